//! Benchmarks a step of a scene for several sets of queries: `cargo bench --bench scene`.
//!
//! The race `scene` compares it with other libraries.

use common::chosen;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lin_canny::ManifoldOptions;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene};
use truth::crowd::{Crowd, Kind};

const NONE: PairQueries = PairQueries::none();

/// Growing sets of queries for one motion.
fn sets() -> [(&'static str, PairQueries); 7] {
    [
        ("boxes", NONE.boxes(true)),
        ("overlap", NONE.overlap(true)),
        ("within", NONE.within(0.05)),
        ("distance", NONE.distance(0.02)),
        ("features", NONE.distance(0.02).features(true)),
        ("depth", NONE.distance(0.02).features(true).depth(true)),
        ("manifold", NONE.manifold(ManifoldOptions::default().prediction(0.02))),
    ]
}

/// Returns a crowd in a scene after 20 steps.
fn scene(crowd: &mut Crowd, queries: PairQueries) -> (Scene, Vec<BodyId>) {
    let shapes = crowd.hulls();
    let mut scene = Scene::new();
    let all = Group::default();
    scene.set_queries(all, all, queries).expect("a range");
    let bodies = crowd.shape_of.iter().zip(&crowd.poses);
    let ids = bodies.map(|(shape, pose)| {
        scene
            .insert(Body::moving(shapes[*shape].clone()), pose.isometry())
            .expect("a pose")
    });
    let ids: Vec<_> = ids.collect();
    for _ in 0..20 {
        advance(&mut scene, &ids, crowd);
    }
    (scene, ids)
}

fn advance(scene: &mut Scene, ids: &[BodyId], crowd: &mut Crowd) {
    crowd.step();
    for (id, pose) in ids.iter().zip(&crowd.poses) {
        scene.set_pose(*id, pose.isometry()).expect("a pose");
    }
    scene.step();
}

/// The measurement includes the poses of the next step: a few nanoseconds per body.
fn moving(criterion: &mut Criterion) {
    let kinds = [(Kind::Pile, "pile"), (Kind::Sparse, "sparse")];
    for &(kind, name) in chosen(&kinds[..1], &kinds) {
        for &vertices in chosen(&[32], &[32, 256]) {
            let mut group = criterion.benchmark_group(format!("scene/{name}-{vertices}"));
            for &n in chosen(&[1_000], &[1_000, 10_000]) {
                group.throughput(Throughput::Elements(n as u64)).sample_size(10);
                for (queries, set) in sets() {
                    let mut crowd = Crowd::new(kind, n, vertices);
                    let (mut scene, ids) = scene(&mut crowd, set);
                    group.bench_function(BenchmarkId::new(queries, n), |b| {
                        b.iter(|| advance(&mut scene, &ids, &mut crowd));
                    });
                }
            }
            group.finish();
        }
    }
}

/// Benchmarks a step in which no pose was set, and a step in which one body in a hundred was moved.
fn resting(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("scene/rest");
    let mut crowd = Crowd::new(Kind::Pile, 10_000, 32);
    let (mut scene, ids) = scene(&mut crowd, sets()[4].1);
    group.bench_function("nothing", |b| b.iter(|| scene.step().counts.queries));
    group.bench_function("one in a hundred", |b| {
        b.iter(|| {
            crowd.step();
            for k in (0..ids.len()).step_by(100) {
                scene.set_pose(ids[k], crowd.poses[k].isometry()).expect("a pose");
            }
            scene.step().counts.queries
        });
    });
    group.finish();
}

criterion_group!(name = benches; config = common::criterion(); targets = moving, resting);
criterion_main!(benches);
