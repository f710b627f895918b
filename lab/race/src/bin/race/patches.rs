//! `race patches`: two curved surfaces that tumble by half a degree per frame, in nanoseconds of
//! thread CPU time per query.
//!
//! `ours` keeps its tracker, `ours-cold` starts a new tracker for each query. The name of the shape
//! is the width of the interval. For comparison, meshes with an accuracy of `1e-4`: `ours-mesh`
//! keeps a `PairTracker`, parry's `distance` of two `TriMesh`es keeps no state.

use std::hint::black_box;

use cpu_time::ThreadTime;
use lin_canny::nalgebra::Point3;
use lin_canny::surface::{BezierPatch, BezierSurface, revolution};
use lin_canny::{Mesh, PairTracker, QueryOptions, RelativePose};
use parry3d_f64::math::Vector;
use parry3d_f64::query;
use parry3d_f64::shape::TriMesh;
use truth::pose::{Pose, quat, quat_mul, unit_quat};
use truth::rng::Rng;

use race::common::{Options, Rows};

pub(crate) const SCENES: [&str; 2] = ["bicubic", "vase"];

/// Returns the nanoseconds of all frames of a pair.
type Engine<'a> = dyn Fn(&[BezierSurface; 2], &[Pose]) -> Vec<f64> + 'a;

/// Number of pairs in the first scene.
const PAIRS: usize = 8;

fn bicubic(rng: &mut Rng) -> BezierSurface {
    let points: Vec<_> = truth::nets::bumps(rng, [3, 3], 0.5)
        .into_iter()
        .map(Point3::from)
        .collect();
    let patch = BezierPatch::polynomial([3, 3], &points).expect("16 points");
    BezierSurface::new(vec![patch]).expect("a patch")
}

fn vase() -> BezierSurface {
    let curves = truth::nets::vase();
    let curves: Vec<&[[f64; 3]]> = curves.iter().map(Vec::as_slice).collect();
    revolution(&curves).expect("a profile")
}

/// Returns poses of B next to A, rotating, at a distance of about 0.2.
fn tumbling(a: &BezierSurface, b: &BezierSurface, seed: u64, frames: usize) -> Vec<Pose> {
    let mut rng = Rng::new(seed);
    let (axis, mut q, mut x) = (rng.unit(), rng.quat(), 3.0);
    let mut tracker = PairTracker::new();
    let mut poses = Vec::new();
    while poses.len() < frames + 20 {
        let phase = (0.5 * poses.len() as f64).to_radians();
        q = unit_quat(quat_mul(quat(axis, 0.5_f64.to_radians()), q));
        let mut pose = Pose {
            q,
            t: [x, 0.1 * phase.sin(), 0.1 * phase.cos()],
        };
        for _ in 0..if poses.is_empty() { 60 } else { 2 } {
            let d = tracker
                .closest_with(a, b, &relative(&pose), &QueryOptions::default().width(1e-3))
                .distance;
            x += if d > 0.0 {
                0.5 * (0.2 + 0.09 * phase.sin() - d)
            } else {
                0.02
            };
            pose.t[0] = x;
        }
        poses.push(pose);
    }
    poses.split_off(20)
}

fn relative(pose: &Pose) -> RelativePose {
    RelativePose::from_isometry(&pose.isometry()).expect("a unit quaternion")
}

/// Returns points and triangles of a surface, with `n` squares along each side of each patch.
fn net(s: &BezierSurface, n: usize) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for patch in s.patches() {
        let first = points.len() as u32;
        let at = |i: usize, j: usize| patch.point(i as f64 / n as f64, j as f64 / n as f64);
        (0..=n).for_each(|i| (0..=n).for_each(|j| points.push(at(i, j))));
        let id = |i: usize, j: usize| first + (i * (n + 1) + j) as u32;
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    (points, triangles)
}

/// Returns the sorted nanoseconds of the frames, each the least of three passes.
fn each(poses: &[Pose], mut start: impl FnMut(), mut query: impl FnMut(&Pose)) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; poses.len()];
    for _ in 0..3 {
        start();
        for (pose, least) in poses.iter().zip(&mut least) {
            let began = ThreadTime::now();
            query(pose);
            *least = least.min(began.elapsed().as_nanos() as f64);
        }
    }
    least.sort_by(f64::total_cmp);
    least
}

/// Races all scenes.
pub(crate) fn run(options: &Options) -> Rows {
    let mut rows = Rows::default();
    println!(
        "{:10} {:6} {:12} {:>10} {:>10} {:>10}",
        "scene", "width", "engine", "median", "p90", "max"
    );
    for scene in SCENES.into_iter().filter(|s| options.wants(s)) {
        let frames = if options.quick { 60 } else { 360 };
        let mut rng = Rng::new(5);
        let pairs: Vec<[BezierSurface; 2]> = match scene {
            "bicubic" => (0..PAIRS).map(|_| [bicubic(&mut rng), bicubic(&mut rng)]).collect(),
            _ => vec![[vase(), vase()]],
        };
        race(&mut rows, scene, &pairs, frames);
    }
    rows
}

fn race(rows: &mut Rows, scene: &str, pairs: &[[BezierSurface; 2]], frames: usize) {
    let motions: Vec<Vec<Pose>> = (0..).zip(pairs).map(|(k, [a, b])| tumbling(a, b, k, frames)).collect();
    let patches = pairs[0][0].patches().len();
    let mut put = |shape: &str, engine: &str, of: &Engine| {
        let mut all: Vec<f64> = pairs.iter().zip(&motions).flat_map(|(p, m)| of(p, m)).collect();
        all.sort_by(f64::total_cmp);
        let part = |p: usize| all[(all.len() - 1) * p / 100];
        println!(
            "{scene:10} {shape:6} {engine:12} {:10.0} {:10.0} {:10.0}",
            part(50),
            part(90),
            part(100)
        );
        rows.push((scene, shape, patches), engine, part(50), 0);
    };
    for (shape, width) in [("1e-4", 1e-4), ("1e-9", 1e-9)] {
        put(shape, "ours", &|[a, b], poses| {
            let tracker = std::cell::RefCell::new(PairTracker::new());
            let query = |p: &Pose| {
                black_box(
                    tracker
                        .borrow_mut()
                        .closest_with(a, b, &relative(p), &QueryOptions::default().width(width)),
                );
            };
            each(poses, || tracker.borrow_mut().reset(), query)
        });
        put(shape, "ours-cold", &|[a, b], poses| {
            let query = |p: &Pose| {
                black_box(PairTracker::new().closest_with(a, b, &relative(p), &QueryOptions::default().width(width)));
            };
            each(poses, || (), query)
        });
    }
    // Squares with side 2 / n: a sagitta of about 1e-4 for the curvatures of these surfaces.
    let n = if patches == 1 { 72 } else { 16 };
    put("1e-4", "ours-mesh", &|pair, poses| {
        let [a, b] = pair.each_ref().map(|s| {
            let (points, triangles) = net(s, n);
            Mesh::new(&points, &triangles).expect("a sound mesh")
        });
        let tracker = std::cell::RefCell::new(PairTracker::new());
        let query = |p: &Pose| {
            black_box(tracker.borrow_mut().closest(&a, &b, &relative(p)));
        };
        each(poses, || tracker.borrow_mut().reset(), query)
    });
    put("1e-4", "parry", &|pair, poses| {
        let [a, b] = pair.each_ref().map(|s| {
            let (points, triangles) = net(s, n);
            let points = points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
            TriMesh::new(points, triangles).expect("a sound mesh")
        });
        let query = |p: &Pose| {
            let _ = black_box(query::distance(&Default::default(), &a, &truth::parry::pose(p), &b));
        };
        each(&poses[..1], || (), query)
    });
}
