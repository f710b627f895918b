//! Scenes scaled down to a thousandth, and millimetre parts in metres: which contacts lose bodies?
//!
//! `cargo run --release -p lin-canny-rapier --example rapier_small -- [--csv FILE] [--out FILE.svg] [--bodies N]`
//!
//! Sizes, gravity and rapier's length unit are scaled together, so that every scene should behave
//! alike. All bodies have the same mass properties with both contacts. The parts are of steel and 2
//! mm large, at 960 steps per second. Depths are divided by the size of a body.

mod common;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use common::picture::{BLUE, Drawn, ORANGE, Picture, View};
use common::{Engine, Scene, Setup, bin, layers, pebble, prism};
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::Vector;
use truth::command::{count, file, write};
use truth::rng::Rng;

/// Count lost bodies in piles scaled to 1/1000 and in piles of millimetre parts, with parry's
/// contacts and ours
#[derive(Parser)]
struct Options {
    /// Output table with lost bodies, sleeping bodies and the deepest overlap of each pile
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/rapier_small.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of bodies per pile
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = count(1))]
    bodies: usize,
}

/// A kind of bodies of size about 1.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    make: fn(&mut Rng, usize) -> Vec<Vector>,
}

const SCALED: [Kind; 5] = [
    Kind {
        name: "hulls",
        make: |rng, _| pebble(rng, 24, 0.3, 0.5),
    },
    Kind {
        name: "coins",
        make: |_, _| prism(32, 0.4, 0.05),
    },
    Kind {
        name: "plates",
        make: |_, k| {
            if k % 2 == 0 {
                slab(1.0, 0.02, 0.8)
            } else {
                slab(0.6, 0.01, 0.6)
            }
        },
    },
    Kind {
        name: "foils",
        make: |_, _| slab(1.0, 0.002, 0.8),
    },
    Kind {
        name: "needles",
        make: |_, k| {
            if k % 2 == 0 {
                slab(0.02, 1.0, 0.02)
            } else {
                prism(8, 0.01, 0.5)
            }
        },
    },
];

const PARTS: [Kind; 3] = [
    Kind {
        name: "hulls",
        make: |rng, _| pebble(rng, 24, 0.3, 0.5),
    },
    Kind {
        name: "nuts",
        make: |_, k| prism(if k % 2 == 0 { 6 } else { 12 }, 0.5, 0.2),
    },
    Kind {
        name: "pins",
        make: |_, _| prism(8, 0.05, 0.5),
    },
];

/// Returns the vertices of a cuboid of these extents.
fn slab(x: f32, y: f32, z: f32) -> Vec<Vector> {
    let corner = |k: usize| {
        let side = |bit: usize, x: f32| if k & bit == 0 { -x / 2.0 } else { x / 2.0 };
        Vector::new(side(1, x), side(2, y), side(4, z))
    };
    (0..8).map(corner).collect()
}

/// How a pile ended.
struct End {
    lost: usize,
    deepest: f64,
    asleep: usize,
    scene: Scene,
}

fn pile(kind: Kind, count: usize, setup: Setup, scale: f32, steps: usize) -> End {
    let mut rng = Rng::new(17);
    let shapes = (0..count).map(|k| (kind.make)(&mut rng, k)).collect();
    let mut starts = layers(&mut rng, shapes, 1.9, 1.1);
    for start in &mut starts {
        start.points.iter_mut().for_each(|p| *p *= scale);
        start.pose.translation *= scale;
    }
    let walls: Vec<_> = bin(2.0, 24.0)
        .into_iter()
        .map(|(h, c)| (h * scale, c * scale))
        .collect();
    let mut scene = setup.scene(&walls, &starts);
    let mut deepest = 0.0f64;
    for step in 0..steps {
        scene.world.step();
        if step % 4 == 0 {
            deepest = scene.depths().into_iter().fold(deepest, f64::max);
        }
    }
    let (low, high) = (
        Vector::new(-2.0, 0.0, -2.0) * scale,
        Vector::new(2.0, 60.0, 2.0) * scale,
    );
    End {
        lost: scene.lost(low, high),
        deepest: deepest / f64::from(scale),
        asleep: scene.asleep(),
        scene,
    }
}

fn draw(ends: &[(&str, Engine, f32, End)]) -> String {
    let title = "The same piles at a thousandth of the size, in rapier (f32)";
    let mut picture = Picture::new(960, 470, title);
    picture.word([480.0, 26.0], 17, "middle", title);
    for (k, (kind, engine, scale, end)) in ends.iter().enumerate() {
        let (column, row) = (k / 2, k % 2);
        let center = [110.0 + 185.0 * column as f64, 205.0 + 205.0 * row as f64];
        let view = View {
            origin: center,
            scale: 32.0 / f64::from(*scale),
            above: 0.45,
            about: 0.6,
        };
        let color = if *engine == Engine::Ours { BLUE } else { ORANGE };
        let body = |k: usize| {
            let shade = 0.75 + 0.25 * ((k * 7919) % 100) as f64 / 100.0;
            Drawn {
                body: end.scene.hulls[k].body(),
                pose: isometry(&end.scene.pose(k)),
                color: color.map(|c| c * shade),
            }
        };
        let bodies: Vec<Drawn> = (0..end.scene.bodies.len()).map(body).collect();
        picture.bodies(&view, &bodies);
        let who = if *engine == Engine::Ours { "lin-canny" } else { "parry" };
        let words = format!("{kind}, {who}: {} lost", end.lost);
        picture.word([center[0], center[1] - 150.0], 13, "middle", &words);
    }
    picture.finish()
}

fn run(options: &Options) -> Result<(), String> {
    let mut csv = String::from("scene,kind,scale,engine,lost,deepest,asleep\n");
    print!("{csv}");
    let mut drawn = Vec::new();
    let mut note = |scene: &str, kind: Kind, scale: f32, engine: Engine, end: &End| {
        let (
            name,
            End {
                lost, deepest, asleep, ..
            },
        ) = (engine.name(), end);
        let line = format!("{scene},{},{scale},{name},{lost},{deepest:.4},{asleep}", kind.name);
        println!("{line}");
        let _ = writeln!(csv, "{line}");
    };
    for kind in SCALED {
        for scale in [1.0, 0.1, 0.01, 0.001] {
            for engine in Engine::BOTH {
                let plain = Setup::of(engine);
                let setup = Setup {
                    size: scale,
                    gravity: 9.81 * scale,
                    ..plain
                };
                let end = pile(kind, options.bodies, setup, scale, 360);
                note("scaled", kind, scale, engine, &end);
                if scale == 0.001 {
                    drawn.push((kind.name, engine, scale, end));
                }
            }
        }
    }
    for kind in PARTS {
        for engine in Engine::BOTH {
            let setup = Setup {
                size: 0.002,
                step: 1.0 / 960.0,
                density: 7800.0,
                ..Setup::of(engine)
            };
            let end = pile(kind, options.bodies, setup, 0.002, 480);
            note("millimetres", kind, 0.002, engine, &end);
        }
    }
    write(&options.out, &draw(&drawn))?;
    options.csv.as_deref().map_or(Ok(()), |path| write(path, &csv))
}

fn main() -> ExitCode {
    truth::command::main(run)
}
