//! Closed forms: spheres, cylinders, boxes.

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{ContactState, PairOutcome, PairTracker, QueryOptions, RelativePose, Shape, Tracker};
use truth::rng::Rng;

use crate::bodies::{place, pose, sphere, tube};

/// Relative error of the roundness of circles of rational patches.
const ROUND: f64 = 1e-15;

fn holds(o: &PairOutcome, truth: f64, width: f64) {
    let slack = 4.0 * ROUND;
    assert!(o.lower <= truth + slack && truth <= o.upper + slack, "{truth:e}: {o:?}");
    assert!(o.is_converged && o.upper - o.lower <= width, "{truth:e}: {o:?}");
}

#[test]
fn spheres_apart_and_one_in_the_other() {
    let mut rng = Rng::new(3);
    let (a, b) = (sphere(1.0), sphere(0.5));
    assert!(a.is_closed() && !tube(1.0, 1.0).is_closed());
    let mut tracker = PairTracker::new();
    for _ in 0..100 {
        let gap = rng.log_range(1e-9, 3.0);
        let at = place(&mut rng, 1.5 + gap);
        let apart = at.translation.vector.norm();
        holds(
            &tracker.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-9)),
            apart - 1.5,
            1e-9,
        );
        // One in the hollow of the other, off its centre.
        let apart = rng.range(0.2, 0.45);
        let at = place(&mut rng, apart);
        let apart = at.translation.vector.norm();
        holds(
            &tracker.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-7)),
            0.5 - apart,
            1e-7,
        );
    }
}

#[test]
fn a_sphere_and_the_side_of_a_cylinder() {
    let mut rng = Rng::new(4);
    let (side, ball) = (tube(0.7, 1.2), sphere(0.25));
    for _ in 0..100 {
        let apart = rng.range(1.1, 3.0);
        let at = place(&mut rng, apart);
        let c = at.translation.vector;
        let (off, up) = (c.x.hypot(c.y) - 0.7, (c.z.abs() - 1.2).max(0.0));
        let truth = off.hypot(up) - 0.25;
        if truth > 1e-6 {
            holds(
                &PairTracker::new().closest_with(&side, &ball, &pose(&at), &QueryOptions::default().width(1e-9)),
                truth,
                1e-9,
            );
        }
    }
}

#[test]
fn flat_patches_are_polyhedra() {
    let mut rng = Rng::new(5);
    let die = solids::cuboid(Vector3::new(0.5, 0.7, 0.3)).expect("a box");
    let gem = solids::octahedron(0.8).expect("an octahedron");
    let a = BezierSurface::from_convex(&die).expect("faces");
    let b = BezierSurface::from_convex(&gem).expect("faces");
    assert!(a.is_closed() && b.is_closed());
    let ball = sphere(0.8);
    let round = Shape::ball(0.8).expect("a ball");
    let die_shape = Shape::from(die.clone());
    let (mut warm, mut warm_ball) = (PairTracker::new(), PairTracker::new());
    for _ in 0..60 {
        let apart = rng.range(1.2, 3.0);
        let at = place(&mut rng, apart);
        let truth = Tracker::new().closest(&die, &gem, &pose(&at));
        let o = warm.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-9));
        if truth.state == ContactState::Separated {
            assert!(o.is_converged, "{truth:?} {o:?}");
            assert!(o.lower <= truth.upper, "{truth:?} {o:?}");
            assert!(truth.lower <= o.upper, "{truth:?} {o:?}");
        }
        let truth = PairTracker::new().closest(&die_shape, &round, &pose(&at));
        let o = warm_ball.closest_with(&a, &ball, &pose(&at), &QueryOptions::default().width(1e-9));
        if truth.state == ContactState::Separated {
            let slack = ROUND;
            assert!(o.is_converged, "{truth:?} {o:?}");
            assert!(o.lower <= truth.upper + slack, "{truth:?} {o:?}");
            assert!(truth.lower <= o.upper + slack, "{truth:?} {o:?}");
        }
    }
}

#[test]
fn flush_faces_are_no_harder() {
    let die = solids::cuboid(Vector3::repeat(0.5)).expect("a box");
    let a = BezierSurface::from_convex(&die).expect("faces");
    for gap in [1e-12, 1e-6, 0.1] {
        let at = Isometry3::translation(0.2, 0.3, 1.0 + gap);
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&a, &a, &pose(&at), &QueryOptions::default().width(1e-11));
        assert!(o.is_converged, "{o:?}");
        assert!((o.distance - at.translation.z + 1.0).abs() < 1e-11, "{o:?}");
        assert!(tracker.work().surfaces.splits < 1000, "{:?}", tracker.work());
    }
}

#[test]
fn a_cylinder_lies_along_a_plane() {
    let side = tube(0.5, 1.0);
    let corners = [[-2.0, -2.0], [-2.0, 2.0], [2.0, -2.0], [2.0, 2.0]].map(|[x, y]| Point3::new(x, y, 0.0));
    let floor =
        BezierSurface::new(vec![BezierPatch::polynomial([1, 1], &corners).expect("a square")]).expect("a floor");
    let lying = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    for gap in [0.0, 1e-9, 1e-3] {
        let at = Isometry3::from_parts(Translation3::new(0.1, 0.2, 0.5 + gap), lying);
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&floor, &side, &pose(&at), &QueryOptions::default().width(1e-9));
        holds(&o, at.translation.z - 0.5, 1e-9);
        assert!(tracker.work().surfaces.splits < 2000, "{:?}", tracker.work());
    }
}

#[test]
fn default_bounds_converge_at_any_distance() {
    let at = |k: usize| {
        let (x, y) = ((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0);
        Point3::new(x, y, -x.abs() - y.abs())
    };
    let points: Vec<_> = (0..9).map(at).collect();
    let patch = BezierPatch::polynomial([2, 2], &points).expect("a patch");
    let dome = BezierSurface::new(vec![patch]).expect("a dome");
    let ball = Shape::ball(0.5).expect("a ball");
    for exponent in 0..17 {
        let z = 10f64.powi(exponent) + 2.0;
        let pose = Isometry3::translation(0.1 * z, 0.2, z);
        let pose = RelativePose::from_isometry(&pose).expect("a pose");
        let of_ball = PairTracker::new().closest(&dome, &ball, &pose);
        let of_dome = PairTracker::new().closest(&dome, &dome, &pose);
        for found in [of_ball, of_dome] {
            let width = found.upper - found.lower;
            assert!(found.is_converged, "{z:e}: {found:?}");
            assert!(width <= 1e-8 + 4e-12 * 1.2 * z, "{z:e}: {found:?}");
        }
    }
}
