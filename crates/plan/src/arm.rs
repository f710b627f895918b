//! Serial arms of revolute and prismatic joints.

use std::vec::Vec;

use nalgebra::{Isometry3, Unit, Vector3};

use crate::error::PlanError;
use crate::tree::{Drive, JointTree, TreeJoint};

/// The kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointKind {
    /// Rotates about its axis; values in radians.
    Revolute,
    /// Slides along its axis; values in the unit of length.
    Prismatic,
}

/// A joint of a serial arm ([`JointTree::serial`]), and the link that the joint moves.
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

impl JointTree {
    /// Returns a serial arm: joints in a chain, each of which moves a link and has a coordinate.
    ///
    /// The base has the pose `base` in the world. `links` gives the link of each body, in the order
    /// of the bodies: link 0 is the base, and link k is moved by joint k - 1. `reach` is the distance
    /// from the last joint to the farthest point of the arm. Together with the lengths of the links
    /// it sets the length that corresponds to one radian of each joint.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny_plan::{Checker, Joint, JointTree, Verdict, World};
    /// use lin_canny::polyhedron::solids;
    ///
    /// // Two links in the plane, each one long.
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let turn = |x: f64| Joint::revolute(at(x), Vector3::z_axis(), [-3.0, 3.0]);
    /// let base = Isometry3::identity();
    /// let arm = JointTree::serial(base, vec![turn(0.0), turn(1.0)], vec![1, 2], 1.0)?;
    /// let rod = solids::cuboid(Vector3::new(0.4, 0.05, 0.05))?.transformed(&at(0.5))?;
    /// let mut world = World::new();
    /// world.robot_body("upper arm", rod.clone());
    /// world.robot_body("fore arm", rod);
    /// let post = solids::cuboid(Vector3::new(0.1, 0.1, 1.0))?;
    /// let side = Isometry3::translation(0.0, 1.5, 0.0);
    /// world.obstacle("post", post, side);
    ///
    /// let mut checker = Checker::new(arm, world)?;
    /// assert!(checker.certify(&[0.0, 0.0], &[0.8, 1.0])?.is_free());
    /// let verdict = checker.certify(&[0.0, 0.0], &[2.5, 0.0])?;
    /// let Verdict::Blocked { t, pair, .. } = verdict else {
    ///     panic!("the arm hits the post")
    /// };
    /// assert!(t > 0.5 && t < 0.7);
    /// assert_eq!(checker.name(pair.b), "post");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a pose, a limit or `reach` is not finite or out of range, or if a link
    /// does not exist.
    pub fn serial(base: Isometry3<f64>, joints: Vec<Joint>, links: Vec<usize>, reach: f64) -> Result<Self, PlanError> {
        if !(reach > 0.0) {
            return Err(PlanError::Value {
                what: "reach",
                value: reach,
            });
        }
        let limits = joints.iter().map(|joint| joint.limits).collect();
        let mut reaches = std::vec![0.0; joints.len()];
        reaches.push(reach);
        let chain = joints.into_iter().enumerate().map(|(index, joint)| TreeJoint {
            parent: index,
            kind: joint.kind,
            origin: joint.origin,
            axis: joint.axis,
            drive: Some(Drive::by(index)),
        });
        Self::new(base, chain.collect(), limits, links, reaches)
    }
}
