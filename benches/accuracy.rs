//! What accuracy costs in time: every level of an answer on one motion, beside GJK.
//!
//! Two hulls orbit each other at a gap of 2 % of their radius, half a degree a frame. `walk` follows
//! features without a proof, `distance` and `closest` have proven bounds, and `closest-exact` is
//! correctly rounded. The largest error of each level against the exact distance, over the size of
//! the pair, is printed first, also at a gap of 1e-9. Run `cargo bench --bench accuracy`;
//! `cargo run --release -p race --bin accuracy_cost` measures more motions and other libraries.

use common::{Group, chosen, each};
use criterion::{AxisScale, Criterion, PlotConfiguration, criterion_group, criterion_main};
use lin_canny::nalgebra::Isometry3;
use lin_canny::{RelativePose, Tracker};
use truth::exact::solve;
use truth::motion::Frame;
use truth::pairs::Pair;
use truth::parry::{self, GjkCached};

const FRAMES: usize = 500;

/// Frames whose error is measured: rational arithmetic takes milliseconds each.
const JUDGED: usize = 20;

/// A frame in the form of each engine.
type Case = (Frame, (Isometry3<f64>, Isometry3<f64>));

/// One level: its name, and what it says about a frame.
type Level<'a> = (&'static str, Box<dyn FnMut(&Case) -> f64 + 'a>);

fn levels<'a>(pair: &'a Pair) -> Vec<Level<'a>> {
    let (a, b) = (&pair.a.ours, &pair.b.ours);
    let pose = |case: &Case| RelativePose::new(&case.1.0, &case.1.1).expect("a pose");
    let [mut walk, mut within, mut overlap] = [0; 3].map(|_| Tracker::new());
    let [mut distance, mut closest, mut exact] = [0; 3].map(|_| Tracker::new());
    let mut gjk = GjkCached::default();
    let mut list: Vec<Level<'a>> = vec![
        (
            "walk",
            Box::new(move |c| walk.propose(a, b, &pose(c)).distance.unwrap_or(f64::NAN)),
        ),
        ("distance", Box::new(move |c| distance.distance(a, b, &pose(c)).value)),
        ("closest", Box::new(move |c| closest.closest(a, b, &pose(c)).distance)),
        (
            "closest-cold",
            Box::new(move |c| Tracker::new().closest(a, b, &pose(c)).distance),
        ),
        (
            "closest-exact",
            Box::new(move |c| exact.closest_exact(a, b, &pose(c)).distance),
        ),
        (
            "gjk-cached",
            Box::new(move |c| {
                let found = gjk.closest(&pair.a.climber, &c.0.a, &pair.b.climber, &c.0.b);
                found.map_or(f64::NAN, |w| w.distance)
            }),
        ),
        // Yes or no alone: no error is printed.
        (
            "overlap",
            Box::new(move |c| f64::from(u8::from(overlap.intersects(a, b, &pose(c))))),
        ),
        (
            "within",
            Box::new(move |c| f64::from(u8::from(within.within(a, b, &pose(c), 0.01)))),
        ),
    ];
    if let (Some(one), Some(other)) = (&pair.a.parry, &pair.b.parry) {
        list.push(("parry", Box::new(move |c| parry::distance(one, &c.0.a, other, &c.0.b))));
    }
    list
}

fn accuracy(c: &mut Criterion) {
    let sizes = chosen(&[32, 512], &[8, 32, 128, 512, 2048]);
    let spheres = |n: usize| Pair::of("sphere", n).expect("a sphere");
    for &n in sizes.iter().filter(|n| **n <= 128) {
        let pairs = [spheres(n).moving(Some(0.5), FRAMES), spheres(n).at_gap(1e-9, FRAMES)];
        let [one, other] = pairs.each_ref().map(errors);
        println!("hulls of {n} vertices: largest error over the size of the pair, at gaps of 2e-2 and 1e-9 radii");
        for ((name, one), (_, other)) in one.iter().zip(&other) {
            println!("  {name:<14} {one:8.1e} {other:8.1e}");
        }
    }
    let mut group: Group = c.benchmark_group("accuracy");
    group.plot_config(PlotConfiguration::default().summary_scale(AxisScale::Logarithmic));
    for &n in sizes {
        let pair = spheres(n).moving(Some(0.5), FRAMES);
        for (name, mut ask) in levels(&pair) {
            each(&mut group, name, n, &cases(&pair), |case| ask(case));
        }
    }
    group.finish();
}

fn cases(pair: &Pair) -> Vec<Case> {
    pair.frames
        .iter()
        .copied()
        .zip(pair.isometries.iter().copied())
        .collect()
}

/// Returns the largest error of each level that says a distance.
fn errors(pair: &Pair) -> Vec<(&'static str, f64)> {
    let cases = cases(pair);
    let judged: Vec<usize> = (0..cases.len()).step_by(cases.len() / JUDGED).collect();
    let exact = |k: &usize| solve(pair.a.plain(), &pair.frames[*k].a, pair.b.plain(), &pair.frames[*k].b).distance;
    let exact: Vec<f64> = judged.iter().map(exact).collect();
    let distances = levels(pair)
        .into_iter()
        .filter(|(name, _)| !["overlap", "within"].contains(name));
    let worst = |(name, mut ask): Level| {
        let errors = judged
            .iter()
            .zip(&exact)
            .map(|(&k, exact)| (ask(&cases[k]) - exact).abs() / pair.size(k));
        // NaN counts.
        (
            name,
            errors.fold(0.0f64, |worst, error| if error <= worst { worst } else { error }),
        )
    };
    distances.map(worst).collect()
}

criterion_group!(name = benches; config = common::criterion(); targets = accuracy);
criterion_main!(benches);
