//! The command `cell`: writes the world of robot, cell and options as one cell file.

use std::path::PathBuf;

use clap::Args;
use lin_canny_robot::Cell;

use super::end::{End, ToolError};
use super::options::RobotOptions;
use super::text;

#[derive(Args)]
pub(super) struct CellOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Minimum distance of all pairs in metres [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    margin: Option<f64>,
    /// Output file with the cell as JSON [default: stdout]
    #[arg(long, value_name = "OUT.json")]
    out: Option<PathBuf>,
}

pub(super) fn run(options: &CellOptions) -> Result<End, ToolError> {
    let (_, setup) = options.robot.load()?;
    let mut checker = setup.checker()?;
    if let Some(margin) = options.margin {
        checker.world_mut().set_margin(margin)?;
    }
    let world = checker.world();
    let cell = Cell::from_world(world);
    match &options.out {
        Some(file) => cell.save(file)?,
        None => text::put(format_args!("{}", cell.to_json()?)),
    }
    warn!(
        "obstacles: {}, attached objects: {}, paddings: {}, excluded pairs of bodies: {}",
        cell.obstacles.len(),
        cell.attached.len(),
        cell.paddings.len(),
        world.excluded().len(),
    );
    Ok(End::Free)
}
