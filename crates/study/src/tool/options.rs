//! The options that several commands share.

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use lin_canny_study::robot::{LoadOptions, MeshUse, Packages, RobotFiles};
use lin_canny_study::{Format, RunOptions, Study, StudyError, StudyOptions};

/// The body that is made from a mesh.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MeshGeometry {
    /// The convex hull
    Hull,
    /// The triangles of the mesh
    Mesh,
}

/// The robot, its cell and the options of a row: they must be equal in all processes of a cluster.
#[derive(Args)]
pub(super) struct StudyArguments {
    /// Robot as URDF, MJCF or SDFormat
    #[arg(long, value_name = "ROBOT")]
    robot: PathBuf,
    /// Obstacles as JSON or SDFormat
    #[arg(long, value_name = "CELL.json")]
    cell: Option<PathBuf>,
    /// Link pairs to ignore, as SRDF
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// Folder with the packages of `package://` paths, searched before ROS_PACKAGE_PATH; may be
    /// repeated
    #[arg(long, value_name = "DIR")]
    packages: Vec<PathBuf>,
    /// Body that is made from each mesh
    #[arg(long, value_enum, default_value = "hull")]
    geometry: MeshGeometry,
    /// Check adjacent links as well
    #[arg(long)]
    check_adjacent: bool,
    /// Attach an object to a link: a JSON file with a body of a cell, its pose in the frame of the
    /// link, and `touch_links`; may be repeated
    #[arg(long, value_name = "LINK=FILE.json", value_parser = attachment)]
    attach: Vec<(String, PathBuf)>,
    /// Reject files of clouds with points without a return instead of dropping such points
    #[arg(long)]
    keep_invalid: bool,
    /// Add a padding to a link, an obstacle or an attached object, in the unit of the robot: its pairs
    /// keep so much more than the margin; may be repeated
    #[arg(long, value_name = "NAME=LENGTH", value_parser = padding)]
    pad: Vec<(String, f64)>,
    /// Exclude all pairs of two links, or of a link and an obstacle; may be repeated
    #[arg(long, alias = "allow", value_name = "A,B", value_parser = name_pair)]
    exclude: Vec<[String; 2]>,
    /// Minimum distance for `is_free` and `certify`, in the unit of the robot [default: that of the
    /// cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    margin: Option<f64>,
    /// Accept pairs that are in contact at the start of a segment of `certify`, within this distance:
    /// they must not come closer until they have left it
    #[arg(long, value_name = "LENGTH")]
    start_contact: Option<f64>,
    /// Return NULL for invalid rows and count them, instead of stopping with an error
    #[arg(long)]
    lenient: bool,
}

fn attachment(text: &str) -> Result<(String, PathBuf), String> {
    let (link, file) = text.split_once('=').ok_or("expected LINK=FILE.json")?;
    Ok((link.into(), file.into()))
}

fn padding(text: &str) -> Result<(String, f64), String> {
    let (name, length) = text.rsplit_once('=').ok_or("expected NAME=LENGTH")?;
    let length = length.parse::<f64>().map_err(|e| e.to_string())?;
    Ok((name.into(), length))
}

fn name_pair(text: &str) -> Result<[String; 2], String> {
    let (a, b) = text
        .split_once(',')
        .ok_or("expected two names with a comma between them")?;
    Ok([a.into(), b.into()])
}

impl StudyArguments {
    pub(super) fn load(&self) -> Result<Arc<Study>, StudyError> {
        let usage = match self.geometry {
            MeshGeometry::Hull => MeshUse::Hull,
            MeshGeometry::Mesh => MeshUse::Mesh,
        };
        let files = RobotFiles {
            robot: self.robot.clone(),
            srdf: self.srdf.clone(),
            cell: self.cell.clone(),
            packages: Packages::new(&self.packages).with_environment(),
            options: LoadOptions::default().meshes(usage).keep_invalid(self.keep_invalid),
            check_adjacent: self.check_adjacent,
            attached: self.attach.clone(),
            paddings: self.pad.clone(),
            excluded: self.exclude.clone(),
            others: Vec::new(),
        };
        let mut options = StudyOptions::default()
            .start_contact_margin(self.start_contact)
            .lenient(self.lenient);
        options.margin = self.margin;
        let study = Study::load(&files, options)?;
        for skipped in study.skipped() {
            warn!("warning: {skipped}");
        }
        warn!("robot, cell and options: {}", study.fingerprint());
        Ok(study)
    }
}

/// Options that decide where rows are processed.
#[derive(Args)]
pub(super) struct WhereArguments {
    /// Number of partitions that run in parallel [default: number of cores]
    #[arg(long, value_name = "N")]
    partitions: Option<usize>,
    /// Scheduler of a cluster [default: run in this process]
    #[arg(long, value_name = "HOST:PORT")]
    scheduler: Option<String>,
}

impl WhereArguments {
    pub(super) fn options(&self, format: Format) -> RunOptions {
        let mut options = RunOptions::default().format(format);
        if let Some(partitions) = self.partitions {
            options.partitions = partitions.max(1);
        }
        options.scheduler.clone_from(&self.scheduler);
        options
    }
}
