//! Scenes of cuboids and balls in metres, where parry's contacts are right: worlds end under our dispatcher as under parry's.
//!
//! Balls beside balls and cuboids have parry's closed forms under either, so all bits are equal. Two cuboids have as many contacts
//! as our manifold finds, which need not be parry's: there the outcome is compared.

use super::bodies::Told;
use super::engine::rapier::prelude::*;
use super::engine::{CertifiedDispatcher, certified_world};
use super::stage;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Engine {
    Parry,
    Ours,
}

fn built<T>(engine: Engine, fill: impl Fn(&mut PhysicsWorld) -> T) -> (PhysicsWorld, T) {
    let mut world = certified_world(CertifiedDispatcher::default(), 1.0, 1.0 / 60.0);
    world.gravity = Vector::Y * -9.81;
    if engine == Engine::Parry {
        world.narrow_phase = NarrowPhase::new();
    }
    let made = fill(&mut world);
    (world, made)
}

/// All bits of poses and velocities, and who sleeps.
fn state(world: &PhysicsWorld) -> Vec<(Vec<u64>, bool)> {
    let of = |b: &RigidBody| {
        let lists = [b.translation(), b.linvel(), b.angvel()].map(|v| v.to_array());
        let numbers = lists.concat().into_iter().chain(b.rotation().to_array());
        (numbers.map(|x| f64::from(x).to_bits()).collect(), b.is_sleeping())
    };
    world.bodies.iter().map(|(_, b)| of(b)).collect()
}

/// Steps a scene under both and compares all bits on the way; returns the world at the end.
fn equal<T>(name: &str, steps: usize, fill: impl Fn(&mut PhysicsWorld) -> T) -> (PhysicsWorld, T) {
    let ((mut parry, _), (mut ours, made)) = (built(Engine::Parry, &fill), built(Engine::Ours, &fill));
    for step in 0..steps {
        parry.step();
        ours.step();
        if step % 20 == 0 || step + 1 == steps {
            assert_eq!(state(&parry), state(&ours), "{name}, step {step}");
        }
    }
    (ours, made)
}

#[test]
fn bullets_end_where_they_end_under_parry() {
    let (world, balls) = equal("bullets", 120, |w| stage::bullets(w, 6));
    for ball in balls {
        let x = world.bodies[ball].translation().x;
        assert!(x < 0.0, "a ball passed the wall: {x}");
    }
}

#[test]
fn balls_bounce_as_high_as_under_parry() {
    let (mut world, balls) = equal("restitution", 60, |w| stage::bounces(w, 10));
    let mut highest = vec![0.0; balls.len()];
    for _ in 0..120 {
        world.step();
        for (ball, highest) in balls.iter().zip(&mut highest) {
            *highest = world.bodies[*ball].translation().y.max(*highest);
        }
    }
    assert!(highest.is_sorted(), "by restitution: {highest:?}");
    assert!(highest[9] > 2.0 * highest[0], "{highest:?}");
}

#[test]
fn balls_ride_platforms_as_under_parry() {
    equal("platforms", 120, |w| stage::platforms(w, 10, &SharedShape::ball(0.35)));
}

#[test]
fn sensors_tell_what_they_tell_under_parry() {
    let run = |engine| {
        let (mut world, (balls, sensors)) = built(engine, |w| stage::sensors(w, 5));
        let told: Vec<_> = (0..120)
            .map(|_| {
                let told = Told::default();
                world.step_with_events(&(), &told);
                told.0.into_inner().expect("one thread")
            })
            .collect();
        let count = told.iter().flatten().count();
        assert_eq!(count, 2 * balls.len(), "every ball enters a sensor and leaves it");
        assert_eq!(sensors.len(), balls.len());
        (told, state(&world))
    };
    assert_eq!(run(Engine::Parry), run(Engine::Ours));
}

fn up(world: &PhysicsWorld, body: RigidBodyHandle) -> Real {
    (world.bodies[body].rotation() * Vector::Y).y
}

/// Returns for each domino the step at which it had fallen by 45 degrees, and where it lies at the end.
fn fallen(engine: Engine) -> (Vec<usize>, Vec<[Real; 2]>) {
    let (mut world, dominoes) = built(engine, |w| stage::dominoes(w, 30));
    let mut when = vec![usize::MAX; dominoes.len()];
    for step in 0..420 {
        world.step();
        for (domino, when) in dominoes.iter().zip(&mut when) {
            if up(&world, *domino) < std::f64::consts::FRAC_1_SQRT_2 as Real {
                *when = step.min(*when);
            }
        }
    }
    let at = |d: &RigidBodyHandle| [world.bodies[*d].translation().x, up(&world, *d)];
    assert!(dominoes.iter().all(|d| world.bodies[*d].is_sleeping()), "{engine:?}");
    (when, dominoes.iter().map(at).collect())
}

#[test]
fn dominoes_fall_in_the_same_order() {
    let [(parry, lies_parry), (ours, lies_ours)] = [Engine::Parry, Engine::Ours].map(fallen);
    assert!(ours.is_sorted() && ours[29] < 420, "{ours:?}");
    assert!(parry.is_sorted() && parry[29] < 420, "{parry:?}");
    for (k, (p, q)) in lies_parry.iter().zip(&lies_ours).enumerate() {
        // The wave is as fast to 3 %, and a slab of 0.1 x 1 x 0.5 lies within half its thickness of the other.
        assert!(
            ours[k].abs_diff(parry[k]) <= 2 + parry[k] * 3 / 100,
            "{k}: {} {}",
            parry[k],
            ours[k]
        );
        assert!((p[0] - q[0]).abs() < 0.05, "{k}: {p:?} {q:?}");
        assert!((p[1] - q[1]).abs() < 0.05, "{k}: {p:?} {q:?}");
    }
}

#[test]
fn towers_of_planks_stand_as_under_parry() {
    let run = |engine| {
        let (mut world, planks) = built(engine, |w| stage::planks(w, 12, 2));
        let laid: Vec<Vector> = planks.iter().map(|p| world.bodies[*p].translation()).collect();
        (0..240).for_each(|_| world.step());
        let off = planks
            .iter()
            .zip(&laid)
            .map(|(p, at)| (world.bodies[*p].translation() - *at).length());
        let moved = off.fold(0.0, Real::max);
        let asleep: Vec<bool> = planks.iter().map(|p| world.bodies[*p].is_sleeping()).collect();
        (moved, asleep)
    };
    let [(parry, asleep), (ours, ours_asleep)] = [Engine::Parry, Engine::Ours].map(run);
    // The solver's contacts are soft: twelve levels of 0.1 sag by 0.015.
    assert!(parry < 0.02 && ours < 0.02, "a plank moved by {parry} and {ours}");
    assert_eq!(asleep, ours_asleep);
    assert!(ours_asleep.iter().all(|asleep| *asleep));
}

#[test]
fn cuboids_ride_platforms_as_under_parry() {
    let run = |engine| {
        let rider = SharedShape::cuboid(0.3, 0.3, 0.3);
        let (mut world, pairs) = built(engine, |w| stage::platforms(w, 10, &rider));
        (0..240).for_each(|_| world.step());
        let place = |pair: &[RigidBodyHandle; 2]| {
            let [a, b] = pair.map(|handle| world.bodies[handle].translation());
            b - a
        };
        let on: Vec<Vector> = pairs.iter().map(place).collect();
        on
    };
    for (k, (p, q)) in run(Engine::Parry).into_iter().zip(run(Engine::Ours)).enumerate() {
        // As high on the platform; how far a cuboid slips before it is carried is a matter of friction.
        assert!((q.y - 0.4).abs() < 0.002, "{k}: {p:?} {q:?}");
        assert!((p.y - q.y).abs() < 1e-4, "{k}: {p:?} {q:?}");
        assert!((p - q).length() < 0.02, "{k}: {p:?} {q:?}");
    }
}
