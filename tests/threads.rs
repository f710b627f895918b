//! Feature `parallel`: any number of threads gives the same events, slots, errors and calls of the
//! filter.
//!
//! It is a separate process, because the global thread pool is created once per process.
#![cfg(feature = "parallel")]

use lin_canny::broad::*;
use truth::boxes::{Kind, Scene};

fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(work)
}

/// Results of a step, in their order.
#[derive(Debug, PartialEq)]
struct Told {
    error: BatchError,
    asked: Vec<(BodyId, BodyId)>,
    began: Vec<Pair>,
    ended: Vec<Pair>,
    pairs: Vec<Pair>,
}

/// Runs twenty steps of a scene with two bad boxes each, one body replaced and one tested again by
/// the filter, which rejects some pairs.
fn run(kind: Kind, threads: usize) -> Vec<Told> {
    let mut scene = Scene::new(kind, 1500);
    let from = if threads == 1 { usize::MAX } else { 0 };
    let mut broad = SweepAndPrune::with_settings(Settings::default().parallel_from(from));
    let insert = |broad: &mut SweepAndPrune, aabb: &Aabb| broad.insert(aabb, BodyOptions::default()).unwrap();
    let mut ids: Vec<BodyId> = scene.boxes.iter().map(|b| insert(&mut broad, b)).collect();
    let step = |step: usize| {
        scene.step();
        let mut batch: Vec<(BodyId, Aabb)> = ids.iter().copied().zip(scene.boxes.iter().copied()).collect();
        batch[700].1.min.x = f64::NAN;
        batch[70].0.generation += 2;
        if step.is_multiple_of(3) {
            batch.reverse();
        }
        let error = broad.set_boxes(&batch).unwrap_err();
        let replaced = (step * 71 + 3) % 1500;
        broad.remove(ids[replaced]).unwrap();
        ids[replaced] = insert(&mut broad, &scene.boxes[replaced]);
        broad.regroup(ids[step * 37]).unwrap();
        let mut asked = Vec::new();
        let events = broad.step_with(&mut |a, b| {
            asked.push((a, b));
            (a.index ^ b.index) % 5 > 0
        });
        let (began, ended) = (events.began.to_vec(), events.ended.to_vec());
        let pairs = broad.pairs().collect();
        Told {
            error,
            asked,
            began,
            ended,
            pairs,
        }
    };
    (0..20).map(step).collect()
}

#[test]
fn threads_change_nothing() {
    rayon::ThreadPoolBuilder::new().num_threads(3).build_global().unwrap();
    for kind in [
        Kind::Uniform,
        Kind::Pile,
        Kind::Movers,
        Kind::Teleport,
        Kind::Mixed,
        Kind::Clusters,
    ] {
        let one = with_threads(1, || run(kind, 1));
        assert!(one.iter().all(|told| told.error.refused == 2));
        let ended: usize = one.iter().map(|told| told.ended.len()).sum();
        let refused: usize = one.iter().map(|told| told.asked.len() - told.began.len()).sum();
        let (least_ended, least_refused) = if kind == Kind::Movers { (10, 5) } else { (40, 50) };
        assert!(ended > least_ended, "{} {ended} {refused}", kind.name());
        assert!(refused > least_refused, "{} {ended} {refused}", kind.name());
        let outside = run(kind, 3);
        assert!(outside == one, "{} from outside the pool", kind.name());
        for threads in [2, 3, 8] {
            let many = with_threads(threads, || run(kind, threads));
            assert!(many == one, "{} {threads}", kind.name());
        }
    }
}
