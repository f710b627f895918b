//! The option `--pair-boxes`: boxes of joint values in which links are apart.

use clap::Args;
use lin_canny_cli::output::progress;
use lin_canny_robot::plan::{Checker, JointTree, PairBoxes};
use std::ops::ControlFlow;

use crate::end::ToolError;

#[derive(Args)]
pub(crate) struct PairBoxArguments {
    /// Prove this many boxes first for each pair of links with one or two joints between them:
    /// verdicts stay
    #[arg(long, value_name = "COUNT")]
    pair_boxes: Option<u64>,
}

impl PairBoxArguments {
    /// Sets the boxes of a checker, after its margins.
    pub(crate) fn set(&self, checker: &mut Checker<JointTree>) -> Result<(), ToolError> {
        let Some(boxes) = self.pair_boxes else { return Ok(()) };
        let bar = progress("boxes of a pair", boxes);
        let found = PairBoxes::search(checker, boxes, &mut |now| {
            bar.set_position(now.done as u64);
            ControlFlow::Continue(())
        })?;
        bar.finish_and_clear();
        checker.set_pair_boxes(&found)?;
        Ok(())
    }
}
