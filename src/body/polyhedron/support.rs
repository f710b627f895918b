//! Support vertices: hill climbing from a hint, and a cube map of directions for cold starts.
//!
//! Every vertex of a convex body that is not a support vertex has a strictly better adjacent
//! vertex, so climbing ends at a support vertex. Rounding breaks this argument only if the sign of
//! `n . e` along an edge `e` is uncertain; the climb then continues with exact signs (`highest`).
//! Signs are computed from edge vectors, never from the difference of two large products: on a
//! chamfer of 1e-9 that difference shows no higher adjacent vertex, although a far vertex is
//! higher.
//!
//! Sources: Cameron 1997 (hill climbing with cached vertices). The cube map follows the directional
//! lookup of Ehmann and Lin 2000, section 4.2, with cells on a cube instead of a sphere, so it
//! needs no trigonometry.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::packed::PackedVec3;
use crate::base::num::sign::edge_sign;
use crate::base::tolerance::EDGE_SIGN;
use crate::body::polyhedron::fans::{Fans, steepest};
use crate::body::polyhedron::highest;
use crate::body::polyhedron::highest::Direction;
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{ConvexPolyhedron, VertexId};

/// The largest number of vertices for which boxes are found by a scan in `f32`, and heights by a
/// scan in `f64`. The boxes of larger bodies are found by hill climbing from the extreme vertices
/// of the last frame. A scan takes linear time but has no branch to mispredict. The support
/// vertices of the minimum-norm solver are scanned up to this number too. Measured for that solver,
/// in piles of overlapping bodies: the scan takes 20 to 33 % less time at 48 and 64 vertices, the
/// same time at 96, and more at 128.
pub(super) const SCANNED: usize = 64;

/// The largest number of vertices for which a support vertex without a hint is found by a scan:
/// linear time, but no branch to mispredict.
const SCAN: usize = 16;

/// The cube map treats no body as flatter than this. A smaller value gives finer cells around the
/// axis of a flat body and coarser cells around its edge.
const FLATTEST: f64 = 1.0 / 1024.0;

/// Steps of a climb between two searches for a large face or fan to jump over: long climbs become
/// short, short climbs never pay for the search.
const LEAP: u32 = 4;

/// Climbs from `start` to a vertex with no adjacent vertex certainly higher along `n`.
#[inline]
pub(crate) fn support_climb(
    topology: &Topology,
    points: &[Vector3<f64>],
    fans: &Fans,
    n: PackedVec3,
    start: VertexId,
) -> VertexId {
    let mut v = start;
    let mut steps = 0;
    loop {
        let p = PackedVec3::new(&points[v.index()]);
        let (mut best, mut rise) = (v, 0.0);
        if let Some(m) = fans.axis(topology, v) {
            best = topology.half_edge(steepest(topology, points, v, m, &n.vector())).to;
        } else {
            topology.each_leaving(v, |_, to| {
                let c = n.dot(PackedVec3::new(&points[to.index()]) - p);
                if c > rise {
                    (best, rise) = (to, c);
                }
            });
        }
        // Only a certain rise is a move, so the loop ends among tied vertices.
        if best == v || edge_sign(&n.vector(), &(points[best.index()] - points[v.index()])) <= 0 {
            return v;
        }
        steps += 1;
        v = if steps % LEAP == 0 {
            jump(topology, points, fans, &n.vector(), best)
        } else {
            best
        };
    }
}

/// Jumps to the highest vertex of a large face, or to a high vertex of a large fan, if the body has
/// such.
#[inline]
fn jump(topology: &Topology, points: &[Vector3<f64>], fans: &Fans, n: &Vector3<f64>, v: VertexId) -> VertexId {
    if !topology.has_large_faces() && fans.is_empty() {
        return v;
    }
    highest::jump(topology, fans, &Direction::new(points, n, &Vector3::zeros()), v)
}

/// The support vertex along a direction, with proof.
pub(crate) struct Extreme {
    /// A vertex that no vertex exceeds by more than rounding.
    pub(crate) vertex: VertexId,
    /// The largest rounded `n . x` over a set of vertices that is proven to hold the exact support
    /// vertex.
    pub(crate) value: f64,
}

/// The heights of the vertices adjacent to a vertex, relative to the vertex, along a direction.
struct Surroundings {
    vertex: VertexId,
    /// The highest adjacent vertex, if certainly higher.
    higher: Option<VertexId>,
    /// Number of adjacent vertices not certainly lower; `tie` is the last of them.
    ties: u32,
    tie: VertexId,
}

impl ConvexPolyhedron {
    /// Returns the support vertex along `n` (stored frame) up to rounding, climbing from `hint`.
    #[inline]
    pub(crate) fn support_climb(&self, n: &Vector3<f64>, hint: VertexId) -> VertexId {
        support_climb(&self.topology, &self.points, &self.fans, PackedVec3::new(n), hint)
    }

    /// Returns whether a climb along `n` would end at `v` at once, as far as a cheap test can
    /// decide: up to eight edges in parallel, without a branch to mispredict.
    #[inline(always)]
    pub(crate) fn is_local_maximum(&self, n: &Vector3<f64>, v: VertexId) -> bool {
        let p = self.points[v.index()];
        let rises = |w: VertexId| n.dot(&(self.points[w.index()] - p)) > 0.0;
        let adjacent = self.topology.up_to_eight(v);
        adjacent.is_some_and(|adjacent| !adjacent.each(rises).into_iter().fold(false, |any, one| any | one))
    }

    /// Returns the support vertex along `n` up to rounding, without a hint.
    #[inline]
    pub(crate) fn support_cold(&self, n: &Vector3<f64>) -> VertexId {
        if self.points.len() <= SCAN {
            self.highest_of_few(n).vertex
        } else {
            self.support_climb(n, self.lookup.cell(n))
        }
    }

    /// Returns the support vertex along `n`, proven by a scan.
    #[inline]
    fn highest_of_few(&self, n: &Vector3<f64>) -> Extreme {
        let mut top = Extreme {
            vertex: VertexId(0),
            value: f64::NEG_INFINITY,
        };
        for (vertex, p) in self.vertices().zip(&self.points) {
            let value = n.dot(p);
            if value > top.value {
                top = Extreme { vertex, value };
            }
        }
        top
    }

    /// Returns a start for a climb along `n`: the higher of `hint` and the vertex of the cube map.
    #[inline]
    pub(crate) fn start_vertex(&self, n: &Vector3<f64>, hint: VertexId) -> VertexId {
        let cell = self.lookup.cell(n);
        if n.dot(&self.points[hint.index()]) >= n.dot(&self.points[cell.index()]) {
            hint
        } else {
            cell
        }
    }

    /// Returns the proven support vertex along `n`, for solvers whose directions jump: a body of up
    /// to [`SCANNED`] vertices is scanned, a larger one climbed from the better of `hint` and the
    /// cube map.
    pub(crate) fn support_certified_anywhere(&self, n: &Vector3<f64>, hint: VertexId) -> Extreme {
        if self.points.len() <= SCANNED {
            self.highest_of_few(n)
        } else {
            self.support_certified(n, self.start_vertex(n, hint))
        }
    }

    /// Returns the proven support vertex along `n`: if other vertices may tie with the end of the
    /// climb, exact signs decide.
    pub(crate) fn support_certified(&self, n: &Vector3<f64>, hint: VertexId) -> Extreme {
        let top = self.climb_with_ties(n, hint);
        let (v, w) = (top.vertex, top.tie);
        let (at_v, at_w) = (n.dot(&self.points[v.index()]), n.dot(&self.points[w.index()]));
        // All vertices adjacent to the one or two tied vertices are certainly lower, so no path
        // that never falls reaches another vertex.
        match top.ties {
            0 => Extreme { vertex: v, value: at_v },
            1 if self.surroundings(n, w, v).ties == 0 => {
                let first = at_v > at_w || (at_v == at_w && v < w);
                let (vertex, value) = if first { (v, at_v) } else { (w, at_w) };
                Extreme { vertex, value }
            }
            _ => self.extreme_of_many(n, v),
        }
    }

    #[inline(never)]
    fn extreme_of_many(&self, n: &Vector3<f64>, start: VertexId) -> Extreme {
        let vertex = self.support_exact(&Direction::new(&self.points, n, &Vector3::zeros()), start);
        Extreme {
            vertex,
            value: n.dot(&self.points[vertex.index()]),
        }
    }

    /// Climbs along `n` as [`support_climb`] does, and counts ties on the way.
    #[inline]
    fn climb_with_ties(&self, n: &Vector3<f64>, start: VertexId) -> Surroundings {
        let mut v = start;
        let mut steps = 0;
        loop {
            let ring = self.surroundings(n, v, v);
            let Some(w) = ring.higher else { return ring };
            steps += 1;
            v = if steps % LEAP == 0 {
                jump(&self.topology, &self.points, &self.fans, n, w)
            } else {
                w
            };
        }
    }

    /// Compares `v` with its adjacent vertices, `except` one.
    #[inline]
    fn surroundings(&self, n: &Vector3<f64>, v: VertexId, except: VertexId) -> Surroundings {
        let p = self.points[v.index()];
        let mut ring = Surroundings {
            vertex: v,
            higher: None,
            ties: 0,
            tie: v,
        };
        let mut rise = 0.0;
        if let Some(m) = self.fans.axis(&self.topology, v) {
            let w = self
                .topology
                .half_edge(steepest(&self.topology, &self.points, v, m, n))
                .to;
            let rises = edge_sign(n, &(self.points[w.index()] - p)) > 0;
            // Ties of a large fan are not counted: two stand for any number.
            return Surroundings {
                higher: rises.then_some(w),
                ties: 2,
                ..ring
            };
        }
        self.topology.each_leaving(v, |_, w| {
            let e = self.points[w.index()] - p;
            let (x, y, z) = (n.x * e.x, n.y * e.y, n.z * e.z);
            let (value, bound) = (x + y + z, EDGE_SIGN * (x.abs() + y.abs() + z.abs()));
            if value >= -bound && w != except {
                (ring.ties, ring.tie) = (ring.ties + 1, w);
                if value > rise {
                    rise = value;
                    ring.higher = (value > bound).then_some(w);
                }
            }
        });
        ring
    }
}

/// The support vertex for each of a grid of directions on the faces of a cube.
///
/// Directions are scaled by the body's extents before the look-up: the normals of a flat body crowd
/// round its axis, and so do the cells.
#[derive(Clone, Debug)]
pub(crate) struct CubeMap {
    /// Half extents of the body, none below [`FLATTEST`] times the greatest.
    stretch: Vector3<f64>,
    /// Cells along an edge of the cube.
    side: u32,
    /// One vertex for each cell, face by face, row by row.
    cells: Vec<VertexId>,
}

impl CubeMap {
    /// Finds the support vertex of the centre of every cell, climbing from the vertex of the
    /// previous cell.
    pub(crate) fn new(topology: &Topology, points: &[Vector3<f64>], fans: &Fans) -> Self {
        // Measured: with 4, 8 and 16 cells a climb visits 2-6 vertices up to 128, 1024 and 8192
        // vertices.
        let side: u32 = match points.len() {
            0..=12 => 2,
            13..=128 => 4,
            129..=1024 => 8,
            _ => 16,
        };
        let stretch = stretch(points);
        let mut cells = vec![VertexId(0); (6 * side * side) as usize];
        let mut hint = VertexId(0);
        for face in 0..6 {
            for row in 0..side {
                for k in 0..side {
                    // Boustrophedon, so that each cell borders the previous cell.
                    let column = if row % 2 == 0 { k } else { side - 1 - k };
                    let middle = |i: u32| (2 * i + 1) as f64 / side as f64 - 1.0;
                    let mut n = Vector3::repeat(if face % 2 == 0 { 1.0 } else { -1.0 });
                    let axis = face as usize / 2;
                    n[(axis + 1) % 3] = middle(row);
                    n[(axis + 2) % 3] = middle(column);
                    hint = support_climb(
                        topology,
                        points,
                        fans,
                        PackedVec3::new(&n.component_div(&stretch)),
                        hint,
                    );
                    cells[((face * side + row) * side + column) as usize] = hint;
                }
            }
        }
        Self { stretch, side, cells }
    }

    /// Returns the bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        4 * self.cells.capacity()
    }

    /// Returns the vertex stored for the cell that holds `n`; any vertex if `n` is zero.
    #[inline]
    pub(crate) fn cell(&self, n: &Vector3<f64>) -> VertexId {
        let n = n.component_mul(&self.stretch);
        let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
        let axis = if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) };
        let largest = n[axis].abs();
        let half = 0.5 * self.side as f64;
        // A zero or NaN direction gives NaN here, which the cast turns into cell 0.
        let index = |c: f64| ((c / largest * half + half) as u32).min(self.side - 1);
        let (row, column) = (index(n[(axis + 1) % 3]), index(n[(axis + 2) % 3]));
        let face = 2 * axis as u32 + u32::from(n[axis] < 0.0);
        self.cells[((face * self.side + row) * self.side + column) as usize]
    }
}

/// Returns the half extents of the bounding box, kept off zero.
fn stretch(points: &[Vector3<f64>]) -> Vector3<f64> {
    let (mut low, mut high) = (points[0], points[0]);
    for p in points {
        (low, high) = (low.smaller(*p), high.larger(*p));
    }
    let half = (high - low) * 0.5;
    let least = half.amax() * FLATTEST;
    if least > 0.0 {
        half.map(|h| h.larger(least))
    } else {
        Vector3::repeat(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use nalgebra::Point3;

    /// Bodies that are scanned and bodies that are climbed, from every hint: the highest vertex,
    /// and of exactly equal ones on a cube the first.
    #[test]
    fn supports_from_anywhere_are_the_highest() {
        let mut rng = Rng::new(3);
        for n in [4, 8, 33, SCANNED, SCANNED + 1, 200] {
            let cloud: Vec<Point3<f64>> = (0..n).map(|_| Point3::from(rng.unit())).collect();
            let body = ConvexPolyhedron::from_points(&cloud).expect("a solid");
            for hint in body.vertices().take(60) {
                let direction = Vector3::from(rng.unit());
                let highest = body.points.iter().map(|p| direction.dot(p)).fold(f64::MIN, f64::max);
                let top = body.support_certified_anywhere(&direction, hint);
                assert_eq!(top.value, highest, "{n} {hint:?}");
                assert_eq!(direction.dot(&body.points[top.vertex.index()]), highest);
            }
        }
        let cube = crate::body::polyhedron::solids::cuboid(Vector3::repeat(0.5)).expect("a cube");
        for axis in [Vector3::x(), -Vector3::x(), Vector3::y(), Vector3::z()] {
            let first = cube.vertices().find(|v| axis.dot(&cube.points[v.index()]) == 0.5);
            for hint in cube.vertices() {
                assert_eq!(Some(cube.support_certified_anywhere(&axis, hint).vertex), first);
            }
        }
    }
}
