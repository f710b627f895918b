//! The command `smooth`: turns the path of a file into a smooth trajectory that is proven free.

use std::path::PathBuf;

use clap::Args;
use lin_canny::Progress;
use lin_canny_cli::{
    RobotOptions,
    output::{self, progress},
    values::{self, Limit},
};
use lin_canny_robot::plan::{Checker, PlanError, SmoothOptions, Smoother, nearest_name};
use lin_canny_robot::{Coordinate, Trajectory};

use crate::end::{End, ToolError};
use crate::options::RowOptions;
use crate::text::write;

#[derive(Args)]
pub(crate) struct SmoothArguments {
    #[command(flatten)]
    robot: RobotOptions,
    #[command(flatten)]
    rows: RowOptions,
    /// Greatest acceleration of all joints, such as `5`, or of one, such as `elbow=2`, in radians or
    /// metres per second squared; may be repeated, and a later one wins
    #[arg(long, value_name = "[JOINT=]X", value_parser = values::limit, required = true)]
    acceleration: Vec<Limit>,
    /// Greatest velocity of all joints or of one, in radians or metres per second; may be repeated
    /// [default: that of the URDF]
    #[arg(long, value_name = "[JOINT=]X", value_parser = values::limit)]
    velocity: Vec<Limit>,
    /// Keep accelerations continuous, too: rows have accelerations, and the motion is quintic
    #[arg(long)]
    continuous_acceleration: bool,
    /// Greatest distance from a corner of the path, of any joint, in radians or metres; 0 stops at each
    /// corner [default: no limit]
    #[arg(long, value_name = "X", value_parser = values::not_negative)]
    deviation: Option<f64>,
    /// Output file with the trajectory, for `certify --trajectory` [default: stdout]
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Required distance of all pairs in metres, without their paddings [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    margin: Option<f64>,
}

impl SmoothArguments {
    fn wrong(&self, reason: String) -> ToolError {
        let file = self.rows.file().to_owned();
        ToolError::State { file, reason }
    }

    /// Returns the limit of each coordinate: the last that is given, or that of the robot.
    fn limits(
        &self,
        what: &str,
        given: &[Limit],
        coordinates: &[Coordinate],
        of_robot: impl Fn(&Coordinate) -> Option<f64>,
    ) -> Result<Vec<f64>, ToolError> {
        let mut limits: Vec<Option<f64>> = coordinates.iter().map(of_robot).collect();
        for (name, value) in given {
            let Some(name) = name else {
                limits.fill(Some(*value));
                continue;
            };
            let Some(k) = coordinates.iter().position(|c| c.name == *name) else {
                let near = nearest_name(name, coordinates.iter().map(|c| c.name.as_str()));
                let near = near.map_or(String::new(), |near| format!(" (nearest: {near:?})"));
                return Err(self.wrong(format!("--{what}: joint {name:?} does not exist{near}")));
            };
            limits[k] = Some(*value);
        }
        let named = limits.into_iter().zip(coordinates);
        let each = named.map(|(limit, c)| {
            let none = || self.wrong(format!("joint {:?} has no {what} limit; see --{what}", c.name));
            limit.ok_or_else(none)
        });
        each.collect()
    }
}

pub(crate) fn run(options: &SmoothArguments) -> Result<End, ToolError> {
    let (robot, cell) = options.robot.load()?;
    let path = options.rows.load(&options.robot, &robot, &cell, 1)?;
    let coordinates = cell.coordinates();
    let velocity = options.limits("velocity", &options.velocity, coordinates, |c| c.velocity)?;
    let acceleration = options.limits("acceleration", &options.acceleration, coordinates, |_| None)?;
    let smooth = SmoothOptions::new(velocity, acceleration)
        .continuous_acceleration(options.continuous_acceleration)
        .deviation(options.deviation.unwrap_or(f64::INFINITY));
    let mut checker = Checker::of_robots(cell.clone())?;
    if let Some(margin) = options.margin {
        checker.cell_mut().set_margin(margin)?;
    }
    let bar = progress("pieces", 0);
    let found = Smoother::new(&smooth)
        .progress(&mut |at| {
            bar.set_length(at.total.unwrap_or_default() as u64);
            bar.set_position(at.done as u64);
            Progress::stop_if(false)
        })
        .smooth(&mut checker, &path.rows);
    bar.finish_and_clear();
    let found = match found {
        Err(PlanError::Unproven { segment }) => {
            let [from, to] = [segment, segment + 1].map(|k| path.lines.get(k).unwrap_or(&path.lines[0]));
            say!("lines {from} to {to}: not proven free; see the command certify");
            return Ok(End::Blocked);
        }
        Err(PlanError::Limit {
            what,
            coordinate,
            value,
        }) => {
            let name = &coordinates[coordinate].name;
            let reason =
                format!("{what} limit of joint {name:?} is out of range: {value} (expected a positive number)");
            return Err(options.wrong(format!("{reason}; see --{what}")));
        }
        found => found?,
    };
    let (seconds, corners) = (found.duration(), path.rows.len().saturating_sub(2));
    let stops = found.stops.len();
    let trajectory = Trajectory::from(found);
    let text = trajectory.csv_text(coordinates);
    match &options.csv {
        Some(file) => write(file, &text)?,
        None => output::put(format_args!("{text}")),
    }
    let rows = trajectory.rows.len();
    warn!("a trajectory of {rows} rows, {seconds:.3} s, with stops at {stops} of {corners} inner rows of the path");
    Ok(End::Free)
}
