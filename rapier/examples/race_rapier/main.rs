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
use clap::{Parser, ValueEnum};
use lab::boxes::Kind;
use lab::race::{Options, Rows, boxes, scene};
use pipeline::Pipeline;
use std::process::ExitCode;

/// Boxes of many bodies and whole scenes: ours and parry's parts against rapier
#[derive(Parser)]
struct Command {
    /// Which race
    #[arg(value_enum)]
    race: Race,
    #[command(flatten)]
    options: Options,
}

#[derive(Clone, Copy, ValueEnum)]
enum Race {
    Boxes,
    Scene,
}

fn main() -> ExitCode {
    lab::command::main(race)
}

fn race(Command { race, options }: &Command) -> Result<(), String> {
    let (scenes, run): (Vec<&str>, fn(&Options) -> Rows) = match race {
        Race::Boxes => (boxes::RACED.map(Kind::name).into(), |o| {
            boxes::run(o, &[("rapier", |scene| Box::new(Broad::new(scene)))])
        }),
        Race::Scene => (scene::SCENES.map(|s| s.0).into(), |o| {
            scene::run(o, &[("rapier-collision", |crowd| Box::new(Pipeline::new(crowd)))])
        }),
    };
    options.check(&scenes)?;
    options.save(&run(options))
}
