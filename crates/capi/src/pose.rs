//! Poses, vectors and features of C.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::{ContactState, Feature, Velocity};

/// A pose: a translation, then a unit quaternion x, y, z, w.
///
/// The squared norm of the quaternion must be within 1e-12 of 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_pose {
    /// The translation.
    pub translation: [f64; 3],
    /// The unit quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// A body at a constant velocity, from time zero.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_motion {
    /// The pose at time zero.
    pub pose: lc_pose,
    /// The velocity of the origin of the body in the world, in lengths per time.
    pub linear: [f64; 3],
    /// The angular velocity in the world, in radians per time.
    pub angular: [f64; 3],
}

#[inline(always)]
pub(crate) fn isometry(pose: &lc_pose) -> Isometry3<f64> {
    let ([x, y, z], [i, j, k, w]) = (pose.translation, pose.rotation);
    Isometry3::from_parts(
        Translation3::from(Vector3::new(x, y, z)),
        UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
    )
}

pub(crate) fn pose_of(pose: &Isometry3<f64>) -> lc_pose {
    lc_pose {
        translation: pose.translation.vector.into(),
        rotation: pose.rotation.coords.into(),
    }
}

pub(crate) fn velocity(linear: [f64; 3], angular: [f64; 3]) -> Velocity {
    Velocity::new(linear.into(), angular.into())
}

pub(crate) fn points(xyz: &[f64]) -> Vec<Point3<f64>> {
    let (triples, _) = xyz.as_chunks::<3>();
    triples.iter().map(|p| Point3::from(*p)).collect()
}

/// Bodies are proven apart.
pub const LC_SEPARATED: u32 = 0;
/// Bodies touch, or the bounds do not decide and no finer arithmetic exists.
pub const LC_TOUCHING: u32 = 1;
/// Bodies are proven to share an inner point.
pub const LC_OVERLAPPING: u32 = 2;
/// The bounds do not decide.
pub const LC_UNDECIDED: u32 = 3;

#[inline(always)]
pub(crate) fn state(state: ContactState) -> u32 {
    match state {
        ContactState::Separated => LC_SEPARATED,
        ContactState::Touching => LC_TOUCHING,
        ContactState::Overlapping => LC_OVERLAPPING,
        _ => LC_UNDECIDED,
    }
}

/// Returns the dimension and the index of a feature.
#[inline(always)]
pub(crate) fn feature(feature: Feature) -> [u32; 2] {
    [feature.dimension() as u32, feature.index() as u32]
}
