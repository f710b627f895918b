//! Boxes of small nodes: all nodes below one of few items, the root of a group, have its axes.
//!
//! So the heights of a vertex are taken once for all of them, and the extents of a node are those
//! of its children, which do not grow as boxes about boxes of other axes do.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use wide::f32x4;

use super::axes::BoxAxes;
use super::eight::{EightAtRest, Places, VerticesBelow};
use super::{Below, OrientedBox, Tree};
use crate::base::num::extremes::Extremes;

/// Nodes of up to so many items have the axes of the largest node above them that has no more.
pub(super) const GROUP: usize = 16;

/// The corners of every triangle by their number among the vertices of its group: the consecutive
/// ones, then the others.
#[derive(Clone, Debug)]
pub(super) struct GroupCorners(Arc<[[u8; 3]]>);

impl GroupCorners {
    /// Takes the groups of a tree: their items, their consecutive vertices, the others.
    pub(super) fn new(items: &[[u32; 3]], groups: impl Iterator<Item = ((usize, usize), [u32; 2], Vec<u32>)>) -> Self {
        let mut corners = vec![[0; 3]; items.len()];
        for ((first, last), own, others) in groups {
            let number = |v: u32| match others.binary_search(&v) {
                Ok(k) => own[1] - own[0] + k as u32,
                Err(_) => v - own[0],
            };
            for (corners, item) in corners[first..last].iter_mut().zip(&items[first..last]) {
                *corners = item.map(|v| number(v) as u8);
            }
        }
        Self(corners.into())
    }
}

/// Fits the boxes of groups.
pub(super) struct GroupFit<'a> {
    pub(super) tree: &'a Tree,
    pub(super) places: &'a Places,
    pub(super) corners: &'a GroupCorners,
    /// The vertices of nodes that are not consecutive.
    pub(super) others: &'a [u32],
    pub(super) slack: f32,
}

/// Extents along three axes.
type Extents = (f32x4, f32x4);

/// Room for the work on a group: heights of its vertices, and extents of its nodes.
pub(super) struct GroupRoom {
    heights: [f32x4; 3 * GROUP],
    extents: [Extents; 2 * GROUP],
}

impl GroupRoom {
    pub(super) fn new() -> Self {
        Self {
            heights: [f32x4::ZERO; 3 * GROUP],
            extents: [(f32x4::ZERO, f32x4::ZERO); 2 * GROUP],
        }
    }
}

impl GroupFit<'_> {
    /// Fits the boxes of eight groups. Returns how far they reach from the tree's origin.
    pub(super) fn fit(&self, eight: &EightAtRest, boxes: &mut [OrientedBox], room: &mut GroupRoom) -> f32 {
        let (axes, mut reach) = (eight.stored_axes(self.places, boxes), 0.0f32);
        for (lane, (&node, below)) in eight.nodes.iter().zip(&eight.below).enumerate() {
            if lane == 0 || node != eight.nodes[lane - 1] {
                let axes = BoxAxes::new(axes.map(|axis| axis.map(|x| x[lane])));
                self.fit_group((node, below), &axes, boxes, room);
                reach = reach.larger(boxes[node as usize].reach());
            }
        }
        reach
    }

    fn fit_group(
        &self,
        (root, below): (u32, &VerticesBelow),
        axes: &BoxAxes,
        boxes: &mut [OrientedBox],
        GroupRoom { heights, extents }: &mut GroupRoom,
    ) {
        let others = &self.others[below.others[0] as usize..below.others[1] as usize];
        let vertices = (below.own[0]..below.own[1]).chain(others.iter().copied());
        for (heights, vertex) in heights.iter_mut().zip(vertices) {
            *heights = self.places.heights_of(vertex, axes);
        }
        // The root, then the nodes below it, whose children have higher numbers.
        let first = match self.tree.below(root) {
            Below::Children(c) => c,
            Below::Leaf(..) => below.end,
        };
        for k in (0..=(below.end - first) as usize).rev() {
            let node = if k == 0 { root } else { first + k as u32 - 1 };
            let (low, high) = match self.tree.below(node) {
                Below::Leaf(item, count) => self.of_leaf(item as usize, count as usize, heights),
                Below::Children(c) => {
                    let c = (c - first) as usize + 1;
                    let ((low, high), (l, h)) = (extents[c], extents[c + 1]);
                    (low.fast_min(l), high.fast_max(h))
                }
            };
            extents[k] = (low, high);
            boxes[node as usize] = axes.fitted(low, high, self.slack);
        }
    }

    #[inline(always)]
    fn of_leaf(&self, item: usize, count: usize, heights: &[f32x4; 3 * GROUP]) -> Extents {
        let corners = self.corners.0[item..item + count].as_flattened();
        let start = (f32x4::splat(f32::MAX), f32x4::splat(-f32::MAX));
        corners.iter().fold(start, |(low, high), &v| {
            let h = heights[v as usize];
            (low.fast_min(h), high.fast_max(h))
        })
    }
}
