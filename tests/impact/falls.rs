//! Motions that are not uniform: gravity as a user-defined motion, for every kind of pair.

use super::pairs::{Bodies, Fall};
use lin_canny::RelativePose;
use lin_canny::impact::{Impact, Tolerance, cast, free_until, overlapping_until};
use lin_canny::motion::Motion;
use lin_canny::nalgebra::{Isometry3, Vector3};
use truth::rng::Rng;

/// Balls of diameter one meet when their centres are one apart.
fn meeting(fall: &Fall) -> f64 {
    let apart = |t: f64| fall.pose(t).translation.vector.norm() - 1.0;
    let (mut free, mut met) = (0.0, 0.0);
    while apart(met) > 0.0 {
        free = met;
        met += 1.0 / 4096.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (free + met);
        if apart(middle) > 0.0 {
            free = middle;
        } else {
            met = middle;
        }
    }
    met
}

/// Spheres dropped onto each other with an offset, over short and long intervals: the cast returns
/// a hit on time.
#[test]
fn round_bodies_fall_onto_each_other() {
    let bodies = Bodies::new(1.0);
    for (k, until) in [1.0, 3.0, 30.0, 300.0].into_iter().enumerate() {
        for is_named in [true, false] {
            let fall = Fall {
                start: Isometry3::translation(0.1, 0.2, 3.0 + 0.1 * k as f64),
                gravity: Vector3::z() * -9.81,
                is_named,
                ..Fall::still()
            };
            let truth = meeting(&fall);
            bodies.each(|kind, pair| {
                if !["surfaces", "surface and shape", "shape and surface"].contains(&kind) {
                    return;
                }
                let found = cast(pair, &Fall::still(), &fall, 0.0..until, Tolerance::Distance(1e-6)).expect("a cast");
                let Impact::Hit { safe, hit, .. } = found.impact else {
                    panic!("{kind} until {until}, {is_named}, {truth}: {found:?}")
                };
                assert!(safe <= truth, "{kind} {truth} {found:?}");
                assert!(truth - 1e-12 <= hit, "{kind} {truth} {found:?}");
                assert!(hit - safe < 1e-5, "{kind} {truth} {found:?}");
                assert!(found.queries < 150, "{kind} until {until}, {is_named}: {found:?}");
            });
        }
    }
}

/// Random throws, accelerations and spins, for every kind of pair: separated up to `safe`, and
/// decided.
#[test]
fn every_kind_falls_and_is_never_late() {
    let bodies = Bodies::new(1.0);
    let (mut hits, mut misses, mut open, mut cases) = (0, 0, 0, 0);
    for case in 0..24 {
        let mut rng = Rng::of_case(1924, case);
        let a = Fall {
            start: Isometry3::identity(),
            ..Fall::random(&mut rng)
        };
        let mut b = Fall::random(&mut rng);
        let until = [1.0, 3.0, 20.0][rng.below(3)];
        if case % 3 > 0 {
            // Aimed so that about half of them meet.
            b.linear += a.linear - b.start.translation.vector * rng.range(0.5, 2.0);
            b.gravity += a.gravity;
        }
        bodies.each(|kind, pair| {
            cases += 1;
            let found = cast(pair, &a, &b, 0.0..until, Tolerance::Distance(1e-6)).expect("a cast");
            let relative = |t: f64| RelativePose::new(&a.pose(t), &b.pose(t)).expect("a pose");
            let (safe, hit) = match found.impact {
                Impact::Hit { safe, hit, .. } => (safe, Some(hit)),
                Impact::Miss => (until, None),
                Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => {
                    open += 1;
                    (safe, None)
                }
                other => panic!("{kind} {case}: {other:?}"),
            };
            let samples = if kind.contains("surface") { 12 } else { 60 };
            for k in 0..=samples {
                let seen = pair.measure(&relative(safe * f64::from(k) / f64::from(samples)));
                assert!(seen.upper > 0.0, "{kind} {case}: {found:?} {seen:?}");
            }
            if let Some(hit) = hit {
                let seen = pair.measure(&relative(hit));
                assert!(seen.lower <= 1e-9, "{kind} {case}: {found:?} {seen:?}");
                hits += 1;
            } else {
                misses += u32::from(safe == until);
            }
        });
    }
    eprintln!("{cases} casts: {hits} hits, {misses} misses, {open} open");
    assert!(hits > 40, "{hits} hits, {misses} misses, {open} open");
    assert!(misses > 40, "{hits} hits, {misses} misses, {open} open");
    assert!(open <= 2, "{hits} hits, {misses} misses, {open} open");
}

/// The time for which an overlap or a distance holds under gravity: at most the closed form, and
/// most of it.
#[test]
fn holds_are_most_of_what_there_is() {
    let bodies = Bodies::new(1.0);
    for way in [1e-9, 1e-6, 1e-3, 0.5, 2.0] {
        for until in [1e-3, 1.0, 100.0] {
            let fall = Fall {
                start: Isometry3::translation(0.0, 0.0, 0.1),
                gravity: Vector3::z() * -9.81,
                is_named: false,
                ..Fall::still()
            };
            let truth = f64::min(until, (2.0 * way / 9.81f64).sqrt());
            bodies.each(|kind, pair| {
                let held = overlapping_until(pair, &Fall::still(), &fall, 0.0..until, way).expect("an answer");
                assert!(held <= truth, "{kind}, {way} until {until}: {held} {truth}");
                assert!(held > 0.7 * truth, "{kind}, {way} until {until}: {held} {truth}");
            });
        }
    }
    // From afar: the first step of the cast proves most of the fall.
    let fall = Fall {
        start: Isometry3::translation(0.0, 0.0, 3.0),
        gravity: Vector3::z() * -9.81,
        is_named: false,
        ..Fall::still()
    };
    bodies.each(|kind, pair| {
        let free = free_until(pair, &Fall::still(), &fall, 0.0..300.0, 0.0).expect("an answer");
        assert!(free.until > 0.3, "{kind}: {free:?}");
    });
}
