//! Vertices of many edges: which edge rises most, and how high the body reaches there, without a look at every edge.
//!
//! With a direction `m` along which every edge `e` of a fan rises, the points `e / (m . e)` are the corners of a convex
//! polygon in the plane `m . x = 1`. A direction `n` on them, `n . e / (m . e)`, rises to one corner and falls from it,
//! and is positive where `n . e` is. So a search round the ring finds an edge that rises, if one does.
//!
//! That none does is a matter of proof, and the search has none: among ten thousand nearly parallel edges rounding hides
//! the order. The faces prove it. Where `n` is a sum of normals of three of them with weights that are not negative, the vertex is
//! the highest along `n` ([`ConvexPolyhedron::extreme_by_faces`]), whatever the search did.

use alloc::vec::Vec;
use nalgebra::Vector3;

use super::support::{Extreme, highest_of};
use super::topology::{LARGE, MANY, Topology};
use super::{ConvexPolyhedron, Plane};
use crate::double_double::DoubleDouble;
use crate::scalar::{Scalar, cross, dot, scaled, sqrt};
use crate::tolerance::{EDGE_SIGN, PLANE_BOUND};

/// The large fans of a body: their vertices in rising order, each with its direction `m`.
#[derive(Clone, Debug)]
pub(crate) struct Fans(Vec<(u32, Vector3<f64>)>);

impl Fans {
    /// For fans of more than [`LARGE`] edges, minus the sum of the normals of their faces; left out where rounding makes
    /// an edge not rise along that.
    pub(crate) fn new(topology: &Topology, points: &[Vector3<f64>], planes: &[Plane]) -> Self {
        let axis = |v: u32| {
            let normals = topology
                .fan(v)
                .map(|h| planes[topology.half_edge(h).face as usize].normal);
            let m = -normals.sum::<Vector3<f64>>() / topology.fan(v).len() as f64;
            let rises = |w: u32| {
                let e = points[w as usize] - points[v as usize];
                m.dot(&e) > EDGE_SIGN * m.abs().dot(&e.abs())
            };
            topology.neighbours(v).all(rises).then_some((v, m))
        };
        let large = (0..topology.vertex_count() as u32).filter(|&v| topology.fan(v).len() > LARGE);
        Self(large.filter_map(axis).collect())
    }

    /// Whether there are none.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.0.capacity() * size_of::<(u32, Vector3<f64>)>()
    }

    /// Along which all edges of `v` rise; `None` for fans of up to [`MANY`] edges, which are soon looked round.
    #[inline(always)]
    pub(crate) fn axis(&self, topology: &Topology, v: u32) -> Option<&Vector3<f64>> {
        if topology.fan(v).len() <= MANY {
            None
        } else {
            self.find(v)
        }
    }

    #[cold]
    fn find(&self, v: u32) -> Option<&Vector3<f64>> {
        let k = self.0.binary_search_by_key(&v, |f| f.0).ok()?;
        Some(&self.0[k].1)
    }
}

/// The half-edge of the large fan of `v` for which `n . e / (m . e)` is greatest.
#[inline(never)]
pub(crate) fn steepest(t: &Topology, points: &[Vector3<f64>], v: u32, m: &Vector3<f64>, n: &Vector3<f64>) -> u32 {
    let (fan, p) = (t.fan(v), points[v as usize]);
    let slope = |k: usize| {
        let e = points[t.half_edge(fan.start + k as u32).to as usize] - p;
        n.dot(&e) / m.dot(&e)
    };
    fan.start + top_of_ring(fan.len(), slope) as u32
}

/// The highest neighbour of `v`, where heights round its large fan rise once and fall once, as they do where the neighbours
/// lie in one plane; some neighbour elsewhere.
pub(crate) fn highest_neighbour(t: &Topology, points: &[Vector3<f64>], v: u32, n: &Vector3<f64>) -> u32 {
    let fan = t.fan(v);
    let to = |k: usize| t.half_edge(fan.start + k as u32).to;
    to(top_of_ring(fan.len(), |k| n.dot(&points[to(k) as usize])))
}

/// The place of the greatest value on a ring on which values rise to one place and fall from it.
pub(crate) fn top_of_ring(m: usize, value: impl Fn(usize) -> f64) -> usize {
    let stride = m.div_ceil(4).max(1);
    let (mut best, mut top) = (0, value(0));
    for k in 1..4 {
        let (k, v) = ((k * stride) % m, value((k * stride) % m));
        if v > top {
            (best, top) = (k, v);
        }
    }
    top_from(m, best, stride, value)
}

/// The same from a place, by strides from the given one down to one.
fn top_from(m: usize, mut best: usize, mut stride: usize, value: impl Fn(usize) -> f64) -> usize {
    let mut top = value(best);
    loop {
        let (left, right) = ((best + m - stride % m) % m, (best + stride) % m);
        let (at_left, at_right) = (value(left), value(right));
        if at_left > top {
            (best, top) = (left, at_left);
        } else if at_right > top {
            (best, top) = (right, at_right);
        } else if stride == 1 {
            return best;
        } else {
            stride = stride.div_ceil(2);
        }
    }
}

impl ConvexPolyhedron {
    /// The half-edge of the large fan of `v` that makes the least angle with `d`, which leads out of the body: the rib nearest to a point
    /// there. Of the faces seen from there, one is found as in `closest::behind`; along those seen the angle falls to one
    /// rib and rises from it.
    #[inline(never)]
    pub(crate) fn nearest_rib(&self, v: u32, d: &Vector3<f64>) -> u32 {
        let (t, fan, p) = (&self.topology, self.topology.fan(v), self.points[v as usize]);
        let m = fan.len();
        let inward = self.inner - p;
        let normal = |k: usize| &self.planes[t.half_edge(fan.start + (k % m) as u32).face as usize].normal;
        let seen = top_of_ring(m, |k| -normal(k).dot(d) / normal(k).dot(&inward));
        let fall = |k: usize| {
            let e = self.points[t.half_edge(fan.start + k as u32).to as usize] - p;
            let c = d.dot(&e);
            if normal(k).dot(d) > 0.0 || normal(k + m - 1).dot(d) > 0.0 {
                c * c.abs() / e.norm_squared()
            } else {
                f64::NEG_INFINITY
            }
        };
        fan.start + top_from(m, seen, m.div_ceil(8), fall) as u32
    }

    /// A vertex at or beside `v`, of a large fan or face, that is highest along `n` but for rounding, and a bound of `n . x` over the
    /// body. `None` where no three faces prove one.
    #[inline(never)]
    pub(crate) fn extreme_by_faces(&self, n: &Vector3<f64>, v: u32) -> Option<Extreme> {
        let (t, near) = (&self.topology, PLANE_BOUND * self.radius * sqrt(n.norm_squared()));
        let proven = |v: u32, corners: [u32; 3]| {
            let above = 2.0 * self.radius * self.rest(n, v, corners)?.abs().sum();
            let value = n.dot(&self.points[v as usize]) + above;
            (above <= near).then_some(Extreme { vertex: v, value })
        };
        // Where an edge of a vertex of few lies between two of its faces, with each of the others.
        let beside = |h: u32| {
            let fan = t.fan(t.from(h));
            let before = if h == fan.start { fan.end - 1 } else { h - 1 };
            fan.clone().find_map(|third| proven(t.from(h), [before, h, third]))
        };
        if let Some(m) = self.fans.axis(t, v) {
            return proven(v, self.faces_around(n, v)).or_else(|| {
                // On a rib: its other end.
                let rib = t.half_edge(steepest(t, &self.points, v, m, n));
                (t.fan(rib.to).len() <= MANY).then(|| beside(rib.twin)).flatten()
            });
        }
        if t.fan(v).len() > MANY {
            return None;
        }
        let large = t.fan(v).filter_map(|h| t.ring(t.half_edge(h).face));
        large.map(|ring| highest_of(t, &self.points, n, ring)).find_map(|top| {
            let few = t.fan(top).len() <= MANY;
            few.then(|| t.fan(top).find_map(beside)).flatten()
        })
    }

    /// Three faces of the large fan of `v`, by the half-edges on their right, between whose normals `n` lies, if it does between those
    /// of all: the normals are a convex ring, cut into wedges from the first.
    fn faces_around(&self, n: &Vector3<f64>, v: u32) -> [u32; 3] {
        let fan = self.topology.fan(v);
        let normal = |h: u32| &self.planes[self.topology.half_edge(h).face as usize].normal;
        let across = n.cross(normal(fan.start));
        let (mut low, mut high) = (fan.start + 1, fan.end - 1);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            // n . (N0 x Nk)
            if across.dot(normal(middle)) >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        [fan.start, low, high]
    }

    /// What is left of `n` by a sum of the outward normals of three faces at `v`, with weights that are not negative: for every point
    /// `x` of the body `n . (x - v) <= rest . (x - v)`. The normals are cross products of edges in double-double, so that the rest
    /// has no rounding to count. `None` where the normals lie in a plane.
    fn rest(&self, n: &Vector3<f64>, v: u32, faces: [u32; 3]) -> Option<Vector3<f64>> {
        let fan = self.topology.fan(v);
        let p = &self.points[v as usize];
        let edge = |h: u32| -> [DoubleDouble; 3] {
            let q = &self.points[self.topology.half_edge(h).to as usize];
            core::array::from_fn(|k| DoubleDouble::sum(q[k], -p[k]))
        };
        let normals = faces.map(|h| cross(&edge(h), &edge(if h + 1 == fan.end { fan.start } else { h + 1 })));
        // Unit length, so that weights are no larger than need be; the factor is exact enough.
        let normals = normals.map(|f| {
            let length = sqrt(dot(&f, &f).value());
            scaled(&f, DoubleDouble::from(1.0 / length))
        });
        let [a, b, c] = normals.map(|f| Vector3::from(f.map(Scalar::value)));
        let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
        let volume = a.dot(&bc);
        if !(volume > 0.0) {
            return None;
        }
        let zero = DoubleDouble::from(0.0);
        let mut weights = [zero; 3];
        let left = |weights: &[DoubleDouble; 3]| {
            let parts = |k: usize| weights.iter().zip(&normals).map(move |(&w, f)| w * f[k]);
            Vector3::from_fn(|k, _| parts(k).fold(DoubleDouble::from(n[k]), |s, x| s - x).value())
        };
        // Thin wedges cancel: twice.
        for _ in 0..2 {
            let rest = left(&weights);
            for (w, side) in weights.iter_mut().zip([bc, ca, ab]) {
                *w = *w + DoubleDouble::from(rest.dot(&side) / volume);
            }
        }
        if weights.iter().any(|w| *w < zero) {
            // Beyond a side by rounding: what is dropped there the others take over.
            let positive = |w: DoubleDouble| if w > zero { w } else { zero };
            weights = weights.map(positive);
            for k in [0, 1, 2, 0, 1, 2] {
                weights[k] = positive(weights[k] + DoubleDouble::from(left(&weights).dot(&[a, b, c][k])));
            }
        }
        Some(left(&weights))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_finds_the_top_of_a_ring() {
        for m in 3..200 {
            for top in 0..m {
                let height = |k: usize| (core::f64::consts::TAU * (k as f64 - top as f64) / m as f64).cos();
                assert_eq!(top_of_ring(m, height), top);
            }
        }
    }

    /// A cone over random points of an ellipse, its tip off the middle.
    fn cone(n: usize, rng: &mut lab::rng::Rng) -> ConvexPolyhedron {
        let angle = |_| rng.range(0.0, core::f64::consts::TAU);
        let rim: Vec<f64> = (0..n).map(angle).collect();
        let rim = rim.iter().map(|t| nalgebra::Point3::new(t.cos(), 0.6 * t.sin(), 0.0));
        let points: Vec<_> = rim.chain([nalgebra::Point3::new(0.5, 0.3, 0.4)]).collect();
        ConvexPolyhedron::from_points(&points).expect("a solid")
    }

    #[test]
    fn what_three_faces_prove_is_so_from_any_vertex_along_any_direction() {
        let mut rng = lab::rng::Rng::new(77);
        let (mut proven, mut open) = (0, 0);
        for n in [130, 1000, 5000] {
            let body = cone(n, &mut rng);
            let apex = (0..body.points.len() as u32)
                .max_by_key(|&v| body.topology.fan(v).len())
                .expect("vertices");
            for k in 0..600 {
                // Of any length; every other one next to the normal of a face of the tip.
                let face = body.topology.half_edge(body.topology.fan(apex).start + k % 100).face;
                let aside = Vector3::from(rng.unit()) * [1e-3, 1e-12, 1e-15, 0.0][k as usize / 2 % 4];
                let n = match k % 2 {
                    0 => Vector3::from(rng.unit()) * rng.range(0.1, 4.0),
                    _ => body.planes[face as usize].normal + aside,
                };
                let rib = body.topology.half_edge(body.topology.fan(apex).start + k % 90).to;
                for v in [apex, rib] {
                    let heights = body.points.iter().map(|p| n.dot(p));
                    let top = heights.fold(f64::NEG_INFINITY, f64::max);
                    let Some(e) = body.extreme_by_faces(&n, v) else {
                        open += 1;
                        continue;
                    };
                    proven += 1;
                    let rounding = 8.0 * crate::tolerance::UNIT * n.norm() * body.radius;
                    assert!(e.value >= top - rounding, "{} {top}", e.value);
                    let here = n.dot(&body.points[e.vertex as usize]);
                    assert!(
                        top - here <= PLANE_BOUND * n.norm() * body.radius + rounding,
                        "{here} {top}"
                    );
                }
            }
        }
        assert!(proven > 400 && open > 400, "{proven} {open}");
    }
}
