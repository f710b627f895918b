//! Races against other libraries on the same motions.
//!
//! ```text
//! cargo run --release -p lab --bin race -- pairs|curved|contact|boxes|scene|impact|meshes|plan|patches [--csv FILE] [--quick] [--only SCENE] [--upto N]
//! ```

mod cad;
mod contact;
mod curved;
mod impact;
mod meshes;
mod pairs;
mod patches;
mod plan;
mod rrt;

use lab::boxes::Kind;
use lab::race::{self, Options, Rows, boxes, scene};
use std::process::ExitCode;

const USAGE: &str = "\
usage: race pairs|curved|contact|boxes|scene|impact|meshes|plan|patches [--csv FILE] [--quick] [--only SCENE] [--upto N]

Ours against other libraries: closest points of two bodies, of two curved shapes, their contacts, boxes of many bodies,
whole scenes, casts of moving bodies, meshes, segments of planners, curved surfaces.

  --csv FILE     one row a result: scene,shape,n,engine,ns
  --quick        pairs, contact, impact, plan and patches: fewer frames and passes; boxes and scene: a thousand bodies
  --only SCENE   one scene of the race
  --upto N       boxes and scene: no more bodies than these";

fn main() -> ExitCode {
    let parsed = race::parse(std::env::args().skip(1));
    lab::command::main("race", USAGE, parsed, race)
}

fn race((name, options): &(String, Options)) -> Result<(), String> {
    let (scenes, run): (Vec<&str>, fn(&Options) -> Rows) = match name.as_str() {
        "pairs" => (pairs::SCENES.into(), pairs::run),
        "curved" => (curved::SCENES.into(), curved::run),
        "contact" => (lab::contacts::SCENES.into(), contact::run),
        "boxes" => (boxes::RACED.map(Kind::name).into(), |o| boxes::run(o, &[])),
        "scene" => (scene::SCENES.map(|s| s.0).into(), |o| scene::run(o, &[])),
        "impact" => (impact::SCENES.map(|s| s.0).into(), impact::run),
        "meshes" => (meshes::SCENES.into(), meshes::run),
        "plan" => (plan::SCENES.into(), plan::run),
        "patches" => (patches::SCENES.into(), patches::run),
        _ => return Err(format!("{name} is no race")),
    };
    options.check(&scenes)?;
    options.save(&run(options))
}
