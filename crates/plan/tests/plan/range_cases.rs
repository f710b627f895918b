//! Proofs over ranges of joints in hard cases: contacts at one configuration, round bodies, hollow
//! bodies, joints that move nothing, many joints, and answers that go on.

use core::ops::ControlFlow;

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{HalfSpace, Mesh, Shape};
use lin_canny_plan::{
    Cell, CellBody, Checker, ClearanceWidth, ConfigurationSpace, Joint, JointTree, PlanError, RangeAnswer,
    RangeOptions, RangeProver, RangeVerdict, TimedPoses,
};
use std::f64::consts::{PI, TAU};
use truth::rng::Rng;

use crate::ranges::{A, OTHER, at, cube, moved, robot, slide};
use truth::plans::{Ask, Furnish, cuboid};

fn turn(axis: Vector3<f64>, limits: [f64; 2]) -> Joint {
    let axis = lin_canny::nalgebra::Unit::new_normalize(axis);
    Joint::revolute(Isometry3::identity(), axis, limits)
}

/// A ball of radius 1 swings on a rod past a wall: the distance is least at the angle 0, and is
/// `gap` there.
fn swing(gap: f64) -> Checker<JointTree> {
    let wall = HalfSpace::new(-Vector3::x(), -(4.0 + gap)).expect("a wall");
    let joints = vec![turn(Vector3::z(), [-1.0, 1.0]), slide(Vector3::x_axis(), [0.0, 3.0])];
    moved(joints, Shape::ball(1.0).expect("a ball"), wall)
}

#[test]
fn pairs_that_touch_at_one_inner_configuration_never_never_meet() {
    let options = RangeOptions::default().cells(4_000);
    // The middle of a cell, and an angle that no cell has in its middle.
    for (low, high) in [(-0.25, 0.25), (-0.3, 0.2), (-0.7, 0.1)] {
        let prove = |gap: f64, options: &RangeOptions| {
            let mut checker = swing(gap);
            let answer = RangeProver::new(options).pair(&mut checker, A, OTHER, &[low, 3.0], &[high, 3.0]);
            let answer = answer.expect("a range");
            if let RangeVerdict::Both { free, touching } = &answer.verdict {
                assert_eq!(checker.is_free_at(free), Ok(true));
                assert_eq!(checker.is_free_at(touching), Ok(false));
            }
            answer
        };
        let touch = prove(0.0, &options);
        assert!(!touch.is_never() && touch.lower == 0.0, "{touch:?}");
        // The contact is found, or little is left around it.
        assert!(touch.open_share() < 1e-3 && touch.upper < 1e-9, "{touch:?}");
        for gap in [1e-6, 1e-9] {
            let apart = prove(gap, &options);
            assert!(apart.is_never() && apart.lower <= gap, "{apart:?}");
            let deep = prove(-gap, &options);
            assert!(matches!(deep.verdict, RangeVerdict::Both { .. }), "{deep:?}");
        }
    }
}

#[test]
fn a_contact_at_the_end_of_a_turn_is_found() {
    let options = RangeOptions::default();
    for (end, touches) in [(0.0, true), (-1e-3, false)] {
        let answer = RangeProver::new(&options).pair(&mut swing(0.0), A, OTHER, &[-0.9, 3.0], &[end, 3.0]);
        let answer = answer.expect("a range");
        assert_eq!(answer.is_never(), !touches, "{answer:?}");
        assert!(answer.lower <= 3.0 * (1.0 - f64::cos(end)), "{answer:?}");
    }
}

/// Ranges without width are configurations, for every pair of a world, with and without a margin.
#[test]
fn ranges_of_no_width_are_as_single_configurations_say() {
    let mut rng = Rng::new(12);
    let mut tally = [0; 2];
    for k in 0..20 {
        let (tree, mut cell) = robot(&mut rng, 1.0, 300 + k);
        cell.put("post", cube(0.4), Isometry3::translation(2.0, 0.2, 0.0));
        let floor = HalfSpace::new(Vector3::z(), -2.0).expect("a plane");
        cell.put("floor", floor, Isometry3::identity());
        let shell = Mesh::from_convex(&cube(0.5)).expect("a mesh");
        cell.put("shell", shell, Isometry3::translation(-1.8, 0.0, 0.3));
        let mut checker = Checker::new(tree.clone(), cell).expect("a world");
        for margin in [0.0, 0.2] {
            checker.cell_mut().set_margin(margin).expect("a margin");
            let q: Vec<f64> = tree.bounds().iter().map(|[low, high]| rng.range(*low, *high)).collect();
            let answers = checker.answers_over(&RangeOptions::default(), &q, &q);
            assert!(answers.iter().all(|answer| answer.cells == 1 && answer.open.is_empty()));
            let is_free = answers.iter().all(RangeAnswer::is_never);
            assert_eq!(checker.is_free_at(&q), Ok(is_free));
            tally[usize::from(is_free)] += 1;
        }
    }
    assert!(tally.iter().all(|n| *n > 4), "{tally:?}");
}

/// A coordinate without width is as good as a fixed joint.
#[test]
fn a_coordinate_of_no_width_is_not_divided() {
    let options = RangeOptions::default();
    let joints = || vec![turn(Vector3::z(), [-PI, PI]), slide(Vector3::x_axis(), [0.0, 5.0])];
    let far = cube(0.5)
        .transformed(&Isometry3::translation(4.0, 0.0, 0.0))
        .expect("a box");
    let mut checker = moved(joints(), cube(0.2), far);
    for (x, never) in [(3.0, true), (3.3, false)] {
        let answer = checker.answer_over(&options, [A, OTHER], &[-PI, x], &[PI, x]);
        assert_eq!(answer.is_never(), never, "{answer:?}");
        assert!(answer.at[1] == x && answer.open.is_empty(), "{answer:?}");
    }
}

#[test]
fn joints_that_change_no_distance_cost_few_cells() {
    // A turn about the line between the closest points, and a ball that turns about its centre.
    let options = RangeOptions::default().width(ClearanceWidth::Length(1e-3));
    let wall = || {
        cube(1.0)
            .transformed(&Isometry3::translation(3.0, 0.0, 0.0))
            .expect("a wall")
    };
    let mut along = moved(vec![turn(Vector3::x(), [-PI, PI])], cube(0.5), wall());
    let answer = along.answer_over(&options, [A, OTHER], &[-PI], &[PI]);
    assert!(answer.is_never() && answer.cells < 64, "{answer:?}");
    assert!(answer.lower >= 1.5 - 2e-3 && answer.lower <= 1.5, "{answer:?}");
    let mut spin = moved(
        vec![turn(Vector3::z(), [-TAU, TAU])],
        Shape::ball(0.5).expect("a ball"),
        wall(),
    );
    let answer = spin.answer_over(&options, [A, OTHER], &[-TAU], &[TAU]);
    assert!(answer.is_never() && answer.cells == 1, "{answer:?}");
}

/// The axis of a turn passes through the place where the bodies overlap: a body that ends in a
/// point stays in contact.
#[test]
fn a_turn_about_the_place_of_contact_keeps_it() {
    let needle = cuboid([1.0, 0.05, 0.05]);
    let needle = needle
        .transformed(&Isometry3::translation(0.99, 0.0, 0.0))
        .expect("a needle");
    let axes = [Vector3::x(), Vector3::y(), Vector3::new(1.0, 0.2, 0.1)];
    for axis in axes {
        let other = cube(0.3);
        let mut checker = moved(vec![turn(axis, [-PI, PI])], needle.clone(), other);
        let answer = checker.answer_over(&RangeOptions::default(), [A, OTHER], &[-PI], &[PI]);
        assert_eq!((answer.verdict, answer.cells), (RangeVerdict::Always, 1));
    }
}

#[test]
fn a_width_of_zero_ends_at_its_budget_with_tight_bounds() {
    let mut checker = swing(0.5);
    let options = RangeOptions::default().cells(500).width(ClearanceWidth::Length(0.0));
    let answer = checker.answer_over(&options, [A, OTHER], &[-0.3, 3.0], &[0.2, 3.0]);
    assert!(answer.cells <= 500, "{answer:?}");
    assert!(answer.lower <= 0.5, "{answer:?}");
    assert!(0.5 <= answer.upper, "{answer:?}");
    assert!(answer.upper - answer.lower < 1e-9, "{answer:?}");
}

#[test]
fn twenty_joints_are_bounded_together() {
    let joint = |k: usize| {
        let axis = if k.is_multiple_of(2) {
            Vector3::z_axis()
        } else {
            Vector3::y_axis()
        };
        Joint::revolute(Isometry3::translation(0.1, 0.0, 0.0), axis, [-0.01, 0.01])
    };
    let other = cube(0.5)
        .transformed(&Isometry3::translation(2.0, 1.2, 0.0))
        .expect("a box");
    let mut checker = moved((0..20).map(joint).collect(), cube(0.05), other);
    let answer = checker.answer_over(
        &RangeOptions::default().cells(200),
        [A, OTHER],
        &[-0.01; 20],
        &[0.01; 20],
    );
    assert!(answer.is_never() && answer.coordinates.len() == 20, "{answer:?}");
    let mut rng = Rng::new(6);
    for _ in 0..300 {
        let q = at(&mut rng, [&[-0.01; 20], &[0.01; 20]]);
        let near = checker.clearance(&q).expect("a configuration").expect("a pair");
        assert!(near.upper >= answer.lower, "{near:?} {answer:?}");
    }
}

/// A cylinder or cone is proven as a prism or pyramid with 32 sides, and beyond its error by
/// distances: a width is reached, at a price.
#[test]
fn round_bodies_reach_a_width_below_the_error_of_their_prisms() {
    let wall = cube(1.0)
        .transformed(&Isometry3::translation(0.0, 3.0, 0.0))
        .expect("a wall");
    // The wall is between the directions of a corner and of a side, so that the prism is 3 mm too
    // near.
    let spin = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI / 64.0 + 0.01);
    let origin = Isometry3::from_parts(Translation3::identity(), spin);
    for shape in [Shape::cylinder(0.5, 1.0), Shape::cone(0.5, 1.0)] {
        let shape = shape.expect("a shape");
        let mut cells = Vec::new();
        for width in [1e-1, 1e-2, 1e-3] {
            let rail = Joint::prismatic(origin, Vector3::z_axis(), [-0.5, 0.5]);
            let mut checker = moved(vec![rail], shape.clone(), wall.clone());
            let options = RangeOptions::default().width(ClearanceWidth::Length(width));
            let answer = checker.answer_over(&options, [A, OTHER], &[-0.5], &[0.5]);
            assert!(answer.is_never() && answer.lower <= 1.0, "{answer:?}");
            assert!(answer.upper - answer.lower <= width, "{answer:?}");
            assert!(answer.upper >= 1.0, "{answer:?}");
            cells.push(answer.cells);
        }
        assert!(cells[1] < 10 && (100..4_000).contains(&cells[2]), "{cells:?}");
    }
    // A cylinder that turns about its own axis, which its prism does not know.
    let cylinder = Shape::cylinder(0.5, 1.0).expect("a cylinder");
    let mut spinning = moved(vec![turn(Vector3::z(), [-PI, PI])], cylinder, wall);
    let options = RangeOptions::default().width(ClearanceWidth::Share(0.1));
    let answer = spinning.answer_over(&options, [A, OTHER], &[-PI], &[PI]);
    assert!(answer.is_never(), "{answer:?}");
    assert!(answer.lower > 0.9, "{answer:?}");
    assert!(answer.lower <= 1.0, "{answer:?}");
}

/// A closed mesh with a cavity: the walls of a box, and those of a smaller box inside that face
/// inwards.
fn hollow(outer: f64, inner: f64) -> Mesh {
    let [shell, cavity] = [outer, inner].map(|half| Mesh::from_convex(&cube(half)).expect("a mesh"));
    let mut points: Vec<Point3<f64>> = Vec::new();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for (mesh, is_inside) in [(shell, false), (cavity, true)] {
        for (_, [p, q, r]) in mesh.triangles() {
            let first = points.len() as u32;
            points.extend(if is_inside { [p, r, q] } else { [p, q, r] });
            triangles.push([first, first + 1, first + 2]);
        }
    }
    Mesh::new(&points, &triangles).expect("a mesh")
}

#[test]
fn a_mesh_in_a_hollow_mesh_keeps_off_its_walls() {
    let joints = || vec![slide(Vector3::x_axis(), [-3.0, 3.0]), turn(Vector3::z(), [-0.5, 0.5])];
    let small = || Mesh::from_convex(&cube(0.3)).expect("a mesh");
    let options = RangeOptions::default().cells(2_000);
    let mut checker = moved(joints(), small(), hollow(2.0, 1.0));
    // In the cavity, through the wall, in the material, and outside.
    for (x, expected) in [
        ([-0.4, 0.4], "never"),
        ([0.0, 0.9], "both"),
        ([1.45, 1.55], "always"),
        ([2.6, 3.0], "never"),
    ] {
        let (low, high) = ([x[0], -0.3], [x[1], 0.3]);
        let answer = checker.answer_over(&options, [A, OTHER], &low, &high);
        let found = match answer.verdict {
            RangeVerdict::Never => "never",
            RangeVerdict::Always => "always",
            RangeVerdict::Both { .. } => "both",
            _ => "open",
        };
        assert_eq!(found, expected, "{x:?} {answer:?}");
        let mut rng = Rng::new(3);
        for _ in 0..100 {
            let q = at(&mut rng, [&low, &high]);
            let is_free = checker.is_free_at(&q).expect("a configuration");
            assert!(found == "both" || is_free == (found == "never"), "{q:?} {answer:?}");
        }
    }
}

/// With an obstacle that moves, every call over a range needs a time, that of an answer which goes
/// on as well.
#[test]
fn an_answer_goes_on_only_at_a_time() {
    let x = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    let scene = || {
        let mut cell = Cell::new();
        cell.robot_body("body", cube(0.5));
        cell.put("post", cube(0.5), x(4.5));
        let poses = TimedPoses::new(&[0.0, 1.0], &[x(9.0), x(2.0)]).expect("poses");
        cell.put_moving("cart", cube(0.5), poses);
        let rail = vec![slide(Vector3::x_axis(), [0.0, 3.0])];
        let arm = JointTree::serial(Isometry3::identity(), rail, vec![1], 1.0).expect("an arm");
        Checker::new(arm, cell).expect("a world")
    };
    let options = RangeOptions::default();
    let go = &mut |_| ControlFlow::Continue(());
    let mut checker = scene();
    checker.set_time(0.0).expect("a time");
    let (post, cart) = (CellBody::Obstacle(0), CellBody::Obstacle(1));
    let mut open = |id| {
        let answer = RangeProver::new(&options.cells(0)).pair(&mut checker, A, id, &[0.0], &[3.0]);
        answer.expect("a range")
    };
    for id in [post, cart] {
        let begun = open(id);
        assert!(matches!(begun.verdict, RangeVerdict::Open { .. }));
        let mut later = scene();
        let none = Err(PlanError::NoTime("cart".into()));
        assert_eq!(RangeProver::new(&options).progress(go).resume(&mut later, &begun), none);
        later.set_time(0.0).expect("a time");
        let whole = later.answer_over(&options, [A, id], &[0.0], &[3.0]);
        assert!(whole.is_never(), "{whole:?}");
        let found = RangeProver::new(&options).progress(go).resume(&mut later, &begun);
        assert_eq!(found, Ok(whole));
        later.set_time(0.5).expect("a time");
        let again = RangeProver::new(&options).progress(go).resume(&mut later, &begun);
        // The post has not moved.
        assert_eq!(again.is_ok(), id == post, "{again:?}");
    }
}
