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

/// Entries scanned, step by step. `motion` says how body `i` moves in step `s`.
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

/// No step, the first included, scans more than five times what the median step does and eight entries a body beside.
fn assert_even(name: &str, n: usize, counts: &[u64]) {
    let mut sorted = counts.to_vec();
    sorted.sort_unstable();
    let most = 5 * sorted[sorted.len() / 2] + 8 * n as u64;
    assert!(
        counts.iter().all(|c| *c <= most),
        "{name}: at most {most}, but {counts:?}"
    );
}

/// Two plates in a hundred boxes, across each axis; all are slow but for one in five hundred, in some steps.
#[test]
fn plates_among_small_boxes() {
    let n = 8000;
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
        let counts = scanned(boxes, |s, i, aabb| match (s % 4, i % 500) {
            (0, 0) => place(&mut rng, side) - Point3::from((aabb.min.coords + aabb.max.coords) * 0.5),
            _ => Vector3::from(rng.unit()) * 0.01,
        });
        assert_even("plates", n, &counts);
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
    assert_even("needles", n, &counts);
}

/// Pipes along all axes that move slowly, and one body that hops.
#[test]
fn pipes_and_one_hopping_body() {
    let (mut rng, n) = (Rng::new(4), 4000);
    let boxes = (0..n).map(|_| {
        let mut half = Vector3::repeat(0.25);
        half[rng.below(3)] = 5.0;
        Aabb::from_center(place(&mut rng, 100.0), half)
    });
    let boxes: Vec<_> = boxes.collect();
    let counts = scanned(boxes, |s, i, _| match (s % 6, i) {
        (0, 0) => Vector3::repeat(if s % 12 == 0 { 40.0 } else { -40.0 }),
        _ => Vector3::from(rng.unit()) * 0.01,
    });
    assert_even("pipes", n, &counts);
}
