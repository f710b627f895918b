//! First times between two steps at which bodies come within a distance.

use crate::{ALL, NONE, read_back};
use lin_canny::impact::{Impact, Tolerance};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, PairImpact, PairQueries, Scene, SceneError, StepWork};
use lin_canny::{RelativePose, Shape, Tracker, Velocity};
use truth::forms::forms;
use truth::rng::Rng;

const BRACKET: Tolerance = Tolerance::Distance(1e-9);
const TICK: f64 = 1.0 / 60.0;

/// A ball that flies past a block, 30 mm above it, from far on one side to far on the other within
/// a tick.
fn fly_by(queries: PairQueries) -> Scene {
    let mut scene = Scene::with_queries(queries).unwrap();
    let block = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    scene.insert(Body::fixed(block), Isometry3::identity()).unwrap();
    let ball = Body::moving(Shape::ball(0.1).unwrap());
    let ball = scene.insert(ball, Isometry3::translation(-5.0, 0.63, 0.0)).unwrap();
    let velocity = Velocity::new(Vector3::x() * 600.0, Vector3::zeros());
    scene.set_velocity(ball, velocity).unwrap();
    scene.step();
    scene.advance(TICK).unwrap();
    scene.step();
    scene
}

#[test]
fn bodies_that_come_near_between_steps_are_found() {
    let near = NONE.within(0.05);
    let scene = fly_by(near.impact(BRACKET));
    assert!(scene.events().is_empty() && scene.impacts().is_empty());
    let scene = fly_by(near.impact(BRACKET).impact_within(0.05, BRACKET));
    assert!(scene.events().is_empty());
    let [found] = scene.impacts() else {
        panic!("{:?}", scene.impacts())
    };
    assert_eq!(found.distance, 0.05);
    let Impact::Hit { safe, hit, .. } = found.impact else {
        panic!("{found:?}")
    };
    let met = (5.0 - 0.5 - (0.15f64.powi(2) - 0.13f64.powi(2)).sqrt()) / 600.0;
    assert!(safe <= met + 1e-15, "{safe} {met} {hit}");
    assert!(met <= hit, "{safe} {met} {hit}");
    assert!(hit - safe < 1e-9, "{safe} {met} {hit}");
    // The distance of the flight is 0.03.
    assert!(fly_by(NONE.impact_within(0.0299, BRACKET)).impacts().is_empty());
    assert_eq!(fly_by(NONE.impact_within(0.0301, BRACKET)).impacts().len(), 1);
}

#[test]
fn distances_and_widths_out_of_range_are_refused() {
    let mut scene = Scene::new();
    for (d, width) in [
        (-0.1, 0.0),
        (f64::NAN, 0.0),
        (f64::INFINITY, 0.0),
        (0.1, -1.0),
        (0.1, f64::NAN),
    ] {
        for by in [Tolerance::Distance(width), Tolerance::Time(width)] {
            let refused = scene.set_queries(ALL, ALL, NONE.impact_within(d, by));
            assert!(matches!(refused, Err(SceneError::Range { .. })), "{d} {width}");
        }
    }
    // A step is due after each tick, as for `impact`.
    scene.set_queries(ALL, ALL, NONE.impact_within(0.1, BRACKET)).unwrap();
    scene.advance(TICK).unwrap();
    assert_eq!(scene.advance(TICK), Err(SceneError::StepDue));
}

/// Bodies of every kind, thrown about in scenes with different queries and equal calls.
struct Play {
    scenes: Vec<Scene>,
    ids: Vec<BodyId>,
    rng: Rng,
}

impl Play {
    fn new(kind: usize, seed: u64, queries: &[PairQueries]) -> Self {
        let mut rng = Rng::of_case(seed, kind as u64);
        let mut scenes: Vec<_> = queries.iter().map(|q| Scene::with_queries(*q).unwrap()).collect();
        let shapes = forms(kind);
        let mut ids = Vec::new();
        for k in 0..10 {
            let shape = &shapes[k % shapes.len()].0;
            let pose = Isometry3::new(Vector3::from(rng.in_ball()) * 2.0, Vector3::from(rng.unit()));
            let body = if k == 9 { Body::fixed } else { Body::moving };
            let all = scenes
                .iter_mut()
                .map(|scene| scene.insert(body(shape.clone()), pose).unwrap());
            ids.push(all.last().unwrap());
        }
        Self { scenes, ids, rng }
    }

    fn step(&mut self) {
        let rng = &mut self.rng;
        for &id in &self.ids[..9] {
            let pose = Isometry3::new(Vector3::from(rng.in_ball()) * 2.0, Vector3::from(rng.unit()));
            let speed = rng.log_range(1.0, 100.0);
            let velocity = Velocity::new(Vector3::from(rng.in_ball()) * speed, Vector3::from(rng.unit()) * 5.0);
            let (jumps, turns) = (rng.chance(0.3), rng.chance(0.4));
            for scene in &mut self.scenes {
                if jumps {
                    scene.set_pose(id, pose).unwrap();
                }
                if turns || jumps {
                    scene.set_velocity(id, velocity).unwrap();
                }
            }
        }
        for scene in &mut self.scenes {
            scene.advance(TICK).unwrap();
            scene.step();
        }
    }
}

#[test]
fn distance_zero_is_contact_bit_for_bit() {
    let mut impacts = 0;
    for kind in 0..4 {
        let queries = NONE.overlap(true).within(0.2);
        let mut play = Play::new(
            kind,
            71,
            &[queries.impact(BRACKET), queries.impact_within(0.0, BRACKET)],
        );
        for round in 0..60 {
            play.step();
            let [one, other] = &play.scenes[..] else { unreachable!() };
            assert_eq!(one.impacts(), other.impacts());
            assert_eq!(one.events(), other.events());
            assert_eq!(one.report().counts, other.report().counts);
            impacts += one.impacts().len();
            if round == 30 {
                play.scenes[1] = read_back(&play.scenes[1]);
                play.scenes[0] = read_back(&play.scenes[0]);
            }
        }
    }
    assert!(impacts > 40, "{impacts}");
}

/// Contact and distance in one query give what each gives alone.
#[test]
fn contact_and_distance_do_not_disturb_each_other() {
    let (mut counts, mut found) = ([StepWork::default(); 3], [0; 2]);
    for kind in 0..4 {
        let contact = NONE.impact(BRACKET);
        let (near, both) = (NONE.impact_within(0.2, BRACKET), contact.impact_within(0.2, BRACKET));
        let mut play = Play::new(kind, 72, &[contact, near, both, NONE.overlap(true).within(0.2)]);
        for _ in 0..60 {
            play.step();
            let [contact, near, both, plain] = &play.scenes[..] else {
                unreachable!()
            };
            let said = |impacts: &[PairImpact], d: f64| -> Vec<(BodyId, BodyId)> {
                let those = impacts.iter().filter(|i| i.distance == d);
                let mut those: Vec<_> = those.map(|i| (i.a, i.b)).collect();
                those.sort_unstable();
                those
            };
            assert_eq!(said(contact.impacts(), 0.0), said(both.impacts(), 0.0));
            assert_eq!(said(near.impacts(), 0.2), said(both.impacts(), 0.2));
            // A body that meets another comes near it before, unless it is near at the start.
            let is_sorted = |x: &PairImpact, y: &PairImpact| x.safe() <= y.safe();
            assert!(both.impacts().is_sorted_by(is_sorted));
            let sum = plain.report().counts;
            assert_eq!((sum.casts, sum.impacts), (0, 0));
            for (all, scene) in counts.iter_mut().zip([contact, near, both]) {
                *all += scene.report().counts;
            }
            found[0] += contact.impacts().len();
            found[1] += near.impacts().len();
        }
    }
    let [contact, near, both] = &counts;
    println!(
        "{found:?} impacts, {} {} {} casts",
        contact.casts, near.casts, both.casts
    );
    assert!(found[0] > 30 && found[1] > found[0], "{found:?}");
    assert!(contact.casts < both.casts && near.casts < both.casts);
}

/// Brackets against the exact predicate of polyhedra at many instants.
#[test]
fn brackets_are_never_late() {
    let (mut hits, mut sampled) = (0, 0);
    for seed in 0..6 {
        let mut play = Play::new(0, 80 + seed, &[NONE.impact_within(0.15, BRACKET)]);
        for _ in 0..40 {
            // The motions of the tick are those before it; `step` sets them first.
            play.step();
            let scene = &play.scenes[0];
            for impact in scene.impacts() {
                let Impact::Hit { safe, hit, .. } = impact.impact else {
                    continue;
                };
                let start = |id: BodyId| {
                    let (end, v) = (scene.pose(id).unwrap(), scene.velocity(id).unwrap());
                    (v, v.applied(end, -TICK))
                };
                let [(v, p), (w, q)] = [impact.a, impact.b].map(start);
                let body = |id| scene.geometry(id).unwrap().as_polyhedron().unwrap();
                let is_near = |t: f64, d: f64| {
                    let pose = RelativePose::new(&v.applied(&p, t), &w.applied(&q, t)).unwrap();
                    Tracker::new().within(body(impact.a), body(impact.b), &pose, d)
                };
                hits += 1;
                // Poses before the tick are computed back, so they round.
                assert!(is_near(hit, 0.15 + 1e-9));
                for k in 0..=20 {
                    sampled += 1;
                    assert!(!is_near(safe * f64::from(k) / 20.0, 0.15 - 1e-9), "{impact:?}");
                }
            }
        }
    }
    assert!(hits > 60, "{hits} hits, {sampled} instants");
}

#[cfg(feature = "serde")]
#[test]
fn impacts_of_old_files_are_of_contact() {
    let queries = NONE.impact(BRACKET);
    let mut scene = Scene::with_queries(queries).unwrap();
    let block = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    scene.insert(Body::fixed(block.clone()), Isometry3::identity()).unwrap();
    let moving = scene
        .insert(Body::moving(block), Isometry3::translation(-5.0, 0.0, 0.0))
        .unwrap();
    let velocity = Velocity::new(Vector3::x() * 600.0, Vector3::zeros());
    scene.set_velocity(moving, velocity).unwrap();
    scene.advance(TICK).unwrap();
    scene.step();
    let mut old = serde_json::to_value(&scene).unwrap();
    assert!(crate::assembly::of_old(&mut old) > 5);
    let read: Scene = serde_json::from_value(old).unwrap();
    assert!(scene.impacts().len() == 1 && read.impacts() == scene.impacts());
}
