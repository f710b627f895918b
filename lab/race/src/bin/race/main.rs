//! Races against other libraries on the same motions.
//!
//! ```text
//! cargo run --release -p race --bin race -- pairs [--csv FILE] [--quick] [--only SCENE] [--upto N]
//! ```

mod bending;
mod cad;
mod clouds;
mod contact;
mod curved;
mod curves;
mod gate;
mod impact;
mod instructions;
mod mbm;
mod meshes;
mod pairs;
mod patches;
mod plan;
mod point_queries;
mod points;
mod rays;
mod rrt;

use clap::{Parser, ValueEnum};
use race::common::{Options, Rows, boxes, scene};
use std::path::PathBuf;
use std::process::ExitCode;
use truth::boxes::Kind;

/// Compare the speed of this crate with other libraries
///
/// Each race measures one kind of query: closest points of polyhedra or curved shapes, contacts,
/// broad phases, whole scenes, casts, meshes, segments of planners, curves of joints, Bézier
/// surfaces, rays, hulls, clouds and points. The race `mbm` plans the problems of MotionBenchMaker
/// in the folder of `--data`; `--only` names a robot, and `--upto` the number of problems of a set.
/// The race `instructions` counts the instructions of queries. The race `gate` runs 30 cells of the
/// others in two minutes, and names the cells that are more than 5 % slower than in
/// `benches/record/gate.csv`.
#[derive(Parser)]
struct Command {
    /// Race to run
    #[arg(value_enum)]
    race: Race,
    #[command(flatten)]
    options: Options,
    /// Write the results of `gate` to `benches/record/gate.csv`
    #[arg(long)]
    save: bool,
    /// Folder of `mbm`, or of robots for `curves`: `resources` of the source package vamp-planner,
    /// problems unpacked
    #[arg(long, value_name = "FOLDER")]
    data: Option<PathBuf>,
    /// Paths of another planner that `mbm` certifies: JSON lines with robot, set, index and path
    #[arg(long, value_name = "FILE", requires = "data")]
    paths: Option<PathBuf>,
    /// One cell of the table of instructions, run in its own process
    #[arg(long, hide = true)]
    cell: Option<String>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Race {
    Pairs,
    Curved,
    Curves,
    Contact,
    Boxes,
    Scene,
    Impact,
    Meshes,
    Plan,
    Patches,
    Rays,
    Hulls,
    Clouds,
    Points,
    Instructions,
    Mbm,
    Gate,
}

fn main() -> ExitCode {
    truth::command::main(race)
}

fn race(
    Command {
        race,
        options,
        save,
        data,
        paths,
        cell,
    }: &Command,
) -> Result<(), String> {
    if let Some(cell) = cell {
        return instructions::run_cell(cell);
    }
    if *save && !matches!(race, Race::Gate) {
        return Err("--save belongs to gate".into());
    }
    if data.is_some() && !matches!(race, Race::Curves | Race::Mbm) {
        return Err("--data belongs to curves and mbm".into());
    }
    let (scenes, run): (Vec<&str>, fn(&Options) -> Rows) = match race {
        Race::Pairs => (pairs::SCENES.into(), pairs::run),
        Race::Curved => (curved::SCENES.into(), curved::run),
        Race::Curves => {
            options.check(&curves::SCENES)?;
            return options.save(&curves::run(options, data.as_deref())?);
        }
        Race::Contact => (truth::contacts::SCENES.into(), contact::run),
        Race::Boxes => (boxes::RACED.map(Kind::name).into(), |o| boxes::run(o, &[])),
        Race::Scene => (scene::SCENES.map(|s| s.0).into(), |o| scene::run(o, &[])),
        Race::Impact => (impact::SCENES.map(|s| s.0).into(), impact::run),
        Race::Meshes => (meshes::SCENES.into(), meshes::run),
        Race::Plan => (plan::SCENES.into(), plan::run),
        Race::Patches => (patches::SCENES.into(), patches::run),
        Race::Rays => (rays::SCENES.into(), rays::run),
        Race::Hulls => (points::SCENES.into(), points::run),
        Race::Mbm => {
            options.check(&mbm::ROBOTS)?;
            return mbm::run(options, data.as_deref(), paths.as_deref());
        }
        Race::Gate => return gate::run(*save),
        Race::Clouds => (clouds::SCENES.into(), clouds::run),
        Race::Points => (point_queries::SCENES.into(), point_queries::run),
        Race::Instructions => {
            options.check(&instructions::SCENES)?;
            return options.save(&instructions::run(options)?);
        }
    };
    options.check(&scenes)?;
    options.save(&run(options))
}
