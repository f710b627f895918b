//! A polyhedron of few planes that contains the body.
//!
//! 1. **Inner hull**: points of the body, most where their hull is farthest below the body.
//! 2. **Planes**: the faces of the inner hull, moved outward until they touch the body. Planes are
//!    removed until few are left (`fewer.rs`).
//! 3. **Corners** of the planes, in double-double, each a little outside its planes.
//! 4. **Proof** that the hull of the rounded corners contains the body, and the gap.
//!
//! # Proof
//!
//! Let the body be in each half-space `n . x <= d`, which a query of the body and the half-space
//! proves. Take any direction `m`, and suppose three normals of which `m` is a sum with positive
//! weights, `m = a n1 + b n2 + c n3`. No point of the body is higher along `m` than
//! `a d1 + b d2 + c d3`. A corner with `n . v >= d` for these three planes is at least that high.
//! So if for all directions there are three such planes with a corner, no plane separates a point
//! of the body from the hull of the corners: this hull contains the body. That a corner is not
//! strictly inside a half-space is an exact sign, for any rounding error.
//!
//! The triples are the triangles of the dual (`fewer.rs`), of which the cones of normals are to
//! contain all directions. The dual is an exact hull around the origin, so rays from the origin
//! meet its triangles. Its points `w` and the stored normals differ by rounding. Between them there
//! is a path on which no triangle meets the origin: with the point inside, `c`, all products of
//! `v - c` with both are positive at the three points of the triangle with the corner `v`. So the
//! triangles of the normals wind around the origin once, as those of the dual do, and meet all
//! rays.

use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::fewer::{Chooser, Dual, Plane};
use super::inner::{FromInner, Inner};
use super::supports::Supports;
use super::{CoverError, FACES_MAX, HullCover};
use crate::base::num::double_double::{DoubleDouble, Expansion};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, scaled};
use crate::base::tolerance::COVER;
use crate::body::polyhedron::{ConvexPolyhedron, VertexId};
use crate::convex::contact::HalfSpace;
use crate::pair::outcome::ContactState;
use crate::pair_tracker::geometry::GeometryRef;
use crate::point::PointQuery;

/// Points of the inner hull, and points for each plane.
const POINTS: usize = 96;
const POINTS_PER_FACE: usize = 2;

/// Most doublings of the distance by which corners are outside their planes.
const DOUBLINGS: u32 = 40;

/// Coordinates below this part of the largest one are zero, so that the hull stores corners as they
/// are.
const LEAST: f64 = f64::from_bits((1023 - 190) << 52);

/// Rounds in which the inner hull grows near corners, and the width of the gap's bounds.
const ROUNDS: usize = 16;
const WIDTH: f64 = 1.0 / 512.0;

pub(super) fn cover(geometry: GeometryRef<'_>, faces: usize) -> Result<HullCover, CoverError> {
    if !(4..=FACES_MAX).contains(&faces) {
        return Err(CoverError::Faces { faces });
    }
    let supports = Supports::new(geometry)?;
    let none = CoverError::NoHull { kind: supports.kind };
    if supports.low == supports.high {
        // The box of a single point that is not rounded.
        let hull = ConvexPolyhedron::point(supports.low).map_err(|_| none)?;
        return Ok(HullCover {
            hull,
            planes: Vec::new(),
            gap: 0.0,
        });
    }
    let inner = Inner::new(&supports, POINTS + POINTS_PER_FACE * faces).ok_or(none)?;
    let candidates = inner.candidates(&supports);
    let dual = Chooser::new(&supports, &inner).choose(candidates, faces).ok_or(none)?;
    let hull = proven(&supports, &dual, inner.middle() * supports.unit).ok_or(none)?;
    let gap = gap(&supports, inner, &hull);
    let planes = dual.planes.iter().map(|plane| plane.support.space).collect();
    Ok(HullCover { hull, planes, gap })
}

/// Returns the hull of the rounded corners of planes, proven to contain the body; `None` if the
/// proof fails.
fn proven(supports: &Supports<'_>, dual: &Dual, middle: Point3<f64>) -> Option<ConvexPolyhedron> {
    let is_inside = |plane: &Plane| plane.support.space.outcome_of(&middle).state == ContactState::Overlapping;
    if !dual.planes.iter().all(is_inside) {
        return None;
    }
    let triangles: Vec<[VertexId; 3]> = dual.hull.triangles().collect();
    let mut outward = COVER * supports.reach();
    for _ in 0..DOUBLINGS {
        let corners = triangles.iter().map(|t| {
            let spaces = t.each(|v| &dual.planes[v.index()].support.space);
            let corner = corner(spaces, &middle, outward, supports.unit);
            let normals = t.each(|v| dual.hull.vertex(v).map_or_else(Vector3::zeros, |w| w.coords));
            is_outside(spaces, &normals, &corner, &middle).then_some(corner)
        });
        if let Some(corners) = corners.collect::<Option<Vec<_>>>() {
            return hull_of(dual, &triangles, &corners);
        }
        outward *= 2.0;
    }
    None
}

/// Returns the point at a distance outside three planes, rounded.
///
/// Lengths are divided by `unit`: then products stay in the range of double-double.
fn corner(spaces: [&HalfSpace; 3], middle: &Point3<f64>, outward: f64, unit: f64) -> Point3<f64> {
    let normals: [Vec3<DoubleDouble>; 3] =
        spaces.each(|s| <[f64; 3]>::from(s.normal().into_inner()).each(DoubleDouble::from));
    let center: Vec3<DoubleDouble> = <[f64; 3]>::from(*middle / unit).each(DoubleDouble::from);
    let height = |k: usize| {
        let offset = DoubleDouble::sum(spaces[k].offset() / unit, outward / unit);
        offset - dot(&normals[k], &center)
    };
    // Cramer's rule.
    let across = [[1, 2], [2, 0], [0, 1]].each(|[i, j]| cross(&normals[i], &normals[j]));
    let volume = dot(&normals[0], &across[0]);
    let parts: [Vec3<DoubleDouble>; 3] = core::array::from_fn(|k| scaled(&across[k], height(k) / volume));
    let p = Vector3::from_fn(|k, _| (center[k] + parts[0][k] + parts[1][k] + parts[2][k]).value() * unit);
    let least = p.amax() * LEAST;
    Point3::from(p.map(|x| if x.abs() < least { 0.0 } else { x }))
}

/// Returns whether a corner is proven to be strictly inside none of its half-spaces, and on the
/// side of the points of the dual.
fn is_outside(spaces: [&HalfSpace; 3], points: &[Vector3<f64>; 3], corner: &Point3<f64>, middle: &Point3<f64>) -> bool {
    let outside = |s: &&HalfSpace| s.outcome_of(corner).state != ContactState::Overlapping;
    let along = |w: &Vector3<f64>| {
        let mut sum = Expansion::<12>::new();
        (0..3).for_each(|k| sum.add_product(w[k], corner[k]));
        (0..3).for_each(|k| sum.add_product(-w[k], middle[k]));
        sum.sign() > 0
    };
    corner.iter().all(|x| x.is_finite()) && spaces.iter().all(outside) && points.iter().all(along)
}

/// Returns the hull of corners with the plane of each face; `None` if a corner is stored otherwise
/// or the extent is out of range.
fn hull_of(dual: &Dual, triangles: &[[VertexId; 3]], corners: &[Point3<f64>]) -> Option<ConvexPolyhedron> {
    let mut hull = ConvexPolyhedron::from_points(corners).ok()?;
    let is_stored = |v: VertexId| Some(hull.vertex(v)? == corners[hull.source_vertex(v)?]);
    if !hull.vertices().all(|v| is_stored(v) == Some(true)) {
        return None;
    }
    let planes = hull.faces().map(|face| {
        let normal = hull
            .face_plane(face)
            .map_or_else(Vector3::zeros, |(n, _)| n.into_inner());
        let at = hull.face_vertices(face).filter_map(|v| hull.source_vertex(v));
        let triples: Vec<&[VertexId; 3]> = at.map(|k| &triangles[k]).collect();
        // The plane of most corners of the face, and of these the one that is nearest to the face.
        let rank = |v: VertexId| {
            let common = triples.iter().filter(|t| t.contains(&v)).count();
            (common, dual.planes[v.index()].support.space.normal().dot(&normal))
        };
        let all = dual.hull.vertices().map(|v| (rank(v), v.index() as u32));
        all.fold(
            ((0, f64::NEG_INFINITY), 0),
            |best, next| if next.0 > best.0 { next } else { best },
        )
        .1
    });
    hull.source_faces = planes.collect();
    Some(hull)
}

/// Returns an upper bound of the distance of any point of the cover from the convex hull of the
/// body.
///
/// The distance from a convex set is a convex function, so it is greatest at a corner. Each corner
/// has two upper bounds: its distance from the body, and its distance from the inner hull plus that
/// of the inner hull's vertices from the body.
fn gap(supports: &Supports<'_>, mut inner: Inner, hull: &ConvexPolyhedron) -> f64 {
    let (query, unit) = (PointQuery::new(supports.geometry).prepared(), supports.unit);
    let from_body = |p: &Point3<f64>| {
        query
            .closest_point(p)
            .map_or(f64::INFINITY, |found| found.upper.larger(0.0))
    };
    let corners: Vec<(Point3<f64>, f64)> = hull.vertex_points().map(|p| (p, from_body(&p))).collect();
    if supports.is_convex() {
        return corners.iter().fold(0.0, |gap, (_, d)| gap.larger(*d));
    }
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let off = inner
            .hull
            .vertex_points()
            .fold(0.0f64, |off, p| off.larger(from_body(&(p * unit))));
        let mut from_inner = FromInner::new(&inner);
        let mut bounds: Vec<(f64, f64, Point3<f64>)> = Vec::with_capacity(corners.len());
        for (p, direct) in &corners {
            let (d, n) = from_inner.distance(&(p / unit));
            let upper = (d * unit + off) * (1.0 + COVER);
            let Some(support) = supports.along(&n) else { continue };
            let lower = support.space.outcome_of(p).lower;
            bounds.push((lower, upper.smaller(*direct), support.point / unit));
        }
        let upper = bounds.iter().fold(0.0f64, |most, bound| most.larger(bound.1));
        let lower = bounds.iter().fold(0.0f64, |most, bound| most.larger(bound.0));
        best = if bounds.len() == corners.len() {
            best.smaller(upper)
        } else {
            best
        };
        let open = bounds.iter().filter(|(_, upper, _)| *upper > lower).map(|(.., p)| *p);
        if upper - lower <= WIDTH * upper || !inner.add(open) {
            break;
        }
    }
    best
}
