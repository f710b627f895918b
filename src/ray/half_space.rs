//! Rays against a half-space: a closed form.

use nalgebra::{Isometry3, Unit};

use super::{Ray, RayCast, RayHit, placed};
use crate::base::num::extremes::Bounded;
use crate::base::tolerance::{CERTIFICATE, RAY, UNIT};
use crate::body::polyhedron::{FaceId, Feature};
use crate::convex::contact::HalfSpace;

/// Returns where a ray enters a half-space at a pose.
///
/// The height of the origin and the pace at which the ray sinks are known up to rounding. The
/// quotients of their bounds are the bracket.
pub(super) fn entered(space: &HalfSpace, pose: &Isometry3<f64>, ray: &Ray, length: f64) -> RayCast {
    let Some(at) = placed(pose, &ray.origin) else {
        return RayCast::Undecided { safe: 0.0 };
    };
    let n = space.normal().into_inner();
    let height = n.dot(&at.translation()) - space.offset();
    let size = at.translation_sixteenth().abs().sum() + space.offset().abs() * 0.0625;
    let term = (CERTIFICATE * UNIT * 16.0) * size + f64::MIN_POSITIVE;
    if !(height > term) {
        return RayCast::Inside;
    }
    let out = pose.rotation * n;
    let pace = -out.dot(&ray.direction);
    if pace + RAY <= 0.0 {
        return RayCast::Miss;
    }
    // Rounded by a few units in addition.
    let safe = (height - term) / (pace + RAY) * (1.0 - RAY);
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
