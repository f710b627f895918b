//! Distance of two convex bodies, tracked and cold, and the build of a hull and its box; parry beside
//! it.
//!
//! Run `cargo bench --bench pairs`. The race (`cargo run --release -p race --bin race -- pairs`)
//! runs the same motions with all engines interleaved. These benchmarks follow one engine over
//! time.

use std::hint::black_box;

use common::{chosen, each};
use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion};
use lin_canny::{BoxHint, ConvexPolyhedron, RelativePose, Solver, Tracker};
use truth::pairs::Pair;
use truth::parry::{self, GjkCached};
use truth::rng::Rng;
use truth::workload;

const FRAMES: usize = 500;

/// Benchmarks queries of pairs that move a little or take a new pose each frame.
fn queries(c: &mut Criterion) {
    let motions = [("tracked-0.5", Some(0.5)), ("random", None), ("tracked-5", Some(5.0))];
    for (scene, degrees) in chosen(&motions[..2], &motions) {
        for shape in chosen(&["sphere"], &["sphere", "flat"]) {
            let mut group = c.benchmark_group(format!("pairs/{scene}/{shape}"));
            for &n in chosen(&[8, 128, 2048], &[8, 32, 128, 512, 2048, 8192]) {
                let pair = Pair::of(shape, n).expect("two bodies").moving(*degrees, FRAMES);
                let (a, b) = (&pair.a.ours, &pair.b.ours);
                let mut tracker = Tracker::new();
                each(&mut group, "ours", n, &pair.isometries, |(pa, pb)| {
                    let o = tracker.closest(a, b, &RelativePose::new(pa, pb).expect("a pose"));
                    (o.distance, pa * o.point_on_a, pb * o.point_on_b)
                });
                if degrees.is_none() {
                    each(&mut group, "ours, cold", n, &pair.isometries, |(pa, pb)| {
                        Tracker::new()
                            .closest(a, b, &RelativePose::new(pa, pb).expect("a pose"))
                            .distance
                    });
                }
                let mut gjk = GjkCached::default();
                each(&mut group, "gjk-cached", n, &pair.frames, |f| {
                    gjk.closest(&pair.a.climber, &f.a, &pair.b.climber, &f.b)
                });
                if let (Some(one), Some(other)) = (&pair.a.parry, &pair.b.parry) {
                    each(&mut group, "parry", n, &pair.frames, |f| {
                        parry::closest_points(one, &f.a, other, &f.b)
                    });
                }
            }
        }
    }
}

/// Benchmarks queries that the minimum-norm solver answers, including the failed walk before it.
fn fallbacks(c: &mut Criterion) {
    let mut group = c.benchmark_group("pairs/fallback");
    for &(shape, n) in chosen(
        &[],
        &[
            ("sphere", 8),
            ("flat", 8),
            ("flat", 128),
            ("sphere", 2048),
            ("prism", 16384),
        ],
    ) {
        let pair = Pair::of(shape, n).expect("two bodies");
        let mut cases = Vec::new();
        let pair = pair.moving(None, 40 * FRAMES);
        let (a, b) = (&pair.a.ours, &pair.b.ours);
        let mut tracker = Tracker::new();
        for (pa, pb) in &pair.isometries {
            let (before, relative) = (tracker.clone(), RelativePose::new(pa, pb).expect("a pose"));
            if tracker.closest(a, b, &relative).solver == Solver::Gjk {
                cases.push((before, relative));
            }
        }
        println!("{shape} {n}: {} such queries", cases.len());
        if cases.is_empty() {
            continue;
        }
        let mut k = 0;
        let mut next = move || {
            k += 1;
            k
        };
        group.bench_function(BenchmarkId::new(shape, n), |bench| {
            bench.iter_batched(
                || cases[next() % cases.len()].clone(),
                |(mut tracker, relative)| black_box(tracker.closest(a, b, &relative).distance),
                BatchSize::SmallInput,
            );
        });
    }
}

/// Benchmarks the hull of points, ours and parry's.
fn builds(c: &mut Criterion) {
    let mut group = c.benchmark_group("pairs/build");
    group.sample_size(10);
    for &n in chosen(&[32, 2048], &[32, 512, 2048, 8192]) {
        let points = workload::points("sphere", n, &mut Rng::new(n as u64));
        let ours: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
        group.bench_function(BenchmarkId::new("ours", n), |b| {
            b.iter(|| ConvexPolyhedron::from_points(&ours))
        });
        group.bench_function(BenchmarkId::new("parry", n), |b| b.iter(|| parry::hull(&points)));
    }
}

/// Benchmarks boxes of bodies that rotate slightly each time, ours and parry's.
fn boxes(c: &mut Criterion) {
    use parry3d_f64::math::{Pose, Rotation, Vector};
    let mut group = c.benchmark_group("pairs/box");
    for &n in chosen(&[32, 1024], &[8, 32, 256, 1024]) {
        let points = workload::points("sphere", n, &mut Rng::new(n as u64));
        let cloud: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
        let body = ConvexPolyhedron::from_points(&cloud).expect("a hull");
        let (mut hint, mut turn) = (BoxHint::default(), UnitQuaternion::identity());
        let step = UnitQuaternion::from_euler_angles(0.02, 0.01, 0.005);
        group.bench_function(BenchmarkId::new("ours", n), |b| {
            b.iter(|| {
                turn *= step;
                turn.renormalize_fast();
                body.aabb_at(&Isometry3::from_parts([1.0, 2.0, 3.0].into(), turn), &mut hint)
            });
        });
        let Some(other) = parry::hull(&points) else {
            continue;
        };
        let mut turn = Rotation::IDENTITY;
        let step = Rotation::from_axis_angle(Vector::new(0.8, 0.5, 0.33), 0.023);
        group.bench_function(BenchmarkId::new("parry", n), |b| {
            b.iter(|| {
                turn = (turn * step).normalize();
                other.aabb(&Pose::from_parts(Vector::new(1.0, 2.0, 3.0), turn))
            });
        });
    }
}

criterion_group!(name = benches; config = common::criterion(); targets = queries, fallbacks, builds, boxes);
criterion_main!(benches);
