//! Trees of joints with branches, mimic joints and fixed joints.

use std::sync::Arc;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Quaternion, Unit, UnitQuaternion, Vector3};

use crate::arm::JointKind;
use crate::curve::JointCurve;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::space::{ConfigurationSpace, JointPath, check, check_bounds, within};
use crate::tree_motion::{LinkTree, TreeBodies, TreeSegment};
use lin_canny::RelativePose;
use lin_canny::{EXTENT_MAX, POSE_UNIT};

/// Sets the value of a joint: `factor` times a coordinate of the configuration, plus `offset`.
///
/// Joints with the same coordinate mimic each other.
#[derive(Clone, Copy, Debug, PartialEq)]
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

    fn check(&self, index: usize, limits: &[[f64; 2]]) -> Result<(), PlanError> {
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

/// A robot whose joints form a tree.
///
/// Each joint moves a link. A link carries any number of bodies and further joints. Coordinates
/// drive joints; one coordinate may drive several. Along a segment all joints move at constant
/// rates.
///
/// The frame of a link is the frame of its joint, moved by the value of the joint. Link 0 is the
/// base, and link k is moved by joint k - 1.
///
/// Two fingers of a gripper that open together:
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny_plan::{Checker, Drive, JointKind, JointTree, TreeJoint, World};
/// use lin_canny::polyhedron::solids;
///
/// let finger = |factor: f64| TreeJoint {
///     parent: 1,
///     kind: JointKind::Prismatic,
///     origin: Isometry3::translation(0.0, factor * 0.02, 0.1),
///     axis: Vector3::y_axis(),
///     drive: Some(Drive { coordinate: 1, factor, offset: 0.0 }),
/// };
/// let wrist = TreeJoint {
///     parent: 0,
///     kind: JointKind::Revolute,
///     origin: Isometry3::identity(),
///     axis: Vector3::z_axis(),
///     drive: Some(Drive::by(0)),
/// };
/// let joints = vec![wrist, finger(1.0), finger(-1.0)];
/// let limits = vec![[-3.0, 3.0], [0.0, 0.04]];
/// let (base, radii) = (Isometry3::identity(), vec![0.0, 0.0, 0.1, 0.1]);
/// let hand = JointTree::new(base, joints, limits, vec![2, 3], radii)?;
/// let rod = solids::cuboid(Vector3::new(0.01, 0.01, 0.05))?;
/// let mut world = World::new();
/// world.robot_body("left", rod.clone());
/// world.robot_body("right", rod);
///
/// let mut checker = Checker::new(hand, world)?;
/// let apart = checker.clearance(&[0.5, 0.03])?.unwrap().distance;
/// assert!((apart - 0.08).abs() < 1e-12);
/// assert!(checker.is_free(&[0.0, 0.04], &[2.0, 0.0])?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointTree {
    tree: LinkTree,
    limits: Vec<[f64; 2]>,
    scales: Vec<f64>,
    bodies: Arc<TreeBodies>,
    /// For each link, the first link that keeps its relative pose to it.
    rigid: Vec<usize>,
}

impl JointTree {
    /// Returns the robot whose base has the pose `base` in the world.
    ///
    /// `limits` are the limits of the coordinates. `links` gives the link of each body, in the
    /// order of the bodies. `radii` gives, for each link and the base first, the distance from the
    /// link's origin to the farthest point of its bodies. Together with the lengths of the links
    /// they set the length that corresponds to one radian of each coordinate.
    ///
    /// # Errors
    /// Returns an error if a pose, a limit or a radius is not finite or out of range, if a parent
    /// does not come before its joint, or if a link or coordinate does not exist.
    pub fn new(
        base: Isometry3<f64>,
        joints: Vec<TreeJoint>,
        limits: Vec<[f64; 2]>,
        links: Vec<usize>,
        radii: Vec<f64>,
    ) -> Result<Self, PlanError> {
        RelativePose::from_isometry(&base)?;
        check_bounds("limit of a joint", &limits)?;
        for (index, joint) in joints.iter().enumerate() {
            joint.check(index, &limits)?;
        }
        let refused = |what, value| Err(PlanError::Value { what, value });
        if radii.len() != joints.len() + 1 {
            return refused("number of radii", radii.len() as f64);
        }
        if let Some(&radius) = radii.iter().find(|r| !(0.0..=EXTENT_MAX).contains(*r)) {
            return refused("reach", radius);
        }
        if let Some(&link) = links.iter().find(|l| **l > joints.len()) {
            return refused("index of a link", link as f64);
        }
        Ok(Self {
            scales: scales(&joints, &limits, radii),
            rigid: rigid(&joints),
            tree: LinkTree::new(&base, joints),
            limits,
            bodies: Arc::new(TreeBodies {
                middles: std::vec![Point3::origin(); links.len()],
                links,
            }),
        })
    }

    /// Returns the pose of a link in the world at a configuration. Link 0 is the base.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid or the link does not exist.
    pub fn link_pose(&self, configuration: &[f64], link: usize) -> Result<Isometry3<f64>, PlanError> {
        self.check(configuration)?;
        let mut poses = Vec::new();
        self.tree.poses(configuration, &mut poses);
        poses.get(link).copied().ok_or(PlanError::Value {
            what: "index of a link",
            value: link as f64,
        })
    }

    /// Returns the link of each body.
    #[must_use]
    pub fn links(&self) -> &[usize] {
        &self.bodies.links
    }
}

/// Returns the length that corresponds to one unit of each coordinate.
///
/// It is the greatest value of the joints that the coordinate drives: the factor for a prismatic
/// joint, and the factor times the distance to the farthest moved point for a revolute joint. It is
/// 1 for a coordinate that moves nothing.
fn scales(joints: &[TreeJoint], limits: &[[f64; 2]], mut beyond: Vec<f64>) -> Vec<f64> {
    let mut scales = std::vec![0.0f64; limits.len()];
    for (index, joint) in joints.iter().enumerate().rev() {
        let mut reach = beyond[index + 1];
        if let Some(drive) = joint.drive {
            let scale = match joint.kind {
                JointKind::Revolute => reach,
                JointKind::Prismatic => {
                    let ends = limits[drive.coordinate].map(|q| (drive.factor * q + drive.offset).abs());
                    reach += ends[0].larger(ends[1]);
                    1.0
                }
            };
            scales[drive.coordinate] = scales[drive.coordinate].larger(scale * drive.factor.abs());
        }
        reach += joint.origin.translation.vector.norm();
        beyond[joint.parent] = beyond[joint.parent].larger(reach);
    }
    let known = |scale: f64| if scale > 0.0 { scale } else { 1.0 };
    scales.into_iter().map(known).collect()
}

/// Returns, for each link, the first link that fixed joints connect to it.
fn rigid(joints: &[TreeJoint]) -> Vec<usize> {
    let mut first = std::vec![0];
    for (index, joint) in joints.iter().enumerate() {
        let moves = joint.drive.is_some_and(|d| d.factor != 0.0);
        first.push(if moves { index + 1 } else { first[joint.parent] });
    }
    first
}

impl ConfigurationSpace for JointTree {
    type Segment = TreeSegment;

    fn coordinates(&self) -> usize {
        self.limits.len()
    }
    fn degrees_of_freedom(&self) -> usize {
        self.limits.len()
    }
    fn bodies(&self) -> usize {
        self.bodies.links.len()
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
        let links = self.tree.poses(q, poses);
        for &link in &self.bodies.links {
            poses.push(poses[link]);
        }
        poses.drain(..links);
    }

    fn segment(&self, from: &[f64], to: &[f64]) -> Result<TreeSegment, PlanError> {
        let curve = JointCurve::straight(from, to);
        Ok(TreeSegment::new(&self.tree, &self.bodies, curve))
    }

    fn curve(&self, curve: &JointCurve) -> Result<TreeSegment, PlanError> {
        curve.check(&self.limits)?;
        Ok(TreeSegment::new(&self.tree, &self.bodies, curve.clone()))
    }

    fn set_middles(&mut self, middles: &[Point3<f64>]) {
        let bodies = Arc::make_mut(&mut self.bodies);
        for (middle, given) in bodies.middles.iter_mut().zip(middles) {
            *middle = *given;
        }
    }

    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        from.iter().zip(to).map(|(a, b)| b - a).collect()
    }

    fn distance(&self, from: &[f64], to: &[f64]) -> f64 {
        let joints = from.iter().zip(to).zip(&self.scales);
        let squares = joints.map(|((a, b), scale)| ((b - a) * scale) * ((b - a) * scale));
        f64::sqrt(squares.sum())
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
        let mut pose = *self.tree.base();
        for (_, joint) in self.tree.path(self.bodies.links[body]) {
            pose = joint.after(&pose, joint.value(q));
            let Some(drive) = joint.drive else { continue };
            let axis = pose.rotation * joint.axis.into_inner();
            let change = match joint.kind {
                JointKind::Revolute => axis.dot(&(point - pose.translation.vector).coords.cross(direction)),
                JointKind::Prismatic => axis.dot(direction),
            };
            gradient[drive.coordinate] += change * drive.factor;
        }
    }

    fn is_rigid(&self, a: usize, b: usize) -> bool {
        self.rigid[self.bodies.links[a]] == self.rigid[self.bodies.links[b]]
    }

    fn joint_path(&self, body: usize) -> Option<JointPath> {
        let path = self.tree.path(self.bodies.links[body]);
        Some(JointPath {
            base: *self.tree.base(),
            joints: path.map(|(index, joint)| (index, joint.clone())).collect(),
        })
    }
}
