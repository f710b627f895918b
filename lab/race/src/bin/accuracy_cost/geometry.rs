//! Measures the cost of geometric accuracy: two spheres of radius 1, replaced by hulls of more and
//! more vertices.
//!
//! The error is that of the shape: the exact distance of the hulls minus the distance of the
//! spheres, which is the distance of their centres less 2. Both are accurate to 1e-15, far below
//! the error.

use race::progress::Progress;
use race::record::Row;

use crate::engines::{Accuracy, Case};
use crate::measure::{self, Seen};
use crate::options::Options;
use crate::truth::Truth;
use truth::pairs::{Body, Pair, ball};

const SIZES: [usize; 9] = [12, 40, 120, 400, 1200, 4000, 12_000, 40_000, 100_000];

const CASES: [Case; 4] = [
    Case::warm(Accuracy::Certified),
    Case::warm(Accuracy::Exact),
    Case::warm(Accuracy::Gjk),
    Case::cold(Accuracy::Parry),
];

pub(crate) fn count(options: &Options) -> u64 {
    if options.does("geometry") {
        sizes(options).len() as u64
    } else {
        0
    }
}

fn sizes(options: &Options) -> &'static [usize] {
    if options.quick { &SIZES[..6] } else { &SIZES }
}

pub(crate) fn run(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<(), String> {
    println!(
        "\nA sphere replaced by a hull of n vertices, 0.5 degrees a frame: error of the shape and time of a query"
    );
    println!(
        "{:>7}  {:>10}  {:>10} {:>10} {:>10} {:>12}  {:>9}",
        "n", "error", "certified", "exact", "gjk-cached", "parry-f64", "MB"
    );
    for &n in sizes(options) {
        progress.say(&format!("a hull of {n} vertices"));
        let body = || Body::new(&ball(n));
        let pair = Pair::new(body()?, body()?).moving(Some(0.5), options.frames());
        let errors = shape_errors(&pair, options);
        let mut seen: Vec<Seen> = measure::timed(&pair, &CASES, options);
        seen.iter_mut().for_each(|s| s.err.clone_from(&errors));
        let at = |k: usize| {
            let ns = seen.iter().find(|s| s.case == CASES[k]);
            ns.map_or(f64::NAN, |s| race::record::spread(s.ns.iter().copied())[1])
        };
        println!(
            "{n:>7}  {:>10.1e}  {:>10.1} {:>10.1} {:>10.1} {:>12.1}  {:>9.2}",
            errors.iter().copied().fold(0.0, f64::max),
            at(0),
            at(1),
            at(2),
            at(3),
            pair.a.ours.memory_usage() as f64 / 1e6
        );
        measure::record(rows, &seen, "ball", n);
        progress.step();
    }
    Ok(())
}

/// Returns the largest error of the shape in each stretch of the motion, relative to the size of
/// the pair.
fn shape_errors(pair: &Pair, options: &Options) -> Vec<f64> {
    let parts = options.passes();
    let error = |f: usize| {
        let frame = &pair.frames[f];
        let spheres = truth::pose::norm(truth::pose::sub(frame.b.t, frame.a.t)) - 2.0;
        (Truth::of(pair, f).lower - spheres).abs() / pair.size(f)
    };
    let step = pair.frames.len() / (3 * parts);
    (0..parts)
        .map(|p| (0..3).map(|k| error((3 * p + k) * step)).fold(0.0, f64::max))
        .collect()
}
