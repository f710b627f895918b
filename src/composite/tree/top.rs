//! The upper part of a tree made anew over its lower parts.
//!
//! Small parts of a surface remain small when it bends, large ones come to lie in each other. A
//! whole new tree is better at first, but puts triangles together that are near each other by
//! chance and part again: of a sheet that is crumpled further it soon has five times the bounds.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::split::Splitter;
use super::{Below, COUNT_SHIFT, LEAF_MARK, OrientedBox, Tree};
use crate::base::notice::Watch;

/// The upper part of a tree is what is above nodes of so many items.
const LOWER_PART: u32 = 64;

/// Where a node comes from.
#[derive(Clone, Copy)]
enum NodeOrigin {
    /// The new upper part, by its own number.
    Top(u32),
    /// The tree before.
    Old(u32),
}

impl Tree {
    /// Divides the largest nodes of few items among new nodes above them: the tree, the order of
    /// the items, and the new nodes, which have axes and no extents.
    pub(crate) fn with_new_top(&self, points: &[Vector3<f64>], items: &[[u32; 3]]) -> (Self, Vec<u32>, Vec<u32>) {
        let lower = self.lower_parts();
        let vertices = |&node: &u32| {
            let (first, last) = self.range(node);
            let mut all = items[first as usize..last as usize].as_flattened().to_vec();
            all.sort_unstable();
            all.dedup();
            all
        };
        let parts: Vec<Vec<u32>> = lower.iter().map(vertices).collect();
        let splitter = Splitter::new((self.centre, self.exponent), points, &parts, 1);
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

    /// Adds a node and returns its number.
    fn push(&mut self) -> u32 {
        self.boxes.push(OrientedBox::default());
        self.links.push(0);
        self.links.len() as u32 - 1
    }

    /// Returns the largest nodes of at most [`LOWER_PART`] items.
    fn lower_parts(&self) -> Vec<u32> {
        let (mut parts, mut stack) = (Vec::new(), vec![0]);
        while let Some(node) = stack.pop() {
            let (first, last) = self.range(node);
            match self.below(node) {
                Below::Children(c) if last - first > LOWER_PART => stack.extend([c + 1, c]),
                _ => parts.push(node),
            }
        }
        parts
    }

    /// Returns the highest number of a node below a node: the nodes below it are consecutive.
    pub(super) fn last_below(&self, node: u32) -> u32 {
        let (mut last, mut at) = (node, node);
        while let Below::Children(c) = self.below(at) {
            last = c + 1;
            // The nodes below the right child come last, or those below the left if that is a leaf.
            at = if self.is_leaf(c + 1) { c } else { c + 1 };
        }
        last
    }
}
