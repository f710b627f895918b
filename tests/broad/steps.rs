//! Promise: a step costs in proportion to what changed in it. Counted are entries inside windows, not time.

use lin_canny::broad::*;
use lin_canny::nalgebra::{Point3, Vector3};
use truth::rng::Rng;

fn place(rng: &mut Rng, side: f64) -> Point3<f64> {
    Point3::new(rng.range(0.0, side), rng.range(0.0, side), rng.range(0.0, side))
}

fn shifted(aabb: &Aabb, by: Vector3<f64>) -> Aabb {
    Aabb::new(aabb.min + by, aabb.max + by)
}

/// Entries compared, step by step. `motion` says how body `i` moves in step `s`.
fn scanned(mut boxes: Vec<Aabb>, mut motion: impl FnMut(usize, usize, &Aabb) -> Vector3<f64>) -> Vec<u64> {
    let mut broad = SweepAndPrune::new();
    let ids: Vec<_> = boxes
        .iter()
        .map(|b| broad.insert(b, BodyOptions::moving()).unwrap())
        .collect();
    let mut counts = Vec::new();
    for s in 0..24 {
        for (i, aabb) in boxes.iter_mut().enumerate().filter(|_| s > 0) {
            *aabb = shifted(aabb, motion(s, i, aabb));
            broad.set_box(ids[i], aabb).unwrap();
        }
        broad.step();
        assert_eq!(broad.check(), Ok(()));
        counts.push(broad.scanned());
    }
    counts
}

/// No step, the first included, compares more than `most` times the entries of the median step.
fn assert_even(name: &str, most: u64, counts: &[u64]) {
    let mut sorted = counts.to_vec();
    sorted.sort_unstable();
    let median = sorted[sorted.len() / 2];
    assert!(
        counts.iter().all(|c| *c <= most * median),
        "{name}: at most {most} medians, but {counts:?}"
    );
}

/// Plates in a hundred boxes, across each axis, all at random places in every step: the columns of
/// the first steps are cut for other sizes.
#[test]
fn plates_among_small_boxes() {
    let n = 4000;
    for axis in 0..3 {
        let (mut rng, side) = (Rng::new(1), (16.0 * n as f64).cbrt());
        let boxes = (0..n).map(|i| {
            let mut half = Vector3::repeat(0.5);
            if i % 50 == 0 {
                half = Vector3::repeat(0.3 * side);
                half[axis] = 0.05;
            }
            Aabb::from_center(place(&mut rng, side), half)
        });
        let boxes: Vec<_> = boxes.collect();
        let mut rng = Rng::new(2);
        let counts = scanned(boxes, |_, _, aabb| {
            place(&mut rng, side) - Point3::from((aabb.min.coords + aabb.max.coords) * 0.5)
        });
        assert_even("plates", 4, &counts);
    }
}

/// Parallel needles in slow motion; now and then one wraps to the other side of the world.
#[test]
fn needles_that_wrap() {
    let (mut rng, n) = (Rng::new(3), 4000);
    let half = Vector3::new(1e-4, 50.0, 1e-4);
    let boxes: Vec<_> = (0..n)
        .map(|_| Aabb::from_center(place(&mut rng, 100.0), half))
        .collect();
    let counts = scanned(boxes, |s, i, aabb| {
        let wraps = s % 5 == 0 && i == s;
        let far = if aabb.min.x > 50.0 {
            -aabb.min.x
        } else {
            99.0 - aabb.min.x
        };
        Vector3::x() * if wraps { far } else { 1e-3 * rng.uniform() }
    });
    assert_even("needles", 2, &counts);
}

/// Parallel needles of which one in a hundred moves, slowly, and one body that hops: the windows of
/// the columns that are repaired must not be as wide as the hop.
#[test]
fn a_hop_among_few_movers() {
    let (mut rng, n) = (Rng::new(4), 4000);
    let half = Vector3::new(1e-4, 50.0, 1e-4);
    let boxes: Vec<_> = (0..n)
        .map(|_| Aabb::from_center(place(&mut rng, 100.0), half))
        .collect();
    let counts = scanned(boxes, |s, i, _| match (s % 6, i) {
        (0, 0) => Vector3::x() * if s % 12 == 0 { 40.0 } else { -40.0 },
        (_, i) if i % 100 == 1 => Vector3::from(rng.unit()) * 1e-3,
        _ => Vector3::zeros(),
    });
    assert_even("hops", 5, &counts[1..]);
}

/// A world that changes after a calm: centres of unit boxes, and the side of a box.
struct Change {
    name: &'static str,
    /// Where a centre of the calm world is in the step after the calm, and the scale of its box.
    place: fn(usize, &Point3<f64>) -> (Point3<f64>, f64),
    steps: usize,
    /// From which step on it is to cost no more than the calm, but for a few steps: bodies that fly far cost more by themselves.
    over: usize,
}

/// The part of a change that is done by a step, when it takes so many.
fn part(step: usize, steps: usize) -> f64 {
    ((step + 1) as f64 / steps as f64).min(1.0)
}

fn turned(p: &Point3<f64>, angle: f64, axis: usize) -> Point3<f64> {
    let (sin, cos) = angle.sin_cos();
    let mut q = *p;
    (q[0], q[axis]) = (cos * p[0] - sin * p[axis], sin * p[0] + cos * p[axis]);
    q
}

const CHANGES: [Change; 5] = [
    Change {
        name: "along y at once",
        place: |_, p| (turned(p, std::f64::consts::FRAC_PI_2, 1), 1.0),
        steps: 8,
        over: 0,
    },
    Change {
        name: "along z at once",
        place: |_, p| (turned(p, std::f64::consts::FRAC_PI_2, 2), 1.0),
        steps: 8,
        over: 0,
    },
    Change {
        name: "turned to y",
        place: |s, p| (turned(p, std::f64::consts::FRAC_PI_2 * part(s, 40), 1), 1.0),
        steps: 48,
        over: 40,
    },
    Change {
        name: "drawn out along z",
        place: |s, p| {
            let w = part(s, 30);
            (Point3::new(p.x * (1.0 - 0.99 * w), p.y, p.z * (1.0 + 99.0 * w)), 1.0)
        },
        steps: 40,
        over: 30,
    },
    Change {
        name: "shrinking",
        place: |s, p| (p * 0.5f64.powi(s as i32 + 1), 0.5f64.powi(s as i32 + 1)),
        steps: 12,
        over: 0,
    },
];

/// After so many calm steps of a cloud along x, few steps compare several times the entries of a calm one, and none of the last.
fn change_after_calm(change: &Change, calm: usize) {
    let (mut rng, n) = (Rng::new(11), 1500);
    let place = |rng: &mut Rng| Point3::new(rng.range(-750.0, 750.0), rng.range(-7.5, 7.5), rng.range(-7.5, 7.5));
    let centres: Vec<_> = (0..n).map(|_| place(&mut rng)).collect();
    let boxed = |c: &Point3<f64>, size: f64| Aabb::from_center(*c, Vector3::repeat(0.5 * size));
    let mut broad = SweepAndPrune::new();
    let ids: Vec<_> = centres
        .iter()
        .map(|c| broad.insert(&boxed(c, 1.0), BodyOptions::moving()).unwrap())
        .collect();
    let mut counts = Vec::new();
    for s in 0..calm + change.steps {
        let trembling = rng.range(0.0, 1e-3);
        for (id, c) in ids.iter().zip(&centres) {
            let (mut to, size) = match s.checked_sub(calm) {
                Some(after) => (change.place)(after, c),
                None => (*c, 1.0),
            };
            to.x += trembling * size;
            broad.set_box(*id, &boxed(&to, size)).unwrap();
        }
        broad.step();
        counts.push(broad.scanned());
    }
    assert_eq!(broad.check(), Ok(()));
    let (before, after) = counts.split_at(calm);
    let usual = before[calm - 1];
    let slow = after[change.over..].iter().filter(|c| **c > 6 * usual).count();
    let worst = after.iter().max().unwrap();
    assert!(
        slow <= 3 && after[after.len() - 4..].iter().all(|c| *c <= 6 * usual),
        "{} after {calm} calm steps of {usual}: {slow} slow steps, worst {worst}: {after:?}",
        change.name
    );
}

/// However long nothing asked for other columns, they are cut as soon as the present ones are far too dear.
#[test]
fn changes_after_a_long_calm() {
    for change in &CHANGES {
        for calm in [8, 60, 300] {
            change_after_calm(change, calm);
        }
    }
}
