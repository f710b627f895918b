//! Moving obstacles: what is called free is free at every sampled time, what is called blocked is in contact at the time
//! named. The judge puts the obstacles at their poses at a time, and decides configurations by predicates.

use std::f64::consts::{FRAC_PI_2, PI};

use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, HalfSpace, Shape};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, ConfigurationSpace, Joint, JointCurve, JointMotion, JointTree, PlanError,
    PlanOptions, RrtConnect, TimedPoses, TranslationSpace, Verdict,
};
use truth::plans::{Ask, Furnish, bezier, blocked, tubed};
use truth::rng::Rng;

use crate::judge::Counts;

fn cuboid(half: [f64; 3]) -> Geometry {
    solids::cuboid(Vector3::from(half)).expect("a box").into()
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

fn turned(xyz: [f64; 3], xyzw: [f64; 4]) -> Isometry3<f64> {
    let turn = UnitQuaternion::new_unchecked(Quaternion::from(xyzw));
    Isometry3::from_parts(Translation3::from(xyz), turn)
}

fn poses(times: &[f64], poses: &[Isometry3<f64>]) -> TimedPoses {
    TimedPoses::new(times, poses).expect("timed poses")
}

/// A box of half `size` that slides along x and y and turns about z.
fn slider(size: f64, obstacles: &[(Geometry, TimedPoses)]) -> Checker<JointTree> {
    let origin = Isometry3::identity();
    let rail = |axis| Joint::prismatic(origin, axis, [-1e2 * size, 1e2 * size]);
    let joints = vec![
        rail(Vector3::x_axis()),
        rail(Vector3::y_axis()),
        Joint::revolute(origin, Vector3::z_axis(), [-10.0, 10.0]),
    ];
    let space = JointTree::serial(origin, joints, vec![3], 2.0 * size).expect("an arm");
    let mut cell = Cell::new();
    cell.robot_body("block", cuboid([size; 3]));
    for (k, (geometry, poses)) in obstacles.iter().enumerate() {
        cell.put_moving(format!("cart {k}"), geometry.clone(), poses.clone());
    }
    Checker::new(space, cell).expect("a world")
}

fn curve(points: &[[f64; 3]], times: [f64; 2]) -> JointCurve {
    let curve = bezier(points);
    curve.with_times(times).expect("times")
}

fn certify(checker: &mut Checker<JointTree>, points: &[[f64; 3]], times: [f64; 2]) -> Verdict {
    checker.verdict_of(&JointMotion::curve(&curve(points, times)))
}

#[test]
fn positions_are_linear_and_rotations_are_slerps() {
    let mut rng = Rng::new(1);
    for _ in 0..200 {
        let mut pose = || {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
            let sign = if rng.chance(0.5) { 1.0 } else { -1.0 };
            let turn = UnitQuaternion::new_unchecked(turn.into_inner() * sign);
            Isometry3::from_parts(Translation3::from(Vector3::from(rng.unit()) * 3.0), turn)
        };
        let rows = [pose(), pose(), pose()];
        let times = [-2.0, 1.0, 1.5];
        let timed = poses(&times, &rows);
        for i in 0..=20 {
            let t = -2.0 + 3.5 * f64::from(i) / 20.0;
            let k = usize::from(t >= 1.0);
            let x = (t - times[k]) / (times[k + 1] - times[k]);
            let found = timed.at(t).expect("a pose");
            let [p, q] = [rows[k], rows[k + 1]];
            let place = p.translation.vector.lerp(&q.translation.vector, x);
            assert!((found.translation.vector - place).norm() < 1e-14);
            let between = p
                .rotation
                .try_slerp(&q.rotation, x, 1e-12)
                .expect("less than half a turn");
            assert!(found.rotation.angle_to(&between) < 1e-7, "{t}");
        }
        for (time, row) in times.iter().zip(&rows) {
            let found = timed.at(*time).expect("a pose");
            assert_eq!(found.translation, row.translation);
            assert!(found.rotation.angle_to(&row.rotation) < 1e-7);
        }
        assert!(timed.at((-2.0f64).next_down()).is_none() && timed.at(1.5f64.next_up()).is_none());
        assert!(timed.at(f64::NAN).is_none());
    }
}

#[test]
fn timed_poses_that_are_invalid_are_errors() {
    let origin = Isometry3::identity();
    let refused = |times: &[f64], poses: &[Isometry3<f64>]| {
        let error = TimedPoses::new(times, poses).expect_err("an error");
        error.to_string()
    };
    assert_eq!(refused(&[], &[]), "number of timed poses is out of range: 0.0");
    assert_eq!(refused(&[0.0], &[origin]), "number of timed poses is out of range: 1.0");
    let found = refused(&[0.0], &[origin; 2]);
    assert_eq!(found, "number of times of poses is out of range: 1.0");
    for (times, text) in [
        ([0.0, 0.0, 1.0], "timed pose 1: time is out of range: 0.0"),
        ([0.0, 1.0, 1.0], "timed pose 2: time is out of range: 1.0"),
        ([0.0, 1.0, 0.5], "timed pose 2: time is out of range: 0.5"),
        ([f64::NAN, 1.0, 2.0], "timed pose 0: time is out of range: NaN"),
        ([0.0, 1.0, f64::INFINITY], "timed pose 2: time is out of range: inf"),
    ] {
        assert_eq!(refused(&times, &[origin; 3]), text);
    }
    let wrong = [
        turned([0.0; 3], [0.0, 0.0, 0.0, 0.5]),
        turned([0.0; 3], [0.0; 4]),
        turned([f64::NAN, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]),
    ];
    for pose in wrong {
        assert!(refused(&[0.0, 1.0, 2.0], &[origin, pose, origin]).starts_with("timed pose 1: "));
    }
    let far = [at(-1e100, 0.0, 0.0), at(1e100, 0.0, 0.0)];
    assert!(refused(&[0.0, 1.0], &far).starts_with("timed pose 1: linear velocity"));
    // Times on the clock of a curve.
    let straight = || bezier(&[[0.0], [1.0]]);
    for times in [[1.0, 1.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        let error = straight().with_times(times).expect_err("an error").to_string();
        assert!(error.starts_with("time of a curve is out of range"), "{error}");
    }
    let timed = straight().with_times([1.0, 3.0]).expect("times");
    assert_eq!(timed.times(), Some([1.0, 3.0]));
    assert_eq!(timed.elevated().expect("a curve").times(), Some([1.0, 3.0]));
}

/// The obstacle is beside the block, and both move alike.
#[test]
fn an_obstacle_that_keeps_pace_is_free_unless_it_touches() {
    for gap in [0.0, 1e-1, 1e-3, 1e-6, 1e-9, 1e-12] {
        let times = [5.0, 8.0];
        let beside = |x: f64, y: f64| at(x, y + 1.5 + gap, 0.0);
        let straight = poses(&times, &[beside(-3.0, 0.0), beside(4.0, 2.0)]);
        let mut checker = slider(0.5, &[(cuboid([1.0; 3]), straight)]);
        let found = certify(&mut checker, &[[-3.0, 0.0, 0.0], [4.0, 2.0, 0.0]], times);
        // The same in three rows, and a part of the motion.
        let rows = [beside(-3.0, 0.0), beside(0.5, 1.0), beside(4.0, 2.0)];
        let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&[5.0, 6.5, 8.0], &rows))]);
        let in_rows = certify(&mut checker, &[[-3.0, 0.0, 0.0], [4.0, 2.0, 0.0]], times);
        let ends = [[-1.25, 0.5, 0.0], [2.25, 1.5, 0.0]];
        let part = certify(&mut checker, &ends, [5.75, 7.25]);
        for (name, found) in [("whole", found), ("rows", in_rows), ("part", part)] {
            match gap > 0.0 {
                true => assert!(found.is_free(), "{name} {gap:e}: {found:?}"),
                false => assert!(
                    matches!(found, Verdict::Blocked { contact_at: 0.0, .. }),
                    "{name}: {found:?}"
                ),
            }
        }
    }
    // Both turn about the same axis: a box at a distance of 2 on the axis x of each.
    for gap in [0.0, 1e-1, 1e-3, 1e-6, 1e-8] {
        let origin = Isometry3::identity();
        let arm = vec![Joint::revolute(origin, Vector3::z_axis(), [-10.0, 10.0])];
        let space = JointTree::serial(origin, arm, vec![1], 3.0).expect("an arm");
        let placed = |y: f64, half: f64| {
            let body = solids::cuboid(Vector3::repeat(half)).expect("a box");
            body.transformed(&at(2.0, y, 0.0)).expect("a box")
        };
        let mut cell = Cell::new();
        cell.robot_body("block", placed(0.0, 0.5));
        let quarters = [0.0, 1.0, 2.0].map(|k| Isometry3::rotation(Vector3::z() * (k * FRAC_PI_2)));
        cell.put_moving("arm", placed(0.9 + gap, 0.4), poses(&[0.0, 1.0, 2.0], &quarters));
        let mut checker = Checker::new(space, cell).expect("a world");
        let along = bezier(&[[0.0], [PI]]);
        let along = along.with_times([0.0, 2.0]).expect("times");
        let found = checker.verdict_of(&JointMotion::curve(&along));
        assert_eq!(found.is_free(), gap > 0.0, "{gap:e}: {found:?}");
    }
}

/// A bar along x that turns by half a turn about z passes on the side that the signs of the quaternions say.
#[test]
fn half_turns_go_where_the_signs_say() {
    let bar = || {
        let body = solids::cuboid(Vector3::new(0.5, 0.1, 0.1)).expect("a box");
        Geometry::from(body.transformed(&at(1.5, 0.0, 0.0)).expect("a box"))
    };
    let (one, half) = ([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]);
    let minus = |q: [f64; 4]| q.map(|x| -x);
    let rows = |turns: &[[f64; 4]]| {
        let rows: Vec<_> = turns.iter().map(|q| turned([0.0; 3], *q)).collect();
        let times: Vec<f64> = (0..turns.len()).map(|k| k as f64).collect();
        poses(&times, &rows)
    };
    // The least and the greatest y of the bar, and where the block at y = 1.5 or -1.5 is met.
    let sides = |timed: &TimedPoses| {
        let last = timed.times()[timed.times().len() - 1];
        [1.5, -1.5].map(|y| {
            let mut checker = slider(0.1, &[(bar(), timed.clone())]);
            let found = certify(&mut checker, &[[0.0, y, 0.0]; 2], [0.0, last]);
            match found {
                Verdict::Free { .. } => None,
                Verdict::Blocked {
                    contact_at: t,
                    free_until: safe,
                    ..
                } => {
                    assert!(t - safe < 1e-4);
                    Some(t * last)
                }
                other => panic!("{other:?}"),
            }
        })
    };
    let is_near = |found: Option<f64>, expected: f64| found.is_some_and(|t| (t - expected).abs() < 0.1);
    for sign in [1.0, -1.0] {
        let signed = |q: [f64; 4]| q.map(|x| sign * x);
        let [left, right] = sides(&rows(&[signed(one), signed(half)]));
        assert!(is_near(left, 0.5) && right.is_none(), "{left:?} {right:?}");
        let [left, right] = sides(&rows(&[signed(one), minus(signed(half))]));
        assert!(is_near(right, 0.5) && left.is_none(), "{left:?} {right:?}");
        // On to a whole turn, or back.
        let [left, right] = sides(&rows(&[signed(one), signed(half), minus(signed(one))]));
        assert!(is_near(left, 0.5) && is_near(right, 1.5), "{left:?} {right:?}");
        let [left, right] = sides(&rows(&[signed(one), signed(half), signed(one)]));
        assert!(is_near(left, 0.5) && right.is_none(), "{left:?} {right:?}");
        // A cosine of half a turn that is not quite zero.
        for w in [6.1e-17, -6.1e-17] {
            let [left, right] = sides(&rows(&[signed(one), signed([0.0, 0.0, 1.0, w])]));
            assert!(is_near(left, 0.5) && right.is_none(), "{w:e}: {left:?} {right:?}");
        }
        // The same rotation twice.
        assert_eq!(sides(&rows(&[signed(one), minus(signed(one))])), [None; 2]);
        assert_eq!(sides(&rows(&[signed(half), minus(signed(half))])), [None; 2]);
        // Away from half a turn signs do not matter, to the bit.
        let quarter = [0.0, 0.0, 0.5f64.sqrt(), 0.5f64.sqrt()];
        let near = |q: [f64; 4]| rows(&[signed(one), q]).at(0.3).expect("a pose");
        let [a, b] = [near(quarter), near(minus(quarter))];
        assert!(a.rotation.coords == b.rotation.coords && a.translation == b.translation);
    }
}

#[test]
fn tangent_passes_are_decided() {
    for k in 1..=11 {
        for sign in [1.0, -1.0] {
            let gap = sign * 10f64.powi(-k);
            // A ball passes the face of the block, which is at rest.
            let ball = Geometry::from(Shape::ball(1.0).expect("a ball"));
            let rows = [-4.0, 4.0].map(|x| at(x, 1.5 + gap, 0.0));
            let mut checker = slider(0.5, &[(ball, poses(&[0.0, 1.0], &rows))]);
            let found = certify(&mut checker, &[[0.0; 3]; 2], [0.0, 1.0]);
            assert_eq!(found.is_free(), gap > 0.0, "{gap:e}: {found:?}");
            assert!(!matches!(found, Verdict::Undecided { .. }), "{gap:e}: {found:?}");
            // The block falls on a parabola to a floor that rises to meet it half way, and falls again.
            let rows = [-3.0, 0.0, -3.0].map(|y| at(0.0, y - 1.5 - gap, 0.0));
            let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&[0.0, 1.0, 2.0], &rows))]);
            let found = certify(
                &mut checker,
                &[[-0.4, 4.0, 0.0], [0.0, -4.0, 0.0], [0.4, 4.0, 0.0]],
                [0.0, 2.0],
            );
            assert_eq!(found.is_free(), gap > 0.0, "parabola {gap:e}: {found:?}");
            if let Some(([safe, t], _)) = blocked(&found) {
                assert!(safe <= 0.5, "{gap:e}: {found:?}");
                assert!(t - safe < 1e-3, "{gap:e}: {found:?}");
                assert!((t - 0.5).abs() < 0.3, "{gap:e}: {found:?}");
            }
        }
    }
    let ball = Geometry::from(Shape::ball(1.0).expect("a ball"));
    let rows = [-4.0, 4.0].map(|x| at(x, 1.5, 0.0));
    let mut checker = slider(0.5, &[(ball, poses(&[0.0, 1.0], &rows))]);
    assert!(!certify(&mut checker, &[[0.0; 3]; 2], [0.0, 1.0]).is_free());
}

#[test]
fn an_obstacle_that_arrives_at_the_end_is_blocked_there() {
    for begin in [0.0, 0.3, -7.0, 1.7e9] {
        let rows = [
            at(0.0, 6.0, 0.0),
            at(0.0, 3.0, 0.0),
            at(0.0, 1.5, 0.0),
            at(0.0, -1.5, 0.0),
        ];
        let times = [begin, begin + 1.0, begin + 1.75, begin + 3.0];
        let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&times, &rows))]);
        // Ends at a row, and between rows.
        let found = certify(&mut checker, &[[0.0; 3]; 2], [times[0], times[2]]);
        assert!(
            matches!(found, Verdict::Blocked { contact_at: 1.0, free_until: safe, .. } if safe > 0.99),
            "{found:?}"
        );
        assert!(certify(&mut checker, &[[0.0; 3]; 2], [times[0], times[1]]).is_free());
        let found = certify(&mut checker, &[[0.0; 3]; 2], [times[1], times[3]]);
        assert!(
            matches!(found, Verdict::Blocked { contact_at: t, .. } if (t - 0.375).abs() < 1e-5),
            "{found:?}"
        );
        for gap in [1e-3, 1e-9, 1e-12] {
            let mut rows = rows;
            rows[2].translation.vector.y += gap;
            let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&times[..3], &rows[..3]))]);
            assert!(
                certify(&mut checker, &[[0.0; 3]; 2], [times[0], times[2]]).is_free(),
                "{gap:e}"
            );
        }
    }
    // The block and the obstacle arrive at the same time from both sides, at rest.
    let rows = [at(3.0, 0.0, 0.0), at(0.5, 0.0, 0.0)];
    let mut checker = slider(0.5, &[(cuboid([0.5; 3]), poses(&[0.0, 2.0], &rows))]);
    let found = certify(
        &mut checker,
        &[[-4.0, 0.0, 0.0], [-0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]],
        [0.0, 2.0],
    );
    assert!(
        matches!(found, Verdict::Blocked { contact_at: 1.0, free_until: safe, .. } if safe > 0.99),
        "{found:?}"
    );
}

/// Rows much nearer to each other than the rounding of the time prove nothing, and no number leaves its range.
#[test]
fn rows_of_any_distance_in_time_are_sound() {
    let rows = |y: [f64; 4]| y.map(|y| at(0.0, y, 0.0));
    let up = [9.0, 5.0, 5.0, 9.0];
    for near in [1e-3, 1e-9, 1e-12, 1e-15, 1e-16, 1e-200, 5e-324] {
        let times = if near < 1e-16 {
            [-1.0, 0.0, near, 1.0]
        } else {
            [0.0, 1.0, 1.0 + near, 2.0]
        };
        if times[1] == times[2] {
            continue;
        }
        let timed = poses(&times, &rows(up));
        let mut checker = slider(0.5, &[(cuboid([1.0; 3]), timed)]);
        let found = certify(&mut checker, &[[0.0; 3]; 2], [times[0], times[3]]);
        // The obstacle stands still in between, so nothing is unknown of it but the time.
        assert!(
            found.is_free() || matches!(found, Verdict::Undecided { .. }) && near < 1e-12,
            "{near:e}: {found:?}"
        );
        // It jumps through the block and back.
        let timed = poses(&times, &rows([9.0, 5.0, -5.0, 9.0]));
        let mut checker = slider(0.5, &[(cuboid([1.0; 3]), timed)]);
        let found = certify(&mut checker, &[[0.0; 3]; 2], [times[0], times[3]]);
        assert!(!found.is_free(), "{near:e}");
    }
    for size in [1e-300, 1e-100, 1e90] {
        let times = [0.0, size, 2.0 * size];
        let rows = [3.0, 2.0, 3.0].map(|y| at(0.0, y, 0.0));
        let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&times, &rows))]);
        assert!(
            certify(&mut checker, &[[0.0; 3]; 2], [0.0, 2.0 * size]).is_free(),
            "{size:e}"
        );
        let found = certify(&mut checker, &[[0.0, 0.6, 0.0]; 2], [0.0, 2.0 * size]);
        assert!(
            matches!(found, Verdict::Blocked { free_until: safe, contact_at: t, .. } if safe < 0.5 && t > 0.4),
            "{found:?}"
        );
    }
}

#[test]
fn a_floor_that_rises_is_met() {
    let floor = || Geometry::from(HalfSpace::new(Vector3::y(), 0.0).expect("a half-space"));
    let rows = [at(7.0, -5.0, 0.0), at(-9.0, 0.0, 3.0)];
    let mut checker = slider(0.5, &[(floor(), poses(&[0.0, 2.0], &rows))]);
    assert!(certify(&mut checker, &[[0.0, 0.6, 0.0]; 2], [0.0, 2.0]).is_free());
    let found = certify(&mut checker, &[[0.0, -2.0, 0.0]; 2], [0.0, 2.0]);
    assert!(
        matches!(found, Verdict::Blocked { contact_at: t, .. } if (t - 0.5).abs() < 1e-4),
        "{found:?}"
    );
    // It tilts.
    let tilted = Isometry3::rotation(Vector3::z() * 0.5);
    let mut checker = slider(0.5, &[(floor(), poses(&[0.0, 1.0], &[Isometry3::identity(), tilted]))]);
    assert!(!certify(&mut checker, &[[3.0, 0.6, 0.0]; 2], [0.0, 1.0]).is_free());
    assert!(certify(&mut checker, &[[3.0, 3.0, 0.0]; 2], [0.0, 1.0]).is_free());
    checker.set_time(1.0).expect("a pose");
    assert!(!checker.is_free_at(&[3.0, 0.6, 0.0]).expect("within limits"));
}

#[test]
fn everything_without_a_time_is_an_error() {
    let rows = [at(0.0, 5.0, 0.0), at(0.0, 2.0, 0.0)];
    let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&[1.0, 2.0], &rows))]);
    let (p, q) = ([0.0; 3], [1.0, 0.0, 0.0]);
    let straight = bezier(&[p, q]);
    let none = || PlanError::NoTime("cart 0".into());
    assert_eq!(
        none().to_string(),
        "obstacle \"cart 0\" moves (expected a motion with times, or a checker with a time)"
    );
    for has_time in [false, true] {
        // Segments have no times, even if configurations have one.
        assert_eq!(checker.certify(&JointMotion::segment(&p, &q)), Err(none()));
        assert_eq!(checker.is_free(&JointMotion::segment(&p, &q)), Err(none()));
        assert_eq!(crate::prove(&mut checker, &JointMotion::segment(&p, &q)), Err(none()));
        let found = checker.certify(&JointMotion::segment(&p, &q).with_radius(0.1).expect("a motion"));
        assert_eq!(found, Err(none()));
        let found = checker.certify(&JointMotion::path(&[p, q]).expect("a motion"));
        assert_eq!(found, Err(none()));
        assert_eq!(checker.clearance_along(&JointMotion::segment(&p, &q), 0.1), Err(none()));
        assert_eq!(checker.certify(&JointMotion::curve(&straight)), Err(none()));
        assert_eq!(crate::prove(&mut checker, &JointMotion::curve(&straight)), Err(none()));
        let found = checker.certify(&JointMotion::spline(std::slice::from_ref(&straight)).expect("a motion"));
        assert_eq!(found, Err(none()));
        assert_eq!(checker.certify(&tubed(&straight, &[0.1; 3])), Err(none()));
        let answer = checker.clearance_along(&JointMotion::curve(&straight), 0.1);
        assert_eq!(answer, Err(none()));
        let found = RrtConnect::new(&PlanOptions::default())
            .plan(&mut checker, &p, &q)
            .err();
        assert_eq!(found, Some(none()), "{has_time}");
        let id = CellBody::Obstacle(0);
        if !has_time {
            assert_eq!(checker.clearance(&p), Err(none()));
            assert_eq!(checker.nearest(&p, 1.0), Err(none()));
            assert_eq!(checker.is_free_at(&p), Err(none()));
            assert_eq!(checker.in_contact(&p), Err(none()));
            assert!(checker.nearest_batch(&p, 1, 0.0, 2).is_err());
            assert_eq!(checker.pose(id, &p), Err(none()));
            assert_eq!(checker.time(), None);
            checker.set_time(1.5).expect("a pose");
        } else {
            assert_eq!(checker.time(), Some(1.5));
            assert_eq!(checker.clearance(&p).expect("a pose").expect("a pair").distance, 2.0);
            assert_eq!(checker.nearest_batch(&p, 1, 0.0, 2).expect("rows").distances, [2.0]);
            assert_eq!(checker.pose(id, &p), Ok(at(0.0, 3.5, 0.0)));
            assert!(checker.is_free_at(&[0.0, 1.9, 0.0]).expect("a pose"));
            assert_eq!(checker.in_contact(&[0.0, 2.0, 0.0]).expect("a pose").len(), 1);
        }
    }
    // Times without a pose.
    for (times, time) in [
        ([0.5, 1.5], 0.5),
        ([1.5, 2.5], 2.5),
        ([0.0, 3.0], 0.0),
        ([3.0, 4.0], 3.0),
    ] {
        let error = checker
            .certify(&JointMotion::curve(&curve(&[p, q], times)))
            .expect_err("an error");
        let text = format!("obstacle \"cart 0\" has no pose at time {time:?} (its poses cover 1.0 to 2.0)");
        assert_eq!(error.to_string(), text);
    }
    for time in [0.999, 2.001] {
        assert!(matches!(checker.set_time(time), Err(PlanError::PoseTime { .. })));
    }
    assert!(matches!(checker.set_time(f64::NAN), Err(PlanError::Value { .. })));
    assert_eq!(checker.time(), Some(1.5));
    // Curves of a spline follow each other in time.
    let [one, two] = [[1.0, 1.5], [1.6, 2.0]].map(|times| curve(&[p, p], times));
    assert_eq!(
        JointMotion::spline(&[one.clone(), two]),
        Err(PlanError::CurveTime {
            index: 1,
            start: 1.6,
            end: 1.5
        })
    );
    let two = curve(&[p, p], [1.5, 2.0]);
    assert!(checker.is_free_along(&JointMotion::spline(&[one, two]).expect("a motion")));
}

#[test]
fn moving_obstacles_come_and_go() {
    let rows = [at(0.0, 5.0, 0.0), at(0.0, 0.0, 0.0)];
    let timed = poses(&[0.0, 1.0], &rows);
    let mut checker = slider(0.5, &[]);
    let still = |times| curve(&[[0.0; 3]; 2], times);
    assert!(checker.is_free_along(&JointMotion::segment(&[0.0; 3], &[0.0; 3])));
    checker.set_time(0.5).expect("nothing moves");
    let id = checker.cell_mut().put_moving("press", cuboid([1.0; 3]), timed.clone());
    assert_eq!(checker.cell().obstacle_motion(id), Some(&timed));
    assert_eq!(checker.cell().obstacle_pose(id), Some(&rows[0]));
    let answer = checker.clearance(&[0.0; 3]).expect("a pose").expect("a pair").distance;
    assert_eq!(answer, 1.0);
    let found = checker.verdict_of(&JointMotion::curve(&still([0.0, 1.0])));
    assert!(
        matches!(found, Verdict::Blocked { contact_at: t, .. } if (t - 0.7).abs() < 1e-5),
        "{found:?}"
    );
    assert!(checker.is_free_along(&JointMotion::curve(&still([0.0, 0.699]))));
    checker
        .cell_mut()
        .replace_obstacle(id, cuboid([0.1; 3]))
        .expect("an obstacle");
    assert!(checker.is_free_along(&JointMotion::curve(&still([0.0, 0.7]))));
    // Without a pose at the time of configurations.
    let late = poses(&[2.0, 3.0], &rows);
    let late = checker.cell_mut().put_moving("late", cuboid([0.1; 3]), late);
    for error in [
        checker.is_free_at(&[0.0; 3]).map(|_| ()),
        checker.clearance(&[0.0; 3]).map(|_| ()),
        checker.pose(late, &[0.0; 3]).map(|_| ()),
        checker.set_time(0.6),
    ] {
        assert!(matches!(error, Err(PlanError::PoseTime { .. })), "{error:?}");
    }
    checker.cell_mut().remove_obstacle(late).expect("an obstacle");
    let answer = checker.clearance(&[0.0; 3]).expect("a pose").expect("a pair").distance;
    assert_eq!(answer, 1.9);
    // At rest, then gone.
    checker
        .cell_mut()
        .move_obstacle(id, at(0.0, 3.0, 0.0))
        .expect("an obstacle");
    assert_eq!(checker.cell().obstacle_motion(id), None);
    assert!(checker.is_free_along(&JointMotion::segment(&[0.0; 3], &[0.0; 3])));
    let still = bezier(&[[0.0, 2.6, 0.0]; 2]);
    assert!(!checker.is_free_along(&JointMotion::curve(&still)));
    let id = checker.cell_mut().put_moving("second press", cuboid([1.0; 3]), timed);
    assert!(checker.certify(&JointMotion::segment(&[0.0; 3], &[0.0; 3])).is_err());
    checker.cell_mut().remove_obstacle(id).expect("an obstacle");
    assert!(checker.is_free_along(&JointMotion::segment(&[0.0; 3], &[0.0; 3])));
}

/// A contact with a moving obstacle at the start is not accepted, whatever the margin.
#[test]
fn contacts_at_the_start_with_moving_obstacles_are_not_accepted() {
    let rows = [at(0.0, -1.5, 0.0), at(0.0, -3.0, 0.0)];
    let mut checker = slider(0.5, &[(cuboid([1.0; 3]), poses(&[0.0, 1.0], &rows))]);
    checker.set_start_contact_margin(Some(1e-3)).expect("a length");
    let along = curve(&[[0.0; 3], [0.0, 2.0, 0.0]], [0.0, 1.0]);
    let found = checker.verdict_of(&JointMotion::curve(&along));
    assert!(matches!(found, Verdict::Blocked { contact_at: 0.0, .. }), "{found:?}");
    assert_eq!(crate::prove(&mut checker, &JointMotion::curve(&along)), Ok(None));
    checker.cell_mut().put("table", cuboid([1.0; 3]), at(0.0, -1.5, 0.0));
    checker.cell_mut().remove_obstacle("cart 0").expect("an obstacle");
    assert!(checker.is_free_along(&JointMotion::curve(&along)));
}

/// Random poses about the robot, at random times that cover -1 to 11.
fn wander(rng: &mut Rng, far: f64) -> TimedPoses {
    let count = 2 + rng.below(8);
    let mut times: Vec<f64> = (0..count).map(|_| rng.range(-1.0, 11.0)).collect();
    times.extend([-1.0, 11.0]);
    times.sort_by(f64::total_cmp);
    let mut rows: Vec<Isometry3<f64>> = Vec::new();
    for k in 0..times.len() {
        let place = Vector3::from(rng.unit()) * rng.range(0.3, 1.0) * far;
        let axis = Vector3::from(rng.unit());
        // Half a turn, a rest, or anything.
        let turn = match rng.below(8) {
            0 => UnitQuaternion::from_quaternion(Quaternion::from_parts(0.0, axis)),
            1 if k > 0 => UnitQuaternion::new_unchecked(-rows[k - 1].rotation.into_inner()),
            _ => UnitQuaternion::from_scaled_axis(axis * rng.range(0.0, PI)),
        };
        let is_at_rest = k > 0 && rng.chance(0.15);
        rows.push(match is_at_rest {
            true => rows[k - 1],
            false => Isometry3::from_parts(Translation3::from(place), turn),
        });
    }
    poses(&times, &rows)
}

fn among(space: JointTree, mut cell: Cell, rng: &mut Rng, far: f64) -> Checker<JointTree> {
    for k in 0..3 {
        let half = [0.0; 3].map(|_: f64| rng.range(0.03, 0.12));
        let geometry = match k {
            0 => Geometry::from(Shape::ball(half[0]).expect("a ball")),
            _ => cuboid(half),
        };
        cell.put_moving(format!("moving {k}"), geometry, wander(rng, far));
    }
    Checker::new(space, cell).expect("a world")
}

/// Certifies random curves at random times, and judges each at `places` times up to where it is called free.
fn judged(joints: usize, worlds: usize, curves: usize, places: u32, seed: u64) -> Counts {
    let (mut rng, mut counts) = (Rng::new(seed), Counts::default());
    for _ in 0..worlds {
        let (space, cell) = truth::arm::chain::chain(joints, [-1e3, 1e3]).expect("an arm");
        let mut checker = among(space.clone(), cell, &mut rng, 0.35 * joints as f64);
        let mut judge = Checker::new(space, checker.cell().clone()).expect("a world");
        for k in 0..curves {
            // An obstacle may be at the base.
            let (begin, from) = loop {
                let begin = rng.range(-1.0, 10.0);
                judge.set_time(begin).expect("a pose");
                let q: Vec<f64> = (0..joints).map(|_| rng.range(-1.5, 1.5)).collect();
                if judge.is_free_at(&q).expect("within limits") {
                    break (begin, q);
                }
            };
            let times = [begin, begin + rng.log_range(0.05, 11.0 - begin)];
            let way = [0.2, 0.7, 2.0][k % 3];
            let degree = 1 + k % 7;
            let mut points = vec![from.clone()];
            points.extend((0..degree).map(|_| {
                let each = from.iter().map(|x| x + rng.range(-way, way));
                each.collect::<Vec<f64>>()
            }));
            let curve = bezier(&points);
            let curve = curve.with_times(times).expect("times");
            let verdict = checker.verdict_of(&JointMotion::curve(&curve));
            let is_free = |t: f64| {
                let time = (times[0] + (times[1] - times[0]) * t).clamp(times[0], times[1]);
                judge.set_time(time).expect("a pose");
                judge.is_free_at(&curve.at(t)).expect("within limits")
            };
            counts.judge(&verdict, places, is_free, &(k, times, &points));
        }
        counts.queries += checker.work().queries;
    }
    counts
}

#[test]
fn random_curves_among_moving_obstacles_are_as_the_verdict_says() {
    for (joints, seed) in [(3, 1), (6, 2)] {
        let counts = judged(joints, 4, 14, 100, seed);
        println!("{joints} joints: {counts:?}");
        assert!(counts.free > 5, "{counts:?}");
        assert!(counts.blocked > 5, "{counts:?}");
        assert!(counts.undecided == 0, "{counts:?}");
    }
}

#[test]
#[ignore = "600 curves at 10,000 places: cargo test --release -p lin-canny-plan --test plan moving::hundreds -- --ignored --nocapture"]
fn hundreds_of_curves_among_moving_obstacles_are_as_the_verdict_says() {
    for (joints, seed) in [(3, 11), (6, 12), (10, 13)] {
        println!("{joints} joints: {:?}", judged(joints, 10, 20, 10_000, seed));
    }
}

#[test]
fn proofs_clearances_and_tubes_agree_with_verdicts() {
    let mut rng = Rng::new(31);
    let (space, cell) = truth::arm::chain::chain(4, [-1e3, 1e3]).expect("an arm");
    let mut checker = among(space, cell, &mut rng, 1.4);
    let mut free = 0;
    for k in 0..24 {
        let from: Vec<f64> = (0..4).map(|_| rng.range(-1.0, 1.0)).collect();
        let points: Vec<Vec<f64>> = (0..2 + k % 4)
            .map(|_| from.iter().map(|x| x + rng.range(-0.4, 0.4)).collect())
            .collect();
        let begin = rng.range(-1.0, 8.0);
        let times = [begin, begin + 3.0];
        let curve = bezier(&points);
        let curve = curve.with_times(times).expect("times");
        let is_free = checker.is_free_along(&JointMotion::curve(&curve));
        let proof = crate::prove(&mut checker, &JointMotion::curve(&curve)).expect("within limits");
        assert_eq!(proof.is_some(), is_free);
        let tube = checker.verdict_of(&tubed(&curve, &[1e-9; 4]));
        assert_eq!(tube.is_free(), is_free);
        checker.set_time(begin).expect("a pose");
        let before = checker.clearance(&curve.at(0.0)).expect("within limits");
        let clearance = checker
            .clearance_along(&JointMotion::curve(&curve), 1e-2)
            .expect("within limits");
        assert_eq!(clearance.lower > 0.0, is_free, "{clearance:?}");
        // The clearance along a curve leaves the time of configurations as it was.
        let after = checker.clearance(&curve.at(0.0)).expect("within limits");
        let distance = |near: Option<lin_canny_plan::NearPair>| near.expect("a pair").distance;
        assert!((distance(before) - distance(after)).abs() < 1e-14);
        if !is_free {
            continue;
        }
        free += 1;
        proof.expect("a proof").iter().for_each(crate::judge::follow);
        let least = (0..=200).map(|i| {
            let t = f64::from(i) / 200.0;
            checker.set_time(begin + 3.0 * t).expect("a pose");
            let near = checker.clearance(&curve.at(t)).expect("within limits");
            near.expect("a pair").distance
        });
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(clearance.lower <= least, "{clearance:?} {least}");
        assert!(least <= clearance.upper * (1.0 + 1e-2) + 1e-2, "{clearance:?} {least}");
    }
    assert!(free > 5, "{free}");
}

#[test]
fn verdicts_have_the_same_bits_on_every_thread_and_after_reset() {
    let ask = |checker: &mut Checker<JointTree>| -> Vec<String> {
        let mut rng = Rng::new(9);
        let each = (0..10).map(|k| {
            let from: Vec<f64> = (0..5).map(|_| rng.range(-1.0, 1.0)).collect();
            let points: Vec<Vec<f64>> = (0..2 + k % 4)
                .map(|_| from.iter().map(|x| x + rng.range(-0.5, 0.5)).collect())
                .collect();
            let begin = rng.range(-1.0, 6.0);
            let curve = bezier(&points);
            let curve = curve.with_times([begin, begin + 5.0]).expect("times");
            checker.reset();
            let verdict = checker.certify(&JointMotion::curve(&curve));
            checker.reset();
            let clearance = checker.clearance_along(&JointMotion::curve(&curve), 0.01);
            checker.set_time(begin).expect("a pose");
            let batch = [1, 3].map(|threads| checker.nearest_batch(&points.concat(), 3, 0.5, threads).expect("rows"));
            assert_eq!(batch[0], batch[1]);
            format!("{verdict:?} {clearance:?} {batch:?}")
        });
        each.collect()
    };
    let new = || {
        let (space, cell) = truth::arm::chain::chain(5, [-1e3, 1e3]).expect("an arm");
        among(space, cell, &mut Rng::new(77), 1.8)
    };
    let mut checker = new();
    let expected = ask(&mut checker);
    assert_eq!(ask(&mut checker), expected);
    let threads: Vec<_> = (0..3).map(|_| std::thread::spawn(move || ask(&mut new()))).collect();
    for thread in threads {
        assert_eq!(thread.join().expect("no panic"), expected);
    }
}

/// Scenes of all sizes have the same verdicts: to the bit, unless the size crosses a limit of storage.
#[test]
fn scenes_of_all_sizes_have_equal_verdicts() {
    type Found = Option<([f64; 2], CellPair)>;
    let scene = |exponent: i32, clock: f64| -> Vec<Found> {
        let unit = 2f64.powi(exponent);
        let placed = |x: f64, y: f64, turn: f64| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * turn);
            Isometry3::from_parts(Translation3::new(x * unit, y * unit, 0.0), turn)
        };
        let rows = [placed(0.0, 6.0, 0.0), placed(1.0, 2.0, 1.0), placed(-4.0, 2.5, -1.0)];
        let times = [0.0, 2.0, 4.0].map(|t| t * clock);
        let ball = Geometry::from(Shape::ball(0.7 * unit).expect("a ball"));
        let carts = [
            (cuboid([unit, 0.5 * unit, unit]), poses(&times, &rows)),
            (ball, poses(&times, &rows.map(|r| placed(3.0, 0.0, 0.0) * r))),
        ];
        let mut checker = slider(0.5 * unit, &carts);
        let mut found = Vec::new();
        for y in [-1.0, 0.5, 0.9, 1.0, 1.2, 2.0] {
            let points = [[-2.0, 0.0, 0.0], [0.0, y, 1.0], [2.0, y, -1.0], [3.0, 0.0, 0.0]];
            let points = points.map(|[x, y, turn]| [x * unit, y * unit, turn]);
            let verdict = certify(&mut checker, &points, [0.5 * clock, 4.0 * clock]);
            let is_decided = verdict.is_free() || blocked(&verdict).is_some();
            assert!(is_decided, "{exponent}: {verdict:?}");
            found.push(blocked(&verdict));
        }
        found
    };
    let expected = scene(0, 1.0);
    assert!(expected.iter().any(Option::is_none), "{expected:?}");
    assert!(expected.iter().any(Option::is_some), "{expected:?}");
    for exponent in [-40, 40] {
        assert_eq!(scene(exponent, 1.0), expected, "{exponent}");
    }
    for exponent in [-325, -200, -100, 100, 200, 325] {
        for (found, expected) in scene(exponent, 1.0).into_iter().zip(&expected) {
            match (found, *expected) {
                (None, None) => {}
                (Some(([s, t], p)), Some(([safe, at], pair))) if p == pair => {
                    assert!((s - safe).abs() < 1e-9, "{exponent}: {s} {t} {expected:?}");
                    assert!((t - at).abs() < 1e-9, "{exponent}: {s} {t} {expected:?}");
                }
                (found, expected) => panic!("{exponent}: {found:?} {expected:?}"),
            }
        }
    }
    for clock in [2f64.powi(-325), 2f64.powi(-40), 2f64.powi(325)] {
        assert_eq!(scene(0, clock), expected, "{clock:e}");
    }
}

/// A rigid robot in the plane of a conveyor: every space follows straight curves among moving obstacles.
#[test]
fn spaces_without_joints_follow_straight_curves() {
    let mut cell = Cell::new();
    cell.robot_body("drone", cuboid([0.5; 3]));
    let rows = [at(5.0, 0.0, 0.0), at(-5.0, 0.0, 0.0)];
    cell.put_moving("train", cuboid([0.5; 3]), poses(&[0.0, 10.0], &rows));
    let space = TranslationSpace::new([[-9.0, 9.0]; 3], UnitQuaternion::identity(), 1).expect("a space");
    assert_eq!(space.coordinates(), 3);
    let mut checker = Checker::new(space, cell).expect("a world");
    let to = |y: f64| {
        let curve = bezier(&[[-5.0, 0.0, 0.0], [5.0, y, 0.0]]);
        curve.with_times([0.0, 10.0]).expect("times")
    };
    let found = checker.verdict_of(&JointMotion::curve(&to(0.0)));
    assert!(
        matches!(found, Verdict::Blocked { contact_at: t, .. } if (t - 0.45).abs() < 1e-5),
        "{found:?}"
    );
    assert!(checker.is_free_along(&JointMotion::curve(&to(9.0))));
}
