//! Promise: a query allocates nothing if a solver before the exact stage answers.
//!
//! An overlap allocates nothing in a tracker that already has its memory. A counting allocator
//! counts, so this test is a separate process.

use std::alloc::System;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{ContactState, Manifold, ManifoldOptions, RelativePose, Solver, Tracker};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use truth::rng::Rng;
use truth::shapes;
use truth::support::body;

#[global_allocator]
static COUNTING: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Returns the allocations, new and grown, while `f` runs.
fn allocations(f: impl FnOnce()) -> usize {
    let region = Region::new(COUNTING);
    f();
    let change = region.change();
    change.allocations + change.reallocations
}

// One test only: tests of one file run concurrently and would count each other's allocations.
#[test]
fn queries_below_the_exact_rung_allocate_nothing() {
    assert!(
        allocations(|| drop(std::hint::black_box(vec![1u8]))) > 0,
        "the allocator counts"
    );
    let mut rng = Rng::new(21);
    let mut shapes = vec![
        shapes::cube(),
        shapes::icosphere(2),
        shapes::cone(512, 1.0, 0.4),
        shapes::grid(4),
    ];
    shapes.extend([1e-3, 1e-9].map(|z| shapes::sliver(&mut rng, 24, z)));
    shapes.extend([1e-6].map(|z| shapes::needle(&mut rng, 24, z)));
    shapes.push(shapes::sphere(&mut rng, 300));
    let bodies: Vec<_> = shapes.iter().map(body).collect();
    let (mut separated, mut overlapping, mut fallbacks, mut tracked, mut points) = (0, 0, 0, 0, 0);
    // Two cubes with a gap near rounding are solved in double-double.
    let near = RelativePose::from_isometry(&Isometry3::translation(2.0 + 2e-14, 0.3, 0.2)).unwrap();
    let mut answer = None;
    let count = allocations(|| answer = Some(Tracker::new().closest(&bodies[0], &bodies[0], &near)));
    assert_eq!((count, answer.map(|o| o.solver)), (0, Some(Solver::DoubleDouble)));
    for (a, b) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))) {
        let mut pair = Tracker::new();
        pair.reserve();
        let n = Vector3::from(rng.unit());
        let axis = Vector3::from(rng.unit());
        let mut kept_points = 0;
        for k in 0..60 {
            // From separation into overlap and out again, with occasional jumps.
            let reach = 2.5 - 0.08 * f64::from(k);
            let pose = Isometry3::new(n * reach, axis * (0.02 * f64::from(k)));
            let pose = RelativePose::from_isometry(&pose).unwrap();
            let mut fresh: Vec<Tracker> = (0..3).map(|_| pair.clone()).collect();
            fresh.iter_mut().for_each(Tracker::reserve);
            // Builds that check every answer copy the tracker for their report; `distance` is
            // `closest` without the copy.
            let o = pair.clone().closest(a, b, &pose);
            // The threads of the test harness may allocate meanwhile, so the least of three counts
            // is taken.
            let count = fresh.iter_mut().map(|t| {
                allocations(|| {
                    std::hint::black_box(t.distance(a, b, &pose));
                })
            });
            let count = count.min().unwrap();
            let lean = fresh.iter_mut().map(|t| {
                allocations(|| {
                    std::hint::black_box((t.propose(a, b, &pose), t.intersects(a, b, &pose)));
                })
            });
            let lean = lean.min().unwrap();
            // A manifold allocates no more than the outcome that it is made from, and nothing again
            // at the same pose.
            let options = ManifoldOptions::default().prediction(0.1);
            let [mut answered, mut made, mut kept] = [usize::MAX; 3];
            let mut manifolds = [(); 3].map(|()| Manifold::new());
            for m in &mut manifolds {
                let (mut s, mut t) = (pair.clone(), pair.clone());
                [&mut s, &mut t].into_iter().for_each(Tracker::reserve);
                answered = answered.min(allocations(|| {
                    std::hint::black_box(s.closest(a, b, &pose));
                }));
                made = made.min(allocations(|| t.manifold(a, b, &pose, &options, m)));
                kept = kept.min(allocations(|| t.manifold(a, b, &pose, &options, m)));
            }
            points += manifolds[0].points().len();
            pair.closest(a, b, &pose);
            // The first polytope has four triangles, and each point adds two. The cached part grows
            // from query to query.
            let is_plain = o.work.exacts == 0 && (o.state != ContactState::Overlapping || o.work.double_doubles == 0);
            let is_small = kept_points + o.work.points_added <= (256 - 4) / 2;
            kept_points = match o.solver {
                Solver::Polytope => kept_points + o.work.points_added,
                _ => o.work.points_added,
            };
            if is_plain && is_small {
                assert_eq!((count, lean), (0, 0), "{o:?}");
                assert_eq!(made, answered, "{o:?}");
                // Beyond the prediction, every query computes again.
                assert!(manifolds[0].points().is_empty() || kept == 0, "{o:?}");
                separated += u32::from(o.state == ContactState::Separated);
                overlapping += u32::from(o.state == ContactState::Overlapping);
                tracked += u32::from(o.solver == Solver::Polytope);
                fallbacks += o.work.fallbacks;
            }
        }
    }
    assert!(
        separated > 500 && overlapping > 500 && tracked > 300 && fallbacks > 10 && points > 500,
        "{separated} {overlapping} {tracked} {fallbacks} {points}"
    );
}
