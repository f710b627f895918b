//! A tree of oriented boxes over triangles or convex pieces, and the heights of its nodes along a
//! direction.
//!
//! Oriented boxes, because a box in the body's axes is as thick as its piece of surface is long if
//! the surface is oblique, an oriented one only as thick as the surface is curved: near contact the
//! first cost pairs in proportion to size over gap, the second its logarithm.
//!
//! `split` puts the items in order, `fit` takes the first boxes, `refit` those of points that have
//! moved; `rebuild` tells when a new tree is worth it and makes the upper part of one.

mod fit;
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

/// A box in single precision: every point below the node is `centre + sum of s_k axis_k` with
/// `|s_k| <= half_k`, exactly, for the numbers as stored. Coordinates are those of the tree
/// ([`Tree::centre`], [`Tree::exponent`]).
///
/// Sixteen numbers, a line of the cache, so that four boxes are read by one transposition a row:
/// three axes, the longest side's first, the centre, the half extents, the radius.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(align(64))]
pub(crate) struct OrientedBox {
    pub(crate) rows: [[f32; 4]; 4],
}

impl OrientedBox {
    /// Turns the box to axes.
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

    /// Returns a segment `-u` to `u` about the centre, and how far from it points below the node
    /// are at most; no segment if the ball about the centre is not four times as large, so that
    /// few have one. Lengths are times `scale`, a power of two.
    #[inline(always)]
    pub(crate) fn rod(&self, scale: f32) -> (f32, [f32; 3]) {
        let [long, wide, deep, radius] = self.rows[3].each(|h| h * scale);
        let square = wide * wide + deep * deep;
        if 16.0 * square >= radius * radius {
            return (radius, [0.0; 3]);
        }
        // The factor: axes that are orthonormal within 8 units, 6 of the length, and rounding, 3.
        let around = sqrt(f64::from(square)) as f32 * (1.0 + 16.0 * f32::EPSILON);
        let [x, y, z, _] = self.rows[0];
        (around, [x * long, y * long, z * long])
    }

    /// Returns how far the box reaches from the tree's origin, up to rounding.
    #[inline(always)]
    pub(super) fn reach(&self) -> f32 {
        let [_, x, y, z] = self.rows[2];
        sqrt(f64::from(x * x + y * y + z * z)) as f32 + self.radius()
    }

    /// Returns an eighth of the surface of the box.
    #[inline(always)]
    pub(crate) fn area(&self) -> f32 {
        let [x, y, z, _] = self.rows[3];
        x * (y + z) + y * z
    }

    /// No point below the node is farther than this from the centre.
    #[inline(always)]
    pub(crate) fn radius(&self) -> f32 {
        self.rows[3][3]
    }
}

/// A box of a nearly flat node in double precision, which single precision cannot hold: the
/// `heights` of every point below the node along the `axes` lie from `low` to `high`, in stored
/// coordinates of the body. The third axis is the normal of the node's largest triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slab {
    pub(crate) axes: [Vector3<f64>; 3],
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
    /// By how much the sum of three heights' parts of a unit vector may be off.
    pub(crate) doubt: f64,
}

/// The children of a node, or the triangles of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Below {
    /// The first of two children; the second follows.
    Children(u32),
    /// First and count of triangles.
    Leaf(u32, u32),
}

/// Most triangles of a leaf.
pub(crate) const LEAF: usize = 4;

/// The mark of a leaf in [`Tree::links`], and where its count stands.
const LEAF_MARK: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 28;

/// A tree of boxes; the root is node 0.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Tree {
    pub(crate) boxes: Vec<OrientedBox>,
    links: Vec<u32>,
    /// Slabs of nearly flat nodes: of the highest ones, and of nodes that are much thinner still.
    slabs: Vec<Slab>,
    /// The slab of each node or of its nearest ancestor that has one; empty if there is no slab.
    nearest: Vec<u32>,
    /// Where the tree's origin is in stored coordinates of the body.
    pub(crate) centre: Vector3<f64>,
    /// The tree's lengths times `2^exponent` are stored lengths of the body: the tree's radius is
    /// about one.
    pub(crate) exponent: i32,
    /// No corner of a box is farther than this from the tree's origin.
    pub(crate) reach: f32,
    /// How far the points below the nodes have moved.
    pub(crate) paths: Paths,
}

impl Tree {
    /// Adds the children and items of every node to the fingerprint of a body.
    pub(crate) fn add_links(&self, to: &mut Fingerprinter) {
        to.word(self.links.len() as u64);
        to.indices(self.links.iter().copied());
    }

    /// Replaces what is below a node.
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
            Below::Leaf(first, (link >> COUNT_SHIFT & 7) + 1)
        }
    }

    #[inline(always)]
    pub(crate) fn is_leaf(&self, node: u32) -> bool {
        self.links[node as usize] & LEAF_MARK != 0
    }

    /// Returns whether nodes have the same children and items as those of another tree.
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

    /// One length of the tree in stored lengths of the body.
    pub(crate) fn unit(&self) -> f64 {
        crate::body::polyhedron::power_of_two(self.exponent)
    }

    /// Asks about the items whose boxes are at most twice `reach` from a point in stored
    /// coordinates of the body, until an answer is true.
    pub(crate) fn any_near(&self, point: &Vector3<f64>, reach: f64, mut is_found: impl FnMut(u32) -> bool) -> bool {
        let place = (point - self.centre) / self.unit();
        // Twice for the rounding of all that follows.
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

/// Returns a vector divided by its length if the length is near one.
pub(super) fn near_unit(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let square = v.norm_squared();
    (square > 0.5 && square < 2.0).then(|| v / sqrt(square))
}

/// Returns an upper bound of the height along `n` of all points below a node, in stored units of
/// the body.
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
    // n = s m + rest with the normal m: the slab bounds what m contributes, the box the rest, which
    // is next to nothing if n is m. The slab alone is better for its own node.
    let top = part(2, s);
    let rest = of_box(&(n - slab.axes[2] * s));
    top + rest.smaller(part(0, x) + part(1, y) + slab.doubt)
}
