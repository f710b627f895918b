//! The races of many bodies with rapier among the engines.
//!
//! ```text
//! cargo run --release -p lin-canny-rapier --example race_rapier -- boxes|scene [--csv FILE] [--quick] [--only SCENE] [--upto N]
//! ```
//!
//! The races are those of example `race` of `lin-canny`; `rapier` is the broad phase of rapier alone, `rapier-collision` its
//! `CollisionPipeline`: events, contact manifolds within 0.02, approximate depth.

#[path = "../../../examples/race/boxes/mod.rs"]
mod boxes;
mod broad;
#[path = "../../../examples/race/common.rs"]
#[expect(dead_code, reason = "what races of pairs share is in the same file")]
mod common;
#[path = "../../../examples/race/hulls.rs"]
mod hulls;
mod pipeline;
#[path = "../../../examples/race/scene/mod.rs"]
mod scene;
#[path = "../../../examples/race/tree.rs"]
mod tree;

use broad::Broad;
use common::{Options, Rows};
use lab::boxes::Kind;
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
    let parsed = common::parse(std::env::args().skip(1));
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
