//! The command `find-excluded`: finds link pairs that always or never collide.

use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::Args;
use lin_canny_cli::{RobotOptions, output::progress};
use lin_canny_robot::{Srdf, find_excluded};

use crate::end::{End, ToolError};
use crate::text::write;

#[derive(Args)]
pub(crate) struct FindExcludedOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Number of random configurations
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..))]
    samples: u64,
    /// Random seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Output file with the pairs as SRDF
    #[arg(long, value_name = "OUT.srdf")]
    out: Option<PathBuf>,
}

pub(crate) fn run(options: &FindExcludedOptions) -> Result<End, ToolError> {
    let (robot, cell) = options.robot.load()?;
    let bar = progress("configurations", options.samples);
    let counts = find_excluded(&cell, options.samples, options.seed, &mut |progress| {
        bar.set_position(progress.done as u64);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    for pair in &counts {
        let [a, b] = &pair.links;
        let reason = pair.reason.map_or("check".into(), |r| r.to_string());
        say!("{reason:<9}{:>8} of {} overlap: {a} - {b}", pair.overlaps, pair.samples);
    }
    if let Some(file) = &options.out {
        write(file, &Srdf::from_counts(&counts).text(robot.name()))?;
    }
    Ok(End::Free)
}
