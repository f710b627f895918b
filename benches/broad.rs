//! Benchmarks a step of the broad phase on all scenes: `cargo bench --bench broad`.
//!
//! The race `boxes` compares it with other libraries. To measure the effect of threads, run
//! `RAYON_NUM_THREADS=2 cargo bench --features parallel --bench broad -- 'columns/(uniform|pile)/10*$'`,
//! and the same with one thread.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lin_canny::broad::{Aabb, BodyId, BodyOptions, SweepAndPrune};
use truth::boxes::{Kind, Scene};

fn step(criterion: &mut Criterion, sizes: &[usize]) {
    let mut group = criterion.benchmark_group("columns");
    group.sample_size(20);
    for kind in Kind::ALL {
        for &n in sizes {
            if n > 100_000 && !matches!(kind, Kind::Uniform | Kind::Pile) {
                continue;
            }
            let mut scene = Scene::new(kind, n);
            let mut broad = SweepAndPrune::new();
            let ids: Vec<BodyId> = scene
                .boxes
                .iter()
                .filter_map(|b| broad.insert(b, BodyOptions::moving()).ok())
                .collect();
            assert_eq!(ids.len(), n);
            broad.step();
            assert!(broad.pair_count() > n / 20, "the scene hardly has pairs");
            group.throughput(Throughput::Elements(n as u64));
            group.bench_function(BenchmarkId::new(kind.name(), n), |bencher| {
                bencher.iter_batched(
                    || {
                        scene.step();
                        scene
                            .moved
                            .iter()
                            .map(|&i| (ids[i as usize], scene.boxes[i as usize]))
                            .collect()
                    },
                    |batch: Vec<(BodyId, Aabb)>| {
                        assert!(broad.set_boxes(&batch).is_ok());
                        let events = broad.step();
                        (events.began.len(), events.ended.len(), batch)
                    },
                    criterion::BatchSize::PerIteration,
                );
            });
        }
    }
    group.finish();
}

/// Benchmarks the insertion of a whole scene and its first step.
fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(20);
    for kind in [Kind::Uniform, Kind::Pile] {
        let scene = Scene::new(kind, 10_000);
        group.bench_function(kind.name(), |bencher| {
            bencher.iter(|| {
                let mut broad = SweepAndPrune::new();
                scene
                    .boxes
                    .iter()
                    .for_each(|b| assert!(broad.insert(b, BodyOptions::moving()).is_ok()));
                broad.step().began.len()
            });
        });
    }
    group.finish();
}

fn benches(criterion: &mut Criterion) {
    step(criterion, &[1_000, 10_000, 100_000, 1_000_000]);
    build(criterion);
}

criterion_group!(broad, benches);
criterion_main!(broad);
