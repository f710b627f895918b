//! Numbers of every kind: an answer or `Unsupported`, never a panic, and never without end.

use truth::rng::Rng;

use super::engine::parry::math::{Pose, Real, Rotation, Vector};
use super::engine::parry::query::details::ShapeCastOptions;
use super::engine::parry::query::{
    ClosestPoints, Contact, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher,
};
use super::engine::parry::shape::{
    Ball, Capsule, Compound, Cone, ConvexPolyhedron, Cuboid, Cylinder, HalfSpace, HeightField, RoundShape, Segment,
    Shape, SharedShape, TriMesh, Triangle, Voxels,
};
use super::engine::parry::utils::Array2;
use super::engine::{CertifiedDispatcher, Hull};

/// A number of the engine: half of them ordinary, the others at the ends of its range or none.
fn number(rng: &mut Rng) -> Real {
    let extremes = [
        0.0,
        -0.0,
        Real::from_bits(1),
        Real::MIN_POSITIVE,
        1.2 * Real::MIN_POSITIVE,
        1e-38,
        1e-30,
        1e-20,
        1e-10,
        1e-5,
        1e5,
        1e9,
        1e15,
        1e20,
        1e30,
        Real::MAX.sqrt(),
        Real::MAX.sqrt().sqrt(),
        Real::MIN_POSITIVE.sqrt(),
        Real::MAX,
        Real::INFINITY,
        Real::NAN,
    ];
    let sign = if rng.chance(0.25) { -1.0 } else { 1.0 };
    let ordinary = rng.range(0.1, 2.0) as Real;
    let k = rng.below(2 * extremes.len());
    sign * extremes.get(k).copied().unwrap_or(ordinary)
}

/// One number for most of a shape, or each of its own.
fn vector(rng: &mut Rng) -> Vector {
    let (x, kind) = (number(rng), rng.below(4));
    match kind {
        0 => Vector::splat(x),
        1 => Vector::from(rng.unit().map(|c| c as Real)) * x.abs(),
        2 => Vector::from(rng.unit().map(|c| c as Real)),
        _ => Vector::new(x, number(rng), number(rng)),
    }
}

fn pose(rng: &mut Rng) -> Pose {
    let turn = match rng.below(8) {
        0 => Rotation::from_xyzw(0.0, 0.0, 0.0, 0.0),
        1 => Rotation::from_xyzw(number(rng), number(rng), number(rng), number(rng)),
        2 | 3 => Rotation::IDENTITY,
        _ => {
            let [x, y, z, w] = rng.quat().map(|x| x as Real);
            Rotation::from_xyzw(x, y, z, w)
        }
    };
    let at = match rng.below(3) {
        0 => Vector::ZERO,
        1 => vector(rng) * 0.1,
        _ => vector(rng),
    };
    Pose::from_parts(at, turn)
}

/// Number of kinds of [`shape`].
const KINDS: usize = 20;

/// Times that every pair of kinds is drawn.
const ROUNDS: usize = 6;

/// A shape of a kind; `None` if parry or this crate makes none of the numbers drawn.
fn shape(rng: &mut Rng, kind: usize) -> Option<SharedShape> {
    let (size, other) = (vector(rng), number(rng));
    let x = size.x;
    let corners = [Vector::ZERO, Vector::X * size.x, Vector::Y * size.y, Vector::Z * size.z];
    let solid = || ConvexPolyhedron::from_convex_mesh(corners.to_vec(), &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
    let border = |x: Real| x.abs().min(1e30);
    // parry's builders of these assert on numbers that are none.
    let is_plain = corners.iter().all(|c| c.is_finite()) && other.is_finite();
    Some(match kind {
        0 => SharedShape::new(Ball::new(x)),
        1 => SharedShape::new(Cuboid::new(size)),
        2 => SharedShape::new(Capsule::new(corners[1], corners[2], other)),
        3 => SharedShape::new(Cylinder {
            half_height: x,
            radius: other,
        }),
        4 => SharedShape::new(Cone::new(x, other)),
        5 => SharedShape::new(HalfSpace::new(size)),
        6 => SharedShape::new(HalfSpace::new(Vector::Y)),
        7 => SharedShape::new(Triangle::new(corners[1], corners[2], corners[3])),
        8 => SharedShape::new(Segment::new(corners[1], corners[2])),
        9 => SharedShape::new(RoundShape {
            inner_shape: Triangle::new(corners[1], corners[2], corners[3]),
            border_radius: other,
        }),
        10 if is_plain => SharedShape::new(solid()?),
        11 => SharedShape::from(Hull::from_points(&corners).ok()?),
        12 => SharedShape::new(RoundShape {
            inner_shape: Cuboid::new(size),
            border_radius: other,
        }),
        13 => SharedShape::new(RoundShape {
            inner_shape: Cylinder {
                half_height: x,
                radius: size.y,
            },
            border_radius: other,
        }),
        14 => SharedShape::new(RoundShape {
            inner_shape: Cone::new(x, size.y),
            border_radius: border(other),
        }),
        15 if is_plain => SharedShape::new(RoundShape {
            inner_shape: solid()?,
            border_radius: other,
        }),
        16 if is_plain => {
            let part = Cuboid::new(size.abs());
            let pose = Pose::from_translation(vector(rng).clamp(-Vector::splat(1e30), Vector::splat(1e30)));
            SharedShape::new(Compound::new(vec![
                (Pose::IDENTITY, SharedShape::new(part)),
                (pose, SharedShape::new(Ball::new(other.abs()))),
            ]))
        }
        17 if is_plain => {
            let mesh = TriMesh::new(corners.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
            SharedShape::new(mesh.ok()?)
        }
        18 if is_plain => {
            let heights = Array2::new(3, 3, vec![other.clamp(-1e30, 1e30); 9]);
            SharedShape::new(HeightField::new(heights, size.abs()))
        }
        19 if is_plain => SharedShape::new(Voxels::new(Vector::splat(0.5), &[Default::default()])),
        _ => return None,
    })
}

/// An ordinary shape of a kind, so that one number out of range at a time meets sound code.
fn ordinary(rng: &mut Rng) -> SharedShape {
    let list = super::dispatch::kinds(rng, 1.0);
    list[rng.below(list.len())].clone()
}

/// Asks everything of a pair once.
fn ask(ours: &CertifiedDispatcher, pose: &Pose, a: &dyn Shape, b: &dyn Shape, rng: &mut Rng) -> usize {
    let mut kept: Vec<ContactManifold<(), ()>> = Vec::new();
    let mut answered = 0;
    for _ in 0..2 {
        let made = ours.contact_manifolds(pose, a, b, number(rng), &mut kept, &mut None);
        answered += usize::from(made.is_ok());
    }
    let _ = ours.distance(pose, a, b);
    let _ = ours.intersection_test(pose, a, b);
    let (prediction, most) = (number(rng), number(rng));
    if let Ok(Some(Contact { dist, .. })) = ours.contact(pose, a, b, prediction) {
        assert!(dist <= prediction, "{dist} for {prediction}");
    }
    if let Ok(ClosestPoints::WithinMargin(..)) = ours.closest_points(pose, a, b, most) {
        assert!(most >= 0.0, "points within {most}");
    }
    let options = ShapeCastOptions {
        max_time_of_impact: number(rng),
        target_distance: if rng.chance(0.5) { 0.0 } else { number(rng) },
        stop_at_penetration: rng.chance(0.5),
        ..ShapeCastOptions::default()
    };
    let _ = ours.cast_shapes(pose, vector(rng), a, b, options);
    // Casts of more turns end too, after as many looks as a cast may take: seconds each.
    let spin = vector(rng);
    let spin = if spin.is_finite() {
        spin.clamp_length_max(100.0)
    } else {
        spin
    };
    let motion = NonlinearRigidMotion::new(*pose, vector(rng), vector(rng), spin);
    let rest = NonlinearRigidMotion::identity();
    let (start, end) = match rng.below(3) {
        0 => (0.0, 1.0),
        1 => (0.0, number(rng).min(100.0)),
        _ => (number(rng), number(rng)),
    };
    let stop = rng.chance(0.5);
    let _ = ours.cast_shapes_nonlinear(&rest, a, &motion, b, start, end, stop);
    answered
}

/// Poses, shapes, predictions, velocities and times of any kind.
#[test]
fn no_query_panics() {
    let mut rng = Rng::new(16);
    let ours = CertifiedDispatcher::default();
    let mut answered = 0;
    for round in 0..ROUNDS {
        for kind in 0..KINDS * KINDS {
            let (Some(a), Some(b)) = (shape(&mut rng, kind / KINDS), shape(&mut rng, kind % KINDS)) else {
                continue;
            };
            let a = if round % 3 == 1 { ordinary(&mut rng) } else { a };
            let b = if round % 3 == 2 { ordinary(&mut rng) } else { b };
            let pose = if rng.chance(0.3) {
                Pose::translation(0.5, 0.2, 0.1)
            } else {
                pose(&mut rng)
            };
            answered += ask(&ours, &pose, &*a, &*b, &mut rng);
        }
    }
    assert!(answered > 1000, "{answered}");
}

/// Predictions below zero ask for overlaps as deep, of parts of compounds as of other shapes.
#[test]
fn negative_predictions_ask_for_depth() {
    let cuboid = SharedShape::new(Cuboid::new(Vector::splat(0.5)));
    let compound = Compound::new(vec![(Pose::translation(0.0, 0.25, 0.0), cuboid.clone())]);
    let ours = CertifiedDispatcher::default();
    let (ball, space) = (Ball::new(0.5), HalfSpace::new(Vector::Y));
    let above = Pose::translation(0.0, 1.05, 0.0);
    for (prediction, is_found) in [(-0.1, true), (-0.19, true), (-0.21, false), (Real::NAN, false)] {
        let found = ours.contact(&above, &compound, &ball, prediction).expect("supported");
        assert_eq!(found.is_some(), is_found, "{prediction}: {found:?}");
        let low = Pose::translation(0.0, 0.3, 0.0);
        let found = ours.contact(&low, &space, &ball, prediction).expect("supported");
        assert_eq!(found.is_some(), is_found, "{prediction}: {found:?}");
    }
    let high = Pose::translation(0.0, 2.0, 0.0);
    for (most, is_found) in [(-1.0, false), (Real::NAN, false), (1.0, false), (1.6, true)] {
        for (shape, pose) in [
            (&space as &dyn Shape, &high),
            (&compound, &Pose::translation(0.0, 2.75, 0.0)),
        ] {
            let found = ours.closest_points(pose, shape, &ball, most).expect("supported");
            let answer = matches!(found, ClosestPoints::WithinMargin(..));
            assert_eq!(answer, is_found, "{most}: {found:?}");
        }
    }
}

/// parry's own searches of a cast end with the default options and at any time of the clock: along
/// the cells of a field, to an instant late on the clock, after a penetration at a great speed.
#[test]
fn casts_of_parry_end() {
    let ours = CertifiedDispatcher::default();
    let (ball, x) = (Ball::new(0.5), NonlinearRigidMotion::identity());
    let field = HeightField::new(Array2::new(5, 5, vec![0.0; 25]), Vector::new(4.0, 1.0, 4.0));
    for velocity in [
        Vector::new(0.0, -1e-3, 1.0),
        Vector::new(0.0, 1e-3, 1.0),
        Vector::new(1.0, 1.0, 0.0),
    ] {
        let options = ShapeCastOptions::default();
        let past = Pose::translation(0.0, 0.6, -1.0);
        let hit = ours
            .cast_shapes(&past, velocity, &field, &ball, options)
            .expect("supported");
        assert!(hit.is_none(), "{velocity:?}: {hit:?}");
    }
    let triangle = Triangle::new(Vector::X, Vector::Z, -Vector::X - Vector::Z);
    for late in [0.0, 10.0, 40.0, 1000.0] {
        let speed = Vector::Y * -1.0;
        let above = Pose::translation(0.0, 2.0 + late, 0.0);
        let y = NonlinearRigidMotion::new(above, Vector::ZERO, speed, Vector::Y * 0.1);
        let hit = ours.cast_shapes_nonlinear(&x, &triangle, &y, &ball, late, late + 8.0, true);
        let time = hit.expect("supported").expect("a hit").time_of_impact;
        assert!((time - late - 1.5).abs() < 1e-3, "{time} after {late}");
    }
    // Overlaps at the start, and passes its thickness in far less than the clock tells.
    let tip = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector::from);
    for (size, speed) in [(1e-30, 1.0), (1e-3, 1e6), (1.0, 1e8)] {
        let tip = Hull::from_points(&tip.map(|p| p * size)).expect("a solid");
        let y = NonlinearRigidMotion::new(Pose::IDENTITY, Vector::ZERO, Vector::Y * speed, Vector::Y);
        let hit = ours.cast_shapes_nonlinear(&x, &tip, &y, &tip, 0.0, 1.0, false);
        let hit = hit.expect("supported").expect("they overlap");
        assert_eq!(hit.time_of_impact, 0.0);
    }
}
