//! A tree of oriented boxes over triangles or convex pieces, and the heights of its nodes along a
//! direction.
//!
//! If the surface is oblique to the body's axes, a box along these axes is as thick as its part of
//! the surface is long. An oriented box is only as thick as the surface is curved. Near contact,
//! the number of pairs grows in proportion to size / gap with axis-aligned boxes, and with the
//! logarithm of size / gap with oriented boxes.
//!
//! - `morton` builds the tree of a cloud of points.
//! - `split` orders the items and creates the nodes.
//! - `fit` computes the first boxes.
//! - `refit` computes the boxes of points that have moved.
//! - `rebuild` measures whether a new tree is worth its cost, and creates a new upper part.

mod fit;
pub(crate) mod morton;
mod rebuild;
mod refit;
mod split;

use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::Vector3;

pub(super) use fit::up;
pub(super) use refit::{Paths, Refit};

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::Fingerprinter;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::UNIT_SINGLE;

/// A box in single precision.
///
/// Every point below the node is exactly `centre + sum of s_k axis_k` with `|s_k| <= half_k`, for
/// the numbers as stored. Coordinates are those of the tree ([`Tree::centre`], [`Tree::exponent`]).
///
/// The sixteen numbers fill a cache line, so that one transposition per row reads four boxes. They
/// are three axes, that of the longest side first, the centre, the half extents and the radius.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(align(64))]
pub(crate) struct OrientedBox {
    pub(crate) rows: [[f32; 4]; 4],
}

impl OrientedBox {
    /// Stores the axes.
    pub(crate) fn set_axes(&mut self, axes: &[Vector3<f64>; 3]) {
        for (k, x) in axes.iter().flat_map(|r| r.iter()).enumerate() {
            self.rows[k / 4][k % 4] = *x as f32;
        }
    }

    pub(crate) fn axis(&self, k: usize) -> Vector3<f64> {
        let at = |i: usize| f64::from(self.rows[i / 4][i % 4]);
        Vector3::new(at(3 * k), at(3 * k + 1), at(3 * k + 2))
    }

    pub(crate) fn centre(&self) -> Vector3<f64> {
        let [_, x, y, z] = self.rows[2].each(f64::from);
        Vector3::new(x, y, z)
    }

    pub(crate) fn half(&self) -> Vector3<f64> {
        let [x, y, z, _] = self.rows[3].each(f64::from);
        Vector3::new(x, y, z)
    }

    /// Returns a radius and a segment from `-u` to `u` around the centre.
    ///
    /// Every point below the node is within the radius of the segment. `u` is zero, and the radius
    /// that of the box, unless the radius of the box is more than four times the radius around the
    /// segment. So few boxes have a segment. Lengths are multiplied by `scale`, a power of two.
    #[inline(always)]
    pub(crate) fn rod(&self, scale: f32) -> (f32, [f32; 3]) {
        let [long, wide, deep, radius] = self.rows[3].each(|h| h * scale);
        let square = wide * wide + deep * deep;
        if 16.0 * square >= radius * radius {
            return (radius, [0.0; 3]);
        }
        // The factor covers axes that are orthonormal within 8 units, 6 of the length, and 3 of
        // rounding.
        let around = sqrt(f64::from(square)) as f32 * (1.0 + 16.0 * f32::EPSILON);
        let [x, y, z, _] = self.rows[0];
        (around, [x * long, y * long, z * long])
    }

    /// Returns the radius of the box around the tree's origin, up to rounding.
    #[inline(always)]
    pub(super) fn reach(&self) -> f32 {
        let [_, x, y, z] = self.rows[2];
        sqrt(f64::from(x * x + y * y + z * z)) as f32 + self.radius()
    }

    /// Returns an eighth of the surface area of the box.
    #[inline(always)]
    pub(crate) fn area(&self) -> f32 {
        let [x, y, z, _] = self.rows[3];
        x * (y + z) + y * z
    }

    /// Returns the largest distance of a point below the node from the centre of the box.
    #[inline(always)]
    pub(crate) fn radius(&self) -> f32 {
        self.rows[3][3]
    }
}

/// A box of a nearly flat node in double precision, because single precision is too coarse for it.
///
/// The heights of every point below the node along `axes` are from `low` to `high`, in stored
/// coordinates of the body. The third axis is the normal of the node's largest triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slab {
    pub(crate) axes: [Vector3<f64>; 3],
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
    /// Error of the sum of three heights, weighted by the components of a unit vector.
    pub(crate) doubt: f64,
}

/// The children of a node, or the items of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Below {
    /// The first of two children, whose indices are consecutive.
    Children(u32),
    /// First item and number of items.
    Leaf(u32, u32),
}

/// Largest number of items of a leaf, except of a cloud.
pub(crate) const LEAF: usize = 4;

/// Largest number of points of a leaf of a cloud.
///
/// A hull over 100,000 points takes 1.25 times as long with leaves of 8, which also need half as
/// much memory again.
pub(crate) const CLOUD_LEAF: usize = 16;

/// The mark of a leaf in [`Tree::links`], and the position of its count in the link.
const LEAF_MARK: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 27;

/// A tree of boxes; the root is node 0.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Tree {
    pub(crate) boxes: Vec<OrientedBox>,
    links: Vec<u32>,
    /// Slabs of nearly flat nodes: of the topmost ones, and of nodes below that are much thinner.
    slabs: Vec<Slab>,
    /// The slab of each node or of its nearest ancestor with a slab; empty without slabs.
    nearest: Vec<u32>,
    /// The tree's origin in stored coordinates of the body.
    pub(crate) centre: Vector3<f64>,
    /// The tree's lengths times `2^exponent` are stored lengths of the body.
    ///
    /// The radius of the tree is about one of its units.
    pub(crate) exponent: i32,
    /// Upper bound of the distance of all boxes from the tree's origin.
    pub(crate) reach: f32,
    /// Path lengths of the points below the nodes.
    pub(crate) paths: Paths,
}

impl Tree {
    /// Adds the children and items of every node to the fingerprint of a body.
    pub(crate) fn add_links(&self, to: &mut Fingerprinter) {
        to.word(self.links.len() as u64);
        to.indices(self.links.iter().copied());
    }

    /// Replaces the link of a node.
    #[cfg(test)]
    pub(crate) fn set_link(&mut self, node: usize, link: u32) {
        self.links[node] = link;
    }

    #[inline(always)]
    pub(crate) fn below(&self, node: u32) -> Below {
        let link = self.links[node as usize];
        if link & LEAF_MARK == 0 {
            Below::Children(link)
        } else {
            let first = link & ((1 << COUNT_SHIFT) - 1);
            Below::Leaf(first, (link >> COUNT_SHIFT & 15) + 1)
        }
    }

    /// Returns up to eight nodes below an inner node, which cover it, and their number.
    ///
    /// They are three levels down, or leaves. The first fills the other places.
    #[inline(always)]
    pub(crate) fn eight_below(&self, node: u32) -> ([u32; 8], usize) {
        let (mut nodes, mut count) = ([node; 8], 1);
        for _ in 0..3 {
            let above = count;
            for k in 0..above {
                if let Below::Children(c) = self.below(nodes[k]) {
                    nodes[k] = c;
                    nodes[count] = c + 1;
                    count += 1;
                }
            }
        }
        let first = nodes[0];
        nodes[count..].fill(first);
        (nodes, count)
    }

    #[inline(always)]
    pub(crate) fn is_leaf(&self, node: u32) -> bool {
        self.links[node as usize] & LEAF_MARK != 0
    }

    /// Returns whether all nodes have the same children and items as the nodes of another tree.
    pub(crate) fn is_laid_out_as(&self, other: &Self) -> bool {
        self.links == other.links
    }

    /// Returns the number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.links.len()
    }

    /// Returns whether the tree has a single item.
    #[inline(always)]
    pub(crate) fn is_alone(&self) -> bool {
        self.links[0] == LEAF_MARK
    }

    /// Returns the items below a node.
    pub(crate) fn range(&self, node: u32) -> Range<u32> {
        let (mut left, mut right) = (node, node);
        let first = loop {
            match self.below(left) {
                Below::Children(c) => left = c,
                Below::Leaf(first, _) => break first,
            }
        };
        loop {
            match self.below(right) {
                Below::Children(c) => right = c + 1,
                Below::Leaf(last, count) => break first..last + count,
            }
        }
    }

    /// Returns whether points of the body have ever moved in its frame.
    #[inline(always)]
    pub(crate) fn bends(&self) -> bool {
        self.paths.total > 0
    }

    /// Returns the slab of a node or of its nearest ancestor that has one.
    pub(crate) fn slab(&self, node: u32) -> Option<&Slab> {
        self.slabs.get(*self.nearest.get(node as usize)? as usize)
    }

    /// Returns one unit of the tree in stored units of the body.
    pub(crate) fn unit(&self) -> f64 {
        crate::body::polyhedron::power_of_two(self.exponent)
    }

    /// Calls `is_found` with each item near a point, until a call returns true.
    ///
    /// Items are near if their box is at most twice `reach` from the point. The point and `reach`
    /// are in stored coordinates of the body. Returns whether a call returned true.
    pub(crate) fn any_near(&self, point: &Vector3<f64>, reach: f64, mut is_found: impl FnMut(u32) -> bool) -> bool {
        let place = (point - self.centre) / self.unit();
        // Doubled for the rounding of everything below.
        let reach = 2.0 * reach / self.unit() + 16.0 * UNIT_SINGLE;
        let mut stack = alloc::vec![0];
        while let Some(node) = stack.pop() {
            let b = &self.boxes[node as usize];
            let (d, half) = (place - b.centre(), b.half());
            if (0..3).any(|k| b.axis(k).dot(&d).abs() > half[k] * (1.0 + 16.0 * UNIT_SINGLE) + reach) {
                continue;
            }
            match self.below(node) {
                Below::Children(c) => stack.extend([c, c + 1]),
                Below::Leaf(first, count) => {
                    if (first..first + count).any(&mut is_found) {
                        return true;
                    }
                }
            }
        }
        false
    }

    pub(crate) fn memory_usage(&self) -> usize {
        let slabs = size_of_val(&self.slabs[..]) + size_of_val(&self.nearest[..]);
        size_of_val(&self.boxes[..]) + size_of_val(&self.links[..]) + slabs
    }
}

/// Returns a vector divided by its length; `None` unless its squared length is from 0.5 to 2.
pub(super) fn near_unit(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let square = v.norm_squared();
    (square > 0.5 && square < 2.0).then(|| v / sqrt(square))
}

/// Returns an upper bound of the height along `n` of all points below a node.
///
/// The height is in stored units of the body.
pub(super) fn height(tree: &Tree, node: u32, n: &Vector3<f64>) -> f64 {
    let b = &tree.boxes[node as usize];
    let (unit, half) = (tree.unit(), b.half());
    let centre = tree.centre + b.centre() * unit;
    let of_box = |n: &Vector3<f64>| {
        let [x, y, z] = [0, 1, 2].each(|k| (b.axis(k).dot(n) * half[k]).abs());
        n.dot(&centre) + (x + y + z) * unit
    };
    let Some(slab) = tree.slab(node) else { return of_box(n) };
    let part = |k: usize, along: f64| along * if along > 0.0 { slab.high[k] } else { slab.low[k] };
    let [x, y, s] = slab.axes.each(|a| a.dot(n));
    // n = s m + rest with the normal m. The slab bounds the height along m, the box that along the
    // rest, which is nearly zero if n is nearly m. For the node that owns the slab, the slab alone
    // is better.
    let top = part(2, s);
    let rest = of_box(&(n - slab.axes[2] * s));
    top + rest.smaller(part(0, x) + part(1, y) + slab.doubt)
}
