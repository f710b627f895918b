//! What several commands take.

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use lin_canny_study::robot::{MeshOptions, MeshUse, Packages, RobotFiles};
use lin_canny_study::{Format, RunOptions, Study, StudyError, StudyOptions};

/// What a mesh becomes.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MeshGeometry {
    /// The convex hull.
    Hull,
    /// The mesh as it is.
    Mesh,
}

/// The robot, its cell, and how rows are answered: the same for all processes of a cluster.
#[derive(Args)]
pub(super) struct StudyArguments {
    /// The robot
    #[arg(long, value_name = "ROBOT.urdf")]
    robot: PathBuf,
    /// Obstacles
    #[arg(long, value_name = "CELL.json")]
    cell: Option<PathBuf>,
    /// Pairs of links to ignore
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// A folder with packages of `package://` names, before those of ROS_PACKAGE_PATH; may repeat
    #[arg(long, value_name = "DIR")]
    packages: Vec<PathBuf>,
    /// What meshes become
    #[arg(long, value_enum, default_value = "hull")]
    geometry: MeshGeometry,
    /// Check adjacent links too
    #[arg(long)]
    check_adjacent: bool,
    /// The distance that `is_free` and `certify` keep
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, allow_negative_numbers = true)]
    margin: f64,
    /// Answer bad rows (NULL, outside the limits) by NULL and count them, instead of ending
    #[arg(long)]
    lenient: bool,
}

impl StudyArguments {
    pub(super) fn load(&self) -> Result<Arc<Study>, StudyError> {
        let usage = match self.geometry {
            MeshGeometry::Hull => MeshUse::Hull,
            MeshGeometry::Mesh => MeshUse::Mesh,
        };
        let files = RobotFiles {
            urdf: self.robot.clone(),
            srdf: self.srdf.clone(),
            cell: self.cell.clone(),
            packages: Packages::new(&self.packages).with_environment(),
            meshes: MeshOptions::new(usage),
            check_adjacent: self.check_adjacent,
        };
        let options = StudyOptions {
            margin: self.margin,
            lenient: self.lenient,
        };
        let study = Study::load(&files, options)?;
        eprintln!("robot, cell and options: {}", study.fingerprint());
        Ok(study)
    }
}

/// Where rows are answered, and what is written.
#[derive(Args)]
pub(super) struct WhereArguments {
    /// Partitions answered side by side; as many as the machine has cores if left out
    #[arg(long, value_name = "N")]
    partitions: Option<usize>,
    /// The scheduler of a cluster; this process answers if left out
    #[arg(long, value_name = "HOST:PORT")]
    scheduler: Option<String>,
}

impl WhereArguments {
    pub(super) fn options(&self, format: Format) -> RunOptions {
        let all = RunOptions::default();
        RunOptions {
            partitions: self.partitions.unwrap_or(all.partitions).max(1),
            scheduler: self.scheduler.clone(),
            format,
            ..all
        }
    }
}

/// A format of files, as an argument.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum FormatArgument {
    /// Apache Parquet.
    Parquet,
    /// Text with a line of names.
    Csv,
    /// Arrow IPC.
    Arrow,
}

impl From<FormatArgument> for Format {
    fn from(argument: FormatArgument) -> Self {
        match argument {
            FormatArgument::Parquet => Self::Parquet,
            FormatArgument::Csv => Self::Csv,
            FormatArgument::Arrow => Self::Arrow,
        }
    }
}
