//! A robot: links, joints, and the geometry of its links.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::{Geometry, HullFit};
use lin_canny_plan::Drive;

use crate::error::FileError;
use crate::geometry::MeshOptions;
use crate::packages::Packages;
use crate::urdf;

/// The kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// Turns about its axis, between limits or without.
    Revolute,
    /// Slides along its axis.
    Prismatic,
    /// Never moves.
    Fixed,
    /// Slides in a plane across its axis and turns about the axis: coordinates `x`, `y`, `theta`.
    Planar,
    /// Moves freely: coordinates `x`, `y`, `z`, and the angles `roll`, `pitch`, `yaw` of a URDF's
    /// `rpy`.
    Floating,
}

impl MotionKind {
    /// The names of the coordinates of a joint with several.
    pub(crate) fn parts(self) -> &'static [&'static str] {
        match self {
            Self::Planar => &["x", "y", "theta"],
            Self::Floating => &["x", "y", "z", "roll", "pitch", "yaw"],
            Self::Revolute | Self::Prismatic | Self::Fixed => &[],
        }
    }
}

/// A joint, which moves one link against another.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RobotJoint {
    /// The name.
    pub name: String,
    /// The kind.
    pub kind: MotionKind,
    /// The index of the link before.
    pub parent: usize,
    /// The index of the link that the joint moves.
    pub child: usize,
    /// The pose of the joint's frame in the frame of the link before.
    pub origin: Isometry3<f64>,
    /// The axis in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// What moves a revolute or prismatic joint; of a planar or floating joint the first of its
    /// coordinates, which follow each other. `None` for a fixed joint.
    pub drive: Option<Drive>,
    /// The joint that this one mimics.
    pub mimics: Option<String>,
    /// Least and greatest value, of a revolute or prismatic joint.
    pub limits: [f64; 2],
}

/// A body of a link: one of its collision elements.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LinkBody {
    /// The pose in the frame of the link.
    pub origin: Isometry3<f64>,
    /// The geometry.
    pub geometry: Geometry,
    /// The mesh file that the geometry comes from, if there is one.
    pub mesh: Option<PathBuf>,
    /// What the hull of the mesh adds, if it was measured.
    pub hull_fit: Option<HullFit>,
}

/// A link: a name and bodies.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RobotLink {
    /// The name.
    pub name: String,
    /// The bodies, none for a mere frame.
    pub bodies: Vec<LinkBody>,
}

/// A coordinate of a robot's configurations.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Coordinate {
    /// The name of the joint; of a planar or floating joint with the part, such as `base/x`.
    pub name: String,
    /// Least and greatest value.
    pub limits: [f64; 2],
}

/// How a URDF is read.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadOptions {
    /// What meshes become.
    pub meshes: MeshOptions,
    /// The least and greatest value of a joint that turns without limits.
    pub continuous_limits: [f64; 2],
    /// The least and greatest value of the places of planar and floating joints, which URDF does
    /// not limit.
    pub floating_limits: [f64; 2],
}

impl Default for LoadOptions {
    /// Hulls, two turns either way, ten metres either way.
    fn default() -> Self {
        let turns = 4.0 * std::f64::consts::PI;
        Self {
            meshes: MeshOptions::default(),
            continuous_limits: [-turns, turns],
            floating_limits: [-10.0, 10.0],
        }
    }
}

/// A robot as its URDF says.
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
#[derive(Clone, Debug)]
pub struct Robot {
    pub(crate) name: String,
    pub(crate) links: Vec<RobotLink>,
    pub(crate) joints: Vec<RobotJoint>,
    pub(crate) coordinates: Vec<Coordinate>,
}

impl Robot {
    /// Returns the robot of a URDF file; meshes become hulls.
    ///
    /// # Errors
    /// A file that cannot be read or says no robot: the file, the line, the element and the reason.
    pub fn load(path: impl AsRef<Path>, packages: &Packages) -> Result<Self, FileError> {
        Self::load_with(path, packages, &LoadOptions::default())
    }

    /// Returns the robot of a URDF file.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_with(path: impl AsRef<Path>, packages: &Packages, options: &LoadOptions) -> Result<Self, FileError> {
        let path = path.as_ref();
        urdf::parse(path, &FileError::read(path)?, packages, options)
    }

    /// Returns the robot of the text of a URDF; `path` is the file that errors name, and meshes
    /// with relative paths are looked for beside it.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(
        text: &str,
        path: impl AsRef<Path>,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Self, FileError> {
        urdf::parse(path.as_ref(), text, packages, options)
    }

    /// Returns the name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the links; each comes after the link that it hangs on, the root first.
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

    /// Returns the index of a link.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Returns the pairs of links that are adjacent: connected by one joint, or by several with
    /// links without bodies between.
    #[must_use]
    pub fn adjacent(&self) -> Vec<[usize; 2]> {
        let has_bodies = |link: usize| !self.links[link].bodies.is_empty();
        let mut pairs = Vec::new();
        for link in (1..self.links.len()).filter(|&k| has_bodies(k)) {
            let mut before = self.joints[link - 1].parent;
            while before > 0 && !has_bodies(before) {
                before = self.joints[before - 1].parent;
            }
            if has_bodies(before) {
                pairs.push([before, link]);
            }
        }
        pairs
    }
}
