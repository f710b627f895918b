//! What each effect of a simulation costs: 300 hulls in a bin, with effects added one by one.
//!
//! A measurement is the first 60 steps of 1/60 s; the throughput is in steps. Run
//! `cargo bench -p lin-canny-rapier --bench effects`.

use std::time::Duration;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

#[path = "../examples/common/mod.rs"]
mod common;

use common::effects::{sets, simulation};

const BODIES: usize = 300;
const STEPS: u64 = 60;

fn effects(c: &mut Criterion) {
    let mut group = c.benchmark_group("effects");
    group.throughput(Throughput::Elements(STEPS));
    for (name, effects, observe) in sets() {
        group.bench_function(name, |bench| {
            bench.iter_batched_ref(
                || simulation(effects, observe, BODIES).expect("a simulation"),
                |simulation| {
                    for _ in 0..STEPS {
                        simulation.step().expect("a step");
                    }
                },
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(2))
        .sample_size(10)
}

criterion_group!(name = benches; config = criterion(); targets = effects);
criterion_main!(benches);
