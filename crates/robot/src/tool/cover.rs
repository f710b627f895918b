//! The command `cover`: writes balls that contain the links, and balls inside, as URDF and JSON.

use std::path::PathBuf;

use clap::Args;
use lin_canny::cover::CoverGoal;
use lin_canny_robot::{cover_links, json_of_balls, urdf_of_balls};

use super::options::RobotOptions;
use super::{End, ToolError, text, write};

#[derive(Args)]
pub(super) struct CoverOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Greatest number of balls that cover each collision element
    #[arg(long, value_name = "N", default_value_t = 8, conflicts_with = "gap")]
    balls: usize,
    /// Greatest distance by which balls stick out, in metres, in place of a number of balls
    #[arg(long, value_name = "LENGTH")]
    gap: Option<f64>,
    /// Greatest number of balls inside each collision element
    #[arg(long, value_name = "N", default_value_t = 8)]
    inner: usize,
    /// Output file: .urdf with the outer balls as spheres, or .json with all balls; may be repeated
    #[arg(long, value_name = "OUT.urdf|OUT.json", value_parser = output)]
    out: Vec<PathBuf>,
}

fn output(name: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(name);
    match file.extension().and_then(|e| e.to_str()) {
        Some("urdf" | "json") => Ok(file),
        _ => Err("expected a name that ends with .urdf or .json".into()),
    }
}

pub(super) fn run(options: &CoverOptions) -> Result<End, ToolError> {
    let (robot, _) = options.robot.load()?;
    let file = options.robot.file();
    if options.robot.skips_meshes() && !robot.skipped().is_empty() {
        return Err(ToolError::Input {
            file: file.to_owned(),
            reason: "a mesh is missing, and balls would not contain it".into(),
        });
    }
    let goal = options.gap.map_or(CoverGoal::Balls(options.balls), CoverGoal::Gap);
    let covers = cover_links(&robot, goal, options.inner).map_err(|error| ToolError::Input {
        file: file.to_owned(),
        reason: error.to_string(),
    })?;
    for cover in &covers {
        let sum = |gap: f64| text::distance(f64::NEG_INFINITY, gap);
        let inside = match &cover.inside {
            Some(inside) => format!("{} inside leave out {}", inside.balls.len(), sum(inside.gap)),
            None => "it has no inside".to_owned(),
        };
        let (balls, gap) = (cover.outside.balls.len(), sum(cover.outside.gap));
        say!("{}: {balls} balls around it stick out {gap}; {inside}", cover.link);
    }
    for out in &options.out {
        let is_urdf = out.extension().is_some_and(|e| e == "urdf");
        let text = match is_urdf {
            true => urdf_of_balls(file, &covers)?,
            false => json_of_balls(&robot, &covers),
        };
        write(out, &text)?;
    }
    Ok(End::Free)
}
