//! Serial arms of revolute and prismatic joints.

use alloc::vec::Vec;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use super::arm_motion::{ArmSegment, Chain};
use super::error::PlanError;
use super::space::{ConfigurationSpace, check, check_bounds, within};
use crate::pose::{RelativePose, normalize};
use crate::tolerance::EXTENT_MAX;

/// The kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about its axis; values are radians.
    Revolute,
    /// Slides along its axis; values are lengths.
    Prismatic,
}

/// A joint of a serial arm, and the link that the joint moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The kind.
    pub kind: JointKind,
    /// The pose of the joint's frame in the frame of the link before.
    pub origin: Isometry3<f64>,
    /// The axis through the origin of the joint's frame, in that frame.
    pub axis: Unit<Vector3<f64>>,
    /// Least and greatest value.
    pub limits: [f64; 2],
}

impl Joint {
    /// Returns a joint that turns.
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

    /// Returns a joint that slides.
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

/// A serial arm: joints in a chain, each of which moves a link; a link carries any number of
/// bodies. A configuration holds the value of each joint, and each joint moves evenly along a
/// segment.
///
/// The frame of a link is the frame of its joint, moved by the value of the joint. Link 0 is the
/// base, and link k is moved by joint k - 1.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::plan::{Checker, Joint, SerialArm, Verdict, World};
/// use lin_canny::polyhedron::solids;
///
/// // Two links in the plane, each one long.
/// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
/// let turn = |x: f64| Joint::revolute(at(x), Vector3::z_axis(), [-3.0, 3.0]);
/// let base = Isometry3::identity();
/// let arm = SerialArm::new(base, vec![turn(0.0), turn(1.0)], vec![1, 2], 1.0)?;
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
#[derive(Clone, Debug)]
pub struct SerialArm {
    chain: Chain,
    limits: Vec<[f64; 2]>,
    scales: Vec<f64>,
    links: Vec<usize>,
}

impl SerialArm {
    /// Returns the arm whose base stands at a pose of the world. `links` names the link of each
    /// body, in the order of the bodies; `reach` is the length from the last joint to the farthest
    /// point of the arm, and sets with the lengths of the links the length that a radian of each
    /// joint stands for.
    ///
    /// # Errors
    /// Poses, limits or a reach that are not finite or out of range, or a link that does not exist.
    pub fn new(base: Isometry3<f64>, joints: Vec<Joint>, links: Vec<usize>, reach: f64) -> Result<Self, PlanError> {
        RelativePose::from_isometry(&base)?;
        for joint in &joints {
            RelativePose::from_isometry(&joint.origin)?;
            check_bounds("limit of a joint", &[joint.limits])?;
            let value = joint.axis.norm_squared();
            if !((value - 1.0).abs() <= crate::tolerance::POSE_UNIT) {
                let what = "length of an axis";
                return Err(PlanError::Value { what, value });
            }
        }
        if !(reach > 0.0 && reach <= EXTENT_MAX) {
            return Err(PlanError::Value {
                what: "reach",
                value: reach,
            });
        }
        if let Some(link) = links.iter().find(|l| **l > joints.len()) {
            return Err(PlanError::Value {
                what: "number of a link",
                value: *link as f64,
            });
        }
        let limits = joints.iter().map(|j| j.limits).collect();
        Ok(Self {
            scales: scales(&joints, reach),
            chain: Chain::new(&base, joints),
            limits,
            links,
        })
    }

    /// Returns the pose of a link at a configuration: 0 for the base.
    ///
    /// # Errors
    /// A configuration that is not of the space, or a link that does not exist.
    pub fn link_pose(&self, configuration: &[f64], link: usize) -> Result<Isometry3<f64>, PlanError> {
        self.check(configuration)?;
        let pose = self.chain.poses(configuration).nth(link);
        pose.ok_or(PlanError::Value {
            what: "number of a link",
            value: link as f64,
        })
    }

    /// Returns the link of each body.
    #[must_use]
    pub fn links(&self) -> &[usize] {
        &self.links
    }
}

/// The length of a unit of each joint: 1 for a slide, the distance to the farthest point of the arm
/// for a turn.
fn scales(joints: &[Joint], reach: f64) -> Vec<f64> {
    let mut beyond = reach;
    let mut scales: Vec<f64> = joints
        .iter()
        .rev()
        .map(|joint| {
            let scale = match joint.kind {
                JointKind::Revolute => beyond,
                JointKind::Prismatic => {
                    beyond += joint.limits[0].abs().max(joint.limits[1].abs());
                    1.0
                }
            };
            beyond += joint.origin.translation.vector.norm();
            scale
        })
        .collect();
    scales.reverse();
    scales
}

impl ConfigurationSpace for SerialArm {
    type Segment = ArmSegment;

    fn coordinates(&self) -> usize {
        self.limits.len()
    }
    fn freedom(&self) -> usize {
        self.limits.len()
    }
    fn bodies(&self) -> usize {
        self.links.len()
    }
    fn bounds(&self) -> &[[f64; 2]] {
        &self.limits
    }
    fn scales(&self) -> &[f64] {
        &self.scales
    }
    fn check(&self, q: &[f64]) -> Result<(), PlanError> {
        check(q, self.limits.len(), &self.limits)
    }

    fn place(&self, q: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        let of_links: Vec<_> = self.chain.poses(q).collect();
        poses.clear();
        poses.extend(self.links.iter().map(|&link| of_links[link]));
    }

    fn segment(&self, from: &[f64], to: &[f64]) -> Result<ArmSegment, PlanError> {
        Ok(ArmSegment::new(&self.chain, &self.links, from, to))
    }

    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        from.iter().zip(to).map(|(a, b)| b - a).collect()
    }

    fn moved(&self, q: &[f64], step: &[f64]) -> Vec<f64> {
        let joints = q.iter().zip(step).zip(&self.limits);
        joints.map(|((x, dx), limits)| within(x + dx, *limits)).collect()
    }

    fn sample(&self, uniform: &mut dyn FnMut() -> f64) -> Vec<f64> {
        let each = self.limits.iter();
        each.map(|[low, high]| low + (high - low) * uniform()).collect()
    }

    fn gradient(&self, q: &[f64], body: usize, point: &Point3<f64>, direction: &Vector3<f64>, gradient: &mut [f64]) {
        gradient.fill(0.0);
        let poses = self.chain.poses(q).skip(1);
        let joints = self.chain.joints().iter().zip(poses).take(self.links[body]);
        for (value, (joint, pose)) in gradient.iter_mut().zip(joints) {
            let axis = pose.rotation * joint.axis.into_inner();
            *value = match joint.kind {
                JointKind::Revolute => axis.dot(&(point - pose.translation.vector).coords.cross(direction)),
                JointKind::Prismatic => axis.dot(direction),
            };
        }
    }

    fn is_rigid(&self, a: usize, b: usize) -> bool {
        self.links[a] == self.links[b]
    }
}

impl Joint {
    /// Returns the pose that the value of the joint adds.
    pub(super) fn moved(&self, value: f64) -> Isometry3<f64> {
        match self.kind {
            JointKind::Revolute => {
                let spin = crate::motion::Velocity::new(Vector3::zeros(), self.axis.into_inner() * value);
                spin.applied(&Isometry3::identity(), 1.0)
            }
            JointKind::Prismatic => Isometry3::from_parts(
                (self.axis.into_inner() * value).into(),
                nalgebra::UnitQuaternion::identity(),
            ),
        }
    }

    /// Returns the pose of the link after the joint from the pose of the link before.
    pub(super) fn after(&self, parent: &Isometry3<f64>, value: f64) -> Isometry3<f64> {
        normalize(&(parent * self.origin * self.moved(value)))
    }
}
