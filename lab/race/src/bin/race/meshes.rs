//! `race meshes`: distance and closest points of two meshes, in nanoseconds of thread CPU time per
//! query.
//!
//! Every engine gets the same two poses per frame and returns the distance; ours is certified, with
//! witnesses and features. `ours` keeps its tracker, `ours-cold` starts a new tracker for each
//! query. parry's `distance` of two `TriMesh`es keeps no state.
//!
//! - `tracked-0.5`, `tracked-0.02`: B tumbles by 0.5 or 0.02 degrees per frame at gaps of 0.02 to
//!   0.2.
//! - `random`: B takes a random pose nearby.
//! - `flush`: B slides and rotates flush on A.
//! - `box-over`: a box tumbles next to a mesh.
//! - `pieces`: rings and knots are compounds of convex pieces, and a rock is decomposed by parry's
//!   VHACD. `n` is the number of pieces. Ours is a `Compound`, parry's a `ParryCompound`.
//!
//! Tori are linked. In `torus-centred`, each tube is near the middle of the other's hole, where
//! most of both bodies is nearly equally close. The scenes of `cad.rs` are measured for our engine
//! alone.

use std::hint::black_box;
use std::time::{Duration, Instant};
use truth::forms::mesh;

use cpu_time::ThreadTime;
use lin_canny::nalgebra::Point3;
use lin_canny::{Compound, ConvexPolyhedron, Mesh, PairTracker, Piece, RelativePose};
use parry3d_f64::math::Vector;
use parry3d_f64::query;
use parry3d_f64::shape::{Compound as ParryCompound, SharedShape, TriMesh};
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};
use race::progress::Progress;
use truth::pose::{Pose, quat, quat_mul, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};

use crate::{bending, cad};
use race::common::{Options, Rows, median};

pub(crate) const SCENES: [&str; 14] = [
    "tracked-0.5",
    "tracked-0.02",
    "random",
    "flush",
    "box-over",
    "pieces",
    "bending",
    "bending-tracked",
    "bending-self",
    "bending-frame",
    "crossing-shafts",
    "shaft-in-bore",
    "link-over-tray",
    "terrain",
];

/// Frames of a scene, and passes over them.
const FRAMES: usize = 240;
const PASSES: usize = 5;

/// Time limit for measuring one engine on one scene.
const LIMIT: Duration = Duration::from_secs(6);

/// Two meshes and the poses of B in A's frame.
struct Race {
    shape: &'static str,
    a: Soup,
    b: Soup,
    poses: Vec<Pose>,
}

fn trimesh(soup: &Soup) -> TriMesh {
    let points = soup.points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
    TriMesh::new(points, soup.triangles.clone()).expect("made meshes are sound")
}

/// Returns poses of B next to A, rotating by `degrees` per frame at a gap between 0.02 and 0.2.
fn tumbling(a: &Mesh, b: &Mesh, reach: f64, degrees: f64, frames: usize) -> Vec<Pose> {
    let mut rng = Rng::new(11);
    let axis = rng.unit();
    let (mut q, mut x) = (rng.quat(), reach);
    let mut tracker = PairTracker::new();
    let mut poses = Vec::new();
    while poses.len() < frames + 20 {
        let phase = poses.len() as f64 * degrees.to_radians();
        q = unit_quat(quat_mul(quat(axis, degrees.to_radians()), q));
        let gap = 0.11 + 0.09 * phase.sin();
        let mut pose = Pose {
            q,
            t: [x, 0.1 * phase.sin(), 0.1 * phase.cos()],
        };
        for _ in 0..if poses.is_empty() { 60 } else { 2 } {
            let at = RelativePose::from_isometry(&pose.isometry()).expect("unit");
            let d = tracker.distance(a, b, &at).value;
            x += if d > 0.0 { 0.5 * (gap - d) } else { 0.02 };
            pose.t[0] = x;
        }
        poses.push(pose);
    }
    poses.split_off(20)
}

/// Returns poses of one ring through the other, rotating by `degrees` per frame.
///
/// B's tube passes through the middle of A's hole or, with `rings`, next to A's tube at the gaps of
/// [`tumbling`]. In the middle, the whole inner sides of both rings are nearly equally close.
fn linked(rings: Option<(&Mesh, &Mesh)>, degrees: f64, frames: usize) -> Vec<Pose> {
    let turned = quat([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2);
    let (mut x, mut tracker, mut poses) = (1.05, PairTracker::new(), Vec::new());
    while poses.len() < frames {
        let phase = poses.len() as f64 * degrees.to_radians();
        let spin = quat_mul(quat([0.0, 1.0, 0.0], phase), turned);
        let mut pose = Pose {
            q: unit_quat(quat_mul(quat([0.0, 0.0, 1.0], 0.3 * phase.sin()), spin)),
            t: [1.05 + 0.1 * phase.sin(), 0.1 * phase.cos(), 0.05],
        };
        if let Some((a, b)) = rings {
            for _ in 0..if poses.is_empty() { 60 } else { 2 } {
                pose.t[0] = x;
                let at = RelativePose::from_isometry(&pose.isometry()).expect("unit");
                x += 0.5 * (tracker.distance(a, b, &at).value - 0.11 - 0.09 * phase.sin());
            }
            pose.t[0] = x;
        }
        poses.push(pose);
    }
    poses
}

/// Returns random nearby poses at which the bodies are separated.
fn random(a: &Mesh, b: &Mesh, reach: f64, frames: usize) -> Vec<Pose> {
    let mut rng = Rng::new(12);
    let mut poses = Vec::new();
    while poses.len() < frames {
        let (q, u) = (rng.quat(), rng.unit());
        let pose = Pose {
            q,
            t: u.map(|x| x * reach * rng.range(0.5, 1.3)),
        };
        let at = RelativePose::from_isometry(&pose.isometry()).expect("unit");
        let d = PairTracker::new().distance(a, b, &at).value;
        if d > 0.01 {
            poses.push(pose);
        }
    }
    poses
}

/// Returns poses of B that slides and rotates on the upper side of A.
fn flush(height: f64, frames: usize) -> Vec<Pose> {
    let pose = |k: usize| {
        let angle = k as f64 * 0.5f64.to_radians();
        Pose {
            q: quat([0.0, 0.0, 1.0], angle),
            t: [0.3 * angle.sin(), 0.2 * angle.cos(), height],
        }
    };
    (0..frames).map(pose).collect()
}

/// Returns the shapes with about `n` triangles.
fn shapes(n: usize) -> Vec<(&'static str, Soup)> {
    let side = ((n as f64 / 4.0).sqrt()) as usize;
    let depth = ((n as f64 / 20.0).ln() / 4f64.ln()).round() as u32;
    vec![
        ("torus", soups::torus(2 * side, side, 0.3)),
        ("rock", soups::rock(depth, 1)),
        ("gear", soups::gear(n / 16)),
        ("knot", soups::knot(5 * side, n / (10 * side), 0.12)),
        ("screw", soups::screw(8, n / 66)),
    ]
}

fn races(scene: &str, n: usize, frames: usize) -> Vec<Race> {
    let pair = |shape, a: Soup, b: Soup, of: &dyn Fn(&Mesh, &Mesh, f64) -> Vec<Pose>| {
        let poses = of(&mesh(&a), &mesh(&b), a.radius() + b.radius());
        Race { shape, a, b, poses }
    };
    let degrees = if scene == "tracked-0.02" { 0.02 } else { 0.5 };
    match scene {
        "flush" => {
            let side = (n as f64 / 12.0).sqrt().round() as usize;
            let plate = soups::plate(side, [1.0, 1.0, 0.05]);
            vec![pair("plates", plate.clone(), plate, &|_, _, _| flush(0.1, frames))]
        }
        "box-over" => {
            let cube = soups::plate(1, [0.3, 0.3, 0.3]);
            let over = |(shape, a)| pair(shape, a, cube.clone(), &|a, b, r| tumbling(a, b, r, 0.5, frames));
            shapes(n).into_iter().map(over).collect()
        }
        _ => {
            let of = |shape: &'static str| {
                move |a: &Mesh, b: &Mesh, r: f64| match (scene, shape) {
                    ("random", _) => random(a, b, r, frames),
                    (_, "torus") => linked(Some((a, b)), degrees, frames),
                    (_, "torus-centred") => linked(None, degrees, frames),
                    _ => tumbling(a, b, r, degrees, frames),
                }
            };
            let mut all = shapes(n);
            if scene != "random" {
                all.insert(1, ("torus-centred", all[0].1.clone()));
            }
            let race = |(shape, a): (_, Soup)| pair(shape, a.clone(), a, &of(shape));
            all.into_iter().map(race).collect()
        }
    }
}

/// Returns the median nanoseconds per query, over passes.
pub(crate) fn time(poses: usize, mut query: impl FnMut(usize)) -> f64 {
    let (begun, mut passes) = (Instant::now(), Vec::new());
    for pass in 0..=PASSES {
        let (start, mut done) = (ThreadTime::now(), 0);
        for k in 0..poses {
            query(k);
            done += 1;
            if begun.elapsed() > LIMIT {
                break;
            }
        }
        // The first pass is a warm-up, unless it reaches the time limit.
        if pass > 0 || done < poses {
            passes.push(start.elapsed().as_nanos() as f64 / done as f64);
        }
        if begun.elapsed() > LIMIT {
            break;
        }
    }
    median(&mut passes)
}

fn race(scene: &str, n: usize, race: &Race, csv: &mut Rows) {
    let (a, b) = (mesh(&race.a), mesh(&race.b));
    let at: Vec<RelativePose> = race
        .poses
        .iter()
        .map(|p| RelativePose::from_isometry(&p.isometry()).expect("unit"))
        .collect();
    let progress = Progress::new(&format!("{scene} {} {n}", race.shape), 3);
    let mut tracker = PairTracker::new();
    let ours = time(at.len(), |k| {
        black_box(tracker.closest(&a, &b, &at[k]));
    });
    progress.step();
    let cold = time(at.len(), |k| {
        black_box(PairTracker::new().closest(&a, &b, &at[k]));
    });
    progress.step();
    let (p, q) = (trimesh(&race.a), trimesh(&race.b));
    let poses: Vec<_> = race.poses.iter().map(truth::parry::pose).collect();
    let parry = time(poses.len(), |k| {
        black_box(query::distance(&Default::default(), &p, &poses[k], &q).ok());
    });
    drop(progress);
    let mut counted = PairTracker::new();
    for at in &at {
        counted.closest(&a, &b, at);
    }
    let w = counted.work();
    let each = |x: u64| x as f64 / w.trees.queries as f64;
    println!(
        "{scene:<13}{:<14}{:>8}{ours:>10.0}{cold:>10.0}{parry:>14.0}{:>9.0}{:>8.0}{:>8.1}{:>8.1}{:>7.2}{:>8.0}",
        race.shape,
        race.a.triangles.len(),
        parry / ours,
        each(w.trees.bounds),
        each(w.trees.failed),
        each(w.trees.measured),
        each(w.trees.cuts),
        counted.front_len(),
    );
    for (engine, ns) in [("ours", ours), ("ours-cold", cold), ("parry-trimesh", parry)] {
        csv.push((scene, race.shape, race.a.triangles.len()), engine, ns, 0);
    }
}

/// Returns the points of stretches of a tube: `rows` rings of `m` points each, and the first ring
/// of the next stretch.
fn stretches(soup: &Soup, m: usize, rows: usize) -> Vec<Vec<[f64; 3]>> {
    let count = soup.points.len() / m;
    let stretch = |first: usize| {
        let points = (first..=first + rows).flat_map(|i| &soup.points[i % count * m..][..m]);
        points.copied().collect()
    };
    (0..count).step_by(rows).map(stretch).collect()
}

/// Returns the hulls of an approximate convex decomposition.
fn decomposed(soup: &Soup) -> Vec<Vec<[f64; 3]>> {
    let points: Vec<_> = soup.points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
    let parameters = VHACDParameters {
        resolution: 64,
        ..Default::default()
    };
    let found = VHACD::decompose(&parameters, &points, &soup.triangles, true);
    let hulls = found.compute_exact_convex_hulls(&points, &soup.triangles);
    let points = |(points, _): (Vec<Vector>, _)| points.iter().map(|p| [p.x, p.y, p.z]).collect();
    hulls.into_iter().map(points).collect()
}

/// Races compounds of convex pieces.
fn pieces(frames: usize, csv: &mut Rows) {
    let (ring, large) = (soups::torus(16, 12, 0.3), soups::torus(52, 12, 0.3));
    let (knot, rock) = (soups::knot(104, 8, 0.12), soups::rock(3, 1));
    let bodies = [
        ("torus", &ring, stretches(&ring, 12, 2)),
        ("torus", &large, stretches(&large, 12, 2)),
        ("torus-centred", &large, stretches(&large, 12, 2)),
        ("knot", &knot, stretches(&knot, 8, 4)),
        ("rock", &rock, decomposed(&rock)),
    ];
    for (shape, soup, hulls) in bodies {
        let body = |points: &Vec<[f64; 3]>| {
            let points: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
            Piece::new(ConvexPolyhedron::from_points(&points).expect("a piece has a volume"))
        };
        let ours = Compound::new(hulls.iter().map(body).collect()).expect("pieces stand in place");
        let reach = 2.0 * soup.radius();
        let (a, b) = (mesh(soup), mesh(soup));
        let poses = match shape {
            "torus" => linked(Some((&a, &b)), 0.5, frames),
            "torus-centred" => linked(None, 0.5, frames),
            _ => tumbling(&a, &b, reach, 0.5, frames),
        };
        let at: Vec<RelativePose> = poses
            .iter()
            .map(|p| RelativePose::from_isometry(&p.isometry()).expect("unit"))
            .collect();
        let mut tracker = PairTracker::new();
        let tracked = time(at.len(), |k| {
            black_box(tracker.closest(&ours, &ours, &at[k]));
        });
        let cold = time(at.len(), |k| {
            black_box(PairTracker::new().closest(&ours, &ours, &at[k]));
        });
        let hull = |points: &Vec<[f64; 3]>| {
            let points: Vec<_> = points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
            (
                Default::default(),
                SharedShape::convex_hull(&points).expect("a piece has a volume"),
            )
        };
        let compound = ParryCompound::new(hulls.iter().map(hull).collect());
        let placed: Vec<_> = poses.iter().map(truth::parry::pose).collect();
        let parry = time(placed.len(), |k| {
            black_box(query::distance(&Default::default(), &compound, &placed[k], &compound).ok());
        });
        let mut counted = PairTracker::new();
        at.iter().for_each(|at| {
            counted.closest(&ours, &ours, at);
        });
        let w = counted.work();
        let each = |x: u64| x as f64 / w.trees.queries as f64;
        println!(
            "{:<13}{shape:<14}{:>8}{tracked:>10.0}{cold:>10.0}{parry:>14.0}{:>9.0}{:>8.0}{:>8.1}{:>8.1}{:>7.2}{:>8.0}",
            "pieces",
            hulls.len(),
            parry / tracked,
            each(w.trees.bounds),
            each(w.trees.failed),
            each(w.trees.measured),
            each(w.trees.cuts),
            counted.front_len(),
        );
        for (engine, ns) in [("ours", tracked), ("ours-cold", cold), ("parry-compound", parry)] {
            csv.push(("pieces", shape, hulls.len()), engine, ns, 0);
        }
    }
}

/// Prints the time to build meshes, and their memory.
fn built(n: usize) {
    for (shape, soup) in shapes(n) {
        let start = ThreadTime::now();
        let m = mesh(&soup);
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let bytes = m.memory_usage() as f64 / m.triangle_count() as f64;
        println!(
            "{shape:<7}{:>8} triangles: {ms:>7.1} ms, {bytes:>5.1} bytes a triangle",
            m.triangle_count()
        );
    }
}

pub(crate) fn run(o: &Options) -> Rows {
    let mut csv = Rows::default();
    let frames = if o.quick { FRAMES / 4 } else { FRAMES };
    if o.wants_all() {
        o.sizes([1_280, 20_480, 102_400]).for_each(built);
    }
    println!("\nns a query, thread CPU time; counts a query of `ours`\n");
    println!(
        "{:<13}{:<14}{:>8}{:>10}{:>10}{:>14}{:>9}{:>8}{:>8}{:>8}{:>7}{:>8}",
        "scene", "shape", "n", "ours", "cold", "parry", "/ours", "bounds", "failed", "measure", "cuts", "front"
    );
    if o.wants("pieces") {
        pieces(frames, &mut csv);
    }
    let plain = SCENES.into_iter().filter(|s| {
        !["pieces", "bending", "bending-tracked", "bending-self", "bending-frame"].contains(s)
            && !cad::SCENES.contains(s)
    });
    for scene in plain.filter(|s| o.wants(s)) {
        for n in o.sizes([1_280, 20_480, 102_400]) {
            let races = races(scene, n, frames).into_iter();
            for r in races.filter(|r| o.wants_cell(scene, r.shape, r.a.triangles.len())) {
                race(scene, n, &r, &mut csv);
            }
        }
    }
    bending::run(o.sizes([20_480, 102_400]), |scene| o.wants(scene), &mut csv);
    cad::run(o, frames, &mut csv);
    csv
}
