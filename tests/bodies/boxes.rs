//! Promise: the box of a posed body contains it exactly, and is larger only by rounding.

use lin_canny::broad::Aabb;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{BoxHint, ConvexPolyhedron};
use truth::Pose;
use truth::rng::Rng;
use truth::shapes::{self, Shape};

/// Returns whether the exact position of every vertex is between the corners.
fn holds(body: &ConvexPolyhedron, pose: &Pose, low: Point3<f64>, high: Point3<f64>) -> bool {
    let points: Vec<_> = body.vertex_points().map(Into::into).collect();
    let placed = truth::rational::placed(&points, pose);
    let inside = |x: &_, k: usize| *x >= truth::rational::exact(low[k]) && *x <= truth::rational::exact(high[k]);
    placed.iter().all(|p| (0..3).all(|k| inside(&p[k], k)))
}

/// Returns the largest excess of a side of the box over the extent of the vertices.
fn excess(body: &ConvexPolyhedron, pose: &Pose, low: Point3<f64>, high: Point3<f64>) -> f64 {
    let at: Vec<Point3<f64>> = body.vertex_points().map(|p| pose.isometry() * p).collect();
    let worst = |k: usize| {
        let (least, most) = at
            .iter()
            .fold((f64::MAX, f64::MIN), |(l, m), p| (l.min(p[k]), m.max(p[k])));
        (least - low[k]).max(high[k] - most)
    };
    worst(0).max(worst(1)).max(worst(2))
}

fn bodies(rng: &mut Rng) -> Vec<(Shape, ConvexPolyhedron)> {
    let list = vec![
        shapes::cube(),
        shapes::sphere(rng, 31),
        shapes::sphere(rng, 200),
        shapes::ellipsoid(rng, 90, [1.0, 1.0, 1e-3]),
        shapes::needle(rng, 24, 1e-6),
        shapes::prism(80, 1.0, 0.3),
        shapes::sphere(rng, 12).moved(&Pose::shift([1e6, -3e5, 2.0])),
        shapes::sphere(rng, 100).moved(&Pose::shift([1e6, -3e5, 2.0])),
        shapes::sphere(rng, 12).stretched([1e-60; 3]),
        shapes::sphere(rng, 100).stretched([1e60; 3]),
    ];
    let build = |s: &Shape| {
        let points: Vec<Point3<f64>> = s.points.iter().map(|&p| p.into()).collect();
        ConvexPolyhedron::from_points(&points).expect("a solid")
    };
    list.into_iter().map(|s| (build(&s), s)).map(|(b, s)| (s, b)).collect()
}

#[test]
fn boxes_hold_the_body_and_are_tight() {
    let mut rng = Rng::new(77);
    for (shape, body) in bodies(&mut rng) {
        let radius = body.bounding_ball().1;
        let mut hint = BoxHint::default();
        for frame in 0..12 {
            let pose = Pose::new(rng.quat(), rng.unit().map(|c| c * radius * 10f64.powi(frame % 4)));
            let (low, high) = body.aabb_at(&pose.isometry(), &mut hint);
            assert!(holds(&body, &pose, low, high), "{} {pose:?}", shape.name);
            let reach = radius + truth::pose::norm(pose.t) + body.bounding_ball().0.coords.norm();
            // A body within two radii of its origin is measured from the origin.
            let most = 3.3e-6 * radius + 3e-14 * reach;
            let excess = excess(&body, &pose, low, high);
            assert!(excess <= most, "{}: {excess:e} > {most:e}", shape.name);
            let (low, high) = body.cube_at(&pose.isometry());
            assert!(holds(&body, &pose, low, high), "cube of {} {pose:?}", shape.name);
        }
    }
}

/// The rotation of a far body has the rounding error of the whole matrix, even along an axis that
/// hardly depends on it.
#[test]
fn boxes_hold_bodies_far_from_their_own_origin() {
    let mut rng = Rng::new(78);
    let mut thin = 0;
    for k in 0..2000 {
        let away = [1e4, 1e6, 1e9][k % 3];
        let shape = shapes::sphere(&mut rng, [80, 8][k / 3 % 2]);
        let mut points: Vec<Point3<f64>> = shape.points.iter().map(|&p| p.into()).collect();
        points.iter_mut().for_each(|p| p.z += away);
        if k % 5 == 0 {
            points.truncate(1);
        }
        let body = match points[..] {
            [p] => ConvexPolyhedron::point(p).expect("a point"),
            _ => ConvexPolyhedron::from_points(&points).expect("a solid"),
        };
        // About z, then about x or y: along the other axis, z contributes only rounding.
        let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][k % 2];
        let tilt = truth::pose::quat(axis, rng.range(-3.0, 3.0));
        let q = truth::pose::quat_mul(tilt, truth::pose::quat([0.0, 0.0, 1.0], rng.range(-3.0, 3.0)));
        let pose = Pose::new(q, rng.unit());
        let (low, high) = body.aabb_at(&pose.isometry(), &mut BoxHint::default());
        assert!(holds(&body, &pose, low, high), "{k}: {away:e} {pose:?}");
        let (low, high) = body.cube_at(&pose.isometry());
        assert!(holds(&body, &pose, low, high), "cube {k}: {away:e} {pose:?}");
        thin += usize::from(points.len() != 8);
    }
    assert!(thin > 800, "{thin}");
}

#[test]
fn a_stale_hint_changes_no_bit() {
    let mut rng = Rng::new(78);
    let all = bodies(&mut rng);
    let mut foreign = BoxHint::default();
    for k in 0..200 {
        let (_, body) = &all[k % all.len()];
        let pose = Pose::new(rng.quat(), rng.unit()).isometry();
        let found = body.aabb_at(&pose, &mut foreign);
        assert_eq!(found, body.aabb_at(&pose, &mut BoxHint::default()));
    }
}

#[test]
fn a_pose_that_is_no_number_is_a_box_the_broad_phase_refuses() {
    let body = lin_canny::polyhedron::solids::octahedron(1.0).expect("a solid");
    let pose = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let (low, high) = body.aabb_at(&pose, &mut BoxHint::default());
    assert!(Aabb::new(low, high).validate().is_err());
}
