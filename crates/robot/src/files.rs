//! Loads robots and their cell from all their files.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Cell, PlanError, nearest_name};

use crate::cell::CellFile;
use crate::cell_body::AttachedBody;
use crate::error::{FileError, FileErrorKind, Skipped};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::Robot;
use crate::srdf::Srdf;

/// The files of a robot and its cell, with the options of the command line tools.
///
/// ```
/// use lin_canny_robot::RobotFiles;
/// use lin_canny_robot::plan::Checker;
///
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
/// let mut files = RobotFiles::new(format!("{folder}/gripper.urdf"));
/// files.srdf = Some(format!("{folder}/gripper.srdf").into());
/// files.cell = Some(format!("{folder}/cell.json").into());
///
/// let loaded = files.load()?;
/// assert_eq!(loaded.cell.coordinates().len(), 7);
/// let mut checker = Checker::of_robots(loaded.cell)?;
/// # assert!(checker.is_free_at(&[0.0; 7]).is_ok());
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
    /// Paddings of links, obstacles and attached objects: see [`Cell::pad`].
    pub paddings: Vec<(String, f64)>,
    /// Pairs of names that are excluded: see [`Cell::exclude`].
    pub excluded: Vec<[String; 2]>,
}

/// What [`RobotFiles::load`] returns.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadedCell {
    /// The first robot.
    pub robot: Robot,
    /// All robots and bodies.
    pub cell: Cell,
    /// What the files name and the cell does not hold.
    pub skipped: Vec<Skipped>,
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

    /// Returns the further robot with a prefix.
    ///
    /// # Errors
    /// Returns an error if no further robot has this prefix.
    pub fn other_mut(&mut self, prefix: &str) -> Result<&mut OtherRobot, FileError> {
        match self.others.iter().position(|other| other.prefix == prefix) {
            Some(k) => Ok(&mut self.others[k]),
            None => {
                let reason = FileErrorKind::Unknown {
                    kind: "robot with the prefix",
                    name: prefix.into(),
                    near: nearest_name(prefix, self.others.iter().map(|other| &other.prefix[..])),
                };
                Err(FileError::new(&self.robot, None, "", reason))
            }
        }
    }

    /// Returns the first robot, the cell of all robots and bodies, and what the files name and the cell
    /// does not hold.
    ///
    /// The coordinates of the cell are those of the first robot, then those of each further robot with
    /// its prefix. All pairs of links of two robots are checked.
    ///
    /// # Errors
    /// Returns an error if a file is invalid, if the robot has no link of a name in
    /// `options.link_meshes`, if two robots have a link or joint of the same name, or if a name of an
    /// attached object, a padding or an excluded pair does not exist.
    pub fn load(&self) -> Result<LoadedCell, FileError> {
        let robot = Robot::load_with(&self.robot, &self.packages, &self.options)?;
        for name in self.options.link_meshes.keys() {
            if robot.link(name).is_none() {
                let reason = robot.unknown_link(name);
                return Err(FileError::new(&self.robot, None, "", reason));
            }
        }
        let mut cell = Cell::new();
        let mut skipped = robot.skipped().to_vec();
        let add = |cell: &mut Cell, prefix: &str, robot: &Robot, pose, file: &Path| {
            cell.add_robot(prefix, robot, pose).map_err(|error| match error {
                PlanError::NameTaken { kind, name } => {
                    FileError::new(file, None, format!("{kind} {name:?}"), FileErrorKind::Repeated)
                }
                error => FileError::of_plan(file, error),
            })
        };
        add(&mut cell, "", &robot, Isometry3::identity(), &self.robot)?;
        let mut others = Vec::new();
        for other in &self.others {
            let further = Robot::load_with(&other.robot, &self.packages, &self.options)?;
            add(&mut cell, &other.prefix, &further, other.pose, &other.robot)?;
            skipped.extend_from_slice(further.skipped());
            others.push(further);
        }
        if !self.check_adjacent {
            cell.exclude_adjacent();
        }
        let others = self.others.iter().zip(&others);
        let others = others.map(|(other, robot)| (&other.prefix[..], robot, &other.srdf));
        for (prefix, robot, srdf) in std::iter::once(("", &robot, &self.srdf)).chain(others) {
            if let Some(file) = srdf {
                let srdf = Srdf::load(file, robot)?;
                srdf.exclude_in(&mut cell, prefix)
                    .map_err(|e| FileError::of_plan(file, e))?;
                skipped.extend(srdf.skipped_pairs().cloned());
            }
        }
        let mut named = None;
        if let Some(file) = &self.cell {
            let text = CellFile::load(file, &self.packages, &self.options)?;
            let (bodies, notes) = text.add_bodies(&mut cell)?;
            skipped.extend(notes);
            named = Some((text, bodies));
        }
        for (link, file) in &self.attached {
            let object = AttachedBody::load(file, &self.packages, &self.options)?;
            object
                .attach_to(&mut cell, link)
                .map_err(|e| FileError::of_plan(file, e))?;
            skipped.extend(object.skipped);
        }
        if let Some((text, bodies)) = named {
            text.add_pairs(&mut cell, &bodies)?;
        }
        for (name, padding) in &self.paddings {
            cell.pad(name, *padding).map_err(|e| FileError {
                element: format!("padding of {name:?}"),
                ..FileError::of_plan(&self.robot, e)
            })?;
        }
        for [a, b] in &self.excluded {
            match cell.exclude(a, b) {
                Ok(_) => {}
                Err(PlanError::WithoutBodies(link)) => skipped.push(Skipped {
                    file: self.robot.clone(),
                    line: None,
                    element: format!("pair {a:?} and {b:?}"),
                    reason: format!("link {link:?} has no bodies, so this excludes nothing"),
                }),
                Err(error) => {
                    return Err(FileError {
                        element: format!("excluded pair {a:?} and {b:?}"),
                        ..FileError::of_plan(&self.robot, error)
                    });
                }
            }
        }
        Ok(LoadedCell { robot, cell, skipped })
    }
}
