//! Grades the crate at each level, and parry, on every named hard case of `tests/corpus/`.
//!
//! The exact values in the files are the reference.
//!
//! ```text
//! cargo run --release -p race --bin corpus             # the table of the README
//! cargo run --release -p race --bin corpus -- --list   # and every failure by name
//! cargo run --release -p race --bin corpus -- --truth  # the exact values of the small cases
//! ```
//!
//! An engine fails a case if it
//!
//! - panics, gives no answer or returns NaN;
//! - returns the wrong side of contact although the bodies are more than `1e-12 L` from touching;
//! - has an error greater than both `1e-9` of the distance and `1e-13 L`; or
//! - gives different answers for A, B and for B, A.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Tracker};
use truth::corpus::{self, Case};
use truth::parry;
use truth::shapes::Shape;
use truth::support::{between, body};

/// A signed distance, an overlap of unknown depth, or no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Answer {
    Distance(f64),
    Overlap,
    None,
}

impl Answer {
    fn signed(self) -> Option<f64> {
        match self {
            Self::Distance(d) => Some(d),
            Self::Overlap => None,
            Self::None => Some(f64::NAN),
        }
    }
}

/// A graded engine.
struct Engine {
    name: &'static str,
    /// Accepts only bodies with a volume.
    solids: bool,
    /// Returns a depth.
    depth: bool,
    ask: fn(&Pair) -> Answer,
}

struct Pair {
    a: ConvexPolyhedron,
    b: ConvexPolyhedron,
    points: [Vec<truth::Point>; 2],
    poses: [truth::Pose; 2],
}

impl Pair {
    fn new(c: &Case, swapped: bool) -> Self {
        let (a, b) = (body(&c.a), body(&c.b));
        let points = [c.a.points.clone(), c.b.points.clone()];
        let (mut pair, poses) = (
            Self {
                a,
                b,
                points,
                poses: [c.pose_a, c.pose_b],
            },
            [c.pose_b, c.pose_a],
        );
        if swapped {
            std::mem::swap(&mut pair.a, &mut pair.b);
            pair.points.reverse();
            pair.poses = poses;
        }
        pair
    }

    fn solid(&self) -> bool {
        [&self.a, &self.b].iter().all(|b| b.volume() > 0.0)
    }
}

fn ours(o: &Outcome) -> Answer {
    match o.state {
        ContactState::Undecided => Answer::None,
        _ => Answer::Distance(o.distance),
    }
}

fn walk(p: &Pair) -> Answer {
    let pose = between(&p.poses[0], &p.poses[1]);
    let reported = Tracker::new().propose(&p.a, &p.b, &pose);
    reported.distance.map_or(Answer::Overlap, Answer::Distance)
}

fn certified(p: &Pair) -> Answer {
    ours(&Tracker::new().closest(&p.a, &p.b, &between(&p.poses[0], &p.poses[1])))
}

fn exact(p: &Pair) -> Answer {
    ours(&Tracker::new().closest_exact(&p.a, &p.b, &between(&p.poses[0], &p.poses[1])))
}

/// Returns the vertices and faces of one of our bodies.
fn plain(body: &ConvexPolyhedron) -> Shape {
    let rim = |f| body.face_vertices(f).map(|v| v.index() as u32).collect();
    let mut shape = Shape::hull("body", body.vertex_points().map(|p| p.coords.into()).collect());
    shape.faces = body.faces().map(rim).collect();
    shape
}

fn parry_of_our_hull(p: &Pair) -> Answer {
    let hull = |b| {
        let s = plain(b);
        parry::mesh(&s.points, &s.faces)
    };
    signed(hull(&p.a), hull(&p.b), &p.poses)
}

fn parry_of_points(p: &Pair) -> Answer {
    signed(parry::hull(&p.points[0]), parry::hull(&p.points[1]), &p.poses)
}

fn signed(a: Option<parry::Hull>, b: Option<parry::Hull>, poses: &[truth::Pose; 2]) -> Answer {
    let (Some(a), Some(b)) = (a, b) else {
        return Answer::None;
    };
    Answer::Distance(parry::signed_distance(&a, &poses[0], &b, &poses[1]))
}

const fn engine(name: &'static str, solids: bool, depth: bool, ask: fn(&Pair) -> Answer) -> Engine {
    Engine {
        name,
        solids,
        depth,
        ask,
    }
}

const ENGINES: [Engine; 5] = [
    engine("walk alone", false, false, walk),
    engine("certified", false, true, certified),
    engine("exact", false, true, exact),
    engine("parry, our hull", true, true, parry_of_our_hull),
    engine("parry, its hull", true, true, parry_of_points),
];

/// Kinds of failure, the worst first.
const WAYS: [&str; 6] = ["panic", "no answer", "NaN", "side", "distance", "order"];

/// Returns the kind of failure of an engine on a case, if any: the worse of both orders.
fn grade(c: &Case, engine: &Engine, there: &Pair, back: &Pair) -> Option<usize> {
    let asked = |p: &Pair| catch_unwind(AssertUnwindSafe(|| (engine.ask)(p))).ok();
    let (Some(x), Some(y)) = (asked(there), asked(back)) else {
        return Some(0);
    };
    if x == Answer::None || y == Answer::None {
        return Some(1);
    }
    // A touching pair has distance zero. If the file gives no depth, the depth is large.
    let truth = match (c.state, engine.depth) {
        (truth::ContactState::Touching, _) | (truth::ContactState::Overlapping, false) => Some(0.0),
        _ => c.distance,
    };
    let slack = f64::max(1e-9 * truth.unwrap_or(0.0).abs(), 1e-13 * c.size());
    let ways = [x, y].map(|answer| fault(c, answer.signed(), truth, slack));
    let apart = x.signed().zip(y.signed()).is_some_and(|(d, e)| (d - e).abs() > slack);
    ways.into_iter().flatten().min().or(apart.then_some(5))
}

/// Returns the failure of one answer; `reported` is `None` for an overlap of unknown depth.
fn fault(c: &Case, reported: Option<f64>, truth: Option<f64>, slack: f64) -> Option<usize> {
    if reported.is_some_and(f64::is_nan) {
        return Some(2);
    }
    let near = truth.is_some_and(|t| t.abs() <= 1e-12 * c.size());
    let overlaps = reported.is_none_or(|d| d < 0.0);
    if !near && overlaps != (c.state == truth::ContactState::Overlapping) {
        return Some(3);
    }
    let off = reported.zip(truth).is_some_and(|(d, t)| (d - t).abs() > slack);
    off.then_some(4)
}

/// Failures by kind, and the number of cases run.
#[derive(Clone, Copy, Default)]
struct Score {
    asked: usize,
    ways: [usize; WAYS.len()],
}

impl Score {
    fn add(&mut self, o: &Self) {
        self.asked += o.asked;
        self.ways.iter_mut().zip(o.ways).for_each(|(s, n)| *s += n);
    }

    fn cell(&self) -> String {
        let failed: usize = self.ways.iter().sum();
        let list = WAYS.iter().zip(self.ways).filter(|(_, n)| *n > 0);
        let words: Vec<String> = list.map(|(w, n)| format!("{n} {w}")).collect();
        match failed {
            0 => "0".into(),
            _ => words.join(", "),
        }
    }
}

type Table = BTreeMap<String, [Score; ENGINES.len()]>;

fn table(cases: &[Case], list: bool) -> Table {
    let mut table = Table::new();
    for c in cases {
        let (there, back) = (Pair::new(c, false), Pair::new(c, true));
        let row = table.entry(c.family.clone()).or_default();
        for (score, engine) in row.iter_mut().zip(&ENGINES) {
            if engine.solids && !there.solid() {
                continue;
            }
            score.asked += 1;
            if let Some(way) = grade(c, engine, &there, &back) {
                score.ways[way] += 1;
                if list {
                    let reported = [&there, &back].map(|p| (engine.ask)(p));
                    eprintln!(
                        "{}: {} ({}), truth {:?}: {reported:?}",
                        engine.name, c.name, WAYS[way], c.distance
                    );
                }
            }
        }
    }
    table
}

fn print(table: &Table) {
    let heads: Vec<_> = ENGINES.iter().map(|e| e.name).collect();
    println!(
        "| family | cases | {} |\n|---|---:|{}",
        heads.join(" | "),
        "---|".repeat(heads.len())
    );
    let line = |name: &str, row: &[Score; ENGINES.len()]| {
        let cells: Vec<_> = row.iter().map(Score::cell).collect();
        println!("| {name} | {} | {} |", row[0].asked, cells.join(" | "));
    };
    let mut sum = [Score::default(); ENGINES.len()];
    for (family, row) in table {
        line(family, row);
        sum.iter_mut().zip(row).for_each(|(s, r)| s.add(r));
    }
    line("all", &sum);
}

/// Grade this crate, at each level of accuracy, and parry on every named hard case of tests/corpus
#[derive(Parser)]
struct Options {
    /// List every failure by name
    #[arg(long)]
    list: bool,
    /// Print the exact values of the small cases instead
    #[arg(long)]
    truth: bool,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), String> {
    let cases = corpus::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus"));
    if options.truth {
        for c in cases.iter().filter(|c| c.is_small(42)) {
            let t = c.truth();
            println!("{} {} {:?}", c.name, t.state, t.distance);
        }
        return Ok(());
    }
    // Panics count as failures; their messages are suppressed.
    std::panic::set_hook(Box::new(|_| ()));
    print(&table(&cases, options.list));
    Ok(())
}
