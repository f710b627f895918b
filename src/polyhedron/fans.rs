//! Vertices of many edges: which edge rises most, without a look at every edge.
//!
//! With a direction `m` along which every edge `e` of a fan rises, the points `e / (m . e)` are the corners of a convex
//! polygon in the plane `m . x = 1`. A direction `n` on them, `n . e / (m . e)`, rises to one corner and falls from it,
//! and is positive where `n . e` is. So a search round the ring finds an edge that rises, if one does: for certain where the values
//! are compared without rounding (`highest`), else most of the time.

use alloc::vec::Vec;
use nalgebra::Vector3;

use super::highest::{Direction, Upward};
use super::topology::{LARGE, MANY, Topology};
use super::{ConvexPolyhedron, Plane};

/// The large fans of a body: their vertices in rising order, each with its direction `m`.
#[derive(Clone, Debug)]
pub(crate) struct Fans(Vec<(u32, Vector3<f64>)>);

impl Fans {
    /// For fans of more than [`LARGE`] edges, minus the sum of the normals of their faces; left out where rounding makes
    /// an edge not rise along that, of which a tip must be no higher than rounding over a base of thousands of corners.
    pub(crate) fn new(topology: &Topology, points: &[Vector3<f64>], planes: &[Plane]) -> Self {
        let axis = |v: u32| {
            let normals = topology
                .fan(v)
                .map(|h| planes[topology.half_edge(h).face as usize].normal);
            let m = -normals.sum::<Vector3<f64>>() / topology.fan(v).len() as f64;
            let along = Direction::new(points, &m, &Vector3::zeros());
            topology.neighbours(v).all(|w| along.rise(v, w) > 0).then_some((v, m))
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

/// The place of the greatest value on a ring on which values rise to one place and fall from it.
pub(crate) fn top_of_ring<V: PartialOrd>(m: usize, value: impl Fn(usize) -> V) -> usize {
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
fn top_from<V: PartialOrd>(m: usize, mut best: usize, mut stride: usize, value: impl Fn(usize) -> V) -> usize {
    let mut top = value(best);
    // Each round finds a higher place or halves the stride: no more rounds than places and halvings, whatever the values.
    for _ in 0..m + usize::BITS as usize {
        let (left, right) = ((best + m - stride % m) % m, (best + stride) % m);
        let (at_left, at_right) = (value(left), value(right));
        if at_left > top {
            (best, top) = (left, at_left);
        } else if at_right > top {
            (best, top) = (right, at_right);
        } else if stride == 1 {
            break;
        } else {
            stride = stride.div_ceil(2);
        }
    }
    best
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
}
