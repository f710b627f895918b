//! Races of many bodies, with rapier as one of the engines.
//!
//! ```text
//! cargo run --release -p lin-canny-rapier --example race_rapier -- boxes|scene|scenes [--csv FILE] [--quick] [--only SCENE] [--upto N]
//! ```
//!
//! `boxes` and `scene` equal the races of the instrument `race`. The engine `rapier` is rapier's
//! broad phase alone, `rapier-collision` its `CollisionPipeline`: events, contact manifolds within
//! 0.02, approximate depth. `scenes` runs whole rapier worlds with parry's narrow phase and with
//! ours.

mod broad;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/ordinary.rs"]
mod ordinary;
mod pipeline;
mod scenes;

use lin_canny_rapier::single as engine;

use broad::Broad;
use clap::{Parser, ValueEnum};
use pipeline::Pipeline;
use race::common::{Options, Rows, boxes, scene};
use std::process::ExitCode;
use truth::boxes::Kind;

/// Compare broad phases, collision detection and whole steps with parry and rapier
#[derive(Parser)]
struct Command {
    /// Race to run
    #[arg(value_enum)]
    race: Race,
    #[command(flatten)]
    options: Options,
}

#[derive(Clone, Copy, ValueEnum)]
enum Race {
    /// Broad phases of many bodies
    Boxes,
    /// Collision detection of whole scenes, without dynamics
    Scene,
    /// Whole steps of rapier, with parry's narrow phase and with ours
    Scenes,
}

fn main() -> ExitCode {
    truth::command::main(race)
}

fn race(Command { race, options }: &Command) -> Result<(), String> {
    let (scenes, run): (Vec<&str>, fn(&Options) -> Rows) = match race {
        Race::Boxes => (boxes::RACED.map(Kind::name).into(), |o| {
            boxes::run(o, &[("rapier", |scene| Box::new(Broad::new(scene)))])
        }),
        Race::Scene => (scene::SCENES.map(|s| s.0).into(), |o| {
            scene::run(o, &[("rapier-collision", |crowd| Box::new(Pipeline::new(crowd)))])
        }),
        Race::Scenes => (scenes::names(), scenes::run),
    };
    options.check(&scenes)?;
    options.save(&run(options))
}
