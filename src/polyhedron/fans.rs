//! Vertices of many edges: which edge rises most, without a look at every edge.
//!
//! With a direction `m` along which every edge `e` of a fan rises, the points `e / (m . e)` are the
//! corners of a convex polygon in the plane `m . x = 1`. A direction `n` on them,
//! `n . e / (m . e)`, rises to one corner and falls from it, and is positive where `n . e` is. So a
//! search round the ring finds an edge that rises, if one does: for certain where the values are
//! compared without rounding (`highest`), else most of the time.

use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::num::double_double::{DoubleDouble, Expansion};
use crate::num::sign::side;
use crate::polyhedron::highest::{Direction, Slope, exact};
use crate::polyhedron::support::edge_sign;
use crate::polyhedron::topology::Topology;
use crate::polyhedron::{ConvexPolyhedron, Plane};
use crate::tuning::polyhedron::{LARGE, MANY};

/// The direction `m` of a fan, each coordinate a sum of parts that fall in magnitude.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    parts: [[f64; Self::PARTS]; 3],
    /// Whether f64 is certain that all edges rise along the first parts, and the others are zero.
    plain: bool,
}

impl Axis {
    /// One part is enough but for a tip that is no higher than rounding over a base of thousands of
    /// corners.
    const PARTS: usize = 4;

    #[cfg(test)]
    pub(super) fn new(parts: [[f64; Self::PARTS]; 3]) -> Self {
        Self { parts, plain: false }
    }

    /// Minus the sum of the normals of the faces at `v`, if f64 is certain that all edges of `v`
    /// rise along it.
    fn plain(t: &Topology, points: &[Vector3<f64>], planes: &[Plane], v: u32) -> Option<Self> {
        let normals = t.fan(v).map(|h| planes[t.half_edge(h).face as usize].normal);
        let m = -normals.sum::<Vector3<f64>>() / t.fan(v).len() as f64;
        let rises = |w: u32| edge_sign(&m, &(points[w as usize] - points[v as usize])) > 0;
        let parts = [0, 1, 2].map(|k| core::array::from_fn(|part| if part == 0 { m[k] } else { 0.0 }));
        t.neighbours(v).all(rises).then_some(Self { parts, plain: true })
    }

    /// Minus the sum of the exact normals of two faces at `v` without a common edge: all edges rise
    /// along that. `None` where it has too many parts.
    fn fine(t: &Topology, points: &[Vector3<f64>], v: u32) -> Option<Self> {
        let (fan, p) = (t.fan(v), points[v as usize]);
        let to = |h: u32| points[t.half_edge(h).to as usize];
        let faces = [fan.start, fan.start + fan.len() as u32 / 2].map(|h| [to(h), to(h + 1)]);
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
        let (parts, plain) = ([0, 1, 2].map(coordinate), false);
        let axis = Self { parts, plain };
        let rises = |w: u32| axis.rise(&p, &points[w as usize]).sign() > 0;
        t.neighbours(v).all(rises).then_some(axis)
    }

    /// Rounded.
    pub(crate) fn rounded(&self) -> Vector3<f64> {
        Vector3::from(self.parts.map(|p| p[0]))
    }

    /// The first two parts.
    pub(super) fn doubled(&self) -> [DoubleDouble; 3] {
        self.parts.map(|[hi, lo, ..]| DoubleDouble { hi, lo })
    }

    /// All parts.
    #[cfg(feature = "exact")]
    pub(crate) fn parts(&self) -> &[[f64; Self::PARTS]; 3] {
        &self.parts
    }

    /// `m . (q - p)` without rounding.
    pub(super) fn rise(&self, p: &Vector3<f64>, q: &Vector3<f64>) -> Expansion<{ 12 * Self::PARTS }> {
        exact(&self.parts, p, q)
    }
}

/// The large fans of a body: their vertices in rising order, each with its axis.
#[derive(Clone, Debug)]
pub(crate) struct Fans(Vec<(u32, Axis)>);

impl Fans {
    /// For fans of more than [`LARGE`] edges; left out are those without an axis.
    pub(crate) fn new(topology: &Topology, points: &[Vector3<f64>], planes: &[Plane]) -> Self {
        let axis = |v| Axis::plain(topology, points, planes, v).or_else(|| Axis::fine(topology, points, v));
        let large = (0..topology.vertex_count() as u32).filter(|&v| topology.fan(v).len() > LARGE);
        Self(large.filter_map(|v| Some((v, axis(v)?))).collect())
    }

    /// Whether there are none.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.0.capacity() * size_of::<(u32, Axis)>()
    }

    /// Along which all edges of `v` rise; `None` for fans of up to [`MANY`] edges, which are soon
    /// looked round.
    #[inline(always)]
    pub(crate) fn axis(&self, topology: &Topology, v: u32) -> Option<&Axis> {
        if topology.fan(v).len() <= MANY {
            None
        } else {
            self.find(v)
        }
    }

    #[cold]
    fn find(&self, v: u32) -> Option<&Axis> {
        let k = self.0.binary_search_by_key(&v, |f| f.0).ok()?;
        Some(&self.0[k].1)
    }
}

/// The half-edge of the large fan of `v` for which `n . e / (m . e)` is greatest, in f64 as far as
/// its axis allows.
#[inline(never)]
pub(crate) fn steepest(t: &Topology, points: &[Vector3<f64>], v: u32, axis: &Axis, n: &Vector3<f64>) -> u32 {
    let (fan, p, m) = (t.fan(v), points[v as usize], axis.rounded());
    let to = |k: usize| t.half_edge(fan.start + k as u32).to;
    let steepest = if axis.plain {
        top_of_ring(fan.len(), |k| {
            let e = points[to(k) as usize] - p;
            n.dot(&e) / m.dot(&e)
        })
    } else {
        let n = Direction::new(points, n, &Vector3::zeros());
        top_of_ring(fan.len(), |k| Slope(&n, axis, v, to(k)))
    };
    fan.start + steepest as u32
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
    // Each round finds a higher place or halves the stride: no more rounds than places and
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

impl ConvexPolyhedron {
    /// Half-edges of `v` among which are those of all edges and faces at `v` that vertex `w` is on:
    /// the whole fan, of a large one three.
    pub(crate) fn toward(&self, v: u32, w: u32) -> impl Iterator<Item = u32> + Clone + use<> {
        let (t, fan) = (&self.topology, self.topology.fan(v));
        let m = fan.len();
        let (mut first, mut count) = (0, m);
        if m > MANY {
            // Seen along the first edge from `v`, the others turn counter-clockwise by less than
            // half a turn, and `w` lies among them.
            let to = |k: usize| &self.points[t.half_edge(fan.start + k as u32).to as usize];
            let (p, q, at) = (&self.points[v as usize], to(0), &self.points[w as usize]);
            let (mut low, mut high) = (1, m);
            while low < high {
                let k = low.midpoint(high);
                if side(p, q, to(k), at) < 0.0 {
                    low = k + 1;
                } else {
                    high = k;
                }
            }
            // Between the edges before and at `low`; on that before it is also on the face before
            // that.
            (first, count) = (low + m - 2, 3);
        }
        (first..first + count).map(move |k| fan.start + (k % m) as u32)
    }

    /// The half-edge of the large fan of `v` that makes the least angle with `d`, which leads out
    /// of the body: the rib nearest to a point there. Of the faces seen from there, one is found as
    /// in `closest::behind`; along those seen the angle falls to one rib and rises from it.
    #[inline(never)]
    pub(crate) fn nearest_rib(&self, v: u32, d: &Vector3<f64>) -> u32 {
        let (t, fan, p) = (&self.topology, self.topology.fan(v), self.points[v as usize]);
        let m = fan.len();
        let inward = self.vertex_mean - p;
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
    use crate::tolerance::UNIT;
    use nalgebra::{Point3, UnitQuaternion};

    /// Two tips over a rim of 300 corners, the first `height` above its plane, which is level or
    /// not; on a diagonal plane the corners are whole numbers, exactly on it.
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
            let tips: Vec<u32> = (0..body.points.len() as u32)
                .filter(|&v| body.topology.fan(v).len() > MANY)
                .collect();
            assert!(
                tips.len() > usize::from(plane != "turned"),
                "{plane} {height}: {}",
                tips.len()
            );
            for &v in &tips {
                let axis = body.fans.axis(&body.topology, v).expect("an axis");
                let at = |v: u32| &body.points[v as usize];
                assert!(body.topology.neighbours(v).all(|w| axis.rise(at(v), at(w)).sign() > 0));
            }
        }
    }

    #[test]
    fn what_two_vertices_share_is_toward_each_other() {
        // Two apexes that share an edge and a rim of 300 corners.
        let rim = (0..300).map(|k| core::f64::consts::PI * f64::from(k) / 299.0);
        let rim = rim.map(|t| Point3::new(0.0, t.cos(), 0.1 + t.sin()));
        let apexes = [1.0, -1.0].map(|x| Point3::new(x, 0.0, 0.0));
        let tent = ConvexPolyhedron::from_points(&rim.chain(apexes).collect::<Vec<_>>()).expect("a solid");
        for body in [tent, double_cone("level", 0.5), double_cone("turned", 4.0 * UNIT)] {
            let t = &body.topology;
            let all = 0..t.vertex_count() as u32;
            let tips = all.clone().filter(|&v| t.fan(v).len() > MANY);
            let (mut edges, mut faces) = (0, 0);
            for (v, w) in tips.flat_map(|v| all.clone().filter(move |&w| w != v).map(move |w| (v, w))) {
                let near: Vec<u32> = body.toward(v, w).collect();
                assert_eq!(near.len(), 3);
                for h in t.fan(v) {
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
