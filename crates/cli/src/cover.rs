//! The command `cover`: writes balls that contain the links, and balls inside, or hulls of few
//! faces, as URDF and JSON.

use std::path::{Path, PathBuf};

use clap::Args;
use lin_canny::cover::CoverGoal;
use lin_canny_cli::{RobotOptions, values};
use lin_canny_robot::{
    LinkCoverError, LinkHulls, Robot, cover_links, hull_links, json_of_balls, json_of_hulls, urdf_of_balls,
    urdf_of_hulls,
};

use crate::end::{End, ToolError};
use crate::text::{self, write};

#[derive(Args)]
pub(crate) struct CoverOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Greatest number of balls that cover each collision element
    #[arg(long, value_name = "N", default_value_t = 8, conflicts_with = "gap")]
    balls: usize,
    /// Greatest distance by which balls stick out, in metres, instead of a number of balls
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    gap: Option<f64>,
    /// Greatest number of balls inside each collision element
    #[arg(long, value_name = "N", default_value_t = 8)]
    inner: usize,
    /// Greatest number of faces of a hull around each collision element, instead of balls
    #[arg(long, value_name = "N", conflicts_with_all = ["balls", "gap", "inner"])]
    faces: Option<usize>,
    /// Output file: .urdf with outer balls as spheres or hulls as OBJ files next to it, or .json with
    /// all balls or hulls; may be repeated
    #[arg(long, value_name = "OUT.urdf|OUT.json", value_parser = values::cover_file)]
    out: Vec<PathBuf>,
}

pub(crate) fn run(options: &CoverOptions) -> Result<End, ToolError> {
    let (robot, _) = options.robot.load()?;
    let file = &options.robot.robot;
    if options.robot.skip_missing_meshes && !robot.skipped().is_empty() {
        return Err(ToolError::Input {
            file: file.to_owned(),
            reason: "a mesh is missing, and the cover would not contain it".into(),
        });
    }
    let wrong = |error: LinkCoverError| ToolError::Input {
        file: file.to_owned(),
        reason: error.to_string(),
    };
    if let Some(faces) = options.faces {
        let hulls = hull_links(&robot, faces).map_err(wrong)?;
        return write_hulls(options, file, &robot, &hulls);
    }
    let goal = options.gap.map_or(CoverGoal::Balls(options.balls), CoverGoal::Gap);
    let covers = cover_links(&robot, goal, options.inner).map_err(wrong)?;
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
        let text = match is_urdf(out) {
            true => urdf_of_balls(file, &covers)?,
            false => json_of_balls(&robot, &covers),
        };
        write(out, &text)?;
    }
    Ok(End::Free)
}

fn is_urdf(out: &Path) -> bool {
    out.extension().is_some_and(|e| e == "urdf")
}

fn write_hulls(options: &CoverOptions, file: &Path, robot: &Robot, hulls: &[LinkHulls]) -> Result<End, ToolError> {
    for row in hulls {
        let gap = row
            .hulls
            .iter()
            .fold(0.0, |most, cover| if cover.gap > most { cover.gap } else { most });
        let faces = row.hulls.iter().map(|cover| cover.planes.len()).max().unwrap_or(0);
        let (count, gap) = (row.hulls.len(), text::distance(f64::NEG_INFINITY, gap));
        let noun = if count == 1 { "hull" } else { "hulls" };
        say!(
            "{}: {count} {noun} of up to {faces} faces around it, which stick out {gap}",
            row.link
        );
    }
    for out in &options.out {
        if !is_urdf(out) {
            write(out, &json_of_hulls(robot, hulls))?;
            continue;
        }
        let stem = out.file_stem().unwrap_or_default().to_string_lossy();
        let name = |row: usize, k: usize| format!("{stem}-{row}-{k}.obj");
        let text = urdf_of_hulls(file, hulls, name)?;
        for (row, link) in hulls.iter().enumerate() {
            for (k, cover) in link.hulls.iter().enumerate() {
                write(&out.with_file_name(name(row, k)), &cover.hull.to_obj())?;
            }
        }
        write(out, &text)?;
    }
    Ok(End::Free)
}
