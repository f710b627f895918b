//! The options of all commands: the robot, its pairs, its cell.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use lin_canny::Geometry;
use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::{Cell, CellBody};
use lin_canny_robot::{
    Coordinate, FileError, FileErrorKind, LoadOptions, LoadedCell, MeshUse, OtherRobot, Packages, Robot, RobotFiles,
    Skipped, Srdf, Trajectory,
};

use crate::end::ToolError;
use crate::values;

/// The body that is made from a mesh.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MeshGeometry {
    /// The convex hull
    Hull,
    /// The triangles of the mesh
    Mesh,
    /// Convex pieces from the folder of `--pieces`
    Pieces,
}

impl From<MeshGeometry> for MeshUse {
    fn from(geometry: MeshGeometry) -> Self {
        match geometry {
            MeshGeometry::Hull => Self::Hull,
            MeshGeometry::Mesh => Self::Mesh,
            MeshGeometry::Pieces => Self::Pieces,
        }
    }
}

/// The robot and its cell.
#[derive(Args)]
pub(crate) struct RobotOptions {
    /// Robot as URDF, MJCF or SDFormat
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Link pairs to exclude, as SRDF
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// Further robot in the same cell, with a prefix of all its names, such as `left_=ur5.urdf`: Q.csv
    /// and the trajectory have columns such as `left_elbow`; may be repeated
    #[arg(long = "robot", value_name = "PREFIX=FILE", value_parser = values::prefixed_file)]
    others: Vec<(String, PathBuf)>,
    /// Pose of a further robot in the world, in metres and radians; may be repeated
    #[arg(long, value_name = "PREFIX=X,Y,Z[,ROLL,PITCH,YAW]", value_parser = values::prefixed_pose, requires = "others")]
    robot_pose: Vec<(String, Isometry3<f64>)>,
    /// Link pairs of a further robot to exclude, as SRDF without the prefix; may be repeated
    #[arg(long, value_name = "PREFIX=FILE", value_parser = values::prefixed_file, requires = "others")]
    robot_srdf: Vec<(String, PathBuf)>,
    /// Obstacles as JSON or SDFormat (without effect in `find-excluded`)
    #[arg(long, value_name = "CELL.json")]
    cell: Option<PathBuf>,
    /// Folder with the packages of `package://` paths, searched before ROS_PACKAGE_PATH; may be
    /// repeated
    #[arg(long, value_name = "DIR")]
    packages: Vec<PathBuf>,
    /// Body that is made from each mesh
    #[arg(long, value_enum, default_value = "hull")]
    geometry: MeshGeometry,
    /// Body that is made from the meshes of one link, such as `hand=mesh`; may be repeated
    #[arg(long, value_name = "LINK=KIND", value_parser = link_geometry)]
    link: Vec<(String, MeshGeometry)>,
    /// Folder of the convex pieces: the objects in arm.obj are the pieces of the mesh arm.stl
    #[arg(long, value_name = "DIR")]
    pieces: Option<PathBuf>,
    /// Measure and print how much each hull differs from its mesh
    #[arg(long)]
    hull_fit: bool,
    /// Skip collision elements of the robot and bodies of the cell whose mesh file is missing, with a
    /// warning for each: nothing is checked against them
    #[arg(long)]
    skip_missing_meshes: bool,
    /// Add a padding to a link, an obstacle or an attached object, in metres: its pairs keep so much
    /// more than the margin; may be repeated
    #[arg(long, value_name = "NAME=LENGTH", value_parser = values::named_number)]
    pad: Vec<(String, f64)>,
    /// Exclude all pairs of two links, or of a link and an obstacle; may be repeated
    #[arg(long, alias = "allow", value_name = "A,B", value_parser = values::name_pair)]
    exclude: Vec<[String; 2]>,
    /// Attach an object to a link: a JSON file with a body of a cell, its pose in the frame of the
    /// link, and `touch_links`; may be repeated
    #[arg(long, value_name = "LINK=FILE.json", value_parser = values::attachment)]
    attach: Vec<(String, PathBuf)>,
    /// Reject files of clouds with points without a return instead of dropping such points
    #[arg(long)]
    keep_invalid: bool,
    /// Check adjacent links as well
    #[arg(long)]
    check_adjacent: bool,
    /// Full turns that a joint without limits may make each way
    #[arg(long, value_name = "N", default_value = "2", value_parser = values::not_negative)]
    turns: f64,
    /// Widen the limits of all joints by X at both ends, in radians or metres; recorded values often
    /// exceed a limit by 1e-7
    #[arg(long, value_name = "X", default_value = "0", value_parser = values::not_negative)]
    limit_slack: f64,
}

/// The rows of a command.
#[derive(Args)]
pub(crate) struct RowOptions {
    /// Configurations: one column per joint, in any order, and optionally `time`
    #[arg(long, value_name = "Q.csv")]
    joints: PathBuf,
    #[command(flatten)]
    rest: RestOptions,
}

/// The values of joints that a file does not name.
#[derive(Args)]
pub(crate) struct RestOptions {
    /// Values of the joints without a column in Q.csv: a CSV file with column names and one row
    #[arg(long, value_name = "FILE")]
    rest: Option<PathBuf>,
    /// State of the SRDF whose values the joints have that neither Q.csv nor --rest names, such as
    /// `arm/home`, or `home` if one group has it; may be repeated, and a later state wins
    #[arg(long, value_name = "GROUP/NAME", requires = "srdf")]
    state: Vec<String>,
}

impl RowOptions {
    /// Returns the file of the rows.
    pub(crate) fn file(&self) -> &Path {
        &self.joints
    }

    /// Returns at least this number of rows.
    pub(crate) fn load(
        &self,
        files: &RobotOptions,
        robot: &Robot,
        cell: &Cell,
        least: usize,
    ) -> Result<Trajectory, ToolError> {
        self.rest
            .load(&self.joints, (files, robot, cell), least, |file, of, rest| {
                Trajectory::load_with_rest(file, of, rest)
            })
    }
}

/// Reads a file: its path, the coordinates, and the values of those that it does not name.
pub(crate) type ReadRows = fn(&Path, &[Coordinate], &[Option<f64>]) -> Result<Trajectory, FileError>;

impl RestOptions {
    /// Returns at least this number of rows of a file.
    pub(crate) fn load(
        &self,
        file: &Path,
        (files, robot, cell): (&RobotOptions, &Robot, &Cell),
        least: usize,
        read: ReadRows,
    ) -> Result<Trajectory, ToolError> {
        let coordinates = cell.coordinates();
        let mut values = self.values_of_states(files, robot, cell)?;
        let rest = self.rest.as_ref().map(|file| Trajectory::load_rest(file, coordinates));
        let rows = rest.unwrap_or(Ok(Vec::new())).and_then(|rest| {
            for (value, rest) in values.iter_mut().zip(rest) {
                *value = rest.or(*value);
            }
            read(file, coordinates, &values)
        });
        let rows = rows.map_err(|error| {
            let see = match &error.reason {
                FileErrorKind::Missing(what) if what.starts_with("column") || what.starts_with("joint") => {
                    "--rest and --state"
                }
                FileErrorKind::Range { .. } => "--limit-slack and --turns",
                _ => return ToolError::File(error),
            };
            let error = Box::new(error);
            ToolError::Rows { error, see }
        })?;
        let (file, count) = (file.to_owned(), rows.rows.len());
        if count < least {
            return Err(ToolError::TooFew { file, count, least });
        }
        Ok(rows)
    }

    /// Returns the values of the coordinates in the states; `None` where no state has one.
    fn values_of_states(
        &self,
        files: &RobotOptions,
        robot: &Robot,
        cell: &Cell,
    ) -> Result<Vec<Option<f64>>, ToolError> {
        let coordinates = cell.coordinates();
        let mut found = vec![None; coordinates.len()];
        let Some(file) = files.srdf.as_ref().filter(|_| !self.state.is_empty()) else {
            return Ok(found);
        };
        let wrong = |reason: String| ToolError::State {
            file: file.clone(),
            reason,
        };
        let srdf = Srdf::load(file, robot)?;
        for name in &self.state {
            let state = srdf.state(name).map_err(|reason| wrong(reason.to_string()))?;
            let title = format!("group_state {:?} joint", state.name);
            let of_state = srdf.skipped.iter().filter(|one| one.element.starts_with(&title));
            warn_of_skipped(&of_state.cloned().collect::<Vec<_>>());
            for (coordinate, value) in &state.values {
                let Some(k) = coordinates.iter().position(|c| c.name == *coordinate) else {
                    continue;
                };
                let [low, high] = coordinates[k].limits;
                if !(low..=high).contains(value) {
                    let field = format!("{coordinate} (limits {low} and {high})");
                    let reason = FileErrorKind::Range { field, value: *value };
                    return Err(wrong(format!(
                        "state {name:?}: {reason}; see --limit-slack and --turns"
                    )));
                }
                found[k] = Some(*value);
            }
        }
        Ok(found)
    }
}

fn link_geometry(text: &str) -> Result<(String, MeshGeometry), String> {
    let (link, kind) = text.rsplit_once('=').ok_or("expected LINK=KIND")?;
    Ok((link.into(), MeshGeometry::from_str(kind, true)?))
}

impl RobotOptions {
    /// Returns the further robots.
    fn others(&self) -> Result<Vec<OtherRobot>, ToolError> {
        let mut others = Vec::new();
        for (prefix, file) in &self.others {
            others.push(OtherRobot::new(prefix, file));
        }
        let find = |prefix: &str, option: &str, others: &[OtherRobot]| {
            others.iter().position(|other| other.prefix == prefix).ok_or_else(|| {
                let reason = format!("{option}: no robot has the prefix {prefix:?}");
                let file = self.robot.clone();
                ToolError::State { file, reason }
            })
        };
        for (prefix, pose) in &self.robot_pose {
            let k = find(prefix, "--robot-pose", &others)?;
            others[k].pose = *pose;
        }
        for (prefix, file) in &self.robot_srdf {
            let k = find(prefix, "--robot-srdf", &others)?;
            others[k].srdf = Some(file.clone());
        }
        Ok(others)
    }

    /// Returns the files of robots, pairs and cell that the options name.
    pub(crate) fn named_files(&self) -> impl Iterator<Item = &Path> {
        let others = self.others.iter().chain(&self.robot_srdf).chain(&self.attach);
        let files = core::iter::once(&self.robot).chain(&self.srdf).chain(&self.cell);
        files.chain(others.map(|other| &other.1)).map(PathBuf::as_path)
    }

    /// Returns whether collision elements without their mesh file are skipped.
    pub(crate) fn skips_meshes(&self) -> bool {
        self.skip_missing_meshes
    }

    /// Returns the file of the robot.
    pub(crate) fn file(&self) -> &Path {
        &self.robot
    }

    /// Returns the robot, and the cell of the robots and all bodies.
    pub(crate) fn load(&self) -> Result<(Robot, Cell), ToolError> {
        let link_meshes = self.link.iter().map(|(link, kind)| (link.clone(), (*kind).into()));
        let angle = self.turns * std::f64::consts::TAU;
        let mut options = LoadOptions::default()
            .continuous_limits([-angle, angle])
            .meshes(self.geometry.into())
            .link_meshes(link_meshes)
            .measure_hulls(self.hull_fit)
            .skip_missing_meshes(self.skip_missing_meshes)
            .keep_invalid(self.keep_invalid);
        options.pieces.clone_from(&self.pieces);
        let files = RobotFiles {
            robot: self.robot.clone(),
            srdf: self.srdf.clone(),
            others: self.others()?,
            cell: self.cell.clone(),
            packages: Packages::new(&self.packages).with_environment(),
            options,
            check_adjacent: self.check_adjacent,
            attached: self.attach.clone(),
            paddings: self.pad.clone(),
            excluded: self.exclude.clone(),
        };
        let LoadedCell {
            robot,
            mut cell,
            skipped,
            ..
        } = files.load()?;
        cell.widen_limits(self.limit_slack);
        warn_of_skipped(&skipped);
        warn_of_turned_triangles(&robot);
        if self.hull_fit {
            print_hull_fits(&robot);
        }
        Ok((robot, cell))
    }
}

/// Warns of what the files name and the cell does not hold, once for each element and reason.
fn warn_of_skipped(skipped: &[Skipped]) {
    let mut counts: HashMap<(&str, &str), usize> = HashMap::new();
    for one in skipped {
        *counts.entry((&one.element, &one.reason)).or_default() += 1;
    }
    for one in skipped {
        // The first of each takes the count away.
        match counts.remove(&(one.element.as_str(), one.reason.as_str())) {
            Some(1) => warn!("warning: {one}"),
            Some(count) => warn!("warning: {one} (and {} more)", count - 1),
            None => {}
        }
    }
}

/// Warns of meshes that are open surfaces because triangles are inverted: they have no inside.
fn warn_of_turned_triangles(robot: &Robot) {
    for link in robot.links() {
        for body in &link.bodies {
            let (Geometry::Mesh(geometry), Some(mesh)) = (&body.geometry, &body.mesh) else {
                continue;
            };
            let edges = geometry.report().misoriented_edges.len();
            if edges > 0 {
                warn!(
                    "warning: mesh {} of link {} has no inside: triangles are inverted at {edges} edges",
                    mesh.display(),
                    link.name
                );
            }
        }
    }
}

fn print_hull_fits(robot: &Robot) {
    for link in robot.links() {
        for body in &link.bodies {
            let (Some(fit), Some(mesh)) = (&body.hull_fit, &body.mesh) else {
                continue;
            };
            let void_fraction = fit.void_fraction().map_or("an open mesh".into(), |void_fraction| {
                format!("{:.1} % air", 100.0 * void_fraction)
            });
            let (low, high) = (fit.gap_lower, fit.gap_upper);
            say!(
                "hull of {} ({}): gap {low:.3e} to {high:.3e}, {void_fraction}",
                link.name,
                mesh.display()
            );
        }
    }
}

/// Returns an error if an obstacle moves, because `expected` is missing.
pub(crate) fn check_at_rest(cell: &Cell, file: &Path, expected: &str) -> Result<(), ToolError> {
    let moves = |id: &CellBody| cell.obstacle_motion(*id).is_some();
    match cell.bodies().map(|(id, _)| id).find(moves) {
        None => Ok(()),
        Some(id) => Err(ToolError::State {
            file: file.to_owned(),
            reason: format!("obstacle {:?} moves (expected {expected})", cell.name(id)),
        }),
    }
}
