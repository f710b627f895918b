//! What the benchmarks share: how long a row is measured, and which rows there are.
//!
//! By default each benchmark has the rows that answer its question. `LIN_CANNY_BENCH=all` adds the
//! other shapes, sizes and motions.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion};

/// A group of rows.
pub type Group<'a> = BenchmarkGroup<'a, WallTime>;

/// Returns the settings of all benchmarks: a second of warm-up, two seconds of measurement.
pub fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(2))
        .sample_size(50)
        // Intervals of bootstrapping take longer than plots else.
        .nresamples(10_000)
}

/// Returns the default values, or all of them.
pub fn chosen<'a, T>(default: &'a [T], all: &'a [T]) -> &'a [T] {
    match std::env::var("LIN_CANNY_BENCH") {
        Ok(which) if which == "all" => all,
        _ => default,
    }
}

/// Measures a call; successive measurements use successive cases.
pub fn each<C, T>(
    group: &mut Group,
    name: &str,
    size: impl std::fmt::Display,
    cases: &[C],
    mut ask: impl FnMut(&C) -> T,
) {
    let mut k = 0;
    group.bench_function(BenchmarkId::new(name, size), |bench| {
        bench.iter(|| {
            k = (k + 1) % cases.len();
            black_box(ask(&cases[k]))
        });
    });
}
