//! Bodies of any shape, moved by the caller, with coefficients of their own.

use lin_canny_rapier::lin_canny_parry::lin_canny::Velocity;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::scene;
use lin_canny_rapier::{Body, BodyId, Effects, Settings, SimulationError};

use super::engine::rapier::dynamics::{SoftBodySet, SoftBodyTearEvent};
use super::engine::rapier::geometry::{CollisionEvent, ContactPair, SharedShape};
use super::engine::rapier::math::{Pose, Real, Vector};
use super::engine::rapier::pipeline::EventHandler;
use super::engine::rapier::prelude::{ActiveEvents, ColliderHandle, ColliderSet, RigidBodySet};
use super::engine::{BodyShape, MeshShape, Simulation};

fn falling() -> Effects {
    Effects {
        gravity: Some(Vector3::y() * -9.81),
        friction: Some(0.8),
        ..Effects::response()
    }
}

fn up(y: f64) -> Isometry3<f64> {
    Isometry3::translation(0.0, y, 0.0)
}

fn floor() -> SharedShape {
    SharedShape::cuboid(10.0, 1.0, 10.0)
}

fn run(s: &mut Simulation, steps: usize) {
    (0..steps).for_each(|_| s.step().expect("a step"));
}

/// One of every kind, with the height at which it lies.
fn shapes() -> Vec<(BodyShape, f64)> {
    let part = |x: Real| (Pose::translation(x, 0.0, 0.0), SharedShape::cuboid(0.1, 0.1, 0.1));
    let corners = [Vector::ZERO, Vector::X, Vector::Y, Vector::Z].map(|v| v - Vector::splat(0.25));
    let tetrahedron = MeshShape::from_triangles(&corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
    vec![
        (SharedShape::cuboid(0.2, 0.1, 0.2).into(), 0.1),
        (SharedShape::ball(0.2).into(), 0.2),
        (SharedShape::cylinder(0.1, 0.2).into(), 0.1),
        (SharedShape::cone(0.2, 0.2).into(), 0.2),
        (SharedShape::round_cylinder(0.1, 0.2, 0.05).into(), 0.15),
        (SharedShape::compound(vec![part(-0.2), part(0.2)]).into(), 0.1),
        (tetrahedron.expect("a mesh").into(), 0.25),
    ]
}

#[test]
fn bodies_of_any_shape_rest_where_they_lie() {
    for (k, (shape, height)) in shapes().into_iter().enumerate() {
        let mut s = Simulation::new(falling(), Settings::default()).expect("effects");
        s.insert(floor(), Body::fixed(up(-1.0))).expect("a floor");
        let id = s
            .insert(shape, Body::moving(up(height + 0.01), 1000.0))
            .expect("a body");
        run(&mut s, 120);
        let y = s.pose(id).expect("a body").translation.y;
        assert!((y - height).abs() < 0.005, "{k}: {y} for {height}");
    }
}

/// Without response the scene tells distances of any shape, and every shape falls as far.
#[test]
fn bodies_of_any_shape_are_observed_without_response() {
    let effects = Effects {
        gravity: Some(Vector3::y() * -9.81),
        ..Effects::none()
    };
    let observe = scene::PairQueries::none().distance(10.0);
    for (k, (shape, height)) in shapes().into_iter().enumerate() {
        let settings = Settings::default().queries(observe);
        let mut s = Simulation::new(effects, settings).expect("effects");
        s.insert(floor(), Body::fixed(up(-1.0))).expect("a floor");
        let id = s.insert(shape, Body::moving(up(height + 1.0), 1000.0)).expect("a body");
        run(&mut s, 10);
        let fallen = height + 1.0 - s.pose(id).expect("a body").translation.y;
        let pair = s.scene().expect("a scene").pairs().next().expect("a pair");
        let gap = pair.distance.as_ref().expect("a distance").upper;
        assert!((gap - (1.0 - fallen)).abs() < 1e-6, "{k}: {gap} after {fallen}");
    }
    let mut s = Simulation::new(effects, Settings::default()).expect("effects");
    let plane = s.insert(SharedShape::halfspace(Vector::Y), Body::fixed(up(0.0)));
    assert_eq!(plane.err(), Some(SimulationError::Shape));
    let sticky = s.insert(floor(), Body::fixed(up(0.0)).friction(0.5));
    assert_eq!(
        sticky.err(),
        Some(SimulationError::NeedsResponse { effect: "friction" })
    );
}

/// A conveyor carries what lies on it, and is not pushed.
#[test]
fn kinematic_bodies_push_and_are_not_pushed() {
    let mut s = Simulation::new(falling(), Settings::default()).expect("effects");
    let velocity = Velocity::new(Vector3::new(0.5, 0.0, 0.0), Vector3::zeros());
    let belt = s.insert(floor(), Body::kinematic(up(-1.0), velocity)).expect("a belt");
    let cube = SharedShape::cuboid(0.1, 0.1, 0.1);
    let id = s.insert(cube, Body::moving(up(0.1), 1000.0)).expect("a cube");
    run(&mut s, 120);
    let (carried, moved) = (s.pose(id).expect("a cube"), s.pose(belt).expect("a belt"));
    assert!((moved.translation.x - 1.0).abs() < 1e-3 && (moved.translation.y + 1.0).abs() < 1e-6);
    assert!((carried.translation.x - 1.0).abs() < 0.1, "{carried}");
    s.set_velocity(belt, Velocity::default()).expect("a velocity");
    run(&mut s, 60);
    assert!((s.pose(belt).expect("a belt").translation.x - moved.translation.x).abs() < 1e-3);
}

fn slid(s: &mut Simulation, id: BodyId) -> f64 {
    run(s, 60);
    s.pose(id).expect("a body").translation.x
}

#[test]
fn bodies_have_coefficients_of_their_own() {
    let way = Velocity::new(Vector3::new(1.0, 0.0, 0.0), Vector3::zeros());
    let of = |friction: f64| {
        let mut s = Simulation::new(falling(), Settings::default()).expect("effects");
        s.insert(floor(), Body::fixed(up(-1.0)).friction(friction))
            .expect("a floor");
        let body = Body::moving(up(0.1), 1000.0).velocity(way).friction(friction);
        let id = s.insert(SharedShape::cuboid(0.1, 0.1, 0.1), body).expect("a body");
        slid(&mut s, id)
    };
    let (ice, rubber) = (of(0.0), of(0.9));
    assert!(ice > 0.9 && rubber < 0.2, "{ice} {rubber}");
    let bounced = |restitution: f64| {
        let mut s = Simulation::new(falling(), Settings::default()).expect("effects");
        s.insert(floor(), Body::fixed(up(-1.0)).restitution(restitution))
            .expect("a floor");
        let body = Body::moving(up(1.0), 1000.0).restitution(restitution);
        let id = s.insert(SharedShape::ball(0.1), body).expect("a ball");
        let mut rose: f64 = 0.0;
        for _ in 0..90 {
            run(&mut s, 1);
            rose = rose.max(s.velocity(id).expect("a ball").linear.y);
        }
        rose
    };
    assert!(bounced(0.9) > 3.0 && bounced(0.0) < 0.5);
    let mut s = Simulation::new(falling(), Settings::default()).expect("effects");
    let wrong = s.insert(floor(), Body::fixed(up(0.0)).friction(-1.0)).err();
    assert!(
        matches!(wrong, Some(SimulationError::Number { what: "friction", .. })),
        "{wrong:?}"
    );
}

/// Both engines.
#[test]
fn poses_and_velocities_are_set() {
    let thrown = Velocity::new(Vector3::new(0.0, 0.0, 2.0), Vector3::new(0.0, 3.0, 0.0));
    for effects in [Effects::none(), Effects::response()] {
        let effects = Effects {
            rotation: true,
            ..effects
        };
        let mut s = Simulation::new(effects, Settings::default()).expect("effects");
        let id = s
            .insert(SharedShape::cylinder(0.2, 0.1), Body::moving(up(0.0), 10.0))
            .expect("a body");
        run(&mut s, 2);
        s.set_pose(id, up(5.0)).expect("a pose");
        s.set_velocity(id, thrown).expect("a velocity");
        run(&mut s, 60);
        let (pose, velocity) = (s.pose(id).expect("a body"), s.velocity(id).expect("a body"));
        let off = (pose.translation.vector - Vector3::new(0.0, 5.0, 2.0)).norm();
        assert!(off < 1e-4, "{pose}");
        // About the cylinder's own axis.
        assert!((pose.rotation.angle() - 3.0).abs() < 1e-3, "{pose}");
        assert!((velocity.angular - thrown.angular).norm() < 1e-4);
        let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
        assert!(s.set_pose(id, nowhere).is_err());
        s.remove(id).expect("a body");
        assert_eq!(s.set_pose(id, up(0.0)), Err(SimulationError::NoBody { body: id }));
        assert_eq!(s.set_velocity(id, thrown), Err(SimulationError::NoBody { body: id }));
    }
}

/// What begins and ends, in order: whether it begins, and the two colliders.
#[derive(Default)]
pub(super) struct Told(pub(super) std::sync::Mutex<Vec<(bool, ColliderHandle, ColliderHandle)>>);

impl EventHandler for Told {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        event: CollisionEvent,
        _: Option<&ContactPair>,
    ) {
        let row = (event.started(), event.collider1(), event.collider2());
        self.0.lock().expect("one thread").push(row);
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}

    fn handle_contact_force_event(&self, _: Real, _: &RigidBodySet, _: &ColliderSet, _: &ContactPair, _: Real) {}
}

#[test]
fn handlers_are_told_of_contacts() {
    let mut s = Simulation::new(falling(), Settings::default()).expect("effects");
    s.insert(floor(), Body::fixed(up(-1.0))).expect("a floor");
    s.insert(SharedShape::ball(0.1), Body::moving(up(0.3), 10.0))
        .expect("a ball");
    let world = s.world_mut().expect("response");
    world
        .colliders
        .iter_mut()
        .for_each(|(_, collider)| collider.set_active_events(ActiveEvents::COLLISION_EVENTS));
    let told = Told::default();
    (0..60).for_each(|_| s.step_with(&(), &told).expect("a step"));
    let told = told.0.into_inner().expect("one thread");
    assert_eq!(told.iter().filter(|row| row.0).count(), 1);
}

/// Both engines: the deepest overlap is the one made deepest, and pairs of fixed bodies do not count.
#[test]
fn the_deepest_overlap_is_found() {
    for effects in [Effects::none(), Effects::response()] {
        let mut s = Simulation::new(effects, Settings::default()).expect("effects");
        let ground = s.insert(floor(), Body::fixed(up(-1.0))).expect("a floor");
        s.insert(floor(), Body::fixed(up(-1.5))).expect("another");
        assert_eq!(s.deepest_overlap(), Ok(None));
        for (k, (shape, height)) in shapes().into_iter().enumerate() {
            let at = Isometry3::translation(3.0 * k as f64 - 9.0, height - 0.01, 0.0);
            s.insert(shape, Body::moving(at, 1000.0)).expect("a body");
        }
        let at = Isometry3::translation(0.0, 0.17, 5.0);
        let deep = s.insert(SharedShape::ball(0.2), Body::moving(at, 1.0)).expect("a ball");
        let found = s.deepest_overlap().expect("poses").expect("an overlap");
        assert!(
            found.bodies == [ground, deep] || found.bodies == [deep, ground],
            "{found:?}"
        );
        assert!(found.lower <= found.upper);
        assert!((found.upper - 0.03).abs() < 1e-4, "{found:?}");
        assert!((found.lower - 0.03).abs() < 1e-4, "{found:?}");
        s.remove(deep).expect("a ball");
        let found = s.deepest_overlap().expect("poses").expect("an overlap");
        assert!((found.upper - 0.01).abs() < 1e-3, "{found:?}");
    }
}

/// A pose that is none gets an error; shapes without an inside or a geometry are left out.
#[test]
fn the_deepest_overlap_is_total() {
    let mut s = Simulation::new(Effects::response(), Settings::default()).expect("effects");
    let plane = SharedShape::halfspace(Vector::Y);
    s.insert(plane, Body::fixed(up(0.0))).expect("a half-space");
    let ball = s
        .insert(SharedShape::ball(0.5), Body::moving(up(0.0), 1.0))
        .expect("a ball");
    let corners = [Vector::X, Vector::Y, Vector::Z].map(|v| v * 9.0).to_vec();
    let open = SharedShape::trimesh(corners, vec![[0, 1, 2]]).expect("a mesh");
    s.insert(open, Body::fixed(up(-9.0))).expect("a triangle");
    assert_eq!(s.deepest_overlap(), Ok(None));
    let handle = s.handle(ball).expect("response");
    for x in [Real::NAN, Real::INFINITY, 1e38] {
        let world = s.world_mut().expect("response");
        let body = world.bodies.get_mut(handle).expect("a ball");
        body.set_translation(Vector::new(x, 0.0, 0.0), false);
        assert!(s.deepest_overlap().is_err(), "{x}");
    }
}
