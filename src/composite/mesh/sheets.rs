//! Faces that cancel: triangles on each other in one plane that face opposite ways.
//!
//! ```text
//!     wall            ----->-----+----->-----      outer face
//!     window (cavity)   --<--    |                 its end, in the same plane
//! ```
//!
//! On both sides of such faces the winding number is the same. Where it is zero they are a sheet
//! without thickness, which a body may pass through and share no inner point with the solid.

use alloc::vec::Vec;
use nalgebra::Vector3;

use super::{Mesh, MeshReport};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::ONE_PLANE;
use crate::composite::meet::triangle::{self, Triangle};

impl Mesh {
    /// Returns the triangles, by the caller's index and in order, that may be part of a sheet: none
    /// of a mesh without inward parts and without edges of more than two triangles, where every
    /// face bounds the inside.
    pub(super) fn find_sheets(&self) -> Vec<u32> {
        let mut found = Vec::new();
        for t in self.suspects() {
            let (own, middle) = (self.corners(t), self.triangle_middle(t));
            let reach = own.iter().map(|p| (p - middle).norm_squared()).fold(0.0, f64::larger);
            self.tree.any_near(&middle, sqrt(reach), |u| {
                if u != t && self.cancel(&own, &self.corners(u)) {
                    found.extend([t, u].map(|k| self.source_triangles[k as usize]));
                }
                false
            });
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Returns the triangles of inward parts, and those at edges of more than two triangles.
    fn suspects(&self) -> Vec<u32> {
        let MeshReport {
            parts,
            non_manifold_edges,
            ..
        } = &self.report;
        let is_inward = |v: f64| v < 0.0;
        let has_both = parts.iter().any(|p| is_inward(p.volume)) && parts.iter().any(|p| p.volume > 0.0);
        if !self.is_solid() || !has_both && non_manifold_edges.is_empty() {
            return Vec::new();
        }
        // By the label of their part, and by their edges.
        let labels = if has_both { self.labels() } else { Vec::new() };
        let own = parts
            .iter()
            .zip(&self.part_vertices)
            .filter(|(p, _)| is_inward(p.volume));
        let mut inward: Vec<u32> = if has_both {
            own.map(|(_, four)| labels[four[0] as usize]).collect()
        } else {
            Vec::new()
        };
        inward.sort_unstable();
        let mut edges = non_manifold_edges.clone();
        edges.iter_mut().for_each(|e| e.sort_unstable());
        edges.sort_unstable();
        let is_suspect = |t: &u32| {
            let corners = self.triangles[*t as usize];
            let names = corners.map(|v| self.source_points[v as usize]);
            let edge = |i: usize| {
                let (v, w) = (names[i], names[(i + 1) % 3]);
                [v.min(w), v.max(w)]
            };
            let is_of_inward = has_both && inward.binary_search(&labels[corners[0] as usize]).is_ok();
            is_of_inward || !edges.is_empty() && (0..3).any(|i| edges.binary_search(&edge(i)).is_ok())
        };
        (0..self.triangles.len() as u32).filter(is_suspect).collect()
    }

    /// Returns whether a triangle, by its number in the tree, may be part of a sheet.
    pub(in crate::composite) fn may_be_sheet(&self, triangle: u32) -> bool {
        let name = &self.source_triangles[triangle as usize];
        self.sheets.binary_search(name).is_ok()
    }

    /// Returns whether two triangles cancel over an area, up to the rounding of coordinates.
    pub(super) fn cancel(&self, p: &Triangle, q: &Triangle) -> bool {
        let (m, n) = (triangle::normal(p), triangle::normal(q));
        if !(m.dot(&n) < 0.0) {
            return false;
        }
        // The plane of the larger one is the better known.
        let (large, normal, small) = if m.norm_squared() < n.norm_squared() {
            (q, n, p)
        } else {
            (p, m, q)
        };
        let (doubt, length) = (ONE_PLANE * self.radius, sqrt(normal.norm_squared()));
        let is_off = |x: &Vector3<f64>| !(normal.dot(&(x - large[0])).abs() <= doubt * length);
        if small.iter().any(is_off) {
            return false;
        }
        let is_beside = |x: &Triangle, y: &Triangle, out: f64| {
            (0..3).any(|i| {
                let side = (x[(i + 1) % 3] - x[i]).cross(&normal) * out;
                let length = sqrt(side.norm_squared());
                y.iter().all(|v| side.dot(&(v - x[i])) >= -doubt * length)
            })
        };
        !(is_beside(large, small, 1.0) || is_beside(small, large, -1.0))
    }
}
