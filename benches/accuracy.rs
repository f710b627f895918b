//! Benchmarks of accuracy levels: follow one level of the instrument `accuracy_cost` over time.
//!
//! Run `cargo bench --bench accuracy`, with `-- --save-baseline NAME` before a change and
//! `-- --baseline NAME` after it. `cargo run --release -p race --bin accuracy_cost` measures errors
//! too and interleaves all engines.

use std::hint::black_box;

use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main, measurement::WallTime};
use lin_canny::{RelativePose, Tracker};
use truth::pairs::{Body, Pair, ball};
use truth::parry::GjkCached;

const FRAMES: usize = 500;

type Group<'a> = BenchmarkGroup<'a, WallTime>;

/// Measures one query; successive measurements use successive frames.
fn each<T>(group: &mut Group, name: &str, n: usize, pair: &Pair, mut ask: impl FnMut(&RelativePose) -> T) {
    let mut k = 0;
    group.bench_function(BenchmarkId::new(name, n), |bench| {
        bench.iter(|| {
            k = (k + 1) % pair.frames.len();
            let (a, b) = &pair.isometries[k];
            black_box(ask(&RelativePose::new(a, b).expect("a pose")))
        });
    });
}

fn gjk(group: &mut Group, n: usize, pair: &Pair) {
    let (mut k, mut state) = (0, GjkCached::default());
    group.bench_function(BenchmarkId::new("gjk-cached", n), |bench| {
        bench.iter(|| {
            k = (k + 1) % pair.frames.len();
            let f = &pair.frames[k];
            black_box(state.closest(&pair.a.climber, &f.a, &pair.b.climber, &f.b))
        });
    });
}

fn levels(c: &mut Criterion) {
    let mut group = c.benchmark_group("levels/sphere-0.05deg");
    for n in [8, 512] {
        let pair = Pair::of("sphere", n).expect("a sphere").swinging(0.05, FRAMES);
        let (a, b) = (&pair.a.ours, &pair.b.ours);
        let mut t = Tracker::new();
        each(&mut group, "walk", n, &pair, |p| t.propose(a, b, p));
        let mut t = Tracker::new();
        each(&mut group, "certified", n, &pair, |p| t.closest(a, b, p));
        let mut t = Tracker::new();
        each(&mut group, "exact", n, &pair, |p| t.closest_exact(a, b, p));
        each(&mut group, "certified-cold", n, &pair, |p| {
            Tracker::new().closest(a, b, p)
        });
        gjk(&mut group, n, &pair);
    }
}

/// Benchmarks a sphere replaced by hulls of more and more vertices.
fn geometry(c: &mut Criterion) {
    let mut group = c.benchmark_group("geometry/ball-0.5deg");
    for n in [12, 120, 1200, 12_000, 100_000] {
        let body = || Body::new(&ball(n)).expect("a hull");
        let pair = Pair::new(body(), body()).moving(Some(0.5), FRAMES);
        let mut t = Tracker::new();
        each(&mut group, "certified", n, &pair, |p| {
            t.closest(&pair.a.ours, &pair.b.ours, p)
        });
        gjk(&mut group, n, &pair);
    }
}

/// Benchmarks every question on one motion.
fn asking(c: &mut Criterion) {
    for degrees in [0.05, 1.0] {
        let mut group = c.benchmark_group(format!("asking/flat-{degrees}deg"));
        let n = 512;
        let pair = Pair::of("flat", n).expect("a flat body").swinging(degrees, FRAMES);
        let (a, b) = (&pair.a.ours, &pair.b.ours);
        let mut t = Tracker::new();
        each(&mut group, "overlap", n, &pair, |p| t.intersects(a, b, p));
        let mut t = Tracker::new();
        each(&mut group, "within", n, &pair, |p| t.within(a, b, p, 0.1));
        let mut t = Tracker::new();
        each(&mut group, "distance", n, &pair, |p| t.distance(a, b, p));
        let mut t = Tracker::new();
        each(&mut group, "witnesses", n, &pair, |p| t.closest(a, b, p));
    }
}

criterion_group!(benches, levels, geometry, asking);
criterion_main!(benches);
