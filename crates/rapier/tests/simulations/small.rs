//! Small bodies of every convex kind under the gravity of the earth: stacked, and thrown on a floor.

use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::{Geometry, PairTracker, RelativePose, Shape};
use truth::rng::Rng;

use super::engine::rapier::prelude::*;
use super::engine::{CertifiedDispatcher, Hull, certified_world};

const GRAVITY: Real = -9.81;

/// A floor of a cuboid, ten sizes wide and a size thick, whose top is at zero.
fn floored(size: Real, step: Real) -> PhysicsWorld {
    let mut world = certified_world(CertifiedDispatcher::default(), size, step);
    world.gravity = Vector::Y * GRAVITY;
    let floor = ColliderBuilder::cuboid(10.0 * size, size, 10.0 * size);
    world.insert(RigidBodyBuilder::fixed().translation(Vector::Y * -size), floor);
    world
}

/// Five boxes of a centimetre on each other: parry's sink by four of their sizes.
#[test]
fn five_boxes_of_a_centimetre_stand() {
    let size: Real = 0.01;
    let mut world = floored(size, 1.0 / 480.0);
    let boxes: Vec<RigidBodyHandle> = (0..5)
        .map(|k| {
            let at = Vector::Y * (k as Real + 0.5) * size;
            let cuboid = ColliderBuilder::cuboid(0.5 * size, 0.5 * size, 0.5 * size);
            world.insert(RigidBodyBuilder::dynamic().translation(at), cuboid).0
        })
        .collect();
    for _ in 0..960 {
        world.step();
        for (k, &handle) in boxes.iter().enumerate() {
            let at = world.bodies[handle].translation() / size;
            let moved = (at - Vector::Y * (k as Real + 0.5)).length();
            assert!(moved < 0.02, "box {k}: {moved} sizes");
        }
    }
}

/// A kind, its shape of the engine and of the core, and the place of the core's in the engine's frame.
struct Kind {
    name: &'static str,
    shape: SharedShape,
    truth: Geometry,
    at: Isometry3<f64>,
}

/// The place of a shape of the core whose axis is z in the frame of one whose axis is y.
fn upright() -> Isometry3<f64> {
    Isometry3::rotation(Vector3::x() * -std::f64::consts::FRAC_PI_2)
}

/// Every convex kind, about `size` wide.
fn kinds(size: Real) -> Vec<Kind> {
    let (half, border, wide) = (0.5 * size, 0.1 * size, f64::from);
    let (inner, thin) = (half - border, 0.3 * size);
    let stone = |size: Real| -> Vec<Vector> {
        let mut rng = Rng::new(5);
        let point = |_| Vector::from(rng.unit().map(|x| x as Real * size));
        (0..14).map(point).collect()
    };
    let hull = |size: Real| Hull::from_points(&stone(size)).expect("a solid");
    let cuboid = |half: Real| Shape::cuboid(Vector3::repeat(wide(half))).expect("a body");
    let cylinder = |half: Real| Shape::cylinder(wide(half), wide(half)).expect("a body");
    let cone = |half: Real| Shape::cone(wide(half), wide(half)).expect("a body");
    let of_hull = |hull: &Hull| Shape::from(hull.body().clone());
    let capsule = Shape::capsule(wide(thin), wide(0.2 * size)).expect("a body");
    let (lying, upright) = (Isometry3::identity(), upright());
    let list = [
        (
            "cuboid",
            lying,
            SharedShape::cuboid(half, half, half),
            cuboid(half),
            0.0,
        ),
        (
            "round cuboid",
            lying,
            SharedShape::round_cuboid(inner, inner, inner, border),
            cuboid(inner),
            border,
        ),
        (
            "ball",
            lying,
            SharedShape::ball(half),
            Shape::ball(wide(half)).expect("a body"),
            0.0,
        ),
        (
            "capsule",
            upright,
            SharedShape::capsule_y(thin, 0.2 * size),
            capsule,
            0.0,
        ),
        (
            "cylinder",
            upright,
            SharedShape::cylinder(half, half),
            cylinder(half),
            0.0,
        ),
        (
            "round cylinder",
            upright,
            SharedShape::round_cylinder(inner, inner, border),
            cylinder(inner),
            border,
        ),
        ("cone", upright, SharedShape::cone(half, half), cone(half), 0.0),
        (
            "round cone",
            upright,
            SharedShape::round_cone(inner, inner, border),
            cone(inner),
            border,
        ),
        ("hull", lying, SharedShape::from(hull(half)), of_hull(&hull(half)), 0.0),
        (
            "round hull",
            lying,
            SharedShape::from(hull(inner).rounded(border).expect("a radius")),
            of_hull(&hull(inner)),
            border,
        ),
    ];
    let placed = |(name, at, shape, core, border): (&'static str, Isometry3<f64>, SharedShape, Shape, Real)| Kind {
        name,
        shape,
        truth: Geometry::from(core.rounded(wide(border)).expect("a radius")),
        at,
    };
    list.into_iter().map(placed).collect()
}

/// Returns the pose of a body of the core.
fn posed(body: &RigidBody, at: &Isometry3<f64>) -> Isometry3<f64> {
    let pose = body.position();
    let [i, j, k, w] = pose.rotation.to_array().map(f64::from);
    let t = pose.translation.to_array().map(f64::from);
    let q = truth::pose::unit_quat([i, j, k, w]);
    truth::Pose::new(q, t).isometry() * at
}

/// The greatest depth of two bodies in each other, or of one in the floor.
fn deepest(kind: &Kind, size: Real, poses: &[Isometry3<f64>]) -> f64 {
    let thick = f64::from(size);
    let floor = Geometry::from(Shape::cuboid(Vector3::new(10.0, 1.0, 10.0) * thick).expect("a body"));
    let below = Isometry3::translation(0.0, -thick, 0.0);
    let mut tracker = PairTracker::new();
    let mut deepest = 0.0f64;
    let mut look = |a: &Geometry, x: &Isometry3<f64>, y: &Isometry3<f64>| {
        let relative = RelativePose::new(x, y).expect("a pose");
        let found = tracker.closest(a, &kind.truth, &relative);
        deepest = deepest.max(-found.lower);
    };
    for (k, x) in poses.iter().enumerate() {
        look(&floor, &below, x);
        for y in &poses[k + 1..] {
            look(&kind.truth, x, y);
        }
    }
    deepest / thick
}

/// Forty bodies of a millimetre that fall on each other come to rest on the floor: none falls
/// through, and none is deeper in another than a fiftieth of its size.
#[test]
fn forty_bodies_of_a_millimetre_rest_on_a_floor() {
    let size: Real = 1e-3;
    for kind in kinds(size) {
        let (mut world, mut rng) = (floored(size, 5e-4), Rng::new(7));
        let bodies: Vec<RigidBodyHandle> = (0..40)
            .map(|k| {
                let [x, y, z] = [k % 3, k / 9, k / 3 % 3].map(|j| 1.8 * j as Real * size);
                let [i, j, k, w] = rng.quat().map(|x| x as Real);
                let turn = Rotation::from_xyzw(i, j, k, w).normalize();
                let pose = Pose::from_parts(Vector::new(x, y + size, z), turn);
                let collider = ColliderBuilder::new(kind.shape.clone()).density(2000.0);
                // Balls would roll on, and meet at a tenth of their size a step.
                let body = RigidBodyBuilder::dynamic().pose(pose).angular_damping(20.0);
                world.insert(body, collider).0
            })
            .collect();
        let mut most = 0.0f64;
        for step in 0..800 {
            world.step();
            if step >= 600 && step % 40 == 0 {
                let poses: Vec<_> = bodies.iter().map(|&h| posed(&world.bodies[h], &kind.at)).collect();
                most = most.max(deepest(&kind, size, &poses));
            }
        }
        let lost = bodies.iter().filter(|&&h| {
            let at = world.bodies[h].translation() / size;
            // What rolled over the rim of the floor was not lost in it.
            at.y < 0.0 && at.x.abs().max(at.z.abs()) < 9.5
        });
        assert_eq!(lost.count(), 0, "{}", kind.name);
        assert!(most < 0.02, "{}: {most} sizes deep", kind.name);
        assert!(most > 1e-6, "{}: bodies must touch", kind.name);
    }
}
