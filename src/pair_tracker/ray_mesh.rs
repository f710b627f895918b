//! Ray casts of meshes: what a ray first meets, by exact predicates.

use nalgebra::{Isometry3, Unit};

use super::ray::{Ray, RayCast, RayHit, placed};
use crate::base::tolerance::RAY;
#[cfg(feature = "exact")]
use crate::composite::meet::exact::ExactRay;
#[cfg(feature = "exact")]
use crate::composite::meet::exact::PointSide;
use crate::composite::meet::ray::{MeshRay, Met};
use crate::composite::mesh::Mesh;
use crate::pair_tracker::geometry::GeometryRef;

/// Returns the answer of a mesh by the triangle that a part of the ray first meets. `None` if
/// rounding hides the answer: never with the feature `exact`, but for places out of range.
pub(super) fn pierce(
    mesh: &Mesh,
    pose: &Isometry3<f64>,
    ray: &Ray,
    (from, until): (f64, f64),
    (length, width): (f64, f64),
) -> Option<RayCast> {
    let mut on_mesh = in_body(mesh.into(), mesh.unit(), pose, ray, (from, until), (length, width))?;
    if from == 0.0 && begins_in(mesh, &on_mesh)? {
        return Some(RayCast::Inside);
    }
    Some(match mesh.first_met(&mut on_mesh)? {
        Met::Nothing => RayCast::Miss,
        Met::Between(safe, hit) => entered(mesh, pose, ray, (safe, hit)),
    })
}

/// Returns a part of a ray in the frame of a body at a pose, in a unit of length; `None` if the
/// body is out of range.
pub(super) fn in_body(
    body: GeometryRef,
    unit: f64,
    pose: &Isometry3<f64>,
    ray: &Ray,
    (from, until): (f64, f64),
    (length, width): (f64, f64),
) -> Option<MeshRay> {
    let (centre, radius) = body.bounding_ball();
    let size = radius + centre.coords.abs().sum() + ray.origin.coords.abs().sum() + until;
    let seen = placed(pose, &ray.origin)?;
    let place = |at: f64| Some(placed(pose, &ray.at(at))?.translation() / unit);
    Some(MeshRay {
        ends: [place(from)?, place(until)?],
        error: RAY * (size + pose.translation.vector.abs().sum()) / unit,
        direction: seen.rotation() * ray.direction.into_inner(),
        span: (from, until),
        length,
        width,
        #[cfg(feature = "exact")]
        exact: ExactRay::new(seen, ray.direction.into_inner()),
    })
}

/// Returns whether a ray begins in a solid or on the surface; `None` if rounding hides it.
fn begins_in(mesh: &Mesh, ray: &MeshRay) -> Option<bool> {
    let held = mesh.held_by_rounding(&ray.ends[0], ray.error);
    #[cfg(feature = "exact")]
    let held = held.or_else(|| Some(mesh.side_of(&ray.exact.origin(mesh.exponent)) != PointSide::Outside));
    held
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
