//! Measures the cost of an exact nonconvex mesh: the mesh as it is, its convex hull, and pieces of
//! parry's V-HACD.
//!
//! The error is measured against brute force over all pairs of triangles. An overlap counts as
//! distance zero.

use std::hint::black_box;

use lin_canny::nalgebra::Point3;
use lin_canny::{Compound, ConvexPolyhedron, Decomposition, Mesh, PairTracker, Piece, RelativePose, Tracker};
use parry3d_f64::math::Vector;
use parry3d_f64::query;
use parry3d_f64::shape::TriMesh;
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};
use race::progress::Progress;
use race::record::Row;
use truth::pose::{Pose, quat, quat_mul, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{brute, pose};

use crate::measure;
use crate::options::Options;
use crate::truth::{Sampled, Truth};

type Trouble = Box<dyn std::error::Error>;

/// Cells of V-HACD along the longest side.
const RESOLUTIONS: [u32; 3] = [16, 32, 64];

/// A mesh in the form of each engine, and poses of a second instance of it.
struct Scene {
    soup: Soup,
    mesh: Mesh,
    poses: Vec<Pose>,
    relative: Vec<RelativePose>,
    truth: Sampled,
}

impl Scene {
    fn new(shape: &str, options: &Options) -> Result<Self, Trouble> {
        let soup = match shape {
            "rings" => soups::torus(30, 15, 0.3),
            "gears" => soups::gear(48),
            _ => soups::knot(70, 7, 0.12),
        };
        let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
        let mesh = Mesh::new(&points, &soup.triangles)?;
        let poses = if shape == "rings" {
            (0..options.frames()).map(linked).collect()
        } else {
            tumbling(&mesh, 2.0 * soup.radius(), options.frames())?
        };
        let relative = poses.iter().map(|p| RelativePose::from_isometry(&p.isometry()));
        let truth = |f: usize| {
            let distance = brute::distance(&soup, &soup, &poses[f]).0;
            let truth = Truth {
                lower: distance,
                upper: distance,
            };
            (truth, 2.0 * soup.radius() + pose::norm(poses[f].t))
        };
        Ok(Self {
            truth: Sampled::of(poses.len(), options.sampled(), truth),
            relative: relative.collect::<Result<_, _>>()?,
            mesh,
            soup,
            poses,
        })
    }

    /// Returns times and errors; an overlap counts as distance zero.
    fn seen<S>(
        &self,
        options: &Options,
        fresh: impl Fn() -> S + Copy,
        ask: impl Fn(usize, &mut S) -> f64 + Copy,
    ) -> [Vec<f64>; 2] {
        let apart = |f: usize, state: &mut S| match ask(f, state) {
            overlap if overlap < 0.0 => 0.0,
            distance => distance,
        };
        measure::passes(options, (self.poses.len(), &self.truth), fresh, apart)
    }

    /// Returns the pieces of V-HACD as a compound.
    fn pieces(&self, resolution: u32) -> Result<Compound, Trouble> {
        let parameters = VHACDParameters {
            resolution,
            ..Default::default()
        };
        let points: Vec<_> = self.soup.points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
        let found = VHACD::decompose(&parameters, &points, &self.soup.triangles, true);
        let parts = found.compute_primitive_intersections(&points, &self.soup.triangles);
        let piece = |part: &Vec<Vector>| {
            let points: Vec<_> = part.iter().map(|p| Point3::new(p.x, p.y, p.z)).collect();
            ConvexPolyhedron::from_points(&points).ok().map(Piece::new)
        };
        Ok(Compound::new(parts.iter().filter_map(piece).collect())?)
    }
}

/// Returns the pose of one ring through the other, rotating by half a degree per frame.
fn linked(k: usize) -> Pose {
    let turned = quat([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2);
    let phase = k as f64 * 0.5f64.to_radians();
    let spin = quat_mul(quat([0.0, 1.0, 0.0], phase), turned);
    Pose {
        q: unit_quat(quat_mul(quat([0.0, 0.0, 1.0], 0.3 * phase.sin()), spin)),
        t: [1.05 + 0.1 * phase.sin(), 0.1 * phase.cos(), 0.05],
    }
}

/// Returns poses of B next to A, rotating by half a degree per frame at gaps of 0.02 to 0.2.
fn tumbling(mesh: &Mesh, reach: f64, frames: usize) -> Result<Vec<Pose>, Trouble> {
    let mut rng = Rng::new(11);
    let (axis, mut q, mut x) = (rng.unit(), rng.quat(), reach);
    let (mut tracker, mut poses) = (PairTracker::new(), Vec::new());
    while poses.len() < frames + 20 {
        let phase = poses.len() as f64 * 0.5f64.to_radians();
        q = unit_quat(quat_mul(quat(axis, 0.5f64.to_radians()), q));
        for _ in 0..if poses.is_empty() { 60 } else { 2 } {
            let at = RelativePose::from_isometry(&Pose { q, t: [x, 0.0, 0.0] }.isometry())?;
            let d = tracker.distance(mesh, mesh, &at).value;
            x += if d > 0.0 {
                0.5 * (0.11 + 0.09 * phase.sin() - d)
            } else {
                0.02
            };
        }
        poses.push(Pose { q, t: [x, 0.0, 0.0] });
    }
    Ok(poses.split_off(20))
}

/// Names of the scenes.
const SCENES: [&str; 3] = ["rings", "gears", "knots"];

pub(crate) fn count(options: &Options) -> u64 {
    if options.does("nonconvex") && options.meshes().is_none() {
        SCENES.len() as u64
    } else {
        0
    }
}

pub(crate) fn run(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<(), Trouble> {
    measure::title(
        "Meshes that are not convex: as they are, as hulls, as pieces of V-HACD; 0.5 degrees a frame; n parts a body",
        "scene",
    );
    for name in SCENES {
        progress.say(name);
        let scene = Scene::new(name, options)?;
        let n = scene.mesh.triangle_count();
        let mut note = |n: usize, engine: &str, level: &str, seen: [Vec<f64>; 2]| {
            measure::line(rows, ("nonconvex", name, n), (engine, level), seen);
        };
        let mesh = |f: usize, s: &mut PairTracker| s.distance(&scene.mesh, &scene.mesh, &scene.relative[f]).value;
        note(n, "ours", "mesh", scene.seen(options, PairTracker::new, mesh));
        let hull = scene.mesh.hull()?;
        let as_hull = |f: usize, s: &mut Tracker| s.distance(&hull, &hull, &scene.relative[f]).value;
        note(1, "ours", "hull", scene.seen(options, Tracker::new, as_hull));
        for resolution in RESOLUTIONS {
            let pieces = Decomposition::new(scene.mesh.clone(), scene.pieces(resolution)?)?;
            let body = pieces.pieces();
            let as_pieces = |f: usize, s: &mut PairTracker| s.distance(body, body, &scene.relative[f]).value;
            let seen = scene.seen(options, PairTracker::new, as_pieces);
            note(body.pieces().len(), "ours", "pieces", seen);
            println!("{:<8} {:>6}  {}", "", "", pieces.fit());
        }
        let corners: Vec<_> = scene
            .soup
            .points
            .iter()
            .map(|p| Vector::new(p[0], p[1], p[2]))
            .collect();
        let theirs = TriMesh::new(corners, scene.soup.triangles.clone())?;
        let still = Default::default();
        let parry = |f: usize, (): &mut ()| {
            let found = query::distance(&still, &theirs, &truth::parry::pose(&scene.poses[f]), &theirs);
            black_box(found).map_or(f64::NAN, |d| d.distance)
        };
        note(n, "parry-f64", "mesh", scene.seen(options, || (), parry));
        progress.step();
    }
    Ok(())
}
