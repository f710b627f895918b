//! The command `cell`: writes the world of robot, cell and options as one cell file.

use std::path::PathBuf;

use clap::Args;
use lin_canny_cli::{RobotOptions, output, values};
use lin_canny_robot::CellFile;
use lin_canny_robot::plan::Checker;

use crate::end::{End, ToolError};

#[derive(Args)]
pub(crate) struct CellOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Required distance of all pairs in metres, without their paddings [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    margin: Option<f64>,
    /// Output file with the cell as JSON [default: stdout]
    #[arg(long, value_name = "OUT.json")]
    out: Option<PathBuf>,
}

pub(crate) fn run(options: &CellOptions) -> Result<End, ToolError> {
    let (_, cell) = options.robot.load()?;
    let mut checker = Checker::of_robots(cell.clone())?;
    if let Some(margin) = options.margin {
        checker.cell_mut().set_margin(margin)?;
    }
    let file = CellFile::from_cell(checker.cell());
    match &options.out {
        Some(path) => file.save(path)?,
        None => output::put(format_args!("{}", file.to_json()?)),
    }
    warn!(
        "obstacles: {}, attached objects: {}, paddings: {}, excluded pairs of bodies: {}",
        file.obstacles.len(),
        file.attached.len(),
        file.paddings.len(),
        checker.cell().excluded().len(),
    );
    Ok(End::Free)
}
