//! Two published protocols that revealed weaknesses of walks over features.
//!
//! Degeneracy (Mirtich 1998, algorithm 10): two cubes, the upper rotated by as little as e^-20,
//! move between two nearly parallel poses. Bisection searches the pose at which the closest
//! features change: there all tests are at their worst. In 100 000 trials, the Lin-Canny code of
//! its time cycled 4489 times.
//!
//! Coherence (Mirtich 1998, section 7): one body on a sinusoidal path rotates by a fixed angle per
//! frame.

use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Solver, Tracker, TrackerWork};
use truth::pose::{quat, unit};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support::{assert_right, between, body};
use truth::{Pose, exact};

/// Largest width of a certified outcome, in units of L.
const WIDTH: f64 = 1e-13;

/// Asserts that an outcome is separated and as tight as promised; counts pairs that another solver
/// answered.
fn certified(o: &Outcome, size: f64, what: &str) {
    assert_eq!(o.state, ContactState::Separated, "{what}: {o:?}");
    assert!(o.upper - o.lower <= WIDTH * size, "{what}: {o:?}");
}

fn share(totals: &TrackerWork) -> f64 {
    let walked = totals.answered_by(Solver::Walk) + totals.answered_by(Solver::Restart);
    1.0 - walked as f64 / totals.queries as f64
}

/// Returns a pose of the degeneracy protocol: above the lower cube, rotated slightly about any
/// axis.
fn nearly_parallel(rng: &mut Rng) -> Pose {
    let t = [rng.range(-4.0, 4.0), rng.range(-4.0, 4.0), 4.0];
    Pose::new(quat(rng.unit(), (-rng.range(0.0, 20.0)).exp()), t)
}

fn middle(a: &Pose, b: &Pose) -> Pose {
    let half = |x: f64, y: f64| 0.5 * (x + y);
    Pose::new(
        truth::pose::unit_quat(std::array::from_fn(|i| half(a.q[i], b.q[i]))),
        std::array::from_fn(|i| half(a.t[i], b.t[i])),
    )
}

/// Bisects between two poses until the features change between poses that `f64` cannot separate.
///
/// Each query starts from the features of the previous one.
fn bisect(
    pair: &mut Tracker,
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    ends: (Pose, Pose),
    check: &mut impl FnMut(&Outcome, &Pose),
) {
    let mut ask = |p: &Pose| {
        let o = pair.closest(a, b, &between(&Pose::IDENTITY, p));
        check(&o, p);
        o.features
    };
    let (mut low, mut high) = ends;
    let (first, last) = (ask(&low), ask(&high));
    if first == last {
        return;
    }
    for _ in 0..60 {
        let mid = middle(&low, &high);
        if mid == low || mid == high {
            return;
        }
        if ask(&mid) == first { low = mid } else { high = mid }
    }
}

fn degenerate(shape: &Shape, trials: usize, seed: u64) -> TrackerWork {
    let (a, mut rng) = (body(shape), Rng::new(seed));
    let mut pair = Tracker::new();
    let mut judged = 0;
    for trial in 0..trials {
        let ends = (nearly_parallel(&mut rng), nearly_parallel(&mut rng));
        let mut count = 0;
        bisect(&mut pair, &a, &a, ends, &mut |o, p| {
            certified(o, 10.0, &format!("{} trial {trial} at {p:?}", shape.name));
            count += 1;
            // The oracle takes milliseconds: one pose of some bisections, mostly late ones.
            if trial % 50 == 0 && count % 20 == 0 {
                let truth = exact::solve(shape.into(), &Pose::IDENTITY, shape.into(), p);
                assert_right(o, &truth, &format!("{} trial {trial}", shape.name));
                judged += 1;
            }
        });
    }
    assert!(judged * 60 > trials, "{judged} poses judged by the oracle");
    pair.work()
}

#[test]
fn bisections_between_nearly_parallel_poses_end_in_proof() {
    let plate = shapes::cuboid([1.0, 1.0, 1e-3]);
    for (shape, trials) in [
        (shapes::cube(), 3000),
        (plate, 1000),
        (shapes::prism(6, 1.0, 1.0), 1000),
    ] {
        let totals = degenerate(&shape, trials, 31);
        println!(
            "degeneracy, {}: {totals:?}, fallback share {:.5}",
            shape.name,
            share(&totals)
        );
        assert!(totals.queries as usize > 20 * trials, "{totals:?}");
        // None for cubes; for a plate one in 57 500, if a foot of a perpendicular is within
        // rounding of an edge.
        let most = if shape.name.starts_with("cube") { 0.0 } else { 1e-4 };
        assert!(share(&totals) <= most, "{}: {totals:?}", shape.name);
    }
}

/// Returns frames of the coherence protocol: B on a sinusoidal path about A, rotated by `degrees`
/// more in each frame.
fn sinusoid(rng: &mut Rng, frames: usize, degrees: f64) -> Vec<Pose> {
    let axis = unit(rng.unit());
    let phase: [f64; 3] = std::array::from_fn(|_| rng.range(0.0, std::f64::consts::TAU));
    let frame = |i: usize| {
        let theta = (degrees * i as f64).to_radians();
        let swing = |k: usize| 0.7 * (theta + phase[k]).cos();
        Pose::new(quat(axis, theta), [4.2 + swing(0), swing(1), swing(2)])
    };
    (0..frames).map(frame).collect()
}

#[test]
fn warm_is_cold_along_coherent_motion() {
    let mut rng = Rng::new(41);
    let bodies = [
        shapes::cube(),
        shapes::icosahedron(),
        shapes::prism(60, 1.0, 0.1),
        shapes::icosphere(3),
    ];
    for shape in &bodies {
        let a = body(shape);
        for degrees in [0.0, 0.1, 0.5, 1.0, 5.0, 10.0, 25.0] {
            let (mut warm, mut cold) = (Tracker::new(), TrackerWork::default());
            for (i, p) in sinusoid(&mut rng, 1000, degrees).iter().enumerate() {
                let pose = between(&Pose::IDENTITY, p);
                let o = warm.closest(&a, &a, &pose);
                let mut fresh = Tracker::new();
                let c = fresh.closest(&a, &a, &pose);
                cold += fresh.work();
                let what = format!("{} frame {i}, {degrees} degrees", shape.name);
                certified(&o, 10.0, &what);
                certified(&c, 10.0, &what);
                // Both contain the distance in their bounds, so neither may refute the other.
                assert!(o.lower <= c.upper && c.lower <= o.upper, "{what}: {o:?} {c:?}");
                assert!((o.distance - c.distance).abs() <= 1e-14 * 10.0, "{what}: {o:?} {c:?}");
            }
            let totals = warm.work();
            println!(
                "coherence, {}, {degrees} degrees: {:.2} steps a query warm, {:.2} cold, fallback share {:.5} warm, {:.5} cold",
                shape.name,
                totals.steps as f64 / totals.queries as f64,
                cold.steps as f64 / cold.queries as f64,
                share(&totals),
                share(&cold)
            );
            // A tracker may try the other start if motion is fast.
            assert!(totals.queries == 1000, "{totals:?}");
            assert!((degrees > 1.0 || totals.warm > 900), "{totals:?}");
            assert_eq!(share(&totals), 0.0, "{}, {degrees} degrees: {totals:?}", shape.name);
            if degrees < 0.2 {
                assert!(totals.steps < 1600, "{}: {totals:?}", shape.name);
            }
        }
    }
}
