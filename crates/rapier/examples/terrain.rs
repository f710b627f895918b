//! Small bodies on a terrain: a mesh of parry with parry's contacts, and a `MeshShape` with ours.
//!
//! `cargo run --release -p lin-canny-rapier --example terrain -- [--csv FILE] [--bodies N] [--size M] [--steps N] [--upto N]`
//!
//! Bodies of 2 mm (hulls of 14 points, boxes, capsules, balls, cylinders, cones) fall onto hills
//! with cells of 0.1 m, at 960 steps per second. A body below the ground at the end counts as lost.
//! Depths are divided by the size of a body. Times are CPU time per step, from one run each.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use cpu_time::ThreadTime;
use lin_canny_rapier::single::rapier::parry::query::{QueryDispatcher, Ray, RayCast};
use lin_canny_rapier::single::rapier::prelude::*;
use lin_canny_rapier::single::{CertifiedDispatcher, Hull, MeshShape, certified_world};
use race::progress::Progress;
use truth::command::{count, file, write};
use truth::rng::Rng;

/// Drop small bodies onto terrains of triangles, with parry's contacts and with ours
#[derive(Parser)]
struct Options {
    /// Output table with µs per step, lost bodies and the deepest overlap, by engine and triangles
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Number of bodies
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = count(1))]
    bodies: usize,
    /// Size of a body in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.002, value_parser = size)]
    size: f32,
    /// Number of steps
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = count(1))]
    steps: usize,
    /// Greatest number of triangles
    #[arg(long, value_name = "N", default_value_t = 1_100_000, value_parser = count(1))]
    upto: usize,
}

fn size(text: &str) -> Result<f32, String> {
    let size = text.parse().map_err(|_| "not a number".to_string())?;
    let range = 1e-4..=0.1;
    if range.contains(&size) {
        Ok(size)
    } else {
        Err("not in 0.0001 to 0.1".to_string())
    }
}

/// Points and triangles of hills with y up.
fn hills(cells: usize) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let soup = truth::turned::terrain(cells);
    let up = |p: &[f64; 3]| Vector::new(p[0] as f32, p[2] as f32, -p[1] as f32);
    (soup.points.iter().map(up).collect(), soup.triangles)
}

/// A body's shape by its number.
fn shape(k: usize, size: f32, hull: &Hull) -> SharedShape {
    match k % 6 {
        0 => SharedShape::from(hull.clone()),
        1 => SharedShape::cuboid(0.5 * size, 0.3 * size, 0.4 * size),
        2 => SharedShape::capsule_y(0.3 * size, 0.2 * size),
        3 => SharedShape::ball(0.5 * size),
        4 => SharedShape::cylinder(0.3 * size, 0.4 * size),
        _ => SharedShape::cone(0.4 * size, 0.4 * size),
    }
}

/// What a run shows.
struct Seen {
    step: f64,
    lost: usize,
    deepest: f32,
}

/// Drops bodies on a floor. `ground` measures: heights by rays, overlaps by certified contacts.
fn run(o: &Options, floor: SharedShape, ground: &MeshShape, is_ours: bool) -> Seen {
    let size = o.size;
    let mut world = certified_world(CertifiedDispatcher::default(), size, 1.0 / 960.0);
    if !is_ours {
        world.narrow_phase = NarrowPhase::new();
    }
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(floor).friction(1.0));
    let mut rng = Rng::new(43);
    let points: Vec<Vector> = (0..14)
        .map(|_| Vector::from(rng.unit().map(|x| 0.5 * size * x as f32)))
        .collect();
    let hull = Hull::from_points(&points).expect("points of a sphere span a hull");
    let height = |p: Vector| ground.cast_local_ray_and_get_normal(&Ray::new(p, -Vector::Y), 100.0, true);
    let handles: Vec<RigidBodyHandle> = (0..o.bodies)
        .map(|k| {
            let [x, z] = [0; 2].map(|_| rng.range(-2.0, 2.0) as f32);
            let top = height(Vector::new(x, 10.0, z)).map_or(10.0, |hit| hit.time_of_impact);
            let place = Vector::new(x, 10.0 - top + size, z);
            let body = RigidBodyBuilder::dynamic().translation(place).angular_damping(2.0);
            world
                .insert(body, ColliderBuilder::new(shape(k, size, &hull)).friction(1.0))
                .0
        })
        .collect();
    let began = ThreadTime::now();
    (0..o.steps).for_each(|_| world.step());
    let step = began.elapsed().as_secs_f64() * 1e6 / o.steps as f64;
    let mut seen = Seen {
        step,
        lost: 0,
        deepest: 0.0,
    };
    for handle in handles {
        let body = &world.bodies[handle];
        if height(body.position().translation).is_none() {
            seen.lost += 1;
            continue;
        }
        let shape = world.colliders[body.colliders()[0]].shape();
        let contact = CertifiedDispatcher::default().contact(body.position(), ground, shape, 0.0);
        let depth = contact.ok().flatten().map_or(0.0, |c| -c.dist / size);
        seen.deepest = seen.deepest.max(depth);
    }
    seen
}

fn main() -> ExitCode {
    match compare(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::from(2)
        }
    }
}

fn compare(o: &Options) -> Result<(), String> {
    let mut csv = String::from("triangles,engine,build_s,us_per_step,lost,deepest\n");
    println!(
        "{} bodies of {} m, {} steps\n\n{:>10}{:>10}{:>10}{:>12}{:>7}{:>10}",
        o.bodies, o.size, o.steps, "triangles", "engine", "build s", "us a step", "lost", "deepest"
    );
    let sizes = [71, 224, 708].into_iter().filter(|n| 2 * n * n <= o.upto);
    let progress = Progress::new("terrain", 2 * sizes.clone().count() as u64);
    for cells in sizes {
        let (points, triangles) = hills(cells);
        let began = ThreadTime::now();
        let ground = MeshShape::from_triangles(&points, &triangles).map_err(|e| e.to_string())?;
        let ours = began.elapsed().as_secs_f64();
        let began = ThreadTime::now();
        let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
        let mesh = SharedShape::trimesh_with_flags(points, triangles.clone(), flags).map_err(|e| e.to_string())?;
        let parrys = began.elapsed().as_secs_f64();
        let floors = [
            ("parry", mesh, parrys),
            ("ours", SharedShape::from(ground.clone()), ours),
        ];
        for (engine, floor, build) in floors {
            let Seen { step, lost, deepest } = run(o, floor, &ground, engine == "ours");
            println!(
                "{:>10}{engine:>10}{build:>10.2}{step:>12.0}{lost:>7}{deepest:>10.3}",
                triangles.len()
            );
            let _ = writeln!(csv, "{},{engine},{build},{step},{lost},{deepest}", triangles.len());
            progress.step();
        }
    }
    drop(progress);
    o.csv.as_ref().map_or(Ok(()), |path| write(path, &csv))
}
