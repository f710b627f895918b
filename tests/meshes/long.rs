//! Long thin triangles: CAD-like shafts, cones, bearings, links and trays.

use super::{mesh, relative};
use lin_canny::{Mesh, MeshKind, PairTracker};
use truth::pose::{quat, quat_mul, unit_quat};
use truth::{Pose, turned};

#[test]
fn turned_parts_are_solids() {
    let parts = [
        turned::shaft(40),
        turned::cone(24),
        turned::bearing(30, 1.01),
        turned::link(16),
        turned::tray(5),
    ];
    for part in parts {
        let m = mesh(&part);
        assert_eq!(m.kind(), MeshKind::Solid, "{}", m.report());
        assert!(m.report().parts.iter().all(|p| p.volume > 0.0), "{}", m.report());
    }
}

/// Returns the pose of a shaft that rotates by half a degree per frame, at an angle to another and
/// at a gap.
fn crossing(k: usize, degrees: f64, gap: f64) -> Pose {
    let turn = quat([0.0, 0.0, 1.0], (0.5 * k as f64).to_radians());
    Pose::new(
        unit_quat(quat_mul(quat([1.0, 0.0, 0.0], degrees.to_radians()), turn)),
        [2.0 + gap, 0.002 * k as f64, 0.1],
    )
}

#[test]
fn fronts_of_long_parts_hold_what_they_claim() {
    let shaft = mesh(&turned::shaft(90));
    let bearing = mesh(&turned::bearing(48, 1.05));
    let tray = mesh(&turned::tray(6));
    let link = mesh(&turned::link(20));
    let mut entries = 0;
    let mut follow = |a: &Mesh, b: &Mesh, pose: &dyn Fn(usize) -> Pose| {
        let mut tracker = PairTracker::new();
        for k in 0..60 {
            let at = relative(&pose(k));
            tracker.closest(a, b, &at);
            if k % 6 == 5 {
                assert_eq!(tracker.check(a, b, &at), Ok(()), "{k}");
                entries += tracker.front_len();
            }
        }
    };
    for degrees in [1.0, 10.0, 45.0, 90.0] {
        follow(&shaft, &shaft, &|k| crossing(k, degrees, 0.05));
    }
    follow(&shaft, &bearing, &|k| {
        Pose::new(quat([0.0, 0.0, 1.0], 0.005 * k as f64), [0.01, 0.02, 0.005 * k as f64])
    });
    follow(&tray, &link, &|k| {
        Pose::new(
            unit_quat(quat_mul(
                quat([0.0, 0.0, 1.0], 0.01 * k as f64),
                quat([0.0, 1.0, 0.0], 1.5),
            )),
            [0.1, 0.0, 0.13],
        )
    });
    assert!(entries > 10_000, "{entries}");
}

#[test]
fn work_does_not_grow_with_the_number_of_sides() {
    let mut bounds = Vec::new();
    for sides in [100, 1_000] {
        let shaft = mesh(&turned::shaft(sides));
        let mut worst = 0;
        for degrees in [1.0, 10.0, 45.0, 90.0] {
            let mut tracker = PairTracker::new();
            for k in 0..20 {
                let mut cold = PairTracker::new();
                let at = relative(&crossing(k, degrees, 0.05));
                let found = cold.closest(&shaft, &shaft, &at).state;
                assert_eq!(found, tracker.closest(&shaft, &shaft, &at).state);
                worst = worst.max(cold.work().trees.bounds);
            }
            assert!(
                tracker.work().trees.bounds < 600 * 20,
                "{sides} {degrees} {:?}",
                tracker.work()
            );
        }
        bounds.push(worst);
    }
    // Ten times the sides: the work grows by less than the root of this factor.
    assert!(bounds[1] < 3 * bounds[0] && bounds[1] < 2_000, "{bounds:?}");
}

#[test]
fn a_front_that_does_not_pay_is_dropped_and_none_is_longer_than_a_cap() {
    let (shaft, bearing) = (mesh(&turned::shaft(1_000)), mesh(&turned::bearing(1_000, 1.001)));
    let (mut tracker, mut cold) = (PairTracker::new(), 0);
    for k in 0..30 {
        let at = relative(&Pose::new(
            quat([0.0, 0.0, 1.0], 0.004 * f64::from(k)),
            [3e-4, 0.0, 0.0],
        ));
        tracker.closest(&shaft, &bearing, &at);
        let mut anew = PairTracker::new();
        anew.closest(&shaft, &bearing, &at);
        cold += anew.work().trees.bounds;
        assert!(tracker.memory_usage() < 8 << 20, "{}", tracker.memory_usage());
    }
    let work = tracker.work();
    assert!(work.trees.bounds < cold + cold / 4, "{work:?} {cold}");
    assert!(work.trees.cuts < 15, "{work:?} {cold}");
}
