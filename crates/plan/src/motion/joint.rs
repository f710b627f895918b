//! Joints: their kinds, what drives them, and how they move a link.

use nalgebra::{Isometry3, Quaternion, Unit, UnitQuaternion, Vector3};

use crate::error::PlanError;
use crate::extremes::Extremes;
use lin_canny::{EXTENT_MAX, POSE_UNIT, RelativePose};

/// The kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum JointKind {
    /// Rotates about its axis; values in radians.
    Revolute,
    /// Slides along its axis; values in the unit of length.
    Prismatic,
}

/// A joint of a serial arm ([`JointTree::serial`](crate::JointTree::serial)), and the link that the joint moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Pose of the joint's frame in the frame of the parent link.
    pub origin: Isometry3<f64>,
    /// Axis through the origin of the joint's frame, in that frame.
    pub axis: Unit<Vector3<f64>>,
    /// Least and greatest value.
    pub limits: [f64; 2],
}

impl Joint {
    /// Returns a joint that rotates about an axis.
    #[must_use]
    pub fn revolute(origin: Isometry3<f64>, axis: Unit<Vector3<f64>>, limits: [f64; 2]) -> Self {
        let kind = JointKind::Revolute;
        Self {
            kind,
            origin,
            axis,
            limits,
        }
    }

    /// Returns the three joints of a ball joint, all with the same limits.
    ///
    /// They turn about z, then y, then x of the frame at `origin`: yaw, pitch and roll. See
    /// [`TreeJoint::ball`]. The link that turns is the one that the last of them moves.
    #[must_use]
    pub fn ball(origin: Isometry3<f64>, limits: [f64; 2]) -> [Self; 3] {
        let joint = |origin, axis| Self::revolute(origin, axis, limits);
        let here = Isometry3::identity();
        [
            joint(origin, Vector3::z_axis()),
            joint(here, Vector3::y_axis()),
            joint(here, Vector3::x_axis()),
        ]
    }

    /// Returns a joint that slides along an axis.
    #[must_use]
    pub fn prismatic(origin: Isometry3<f64>, axis: Unit<Vector3<f64>>, limits: [f64; 2]) -> Self {
        let kind = JointKind::Prismatic;
        Self {
            kind,
            origin,
            axis,
            limits,
        }
    }
}

/// Sets the value of a joint: `factor` times a coordinate of the configuration, plus `offset`.
///
/// Joints with the same coordinate mimic each other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drive {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Change of the joint value per unit of the coordinate.
    pub factor: f64,
    /// Joint value at the coordinate 0.
    pub offset: f64,
}

impl Drive {
    /// Returns the drive of a joint whose value equals a coordinate.
    #[must_use]
    pub fn by(coordinate: usize) -> Self {
        Self {
            coordinate,
            factor: 1.0,
            offset: 0.0,
        }
    }
}

/// A joint of a tree, and the link that the joint moves.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TreeJoint {
    /// Parent link: 0 for the base, k for the link that joint k - 1 moves.
    pub parent: usize,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Pose of the joint's frame in the frame of the parent link.
    pub origin: Isometry3<f64>,
    /// Axis through the origin of the joint's frame, in that frame.
    pub axis: Unit<Vector3<f64>>,
    /// The coordinate that moves the joint. A joint without a drive is fixed at the value 0.
    pub drive: Option<Drive>,
}

impl TreeJoint {
    /// Returns a joint that never moves.
    #[must_use]
    pub fn fixed(parent: usize, origin: Isometry3<f64>) -> Self {
        Self {
            parent,
            kind: JointKind::Prismatic,
            origin,
            axis: Vector3::z_axis(),
            drive: None,
        }
    }

    /// Returns the three joints of a ball joint: joints `first` to `first + 2` of a tree.
    ///
    /// The link that turns is the last of theirs, link `first + 3`. Coordinates `coordinate` to
    /// `coordinate + 2` are roll, pitch and yaw in radians: the link turns about x by roll, then about
    /// y by pitch, then about z by yaw, all of them axes of the joint's frame, which do not turn. So a
    /// proof for three revolute joints holds for a ball joint. At a pitch of a quarter turn, a change
    /// of roll and one of yaw turn the link in the same way; elsewhere, each small rotation is a small
    /// change of the three angles. A straight motion of the angles is not the shortest rotation.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, UnitQuaternion};
    /// use lin_canny_plan::{JointTree, TreeJoint};
    ///
    /// let joints = TreeJoint::ball(0, 0, Isometry3::translation(0.0, 0.0, 1.0), 0);
    /// let limits = vec![[-4.0, 4.0]; 3];
    /// let tree = JointTree::new(Isometry3::identity(), joints.to_vec(), limits, vec![3], vec![0.5; 4])?;
    /// let found = tree.link_pose(&[0.3, -0.2, 1.5], 3)?;
    /// assert!(found.rotation.angle_to(&UnitQuaternion::from_euler_angles(0.3, -0.2, 1.5)) < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn ball(first: usize, parent: usize, origin: Isometry3<f64>, coordinate: usize) -> [Self; 3] {
        let joint = |parent, origin, axis, coordinate| Self {
            parent,
            kind: JointKind::Revolute,
            origin,
            axis,
            drive: Some(Drive::by(coordinate)),
        };
        let here = Isometry3::identity();
        [
            joint(parent, origin, Vector3::z_axis(), coordinate + 2),
            joint(first + 1, here, Vector3::y_axis(), coordinate + 1),
            joint(first + 2, here, Vector3::x_axis(), coordinate),
        ]
    }

    /// Returns the joint value at a configuration.
    pub(crate) fn value(&self, configuration: &[f64]) -> f64 {
        self.drive
            .map_or(0.0, |d| d.factor * configuration[d.coordinate] + d.offset)
    }

    /// Returns the rotation by a value of a revolute joint.
    fn turned(&self, value: f64) -> Quaternion<f64> {
        let (sine, cosine) = libm::sincos(0.5 * value);
        Quaternion::from_parts(cosine, self.axis.into_inner() * sine)
    }

    /// Returns the pose of the link relative to the joint's frame.
    pub(crate) fn moved(&self, value: f64) -> Isometry3<f64> {
        match self.kind {
            JointKind::Revolute => {
                let turn = UnitQuaternion::new_unchecked(self.turned(value));
                Isometry3::from_parts(Vector3::zeros().into(), turn)
            }
            JointKind::Prismatic => {
                let way = self.axis.into_inner() * value;
                Isometry3::from_parts(way.into(), UnitQuaternion::identity())
            }
        }
    }

    /// Returns the pose of the joint's link from the pose of the parent link, whose rotation has
    /// unit length up to rounding.
    pub(crate) fn after(&self, parent: &Isometry3<f64>, value: f64) -> Isometry3<f64> {
        self.after_origin(parent, &(parent.rotation * self.origin.translation.vector), value)
    }

    /// Returns the pose of the joint's link from the pose of the parent link and the vector in the
    /// world between their origins at the value 0.
    #[inline]
    pub(crate) fn after_origin(&self, parent: &Isometry3<f64>, apart: &Vector3<f64>, value: f64) -> Isometry3<f64> {
        let mut place = parent.translation.vector + apart;
        let frame = parent.rotation * self.origin.rotation;
        let turned = match self.kind {
            // A joint without drive stays at 0.
            _ if self.drive.is_none() => frame.into_inner(),
            JointKind::Revolute => frame.into_inner() * self.turned(value),
            JointKind::Prismatic => {
                place += frame * (self.axis.into_inner() * value);
                frame.into_inner()
            }
        };
        // One step of Newton's method: the squared norm errs by a few units of rounding.
        let unit = turned.coords * (1.5 - 0.5 * turned.norm_squared());
        Isometry3::from_parts(place.into(), UnitQuaternion::new_unchecked(unit.into()))
    }

    pub(crate) fn check(&self, index: usize, limits: &[[f64; 2]]) -> Result<(), PlanError> {
        RelativePose::from_isometry(&self.origin)?;
        let refused = |what, value| Err(PlanError::Value { what, value });
        let square = self.axis.norm_squared();
        if !((square - 1.0).abs() <= POSE_UNIT) {
            return refused("squared length of a joint axis", square);
        }
        if self.parent > index {
            return refused("index of a parent link", self.parent as f64);
        }
        let Some(drive) = self.drive else {
            return Ok(());
        };
        let Some([low, high]) = limits.get(drive.coordinate) else {
            return refused("coordinate index of a drive", drive.coordinate as f64);
        };
        let most = drive.factor.abs() * low.abs().larger(high.abs()) + drive.offset.abs();
        if most <= EXTENT_MAX {
            Ok(())
        } else {
            refused("joint value", most)
        }
    }
}
