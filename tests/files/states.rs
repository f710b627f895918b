//! Numbers of stored states are changed, one at a time, to numbers that no query would make
//! (feature `serde`). What can be read answers queries, and every bound is judged by exact
//! arithmetic: no stored number may become a false answer.
#![cfg(feature = "serde")]

use ciborium::Value;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Geometry, Manifold, ManifoldOptions, Mesh, PairTracker, Piece,
    RelativePose, Shape, Tracker, Velocity,
};
use serde::{Serialize, de::DeserializeOwned};
use std::sync::Arc;
use truth::rng::Rng;

/// Calls a function with each number of a value.
fn each_number(value: &mut Value, call: &mut impl FnMut(&mut Value)) {
    match value {
        Value::Integer(_) | Value::Float(_) => call(value),
        Value::Array(items) => items.iter_mut().for_each(|item| each_number(item, call)),
        Value::Map(entries) => entries.iter_mut().for_each(|(_, item)| each_number(item, call)),
        _ => {}
    }
}

/// Returns what a number is changed to.
fn hostile(number: &Value) -> Vec<Value> {
    match number {
        Value::Integer(n) => {
            let n = i128::from(*n);
            let others = [0, 1, n + 1, n ^ 4, i128::from(u32::MAX), i128::from(u64::MAX)];
            others
                .into_iter()
                .filter_map(|n| Some(Value::Integer(n.try_into().ok()?)))
                .collect()
        }
        Value::Float(x) => {
            let far = [
                1e300,
                -1e300,
                0.0,
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                1.0,
                -1.0,
            ];
            let near = [
                x + 0.25,
                x - 0.25,
                -x,
                x * 1.001,
                x * 0.999,
                x * (1.0 + 1e-9),
                x * (1.0 - 1e-9),
            ];
            far.into_iter().chain(near).map(Value::Float).collect()
        }
        _ => Vec::new(),
    }
}

/// Changes single numbers of a value, at most `most` times, and judges what can be read. Returns
/// how many could and could not be read.
fn changed<T: Serialize + DeserializeOwned>(value: &T, most: usize, mut judge: impl FnMut(T, &str)) -> [usize; 2] {
    let stored = Value::serialized(value).expect("serialises");
    let mut changes = Vec::new();
    let mut count = 0;
    each_number(&mut stored.clone(), &mut |number| {
        changes.extend(hostile(number).into_iter().map(|to| (count, to)));
        count += 1;
    });
    let step = changes.len().div_ceil(most).max(1);
    let mut counts = [0; 2];
    // The step has no common factor with the numbers of changes of a number.
    for (at, to) in changes.iter().step_by(step | 1) {
        let (mut text, mut k) = (stored.clone(), 0);
        each_number(&mut text, &mut |number| {
            if k == *at {
                *number = to.clone();
            }
            k += 1;
        });
        match text.deserialized::<T>() {
            Ok(read) => {
                judge(read, &format!("number {at} changed to {to:?}"));
                counts[0] += 1;
            }
            Err(_) => counts[1] += 1,
        }
    }
    counts
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

fn relative(pose: &Isometry3<f64>) -> RelativePose {
    RelativePose::from_isometry(pose).expect("a pose")
}

/// Returns an interval that contains the signed distance: a unit in the last place if the bodies
/// are apart.
fn truth(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> [f64; 2] {
    let exact = Tracker::new().closest_exact(a, b, pose);
    if exact.state == ContactState::Separated {
        return [exact.distance.next_down(), exact.distance.next_up()];
    }
    let found = Tracker::new().closest(a, b, pose);
    [found.lower, found.upper]
}

/// Asserts that an interval may contain the distance.
fn holds([lower, upper]: [f64; 2], truth: [f64; 2], what: &str) {
    assert!(lower <= truth[1], "{what}: [{lower}, {upper}] for {truth:?}");
    assert!(upper >= truth[0], "{what}: [{lower}, {upper}] for {truth:?}");
}

/// Poses that start where a state was stored and end elsewhere.
fn poses(first: [f64; 3]) -> Vec<Isometry3<f64>> {
    let [x, y, z] = first;
    let turned = |angle: f64| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    vec![
        at(x, y, z),
        at(x, y + 1e-5, z),
        at(x + 0.01, y, z - 1e-3),
        Isometry3::from_parts(Translation3::new(x, y, z + 0.02), turned(0.3)),
        at(x, y, z + 0.5),
        at(x, y, z),
    ]
}

#[test]
fn a_manifold_that_was_read_answers_no_stored_bound() {
    let cube = solids::cuboid(Vector3::repeat(0.5)).expect("a body");
    let other = solids::prism(30, 0.4, 0.8).expect("a body");
    let options = ManifoldOptions::default().prediction(0.1);
    let mut sums = [0; 2];
    for (b, first) in [
        (&cube, [0.3, 0.2, 0.99]),
        (&cube, [0.1, 0.2, 1.4]),
        (&cube, [0.1, 0.2, 1.05]),
        (&other, [0.0, 0.1, 0.95]),
    ] {
        let (mut tracker, mut manifold) = (Tracker::new(), Manifold::new());
        for pose in &poses(first)[..2] {
            tracker.manifold(&cube, b, &relative(pose), &options, &mut manifold);
        }
        let counts = changed(&manifold, 1500, |mut manifold: Manifold, what| {
            for pose in poses(first) {
                let pose = relative(&pose);
                let truth = truth(&cube, b, &pose);
                // Before the first query there are no bounds.
                holds([manifold.lower(), manifold.upper()], [truth[0], truth[1]], what);
                Tracker::new().manifold(&cube, b, &pose, &options, &mut manifold);
                holds([manifold.lower(), manifold.upper()], truth, what);
                let mut fresh = Manifold::new();
                Tracker::new().manifold(&cube, b, &pose, &options, &mut fresh);
                let deepest = |m: &Manifold| m.deepest().map_or(f64::NAN, |p| p.separation);
                assert_eq!(manifold.points().is_empty(), fresh.points().is_empty(), "{what}");
                assert!(!((deepest(&manifold) - deepest(&fresh)).abs() > 1e-2), "{what}");
                manifold = Value::serialized(&manifold)
                    .and_then(|v| v.deserialized())
                    .expect("reads");
                assert!(manifold.lower() == f64::NEG_INFINITY, "{what}");
                assert!(manifold.upper() == f64::INFINITY, "{what}");
            }
        });
        (0..2).for_each(|k| sums[k] += counts[k]);
    }
    assert!(sums[0] > 500, "{sums:?}");
}

#[test]
fn a_tracker_that_was_read_answers_as_a_new_one() {
    let (a, b) = (
        solids::icosahedron(1.0).expect("a body"),
        solids::cone(7, 0.55, 0.3).expect("a body"),
    );
    let mut sums = [0; 2];
    for first in [[2.0, 0.5, -1.0], [0.1, 0.2, 0.3], [1.2, 0.1, 0.0]] {
        let mut tracker = Tracker::new();
        tracker.closest(&a, &b, &relative(&at(first[0] + 1e-3, first[1], first[2])));
        tracker.closest(&a, &b, &relative(&at(first[0], first[1], first[2])));
        tracker.intersects(&a, &b, &relative(&at(first[0], first[1], first[2])));
        let counts = changed(&tracker, 1500, |mut tracker: Tracker, what| {
            for pose in poses(first) {
                let pose = relative(&pose);
                let found = tracker.closest(&a, &b, &pose);
                holds([found.lower, found.upper], truth(&a, &b, &pose), what);
                let meets = Tracker::new().intersects(&a, &b, &pose);
                assert_eq!(tracker.intersects(&a, &b, &pose), meets, "{what}");
                let local = tracker.closest_with_local_depth(&a, &b, &pose);
                holds([local.lower, local.upper], truth(&a, &b, &pose), what);
            }
        });
        (0..2).for_each(|k| sums[k] += counts[k]);
    }
    assert!(sums[0] > 500, "{sums:?}");
}

#[test]
fn a_pair_tracker_that_was_read_answers_as_a_new_one() {
    let body = solids::icosahedron(1.0).expect("a body");
    let kinds: [Geometry; 3] = [
        body.clone().into(),
        Shape::cylinder(0.7, 0.5).expect("a shape").into(),
        Mesh::from_convex(&body).expect("a mesh").into(),
    ];
    for g in &kinds {
        for h in &kinds {
            let pose = relative(&at(1.9, 0.3, 0.1));
            let mut tracker = PairTracker::new();
            let wanted = tracker.closest(g, h, &pose);
            let counts = changed(&tracker, 60, |mut tracker: PairTracker, what| {
                let found = tracker.closest(g, h, &pose);
                holds([found.lower, found.upper], [wanted.lower, wanted.upper], what);
                assert_eq!(found.state, wanted.state, "{what}");
            });
            assert!(counts[0] > 10, "{counts:?}");
        }
    }
}

/// A geometry that was read is that of its own points.
#[test]
fn geometries_that_were_read_are_those_of_their_points() {
    let body = solids::icosahedron(1.0).expect("a body");
    let mesh = Mesh::from_convex(&body).expect("a mesh");
    let pose = relative(&at(1.9, 0.3, 0.1));
    let counts = changed(&mesh, 600, |read: Mesh, what| {
        let points: Vec<Point3<f64>> = read.triangles().flat_map(|(_, corners)| corners).collect();
        let indices: Vec<[u32; 3]> = (0..points.len() as u32).step_by(3).map(|t| [t, t + 1, t + 2]).collect();
        let same = Mesh::new(&points, &indices).expect("the points of a mesh");
        let [x, y] = [&read, &same].map(|m| PairTracker::new().closest(m, &body, &pose));
        holds([x.lower, x.upper], [y.lower, y.upper], what);
        assert_eq!(x.state, y.state, "{what}");
    });
    assert!(counts[0] > 50, "{counts:?}");
    let counts = changed(&body, 600, |read: ConvexPolyhedron, what| {
        let points: Vec<Point3<f64>> = read.vertex_points().collect();
        let same = ConvexPolyhedron::from_points(&points).expect("the points of a body");
        holds(truth(&read, &body, &pose), truth(&same, &body, &pose), what);
    });
    assert!(counts[0] > 50, "{counts:?}");
    let mut piece = Piece::new(body.clone());
    piece.pose = at(0.5, 0.0, 0.0);
    let counts = changed(
        &Compound::new(vec![piece]).expect("a compound"),
        300,
        |read: Compound, what| {
            let same = Compound::new(read.pieces().to_vec()).unwrap_or_else(|e| panic!("{what}: {e}: {read:?}"));
            let [x, y] = [&read, &same].map(|c| PairTracker::new().closest(c, &body, &pose));
            holds([x.lower, x.upper], [y.lower, y.upper], what);
        },
    );
    assert!(counts[0] > 20, "{counts:?}");
}

const NEAR: f64 = 0.2;

/// Returns a scene in which pairs of every level of detail rest, move, sleep and keep contacts.
fn scene() -> Scene {
    let none = PairQueries::none();
    let queries = [
        none.overlap(true).boxes(true),
        none.overlap(true).within(NEAR),
        none.distance(0.6).overlap(true),
        none.distance(0.6).features(true).depth(true).overlap(true),
        none.manifold(ManifoldOptions::default().prediction(0.1)).overlap(true),
    ];
    let mut scene = Scene::new();
    let group = |k: usize| Group::new(k as u8).expect("a group");
    let cube = Arc::new(solids::cuboid(Vector3::repeat(0.5)).expect("a body"));
    let other = Arc::new(solids::icosahedron(0.6).expect("a body"));
    let mut ids = Vec::new();
    for (k, queries) in queries.into_iter().enumerate() {
        scene.set_queries(group(k), group(k), queries).expect("queries");
        for (i, x) in [0.0, 0.99, 2.1, 3.4].into_iter().enumerate() {
            let body = if i == 2 { other.clone() } else { cube.clone() };
            let pose = at(x, 0.1 * i as f64, 4.0 * k as f64);
            ids.push(scene.insert(Body::moving(body).group(group(k)), pose).expect("a body"));
        }
    }
    scene.step();
    for (k, &id) in ids.iter().enumerate() {
        if k % 4 == 3 {
            scene
                .set_velocity(id, Velocity::new(Vector3::new(-0.1, 0.0, 0.0), Vector3::z() * 0.1))
                .expect("moves");
        } else if k % 4 == 1 {
            let mut pose = *scene.pose(id).expect("a body");
            pose.translation.x += 1e-5;
            scene.set_pose(id, pose).expect("a pose");
        }
    }
    for _ in 0..2 {
        scene.advance(0.01).expect("a tick");
        scene.step();
    }
    scene
}

/// Judges all answers of a scene at the poses of its bodies.
fn judge_scene(scene: &Scene, what: &str) -> usize {
    let mut judged = 0;
    for pair in scene.pairs() {
        let ids = [pair.a, pair.b];
        let [Some(x), Some(y)] = ids.map(|id| scene.pose(id)) else {
            continue;
        };
        let [Some(a), Some(b)] = ids.map(|id| scene.geometry(id).and_then(Geometry::as_polyhedron)) else {
            continue;
        };
        let pose = RelativePose::new(x, y).expect("a pose");
        let truth = truth(a, b, &pose);
        if let Some(overlaps) = pair.overlaps {
            assert_eq!(overlaps, Tracker::new().intersects(a, b, &pose), "{what}: {ids:?}");
            judged += 1;
        }
        if let (Some(within), true) = (pair.within, what.is_empty()) {
            assert_eq!(within, Tracker::new().within(a, b, &pose, NEAR), "{what}: {ids:?}");
        }
        if let Some(d) = pair.distance {
            holds([d.lower, d.upper], truth, what);
            judged += 1;
        }
        if let Some(m) = pair.manifold {
            holds([m.lower(), m.upper()], truth, what);
        }
    }
    judged
}

/// Moves bodies towards and through each other, and judges the scene after each step.
fn use_scene(mut scene: Scene, what: &str) -> usize {
    let mut judged = judge_scene(&scene, what);
    let ids: Vec<BodyId> = scene.bodies().collect();
    for round in 0..4 {
        if round % 2 == 0 {
            let _ = scene.advance(0.01);
        }
        for (k, &id) in ids.iter().enumerate() {
            if k % 4 == round % 4 && round > 0 {
                let mut pose = *scene.pose(id).expect("a body");
                pose.translation.x -= [0.0, 1e-4, 0.05, 0.6][round];
                let _ = scene.set_pose(id, pose);
            }
        }
        scene.step();
        judged += judge_scene(&scene, what);
    }
    judged
}

/// Changes single numbers of a scene, saved after a step and between calls and a step.
fn scenes(most: usize) {
    let after_step = scene();
    let mut judged = use_scene(after_step.clone(), "");
    let mut before_step = after_step.clone();
    before_step.advance(0.01).expect("a tick");
    for id in before_step.bodies().step_by(5).collect::<Vec<_>>() {
        let mut pose = *before_step.pose(id).expect("a body");
        pose.translation.x -= 0.3;
        before_step.set_pose(id, pose).expect("a pose");
    }
    for (known, is_stepped) in [(after_step, true), (before_step, false)] {
        let read: Scene = Value::serialized(&known).and_then(|v| v.deserialized()).expect("reads");
        let read = use_scene(read, "");
        assert!(read == judged || !is_stepped);
        judged = read;
        let (mut least, mut sum) = (usize::MAX, 0);
        let counts = changed(&known, most, |scene: Scene, what| {
            let judged = use_scene(scene, what);
            least = least.min(judged);
            sum += judged;
        });
        println!("{counts:?}, {least} to {judged} answers");
        assert!(counts[0] > most.min(10_000) / 10, "{counts:?} {sum}");
        assert!(sum > counts[0] * judged / 3, "{counts:?} {sum}");
    }
}

/// A text claims a bound of a depth that no query asks, so the query proves none.
#[test]
fn bounds_that_a_query_leaves_open_are_not_believed() {
    let known = scene();
    let stored = Value::serialized(&known).expect("serialises");
    // A bound of minus infinity is stored as the least number.
    let is_open = |number: &Value| matches!(number, Value::Float(x) if *x == f64::MIN);
    let mut count = 0;
    each_number(&mut stored.clone(), &mut |number| count += usize::from(is_open(number)));
    assert!(count > 0);
    for (at, claimed) in (0..count).flat_map(|at| [(at, 0.0), (at, -1e-9)]) {
        let (mut text, mut k) = (stored.clone(), 0);
        each_number(&mut text, &mut |number| {
            if is_open(number) {
                if k == at {
                    *number = Value::Float(claimed);
                }
                k += 1;
            }
        });
        if let Ok(read) = text.deserialized::<Scene>() {
            use_scene(read, &format!("open number {at} changed to {claimed}"));
        }
    }
}

#[test]
fn a_scene_that_was_read_has_no_false_answer() {
    scenes(600);
}

#[test]
#[ignore = "minutes: cargo test --release --all-features --test files every_number_of_a_scene -- --ignored"]
fn every_number_of_a_scene_is_changed() {
    scenes(usize::MAX);
}

/// Motions are read as the numbers say, or refused: no derived number is believed.
#[test]
fn motions_that_were_read_follow_their_numbers() {
    use lin_canny::motion::{Motion, Steady};
    let mut rng = Rng::new(7);
    let from = Isometry3::new(Vector3::from(rng.in_ball()), Vector3::from(rng.in_ball()));
    let steady = Steady::new(&from, Velocity::new(Vector3::x(), Vector3::z())).expect("a motion");
    let counts = changed(&steady, usize::MAX, |read: Steady, what| {
        let pose = read.pose(0.25);
        assert!((pose.rotation.norm() - 1.0).abs() < 1e-9, "{what}");
        assert!(pose.translation.vector.iter().all(|x| x.is_finite()), "{what}");
        let again: Steady = Value::serialized(&read).and_then(|v| v.deserialized()).expect("reads");
        assert_eq!(again.pose(0.25), pose, "{what}");
    });
    assert!(counts[0] > 10, "{counts:?}");
}
