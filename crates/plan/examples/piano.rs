//! The piano mover's problem in the plane: an L-shaped body moves through a door. Draws the
//! freeways, the bridges and the path.
//!
//! `cargo run --release -p lin-canny-plan --example piano -- [--door WIDTH] [--seed N] [--out FILE.svg]`

use clap::Parser;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, Progress};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, EdgeKind, FreewayEnd, JointMotion, Opportunistic, Plan, PlanOptions,
    PlanarSpace, Shortcuts, widen,
};
use lin_canny_record::svg::{BLUE, GREEN, GREY, INK, ORANGE, Place, SKY, Svg};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use truth::command::{file, number, seconds};

/// Plan the path of an L-shaped body, 0.9 by 0.5, through a door in a wall
///
/// Searches for a path with the opportunistic planner, shortens it, and draws freeways (by sweep
/// coordinate), bridges, links and the path in the plane of the positions.
#[derive(Parser)]
struct Options {
    /// Width of the door
    #[arg(long, value_name = "WIDTH", default_value_t = 0.36, value_parser = number(0.0))]
    door: f64,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 3)]
    seed: u64,
    /// Time limit of the search in seconds
    #[arg(long, value_name = "S", default_value = "10", value_parser = seconds)]
    seconds: Duration,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/piano.svg", value_parser = file("svg"))]
    out: PathBuf,
}

type Trouble = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    truth::command::main(run)
}

/// Half sides of the room, and of the wall.
const ROOM: [f64; 2] = [2.0, 1.2];
const WALL: f64 = 0.12;

/// Boxes in the plane: centre and half sides.
type Flat = ([f64; 2], [f64; 2]);

/// The two arms of the L, about the inner corner.
const PIECES: [Flat; 2] = [([0.25, 0.0], [0.45, 0.08]), ([-0.12, 0.21], [0.08, 0.29])];

fn walls(door: f64) -> Vec<Flat> {
    let [x, y] = ROOM;
    let half = 0.5 * (y - 0.5 * door);
    vec![
        ([0.0, 0.5 * door + half], [WALL, half]),
        ([0.0, -0.5 * door - half], [WALL, half]),
        ([0.0, y + WALL], [x + 2.0 * WALL, WALL]),
        ([0.0, -y - WALL], [x + 2.0 * WALL, WALL]),
        ([x + WALL, 0.0], [WALL, y]),
        ([-x - WALL, 0.0], [WALL, y]),
    ]
}

fn block(([x, y], [a, b]): Flat) -> Result<ConvexPolyhedron, Trouble> {
    let solid = solids::cuboid(Vector3::new(a, b, 0.1))?;
    Ok(solid.transformed(&Isometry3::translation(x, y, 0.0))?)
}

fn run(options: &Options) -> Result<(), Trouble> {
    if !(options.door < 2.0 * ROOM[1]) {
        return Err("the door is wider than the room".into());
    }
    let walls = walls(options.door);
    let mut cell = Cell::new();
    for piece in PIECES {
        cell.robot_body("piano", block(piece)?);
    }
    for flat in &walls {
        cell.add_obstacle(cell.free_name("wall"), block(*flat)?, Isometry3::identity())?;
    }
    let space = PlanarSpace::new(ROOM.map(|half| [-half, half]), 0.7, PIECES.len())?;
    let mut checker = Checker::new(space, cell)?;
    let (start, goal) = ([-1.4, 0.3, 1.57], [1.4, -0.3, -1.57]);
    let search = PlanOptions::default().seed(options.seed).unlimited();
    let began = Instant::now();
    let plan = Opportunistic::new(&search)
        .progress(&mut |_| Progress::stop_if(began.elapsed() > options.seconds))
        .plan(&mut checker, &start, &goal)?;
    let work = &plan.work;
    println!(
        "{:.2?}: {} freeways, {} bridges, {} random slices, {} configurations",
        began.elapsed(),
        work.freeways,
        work.bridges,
        work.slices,
        plan.roadmap.nodes.len()
    );
    let path = match &plan.path {
        Some(path) => {
            let short = Shortcuts::new(300, options.seed).shorten(&mut checker, path)?;
            let wide = widen(&mut checker, &short, 0.1, 0.2, 4)?;
            let mut least = f64::INFINITY;
            for ends in wide.windows(2) {
                least = least.min(
                    checker
                        .clearance_along(&JointMotion::segment(&ends[0], &ends[1]), 0.05)?
                        .lower,
                );
            }
            println!(
                "path: {} segments of length {:.2}; shortened to {:.2}, widened to a proven clearance of {least:.4}",
                path.len() - 1,
                checker.space().path_length(path),
                checker.space().path_length(&short)
            );
            wide
        }
        None => {
            println!("no path found: there may be one nevertheless");
            vec![start.into(), goal.into()]
        }
    };
    truth::command::write(&options.out, &draw(&checker, &walls, &plan, &path))?;
    println!("drawn to {}", options.out.display());
    Ok(())
}

const SCALE: f64 = 190.0;

fn at(x: f64, y: f64) -> Place {
    [430.0 + SCALE * x, 318.0 - SCALE * y]
}

fn corners(([x, y], [a, b]): Flat, q: &[f64]) -> Vec<Place> {
    let (sine, cosine) = q[2].sin_cos();
    let corner = |(s, t): (f64, f64)| {
        let p = Point3::new(x + s * a, y + t * b, 0.0);
        at(q[0] + cosine * p.x - sine * p.y, q[1] + sine * p.x + cosine * p.y)
    };
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(corner)
        .to_vec()
}

fn draw(checker: &Checker<PlanarSpace>, walls: &[Flat], plan: &Plan, path: &[Vec<f64>]) -> String {
    let title = "An L through a door: freeways, bridges and the path";
    let mut svg = Svg::new(860, 640, title);
    for flat in walls {
        svg.polygon(
            &corners(*flat, &[0.0; 3]),
            &format!("fill=\"{GREY}\" fill-opacity=\"0.6\""),
        );
    }
    silhouettes(&mut svg, checker, path);
    let roadmap = &plan.roadmap;
    let place = |node: usize| at(roadmap.nodes[node][0], roadmap.nodes[node][1]);
    for edge in roadmap
        .edges
        .iter()
        .filter(|e| matches!(e.kind, EdgeKind::Link | EdgeKind::Ascent))
    {
        let style = format!("stroke=\"{GREY}\" stroke-width=\"0.5\" stroke-opacity=\"0.5\"");
        svg.line(place(edge.ends[0]), place(edge.ends[1]), &style);
    }
    slices(&mut svg, plan);
    for freeway in &roadmap.freeways {
        let colour = match (freeway.depth, freeway.coordinate) {
            (0, 0) => BLUE,
            (0, _) => SKY,
            _ => ORANGE,
        };
        let nodes: Vec<Place> = freeway.nodes.iter().map(|k| place(*k)).collect();
        svg.polyline(&nodes, &format!("stroke=\"{colour}\" stroke-width=\"1.2\""));
    }
    let way: Vec<Place> = path.iter().map(|q| at(q[0], q[1])).collect();
    if plan.path.is_some() {
        svg.polyline(
            &way,
            &format!("stroke=\"{GREEN}\" stroke-width=\"3\" stroke-linejoin=\"round\""),
        );
    }
    for (q, name) in [(&path[0], "start"), (&path[path.len() - 1], "goal")] {
        svg.dot(at(q[0], q[1]), 4.5, &format!("fill=\"{INK}\""));
        let [x, y] = at(q[0], q[1]);
        svg.words([x, y + 20.0], 13, "middle", name);
    }
    svg.words([40.0, 30.0], 15, "start", title);
    let keys = [
        ("freeway in x", BLUE),
        ("freeway in y", SKY),
        ("bridge in its slice", ORANGE),
        ("ascent, link", GREY),
        ("path", GREEN),
    ];
    for (k, (name, colour)) in keys.into_iter().enumerate() {
        let x = 60.0 + 155.0 * k as f64;
        svg.line(
            [x, 614.0],
            [x + 26.0, 614.0],
            &format!("stroke=\"{colour}\" stroke-width=\"3\""),
        );
        svg.words([x + 34.0, 619.0], 13, "start", name);
    }
    svg.finish()
}

/// The slices in which bridges were searched: those of the ends of freeways that are no bounds.
fn slices(svg: &mut Svg, plan: &Plan) {
    let roadmap = &plan.roadmap;
    for freeway in roadmap.freeways.iter().filter(|f| f.depth == 0) {
        let tips = [freeway.nodes[0], freeway.nodes[freeway.nodes.len() - 1]];
        for (tip, end) in tips.into_iter().zip(freeway.ends) {
            if !matches!(end, FreewayEnd::Closed | FreewayEnd::Inflection) {
                continue;
            }
            let q = &roadmap.nodes[tip];
            let [x, y] = ROOM;
            let line = match freeway.coordinate {
                0 => [at(q[0], -y), at(q[0], y)],
                _ => [at(-x, q[1]), at(x, q[1])],
            };
            let style = format!("stroke=\"{ORANGE}\" stroke-width=\"0.5\" stroke-dasharray=\"2 4\"");
            svg.line(line[0], line[1], &style);
        }
    }
}

/// The L at places along the path, evenly in length.
fn silhouettes(svg: &mut Svg, checker: &Checker<PlanarSpace>, path: &[Vec<f64>]) {
    let whole = checker.space().path_length(path);
    let (mut gone, mut next) = (0.0, 0.0);
    for ends in path.windows(2) {
        let length = checker.space().distance(&ends[0], &ends[1]);
        while next <= gone + length && length > 0.0 {
            let q = checker.space().between(&ends[0], &ends[1], (next - gone) / length);
            for piece in PIECES {
                let style = format!("fill=\"{GREEN}\" fill-opacity=\"0.10\" stroke=\"{GREEN}\" stroke-width=\"0.7\"");
                svg.polygon(&corners(piece, &q), &style);
            }
            next += whole / 16.0;
        }
        gone += length;
    }
}
