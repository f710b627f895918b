//! Bodies of every size in flight: they fall and fly as bodies of a metre do.

use lin_canny_rapier::lin_canny_parry::lin_canny::Velocity;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::polyhedron::solids;
use lin_canny_rapier::{Body, BodyId, Effects, Settings, SimulationError};

use super::engine::rapier::prelude::*;
use super::engine::{CertifiedDispatcher, Hull, Simulation, certified_world};

const GRAVITY: f64 = 9.81;

/// Sizes of bodies: a tenth of a millimetre to ten metres.
const SIZES: [f64; 9] = [1e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.02, 0.1, 1.0, 10.0];

/// Time of a step, and steps of a flight of one second.
const STEP: f64 = 1e-3;
const STEPS: usize = 1000;

fn cube(size: f64) -> Hull {
    Hull::new(solids::cuboid(Vector3::repeat(0.5 * size)).expect("a solid"))
}

/// A cube of a size that is thrown at a velocity, under a gravity.
fn thrown(settings: Settings, gravity: f64, linear: Vector3<f64>) -> (Simulation, BodyId) {
    let effects = Effects {
        gravity: Some(Vector3::y() * -gravity),
        ..Effects::response()
    };
    let mut simulation = Simulation::new(effects, settings).expect("settings");
    let velocity = Velocity::new(linear, Vector3::zeros());
    let body = Body::moving(Isometry3::identity(), 1000.0).velocity(velocity);
    let id = simulation.insert(cube(settings.length_unit), body).expect("a cube");
    (simulation, id)
}

fn settings(size: f64) -> Settings {
    Settings::default().length_unit(size).time_step(STEP)
}

/// Where a thrown cube is after a flight.
fn flown(settings: Settings, gravity: f64, linear: Vector3<f64>) -> Vector3<f64> {
    let (mut simulation, id) = thrown(settings, gravity, linear);
    for _ in 0..STEPS {
        simulation.step().expect("a step");
    }
    simulation.pose(id).expect("the cube").translation.vector
}

/// What rapier's integrator makes of a flight: velocities change first, four times in a step, so that
/// a fall is too long by a quarter of its length over the number of steps.
fn expected(linear: Vector3<f64>) -> Vector3<f64> {
    let fallen = 0.5 * GRAVITY * (1.0 + 0.25 / STEPS as f64);
    linear - Vector3::y() * fallen
}

#[test]
fn bodies_of_every_size_fall_as_bodies_of_a_metre() {
    let metre = flown(settings(1.0), GRAVITY, Vector3::zeros());
    for size in SIZES {
        let at = flown(settings(size), GRAVITY, Vector3::zeros());
        let off = (at - metre).norm();
        assert!(off < 1e-3 * metre.norm(), "size {size}: {at:?} {metre:?}");
        let truth = expected(Vector3::zeros());
        let off = (at - truth).norm();
        assert!(off < 1e-4 * truth.norm(), "size {size}: {at:?} {truth:?}");
    }
}

#[test]
fn bodies_of_every_size_fly_as_fast_as_they_are_thrown() {
    for linear in [Vector3::new(10.0, 0.0, 0.0), Vector3::new(0.0, 60.0, -80.0)] {
        for size in SIZES {
            let at = flown(settings(size), GRAVITY, linear);
            let truth = expected(linear);
            let off = (at - truth).norm();
            assert!(off < 1e-4 * truth.norm(), "size {size}: {at:?} {truth:?}");
        }
    }
}

#[test]
fn bodies_fall_in_a_certified_world_of_every_size() {
    for size in SIZES {
        let mut world = certified_world(CertifiedDispatcher::default(), size as Real, STEP as Real);
        world.gravity = Vector::Y * -GRAVITY as Real;
        let shape = SharedShape::from(cube(size));
        let (body, _) = world.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::new(shape));
        for _ in 0..STEPS {
            world.step();
        }
        let fallen = f64::from(-world.bodies[body].translation().y);
        let truth = -expected(Vector3::zeros()).y;
        assert!((fallen - truth).abs() < 1e-4 * truth, "size {size}: {fallen} {truth}");
    }
}

#[test]
fn a_limit_of_the_speed_is_in_lengths_a_time_at_every_size() {
    for size in SIZES {
        let limited = settings(size).max_speed(2.0);
        let at = flown(limited, 0.0, Vector3::x() * 10.0);
        assert!((at - Vector3::x() * 2.0).norm() < 1e-3, "size {size}: {at:?}");
        // Rapier puts a body to sleep that moves by less than a tenth of its size a second.
        let slow = flown(limited, 0.0, Vector3::x() * 1.5);
        assert!((slow - Vector3::x() * 1.5).norm() < 1e-4, "size {size}: {slow:?}");
    }
}

#[test]
fn a_limit_of_the_speed_that_is_none_is_refused() {
    for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let settings = Settings::default().max_speed(speed);
        let refused = Simulation::new(Effects::response(), settings).err();
        let is_named = matches!(refused, Some(SimulationError::Number { what: "max_speed", .. }));
        assert!(is_named, "{speed}: {refused:?}");
    }
}
