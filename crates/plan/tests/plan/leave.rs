//! Promise: a part that an arm lifts from a table, or slides over it, never enters the table.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{ContactState, Geometry, Mesh, PairTracker, RelativePose, Shape};
use lin_canny_plan::{Cell, CellBody, Checker, ConfigurationSpace, Joint, JointMotion, JointTree, PlanError, Verdict};
use truth::plans::{Ask, Furnish, cuboid};
use truth::rng::Rng;

/// An arm that moves its last link along x, y and z, and then rotates it about z and x.
fn arm() -> JointTree {
    let here = Isometry3::identity();
    let slide = |axis| Joint::prismatic(here, axis, [-2.0, 2.0]);
    let turn = |axis| Joint::revolute(here, axis, [-3.0, 3.0]);
    let joints = vec![
        slide(Vector3::x_axis()),
        slide(Vector3::y_axis()),
        slide(Vector3::z_axis()),
        turn(Vector3::z_axis()),
        turn(Vector3::x_axis()),
    ];
    JointTree::serial(here, joints, vec![5], 0.5).expect("an arm")
}

fn parts() -> [Geometry; 3] {
    let die = cuboid([0.2, 0.1, 0.05]);
    let slim = cuboid([0.19, 0.09, 0.04]);
    [
        Mesh::from_convex(&die).expect("a mesh").into(),
        die.into(),
        Shape::rounded(slim.into(), 0.01).expect("a rounded box").into(),
    ]
}

/// Returns bounds of the signed distance.
fn signed(a: &Geometry, b: &Geometry, pose: &RelativePose) -> [f64; 2] {
    let mut tracker = PairTracker::new();
    let found = tracker.closest(a, b, pose);
    if found.state == ContactState::Separated || (a.as_convex().is_some() && b.as_convex().is_some()) {
        return [found.lower, found.upper];
    }
    let depth = tracker.penetration(a, b, pose).expect("solids");
    [-depth.upper, -depth.lower]
}

fn run(seed: u64, count: u64) {
    let mut tally = [0; 4];
    for case in 0..count {
        let mut rng = Rng::of_case(seed, case);
        let table = rng.pick(&parts()).clone();
        let mut cell = Cell::new();
        cell.robot_body("hand", Shape::ball(0.01).expect("a ball"));
        let space = arm();
        let mut checker = Checker::new(space, cell).expect("a checker");
        // The part is below the hand, and the table is below the part.
        let below = Isometry3::translation(0.0, 0.0, -0.3);
        let id = checker
            .cell_mut()
            .attach("hand", "part", rng.pick(&parts()).clone(), below, &["hand"]);
        let id = id.expect("an object");
        let q: Vec<f64> = (0..5).map(|_| rng.range(-0.5, 0.5)).collect();
        let upright = rng.chance(0.5);
        let q = if upright { [&q[..4], &[0.0]].concat() } else { q };
        let resting = checker.pose(id, &q).expect("a pose") * Isometry3::translation(0.1, 0.05, -0.1);
        checker.cell_mut().put("table", table.clone(), resting);
        let margin = [0.0, 5e-4][rng.below(2)];
        checker.cell_mut().set_margin(margin).expect("a margin");
        checker.set_start_contact_margin(Some(1e-3)).expect("a margin");
        let mut goal: Vec<f64> = q.iter().map(|x| x + rng.range(-0.4, 0.4)).collect();
        let is_sliding = upright && rng.chance(0.5);
        if is_sliding {
            (goal[2], goal[4]) = (q[2], q[4]);
        } else if upright && rng.chance(0.7) {
            (goal[2], goal[4]) = (q[2] + rng.range(0.1, 0.4), q[4]);
        }
        let is_up = upright && goal[4] == q[4];
        let verdict = checker.verdict_of(&JointMotion::segment(&q, &goal));
        let part = checker.cell().geometry(id).expect("an object").clone();
        let distance = |t: f64| {
            let at = checker.space().between(&q, &goal, t);
            let pose = checker.pose(id, &at).expect("a pose");
            signed(&part, &table, &RelativePose::new(&pose, &resting).expect("a pose"))
        };
        assert!(!is_up || verdict.is_free(), "{case}: {}", checker.show(&verdict));
        match &verdict {
            Verdict::Free { start_contacts, .. } => {
                tally[usize::from(is_sliding)] += 1;
                let [leaving] = start_contacts[..] else {
                    panic!("{case}: {verdict:?}")
                };
                assert_eq!([leaving.pair.a, leaving.pair.b], [id, CellBody::Obstacle(0)]);
                let contact = leaving.contact;
                assert!(contact.distance.abs() < 2e-9 && contact.kept > -2e-9, "{contact:?}");
                assert!(
                    !is_sliding || contact.until.is_none_or(|t| t > 0.1),
                    "{case}: {contact:?}"
                );
                for k in 0..=50 {
                    let t = f64::from(k) / 50.0;
                    let keep = if contact.until.is_some_and(|until| t >= until) {
                        margin
                    } else {
                        contact.kept
                    };
                    assert!(distance(t)[1] >= keep, "{case} at {t}: {:?} < {keep}", distance(t));
                }
                let names = checker.show(&verdict).to_string();
                assert!(names.ends_with("leaving the contact of part and table"), "{names}");
            }
            Verdict::Blocked { contact_at: t, .. } => {
                tally[2] += 1;
                assert!(distance(*t)[0] <= margin, "{case} at {t}: {:?}", distance(*t));
            }
            _ => tally[3] += 1,
        }
        // Without the option the contact is a contact.
        checker.set_start_contact_margin(None).expect("none");
        assert!(matches!(
            checker.certify(&JointMotion::segment(&q, &goal)),
            Ok(Verdict::Blocked { free_until: 0.0, .. } | Verdict::Undecided { free_until: 0.0, .. })
        ));
    }
    println!("lifted, slid, blocked, undecided: {tally:?}");
    assert!(tally[3] * 50 <= count, "{tally:?}");
    assert!(tally[..3].iter().all(|n| 20 * n > count), "{tally:?}");
}

#[test]
fn parts_are_lifted_and_slid_but_not_pressed() {
    run(1, 100);
}

#[test]
#[ignore = "10,000 motions, half a minute: cargo test --release --all-features -p lin-canny-plan --test plan leave -- --ignored"]
fn parts_are_lifted_and_slid_but_not_pressed_in_full() {
    run(2, 10_000);
}

#[test]
fn margins_out_of_range_are_named() {
    let mut cell = Cell::new();
    cell.robot_body("hand", Shape::ball(0.01).expect("a ball"));
    let mut checker = Checker::new(arm(), cell).expect("a checker");
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let found = checker.set_start_contact_margin(Some(bad)).expect_err("an error");
        assert!(
            matches!(
                found,
                PlanError::Value {
                    what: "start contact margin",
                    ..
                }
            ),
            "{found:?}"
        );
    }
}
