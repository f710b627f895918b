//! What stays with parry's closed forms, at every size: half-spaces, balls, balls and cuboids.

use lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use truth::rng::Rng;

use super::dispatch::random_pose;
use super::engine::parry::math::{Pose, Real, Rotation, Vector};
use super::engine::parry::query::{ClosestPoints, ContactManifold, PersistentQueryDispatcher, QueryDispatcher};
use super::engine::parry::shape::{Ball, Cuboid, HalfSpace, Shape, SharedShape};
use super::engine::{CertifiedDispatcher, Hull, isometry};

type Manifolds = Vec<ContactManifold<(), ()>>;

/// The height of a core along a unit direction of its own frame.
type Reach = Box<dyn Fn(&Vector3<f64>) -> f64>;

const SIZES: [Real; 9] = [1e-4, 1e-3, 5e-3, 1e-2, 2e-2, 0.1, 1.0, 100.0, 1e4];

/// A shape, and how far its core reaches along a direction of its own frame; its border.
struct Reached {
    name: &'static str,
    shape: SharedShape,
    reach: Reach,
    border: f64,
}

fn wide(p: Vector) -> Vector3<f64> {
    Vector3::from(p.to_array().map(f64::from))
}

fn of_points(points: Vec<Vector>) -> Reach {
    Box::new(move |n| points.iter().map(|&p| wide(p).dot(n)).fold(f64::NEG_INFINITY, f64::max))
}

fn of_cylinder(half: Real, radius: Real) -> Reach {
    let (half, radius) = (f64::from(half), f64::from(radius));
    Box::new(move |n| half * n.y.abs() + radius * n.x.hypot(n.z))
}

fn of_cone(half: Real, radius: Real) -> Reach {
    let (half, radius) = (f64::from(half), f64::from(radius));
    Box::new(move |n| (half * n.y).max(radius * n.x.hypot(n.z) - half * n.y))
}

/// Every convex kind of a size.
fn reached(rng: &mut Rng, size: Real) -> Vec<Reached> {
    let mut side = || size * rng.range(0.2, 0.6) as Real;
    let (half, h, r, border) = (Vector::new(side(), side(), side()), side(), side(), 0.2 * size);
    let corner = |k: u32| Vector::from([0, 1, 2].map(|bit| if k >> bit & 1 == 0 { -1.0 } else { 1.0 })) * half;
    let corners: Vec<Vector> = (0..8).map(corner).collect();
    let hull = Hull::from_points(&corners).expect("a solid");
    let plain = || SharedShape::convex_hull(&corners).expect("a hull");
    let [a, b, c] = [0; 3].map(|_| Vector::from(rng.unit().map(|x| 0.6 * x as Real)) * size);
    let polyhedral = |name, shape, points: &[Vector], border: Real| Reached {
        name,
        shape,
        reach: of_points(points.to_vec()),
        border: f64::from(border),
    };
    let curved = |name, shape, reach, border: Real| Reached {
        name,
        shape,
        reach,
        border: f64::from(border),
    };
    let (x, y, z) = (half.x, half.y, half.z);
    vec![
        polyhedral("ball", SharedShape::ball(r), &[Vector::ZERO], r),
        polyhedral("capsule", SharedShape::capsule(a, b, r), &[a, b], r),
        polyhedral("segment", SharedShape::segment(a, b), &[a, b], 0.0),
        polyhedral("triangle", SharedShape::triangle(a, b, c), &[a, b, c], 0.0),
        polyhedral(
            "round triangle",
            SharedShape::round_triangle(a, b, c, border),
            &[a, b, c],
            border,
        ),
        polyhedral("cuboid", SharedShape::cuboid(x, y, z), &corners, 0.0),
        polyhedral(
            "round cuboid",
            SharedShape::round_cuboid(x, y, z, border),
            &corners,
            border,
        ),
        polyhedral("plain", plain(), &corners, 0.0),
        polyhedral("hull", SharedShape::from(hull.clone()), &corners, 0.0),
        polyhedral(
            "round hull",
            SharedShape::from(hull.rounded(border).expect("a radius")),
            &corners,
            border,
        ),
        curved("cylinder", SharedShape::cylinder(h, r), of_cylinder(h, r), 0.0),
        curved(
            "round cylinder",
            SharedShape::round_cylinder(h, r, border),
            of_cylinder(h, r),
            border,
        ),
        curved("cone", SharedShape::cone(h, r), of_cone(h, r), 0.0),
        curved(
            "round cone",
            SharedShape::round_cone(h, r, border),
            of_cone(h, r),
            border,
        ),
    ]
}

/// A pair, the signed distance in `f64`, and what is near enough to it.
struct Case {
    what: (&'static str, Real),
    truth: f64,
    close: f64,
}

/// Checks all queries but casts, in both orders.
fn check(what: (&'static str, Real), pos12: Pose, [a, b]: [&dyn Shape; 2], truth: f64, close: f64) {
    let case = Case { what, truth, close };
    case.check_order(&pos12, a, b);
    case.check_order(&pos12.inverse(), b, a);
}

impl Case {
    fn check_order(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) {
        let Self { what, truth, close } = *self;
        let (ours, size) = (CertifiedDispatcher::default(), what.1);
        let gap = f64::from(ours.distance(pos12, a, b).expect("supported").distance);
        assert!((gap - truth.max(0.0)).abs() < close, "{what:?}: {gap:e} for {truth:e}");
        let contact = ours.contact(pos12, a, b, 10.0 * size).expect("supported");
        let dist = f64::from(contact.expect("within").dist);
        assert!((dist - truth).abs() < close, "{what:?}: {dist:e} for {truth:e}");
        let meets = ours.intersection_test(pos12, a, b).expect("supported").intersecting;
        assert!(
            meets == (truth < 0.0) || truth.abs() < close,
            "{what:?}: {meets} at {truth:e}"
        );
        let points = ours.closest_points(pos12, a, b, 10.0 * size).expect("supported");
        let are_apart = matches!(points, ClosestPoints::WithinMargin(..));
        assert!(
            are_apart == (truth > 0.0) || truth.abs() < close,
            "{what:?}: {points:?} at {truth:e}"
        );
        self.check_manifold(pos12, a, b);
    }

    fn check_manifold(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) {
        let Self { what, truth, close } = *self;
        let (mut kept, prediction) = (Manifolds::new(), 0.05 * what.1);
        CertifiedDispatcher::default()
            .contact_manifolds(pos12, a, b, prediction, &mut kept, &mut None)
            .expect("supported");
        let Some(deepest) = kept[0].find_deepest_contact().map(|p| f64::from(p.dist)) else {
            assert!(truth > f64::from(prediction) - close, "{what:?}: none at {truth:e}");
            return;
        };
        assert!((deepest - truth).abs() < close, "{what:?}: {deepest:e} for {truth:e}");
        for p in &kept[0].points {
            let apart = f64::from((pos12 * p.local_p2 - p.local_p1).dot(kept[0].local_n1));
            assert!((apart - f64::from(p.dist)).abs() < close, "{what:?}: {apart:e} {p:?}");
        }
    }
}

/// The lowest point of a shape over a half-space is its height.
#[test]
fn half_spaces_are_right_at_any_size() {
    let (mut deep, mut near) = (0, 0);
    for size in SIZES {
        let mut rng = Rng::new(71);
        for round in 0..60 {
            let normal = Vector::from(rng.unit().map(|x| x as Real)).normalize();
            let space = HalfSpace::new(normal);
            for Reached {
                name,
                shape,
                reach,
                border,
            } in reached(&mut rng, size)
            {
                let turned = random_pose(&mut rng, f64::from(size)).rotation;
                // Every third lies flat, stands, or leans by little.
                let turned = match round % 3 {
                    0 => Rotation::from_rotation_arc(Vector::Y, normal),
                    _ => turned,
                };
                let below = isometry(&Pose::from_parts(Vector::ZERO, turned)).inverse_transform_vector(&-wide(normal));
                let low = reach(&below.normalize()) + border;
                let height = low + f64::from(size) * rng.range(-0.2, 0.2);
                let pos12 = Pose::from_parts(normal * height as Real, turned);
                let at: Isometry3<f64> = isometry(&pos12);
                let n = wide(normal).normalize();
                let truth = at.translation.vector.dot(&n) - low;
                let (what, close) = ((name, size), 4e-6 * f64::from(size));
                let shapes: [&dyn Shape; 2] = [&space, &*shape];
                check(what, pos12, shapes, truth, close);
                deep += usize::from(truth < 0.0);
                near += usize::from(truth > 0.0 && truth < 0.05 * f64::from(size));
            }
        }
    }
    assert!(deep > 2000 && near > 500, "{deep} {near}");
}

/// Balls, and a ball and a cuboid, from deep inside to apart.
#[test]
fn balls_and_cuboids_are_right_at_any_size() {
    let mut deep = 0;
    for size in SIZES {
        let mut rng = Rng::new(72);
        for _ in 0..300 {
            let mut side = || size * rng.range(0.2, 0.6) as Real;
            let (half, r, s) = (Vector::new(side(), side(), side()), side(), side());
            let apart = f64::from(size) * rng.range(0.0, 1.2);
            let pos12 = random_pose(&mut rng, apart);
            let (at, h) = (wide(pos12.translation), wide(half));
            let close = 4e-6 * f64::from(size);
            let out = at.abs() - h;
            let outside = out.map(|x| x.max(0.0)).norm();
            let of_cuboid = if outside > 0.0 { outside } else { out.max() } - f64::from(r);
            let of_ball = at.norm() - f64::from(r) - f64::from(s);
            let (cuboid, ball, other) = (Cuboid::new(half), Ball::new(r), Ball::new(s));
            for (name, first, truth) in [("cuboid", &cuboid as &dyn Shape, of_cuboid), ("ball", &other, of_ball)] {
                let (what, shapes) = ((name, size), [first, &ball as &dyn Shape]);
                check(what, pos12, shapes, truth, close);
                deep += usize::from(truth < 0.0);
            }
        }
    }
    assert!(deep > 1000, "{deep}");
}
