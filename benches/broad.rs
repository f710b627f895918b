//! A step of the broad phase: boxes that move, and the pairs that begin and end; parry's tree of boxes
//! beside it.
//!
//! parry's row does what rapier's broad phase does in a step: it updates the leaves that moved, refits
//! the tree and lists the pairs of changed leaves; it keeps no pairs, so ended ones are not found. Run
//! `cargo bench --bench broad`; the race `boxes` compares more libraries. To measure the effect of
//! threads, run `RAYON_NUM_THREADS=2 cargo bench --features parallel --bench broad`, and the same with
//! one thread.

use std::hint::black_box;

use common::chosen;
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lin_canny::broad::{Aabb, BodyId, BodyOptions, SweepAndPrune};
use parry3d_f64::bounding_volume::Aabb as ParryAabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use truth::boxes::{Kind, Scene};

fn parry_box(b: &Aabb) -> ParryAabb {
    let vector = |p: [f64; 3]| Vector::new(p[0], p[1], p[2]);
    ParryAabb::new(vector(b.min.into()), vector(b.max.into()))
}

fn step(criterion: &mut Criterion) {
    let kinds = chosen(&[Kind::Uniform, Kind::Pile], &Kind::ALL);
    for &kind in kinds {
        let mut group = criterion.benchmark_group(format!("broad/{}", kind.name()));
        group.sample_size(20);
        for &n in chosen(&[10_000, 100_000], &[1_000, 10_000, 100_000, 1_000_000]) {
            if n > 100_000 && !matches!(kind, Kind::Uniform | Kind::Pile) {
                continue;
            }
            group.throughput(Throughput::Elements(n as u64));
            ours(&mut group, kind, n);
            theirs(&mut group, kind, n);
        }
        group.finish();
    }
}

fn ours(group: &mut common::Group, kind: Kind, n: usize) {
    let mut scene = Scene::new(kind, n);
    let mut broad = SweepAndPrune::new();
    let ids = scene
        .boxes
        .iter()
        .filter_map(|b| broad.insert(b, BodyOptions::default()).ok());
    let ids: Vec<BodyId> = ids.collect();
    assert_eq!(ids.len(), n);
    broad.step();
    assert!(broad.pair_count() > n / 20, "the scene hardly has pairs");
    group.bench_function(BenchmarkId::new("ours", n), |bencher| {
        bencher.iter_batched(
            || {
                scene.step();
                let moved = scene.moved.iter();
                moved.map(|&i| (ids[i as usize], scene.boxes[i as usize])).collect()
            },
            |batch: Vec<(BodyId, Aabb)>| {
                assert!(broad.set_boxes(&batch).is_ok());
                let events = broad.step();
                (events.began.len(), events.ended.len(), batch)
            },
            BatchSize::PerIteration,
        );
    });
}

fn theirs(group: &mut common::Group, kind: Kind, n: usize) {
    let mut scene = Scene::new(kind, n);
    let boxes = scene.boxes.iter().enumerate().map(|(k, b)| (k, parry_box(b)));
    let mut tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes);
    let mut workspace = BvhWorkspace::default();
    group.bench_function(BenchmarkId::new("parry", n), |bencher| {
        bencher.iter_batched(
            || {
                scene.step();
                let moved = scene.moved.iter();
                moved.map(|&i| (i, parry_box(&scene.boxes[i as usize]))).collect()
            },
            |batch: Vec<(u32, ParryAabb)>| {
                for (k, moved) in &batch {
                    tree.insert_or_update_partially(*moved, *k, 0.0);
                }
                tree.refit(&mut workspace);
                tree.optimize_incremental(&mut workspace);
                let mut pairs = 0;
                tree.traverse_bvtt_single_tree::<true>(&mut workspace, &mut |a, b| {
                    black_box((a, b));
                    pairs += 1;
                });
                (pairs, batch)
            },
            BatchSize::PerIteration,
        );
    });
}

/// Benchmarks the insertion of a whole scene and its first step.
fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("broad/build");
    group.sample_size(20);
    for &kind in chosen(&[], &[Kind::Uniform, Kind::Pile]) {
        let scene = Scene::new(kind, 10_000);
        group.bench_function(kind.name(), |bencher| {
            bencher.iter(|| {
                let mut broad = SweepAndPrune::new();
                let boxes = scene.boxes.iter();
                boxes.for_each(|b| assert!(broad.insert(b, BodyOptions::default()).is_ok()));
                broad.step().began.len()
            });
        });
    }
    group.finish();
}

criterion_group!(name = benches; config = common::criterion(); targets = step, build);
criterion_main!(benches);
