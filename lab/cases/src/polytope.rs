//! A convex polytope over the integers that grows point by point.
//!
//! A new point replaces the facets that see it. Coplanar facets do not see it, so they stay
//! triangles, and no facet is degenerate.

use crate::rational::{IntVec, cross, dot, sub};
use dashu_int::IBig;
use std::collections::HashMap;

/// A triangle of the polytope.
pub(crate) struct Facet {
    /// Its vertices, counter-clockwise from outside.
    pub(crate) vertices: [usize; 3],
    /// Outward normal, of any length.
    pub(crate) normal: IntVec,
    /// `normal . p` for its points p.
    pub(crate) offset: IBig,
    /// The facet behind the edge from vertex k to vertex k + 1.
    neighbours: [usize; 3],
    /// Whether it is a facet of the polytope, or was replaced.
    pub(crate) is_alive: bool,
}

/// The polytope.
pub(crate) struct Polytope {
    pub(crate) points: Vec<IntVec>,
    pub(crate) facets: Vec<Facet>,
}

impl Polytope {
    /// Returns the tetrahedron of four points that are not coplanar.
    pub(crate) fn new(points: [IntVec; 4]) -> Self {
        let mut p = Self {
            points: points.into(),
            facets: Vec::new(),
        };
        let [a, b, c, d] = [0, 1, 2, 3].map(|i: usize| &p.points[i]);
        let is_above = dot(&cross(&sub(b, a), &sub(c, a)), &sub(d, a)) > IBig::ZERO;
        let (b, c) = if is_above { (2, 1) } else { (1, 2) };
        for (vertices, neighbours) in [
            ([0, b, c], [1, 2, 3]),
            ([0, 3, b], [3, 2, 0]),
            ([b, 3, c], [1, 3, 0]),
            ([c, 3, 0], [2, 1, 0]),
        ] {
            let facet = p.facet(vertices);
            p.facets.push(Facet { neighbours, ..facet });
        }
        p
    }

    fn facet(&self, vertices: [usize; 3]) -> Facet {
        let [a, b, c] = vertices.map(|i| &self.points[i]);
        let normal = cross(&sub(b, a), &sub(c, a));
        Facet {
            offset: dot(&normal, a),
            vertices,
            normal,
            neighbours: [0; 3],
            is_alive: true,
        }
    }

    fn sees(&self, facet: usize, point: usize) -> bool {
        let f = &self.facets[facet];
        dot(&f.normal, &self.points[point]) > f.offset
    }

    /// Adds a point outside the facet `seen`. Returns the new facets.
    pub(crate) fn add(&mut self, point: IntVec, seen: usize) -> std::ops::Range<usize> {
        let tip = self.points.len();
        self.points.push(point);
        self.facets[seen].is_alive = false;
        let (mut stack, mut horizon) = (vec![seen], Vec::new());
        while let Some(f) = stack.pop() {
            for k in 0..3 {
                let behind = self.facets[f].neighbours[k];
                if !self.facets[behind].is_alive {
                    continue;
                }
                if self.sees(behind, tip) {
                    self.facets[behind].is_alive = false;
                    stack.push(behind);
                } else {
                    let v = self.facets[f].vertices;
                    horizon.push((v[k], v[(k + 1) % 3], behind));
                }
            }
        }
        let first = self.facets.len();
        // The horizon is one closed loop, so each of its vertices starts one edge and ends one.
        let starts: HashMap<usize, usize> = horizon.iter().zip(first..).map(|(h, f)| (h.0, f)).collect();
        let ends: HashMap<usize, usize> = horizon.iter().zip(first..).map(|(h, f)| (h.1, f)).collect();
        for (f, (from, to, behind)) in (first..).zip(horizon) {
            let facet = self.facet([from, to, tip]);
            let edge = self.facets[behind].vertices.iter().position(|&v| v == to);
            self.facets[behind].neighbours[edge.expect("the edge, backwards")] = f;
            let neighbours = [behind, starts[&to], ends[&from]];
            self.facets.push(Facet { neighbours, ..facet });
        }
        first..self.facets.len()
    }

    /// Returns the facets in the plane of `facet` that are connected with it.
    pub(crate) fn coplanar(&self, facet: usize) -> Vec<usize> {
        let mut found = vec![facet];
        let mut next = 0;
        while next < found.len() {
            let f = &self.facets[found[next]];
            next += 1;
            for g in f.neighbours {
                let is_level = |&v: &usize| dot(&f.normal, &self.points[v]) == f.offset;
                if !found.contains(&g) && self.facets[g].vertices.iter().all(is_level) {
                    found.push(g);
                }
            }
        }
        found
    }
}
