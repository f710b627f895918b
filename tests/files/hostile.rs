//! Tampered files are rejected, or contain valid bodies and poses (feature `serde`).
#![cfg(feature = "serde")]

use lin_canny::broad::{Aabb, SweepAndPrune};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene};
use lin_canny::{Compound, ConvexPolyhedron, Manifold, ManifoldOptions, Mesh, PairTracker};
use lin_canny::{RelativePose, Shape, Tracker, Velocity};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::sync::Arc;
use truth::driven::bytes;
use truth::rng::Rng;
use truth::shapes;

/// Returns a text with one to four bytes changed to others that occur in JSON.
fn tampered(text: &str, rng: &mut Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(bytes.len());
        bytes[at] = *rng.pick(b"0123456789.-e,[]{}\"ABVFnull");
    }
    String::from_utf8(bytes).unwrap_or_default()
}

#[test]
fn tampered_files_do_no_harm() {
    let mut rng = Rng::new(81);
    let shape = shapes::small(&mut rng);
    let points: Vec<_> = shape.points.iter().map(|&p| Point3::from(p)).collect();
    let a = ConvexPolyhedron::from_points(&points).unwrap();
    let pose = Isometry3::new(Vector3::new(2.0, 0.5, -1.0), Vector3::new(0.1, 0.2, 0.3));
    let pose = RelativePose::from_isometry(&pose).unwrap();
    let mut pair = Tracker::new();
    pair.closest(&a, &a, &pose);
    let body_text = serde_json::to_string(&a).unwrap();
    let pose_text = serde_json::to_string(&pose).unwrap();
    let pair_text = serde_json::to_string(&pair).unwrap();
    assert_eq!(serde_json::from_str::<Tracker>(&pair_text).unwrap(), pair);
    assert_eq!(serde_json::from_str::<RelativePose>(&pose_text).unwrap(), pose);
    let (mut read, mut refused) = ([0; 3], [0; 3]);
    for _ in 0..6000 {
        let body = serde_json::from_str::<ConvexPolyhedron>(&tampered(&body_text, &mut rng));
        let moved = serde_json::from_str::<RelativePose>(&tampered(&pose_text, &mut rng));
        let tracker = serde_json::from_str::<Tracker>(&tampered(&pair_text, &mut rng));
        for (k, ok) in [body.is_ok(), moved.is_ok(), tracker.is_ok()].into_iter().enumerate() {
            *(if ok { &mut read[k] } else { &mut refused[k] }) += 1;
        }
        let body = body.unwrap_or_else(|_| a.clone());
        bytes::query(&a, &body, &moved.unwrap_or(pose), &mut tracker.unwrap_or_default(), 0.5);
    }
    assert!(read.iter().chain(&refused).all(|&n| n > 20), "{read:?} {refused:?}");
}

/// Collects the paths of all numbers of a text.
pub(super) fn numbers(value: &Value, way: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(way.into()),
        Value::Array(list) => list
            .iter()
            .enumerate()
            .for_each(|(k, v)| numbers(v, &format!("{way}/{k}"), found)),
        Value::Object(map) => map.iter().for_each(|(k, v)| numbers(v, &format!("{way}/{k}"), found)),
        _ => {}
    }
}

/// Returns a text with one or two numbers changed to others of their kind: limits of the types,
/// neighbours, and numbers from elsewhere.
fn mutated(text: &Value, ways: &[String], rng: &mut Rng) -> Value {
    let mut text = text.clone();
    for _ in 0..1 + rng.below(2) {
        let other = text.pointer(&ways[rng.below(ways.len())]).cloned().unwrap();
        let number = text.pointer_mut(&ways[rng.below(ways.len())]).unwrap();
        *number = match number.as_u64() {
            Some(n) => {
                let ends = [
                    0,
                    1,
                    31,
                    32,
                    0x7fff_ffff,
                    0xffff_fffe,
                    0xffff_ffff,
                    u64::MAX - 1,
                    u64::MAX,
                ];
                let near = [n.wrapping_add(1), n.wrapping_sub(1), n ^ 1 << rng.below(33)];
                if rng.below(3) == 0 {
                    other
                } else if rng.below(3) == 0 {
                    json!(*rng.pick(&near))
                } else {
                    json!(*rng.pick(&ends))
                }
            }
            None => json!(*rng.pick(&[0.0, -0.0, -1.0, 1e-320, 1e-160, 1e37, 1e160, f64::MAX, f64::MIN, 0.5])),
        };
    }
    text
}

/// Changes numbers of a serialised value and uses each value that can be read. Returns how many
/// could be read.
fn survives<T: serde::Serialize + DeserializeOwned>(
    value: &T,
    rounds: usize,
    seed: u64,
    mut ask: impl FnMut(T, &str),
) -> usize {
    let mut rng = Rng::new(seed);
    let text = serde_json::to_value(value).unwrap();
    let mut ways = Vec::new();
    numbers(&text, "", &mut ways);
    let mut read = 0;
    for _ in 0..rounds {
        let changed = mutated(&text, &ways, &mut rng).to_string();
        if let Ok(value) = serde_json::from_str(&changed) {
            ask(value, &changed);
            read += 1;
        }
    }
    read
}

/// Returns two groups, one of which has no boxes because its range is infinite.
pub(super) fn small_scene() -> (Scene, Vec<BodyId>) {
    let group = |k| Group::new(k).unwrap();
    let none = PairQueries::none();
    let mut scene = Scene::new();
    let near = none.overlap(true).distance(0.5).features(true);
    let contacts = none.manifold(ManifoldOptions::default().prediction(0.1)).within(0.2);
    scene.set_queries(group(0), group(0), near).unwrap();
    scene.set_queries(group(0), group(1), contacts).unwrap();
    scene
        .set_queries(group(2), group(2), none.distance(f64::INFINITY))
        .unwrap();
    let cube = Arc::new(solids::cuboid(Vector3::repeat(0.5)).unwrap());
    let at = |k: usize| Isometry3::translation(0.9 * k as f64, 0.1 * k as f64, 0.0);
    let ids = (0..7)
        .map(|k| {
            scene
                .insert(Body::moving(cube.clone()).group(group(k as u8 % 3)), at(k))
                .unwrap()
        })
        .collect::<Vec<_>>();
    scene.step();
    scene.remove(ids[2]).unwrap();
    scene.step();
    (scene, ids)
}

/// Uses all calls around a step: moves, removals, insertions, other groups, queries.
fn use_scene(mut scene: Scene) {
    let shape = Arc::new(solids::octahedron(0.6).unwrap());
    let mut sum = *scene.report();
    for round in 0..2 {
        let ids: Vec<BodyId> = scene.bodies().collect();
        for (k, &id) in ids.iter().enumerate() {
            let _ = match (k + round) % 4 {
                0 => scene.remove(id),
                1 => scene.set_group(id, Group::new(k as u8 % 3).unwrap()),
                _ => scene.set_pose(id, Isometry3::translation(0.3 * k as f64, 0.0, 0.2)),
            };
        }
        let _ = scene.insert(Body::moving(shape.clone()), Isometry3::translation(0.1, 0.2, 0.3));
        sum += *scene.step();
        assert!(scene.pairs().all(|p| p.a != p.b));
        let _ = sum.times.total();
    }
}

#[test]
fn numbers_changed_in_a_file_do_no_harm() {
    let checks = std::panic::catch_unwind(|| std::hint::black_box(u8::MAX) + std::hint::black_box(1));
    assert!(checks.is_err(), "this test is worth little without overflow checks");
    let (a, b) = (solids::icosahedron(1.0).unwrap(), solids::cone(7, 0.55, 0.3).unwrap());
    let (apart, deep) = ([2.0, 0.5, -1.0], [0.1, 0.2, 0.3]);
    let pose = |[x, y, z]: [f64; 3]| RelativePose::from_isometry(&Isometry3::translation(x, y, z)).unwrap();
    for (t, seed) in [(apart, 82), (deep, 83)] {
        let mut pair = Tracker::new();
        pair.closest(&a, &b, &pose(t));
        pair.intersects(&a, &b, &pose(t));
        let read = survives(&pair, 1500, seed, |mut pair, _| {
            bytes::query(&a, &b, &pose(t), &mut pair, 0.5);
            let mut sum = pair.work();
            sum += pair.work();
        });
        assert!(read > 500, "{read}");
    }
    let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    let cube = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let flush = pose([0.3, 0.2, 0.99]);
    let options = ManifoldOptions::default().prediction(0.1);
    pair.manifold(&cube, &cube, &flush, &options, &mut manifold);
    let read = survives(&manifold, 2000, 84, |mut manifold, _| {
        pair.manifold(&cube, &cube, &flush, &options, &mut manifold);
        pair.manifold(&cube, &cube, &pose([0.3, 0.21, 0.99]), &options, &mut manifold);
    });
    assert!(read > 200, "{read}");
    let (scene, _) = small_scene();
    let read = survives(&scene, 4000, 85, |scene, _| use_scene(scene));
    assert!(read > 400, "{read}");
}

fn use_broad(mut broad: SweepAndPrune) {
    let at = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), Vector3::repeat(0.5));
    for round in 0..2 {
        let ids: Vec<_> = broad.bodies().collect();
        for (k, id) in ids.into_iter().enumerate() {
            let _ = if (k + round) % 3 == 0 {
                broad.remove(id)
            } else {
                broad.set_box(id, &at(0.2 * k as f64))
            };
        }
        let _ = broad.insert(&at(0.1), lin_canny::broad::BodyOptions::default());
        broad.step();
    }
}

#[test]
fn numbers_changed_in_the_file_of_a_broad_phase_do_no_harm() {
    fn filled(mut broad: SweepAndPrune) -> SweepAndPrune {
        for k in 0..6 {
            let aabb = Aabb::from_center(Point3::new(0.7 * f64::from(k), 0.0, 0.0), Vector3::repeat(0.5));
            broad.insert(&aabb, lin_canny::broad::BodyOptions::default()).unwrap();
        }
        broad.step();
        broad
    }
    let read = survives(&filled(SweepAndPrune::new()), 1500, 86, |broad, _| use_broad(broad));
    assert!(read > 100, "{read}");
}

/// Counters at their limit stay there. Generations at their limit, and boxes that contradict the
/// queries, are rejected.
#[test]
fn counters_and_generations_at_their_end_do_no_harm() {
    let a = solids::icosahedron(1.0).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::translation(0.1, 0.2, 0.3)).unwrap();
    let mut pair = Tracker::new();
    pair.closest(&a, &a, &pose);
    let text = serde_json::to_value(&pair).unwrap();
    for way in ["queries", "warm", "steps", "depths", "answered"] {
        let mut text = text.clone();
        text["totals"][way] = if way == "answered" {
            json!(vec![u64::MAX; 7])
        } else {
            json!(u64::MAX)
        };
        let mut pair: Tracker = serde_json::from_value(text).unwrap();
        for _ in 0..2 {
            pair.closest(&a, &a, &pose);
            pair.intersects(&a, &a, &pose);
            pair.intersects(&a, &a, &pose);
        }
        assert!(way != "queries" || pair.work().queries == u64::MAX);
    }
    counters_at_their_end(&pose);
    let text = serde_json::to_value(small_scene().0).unwrap();
    assert!(serde_json::from_value::<Scene>(text.clone()).is_ok());
    let changed = |way: &str, to: Value| {
        let mut text = text.clone();
        *text.pointer_mut(way).unwrap() = to;
        serde_json::from_value::<Scene>(text)
    };
    assert!(changed("/rows/1/generation", json!(u32::MAX)).is_err());
    assert!(changed("/rows/2/generation", json!(u32::MAX - 1)).is_err());
    assert!(changed("/rows/1/solid/group", json!(2)).is_err());
    assert!(changed("/rows/1/solid/boxed", json!(false)).is_err());
    assert!(changed("/growths/0", json!(f64::MAX)).is_err());
    assert!(changed("/partners/0", json!(0)).is_err());
}

/// Sets all counters of a value to their limit.
fn at_their_end<T: serde::Serialize + DeserializeOwned>(value: &T) -> T {
    fn set(value: &mut Value, is_counter: bool) {
        match value {
            Value::Number(_) if is_counter => *value = json!(u64::MAX),
            Value::Array(list) => list.iter_mut().for_each(|v| set(v, is_counter)),
            Value::Object(map) => {
                // The work of a single outcome has no `windings`.
                let is_work = |key: &str, v: &Value| key == "work" && v.get("windings").is_some();
                for (key, v) in map {
                    let is_named = ["totals", "counts", "convex", "trees", "surfaces"].contains(&key.as_str());
                    set(v, is_counter || is_named || is_work(key, v));
                    if key == "ticks" {
                        v["now"] = json!(u64::MAX);
                    }
                }
            }
            _ => {}
        }
    }
    let mut text = serde_json::to_value(value).unwrap();
    set(&mut text, false);
    serde_json::from_value(text).unwrap()
}

/// Sets the counters of trackers of every kind, and of a scene at its last tick, to their limit.
fn counters_at_their_end(pose: &RelativePose) {
    let body = solids::icosahedron(1.0).unwrap();
    let (shape, ball) = (Shape::from(body.clone()), Shape::ball(0.3).unwrap());
    let (mesh, pieces) = (Mesh::from_convex(&body).unwrap(), Compound::from(shape.clone()));
    let (mut shapes, mut meshes, mut compounds) = (PairTracker::new(), PairTracker::new(), PairTracker::new());
    for _ in 0..2 {
        for _ in 0..2 {
            shapes.closest(&shape, &ball, pose);
            shapes.closest(&ball, &ball, pose);
            shapes.intersects(&shape, &shape, pose);
            meshes.closest(&mesh, &mesh, pose);
            meshes.intersects(&mesh, &mesh, pose);
            compounds.closest(&pieces, &mesh, pose);
            compounds.intersects(&pieces, &mesh, pose);
        }
        shapes = at_their_end(&shapes);
        (meshes, compounds) = (at_their_end(&meshes), at_their_end(&compounds));
    }
    assert_eq!(shapes.work().convex.queries, u64::MAX);
    assert_eq!(meshes.work().trees.queries, u64::MAX);
    assert_eq!(compounds.work().trees.queries, u64::MAX);
    let (mut scene, ids) = small_scene();
    let velocity = Velocity::new(Vector3::x(), Vector3::z());
    for _ in 0..3 {
        for tick in 0..3 {
            scene.set_velocity(ids[1 + 2 * (tick % 2)], velocity).unwrap();
            scene.advance(1.0 / 60.0).unwrap();
            let sum = *scene.step();
            let mut twice = sum;
            twice += sum;
            assert_eq!(scene.check(), Ok(()));
        }
        scene = at_their_end(&scene);
    }
}
