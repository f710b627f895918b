//! A tray of 150 small steel parts: how many are lost with our shape, with our dispatcher, with
//! both.
//!
//! `cargo run --release -p lin-canny-rapier --example parts -- [--csv FILE] [--out FILE.svg] [--seeds N] [--unit M]`
//!
//! Nuts of 12 mm, pins of 3 cm and discs of 16 mm fall into a tray, a mesh of parry, for 8 s at 60
//! steps per second, with rapier in `f32`. Each row is one combination:
//!
//! * parry's hulls and parry's dispatcher;
//! * parry's hulls and our dispatcher, also with the mass properties of our hulls;
//! * our hulls and parry's dispatcher;
//! * our hulls and our dispatcher, also with a `MeshShape` as the tray.
//!
//! The program prints the parts that left the tray (mean of several seeds), the deepest overlap in
//! the last second (worst of the seeds, by certified distances, and below the floor) and the thread
//! time of all steps (mean). The picture shows the first seed.

mod common;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use common::picture::{BLUE, Drawn, GREY, ORANGE, hulls, view};
use common::{Scene, layers, prism};
use cpu_time::ThreadTime;
use lin_canny_rapier::lin_canny_parry::lin_canny::ConvexPolyhedron;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::polyhedron::solids;
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::*;
use lin_canny_rapier::single::{CertifiedDispatcher, Hull, MeshShape, certified_world};
use lin_canny_record::svg::Svg;
use race::progress::Progress;
use truth::command::{count, file, number, write};
use truth::rng::Rng;

/// Drop 150 small steel parts into a tray, with parry's hulls and contacts and with ours
#[derive(Parser)]
struct Options {
    /// Output table, one row per combination: way,lost,deepest_mm,seconds
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/parts.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of seeds for the rotations of the parts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = count(1))]
    seeds: usize,
    /// rapier's length unit in metres (rapier's default is 1)
    #[arg(long, value_name = "M", default_value_t = SIZE, value_parser = unit)]
    unit: f32,
}

/// Reads a length unit.
fn unit(word: &str) -> Result<f32, String> {
    let unit = number(1e-6)(word)?;
    if unit <= 1e6 {
        Ok(unit as f32)
    } else {
        Err("longer than 1e6".into())
    }
}

const PARTS: usize = 150;
const STEPS: usize = 480;
const STEP: f32 = 1.0 / 60.0;
/// Density of steel.
const STEEL: f32 = 7850.0;
/// Diameter of an ordinary part.
const SIZE: f32 = 0.015;
/// Half the width of the tray, and its height.
const TRAY: (f32, f32) = (0.075, 0.06);
/// Thickness of its floor and walls.
const THICKNESS: f32 = 0.002;

/// What of ours is in the world.
#[derive(Clone, Copy)]
struct Way {
    name: &'static str,
    hulls: bool,
    dispatcher: bool,
    tray: bool,
    /// Whether parry's hulls have the mass properties of ours.
    mass: bool,
}

/// rapier as it comes.
const PLAIN: Way = Way {
    name: "rapier",
    hulls: false,
    dispatcher: false,
    tray: false,
    mass: false,
};

const DISPATCHER: Way = Way {
    name: "dispatcher",
    dispatcher: true,
    ..PLAIN
};

const HULLS: Way = Way {
    name: "hulls",
    hulls: true,
    ..PLAIN
};

const BOTH: Way = Way {
    name: "both",
    hulls: true,
    dispatcher: true,
    ..PLAIN
};

const WAYS: [Way; 6] = [
    PLAIN,
    DISPATCHER,
    HULLS,
    BOTH,
    Way {
        name: "both, MeshShape tray",
        tray: true,
        ..BOTH
    },
    Way {
        name: "dispatcher, our mass",
        mass: true,
        ..DISPATCHER
    },
];

/// Returns the vertices of a nut, a pin or a disc.
fn part(k: usize) -> Vec<Vector> {
    match k % 3 {
        0 => prism(6, 0.006, 0.0025),
        1 => prism(8, 0.0015, 0.015),
        _ => prism(16, 0.008, 0.00075),
    }
}

/// Squares along a side of the tray.
const CELLS: usize = 8;

/// Returns the points about a square at a height, `CELLS` to a side.
fn border(half: f32, height: f32) -> Vec<Vector> {
    let along = |j: usize| half * (2.0 * j as f32 / CELLS as f32 - 1.0);
    let side = |turn: usize, j: usize| match turn {
        0 => (along(j), -half),
        1 => (half, along(j)),
        2 => (-along(j), half),
        _ => (-half, -along(j)),
    };
    let all = (0..4).flat_map(|turn| (0..CELLS).map(move |j| side(turn, j)));
    all.map(|(x, z)| Vector::new(x, height, z)).collect()
}

/// Returns the points and triangles of the tray, as a CAD program writes a solid: facing outwards,
/// and closed.
fn tray() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let ((w, h), t) = (TRAY, THICKNESS);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let mut quad = |corners: [Vector; 4]| {
        let first = points.len() as u32;
        points.extend(corners);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    let loops = [border(w, 0.0), border(w, h), border(w + t, h), border(w + t, -t)];
    for pair in loops.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        for k in 0..4 * CELLS {
            let next = (k + 1) % (4 * CELLS);
            quad([a[k], a[next], b[next], b[k]]);
        }
    }
    for (i, k) in (0..CELLS).flat_map(|i| (0..CELLS).map(move |k| (i, k))) {
        let corner = |half: f32, y: f32, i: usize, k: usize| {
            let at = |j: usize| half * (2.0 * j as f32 / CELLS as f32 - 1.0);
            Vector::new(at(i), y, at(k))
        };
        let over = |i, k| corner(w, 0.0, i, k);
        let under = |i, k| corner(w + t, -t, i, k);
        quad([over(i, k), over(i, k + 1), over(i + 1, k + 1), over(i + 1, k)]);
        quad([under(i, k), under(i + 1, k), under(i + 1, k + 1), under(i, k + 1)]);
    }
    (points, triangles)
}

/// Returns parts over the tray.
fn scene(way: Way, unit: f32, seed: u64) -> Scene {
    let dispatcher = CertifiedDispatcher::default();
    let mut world = certified_world(dispatcher, unit, STEP);
    world.gravity = Vector::Y * -9.81;
    if !way.dispatcher {
        world.narrow_phase = NarrowPhase::new();
    }
    let (points, triangles) = tray();
    let shape = match way.tray {
        true => MeshShape::from_triangles(&points, &triangles).expect("a mesh").into(),
        false => SharedShape::trimesh(points, triangles).expect("a mesh"),
    };
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(shape));
    let starts = layers(
        &mut Rng::new(seed + 12),
        (0..PARTS).map(part).collect(),
        TRAY.0 - 0.01,
        0.032,
    );
    let (mut bodies, mut hulls) = (Vec::new(), Vec::new());
    for start in starts {
        let hull = Hull::from_points(&start.points).expect("a solid");
        let shape = match way.hulls {
            true => SharedShape::from(hull.clone()),
            false => SharedShape::convex_hull(&start.points).expect("a hull"),
        };
        let body = RigidBodyBuilder::dynamic().pose(start.pose);
        let collider = match way.mass {
            true => ColliderBuilder::new(shape).mass_properties(hull.mass_properties_at(STEEL)),
            false => ColliderBuilder::new(shape).density(STEEL),
        };
        bodies.push(world.insert(body, collider).0);
        hulls.push(hull);
    }
    Scene { world, bodies, hulls }
}

/// Result of a combination: sums over the seeds, the deepest overlap, the world of the first seed.
struct End {
    lost: usize,
    deepest: f64,
    spent: Duration,
    shown: Scene,
}

/// Whether a part is in the tray.
fn is_in(scene: &Scene, k: usize) -> bool {
    let p = scene.world.bodies[scene.bodies[k]].center_of_mass();
    let (w, h) = TRAY;
    p.x.abs() < w && p.z.abs() < w && p.y > 0.0 && p.y < 4.0 * h
}

/// Returns how far the lowest point of a part in the tray is below the floor.
fn below(scene: &Scene) -> f64 {
    let lowest = |k: usize| {
        let pose = isometry(&scene.pose(k));
        let body = scene.hulls[k].body();
        let heights = body.vertices().filter_map(|v| body.vertex(v)).map(|p| (pose * p).y);
        heights.fold(f64::INFINITY, f64::min)
    };
    let held = (0..PARTS).filter(|&k| is_in(scene, k));
    held.map(|k| -lowest(k)).fold(0.0, f64::max)
}

/// Steps a world of parts; returns the number lost, the deepest overlap of the last second, and the
/// time of the steps.
fn fall(scene: &mut Scene, progress: &Progress) -> (usize, f64, Duration) {
    let (mut deepest, mut spent) = (0.0f64, Duration::ZERO);
    for step in 0..STEPS {
        let start = ThreadTime::now();
        scene.world.step();
        spent += start.elapsed();
        if step + 60 >= STEPS && step % 6 == 5 {
            deepest = scene.depths().into_iter().fold(deepest, f64::max).max(below(scene));
        }
        progress.step();
    }
    let lost = (0..PARTS).filter(|&k| !is_in(scene, k)).count();
    (lost, deepest, spent)
}

fn run_way(way: Way, options: &Options, progress: &Progress) -> End {
    let mut shown = scene(way, options.unit, 0);
    let (mut lost, mut deepest, mut spent) = fall(&mut shown, progress);
    for seed in 1..options.seeds as u64 {
        let (more, depth, time) = fall(&mut scene(way, options.unit, seed), progress);
        lost += more;
        deepest = deepest.max(depth);
        spent += time;
    }
    End {
        lost,
        deepest,
        spent,
        shown,
    }
}

/// Returns a fixed cuboid of the picture.
fn slab(half: [f64; 3], at: [f64; 3]) -> (ConvexPolyhedron, Isometry3<f64>) {
    let body = solids::cuboid(Vector3::from(half)).expect("a solid");
    (body, Isometry3::from_parts(at.into(), Default::default()))
}

fn draw(ends: &[(Way, End)]) -> String {
    let title = "150 steel parts of 1 to 3 cm on a mesh tray after 8 s at 60 Hz, in rapier (f32)";
    let mut picture = Svg::new(1000, 330, title);
    picture.words([500.0, 26.0], 17, "middle", title);
    let (w, h) = (f64::from(TRAY.0), f64::from(TRAY.1));
    let thin = 0.001;
    let walls = [
        slab([w, thin, w], [0.0, -thin, 0.0]),
        slab([thin, 0.5 * h, w], [-w, 0.5 * h, 0.0]),
        slab([w, 0.5 * h, thin], [0.0, 0.5 * h, -w]),
    ];
    for (column, (way, end)) in ends.iter().take(4).enumerate() {
        let center = [130.0 + 247.0 * column as f64, 195.0];
        let view = view(center, 1050.0, 0.75, 0.6);
        let drawn = |(body, pose): &(ConvexPolyhedron, Isometry3<f64>)| (body.clone(), *pose);
        for (body, pose) in walls.iter().map(drawn) {
            let color = GREY;
            hulls(
                &mut picture,
                [1000.0, 330.0],
                &view,
                &[Drawn {
                    body: &body,
                    pose,
                    color,
                }],
            );
        }
        let color = if way.hulls && way.dispatcher { BLUE } else { ORANGE };
        let held = (0..PARTS).filter(|&k| is_in(&end.shown, k));
        let bodies: Vec<Drawn> = held
            .map(|k| Drawn {
                body: end.shown.hulls[k].body(),
                pose: isometry(&end.shown.pose(k)),
                color: color.map(|c| c * (0.75 + 0.25 * ((k * 7919) % 100) as f64 / 100.0)),
            })
            .collect();
        hulls(&mut picture, [1000.0, 330.0], &view, &bodies);
        let who = match way.name {
            "rapier" => "rapier as it comes",
            "dispatcher" => "lin-canny's dispatcher alone",
            "hulls" => "lin-canny's hulls alone",
            _ => "lin-canny's hulls and dispatcher",
        };
        picture.words([center[0], 62.0], 13, "middle", who);
        let lost = (0..PARTS).filter(|&k| !is_in(&end.shown, k)).count();
        let words = format!("{lost} of {PARTS} lost");
        picture.words([center[0], 300.0], 13, "middle", &words);
    }
    picture.finish()
}

fn run(options: &Options) -> Result<(), String> {
    let mut csv = String::from("way,lost,deepest_mm,seconds\n");
    let progress = Progress::new("parts", (WAYS.len() * options.seeds * STEPS) as u64);
    let mut ends = Vec::new();
    println!("{:<24}{:>6}{:>14}{:>10}", "way", "lost", "deepest, mm", "CPU, s");
    for way in WAYS {
        let end = run_way(way, options, &progress);
        let mean = |x: f64| x / options.seeds as f64;
        let (lost, deep) = (mean(end.lost as f64), 1e3 * end.deepest);
        let seconds = mean(end.spent.as_secs_f64());
        println!("{:<24}{lost:>6.1}{deep:>14.2}{seconds:>10.2}", way.name);
        let _ = writeln!(csv, "\"{}\",{lost:.1},{deep:.3},{seconds:.4}", way.name);
        ends.push((way, end));
    }
    drop(progress);
    write(&options.out, &draw(&ends))?;
    options.csv.as_deref().map_or(Ok(()), |path| write(path, &csv))
}

fn main() -> ExitCode {
    truth::command::main(run)
}
