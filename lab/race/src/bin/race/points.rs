//! `race hulls`: the convex hull of points, in milliseconds of thread CPU time.
//!
//! Also prints the number of vertices of the hull, and the distance of the farthest point from the
//! hull of these vertices. Points are on a sphere, in a ball, in a cube, or on a sphere flattened
//! to a thousandth (`flat`), all with a radius of about one. `crates/python/bench/hulls.py`
//! measures qhull.

use std::hint::black_box;

use cpu_time::ThreadTime;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker};
use race::progress::Progress;
use truth::rng::Rng;
use truth::{Point, parry};

use race::common::{Options, Rows, median};

pub(crate) const SCENES: [&str; 4] = ["sphere", "ball", "cube", "flat"];

const PASSES: usize = 3;

/// Largest number of points that are compared with a hull.
const LOOKED_AT: usize = 20_000;

fn cloud(scene: &str, n: usize) -> Vec<Point> {
    let mut rng = Rng::new(n as u64);
    let mut point = || match scene {
        "sphere" => rng.unit(),
        "ball" => rng.in_ball(),
        "cube" => [0; 3].map(|_| rng.range(-1.0, 1.0)),
        _ => {
            let [x, y, z] = rng.unit();
            [x, y, 1e-3 * z]
        }
    };
    (0..n).map(|_| point()).collect()
}

/// Returns the median milliseconds of some passes.
fn timed(passes: usize, mut pass: impl FnMut()) -> f64 {
    let mut once = || {
        let began = ThreadTime::now();
        pass();
        1e3 * began.elapsed().as_secs_f64()
    };
    median(&mut (0..passes).map(|_| once()).collect::<Vec<_>>())
}

/// Returns the largest distance of a sampled point from the hull of the vertices that an engine
/// kept.
fn lost(points: &[Point], kept: &[Point3<f64>]) -> f64 {
    let Ok(hull) = ConvexPolyhedron::from_points(kept) else {
        return f64::NAN;
    };
    let mut tracker = Tracker::new();
    let mut distance = |p: &Point| {
        let at = RelativePose::from_isometry(&Isometry3::translation(p[0], p[1], p[2])).expect("a place");
        let place = ConvexPolyhedron::point(Point3::origin()).expect("a point");
        tracker.closest(&hull, &place, &at).distance
    };
    let stride = points.len().div_ceil(LOOKED_AT);
    points.iter().step_by(stride).map(&mut distance).fold(0.0, f64::max)
}

/// Races all point clouds.
pub(crate) fn run(options: &Options) -> Rows {
    let mut rows = Rows::default();
    println!(
        "{:7} {:>8} {:>10} {:>10} {:>6} {:>9} {:>9} {:>10} {:>10}",
        "points", "n", "ours ms", "parry ms", "/ours", "vertices", "vertices", "lost", "lost"
    );
    let sizes: Vec<usize> = options.sizes([1000, 10_000, 100_000, 1_000_000]).collect();
    let progress = Progress::new("hulls", (SCENES.len() * sizes.len()) as u64);
    for scene in SCENES.into_iter().filter(|s| options.wants(s)) {
        for &n in &sizes {
            race(&mut rows, scene, n, if options.quick { 1 } else { PASSES });
            progress.step();
        }
    }
    rows
}

fn race(rows: &mut Rows, scene: &str, n: usize, passes: usize) {
    let points = cloud(scene, n);
    let at: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
    let mine = timed(passes, || {
        let _ = black_box(ConvexPolyhedron::from_points(&at));
    });
    let theirs = timed(passes, || {
        let _ = black_box(parry::hull(&points));
    });
    let ours = ConvexPolyhedron::from_points(&at).expect("a hull");
    let kept: Vec<Point3<f64>> = ours.vertices().filter_map(|v| ours.vertex(v)).collect();
    let parry = parry::hull(&points);
    let theirs_kept = parry.iter().flat_map(|h| h.points()).map(|p| p.to_array().into());
    let theirs_kept: Vec<Point3<f64>> = theirs_kept.collect();
    println!(
        "{scene:7} {n:8} {mine:10.2} {theirs:10.2} {:6.2} {:9} {:9} {:10.1e} {:10.1e}",
        theirs / mine,
        kept.len(),
        theirs_kept.len(),
        lost(&points, &kept),
        lost(&points, &theirs_kept)
    );
    rows.push((scene, "hull", n), "ours", 1e6 * mine, 0);
    rows.push((scene, "hull", n), "parry", 1e6 * theirs, 0);
}
