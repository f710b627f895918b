//! Loads robots and their cell from all their files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;

use crate::cell::CellFile;
use crate::cell_body::AttachedBody;
use crate::error::{FileError, FileErrorKind};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::Robot;
use crate::space::Setup;
use crate::srdf::Srdf;

/// The files of a robot and its cell, with the options of the command line tools.
///
/// ```
/// use lin_canny_robot::RobotFiles;
///
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
/// let mut files = RobotFiles::new(format!("{folder}/gripper.urdf"));
/// files.srdf = Some(format!("{folder}/gripper.srdf").into());
/// files.cell = Some(format!("{folder}/cell.json").into());
///
/// let (robot, setup) = files.load()?;
/// assert_eq!(setup.coordinates().len(), robot.coordinates().len());
/// let mut checker = setup.checker()?;
/// # assert!(checker.is_free_at(&vec![0.0; setup.coordinates().len()]).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct RobotFiles {
    /// The robot, as URDF, MJCF or SDFormat.
    pub robot: PathBuf,
    /// Link pairs to ignore, as SRDF.
    pub srdf: Option<PathBuf>,
    /// Further robots in the same cell.
    pub others: Vec<OtherRobot>,
    /// The obstacles, as JSON or SDFormat: see [`CellFile`].
    pub cell: Option<PathBuf>,
    /// Folders of `package://` paths.
    pub packages: Packages,
    /// Options for loading the robot and the cell.
    pub options: LoadOptions,
    /// Whether adjacent links are checked as well.
    pub check_adjacent: bool,
    /// Objects that links carry: the link, and the JSON file of an [`AttachedBody`].
    pub attached: Vec<(String, PathBuf)>,
    /// Paddings of links, obstacles and attached objects: see [`Setup::pad`].
    pub paddings: Vec<(String, f64)>,
    /// Pairs of names that are excluded: see [`Setup::exclude`].
    pub excluded: Vec<[String; 2]>,
}

/// A further robot in the cell of [`RobotFiles`].
///
/// Its joints and links have the prefix before their names, and so do the columns of a trajectory.
#[derive(Clone, Debug)]
pub struct OtherRobot {
    /// What the names of joints and links start with.
    pub prefix: String,
    /// The robot, as URDF, MJCF or SDFormat.
    pub robot: PathBuf,
    /// Link pairs to ignore, as SRDF without the prefix.
    pub srdf: Option<PathBuf>,
    /// Pose of the root link in the world.
    pub pose: Isometry3<f64>,
}

impl OtherRobot {
    /// Returns a robot at the origin of the world, without an SRDF.
    #[must_use]
    pub fn new(prefix: impl Into<String>, robot: impl Into<PathBuf>) -> Self {
        Self {
            prefix: prefix.into(),
            robot: robot.into(),
            srdf: None,
            pose: Isometry3::identity(),
        }
    }
}

/// Names of links and of coordinates that are in use.
#[derive(Default)]
struct UsedNames(BTreeSet<(&'static str, String)>);

impl UsedNames {
    /// Adds the names of a robot.
    fn add(&mut self, prefix: &str, robot: &Robot, file: &Path) -> Result<(), FileError> {
        let links = robot.links().iter().map(|link| ("link", &link.name));
        let all = links.chain(robot.coordinates().iter().map(|c| ("joint", &c.name)));
        for (kind, name) in all {
            let name = format!("{prefix}{name}");
            if !self.0.insert((kind, name.clone())) {
                let element = format!("{kind} {name:?}");
                return Err(FileError::new(file, None, element, FileErrorKind::Repeated));
            }
        }
        Ok(())
    }
}

impl RobotFiles {
    /// Returns the files of a robot without a cell.
    ///
    /// Meshes are replaced by their hulls, adjacent links are ignored, and packages are searched in
    /// `ROS_PACKAGE_PATH`.
    #[must_use]
    pub fn new(robot: impl Into<PathBuf>) -> Self {
        Self {
            robot: robot.into(),
            packages: Packages::default().with_environment(),
            ..Self::default()
        }
    }

    /// Returns the first robot, and the setup of all robots and the cell for a checker.
    ///
    /// The coordinates of the setup are those of the first robot, then those of each further robot
    /// with its prefix. All pairs of links of two robots are checked. Names of attached objects,
    /// paddings and excluded pairs are checked by [`Setup::checker`].
    ///
    /// # Errors
    /// Returns an error if a file is invalid, if the robot has no link of a name in
    /// `options.link_meshes`, or if two robots have a link or joint of the same name.
    pub fn load(&self) -> Result<(Robot, Setup), FileError> {
        let robot = Robot::load_with(&self.robot, &self.packages, &self.options)?;
        for name in self.options.link_meshes.keys() {
            if robot.link(name).is_none() {
                let reason = robot.unknown_link(name);
                return Err(FileError::new(&self.robot, None, "", reason));
            }
        }
        let mut setup = Setup::new();
        setup.robot("", &robot, Isometry3::identity());
        let mut used = UsedNames::default();
        let mut others = Vec::new();
        for other in &self.others {
            if others.is_empty() {
                used.add("", &robot, &self.robot)?;
            }
            let further = Robot::load_with(&other.robot, &self.packages, &self.options)?;
            used.add(&other.prefix, &further, &other.robot)?;
            setup.robot(&other.prefix, &further, other.pose);
            others.push(further);
        }
        if !self.check_adjacent {
            setup.exclude_adjacent();
        }
        if let Some(file) = &self.srdf {
            setup.exclude_srdf("", &Srdf::load(file, &robot)?);
        }
        for (other, further) in self.others.iter().zip(&others) {
            if let Some(file) = &other.srdf {
                setup.exclude_srdf(&other.prefix, &Srdf::load(file, further)?);
            }
        }
        if let Some(file) = &self.cell {
            setup.cell(&CellFile::load(file, &self.packages, &self.options)?);
        }
        for (link, file) in &self.attached {
            setup.attach(link, AttachedBody::load(file, &self.packages, &self.options)?);
        }
        for (name, padding) in &self.paddings {
            setup.pad(name, *padding);
        }
        for [a, b] in &self.excluded {
            setup.exclude(a, b);
        }
        Ok((robot, setup))
    }
}
