//! Promise: pairs are those of brute force if bounds are equal everywhere: bricks, lattices,
//! stacks.

use lin_canny::broad::*;
use lin_canny::nalgebra::{Point3, Vector3};
use truth::driven::lattice::{Mix, sequence};
use truth::driven::played;
use truth::tally::Tally;

fn play(sequences: u64, make: impl Fn() -> SweepAndPrune) {
    let mix = played(0..sequences, |seed| sequence(seed, make()));
    let n = sequences;
    assert!(mix.pairs > 20 * n, "{mix:?}");
    assert!(mix.events > 5 * n, "{mix:?}");
    assert!(mix.steps > 10 * n, "{mix:?}");
    assert!(
        mix.jumps > n && mix.slides > n && mix.reused > n / 4 && mix.turns > n / 4 && mix.quiet > 2 * n,
        "{mix:?}"
    );
}

#[test]
fn columns_on_lattices_equal_brute_force() {
    play(20_000, SweepAndPrune::new);
}

/// With the feature `parallel` and several threads, columns are distributed from the first body on.
#[test]
fn shared_work_on_lattices_equals_brute_force() {
    play(2000, || {
        SweepAndPrune::with_settings(Settings::default().parallel_from(1))
    });
}

/// Plays two million sequences or `LATTICE_SEQUENCES`, which takes minutes.
#[test]
#[ignore = "minutes of work; run with --release"]
fn two_million_sequences_equal_brute_force() {
    let asked = std::env::var("LATTICE_SEQUENCES").ok().and_then(|n| n.parse().ok());
    let (n, threads) = (asked.unwrap_or(2_000_000), 2);
    let mixes: Vec<Mix> = std::thread::scope(|scope| {
        let parts: Vec<_> = (0..threads)
            .map(|part| {
                let seeds = (1_000_000 + part..1_000_000 + n).step_by(threads as usize);
                scope.spawn(move || played(seeds, |seed| sequence(seed, SweepAndPrune::new())))
            })
            .collect();
        parts
            .into_iter()
            .map(|part| part.join().expect("no sequence failed"))
            .collect()
    });
    let mut sum = Mix::default();
    mixes.iter().for_each(|mix| sum.add(mix));
    assert_eq!(sum.sequences, n);
    println!("{sum:?}");
}

/// A wall of bricks: one is lifted out and put back, or replaced, then two slide along each other.
fn wall(mut broad: SweepAndPrune, size: u32, gap: f64, replace: bool) {
    let brick = |x: f64, y: f64| Aabb::from_center(Point3::new(x, y, 0.0), Vector3::repeat(0.5));
    let mut wall = Vec::new();
    for x in 0..size {
        for y in 0..size {
            let aabb = brick(gap * f64::from(x), gap * f64::from(y));
            wall.push(broad.insert(&aabb, BodyOptions::default()).unwrap());
        }
    }
    broad.step();
    if replace {
        broad.remove(wall[0]).unwrap();
        broad.step();
        wall[0] = broad.insert(&brick(0.0, 0.0), BodyOptions::default()).unwrap();
    } else {
        broad.set_box(wall[0], &brick(-50.0, 40.0)).unwrap();
        broad.step();
        broad.set_box(wall[0], &brick(0.0, 0.0)).unwrap();
    }
    broad.step();
    for (who, y) in [(0, 0.25), (1, 0.5)] {
        for k in 0..=24 {
            broad.set_box(wall[who], &brick(0.25 * f64::from(k), y)).unwrap();
            broad.step();
            assert_eq!(broad.check(), Ok(()));
        }
    }
    assert!(broad.pair(wall[0], wall[1]).is_some(), "{size} {gap} {replace}");
}

#[test]
fn a_brick_set_back_into_its_wall_still_meets_others() {
    for size in [4, 8, 12, 16] {
        for gap in [1.0, 1.5, 2.0, 3.0] {
            for replace in [false, true] {
                wall(SweepAndPrune::new(), size, gap, replace);
            }
        }
    }
}
