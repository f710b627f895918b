//! Races of rapier's worlds, with parry's contacts and with ours.
//!
//! ```text
//! cargo bench -p lin-canny-rapier --bench race -- boxes|scene|scenes|pile|calls [--csv FILE] [--quick] ...
//! ```
//!
//! `boxes` and `scene` equal the races of the instrument `race`. The engine `rapier` is rapier's
//! broad phase alone, `rapier-collision` its `CollisionPipeline`: events, contact manifolds within
//! 0.02, approximate depth. `scenes` runs whole rapier worlds with parry's narrow phase and with
//! ours, `pile` hulls that fall into a bin, and `calls` repeats the calls of such a pile outside
//! rapier.

mod broad;
mod calls;
#[path = "../../examples/common/mod.rs"]
mod common;
mod ordinary;
mod pile;
mod pipeline;
mod scenes;

use lin_canny_rapier::single as engine;

use broad::Broad;
use clap::{Parser, Subcommand};
use pipeline::Pipeline;
use race::common::{Options, Rows, boxes, scene};
use std::process::ExitCode;
use truth::boxes::Kind;

/// Compare broad phases, collision detection, contacts and whole steps with parry and rapier
#[derive(Parser)]
struct Command {
    #[command(subcommand)]
    race: Race,
    /// Cargo passes it to every benchmark.
    #[arg(long, hide = true, global = true)]
    bench: bool,
}

#[derive(Subcommand)]
enum Race {
    /// Broad phases of many bodies
    Boxes(Options),
    /// Collision detection of whole scenes, without dynamics
    Scene(Options),
    /// Whole steps of rapier, with parry's narrow phase and with ours
    Scenes(Options),
    /// Cost per step and deepest overlap of a pile of hulls
    Pile(pile::Options),
    /// Cost per call of the contact dispatcher, replayed from a pile
    Calls(calls::Options),
}

fn main() -> ExitCode {
    truth::command::main(|Command { race, .. }: &Command| match race {
        Race::Boxes(options) => rows(options, &boxes::RACED.map(Kind::name), |o| {
            boxes::run(o, &[("rapier", |scene| Box::new(Broad::new(scene)))])
        }),
        Race::Scene(options) => rows(options, &scene::SCENES.map(|s| s.0), |o| {
            scene::run(o, &[("rapier-collision", |crowd| Box::new(Pipeline::new(crowd)))])
        }),
        Race::Scenes(options) => rows(options, &scenes::names(), scenes::run),
        Race::Pile(options) => pile::run(options),
        Race::Calls(options) => calls::run(options),
    })
}

fn rows(options: &Options, scenes: &[&str], run: fn(&Options) -> Rows) -> Result<(), String> {
    options.check(scenes)?;
    options.save(&run(options))
}
