//! A robot and its cell, from all their files.

use std::path::PathBuf;

use lin_canny::nalgebra::Isometry3;

use crate::cell::Cell;
use crate::error::{FileError, FileErrorKind};
use crate::geometry::MeshOptions;
use crate::packages::Packages;
use crate::robot::{LoadOptions, Robot};
use crate::space::Setup;
use crate::srdf::Srdf;

/// The files of a robot in its cell, and how they are read: what the tools take as arguments.
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
    /// The robot.
    pub urdf: PathBuf,
    /// Pairs of links to ignore.
    pub srdf: Option<PathBuf>,
    /// The obstacles, as JSON: see [`Cell`].
    pub cell: Option<PathBuf>,
    /// Where the meshes of `package://` names are.
    pub packages: Packages,
    /// What meshes become.
    pub meshes: MeshOptions,
    /// Whether adjacent links are checked too.
    pub check_adjacent: bool,
}

impl RobotFiles {
    /// Returns the files of a robot alone: meshes become hulls, adjacent links are ignored,
    /// packages are looked for in `ROS_PACKAGE_PATH`.
    #[must_use]
    pub fn new(urdf: impl Into<PathBuf>) -> Self {
        Self {
            urdf: urdf.into(),
            packages: Packages::default().with_environment(),
            ..Self::default()
        }
    }

    /// Returns the robot, and robot and cell to make a checker of.
    ///
    /// # Errors
    /// A file that is refused, or a link of `meshes.of_links` that the robot does not have.
    pub fn load(&self) -> Result<(Robot, Setup), FileError> {
        let options = LoadOptions {
            meshes: self.meshes.clone(),
            ..LoadOptions::default()
        };
        let robot = Robot::load_with(&self.urdf, &self.packages, &options)?;
        for name in self.meshes.of_links.keys() {
            if robot.link(name).is_none() {
                let (kind, name) = ("link", name.clone());
                return Err(FileError::new(
                    &self.urdf,
                    None,
                    "",
                    FileErrorKind::Unknown { kind, name },
                ));
            }
        }
        let mut setup = Setup::new();
        setup.robot("", &robot, Isometry3::identity());
        if !self.check_adjacent {
            setup.ignore_adjacent();
        }
        if let Some(file) = &self.srdf {
            setup.ignore("", &Srdf::load(file, &robot)?);
        }
        if let Some(file) = &self.cell {
            setup.cell(&Cell::load(file, &self.packages, &self.meshes)?);
        }
        Ok((robot, setup))
    }
}
