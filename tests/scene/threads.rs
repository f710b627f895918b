//! Features `parallel` and `serde`: any number of threads gives the same bits, and so does a scene
//! that was saved and read back.
#![cfg(all(feature = "parallel", feature = "serde"))]

use lin_canny::scene::{Body, BodyId, Event, Group, PairQueries, Scene, Settings};
use lin_canny::{Distance, Manifold, ManifoldOptions, Outcome};
use truth::crowd::{Crowd, Kind};

const KINDS: [Kind; 2] = [Kind::Sparse, Kind::Pile];

fn sets() -> [PairQueries; 6] {
    let none = PairQueries::none();
    [
        none.overlap(true).boxes(true),
        none.within(0.1),
        none.distance(0.2).overlap(true),
        none.distance(0.2).features(true).depth(true).overlap(true),
        none.manifold(ManifoldOptions::default().prediction(0.05)),
        none.features(true).local_depth(true).overlap(true),
    ]
}

/// Returns a scene of three groups with different queries.
fn scene(crowd: &Crowd, settings: Settings) -> (Scene, Vec<BodyId>) {
    let group = |k: usize| Group::new(k as u8).unwrap();
    let mut scene = Scene::with_settings(settings);
    for (k, queries) in sets().into_iter().enumerate() {
        scene
            .set_queries(group(k % 3), group((k + k / 3) % 3), queries)
            .unwrap();
        scene.set_queries(group(k % 3), group(2), queries).unwrap();
    }
    let shapes = crowd.hulls();
    let ids = crowd
        .shape_of
        .iter()
        .zip(&crowd.poses)
        .enumerate()
        .map(|(k, (shape, pose))| {
            let shape = shapes[*shape].clone();
            let made = if k % 7 == 0 {
                Body::fixed(shape)
            } else {
                Body::moving(shape)
            };
            scene.insert(made.group(group(k % 3)), pose.isometry()).unwrap()
        });
    let ids = ids.collect();
    (scene, ids)
}

type Answers = (
    u32,
    Option<bool>,
    Option<bool>,
    Option<Distance>,
    Option<Outcome>,
    Option<Manifold>,
);

type Seen = (Vec<Event>, Vec<Answers>, lin_canny::scene::StepWork);

/// Returns whether each answer of a pair is the known one, or none.
fn is_same_or_none(known: &Answers, told: &Answers) -> bool {
    known.0 == told.0
        && (told.1.is_none() || told.1 == known.1)
        && (told.2.is_none() || told.2 == known.2)
        && (told.3.is_none() || told.3 == known.3)
        && (told.4.is_none() || told.4 == known.4)
        && (told.5.is_none() || told.5 == known.5)
}

fn seen(scene: &Scene) -> Seen {
    let pairs = scene.pairs().map(|p| {
        (
            p.pair.slot,
            p.overlaps,
            p.within,
            p.distance,
            p.outcome.copied(),
            p.manifold.cloned(),
        )
    });
    let mut counts = scene.report().counts;
    // Swaps of the columns of the broad phase, which are rebuilt when a scene is read.
    counts.swaps = 0;
    (scene.events().to_vec(), pairs.collect(), counts)
}

fn advance(scene: &mut Scene, ids: &[BodyId], crowd: &mut Crowd) {
    crowd.step();
    for (k, (id, pose)) in ids.iter().zip(&crowd.poses).enumerate() {
        if k % 7 != 0 && k % 5 != 1 {
            scene.set_pose(*id, pose.isometry()).unwrap();
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn threads_change_nothing() {
    for kind in KINDS {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut crowd = Crowd::new(kind, 3000, 12);
                let from = if threads == 1 { usize::MAX } else { 0 };
                let (mut scene, ids) = scene(&crowd, Settings::default().parallel_from(from));
                let mut log = vec![];
                for _ in 0..12 {
                    advance(&mut scene, &ids, &mut crowd);
                    scene.step();
                    log.push(seen(&scene));
                }
                log
            })
        };
        let one = run(1);
        let asked: u64 = one.iter().map(|s| s.2.queries).sum();
        assert!(asked > 3000, "{asked}");
        for threads in [2, 3, 8] {
            assert!(run(threads) == one, "{kind:?} {threads}");
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_scene_goes_on_from_a_file_bit_for_bit() {
    for kind in KINDS {
        let mut crowd = Crowd::new(kind, 150, 12);
        let (mut one, mut ids) = scene(&crowd, Settings::default());
        one.set_velocity(
            ids[1],
            lin_canny::Velocity::new([0.1, 0.0, 0.0].into(), [0.0, 0.3, 0.0].into()),
        )
        .unwrap();
        for k in 0..30 {
            // Saved in every state, with or without pending calls.
            advance(&mut one, &ids, &mut crowd);
            match k % 5 {
                0 => one.step(),
                1 => {
                    one.remove(ids.remove(k)).unwrap();
                    crowd.poses.remove(k);
                    one.report()
                }
                2 => {
                    let all = sets()[k / 5 % 5].distance(f64::INFINITY);
                    one.set_queries(Group::default(), Group::default(), all).unwrap();
                    one.report()
                }
                3 => {
                    one.set_group(ids[k], Group::default()).unwrap();
                    one.report()
                }
                _ => one.report(),
            };
            let text = serde_json::to_string(&one).expect("serialises");
            let mut two: Scene = serde_json::from_str(&text).expect("deserialises");
            let (x, y) = (seen(&one), seen(&two));
            assert!((&x.0, x.2) == (&y.0, y.2) && x.1.len() == y.1.len());
            // Answers about poses that no text has are not given before the next step.
            let has_calls = k % 5 != 0;
            if has_calls {
                assert!(x.1.iter().zip(&y.1).all(|(x, y)| is_same_or_none(x, y)));
            } else {
                assert_eq!(serde_json::to_string(&two).expect("serialises"), text);
                assert!(x.1 == y.1);
            }
            for scene in [&mut one, &mut two] {
                scene.advance(0.1).unwrap();
                scene.step();
            }
            let (x, y) = (seen(&one), seen(&two));
            let differing = x.1.iter().zip(&y.1).find(|(x, y)| x != y);
            assert!(x == y, "{kind:?} {k}: {differing:?}");
            let id = one.bodies().next().unwrap();
            assert_eq!(one.pairs_of(id), two.pairs_of(id));
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_damaged_file_is_refused_or_does_no_harm() {
    let mut crowd = Crowd::new(Kind::Pile, 12, 6);
    let (mut scene, ids) = scene(&crowd, Settings::default());
    for _ in 0..3 {
        advance(&mut scene, &ids, &mut crowd);
        scene.step();
    }
    scene.remove(ids[3]).unwrap();
    let known = serde_json::to_value(&scene).expect("serialises");
    let mut paths = vec![];
    numbers(&known, &mut vec![], &mut paths);
    let (mut refused, mut lived) = (0, 0);
    // Every eleventh number in the file is replaced.
    for (k, path) in paths.iter().enumerate().step_by(11) {
        for value in [0u32, 1, 5, 4_000_000_000] {
            let mut text = known.clone();
            *text.pointer_mut(path).expect("is there") = (value.wrapping_add(k as u32 % 3)).into();
            match serde_json::from_value::<Scene>(text) {
                Err(_) => refused += 1,
                Ok(mut scene) => {
                    lived += 1;
                    scene.step();
                    let ids: Vec<BodyId> = scene.bodies().collect();
                    for id in &ids {
                        let pose =
                            *scene.pose(*id).expect("lives") * lin_canny::nalgebra::Translation3::new(0.01, 0.0, 0.0);
                        let _ = scene.set_pose(*id, pose);
                        let _ = scene.pairs_of(*id);
                    }
                    scene.step();
                    scene.pairs().for_each(drop);
                    ids.iter().for_each(|id| scene.remove(*id).expect("lives"));
                    scene.step();
                    assert_eq!(scene.body_count(), 0, "{path}");
                }
            }
        }
    }
    assert!(refused > 50 && lived > 50, "{refused} {lived}");
}

/// Collects the paths of all numbers in a text.
#[cfg(feature = "serde")]
fn numbers(value: &serde_json::Value, path: &mut Vec<String>, out: &mut Vec<String>) {
    use serde_json::Value;
    match value {
        Value::Number(_) => out.push(path.iter().map(|p| format!("/{p}")).collect()),
        Value::Array(items) => {
            for (k, item) in items.iter().enumerate() {
                path.push(k.to_string());
                numbers(item, path, out);
                path.pop();
            }
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                path.push(name.clone());
                numbers(field, path, out);
                path.pop();
            }
        }
        _ => {}
    }
}
