//! Meshes: the distance of two of them, points, and rays, ours and parry's.
//!
//! Our answers are proven bounds with closest points; parry's `distance` returns a number. Run
//! `cargo bench --bench mesh`; the races `meshes`, `points` and `rays` have more shapes and compare
//! the answers.

use common::{chosen, each};
use criterion::{Criterion, criterion_group, criterion_main};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Geometry, Mesh, PairTracker, PointQuery, PointTracker, Ray, RayCaster, RelativePose};
use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::query::{self, PointQuery as _, RayCast as _};
use parry3d_f64::shape::TriMesh;
use truth::forms::mesh;
use truth::parry;
use truth::pose::{Pose, quat, quat_mul, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};

const FRAMES: usize = 240;

/// A rock of 20 times a power of four triangles.
fn rock(n: usize) -> Soup {
    soups::rock((n / 20).ilog2() / 2, 1)
}

fn trimesh(soup: &Soup) -> TriMesh {
    let points = soup.points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
    TriMesh::new(points, soup.triangles.clone()).expect("made meshes are sound")
}

/// Poses of a body that tumbles by half a degree a frame near another, at gaps of 0.02 to 0.2.
fn tumbling(body: &Mesh, reach: f64) -> Vec<Pose> {
    let mut rng = Rng::new(11);
    let axis = rng.unit();
    let (mut q, mut x, mut tracker, mut poses) = (rng.quat(), reach, PairTracker::new(), Vec::new());
    for k in 0..FRAMES + 20 {
        let phase = (0.5 * k as f64).to_radians();
        q = unit_quat(quat_mul(quat(axis, 0.5f64.to_radians()), q));
        let mut pose = Pose {
            q,
            t: [x, 0.1 * phase.sin(), 0.1 * phase.cos()],
        };
        for _ in 0..if k == 0 { 60 } else { 2 } {
            let at = RelativePose::from_isometry(&pose.isometry()).expect("unit");
            let d = tracker.distance(body, body, &at).value;
            x += if d > 0.0 {
                0.5 * (0.11 + 0.09 * phase.sin() - d)
            } else {
                0.02
            };
            pose.t[0] = x;
        }
        poses.push(pose);
    }
    poses.split_off(20)
}

fn pairs(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh/pairs");
    group.sample_size(20);
    for &n in chosen(&[1280, 20_480], &[320, 1280, 5120, 20_480, 81_920]) {
        let soup = rock(n);
        let (ours, theirs) = (mesh(&soup), trimesh(&soup));
        let poses = tumbling(&ours, 2.0 * soup.radius());
        let relative = |pose: &Pose| RelativePose::from_isometry(&pose.isometry()).expect("unit");
        let mut tracker = PairTracker::new();
        each(&mut group, "ours", n, &poses, |pose| {
            tracker.closest(&ours, &ours, &relative(pose))
        });
        each(&mut group, "ours, cold", n, &poses, |pose| {
            PairTracker::new().closest(&ours, &ours, &relative(pose))
        });
        each(&mut group, "parry", n, &poses, |pose| {
            query::distance(&ParryPose::IDENTITY, &theirs, &parry::pose(pose), &theirs)
        });
    }
}

fn points(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh/points");
    for &n in chosen(&[20_480], &[1280, 20_480, 327_680]) {
        let soup = rock(n);
        let (ours, theirs) = (mesh(&soup), trimesh(&soup));
        let query = PointQuery::new(&ours).prepared();
        let (mut rng, size) = (Rng::new(7), soup.radius());
        let points: Vec<Point3<f64>> = (0..2000)
            .map(|_| Point3::from([0; 3].map(|_| rng.range(-2.0, 2.0) * size)))
            .collect();
        each(&mut group, "ours", n, &points, |p| query.closest_point(p));
        let mut tracker = PointTracker::new();
        each(&mut group, "ours, tracked", n, &points, |p| {
            tracker.closest_point(&query, p)
        });
        each(&mut group, "parry", n, &points, |p| {
            theirs.project_point(&ParryPose::IDENTITY, Vector::new(p.x, p.y, p.z), false)
        });
    }
}

fn rays(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh/rays");
    for &n in chosen(&[20_480], &[1280, 20_480, 327_680]) {
        let soup = rock(n);
        let (ours, theirs) = (Geometry::from(mesh(&soup)), trimesh(&soup));
        let mut rng = Rng::new(5);
        let rays: Vec<(Ray, query::Ray)> = (0..2000)
            .map(|_| {
                let from = Vector3::from(rng.unit()) * (3.0 * soup.radius());
                let to = Vector3::from(rng.in_ball()) * soup.radius();
                let ray = Ray::new(from.into(), to - from).expect("two places");
                let parts = |v: Vector3<f64>| Vector::new(v.x, v.y, v.z);
                (ray, query::Ray::new(parts(from), parts(ray.direction.into_inner())))
            })
            .collect();
        let (mut caster, still) = (RayCaster::new(), Isometry3::identity());
        each(&mut group, "ours", n, &rays, |(ray, _)| {
            caster.cast(&ours, &still, ray, f64::INFINITY)
        });
        each(&mut group, "parry", n, &rays, |(_, ray)| {
            theirs.cast_ray_and_get_normal(&ParryPose::IDENTITY, ray, f64::MAX, true)
        });
    }
}

criterion_group!(name = benches; config = common::criterion(); targets = pairs, points, rays);
criterion_main!(benches);
