//! What is called for is computed, and nothing else.

use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::polyhedron::solids;
use lin_canny_rapier::lin_canny_parry::lin_canny::{ManifoldOptions, Velocity, scene};
use lin_canny_rapier::{Body, BodyId, Continuous, Effects, FrictionModel, Report, Settings, SimulationError};

use super::engine::rapier::math::Real;
use super::engine::{Hull, Simulation};

const DOWN: Vector3<f64> = Vector3::new(0.0, -9.81, 0.0);

fn block() -> Hull {
    Hull::new(solids::cuboid(Vector3::new(0.3, 0.2, 0.1)).expect("a solid"))
}

fn ground() -> Hull {
    Hull::new(solids::cuboid(Vector3::new(10.0, 1.0, 10.0)).expect("a solid"))
}

fn simulation(effects: Effects) -> Simulation {
    Simulation::new(effects, Settings::default()).expect("effects are consistent")
}

/// A block thrown flat onto the ground, and the ground.
fn thrown(effects: Effects, height: f64, velocity: Velocity) -> (Simulation, BodyId) {
    let mut s = simulation(effects);
    s.insert(ground(), Body::fixed(Isometry3::translation(0.0, -1.0, 0.0)))
        .expect("ground");
    let body = Body::moving(Isometry3::translation(0.0, height, 0.0), 1.0).velocity(velocity);
    let id = s.insert(block(), body).expect("a block");
    (s, id)
}

fn run(s: &mut Simulation, steps: usize) -> Report {
    (0..steps).for_each(|_| s.step().expect("a step"));
    s.report()
}

fn height(s: &Simulation, id: BodyId) -> f64 {
    s.pose(id).expect("a body").translation.y
}

#[test]
fn without_response_no_engine_is_built_and_bodies_pass() {
    let effects = Effects {
        gravity: Some(DOWN),
        ..Effects::none()
    };
    let (mut s, id) = thrown(effects, 1.0, Velocity::default());
    let report = run(&mut s, 60);
    assert!(s.world().is_none() && s.world_mut().is_none() && s.handle(id).is_none());
    let mut expected = Report::default();
    expected.moved = 1;
    assert_eq!(report, expected);
    // Semi-implicit Euler: g dt^2 n (n + 1) / 2.
    let fallen = 9.81 / 3600.0 * 60.0 * 61.0 / 2.0;
    assert!((height(&s, id) - (1.0 - fallen)).abs() < 1e-12);
    let counts = s.scene().expect("a scene").report().counts;
    assert_eq!((counts.boxes, counts.pairs, counts.queries), (0, 0, 0));
}

#[test]
fn what_is_observed_is_told_without_response() {
    let observe = scene::PairQueries::none()
        .overlap(true)
        .manifold(ManifoldOptions::default().prediction(0.05));
    let settings = Settings::default().queries(observe);
    let effects = Effects {
        gravity: Some(DOWN),
        rotation: true,
        ..Effects::none()
    };
    let mut s = Simulation::new(effects, settings).expect("consistent");
    s.insert(ground(), Body::fixed(Isometry3::translation(0.0, -1.0, 0.0)))
        .expect("ground");
    let id = s
        .insert(block(), Body::moving(Isometry3::translation(0.0, 0.5, 0.0), 1.0))
        .expect("a block");
    let mut met = None;
    for step in 0..60 {
        s.step().expect("a step");
        if s.report().touching > 0 && met.is_none() {
            met = Some((step, height(&s, id)));
        }
    }
    let (_, at) = met.expect("the block meets the ground");
    assert!((0.1..0.26).contains(&at), "{at}");
    let refused = Simulation::new(Effects::response(), settings).err();
    assert_eq!(refused, Some(SimulationError::ObservedResponse));
}

/// Angular momentum is conserved although the angular velocity of a block is not.
#[test]
fn a_block_tumbles_with_its_angular_momentum() {
    let inertia = block().body().inertia();
    let momentum = |s: &Simulation, id| {
        let turn = s.pose(id).expect("a body").rotation;
        let w = s.velocity(id).expect("a body").angular;
        turn * (inertia * turn.inverse_transform_vector(&w))
    };
    let velocity = Velocity::new(Vector3::zeros(), Vector3::new(0.1, 5.0, 0.2));
    let effects = Effects {
        rotation: true,
        ..Effects::none()
    };
    let (mut s, id) = thrown(effects, 3.0, velocity);
    let before = momentum(&s, id);
    run(&mut s, 300);
    assert!((momentum(&s, id) - before).norm() < 1e-12 * before.norm());
    let turned = (s.velocity(id).expect("a body").angular - velocity.angular).norm();
    assert!(turned > 0.5, "a block about its middle axis tumbles: {turned}");
    let still = Effects {
        rotation: false,
        ..effects
    };
    let (mut s, id) = thrown(still, 3.0, velocity);
    run(&mut s, 30);
    assert_eq!(s.pose(id).expect("a body").rotation, UnitQuaternion::identity());
}

/// The velocity told is the one by which the pose changes, in both engines.
#[test]
fn a_body_that_does_not_move_has_no_velocity() {
    let velocity = Velocity::new(Vector3::new(1.0, 2.0, 0.5), Vector3::new(0.0, 3.0, 0.0));
    for response in [false, true] {
        for rotation in [false, true] {
            let base = if response { Effects::response() } else { Effects::none() };
            let mut s = simulation(Effects { rotation, ..base });
            let free = Body::moving(Isometry3::translation(0.0, 9.0, 0.0), 1.0).velocity(velocity);
            let moving = s.insert(block(), free).expect("a block");
            let still = Body::fixed(Isometry3::identity()).velocity(velocity);
            let fixed = s.insert(block(), still).expect("a block");
            for _ in 0..3 {
                let told = |s: &Simulation, id| s.velocity(id).expect("a body");
                let what = format!("response {response}, rotation {rotation}");
                assert_eq!(told(&s, fixed), Velocity::default(), "{what}");
                assert_eq!(told(&s, moving).angular.norm() > 0.0, rotation, "{what}");
                assert_eq!(told(&s, moving).linear, velocity.linear, "{what}");
                run(&mut s, 1);
            }
        }
    }
}

#[test]
fn effects_left_out_leave_their_counters_at_zero() {
    let all = Effects {
        gravity: Some(DOWN),
        friction: Some(0.5),
        restitution: Some(0.1),
        continuous: Continuous::AgainstAll,
        ..Effects::response()
    };
    let fast = Velocity::new(Vector3::new(0.0, -60.0, 0.0), Vector3::zeros());
    let swept = |effects| {
        let (mut s, _) = thrown(effects, 20.0, fast);
        (0..20).map(|_| run(&mut s, 1).swept).max()
    };
    assert_eq!(swept(all), Some(1));
    let found = swept(Effects {
        continuous: Continuous::Off,
        ..all
    });
    assert_eq!(found, Some(0));
    let (mut s, _) = thrown(all, 0.3, Velocity::default());
    let rested = run(&mut s, 240);
    assert_eq!((rested.asleep, rested.moved, rested.iterations), (1, 0, 4));
    let (mut s, _) = thrown(Effects { sleeping: false, ..all }, 0.3, Velocity::default());
    let awake = run(&mut s, 240);
    assert_eq!((awake.asleep, awake.moved, awake.touching), (0, 1, 1));
    // No gravity: nothing touches.
    let (mut s, id) = thrown(Effects { gravity: None, ..all }, 0.3, Velocity::default());
    assert_eq!(run(&mut s, 60).touching, 0);
    assert!((height(&s, id) - 0.3).abs() < 1e-6);
    // No rotation: a block dropped on an edge stays on it.
    let on_edge = |rotation| {
        let mut s = simulation(Effects { rotation, ..all });
        s.insert(ground(), Body::fixed(Isometry3::translation(0.0, -1.0, 0.0)))
            .expect("ground");
        let pose = Isometry3::new(Vector3::y() * 0.5, Vector3::z() * 0.6);
        let id = s.insert(block(), Body::moving(pose, 1.0)).expect("a block");
        run(&mut s, 120);
        s.pose(id).expect("a body").rotation.angle_to(&pose.rotation)
    };
    assert!(on_edge(true) > 0.1 && on_edge(false) < 1e-6);
}

#[test]
fn friction_restitution_and_its_model_are_as_called_for() {
    let base = Effects {
        gravity: Some(DOWN),
        ..Effects::response()
    };
    let sliding = Velocity::new(Vector3::new(2.0, 0.0, 0.0), Vector3::zeros());
    let slid = |effects| {
        let (mut s, id) = thrown(effects, 0.2, sliding);
        run(&mut s, 120);
        s.pose(id).expect("a body").translation.x
    };
    let off = (slid(base) - 4.0).abs();
    assert!(off < 0.05, "without friction a block slides on: {}", slid(base));
    for friction_model in [FrictionModel::Simplified, FrictionModel::Coulomb] {
        let x = slid(Effects {
            friction: Some(0.5),
            friction_model,
            ..base
        });
        // v^2 / (2 mu g)
        assert!((x - 4.0 / 9.81).abs() < 0.06, "{friction_model:?}: {x}");
    }
    let bounced = |restitution| {
        let (mut s, id) = thrown(Effects { restitution, ..base }, 1.2, Velocity::default());
        let mut highest = 0.0f64;
        for step in 0..90 {
            run(&mut s, 1);
            highest = highest.max(if step > 30 { height(&s, id) } else { 0.0 });
        }
        highest
    };
    let (none, some) = (bounced(None), bounced(Some(0.8)));
    assert!(none < 0.25 && some > 0.6, "{none} {some}");
}

/// A thin wall holds a fast body if its motion is swept, and lets it through if not.
#[test]
fn continuous_motion_holds_fast_bodies() {
    let through = |continuous| {
        let mut s = simulation(Effects {
            continuous,
            ..Effects::response()
        });
        let wall = Hull::new(solids::cuboid(Vector3::new(0.01, 2.0, 2.0)).expect("a solid"));
        s.insert(&wall, Body::fixed(Isometry3::identity())).expect("a wall");
        let pose = Isometry3::translation(-3.07, 0.0, 0.0);
        let body = Body::moving(pose, 1.0).velocity(Velocity::new(Vector3::x() * 120.0, Vector3::zeros()));
        let id = s.insert(block(), body).expect("a block");
        run(&mut s, 20);
        s.pose(id).expect("a body").translation.x > 0.0
    };
    assert!(through(Continuous::Off));
    assert!(!through(Continuous::AgainstFixed) && !through(Continuous::AgainstAll));
}

#[test]
fn nonsense_is_refused_by_name() {
    let refused = |effects: Effects| Simulation::new(effects, Settings::default()).err();
    let needs = |effect| Some(SimulationError::NeedsResponse { effect });
    let none = Effects::none();
    let found = refused(Effects {
        friction: Some(0.5),
        ..none
    });
    assert_eq!(found, needs("friction"));
    let answer = refused(Effects {
        restitution: Some(0.5),
        ..none
    });
    assert_eq!(answer, needs("restitution"));
    assert_eq!(refused(Effects { sleeping: true, ..none }), needs("sleeping"));
    let found = refused(Effects {
        continuous: Continuous::AgainstAll,
        ..none
    });
    assert_eq!(found, needs("continuous"));
    assert_eq!(refused(Effects { iterations: 4, ..none }), needs("iterations"));
    let number = |e: Option<SimulationError>| matches!(e, Some(SimulationError::Number { .. }));
    assert!(number(refused(Effects {
        gravity: Some(DOWN * f64::NAN),
        ..none
    })));
    assert!(number(refused(Effects {
        iterations: 0,
        ..Effects::response()
    })));
    assert!(number(refused(Effects {
        friction: Some(-1.0),
        ..Effects::response()
    })));
    let settings = Settings::default().time_step(0.0);
    assert!(number(Simulation::new(none, settings).err()));
    for effects in [none, Effects::response()] {
        let (mut s, id) = thrown(effects, 1.0, Velocity::default());
        let body = Body::moving(Isometry3::translation(f64::NAN, 0.0, 0.0), 1.0);
        assert!(matches!(s.insert(block(), body), Err(SimulationError::Pose(_))));
        let body = Body::moving(Isometry3::identity(), f64::INFINITY);
        assert!(number(s.insert(block(), body).err()));
        assert_eq!(s.remove(id), Ok(()));
        assert_eq!(s.remove(id), Err(SimulationError::NoBody { body: id }));
        assert_eq!((s.pose(id), s.velocity(id)), (None, None));
        assert_eq!(run(&mut s, 5).moved, 0);
    }
}

/// With response, numbers are those of the engine: `f32` has neither 1e39 nor 1e-60.
#[test]
fn numbers_the_engine_does_not_have_are_refused() {
    let (least, most) = (f64::from(Real::MIN_POSITIVE), f64::from(Real::MAX));
    let is_number = |e: Option<SimulationError>| matches!(e, Some(SimulationError::Number { .. }));
    let new = |effects, settings| Simulation::new(effects, settings).err();
    let (response, default) = (Effects::response(), Settings::default());
    for size in [
        1e-3 * least,
        least,
        1e-3 * least.sqrt(),
        1e3 * most.sqrt(),
        most,
        f64::INFINITY,
        f64::NAN,
    ] {
        assert!(is_number(new(response, default.length_unit(size))), "size {size:e}");
        assert!(is_number(new(response, default.time_step(size))), "step {size:e}");
    }
    for far in [1e3 * most.sqrt(), most, 10.0 * most, -10.0 * most, f64::NAN] {
        let gravity = Some(DOWN * far);
        assert!(
            is_number(new(Effects { gravity, ..response }, default)),
            "gravity {far:e}"
        );
        let mut s = simulation(response);
        let at = |x: f64| Body::moving(Isometry3::translation(x, 0.0, 0.0), 1.0);
        for velocity in [Velocity::new(DOWN * far, DOWN), Velocity::new(DOWN, DOWN * far)] {
            assert!(
                is_number(s.insert(block(), at(0.0).velocity(velocity)).err()),
                "velocity {far:e}"
            );
        }
        if far.is_finite() {
            // A place whose square is out of the range of f64 is no pose.
            let refused = s.insert(block(), at(far)).err();
            let is_pose = matches!(refused, Some(SimulationError::Pose(_)));
            assert!(is_number(refused) || is_pose, "position {far:e}");
        }
    }
    for density in [1e-3 * least, 0.1 / most, 1e22, 1e30, 1e3 * most] {
        let mut s = simulation(response);
        let body = Body::moving(Isometry3::identity(), density);
        assert!(is_number(s.insert(block(), body).err()), "density {density:e}");
    }
}

/// What is accepted moves: small steps, light and heavy bodies, small and large sizes.
#[test]
fn what_is_accepted_falls() {
    let least = f64::from(Real::MIN_POSITIVE);
    let effects = Effects {
        gravity: Some(DOWN),
        ..Effects::response()
    };
    for (size, density) in [(1.0, 1e-30), (1.0, 1e20), (1e-6, 1.0), (1e5, 1.0)] {
        let settings = Settings::default().length_unit(size).time_step(1.0 / 60.0);
        let mut s = Simulation::new(effects, settings).expect("consistent");
        let id = s
            .insert(block(), Body::moving(Isometry3::identity(), density))
            .expect("a block");
        run(&mut s, 10);
        assert!(
            height(&s, id) < 0.0,
            "size {size:e}, density {density:e}: {}",
            height(&s, id)
        );
    }
    for time_step in [200.0 * least.sqrt(), 1e-6, 1e-3, 0.1] {
        let settings = Settings::default().time_step(time_step);
        let mut s = Simulation::new(effects, settings).expect("consistent");
        let id = s
            .insert(block(), Body::moving(Isometry3::identity(), 1.0))
            .expect("a block");
        run(&mut s, 1);
        assert!(height(&s, id) < 0.0, "step {time_step:e}");
    }
}

/// The default step is for bodies of some centimetres; whoever names a step gets it.
#[test]
fn the_default_step_is_refused_for_small_bodies_that_fall() {
    let falling = Effects {
        gravity: Some(DOWN),
        ..Effects::response()
    };
    let of = |size: f64| Settings::default().length_unit(size);
    let refused = |effects, settings| Simulation::new(effects, settings).err();
    for (size, is_refused) in [(1.0, false), (0.022, false), (0.021, true), (0.002, true)] {
        let Some(SimulationError::LongStep { longest }) = refused(falling, of(size)) else {
            assert!(!is_refused, "{size}");
            continue;
        };
        assert!(is_refused && longest < 1.0 / 60.0, "{size}");
        assert!((0.5 * 9.81 * longest * longest - size / 16.0).abs() < 1e-12);
        assert_eq!(refused(falling, of(size).time_step(1.0 / 60.0)), None);
    }
    // Nothing falls, or nothing rests on anything.
    assert_eq!(refused(Effects::response(), of(0.002)), None);
    let found = refused(
        Effects {
            gravity: Some(DOWN),
            ..Effects::none()
        },
        of(0.002),
    );
    assert_eq!(found, None);
}
