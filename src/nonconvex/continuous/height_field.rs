//! Regions of a mesh that are height fields over a frame, so that they cannot meet themselves.
//!
//! Along one direction, no point of a height field hides another. So no two triangles without a
//! common vertex meet. Volino and Magnenat-Thalmann 1994 skip regions whose normals lie in a cone
//! and whose boundary does not cross itself. This module proves both over the whole frame, for
//! triangles on straight paths, projected to a plane by a fixed linear map:
//!
//! 1. **Every triangle keeps its orientation.** The area of its projection is a quadratic in time,
//!    and all its Bernstein coefficients are positive.
//! 2. **The boundary is simple.** Edges to triangles outside the region form loops in which no
//!    vertex occurs twice. If two boundary edges share no vertex, a line separates them at both
//!    ends of the frame. If they share a vertex, they never fold back: their cross product or their
//!    scalar product keeps its sign.
//! 3. **At most one loop runs counter-clockwise.**
//!
//! Proof. Count the triangles over a point of the plane with their orientation. The count is the
//! sum of the winding numbers of the loops around the point, so by 3 it is at most one. By 1 the
//! count is the number of triangles. Suppose that two triangles share no vertex and meet in the
//! projection at a point. Then their stars there are disjoint. A star in the interior of the region
//! covers all sides of the point, and a star at the boundary covers one side. Two stars at the
//! boundary would be at two points of it that coincide, which 2 excludes. So some point nearby
//! would be covered twice.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::frame::MovingMesh;
use super::paths::{VertexPath, size};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::sort::sort;
use crate::base::tolerance::{PATH_AREA, PATH_GAP, UNIT};
use crate::body::polyhedron::{exponent_of, power_of_two};

/// A point in the plane.
type PlanePlace = [f64; 2];

/// A point at both ends of the frame.
type PlaneWay = [PlanePlace; 2];

/// There is no triangle across the edge.
const NONE: u32 = u32::MAX;

/// The edge has more than two triangles, or two that do not have opposite directions along it.
const UNCLEAR: u32 = u32::MAX - 1;

/// A mesh whose regions are tested for being height fields.
pub(super) struct HeightFields<'a> {
    of: &'a MovingMesh<'a>,
    /// Vertices at both ends relative to the first vertex, all coordinates below a quarter.
    /// Projected by rows whose coordinates are at most one, they are below one and wrong by less
    /// than 4 UNIT.
    places: Vec<[Vector3<f64>; 2]>,
    /// The triangle across each edge, three for each triangle.
    across: Vec<u32>,
    /// The end of the boundary edge that starts at a vertex; `NONE` between two tests.
    next: Vec<u32>,
    rim: Vec<[u32; 2]>,
}

impl<'a> HeightFields<'a> {
    pub(super) fn new(of: &'a MovingMesh<'a>, vertices: &[VertexPath]) -> Self {
        let first = vertices.first().map_or_else(Vector3::zeros, |p| p.start.coords);
        let seen = |p: &VertexPath| [p.start, p.end].each(|x| x.coords - first);
        let mut places: Vec<_> = vertices.iter().map(seen).collect();
        let largest = places.iter().flatten().fold(0.0, |m: f64, v| m.larger(v.amax()));
        // If the factor is not a normal number, it must be applied as two factors.
        let e = if largest > 0.0 { exponent_of(largest) + 3 } else { 0 };
        let factors = [power_of_two(-e / 2), power_of_two(-e - (-e / 2))];
        for place in places.iter_mut().flatten() {
            *place = *place * factors[0] * factors[1];
        }
        Self {
            of,
            across: across(&of.both()[0].triangles, vertices.len()),
            next: vec![NONE; places.len()],
            places,
            rim: Vec::new(),
        }
    }

    /// Returns whether the triangles below one or two nodes together are proven a height field.
    pub(super) fn holds(&mut self, nodes: &[u32]) -> bool {
        let tree = &self.of.both()[0].tree;
        let of = |k: usize| nodes.get(k).map_or(0..0, |&node| tree.range(node));
        let [first, second] = [of(0), of(1)];
        let is_in = |t: u32| first.contains(&t) || second.contains(&t);
        if nodes.len() > 1 {
            let edges = &self.across[3 * first.start as usize..3 * first.end as usize];
            if !edges.iter().any(|t| second.contains(t)) {
                return false;
            }
        }
        let rows = self.rows(first.clone().chain(second.clone()));
        for t in first.clone().chain(second.clone()) {
            let corners = self.of.both()[0].triangles[t as usize];
            let [a, b, c] = corners.each(|v| self.way(v, &rows));
            if crosses([&a, &b], [&a, &c]).iter().any(|area| !(*area > PATH_AREA)) {
                return false;
            }
        }
        self.rim.clear();
        for t in first.clone().chain(second.clone()) {
            let corners = self.of.both()[0].triangles[t as usize];
            for k in 0..3 {
                match self.across[3 * t as usize + k] {
                    UNCLEAR => return false,
                    beyond if is_in(beyond) => {}
                    _ => self.rim.push([corners[k], corners[(k + 1) % 3]]),
                }
            }
        }
        self.is_rim_simple(&rows)
    }

    /// Returns two rows that project to a plane which most triangles face. Any rows are valid.
    fn rows(&self, triangles: impl Iterator<Item = u32>) -> [Vector3<f64>; 2] {
        let mut n = Vector3::zeros();
        for t in triangles {
            let middle = |v: u32| {
                let [begin, end] = &self.places[v as usize];
                begin + end
            };
            let [a, b, c] = self.of.both()[0].triangles[t as usize].each(middle);
            n += (b - a).cross(&(c - a));
        }
        let least = n.iamin();
        let axis = Vector3::ith(least, 1.0);
        let row = |v: Vector3<f64>| {
            v.try_normalize(0.0)
                .unwrap_or_else(Vector3::zeros)
                .map(|x| x.clamped(-1.0, 1.0))
        };
        let p = row(axis.cross(&row(n)));
        [p, row(row(n).cross(&p))]
    }

    fn way(&self, vertex: u32, [p, q]: &[Vector3<f64>; 2]) -> PlaneWay {
        self.places[vertex as usize].each(|x| [p.dot(&x), q.dot(&x)])
    }

    /// Returns whether the boundary loops are simple, and at most one runs counter-clockwise.
    fn is_rim_simple(&mut self, rows: &[Vector3<f64>; 2]) -> bool {
        let mut is_once = true;
        for &[from, to] in &self.rim {
            is_once &= self.next[from as usize] == NONE;
            self.next[from as usize] = to;
        }
        let is_simple =
            is_once && self.never_folds(rows) && self.are_rim_edges_apart(rows) && self.loops_left(rows) <= 1;
        for &[from, _] in &self.rim {
            self.next[from as usize] = NONE;
        }
        is_simple
    }

    /// Returns whether no boundary edge ever folds back onto the next one.
    fn never_folds(&self, rows: &[Vector3<f64>; 2]) -> bool {
        self.rim.iter().all(|&[from, to]| {
            let after = self.next[to as usize];
            if after == NONE {
                return false;
            }
            let [a, b, c] = [from, to, after].each(|v| self.way(v, rows));
            let turns = crosses([&a, &b], [&b, &c]);
            // The scalar product is the cross product with the other vector rotated by 90°.
            let turned = |way: &PlaneWay| way.each(|[x, y]| [-y, x]);
            turns.iter().all(|x| *x > PATH_AREA)
                || turns.iter().all(|x| *x < -PATH_AREA)
                || crosses([&a, &b], [&turned(&b), &turned(&c)])
                    .iter()
                    .all(|x| *x > PATH_AREA)
        })
    }

    /// Returns whether a line separates every two boundary edges that share no vertex.
    fn are_rim_edges_apart(&self, rows: &[Vector3<f64>; 2]) -> bool {
        let edge = |&[from, to]: &[u32; 2]| {
            let ways = [from, to].each(|v| self.way(v, rows));
            let range = |k: usize| {
                let all = ways.iter().flatten().map(|place| place[k]);
                all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                    [low.smaller(x), high.larger(x)]
                })
            };
            ([range(0), range(1)], [from, to], ways)
        };
        let mut edges: Vec<_> = self.rim.iter().map(edge).collect();
        sort(&mut edges, |a, b| a.0[0][0].total_cmp(&b.0[0][0]).then(a.1.cmp(&b.1)));
        edges.iter().enumerate().all(|(i, ([x, y], ends, p))| {
            let later = edges[i + 1..]
                .iter()
                .take_while(|other| other.0[0][0] <= x[1] + PATH_GAP);
            later
                .filter(|([_, v], others, _)| {
                    let shares = ends.iter().any(|vertex| others.contains(vertex));
                    !shares && v[0] <= y[1] + PATH_GAP && y[0] <= v[1] + PATH_GAP
                })
                .all(|(_, _, q)| are_parted(p, q))
        })
    }

    /// Returns the number of loops that may run counter-clockwise.
    fn loops_left(&mut self, rows: &[Vector3<f64>; 2]) -> usize {
        let mut count = 0;
        for k in 0..self.rim.len() {
            let mut at = self.rim[k][0];
            let ([[x, y], _], mut area, mut doubt) = (self.way(at, rows), 0.0, 0.0);
            while self.next[at as usize] != NONE {
                let to = self.next[at as usize];
                self.next[at as usize] = NONE;
                let ([a, _], [b, _]) = (self.way(at, rows), self.way(to, rows));
                area += (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x);
                doubt += PATH_AREA + 2.0 * UNIT * area.abs();
                at = to;
            }
            count += usize::from(doubt > 0.0 && !(area < -doubt));
        }
        count
    }
}

/// Returns the Bernstein coefficients of the cross product of `b - a` and `d - c` over the frame.
fn crosses([a, b]: [&PlaneWay; 2], [c, d]: [&PlaneWay; 2]) -> [f64; 3] {
    let way = |p: &PlaneWay, q: &PlaneWay| [0, 1].each(|k| [q[k][0] - p[k][0], q[k][1] - p[k][1]]);
    let cross = |u: PlanePlace, v: PlanePlace| u[0] * v[1] - u[1] * v[0];
    let ([u, v], [w, x]) = (way(a, b), way(c, d));
    [cross(u, w), 0.5 * (cross(u, x) + cross(v, w)), cross(v, x)]
}

/// Returns whether a line separates two edges at both ends, and so at all times in between.
fn are_parted(p: &[PlaneWay; 2], q: &[PlaneWay; 2]) -> bool {
    let middle = |edge: &[PlaneWay; 2]| [0, 1].each(|k| edge.iter().flatten().map(|place| place[k]).sum::<f64>());
    let ([a, b], [c, d]) = (middle(p), middle(q));
    let way = [c - a, d - b];
    let across = |edge: &[PlaneWay; 2]| {
        let of = |k: usize| edge[1][0][k] + edge[1][1][k] - edge[0][0][k] - edge[0][1][k];
        let n = [-of(1), of(0)];
        if n[0] * way[0] + n[1] * way[1] < 0.0 {
            [-n[0], -n[1]]
        } else {
            n
        }
    };
    [across(p), across(q), way].into_iter().any(|n| {
        let length = size(&Vector3::new(n[0], n[1], 0.0));
        let height = |place: &PlanePlace| n[0] * place[0] + n[1] * place[1];
        length > 0.0
            && [0, 1].into_iter().all(|end| {
                let high = p
                    .iter()
                    .fold(f64::NEG_INFINITY, |m: f64, way| m.larger(height(&way[end])));
                let low = q.iter().fold(f64::INFINITY, |m: f64, way| m.smaller(height(&way[end])));
                low - high > PATH_GAP * length
            })
    })
}

/// Returns the triangle across each edge.
///
/// This is the only triangle with the edge in the opposite direction, if no other triangle has the
/// edge in the same direction.
fn across(triangles: &[[u32; 3]], vertices: usize) -> Vec<u32> {
    // The edges that start at each vertex.
    let mut starts = vec![0u32; vertices + 1];
    triangles.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
    (0..vertices).for_each(|v| starts[v + 1] += starts[v]);
    let mut places = starts.clone();
    let mut ends = vec![(0, 0); 3 * triangles.len()];
    for (t, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            let place = &mut places[corners[k] as usize];
            ends[*place as usize] = (corners[(k + 1) % 3], t as u32);
            *place += 1;
        }
    }
    let from = |v: u32| &ends[starts[v as usize] as usize..starts[v as usize + 1] as usize];
    let mut across = Vec::with_capacity(3 * triangles.len());
    for corners in triangles {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let same = from(a).iter().filter(|e| e.0 == b).count();
            let mut back = from(b).iter().filter(|e| e.0 == a);
            across.push(match (back.next(), back.next()) {
                _ if same > 1 => UNCLEAR,
                (None, _) => NONE,
                (Some(&(_, t)), None) => t,
                _ => UNCLEAR,
            });
        }
    }
    across
}
