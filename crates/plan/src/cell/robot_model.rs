//! Links, joints and coordinates of a robot, and the tree that all robots of a cell make.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::string::String;
use std::vec::Vec;

use nalgebra::{Isometry3, Quaternion, Unit, UnitQuaternion, Vector3};

use crate::error::PlanError;
use crate::motion::joint::{Drive, JointKind, TreeJoint};
use lin_canny::{Geometry, HullFit};

/// The kind of a joint of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MotionKind {
    /// Rotates about its axis, with or without limits.
    Revolute,
    /// Slides along its axis.
    Prismatic,
    /// Never moves.
    Fixed,
    /// Slides in the plane perpendicular to its axis and rotates about the axis: coordinates `x`,
    /// `y` and `theta`.
    Planar,
    /// Rotates about the origin of its frame: the angles `roll`, `pitch` and `yaw` as in `rpy`. The
    /// rotation is that about z by yaw, then about the rotated y by pitch, then about the rotated x by
    /// roll, in radians. Along a straight motion all three angles change at constant rates.
    Ball,
    /// Moves freely: coordinates `x`, `y`, `z`, and the angles `roll`, `pitch`, `yaw` as in `rpy`.
    Floating,
}

impl MotionKind {
    /// Returns the names of the coordinates of a joint with several coordinates.
    #[must_use]
    pub fn coordinate_names(self) -> &'static [&'static str] {
        match self {
            Self::Planar => &["x", "y", "theta"],
            Self::Ball => &["roll", "pitch", "yaw"],
            Self::Floating => &["x", "y", "z", "roll", "pitch", "yaw"],
            Self::Revolute | Self::Prismatic | Self::Fixed => &[],
        }
    }
}

/// A joint, which moves one link relative to another.
#[derive(Clone, Debug)]
pub struct RobotJoint {
    /// Name of the joint.
    pub name: String,
    /// Kind of motion.
    pub kind: MotionKind,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the link that the joint moves.
    pub child: usize,
    /// Pose of the joint's frame in the frame of the parent link.
    pub origin: Isometry3<f64>,
    /// Axis in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Drive of a revolute or prismatic joint; `None` for a fixed joint.
    ///
    /// For a joint with several coordinates, the drive of the first of its consecutive coordinates.
    pub drive: Option<Drive>,
    /// The joint that this one mimics.
    pub mimics: Option<String>,
    /// Least and greatest value of a revolute or prismatic joint, in radians or lengths.
    pub limits: [f64; 2],
}

/// A body of a link: one of its collision elements.
#[derive(Clone, Debug)]
pub struct LinkBody {
    /// Pose in the frame of the link.
    pub origin: Isometry3<f64>,
    /// The geometry.
    pub geometry: Geometry,
    /// The mesh file that the geometry comes from, if there is one.
    pub mesh: Option<PathBuf>,
    /// How much the hull differs from the mesh, if measured.
    pub hull_fit: Option<HullFit>,
}

impl LinkBody {
    /// Returns a body that comes from no mesh file.
    #[must_use]
    pub fn new(origin: Isometry3<f64>, geometry: impl Into<Geometry>) -> Self {
        Self {
            origin,
            geometry: geometry.into(),
            mesh: None,
            hull_fit: None,
        }
    }
}

/// A link: a name and bodies.
#[derive(Clone, Debug)]
pub struct RobotLink {
    /// The name.
    pub name: String,
    /// The bodies; empty for a link that is only a frame.
    pub bodies: Vec<LinkBody>,
}

/// A coordinate of the configurations of a robot.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coordinate {
    /// Name of the joint; for a joint with several coordinates with a suffix, such as `base/x`.
    pub name: String,
    /// Least and greatest value.
    pub limits: [f64; 2],
    /// Greatest absolute velocity by second, of the joint and of those that mimic it, if the file
    /// of the robot states one.
    pub velocity: Option<f64>,
}

/// The links and joints of a robot, as a file describes them: what
/// [`Cell::add_robot`](crate::Cell::add_robot) adds to a cell.
///
/// The robot of a URDF, MJCF or SDFormat file in `lin-canny-robot` is one.
#[derive(Clone, Debug, Default)]
pub struct RobotModel {
    /// The links; the root comes first, and each link comes after its parent.
    pub links: Vec<RobotLink>,
    /// The joints; joint k moves link k + 1.
    pub joints: Vec<RobotJoint>,
    /// The coordinates of a configuration.
    pub coordinates: Vec<Coordinate>,
    /// Pairs of adjacent links, by their indices: see
    /// [`Cell::exclude_adjacent`](crate::Cell::exclude_adjacent).
    pub adjacent: Vec<[usize; 2]>,
    /// Pairs of bodies that are excluded: indices over the bodies of all links.
    pub excluded: Vec<[usize; 2]>,
}

impl AsRef<RobotModel> for RobotModel {
    fn as_ref(&self) -> &RobotModel {
        self
    }
}

impl RobotModel {
    /// Returns an error if an index is out of range, or a link comes before its parent.
    pub(super) fn check(&self) -> Result<(), PlanError> {
        let links = self.links.len();
        let wrong = |what, value: usize| {
            let value = value as f64;
            Err(PlanError::Value { what, value })
        };
        if links != self.joints.len() + 1 {
            return wrong("number of links", links);
        }
        for (k, joint) in self.joints.iter().enumerate() {
            if joint.parent > k {
                return wrong("parent of a joint", joint.parent);
            }
            if let Some(Drive { coordinate, .. }) = joint.drive {
                let last = coordinate.checked_add(joint.kind.coordinate_names().len().max(1) - 1);
                if last.is_none_or(|last| last >= self.coordinates.len()) {
                    return wrong("coordinate of a joint", coordinate);
                }
            }
        }
        if let Some(&link) = self.adjacent.iter().flatten().find(|link| **link >= links) {
            return wrong("index of an adjacent link", link);
        }
        let bodies: usize = self.links.iter().map(|link| link.bodies.len()).sum();
        match self.excluded.iter().flatten().find(|body| **body >= bodies) {
            Some(&body) => wrong("index of an excluded body", body),
            None => Ok(()),
        }
    }
}

/// The robots of a cell as one tree of joints, from the world on.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Robots {
    pub(super) joints: Vec<TreeJoint>,
    pub(super) coordinates: Vec<Coordinate>,
    /// For each link of the tree but the first, the distance from its origin to the farthest point of
    /// its bodies.
    pub(super) radii: Vec<f64>,
    /// The link of the tree of each robot body, and of each frame without a body.
    pub(super) of_bodies: Vec<usize>,
    pub(super) of_frames: Vec<usize>,
    pub(super) adjacent: Vec<[String; 2]>,
    /// The obstacles that are half-spaces of links that no joint moves.
    pub(super) half_spaces: BTreeSet<usize>,
}

impl Robots {
    /// Adds a joint, and returns the link that it moves.
    pub(super) fn add(&mut self, joint: TreeJoint) -> usize {
        self.joints.push(joint);
        self.radii.push(0.0);
        self.joints.len()
    }

    /// Returns the pose in the world of a link that no joint moves.
    pub(super) fn at_rest(&self, mut link: usize) -> Option<Isometry3<f64>> {
        let mut steps = Vec::new();
        while let Some(k) = link.checked_sub(1) {
            let joint = &self.joints[k];
            if joint.drive.is_some() {
                return None;
            }
            steps.push(joint.origin);
            link = joint.parent;
        }
        Some(steps.iter().rev().fold(Isometry3::identity(), |pose, step| pose * step))
    }

    /// Returns an error if the parts of a stored tree do not fit together, or the cell.
    pub(crate) fn check(&self, bodies: usize, obstacles: usize) -> Result<(), PlanError> {
        let links = self.joints.len() + 1;
        let count = |what, is_right: bool, value: usize| match is_right {
            true => Ok(()),
            false => Err(PlanError::Value {
                what,
                value: value as f64,
            }),
        };
        count(
            "number of bodies of a tree",
            self.of_bodies.len() <= bodies,
            self.of_bodies.len(),
        )?;
        count("number of radii", self.radii.len() + 1 == links, self.radii.len())?;
        for (k, joint) in self.joints.iter().enumerate() {
            count("parent of a joint", joint.parent <= k, joint.parent)?;
        }
        for link in self.of_bodies.iter().chain(&self.of_frames) {
            count("index of a link", *link < links, *link)?;
        }
        let space = self.half_spaces.iter().find(|k| **k >= obstacles);
        space.map_or(Ok(()), |k| count("index of an obstacle", false, *k))
    }
}

/// Returns the consecutive revolute and prismatic joints of a joint; the caller sets their parents.
pub(super) fn consecutive(
    kind: MotionKind,
    axis: &Unit<Vector3<f64>>,
    origin: &Isometry3<f64>,
    drive: Option<Drive>,
) -> Vec<TreeJoint> {
    let joint = |kind: JointKind, axis: Unit<Vector3<f64>>, drive: Option<Drive>| TreeJoint {
        parent: 0,
        kind,
        origin: Isometry3::identity(),
        axis,
        drive,
    };
    let after = |k: usize| drive.map(|d| Drive::by(d.coordinate + k));
    let slide = |axis, k| joint(JointKind::Prismatic, axis, after(k));
    let turn = |axis, k| joint(JointKind::Revolute, axis, after(k));
    let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let mut parts = match kind {
        MotionKind::Fixed => std::vec![TreeJoint::fixed(0, Isometry3::identity())],
        MotionKind::Revolute => std::vec![joint(JointKind::Revolute, *axis, drive)],
        MotionKind::Prismatic => std::vec![joint(JointKind::Prismatic, *axis, drive)],
        MotionKind::Planar => {
            let frame = turn_from_z(axis);
            std::vec![slide(frame * x, 0), slide(frame * y, 1), turn(*axis, 2)]
        }
        // The rotation is the product of yaw, pitch and roll.
        MotionKind::Ball => std::vec![turn(z, 2), turn(y, 1), turn(x, 0)],
        MotionKind::Floating => std::vec![
            slide(x, 0),
            slide(y, 1),
            slide(z, 2),
            turn(z, 5),
            turn(y, 4),
            turn(x, 3),
        ],
    };
    parts[0].origin = *origin;
    parts
}

/// Returns the shortest rotation from z to a direction: a half turn about x for the opposite of z.
///
/// x and y of a planar joint are along the rotated axes.
#[must_use]
pub fn turn_from_z(to: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    let about = |axis: &Unit<Vector3<f64>>, angle: f64| {
        let (sine, cosine) = libm::sincos(0.5 * angle);
        UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, axis.into_inner() * sine))
    };
    let across = Vector3::z().cross(to);
    match Unit::try_new(across, 0.0) {
        Some(axis) => about(&axis, libm::atan2(across.norm(), to.z)),
        None if to.z < 0.0 => about(&Vector3::x_axis(), core::f64::consts::PI),
        None => UnitQuaternion::identity(),
    }
}
