//! Promise: a cast is never wrong.
//!
//! Up to `safe`, and during a whole miss, the bodies are separated at every sampled instant. At
//! `hit` they meet. A second method, conservative advancement, contradicts none of it.

mod falls;
mod hard;
mod hostile;
mod judge;
mod leave;
mod models;
mod pairs;
mod parallel;
mod planes;
mod ray;
mod ray_exact;
mod ray_hull;
mod ray_mesh;
mod scales;
mod shapes;
mod spins;
mod steps;
mod within;

use judge::{Judge, Tally};
use lin_canny::ConvexPolyhedron;
use lin_canny::impact::Tolerance;
use truth::casts::{self, SHAPES, Throw};
use truth::rng::Rng;

/// Returns bodies of all families, small and large ones.
pub(crate) fn bodies(rng: &mut Rng) -> Vec<ConvexPolyhedron> {
    let mut all: Vec<_> = SHAPES.iter().map(|s| casts::body(s, 8, rng)).collect();
    all.extend(["sphere", "flat", "plates"].map(|s| casts::body(s, 32, rng)));
    all.push(casts::body("sphere", 128, rng));
    let tiny: Vec<_> = truth::shapes::sphere(rng, 12)
        .points
        .iter()
        .map(|p| p.map(|x| 1e-3 * x))
        .collect();
    all.push(casts::solid(&tiny));
    all
}

pub(crate) fn radius(body: &ConvexPolyhedron) -> f64 {
    body.vertex_points().map(|p| p.coords.norm()).fold(0.0, f64::max)
}

/// Casts random throws of all families, from linear ones to a hundred turns.
fn throws(seed: u64, count: u64, instants: usize) -> Tally {
    let mut rng = Rng::new(seed);
    let bodies = bodies(&mut rng);
    let mut tally = Tally::default();
    for k in 0..count {
        let mut rng = Rng::of_case(seed, k);
        let (a, b) = (rng.pick(&bodies).clone(), rng.pick(&bodies).clone());
        let turn = [0.0, 0.3, 1.0, 1.0, 3.0, 6.0, 6.0, 60.0][rng.below(8)];
        let turn = if k % 500 == 0 { 600.0 } else { turn };
        let mut throw = casts::aimed(&mut rng, (radius(&a), radius(&b)), turn);
        still(&mut rng, &mut throw);
        let tolerance = [1e-4, 1e-6, 1e-9, 1e-12][rng.below(4)];
        let judge = Judge::new([&a, &b], throw, format!("seed {seed} case {k}"));
        judge.cast(Tolerance::Distance(tolerance), instants, turn, &mut tally);
    }
    tally
}

/// In some throws only one body moves, or both move alike.
fn still(rng: &mut Rng, throw: &mut Throw) {
    let [a, b] = throw.velocity;
    match rng.below(10) {
        0 => {
            throw.velocity = [
                Default::default(),
                lin_canny::Velocity::new(b.linear - a.linear, b.angular),
            ]
        }
        1 => {
            throw.velocity = [
                lin_canny::Velocity::new(a.linear - b.linear, a.angular),
                Default::default(),
            ]
        }
        2 => throw.velocity[1].linear = a.linear,
        3 => throw.velocity[0].angular = b.angular,
        4 => {
            throw.start[1].translation.vector +=
                0.7 * (throw.start[0].translation.vector - throw.start[1].translation.vector)
        }
        _ => {}
    }
}

#[test]
fn casts_are_never_late_and_never_miss() {
    let tally = throws(1905, 20_000, 100);
    eprintln!("{tally:?}");
    assert!(tally.hits > 6_000, "{tally:?}");
    assert!(tally.misses > 5_000, "{tally:?}");
    assert!(tally.starts > 20, "{tally:?}");
    assert!(tally.near + tally.unknown <= 2, "{tally:?}");
    let [slow, fast] = tally.medians();
    assert!(slow <= 5 && fast <= 7, "queries a hit: {slow} {fast}");
}

/// The full run: 100,000 casts at 500 instants each.
#[test]
#[ignore = "minutes"]
fn a_hundred_thousand_casts() {
    let tally = throws(1906, 100_000, 500);
    eprintln!("{tally:?} medians {:?}", tally.medians());
    assert!(tally.near + tally.unknown <= 10, "{tally:?}");
}

/// A million casts at 40 instants each; a late or missed contact is a failure.
#[test]
#[ignore = "minutes"]
fn a_million_casts() {
    let tally = throws(1907, 1_000_000, 40);
    eprintln!("{tally:?}");
    eprintln!(
        "0 of {} hits late, 0 of {} misses missed a contact",
        tally.hits, tally.misses
    );
    assert!(tally.hits > 300_000 && tally.misses > 250_000, "{tally:?}");
    assert!(tally.near + tally.unknown <= 100, "{tally:?}");
}
