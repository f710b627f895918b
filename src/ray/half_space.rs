//! Rays against a half-space: a closed form.

#[cfg(feature = "exact")]
use nalgebra::Vector3;
use nalgebra::{Isometry3, Unit};

use super::{Ray, RayCast, RayHit, placed};
use crate::base::num::extremes::Bounded;
use crate::base::pose::{RelativePose, rigid};
use crate::base::tolerance::{CERTIFICATE, RAY, UNIT};
use crate::body::polyhedron::{FaceId, Feature};
use crate::convex::contact::HalfSpace;
#[cfg(feature = "exact")]
use crate::convex::exact::place::ExactVector;

/// Returns where a ray enters a half-space at a pose.
///
/// The height of the origin and the pace at which the ray sinks are known up to rounding. The
/// quotients of their bounds are the bracket. The side of the origin is exact with the feature
/// `exact`; without it, an origin within rounding of the plane counts as inside.
pub(super) fn entered(space: &HalfSpace, pose: &Isometry3<f64>, ray: &Ray, length: f64) -> RayCast {
    let Some(at) = placed(pose, &ray.origin) else {
        return RayCast::Undecided { safe: 0.0 };
    };
    let n = space.normal().into_inner();
    let height = n.dot(&at.translation()) - space.offset();
    let size = at.translation_sixteenth().abs().sum() + space.offset().abs() * 0.0625;
    let term = (CERTIFICATE * UNIT * 16.0) * size + f64::MIN_POSITIVE;
    // Written so that NaN is within rounding.
    if !(height > term) && (height < -term || !is_above(space, &at)) {
        return RayCast::Inside;
    }
    let out = rigid(pose).rotation * n;
    let pace = -out.dot(&ray.direction);
    if pace + RAY <= 0.0 {
        return RayCast::Miss;
    }
    // Rounded by a few units in addition.
    let safe = (height - term).at_least(0.0) / (pace + RAY) * (1.0 - RAY);
    if safe > length {
        return RayCast::Miss;
    }
    let hit = (height + term) / (pace - RAY) * (1.0 + RAY);
    if !(pace > RAY && hit <= length.at_most(f64::MAX)) {
        return RayCast::Undecided { safe };
    }
    let on_plane = ray.at(safe) - out * ((height - safe * pace).at_least(0.0));
    RayCast::Hit(RayHit {
        safe,
        hit,
        point: on_plane,
        normal: Unit::new_normalize(out),
        feature: Some(Feature::Face(FaceId(0))),
        subshape: 0,
    })
}

/// Returns whether a point, at the origin of B's frame, is certainly above the plane.
#[cfg(feature = "exact")]
#[cold]
fn is_above(space: &HalfSpace, at: &RelativePose) -> bool {
    let point = ExactVector::new(&Vector3::zeros()).in_a(at);
    point.compare_along(&space.normal(), space.offset()).is_gt()
}

#[cfg(not(feature = "exact"))]
fn is_above(_: &HalfSpace, _: &RelativePose) -> bool {
    false
}
