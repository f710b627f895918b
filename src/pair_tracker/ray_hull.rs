//! Ray casts of polyhedra: what the cast of a point found, proven for the ray as the caller gave
//! it.
//!
//! The places of the point are rounded, so a hit that is as near the boundary of the hull as
//! rounding may be a miss. Mostly a triangle of the face that was found proves the hit; else all
//! triangles are asked over the integers.

use nalgebra::{Isometry3, Vector3};

use super::ray::{Ray, RayCast, RayHit};
use super::ray_mesh::in_body;
use crate::base::num::sign;
use crate::body::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::composite::meet::ray::{Met, RayBody};
use crate::pair_tracker::geometry::GeometryRef;

/// Returns what the ray meets, if what a cast found is not proven: `None` if the cast is right as
/// it is, and for bodies without faces or with faces that are flat only up to rounding.
pub(super) fn proven(
    hull: &ConvexPolyhedron,
    pose: &Isometry3<f64>,
    ray: &Ray,
    (span, limits): ((f64, f64), (f64, f64)),
    found: &RayCast,
) -> Option<Met> {
    if !matches!(found, RayCast::Hit(_) | RayCast::Near { .. }) || hull.face_count() == 0 {
        return None;
    }
    let mut on_hull = in_body(GeometryRef::from(hull), 1.0, pose, ray, span, limits)?;
    if let RayCast::Hit(RayHit {
        safe,
        hit,
        feature: Some(Feature::Face(face)),
        ..
    }) = *found
    {
        let corners: [Option<VertexId>; 1] = [hull.face_vertices(face).next()];
        let pairs = hull.face_vertices(face).skip(1).zip(hull.face_vertices(face).skip(2));
        let is_through = |b, c| corners[0].is_some_and(|a| on_hull.passes(&placed(hull, [a, b, c]), (safe, hit)));
        if pairs.into_iter().any(|(b, c)| is_through(b, c)) {
            return None;
        }
    }
    if !are_flat(hull) {
        return None;
    }
    let body = RayBody {
        exponent: 0,
        is_closed: !hull.is_flat,
    };
    let mut met = Met::Nothing;
    let is_clear = hull.triangles().all(|t| met.add(on_hull.meets(&placed(hull, t), body)));
    is_clear.then_some(met)
}

fn placed(hull: &ConvexPolyhedron, vertices: [VertexId; 3]) -> [Vector3<f64>; 3] {
    vertices.map(|v| hull.to_user(&hull.points[v.index()]).coords)
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
