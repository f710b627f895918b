//! The command `boxes`: proves boxes of configurations free or in contact, an atlas for other
//! commands.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use lin_canny::Progress;
use lin_canny_robot::plan::{AtlasOptions, Checker, JointTree};
use lin_canny_robot::{load_atlas, save_atlas};

use super::options::RobotOptions;
use super::plan::duration;
use super::{End, ToolError, progress};

#[derive(Args)]
pub(super) struct BoxesOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Most boxes to search [default: 20,000, or no limit with --proofs or --seconds]
    #[arg(long, value_name = "N")]
    boxes: Option<u64>,
    /// Most proofs of a pair over a box [default: none]
    #[arg(long, value_name = "N")]
    proofs: Option<u64>,
    /// Time limit of the run in seconds; the file then depends on the machine [default: none]
    #[arg(long, value_name = "S", value_parser = duration)]
    seconds: Option<Duration>,
    /// Minimum distance of all pairs in metres [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    margin: Option<f64>,
    /// Output file with the boxes
    #[arg(long, value_name = "ATLAS.json")]
    out: PathBuf,
    /// Boxes of an earlier run with the same files, from which the search goes on
    #[arg(long, value_name = "ATLAS.json")]
    resume: Option<PathBuf>,
}

/// The boxes by which a command answers.
#[derive(Args)]
pub(super) struct AtlasArguments {
    /// Boxes that `boxes` has proven for the same files and margin, looked up first: verdicts stay
    #[arg(long, value_name = "ATLAS.json")]
    atlas: Option<PathBuf>,
    /// Prove this many boxes first for each pair of links with one or two joints between them:
    /// verdicts stay
    #[arg(long, value_name = "COUNT")]
    pair_boxes: Option<u64>,
}

impl AtlasArguments {
    /// Sets the boxes of a checker, after its margins.
    pub(super) fn set(&self, checker: &mut Checker<JointTree>) -> Result<(), ToolError> {
        if let Some(boxes) = self.pair_boxes {
            let bar = progress("boxes of a pair", boxes);
            let found = checker.pair_boxes_with_progress(&AtlasOptions::default().boxes(boxes), &mut |now| {
                bar.set_position(now.done as u64);
                std::ops::ControlFlow::Continue(())
            })?;
            bar.finish_and_clear();
            checker.set_pair_boxes(&found)?;
        }
        let Some(file) = &self.atlas else { return Ok(()) };
        let atlas = load_atlas(file)?;
        checker
            .set_atlas(atlas)
            .map_err(|error| state(file, &error.to_string()))
    }
}

pub(super) fn run(options: &BoxesOptions) -> Result<End, ToolError> {
    let (_, setup) = options.robot.load()?;
    let mut checker = setup.checker()?;
    checker.set_margin(options.margin.unwrap_or(checker.margin()))?;
    let has_other = options.proofs.is_some() || options.seconds.is_some();
    let default = AtlasOptions::default().boxes;
    let boxes = options.boxes.unwrap_or(if has_other { u64::MAX } else { default });
    let search = AtlasOptions::default()
        .boxes(boxes)
        .proofs(options.proofs.unwrap_or(u64::MAX));
    let (began, bar) = (Instant::now(), progress("boxes", boxes));
    let mut watch = |now: Progress| {
        bar.set_position(now.done as u64);
        Progress::stop_if(options.seconds.is_some_and(|limit| began.elapsed() > limit))
    };
    let atlas = match &options.resume {
        Some(file) => {
            let earlier = load_atlas(file)?;
            let found = checker.resume_boxes(&earlier, &search, &mut watch);
            found.map_err(|error| state(file, &error.to_string()))?
        }
        None => checker.free_boxes_with_progress(&search, &mut watch)?,
    };
    bar.finish_and_clear();
    save_atlas(&atlas, &options.out)?;
    let shares = atlas.shares();
    say!(
        "{} boxes searched: {:.2} % of the volume is free, {:.2} % in contact, {:.2} % left",
        atlas.searched(),
        100.0 * shares.free,
        100.0 * shares.contact,
        100.0 * shares.left
    );
    Ok(End::Free)
}

fn state(file: &Path, reason: &str) -> ToolError {
    ToolError::Input {
        file: file.to_owned(),
        reason: reason.to_owned(),
    }
}
