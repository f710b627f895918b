//! What all commands take: the robot, its pairs, its cell.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lin_canny::Geometry;
use lin_canny_robot::{MeshOptions, MeshUse, Packages, Robot, RobotFiles, Setup};

use super::ToolError;

/// What a mesh becomes.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MeshGeometry {
    /// The convex hull.
    Hull,
    /// The mesh as it is.
    Mesh,
    /// Convex pieces from the folder of `--pieces`.
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

/// The robot and what is about it.
#[derive(Args)]
pub(super) struct RobotOptions {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    urdf: PathBuf,
    /// Pairs of links to ignore
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// Obstacles (`ignorable` counts links alone)
    #[arg(long, value_name = "CELL.json")]
    cell: Option<PathBuf>,
    /// A folder with packages of `package://` names, before those of ROS_PACKAGE_PATH; may repeat
    #[arg(long, value_name = "DIR")]
    packages: Vec<PathBuf>,
    /// What meshes become
    #[arg(long, value_enum, default_value = "hull")]
    geometry: MeshGeometry,
    /// What the meshes of one link become, such as `hand=mesh`; may repeat
    #[arg(long, value_name = "LINK=KIND", value_parser = link_geometry)]
    link: Vec<(String, MeshGeometry)>,
    /// The folder of the convex pieces: the objects of arm.obj for a mesh arm.stl
    #[arg(long, value_name = "DIR")]
    pieces: Option<PathBuf>,
    /// Measure and print what hulls add to their meshes
    #[arg(long)]
    hull_fit: bool,
    /// Check adjacent links too
    #[arg(long)]
    check_adjacent: bool,
}

fn link_geometry(text: &str) -> Result<(String, MeshGeometry), String> {
    let (link, kind) = text.rsplit_once('=').ok_or("LINK=KIND is needed")?;
    Ok((link.into(), MeshGeometry::from_str(kind, true)?))
}

impl RobotOptions {
    /// Returns the robot, and robot and cell to make a checker of.
    pub(super) fn load(&self) -> Result<(Robot, Setup), ToolError> {
        let of_links = self.link.iter().map(|(link, kind)| (link.clone(), (*kind).into()));
        let files = RobotFiles {
            urdf: self.urdf.clone(),
            srdf: self.srdf.clone(),
            cell: self.cell.clone(),
            packages: Packages::new(&self.packages).with_environment(),
            meshes: MeshOptions {
                all: self.geometry.into(),
                of_links: of_links.collect(),
                pieces: self.pieces.clone(),
                measure_hulls: self.hull_fit,
            },
            check_adjacent: self.check_adjacent,
        };
        let (robot, setup) = files.load()?;
        warn_of_turned_triangles(&robot);
        if self.hull_fit {
            print_hull_fits(&robot);
        }
        Ok((robot, setup))
    }
}

/// Says which meshes are surfaces because triangles are turned over: nothing is inside them.
fn warn_of_turned_triangles(robot: &Robot) {
    for link in robot.links() {
        for body in &link.bodies {
            let (Geometry::Mesh(geometry), Some(mesh)) = (&body.geometry, &body.mesh) else {
                continue;
            };
            let edges = geometry.report().misoriented_edges.len();
            if edges > 0 {
                eprintln!(
                    "warning: mesh {} of link {} has no inside: triangles are turned over at {edges} edges",
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
            let void_fraction = fit.void_fraction().map_or("a surface".into(), |void_fraction| {
                format!("{:.1} % air", 100.0 * void_fraction)
            });
            let (low, high) = (fit.gap_lower, fit.gap_upper);
            println!(
                "hull of {} ({}): gap {low:.3e} to {high:.3e}, {void_fraction}",
                link.name,
                mesh.display()
            );
        }
    }
}
