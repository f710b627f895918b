//! Boxes of joint values in which pairs of robot bodies are apart: with and without them a checker says the same.

use core::ops::ControlFlow;
use core::ops::Range;

use lin_canny::Progress;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, Joint, JointMotion, JointTree, PairBoxes, PlanError, PlanarSpace,
};
use truth::rng::Rng;

use crate::range_worlds::add_obstacles;
use crate::ranges::{at, pose, robot};
use truth::plans::{Ask, Furnish, cuboid};

fn random_checker(k: u64, seed: u64) -> Checker<JointTree> {
    let mut rng = Rng::new(seed + k);
    let size = [1.0, 1e-6, 1e6][(k % 3) as usize];
    let (tree, mut cell) = robot(&mut rng, size, seed + k);
    // Every fifth robot is alone.
    if !k.is_multiple_of(5) {
        add_obstacles(&mut cell, &mut rng, size);
        cell.set_pair_margin("a", "cloud", Some(0.2 * size)).expect("a margin");
        cell.set_pair_margin("b", "open box", Some(0.0)).expect("a margin");
        cell.exclude("a", "walls").expect("a pair");
    }
    cell.set_margin(0.03 * size).expect("a margin");
    cell.pad("b", 0.05 * size).expect("a padding");
    let mut checker = Checker::new(tree, cell).expect("a robot");
    let part = cuboid([0.1 * size; 3]);
    let part_pose = pose(&mut rng, 0.5 * size);
    checker.cell_mut().carry("b", "part", part, part_pose, &[]);
    checker.set_time(0.3).expect("a time");
    checker
}

/// Compares two checkers of one world, of which the second has boxes, at random configurations and along segments.
/// Returns how many were free, and how many pairs were looked up.
fn judge(plain: &mut Checker<JointTree>, with: &mut Checker<JointTree>, samples: u32, rng: &mut Rng) -> [u64; 2] {
    let limits = plain.space().bounds().to_vec();
    let [low, high] = [0, 1].map(|k| limits.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
    let before = with.work().lookups;
    let mut free = 0;
    for k in 0..samples {
        let from = at(rng, [&low, &high]);
        let is_free = plain.is_free_at(&from).expect("a configuration");
        assert_eq!(with.is_free_at(&from).expect("a configuration"), is_free, "{from:?}");
        free += u64::from(is_free);
        let to = at(rng, [&low, &high]);
        // Cold trackers give the same bits, wherever the first contact is.
        plain.reset();
        with.reset();
        // A world with obstacles that move has no segments.
        let Ok(verdict) = plain.certify(&JointMotion::segment(&from, &to)) else {
            continue;
        };
        let found = with.verdict_of(&JointMotion::segment(&from, &to));
        assert_eq!(found, verdict, "{k}: {from:?} {to:?}");
        let is_free = with.is_free(&JointMotion::segment(&from, &to)).expect("a segment");
        assert_eq!(is_free, verdict.is_free(), "{k}: {from:?} {to:?}");
        free += u64::from(is_free);
    }
    [free, with.work().lookups - before]
}

fn random_robots(robots: Range<u64>, samples: u32, seed: u64) -> [u64; 3] {
    let mut all = [0; 3];
    for k in robots {
        let mut rng = Rng::new(seed + 500 + k);
        let mut plain = random_checker(k, seed);
        let boxes = PairBoxes::search(&mut plain, 300, &mut |_| ControlFlow::Continue(())).expect("boxes");
        let Some((pair, share)) = boxes.pairs().next() else {
            continue;
        };
        // Budgets, not chance: a second search finds the same.
        let again = PairBoxes::search(&mut plain.fork().expect("a checker"), 300, &mut |_| {
            ControlFlow::Continue(())
        })
        .expect("boxes");
        assert_eq!(again.pairs().next(), Some((pair, share)), "{k}");
        let mut first = plain.fork().expect("a checker");
        first.set_pair_boxes(&boxes).expect("the boxes of this robot");
        // A fork has them too.
        let mut with = first.fork().expect("a checker");
        let [free, lookups] = judge(&mut plain, &mut with, samples, &mut rng);
        // A pair that must keep more than its boxes prove is queried.
        let kept = plain.cell().required_distance(pair).distance;
        for checker in [&mut plain, &mut with] {
            checker
                .cell_mut()
                .set_pair_margin(pair.a, pair.b, Some(1.5 * kept))
                .expect("a margin");
        }
        let [_, none] = judge(&mut plain, &mut with, samples / 4, &mut rng);
        assert_eq!(none, 0, "{k}");
        // It must keep less: the boxes prove more than that.
        for checker in [&mut plain, &mut with] {
            checker
                .cell_mut()
                .set_pair_margin(pair.a, pair.b, Some(0.0))
                .expect("a margin");
        }
        judge(&mut plain, &mut with, samples / 4, &mut rng);
        all.iter_mut()
            .zip([1, free, lookups])
            .for_each(|(sum, count)| *sum += count);
    }
    all
}

#[test]
fn a_checker_says_the_same_with_boxes_of_pairs() {
    let [robots, free, lookups] = random_robots(0..40, 200, 90);
    assert!(robots > 10 && free > 1000 && lookups > 200, "{robots} {free} {lookups}");
}

#[test]
#[ignore = "minutes: cargo test --release -p lin-canny-plan --test plan boxes_of_pairs -- --ignored"]
fn a_thousand_robots_say_the_same_with_boxes_of_pairs() {
    let counts = random_robots(crate::chosen_robots(0..1_000), 2_000, 800_000);
    println!("robots, free, lookups: {counts:?}");
}

/// Blocks on rails, one after the other.
fn blocks(count: usize, half: f64) -> Checker<JointTree> {
    let rail = |_| Joint::prismatic(Isometry3::identity(), Vector3::x_axis(), [0.0, 4.0]);
    let arm = JointTree::serial(
        Isometry3::identity(),
        (0..count).map(rail).collect(),
        (1..=count).collect(),
        0.1,
    );
    let mut cell = Cell::new();
    for k in 0..count {
        cell.robot_body(format!("block {k}"), cuboid([half; 3]));
    }
    Checker::new(arm.expect("an arm"), cell).expect("a checker")
}

#[test]
fn only_pairs_with_one_or_two_joints_have_boxes() {
    let mut checker = blocks(5, 0.25);
    let boxes = PairBoxes::search(&mut checker, 50, &mut |_| ControlFlow::Continue(())).expect("boxes");
    let pairs: Vec<String> = boxes.pairs().map(|(pair, _)| pair.to_string()).collect();
    let near = |k: usize| (1..=2).map(move |d| (k, k + d)).filter(|(_, b)| *b < 5);
    let expected = (0..5).flat_map(near);
    let expected: Vec<String> = expected
        .map(|(a, b)| format!("robot body {a} and robot body {b}"))
        .collect();
    assert_eq!(pairs, expected);
    assert!(boxes.pairs().all(|(_, share)| share > 0.5), "{boxes:?}");
}

/// A block on two rails about a post, which belongs to the robot.
fn square([x, y]: [[f64; 2]; 2]) -> Checker<JointTree> {
    let rail = |axis, limits| Joint::prismatic(Isometry3::identity(), axis, limits);
    let rails = vec![rail(Vector3::x_axis(), x), rail(Vector3::y_axis(), y)];
    let arm = JointTree::serial(Isometry3::identity(), rails, vec![0, 2], 0.1);
    let mut cell = Cell::new();
    cell.robot_body("post", cuboid([0.5; 3]));
    cell.robot_body("block", cuboid([0.1; 3]));
    Checker::new(arm.expect("an arm"), cell).expect("a checker")
}

fn share_of(boxes: &PairBoxes) -> f64 {
    let shares: Vec<f64> = boxes.pairs().map(|(_, share)| share).collect();
    assert_eq!(shares.len(), 1, "{boxes:?}");
    shares[0]
}

#[test]
fn the_volume_of_a_square_is_known() {
    let mut checker = square([[-2.0, 2.0]; 2]);
    let apart = 1.0 - 1.2 * 1.2 / 16.0;
    let share = share_of(&PairBoxes::search(&mut checker, 20_000, &mut |_| ControlFlow::Continue(())).expect("boxes"));
    assert!(share < apart && share > apart - 2e-3, "{share}");
    // One of two coordinates has a width, and the post ends a box within rounding.
    let share = share_of(
        &PairBoxes::search(&mut square([[-2.0, 2.0], [0.0; 2]]), 5_000, &mut |_| {
            ControlFlow::Continue(())
        })
        .expect("boxes"),
    );
    assert!((share - 0.7).abs() < 1e-9, "{share}");
    // Without a width there is one box.
    for (x, apart) in [(0.3, 0.0), (0.7, 1.0)] {
        let mut checker = square([[x; 2], [0.0; 2]]);
        let boxes = PairBoxes::search(&mut checker, 10, &mut |_| ControlFlow::Continue(())).expect("boxes");
        assert_eq!(share_of(&boxes), apart);
        checker.set_pair_boxes(&boxes).expect("the boxes");
        assert_eq!(checker.is_free_at(&[x, 0.0]).expect("a configuration"), apart == 1.0);
        assert_eq!(checker.work().lookups, apart as u64);
    }
}

#[test]
fn configurations_and_segments_on_faces_are_looked_up() {
    let mut plain = square([[-2.0, 2.0]; 2]);
    let boxes = PairBoxes::search(&mut plain, 3_000, &mut |_| ControlFlow::Continue(())).expect("boxes");
    let mut with = plain.fork().expect("a checker");
    with.set_pair_boxes(&boxes).expect("the boxes");
    // Sums of powers of two, where boxes meet.
    let node = |k: u64| -2.0 + 0.125 * k as f64;
    let (mut rng, mut free) = (Rng::new(9), 0);
    for k in 0..33 * 33 {
        let from = [node(k % 33), node(k / 33)];
        let is_free = plain.is_free_at(&from).expect("a configuration");
        assert_eq!(with.is_free_at(&from).expect("a configuration"), is_free, "{from:?}");
        let mut to = [0, 1].map(|_| node(rng.bits() % 33));
        // Many segments are along a face.
        if k % 2 == 0 {
            to[(k / 2 % 2) as usize] = from[(k / 2 % 2) as usize];
        }
        plain.reset();
        with.reset();
        let verdict = plain.verdict_of(&JointMotion::segment(&from, &to));
        let found = with.verdict_of(&JointMotion::segment(&from, &to));
        assert_eq!(found, verdict, "{from:?} {to:?}");
        free += u64::from(is_free) + u64::from(verdict.is_free());
    }
    // Balls and boxes decide most of them before a lookup.
    let (work, other) = (with.work(), plain.work());
    assert!(work.lookups > 0, "{work:?} {other:?}");
    assert!(work.decisions <= other.decisions, "{work:?} {other:?}");
    assert!(free > 1_500, "{free}");
}

#[test]
fn a_search_that_is_stopped_keeps_its_boxes() {
    let mut checker = square([[-2.0, 2.0]; 2]);
    let mut counts = Vec::new();
    let stopped = PairBoxes::search(&mut checker, 1_000, &mut |now| {
        counts.push(now.done);
        Progress::stop_if(now.done == 200)
    });
    let stopped = share_of(&stopped.expect("boxes"));
    assert_eq!(counts, (1..=200).collect::<Vec<_>>());
    let expected = share_of(&PairBoxes::search(&mut checker, 200, &mut |_| ControlFlow::Continue(())).expect("boxes"));
    assert_eq!(stopped, expected);
    assert!(stopped > 0.5);
    assert!(
        stopped < share_of(&PairBoxes::search(&mut checker, 1_000, &mut |_| ControlFlow::Continue(())).expect("boxes"))
    );
    let found = share_of(&PairBoxes::search(&mut checker, 0, &mut |_| ControlFlow::Continue(())).expect("boxes"));
    assert_eq!(found, 0.0);
}

#[test]
fn a_coordinate_without_limits_is_an_error() {
    let space = PlanarSpace::new([[-2.0, 2.0]; 2], 0.5, 1).expect("a space");
    let mut cell = Cell::new();
    cell.robot_body("block", cuboid([0.1; 3]));
    let refused = PairBoxes::search(&mut Checker::new(space, cell).expect("a checker"), 10, &mut |_| {
        ControlFlow::Continue(())
    });
    assert!(matches!(refused, Err(PlanError::Value { .. })), "{refused:?}");
}

#[test]
fn boxes_of_another_robot_are_refused() {
    let of = |checker: &mut Checker<JointTree>| -> PairBoxes {
        PairBoxes::search(checker, 50, &mut |_| ControlFlow::Continue(())).expect("boxes")
    };
    let mut checker = blocks(2, 0.25);
    let other = of(&mut blocks(2, 0.25));
    let said = checker.set_pair_boxes(&other).expect_err("other bodies");
    assert!(matches!(said, PlanError::OtherPairBoxes(_)), "{said}");
    // The same bodies on other rails.
    let rail = |axis| Joint::prismatic(Isometry3::identity(), axis, [0.0, 4.0]);
    let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    let arm = JointTree::serial(Isometry3::identity(), rails, vec![1, 2], 0.1).expect("an arm");
    let mut bent = Checker::new(arm, checker.cell().clone()).expect("a checker");
    let own = of(&mut checker);
    let said = bent.set_pair_boxes(&own).expect_err("other joints").to_string();
    assert!(said.ends_with("block 0 and block 1: the joints differ"), "{said}");
    let mut copy = Checker::new(checker.space().clone(), checker.cell().clone()).expect("a checker");
    copy.set_pair_boxes(&own).expect("the same robot");
    assert!(copy.is_free_at(&[0.0, 0.8]).expect("a configuration"));
    assert_eq!(copy.work().lookups, 1);
}
