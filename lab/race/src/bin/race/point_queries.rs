//! `race points`: the signed distance and closest point of a point and a solid mesh, in nanoseconds
//! of CPU time per point.
//!
//! Points are in twice the box of the mesh in random order (`far`), a hundredth of the radius from
//! the surface at most, in random order (`near`), or on a path with steps of a thousandth (`path`).
//! `ours` asks one by one, `ours-batch` in one call (its order included), `ours-tracked` with a
//! tracker. Also prints for each mesh the time of the build, that of the proof that it does not meet
//! itself, and its memory. `crates/python/bench/points.py` measures other libraries.

use std::hint::black_box;

use cpu_time::ProcessTime;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{Mesh, PointQuery, PointTracker};
use truth::forms::mesh;
use truth::rng::Rng;
use truth::soups::{self, Soup};

use race::common::{Options, Rows};

pub(crate) const SCENES: [&str; 3] = ["near", "far", "path"];

/// Points of a scene, and passes over them.
const POINTS: usize = 20_000;
const PASSES: usize = 5;

fn solids(options: &Options) -> Vec<(&'static str, Soup)> {
    let rock = |n: usize| ("rock", soups::rock((n / 20).ilog2() / 2, 3));
    let mut list: Vec<_> = options.sizes([1280, 81_920, 1_310_720]).map(rock).collect();
    list.extend(options.sizes([1000, 100_000, 1_000_000]).map(|n| {
        let m = (n as f64 / 4.0).sqrt() as usize;
        ("torus", soups::torus(2 * m, m, 0.35))
    }));
    list
}

fn points(scene: &str, soup: &Soup) -> Vec<Point3<f64>> {
    let (mut rng, size) = (Rng::new(7), soup.radius());
    let mut at = Point3::from(soup.points[0]);
    let mut point = |_| match scene {
        "far" => Point3::from([0; 3].map(|_| rng.range(-2.0, 2.0) * size)),
        "near" => {
            let [a, b, c] = soup.corners(rng.below(soup.triangles.len())).map(Vector3::from);
            let (x, y) = (rng.range(0.0, 0.5), rng.range(0.0, 0.5));
            let off = Vector3::from(rng.unit()) * (0.01 * size * rng.range(0.0, 1.0));
            Point3::from(a * x + b * y + c * (1.0 - x - y) + off)
        }
        _ => {
            at += Vector3::from(rng.unit()) * (1e-3 * size);
            at
        }
    };
    (0..POINTS).map(&mut point).collect()
}

/// Returns nanoseconds per point: the least of some passes.
fn timed(passes: usize, mut pass: impl FnMut()) -> f64 {
    let mut once = || {
        let began = ProcessTime::now();
        pass();
        began.elapsed().as_nanos() as f64 / POINTS as f64
    };
    (0..=passes).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// Returns seconds of CPU time of a call, and its result.
fn seconds<T>(call: impl FnOnce() -> T) -> (f64, T) {
    let began = ProcessTime::now();
    let result = call();
    (began.elapsed().as_secs_f64(), result)
}

/// Races all solids with the points of each scene.
pub(crate) fn run(options: &Options) -> Rows {
    let mut rows = Rows::default();
    let passes = if options.quick { 1 } else { PASSES };
    println!(
        "{:5} {:6} {:>8} {:>8} {:>10} {:>12}",
        "scene", "shape", "n", "ours", "ours-batch", "ours-tracked"
    );
    for (name, soup) in solids(options) {
        let (built, mesh): (f64, Mesh) = seconds(|| mesh(&soup));
        let (proven, query) = seconds(|| PointQuery::new(&mesh).prepared());
        let (n, bytes) = (mesh.triangle_count(), mesh.memory_usage());
        println!(
            "{name}, {n} triangles: built in {built:.2} s, proven in {proven:.2} s, {:.1} bytes a triangle",
            bytes as f64 / n as f64
        );
        for scene in SCENES.into_iter().filter(|scene| options.wants(scene)) {
            let points = points(scene, &soup);
            let ask = |p: &Point3<f64>| query.closest_point(p).expect("a point");
            let alone = timed(passes, || {
                points.iter().for_each(|p| {
                    let _ = black_box(ask(p));
                })
            });
            let batch = timed(passes, || drop(black_box(query.closest_points(&points))));
            let tracked = timed(passes, || {
                let mut tracker = PointTracker::new();
                points.iter().for_each(|p| {
                    let _ = black_box(tracker.closest_point(&query, p));
                });
            });
            println!("{scene:5} {name:6} {n:8} {alone:8.0} {batch:10.0} {tracked:12.0}");
            for (engine, ns) in [("ours", alone), ("ours-batch", batch), ("ours-tracked", tracked)] {
                rows.push((scene, name, n), engine, ns, 1);
            }
        }
    }
    rows
}
