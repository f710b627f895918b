//! Surfaces against convex shapes: closed forms, the tracker of shapes, dense samples.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::BezierSurface;
use lin_canny::{
    ContactState, ConvexPolyhedron, Decision, PairOutcome, PairTracker, QueryOptions, RelativePose, Shape,
};
use truth::rng::Rng;
use truth::support::Decide;

use crate::bodies::{bumpy, place, pose, sphere, tube, vase};

/// Returns every kind of convex shape, of size about one half.
pub(crate) fn kinds() -> Vec<Shape> {
    let axes = Vector3::new(0.5, 0.3, 0.2);
    let made = [
        Shape::ball(0.4),
        Shape::capsule(0.4, 0.2),
        Shape::cuboid(axes),
        Shape::cuboid(axes).and_then(|s| s.rounded(0.1)),
        Shape::cylinder(0.4, 0.3),
        Shape::cone(0.4, 0.3),
        Shape::cone(0.4, 0.3).and_then(|s| s.rounded(0.05)),
        Shape::ellipsoid(axes),
        Ok(Shape::from(solids::random_hull(40, axes, 3).expect("a hull"))),
    ];
    made.into_iter().map(|s| s.expect("a shape")).collect()
}

fn holds(o: &PairOutcome, truth: f64, width: f64) {
    let slack = 4e-15;
    assert!(o.lower <= truth + slack && truth <= o.upper + slack, "{truth:e}: {o:?}");
    assert!(o.is_converged && o.upper - o.lower <= width, "{truth:e}: {o:?}");
}

#[test]
fn balls_about_a_sphere_and_a_cylinder() {
    let mut rng = Rng::new(31);
    let (shell, side) = (sphere(1.0), tube(0.7, 1.2));
    let ball = Shape::ball(0.25).expect("a ball");
    let (mut of_shell, mut of_side) = (PairTracker::new(), PairTracker::new());
    for _ in 0..200 {
        let gap = rng.log_range(1e-9, 3.0);
        let at = place(&mut rng, 1.25 + gap);
        let apart = at.translation.vector.norm();
        holds(
            &of_shell.closest_with(&shell, &ball, &pose(&at), &QueryOptions::default().width(1e-9)),
            apart - 1.25,
            1e-9,
        );
        // In the hollow, off its centre.
        let inside = rng.range(0.2, 0.7);
        let at = place(&mut rng, inside);
        let apart = at.translation.vector.norm();
        holds(
            &of_shell.closest_with(&shell, &ball, &pose(&at), &QueryOptions::default().width(1e-7)),
            0.75 - apart,
            1e-7,
        );
        let apart = rng.range(1.1, 3.0);
        let c = place(&mut rng, apart);
        let t = c.translation.vector;
        let (off, up) = (t.x.hypot(t.y) - 0.7, (t.z.abs() - 1.2).max(0.0));
        let truth = off.hypot(up) - 0.25;
        if truth > 1e-6 {
            holds(
                &of_side.closest_with(&side, &ball, &pose(&c), &QueryOptions::default().width(1e-9)),
                truth,
                1e-9,
            );
        }
    }
}

#[test]
fn a_surface_through_or_within_a_shape_shares_points() {
    let mut rng = Rng::new(32);
    let shell = sphere(0.5);
    for shape in [
        Shape::ball(0.8),
        Shape::cylinder(0.6, 0.7),
        Shape::ellipsoid(Vector3::new(0.9, 0.8, 0.7)),
    ] {
        let shape = shape.expect("a shape");
        let mut tracker = PairTracker::new();
        for k in 0..20 {
            let at = place(&mut rng, 0.02 * f64::from(k));
            let o = tracker.closest_with(&shell, &shape, &pose(&at), &QueryOptions::default().width(1e-9));
            assert_eq!(
                (o.state, o.lower, o.upper, o.distance),
                (ContactState::Overlapping, f64::NEG_INFINITY, 0.0, 0.0),
                "{o:?}"
            );
            assert_eq!(tracker.decide(&shell, &shape, &pose(&at), 0.0), Decision::Yes);
        }
    }
    // Touching: neither answer is proven.
    let ball = Shape::ball(0.5).expect("a ball");
    let mut tracker = PairTracker::new();
    let at = |x: f64| pose(&Isometry3::translation(0.6 * x, 0.8 * x, 0.0));
    assert!(matches!(
        tracker.decide(&shell, &ball, &at(1.0), 0.0),
        Decision::Undecided { .. }
    ));
    assert_eq!(tracker.decide(&shell, &ball, &at(1.0 + 1e-9), 0.0), Decision::No);
    assert_eq!(tracker.decide(&shell, &ball, &at(1.0 - 1e-9), 0.0), Decision::Yes);
    assert_eq!(tracker.decide(&shell, &ball, &at(1.5), 0.5 + 1e-9), Decision::Yes);
    assert_eq!(tracker.decide(&shell, &ball, &at(1.5), 0.5 - 1e-9), Decision::No);
    assert_eq!(tracker.decide(&shell, &ball, &at(1.5), -1.0), Decision::No);
}

/// The boundary of a polyhedron as flat patches, against the tracker of the solid.
#[test]
fn flat_patches_are_polyhedra() {
    let mut rng = Rng::new(33);
    let gem = solids::icosahedron(0.6).expect("a body");
    let surface = BezierSurface::from_convex(&gem).expect("faces");
    let solid = Shape::from(gem);
    let mut apart = 0;
    for shape in kinds() {
        let mut tracker = PairTracker::new();
        for _ in 0..25 {
            let far = rng.range(0.9, 2.0);
            let at = place(&mut rng, far);
            let truth = PairTracker::new().closest(&solid, &shape, &pose(&at));
            let o = tracker.closest_with(&surface, &shape, &pose(&at), &QueryOptions::default().width(1e-9));
            if truth.state == ContactState::Separated {
                apart += 1;
                assert!(o.is_converged, "{truth:?} {o:?}");
                assert!(o.lower <= truth.upper, "{truth:?} {o:?}");
                assert!(truth.lower <= o.upper, "{truth:?} {o:?}");
                assert!(
                    o.normal.dot(&truth.normal) > 1.0 - 1e-6 || truth.distance < 1e-3,
                    "{truth:?} {o:?}"
                );
            }
        }
    }
    assert!(apart > 150, "{apart}");
}

/// Returns the least distance of a grid of points of a surface, by the tracker of shapes.
pub(crate) fn sampled(a: &BezierSurface, b: &Shape, at: &RelativePose, n: usize) -> f64 {
    let point = Shape::from(ConvexPolyhedron::point(Point3::origin()).expect("a point"));
    let (pose_a, pose_b) = at.poses();
    let mut tracker = PairTracker::new();
    let mut least = f64::INFINITY;
    for patch in a.patches() {
        for k in 0..=n * (n + 2) {
            let p = patch.point((k / (n + 1)) as f64 / n as f64, (k % (n + 1)) as f64 / n as f64);
            let on = pose_a * Isometry3::from(p.coords);
            let at = RelativePose::new(&on, &pose_b).expect("a pose");
            least = least.min(tracker.distance(&point, b, &at).value);
        }
    }
    least
}

#[test]
fn no_sample_is_closer_than_the_lower_bound() {
    let mut rng = Rng::new(34);
    let (mut wide, mut overlaps, mut count) = (0, 0, 0);
    for (k, shape) in kinds().iter().enumerate() {
        for degrees in [[3, 3], [2, 4], [1, 2]] {
            let surface = BezierSurface::new(vec![bumpy(&mut rng, degrees, 0.6)]).expect("a surface");
            let mut warm = PairTracker::new();
            for _ in 0..4 {
                count += 1;
                let far = rng.range(0.2, 2.5);
                let at = pose(&place(&mut rng, far));
                let least = sampled(&surface, shape, &at, 24);
                let o = warm.closest_with(&surface, shape, &at, &QueryOptions::default().width(1e-9));
                let cold = PairTracker::new().closest_with(&surface, shape, &at, &QueryOptions::default().width(1e-9));
                assert!(o.lower <= cold.upper && cold.lower <= o.upper, "{k}: {o:?} {cold:?}");
                assert!(o.lower <= least.max(0.0) + 1e-14, "{k}: {least} {o:?}");
                // Every point of the surface is within about 0.1 of a sample.
                assert!(o.upper >= least.max(0.0) - 0.15, "{k}: {least} {o:?}");
                if o.is_converged {
                    assert!(o.upper <= least.max(0.0) + 1e-9, "{k}: {least} {o:?}");
                }
                if least < -1e-9 {
                    assert_eq!(o.state, ContactState::Overlapping, "{k}: {least} {o:?}");
                }
                overlaps += usize::from(o.state == ContactState::Overlapping);
                wide += usize::from(!o.is_converged);
            }
        }
    }
    println!("{count}: {overlaps} overlap, {wide} not reached");
    assert!(wide * 20 <= count && overlaps > 5, "{wide} {overlaps}");
}

/// A ball as a surface and as a shape.
#[test]
fn a_ball_of_patches_is_a_ball() {
    let mut rng = Rng::new(35);
    let (a, patches, ball) = (vase(), sphere(0.5), Shape::ball(0.5).expect("a ball"));
    let mut tracker = PairTracker::new();
    let mut splits = 0;
    for _ in 0..20 {
        let far = rng.range(2.0, 3.0);
        let at = pose(&place(&mut rng, far));
        let o = PairTracker::new().closest_with(&a, &patches, &at, &QueryOptions::default().width(1e-9));
        let p = tracker.closest_with(&a, &ball, &at, &QueryOptions::default().width(1e-9));
        assert!(o.is_converged && p.is_converged, "{o:?} {p:?}");
        assert!(
            o.state != ContactState::Separated || o.lower <= p.upper + 1e-15 && p.lower <= o.upper + 1e-15,
            "{o:?} {p:?}"
        );
        splits += tracker.work().surfaces.splits;
        assert!(tracker.front_len() > 0);
        tracker.reset();
    }
    println!("{splits} splits of 20 cold queries");
}

#[test]
fn far_and_tiny_pairs_have_bounds() {
    let shell = sphere(1.0);
    let ball = Shape::ball(0.5).expect("a ball");
    let mut tracker = PairTracker::new();
    for x in [1e90, 1e150, 1e300] {
        let at = pose(&Isometry3::translation(x, 0.0, 0.0));
        let o = tracker.closest_with(&shell, &ball, &at, &QueryOptions::default().width(1e-9));
        assert!(o.lower <= x, "{o:?}");
        assert!(x * (1.0 - 1e-12) <= o.upper, "{o:?}");
        assert!(o.lower > 0.9 * x, "{o:?}");
    }
    for width in [0.0, -1.0, f64::NAN] {
        let at = pose(&Isometry3::translation(2.5, 0.3, 0.1));
        let o = PairTracker::new().closest_with(&shell, &ball, &at, &QueryOptions::default().width(width));
        assert!(!o.is_converged && o.upper - o.lower < 1e-11, "{o:?}");
    }
    let huge = Shape::ball(1e80).expect("a ball");
    let at = pose(&Isometry3::translation(1.5e80, 0.0, 0.0));
    let o = tracker.closest_with(&shell, &huge, &at, &QueryOptions::default().width(1e-9));
    assert!(o.lower > 0.4e80 && o.upper < 0.6e80, "{o:?}");
    let o = PairTracker::new().closest_with(
        &vase(),
        &ball,
        &pose(&Isometry3::translation(3.0, 0.0, 0.0)),
        &QueryOptions::default().width(1e-9).splits(0),
    );
    assert!(!o.is_converged && o.lower <= o.upper, "{o:?}");
}
