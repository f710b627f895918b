//! Kernels and constants for the tests of the error bounds (package `proofs`). No part of the
//! interface: a function may change or vanish in any version.

#![allow(missing_docs)]

use alloc::vec::Vec;

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use crate::base::motion::rotation;
use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::packed::{PackedRotation, PackedVec3};
use crate::base::num::scalar::Scalar;
use crate::base::num::{scalar, sign};
use crate::base::pose::{self, Operand, RelativePose};
use crate::base::tolerance;
use crate::body::polyhedron::build::hull;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair, Plane, VertexId, highest, query};
use crate::body::shape::{Core, Shape};
use crate::convex::depth::pyramid::PyramidSide;
use crate::convex::minimum::simplex::Simplex;
use crate::convex::minimum::{self, Minimum, vertex_of};
use crate::convex::smooth;
use crate::convex::solve::closed_form;
use crate::convex::walk;
use crate::nonconvex::continuous::paths;
use crate::nonconvex::front;
use crate::nonconvex::query::box_gaps;
use crate::nonconvex::query::frame::Way;
use crate::pair::certificate;
use crate::pair::difference::{MinkowskiPoint, support};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::pair::{draft, star};
use crate::surface::{bezier, net, nurbs};
use crate::time::separation::{balls, bernstein, pairs, plane};

type Triple = [f64; 3];

fn packed(v: Triple) -> PackedVec3 {
    PackedVec3::new(&v.into())
}

pub fn rise(n: Triple, e: Triple) -> (f64, f64) {
    sign::rise(&n.into(), &e.into())
}

pub fn edge_sign(n: Triple, e: Triple) -> i32 {
    sign::edge_sign(&n.into(), &e.into())
}

pub fn slopes(n: Triple, m: Triple, e: Triple, f: Triple) -> (f64, f64) {
    highest::slopes(&n, &m, &e, &f)
}

pub fn steeper(n: Triple, m: Triple, e: Triple, f: Triple) -> Option<i32> {
    let [n, m, e, f] = [n, m, e, f].each(Vector3::from);
    highest::steeper(&n, &m, &e, &f)
}

pub fn side_height(u: Triple, w: Triple, base: Triple, p: Triple) -> f64 {
    let [u, w, base, p] = [u, w, base, p].each(Vector3::from);
    hull::side_height(&u.cross(&w), &base, &p)
}

pub fn guard(u: Triple, w: Triple, sides: Triple) -> f64 {
    hull::guard(&u.into(), &w.into(), &sides.into())
}

pub fn scaled_down(x: f64, unit: f64) -> f64 {
    draft::scaled_down(x, unit)
}

pub fn volume(a: Triple, b: Triple, c: Triple) -> f64 {
    scalar::dot(&a, &scalar::cross(&b, &c))
}

/// Returns the weights of the corners of a triangle, its direction and the squared distance of the
/// origin; `None` if the origin is nearest to an edge.
pub fn triangle(corners: [Triple; 3]) -> Option<(Triple, Triple, f64)> {
    let corner = |w: Triple| MinkowskiPoint {
        a: VertexId(0),
        b: VertexId(0),
        w,
    };
    let simplex = Simplex::triangle(corners.each(corner));
    let weights = simplex.weights().try_into().ok()?;
    Some((weights, simplex.direction(), simplex.squared_distance()))
}

pub fn place(ends: [Triple; 2], time: f64) -> Triple {
    paths::place(&ends.each(Vector3::from), time).into()
}

pub fn path_volume(a: Triple, b: Triple, c: Triple) -> f64 {
    let [a, b, c] = [a, b, c].each(Vector3::from);
    paths::determinant([&a, &b, &c])
}

pub fn third(volumes: Triple) -> f64 {
    paths::third(volumes)
}

/// Returns the coefficients of an area along a direction, and the height of the first place over
/// the second.
pub fn path_areas(at: [[Triple; 3]; 2], n: Triple) -> [f64; 4] {
    let at = at.each(|places| places.each(Vector3::from));
    let n = Vector3::from(n);
    let [x, y, z] = paths::areas(at.each_ref().each(|places| places.each_ref())).each(|area| area.dot(&n));
    [x, y, z, n.dot(&at[0][0]) - n.dot(&at[0][1])]
}

pub fn pyramid_side(from: Triple, to: Triple, apex: Triple) -> [f64; 5] {
    let side = PyramidSide::new(packed(apex), packed(from), packed(to));
    let n = side.n.vector();
    [n.x, n.y, n.z, side.height, side.squares]
}

pub fn over_side(n: Triple, edge: Triple, to: Triple) -> f64 {
    query::over_side(&n.into(), &edge.into(), &to.into())
}

pub fn over_middle(n: Triple, p: Triple, middle: Triple) -> f64 {
    let [n, p, middle] = [n, p, middle].each(Vector3::from);
    pairs::over_middle(n.dot(&p), &n, &middle)
}

pub fn two_planes_bound(n: Triple, planes: [(Triple, f64); 2], weights: [f64; 2], radius: f64) -> f64 {
    let [left, right] = planes.each(|(normal, offset)| Plane {
        normal: normal.into(),
        offset,
    });
    let n = packed(n);
    star::two_planes_bound(n, [&left, &right], weights, n.norm_squared(), radius)
}

fn isometry([x, y, z, w]: [f64; 4], t: Triple) -> Isometry3<f64> {
    let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Vector3::from(t).into(), q)
}

/// Returns the rows of the rotation, and the translation; `None` for poses that are refused.
pub fn relative_pose(rotations: [[f64; 4]; 2], translations: [Triple; 2]) -> Option<([Triple; 3], Triple)> {
    let [a, b] = [0, 1].each(|k| isometry(rotations[k], translations[k]));
    let both = RelativePose::new(&a, &b).ok()?;
    Some(placing(&both))
}

/// Returns the rows of the rotation, and the translation.
pub fn placing(pose: &RelativePose) -> ([Triple; 3], Triple) {
    let m = pose.rotation();
    let rows = [0, 1, 2].each(|k| [m[(k, 0)], m[(k, 1)], m[(k, 2)]]);
    (rows, pose.translation().into())
}

pub fn rotation_matrix(q: [f64; 4], s: f64) -> [Triple; 3] {
    let m = pose::rotation_matrix(&q, s);
    [0, 1, 2].each(|k| [m[(k, 0)], m[(k, 1)], m[(k, 2)]])
}

pub fn product(m: [Triple; 3], v: Triple) -> Triple {
    let m = nalgebra::Matrix3::from_fn(|i, j| m[i][j]);
    PackedRotation::new(&m).times(packed(v)).vector().into()
}

pub fn turned(q: [f64; 4], v: Triple) -> Triple {
    (isometry(q, [0.0; 3]).rotation * Vector3::from(v)).into()
}

pub fn rest(c: [f64; 4], x: f64) -> [f64; 4] {
    bernstein::rest(&c, x)
}

pub fn patch_value(net: &[f64], degrees: [usize; 2], at: [f64; 2]) -> f64 {
    let net: Vec<[f64; 1]> = net.iter().map(|x| [*x]).collect();
    bezier::value(&net, degrees, at)[0]
}

pub fn blossom(points: &[[f64; 4]], knots: &[f64], knot: usize, ends: [f64; 2], upper: usize) -> [f64; 4] {
    nurbs::blossom(points, knots, &nurbs::Span { knot, ends }, upper)
}

pub fn raise(points: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let mut row = [[0.0; 4]; bezier::ORDER];
    row[..points.len()].copy_from_slice(points);
    net::raise(&mut row, points.len() - 1);
    row[..=points.len()].to_vec()
}

/// Returns both derivatives of a direction, and the way of the pivots with its derivatives.
pub fn plane_derivatives(n: Triple, spin: Triple, w: Triple, ways: [Triple; 3]) -> ([Triple; 2], [f64; 3]) {
    let [n, spin, w] = [n, spin, w].each(Vector3::from);
    let [between, velocity, acceleration] = ways.each(Vector3::from);
    (
        plane::derivatives(&n, &spin, &w).each(Triple::from),
        plane::way_along(&n, &spin, [&between, &velocity, &acceleration]),
    )
}

pub fn flight_of_ball(from: Triple, velocity: Triple, radius: f64) -> [f64; 4] {
    balls::flight_of_ball(&from.into(), &velocity.into(), radius)
}

/// Returns the quaternion of a turn, vector part first, and its product with another.
pub fn half_turn(axis: Triple, sine: f64, cosine: f64, rest: f64, other: [f64; 4]) -> [[f64; 4]; 2] {
    let [x, y, z, w] = other;
    let q = rotation::half_turn(&axis.into(), sine, cosine, rest);
    [q, q * Quaternion::new(w, x, y, z)].each(|q| [q.i, q.j, q.k, q.w])
}

pub fn patch_first(net: &[f64], degree: usize, at: f64) -> f64 {
    let net: Vec<[f64; 1]> = net.iter().flat_map(|x| [[*x], [*x]]).collect();
    bezier::jet(&net, [degree, 1], [at, 0.0]).u[0]
}

/// Returns the gap of two boxes, each of axes, centre and half extents, at a relative pose.
pub fn box_gap(rotation: [f32; 9], translation: [f32; 3], boxes: [[[f32; 3]; 5]; 2], known: Option<[f32; 3]>) -> f32 {
    box_gaps::gap_of(rotation, translation, boxes, known)
}

/// Returns direction and base of an entry of a front, and the gap that it proves at another pose.
/// The last two are the radius and a segment.
pub fn front_entry(
    rotations: [[f32; 9]; 2],
    translations: [[f32; 3]; 2],
    normal: [f32; 3],
    gap: f32,
    centre: [f32; 3],
    radius: f32,
    rod: [f32; 3],
) -> ([f32; 3], f32, f32) {
    let poses = [0, 1].each(|k| Way {
        rotation: rotations[k],
        translation: translations[k],
    });
    front::entry_at(poses, normal, gap, centre, radius, rod)
}

/// Two bodies as placed, and where a walk ended: bounds before their error term, in A's stored
/// unit.
#[derive(Clone, Copy, Debug)]
pub struct WalkEnd {
    pub features: FeaturePair,
    pub distance: f64,
    pub lower: f64,
    pub normal: Triple,
    pub size: f64,
    pub rotation: [Triple; 3],
    pub translation: Triple,
}

/// Returns where a cold walk ended, if at closest features.
pub fn walk_end(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> Option<WalkEnd> {
    let posed = PosedPair::new(a, b, pose).ok()?;
    let first = FeaturePair::vertices(Operand::A, VertexId(0), VertexId(0));
    let mut draft = draft::Draft::starting_at(first);
    draft.features = walk::seed::cold(&posed, &mut draft.work);
    let m = posed.rotation.matrix();
    walk::walk::<true>(&posed, &mut draft).then(|| WalkEnd {
        features: draft.features,
        distance: draft.distance,
        lower: draft.lower,
        normal: draft.normal.into_inner().into(),
        size: posed.size(),
        rotation: [0, 1, 2].each(|k| [m[(k, 0)], m[(k, 1)], m[(k, 2)]]),
        translation: posed.translation.vector().into(),
    })
}

/// Returns the radius of a body in its stored frame.
pub fn stored_radius(body: &ConvexPolyhedron) -> f64 {
    body.radius
}

/// Returns the distance of the supporting planes, the direction as divided by its length, and the
/// support vertices.
pub fn support_distance(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    normal: Triple,
) -> Option<(f64, Triple, [VertexId; 2])> {
    let (posed, normal) = (PosedPair::new(a, b, pose).ok()?, Vector3::from(normal));
    let distance = certificate::support_distance(&posed, &normal, VertexId(0), VertexId(0));
    let n = normal / normal.norm_squared().sqrt();
    let on_a = a.support_certified(&n, VertexId(0)).vertex;
    let on_b = b.support_certified(&-posed.direction_in_b(&n), VertexId(0)).vertex;
    Some((distance, n.into(), [on_a, on_b]))
}

/// The end of a solve for the least distance; numbers as high and low parts.
#[derive(Clone, Debug)]
pub struct MinimumEnd {
    pub rotation: [[[f64; 2]; 3]; 3],
    pub translation: [[f64; 2]; 3],
    pub lower: [f64; 2],
    pub direction: [[f64; 2]; 3],
    /// The support along the direction.
    pub support: [VertexId; 2],
    pub distance: [f64; 2],
    pub points: Vec<[VertexId; 2]>,
    pub weights: Vec<[f64; 2]>,
}

/// Returns the end of a solve in f64, or in double-double, of bodies apart.
pub fn minimum_end(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    is_double_double: bool,
) -> Option<MinimumEnd> {
    let posed = PosedPair::new(a, b, pose).ok()?;
    if is_double_double {
        solved(&posed, &Transform::<DoubleDouble>::new(a, b, pose)?)
    } else {
        solved(&posed, &Transform::of(&posed))
    }
}

fn solved<T: Scalar>(posed: &PosedPair, frame: &Transform<T>) -> Option<MinimumEnd> {
    let parts = |x: T| [x.value(), (x - T::from(x.value())).value()];
    let first = FeaturePair::vertices(Operand::A, VertexId(0), VertexId(0));
    let Minimum::Outside {
        simplex,
        lower,
        direction,
    } = minimum::solve(posed, frame, vertex_of(posed, frame, first))
    else {
        return None;
    };
    let along = support(posed, frame, &direction.each(|x| -x), &simplex.points()[0]);
    Some(MinimumEnd {
        rotation: frame.matrix.each(|row| row.each(parts)),
        translation: frame.translation.each(parts),
        lower: parts(lower),
        direction: direction.each(parts),
        support: [along.a, along.b],
        distance: parts(simplex.witness_distance()),
        points: simplex.points().iter().map(|p| [p.a, p.b]).collect(),
        weights: simplex.weights().iter().copied().map(parts).collect(),
    })
}

/// What two directions tell of an ellipsoid and of a curved shape at a pose: each divided by its
/// length, the height and the distance of its support points; and the distance of a mixture.
pub type CurvedEnd = ([(Triple, f64, f64); 2], f64);

/// Returns what two directions tell of two curved shapes.
pub fn curved_end(
    a: &Shape,
    b: &Shape,
    pose: &RelativePose,
    directions: [Triple; 2],
    weights: [f64; 2],
) -> Option<CurvedEnd> {
    let (matrix, translation) = placing(pose);
    let frame = Transform { matrix, translation };
    match (a.core(), b.core()) {
        (Core::Ellipsoid(a), Core::Cylinder(b)) => smooth::bounds_along(a, b, frame, directions, weights),
        (Core::Ellipsoid(a), Core::Cone(b)) => smooth::bounds_along(a, b, frame, directions, weights),
        (Core::Ellipsoid(a), Core::Ellipsoid(b)) => smooth::bounds_along(a, b, frame, directions, weights),
        _ => None,
    }
}

fn double([hi, lo]: [f64; 2]) -> DoubleDouble {
    DoubleDouble { hi, lo }
}

pub fn double_sum(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let DoubleDouble { hi, lo } = double(a) + double(b);
    [hi, lo]
}

pub fn double_product(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let DoubleDouble { hi, lo } = double(a) * double(b);
    [hi, lo]
}

pub fn double_quotient(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let DoubleDouble { hi, lo } = double(a) / double(b);
    [hi, lo]
}

/// The distance of two features in closed form.
pub struct FeatureDistance {
    pub distance: [f64; 2],
    pub error: f64,
    /// From A to B in A's frame, of any length.
    pub normal: Triple,
}

/// Returns the distance of two features, if they are the closest ones beyond doubt, for points of
/// the bodies close to the closest points.
pub fn closed_form(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    features: FeaturePair,
    [x, y]: [Triple; 2],
) -> Option<FeatureDistance> {
    let posed = PosedPair::new(a, b, pose).ok()?;
    let mut draft = draft::Draft::starting_at(features);
    (draft.point_on_a, draft.point_on_b) = (x.into(), y.into());
    let form = closed_form::closed_form(&posed, &draft)?;
    Some(FeatureDistance {
        distance: [form.distance.hi, form.distance.lo],
        error: form.error,
        normal: form.normal.into(),
    })
}

/// Returns limits of lengths and directions by name: powers of two.
pub fn limits() -> [(&'static str, f64); 5] {
    [
        ("FAR", tolerance::FAR),
        ("NEAR", tolerance::NEAR),
        ("SMALL_PAIR", tolerance::SMALL_PAIR),
        ("PATCH_MAX", tolerance::PATCH_MAX),
        ("PATH_DIRECTION", tolerance::PATH_DIRECTION),
    ]
}

/// Returns the constants of `tolerance` by name, each in the roundings that the constant counts.
pub fn constants() -> Vec<(&'static str, f64)> {
    macro_rules! by {
        ($unit:expr, $($name:ident)*) => { [$((stringify!($name), tolerance::$name / $unit)),*].to_vec() };
    }
    let unit = tolerance::UNIT;
    let mut all: Vec<(&'static str, f64)> = by!(unit,
        EDGE_SIGN STEEPER SIDE_ERROR ORIENTATION FOOT CELL HEIGHT EDGE_BOUND EXACT_FILTER BOX CENTRE PLACED_PIVOT
        PLACED_CENTRE BERNSTEIN ROOT PATCH_POINT KNOTS RAISED NET NET_STEP NET_CUT COEFFICIENT SLAB_HEIGHT TILT
        NORMAL_ERROR BOX_TURNED DISPLACEMENT FLANK SLANT TURN PLANE BALLS RAY PLACED_BALL SHAPE_POINT CARRIED
        PARALLEL_AXES WAY ODOMETER TICK REGION PLATEAU CROSS_CANCELLED PLANE_OFFSET NEAR_PLANE BOX_EXTENT CURVATURE
        TAYLOR SURFACE_POINT PATCH_SLOPE BENT DIFFERENCE ON_BOUNDARY PATH_GAP
        PATH_VOLUME PATH_AREA CLEAR_SIGN);
    #[cfg(feature = "serde")]
    all.extend(by!(unit, NORMALISED));
    all.extend(by!(1.0, VOLUME CERTIFICATE CLOSED_FORM LEAST_RISE LEAST_SQUARE));
    all.extend(by!(unit * unit, UNIT_DOUBLE_DOUBLE));
    let raised = [
        ("ROUND_UP", tolerance::ROUND_UP),
        ("RADIUS_UP", tolerance::RADIUS_UP),
        ("DISC", tolerance::DISC),
    ];
    all.extend(raised.each(|(name, factor)| (name, (factor - 1.0) / unit)));
    let lowered = [
        ("ROUND_DOWN", tolerance::ROUND_DOWN),
        ("BOX_DISTANCE_DOWN", tolerance::BOX_DISTANCE_DOWN),
        ("INNER", tolerance::INNER),
    ];
    all.extend(lowered.each(|(name, factor)| (name, (1.0 - factor) / unit)));
    all.extend(by!(tolerance::UNIT_SINGLE, BOX_SCANNED BOXES REFIT_HEIGHT BOX_SKEW));
    let columns = [
        ("COLUMN_SUM", tolerance::COLUMN_SUM),
        ("COLUMN_MOVE", tolerance::COLUMN_MOVE - 1.0),
        ("COLUMN_SEARCH", tolerance::COLUMN_SEARCH),
        ("COLUMN_REACH", tolerance::COLUMN_REACH - 1.0),
    ];
    all.extend(columns.each(|(name, part)| (name, f64::from(part) / tolerance::UNIT_SINGLE)));
    all
}
