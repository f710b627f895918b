//! Towers of ten prisms, laid on each other: do they remain upright for 1,000 steps?
//!
//! `cargo run --release -p lin-canny-rapier --example towers -- [--with FILE.csv]... [--csv FILE] [--out FILE.svg]`
//!
//! rapier runs with parry's contacts and with ours. `--with` adds the towers of another engine, one
//! row per body, in the format of `--csv` (`crates/python/bench/towers.py` writes those of MuJoCo).
//! The program prints the greatest displacement of a prism, divided by its size. The picture shows
//! the 2 cm towers.

mod common;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use common::picture::{BLUE, Drawn, ORANGE, hulls, view};
use common::{Engine, Setup, Start, prism};
use lin_canny_rapier::lin_canny_parry::lin_canny::ConvexPolyhedron;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Unit};
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::*;
use lin_canny_record::svg::Svg;
use truth::command::{file, read, write};

/// Simulate towers of ten prisms for 1,000 steps, with parry's contacts and with ours
#[derive(Parser)]
struct Options {
    /// Table with the towers of another engine, in the format of --csv
    #[arg(long, value_name = "FILE.csv")]
    with: Vec<PathBuf>,
    /// Output table with the final position of each prism
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/towers.svg", value_parser = file("svg"))]
    out: PathBuf,
}

/// Diameters of the prisms, which are half as high.
const SIZES: [f32; 3] = [1.0, 0.1, 0.02];
const SIDES: [usize; 4] = [4, 6, 12, 32];
const PRISMS: usize = 10;
const STEPS: usize = 1000;
const STEP: f32 = 1.0 / 240.0;

/// Beyond this, over the size, a tower counts as fallen.
const FALLEN: f64 = 0.5;

const HEADER: &str = "engine,size,sides,prism,x,y,z,qx,qy,qz,qw\n";

/// A prism at the end.
struct Row {
    engine: String,
    size: f32,
    sides: usize,
    prism: usize,
    pose: Isometry3<f64>,
}

fn laid(size: f32, prism: usize) -> f32 {
    0.25 * size + 0.5 * size * prism as f32
}

fn build(engine: Engine, size: f32, sides: usize) -> Vec<Row> {
    let start = |k: usize| Start {
        points: prism(sides, 0.5 * size, 0.25 * size),
        pose: Pose::translation(0.0, laid(size, k), 0.0),
    };
    let starts: Vec<Start> = (0..PRISMS).map(start).collect();
    let ground = (Vector::new(9.0, 0.5, 9.0) * size, Vector::new(0.0, -0.5 * size, 0.0));
    let mut scene = Setup {
        step: STEP,
        size,
        ..Setup::of(engine)
    }
    .scene(&[ground], &starts);
    for _ in 0..STEPS {
        scene.world.step();
    }
    let row = |k: usize| Row {
        engine: engine.name().into(),
        size,
        sides,
        prism: k,
        pose: isometry(&scene.pose(k)),
    };
    (0..PRISMS).map(row).collect()
}

/// Reads the rows of another engine.
fn other(text: &str) -> Result<Vec<Row>, String> {
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let numbers: Option<Vec<f64>> = fields.get(1..)?.iter().map(|f| f.parse().ok()).collect();
        let [size, sides, prism, x, y, z, i, j, k, w] = numbers?[..] else {
            return None;
        };
        let turn = Unit::try_new(Quaternion::new(w, i, j, k), 1e-9)?;
        Some(Row {
            engine: fields[0].into(),
            size: size as f32,
            sides: sides as usize,
            prism: prism as usize,
            pose: Isometry3::from_parts([x, y, z].into(), turn),
        })
    };
    let lines = text.lines().enumerate().skip(1);
    lines
        .map(|l| row(l.1).ok_or_else(|| format!("line {}: no row of a tower: {}", l.0 + 1, l.1)))
        .collect()
}

/// Returns how far any prism of a tower moved, over the size.
fn moved(tower: &[&Row]) -> f64 {
    let off = |r: &&Row| {
        let p = r.pose.translation.vector;
        let rise = p.y - f64::from(laid(r.size, r.prism));
        (p.x * p.x + rise * rise + p.z * p.z).sqrt() / f64::from(r.size)
    };
    tower.iter().map(off).fold(0.0, f64::max)
}

/// The towers of an engine at a size, by their sides.
fn towers<'a>(rows: &'a [Row], engine: &str, size: f32) -> Vec<(usize, Vec<&'a Row>)> {
    let is_of = |r: &&Row, sides: usize| r.engine == engine && (r.size - size).abs() < 1e-6 && r.sides == sides;
    SIDES
        .map(|sides| (sides, rows.iter().filter(|r| is_of(r, sides)).collect()))
        .into()
}

fn draw(rows: &[Row], engines: &[String]) -> String {
    let title = "Towers of ten prisms of two centimetres after 1,000 steps of 1/240 s";
    let (width, height) = (1000, 40 + 250 * engines.len() as u32);
    let mut picture = Svg::new(width, height, title);
    picture.words([500.0, 26.0], 17, "middle", title);
    let size = SIZES[SIZES.len() - 1];
    for (row, engine) in engines.iter().enumerate() {
        let base = 240.0 + 250.0 * row as f64;
        let name = match engine.as_str() {
            "parry" => "rapier with parry's hulls and contacts",
            "ours" => "rapier with lin-canny's hulls and contacts",
            other => other,
        };
        picture.words([16.0, base - 180.0], 15, "start", name);
        picture.line([20.0, base], [980.0, base], "stroke=\"#9aa0a6\" stroke-width=\"1.5\"");
        for (k, (sides, tower)) in towers(rows, engine, size).into_iter().enumerate() {
            let center = 140.0 + 240.0 * k as f64;
            let view = view([center, base], 30.0 / f64::from(size), 0.06, 0.5);
            let moved = moved(&tower);
            let points = prism(sides, 0.5 * size, 0.25 * size);
            let points: Vec<Point3<f64>> = points.iter().map(|p| [p.x, p.y, p.z].map(f64::from).into()).collect();
            let Ok(body) = ConvexPolyhedron::from_points(&points) else {
                continue;
            };
            let color = if moved > FALLEN { ORANGE } else { BLUE };
            let near = |r: &&&Row| r.pose.translation.vector.amax() < 3.6 * f64::from(size) || moved < FALLEN;
            let bodies: Vec<Drawn> = tower
                .iter()
                .filter(near)
                .map(|r| Drawn {
                    body: &body,
                    pose: r.pose,
                    color,
                })
                .collect();
            hulls(&mut picture, [f64::from(width), f64::from(height)], &view, &bodies);
            picture.words(
                [center, base + 34.0],
                12,
                "middle",
                &format!("{sides} sides, moved {moved:.2} sizes"),
            );
        }
    }
    picture.finish()
}

fn run(options: &Options) -> Result<(), String> {
    let mut rows = Vec::new();
    for (engine, size, sides) in Engine::BOTH
        .into_iter()
        .flat_map(|e| SIZES.into_iter().flat_map(move |s| SIDES.map(|n| (e, s, n))))
    {
        rows.extend(build(engine, size, sides));
    }
    for path in &options.with {
        let found = other(&read(path)?).map_err(|e| format!("{}: {e}", path.display()))?;
        rows.extend(found);
    }
    let mut engines: Vec<String> = rows.iter().map(|r| r.engine.clone()).collect();
    engines.dedup();
    println!("most that any of ten prisms moved, over the size; sides 4, 6, 12, 32");
    for engine in &engines {
        for size in SIZES {
            let list: Vec<String> = towers(&rows, engine, size)
                .iter()
                .map(|t| format!("{:8.3}", moved(&t.1)))
                .collect();
            println!("{engine:8} {:>6} {}", format!("{size} m"), list.concat());
        }
    }
    let mut csv = String::from(HEADER);
    for r in &rows {
        let (p, q) = (r.pose.translation.vector, r.pose.rotation.coords);
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{},{},{},{},{}",
            r.engine, r.size, r.sides, r.prism, p.x, p.y, p.z, q.x, q.y, q.z, q.w
        );
    }
    write(&options.out, &draw(&rows, &engines))?;
    options.csv.as_deref().map_or(Ok(()), |path| write(path, &csv))
}

fn main() -> ExitCode {
    truth::command::main(run)
}
