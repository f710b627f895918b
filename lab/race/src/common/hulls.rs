//! Races the bounding box of a posed hull, ours against parry's, in nanoseconds per box.

use super::Rows;
use lin_canny::nalgebra::Point3;
use lin_canny::{BoxHint, ConvexPolyhedron};
use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::shape::{ConvexPolyhedron as ParryHull, Shape};
use std::hint::black_box;
use std::time::Instant;
use truth::rng::Rng;
use truth::{Pose, shapes};

/// Returns poses of a body that rotates by 0.02 radians per frame.
fn poses(rng: &mut Rng) -> Vec<Pose> {
    let (axis, start) = (rng.unit(), rng.quat());
    let pose = |k: usize| Pose {
        q: truth::pose::unit_quat(truth::pose::quat_mul(truth::pose::quat(axis, 0.02 * k as f64), start)),
        t: [0.01 * k as f64, 1.0, -2.0],
    };
    (0..512).map(pose).collect()
}

/// Returns nanoseconds per call, the best of some rounds over all poses.
fn time<P>(poses: &[P], mut work: impl FnMut(&P)) -> f64 {
    let round = |work: &mut dyn FnMut(&P)| {
        let began = Instant::now();
        poses.iter().for_each(work);
        began.elapsed().as_nanos() as f64 / poses.len() as f64
    };
    (0..40).map(|_| round(&mut work)).fold(f64::INFINITY, f64::min)
}

/// Prints the times and adds them to the rows.
pub fn run(csv: &mut Rows) {
    println!(
        "\nbox of a placed hull, ns\n{:>8}{:>9}{:>9}{:>8}",
        "vertices", "ours", "parry", "/ours"
    );
    for n in [8, 32, 64, 256, 1024] {
        let mut rng = Rng::new(n as u64);
        let points = shapes::sphere(&mut rng, n).points;
        let corners: Vec<_> = points.iter().map(|&p| Point3::from(p)).collect();
        let narrow: Vec<_> = points.iter().map(|p| Vector::from(p.map(|x| x as f32))).collect();
        let (Ok(body), Some(hull)) = (
            ConvexPolyhedron::from_points(&corners),
            ParryHull::from_convex_hull(&narrow),
        ) else {
            eprintln!("no hull of {n} points");
            continue;
        };
        let poses = poses(&mut rng);
        let wide: Vec<_> = poses.iter().map(Pose::isometry).collect();
        let parry = |p: &Pose| {
            let [x, y, z, w] = p.q.map(|c| c as f32);
            ParryPose::from_parts(Vector::from(p.t.map(|c| c as f32)), Rotation::from_xyzw(x, y, z, w))
        };
        let theirs: Vec<_> = poses.iter().map(parry).collect();
        let mut hint = BoxHint::default();
        let ours = time(&wide, |p| {
            black_box(body.aabb_at(black_box(p), &mut hint));
        });
        let theirs = time(&theirs, |p| {
            black_box(hull.compute_aabb(black_box(p)));
        });
        println!("{n:>8}{ours:>9.1}{theirs:>9.1}{:>8.1}", theirs / ours);
        for (engine, ns) in [("ours", ours), ("parry", theirs)] {
            csv.push(("hull-box", "sphere", n), engine, ns, 3);
        }
    }
}
