//! Promise: a step costs in proportion to what changed in it. Counted are entries inside windows, not time.

use lab::rng::Rng;
use lin_canny::broad::*;
use lin_canny::nalgebra::{Point3, Vector3};

fn place(rng: &mut Rng, side: f64) -> Point3<f64> {
    Point3::new(rng.range(0.0, side), rng.range(0.0, side), rng.range(0.0, side))
}

fn shifted(aabb: &Aabb, by: Vector3<f64>) -> Aabb {
    Aabb::new(aabb.min + by, aabb.max + by)
}

/// Entries compared, step by step. `motion` says how body `i` moves in step `s`.
fn scanned(mut boxes: Vec<Aabb>, mut motion: impl FnMut(usize, usize, &Aabb) -> Vector3<f64>) -> Vec<u64> {
    let mut broad = PencilSweep::new();
    let ids: Vec<_> = boxes.iter().map(|b| broad.insert(b, Body::moving()).unwrap()).collect();
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
