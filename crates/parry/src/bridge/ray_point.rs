//! Ray and point queries of a geometry of [`lin_canny`].

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, PairTracker, Ray as CoreRay, RayCast, RayCaster, RelativePose};

use super::number::{narrow, wide, wide_point};
use super::parry::math::{Real, Vector};
use super::parry::query::{PointProjection, Ray, RayIntersection};
use super::parry::shape::FeatureId;

/// Returns where a ray enters a geometry; its start if the start is inside.
pub(super) fn cast_ray(geometry: &Geometry, ray: &Ray, max: Real) -> Option<RayIntersection> {
    let (origin, speed) = (wide_point(ray.origin), wide(ray.dir).norm());
    let along = CoreRay::new(origin, wide(ray.dir)).ok()?;
    let length = f64::from(max) * speed;
    let cast = RayCaster::new().cast(geometry, &Isometry3::identity(), &along, length);
    let hit = |distance: f64, normal: Vector3<f64>, part: u32| {
        let feature = FeatureId::Face(part);
        RayIntersection::new((distance / speed) as Real, narrow(&normal), feature)
    };
    match cast.ok()? {
        RayCast::Hit(found) => Some(hit(found.hit, found.normal.into_inner(), found.subshape)),
        RayCast::Inside => Some(hit(0.0, Vector3::zeros(), 0)),
        _ => None,
    }
}

/// Returns the closest point of a geometry to a point.
///
/// For a point inside, returns the closest point of the boundary unless `is_filled`.
pub(super) fn project(geometry: &Geometry, pt: Vector, is_filled: bool) -> PointProjection {
    let at = RelativePose::from_isometry(&Isometry3::from(wide(pt)));
    let (Ok(point), Ok(at)) = (ConvexPolyhedron::point(Point3::origin()), at) else {
        return PointProjection::new(false, pt);
    };
    let found = PairTracker::new().closest(geometry, &point, &at).outcome;
    let is_inside = !(found.distance > 0.0);
    if is_inside && is_filled {
        return PointProjection::new(true, pt);
    }
    PointProjection::new(is_inside, narrow(&found.point_on_a.coords))
}
