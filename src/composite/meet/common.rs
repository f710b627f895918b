//! What two triangles have in common up to rounding, and where one of them leaves the other.

use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::composite::meet::triangle::{self, Triangle};

/// The part of a segment, and of the sides of a target, at which points are taken: no round number,
/// so that a point rarely lies on an edge of a third triangle.
const GENERIC: f64 = 0.438_7;

/// What two triangles have in common.
#[derive(Clone, Copy, Debug)]
pub(super) enum CommonPart {
    /// At most a point, or a stretch of edges in one plane.
    Point,
    /// A point of a common segment, and the unit direction of the segment.
    Segment(Vector3<f64>, Vector3<f64>),
    /// A point inside a common part of a plane, and whether both normals point the same way.
    Flat(Vector3<f64>, bool),
}

/// Returns the unit normal of a triangle; `None` for a triangle without area.
pub(super) fn unit_normal(t: &Triangle) -> Option<Vector3<f64>> {
    let n = triangle::normal(t);
    let length = sqrt(n.norm_squared());
    (length > 0.0 && length.is_finite()).then(|| n / length)
}

/// Returns what two triangles have in common. Heights up to `slack` count as none, and so do
/// lengths up to four times as much.
pub(super) fn common(p: &Triangle, q: &Triangle, slack: f64) -> CommonPart {
    let (Some(n), Some(m)) = (unit_normal(p), unit_normal(q)) else {
        return CommonPart::Point;
    };
    let (over_q, over_p) = (p.map(|x| m.dot(&(x - q[0]))), q.map(|x| n.dot(&(x - p[0]))));
    if over_q.iter().chain(&over_p).all(|h| h.abs() <= slack) {
        return flat(p, q, &n, slack).map_or(CommonPart::Point, |at| CommonPart::Flat(at, n.dot(&m) > 0.0));
    }
    let across = n.cross(&m);
    let s = across / sqrt(across.norm_squared());
    let (Some(of_p), Some(of_q)) = (trace(p, &over_q, &s, slack), trace(q, &over_p, &s, slack)) else {
        return CommonPart::Point;
    };
    let at = |x: &Vector3<f64>| s.dot(&(x - p[0]));
    let (low, high) = (at(&of_p[0]).larger(at(&of_q[0])), at(&of_p[1]).smaller(at(&of_q[1])));
    if high - low > 4.0 * slack {
        let place = low + GENERIC * (high - low);
        CommonPart::Segment(of_p[0] + s * (place - at(&of_p[0])), s)
    } else {
        CommonPart::Point
    }
}

/// Returns the ends of the part of a triangle that lies in a plane, the lower one along `s` first.
/// `heights`: of the corners over the plane.
fn trace(t: &Triangle, heights: &[f64; 3], s: &Vector3<f64>, slack: f64) -> Option<[Vector3<f64>; 2]> {
    let mut ends: Option<[Vector3<f64>; 2]> = None;
    let mut take = |x: Vector3<f64>| {
        let [low, high] = ends.get_or_insert([x; 2]);
        if s.dot(&(x - *low)) < 0.0 {
            *low = x;
        }
        if s.dot(&(x - *high)) > 0.0 {
            *high = x;
        }
    };
    for k in 0..3 {
        let j = (k + 1) % 3;
        let (h, l) = (heights[k], heights[j]);
        if h.abs() <= slack {
            take(t[k]);
        } else if l.abs() > slack && (h > 0.0) != (l > 0.0) {
            take(t[k] + (t[j] - t[k]) * (h / (h - l)));
        }
    }
    ends
}

/// Returns a point inside the common part of two triangles in one plane with the normal `n` of the
/// first; `None` if the part is no wider than some slack.
///
/// Source: clipping by half-planes: Sutherland and Hodgman 1974.
fn flat(p: &Triangle, q: &Triangle, n: &Vector3<f64>, slack: f64) -> Option<Vector3<f64>> {
    let mut polygon = q.to_vec();
    for k in 0..3 {
        let inward = n.cross(&(p[(k + 1) % 3] - p[k]));
        let room = |x: &Vector3<f64>| inward.dot(&(x - p[k]));
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, x) in polygon.iter().enumerate() {
            let y = &polygon[(i + 1) % polygon.len()];
            let (h, l) = (room(x), room(y));
            if h >= 0.0 {
                kept.push(*x);
            }
            if h > 0.0 && l < 0.0 || h < 0.0 && l > 0.0 {
                kept.push(x + (y - x) * (h / (h - l)));
            }
        }
        polygon = kept;
    }
    let first = *polygon.first()?;
    let fan = polygon.windows(2).map(|w| (w[0] - first).cross(&(w[1] - first)).dot(n));
    let around = polygon.iter().map(|x| sqrt((x - first).norm_squared()));
    if !(fan.sum::<f64>().abs() > 8.0 * slack * around.sum::<f64>()) {
        return None;
    }
    let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
    for (k, x) in polygon.iter().enumerate() {
        let weight = 1.0 + GENERIC * k as f64;
        (sum, weights) = (sum + (x - first) * weight, weights + weight);
    }
    Some(first + sum / weights)
}

/// Returns segments of `t` from a point of a common segment, one to each side on which `t` goes on
/// and may be behind `other`: not in front of it, where `other` goes on to both sides.
pub(super) fn leaving(
    t: &Triangle,
    other: &Triangle,
    (at, s): (&Vector3<f64>, &Vector3<f64>),
    slack: f64,
) -> impl Iterator<Item = Vector3<f64>> {
    let aside = |x: &Triangle| unit_normal(x).map(|n| (n, x.map(|c| n.cross(s).dot(&(c - at)))));
    let is_beyond = move |d: f64| d > 4.0 * slack;
    let front = aside(other)
        .filter(|(_, d)| d.iter().any(|d| is_beyond(*d)) && d.iter().any(|d| is_beyond(-d)))
        .map(|(n, _)| n);
    let of_t = aside(t);
    let (t, at) = (*t, *at);
    [1.0, -1.0].into_iter().filter_map(move |side| {
        let (_, d) = of_t?;
        let mut beyond = (0..3).filter(|k| is_beyond(side * d[*k])).map(|k| t[k]);
        let first = beyond.next()?;
        let to = beyond.next().map_or(first, |second| first + (second - first) * GENERIC);
        front.is_none_or(|n| n.dot(&(to - at)) < -slack).then_some(to)
    })
}
