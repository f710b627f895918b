//! Robots of a cell: what a model and a cell may not be, and what stays of a robot's floor.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{Geometry, HalfSpace, Shape};
use lin_canny_plan::{
    Cell, CellBody, Checker, Coordinate, Drive, LinkBody, MotionKind, PlanError, RobotJoint, RobotLink, RobotModel,
};
use truth::plans::Furnish;

fn link(name: &str, bodies: Vec<Geometry>) -> RobotLink {
    let at = |body| LinkBody::new(Isometry3::identity(), body);
    RobotLink {
        name: name.into(),
        bodies: bodies.into_iter().map(at).collect(),
    }
}

fn ball() -> Geometry {
    Shape::ball(0.1).expect("a ball").into()
}

/// A base on its floor, and an arm that a joint turns.
fn model() -> RobotModel {
    let floor = HalfSpace::new(Vector3::z(), -0.05).expect("a floor").into();
    RobotModel {
        links: vec![link("base", vec![ball(), floor]), link("arm", vec![ball()])],
        joints: vec![RobotJoint {
            name: "turn".into(),
            kind: MotionKind::Revolute,
            parent: 0,
            child: 1,
            origin: Isometry3::translation(0.0, 0.0, 1.0),
            axis: Vector3::z_axis(),
            drive: Some(Drive::by(0)),
            mimics: None,
            limits: [-1.0, 1.0],
        }],
        coordinates: vec![Coordinate {
            name: "turn".into(),
            limits: [-1.0, 1.0],
            velocity: None,
        }],
        adjacent: vec![[0, 1]],
        excluded: Vec::new(),
    }
}

/// A failed call changes nothing.
fn refused(cell: &mut Cell, prefix: &str, model: &RobotModel, pose: Isometry3<f64>) -> PlanError {
    let before = format!("{cell:?}");
    let error = cell
        .add_robot(prefix, model, pose)
        .err()
        .unwrap_or_else(|| panic!("{prefix:?} {:?} {model:?}", pose.translation.x));
    assert_eq!(format!("{cell:?}"), before);
    error
}

type Change = fn(&mut RobotModel);

#[test]
fn wrong_models_are_refused() {
    let changes: [(&str, Change); 9] = [
        ("number of links", |m| m.links.clear()),
        ("number of links", |m| m.joints.clear()),
        ("parent of a joint", |m| m.joints[0].parent = 1),
        ("parent of a joint", |m| m.joints[0].parent = usize::MAX),
        ("coordinate of a joint", |m| m.joints[0].drive = Some(Drive::by(1))),
        ("coordinate of a joint", |m| {
            m.joints[0].drive = Some(Drive::by(usize::MAX))
        }),
        // A planar joint has three coordinates.
        ("coordinate of a joint", |m| m.joints[0].kind = MotionKind::Planar),
        ("index of an adjacent link", |m| m.adjacent.push([0, 2])),
        ("index of an excluded body", |m| m.excluded.push([0, 3])),
    ];
    let mut cell = Cell::new();
    // The coordinates of another robot are not those of this one.
    cell.add_robot("first/", &model(), Isometry3::identity())
        .expect("a robot");
    for (expected, change) in changes {
        let mut wrong = model();
        change(&mut wrong);
        let error = refused(&mut cell, "", &wrong, Isometry3::identity()).to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    for x in [f64::NAN, f64::INFINITY, f64::MAX] {
        refused(&mut cell, "", &model(), Isometry3::translation(x, 0.0, 0.0));
    }
    let twice = RobotModel {
        links: vec![link("base", vec![]), link("base", vec![])],
        ..model()
    };
    for (prefix, model) in [("", twice), ("first/", model())] {
        let error = refused(&mut cell, prefix, &model, Isometry3::identity());
        assert!(matches!(error, PlanError::NameTaken { kind: "link", .. }), "{error}");
    }
}

/// The bodies of another space have other numbers than those of a robot: its floor would be excluded
/// from a body that moves.
#[test]
fn robots_do_not_join_the_bodies_of_another_space() {
    let mut bodies = Cell::new();
    bodies.robot_body("drone", ball());
    let mut frames = Cell::new();
    frames.bare_frame("flange");
    for mut cell in [bodies, frames] {
        let error = refused(&mut cell, "", &model(), Isometry3::identity());
        assert!(matches!(error, PlanError::Bodies { .. }), "{error}");
    }
}

#[test]
fn a_removed_floor_is_gone_and_the_others_stay() {
    let mut cell = Cell::new();
    cell.add_robot("a/", &model(), Isometry3::identity()).expect("a robot");
    cell.add_robot("b/", &model(), Isometry3::translation(3.0, 0.0, 0.0))
        .expect("a robot");
    let at_rest = |cell: &Cell| {
        cell.excluded()
            .filter(|pair| matches!(pair[1], CellBody::Obstacle(_)))
            .count()
    };
    assert_eq!(at_rest(&cell), 4, "both bases, both floors");
    cell.exclude_adjacent();
    cell.remove_obstacle(CellBody::Obstacle(0)).expect("a floor");
    cell.include_all();
    assert_eq!((at_rest(&cell), cell.excluded().len()), (2, 2));
    cell.exclude_adjacent();
    assert!(
        Checker::of_robots(cell.clone())
            .expect("a checker")
            .is_free_at(&[0.0, 0.0])
            .expect("within limits")
    );
    // Ids stay without obstacles; the floor of b is a link of it.
    let alone = cell.without_obstacles();
    assert!(!alone.contains(CellBody::Obstacle(0)) && alone.contains(CellBody::Obstacle(1)));
    assert!(Checker::of_robots(alone).is_ok());
    #[cfg(feature = "serde")]
    {
        let text = serde_json::to_string(&cell).expect("JSON");
        let again: Cell = serde_json::from_str(&text).expect("what was written");
        assert_eq!(format!("{again:?}"), format!("{cell:?}"));
        // A tree that names more bodies than the cell has.
        let more = text.replacen("\"of_bodies\":[", "\"of_bodies\":[0,0,0,0,0,", 1);
        assert_ne!(more, text);
        assert!(serde_json::from_str::<Cell>(&more).is_err());
    }
}

#[test]
fn many_bodies_of_one_name_are_numbered_in_time() {
    let mut cell = Cell::new();
    cell.robot_body("arm", ball());
    for k in 1..20_000 {
        let name = cell.free_name("post");
        let expected = if k == 1 { "post".to_owned() } else { format!("post#{k}") };
        assert_eq!(name, expected);
        cell.put(name, ball(), Isometry3::identity());
    }
    assert_eq!(cell.free_name("arm"), "arm#2");
}
