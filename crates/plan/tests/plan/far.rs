//! Segments over which many joints turn far: what is called free is free, and the work stays small.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{Checker, ConfigurationSpace, Joint, SerialArm, Verdict, World};
use std::f64::consts::TAU;
use truth::rng::Rng;

/// An arm of links of 0.2 m that bend in turn about two axes, among twelve posts.
fn checker(joints: usize) -> Checker<SerialArm> {
    let mut world = World::new();
    let link = solids::cuboid(Vector3::new(0.1, 0.04, 0.03)).expect("a box");
    let link = link
        .transformed(&Isometry3::translation(0.11, 0.0, 0.0))
        .expect("a box");
    let mut chain = Vec::new();
    for k in 0..joints {
        let axis = if k % 2 == 0 {
            Vector3::z_axis()
        } else {
            Vector3::y_axis()
        };
        let origin = Isometry3::translation(if k == 0 { 0.0 } else { 0.22 }, 0.0, 0.0);
        chain.push(Joint::revolute(origin, axis, [-3.2, 3.2]));
        world.robot_body(format!("link {k}"), link.clone());
    }
    for k in 0..12 {
        let angle = TAU * f64::from(k) / 12.0;
        let post = solids::cuboid(Vector3::new(0.03, 0.03, 0.6)).expect("a box");
        let place = Vector3::new(1.1 * angle.cos(), 1.1 * angle.sin(), 0.0);
        world.obstacle(format!("post {k}"), post, Isometry3::new(place, Vector3::z() * angle));
    }
    for k in 1..joints {
        world
            .exclude(&format!("link {}", k - 1), &format!("link {k}"))
            .expect("names");
    }
    let arm = SerialArm::new(Isometry3::identity(), chain, (1..=joints).collect(), 0.3).expect("an arm");
    Checker::new(arm, world).expect("a world")
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
        let verdict = checker.certify(&from, &to).expect("within limits");
        if verdict.is_free() {
            free += 1;
            work += checker.work().queries - before;
        }
        let at = |t: f64| checker.space().between(&from, &to, t);
        for k in 0..=300 {
            let t = verdict.safe() * f64::from(k) / 300.0;
            let apart = judge.is_free_at(&at(t)).expect("within limits");
            let starts = matches!(verdict, Verdict::Blocked { t: 0.0, .. });
            assert!(apart || starts, "{verdict:?} meets at {t} of {from:?} {to:?}");
        }
        if let Verdict::Blocked { t, .. } = verdict {
            assert!(!judge.is_free_at(&at(t)).expect("within limits"), "{verdict:?}");
        }
    }
    assert!(free >= 10, "{free}");
    work as f64 / f64::from(free)
}

/// Bounds of motions that turn thousands of times are of no use, and still the answer comes.
#[test]
fn joints_that_turn_thousands_of_times_end() {
    let mut world = World::new();
    let (mut chain, joints) = (Vec::new(), 9);
    for _ in 0..joints {
        let origin = Isometry3::translation(0.22, 0.0, 0.0);
        chain.push(Joint::revolute(origin, Vector3::z_axis(), [-1e15, 1e15]));
        world.robot_body("link", solids::cuboid(Vector3::new(0.1, 0.04, 0.03)).expect("a box"));
    }
    let post = solids::cuboid(Vector3::new(0.03, 0.03, 0.6)).expect("a box");
    world.obstacle("post", post, Isometry3::translation(0.0, 30.0, 0.0));
    world.exclude("link", "link").expect("names");
    let arm = SerialArm::new(Isometry3::identity(), chain, (1..=joints).collect(), 0.3).expect("an arm");
    let mut checker = Checker::new(arm, world).expect("a world");
    for turn in [1e4, 1e9, 1e15] {
        let verdict = checker.certify(&vec![-turn; joints], &vec![turn; joints]);
        assert!(!matches!(verdict, Ok(Verdict::Blocked { .. })), "{verdict:?}");
    }
}

/// Before links were looked at from the last link they share, before balls and boxes knew how far their bounds hold, 14 joints
/// over 2 rad took 1,028 queries, and over 0.5 rad 212.
#[test]
fn joints_that_turn_far_take_few_queries() {
    for (joints, most, limit) in [(6, 0.5, 8.0), (6, 2.0, 25.0), (14, 0.5, 30.0), (14, 2.0, 90.0)] {
        let mean = queries(joints, most);
        println!("{joints} joints over {most}: {mean:.1}");
        assert!(mean < limit, "{joints} joints over {most}: {mean}");
    }
}
