//! Benchmarks of bodies in contact: depth and manifold, with parry for comparison.
//!
//! Run `cargo bench --bench contact`. Scenes, shapes, sizes and engines are those of the race
//! (`cargo run --release -p race --bin race -- contact`), which interleaves the engines and
//! compares their answers. These benchmarks follow one engine over time.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use lin_canny::{ConvexPolyhedron, Manifold, ManifoldOptions, RelativePose, Tracker};
use truth::contacts::{PREDICTION, SCENES, Scene, plain, shapes};
use truth::parry::{self, ContactPair};

const FRAMES: usize = 200;

fn hull(body: &ConvexPolyhedron) -> Option<parry::Hull> {
    let (points, faces) = plain(body);
    parry::mesh(&points, &faces)
}

/// Measures one query; successive measurements use successive frames.
fn contacts(c: &mut Criterion) {
    for scene in SCENES {
        for (shape, n) in shapes(scene) {
            let s = Scene::new(scene, shape, n, FRAMES);
            let mut group = c.benchmark_group(format!("{scene}/{shape}"));
            ours(&mut group, &s, n);
            theirs(&mut group, &s, n);
        }
    }
}

type Group<'a> = criterion::BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn ours(group: &mut Group, s: &Scene, n: usize) {
    let poses = s.poses();
    let relative = |k: usize| RelativePose::new(&poses[k].0, &poses[k].1).expect("a pose");
    let (mut k, mut pair) = (0, Tracker::new());
    group.bench_function(BenchmarkId::new("ours", n), |bench| {
        bench.iter(|| {
            k = (k + 1) % FRAMES;
            let o = pair.closest(&s.a, &s.b, &relative(k));
            let (pa, pb) = &poses[k];
            black_box((
                pa * o.point_on_a,
                pb * o.point_on_b,
                pa * o.normal.into_inner(),
                o.distance,
            ))
        });
    });
    let (mut k, mut pair) = (0, Tracker::new());
    group.bench_function(BenchmarkId::new("ours-local", n), |bench| {
        bench.iter(|| {
            k = (k + 1) % FRAMES;
            let o = pair.closest_with_local_depth(&s.a, &s.b, &relative(k));
            black_box((o.point_on_a, o.point_on_b, o.normal, o.distance))
        });
    });
    let (mut k, mut pair, mut manifold) = (0, Tracker::new(), Manifold::new());
    let options = ManifoldOptions::with_prediction(PREDICTION);
    group.bench_function(BenchmarkId::new("ours-manifold", n), |bench| {
        bench.iter(|| {
            k = (k + 1) % FRAMES;
            pair.manifold(&s.a, &s.b, &relative(k), &options, &mut manifold);
            manifold.points().len()
        });
    });
}

fn theirs(group: &mut Group, s: &Scene, n: usize) {
    let (Some(a), Some(b)) = (hull(&s.a), hull(&s.b)) else {
        return;
    };
    let poses: Vec<_> = s
        .frames
        .iter()
        .map(|f| (parry::pose(&f.a), parry::pose(&f.b)))
        .collect();
    let mut k = 0;
    group.bench_function(BenchmarkId::new("parry-contact", n), |bench| {
        bench.iter(|| {
            k = (k + 1) % FRAMES;
            parry::contact(&a, &poses[k].0, &b, &poses[k].1, PREDICTION)
        });
    });
    let (mut k, mut kept) = (0, ContactPair::default());
    group.bench_function(BenchmarkId::new("parry-manifold-warm", n), |bench| {
        bench.iter(|| {
            k = (k + 1) % FRAMES;
            kept.manifold(&a, &poses[k].0, &b, &poses[k].1, PREDICTION).len()
        });
    });
}

criterion_group!(benches, contacts);
criterion_main!(benches);
