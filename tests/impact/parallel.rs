//! Faces that stay parallel: plates that spin and slide over each other, bodies that rotate as one.
//!
//! The gap never changes, so the number of steps must not grow as the gap shrinks.

use lin_canny::Tracker;
use lin_canny::Velocity;
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use truth::casts::solid;
use truth::rng::Rng;
use truth::shapes;

/// Returns the largest number of steps of casts at a gap, by the rotation.
fn most_looks(gap: f64, turn: f64) -> u32 {
    // Rounding grows with the square of the rotation of one step, so a step rotates by at most the
    // root of the gap divided by rounding.
    let step = (gap / 1e-12).sqrt();
    4 + (6.0 * turn / step) as u32
}

/// A plate spins and slides over a parallel plate, which rests or spins differently; either may be
/// A.
#[test]
fn plates_spin_over_plates() {
    let plate = solid(&shapes::cuboid([1.0, 0.8, 0.05]).points);
    let round = solid(&shapes::prism(9, 1.0, 0.05).points);
    let mut rng = Rng::new(1925);
    let mut most = 0;
    for case in 0..300 {
        let gap = rng.log_range(1e-12, 1e-2);
        let turn = [1.0, 6.0, 60.0][case % 3];
        // The normal of the plates: an axis, or a random direction.
        let tilt = if case % 2 == 0 {
            UnitQuaternion::identity()
        } else {
            UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * 2.0)
        };
        let gap = if case % 2 == 0 { gap } else { gap.max(1e-11) };
        let slide = Vector3::from(rng.in_ball());
        let slide = tilt * Vector3::new(slide.x, slide.y, 0.0);
        let axis = tilt * Vector3::z();
        let under = if case % 5 == 0 {
            axis * (0.3 * turn)
        } else {
            Vector3::zeros()
        };
        let motion = |height: f64, linear: Vector3<f64>, angular: Vector3<f64>| {
            let start = Isometry3::from_parts((axis * height).into(), tilt);
            Steady::new(&start, Velocity::new(linear, angular)).expect("a motion")
        };
        let low = motion(0.0, Vector3::zeros(), under);
        let high = motion(0.1 + gap, slide, axis * turn);
        let tolerance = Tolerance::Distance(1e-10);
        let (first, second) = if case % 4 < 2 {
            (&plate, &round)
        } else {
            (&round, &plate)
        };
        let (of_first, of_second) = if case % 4 < 2 { (&low, &high) } else { (&high, &low) };
        let mut tracker = Tracker::new();
        let mut pair = tracker.pair(first, second);
        let found = cast(&mut pair, of_first, of_second, 0.0..1.0, tolerance).expect("a cast");
        let bound = most_looks(gap, turn);
        let is_missed = found.impact == Impact::Miss && found.queries <= bound;
        assert!(is_missed, "{case}: gap {gap:e}, turn {turn}, bound {bound}: {found:?}");
        most = most.max(found.queries);
    }
    eprintln!("{most} looks at most");
}

/// The same with an approach so slow that the plates meet: on time, for any rotation.
#[test]
fn plates_that_sink_meet_on_time() {
    let plate = solid(&shapes::cuboid([1.0, 0.8, 0.05]).points);
    for (k, turn) in [1.0, 6.0, 60.0].into_iter().enumerate() {
        for gap in [1e-2, 1e-4, 1e-6, 1e-8] {
            let motion = |height: f64, sink: f64, turn: f64| {
                let start = Isometry3::translation(0.1, 0.0, height);
                let velocity = Velocity::new(Vector3::new(0.3, 0.1, -sink), Vector3::z() * turn);
                Steady::new(&start, velocity).expect("a motion")
            };
            let (low, high) = (motion(0.0, 0.0, 0.0), motion(0.1 + gap, 2.0 * gap, turn));
            let mut tracker = Tracker::new();
            let mut pair = tracker.pair(&plate, &plate);
            let found = cast(&mut pair, &low, &high, 0.0..1.0, Tolerance::Distance(0.01 * gap)).expect("a cast");
            let Impact::Hit { safe, hit, .. } = found.impact else {
                panic!("{k} {gap:e}: {found:?}")
            };
            assert!(safe <= 0.5 + 1e-7, "{turn} {gap:e}: {found:?}");
            assert!(0.5 - 1e-7 <= hit, "{turn} {gap:e}: {found:?}");
            assert!(hit - safe < 0.02, "{turn} {gap:e}: {found:?}");
            assert!(found.queries <= 4 + most_looks(gap, turn), "{turn} {gap:e}: {found:?}");
        }
    }
}

/// Two bodies rotate as one with a tiny gap: a long step has no margin left, a shorter one has.
#[test]
fn bodies_carried_round_a_hair_apart_never_meet() {
    let cube = solid(&shapes::cuboid([0.5, 0.5, 0.5]).points);
    let other = solid(&shapes::prism(7, 0.5, 0.5).points);
    let mut rng = Rng::new(1926);
    for case in 0..200 {
        let gap = rng.log_range(3e-12, 1e-2);
        let turn = [1.0, 6.0, 60.0, 600.0][case % 4];
        let axis = if case % 3 == 0 {
            Vector3::z()
        } else {
            Vector3::from(rng.unit())
        };
        let spin = Velocity::new(Vector3::zeros(), axis * turn);
        let away = Vector3::z() * (1.0 + gap);
        let a = Steady::new(&Isometry3::identity(), spin).expect("a motion");
        let b = Steady::about(&Isometry3::from(away), Point3::from(-away), spin).expect("a motion");
        let mut tracker = Tracker::new();
        let mut pair = tracker.pair(&cube, &other);
        let found = cast(&mut pair, &a, &b, 0.0..1.0, Tolerance::Distance(1e-10)).expect("a cast");
        let bound = most_looks(gap, turn);
        let is_missed = found.impact == Impact::Miss && found.queries <= bound;
        assert!(is_missed, "{case}: gap {gap:e}, turn {turn}, bound {bound}: {found:?}");
    }
}
