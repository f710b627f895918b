//! A coin laid flat on the ground, of 4 to 128 sides, for ten seconds: does it lie still?
//!
//! `cargo run --release -p lin-canny-rapier --example coin -- [--csv FILE] [--out FILE.svg]`
//!
//! The ground is a half-space or a cuboid. The program prints the tilt of the coin at the end, how
//! far its centre sank, and whether it sleeps. The picture shows the coins on the half-space.

mod common;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use common::picture::{BLUE, Drawn, ORANGE, hulls, view};
use common::{Engine, Scene, Setup, Start, prism};
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::*;
use lin_canny_record::svg::Svg;
use truth::command::{file, write};

/// Compare coins with 4 to 128 sides, laid flat on a half-space and a cuboid, with parry's hulls
/// and ours
#[derive(Parser)]
struct Options {
    /// Output table with tilt, sinking and sleep of each coin
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/coin.svg", value_parser = file("svg"))]
    out: PathBuf,
}

const SIDES: [usize; 9] = [4, 5, 6, 8, 12, 16, 32, 64, 128];
const RADIUS: f32 = 0.4;
const HALF: f32 = 0.05;
const STEPS: usize = 600;

/// How a coin lies at the end.
struct Lying {
    tilt: f32,
    sunk: f32,
    asleep: bool,
    scene: Scene,
}

fn lay(engine: Engine, sides: usize, on_space: bool) -> Lying {
    let pose = Pose::translation(0.0, HALF, 0.0);
    let start = Start {
        points: prism(sides, RADIUS, HALF),
        pose,
    };
    let ground = (Vector::new(5.0, 0.5, 5.0), Vector::new(0.0, -0.5, 0.0));
    let walls: &[_] = if on_space { &[] } else { &[ground] };
    let mut scene = Setup::of(engine).scene(walls, &[start]);
    if on_space {
        scene.world.insert(
            RigidBodyBuilder::fixed(),
            ColliderBuilder::new(SharedShape::halfspace(Vector::Y)),
        );
    }
    for _ in 0..STEPS {
        scene.world.step();
    }
    let pose = scene.pose(0);
    let up = (pose.rotation * Vector::Y).y.clamp(-1.0, 1.0);
    Lying {
        tilt: up.acos().to_degrees(),
        sunk: HALF - pose.translation.y,
        asleep: scene.asleep() == 1,
        scene,
    }
}

fn draw(coins: &[(Engine, Vec<Lying>)]) -> String {
    let title = "Coins of 4 to 128 sides, laid flat on a half-space, after ten seconds";
    let mut picture = Svg::new(960, 375, title);
    picture.words([480.0, 26.0], 17, "middle", title);
    for (row, (engine, coins)) in coins.iter().enumerate() {
        let base = 125.0 + 165.0 * row as f64;
        picture.words(
            [16.0, base - 56.0],
            15,
            "start",
            match engine {
                Engine::Parry => "rapier with parry's hulls and contacts",
                Engine::Ours => "rapier with lin-canny's hulls and contacts",
            },
        );
        picture.line([20.0, base], [940.0, base], "stroke=\"#9aa0a6\" stroke-width=\"1.5\"");
        for (k, coin) in coins.iter().enumerate() {
            let center = 75.0 + 101.0 * k as f64;
            let color = if coin.tilt < 1.0 { BLUE } else { ORANGE };
            let view = view([center, base], 105.0, 0.06, 0.5);
            let pose = isometry(&coin.scene.pose(0));
            // The place is kept: a coin may have rolled off.
            let pose = lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::Isometry3::from_parts(
                [0.0, pose.translation.y, 0.0].into(),
                pose.rotation,
            );
            hulls(
                &mut picture,
                [960.0, 375.0],
                &view,
                &[Drawn {
                    body: coin.scene.hulls[0].body(),
                    pose,
                    color,
                }],
            );
            picture.words(
                [center, base + 74.0],
                12,
                "middle",
                &format!("{} sides, {:.1}°", SIDES[k], coin.tilt),
            );
        }
    }
    picture.finish()
}

fn run(options: &Options) -> Result<(), String> {
    let mut csv = String::from("engine,ground,sides,tilt_degrees,sunk,asleep\n");
    let mut drawn = Vec::new();
    for engine in Engine::BOTH {
        for on_space in [true, false] {
            let ground = if on_space { "half-space" } else { "cuboid" };
            let coins: Vec<Lying> = SIDES.iter().map(|&sides| lay(engine, sides, on_space)).collect();
            for (sides, c) in SIDES.iter().zip(&coins) {
                let name = engine.name();
                let _ = writeln!(csv, "{name},{ground},{sides},{:.3},{:.4},{}", c.tilt, c.sunk, c.asleep);
            }
            let still = coins.iter().filter(|c| c.asleep && c.tilt < 0.1).count();
            println!(
                "{:5} on a {ground}: {still} of {} coins lie still",
                engine.name(),
                SIDES.len()
            );
            if on_space {
                drawn.push((engine, coins));
            }
        }
    }
    print!("{csv}");
    write(&options.out, &draw(&drawn))?;
    options.csv.as_deref().map_or(Ok(()), |path: &Path| write(path, &csv))
}

fn main() -> ExitCode {
    truth::command::main(run)
}
