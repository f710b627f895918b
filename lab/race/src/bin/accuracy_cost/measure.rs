//! Times the cases of one pair in interleaved passes, for rows of a record and lines of a table.

use std::time::Duration;

use lin_canny::{Solver, TrackerWork};
use race::progress::Progress;
use race::record::{Row, spread};

use crate::engines::{self, Case};
use crate::options::Options;
use crate::truth::Sampled;
use truth::pairs::Pair;

/// Duration of a pass over shapes or meshes, whose first query is a search that takes microseconds.
const PASS: Duration = Duration::from_millis(50);

/// Measurements of one case.
pub(crate) struct Seen {
    pub(crate) case: Case,
    pub(crate) ns: Vec<f64>,
    pub(crate) err: Vec<f64>,
    pub(crate) totals: TrackerWork,
}

/// Measures all cases on one pair, with their errors. Also returns the width of the interval of the
/// true distance.
fn judged(pair: &Pair, cases: &[Case], options: &Options) -> (Vec<Seen>, f64) {
    let truth = Sampled::new(pair, options.sampled());
    let mut all = timed(pair, cases, options);
    for seen in &mut all {
        let (answers, totals) = engines::answers(seen.case, pair);
        seen.err = truth.errors(options.passes(), |f| answers[f].0);
        seen.totals = totals;
    }
    (all, truth.width())
}

/// Times all cases on one pair, in interleaved passes.
pub(crate) fn timed(pair: &Pair, cases: &[Case], options: &Options) -> Vec<Seen> {
    let open = |&case: &Case| Seen {
        case,
        ns: Vec::new(),
        err: Vec::new(),
        totals: TrackerWork::default(),
    };
    let mut all: Vec<Seen> = cases.iter().filter(|c| c.takes(pair)).map(open).collect();
    for _ in 0..options.passes() {
        for seen in &mut all {
            seen.ns.push(engines::time(seen.case, pair));
        }
    }
    all
}

/// Adds the rows of the measurements.
pub(crate) fn record(rows: &mut Vec<Row>, seen: &[Seen], family: &str, n: usize) {
    for s in seen {
        let row = |(&ns, &err): (&f64, &f64)| Row {
            engine: s.case.engine().into(),
            level: s.case.name(),
            family: family.into(),
            n,
            ns,
            err,
        };
        rows.extend(s.ns.iter().zip(&s.err).map(row));
    }
}

/// Returns the times of some passes of `ask` over a motion, and the greatest error of each stretch
/// of the motion.
pub(crate) fn passes<S>(
    options: &Options,
    (frames, truth): (usize, &Sampled),
    fresh: impl Fn() -> S + Copy,
    ask: impl Fn(usize, &mut S) -> f64 + Copy,
) -> [Vec<f64>; 2] {
    let times = (0..options.passes()).map(|_| engines::clocked_within(PASS, frames, fresh, ask));
    let times = times.collect();
    let mut state = fresh();
    let answers: Vec<f64> = (0..frames).map(|f| ask(f, &mut state)).collect();
    [times, truth.errors(options.passes(), |f| answers[f])]
}

/// Prints the title of a table with a line for each engine, and its column headings.
pub(crate) fn title(title: &str, what: &str) {
    println!("\n{title}");
    println!(
        "{what:<20} {:>6}  {:<11} {:<10} {:>11} {:>23}  {:>9}",
        "n", "engine", "level", "ns", "from .. to", "error"
    );
}

/// Prints a line and adds its rows to the record, in the family `part name`.
pub(crate) fn line(
    rows: &mut Vec<Row>,
    (part, name, n): (&str, &str, usize),
    (engine, level): (&str, &str),
    [times, errors]: [Vec<f64>; 2],
) {
    let ns = spread(times.iter().copied());
    println!(
        "{name:<20} {n:>6}  {engine:<11} {level:<10} {:>11.1} {:>11.1} {:>11.1}  {:>9.1e}",
        ns[1],
        ns[0],
        ns[2],
        errors.iter().copied().fold(0.0, f64::max)
    );
    rows.extend(times.iter().zip(&errors).map(|(&ns, &err)| Row {
        engine: engine.into(),
        level: level.into(),
        family: format!("{part} {name}"),
        n,
        ns,
        err,
    }));
}

pub(crate) fn head(title: &str) {
    println!("\n{title}");
    println!(
        "{:<18} {:>6}  {:<11} {:<10} {:>9} {:>17}  {:>9} {:>9}  {:>7} {:>8}",
        "family", "n", "engine", "level", "ns", "from .. to", "error", "least", "steps", "no walk"
    );
}

/// Prints a line for each case.
///
/// Columns: the median time and its spread, the greatest and the least error of its stretches,
/// steps per query, and the share of queries that a solver other than the walk answered.
pub(crate) fn table(seen: &[Seen], family: &str, n: usize) {
    for s in seen {
        let (ns, err) = (spread(s.ns.iter().copied()), spread(s.err.iter().copied()));
        let tracked = s.totals.queries > 0;
        let number = |x: f64, unit: &str| if tracked { format!("{x:.2}{unit}") } else { "-".into() };
        let walked = [Solver::Walk, Solver::Restart]
            .map(|l| s.totals.answered_by(l))
            .iter()
            .sum::<u64>();
        let queries = s.totals.queries.max(1) as f64;
        println!(
            "{family:<18} {n:>6}  {:<11} {:<10} {:>9.1} {:>8.1} {:>8.1}  {:>9.1e} {:>9.1e}  {:>7} {:>8}",
            s.case.engine(),
            s.case.name(),
            ns[1],
            ns[0],
            ns[2],
            err[2],
            err[0],
            number(s.totals.steps as f64 / queries, ""),
            number(100.0 * (1.0 - walked as f64 / queries), "%"),
        );
    }
}

/// Measures one family, prints it and adds it to the record.
pub(crate) fn family(
    pair: &Pair,
    (name, n): (&str, usize),
    list: &[Case],
    options: &Options,
    rows: &mut Vec<Row>,
    progress: &Progress,
) -> Vec<Seen> {
    progress.say(&format!("{name}, {n} vertices"));
    let (seen, open) = judged(pair, list, options);
    table(&seen, name, n);
    if open > 0.0 {
        println!(
            "{:<18} {n:>6}  what exact arithmetic leaves open of the truth: {open:.1e}",
            name
        );
    }
    record(rows, &seen, name, n);
    progress.step();
    seen
}
