//! Relative poses of parts that stand at poses of their own.

use nalgebra::{Isometry3, UnitQuaternion};

use crate::base::pose::RelativePose;
use crate::composite::parts::Parted;

/// Returns B in A's frame, right up to rounding.
pub(in crate::composite) fn relative(pose: &RelativePose) -> Isometry3<f64> {
    let (pose_a, pose_b) = pose.poses();
    let unit = |q: UnitQuaternion<f64>| UnitQuaternion::new_normalize(q.into_inner());
    let rotation = unit(unit(pose_a.rotation).inverse() * unit(pose_b.rotation));
    Isometry3::from_parts(pose.translation().into(), rotation)
}

/// From the pose of two bodies to those of their parts.
pub(crate) struct Placed<'a> {
    pose: &'a RelativePose,
    /// B in A's frame, if poses have to be composed.
    composed: Option<Isometry3<f64>>,
}

impl<'a> Placed<'a> {
    /// `is_in_place`: whether all parts of both bodies stand in the frames of the bodies.
    pub(crate) fn new(pose: &'a RelativePose, is_in_place: bool) -> Self {
        let composed = (!is_in_place).then(|| relative(pose));
        Self { pose, composed }
    }

    pub(in crate::composite) fn of(pose: &'a RelativePose, a: &impl Parted, b: &impl Parted) -> Self {
        Self::new(pose, a.is_in_place() && b.is_in_place())
    }

    /// Returns the relative pose of two parts, and whether it is the bodies' own without rounding.
    pub(crate) fn between(&self, p: &Isometry3<f64>, q: &Isometry3<f64>) -> (RelativePose, bool) {
        let Some(composed) = &self.composed else {
            return (*self.pose, true);
        };
        let mut placed = composed * q;
        placed.rotation = UnitQuaternion::new_normalize(placed.rotation.into_inner());
        RelativePose::new(p, &placed).map_or((*self.pose, false), |pose| (pose, false))
    }
}
