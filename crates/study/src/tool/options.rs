//! The options that several commands share.

use std::sync::Arc;

use clap::Args;
use lin_canny_cli::{RobotOptions, values};
use lin_canny_study::{Format, RunOptions, Study, StudyError, StudyOptions};

/// The robot, its cell and the options of a row: they must be equal in all processes of a cluster.
#[derive(Args)]
pub(super) struct StudyArguments {
    #[command(flatten)]
    robot: RobotOptions,
    /// Required distance of all pairs for `is_free` and `certify`, in the unit of the robot [default: that of the
    /// cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    margin: Option<f64>,
    /// Accept pairs that are in contact at the start of a segment of `certify`, within this distance:
    /// they must not come closer until they have left it
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    start_contact: Option<f64>,
    /// Return NULL for invalid rows and count them, instead of stopping with an error
    #[arg(long)]
    lenient: bool,
}

impl StudyArguments {
    pub(super) fn load(&self) -> Result<Arc<Study>, StudyError> {
        let (_, cell) = self.robot.load()?;
        let mut options = StudyOptions::default()
            .start_contact_margin(self.start_contact)
            .lenient(self.lenient);
        options.margin = self.margin;
        let study = Study::new(cell, options)?;
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
