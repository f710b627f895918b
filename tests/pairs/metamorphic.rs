//! Changes of a query that must not change its outcome: order of bodies, unit, position, order of
//! points, form of the pose, tracker.

use lin_canny::{ContactState, Outcome, RelativePose, Tracker};
use proptest::prelude::*;
use truth::motion::Frame;
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support::{body, relative};
use truth::{Point, Pose};

/// Returns a pair at a pose of any kind, from a seed.
fn scene(seed: u64) -> (Shape, Shape, Frame) {
    let mut rng = Rng::new(seed);
    let (a, b) = (shapes::small(&mut rng), shapes::small(&mut rng));
    let reach = if rng.chance(0.3) {
        rng.range(0.0, 1.0)
    } else {
        rng.range(1.0, 4.0)
    };
    let t = truth::pose::scale(rng.unit(), reach);
    let turned = |rng: &mut Rng| if rng.chance(0.3) { Pose::IDENTITY.q } else { rng.quat() };
    let at = truth::pose::scale(rng.unit(), 2.0);
    let frame = Frame::new(
        Pose::new(turned(&mut rng), at),
        Pose::new(turned(&mut rng), truth::pose::add(at, t)),
    );
    (a, b, frame)
}

fn ask(a: &Shape, b: &Shape, pose: &RelativePose) -> [Outcome; 2] {
    let (a, b) = (body(a), body(b));
    [
        Tracker::new().closest(&a, &b, pose),
        Tracker::new().closest_exact(&a, &b, pose),
    ]
}

/// Two outcomes of the same query: neither refutes the other, and both are as tight as rounding
/// allows.
fn agree(x: &Outcome, y: &Outcome, size: f64) -> Result<(), TestCaseError> {
    prop_assert_eq!(x.state, y.state, "{:?} {:?}", x, y);
    prop_assert!(x.lower <= y.upper && y.lower <= x.upper, "{:?} {:?}", x, y);
    if x.state == ContactState::Separated {
        prop_assert!((x.distance - y.distance).abs() <= 1e-14 * size, "{:?} {:?}", x, y);
    }
    Ok(())
}

fn size(frame: &Frame) -> f64 {
    2.0 * 3f64.sqrt() + truth::pose::norm(truth::pose::sub(frame.b.t, frame.a.t))
}

/// Returns whether two distances are within a unit in the last place: halfway between two doubles,
/// either may be returned.
fn neighbours(x: f64, y: f64) -> bool {
    x.next_down() <= y && y <= x.next_up()
}

/// Returns the numbers of an outcome times `unit`, bit for bit.
fn bits(o: &Outcome, unit: f64) -> Vec<u64> {
    let lengths = [o.distance, o.lower, o.upper].into_iter();
    let points = o.point_on_a.iter().chain(o.point_on_b.iter()).copied();
    let scaled = lengths.chain(points).map(|x| (x * unit).to_bits());
    scaled.chain(o.normal.iter().map(|x| x.to_bits())).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn letters_may_be_exchanged(seed: u64) {
        let (a, b, frame) = scene(seed);
        let (x, y) = (ask(&a, &b, &relative(&frame)), ask(&b, &a, &relative(&frame.swapped())));
        for (x, y) in x.iter().zip(&y) {
            agree(x, y, size(&frame))?;
        }
        if x[1].state == ContactState::Separated {
            prop_assert!(neighbours(x[1].distance, y[1].distance), "{:?} {:?}", x[1], y[1]);
        }
    }

    #[test]
    fn powers_of_two_change_only_the_exponent(seed: u64, step in -1i32..2, k in -85i32..86) {
        // Bodies are stored in units of 2^210; a pair on both sides of a border is answered in
        // other arithmetic.
        let k = 210 * step + k;
        let (a, b, frame) = scene(seed);
        let unit = 2f64.powi(k);
        let big = frame.scaled(unit);
        let (x, y) = (ask(&a, &b, &relative(&frame)), ask(&a.clone().scaled(unit), &b.clone().scaled(unit), &relative(&big)));
        for (x, y) in x.iter().zip(&y) {
            prop_assert_eq!(bits(x, unit), bits(y, 1.0), "{:?} {:?}", x, y);
            prop_assert_eq!((x.state, x.solver, x.features), (y.state, y.solver, y.features));
        }
    }

    #[test]
    fn a_shift_that_both_translations_absorb_changes_no_bit(seed: u64, far in -20i32..20) {
        let (a, b, frame) = scene(seed);
        // Multiples of 2^-20 and a shift by a round number add without rounding.
        let round = |t: Point| t.map(|x| (x * 1_048_576.0).round() / 1_048_576.0);
        let shift = [f64::from(far) * 65_536.0, 1024.0, -3.0 * f64::from(far)];
        let here = Frame::new(frame.a.moved_to(round(frame.a.t)), frame.b.moved_to(round(frame.b.t)));
        let there = |p: &Pose| p.shifted(shift);
        let there = Frame::new(there(&here.a), there(&here.b));
        for (x, y) in ask(&a, &b, &relative(&here)).iter().zip(&ask(&a, &b, &relative(&there))) {
            prop_assert_eq!(x, y);
        }
    }

    #[test]
    fn the_order_of_the_points_does_not_count(seed: u64) {
        let (a, b, frame) = scene(seed);
        let mut rng = Rng::new(!seed);
        let (c, d) = (a.clone().shuffled(&mut rng), b.clone().shuffled(&mut rng));
        // Vertices are numbered by position, so all bits must be equal.
        for (x, y) in ask(&a, &b, &relative(&frame)).iter().zip(&ask(&c, &d, &relative(&frame))) {
            prop_assert_eq!(bits(x, 1.0), bits(y, 1.0));
        }
    }

    #[test]
    fn a_common_motion_leaves_the_distance(seed: u64) {
        let (a, b, frame) = scene(seed);
        let mut rng = Rng::new(seed ^ 1);
        let common = Pose::new(rng.quat(), truth::pose::scale(rng.unit(), 100.0));
        let moved = frame.moved(&common);
        // The motion is rounded far from the origin: a unit in the last place of 100 moves a body
        // by 1.4e-14.
        let slack = 1e-12;
        for (x, y) in ask(&a, &b, &relative(&frame)).iter().zip(&ask(&a, &b, &relative(&moved))) {
            if x.distance > slack {
                prop_assert_eq!(x.state, y.state);
                prop_assert!((x.distance - y.distance).abs() <= slack, "{:?} {:?}", x, y);
            }
        }
    }

    #[test]
    fn what_the_tracker_saw_before_does_not_count(seed: u64, before: u64) {
        let (a, b, frame) = scene(seed);
        let (_, _, other) = scene(before);
        let (p, q) = (body(&a), body(&b));
        let mut pair = Tracker::new();
        pair.closest(&p, &q, &relative(&other));
        let warm = [pair.clone().closest(&p, &q, &relative(&frame)), pair.closest_exact(&p, &q, &relative(&frame))];
        let cold = ask(&a, &b, &relative(&frame));
        for (x, y) in warm.iter().zip(&cold) {
            agree(x, y, size(&frame))?;
        }
        if cold[1].state == ContactState::Separated {
            prop_assert!(neighbours(warm[1].distance, cold[1].distance), "{:?} {:?}", warm[1], cold[1]);
        }
        for d in [0.0, warm[0].lower, warm[0].distance, warm[0].upper, 1.0] {
            let (mut x, mut y) = (pair.clone(), Tracker::new());
            prop_assert_eq!(x.within(&p, &q, &relative(&frame), d), y.within(&p, &q, &relative(&frame), d));
        }
    }

    #[test]
    fn two_ways_of_giving_one_pose_agree(seed: u64) {
        let (a, b, frame) = scene(seed);
        let still = Frame { a: Pose::IDENTITY, ..frame };
        let one = RelativePose::from_isometry(&still.b.isometry()).unwrap();
        for (x, y) in ask(&a, &b, &relative(&still)).iter().zip(&ask(&a, &b, &one)) {
            prop_assert_eq!(x, y);
        }
    }

    #[test]
    fn the_predicates_are_the_distance(seed: u64) {
        let (a, b, frame) = scene(seed);
        let (p, q, pose) = (body(&a), body(&b), relative(&frame));
        let o = Tracker::new().closest_exact(&p, &q, &pose);
        let mut pair = Tracker::new();
        prop_assert_eq!(pair.intersects(&p, &q, &pose), o.state != ContactState::Separated);
        prop_assert_eq!(pair.distance(&p, &q, &pose).state, o.state);
        if o.state == ContactState::Separated {
            prop_assert!(!pair.within(&p, &q, &pose, o.distance.next_down().next_down()));
            prop_assert!(pair.within(&p, &q, &pose, o.distance.next_up().next_up()));
        }
        prop_assert!(!pair.within(&p, &q, &pose, -1.0) && !pair.within(&p, &q, &pose, f64::NAN));
    }
}

#[test]
fn the_scenes_are_a_mix() {
    let mut seen = [0; 3];
    for seed in 0..300 {
        let (a, b, frame) = scene(seed);
        match ask(&a, &b, &relative(&frame))[0].state {
            ContactState::Separated => seen[0] += 1,
            ContactState::Overlapping => seen[1] += 1,
            _ => seen[2] += 1,
        }
    }
    assert!(seen[0] > 60 && seen[1] > 20, "{seen:?}");
}
