//! Ray casts of meshes: the triangle that a ray first passes through, by exact predicates.

use nalgebra::{Isometry3, Unit};

use super::ray::{Ray, RayCast, RayHit, placed};
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::RAY;
use crate::base::tuning::impact::RAY_CROSSINGS;
use crate::composite::mesh::Mesh;
use crate::pair_tracker::geometry::GeometryRef;

/// Returns the answer of a mesh by the triangle that a part of the ray first passes through, up to
/// rounding: the part before it is apart from the mesh, and a short piece there crosses it, both
/// proven. `None` if either proof fails, or if the origin lies in the mesh or is too near to tell.
pub(super) fn pierce(
    mesh: &Mesh,
    pose: &Isometry3<f64>,
    ray: &Ray,
    (from, until): (f64, f64),
    width: f64,
) -> Option<RayCast> {
    let (centre, radius) = GeometryRef::from(mesh).bounding_ball();
    let size = radius + centre.coords.abs().sum() + ray.origin.coords.abs().sum() + until;
    let apart = RAY * (size + pose.translation.vector.abs().sum()) / mesh.unit();
    let piece = |from: f64, until: f64| {
        let place = |at: f64| Some(placed(pose, &ray.at(at))?.translation() / mesh.unit());
        Some((place(from)?, place(until)?))
    };
    let (start, end) = piece(from, until)?;
    if from == 0.0 && mesh.holds_point(&start, apart) != Some(false) {
        return None;
    }
    let met = mesh.first_crossing(&start, &end, 0.0);
    let safe = met.map_or(until, |part| from + part * (until - from) - width);
    let (start, end) = piece(from, safe)?;
    if safe <= from || !mesh.is_clear_of_segment(&start, &end, apart) {
        return None;
    }
    if met.is_none() {
        return Some(RayCast::Miss);
    }
    let hit = (1..RAY_CROSSINGS).find_map(|k| {
        let until = (safe + width * f64::from(1u32 << k)).smaller(until);
        let (start, end) = piece(safe, until)?;
        mesh.is_crossed(&start, &end, 0.0).then_some(until)
    })?;
    Some(entered(mesh, pose, ray, (safe, hit)))
}

/// Returns the hit of a mesh at a pose: what the end of the safe part sees.
pub(super) fn entered(mesh: &Mesh, pose: &Isometry3<f64>, ray: &Ray, (safe, hit): (f64, f64)) -> RayCast {
    let at = pose.inverse_transform_point(&ray.at(safe)).coords;
    let (point, normal, spot) = mesh.seen_from(&at);
    RayCast::Hit(RayHit {
        safe,
        hit,
        point: pose * point,
        // A sliver may have no normal.
        normal: Unit::try_new(pose.rotation * normal, 0.5).unwrap_or(-ray.direction),
        feature: Some(spot.feature),
        part: spot.part,
    })
}
