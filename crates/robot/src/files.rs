//! Loads a robot and its cell from all their files.

use std::path::PathBuf;

use lin_canny::nalgebra::Isometry3;

use crate::cell::Cell;
use crate::cell_body::AttachedBody;
use crate::error::FileError;
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
    /// The obstacles, as JSON or SDFormat: see [`Cell`].
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

    /// Returns the robot, and the setup of robot and cell for a checker.
    ///
    /// Names of attached objects, paddings and excluded pairs are checked by
    /// [`Setup::checker`].
    ///
    /// # Errors
    /// Returns an error if a file is invalid, or if the robot has no link of a name in
    /// `options.link_meshes`.
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
        if !self.check_adjacent {
            setup.exclude_adjacent();
        }
        if let Some(file) = &self.srdf {
            setup.exclude_srdf("", &Srdf::load(file, &robot)?);
        }
        if let Some(file) = &self.cell {
            setup.cell(&Cell::load(file, &self.packages, &self.options)?);
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
