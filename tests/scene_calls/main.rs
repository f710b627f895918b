//! Promise: whatever is called in whatever order, a scene says what is true.

mod play;
#[path = "../support/mod.rs"]
mod support;

use lab::rng::Rng;
use lab::shapes;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, Effects, Group, Scene};
use lin_canny::{Class, RelativePose, Tracker, Velocity};
use play::Play;
use std::sync::Arc;
use support::body;

const NONE: Effects = Effects::none();

fn group(k: usize) -> Group {
    Group::new(k as u8).unwrap()
}

#[test]
fn any_calls_in_any_order_give_what_is_true() {
    let mut seen = [0; 4];
    for seed in 0..8 {
        let mut play = Play::new(seed);
        for _ in 0..150 {
            for _ in 0..play.rng.below(6) {
                play.call();
            }
            for (sum, n) in seen.iter_mut().zip(play.step()) {
                *sum += n;
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 500), "{seen:?}");
}

#[test]
fn questions_on_top_equal_brute_force() {
    let mut rng = Rng::new(5);
    let (g, h) = (group(0), group(1));
    let mut scene = Scene::new();
    for (x, y) in [(g, g), (g, h)] {
        scene.call_for(x, y, Effects { boxes: true, ..NONE }).unwrap();
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
            .insert(made.group(group(k / 2 % 2)), lab::Pose { q, t }.isometry())
            .unwrap();
    }
    scene.step();
    let ids: Vec<BodyId> = scene.bodies().collect();
    let fixed = |id: BodyId| id.index.is_multiple_of(3);
    let measure = |a: BodyId, b: BodyId| {
        let pose = RelativePose::new(scene.pose(a).unwrap(), scene.pose(b).unwrap()).unwrap();
        Tracker::new().closest(
            scene.shape(a).and_then(|s| s.as_polyhedron()).unwrap(),
            scene.shape(b).and_then(|s| s.as_polyhedron()).unwrap(),
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
                    n.outcome.class == Class::Overlapping
                        || n.outcome.lower <= truth.upper && truth.lower <= n.outcome.upper
                );
            }
            found += near.len();
        }
        let first = scene.first_contact(x, y).unwrap().map(|n| (n.a, n.b));
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
        scene.call_for(g, g, Effects { overlap: true, ..NONE }).unwrap();
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
                scene.shape(b).and_then(|s| s.as_polyhedron()).unwrap(),
                scene.shape(b).and_then(|s| s.as_polyhedron()).unwrap(),
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

/// Turning alone: the closest points of a rod beside a wall stand still while its ends sweep in.
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
    // Turned, so that the boxes overlap long before the bodies are near.
    let frame = Isometry3::rotation(Vector3::new(0.4, 0.3, 0.7));
    let (mut events, mut skipped) = (0, 0);
    for (k, axis) in axes.iter().enumerate() {
        for gap in [0.001, 0.01, 0.1, 0.5] {
            for rate in [1e-4, 0.003, 0.05, 0.7] {
                let mut scene = Scene::new();
                let effects = Effects {
                    overlap: k != 1,
                    within: Some(0.02),
                    ..NONE
                };
                scene.call_for(g, g, effects).unwrap();
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
