//! Promise: surfaces of patches stand in scenes beside surfaces and convex shapes; what no tracker answers is refused by name.

use lab::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::patch::{Surface, revolution};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, BodyShape, Effects, Group, Scene, SceneError, ShapeKind};
use lin_canny::{Class, Composite, Feature, Mesh, Piece, Shape, Velocity};

const ALL: Group = Group::new(0).unwrap();
const NONE: Effects = Effects::none();
const D: f64 = 0.2;

fn sphere(r: f64) -> Surface {
    let half = 0.5_f64.sqrt();
    let south: &[[f64; 3]] = &[[0.0, -r, 1.0], [r, -r, half], [r, 0.0, 1.0]];
    let north: &[[f64; 3]] = &[[r, 0.0, 1.0], [r, r, half], [0.0, r, 1.0]];
    revolution(&[south, north]).unwrap()
}

/// Bodies that are all round, with their radii; surfaces and shapes take turns.
fn round_bodies(scene: &mut Scene, rng: &mut Rng) -> Vec<(BodyId, f64, bool)> {
    let shells = [0.3, 0.4].map(|r| BodyShape::from(sphere(r)));
    let mut bodies = Vec::new();
    for k in 0..24 {
        let r = if k / 2 % 2 == 0 { 0.3 } else { 0.4 };
        let is_surface = k % 2 == 0;
        let shape = if is_surface {
            shells[k / 2 % 2].clone()
        } else {
            Shape::ball(r).unwrap().into()
        };
        let at = Isometry3::new(Vector3::from(rng.in_ball()) * 2.0, Vector3::from(rng.unit()));
        bodies.push((scene.insert(Body::moving(shape), at).unwrap(), r, is_surface));
    }
    bodies
}

/// The distance of two round bodies, zero if they share a point; that of two shells in each other, too.
fn truth(scene: &Scene, (a, r, a_is): (BodyId, f64, bool), (b, s, b_is): (BodyId, f64, bool)) -> f64 {
    let (p, q) = (scene.pose(a).unwrap(), scene.pose(b).unwrap());
    let apart = (p.translation.vector - q.translation.vector).norm();
    let outside = apart - r - s;
    // The one that lies in the other is apart if the outer one is a shell.
    let within_a = if a_is { r - s - apart } else { 0.0 };
    let within_b = if b_is { s - r - apart } else { 0.0 };
    outside.max(within_a).max(within_b).max(0.0)
}

#[test]
fn a_scene_of_shells_and_balls_is_that_of_brute_force() {
    let mut rng = Rng::new(51);
    let mut scene = Scene::new();
    let effects = Effects {
        overlap: true,
        within: Some(D),
        distance: Some(0.5),
        features: true,
        ..NONE
    };
    scene.call_for(ALL, ALL, effects).unwrap();
    let bodies = round_bodies(&mut scene, &mut rng);
    let (mut overlapping, mut within, mut measured) = (0, 0, 0);
    for _ in 0..10 {
        for (id, ..) in &bodies {
            let mut at = *scene.pose(*id).unwrap();
            at.translation.vector += Vector3::from(rng.in_ball()) * 0.1;
            scene.set_pose(*id, at).unwrap();
        }
        scene.step();
        for (k, x) in bodies.iter().enumerate() {
            for y in &bodies[k + 1..] {
                let truth = truth(&scene, *x, *y);
                let found = scene.pair(x.0, y.0);
                let overlaps = found.as_ref().and_then(|p| p.overlaps) == Some(true);
                let is_within = found.as_ref().and_then(|p| p.within) == Some(true);
                assert_eq!(overlaps, truth == 0.0, "{truth} {found:?}");
                assert_eq!(is_within, truth <= D, "{truth} {found:?}");
                overlapping += u32::from(overlaps);
                within += u32::from(is_within);
                if truth <= 0.5 {
                    measured += 1;
                    let o = found.as_ref().and_then(|p| p.outcome).expect("measured");
                    if truth > 0.0 {
                        assert_eq!(o.class, Class::Separated, "{truth} {o:?}");
                        assert!(o.lower <= truth + 1e-14 && truth <= o.upper + 1e-14, "{truth} {o:?}");
                        assert!(o.upper - o.lower < 1e-8, "{truth} {o:?}");
                    }
                    let names = if x.0 < y.0 {
                        [o.features.a, o.features.b]
                    } else {
                        [o.features.b, o.features.a]
                    };
                    let is_face = |f: Feature| matches!(f, Feature::Face(_));
                    assert!(!x.2 || is_face(names[0]), "{o:?}");
                    assert!(!y.2 || is_face(names[1]), "{o:?}");
                }
            }
        }
    }
    println!("{overlapping} overlap, {within} within, {measured} measured");
    assert!(overlapping > 50 && within > 100 && measured > 200);
}

#[test]
fn impacts_of_surfaces_are_found() {
    let mut scene = Scene::new();
    let effects = Effects {
        impact: Some(lin_canny::impact::Tolerance::Distance(1e-5)),
        ..NONE
    };
    scene.call_for(ALL, ALL, effects).unwrap();
    let wall = scene.insert(Body::moving(sphere(0.5)), Isometry3::identity()).unwrap();
    let shapes: [BodyShape; 2] = [sphere(0.25).into(), Shape::ball(0.25).unwrap().into()];
    let mut ids = Vec::new();
    for (k, shape) in shapes.into_iter().enumerate() {
        let side = if k == 0 { 1.0 } else { -1.0 };
        let id = scene
            .insert(Body::moving(shape), Isometry3::translation(3.0 * side, 0.0, 0.0))
            .unwrap();
        let speed = Velocity::new(Vector3::new(-30.0 * side, 0.0, 0.0), Vector3::z());
        scene.set_velocity(id, speed).unwrap();
        ids.push(id);
    }
    scene.advance(0.1).unwrap();
    scene.step();
    let impacts = scene.impacts();
    assert!(impacts.len() >= 2, "{impacts:?}");
    for id in ids {
        let found = impacts
            .iter()
            .find(|i| (i.a, i.b) == (wall, id) || (i.a, i.b) == (id, wall))
            .expect("an impact");
        assert!((found.safe() - 2.25 / 30.0).abs() < 1e-4, "{found:?}");
    }
}

/// Two balls as one body beside a shell, inserted before the shell and after.
#[test]
fn bodies_of_pieces_stand_beside_surfaces() {
    let ball = |x: f64| Piece {
        pose: Isometry3::translation(x, 0.0, 0.0),
        ..Piece::new(Shape::ball(0.25).unwrap())
    };
    let made = |effects: Effects, is_first: bool| {
        let mut scene = Scene::new();
        scene.call_for(ALL, ALL, effects).unwrap();
        let dumbbell: BodyShape = Composite::new(vec![ball(-1.0), ball(1.0)]).unwrap().into();
        let at = Isometry3::translation(3.0, 0.0, 0.0);
        let shell: (BodyShape, _) = (sphere(0.5).into(), Isometry3::identity());
        let mut bodies = vec![(dumbbell, at), shell];
        if !is_first {
            bodies.reverse();
        }
        let mut insert = |(shape, at): (BodyShape, _)| scene.insert(Body::moving(shape), at).unwrap();
        let ids: Vec<_> = bodies.into_iter().map(&mut insert).collect();
        (scene, ids)
    };
    for is_first in [true, false] {
        let distance = Some(10.0);
        let (mut scene, ids) = made(Effects { distance, ..NONE }, is_first);
        scene.step();
        let pair = scene.pair(ids[0], ids[1]).expect("a pair");
        let distance = pair.distance.expect("a distance");
        assert!(
            (distance.value - 1.25).abs() < 1e-8 && distance.lower <= 1.25,
            "{distance:?}"
        );
        let impact = Some(lin_canny::impact::Tolerance::Distance(1e-5));
        let (mut scene, ids) = made(Effects { impact, ..NONE }, is_first);
        let flight = Velocity::new(Vector3::new(-30.0, 0.0, 0.0), Vector3::zeros());
        scene.set_velocity(ids[usize::from(!is_first)], flight).unwrap();
        scene.advance(0.1).unwrap();
        scene.step();
        let found = scene.impacts().first().expect("an impact");
        assert!((found.safe() - 1.25 / 30.0).abs() < 1e-5, "{found:?}");
    }
}

#[test]
fn what_no_tracker_answers_is_refused() {
    let at = Isometry3::identity();
    let call = |effects: Effects| {
        let mut scene = Scene::new();
        scene.call_for(ALL, ALL, effects).unwrap();
        scene.insert(Body::moving(sphere(0.5)), at).unwrap();
        scene
    };
    let refusal = |effect: &'static str, these| {
        Err(SceneError::Unanswered {
            effect,
            these,
            those: ShapeKind::Surface,
        })
    };
    let die = || solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let mut scene = call(Effects {
        within: Some(D),
        ..NONE
    });
    let mesh = Mesh::from_convex(&die()).unwrap();
    assert_eq!(
        scene.insert(Body::moving(mesh.clone()), at),
        refusal("within", ShapeKind::Mesh)
    );
    scene
        .insert(Body::moving(Surface::from_mesh(&mesh).unwrap()), at)
        .unwrap();
    scene.insert(Body::moving(die()), at).unwrap();
    let mut scene = call(Effects { depth: true, ..NONE });
    assert_eq!(
        scene.insert(Body::moving(die()), at),
        refusal("depth", ShapeKind::Polyhedron)
    );
    let refused = scene.insert(Body::moving(sphere(0.5)), at);
    assert_eq!(refused, refusal("depth", ShapeKind::Surface));
    assert_eq!(
        refused.unwrap_err().to_string(),
        "no depth is computed between a surface of patches and a surface of patches"
    );
}
