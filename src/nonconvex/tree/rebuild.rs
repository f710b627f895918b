//! Decides when a tree whose points have moved needs a new upper part, and builds it over the lower
//! parts.
//!
//! A search near a point of the surface descends into all boxes that contain it. So the quality of
//! a tree is the number of its boxes that contain points of the surface, now compared with when the
//! tree was built. Areas of boxes are no measure. They also grow where a surface becomes rough,
//! which no other tree improves, and they do not grow where sheets slide into each other. The count
//! depends on the vertices alone, never on queries.
//!
//! Small parts of a surface remain small when it bends, but large parts come to overlap each other.
//! So only the upper part is rebuilt. A whole new tree is better at first, but it joins triangles
//! that are near each other by chance and separate again. If a sheet is crumpled further, such a
//! tree soon needs five times as many bounds.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::Vector3;

use super::split::Splitter;
use super::{Below, COUNT_SHIFT, LEAF_MARK, OrientedBox, Tree};
use crate::base::callbacks::Watch;
use crate::base::num::each::Each;

/// Distance from a box up to which a point still counts as contained, in units of the tree.
///
/// The tree has a size of one or two units. With 0.03 and 0.1, boxes of about this size hide the
/// excess.
const SURFACE_REACH: f32 = 1.0 / 128.0;

/// Number of items whose centroids are counted.
const SURFACE_SAMPLES: usize = 512;

impl Tree {
    /// Returns how many boxes contain the centroids of some of the items, summed over the items.
    pub(crate) fn held(&self, points: &[Vector3<f64>], items: &[[u32; 3]]) -> u64 {
        let (samples, scale) = (items.len().min(SURFACE_SAMPLES), 1.0 / self.unit());
        let (mut held, mut stack) = (0, vec![]);
        for sample in 0..samples {
            let item = (2 * sample + 1) * items.len() / (2 * samples);
            let [a, b, c] = items[item].each(|v| points[v as usize] - self.centre);
            let middle = ((a + b + c) * (scale / 3.0)).map(|x| x as f32);
            stack.push(0);
            while let Some(node) = stack.pop() {
                if self.holds(node, &middle) {
                    held += 1;
                    if let Below::Children(c) = self.below(node) {
                        stack.extend([c, c + 1]);
                    }
                }
            }
        }
        held
    }

    /// Returns whether a point is in a box or within [`SURFACE_REACH`] of it, up to rounding.
    fn holds(&self, node: u32, point: &Vector3<f32>) -> bool {
        let [[xx, xy, xz, yx], [yy, yz, zx, zy], [zz, cx, cy, cz], [a, b, c, _]] = self.boxes[node as usize].rows;
        let (x, y, z) = (point.x - cx, point.y - cy, point.z - cz);
        (xx * x + xy * y + xz * z).abs() <= a + SURFACE_REACH
            && (yx * x + yy * y + yz * z).abs() <= b + SURFACE_REACH
            && (zx * x + zy * y + zz * z).abs() <= c + SURFACE_REACH
    }
}

/// Largest number of items of a lower part; the upper part is above these nodes.
const LOWER_PART: usize = 64;

/// The tree from which a node is copied.
#[derive(Clone, Copy)]
enum NodeOrigin {
    /// The new upper part, with the index of the node there.
    Top(u32),
    /// The old tree, with the index of the node there.
    Old(u32),
}

impl Tree {
    /// Returns a tree with new nodes above the lower parts, the order of the items, and the new
    /// nodes.
    ///
    /// The new nodes have axes but no extents.
    pub(crate) fn with_new_top(&self, points: &[Vector3<f64>], items: &[[u32; 3]]) -> (Self, Vec<u32>, Vec<u32>) {
        let lower = self.lower_parts();
        let vertices = |&node: &u32| {
            let Range { start, end } = self.range(node);
            let mut all = items[start as usize..end as usize].as_flattened().to_vec();
            all.sort_unstable();
            all.dedup();
            all
        };
        let parts: Vec<Vec<u32>> = lower.iter().map(vertices).collect();
        let splitter = Splitter::new(self.centre, self.exponent, points, &parts, 1);
        let (top, order) = splitter.divided(&mut Watch::none());
        let mut tree = Self {
            centre: self.centre,
            exponent: self.exponent,
            ..Self::default()
        };
        let (mut of_items, mut fresh) = (Vec::with_capacity(items.len()), Vec::new());
        tree.push();
        let mut tasks = vec![(0, NodeOrigin::Top(0))];
        while let Some((node, origin)) = tasks.pop() {
            let origin = match origin {
                NodeOrigin::Top(t) => match top.below(t) {
                    Below::Leaf(k, _) => NodeOrigin::Old(lower[order[k as usize] as usize]),
                    Below::Children(_) => origin,
                },
                NodeOrigin::Old(_) => origin,
            };
            let (from, number) = match origin {
                NodeOrigin::Top(t) => (&top, t),
                NodeOrigin::Old(o) => (self, o),
            };
            if let NodeOrigin::Top(_) = origin {
                fresh.push(node);
            }
            tree.boxes[node as usize] = from.boxes[number as usize];
            tree.links[node as usize] = match from.below(number) {
                Below::Leaf(first, count) => {
                    let at = of_items.len() as u32;
                    of_items.extend(first..first + count);
                    LEAF_MARK | (count - 1) << COUNT_SHIFT | at
                }
                Below::Children(c) => {
                    let child = tree.push();
                    tree.push();
                    let of = |k: u32| match origin {
                        NodeOrigin::Top(_) => NodeOrigin::Top(k),
                        NodeOrigin::Old(_) => NodeOrigin::Old(k),
                    };
                    tasks.push((child + 1, of(c + 1)));
                    tasks.push((child, of(c)));
                    child
                }
            };
        }
        (tree, of_items, fresh)
    }

    /// Adds a node and returns its index.
    fn push(&mut self) -> u32 {
        self.boxes.push(OrientedBox::default());
        self.links.push(0);
        self.links.len() as u32 - 1
    }

    /// Returns the largest nodes of at most [`LOWER_PART`] items.
    fn lower_parts(&self) -> Vec<u32> {
        let (mut parts, mut stack) = (Vec::new(), vec![0]);
        while let Some(node) = stack.pop() {
            match self.below(node) {
                Below::Children(c) if self.range(node).len() > LOWER_PART => stack.extend([c + 1, c]),
                _ => parts.push(node),
            }
        }
        parts
    }

    /// Returns the highest index of a node below a node; these nodes are consecutive.
    pub(super) fn last_below(&self, node: u32) -> u32 {
        let (mut last, mut at) = (node, node);
        while let Below::Children(c) = self.below(at) {
            last = c + 1;
            // The nodes below the right child come last, unless it is a leaf.
            at = if self.is_leaf(c + 1) { c } else { c + 1 };
        }
        last
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use core::f64::consts::TAU;
    use nalgebra::Point3;
    use std::vec::Vec;

    use super::*;
    use crate::nonconvex::mesh::Mesh;

    /// Returns a strip of 80 by 20 squares of side 1 / 40.
    ///
    /// The origin is in the middle of a long side.
    fn strip() -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
        let at = |i: u32, j: u32| Point3::new(f64::from(i) / 40.0 - 1.0, f64::from(j) / 40.0, 0.0);
        let points = (0..=80).flat_map(|i| (0..=20).map(move |j| at(i, j))).collect();
        let square = |i: u32, j: u32| {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| (i + k) * 21 + j + l);
            [[a, b, c], [a, c, d]]
        };
        (
            points,
            (0..80).flat_map(|i| (0..20).flat_map(move |j| square(i, j))).collect(),
        )
    }

    /// Rolls up the part beyond x = 0 by some turns, to a spiral whose layers do not touch.
    fn rolled(p: &Point3<f64>, turns: f64) -> Point3<f64> {
        if p.x <= 0.0 || turns == 0.0 {
            return *p;
        }
        let angle = turns * TAU * p.x;
        let radius = (1.0 + 0.02 * angle) / (turns * TAU);
        let start = 1.0 / (turns * TAU);
        Point3::new(radius * angle.sin(), p.y, start - radius * angle.cos())
    }

    /// Checks that all boxes contain their vertices and that the leaves have every triangle once.
    fn check(mesh: &Mesh) {
        let tree = &mesh.tree;
        let mut next = 0;
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            let range = tree.range(node);
            let b = &tree.boxes[node as usize];
            for v in mesh.triangles[range.start as usize..range.end as usize].as_flattened() {
                let d = (mesh.points[*v as usize] - tree.centre) / tree.unit() - b.centre();
                assert!((0..3).all(|k| b.axis(k).dot(&d).abs() <= b.half()[k] + 1e-6), "{node}");
            }
            match tree.below(node) {
                Below::Children(c) => stack.extend([c + 1, c]),
                Below::Leaf(first, count) => {
                    assert_eq!(first, next);
                    next += count;
                }
            }
        }
        assert_eq!(next as usize, mesh.triangle_count());
    }

    #[test]
    fn a_strip_that_is_rolled_up_gets_another_upper_part() {
        let (points, triangles) = strip();
        let mut mesh = Mesh::new(&points, &triangles).unwrap();
        let mut other = mesh.clone();
        let mut anew = 0;
        for frame in 1..=120 {
            let turns = 4.0 * (f64::from(frame) * core::f64::consts::PI / 120.0).sin();
            let now: Vec<_> = points.iter().map(|p| rolled(p, turns)).collect();
            let before = mesh.source_triangles.clone();
            mesh.set_vertices(&now).unwrap();
            check(&mesh);
            anew += u32::from(before != mesh.source_triangles);
            assert_eq!(mesh.vertices(), now);
            // The same calls give the same bits, with a tracker's queries or without.
            other.set_vertices(&now).unwrap();
            assert!(other.tree == mesh.tree && other.fingerprint == mesh.fingerprint);
        }
        assert!((1..=8).contains(&anew), "{anew}");
    }

    #[test]
    fn a_mesh_that_moves_as_a_whole_or_waves_keeps_its_tree() {
        let (points, triangles) = strip();
        let mut mesh = Mesh::new(&points, &triangles).unwrap();
        let order = mesh.source_triangles.clone();
        for frame in 0..100 {
            let t = f64::from(frame) * 0.05;
            let moved = |p: &Point3<f64>| Point3::new(p.x + t, p.y, p.z + 0.2 * (5.0 * p.x + t).sin());
            mesh.set_vertices(&points.iter().map(moved).collect::<Vec<_>>())
                .unwrap();
        }
        assert_eq!(mesh.source_triangles, order);
        check(&mesh);
    }
}
