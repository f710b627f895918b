//! The races of many bodies with rapier among the engines.
//!
//! ```text
//! cargo run --release -p lin-canny-rapier --example race_rapier -- boxes|scene [--csv FILE] [--quick] [--only SCENE] [--upto N]
//! ```
//!
//! The races are those of the instrument `race`; `rapier` is the broad phase of rapier alone, `rapier-collision` its
//! `CollisionPipeline`: events, contact manifolds within 0.02, approximate depth.

mod broad;
mod pipeline;

use broad::Broad;
use lab::boxes::Kind;
use lab::race::{self, Options, Rows, boxes, scene};
use pipeline::Pipeline;
use std::process::ExitCode;

const USAGE: &str = "\
usage: race_rapier boxes|scene [--csv FILE] [--quick] [--only SCENE] [--upto N]

Boxes of many bodies and whole scenes: ours and parry's parts against rapier.

  --csv FILE     one row a result: scene,shape,n,engine,ns
  --quick        a thousand bodies
  --only SCENE   one scene of the race
  --upto N       no more bodies than these";

fn main() -> ExitCode {
    let parsed = race::parse(std::env::args().skip(1));
    lab::command::main("race_rapier", USAGE, parsed, race)
}

fn race((name, options): &(String, Options)) -> Result<(), String> {
    let (scenes, run): (Vec<&str>, fn(&Options) -> Rows) = match name.as_str() {
        "boxes" => (boxes::RACED.map(Kind::name).into(), |o| {
            boxes::run(o, &[("rapier", |scene| Box::new(Broad::new(scene)))])
        }),
        "scene" => (scene::SCENES.map(|s| s.0).into(), |o| {
            scene::run(o, &[("rapier-collision", |crowd| Box::new(Pipeline::new(crowd)))])
        }),
        _ => return Err(format!("{name} is no race")),
    };
    options.check(&scenes)?;
    options.save(&run(options))
}
