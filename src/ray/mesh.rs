//! Ray casts by exact predicates, proven for the ray as the caller passed it.
//!
//! A mesh gets the triangle that the ray meets first. For a polyhedron, the predicates check what
//! the cast of a point found.
//!
//! The positions of this point are rounded, so a hit within rounding of the boundary of the hull
//! may be a miss. Usually a triangle of the face that was found proves the hit. Otherwise all
//! triangles are tested over the integers.

use crate::base::num::each::Each;
use crate::base::num::sign;
use crate::base::pose::rigid;
use crate::base::tolerance::{RAY, UNIT, UNIT_DOUBLE_DOUBLE};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::nonconvex::mesh::Mesh;
#[cfg(feature = "exact")]
use crate::nonconvex::query::exact::{ExactRay, PointSide};
use crate::nonconvex::query::ray::{MeshRay, Met};
use crate::pair::transform::{StoredFrame, about_origins};
use crate::pair_tracker::geometry::GeometryRef;
use crate::ray::{Ray, RayCast, RayHit, placed};
use nalgebra::{Isometry3, Unit, Vector3};

/// Returns the result of a mesh by the triangle that a segment of the ray meets first.
///
/// `None` if rounding hides the result: with the feature `exact`, only for positions out of range.
pub(super) fn pierce(
    mesh: &Mesh,
    pose: &Isometry3<f64>,
    ray: &Ray,
    [from, until]: [f64; 2],
    length: f64,
    width: f64,
) -> Option<RayCast> {
    let mut on_mesh = in_body(mesh.into(), &mesh.frame, pose, ray, [from, until], length, width)?;
    if from == 0.0 && begins_in(mesh, &on_mesh)? {
        return Some(RayCast::Inside);
    }
    let (met, first) = mesh.first_met(&mut on_mesh)?;
    Some(match met {
        Met::Nothing => RayCast::Miss,
        Met::Between(safe, hit) => entered(mesh, pose, ray, [safe, hit], first),
    })
}

/// Returns a segment of a ray in the stored frame of a body at a pose.
///
/// `None` if the body is out of range.
pub(super) fn in_body(
    body: GeometryRef,
    frame: &StoredFrame,
    pose: &Isometry3<f64>,
    ray: &Ray,
    [from, until]: [f64; 2],
    length: f64,
    width: f64,
) -> Option<MeshRay> {
    let (centre, radius) = body.bounding_ball();
    let (seen, unit) = (placed(pose, &ray.origin)?, frame.unit());
    let direction = seen.rotation() * ray.direction.into_inner();
    let (ends, error) = if frame.is_at_origin() {
        let size = radius + centre.coords.abs().sum() + ray.origin.coords.abs().sum() + until;
        let place = |at: f64| Some(placed(pose, &ray.at(at))?.translation() / unit);
        let ends = [place(from)?, place(until)?];
        (ends, RAY * (size + pose.translation.vector.abs().sum()) / unit)
    } else {
        // From the stored origin, no length is longer than the ray or the body. The direction errs
        // by 80 UNIT, and the stored origin is put in double-double.
        let start = about_origins(&seen, [&frame.origin, &Vector3::zeros()])?.translation();
        let off = UNIT_DOUBLE_DOUBLE / UNIT * frame.origin.abs().sum();
        let size = radius + start.abs().sum() + until + off;
        let ends = [from, until].each(|at| (start + direction * at) / unit);
        (ends, 2.0 * RAY * size / unit)
    };
    Some(MeshRay {
        ends,
        error,
        direction,
        span: [from, until],
        length,
        width,
        #[cfg(feature = "exact")]
        exact: ExactRay::new(seen, ray.direction.into_inner(), frame.origin),
    })
}

/// Returns whether a ray starts in a solid or on its surface; `None` if rounding hides it.
fn begins_in(mesh: &Mesh, ray: &MeshRay) -> Option<bool> {
    let held = mesh.held_by_rounding(&ray.ends[0], ray.error);
    #[cfg(feature = "exact")]
    let held = held.or_else(|| Some(mesh.side_of(&ray.exact.origin(mesh.frame.exponent)) != PointSide::Outside));
    held
}

/// Returns the hit of a mesh at a pose, measured from the end of the safe segment.
///
/// `first` is a triangle near this point. It changes the time of the search, never the result.
pub(super) fn entered(
    mesh: &Mesh,
    pose: &Isometry3<f64>,
    ray: &Ray,
    [safe, hit]: [f64; 2],
    first: Option<u32>,
) -> RayCast {
    let pose = rigid(pose);
    let at = pose.inverse_transform_point(&ray.at(safe)).coords;
    let (point, normal, spot) = mesh.seen_from(&at, first);
    RayCast::Hit(RayHit {
        safe,
        hit,
        point: pose * point,
        // A sliver may have no normal.
        normal: Unit::try_new(pose.rotation * normal, 0.5).unwrap_or(-ray.direction),
        feature: Some(spot.feature),
        subshape: spot.subshape,
    })
}

/// Returns what the ray meets, if the result of a cast is not proven.
///
/// `None` if the result of the cast is right, if the body has no faces, or if its faces are flat
/// only up to rounding.
pub(super) fn proven(
    hull: &ConvexPolyhedron,
    pose: &Isometry3<f64>,
    ray: &Ray,
    span: [f64; 2],
    length: f64,
    width: f64,
    found: &RayCast,
) -> Option<Met> {
    if !matches!(found, RayCast::Hit(_) | RayCast::Undecided { .. }) || hull.face_count() == 0 {
        return None;
    }
    // In the unit of the body, products of three lengths do not underflow.
    let frame = StoredFrame::of(hull);
    let mut on_hull = in_body(GeometryRef::from(hull), &frame, pose, ray, span, length, width)?;
    if let RayCast::Hit(RayHit {
        safe,
        hit,
        feature: Some(Feature::Face(face)),
        ..
    }) = *found
    {
        let corners: [Option<VertexId>; 1] = [hull.face_vertices(face).next()];
        let pairs = hull.face_vertices(face).skip(1).zip(hull.face_vertices(face).skip(2));
        let is_through = |b, c| corners[0].is_some_and(|a| on_hull.passes(&corners_of(hull, [a, b, c]), [safe, hit]));
        if pairs.into_iter().any(|(b, c)| is_through(b, c)) {
            return None;
        }
    }
    if !are_flat(hull) {
        return None;
    }
    let mut met = Met::Nothing;
    let is_clear = hull
        .triangles()
        .all(|t| met.add(on_hull.meets(&corners_of(hull, t), hull.exponent)));
    is_clear.then_some(met)
}

/// Returns three vertices in stored coordinates.
fn corners_of(hull: &ConvexPolyhedron, vertices: [VertexId; 3]) -> [Vector3<f64>; 3] {
    vertices.each(|v| hull.points[v.index()])
}

/// Returns whether the vertices of each face are in one plane.
fn are_flat(hull: &ConvexPolyhedron) -> bool {
    let stored = |v: VertexId| -> &Vector3<f64> { &hull.points[v.index()] };
    hull.faces().all(|face| {
        let mut all = hull.face_vertices(face).map(stored);
        match (all.next(), all.next(), all.next()) {
            (Some(a), Some(b), Some(c)) => all.all(|p| sign::side(a, b, c, p) == 0.0),
            _ => true,
        }
    })
}
