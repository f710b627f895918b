//! Promise: a rejected call of a scene names the fault and changes nothing.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene, SceneError};
use lin_canny::{ConvexPolyhedron, ManifoldOptions, PoseError, Velocity};
use std::sync::Arc;

const OVERLAP: PairQueries = PairQueries::none().overlap(true);

fn cube() -> Arc<ConvexPolyhedron> {
    Arc::new(solids::cuboid(Vector3::repeat(0.5)).unwrap())
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

/// A moving cube and a fixed one that overlap, and the id of a removed body.
struct Stage {
    scene: Scene,
    group: Group,
    moving: BodyId,
    fixed: BodyId,
    gone: BodyId,
}

impl Stage {
    fn new() -> Self {
        let group = Group::default();
        let mut scene = Scene::new();
        scene.set_queries(group, group, OVERLAP).unwrap();
        let moving = scene.insert(Body::moving(cube()), at(0.0, 0.0, 0.0)).unwrap();
        let fixed = scene.insert(Body::fixed(cube()), at(0.5, 0.0, 0.0)).unwrap();
        let gone = scene.insert(Body::moving(cube()), at(0.0, 9.0, 0.0)).unwrap();
        scene.remove(gone).unwrap();
        scene.step();
        let stage = Self {
            scene,
            group,
            moving,
            fixed,
            gone,
        };
        assert_eq!(stage.found(), [(moving, fixed, Some(true))]);
        stage
    }

    fn found(&self) -> Vec<(BodyId, BodyId, Option<bool>)> {
        self.scene.pairs().map(|p| (p.a, p.b, p.overlaps)).collect()
    }

    fn assert_unchanged(&mut self) {
        assert_eq!(self.scene.queries(self.group, self.group), OVERLAP);
        self.scene.step();
        assert!(self.scene.events().is_empty());
        assert_eq!(self.scene.report().counts.boxes, 0, "nothing has moved");
        assert_eq!(self.found(), [(self.moving, self.fixed, Some(true))]);
    }
}

#[test]
fn stale_ids_are_refused() {
    let mut stage = Stage::new();
    let (scene, gone) = (&mut stage.scene, stage.gone);
    let error = SceneError::StaleBody { body: gone };
    let stale = Err(error);
    assert_eq!(scene.set_pose(gone, at(0.0, 0.0, 0.0)), stale);
    assert_eq!(scene.remove(gone), stale);
    assert_eq!(scene.set_group(gone, stage.group), stale);
    assert_eq!(scene.set_velocity(gone, Velocity::default()), stale);
    assert_eq!(scene.pairs_of(gone).unwrap_err(), error);
    assert_eq!(scene.nearest(gone, 1, 1.0).unwrap_err(), error);
    stage.assert_unchanged();
}

#[test]
fn poses_and_shapes_that_are_no_bodies_of_a_scene_are_refused() {
    let mut stage = Stage::new();
    let (scene, moving) = (&mut stage.scene, stage.moving);
    let nan = at(0.0, f64::NAN, 0.0);
    let refused = scene.set_pose(moving, nan).unwrap_err();
    assert!(
        matches!(refused, SceneError::Pose { body: Some(id), error: PoseError::Translation { axis: 1, .. } } if id == moving)
    );
    assert!(refused.to_string().contains("body 0"), "{refused}");
    let long = UnitQuaternion::new_unchecked(Quaternion::new(1.1, 0.0, 0.0, 0.0));
    let refused = scene.set_pose(moving, Isometry3::from_parts(Translation3::identity(), long));
    let error = PoseError::Rotation {
        body: lin_canny::Operand::A,
        norm_squared: 1.1 * 1.1,
    };
    assert_eq!(
        refused,
        Err(SceneError::Pose {
            body: Some(moving),
            error
        })
    );
    assert!(matches!(
        scene.set_pose(moving, at(0.0, 0.0, -1e38)),
        Err(SceneError::TooFar { axis: 2, .. })
    ));
    assert!(matches!(
        scene.insert(Body::moving(cube()), nan),
        Err(SceneError::Pose { body: None, .. })
    ));
    let huge = solids::cuboid(Vector3::repeat(1e38)).unwrap();
    assert!(matches!(
        scene.insert(Body::moving(huge), at(0.0, 0.0, 0.0)),
        Err(SceneError::TooLarge { .. })
    ));
    stage.assert_unchanged();
}

#[test]
fn distances_and_options_that_are_none_are_refused() {
    let mut stage = Stage::new();
    let (scene, g) = (&mut stage.scene, stage.group);
    let none = PairQueries::none();
    for d in [f64::NAN, -0.1, 1e38, f64::INFINITY] {
        let within = none.within(d);
        let distance = none.distance(d);
        let manifold = none.manifold(ManifoldOptions::default().prediction(d));
        for queries in [within, manifold, distance] {
            // A distance may be requested at any range.
            if d != f64::INFINITY || queries.distance.is_none() {
                assert!(matches!(
                    scene.set_queries(g, g, queries),
                    Err(SceneError::Range { .. })
                ));
            }
        }
        if d != f64::INFINITY {
            assert!(matches!(scene.pairs_within(g, g, d), Err(SceneError::Range { .. })));
        }
    }
    let faults: [fn(&mut ManifoldOptions); 3] = [
        |m| m.max_face_sine = f64::NAN,
        |m| m.rebuild_motion = f64::NAN,
        |m| m.reselect_motion = f64::NAN,
    ];
    for fault in faults {
        let mut options = ManifoldOptions::default().prediction(0.1);
        fault(&mut options);
        let manifold = none.manifold(options);
        assert_eq!(scene.set_queries(g, g, manifold), Err(SceneError::ManifoldOptions));
    }
    stage.assert_unchanged();
}

#[test]
fn velocities_and_times_that_are_none_are_refused() {
    let mut stage = Stage::new();
    let (scene, moving, fixed) = (&mut stage.scene, stage.moving, stage.fixed);
    assert_eq!(
        scene.set_velocity(fixed, Velocity::default()),
        Err(SceneError::Fixed { body: fixed })
    );
    let along = |x: f64| Velocity::new(Vector3::new(x, 0.0, 0.0), Vector3::zeros());
    assert_eq!(
        scene.set_velocity(moving, along(f64::INFINITY)),
        Err(SceneError::Velocity)
    );
    assert_eq!(scene.velocity(moving), Some(Velocity::default()));
    assert_eq!(scene.advance(f64::NAN), Err(SceneError::Velocity));
    scene.set_velocity(moving, along(1e36)).unwrap();
    assert!(matches!(scene.advance(1e3), Err(SceneError::TooFar { .. })));
    stage.assert_unchanged();
}

/// If one body cannot move, none moves, not even the bodies before it.
#[test]
fn an_advance_moves_all_bodies_or_none() {
    let mut stage = Stage::new();
    let (scene, moving) = (&mut stage.scene, stage.moving);
    let last = scene.insert(Body::moving(cube()), at(0.0, 30.0, 0.0)).unwrap();
    scene.step();
    for (id, speed) in [(moving, 0.1), (last, 1e36)] {
        let velocity = Velocity::new(Vector3::new(speed, 0.0, 0.0), Vector3::zeros());
        scene.set_velocity(id, velocity).unwrap();
    }
    let refused = scene.advance(1e3).unwrap_err();
    assert!(
        matches!(refused, SceneError::TooFar { body: Some(id), .. } if id == last),
        "{refused}"
    );
    assert_eq!(scene.pose(moving), Some(&at(0.0, 0.0, 0.0)));
    stage.assert_unchanged();
}

#[test]
fn questions_out_of_turn_are_refused() {
    let mut stage = Stage::new();
    let (scene, g, moving) = (&mut stage.scene, stage.group, stage.moving);
    let other = Group::new(5).unwrap();
    assert!(matches!(
        scene.pairs_within(g, other, 1.0),
        Err(SceneError::NotEnabled { .. })
    ));
    stage.assert_unchanged();
    let scene = &mut stage.scene;
    scene.set_pose(moving, at(0.1, 0.0, 0.0)).unwrap();
    assert_eq!(scene.nearest(moving, 1, 1.0).unwrap_err(), SceneError::StepDue);
    assert_eq!(scene.pairs_within(g, g, 1.0).unwrap_err(), SceneError::StepDue);
    assert_eq!(scene.any_contact(g, g).unwrap_err(), SceneError::StepDue);
}

#[test]
fn an_origin_that_is_none_is_refused_with_the_first_body() {
    use lin_canny::broad::{Aabb, BroadPhaseError, Settings, SweepAndPrune};
    for (axis, x) in [(0, f64::NAN), (1, f64::INFINITY), (2, f64::NEG_INFINITY)] {
        let mut origin = Point3::origin();
        origin[axis] = x;
        let settings = Settings::default().origin(origin);
        let mut scene = Scene::with_settings(settings);
        let refused = scene.insert(Body::moving(cube()), Isometry3::identity());
        assert_eq!(refused, Err(SceneError::Origin { axis }));
        assert_eq!((scene.body_count(), scene.step().counts.pairs), (0, 0));
        let aabb = Aabb::from_center(Point3::origin(), Vector3::repeat(1.0));
        let body = lin_canny::broad::BodyOptions::default();
        let error = Err(BroadPhaseError::Origin { axis });
        assert_eq!(SweepAndPrune::with_settings(settings).insert(&aabb, body), error);
        assert_eq!(
            SweepAndPrune::with_settings(settings).insert_unbounded(&Aabb::everything(), body),
            error
        );
    }
}
