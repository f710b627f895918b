//! The rim of a face: where a point is beside its side planes, and where a line leaves it.
//!
//! Small rims are walked round; on large ones (see [`Topology::ring`](crate::polyhedron::topology::Topology)) both
//! questions are answered by bisection, so that a face of 8192 edges costs a few times one of 32.

use nalgebra::Vector3;

use crate::num::packed::PackedVec3;
use crate::pair::star::one_norm;
use crate::polyhedron::ConvexPolyhedron;
use crate::polyhedron::unimodal::top_of_ring;
use crate::tolerance::{DIFFERENCE, FOOT};

/// Where a point is beside the side planes of a face.
pub(crate) enum Rim {
    /// Within all of them, beyond rounding.
    Inside,
    /// Within rounding of the plane of this edge.
    Grazes(u32),
    /// Outside the plane of this edge, beyond rounding.
    Outside(u32),
}

/// A face of a body and its plane's normal.
pub(crate) struct Face<'a> {
    pub(crate) body: &'a ConvexPolyhedron,
    pub(crate) face: u32,
    pub(crate) normal: &'a Vector3<f64>,
}

/// One look at one edge of the rim.
struct Look {
    /// Signed distance from the side plane, squared with its sign: negative outside.
    signed: f64,
    rim: Rim,
}

impl Face<'_> {
    /// Where `x` is, with rounding relative to the pair's `size`; and a corner of the rim.
    #[inline(always)]
    pub(crate) fn beside(&self, x: &Vector3<f64>, size: f64) -> (Rim, Vector3<f64>) {
        match self.body.topology.ring(self.face) {
            None => self.beside_small(x, size),
            Some(ring) => (self.beside_large(ring, x, size), self.tail(ring[0])),
        }
    }

    /// Walks round: the edge furthest outside, or the closest that `x` grazes.
    #[inline(always)]
    fn beside_small(&self, x: &Vector3<f64>, size: f64) -> (Rim, Vector3<f64>) {
        let body = self.body;
        // No edge is longer than the diameter, and the 1-norm is less than twice the length.
        let close = 4.0 * FOOT * size * body.radius;
        let start = body.topology.rim_start(self.face);
        let mut from = self.tail(start);
        let (mut rim, mut furthest) = (Rim::Inside, f64::INFINITY);
        let mut h = start;
        loop {
            let e = body.topology.half_edge(h);
            let to = body.points[e.to as usize];
            let u = to - from;
            let side = self.normal.cross(&u).dot(&(x - to));
            if side < close {
                let look = judge(h.min(e.twin), side, &u, size);
                if look.signed < furthest && !matches!(look.rim, Rim::Inside) {
                    (rim, furthest) = (look.rim, look.signed);
                }
            }
            (from, h) = (to, e.next);
            if h == start {
                return (rim, from);
            }
        }
    }

    /// Bisects for the wedge, seen from the first corner, that holds `x`, until it does so on the near side of the chord between
    /// the wedge's other two corners: the three corners of the face then prove it inside, but for the edges next to them, which
    /// are looked at.
    #[inline(never)]
    pub(crate) fn beside_large(&self, ring: &[u32], x: &Vector3<f64>, size: f64) -> Rim {
        let m = ring.len();
        let root = self.tail(ring[0]);
        let left_of = |k: usize| self.normal.cross(&(self.tail(ring[k]) - root)).dot(&(x - root)) >= 0.0;
        // x is left of the ray to corner `low` and right of that to `high`, or beyond one of the two edges at the root.
        let (mut low, mut high) = (1, m - 1);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if left_of(middle) {
                low = middle;
            } else {
                high = middle;
            }
            let (p, q) = (self.tail(ring[low]), self.tail(ring[high]));
            if high - low < m / 2 && self.normal.cross(&(q - p)).dot(&(x - p)) > 0.0 {
                break;
            }
        }
        let near = [0, m - 1, low - 1, low, high - 1, high];
        let (mut rim, mut furthest, mut at) = (Rim::Inside, f64::INFINITY, 0);
        for k in near {
            let look = self.look(ring[k], x, size);
            if look.signed < furthest && !matches!(look.rim, Rim::Inside) {
                (rim, furthest, at) = (look.rim, look.signed, k);
            }
        }
        if let Rim::Outside(_) = rim {
            Rim::Outside(self.name(ring[self.nearest(ring, at, x)]))
        } else {
            rim
        }
    }

    /// From the edge `at`, seen from outside by `x`, gallops along the edges so seen to the one nearest to `x`: the
    /// distance falls along them until there and rises after.
    fn nearest(&self, ring: &[u32], at: usize, x: &Vector3<f64>) -> usize {
        let m = ring.len();
        let ends = |k: usize| (self.tail(ring[k % m]), self.head(ring[k % m]));
        let seen = |k: usize| {
            let (p, q) = ends(k);
            self.normal.cross(&(q - p)).dot(&(x - p)) < 0.0
        };
        let ahead = |k: usize| {
            let (p, q) = ends(at + k);
            seen(at + k) && (x - q).dot(&(q - p)) > 0.0
        };
        let behind = |k: usize| {
            let (p, q) = ends(at + m - k);
            seen(at + m - k) && (x - p).dot(&(q - p)) < 0.0
        };
        let forward = gallop(m, ahead);
        if forward > 0 {
            (at + forward) % m
        } else {
            (at + m - gallop(m, behind)) % m
        }
    }

    /// Where a line from `start`, which is over the face, leaves it before `start + way`: the part of the way and the
    /// edge. `from` is an edge the line comes in over, never one it leaves by.
    #[inline(always)]
    pub(crate) fn leave(&self, start: PackedVec3, way: PackedVec3, from: Option<u32>) -> Option<(f64, u32)> {
        match self.body.topology.ring(self.face) {
            None => self.leave_small(start, way, from),
            Some(ring) => self.leave_large(ring, &start.vector(), &way.vector(), from),
        }
    }

    /// Walks round.
    #[inline(always)]
    fn leave_small(&self, start: PackedVec3, way: PackedVec3, from: Option<u32>) -> Option<(f64, u32)> {
        let (body, normal) = (self.body, PackedVec3::new(self.normal));
        let begin = body.topology.rim_start(self.face);
        let (mut h, mut p) = (begin, PackedVec3::new(&self.tail(begin)));
        let mut first = None;
        loop {
            let e = body.topology.half_edge(h);
            let q = PackedVec3::new(&body.points[e.to as usize]);
            let (name, inward) = (h.min(e.twin), normal.cross(q - p));
            let speed = inward.dot(way);
            if speed < 0.0 && from != Some(name) {
                let when = -inward.dot(start - p) / speed;
                if when < first.map_or(1.0, |(w, _)| w) {
                    first = Some((when, name));
                }
            }
            (p, h) = (q, e.next);
            if h == begin {
                return first;
            }
        }
    }

    /// Most edges are short beside a large face: one by which it is left is bisected for.
    #[inline(never)]
    fn leave_large(
        &self,
        ring: &[u32],
        start: &Vector3<f64>,
        way: &Vector3<f64>,
        from: Option<u32>,
    ) -> Option<(f64, u32)> {
        if matches!(self.beside_large(ring, &(start + way), 0.0), Rim::Inside) {
            return None;
        }
        let mut first = None;
        let mut try_edge = |h: u32| {
            let name = self.name(h);
            let (p, q) = (self.tail(h), self.head(h));
            let inward = self.normal.cross(&(q - p));
            let speed = inward.dot(way);
            if speed < 0.0 && from != Some(name) {
                let when = -inward.dot(&(start - p)) / speed;
                if when < first.map_or(1.0, |(w, _)| w) {
                    first = Some((when, name));
                }
            }
        };
        let k = self.exit(ring, start, way);
        let m = ring.len();
        [(k + m - 1) % m, k, (k + 1) % m]
            .into_iter()
            .for_each(|k| try_edge(ring[k]));
        first
    }

    /// The edge of a large rim by which the line from `start` along `way` leaves it: the one from the corners right of
    /// the line to those left of it.
    #[inline(never)]
    fn exit(&self, ring: &[u32], start: &Vector3<f64>, way: &Vector3<f64>) -> usize {
        let m = ring.len();
        let left = self.normal.cross(way);
        let height = |k: usize| left.dot(&(self.tail(ring[k % m]) - start));
        // From the rightmost corner, counter-clockwise, to the leftmost: in between, once, the sign changes.
        let (low, high) = (top_of_ring(m, |k| -height(k)), top_of_ring(m, height));
        let span = (high + m - low) % m;
        let (mut right, mut over) = (0, span.max(1));
        while over - right > 1 {
            let middle = (right + over) / 2;
            if height(low + middle) < 0.0 {
                right = middle;
            } else {
                over = middle;
            }
        }
        (low + right) % m
    }

    fn look(&self, h: u32, x: &Vector3<f64>, size: f64) -> Look {
        let (p, q) = (self.tail(h), self.head(h));
        let side = self.normal.cross(&(q - p)).dot(&(x - q));
        judge(self.name(h), side, &(q - p), size)
    }

    fn name(&self, h: u32) -> u32 {
        self.body.topology.edge(h)
    }

    #[inline(always)]
    fn tail(&self, h: u32) -> Vector3<f64> {
        self.body.points[self.body.topology.from(h) as usize]
    }

    #[inline(always)]
    fn head(&self, h: u32) -> Vector3<f64> {
        self.body.points[self.body.topology.half_edge(h).to as usize]
    }
}

/// What the product `side` with the unnormalised inward direction says of an edge `u`.
#[inline(always)]
fn judge(edge: u32, side: f64, u: &Vector3<f64>, size: f64) -> Look {
    let length = one_norm(u);
    let rim = if side < -DIFFERENCE * size * length {
        Rim::Outside(edge)
    } else if side < FOOT * size * length {
        Rim::Grazes(edge)
    } else {
        Rim::Inside
    };
    Look {
        signed: side * side.abs() / u.norm_squared(),
        rim,
    }
}

/// How many steps in a row, from the first, a condition holds that holds for a run of them and then no more.
fn gallop(most: usize, holds: impl Fn(usize) -> bool) -> usize {
    let mut reach = 1;
    while reach < most && holds(reach - 1) {
        reach *= 2;
    }
    // It holds below `low` and not at `high`, or the ring ends there.
    let (mut low, mut high) = (reach / 2, reach.min(most) - 1);
    while low < high {
        let middle = (low + high) / 2;
        if holds(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gallop_counts_the_run() {
        for most in 1..40 {
            for run in 0..most {
                assert_eq!(gallop(most, |k| k < run), run, "{run} of {most}");
            }
        }
    }
}
