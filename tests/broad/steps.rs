//! Promise: a step costs in proportion to its changes, measured by entries inside windows, not by
//! time.

use lin_canny::broad::*;
use lin_canny::nalgebra::{Point3, Vector3};
use truth::rng::Rng;

fn place(rng: &mut Rng, side: f64) -> Point3<f64> {
    Point3::new(rng.range(0.0, side), rng.range(0.0, side), rng.range(0.0, side))
}

fn shifted(aabb: &Aabb, by: Vector3<f64>) -> Aabb {
    Aabb::new(aabb.min + by, aabb.max + by)
}

/// Returns the entries compared in each step. `motion` returns the motion of body `i` in step `s`.
fn scanned(mut boxes: Vec<Aabb>, mut motion: impl FnMut(usize, usize, &Aabb) -> Vector3<f64>) -> Vec<u64> {
    let mut broad = SweepAndPrune::new();
    let ids: Vec<_> = boxes
        .iter()
        .map(|b| broad.insert(b, BodyOptions::default()).unwrap())
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

/// Asserts that no step, including the first, compares more than `most` times the entries of the
/// median step.
fn assert_even(name: &str, most: u64, counts: &[u64]) {
    let mut sorted = counts.to_vec();
    sorted.sort_unstable();
    let median = sorted[sorted.len() / 2];
    assert!(
        counts.iter().all(|c| *c <= most * median),
        "{name}: at most {most} medians, but {counts:?}"
    );
}

/// One box in a hundred is a plate perpendicular to each axis, all at random positions in every
/// step: the columns of the first steps fit other sizes.
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

/// Parallel needles in slow motion; occasionally one moves to the other side of the world.
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

/// Parallel needles, one in a hundred moving slowly, and one body that jumps.
///
/// The windows of the repaired columns must not be as wide as the jump.
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

/// A world that changes after a calm period: centres of unit boxes, and the side of a box.
struct Change {
    name: &'static str,
    /// Returns the new centre after the calm period, and the scale of its box.
    place: fn(usize, &Point3<f64>) -> (Point3<f64>, f64),
    steps: usize,
    /// Step after which the cost must be that of the calm period, except in a few steps: bodies
    /// that fly far cost more.
    over: usize,
}

/// Returns the completed fraction of a change that takes several steps.
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

/// After `calm` steps of a cloud along x, only a few steps may compare several times the entries of
/// a calm step, and none of the last steps.
fn change_after_calm(change: &Change, calm: usize) {
    let (mut rng, n) = (Rng::new(11), 1500);
    let place = |rng: &mut Rng| Point3::new(rng.range(-750.0, 750.0), rng.range(-7.5, 7.5), rng.range(-7.5, 7.5));
    let centres: Vec<_> = (0..n).map(|_| place(&mut rng)).collect();
    let boxed = |c: &Point3<f64>, size: f64| Aabb::from_center(*c, Vector3::repeat(0.5 * size));
    let mut broad = SweepAndPrune::new();
    let ids: Vec<_> = centres
        .iter()
        .map(|c| broad.insert(&boxed(c, 1.0), BodyOptions::default()).unwrap())
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

/// After any calm period, columns are cut again as soon as the current ones are much too expensive.
#[test]
fn changes_after_a_long_calm() {
    for change in &CHANGES {
        for calm in [8, 60, 300] {
            change_after_calm(change, calm);
        }
    }
}
