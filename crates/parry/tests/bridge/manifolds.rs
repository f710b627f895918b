//! Manifolds at any size: judged by the core in `f64`, of the same bodies at the same pose.

use lin_canny_parry::lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny_parry::lin_canny::{ConvexPolyhedron, Outcome, PairTracker, RelativePose, Shape};
use truth::rng::Rng;

use super::dispatch::random_pose;
use super::engine::parry::math::{Pose, Real, Vector};
use super::engine::parry::query::{ContactManifold, PersistentQueryDispatcher, QueryDispatcher};
use super::engine::parry::shape::{
    Ball, Capsule, ConvexPolyhedron as Points, Cuboid, RoundShape, Segment, SharedShape, Triangle,
};
use super::engine::{CertifiedDispatcher, Hull, isometry};

type Manifolds = Vec<ContactManifold<(), ()>>;

/// Sizes of the bodies: from a tenth of a millimetre to ten kilometres, in metres.
const SIZES: [Real; 9] = [1e-4, 1e-3, 5e-3, 1e-2, 2e-2, 0.1, 1.0, 100.0, 1e4];

/// Steps of a motion through which a manifold is kept.
const STEPS: usize = 12;

fn wide(p: Vector) -> Point3<f64> {
    Point3::from(p.to_array().map(f64::from))
}

/// A shape of parry and the shape of the core that it is.
struct Judged {
    name: &'static str,
    shape: SharedShape,
    truth: Shape,
    /// Place of the true shape in the frame of parry's.
    at: Isometry3<f64>,
}

impl Judged {
    /// The hull of points, rounded.
    fn new(name: &'static str, shape: SharedShape, core: &[Vector], radius: Real) -> Self {
        let points: Vec<_> = core.iter().map(|&p| wide(p)).collect();
        let core = match points[..] {
            [p] => ConvexPolyhedron::point(p),
            [p, q] => ConvexPolyhedron::segment(p, q),
            [_, _, _] => ConvexPolyhedron::polygon(&points),
            _ => ConvexPolyhedron::from_points(&points),
        };
        let truth = Shape::from(core.expect("a body")).rounded(f64::from(radius));
        let truth = truth.expect("a radius");
        let at = Isometry3::identity();
        Self { name, shape, truth, at }
    }

    /// A shape whose axis is y in parry and z in the core, rounded.
    fn upright(name: &'static str, shape: SharedShape, core: Shape, radius: Real) -> Self {
        let truth = core.rounded(f64::from(radius)).expect("a radius");
        let at = Isometry3::rotation(Vector3::x() * -std::f64::consts::FRAC_PI_2);
        Self { name, shape, truth, at }
    }
}

impl Judged {
    fn is_curved(&self) -> bool {
        self.at != Isometry3::identity()
    }
}

/// The corners of a cuboid.
fn corners(half: Vector) -> Vec<Vector> {
    let side = |k: u32, bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
    (0..8)
        .map(|k| Vector::new(side(k, 1), side(k, 2), side(k, 4)) * half)
        .collect()
}

/// Every kind of which a manifold is promised at any size, twice with other proportions.
fn judged(rng: &mut Rng, size: Real) -> Vec<Judged> {
    let mut list = Vec::new();
    for _ in 0..2 {
        let mut side = || size * rng.range(0.2, 0.6) as Real;
        let half = Vector::new(side(), side(), side());
        let (length, radius) = (side(), side());
        let plain = Points::from_convex_hull(&corners(half)).expect("a hull");
        let stone: Vec<Vector> = (0..12)
            .map(|_| Vector::from(rng.unit().map(|x| x as Real)) * half)
            .collect();
        let (hull, border) = (Hull::from_points(&stone).expect("a solid"), 0.1 * size);
        let pebble = hull.rounded(border).expect("a radius");
        let round_plain = RoundShape {
            inner_shape: plain.clone(),
            border_radius: border,
        };
        let round = RoundShape {
            inner_shape: Cuboid::new(half),
            border_radius: 0.2 * size,
        };
        let (a, b) = (Vector::Y * -length, Vector::new(0.3 * length, length, 0.0));
        let capsule = SharedShape::new(Capsule::new(a, b, radius));
        let ball = SharedShape::new(Ball::new(radius));
        list.extend([
            Judged::new("cuboid", SharedShape::new(Cuboid::new(half)), &corners(half), 0.0),
            Judged::new("capsule", capsule, &[a, b], radius),
            Judged::new("ball", ball, &[Vector::ZERO], radius),
            Judged::new("plain", SharedShape::new(plain), &corners(half), 0.0),
            Judged::new("round", SharedShape::new(round), &corners(half), 0.2 * size),
            Judged::new("hull", SharedShape::from(hull), &stone, 0.0),
            Judged::new("round hull", SharedShape::from(pebble), &stone, border),
            Judged::new("round plain", SharedShape::new(round_plain), &corners(half), border),
        ]);
        list.extend(flat(rng, size));
        list.extend(upright(length, radius, 0.1 * size));
    }
    list
}

/// A segment, a triangle, and a rounded one.
fn flat(rng: &mut Rng, size: Real) -> [Judged; 3] {
    let [a, b, c] = [0; 3].map(|_| Vector::from(rng.unit().map(|x| 0.6 * x as Real)) * size);
    let triangle = Triangle::new(a, b, c);
    let round = RoundShape {
        inner_shape: triangle,
        border_radius: 0.1 * size,
    };
    [
        Judged::new("segment", SharedShape::new(Segment::new(a, b)), &[a, b], 0.0),
        Judged::new("triangle", SharedShape::new(triangle), &[a, b, c], 0.0),
        Judged::new("round triangle", SharedShape::new(round), &[a, b, c], 0.1 * size),
    ]
}

/// A cylinder and a cone, and rounded ones.
fn upright(half: Real, radius: Real, border: Real) -> [Judged; 4] {
    let (h, r) = (f64::from(half), f64::from(radius));
    let cylinder = Shape::cylinder(h, r).expect("a body");
    let cone = Shape::cone(h, r).expect("a body");
    let shape = |name| match name {
        "cylinder" => SharedShape::cylinder(half, radius),
        "cone" => SharedShape::cone(half, radius),
        "round cylinder" => SharedShape::round_cylinder(half, radius, border),
        _ => SharedShape::round_cone(half, radius, border),
    };
    [
        ("cylinder", &cylinder, 0.0),
        ("cone", &cone, 0.0),
        ("round cylinder", &cylinder, border),
        ("round cone", &cone, border),
    ]
    .map(|(name, core, border)| Judged::upright(name, shape(name), core.clone(), border))
}

fn truth(a: &Judged, b: &Judged, pos12: &Pose) -> Outcome {
    let pose = RelativePose::new(&a.at, &(isometry(pos12) * b.at)).expect("a pose");
    PairTracker::new().closest(&a.truth, &b.truth, &pose).outcome
}

/// Checks a manifold by the closest points in `f64`. Returns whether it holds contacts.
fn check(a: &Judged, b: &Judged, (pos12, size): (&Pose, Real), kept: &Manifolds, prediction: Real) -> bool {
    let (what, close) = ((a.name, b.name, size), f64::from(size) * 1e-5);
    // A contact beside the closest points of a rim stands for them.
    let beside = if a.is_curved() || b.is_curved() { 100.0 } else { 1.0 };
    let truth = truth(a, b, pos12);
    let (m, d) = (&kept[0], truth.distance);
    let Some(deepest) = m.find_deepest_contact().map(|p| f64::from(p.dist)) else {
        assert!(d > f64::from(prediction) - close, "{what:?}: none at {d:e}");
        return false;
    };
    // parry's reach of a ball's manifold is the prediction, the reach of others is farther.
    let is_right = (deepest - d).abs() < beside * close;
    // Beyond it the contact of curved shapes is that of a plane between them.
    let reach = f64::from(prediction * CertifiedDispatcher::default().options().prediction_factor);
    let is_beyond = beside > 1.0 && deepest > reach - close && deepest < d + close;
    assert!(is_right || is_beyond, "{what:?}: {deepest:e} for {d:e}");
    for p in &m.points {
        let apart = f64::from((pos12 * p.local_p2 - p.local_p1).dot(m.local_n1));
        assert!((apart - f64::from(p.dist)).abs() < close, "{what:?}: {apart:e} {p:?}");
    }
    let along = (pos12.rotation * m.local_n2 + m.local_n1).length();
    assert!((m.local_n1.length() - 1.0).abs() < 1e-5, "{what:?}: {m:?}");
    assert!(along < 1e-5, "{what:?}: {m:?}");
    d <= f64::from(prediction)
}

/// Manifolds kept through a motion, from apart to deep, are those of the bodies at each instant.
#[test]
fn manifolds_are_right_at_any_size() {
    let mut seen = 0;
    for size in SIZES {
        let mut rng = Rng::new(61);
        let list = judged(&mut rng, size);
        let ours = CertifiedDispatcher::default();
        for (k, a) in list.iter().enumerate() {
            for b in &list[k..] {
                let (mut kept, prediction) = (Manifolds::new(), 0.02 * size);
                let far = random_pose(&mut rng, f64::from(size) * 1.3);
                let aside = Vector::from(rng.unit().map(|x| 0.2 * x as Real)) * size;
                for step in 0..STEPS {
                    let at = far.translation * (1.0 - step as Real / STEPS as Real) + aside;
                    let pos12 = Pose::from_parts(at, far.rotation);
                    ours.contact_manifolds(&pos12, &*a.shape, &*b.shape, prediction, &mut kept, &mut None)
                        .expect("supported");
                    seen += usize::from(check(a, b, (&pos12, size), &kept, prediction));
                }
            }
        }
    }
    assert!(seen > 2000, "{seen}");
}

/// Random poses of a pair of kinds, spread over the bodies of these kinds.
const POSES: usize = 400;

/// Deepest contacts of overlaps at random poses, of small bodies: within 5 % of their size.
#[test]
fn depths_of_small_bodies_are_right() {
    let (mut deep, mut open) = (0, 0);
    for size in [0.02, 0.01, 0.001] {
        let mut rng = Rng::new(63);
        let list = judged(&mut rng, size);
        let (ours, mut kept) = (CertifiedDispatcher::default(), Manifolds::new());
        for (k, a) in list.iter().enumerate() {
            for b in &list[k..] {
                let bodies = if a.name == b.name { 3 } else { 4 };
                for _ in 0..POSES.div_ceil(bodies) {
                    let pos12 = random_pose(&mut rng, f64::from(size) * 0.4);
                    kept.clear();
                    ours.contact_manifolds(&pos12, &*a.shape, &*b.shape, 0.0, &mut kept, &mut None)
                        .expect("supported");
                    let (truth, what) = (truth(a, b, &pos12), (a.name, b.name, size));
                    if truth.upper < 0.0 {
                        let found = kept[0].find_deepest_contact().map_or(0.0, |p| f64::from(p.dist));
                        let off = (found - truth.upper).max(truth.lower - found);
                        assert!(off < 0.05 * f64::from(size), "{what:?}: {found:e} for {truth:?}");
                        open += usize::from(truth.upper - truth.lower > 1e-5 * f64::from(size));
                        deep += 1;
                    }
                }
            }
        }
    }
    assert!(deep > 50_000 && open < deep / 50, "{deep} {open}");
}

/// The other queries of the same pairs, at any size.
#[test]
fn contacts_are_right_at_any_size() {
    let mut deep = 0;
    for size in SIZES {
        let mut rng = Rng::new(62);
        let list = judged(&mut rng, size);
        let (ours, close) = (CertifiedDispatcher::default(), f64::from(size) * 2e-6);
        for (k, a) in list.iter().enumerate() {
            for b in &list[k..] {
                for _ in 0..4 {
                    let apart = f64::from(size) * rng.range(0.2, 1.6);
                    let pos12 = random_pose(&mut rng, apart);
                    let d = truth(a, b, &pos12).distance;
                    let what = (a.name, b.name, size, d);
                    let (x, y) = (&*a.shape, &*b.shape);
                    let gap = f64::from(ours.distance(&pos12, x, y).expect("supported").distance);
                    assert!((gap - d.max(0.0)).abs() < close, "{what:?}: {gap:e}");
                    let contact = ours.contact(&pos12, x, y, 10.0 * size).expect("supported");
                    let contact = contact.expect("within");
                    assert!((f64::from(contact.dist) - d).abs() < close, "{what:?}: {contact:?}");
                    let meets = ours.intersection_test(&pos12, x, y).expect("supported");
                    assert!(meets.intersecting == (d < 0.0) || d.abs() < close, "{what:?}");
                    deep += usize::from(d < 0.0);
                }
            }
        }
    }
    assert!(deep > 500, "{deep}");
}

/// Boxes laid on boxes, and capsules side by side, have the contacts that hold them.
#[test]
fn flush_faces_have_contacts_at_their_ends() {
    let ours = CertifiedDispatcher::default();
    for size in SIZES {
        let cuboid = Cuboid::new(Vector::splat(0.5 * size));
        let capsule = Capsule::new_x(0.5 * size, 0.3 * size);
        for (turn, least) in [(0.0, 4), (0.3, 4)] {
            let turned = Pose::rotation(Vector::Y * turn);
            let mut kept = Manifolds::new();
            for gap in [-0.05, -1e-3, 0.0, 0.01] {
                let at = Vector::new(0.1, 1.0 + gap, 0.05) * size;
                let pose = Pose::from_parts(at, turned.rotation);
                ours.contact_manifolds(&pose, &cuboid, &cuboid, 0.02 * size, &mut kept, &mut None)
                    .expect("supported");
                let near = kept[0].points.iter().filter(|p| p.dist < 0.02 * size);
                assert!(near.count() >= least, "{size} {turn} {gap}: {kept:?}");
            }
        }
        let mut kept = Manifolds::new();
        let side = Pose::translation(0.1 * size, 0.59 * size, 0.0);
        ours.contact_manifolds(&side, &capsule, &capsule, 0.02 * size, &mut kept, &mut None)
            .expect("supported");
        assert_eq!(kept[0].points.len(), 2, "{size}: {kept:?}");
    }
}
