//! Enclosing balls of samples. They propose: nothing relies on them.

use alloc::vec::Vec;

use nalgebra::Point3;

use super::Ball;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;

/// Steps towards the farthest sample. The radius is then some percent above the least one.
const STEPS: usize = 96;

/// Returns a small ball that contains some samples, up to rounding.
pub(super) fn min_ball(samples: &[Point3<f64>], chosen: &[u32]) -> Ball {
    let at = |k: &u32| samples[*k as usize];
    let Some(first) = chosen.first().map(at) else {
        let center = Point3::origin();
        return Ball { center, radius: 0.0 };
    };
    let far = |center: &Point3<f64>| {
        let points = chosen.iter().map(at);
        points.fold((first, -1.0), |best: (Point3<f64>, f64), p| {
            let d = (p - center).norm_squared();
            if d > best.1 { (p, d) } else { best }
        })
    };
    let (mut center, mut best) = (first, (first, f64::INFINITY));
    for step in 0..STEPS {
        let (farthest, d) = far(&center);
        if d < best.1 {
            best = (center, d);
        }
        // Half the way first: the middle of the first sample and the farthest one.
        center += (farthest - center) / (step + 2) as f64;
    }
    Ball {
        center: best.0,
        radius: sqrt(best.1),
    }
}

/// Returns two parts of some samples: those nearer to the one or the other of two centres far
/// apart.
pub(super) fn halves(samples: &[Point3<f64>], chosen: &[u32]) -> [Vec<u32>; 2] {
    let at = |k: u32| samples[k as usize];
    let farthest = |from: Point3<f64>| {
        let far = chosen.iter().fold((from, -1.0), |best: (Point3<f64>, f64), &k| {
            let d = (at(k) - from).norm_squared();
            if d > best.1 { (at(k), d) } else { best }
        });
        far.0
    };
    let first = chosen.first().map_or_else(Point3::origin, |&k| at(k));
    let mut ends = [farthest(first); 2];
    ends[1] = farthest(ends[0]);
    let mut parts = [Vec::new(), Vec::new()];
    for round in 0..4 {
        parts = [Vec::new(), Vec::new()];
        for &k in chosen {
            let [a, b] = ends.map(|end| (at(k) - end).norm_squared());
            parts[usize::from(b < a)].push(k);
        }
        if round < 3 && parts.iter().all(|part| !part.is_empty()) {
            ends = [0, 1].map(|side| mean(samples, &parts[side]));
        }
    }
    parts
}

/// Returns the parts of some samples on both sides of the middle of their box, along an axis.
pub(super) fn halves_along(axis: usize, samples: &[Point3<f64>], chosen: &[u32]) -> [Vec<u32>; 2] {
    let at = |k: &u32| samples[*k as usize][axis];
    let low = chosen.iter().map(at).fold(f64::INFINITY, f64::smaller);
    let high = chosen.iter().map(at).fold(f64::NEG_INFINITY, f64::larger);
    let middle = 0.5 * low + 0.5 * high;
    let mut parts = [Vec::new(), Vec::new()];
    for k in chosen {
        parts[usize::from(at(k) > middle)].push(*k);
    }
    parts
}

/// Returns the mean of some samples, which are not none.
fn mean(samples: &[Point3<f64>], chosen: &[u32]) -> Point3<f64> {
    let first = samples[chosen[0] as usize];
    let share = 1.0 / chosen.len() as f64;
    first
        + chosen.iter().fold(nalgebra::Vector3::zeros(), |sum, &k| {
            sum + (samples[k as usize] - first) * share
        })
}

/// Returns the samples of each ball: each sample goes to the ball with the least power.
///
/// The power of a point is the square of its distance from the centre minus that of the radius.
pub(super) fn assigned(samples: &[Point3<f64>], balls: &[Ball]) -> Vec<Vec<u32>> {
    let mut parts: Vec<Vec<u32>> = balls.iter().map(|_| Vec::new()).collect();
    for (k, p) in (0..).zip(samples) {
        let power = |ball: &Ball| (p - ball.center).norm_squared() - ball.radius * ball.radius;
        let best = (0..balls.len()).fold((0, f64::INFINITY), |best, i| {
            let d = power(&balls[i]);
            if d < best.1 { (i, d) } else { best }
        });
        parts[best.0].push(k);
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// Returns the largest of some numbers that are not negative.
pub(super) fn greatest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, f64::larger)
}
