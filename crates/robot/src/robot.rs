//! Robots: links, joints, and the geometry of the links.

use std::path::PathBuf;

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::{Geometry, HullFit};
use lin_canny_plan::Drive;

use crate::error::{FileErrorKind, Skipped};
use lin_canny_plan::nearest_name as nearest;

/// The kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// Moves freely: coordinates `x`, `y`, `z`, and the angles `roll`, `pitch`, `yaw` as in `rpy`.
    Floating,
}

impl MotionKind {
    /// Returns the names of the coordinates of a joint with several coordinates.
    pub(crate) fn parts(self) -> &'static [&'static str] {
        match self {
            Self::Planar => &["x", "y", "theta"],
            Self::Floating => &["x", "y", "z", "roll", "pitch", "yaw"],
            Self::Revolute | Self::Prismatic | Self::Fixed => &[],
        }
    }
}

/// A joint, which moves one link relative to another.
#[derive(Clone, Debug)]
#[non_exhaustive]
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
    /// For a planar or floating joint, the drive of the first of its consecutive coordinates.
    pub drive: Option<Drive>,
    /// The joint that this one mimics.
    pub mimics: Option<String>,
    /// Least and greatest value of a revolute or prismatic joint, in radians or lengths.
    pub limits: [f64; 2],
}

/// A body of a link: one of its collision elements.
#[derive(Clone, Debug)]
#[non_exhaustive]
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
    pub(crate) fn new(origin: Isometry3<f64>, geometry: Geometry) -> Self {
        Self {
            origin,
            geometry,
            mesh: None,
            hull_fit: None,
        }
    }
}

/// A link: a name and bodies.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RobotLink {
    /// The name.
    pub name: String,
    /// The bodies; empty for a link that is only a frame.
    pub bodies: Vec<LinkBody>,
}

/// A coordinate of the configurations of a robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Coordinate {
    /// Name of the joint; for a planar or floating joint with a suffix, such as `base/x`.
    pub name: String,
    /// Least and greatest value.
    pub limits: [f64; 2],
    /// Greatest absolute velocity by second, of the joint and of those that mimic it, if the URDF
    /// states one.
    pub velocity: Option<f64>,
}

/// A robot that is read from a URDF, MJCF or SDFormat file.
///
/// ```
/// use lin_canny_robot::{Packages, Robot};
///
/// let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/gripper.urdf");
/// let robot = Robot::load(urdf, &Packages::default())?;
/// assert_eq!(robot.name(), "gripper arm");
/// // The right finger mimics the left one: one coordinate moves both.
/// assert_eq!(robot.coordinates().len(), 7);
/// assert_eq!(robot.joints().iter().filter(|j| j.mimics.is_some()).count(), 1);
/// # Ok::<(), lin_canny_robot::FileError>(())
/// ```
#[doc(alias = "URDF")]
#[doc(alias = "SDF")]
#[derive(Clone, Debug)]
pub struct Robot {
    pub(crate) name: String,
    pub(crate) links: Vec<RobotLink>,
    pub(crate) joints: Vec<RobotJoint>,
    pub(crate) coordinates: Vec<Coordinate>,
    /// Pairs of adjacent links, the smaller index first.
    pub(crate) adjacent: Vec<[usize; 2]>,
    /// Pairs of bodies that the file excludes: indices over the bodies of all links.
    pub(crate) excluded: Vec<[usize; 2]>,
    pub(crate) skipped: Vec<Skipped>,
    /// The configuration in which the file draws the robot.
    pub(crate) start: Vec<f64>,
}

impl Robot {
    /// Returns the name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the links; the root comes first, and each link comes after its parent.
    #[must_use]
    pub fn links(&self) -> &[RobotLink] {
        &self.links
    }

    /// Returns the joints; joint k moves link k + 1.
    #[must_use]
    pub fn joints(&self) -> &[RobotJoint] {
        &self.joints
    }

    /// Returns the coordinates of a configuration, in the order of the joints in the file.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Returns the configuration in which the file draws the robot.
    ///
    /// All values are zero, but for floating links of SDFormat and MJCF, whose coordinates are their
    /// poses in the world, and for joints of MJCF with a `ref`. A value may be outside its limits.
    #[must_use]
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// Returns what the file names and the robot does not hold.
    ///
    /// These are collision elements whose mesh file does not exist, if
    /// [`LoadOptions::skip_missing_meshes`](crate::LoadOptions::skip_missing_meshes) is set, elements of SDFormat that are left out by rule,
    /// such as `actor`, and in MJCF equalities of bodies and flags that switch contacts off.
    #[must_use]
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Returns the index of a link.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Returns the error of a link that does not exist.
    pub(crate) fn unknown_link(&self, name: &str) -> FileErrorKind {
        FileErrorKind::Unknown {
            kind: "link",
            name: name.into(),
            near: nearest(name, self.links.iter().map(|link| link.name.as_str())),
        }
    }

    /// Returns the pairs of adjacent links, by their indices.
    ///
    /// Two links are adjacent if one joint connects them, or several joints with links without
    /// bodies between them. In an MJCF file, bodies that no joint moves relative to each other are
    /// one link, and no link is adjacent to the world, as in MuJoCo.
    #[must_use]
    pub fn adjacent(&self) -> &[[usize; 2]] {
        &self.adjacent
    }

    /// Returns the pairs of bodies that the file excludes, each as link and body of the link.
    ///
    /// MJCF excludes pairs by `contype` and `conaffinity`, `exclude` and `pair`; SDFormat by
    /// `collide_bitmask`; URDF by Drake's `drake:collision_filter_group`.
    #[must_use]
    pub fn excluded(&self) -> Vec<[(usize, usize); 2]> {
        let links = self.links.iter().enumerate();
        let bodies = links.flat_map(|(k, link)| (0..link.bodies.len()).map(move |body| (k, body)));
        let bodies: Vec<(usize, usize)> = bodies.collect();
        self.excluded.iter().map(|pair| pair.map(|k| bodies[k])).collect()
    }
}

/// Returns the pairs of adjacent links by the joints, where joint k moves link k + 1.
pub(crate) fn adjacent_by_joints(links: &[RobotLink], joints: &[RobotJoint]) -> Vec<[usize; 2]> {
    let has_bodies = |link: usize| !links[link].bodies.is_empty();
    let mut pairs = Vec::new();
    for link in (1..links.len()).filter(|&k| has_bodies(k)) {
        let mut before = joints[link - 1].parent;
        while before > 0 && !has_bodies(before) {
            before = joints[before - 1].parent;
        }
        if has_bodies(before) {
            pairs.push([before, link]);
        }
    }
    pairs
}
