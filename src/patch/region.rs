//! The surroundings of the closest points, proven far enough at once.
//!
//! Nodes are halves of halves, so where the closest points lie near a border of a half, many pairs
//! of nodes meet there, none of them large. A box of parameters with the closest points in its
//! middle is cut out of each patch by de Casteljau's algorithm and bounded as a node is: by second
//! derivatives along the normal, or by a bowl. Pairs of nodes inside the boxes need no proof of
//! their own, and pairs outside are so much farther that their planes last for some frames.

use nalgebra::Vector3;

use super::bowl::Bowl;
use super::closest::{Meeting, Meets};
use super::cut::Cut;
use super::gap::Trees;
use super::height::taylor;
use super::side::NetSide;
use super::tree::Node;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{BENT_POSE, REGION};

/// Boxes of parameters whose parts are proven `target` apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    patches: [u32; 2],
    /// Of u and v on A, then on B.
    sides: [[f64; 2]; 4],
    pub(super) target: f64,
}

impl Region {
    /// Returns whether a pair of nodes lies in the boxes.
    #[inline]
    pub(super) fn covers(&self, x: &Node, y: &Node) -> bool {
        let within = |[low, high]: [f64; 2], [from, to]: [f64; 2]| low <= from && to <= high;
        let inside = |node: &Node, sides: [[f64; 2]; 2]| {
            let [u, v] = node.domain();
            within(sides[0], u) && within(sides[1], v)
        };
        let [u, v, s, t] = self.sides;
        self.patches == [x.patch(), y.patch()]
            && !x.is_group()
            && !y.is_group()
            && inside(x, [u, v])
            && inside(y, [s, t])
    }

    /// Returns the boxes about two close points whose parts reach about `way` along the surfaces,
    /// if both parts are proven at least `target` apart.
    pub(super) fn about<B: NetSide, M: Meets>(
        best: &Meeting,
        way: f64,
        target: f64,
        points: &M,
        trees: &mut Trees<'_, B>,
    ) -> Option<Self> {
        let n = best.along?;
        let sides = core::array::from_fn(|k| {
            let length = sqrt(best.tangents[k].norm_squared());
            // A parameter that moves no point may have any value.
            let half = if way < length { way / length } else { 1.0 };
            [(best.at[k] - half).at_least(0.0), (best.at[k] + half).at_most(1.0)]
        });
        let [u, v, s, t] = sides;
        let a = points.cut(0, best.patches[0], [u, v])?;
        let b = points.cut(1, best.patches[1], [s, t]);
        let is_proven = is_apart(&a, b.as_ref(), &n, target, trees)
            || match (&best.bowl, &b) {
                (Some(bowl), Some(b)) => is_about([&a, b], bowl, target, trees),
                _ => false,
            };
        // Ends of the boxes err by rounding.
        let inner = |[low, high]: [f64; 2]| {
            let low = if low > 0.0 { low + REGION } else { low };
            [low, if high < 1.0 { high - REGION } else { high }]
        };
        let mut sides = sides.map(inner);
        if b.is_none() {
            (sides[2], sides[3]) = ([0.0, 1.0], [0.0, 1.0]);
        }
        let patches = best.patches;
        is_proven.then_some(Self { patches, sides, target })
    }
}

/// Returns whether planes prove two parts apart, by second derivatives; B whole if not cut.
fn is_apart<B: NetSide>(a: &Cut, b: Option<&Cut>, n: &Vector3<f64>, target: f64, trees: &mut Trees<'_, B>) -> bool {
    trees.counts.caps += 1;
    let frame = trees.frame;
    let m = -frame.direction_in_b(n);
    let high_a = a.net().highest(n);
    let (high_b, error_b) = match b {
        Some(b) => (b.net().highest(&m), b.node.error),
        None => (trees.b.highest(0, &m), trees.b.node(0).error),
    };
    let most = n.dot(&frame.translation) - frame.error - a.node.error - error_b;
    let need = target - (most - high_b - high_a);
    let top = |part: &Cut, n: &Vector3<f64>, highest: f64| {
        let of = taylor(&part.node, &part.net(), n, highest, need);
        of.unwrap_or(highest).smaller(highest)
    };
    let top_a = top(a, n, high_a);
    let top_b = b.map_or(high_b, |b| top(b, &m, high_b));
    most - top_b - top_a >= target
}

/// Returns whether a bowl proves two parts apart.
fn is_about<B: NetSide>([a, b]: [&Cut; 2], bowl: &Bowl, target: f64, trees: &mut Trees<'_, B>) -> bool {
    let (of_a, of_b) = (bowl.of_a(target), bowl.of_b(target, trees.frame));
    if !of_a.is_near(&a.node) || !of_b.is_near(&b.node) {
        return false;
    }
    let most = -target - BENT_POSE * trees.frame.error;
    let (least_a, least_b) = (of_a.least(&a.node, &a.net()), of_b.least(&b.node, &b.net()));
    if !(least_a + least_b <= most) {
        return false;
    }
    trees.counts.bowls += 1;
    let Some(high_a) = of_a.highest(&a.node, &a.net()) else {
        return false;
    };
    let Some(high_b) = of_b.highest(&b.node, &b.net()) else {
        return false;
    };
    -high_a - high_b - BENT_POSE * trees.frame.error >= target
}

#[cfg(test)]
mod tests;
