//! Arbitrary bytes are bodies, poses and queries, or are rejected, within a time limit.

use std::time::{Duration, Instant};
use truth::driven::bytes;
use truth::driven::bytes::drive;
use truth::rng::Rng;
use truth::tally::Tally;

/// Far above the time of any query; an endless loop would exceed it.
const LIMIT: Duration = Duration::from_secs(5);

#[test]
fn any_bytes_are_answered_or_refused() {
    let mut rng = Rng::new(61);
    let mut sum = bytes::Tally::default();
    for k in 0..20_000 {
        let mut text: Vec<u8> = (0..64 + rng.below(900)).map(|_| rng.bits() as u8).collect();
        // Half of the inputs have few kinds of numbers, so that points coincide and bodies touch.
        if k % 2 == 0 {
            text.iter_mut().for_each(|b| *b &= 0x3b);
        }
        let began = Instant::now();
        let tally = std::panic::catch_unwind(|| drive(&text));
        assert!(tally.is_ok(), "input {k}: {text:?}");
        assert!(
            began.elapsed() < LIMIT,
            "input {k} took {:?}: {text:?}",
            began.elapsed()
        );
        sum.add(&tally.unwrap_or_default());
    }
    println!("{sum:?}");
    // All cases occur: bodies built and rejected, poses accepted and rejected, and every contact
    // state that exact arithmetic distinguishes.
    let [separated, touching, overlapping, undecided] = sum.classes;
    assert!(sum.bodies.iter().all(|&n| n > 5000), "{sum:?}");
    assert!(sum.poses.iter().all(|&n| n > 1000), "{sum:?}");
    assert!(
        separated > 1000 && touching > 50 && overlapping > 500 && undecided == 0,
        "{sum:?}"
    );
}

#[test]
fn the_ends_of_the_range_are_answered_or_refused() {
    use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
    use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, polyhedron::solids};
    let mut bodies = vec![];
    for x in [0.0, 5e-324, 1e-300, 1.0, 1e100, 1e116, 1e117, 1e300, f64::MAX] {
        bodies.extend(ConvexPolyhedron::point(Point3::new(x, -x, 0.0)));
        bodies.extend(solids::cuboid(Vector3::new(x, x, x)));
        bodies.extend(ConvexPolyhedron::segment(Point3::origin(), Point3::new(0.0, x, x)));
    }
    assert!(bodies.len() > 8 && bodies.len() < 16, "{}", bodies.len());
    let mut refused = 0;
    for (a, b) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))) {
        for x in [0.0, 5e-324, 1e-300, 1.0, 1e60, 1e150, 1e200, 1e306, 1.7e308, f64::MAX] {
            for turn in [Vector3::zeros(), Vector3::new(0.3, -2.0, 1.0)] {
                let poses = (
                    Isometry3::translation(-x, x, -x),
                    Isometry3::new(Vector3::new(x, -x, x / 3.0), turn),
                );
                match RelativePose::new(&poses.0, &poses.1) {
                    Ok(pose) => drop(bytes::query(a, b, &pose, &mut Tracker::new(), x)),
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(refused > 0);
}
