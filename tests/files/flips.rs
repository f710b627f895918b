//! Each number of a saved scene is changed once (feature `serde`).
//!
//! A scene that can be read passes its check and takes a step. Otherwise the error states the
//! reason.
#![cfg(feature = "serde")]

use super::hostile::{numbers, small_scene};
use lin_canny::Velocity;
use lin_canny::broad::{Aabb, BodyOptions, SweepAndPrune};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::scene::{Group, PairQueries, Scene};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::{Value, json};

/// Returns the replacements of a number.
fn others(number: &Value) -> Vec<Value> {
    match (number.as_u64(), number.as_f64()) {
        (Some(0), _) => vec![json!(1), json!(2), json!(7)],
        (Some(n), _) => vec![json!(n - 1), json!(n + 1), json!(n ^ 4)],
        (_, Some(x)) => vec![json!(x + 0.75), json!(-x - 0.3), json!(2.0 * x)],
        _ => Vec::new(),
    }
}

/// Replaces each number once by each replacement, and checks what can be read. Returns how many
/// could and could not be read.
fn flipped<T: Serialize + DeserializeOwned>(value: &T, mut check: impl FnMut(T) -> Result<(), String>) -> [usize; 2] {
    let text = serde_json::to_value(value).unwrap();
    let mut ways = Vec::new();
    numbers(&text, "", &mut ways);
    let mut counts = [0; 2];
    for way in &ways {
        for other in others(text.pointer(way).unwrap()) {
            let mut changed = text.clone();
            *changed.pointer_mut(way).unwrap() = other.clone();
            match serde_json::from_value::<T>(changed) {
                Ok(read) => {
                    assert_eq!(check(read), Ok(()), "{way} changed to {other}");
                    counts[0] += 1;
                }
                Err(e) => {
                    assert!(e.to_string().len() > 12, "{way}: {e}");
                    counts[1] += 1;
                }
            }
        }
    }
    counts
}

/// Returns a scene between a tick and its step, with velocities, a removed body, an excluded pair,
/// and moved bodies without queries.
fn busy_scene() -> Scene {
    let (mut scene, ids) = small_scene();
    let impact = PairQueries::none().overlap(true).impact(Tolerance::Distance(1e-6));
    let all = Group::default();
    scene.set_queries(all, all, impact).unwrap();
    let id = ids[4];
    scene.set_group(id, Group::new(5).unwrap()).unwrap();
    scene.exclude_pair(ids[0], ids[3]).unwrap();
    scene.step();
    scene.set_pose(id, Isometry3::translation(0.3, 4.0, 0.0)).unwrap();
    scene.step();
    scene.remove(ids[1]).unwrap();
    let velocity = Velocity::new(Vector3::x() * 3.0, Vector3::z());
    scene.set_velocity(ids[3], velocity).unwrap();
    scene.advance(0.1).unwrap();
    scene
}

#[test]
fn a_scene_with_one_number_changed_is_refused_or_sound() {
    let after_step = small_scene().0;
    for scene in [after_step, busy_scene()] {
        assert_eq!(scene.check(), Ok(()));
        let counts = flipped(&scene, |mut read: Scene| {
            read.check()?;
            read.step();
            Ok(())
        });
        std::println!("{counts:?}");
        assert!(counts.iter().all(|n| *n > 300), "{counts:?}");
    }
}

#[test]
fn a_broad_phase_with_one_number_changed_is_refused_or_sound() {
    fn filled(mut broad: SweepAndPrune) -> SweepAndPrune {
        let at = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), Vector3::repeat(0.5));
        let ids: Vec<_> = (0..6)
            .map(|k| broad.insert(&at(0.7 * f64::from(k)), BodyOptions::default()).unwrap())
            .collect();
        broad
            .insert_unbounded(&Aabb::everything(), BodyOptions::default().fixed(true))
            .unwrap();
        broad.step();
        broad.remove(ids[2]).unwrap();
        broad.set_box(ids[4], &at(0.1)).unwrap();
        broad
    }
    fn checked(mut broad: SweepAndPrune) -> Result<(), String> {
        broad.check()?;
        broad.step();
        Ok(())
    }
    let counts = flipped(&filled(SweepAndPrune::new()), checked);
    assert!(counts.iter().all(|n| *n > 20), "{counts:?}");
}
