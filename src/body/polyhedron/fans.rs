//! Half-edges in counter-clockwise order, by index: the fan of a vertex, the ring of a large face.
//! Bisection finds the greatest of unimodal values on a ring, and so the steepest edge of a fan
//! along a direction, without examining every edge.
//!
//! Let `m` be a direction along which every edge `e` of a fan rises. Then the points `e / (m . e)`
//! are the vertices of a convex polygon in the plane `m . x = 1`, and the heights `n . e / (m . e)`
//! along any direction `n` are unimodal around the polygon. A height is positive if and only if `n
//! . e` is. So a search around the fan finds a rising edge if there is one: always if heights are
//! compared without rounding (`highest`), otherwise usually.
//!
//! ```text
//!   \_______/        plane m . x = 1: the points e / (m . e), a convex polygon
//!    \     /    ^
//!     \   /     m    every edge e of the fan rises along m
//!      \ /
//!       v
//! ```
//!
//! Such a direction `m` is the axis of the fan, and its signs are exact.

use crate::base::num::double_double::{DoubleDouble, Expansion};
use crate::base::num::each::Each;
use crate::base::num::sign::{edge_sign, exact_dot, side};
use crate::body::polyhedron::feature::HalfEdgeId;
use crate::body::polyhedron::highest::{Direction, Slope};
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{ConvexPolyhedron, Plane, VertexId};
use alloc::vec::Vec;
use nalgebra::Vector3;

/// Fans with more edges are searched. Up to this number, examining every edge is as cheap.
pub(crate) const MANY: usize = 128;

/// The large fans of a body: their vertices in rising order, each with its axis.
#[derive(Clone, Debug)]
pub(crate) struct Fans(Vec<(VertexId, Axis)>);

impl Fans {
    /// Computes the axes of all fans of more than [`LARGE`] edges; fans without an axis are left
    /// out.
    pub(crate) fn new(topology: &Topology, points: &[Vector3<f64>], planes: &[Plane]) -> Self {
        let axis = |v| {
            Axis::from_normals(topology, points, planes, v).or_else(|| Axis::from_exact_normals(topology, points, v))
        };
        let large = VertexId::all(topology.vertex_count()).filter(|&v| topology.fan(v).len() > LARGE);
        Self(large.filter_map(|v| Some((v, axis(v)?))).collect())
    }

    /// Returns whether the body has no large fan.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        self.0.capacity() * size_of::<(VertexId, Axis)>()
    }

    /// Returns the axis of the fan of `v`; `None` for fans of up to [`MANY`] edges, which are
    /// examined edge by edge.
    #[inline(always)]
    pub(crate) fn axis(&self, topology: &Topology, v: VertexId) -> Option<&Axis> {
        if topology.fan(v).len() <= MANY {
            None
        } else {
            self.find(v)
        }
    }

    #[cold]
    fn find(&self, v: VertexId) -> Option<&Axis> {
        let k = self.0.binary_search_by_key(&v, |f| f.0).ok()?;
        Some(&self.0[k].1)
    }
}

/// Returns the half-edge of the large fan of `v` with the greatest `n . e / (m . e)`, in f64 as far
/// as the axis allows.
#[inline(never)]
pub(crate) fn steepest(
    t: &Topology,
    points: &[Vector3<f64>],
    v: VertexId,
    axis: &Axis,
    n: &Vector3<f64>,
) -> HalfEdgeId {
    let (fan, p, m) = (t.fan(v), points[v.index()], axis.rounded());
    let to = |h| t.half_edge(h).to;
    if axis.is_plain {
        fan.top(|h| {
            let e = points[to(h).index()] - p;
            n.dot(&e) / m.dot(&e)
        })
    } else {
        let n = Direction::new(points, n, &Vector3::zeros());
        fan.top(|h| Slope(&n, axis, v, to(h)))
    }
}

impl ConvexPolyhedron {
    /// Returns half-edges of `v` among which are all half-edges whose edge or left face also holds
    /// vertex `w`: the whole fan, or three half-edges of a large fan.
    pub(crate) fn toward(&self, v: VertexId, w: VertexId) -> impl Iterator<Item = HalfEdgeId> + Clone + use<> {
        let (t, fan) = (&self.topology, self.topology.fan(v));
        let m = fan.len();
        let (mut first, mut count) = (0, m);
        if m > MANY {
            // Seen along the first edge from `v`, all edges turn counter-clockwise by less than
            // half a turn, and `w` lies among them.
            let to = |k: usize| &self.points[t.half_edge(fan.at(k)).to.index()];
            let (p, q, at) = (&self.points[v.index()], to(0), &self.points[w.index()]);
            let (mut low, mut high) = (1, m);
            while low < high {
                let k = low.midpoint(high);
                if side(p, q, to(k), at) < 0.0 {
                    low = k + 1;
                } else {
                    high = k;
                }
            }
            // Vertex `w` lies between the edges before and at `low`, or on the edge before, and
            // then also on the face before that edge.
            (first, count) = (low + m - 2, 3);
        }
        (first..first + count).map(move |k| fan.wrapped(k))
    }

    /// Returns the half-edge of the large fan of `v` with the least angle to `d`, which must lead
    /// out of the body: the edge nearest to a point there. A face visible from the point is found
    /// as in `walk::slide::exit_face`; along the visible faces the angle is unimodal, with a
    /// minimum at an edge.
    #[inline(never)]
    pub(crate) fn nearest_edge(&self, v: VertexId, d: &Vector3<f64>) -> HalfEdgeId {
        let (t, fan, p) = (&self.topology, self.topology.fan(v), self.points[v.index()]);
        let m = fan.len();
        let inward = self.vertex_mean - p;
        let normal = |k: usize| &self.planes[t.half_edge(fan.wrapped(k)).face.index()].normal;
        let seen = top_of_ring(m, |k| -normal(k).dot(d) / normal(k).dot(&inward));
        let fall = |k: usize| {
            let e = self.points[t.half_edge(fan.at(k)).to.index()] - p;
            let c = d.dot(&e);
            if normal(k).dot(d) > 0.0 || normal(k + m - 1).dot(d) > 0.0 {
                c * c.abs() / e.norm_squared()
            } else {
                f64::NEG_INFINITY
            }
        };
        fan.at(top_from(m, seen, m.div_ceil(8), fall))
    }
}

/// The axis `m` of a fan: a direction along which all its edges rise, each coordinate a sum of
/// parts of falling magnitude.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    parts: [[f64; Self::PARTS]; 3],
    /// Whether f64 is certain that all edges rise along the first parts; then all other parts are
    /// zero.
    pub(super) is_plain: bool,
}

impl Axis {
    /// Number of parts. One part is enough but for an apex no higher than rounding over a base of
    /// thousands of vertices.
    const PARTS: usize = 4;

    #[cfg(test)]
    pub(super) fn new(parts: [[f64; Self::PARTS]; 3]) -> Self {
        Self { parts, is_plain: false }
    }

    /// Returns minus the mean normal of the faces at `v`, if f64 is certain that all edges of `v`
    /// rise along it.
    pub(super) fn from_normals(t: &Topology, points: &[Vector3<f64>], planes: &[Plane], v: VertexId) -> Option<Self> {
        let normals = t.fan(v).iter().map(|h| planes[t.half_edge(h).face.index()].normal);
        let m = -normals.sum::<Vector3<f64>>() / t.fan(v).len() as f64;
        let rises = |w: VertexId| edge_sign(&m, &(points[w.index()] - points[v.index()])) > 0;
        let parts = [0, 1, 2].each(|k| core::array::from_fn(|part| if part == 0 { m[k] } else { 0.0 }));
        t.neighbours(v).all(rises).then_some(Self { parts, is_plain: true })
    }

    /// Returns minus the sum of the exact normals of two faces at `v` without a common edge: all
    /// edges of `v` rise along this sum. `None` if the sum has too many parts.
    pub(super) fn from_exact_normals(t: &Topology, points: &[Vector3<f64>], v: VertexId) -> Option<Self> {
        let (fan, p) = (t.fan(v), points[v.index()]);
        let to = |h: HalfEdgeId| points[t.half_edge(h).to.index()];
        let faces = [0, fan.len() / 2].each(|k| [k, k + 1].each(|k| to(fan.at(k))));
        let coordinate = |k: usize| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let mut sum = Expansion::<{ 24 + Self::PARTS }>::new();
            for [q, r] in faces {
                // (r - p) x (q - p) without differences, which may be rounded.
                for (x, y) in [(r, q), (q, p), (p, r)] {
                    sum.add_product(x[i], y[j]);
                    sum.add_product(-x[j], y[i]);
                }
            }
            sum.leading()
        };
        let (parts, is_plain) = ([0, 1, 2].each(coordinate), false);
        let axis = Self { parts, is_plain };
        let rises = |w: VertexId| axis.rise(&p, &points[w.index()]).sign() > 0;
        t.neighbours(v).all(rises).then_some(axis)
    }

    /// Returns the axis rounded to f64.
    pub(crate) fn rounded(&self) -> Vector3<f64> {
        Vector3::from(self.parts.each(|p| p[0]))
    }

    /// Returns the first two parts of each coordinate, as double-double.
    pub(super) fn doubled(&self) -> [DoubleDouble; 3] {
        self.parts.each(|[hi, lo, ..]| DoubleDouble { hi, lo })
    }

    /// Returns all parts of each coordinate.
    #[cfg(feature = "exact")]
    pub(crate) fn parts(&self) -> &[[f64; Self::PARTS]; 3] {
        &self.parts
    }

    /// Returns `m . (q - p)` without rounding.
    pub(super) fn rise(&self, p: &Vector3<f64>, q: &Vector3<f64>) -> Expansion<{ 12 * Self::PARTS }> {
        exact_dot(&self.parts, p, q)
    }
}

/// Faces of more edges are kept as rings too: bisection on a list for longer lists in memory. Also
/// the number of edges of a face examined one by one, and the size of the arrays for small faces.
pub(crate) const LARGE: usize = 24;

/// Half-edges around a vertex or around a large face, counter-clockwise from outside.
pub(crate) trait Cycle {
    /// Returns the number of half-edges.
    fn count(&self) -> usize;

    /// Returns the half-edge of index `k`, which must be less than [`count`](Self::count).
    fn at(&self, k: usize) -> HalfEdgeId;

    /// Returns the half-edge of index `k` modulo [`count`](Self::count).
    #[inline(always)]
    fn wrapped(&self, k: usize) -> HalfEdgeId {
        let m = self.count();
        self.at(if k < m { k } else { k % m })
    }

    /// Returns the index of the half-edge of the greatest value, by bisection. Values must be
    /// unimodal round the cycle.
    #[inline]
    fn top_index<V: PartialOrd>(&self, value: impl Fn(HalfEdgeId) -> V) -> usize {
        top_of_ring(self.count(), |k| value(self.at(k)))
    }

    /// Returns the half-edge of the greatest value, as [`top_index`](Self::top_index).
    #[inline]
    fn top<V: PartialOrd>(&self, value: impl Fn(HalfEdgeId) -> V) -> HalfEdgeId {
        self.at(self.top_index(value))
    }
}

/// The half-edges that leave a vertex: consecutive numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fan {
    pub(super) start: u32,
    pub(super) end: u32,
}

impl Fan {
    /// Returns the number of half-edges.
    #[inline(always)]
    pub(crate) fn len(self) -> usize {
        (self.end - self.start) as usize
    }

    /// Returns the half-edges in order.
    #[inline(always)]
    pub(crate) fn iter(self) -> impl ExactSizeIterator<Item = HalfEdgeId> + Clone + use<> {
        (self.start..self.end).map(HalfEdgeId)
    }

    /// Returns the half-edge after `h`, counter-clockwise.
    #[inline(always)]
    pub(crate) fn after(self, h: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(if h.0 + 1 == self.end { self.start } else { h.0 + 1 })
    }

    /// Returns the index of a half-edge of the fan; the last index for any other half-edge.
    #[inline(always)]
    pub(crate) fn index_of(self, h: HalfEdgeId) -> usize {
        (h.0.wrapping_sub(self.start) as usize).min(self.len() - 1)
    }
}

impl Cycle for Fan {
    #[inline(always)]
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn at(&self, k: usize) -> HalfEdgeId {
        HalfEdgeId(self.start + k as u32)
    }
}

impl Cycle for [HalfEdgeId] {
    #[inline(always)]
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn at(&self, k: usize) -> HalfEdgeId {
        self[k]
    }
}

/// Returns the index of the greatest of `m` unimodal values on a ring: values that rise to an index
/// and fall from there.
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

/// Returns the index of the greatest of `m` unimodal values, searching from index `best` by strides
/// from the given one down to one.
pub(super) fn top_from<V: PartialOrd>(
    m: usize,
    mut best: usize,
    mut stride: usize,
    value: impl Fn(usize) -> V,
) -> usize {
    let mut top = value(best);
    // Each round finds a higher value or halves the stride: no more rounds than values and
    // halvings, whatever the values.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tolerance::UNIT;
    use nalgebra::{Point3, UnitQuaternion};

    /// Two apexes over a base of 300 vertices, the first `height` above the plane of the base,
    /// which is level or not; on a diagonal plane the vertices are whole numbers, exactly on the
    /// plane.
    fn double_cone(plane: &str, height: f64) -> ConvexPolyhedron {
        let turn = UnitQuaternion::from_euler_angles(0.3, 0.7, -0.4);
        let place = |p: [f64; 3]| match plane {
            "level" => Point3::from(p),
            "turned" => turn * Point3::from(p),
            _ => {
                let [x, y, z] = p;
                let (x, y) = ((x * 1e6).round(), (y * 1e6).round());
                Point3::new(x + z, y + z, z - x - y)
            }
        };
        let rim = (0..300).map(|k| core::f64::consts::TAU * f64::from(k) / 300.0);
        let rim = rim.map(|t| [t.cos(), t.sin(), 0.0]);
        let points: Vec<_> = rim.chain([[0.0, 0.0, height], [0.0, 0.0, -1.0]]).map(place).collect();
        ConvexPolyhedron::from_points(&points).expect("a solid")
    }

    #[test]
    fn tips_lower_than_rounding_have_an_axis() {
        for (plane, height) in [
            ("level", 0.5),
            ("level", 1e-60),
            ("turned", 0.5),
            ("turned", 16.0 * UNIT),
            ("diagonal", 0.5),
            ("diagonal", 1e-16),
            ("diagonal", 1e-45),
        ] {
            let body = double_cone(plane, height);
            let tips: Vec<_> = VertexId::all(body.points.len())
                .filter(|&v| body.topology.fan(v).len() > MANY)
                .collect();
            assert!(
                tips.len() > usize::from(plane != "turned"),
                "{plane} {height}: {}",
                tips.len()
            );
            for &v in &tips {
                let axis = body.fans.axis(&body.topology, v).expect("an axis");
                let at = |v: VertexId| &body.points[v.index()];
                assert!(body.topology.neighbours(v).all(|w| axis.rise(at(v), at(w)).sign() > 0));
            }
        }
    }

    #[test]
    fn what_two_vertices_share_is_toward_each_other() {
        // Two apexes that share an edge, over a base of 300 vertices.
        let rim = (0..300).map(|k| core::f64::consts::PI * f64::from(k) / 299.0);
        let rim = rim.map(|t| Point3::new(0.0, t.cos(), 0.1 + t.sin()));
        let apexes = [1.0, -1.0].map(|x| Point3::new(x, 0.0, 0.0));
        let tent = ConvexPolyhedron::from_points(&rim.chain(apexes).collect::<Vec<_>>()).expect("a solid");
        for body in [tent, double_cone("level", 0.5), double_cone("turned", 4.0 * UNIT)] {
            let t = &body.topology;
            let all = VertexId::all(t.vertex_count());
            let tips = all.clone().filter(|&v| t.fan(v).len() > MANY);
            let (mut edges, mut faces) = (0, 0);
            for (v, w) in tips.flat_map(|v| all.clone().filter(move |&w| w != v).map(move |w| (v, w))) {
                let near: Vec<HalfEdgeId> = body.toward(v, w).collect();
                assert_eq!(near.len(), 3);
                for h in t.fan(v).iter() {
                    let e = t.half_edge(h);
                    let edge = e.to == w;
                    let face = t.rim(e.face).any(|g| t.from(g) == w);
                    assert!(!(edge || face) || near.contains(&h), "{v} {w}");
                    (edges, faces) = (edges + u32::from(edge), faces + u32::from(face));
                }
            }
            assert!(edges > 250 && faces > 500, "{edges} {faces}");
        }
    }
}

#[cfg(test)]
mod unimodal_tests {
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
