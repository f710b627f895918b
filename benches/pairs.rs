//! Benchmarks of pairs: tracked and cold queries, the build of a hull and its box, with parry for
//! comparison.
//!
//! Run `cargo bench --bench pairs`. The race (`cargo run --release -p race --bin race -- pairs`)
//! runs the same motions with all engines interleaved. These benchmarks follow one engine over
//! time.

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion};
use lin_canny::{BoxHint, ConvexPolyhedron, RelativePose, Solver, Tracker};
use truth::motion::Frame;
use truth::parry::{Climber, GjkCached};
use truth::rng::Rng;
use truth::workload;

const FRAMES: usize = 500;

fn relative(f: &Frame) -> RelativePose {
    RelativePose::new(&f.a.isometry(), &f.b.isometry()).expect("poses of a motion")
}

fn hull(points: &[truth::Point]) -> ConvexPolyhedron {
    let points: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
    ConvexPolyhedron::from_points(&points).expect("a solid")
}

fn climber(body: &ConvexPolyhedron) -> Climber {
    let points: Vec<truth::Point> = body.vertex_points().map(Into::into).collect();
    let faces: Vec<truth::Face> = body
        .faces()
        .map(|f| body.face_vertices(f).map(|v| v.index() as u32).collect())
        .collect();
    Climber::new(&points, &faces)
}

fn frames(a: &ConvexPolyhedron, b: &ConvexPolyhedron, degrees: Option<f64>, rng: &mut Rng) -> Vec<Frame> {
    workload::motion(degrees, FRAMES, rng, |f| {
        let o = Tracker::new().closest(a, b, &relative(f));
        (o.lower > 0.0).then(|| {
            (
                (f.a.isometry() * o.point_on_a).into(),
                (f.b.isometry() * o.point_on_b).into(),
            )
        })
    })
}

/// Measures one query; successive measurements use successive frames.
fn queries(c: &mut Criterion) {
    for (scene, degrees) in [("coherent-0.5", Some(0.5)), ("coherent-5", Some(5.0)), ("random", None)] {
        for shape in ["sphere", "flat"] {
            let mut group = c.benchmark_group(format!("{scene}/{shape}"));
            for n in [8, 128, 2048] {
                let mut rng = Rng::new(1000 + n as u64);
                let (a, b) = (
                    workload::points(shape, n, &mut rng),
                    workload::points(shape, n, &mut rng),
                );
                let (a, b) = (hull(&a), hull(&b));
                let frames = frames(&a, &b, degrees, &mut rng);
                let poses: Vec<_> = frames.iter().map(|f| (f.a.isometry(), f.b.isometry())).collect();
                let (mut k, mut tracker) = (0, Tracker::new());
                let mut next = move || {
                    k = (k + 1) % FRAMES;
                    k
                };
                group.bench_function(BenchmarkId::new("ours", n), |bench| {
                    bench.iter(|| {
                        let (pa, pb) = &poses[next()];
                        let relative = RelativePose::new(pa, pb).expect("a pose");
                        let o = tracker.closest(&a, &b, &relative);
                        black_box((o.distance, pa * o.point_on_a, pb * o.point_on_b))
                    });
                });
                let (ca, cb, mut gjk) = (climber(&a), climber(&b), GjkCached::default());
                group.bench_function(BenchmarkId::new("gjk-cached", n), |bench| {
                    bench.iter(|| {
                        let f = &frames[next()];
                        black_box(gjk.closest(&ca, &f.a, &cb, &f.b))
                    });
                });
                if scene == "random" {
                    group.bench_function(BenchmarkId::new("ours-cold", n), |bench| {
                        bench.iter(|| {
                            let (pa, pb) = &poses[next()];
                            let relative = RelativePose::new(pa, pb).expect("a pose");
                            black_box(Tracker::new().closest(&a, &b, &relative).distance)
                        });
                    });
                }
            }
        }
    }
}

/// Benchmarks queries that the minimum-norm solver answers, including the failed walk before it.
fn fallbacks(c: &mut Criterion) {
    let mut group = c.benchmark_group("fallback");
    for (shape, n) in [
        ("sphere", 8),
        ("flat", 8),
        ("flat", 128),
        ("sphere", 2048),
        ("prism", 16384),
    ] {
        let mut rng = Rng::new(1000 + n as u64);
        let (a, b) = (
            hull(&workload::points(shape, n, &mut rng)),
            hull(&workload::points(shape, n, &mut rng)),
        );
        let mut cases = Vec::new();
        for _ in 0..40 {
            let mut tracker = Tracker::new();
            for f in &frames(&a, &b, None, &mut rng) {
                let before = tracker.clone();
                if tracker.closest(&a, &b, &relative(f)).solver == Solver::Gjk {
                    cases.push((before, relative(f)));
                }
            }
            if cases.len() >= 16 {
                break;
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
                |(mut tracker, relative)| black_box(tracker.closest(&a, &b, &relative).distance),
                BatchSize::SmallInput,
            );
        });
    }
}

fn builds(c: &mut Criterion) {
    let mut group = c.benchmark_group("build/sphere");
    group.sample_size(10);
    for n in [32, 512, 8192] {
        let points = workload::points("sphere", n, &mut Rng::new(n as u64));
        let ours: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
        group.bench_function(BenchmarkId::new("ours", n), |b| {
            b.iter(|| ConvexPolyhedron::from_points(&ours))
        });
        group.bench_function(BenchmarkId::new("parry", n), |b| b.iter(|| truth::parry::hull(&points)));
    }
}

/// Benchmarks boxes of bodies that rotate slightly each time, ours and parry's.
fn boxes(c: &mut Criterion) {
    let mut group = c.benchmark_group("box");
    for n in [8, 32, 256, 1024] {
        let points = workload::points("sphere", n, &mut Rng::new(n as u64));
        let body = hull(&points);
        let (mut hint, mut turn) = (BoxHint::default(), UnitQuaternion::identity());
        let step = UnitQuaternion::from_euler_angles(0.02, 0.01, 0.005);
        group.bench_function(BenchmarkId::new("ours", n), |b| {
            b.iter(|| {
                turn *= step;
                turn.renormalize_fast();
                body.aabb_at(&Isometry3::from_parts([1.0, 2.0, 3.0].into(), turn), &mut hint)
            });
        });
        let cloud: Vec<_> = points.iter().map(|p| parry3d_f64::math::Vector::from(*p)).collect();
        let Some(other) = parry3d_f64::shape::ConvexPolyhedron::from_convex_hull(&cloud) else {
            continue;
        };
        let mut turn = parry3d_f64::math::Rotation::IDENTITY;
        let step = parry3d_f64::math::Rotation::from_axis_angle(parry3d_f64::math::Vector::new(0.8, 0.5, 0.33), 0.023);
        group.bench_function(BenchmarkId::new("parry", n), |b| {
            b.iter(|| {
                turn = (turn * step).normalize();
                other.aabb(&parry3d_f64::math::Pose::from_parts(
                    parry3d_f64::math::Vector::new(1.0, 2.0, 3.0),
                    turn,
                ))
            });
        });
    }
}

criterion_group!(benches, queries, fallbacks, builds, boxes);
criterion_main!(benches);
