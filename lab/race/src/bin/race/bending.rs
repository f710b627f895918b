//! The scenes `bending`, `bending-tracked`, `bending-self` and `bending-frame` of `race meshes`:
//! meshes whose vertices are replaced in each frame.
//!
//! - `bending`: microseconds to replace the vertices, for a wave that moves every vertex by a
//!   thousandth of the size. `ours` refits the tree (`Mesh::set_vertices`), `ours-rebuilt` builds a
//!   new tree (`Mesh::rebuild`), `parry` refits its tree (`TriMesh::set_vertices` of a `DEFORMABLE`
//!   mesh), and `parry-new` builds a new mesh.
//! - `bending-tracked`: nanoseconds of a tracked query of such a mesh (`bent`) and a torus that
//!   rotates by 0.1 degrees per frame, without the time of `set_vertices`. `rigid` is the same with
//!   a mesh that keeps its first vertices. `after` is a query of the rigid mesh after the vertices
//!   of another mesh were replaced, which shows the effect on the CPU caches.
//! - `bending-self`: microseconds of a self-distance query, for a sheet with a running wave and for
//!   a sheet folded three times that opens and closes. Each vertex moves by up to a thousandth of
//!   the size per frame. `tracked` keeps its tracker, `new` starts a new tracker in each frame.
//! - `bending-frame`: microseconds of a proof that such a sheet does not meet, between two frames,
//!   a torus at some distance (`torus`) or itself (`itself`).

use std::f64::consts::TAU;
use std::hint::black_box;

use cpu_time::ThreadTime;
use lin_canny::continuous::{self, MovingMesh};
use lin_canny::impact::{Impact, Tolerance};
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{Mesh, PairTracker, RelativePose};
use parry3d_f64::math::Vector;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};
use race::common::{Rows, median};
use truth::forms::mesh;
use truth::pose::{Pose, quat, quat_mul};
use truth::soups::{self, Soup};

/// Frames of a pass.
const FRAMES: usize = 60;

/// Displacement of a vertex per frame, for a mesh of size 2.
const WAY: f64 = 2e-3;

/// Returns a sheet of n by n squares with side 2.
fn sheet(n: u32) -> Soup {
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let points = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| [at(i), at(j), 0.0]))
        .collect();
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| (i + k) * (n + 1) + j + l);
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect();
    Soup { points, triangles }
}

/// Returns frame `k` of a wave of height 0.2 that runs along x.
fn frame(rest: &Soup, k: usize) -> Vec<[f64; 3]> {
    let (height, number) = (0.2, 1.5 * std::f64::consts::PI);
    let phase = WAY / height * k as f64;
    let place = |p: &[f64; 3]| [p[0], p[1], p[2] + height * (number * p[0] + phase).sin()];
    rest.points.iter().map(place).collect()
}

fn vertices(points: &[[f64; 3]]) -> Vec<Point3<f64>> {
    points.iter().map(|p| Point3::from(*p)).collect()
}

/// Returns the median nanoseconds of a call per frame.
fn each(mut call: impl FnMut(usize)) -> f64 {
    let mut all: Vec<f64> = (0..FRAMES)
        .map(|k| {
            let start = ThreadTime::now();
            call(k);
            start.elapsed().as_nanos() as f64
        })
        .collect();
    median(&mut all)
}

fn fitted(shape: &str, rest: &Soup, csv: &mut Rows) {
    let frames: Vec<_> = (0..FRAMES).map(|k| frame(rest, k)).collect();
    let given: Vec<_> = frames.iter().map(|f| vertices(f)).collect();
    let theirs: Vec<Vec<Vector>> = frames
        .iter()
        .map(|f| f.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect())
        .collect();
    let mut bent = mesh(rest);
    bent.set_vertices(&given[1]).expect("a sound frame");
    let ours = each(|k| bent.set_vertices(&given[k]).expect("a sound frame"));
    let rebuilt = once(|| bent.rebuild());
    let new = |points: &Vec<Vector>, flags| {
        TriMesh::with_flags(points.clone(), rest.triangles.clone(), flags).expect("made meshes are sound")
    };
    let mut trimesh = new(&theirs[0], TriMeshFlags::DEFORMABLE);
    let parry = each(|k| trimesh.set_vertices(&theirs[k]));
    let anew = once(|| drop(black_box(new(&theirs[3], TriMeshFlags::empty()))));
    let n = rest.triangles.len();
    for (engine, ns) in [
        ("ours", ours),
        ("ours-rebuilt", rebuilt),
        ("parry", parry),
        ("parry-new", anew),
    ] {
        println!("{:<16}{shape:<8}{n:>8}  {engine:<14}{:>12.1} us", "bending", ns / 1e3);
        csv.push(("bending", shape, n), engine, ns, 0);
    }
}

/// Returns the median nanoseconds of a call that takes milliseconds.
fn once(mut call: impl FnMut()) -> f64 {
    let mut all: Vec<f64> = (0..5)
        .map(|_| {
            let start = ThreadTime::now();
            call();
            start.elapsed().as_nanos() as f64
        })
        .collect();
    median(&mut all)
}

/// Returns poses at which a torus rotates above the mesh, between two gaps.
fn poses(a: &Mesh, b: &Mesh) -> Vec<RelativePose> {
    let at = |k: usize, z: f64| {
        let q = quat_mul(
            quat([0.6, 0.8, 0.0], (0.1 * k as f64).to_radians()),
            quat([1.0, 0.0, 0.0], 0.4),
        );
        let pose = Pose { q, t: [0.1, 0.05, z] };
        RelativePose::from_isometry(&pose.isometry()).expect("unit")
    };
    let (mut z, mut tracker) = (3.0, PairTracker::new());
    for _ in 0..60 {
        z -= 0.9 * (tracker.closest(a, b, &at(0, z)).distance - 0.12);
    }
    (0..FRAMES)
        .map(|k| at(k, z + 0.04 * (TAU * k as f64 / FRAMES as f64).sin()))
        .collect()
}

fn tracked(shape: &str, rest: &Soup, csv: &mut Rows) {
    let other = mesh(&soups::torus(80, 32, 0.4).map(|p| p.map(|x| 0.4 * x)));
    let given: Vec<_> = (0..FRAMES).map(|k| vertices(&frame(rest, k))).collect();
    let mut bent = mesh(rest);
    bent.set_vertices(&given[0]).expect("a sound frame");
    bent.rebuild();
    let (rigid, mut beside) = (bent.clone(), bent.clone());
    let at = poses(&rigid, &other);
    let ask = |tracker: &mut PairTracker, m: &Mesh, k: usize| {
        let start = ThreadTime::now();
        black_box(tracker.closest(m, &other, &at[k]));
        start.elapsed().as_nanos() as f64
    };
    let n = rest.triangles.len();
    let row = |engine: &str, times: &mut Vec<f64>, tracker: &PairTracker, csv: &mut Rows| {
        let (ns, w) = (median(times), tracker.work().trees);
        let of = |x: u64| x as f64 / w.queries as f64;
        println!(
            "{:<16}{shape:<8}{n:>8}  {engine:<14}{ns:>12.0} ns  bounds {:>6.0}  leaves {:>5.1}  entries {:>6.0}  failed {:>5.1}  cuts {:.2}",
            "bending-tracked",
            of(w.bounds),
            of(w.leaves),
            of(w.entries),
            of(w.failed),
            of(w.cuts)
        );
        csv.push(("bending-tracked", shape, n), engine, ns, 0);
    };
    let (mut tracker, mut times) = (PairTracker::new(), Vec::new());
    (0..FRAMES).for_each(|k| times.push(ask(&mut tracker, &rigid, k)));
    row("rigid", &mut times, &tracker, csv);
    let (mut tracker, mut times) = (PairTracker::new(), Vec::new());
    for k in 0..FRAMES {
        beside.set_vertices(&given[k]).expect("a sound frame");
        times.push(ask(&mut tracker, &rigid, k));
    }
    row("after", &mut times, &tracker, csv);
    let (mut tracker, mut times) = (PairTracker::new(), Vec::new());
    for k in 0..FRAMES {
        bent.set_vertices(&given[k]).expect("a sound frame");
        times.push(ask(&mut tracker, &bent, k));
    }
    row("bent", &mut times, &tracker, csv);
}

/// Returns frame `k` of a sheet folded three times, whose layers approach and separate by up to a
/// thousandth of the size per frame.
fn folded(rest: &Soup, k: usize) -> Vec<[f64; 3]> {
    let gap = 0.02 + 4.0 * WAY * (1.0 - (0.25 * k as f64).cos());
    let place = |p: &[f64; 3]| {
        let layer = (2.0 * (p[0] + 1.0)).floor().min(3.0);
        let along = p[0] + 1.0 - 0.5 * layer;
        let (bend, turn) = (
            (0.5 - along).min(along) / 0.05,
            if layer as i32 % 2 == 0 { along } else { 0.5 - along },
        );
        let part = (1.0 - bend.min(1.0)) * if along < 0.25 { -0.5 } else { 0.5 };
        [
            turn,
            p[1],
            gap * (layer + part) + 0.02 * (3.0 * p[1] + 0.1 * k as f64).sin(),
        ]
    };
    rest.points.iter().map(place).collect()
}

fn against_itself(shape: &str, rest: &Soup, at: fn(&Soup, usize) -> Vec<[f64; 3]>, csv: &mut Rows) {
    let given: Vec<_> = (0..FRAMES).map(|k| vertices(&at(rest, k))).collect();
    let mut bent = mesh(rest);
    bent.set_vertices(&given[0]).expect("a sound frame");
    bent.rebuild();
    let n = rest.triangles.len();
    for engine in ["tracked", "new"] {
        let (mut tracker, mut times, mut least) = (PairTracker::new(), Vec::new(), f64::INFINITY);
        for vertices in &given {
            bent.set_vertices(vertices).expect("a sound frame");
            if engine == "new" {
                tracker = PairTracker::new();
            }
            let start = ThreadTime::now();
            let found = tracker.self_closest(&bent).expect("triangles that share no vertex");
            times.push(start.elapsed().as_nanos() as f64);
            least = least.min(found.distance);
        }
        let (mean, ns) = (times.iter().sum::<f64>() / times.len() as f64, median(&mut times));
        let w = tracker.work().trees;
        let of = |x: u64| x as f64 / w.queries as f64;
        println!(
            "{:<16}{shape:<8}{n:>8}  {engine:<14}{:>10.0} us  mean {:>7.0}  least {least:.5}  bounds {:>7.0}  leaves {:>6.0}  measured {:>6.0}  entries {:>7.0}  failed {:>6.0}  cuts {:.2}  {} kB",
            "bending-self",
            ns / 1e3,
            mean / 1e3,
            of(w.bounds),
            of(w.leaves),
            of(w.measured),
            of(w.entries),
            of(w.failed),
            of(w.cuts),
            tracker.memory_usage() / 1024
        );
        csv.push(("bending-self", shape, n), engine, ns, 0);
    }
}

fn over_frames(rest: &Soup, csv: &mut Rows) {
    let torus = mesh(&soups::torus(80, 32, 0.4).map(|p| p.map(|x| 0.4 * x)));
    let still = MovingMesh::new(&torus, &torus).expect("one mesh");
    let n = rest.triangles.len();
    for (shape, gap) in [("wave", 0.1), ("wave", 0.02), ("folded", 0.02)] {
        let at = if shape == "wave" { frame } else { folded };
        let (mut before, mut times, mut misses, mut queries) = (mesh(rest), [Vec::new(), Vec::new()], [0; 2], [0; 2]);
        let here = Isometry3::translation(0.0, 0.0, 0.36 + gap);
        let still = still.clone().with_poses(&here, &here).expect("a pose");
        before.set_vertices(&vertices(&at(rest, 0))).expect("a sound frame");
        for k in 1..FRAMES {
            let mut after = before.clone();
            after.set_vertices(&vertices(&at(rest, k))).expect("a sound frame");
            let bent = MovingMesh::new(&before, &after).expect("one mesh");
            for which in 0..2 {
                let start = ThreadTime::now();
                let cast = match which {
                    0 => continuous::cast_meshes(&bent, &still, Tolerance::Time(1e-6)),
                    _ => continuous::cast_self(&bent, Tolerance::Time(1e-6)),
                };
                times[which].push(start.elapsed().as_nanos() as f64);
                let cast = cast.expect("a tolerance");
                misses[which] += u32::from(cast.impact == Impact::Miss);
                queries[which] += cast.queries;
            }
            before = after;
        }
        for (which, engine) in ["torus", "itself"].into_iter().enumerate() {
            let ns = median(&mut times[which]);
            println!(
                "{:<16}{shape:<8}{n:>8}  {engine:<14}{:>10.0} us  gap {gap:.2}  misses {:>3} of {}  intervals {:>8.0}",
                "bending-frame",
                ns / 1e3,
                misses[which],
                FRAMES - 1,
                f64::from(queries[which]) / (FRAMES - 1) as f64
            );
            csv.push(("bending-frame", &format!("{shape}-{gap}"), n), engine, ns, 0);
        }
    }
}

pub(crate) fn run(sizes: impl Iterator<Item = usize>, wants: impl Fn(&str) -> bool, csv: &mut Rows) {
    for n in sizes {
        let side = (n as f64 / 4.0).sqrt() as usize;
        let bodies = [
            ("sheet", sheet((n as f64 / 2.0).sqrt() as u32)),
            ("torus", soups::torus(2 * side, side, 0.3)),
        ];
        for (shape, rest) in &bodies {
            if wants("bending") {
                fitted(shape, rest, csv);
            }
            if wants("bending-tracked") {
                tracked(shape, rest, csv);
            }
        }
        if wants("bending-self") {
            let rest = sheet((n as f64 / 2.0).sqrt() as u32);
            against_itself("wave", &rest, frame, csv);
            against_itself("folded", &rest, folded, csv);
        }
        if wants("bending-frame") {
            over_frames(&sheet((n as f64 / 2.0).sqrt() as u32), csv);
        }
    }
}
