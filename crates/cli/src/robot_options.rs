//! The files of a robot and its cell, as options.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use lin_canny::Geometry;
use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::Cell;
use lin_canny_robot::{FileError, LoadOptions, LoadedCell, MeshUse, OtherRobot, Packages, Robot, RobotFiles, Skipped};

use crate::values;

/// The body that is made from a mesh.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MeshGeometry {
    /// The convex hull
    Hull,
    /// The triangles of the mesh
    Mesh,
    /// The triangles, with holes closed and inverted triangles turned
    Solid,
    /// Convex pieces from the folder of `--pieces`
    Pieces,
}

impl From<MeshGeometry> for MeshUse {
    fn from(geometry: MeshGeometry) -> Self {
        match geometry {
            MeshGeometry::Hull => Self::Hull,
            MeshGeometry::Mesh => Self::Mesh,
            MeshGeometry::Solid => Self::Solid,
            MeshGeometry::Pieces => Self::Pieces,
        }
    }
}

/// The robot and its cell.
#[derive(Args, Debug)]
pub struct RobotOptions {
    /// Robot as URDF, MJCF or SDFormat
    #[arg(value_name = "ROBOT")]
    pub robot: PathBuf,
    /// Link pairs to exclude, as SRDF
    #[arg(long, value_name = "FILE")]
    pub srdf: Option<PathBuf>,
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
    pub skip_missing_meshes: bool,
    /// Add a padding to a link, an obstacle or an attached object, in metres: its pairs keep so much
    /// more than the margin. The padding of a link covers what it carries, unless the object has a
    /// padding; may be repeated
    #[arg(long, value_name = "NAME=LENGTH", value_parser = values::named_number)]
    pad: Vec<(String, f64)>,
    /// Exclude all pairs of two links, or of a link and an obstacle; may be repeated
    #[arg(long, value_name = "A,B", value_parser = values::name_pair)]
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
    /// Farthest that a floating or planar joint, and a sliding joint without limits, may go each way along
    /// x, y and z, in metres; the pose at which the file draws a body is always within
    #[arg(long, value_name = "LENGTH", default_value = "10", value_parser = values::not_negative)]
    floating: f64,
    /// Widen the limits of all joints by X at both ends, in radians or metres; recorded values often
    /// exceed a limit by 1e-7
    #[arg(long, value_name = "X", default_value = "0", value_parser = values::not_negative)]
    limit_slack: f64,
}

fn link_geometry(text: &str) -> Result<(String, MeshGeometry), String> {
    let (link, kind) = text.rsplit_once('=').ok_or("expected LINK=KIND")?;
    Ok((link.into(), MeshGeometry::from_str(kind, true)?))
}

impl RobotOptions {
    /// Returns the files of robots, pairs and cell that the options name.
    pub fn named_files(&self) -> impl Iterator<Item = &Path> {
        let others = self.others.iter().chain(&self.robot_srdf).chain(&self.attach);
        let files = core::iter::once(&self.robot).chain(&self.srdf).chain(&self.cell);
        files.chain(others.map(|other| &other.1)).map(PathBuf::as_path)
    }

    /// Returns the robot, and the cell of the robots and all bodies.
    ///
    /// Prints warnings of what the files name and the cell does not hold.
    ///
    /// # Errors
    /// Returns an error if a file is invalid ([`RobotFiles::load`]), or if no further robot has the prefix of
    /// a pose or an SRDF.
    pub fn load(&self) -> Result<(Robot, Cell), FileError> {
        let link_meshes = self.link.iter().map(|(link, kind)| (link.clone(), (*kind).into()));
        let angle = self.turns * std::f64::consts::TAU;
        let mut options = LoadOptions::default()
            .continuous_limits([-angle, angle])
            .floating_limits([-self.floating, self.floating])
            .meshes(self.geometry.into())
            .link_meshes(link_meshes)
            .measure_hulls(self.hull_fit)
            .skip_missing_meshes(self.skip_missing_meshes)
            .keep_invalid(self.keep_invalid);
        options.pieces.clone_from(&self.pieces);
        let others = self.others.iter().map(|(prefix, file)| OtherRobot::new(prefix, file));
        let mut files = RobotFiles {
            robot: self.robot.clone(),
            srdf: self.srdf.clone(),
            others: others.collect(),
            cell: self.cell.clone(),
            packages: Packages::new(&self.packages).with_environment(),
            options,
            check_adjacent: self.check_adjacent,
            attached: self.attach.clone(),
            paddings: self.pad.clone(),
            excluded: self.exclude.clone(),
        };
        for (prefix, pose) in &self.robot_pose {
            files.other_mut(prefix)?.pose = *pose;
        }
        for (prefix, file) in &self.robot_srdf {
            files.other_mut(prefix)?.srdf = Some(file.clone());
        }
        let LoadedCell {
            robot,
            mut cell,
            skipped,
            ..
        } = files.load()?;
        cell.widen_limits(self.limit_slack);
        warn_of_skipped(&skipped);
        warn_of_turned_triangles(&robot);
        print_repairs(&cell);
        if self.hull_fit {
            print_hull_fits(&robot);
        }
        Ok((robot, cell))
    }
}

/// Warns of what files name and the cell does not hold, once for each file, element and reason.
pub fn warn_of_skipped(skipped: &[Skipped]) {
    let mut counts: HashMap<(&Path, &str, &str), usize> = HashMap::new();
    for one in skipped {
        *counts.entry((&one.file, &one.element, &one.reason)).or_default() += 1;
    }
    for one in skipped {
        // The first of each takes the count away.
        match counts.remove(&(one.file.as_path(), one.element.as_str(), one.reason.as_str())) {
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
                    "warning: mesh {} of link {} has no inside: triangles are inverted at {edges} edges; \
                     `--geometry solid` repairs it",
                    mesh.display(),
                    link.name
                );
            }
        }
    }
}

/// Prints which meshes were changed when they were made solid, and how.
fn print_repairs(cell: &Cell) {
    let obstacles = cell.obstacles().map(|(name, geometry, _)| (name, geometry));
    let attached = cell
        .attached()
        .map(|(_, object)| (object.name.as_str(), &object.geometry));
    for (name, geometry) in cell.robot_bodies().chain(attached).chain(obstacles) {
        let Geometry::Mesh(mesh) = geometry else { continue };
        if let Some(repair) = mesh.report().repair.as_deref().filter(|repair| !repair.is_nothing()) {
            say!("repaired the mesh of {name}: {repair}");
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
