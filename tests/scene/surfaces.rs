//! Promise: scenes support Bézier surfaces with surfaces and convex shapes; unsupported queries are
//! rejected with a named error.

use crate::{ALL, NONE, read_back};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, PairQueries, Scene, SceneError};
use lin_canny::{Compound, ContactState, Feature, Geometry, GeometryKind, Mesh, Shape, Velocity};
use truth::forms::sphere;
use truth::rng::Rng;
use truth::support::piece_at;

const D: f64 = 0.2;
const FAR: f64 = 0.5;

/// Returns round bodies with their radii, alternately surfaces and shapes.
fn round_bodies(scene: &mut Scene, rng: &mut Rng, count: usize) -> Vec<(BodyId, f64, bool)> {
    let shells = [0.3, 0.4].map(|r| Geometry::from(sphere(r)));
    let mut bodies = Vec::new();
    for k in 0..count {
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

/// Returns the distance of two round bodies, zero if they share a point; also of a shell inside
/// another.
fn truth(scene: &Scene, (a, r, a_is): (BodyId, f64, bool), (b, s, b_is): (BodyId, f64, bool)) -> f64 {
    let (p, q) = (scene.pose(a).unwrap(), scene.pose(b).unwrap());
    let apart = (p.translation.vector - q.translation.vector).norm();
    let outside = apart - r - s;
    // A body inside another is separated from it if the outer one is a shell.
    let within_a = if a_is { r - s - apart } else { 0.0 };
    let within_b = if b_is { s - r - apart } else { 0.0 };
    outside.max(within_a).max(within_b).max(0.0)
}

/// Numbers of pairs that overlapped, were within the distance, and were measured.
#[derive(Debug, Default)]
struct Seen {
    overlapping: u32,
    within: u32,
    measured: u32,
}

impl Seen {
    /// Asserts that the results of a step are those of brute force.
    fn judge(&mut self, scene: &Scene, bodies: &[(BodyId, f64, bool)]) {
        for (k, x) in bodies.iter().enumerate() {
            for y in &bodies[k + 1..] {
                let truth = truth(scene, *x, *y);
                let found = scene.pair(x.0, y.0);
                let overlaps = found.as_ref().and_then(|p| p.overlaps) == Some(true);
                let is_within = found.as_ref().and_then(|p| p.within) == Some(true);
                assert_eq!(overlaps, truth == 0.0, "{truth} {found:?}");
                assert_eq!(is_within, truth <= D, "{truth} {found:?}");
                self.overlapping += u32::from(overlaps);
                self.within += u32::from(is_within);
                if truth <= FAR {
                    self.measured += 1;
                    let o = found.as_ref().and_then(|p| p.outcome).expect("measured");
                    if truth > 0.0 {
                        assert_eq!(o.state, ContactState::Separated, "{truth} {o:?}");
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
}

#[test]
fn a_scene_of_shells_and_balls_is_that_of_brute_force() {
    let mut rng = Rng::new(51);
    let mut scene = Scene::new();
    let queries = NONE.overlap(true).within(D).distance(FAR).features(true);
    scene.set_queries(ALL, ALL, queries).unwrap();
    let bodies = round_bodies(&mut scene, &mut rng, 24);
    let mut seen = Seen::default();
    for _ in 0..10 {
        for (id, ..) in &bodies {
            let mut at = *scene.pose(*id).unwrap();
            at.translation.vector += Vector3::from(rng.in_ball()) * 0.1;
            scene.set_pose(*id, at).unwrap();
        }
        scene.step();
        seen.judge(&scene, &bodies);
    }
    println!("{seen:?}");
    assert!(seen.overlapping > 50 && seen.within > 100 && seen.measured > 200);
}

/// Returns the velocity of a body in the next tick: it falls and is thrown back; from tick 40 to
/// tick 50 all bodies rest.
fn next(scene: &Scene, id: BodyId, tick: usize) -> Velocity {
    let (mut v, at) = (scene.velocity(id).unwrap(), scene.pose(id).unwrap().translation.vector);
    if (40..50).contains(&tick) {
        return Velocity::default();
    }
    v.linear.z -= 9.81 / 60.0;
    for k in 0..3 {
        if at[k].abs() > 0.9 && at[k] * v.linear[k] > 0.0 {
            v.linear[k] *= -0.9;
        }
    }
    v
}

/// Shells and balls under gravity, a third of them at rest from the start.
///
/// Of three scenes, one queries everything in every tick, one uses its defaults, and one is saved
/// and read back between `advance` and `step`.
#[test]
fn shells_fall_and_rest_and_are_read_back_in_the_middle_of_a_tick() {
    let mut scenes: Vec<Scene> = (0..3).map(|_| Scene::new()).collect();
    let queries = NONE.overlap(true).within(D).distance(FAR).features(true);
    let mut bodies = Vec::new();
    for (k, scene) in scenes.iter_mut().enumerate() {
        scene.set_queries(ALL, ALL, queries).unwrap();
        scene.set_schedule(k != 0);
        scene.set_budget(k != 0);
        let mut rng = Rng::new(52);
        bodies = round_bodies(scene, &mut rng, 12);
        for (id, ..) in bodies.iter().skip(1).step_by(3).chain(bodies.iter().skip(2).step_by(3)) {
            let way = Vector3::from(rng.in_ball()) * 3.0;
            scene
                .set_velocity(*id, Velocity::new(way, Vector3::from(rng.in_ball())))
                .unwrap();
        }
    }
    let (mut seen, mut events) = (Seen::default(), 0);
    for tick in 0..60 {
        for scene in &mut scenes {
            for (_, (id, ..)) in bodies.iter().enumerate().filter(|(k, _)| k % 3 != 0) {
                scene.set_velocity(*id, next(scene, *id, tick)).unwrap();
            }
            scene.advance(1.0 / 60.0).unwrap();
        }
        if tick % 4 == 1 {
            scenes[2] = read_back(&scenes[2]);
        }
        for scene in &mut scenes {
            scene.step();
            seen.judge(scene, &bodies);
            events += scene.events().len();
        }
        assert_eq!(scenes[0].events(), scenes[1].events(), "tick {tick}");
        assert_eq!(scenes[1].events(), scenes[2].events(), "tick {tick}");
    }
    println!("{seen:?}, {events} events");
    assert!(seen.overlapping > 100 && seen.within > 200 && events > 100);
}

#[test]
fn impacts_of_surfaces_are_found() {
    let mut scene = Scene::new();
    let queries = NONE.impact(lin_canny::impact::Tolerance::Distance(1e-5));
    scene.set_queries(ALL, ALL, queries).unwrap();
    let wall = scene.insert(Body::moving(sphere(0.5)), Isometry3::identity()).unwrap();
    let shapes: [Geometry; 2] = [sphere(0.25).into(), Shape::ball(0.25).unwrap().into()];
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

/// Two balls as one body next to a shell, inserted before the shell and after it.
#[test]
fn bodies_of_pieces_stand_beside_surfaces() {
    let ball = |x: f64| piece_at(Isometry3::translation(x, 0.0, 0.0), Shape::ball(0.25).unwrap());
    let made = |queries: PairQueries, is_first: bool| {
        let mut scene = Scene::new();
        scene.set_queries(ALL, ALL, queries).unwrap();
        let dumbbell: Geometry = Compound::new(vec![ball(-1.0), ball(1.0)]).unwrap().into();
        let at = Isometry3::translation(3.0, 0.0, 0.0);
        let shell: (Geometry, _) = (sphere(0.5).into(), Isometry3::identity());
        let mut bodies = vec![(dumbbell, at), shell];
        if !is_first {
            bodies.reverse();
        }
        let mut insert = |(shape, at): (Geometry, _)| scene.insert(Body::moving(shape), at).unwrap();
        let ids: Vec<_> = bodies.into_iter().map(&mut insert).collect();
        (scene, ids)
    };
    for is_first in [true, false] {
        let (mut scene, ids) = made(NONE.distance(10.0), is_first);
        scene.step();
        let pair = scene.pair(ids[0], ids[1]).expect("a pair");
        let distance = pair.distance.expect("a distance");
        assert!((distance.value - 1.25).abs() < 1e-8, "{distance:?}");
        assert!(distance.lower <= 1.25, "{distance:?}");
        let impact = lin_canny::impact::Tolerance::Distance(1e-5);
        let (mut scene, ids) = made(NONE.impact(impact), is_first);
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
    let call = |queries: PairQueries| {
        let mut scene = Scene::new();
        scene.set_queries(ALL, ALL, queries).unwrap();
        scene.insert(Body::moving(sphere(0.5)), at).unwrap();
        scene
    };
    let refusal = |query: &'static str, these| {
        Err(SceneError::Unanswered {
            query,
            these,
            those: GeometryKind::BezierSurface,
        })
    };
    let die = || solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let mut scene = call(NONE.within(D));
    let mesh = Mesh::from_convex(&die()).unwrap();
    scene.insert(Body::moving(mesh.clone()), at).unwrap();
    scene.insert(Body::moving(die()), at).unwrap();
    let mut scene = call(NONE.depth(true));
    let found = scene.insert(Body::moving(die()), at);
    assert_eq!(found, refusal("depth", GeometryKind::Polyhedron));
    let refused = scene.insert(Body::moving(sphere(0.5)), at);
    assert_eq!(refused, refusal("depth", GeometryKind::BezierSurface));
    assert_eq!(
        refused.unwrap_err().to_string(),
        "the query depth does not exist between a Bézier surface and a Bézier surface"
    );
    let mut scene = call(NONE.local_depth(true));
    let bodies = [
        (Body::moving(mesh), GeometryKind::Mesh),
        (Body::moving(die()), GeometryKind::Polyhedron),
        (Body::moving(sphere(0.5)), GeometryKind::BezierSurface),
    ];
    for (body, kind) in bodies {
        assert_eq!(scene.insert(body, at), refusal("local_depth", kind));
    }
}
