//! Flush contact, tiny gaps, slivers, soups, scales, and bodies far away.

use super::{judge, mesh, relative, size};
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, MeshError, PairTracker};
use truth::pose::{add, quat, scale};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Pose, brute};

#[test]
fn flush_plates_are_settled_high_in_the_trees() {
    let plate = soups::plate(16, [1.0, 1.0, 0.05]);
    let m = mesh(&plate);
    for (gap, tilt) in [(0.0, 0.0), (1e-9, 0.0), (0.0, 1e-6), (1e-3, 0.0), (1e-12, 0.0)] {
        let mut tracker = PairTracker::new();
        for k in 0..40 {
            let angle = 0.005 * f64::from(k);
            let q = truth::pose::quat_mul(quat([1.0, 0.0, 0.0], tilt), quat([0.0, 0.0, 1.0], angle));
            let pose = Pose::new(q, [0.2, 0.1 * angle, 0.1 + gap + 2.0 * tilt]);
            let found = tracker.closest(&m, &m, &relative(&pose));
            if tilt == 0.0 {
                assert!((found.distance - gap).abs() < 1e-14, "{gap} {found:?}");
            }
            if k % 20 == 7 {
                judge(&mut PairTracker::new(), (&plate, &plate), (&m, &m), &pose);
            }
        }
        let w = tracker.work();
        if tilt == 0.0 {
            assert!(w.trees.bounds < 200 * w.trees.queries, "{gap}: {w:?}");
            assert!(w.trees.measured < 5 * w.trees.queries, "{gap}: {w:?}");
            assert!(tracker.front_len() < 64, "{gap}: {w:?}");
        }
    }
}

#[test]
fn gaps_down_to_nothing_equal_brute_force() {
    let mut rng = Rng::new(8);
    let shapes = [soups::rock(2, 3), soups::gear(7), soups::bracket()];
    let mut kinds = [0; 3];
    for k in 0..300 {
        let (a, b) = (rng.pick(&shapes).clone(), rng.pick(&shapes).clone());
        let (m, n) = (mesh(&a), mesh(&b));
        let (q, u) = (rng.quat(), rng.unit());
        let mut pose = Pose::new(q, scale(u, a.radius() + b.radius()));
        let target = 10f64.powi(-(k % 13));
        // Moved along the normal to the required gap.
        for _ in 0..3 {
            let found = PairTracker::new().closest(&m, &n, &relative(&pose));
            let n = found.normal.into_inner();
            pose.t = add(pose.t, scale([n.x, n.y, n.z], target - found.distance));
        }
        let state = judge(&mut PairTracker::new(), (&a, &b), (&m, &n), &pose);
        kinds[match state {
            ContactState::Separated => 0,
            ContactState::Touching => 1,
            _ => 2,
        }] += 1;
    }
    assert!(kinds[0] > 200, "{kinds:?}");
}

#[test]
fn soups_and_slivers_are_surfaces_and_equal_brute_force() {
    let mut rng = Rng::new(9);
    let mut apart = 0;
    for k in 0..300 {
        let a = if k % 2 == 0 {
            soups::loose(60, 0.2, &mut rng)
        } else {
            soups::slivers(60, &mut rng)
        };
        let b = if k % 3 == 0 {
            soups::slivers(40, &mut rng)
        } else {
            soups::loose(40, 0.3, &mut rng)
        };
        let (m, n) = (mesh(&a), mesh(&b));
        let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.0, 3.0)));
        let truth = brute::distance(&a, &b, &pose).0;
        let found = PairTracker::new().closest(&m, &n, &relative(&pose));
        let noise = 2e-14 * size(&a, &b, &pose);
        assert_ne!(found.state, ContactState::Overlapping);
        assert!((found.distance - truth).abs() < noise, "{k}: {found:?} {truth}");
        apart += usize::from(found.state == ContactState::Separated);
    }
    assert!(apart > 100, "{apart}");
}

#[test]
fn plates_that_slide_flush_need_no_finer_arithmetic_and_a_short_front() {
    // Vertices lie exactly in planes: they touch, and pierce nothing.
    let plate = soups::plate(19, [1.0, 1.0, 0.05]);
    let m = mesh(&plate);
    let mut tracker = PairTracker::new();
    for k in 0..120 {
        let angle = 0.5f64.to_radians() * f64::from(k);
        let pose = Pose::new(
            quat([0.0, 0.0, 1.0], angle),
            [0.3 * angle.sin(), 0.2 * angle.cos(), 0.1],
        );
        let found = tracker.closest(&m, &m, &relative(&pose));
        assert_eq!((found.state, found.lower), (ContactState::Touching, 0.0), "{k}");
    }
    let w = tracker.work();
    assert_eq!(w.trees.settled, 0, "{w:?}");
    assert!(w.trees.bounds < 150 * w.trees.queries, "{w:?}");
}

#[test]
fn solids_on_two_sides_of_a_plane_take_no_winding_numbers() {
    // The boxes may be tilted, so that the boxes of the whole bodies overlap.
    for n in [5, 10, 19] {
        let plate = soups::plate(n, [1.0, 1.0, 0.05]);
        let m = mesh(&plate);
        for k in 0..40 {
            let angle = 0.05 * f64::from(k);
            let pose = Pose::new(
                quat([0.0, 0.0, 1.0], angle),
                [0.3 * angle.sin(), 0.2 * angle.cos(), 0.1],
            );
            let mut tracker = PairTracker::new();
            let found = tracker.closest(&m, &m, &relative(&pose));
            assert_eq!(found.state, ContactState::Touching, "{n} {k}");
            assert_eq!(tracker.work().trees.windings, 0, "{n} {k}");
        }
    }
}

#[test]
fn powers_of_two_scale_the_answer() {
    let (a, b) = (soups::knot(60, 8, 0.12), soups::gear(12));
    let mut rng = Rng::new(10);
    for k in 0..60 {
        let pose = Pose::new(rng.quat(), scale(rng.unit(), 1.8));
        let answer = |exponent: i32| {
            let s = 2f64.powi(exponent);
            let grown = |soup: &Soup| mesh(&soup.clone().map(|p| scale(p, s)));
            let at = Pose::new(pose.q, scale(pose.t, s));
            let o = PairTracker::new().closest(&grown(&a), &grown(&b), &relative(&at));
            (
                o.state,
                o.distance / s,
                o.lower / s,
                o.upper / s,
                o.locations,
                o.point_on_a.coords / s,
                o.normal,
            )
        };
        let exponents = [-300, -120, -31, 40, 200, 310];
        assert_eq!(answer(0), answer(exponents[k % 6]), "{k}");
    }
}

#[test]
fn far_and_unequal_bodies_are_answered() {
    let a = soups::rock(3, 1);
    let m = mesh(&a);
    for (grow, far) in [
        (1.0, 1e3),
        (1.0, 1e9),
        (1e-4, 2.0),
        (1e-8, 1e-3),
        (1e4, 2e4),
        (1.0, 1e200),
    ] {
        let b = soups::gear(12).map(|p| scale(p, grow));
        let n = mesh(&b);
        let mut tracker = PairTracker::new();
        for k in 0..20 {
            let q = quat([0.0, 1.0, 0.0], 0.01 * f64::from(k));
            let pose = Pose::new(q, [1.5 + far, 0.2, 0.0]);
            let found = tracker.closest(&m, &n, &relative(&pose));
            if far < 1e100 {
                let truth = brute::distance(&a, &b, &pose).0;
                let off = (found.distance - truth).abs();
                assert!(off < 1e-14 * size(&a, &b, &pose), "{grow} {far} {found:?} {truth}");
            }
            assert_eq!(found.state, ContactState::Separated);
        }
        let w = tracker.work();
        assert!(w.trees.measured < 200 * w.trees.queries, "{grow} {far} {w:?}");
    }
}

#[test]
fn what_is_no_mesh_is_refused_and_what_is_dropped_is_named() {
    let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let points = [
        p(0.0, 0.0),
        p(1.0, 0.0),
        p(0.0, 1.0),
        p(1.0, 0.0),
        p(2.0, 0.0),
        p(f64::NAN, 0.0),
    ];
    let answer = Mesh::new(&points, &[[0, 1, 2]]).unwrap_err();
    assert_eq!(answer, MeshError::NotFinite { index: 5 });
    let points = &points[..5];
    let missing = MeshError::IndexOutOfRange { triangle: 1, index: 7 };
    assert_eq!(Mesh::new(points, &[[0, 1, 2], [0, 7, 1]]).unwrap_err(), missing);
    let found = Mesh::new(points, &[[0, 1, 3], [0, 1, 4]]).unwrap_err();
    assert_eq!(found, MeshError::Empty { given: 2 });
    let kept = Mesh::new(points, &[[0, 1, 2], [0, 1, 4], [2, 0, 3], [0, 0, 2]]).unwrap();
    let report = kept.report();
    assert_eq!(&report.degenerate[..], &[1, 3][..]);
    assert_eq!(&report.repeated[..], &[(2, 0)][..]);
    assert_eq!((report.welded, report.unused, report.boundary_edges.len()), (1, 1, 3));
}
