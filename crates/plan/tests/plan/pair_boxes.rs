//! Boxes of joint values in which pairs of robot bodies are apart: with and without them a checker says the same.

use core::ops::Range;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{
    AtlasOptions, Checker, ConfigurationSpace, Joint, JointTree, PairBoxes, PlanError, SerialArm, World,
};
use truth::rng::Rng;

use crate::atlas::random_checker;
use crate::ranges::at;

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
        plain.forget();
        with.forget();
        // A world with obstacles that move has no segments.
        let Ok(verdict) = plain.certify(&from, &to) else {
            continue;
        };
        assert_eq!(
            with.certify(&from, &to).expect("a segment"),
            verdict,
            "{k}: {from:?} {to:?}"
        );
        let is_free = with.is_free(&from, &to).expect("a segment");
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
        let options = AtlasOptions::default().boxes(300);
        let boxes = plain.pair_boxes(&options).expect("boxes");
        let Some((pair, atlas)) = boxes.pairs().next() else {
            continue;
        };
        // Budgets, not chance: a second search finds the same.
        let again = plain.fork().expect("a checker").pair_boxes(&options).expect("boxes");
        assert!(again.pairs().next() == Some((pair, atlas)), "{k}");
        let mut first = plain.fork().expect("a checker");
        first.set_pair_boxes(&boxes).expect("the boxes of this robot");
        // A fork has them too.
        let mut with = first.fork().expect("a checker");
        let [free, lookups] = judge(&mut plain, &mut with, samples, &mut rng);
        // A pair that must keep more than its boxes prove is queried.
        let kept = plain.world().kept_distance(pair);
        for checker in [&mut plain, &mut with] {
            checker
                .set_pair_margin(pair.a, pair.b, Some(1.5 * kept))
                .expect("a margin");
        }
        let [_, none] = judge(&mut plain, &mut with, samples / 4, &mut rng);
        assert_eq!(none, 0, "{k}");
        // It must keep less: the boxes prove more than that.
        for checker in [&mut plain, &mut with] {
            checker.set_pair_margin(pair.a, pair.b, Some(0.0)).expect("a margin");
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
fn blocks(count: usize, half: f64) -> Checker<SerialArm> {
    let rail = |_| Joint::prismatic(Isometry3::identity(), Vector3::x_axis(), [0.0, 4.0]);
    let arm = SerialArm::new(
        Isometry3::identity(),
        (0..count).map(rail).collect(),
        (1..=count).collect(),
        0.1,
    );
    let mut world = World::new();
    for k in 0..count {
        world.robot_body(
            format!("block {k}"),
            solids::cuboid(Vector3::repeat(half)).expect("a box"),
        );
    }
    Checker::new(arm.expect("an arm"), world).expect("a checker")
}

#[test]
fn only_pairs_with_one_or_two_joints_have_boxes() {
    let mut checker = blocks(5, 0.25);
    let boxes = checker.pair_boxes(&AtlasOptions::default().boxes(50)).expect("boxes");
    let pairs: Vec<String> = boxes.pairs().map(|(pair, _)| pair.to_string()).collect();
    let near = |k: usize| (1..=2).map(move |d| (k, k + d)).filter(|(_, b)| *b < 5);
    let expected = (0..5).flat_map(near);
    let expected: Vec<String> = expected
        .map(|(a, b)| format!("robot body {a} and robot body {b}"))
        .collect();
    assert_eq!(pairs, expected);
    for (_, atlas) in boxes.pairs() {
        assert!(atlas.searched() <= 50 && atlas.shares().free > 0.5, "{atlas:?}");
    }
}

#[test]
fn boxes_of_another_robot_are_refused() {
    let of = |checker: &mut Checker<SerialArm>| -> PairBoxes {
        checker.pair_boxes(&AtlasOptions::default().boxes(50)).expect("boxes")
    };
    let mut checker = blocks(2, 0.25);
    let other = of(&mut blocks(2, 0.25));
    let said = checker.set_pair_boxes(&other).expect_err("other bodies");
    assert!(matches!(said, PlanError::OtherAtlas(_)), "{said}");
    // The same bodies on other rails.
    let rail = |axis| Joint::prismatic(Isometry3::identity(), axis, [0.0, 4.0]);
    let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    let arm = SerialArm::new(Isometry3::identity(), rails, vec![1, 2], 0.1).expect("an arm");
    let mut bent = Checker::new(arm, checker.world().clone()).expect("a checker");
    let own = of(&mut checker);
    let said = bent.set_pair_boxes(&own).expect_err("other joints").to_string();
    assert!(said.ends_with("block 0 and block 1: the joints differ"), "{said}");
    let mut copy = Checker::new(checker.space().clone(), checker.world().clone()).expect("a checker");
    copy.set_pair_boxes(&own).expect("the same robot");
    assert!(copy.is_free_at(&[0.0, 0.8]).expect("a configuration"));
    assert_eq!(copy.work().lookups, 1);
}
