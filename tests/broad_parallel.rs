//! Feature `parallel`: any number of threads gives the same events, slots and errors.
#![cfg(feature = "parallel")]

use lab::boxes::{Kind, Scene};
use lin_canny::broad::*;

fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(work)
}

#[test]
fn threads_change_nothing() {
    for kind in [Kind::Uniform, Kind::Pile, Kind::Teleport, Kind::Mixed, Kind::Clusters] {
        let run = |threads: usize| {
            with_threads(threads, || {
                let mut scene = Scene::new(kind, 1500);
                let from = if threads == 1 { usize::MAX } else { 0 };
                let mut broad = PencilSweep::with_settings(Settings::default().parallel_from(from));
                let ids: Vec<BodyId> = scene
                    .boxes
                    .iter()
                    .map(|b| broad.insert(b, Body::moving()).unwrap())
                    .collect();
                let mut log = Vec::new();
                for step in 0..20 {
                    scene.step();
                    let mut batch: Vec<(BodyId, Aabb)> = ids.iter().copied().zip(scene.boxes.iter().copied()).collect();
                    batch[700].1.min.x = f64::NAN;
                    batch[70].0.generation += 2;
                    if step % 3 == 0 {
                        batch.reverse();
                    }
                    let error = broad.set_boxes(&batch).unwrap_err();
                    let events = broad.step();
                    log.push((error, events.began.to_vec(), events.ended.to_vec()));
                }
                log
            })
        };
        let one = run(1);
        assert!(one[0].0.refused == 2);
        for threads in [2, 3, 8] {
            assert_eq!(run(threads), one, "{} {threads}", kind.name());
        }
    }
}
