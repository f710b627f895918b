//! Long rims and large fans as smooth curves and the bands beside them.
//!
//! A long rim, or the ring of the neighbours of a vertex of many edges, is a curve whose corners are numbered; its *ribs* go from
//! each corner to the apex of the fan, or along the sides of a prism to the other rim. RingLocation a corner the curve is taken as the
//! parabola through it and two others, so far away that their unevenness does not count.

use nalgebra::Vector3;

use crate::polyhedron::{ConvexPolyhedron, Feature};
use crate::tuning::polyhedron::LARGE;
use crate::tuning::walk::SPAN;

/// One curve of a body.
#[derive(Clone, Copy)]
pub(super) struct RingCurve<'a> {
    body: &'a ConvexPolyhedron,
    ring: Ring<'a>,
}

#[derive(Clone, Copy)]
enum Ring<'a> {
    /// The half-edges of a long rim.
    Rim(&'a [u32]),
    /// The fan of this vertex, from its first half-edge.
    Link { apex: u32, first: u32, len: usize },
}

/// What a feature of a body is beside a curve.
pub(super) enum RingLocation<'a> {
    /// A corner or an edge of the curve; its place.
    Curve(RingCurve<'a>, usize),
    /// A rib, or the strip between two of them; its place.
    Rib(RingCurve<'a>, usize),
}

/// The parabola through three corners of a curve and the lines through their ribs, in `x`, which is zero at the middle corner: value,
/// first and second derivative.
pub(super) struct Fit {
    /// Of the curve.
    pub(super) near: [Vector3<f64>; 3],
    /// Of the far ends of the ribs.
    pub(super) far: [Vector3<f64>; 3],
    /// `x` of a point `p` of the body is `scale . p - origin`.
    scale: Vector3<f64>,
    origin: f64,
}

impl<'a> RingCurve<'a> {
    fn link(body: &'a ConvexPolyhedron, apex: u32) -> Option<Self> {
        let fan = body.topology.fan(apex);
        (fan.len() > LARGE).then(|| RingCurve {
            body,
            ring: Ring::Link {
                apex,
                first: fan.start,
                len: fan.len(),
            },
        })
    }

    /// The curve that `h` is a part of, with the place of its tail: the rim on its left, or the link of the vertex across the
    /// triangle on its left.
    fn along(body: &'a ConvexPolyhedron, h: u32) -> Option<(Self, usize)> {
        let t = &body.topology;
        if let Some((ring, k)) = t.long_rim(t.from(h)).filter(|(ring, k)| ring[*k] == h) {
            let ring = Ring::Rim(ring);
            return Some((RingCurve { body, ring }, k));
        }
        let next = t.half_edge(t.half_edge(h).next);
        let band = Self::link(body, next.to)?;
        Some((band, band.place_of(next.next)))
    }

    /// The place of a half-edge of a fan.
    fn place_of(&self, h: u32) -> usize {
        match self.ring {
            Ring::Link { first, len, .. } => (h.wrapping_sub(first) as usize).min(len - 1),
            Ring::Rim(_) => 0,
        }
    }

    fn len(&self) -> usize {
        match self.ring {
            Ring::Rim(ring) => ring.len(),
            Ring::Link { len, .. } => len,
        }
    }

    /// The vertex at place `k`.
    pub(super) fn corner(&self, k: usize) -> u32 {
        let t = &self.body.topology;
        match self.ring {
            Ring::Rim(ring) => t.from(ring[k]),
            Ring::Link { first, .. } => t.half_edge(first + k as u32).to,
        }
    }

    /// The corner nearest to a part of the way from that at place `k` to the next.
    pub(super) fn corner_near(&self, k: usize, part: f64) -> u32 {
        self.corner(if part < 0.5 { k } else { (k + 1) % self.len() })
    }

    /// The edge from the corner at place `k` to the next.
    pub(super) fn edge(&self, k: usize) -> u32 {
        let t = &self.body.topology;
        match self.ring {
            Ring::Rim(ring) => t.edge(ring[k]),
            Ring::Link { first, .. } => t.edge(t.half_edge(first + k as u32).next),
        }
    }

    /// The half-edge of the rib of the corner at place `k`, towards its far end or away from it: of a rim, the one edge of a corner
    /// of three that is none of the rim.
    fn rib_half_edge(&self, k: usize) -> Option<u32> {
        let t = &self.body.topology;
        match self.ring {
            Ring::Rim(ring) => (t.fan(t.from(ring[k])).len() == 3).then(|| t.half_edge(t.half_edge(ring[k]).twin).next),
            Ring::Link { first, .. } => Some(first + k as u32),
        }
    }

    /// The rib of the corner at place `k`.
    pub(super) fn rib(&self, k: usize) -> Option<u32> {
        self.rib_half_edge(k).map(|h| self.body.topology.edge(h))
    }

    /// Its far end.
    pub(super) fn far(&self, k: usize) -> Option<u32> {
        match self.ring {
            Ring::Rim(_) => self.rib_half_edge(k).map(|h| self.body.topology.half_edge(h).to),
            Ring::Link { apex, .. } => Some(apex),
        }
    }

    /// The face between the ribs at place `k` and the next.
    pub(super) fn strip(&self, k: usize) -> u32 {
        let t = &self.body.topology;
        match self.ring {
            Ring::Rim(ring) => t.half_edge(t.half_edge(ring[k]).twin).face,
            Ring::Link { first, .. } => t.half_edge(first + k as u32).face,
        }
    }

    fn at(&self, k: usize) -> Vector3<f64> {
        self.body.points[self.corner(k) as usize]
    }

    /// The point between the corner at place `k` and the next.
    pub(super) fn point(&self, k: usize, part: f64) -> Vector3<f64> {
        self.at(k) * (1.0 - part) + self.at((k + 1) % self.len()) * part
    }

    /// How many places there are between two, the short way.
    pub(super) fn between(&self, k: usize, j: usize) -> usize {
        let d = k.abs_diff(j);
        d.min(self.len() - d)
    }

    /// The place as many corners beyond `to` as that is, the short way, beyond the place `from` of a ring that may be another: none then,
    /// or if that is but one.
    pub(super) fn beyond(&self, ring: &Self, from: usize, to: usize) -> Option<usize> {
        let same = match (self.ring, ring.ring) {
            (Ring::Rim(a), Ring::Rim(b)) => a.first() == b.first(),
            (Ring::Link { apex: a, .. }, Ring::Link { apex: b, .. }) => a == b,
            _ => false,
        };
        let m = self.len();
        (same && self.between(from, to) > 1).then(|| (2 * to + m - from) % m)
    }

    /// The parabola about the corner at place `k`. With ribs, their lines too; `None` where there are none, or the three corners
    /// do not follow each other along a line.
    pub(super) fn fit(&self, k: usize, ribs: bool) -> Option<Fit> {
        let m = self.len();
        // An arc of about three degrees: smooth over small edges, and short.
        let w = m.div_ceil(SPAN);
        let places = [
            if k >= w { k - w } else { k + m - w },
            k,
            if k + w >= m { k + w - m } else { k + w },
        ];
        let [before, p, after] = places.map(|k| self.at(k));
        let way = after - before;
        let scale = way * (1.0 / way.norm_squared());
        let (x0, x1) = (scale.dot(&(before - p)), scale.dot(&(after - p)));
        if !(x0 < 0.0 && x1 > 0.0) {
            return None;
        }
        let (per_left, per_right) = (1.0 / x0, 1.0 / x1);
        // x1 - x0 is one.
        let parabola = |a: Vector3<f64>, p: Vector3<f64>, b: Vector3<f64>| {
            let (left, right) = ((a - p) * per_left, (b - p) * per_right);
            [p, left * x1 - right * x0, (right - left) * 2.0]
        };
        let far = if ribs {
            let [a, q, b] = places.map(|k| self.far(k).map(|v| self.body.points[v as usize]));
            parabola(a?, q?, b?)
        } else {
            [Vector3::zeros(); 3]
        };
        Some(Fit {
            near: parabola(before, p, after),
            far,
            scale,
            origin: scale.dot(&p),
        })
    }

    /// The place whose corner is the last before `x` of a fit about place `k`, and which part of the way to the next `x` is.
    pub(super) fn place_at(&self, fit: &Fit, k: usize, x: f64) -> (usize, f64) {
        if x == 0.0 {
            return (k, 0.0);
        }
        let m = self.len();
        let wrapped = |j: usize| if j >= m { j - m } else { j };
        let at = |j: usize| fit.scale.dot(&self.at(wrapped(j))) - fit.origin;
        // Corners follow each other along the curve for less than a quarter of it.
        let most = m / 4;
        // Where it is if corners are evenly spaced.
        let guess = x * (2 * m.div_ceil(SPAN)) as f64;
        let from = wrapped(wrapped(
            (k + m).wrapping_add_signed(guess.clamp(-(most as f64), most as f64) as isize),
        ));
        let j = if at(from) <= x {
            wrapped(from + last(most, |d| at(from + d) <= x))
        } else {
            wrapped(from + m - 1 - last(most, |d| at(from + m - d) > x))
        };
        let (before, after) = (at(j), at(j + 1));
        (j, ((x - before) / (after - before)).clamp(0.0, 1.0))
    }
}

/// The largest `d` up to `most` for which a condition holds that holds from zero on for a while: doubling, then bisection. Zero counts as
/// holding.
fn last(most: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut reach) = (0, 1);
    while reach <= most && holds(reach) {
        (low, reach) = (reach, 2 * reach);
    }
    let mut high = reach.min(most + 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

impl ConvexPolyhedron {
    /// What a feature is beside a curve, if it is beside one.
    pub(super) fn near(&self, feature: Feature) -> Option<RingLocation<'_>> {
        match feature {
            Feature::Vertex(v) => self.near_vertex(v.0),
            Feature::Edge(e) => self.near_edge(e.0),
            Feature::Face(f) => self.near_face(f.0),
        }
    }

    /// The curve a vertex is a corner of.
    fn near_vertex(&self, v: u32) -> Option<RingLocation<'_>> {
        let t = &self.topology;
        if t.fan(v).len() > LARGE {
            return None;
        }
        if let Some((ring, k)) = t.long_rim(v) {
            let ring = Ring::Rim(ring);
            return Some(RingLocation::Curve(RingCurve { body: self, ring }, k));
        }
        t.fan(v).find_map(|h| {
            let e = t.half_edge(h);
            let band = RingCurve::link(self, e.to)?;
            Some(RingLocation::Curve(band, band.place_of(e.twin)))
        })
    }

    /// The curve an edge is a part of, or a rib beside.
    fn near_edge(&self, edge: u32) -> Option<RingLocation<'_>> {
        let t = &self.topology;
        let e = t.half_edge(edge);
        let tail = t.half_edge(e.twin).to;
        // Of a fan.
        for (apex, h) in [(tail, edge), (e.to, e.twin)] {
            if let Some(band) = RingCurve::link(self, apex) {
                return Some(RingLocation::Rib(band, band.place_of(h)));
            }
        }
        // Of a curve, one way or the other.
        if let Some((band, k)) = RingCurve::along(self, edge).or_else(|| RingCurve::along(self, e.twin)) {
            return Some(RingLocation::Curve(band, k));
        }
        match self.near_vertex(tail)? {
            RingLocation::Curve(band, k) if band.rib(k) == Some(t.edge(edge)) => Some(RingLocation::Rib(band, k)),
            _ => None,
        }
    }

    /// The curve a strip is beside.
    fn near_face(&self, face: u32) -> Option<RingLocation<'_>> {
        let t = &self.topology;
        if t.ring(face).is_some() {
            return None;
        }
        t.rim(face).find_map(|h| {
            let e = t.half_edge(h);
            if let Some(band) = RingCurve::link(self, e.to) {
                // The half-edge from the apex with this face on its left.
                return Some(RingLocation::Rib(band, band.place_of(e.next)));
            }
            let (ring, k) = t.long_rim(e.to).filter(|(ring, k)| ring[*k] == e.twin)?;
            let ring = Ring::Rim(ring);
            Some(RingLocation::Rib(RingCurve { body: self, ring }, k))
        })
    }
}
