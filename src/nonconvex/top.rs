//! The highest point of a mesh or a compound along a direction: a search of its tree.

use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::extremes::Bounded;
use crate::body::shape::Top;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::tree::{Below, height};

/// Returns the highest point of a body along a unit direction, and the caller's index of its
/// member.
///
/// Branch and bound: a node is opened only if its box or slab is higher than the highest member so
/// far. Of equally high members the first that the search meets is returned, so the result depends
/// on nothing but the body and the direction.
pub(crate) fn top(body: &impl Parted, n: &Vector3<f64>) -> (Top, u32) {
    let (tree, frame) = (body.side().tree, body.side().frame);
    let (mut best, mut found) = (f64::NEG_INFINITY, 0);
    let mut stack = Vec::with_capacity(64);
    stack.push((f64::INFINITY, 0));
    while let Some((bound, node)) = stack.pop() {
        if bound <= best {
            continue;
        }
        match tree.below(node) {
            Below::Children(child) => {
                let (x, y) = (height(tree, child, n), height(tree, child + 1, n));
                let (first, second) = ((x, child), (y, child + 1));
                stack.extend(if x > y { [second, first] } else { [first, second] });
            }
            Below::Leaf(first, count) => {
                for item in first..first + count {
                    let high = body.highest(item, n);
                    if high > best {
                        (best, found) = (high, item);
                    }
                }
            }
        }
    }
    let top = body.peak(found, n);
    let missing = best * frame.unit() - n.dot(&(top.point - frame.origin));
    let excess = missing.at_least(0.0);
    (Top { excess, ..top }, body.number(found))
}

/// Calls `each` with the members that may be as high as `level` along a unit direction.
///
/// `level` is in the caller's unit, from the origin of the body.
pub(crate) fn each_above(body: &impl Parted, n: &Vector3<f64>, level: f64, mut each: impl FnMut(u32)) {
    let (tree, unit) = (body.side().tree, body.stored_unit());
    let level = level - n.dot(&body.side().frame.origin);
    let mut stack = alloc::vec![0];
    while let Some(node) = stack.pop() {
        if height(tree, node, n) * unit < level {
            continue;
        }
        match tree.below(node) {
            Below::Children(child) => stack.extend([child, child + 1]),
            Below::Leaf(first, count) => (first..first + count)
                .filter(|item| body.highest(*item, n) * unit >= level)
                .for_each(&mut each),
        }
    }
}
