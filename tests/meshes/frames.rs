//! Tracking over frames: slow motion, jumps, long rotation, skipped frames.

use super::{judge, mesh, relative, shapes};
use lin_canny::{ContactState, PairTracker};
use truth::Pose;
use truth::pose::{quat, quat_mul, unit_quat};
use truth::rng::Rng;
use truth::soups;

/// Returns frames of slow tumbling with occasional jumps.
fn motion(frames: usize, degrees: f64, jump: usize, seed: u64) -> Vec<Pose> {
    let mut rng = Rng::new(seed);
    let (mut q, mut axis, mut at) = (rng.quat(), rng.unit(), rng.unit());
    let pose = |k: usize| {
        if jump > 0 && k % jump == jump - 1 {
            (q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
        }
        q = unit_quat(quat_mul(quat(axis, degrees.to_radians()), q));
        let swing = 1.45 + 0.6 * (k as f64 * degrees.to_radians()).sin();
        Pose::new(q, at.map(|x| x * swing))
    };
    (0..frames).map(pose).collect()
}

#[test]
fn tracked_frames_equal_brute_force() {
    let shapes = shapes();
    let meshes: Vec<_> = shapes.iter().map(mesh).collect();
    let (mut apart, mut meeting, mut entries) = (0, 0, 0);
    for (k, degrees) in [(0, 0.02), (1, 0.5), (2, 0.5), (3, 2.0), (4, 0.5), (5, 5.0), (6, 0.5)] {
        for other in [k, (k + 3) % 7] {
            let (mut tracker, pair) = (PairTracker::new(), (&meshes[k], &meshes[other]));
            for pose in motion(120, degrees, 50, k as u64) {
                match judge(&mut tracker, (&shapes[k], &shapes[other]), pair, &pose) {
                    ContactState::Separated => apart += 1,
                    _ => meeting += 1,
                }
            }
            entries += tracker.work().trees.entries;
        }
    }
    assert!(apart > 500, "{apart} {meeting} {entries}");
    assert!(meeting > 100, "{apart} {meeting} {entries}");
    assert!(entries > 10_000, "{apart} {meeting} {entries}");
}

#[test]
fn warm_equals_cold_over_many_frames() {
    let (a, b) = (mesh(&soups::rock(4, 1)), mesh(&soups::torus(60, 30, 0.3)));
    let mut tracker = PairTracker::new();
    for (k, pose) in motion(20_000, 0.5, 900, 3).iter().enumerate() {
        // Some frames are left out; some query only a lower bound.
        if k % 7 == 3 {
            continue;
        }
        if k % 11 == 5 {
            tracker.lower_bound(&a, &b, &relative(pose));
            continue;
        }
        let warm = tracker.closest(&a, &b, &relative(pose));
        if k % 20 == 0 {
            let cold = PairTracker::new().closest(&a, &b, &relative(pose));
            assert_eq!(warm.state, cold.state, "{k}");
            assert!((warm.distance - cold.distance).abs() < 1e-14, "{k}: {warm:?} {cold:?}");
        }
    }
    let work = tracker.work();
    assert!(work.trees.cuts * 10 < work.trees.queries, "{work:?}");
    // A query with a front is cheaper than one without.
    assert!(work.trees.bounds < 150 * work.trees.queries, "{work:?}");
}

#[test]
fn a_million_steps_of_rotation_stay_right() {
    let (a, b) = (soups::rock(1, 2), soups::gear(5));
    let (m, n) = (mesh(&a), mesh(&b));
    let mut tracker = PairTracker::new();
    let mut q = [0.0, 0.0, 0.0, 1.0];
    let step = quat(truth::pose::unit([0.3, 0.9, -0.2]), 0.01);
    for k in 0..1_000_000u32 {
        q = unit_quat(quat_mul(step, q));
        let pose = Pose::new(q, [2.6, 0.1, 0.0]);
        if k % 50_000 == 49_999 {
            judge(&mut tracker, (&a, &b), (&m, &n), &pose);
        } else {
            tracker.closest(&m, &n, &relative(&pose));
        }
    }
}
