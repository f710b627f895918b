//! Promise: a scene returns correct results for any calls in any order.

use crate::{NONE, group, read_back};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, Group, PairQueries, Scene, SceneError};
use lin_canny::{ContactState, ManifoldOptions, Mesh, RelativePose, Tracker, Velocity};
use std::sync::Arc;
use truth::driven::scenes;
use truth::driven::scenes::Mix;
use truth::rng::Rng;
use truth::shapes;
use truth::support::body;
use truth::tally::{Tally, is_whole, tenth};

/// The bytes of a generator reach every case.
#[test]
fn any_calls_in_any_order_give_what_is_true() {
    let mut mix = Mix::default();
    for seed in 0..tenth(240) as u64 {
        let mut rng = Rng::of_case(77, seed);
        let mut bytes: Vec<u8> = (0..1500).map(|_| rng.bits() as u8).collect();
        // The kinds in turn: kinds with many queries are rare.
        bytes[0] = [0, 1, 0, 2, 1, 0, 3][seed as usize % 7];
        // Velocities and ticks of half a second in one world of three: bodies meet within a tick.
        if seed % 3 == 0 {
            (bytes[1], bytes[2]) = (0, 2);
        }
        mix.add(&scenes::drive(&bytes, read_back));
    }
    if !is_whole() {
        return;
    }
    assert!(mix.steps > 2500 && mix.refused > 5 && mix.reused > 100, "{mix:?}");
    assert!(mix.ticks.iter().chain(&mix.saved).all(|n| *n > 500), "{mix:?}");
    assert!(mix.late > 500, "{mix:?}");
    assert!(mix.overlapping.iter().all(|n| *n > 50) && mix.within > 100, "{mix:?}");
    assert!(mix.distances[1] > 200, "{mix:?}");
    assert!(mix.events > 300, "{mix:?}");
    assert!(mix.impacts.iter().chain(&mix.fixed).all(|n| *n > 10), "{mix:?}");
    assert!(mix.rays.iter().chain(&mix.searches).all(|n| *n > 100), "{mix:?}");
    assert!(mix.slept.iter().all(|n| *n > 50), "{mix:?}");
}

/// A scene that was read had a cold tracker of two surfaces, whose cast within a distance was open
/// where the warm one found no impact.
#[test]
fn cold_and_warm_trackers_of_surfaces_report_the_same_impacts() {
    let mut rng = Rng::new(16_393_487_589_486_275_151);
    let bytes: Vec<u8> = (0..1500).map(|_| rng.bits() as u8).collect();
    assert!(scenes::drive(&bytes, read_back).steps > 0);
}

#[test]
fn questions_on_top_equal_brute_force() {
    let mut rng = Rng::new(5);
    let (g, h) = (group(0), group(1));
    let mut scene = Scene::new();
    for (x, y) in [(g, g), (g, h)] {
        scene.set_queries(x, y, NONE.boxes(true)).unwrap();
    }
    let shapes = [body(&shapes::icosahedron()), body(&shapes::cuboid([0.9, 0.3, 0.1]))].map(Arc::new);
    for k in 0..60 {
        let (q, t) = (rng.quat(), [0; 3].map(|_| rng.range(-6.0, 6.0)));
        let shape = shapes[k % 2].clone();
        let made = if k % 3 == 0 {
            Body::fixed(shape)
        } else {
            Body::moving(shape)
        };
        scene
            .insert(made.group(group(k as u8 / 2 % 2)), truth::Pose::new(q, t).isometry())
            .unwrap();
    }
    scene.step();
    let ids: Vec<BodyId> = scene.bodies().collect();
    let fixed = |id: BodyId| id.index.is_multiple_of(3);
    let measure = |a: BodyId, b: BodyId| {
        let pose = RelativePose::new(scene.pose(a).unwrap(), scene.pose(b).unwrap()).unwrap();
        Tracker::new().closest(
            scene.geometry(a).and_then(|s| s.as_polyhedron()).unwrap(),
            scene.geometry(b).and_then(|s| s.as_polyhedron()).unwrap(),
            &pose,
        )
    };
    let pairs = |of: Group, with: Group| {
        let one = |a: &BodyId| scene.group(*a) == Some(of);
        let other = |b: &BodyId| scene.group(*b) == Some(with);
        let mut all = vec![];
        for &a in ids.iter().filter(|a| one(a)) {
            for &b in ids.iter().filter(|b| other(b)) {
                if a != b && !(fixed(a) && fixed(b)) && (of != with || a < b) {
                    all.push((a, b));
                }
            }
        }
        all
    };
    let mut found = 0;
    for (x, y) in [(g, g), (g, h), (h, g)] {
        for d in [0.0, 0.2, 1.5] {
            let near = scene.pairs_within(x, y, d).unwrap();
            let expected: Vec<_> = pairs(x, y)
                .into_iter()
                .filter(|&(a, b)| measure(a, b).lower <= d)
                .collect();
            assert_eq!(near.iter().map(|n| (n.a, n.b)).collect::<Vec<_>>(), expected);
            for n in &near {
                let truth = measure(n.a, n.b);
                assert!(
                    n.outcome.state == ContactState::Overlapping
                        || n.outcome.lower <= truth.upper && truth.lower <= n.outcome.upper
                );
            }
            found += near.len();
        }
        let first = scene.any_contact(x, y).unwrap().map(|n| (n.a, n.b));
        assert_eq!(
            first,
            pairs(x, y).into_iter().find(|&(a, b)| measure(a, b).lower <= 0.0)
        );
    }
    assert!(found > 100, "{found}");
    for &id in &ids {
        let may = |b: &&BodyId| {
            **b != id && !(fixed(id) && fixed(**b)) && !(scene.group(id) == Some(h) && scene.group(**b) == Some(h))
        };
        let mut all: Vec<_> = ids
            .iter()
            .filter(may)
            .map(|b| (measure(id, *b).distance.max(0.0), *b))
            .collect();
        all.sort_by(|x, y| x.partial_cmp(y).unwrap());
        for (k, farthest) in [(1, f64::INFINITY), (5, 2.0), (100, f64::INFINITY), (0, 1.0)] {
            let near = scene.nearest(id, k, farthest).unwrap();
            let expected: Vec<_> = all.iter().filter(|x| x.0 <= farthest).take(k).collect();
            assert_eq!(near.len(), expected.len());
            for (n, e) in near.iter().zip(expected) {
                assert!(n.b == e.1 && (n.outcome.distance - e.0).abs() < 1e-12, "{n:?} {e:?}");
            }
        }
    }
}

#[test]
fn odd_scales_and_places_lose_nothing() {
    // Tiny bodies that creep, far from the origin in one scene; huge ones in another.
    for (size, offset) in [(1e-60, 0.0), (1e-3, 1e5), (1e30, 0.0)] {
        let g = Group::default();
        let mut scene = Scene::new();
        scene.set_queries(g, g, NONE.overlap(true)).unwrap();
        let shape = Arc::new(solids::cuboid(Vector3::repeat(0.5 * size)).unwrap());
        let at = |x: f64| Isometry3::translation(offset + x * size, offset, 0.0);
        scene.insert(Body::fixed(shape.clone()), at(0.0)).unwrap();
        let b = scene.insert(Body::moving(shape), at(1.1)).unwrap();
        scene.step();
        let mut events = vec![];
        for k in 0..300 {
            let x = 1.1 - 0.2 * (f64::from(k) * 0.05).sin();
            scene.set_pose(b, at(x)).unwrap();
            scene.step();
            let pose = RelativePose::new(&at(0.0), scene.pose(b).unwrap()).unwrap();
            let overlaps = Tracker::new().intersects(
                scene.geometry(b).and_then(|s| s.as_polyhedron()).unwrap(),
                scene.geometry(b).and_then(|s| s.as_polyhedron()).unwrap(),
                &pose,
            );
            for e in scene.events() {
                events.push(e.change);
            }
            assert_eq!(events.len() % 2 == 1, overlaps, "{size:e} {k}");
        }
        assert!(events.len() >= 4, "{events:?}");
    }
}

/// Rotation alone: the closest points of a rod next to a wall are at rest while its ends sweep in.
#[test]
fn spinning_bodies_are_looked_at_in_time() {
    let g = Group::default();
    let wall = Arc::new(solids::cuboid(Vector3::new(5.0, 0.5, 5.0)).unwrap());
    let rod = Arc::new(solids::cuboid(Vector3::new(1.0, 0.01, 0.01)).unwrap());
    let axes = [
        Vector3::z(),
        Vector3::new(0.6, 0.0, 0.8),
        Vector3::new(0.36, 0.48, -0.8),
    ];
    // Rotated, so that the boxes overlap long before the bodies are near.
    let frame = Isometry3::rotation(Vector3::new(0.4, 0.3, 0.7));
    let (mut events, mut skipped) = (0, 0);
    for (k, axis) in axes.iter().enumerate() {
        for gap in [0.001, 0.01, 0.1, 0.5] {
            for rate in [1e-4, 0.003, 0.05, 0.7] {
                let mut scene = Scene::new();
                let queries = NONE.overlap(k != 1).within(0.02);
                scene.set_queries(g, g, queries).unwrap();
                scene.insert(Body::fixed(wall.clone()), frame).unwrap();
                let at = frame * Isometry3::translation(0.0, 0.51 + gap, 0.0);
                let id = scene.insert(Body::moving(rod.clone()), at).unwrap();
                scene
                    .set_velocity(id, Velocity::new(Vector3::zeros(), frame * axis))
                    .unwrap();
                let mut within = false;
                for _ in 0..1000 {
                    scene.advance(rate).unwrap();
                    skipped += scene.step().counts.skipped;
                    for e in scene.events() {
                        within ^= matches!(e.change, Change::CameWithin | Change::LeftWithin);
                        events += 1;
                    }
                    let pose = RelativePose::new(&frame, scene.pose(id).unwrap()).unwrap();
                    assert_eq!(within, Tracker::new().within(&wall, &rod, &pose, 0.02), "{gap} {rate}");
                }
            }
        }
    }
    assert!(events > 1000 && skipped > 3000, "{events} {skipped}");
}

/// Returns poses of two separated cubes whose boxes overlap: where the second is, and where it
/// overlaps the first.
fn places() -> [Isometry3<f64>; 2] {
    let turned = |x: f64| Isometry3::new(Vector3::new(x, x, 0.0), Vector3::z() * std::f64::consts::FRAC_PI_4);
    [turned(1.0), turned(0.5)]
}

fn pair_of_cubes(queries: PairQueries) -> (Scene, [BodyId; 3]) {
    let mut scene = Scene::with_queries(queries).unwrap();
    let cube = Arc::new(solids::cuboid(Vector3::repeat(0.5)).unwrap());
    let far = Isometry3::translation(0.0, 0.0, 1e3);
    let ids = [Isometry3::identity(), places()[0], far].map(|at| scene.insert(Body::moving(cube.clone()), at).unwrap());
    (scene, ids)
}

/// Ticks pass, calls alone move bodies, and velocities are never set, set for a distant body, or
/// set and reset.
#[test]
fn a_jump_wakes_a_pair_whatever_velocities_were_set() {
    let speed = Velocity::new(Vector3::z(), Vector3::zeros());
    for (thrown, when) in [
        (None, 0),
        (Some(2), 0),
        (Some(2), 10),
        (Some(2), 30),
        (Some(1), 0),
        (Some(0), 10),
    ] {
        for (is_late, is_scheduled) in [(true, true), (false, true), (true, false)] {
            let (mut scene, ids) = pair_of_cubes(NONE.overlap(true));
            scene.set_schedule(is_scheduled);
            let mut events = Vec::new();
            for frame in 0..60 {
                if let (Some(k), 0) = (thrown, frame - when) {
                    scene.set_velocity(ids[k], speed).unwrap();
                    let back = if k == 2 { speed } else { Velocity::default() };
                    scene.set_velocity(ids[k], back).unwrap();
                }
                let to = places()[usize::from((20..40).contains(&frame))];
                if is_late {
                    scene.advance(1.0 / 60.0).unwrap();
                }
                scene.set_pose(ids[1], to).unwrap();
                if !is_late {
                    scene.advance(1.0 / 60.0).unwrap();
                }
                scene.step();
                assert_eq!(scene.check(), Ok(()));
                events.extend(scene.events().iter().map(|e| (frame, e.change)));
            }
            let expected = [(20, Change::OverlapBegan), (40, Change::OverlapEnded)];
            assert_eq!(events, expected, "{thrown:?} {when} {is_late} {is_scheduled}");
        }
    }
}

#[test]
fn a_tick_in_which_all_bodies_rest_ends_with_its_step() {
    let queries = NONE.boxes(true).impact(Tolerance::Distance(1e-6));
    for rest in 0..4 {
        let (mut scene, ids) = pair_of_cubes(queries);
        let away = Velocity::new(Vector3::new(3.0, 3.0, 0.0), Vector3::zeros());
        let mut met = 0;
        for tick in 0..12 {
            let velocity = if tick < rest { away } else { Velocity::default() };
            scene.set_velocity(ids[1], velocity).unwrap();
            scene.advance(0.1).unwrap();
            assert_eq!(scene.advance(0.1), Err(SceneError::StepDue));
            scene.step();
            met += scene.events().iter().filter(|e| e.change == Change::BoxesMet).count();
            met -= scene
                .events()
                .iter()
                .filter(|e| e.change == Change::BoxesParted)
                .count();
            // The box of a body at rest contains no swept motion.
            assert_eq!(met == 1, rest == 0 || tick == 0, "{rest} {tick}");
            assert_eq!(scene.check(), Ok(()));
        }
    }
}

/// A tick that moves nothing still records the start of a jump, also in a scene that was read back.
#[test]
#[cfg(feature = "serde")]
fn a_scene_read_back_within_a_tick_goes_on_alike() {
    let impact = Some(Tolerance::Distance(1e-6));
    for (is_thrown, is_swept) in [(false, true), (true, true), (false, false), (true, false)] {
        let mut queries = NONE.boxes(true);
        queries.impact = impact.filter(|_| is_swept);
        let (mut scene, ids) = pair_of_cubes(queries);
        if is_thrown {
            let speed = Velocity::new(Vector3::x(), Vector3::zeros());
            scene.set_velocity(ids[2], speed).unwrap();
        }
        let mut parted = [0; 2];
        for frame in 0..6 {
            scene.advance(0.1).unwrap();
            let mut other = read_back(&scene);
            let to = Isometry3::translation(if frame % 2 == 0 { 9.0 } else { 0.8 }, 0.0, 0.0);
            for scene in [&mut scene, &mut other] {
                scene.set_pose(ids[1], to).unwrap();
                scene.step();
                assert_eq!(scene.check(), Ok(()));
            }
            assert_eq!(scene.events(), other.events());
            parted[usize::from(frame > 0)] += scene.events().len();
        }
        assert_eq!(parted, if is_swept { [1, 0] } else { [0, 5] });
    }
}

/// At any speed, the odometer of a body stays finite, and its scene can be saved and read.
#[test]
fn no_speed_spoils_a_scene() {
    let impact = Some(Tolerance::Distance(1e-6));
    for (spin, speed, time) in [
        (1e120, 0.0, 1e-3),
        (1e150, 0.0, 1e-3),
        (1e99, 0.0, 1e60),
        (3.0, 1e120, 1e-120),
    ] {
        for impact in [impact, None] {
            let mut queries = NONE.overlap(true);
            queries.impact = impact;
            let (mut scene, ids) = pair_of_cubes(queries);
            let velocity = Velocity::new(Vector3::x() * speed, Vector3::z() * spin);
            scene.set_velocity(ids[1], velocity).unwrap();
            for _ in 0..3 {
                scene.advance(time).unwrap();
                scene.step();
                assert_eq!(scene.check(), Ok(()));
                scene = read_back(&scene);
            }
            // The accumulated odometer still lets the pair sleep.
            scene.set_velocity(ids[1], Velocity::default()).unwrap();
            let mut skipped = 0;
            for k in 0..9 {
                let shift = Vector3::new(0.1 + 0.01 * f64::from(k), 0.1, 0.0);
                let at = Isometry3::from_parts((places()[0].translation.vector + shift).into(), places()[0].rotation);
                scene.set_pose(ids[1], at).unwrap();
                skipped += scene.step().counts.skipped;
            }
            assert!(skipped > 4, "{spin} {speed} {time}: {skipped}");
        }
    }
}

/// Contacts of meshes stay with the tracker of the pair, which persists if another query is
/// enabled.
#[test]
fn contacts_end_when_they_are_no_longer_called_for() {
    let g = group(0);
    let mut scene = Scene::new();
    let manifold = ManifoldOptions::default().prediction(0.1);
    scene.set_queries(g, g, NONE.manifold(manifold)).unwrap();
    let mesh = Mesh::from_convex(&solids::icosahedron(0.6).unwrap()).unwrap();
    let cube = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let a = scene.insert(Body::moving(mesh), Isometry3::identity()).unwrap();
    let b = scene.insert(Body::moving(cube), Isometry3::translation(1.0, 0.0, 0.0));
    let b = b.unwrap();
    scene.step();
    assert!(scene.pair(a, b).unwrap().contacts.is_some());
    for queries in [
        NONE.distance(f64::INFINITY),
        NONE.features(true).distance(f64::INFINITY),
        NONE.overlap(true),
    ] {
        scene.set_queries(g, g, queries).unwrap();
        scene.step();
        assert!(scene.pair(a, b).unwrap().contacts.is_none(), "{queries:?}");
    }
}
