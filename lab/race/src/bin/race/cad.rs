//! CAD-like meshes in `race meshes`: long thin triangles, a shaft enclosed by its bearing, a
//! terrain.
//!
//! - `crossing-shafts`: a shaft of length 10 and radius 1 rotates by half a degree per frame about
//!   its axis. It crosses another shaft at an angle of 1, 10, 45 or 90 degrees, with a gap of
//!   0.001, 0.05 or 0.3 (column `shape`). A shaft has `n` sides and `4 n` triangles.
//! - `shaft-in-bore`: a shaft rotates in a bearing (column `shape`: the gap).
//! - `link-over-tray`: the link of a robot hovers above a tray and swings.
//! - `terrain`: a rock rolls over hills; `n` is the number of triangles of the terrain.

use std::hint::black_box;
use truth::forms::mesh;

use lin_canny::{Mesh, PairTracker, RelativePose};
use race::progress::Progress;
use truth::Pose;
use truth::pose::{quat, quat_mul, unit_quat};
use truth::soups::{self, Soup};
use truth::turned;

use crate::meshes::time;
use race::common::{Options, Rows};

pub(crate) const SCENES: [&str; 4] = ["crossing-shafts", "shaft-in-bore", "link-over-tray", "terrain"];

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Two bodies and the poses of B in A's frame.
struct Pair {
    scene: &'static str,
    shape: String,
    n: usize,
    a: Mesh,
    b: Mesh,
    poses: Vec<RelativePose>,
}

fn relative(pose: &Pose) -> RelativePose {
    RelativePose::from_isometry(&pose.isometry()).expect("unit")
}

/// Returns poses of B, which rotates about its axis.
///
/// The axis sways by 0.3 degrees, and the gap varies by a tenth.
fn crossing(degrees: f64, gap: f64, frames: usize) -> Vec<RelativePose> {
    let pose = |k: usize| {
        let phase = k as f64 * DEGREE;
        let across = quat([1.0, 0.0, 0.0], (degrees + 0.3 * phase.sin()) * DEGREE);
        relative(&Pose {
            q: unit_quat(quat_mul(across, quat([0.0, 0.0, 1.0], 0.5 * phase))),
            t: [
                2.0 + gap * (1.0 + 0.1 * phase.cos()),
                0.2 * phase.sin(),
                0.3 * phase.sin(),
            ],
        })
    };
    (0..frames).map(pose).collect()
}

/// Returns poses of the bearing, which rotates about the shaft and drifts by a third of the gap.
fn in_bore(gap: f64, frames: usize) -> Vec<RelativePose> {
    let pose = |k: usize| {
        let phase = k as f64 * DEGREE;
        relative(&Pose {
            q: quat([0.0, 0.0, 1.0], 0.5 * phase),
            t: [0.3 * gap * phase.cos(), 0.3 * gap * phase.sin(), 0.2 * phase.sin()],
        })
    };
    (0..frames).map(pose).collect()
}

/// Returns poses of B above A, lifted from the given poses so that the gap varies between two
/// values.
fn hover(a: &Mesh, b: &Mesh, gaps: [f64; 2], poses: impl Iterator<Item = Pose>) -> Vec<RelativePose> {
    let (mut z, mut tracker) = (2.0, PairTracker::new());
    let lifted = |(k, mut pose): (usize, Pose)| {
        let gap = 0.5 * (gaps[0] + gaps[1] + (gaps[1] - gaps[0]) * (k as f64 * DEGREE).sin());
        for _ in 0..if k == 0 { 80 } else { 2 } {
            pose.t[2] = z;
            let d = tracker.distance(a, b, &relative(&pose)).value;
            z += if d > 0.0 { 0.5 * (gap - d) } else { gap };
        }
        pose.t[2] = z;
        relative(&pose)
    };
    poses.enumerate().map(lifted).collect()
}

/// Returns the pose of a link, with its length along x, that swings above a tray.
fn over_tray(k: usize) -> Pose {
    let phase = k as f64 * DEGREE;
    let lying = quat([0.0, 1.0, 0.0], 90.0 * DEGREE);
    let swing = quat_mul(
        quat([0.0, 0.0, 1.0], 0.5 * phase),
        quat([0.0, 1.0, 0.0], 0.2 * phase.sin()),
    );
    Pose {
        q: unit_quat(quat_mul(swing, lying)),
        t: [0.1 * phase.sin(), 0.1 * phase.cos(), 0.0],
    }
}

/// Returns the pose of a rock that rolls along a circle.
fn rolling(k: usize) -> Pose {
    let phase = k as f64 * 0.5 * DEGREE;
    let (s, c) = phase.sin_cos();
    Pose {
        q: unit_quat(quat([c, s, 0.0], 2.0 * phase)),
        t: [2.0 * c, 2.0 * s, 0.0],
    }
}

fn pairs(scene: &str, frames: usize, o: &Options) -> Vec<Pair> {
    let numbered = |scene, shape: String, n: usize, a: &Soup, b: &Soup, poses| Pair {
        scene,
        shape,
        n,
        a: mesh(a),
        b: mesh(b),
        poses,
    };
    let mut all = Vec::new();
    match scene {
        "crossing-shafts" => {
            for n in o.sizes([200, 1_000, 5_000]) {
                let shaft = turned::shaft(n);
                for (degrees, gap) in [1, 10, 45, 90]
                    .into_iter()
                    .flat_map(|d| [".001", ".05", ".3"].map(|g| (d, g)))
                {
                    let poses = crossing(f64::from(degrees), gap.parse().expect("a number"), frames);
                    all.push(numbered(
                        "crossing-shafts",
                        format!("{degrees}-{gap}"),
                        n,
                        &shaft,
                        &shaft,
                        poses,
                    ));
                }
            }
        }
        "shaft-in-bore" => {
            for n in o.sizes([200, 1_000, 5_000]) {
                for gap in [".001", ".05"] {
                    let wide = gap.parse().expect("a number");
                    let (shaft, bearing) = (turned::shaft(n), turned::bearing(n, 1.0 + wide));
                    all.push(numbered(
                        "shaft-in-bore",
                        gap.into(),
                        n,
                        &shaft,
                        &bearing,
                        in_bore(wide, frames),
                    ));
                }
            }
        }
        "link-over-tray" => {
            for n in o.sizes([32, 240]) {
                let (tray, link) = (turned::tray(n), turned::link(n));
                let poses = hover(&mesh(&tray), &mesh(&link), [0.005, 0.05], (0..frames).map(over_tray));
                all.push(numbered("link-over-tray", "24n-32n".into(), n, &tray, &link, poses));
            }
        }
        _ => {
            for n in o.sizes([71, 224, 708]) {
                let (hills, rock) = (turned::terrain(n), soups::rock(3, 1));
                let poses = hover(&mesh(&hills), &mesh(&rock), [0.02, 0.2], (0..frames).map(rolling));
                all.push(numbered(
                    "terrain",
                    "rock-1280".into(),
                    hills.triangles.len(),
                    &hills,
                    &rock,
                    poses,
                ));
            }
        }
    }
    all
}

fn race(pair: &Pair, csv: &mut Rows) {
    let Pair {
        scene,
        shape,
        n,
        a,
        b,
        poses,
    } = pair;
    let progress = Progress::new(&format!("{scene} {shape} {n}"), 2);
    let mut tracker = PairTracker::new();
    let ours = time(poses.len(), |k| {
        black_box(tracker.closest(a, b, &poses[k]));
    });
    progress.step();
    let cold = time(poses.len(), |k| {
        black_box(PairTracker::new().closest(a, b, &poses[k]));
    });
    drop(progress);
    let (mut counted, mut cold_bounds, mut most) = (PairTracker::new(), 0, 0);
    for at in poses {
        counted.closest(a, b, at);
        most = most.max(counted.memory_usage());
        let mut anew = PairTracker::new();
        anew.closest(a, b, at);
        cold_bounds += anew.work().trees.bounds;
    }
    let w = counted.work();
    let each = |x: u64| x as f64 / w.trees.queries as f64;
    println!(
        "{scene:<16}{shape:<10}{n:>9}{ours:>11.0}{cold:>12.0}{:>10.0}{:>10.0}{:>10.1}{:>9.0}{:>8.1}{:>7.2}{:>9}{:>9}",
        each(cold_bounds),
        each(w.trees.bounds),
        each(w.trees.leaves),
        each(w.trees.failed),
        each(w.trees.measured),
        each(w.trees.cuts),
        counted.front_len(),
        most / 1024,
    );
    for (engine, ns) in [("ours", ours), ("ours-cold", cold)] {
        csv.push((scene, shape, *n), engine, ns, 0);
    }
}

pub(crate) fn run(o: &Options, frames: usize, csv: &mut Rows) {
    let scenes = SCENES.into_iter().filter(|s| o.wants(s));
    for (k, scene) in scenes.enumerate() {
        if k == 0 {
            println!(
                "\n{:<16}{:<10}{:>9}{:>11}{:>12}{:>10}{:>10}{:>10}{:>9}{:>8}{:>7}{:>9}{:>9}",
                "scene",
                "shape",
                "n",
                "ours",
                "cold",
                "cold b.",
                "bounds",
                "leaves",
                "failed",
                "measure",
                "cuts",
                "front",
                "most kB"
            );
        }
        pairs(scene, frames, o).iter().for_each(|pair| race(pair, csv));
    }
}
