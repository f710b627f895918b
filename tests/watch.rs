//! Promise: a watched distance is off by no more than is allowed, its bounds hold, and its yes and no are those of exact
//! arithmetic, however seldom the watch looks.

mod support;

use lab::Pose;
use lab::exact::solve;
use lab::motion::{self, Frame};
use lab::pose::{add, scale};
use lab::rng::Rng;
use lab::shapes::{self, Shape};
use lin_canny::{Class, Tracker, Watch};
use support::{between, body, class};

/// Small solids, one of them far from its own origin, one large and one small.
fn solids(rng: &mut Rng) -> Vec<Shape> {
    let away = shapes::sphere(rng, 8).moved(&Pose::shift([30.0, -20.0, 10.0])).solved();
    vec![
        shapes::cube(),
        shapes::octahedron(),
        shapes::sphere(rng, 9).solved(),
        shapes::cuboid([4.0, 3.0, 0.25]),
        shapes::cuboid([0.1, 0.2, 0.1]),
        away,
    ]
}

/// The pose that puts the middle of a shape where `pose` puts the origin.
fn about(shape: &Shape, pose: &Pose) -> Pose {
    let middle = scale(
        shape.points.iter().fold([0.0; 3], |s, &p| add(s, p)),
        1.0 / shape.points.len() as f64,
    );
    Pose {
        t: pose.apply(middle.map(|x| -x)),
        ..*pose
    }
}

fn motions(rng: &mut Rng) -> Vec<Frame> {
    let slow = motion::orbit_and_spin(rng, 60, 0.05, (1.0, 1.0), (-0.8, 0.6), 180);
    let quick = motion::pass_through(rng, 60, (1.0, 1.0), 0.2);
    let jumps = motion::random_poses(rng, 20, (1.0, 1.0), (0.1, 2.0), 3.0);
    [slow, quick, jumps].concat()
}

#[test]
fn distances_keep_to_the_error_and_bounds_hold() {
    let mut rng = Rng::new(81);
    let solids = solids(&mut rng);
    let (mut known, mut classes, mut used) = (0, [0; 3], 0.0f64);
    for round in 0..24 {
        let (a, b) = (rng.pick(&solids).clone(), rng.pick(&solids).clone());
        let (body_a, body_b) = (body(&a), body(&b));
        let error = [1e-1, 1e-2, 1e-3, 0.0][round % 4];
        let mut watch = Watch::new(&body_a, &body_b);
        for f in motions(&mut rng) {
            let (pa, pb) = (about(&a, &f.a), about(&b, &f.b));
            let truth = solve((&a).into(), &pa, (&b).into(), &pb);
            let before = watch.looked();
            let d = watch.distance(&between(&pa, &pb), error);
            let what = format!("{} {} {error}: {d:?}, truth {}", a.name, b.name, truth.distance);
            if d.class != class(truth.class) {
                assert!(d.class == Class::Touching && d.lower <= 0.0 && d.upper >= 0.0, "{what}");
                assert!(watch.looked() == before, "{what}");
            }
            assert!(
                d.lower <= truth.distance.next_up() && truth.distance.next_down() <= d.upper,
                "{what}"
            );
            if watch.looked() == before {
                known += 1;
                classes[d.class as usize] += 1;
                used = used.max((d.value - truth.distance).abs() / error);
            }
            let slack = 1e-13 * 100.0;
            assert!((d.value - truth.distance).abs() <= error.max(slack), "{what}");
        }
        assert_eq!(watch.asked(), 140);
    }
    // The mix: answers known without a look, apart and overlapping, and errors that come near to what is allowed.
    assert!(
        known > 300 && classes[0] > 100 && classes[2] > 100,
        "{known} {classes:?}"
    );
    assert!((0.5..=1.0).contains(&used), "{used}");
}

#[test]
fn yes_and_no_are_exact() {
    let mut rng = Rng::new(82);
    let solids = solids(&mut rng);
    let (mut looked, mut asked, mut yes) = (0, 0, 0);
    for round in 0..24 {
        let (a, b) = (rng.pick(&solids).clone(), rng.pick(&solids).clone());
        let (body_a, body_b) = (body(&a), body(&b));
        let d = [0.0, 0.01, 0.3][round % 3];
        let mut watch = Watch::new(&body_a, &body_b);
        for f in motions(&mut rng) {
            let (pa, pb) = (about(&a, &f.a), about(&b, &f.b));
            let pose = between(&pa, &pb);
            let truth = Tracker::new().within(&body_a, &body_b, &pose, d);
            assert_eq!(watch.within(&pose, d), truth, "{} {} {d}", a.name, b.name);
            yes += u32::from(truth);
        }
        (looked, asked) = (looked + watch.looked(), asked + watch.asked());
    }
    assert!(
        looked < asked * 4 / 5 && yes > 500 && u64::from(yes) < asked - 500,
        "{looked} {asked} {yes}"
    );
}

/// Touching is intersecting, to the last bit, also for a watch that has seen the bodies a hair apart.
#[test]
fn a_watch_does_not_sleep_through_contact() {
    let cube = body(&shapes::cube());
    let at = |x: f64| between(&Pose::IDENTITY, &Pose::shift([x, 0.0, 0.0]));
    let mut watch = Watch::new(&cube, &cube);
    let above = 2.0f64.next_up();
    for (x, touches) in [(3.0, false), (2.5, false), (above, false), (2.0, true), (above, false)] {
        assert_eq!(watch.intersects(&at(x)), touches, "{x}");
    }
    assert!(watch.looked() < watch.asked());
    let looked = watch.looked();
    assert_eq!(watch.distance(&at(1.9), 0.5).class, Class::Touching);
    assert_eq!(watch.looked(), looked);
    assert_eq!(watch.distance(&at(1.9), 0.05).class, Class::Overlapping);
    assert_eq!(watch.distance(&at(2.0), 0.0).class, Class::Touching);
    assert_eq!(watch.distance(&at(2.5), 0.0).value, 0.5);
    assert!(!watch.within(&at(2.5), f64::NAN) && !watch.within(&at(2.5), -1.0));
    assert_eq!(watch.distance(&at(3.0), f64::NAN).value, 1.0);
}
