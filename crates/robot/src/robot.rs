//! Robots that are read from files.

use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Coordinate, RobotJoint, RobotLink, RobotModel};

use crate::error::{FileErrorKind, Skipped};
use crate::turn::to_roll_pitch_yaw;
use lin_canny_plan::nearest_name as nearest;

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
    /// Links, joints, coordinates, and pairs that are adjacent or excluded.
    pub(crate) model: RobotModel,
    pub(crate) skipped: Vec<Skipped>,
    /// The configuration in which the file draws the robot.
    pub(crate) start: Vec<f64>,
    /// The joints with values in MuJoCo's `qpos`, in its order.
    pub(crate) qpos: Vec<QposJoint>,
}

/// A joint that has values in MuJoCo's `qpos`.
#[derive(Clone, Debug)]
pub(crate) struct QposJoint {
    pub(crate) name: String,
    /// The value in `qpos` at which the file draws the joint; of a held joint, where it is held.
    pub(crate) rest: f64,
}

impl AsRef<RobotModel> for Robot {
    fn as_ref(&self) -> &RobotModel {
        &self.model
    }
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
        &self.model.links
    }

    /// Returns the joints; joint k moves link k + 1.
    #[must_use]
    pub fn joints(&self) -> &[RobotJoint] {
        &self.model.joints
    }

    /// Returns the coordinates of a configuration, in the order of the joints in the file.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.model.coordinates
    }

    /// Returns the configuration in which the file draws the robot.
    ///
    /// All values are zero, but for floating links of SDFormat and MJCF, whose coordinates are their
    /// poses in the world, and for joints of MJCF with a `ref`. A value may be outside the limits that
    /// the file states.
    #[must_use]
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// Draws a floating link at a pose: the limits of its coordinates, from the first, contain it.
    pub(crate) fn draw(&mut self, first: usize, pose: &Isometry3<f64>) {
        let position: [f64; 3] = pose.translation.vector.into();
        let values = position.into_iter().chain(to_roll_pitch_yaw(&pose.rotation));
        for (k, value) in (first..).zip(values) {
            self.start[k] = value;
            let limits = &mut self.model.coordinates[k].limits;
            *limits = containing(*limits, value);
        }
    }

    /// Returns what the file names and the robot does not hold.
    ///
    /// These are collision elements whose mesh file does not exist, if
    /// [`LoadOptions::skip_missing_meshes`](crate::LoadOptions::skip_missing_meshes) is set, elements of SDFormat that are left out by rule,
    /// such as `actor`, and in MJCF equalities of bodies and flags that switch contacts off. What XML
    /// does not allow and simulators take is listed too: text between elements, `--` in comments,
    /// prefixes that are not declared, and text before the XML declaration.
    #[must_use]
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Returns the index of a link.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<usize> {
        self.model.links.iter().position(|link| link.name == name)
    }

    /// Returns the error of a link that does not exist.
    pub(crate) fn unknown_link(&self, name: &str) -> FileErrorKind {
        FileErrorKind::Unknown {
            kind: "link",
            name: name.into(),
            near: nearest(name, self.model.links.iter().map(|link| link.name.as_str())),
        }
    }

    /// Returns the pairs of adjacent links, by their indices.
    ///
    /// Two links are adjacent if one joint connects them, or several joints with links without
    /// bodies between them. In an MJCF file, bodies that no joint moves relative to each other are
    /// one link, and no link is adjacent to the world, as in MuJoCo.
    #[must_use]
    pub fn adjacent(&self) -> &[[usize; 2]] {
        &self.model.adjacent
    }

    /// Returns the pairs of bodies that the file excludes, each as link and body of the link.
    ///
    /// MJCF excludes pairs by `contype` and `conaffinity`, `exclude` and `pair`; SDFormat by
    /// `collide_bitmask`; URDF by Drake's `drake:collision_filter_group`.
    #[must_use]
    pub fn excluded(&self) -> Vec<[(usize, usize); 2]> {
        let links = self.model.links.iter().enumerate();
        let bodies = links.flat_map(|(k, link)| (0..link.bodies.len()).map(move |body| (k, body)));
        let bodies: Vec<(usize, usize)> = bodies.collect();
        self.model.excluded.iter().map(|pair| pair.map(|k| bodies[k])).collect()
    }
}

/// Returns limits that contain a value as well.
pub(crate) fn containing([lower, upper]: [f64; 2], value: f64) -> [f64; 2] {
    let least = if value < lower { value } else { lower };
    let most = if value > upper { value } else { upper };
    [least, most]
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
