//! Extreme vertices: hill climbing from a hint, and a cube map of directions for cold starts.
//!
//! Every non-optimal vertex of a convex body has a strictly better neighbour, so climbing ends at the extreme vertex.
//! Rounding breaks that argument only where the sign of `n . e` along an edge `e` is uncertain; such edges are flooded,
//! and the extreme vertex is proven to lie among the vertices reached (see [`Extreme`]). Signs are taken on edge
//! vectors, never as the difference of two large products: on a chamfer of 1e-9 no neighbour compares higher while a
//! far vertex is.
//!
//! Sources: Cameron 1997 (hill climbing with cached vertices); the cube map follows the directional lookup of Ehmann
//! and Lin 2000, section 4.2, with cells on a cube instead of a sphere, so that no trigonometry is needed.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::ConvexPolyhedron;
use super::fans::{Fans, highest_neighbour, steepest};
use super::topology::{MANY, Topology};
use crate::tolerance::EDGE_SIGN;

/// The cube map takes no body for flatter than this.
const FLATTEST: f64 = 1.0 / 1024.0;

/// Vertices a flood may hold before it turns into a scan of the whole body.
const FLOOD: usize = 48;

/// Steps of a climb between two looks for a large face to leap over.
const LEAP: u32 = 4;

/// The sign of `n . e` where rounding leaves no doubt, else 0. `e` is a rounded difference of two stored points.
#[inline]
pub(crate) fn edge_sign(n: &Vector3<f64>, e: &Vector3<f64>) -> i32 {
    let (x, y, z) = (n.x * e.x, n.y * e.y, n.z * e.z);
    let (value, bound) = (x + y + z, EDGE_SIGN * (x.abs() + y.abs() + z.abs()));
    i32::from(value > bound) - i32::from(value < -bound)
}

/// Climbs from `start` to a vertex with no neighbour certainly higher along `n`.
#[inline]
pub(crate) fn climb(topology: &Topology, points: &[Vector3<f64>], fans: &Fans, n: &Vector3<f64>, start: u32) -> u32 {
    let mut v = start;
    let mut steps = 0;
    loop {
        let p = points[v as usize];
        let (mut best, mut rise) = (v, 0.0);
        if let Some(m) = fans.axis(topology, v) {
            best = topology.half_edge(steepest(topology, points, v, m, n)).to;
        } else {
            topology.each_leaving(v, |_, to| {
                let c = n.dot(&(points[to as usize] - p));
                if c > rise {
                    (best, rise) = (to, c);
                }
            });
        }
        // Only a certain rise is a move: that is what ends the loop among tied vertices.
        if best == v || edge_sign(n, &(points[best as usize] - p)) <= 0 {
            return v;
        }
        steps += 1;
        v = if steps % LEAP == 0 {
            leap(topology, points, fans, n, best)
        } else {
            best
        };
    }
}

/// From a vertex of a large face, or beside one of a large fan, to the highest one of that face or beside that one; the vertex
/// itself where none is certainly higher.
fn leap(topology: &Topology, points: &[Vector3<f64>], fans: &Fans, n: &Vector3<f64>, v: u32) -> u32 {
    if !topology.has_large_faces() && fans.is_empty() || topology.fan(v).len() > MANY {
        return v;
    }
    let mut best = v;
    let mut take = |w: u32| {
        if edge_sign(n, &(points[w as usize] - points[best as usize])) > 0 {
            best = w;
        }
    };
    for h in topology.fan(v) {
        let e = topology.half_edge(h);
        if let Some(ring) = topology.ring(e.face) {
            take(highest_of(topology, points, n, ring));
        }
        if fans.axis(topology, e.to).is_some() {
            take(highest_neighbour(topology, points, e.to, n));
        }
    }
    best
}

/// The highest vertex of a convex rim, by bisection: heights round it rise once and fall once. Where rounding hides the order, another one
/// may come out.
pub(super) fn highest_of(topology: &Topology, points: &[Vector3<f64>], n: &Vector3<f64>, ring: &[u32]) -> u32 {
    let vertex = |k: usize| topology.from(ring[k % ring.len()]);
    let height = |k: usize| n.dot(&points[vertex(k) as usize]);
    let rises = |k: usize| n.dot(&(points[vertex(k + 1) as usize] - points[vertex(k) as usize])) > 0.0;
    let (mut low, mut high) = (0, ring.len());
    while high - low > 1 {
        let middle = (low + high) / 2;
        let is_before = if rises(low) {
            !rises(middle) || height(middle) < height(low)
        } else {
            !rises(middle) && height(middle) > height(low)
        };
        if is_before {
            high = middle;
        } else {
            low = middle;
        }
    }
    vertex(if height(high) > height(low) { high } else { low })
}

/// The extreme vertex along a direction, with proof.
pub(crate) struct Extreme {
    /// A vertex no other vertex exceeds by more than rounding.
    pub(crate) vertex: u32,
    /// The largest rounded `n . x` over a set of vertices that is proven to hold the extreme one; or, at a large face or fan, what
    /// three faces prove of all.
    pub(crate) value: f64,
}

/// What is seen from a vertex along a direction.
struct Ring {
    vertex: u32,
    /// The highest neighbour, if it is certainly higher.
    higher: Option<u32>,
    /// Neighbours that are not certainly lower, and the last of them.
    ties: u32,
    tie: u32,
}

impl ConvexPolyhedron {
    /// The highest vertex along `n` (stored frame), starting from `hint`.
    #[inline]
    pub(crate) fn climb(&self, n: &Vector3<f64>, hint: u32) -> u32 {
        climb(&self.topology, &self.points, &self.fans, n, hint)
    }

    /// Whether a climb along `n` would end at `v` at once, as far as that is cheap to tell: up to eight edges are looked at
    /// side by side, without a branch to mispredict.
    #[inline(always)]
    pub(crate) fn is_summit(&self, n: &Vector3<f64>, v: u32) -> bool {
        let p = self.points[v as usize];
        let rises = |w: u32| n.dot(&(self.points[w as usize] - p)) > 0.0;
        let beside = self.topology.up_to_eight(v);
        beside.is_some_and(|beside| !beside.map(rises).into_iter().fold(false, |any, one| any | one))
    }

    /// The highest vertex along `n` without a hint.
    #[inline]
    pub(crate) fn climb_cold(&self, n: &Vector3<f64>) -> u32 {
        self.climb(n, self.lookup.cell(n))
    }

    /// The higher along `n` of `hint` and the vertex of the cube map: a start for a climb.
    #[inline]
    pub(crate) fn higher(&self, n: &Vector3<f64>, hint: u32) -> u32 {
        let cell = self.lookup.cell(n);
        if n.dot(&self.points[hint as usize]) >= n.dot(&self.points[cell as usize]) {
            hint
        } else {
            cell
        }
    }

    /// The extreme vertex along `n`, proven: every vertex that may tie with the one climbed to is looked at.
    pub(crate) fn extreme(&self, n: &Vector3<f64>, hint: u32) -> Extreme {
        if self.fans.axis(&self.topology, hint).is_some()
            && let Some(proven) = self.extreme_by_faces(n, hint)
        {
            return proven;
        }
        let summit = self.summit(n, hint);
        let (v, w) = (summit.vertex, summit.tie);
        let (at_v, at_w) = (n.dot(&self.points[v as usize]), n.dot(&self.points[w as usize]));
        // All around one or two vertices are certainly lower: no other is in reach of a path that does not fall.
        match summit.ties {
            0 => Extreme { vertex: v, value: at_v },
            1 if self.ring(n, w, v).ties == 0 => {
                let first = at_v > at_w || (at_v == at_w && v < w);
                let (vertex, value) = if first { (v, at_v) } else { (w, at_w) };
                Extreme { vertex, value }
            }
            _ => self.extreme_of_many(n, v, w),
        }
    }

    #[inline(never)]
    fn extreme_of_many(&self, n: &Vector3<f64>, top: u32, tie: u32) -> Extreme {
        if self.topology.has_large_faces() || !self.fans.is_empty() {
            let proven = [top, tie].into_iter().find_map(|v| self.extreme_by_faces(n, v));
            if let Some(proven) = proven {
                return proven;
            }
        }
        let mut best = Extreme {
            vertex: 0,
            value: f64::NEG_INFINITY,
        };
        self.extremes(n, top, 0.0, |v, value| {
            if value > best.value || (value == best.value && v < best.vertex) {
                best = Extreme { vertex: v, value };
            }
        });
        best
    }

    /// Climbs along `n` as [`climb`] does, looking out for ties on the way.
    #[inline]
    fn summit(&self, n: &Vector3<f64>, start: u32) -> Ring {
        let mut v = start;
        let mut steps = 0;
        loop {
            let ring = self.ring(n, v, v);
            let Some(w) = ring.higher else { return ring };
            steps += 1;
            v = if steps % LEAP == 0 {
                leap(&self.topology, &self.points, &self.fans, n, w)
            } else {
                w
            };
        }
    }

    /// Looks round at the neighbours of `v`, `except` one.
    #[inline]
    fn ring(&self, n: &Vector3<f64>, v: u32, except: u32) -> Ring {
        let p = self.points[v as usize];
        let mut ring = Ring {
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
            let rises = edge_sign(n, &(self.points[w as usize] - p)) > 0;
            // Ties of a large fan are not counted: two stand for any number.
            return Ring {
                higher: rises.then_some(w),
                ties: 2,
                ..ring
            };
        }
        self.topology.each_leaving(v, |_, w| {
            let e = self.points[w as usize] - p;
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

    /// Calls `visit(vertex, n . vertex)` for a set of vertices that holds every one whose true height along `n` is
    /// within `slack` of the greatest.
    ///
    /// Proof for `slack = 0`: the set is closed under "neighbour not certainly lower", so from any member the strictly
    /// rising path to the extreme vertex stays inside. For a positive slack the same holds with every vertex of a
    /// superlevel set, which is connected in the graph of a convex body.
    pub(crate) fn extremes(&self, n: &Vector3<f64>, hint: u32, slack: f64, mut visit: impl FnMut(u32, f64)) {
        let top = self.climb(n, hint);
        let floor = n.dot(&self.points[top as usize]) - slack;
        let mut seen = [0u32; FLOOD];
        seen[0] = top;
        let (mut done, mut count) = (0, 1);
        while done < count {
            let v = seen[done];
            done += 1;
            let p = self.points[v as usize];
            for w in self.topology.neighbours(v) {
                let q = self.points[w as usize];
                let near = edge_sign(n, &(q - p)) >= 0 || (slack > 0.0 && n.dot(&q) >= floor);
                if !near || seen[..count].contains(&w) {
                    continue;
                }
                if count == FLOOD {
                    // A plateau larger than the list: every vertex is looked at.
                    for (v, p) in self.points.iter().enumerate() {
                        visit(v as u32, n.dot(p));
                    }
                    return;
                }
                seen[count] = w;
                count += 1;
            }
        }
        for &v in &seen[..count] {
            visit(v, n.dot(&self.points[v as usize]));
        }
    }
}

/// The extreme vertex of a grid of directions on the faces of a cube.
///
/// Directions are stretched by the body's extents before they are looked up: the normals of a flat body crowd round its
/// axis, and so do the cells.
#[derive(Clone, Debug)]
pub(crate) struct CubeMap {
    /// Half extents of the body, none less than a thousandth of the greatest.
    stretch: Vector3<f64>,
    /// Cells along an edge of the cube.
    side: u32,
    /// Face by face, row by row.
    cells: Vec<u32>,
}

impl CubeMap {
    /// Looks up the middle of every cell, climbing from the vertex of the cell before.
    pub(crate) fn new(topology: &Topology, points: &[Vector3<f64>], fans: &Fans) -> Self {
        // Measured: with 4, 8 and 16 cells a climb visits 2-6 vertices up to 128, 1024 and 8192 vertices.
        let side: u32 = match points.len() {
            0..=12 => 2,
            13..=128 => 4,
            129..=1024 => 8,
            _ => 16,
        };
        let stretch = stretch(points);
        let mut cells = vec![0; (6 * side * side) as usize];
        let mut hint = 0;
        for face in 0..6 {
            for row in 0..side {
                for k in 0..side {
                    // Boustrophedon, so that each cell borders the one before.
                    let column = if row % 2 == 0 { k } else { side - 1 - k };
                    let middle = |i: u32| (2 * i + 1) as f64 / side as f64 - 1.0;
                    let mut n = Vector3::repeat(if face % 2 == 0 { 1.0 } else { -1.0 });
                    let axis = face as usize / 2;
                    n[(axis + 1) % 3] = middle(row);
                    n[(axis + 2) % 3] = middle(column);
                    hint = climb(topology, points, fans, &n.component_div(&stretch), hint);
                    cells[((face * side + row) * side + column) as usize] = hint;
                }
            }
        }
        Self { stretch, side, cells }
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        4 * self.cells.capacity()
    }

    /// The vertex stored for the cell that holds `n`; any vertex where `n` is zero.
    #[inline]
    pub(crate) fn cell(&self, n: &Vector3<f64>) -> u32 {
        let n = n.component_mul(&self.stretch);
        let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
        let axis = if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) };
        let largest = n[axis].abs();
        let half = 0.5 * self.side as f64;
        // A zero or NaN direction gives NaN here, and the cast sends it to cell 0.
        let index = |c: f64| ((c / largest * half + half) as u32).min(self.side - 1);
        let (row, column) = (index(n[(axis + 1) % 3]), index(n[(axis + 2) % 3]));
        let face = 2 * axis as u32 + u32::from(n[axis] < 0.0);
        self.cells[((face * self.side + row) * self.side + column) as usize]
    }
}

/// Half extents of the bounding box, kept off zero.
fn stretch(points: &[Vector3<f64>]) -> Vector3<f64> {
    let (mut low, mut high) = (points[0], points[0]);
    for p in points {
        (low, high) = (low.inf(p), high.sup(p));
    }
    let half = (high - low) * 0.5;
    let least = half.amax() * FLATTEST;
    if least > 0.0 {
        half.map(|h| h.max(least))
    } else {
        Vector3::repeat(1.0)
    }
}
