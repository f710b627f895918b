//! Segments over which many joints turn far: what is called free is free, and the work stays small.

use crate::wrapped::Wrapped;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_plan::{Cell, Checker, ConfigurationSpace, Joint, JointMotion, JointTree, Verdict};
use truth::arm::chain::chain;
use truth::plans::{Ask, Furnish, cuboid};
use truth::rng::Rng;

fn checker(joints: usize) -> Checker<JointTree> {
    let (arm, cell) = arm_among_posts(joints);
    Checker::new(arm, cell).expect("a world")
}

fn arm_among_posts(joints: usize) -> (JointTree, Cell) {
    chain(joints, [-3.2, 3.2]).expect("an arm")
}

/// Queries of the free ones among random segments of joints that turn up to `most`, on average. Each segment is judged by
/// predicates: free all the way, or free up to the contact, and in contact there.
fn queries(joints: usize, most: f64) -> f64 {
    let (mut checker, mut judge) = (checker(joints), checker(joints));
    let mut rng = Rng::new(5);
    let (mut free, mut work) = (0, 0);
    for _ in 0..120 {
        let from: Vec<f64> = (0..joints).map(|_| rng.range(-1.0, 1.0)).collect();
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-most, most)).collect();
        let before = checker.work().queries;
        let verdict = checker.verdict_of(&JointMotion::segment(&from, &to));
        if verdict.is_free() {
            free += 1;
            work += checker.work().queries - before;
        }
        let at = |t: f64| checker.space().between(&from, &to, t);
        for k in 0..=300 {
            let t = verdict.free_until() * f64::from(k) / 300.0;
            let apart = judge.is_free_at(&at(t)).expect("within limits");
            let starts = matches!(verdict, Verdict::Blocked { contact_at: 0.0, .. });
            assert!(apart || starts, "{verdict:?} meets at {t} of {from:?} {to:?}");
        }
        if let Verdict::Blocked { contact_at: t, .. } = verdict {
            assert!(!judge.is_free_at(&at(t)).expect("within limits"), "{verdict:?}");
        }
    }
    assert!(free >= 10, "{free}");
    work as f64 / f64::from(free)
}

/// Bounds of motions that turn thousands of times are of no use, and still the answer comes.
#[test]
fn joints_that_turn_thousands_of_times_end() {
    let mut cell = Cell::new();
    let (mut chain, joints) = (Vec::new(), 9);
    for _ in 0..joints {
        let origin = Isometry3::translation(0.22, 0.0, 0.0);
        chain.push(Joint::revolute(origin, Vector3::z_axis(), [-1e15, 1e15]));
        cell.robot_body("link", cuboid([0.1, 0.04, 0.03]));
    }
    let post = cuboid([0.03, 0.03, 0.6]);
    cell.put("post", post, Isometry3::translation(0.0, 30.0, 0.0));
    cell.exclude("link", "link").expect("names");
    let arm = JointTree::serial(Isometry3::identity(), chain, (1..=joints).collect(), 0.3).expect("an arm");
    let mut checker = Checker::new(arm, cell).expect("a world");
    for turn in [1e4, 1e9, 1e15] {
        let verdict = checker.certify(&JointMotion::segment(&vec![-turn; joints], &vec![turn; joints]));
        assert!(!matches!(verdict, Ok(Verdict::Blocked { .. })), "{verdict:?}");
    }
}

/// Before links were looked at from the last link they share, before balls and boxes knew how far their bounds hold, 14 joints
/// over 2 rad took 1,028 queries, and over 0.5 rad 212. While motions were stated about the origins of links, not about the
/// middles of bodies, they took 56 and 22.
#[test]
fn joints_that_turn_far_take_few_queries() {
    for (joints, most, limit) in [(6, 0.5, 2.0), (6, 2.0, 4.0), (14, 0.5, 4.0), (14, 2.0, 8.0)] {
        let mean = queries(joints, most);
        println!("{joints} joints over {most}: {mean:.1}");
        assert!(mean < limit, "{joints} joints over {most}: {mean}");
    }
}

/// Motions about the origins of links and about the middles of bodies, which a wrapped space does not
/// know, must find the same, each within its own bracket.
fn same_verdicts(joints: usize, most: f64, count: usize) -> [u64; 2] {
    let (arm, cell) = arm_among_posts(joints);
    let mut about_origins = Checker::new(Wrapped::new(arm), cell).expect("a world");
    let (mut about_middles, mut judge) = (checker(joints), checker(joints));
    let mut rng = Rng::new(6);
    for _ in 0..count {
        let from: Vec<f64> = (0..joints).map(|_| rng.range(-1.0, 1.0)).collect();
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-most, most)).collect();
        let one = about_origins.verdict_of(&JointMotion::segment(&from, &to));
        let other = about_middles.verdict_of(&JointMotion::segment(&from, &to));
        match (&one, &other) {
            (
                Verdict::Blocked { contact_at: t, .. },
                Verdict::Blocked {
                    contact_at: u,
                    free_until: safe,
                    ..
                },
            ) => {
                assert!(one.free_until() <= *u && *safe <= *t, "{one:?} {other:?}");
                let at = judge.space().between(&from, &to, *u);
                assert!(!judge.is_free_at(&at).expect("within limits"), "{other:?}");
            }
            _ => assert!(one.is_free() && other.is_free(), "{one:?} {other:?}"),
        }
    }
    [about_origins.work().queries, about_middles.work().queries]
}

#[test]
fn verdicts_do_not_depend_on_the_pivot() {
    for (joints, most) in [(6, 0.5), (14, 2.0)] {
        same_verdicts(joints, most, 100);
    }
}

#[test]
#[ignore = "ten thousand segments of each arm"]
fn ten_thousand_verdicts_do_not_depend_on_the_pivot() {
    for (joints, most) in [(6, 0.5), (6, 2.0), (14, 0.5), (14, 2.0)] {
        let queries = same_verdicts(joints, most, 10_000);
        println!("{joints} joints over {most}: queries {queries:?}");
    }
}
