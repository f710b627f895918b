//! Trees of joints with branches, mimic joints and fixed joints.

use std::sync::Arc;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::curve::JointCurve;
use crate::motion::joint::{Drive, Joint, JointKind, TreeJoint};
use crate::motion::space::{ConfigurationSpace, JointPath, check, check_bounds, overwrite, within};
use crate::motion::tree_motion::{LinkTree, TreeBodies, TreeSegment};
use lin_canny::EXTENT_MAX;
use lin_canny::RelativePose;

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
/// use lin_canny_plan::{Checker, Drive, JointKind, JointMotion, JointTree, TreeJoint, Cell};
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
/// let mut cell = Cell::new();
/// cell.robot_body("left", rod.clone());
/// cell.robot_body("right", rod);
///
/// let mut checker = Checker::new(hand, cell)?;
/// let apart = checker.clearance(&[0.5, 0.03])?.unwrap().distance;
/// assert!((apart - 0.08).abs() < 1e-12);
/// assert!(checker.is_free(&JointMotion::segment(&[0.0, 0.04], &[2.0, 0.0]))?);
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
        overwrite(&mut Arc::make_mut(&mut self.bodies).middles, middles);
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
    /// use lin_canny_plan::{Checker, Joint, JointMotion, JointTree, Verdict, Cell};
    /// use lin_canny::polyhedron::solids;
    ///
    /// // Two links in the plane, each one long.
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let turn = |x: f64| Joint::revolute(at(x), Vector3::z_axis(), [-3.0, 3.0]);
    /// let base = Isometry3::identity();
    /// let arm = JointTree::serial(base, vec![turn(0.0), turn(1.0)], vec![1, 2], 1.0)?;
    /// let rod = solids::cuboid(Vector3::new(0.4, 0.05, 0.05))?.transformed(&at(0.5))?;
    /// let mut cell = Cell::new();
    /// cell.robot_body("upper arm", rod.clone());
    /// cell.robot_body("fore arm", rod);
    /// let post = solids::cuboid(Vector3::new(0.1, 0.1, 1.0))?;
    /// let side = Isometry3::translation(0.0, 1.5, 0.0);
    /// cell.add_obstacle("post", post, side)?;
    ///
    /// let mut checker = Checker::new(arm, cell)?;
    /// assert!(checker.certify(&JointMotion::segment(&[0.0, 0.0], &[0.8, 1.0]))?.is_free());
    /// let verdict = checker.certify(&JointMotion::segment(&[0.0, 0.0], &[2.5, 0.0]))?;
    /// let Verdict::Blocked { contact_at: t, pair, .. } = verdict else {
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
