//! The search down both trees to the closest pair, with every other pair proven farther, and the
//! work counters.
//!
//! 1. The search starts with a close pair of items ([`TreeSearch::seed`]), unless a body has a
//!    single item. This pair proves nothing, but pairs of boxes farther apart than its distance are
//!    pruned.
//! 2. Pairs of nodes that are not proven far enough are split, the nearest first
//!    ([`TreeSearch::descend`]).
//! 3. The search ends at pairs of leaves, which are tested item by item
//!    ([`TreeSearch::judge_leaves`]). Directions are tried first, because a gap along a direction
//!    costs far less than a distance.

use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, ByValue, Extremes};
use crate::base::num::sort::sort;
use crate::base::num::sum_of_counters;
use crate::nonconvex::front::{Front, NodePair};
use crate::nonconvex::query::box_gaps::{BoundAim, BoxGaps, bounds};
use crate::nonconvex::query::frame::{TreeFrame, split_pair};
use crate::nonconvex::query::overlap::Touching;
use crate::nonconvex::tree::{Below, CLOUD_LEAF, LEAF, Tree, height, near_unit};

/// Number of pairs taken off the stack at once.
///
/// Both halves of each give eight pairs, the width of the kernel.
pub(crate) const AT_ONCE: usize = 4;

/// Largest number of items of a node that are tested one by one in double precision.
const FEW_ITEMS: u32 = 64;

/// Number of pairs in contact after which a search tests whether the bodies share inner points.
///
/// Bodies in the same position have more contacts than triangles, and hardly a pair that certainly
/// crosses. Of 280 queries of such bodies, the longest measured 649 pairs with this test, and
/// 58,000 pairs without it.
const CROWD: u32 = 128;

/// Tests of two items: triangles or convex pieces, by their index in the tree.
pub(crate) trait Judge {
    /// The features of a pair, returned with points and bounds.
    type Features: Copy;

    /// Whether both trees and poses are the same: the items of a body against each other.
    const IS_SELF: bool = false;

    /// Whether a body may be a cloud, whose leaves have up to [`CLOUD_LEAF`] items.
    const MAY_BE_CLOUD: bool = false;

    /// Returns whether the query includes a pair of items.
    ///
    /// It includes all pairs, except if a body is queried against itself.
    #[inline(always)]
    fn is_asked(&self, _: NodePair) -> bool {
        true
    }

    /// Returns the greatest `n . x` over an item of A, in A's stored frame.
    fn highest_in_a(&self, item: u32, n: &Vector3<f64>) -> f64;

    /// Returns the least `n . y` over an item of B, in B's stored frame.
    fn lowest_in_b(&self, item: u32, n: &Vector3<f64>) -> f64;

    /// Computes the greatest `n . x` over each of some items of A.
    #[inline(always)]
    fn heights_in_a(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) {
        items.zip(to).for_each(|(item, to)| *to = self.highest_in_a(item, n));
    }

    /// Computes the least `n . y` over each of some items of B.
    #[inline(always)]
    fn heights_in_b(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) {
        items.zip(to).for_each(|(item, to)| *to = self.lowest_in_b(item, n));
    }

    /// Returns how many pairs needed a certified query of two polygons.
    fn settled(&self) -> u64 {
        0
    }

    /// Returns whether the bodies certainly share inner points, and how many winding numbers it
    /// took.
    ///
    /// Points near the pairs in contact are tested. `found` is a contact.
    fn shares_inside(&self, touching: &Touching, found: &Measured<Self::Features>) -> (bool, u64);

    /// Decides by integers whether bodies share a point, if few pairs of items are in contact.
    ///
    /// `found` is a contact, and `touching` are the pairs that the search met. The result depends
    /// on neither. Returns `None` if there are too many pairs.
    fn decide_contact(
        &mut self,
        _touching: &Touching,
        _found: &Measured<Self::Features>,
    ) -> Option<DecidedContact<Self::Features>> {
        None
    }

    /// Returns the distance of two items with proven bounds.
    ///
    /// If any arithmetic can, the lower bound is at most the frame's `tie` below the lesser of the
    /// distance and `known`.
    fn measure(&mut self, frame: &TreeFrame, pair: NodePair, known: f64) -> Measured<Self::Features>;
}

/// Two items and their distance, in A's stored units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<F> {
    pub(crate) pair: NodePair,
    /// The distance as computed, without its error.
    pub(crate) distance: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Unit direction from A to B, in A's frame.
    pub(crate) normal: Vector3<f64>,
    /// Witness points, in A's stored frame and in B's.
    pub(crate) on_a: Vector3<f64>,
    pub(crate) on_b: Vector3<f64>,
    pub(crate) features: F,
    /// Whether the items certainly share inner points.
    pub(crate) crosses: bool,
}

/// The items of bodies that are in contact up to rounding, as integers decide.
pub(crate) struct DecidedContact<F> {
    /// The closest pair, or one that crosses.
    pub(crate) best: Measured<F>,
    /// Lower bound of the distance of all pairs, in A's stored units.
    pub(crate) lower: f64,
    /// The pairs that rounding does not separate.
    pub(crate) touching: Touching,
}

impl<F> Measured<F> {
    /// Returns whether the items are in contact up to rounding.
    fn is_contact(&self, frame: &TreeFrame) -> bool {
        self.lower == 0.0 && self.upper <= 2.0 * frame.error
    }
}

/// The goal of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MeshGoal {
    /// Finds the least distance.
    Least,
    /// Decides whether any pair is at most this far apart, in A's stored units.
    Within(f64),
    /// Finds all pairs of a body and itself that are at most this far apart, in stored units.
    All(f64),
}

/// Stores the pairs of nodes that a search proves.
pub(crate) trait ProofKeeper {
    fn keep<J: Judge>(&mut self, search: &TreeSearch<J>, pair: NodePair, proof: GapProof);
}

impl ProofKeeper for Front {
    #[inline(always)]
    fn keep<J: Judge>(&mut self, search: &TreeSearch<J>, pair: NodePair, proof: GapProof) {
        self.push(&search.frame.single, [search.a, search.b], pair, proof);
    }
}

/// A search in progress.
pub(crate) struct TreeSearch<'a, J: Judge> {
    pub(crate) a: &'a Tree,
    pub(crate) b: &'a Tree,
    pub(crate) frame: &'a TreeFrame,
    pub(crate) judge: J,
    pub(crate) goal: MeshGoal,
    /// The closest pair so far.
    pub(crate) best: Option<Measured<J::Features>>,
    /// Lower bound over the pairs that were pruned in double precision or measured, without `best`.
    pub(super) lower: f64,
    /// The pairs found, if the goal is all pairs.
    pub(crate) found: Vec<Measured<J::Features>>,
    /// Lower bound over all pairs of the two leaves tested last, for a body against itself.
    ///
    /// It is minus infinity if the search was over before all pairs were tested.
    pub(crate) leaf_gap: f64,
    /// Directions of the latest best pairs. There are two, because they alternate in flush contact.
    pub(crate) directions: [Option<(NodePair, TriedDirection)>; 2],
    /// Pairs met at distance zero up to rounding.
    pub(super) touching: Touching,
    /// Whether a contact without a crossing ends the search for the least distance.
    ///
    /// It does if one of the bodies is an open mesh, because then the bodies share no inner points.
    pub(crate) ends_in_contact: bool,
    /// Number of measured pairs that are in contact, or closer than a tie.
    close: u32,
    /// The pruning level in single precision.
    single: f32,
    /// The least gap that was proven in single precision.
    least: f32,
    pub(crate) work: TreeWork,
}

/// A unit direction from A to B.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriedDirection {
    /// In A's stored frame, and in B's.
    in_a: Vector3<f64>,
    in_b: Vector3<f64>,
    /// The height of the origin of B's frame above the origin of A's.
    lift: f64,
    /// The greatest height of A in its frame if A has a single item, and the least height of B in
    /// its frame if B has.
    alone: [f64; 2],
}

/// A direction and a proven gap along it, in single precision.
#[derive(Clone, Copy)]
pub(crate) struct GapProof {
    /// From A to B, in A's frame.
    pub(crate) normal: [f32; 3],
    pub(crate) gap: f32,
}

impl GapProof {
    /// Returns a direction along which nothing is proven.
    const fn none(normal: [f32; 3]) -> Self {
        Self { normal, gap: -f32::MAX }
    }
}

impl<'a, J: Judge> TreeSearch<'a, J> {
    pub(crate) fn new([a, b]: [&'a Tree; 2], frame: &'a TreeFrame, judge: J, goal: MeshGoal) -> Self {
        let mut search = Self {
            a,
            b,
            frame,
            judge,
            goal,
            best: None,
            lower: f64::INFINITY,
            found: Vec::new(),
            leaf_gap: f64::INFINITY,
            directions: [None; 2],
            touching: Touching::NONE,
            ends_in_contact: false,
            close: 0,
            single: f32::INFINITY,
            least: f32::INFINITY,
            work: TreeWork::default(),
        };
        search.single = search.single_level();
        search
    }

    /// Returns a direction in both frames, with the height of a body of a single item.
    #[inline(always)]
    fn tried(&self, n: &Vector3<f64>) -> TriedDirection {
        let in_b = self.frame.direction_in_b(n);
        let (mut high, mut low) = (0.0, 0.0);
        if self.a.is_alone() {
            high = self.judge.highest_in_a(0, n);
        }
        if self.b.is_alone() {
            low = self.judge.lowest_in_b(0, &in_b);
        }
        TriedDirection {
            in_a: *n,
            in_b,
            lift: n.dot(&self.frame.translation),
            alone: [high, low],
        }
    }

    /// Returns the pruning level in A's stored units: the distance of the goal, or the least so
    /// far.
    pub(crate) fn level(&self) -> f64 {
        match self.goal {
            MeshGoal::Within(d) | MeshGoal::All(d) => d,
            MeshGoal::Least => self.best.as_ref().map_or(f64::INFINITY, |b| b.distance),
        }
    }

    /// Returns a lower bound of the distance of all pairs, in A's stored units.
    ///
    /// It holds at the end of a search that is not over.
    pub(crate) fn proven(&self) -> f64 {
        let measured = self.best.as_ref().map_or(f64::INFINITY, |b| b.lower);
        let proven = self.lower.smaller(f64::from(self.least) * self.frame.single.unit);
        proven.smaller(measured)
    }

    /// Returns the pruning level in f32, rounded up; the next number if equality does not prune.
    fn single_level(&self) -> f32 {
        let level = self.frame.single_up(self.level());
        match self.goal {
            MeshGoal::Least => level,
            MeshGoal::Within(_) | MeshGoal::All(_) => level.next_up(),
        }
    }

    /// Returns whether the measured pairs decide the goal.
    pub(crate) fn is_over(&self) -> bool {
        let Some(best) = &self.best else { return false };
        match self.goal {
            MeshGoal::Least => best.crosses || self.ends_in_contact && best.is_contact(self.frame),
            MeshGoal::Within(d) => best.upper <= d,
            MeshGoal::All(_) => false,
        }
    }

    /// Measures a pair of items and stores it if it is the closest so far.
    ///
    /// Returns the normal and the lower bound.
    pub(crate) fn measure(&mut self, pair: NodePair) -> (Vector3<f64>, f64) {
        self.work.measured += 1;
        let found = self.judge.measure(self.frame, pair, self.level());
        let result = (found.normal, found.lower);
        if J::IS_SELF
            && let MeshGoal::All(d) = self.goal
            && !(found.lower > d)
        {
            self.found.push(found);
        }
        if found.distance <= self.frame.error {
            self.touching.push(pair);
        }
        let level = self.best.as_ref().map_or(f64::INFINITY, |b| b.distance);
        let is_tie = found.distance <= level + self.frame.tie;
        let is_closer = found.distance < level || found.crosses && self.best.as_ref().is_some_and(|b| !b.crosses);
        let own = Some((pair, self.tried(&found.normal)));
        if found.distance < level - self.frame.tie || self.best.is_none() {
            self.directions = [own, None];
        } else if is_tie {
            self.directions[1] = own;
        }
        if is_closer || self.best.is_none() {
            let before = self.best.replace(found);
            self.lower = self.lower.smaller(before.map_or(f64::INFINITY, |b| b.lower));
            self.single = self.single_level();
        } else {
            self.lower = self.lower.smaller(found.lower);
        }
        if found.distance <= self.frame.tie {
            self.close += 1;
            if self.close == CROWD {
                self.judge_crowd();
            }
        }
        result
    }

    /// Tests for common inner points if many pairs are nearly in contact.
    ///
    /// There may be as many such pairs as items, although none of them certainly crosses.
    #[cold]
    fn judge_crowd(&mut self) {
        let Some(best) = &mut self.best else { return };
        let (is_shared, windings) = self.judge.shares_inside(&self.touching, best);
        self.work.windings += windings;
        if is_shared {
            (best.distance, best.lower, best.upper, best.crosses) = (0.0, 0.0, 0.0, true);
        }
    }

    /// Returns whether a proven gap prunes a pair, and records the gap if it does.
    #[inline(always)]
    pub(crate) fn passes(&mut self, gap: f64) -> bool {
        let passes = match self.goal {
            MeshGoal::Least => gap >= self.level() - self.frame.tie,
            MeshGoal::Within(d) | MeshGoal::All(d) => gap > d,
        };
        if passes {
            self.lower = self.lower.smaller(gap);
        }
        passes
    }

    /// Returns the gaps of up to eight pairs of boxes.
    pub(crate) fn bound(&mut self, pairs: &[NodePair]) -> BoxGaps {
        self.work.bounds += pairs.len() as u64;
        let single = |(_, n): &(NodePair, TriedDirection)| [n.in_a.x as f32, n.in_a.y as f32, n.in_a.z as f32];
        let aim = BoundAim {
            level: self.single + self.frame.single.error,
            known: self.directions[0].as_ref().map(single),
        };
        bounds(&self.frame.single, [self.a, self.b], pairs, &aim)
    }

    /// Tries to prove a pair far enough apart.
    ///
    /// The gap in single precision is tried first. If it is nearly sufficient, directions are tried
    /// in double precision. Two leaves are tested item by item.
    #[inline(always)]
    pub(crate) fn settle(&mut self, pair: NodePair, gap: f32, normal: [f32; 3]) -> Option<GapProof> {
        let proven = gap - self.frame.single.error;
        if proven >= self.single {
            self.least = self.least.smaller(proven);
            return Some(GapProof { normal, gap: proven });
        }
        self.settle_close(pair, gap, normal)
    }

    #[inline(never)]
    fn settle_close(&mut self, pair: NodePair, gap: f32, normal: [f32; 3]) -> Option<GapProof> {
        let (error, level) = (self.frame.single.error, self.single);
        let is_close = gap + 3.0 * error >= level || level < 8.0 * error;
        for k in 0..if is_close { 2 } else { 0 } {
            let Some((_, n)) = self.directions[k] else { break };
            let gap = self.look(pair, &n);
            if self.passes(gap) {
                self.directions.swap(0, k);
                return Some(self.proof(&n.in_a, gap));
            }
        }
        match (self.a.is_leaf(pair[0]), self.b.is_leaf(pair[1])) {
            (true, true) => Some(self.judge_leaves(pair, normal)),
            (false, false) => None,
            _ => self.by_support(pair, gap, normal),
        }
    }

    /// Tries to prove a node of one body against the only item of the other.
    ///
    /// The height of the item itself is used, because the box of a round body is much larger than
    /// the body.
    fn by_support(&mut self, [x, y]: NodePair, gap: f32, normal: [f32; 3]) -> Option<GapProof> {
        let (is_a, is_b) = (self.a.is_alone(), self.b.is_alone());
        let reach = match (is_a, is_b) {
            (true, _) => self.a.boxes[0].radius() * self.frame.single.scale_a,
            (_, true) => self.b.boxes[0].radius() * self.frame.single.scale_b,
            _ => return None,
        };
        // A body is lower than its box by rarely more than half the radius of the box.
        if gap + 0.5 * reach < self.single {
            return None;
        }
        for k in 0..2 {
            // The height of the item along the known direction costs nothing, so it is first.
            let known = self.directions[0].filter(|_| k == 0).map(|d| d.1);
            let new = if k == 1 { self.own_direction(normal) } else { None };
            let Some(n) = known.or(new) else { continue };
            self.work.looks += 1;
            let high = if is_a { n.alone[0] } else { height(self.a, x, &n.in_a) };
            let low = if is_b { n.alone[1] } else { -height(self.b, y, &-n.in_b) };
            let gap = low + n.lift - 2.0 * self.frame.error - high;
            if self.passes(gap) {
                return Some(self.proof(&n.in_a, gap));
            }
        }
        None
    }

    /// Tries to prove two leaves along a direction in A's frame, by the heights of their items.
    pub(crate) fn by_items(&mut self, [x, y]: NodePair, normal: [f32; 3]) -> Option<GapProof> {
        if !(self.a.is_leaf(x) && self.b.is_leaf(y)) {
            return None;
        }
        let n = self.own_direction(normal)?;
        self.work.looks += 1;
        let (low, high) = (self.lowest(self.b.range(y), &n), self.highest(self.a.range(x), &n));
        let gap = low + n.lift - 2.0 * self.frame.error - high;
        self.passes(gap).then(|| self.proof(&n.in_a, gap))
    }

    /// Returns the least height of the given items of B.
    fn lowest(&self, items: Range<u32>, n: &TriedDirection) -> f64 {
        items.fold(f64::INFINITY, |low, k| low.smaller(self.judge.lowest_in_b(k, &n.in_b)))
    }

    /// Returns the greatest height of the given items of A.
    fn highest(&self, items: Range<u32>, n: &TriedDirection) -> f64 {
        items.fold(f64::NEG_INFINITY, |high, k| {
            high.larger(self.judge.highest_in_a(k, &n.in_a))
        })
    }

    /// Returns the direction along which a pair of boxes has its best gap.
    fn own_direction(&self, normal: [f32; 3]) -> Option<TriedDirection> {
        let n = near_unit(&Vector3::from(normal.each(f64::from)))?;
        Some(self.tried(&n))
    }

    /// Converts a direction and a gap in double precision to the form in a front.
    pub(super) fn proof(&self, n: &Vector3<f64>, gap: f64) -> GapProof {
        // Rounding the direction changes heights by v L, and rounding the gap changes it by v of
        // itself. The error of single precision is far larger.
        let gap = (gap * self.frame.single.per_unit) as f32 - self.frame.single.error;
        GapProof {
            normal: [n.x as f32, n.y as f32, n.z as f32],
            gap,
        }
    }

    /// Returns the gap of two nodes along a direction in double precision, reduced by its error.
    ///
    /// Boxes and slabs bound the heights. If the gap is short by no more than the error of single
    /// precision, the items of small nodes do.
    fn look(&mut self, [x, y]: NodePair, n: &TriedDirection) -> f64 {
        self.work.looks += 1;
        let lift = n.lift - 2.0 * self.frame.error;
        let (is_a, is_b) = (self.a.is_alone(), self.b.is_alone());
        let mut high = if is_a { n.alone[0] } else { height(self.a, x, &n.in_a) };
        let mut low = if is_b { n.alone[1] } else { -height(self.b, y, &-n.in_b) };
        let hidden = f64::from(self.frame.single.error) * self.frame.single.unit;
        let level = self.level() - self.frame.tie;
        let is_short = |gap: f64| gap < level && gap + hidden >= level;
        if is_short(low + lift - high) {
            if let Some(items) = few(self.b, y) {
                low = self.lowest(items, n);
            }
            if is_short(low + lift - high)
                && let Some(items) = few(self.a, x)
            {
                high = self.highest(items, n);
            }
        }
        low + lift - high
    }

    /// Splits the pairs on the stack, the nearest first, until all are proven or the search is
    /// over.
    ///
    /// Proven pairs are added to the front, if there is one.
    pub(crate) fn descend<K: ProofKeeper>(&mut self, stack: &mut Vec<NodePair>, mut front: Option<&mut K>) {
        while !stack.is_empty() && !self.is_over() {
            let mut halves = [[0; 2]; 2 * AT_ONCE];
            let mut count = 0;
            while count < 2 * AT_ONCE
                && let Some(pair) = stack.pop()
            {
                if let Some(two) = split_pair([self.a, self.b], self.frame, pair) {
                    halves[count..count + 2].copy_from_slice(&two);
                    count += 2;
                }
            }
            let halves = &mut halves[..count];
            if halves.is_empty() {
                continue;
            }
            self.settle_all(halves, stack, front.as_deref_mut());
        }
    }

    /// Proves up to eight pairs, and puts the others on the stack, the nearest last.
    #[inline(always)]
    pub(crate) fn settle_all<K: ProofKeeper>(
        &mut self,
        pairs: &[NodePair],
        stack: &mut Vec<NodePair>,
        mut front: Option<&mut K>,
    ) {
        let found = self.bound(pairs);
        let mut open = [(0.0, [0; 2]); 2 * AT_ONCE];
        let mut left = 0;
        for (k, &pair) in pairs.iter().enumerate() {
            match self.settle(pair, found.gap[k], found.normal[k]) {
                Some(proof) => {
                    if let Some(front) = front.as_deref_mut() {
                        front.keep(self, pair, proof);
                    }
                }
                None => {
                    open[left] = (found.gap[k], pair);
                    left += 1;
                }
            }
        }
        let open = &mut open[..left];
        // The sort is stable, so pairs of equal bounds keep their order.
        sort(open, |p, q| q.0.by_value(p.0));
        stack.extend(open.iter().map(|p| p.1));
    }

    /// Proves the pair of the roots, or puts it on the stack.
    pub(crate) fn start(&mut self, stack: &mut Vec<NodePair>, front: Option<&mut Front>) {
        stack.clear();
        let root = [0, 0];
        let found = self.bound(&[root]);
        match self.settle(root, found.gap[0], found.normal[0]) {
            Some(proof) => {
                if let Some(front) = front {
                    front.keep(self, root, proof);
                }
            }
            None => stack.push(root),
        }
    }
}

/// Returns the items of a node if they are few.
fn few(tree: &Tree, node: u32) -> Option<Range<u32>> {
    let items = tree.range(node);
    (items.end - items.start <= FEW_ITEMS).then_some(items)
}

impl<J: Judge> TreeSearch<'_, J> {
    /// Measures a close pair of items, found by a beam search of [`AT_ONCE`] pairs of nodes per
    /// level.
    pub(crate) fn seed(&mut self) {
        let mut beam = [[0u32; 2]; AT_ONCE];
        let mut width = 1;
        let mut leaves = [SeedPair::NONE; AT_ONCE];
        while width > 0 {
            let mut halves = [[0; 2]; 2 * AT_ONCE];
            let mut count = 0;
            for &pair in &beam[..width] {
                match split_pair([self.a, self.b], self.frame, pair) {
                    Some(two) => {
                        halves[count..count + 2].copy_from_slice(&two);
                        count += 2;
                    }
                    None => {
                        let new = SeedPair {
                            gap: -f32::MAX,
                            pair,
                            normal: [0.0; 3],
                        };
                        keep(&mut leaves, new);
                    }
                }
            }
            if count == 0 {
                break;
            }
            let found = self.bound(&halves[..count]);
            let mut next = [SeedPair::NONE; AT_ONCE];
            for (k, &pair) in halves[..count].iter().enumerate() {
                let is_leaf = self.a.is_leaf(pair[0]) && self.b.is_leaf(pair[1]);
                let new = SeedPair {
                    gap: found.gap[k],
                    pair,
                    normal: found.normal[k],
                };
                keep(if is_leaf { &mut leaves } else { &mut next }, new);
            }
            width = next.iter().filter(|x| x.gap < f32::INFINITY).count();
            (0..width).for_each(|k| beam[k] = next[k].pair);
        }
        for SeedPair { pair, normal, .. } in leaves.into_iter().filter(|x| x.gap < f32::INFINITY).take(2) {
            self.judge_leaves(pair, normal);
        }
    }
}

/// A candidate of the beam search: the pair with the least gap is the best.
#[derive(Clone, Copy)]
struct SeedPair {
    gap: f32,
    pair: NodePair,
    normal: [f32; 3],
}

impl SeedPair {
    /// An unused entry of a list.
    const NONE: Self = Self {
        gap: f32::INFINITY,
        pair: [0; 2],
        normal: [0.0; 3],
    };
}

/// Inserts a pair into a list sorted by gap, which drops its last entry.
fn keep(list: &mut [SeedPair; AT_ONCE], new: SeedPair) {
    if new.gap < list[AT_ONCE - 1].gap {
        list[AT_ONCE - 1] = new;
        sort(list, |p, q| p.gap.by_value(q.gap));
    }
}

/// Pairs of items of two leaves that are not proven yet.
///
/// There are at most `M` items of A and `N` of B, and `M * N` is at most 64.
struct OpenLeafPair<const M: usize, const N: usize> {
    of_a: Range<u32>,
    of_b: Range<u32>,
    /// One bit per pair, `N` bits per item of A.
    left: u64,
    /// The pair with the least gap along the direction tried last, which is measured first.
    nearest: u32,
    /// The direction along which the least gap of all pairs is greatest, and this gap.
    best: Option<(Vector3<f64>, f64)>,
    /// Lower bound over the pairs that are proven.
    proven: f64,
}

impl<const M: usize, const N: usize> OpenLeafPair<M, N> {
    fn new(of_a: Range<u32>, of_b: Range<u32>) -> Self {
        let row: u64 = (1 << of_b.len()) - 1;
        let left = (0..of_a.len()).fold(0, |bits, x| bits | row << (N * x));
        Self {
            of_a,
            of_b,
            left,
            nearest: 0,
            best: None,
            proven: f64::INFINITY,
        }
    }

    /// Takes the next pair to measure out of those that are not proven.
    #[inline(always)]
    fn take_next(&mut self) -> NodePair {
        let is_open = self.left & 1 << self.nearest != 0;
        let bit = if is_open {
            self.nearest
        } else {
            self.left.trailing_zeros()
        };
        self.left &= !(1 << bit);
        self.pair(bit)
    }

    /// Records a lower bound of some pairs, for a body against itself.
    #[inline(always)]
    fn prove<J: Judge>(&mut self, distance: f64) {
        if J::IS_SELF {
            self.proven = self.proven.smaller(distance);
        }
    }

    /// Removes the pairs that the query does not include.
    fn only_asked<J: Judge>(&mut self, judge: &J) {
        for bit in bits(self.left) {
            if !judge.is_asked(self.pair(bit)) {
                self.left &= !(1 << bit);
            }
        }
    }

    /// Returns the items of a bit.
    #[inline(always)]
    fn pair(&self, bit: u32) -> NodePair {
        [self.of_a.start + bit / N as u32, self.of_b.start + bit % N as u32]
    }
}

/// Returns the indices of the bits that are set.
#[inline(always)]
fn bits(mut left: u64) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let bit = (left != 0).then(|| left.trailing_zeros())?;
        left &= left - 1;
        Some(bit)
    })
}

impl<J: Judge> TreeSearch<'_, J> {
    /// Tests all items of two leaves, first along directions, then by measuring them.
    ///
    /// The directions come from the closest pairs and from the boxes. Returns the best single
    /// direction, even if it does not prove the pair far enough apart.
    fn judge_leaves(&mut self, pair: NodePair, normal: [f32; 3]) -> GapProof {
        self.work.leaves += 1;
        let (Below::Leaf(i, m), Below::Leaf(j, n)) = (self.a.below(pair[0]), self.b.below(pair[1])) else {
            return GapProof::none(normal);
        };
        let (of_a, of_b) = (i..i + m, j..j + n);
        if J::MAY_BE_CLOUD && n as usize > LEAF {
            return if m as usize > LEAF {
                self.judge_wide_leaves(of_a, of_b, normal)
            } else {
                self.judge_items::<LEAF, CLOUD_LEAF>(of_a, of_b, normal)
            };
        }
        if J::MAY_BE_CLOUD && m as usize > LEAF {
            return self.judge_items::<CLOUD_LEAF, LEAF>(of_a, of_b, normal);
        }
        self.judge_items::<LEAF, LEAF>(of_a, of_b, normal)
    }

    /// Tests all items of two leaves of clouds, a few items of A at a time.
    fn judge_wide_leaves(&mut self, of_a: Range<u32>, of_b: Range<u32>, normal: [f32; 3]) -> GapProof {
        let mut worst = GapProof { normal, gap: f32::MAX };
        for first in of_a.clone().step_by(LEAF) {
            let few = first..of_a.end.min(first + LEAF as u32);
            let proof = self.judge_items::<LEAF, CLOUD_LEAF>(few, of_b.clone(), normal);
            if proof.gap < worst.gap {
                worst = proof;
            }
            if self.is_over() {
                return GapProof::none(normal);
            }
        }
        // The proofs have different directions, but an entry of the front has one.
        let Some(n) = self.own_direction(worst.normal) else {
            return GapProof::none(normal);
        };
        let gap = self.lowest(of_b, &n) + n.lift - 2.0 * self.frame.error - self.highest(of_a, &n);
        self.proof(&n.in_a, gap)
    }

    /// Tests pairs of items: first along directions, then by measuring them.
    #[inline(always)]
    fn judge_items<const M: usize, const N: usize>(
        &mut self,
        of_a: Range<u32>,
        of_b: Range<u32>,
        normal: [f32; 3],
    ) -> GapProof {
        let mut open = OpenLeafPair::<M, N>::new(of_a, of_b);
        if J::IS_SELF {
            open.only_asked(&self.judge);
        }
        for k in 0..3 {
            if J::IS_SELF && open.left == 0 {
                break;
            }
            let known = self.directions.get(k).map(|d| d.map(|d| d.1));
            if let Some(n) = known.unwrap_or_else(|| self.own_direction(normal)) {
                self.along(&mut open, &n);
            }
            if open.left == 0 {
                break;
            }
        }
        while open.left != 0 && !self.is_over() {
            let (n, lower) = self.measure(open.take_next());
            open.prove::<J>(lower);
            self.along(&mut open, &self.tried(&n));
        }
        if J::IS_SELF {
            let is_whole = open.left == 0;
            self.leaf_gap = if is_whole { open.proven } else { f64::NEG_INFINITY };
            return GapProof::none([0.0; 3]);
        }
        match open.best {
            Some((n, gap)) => self.proof(&n, gap),
            None => GapProof::none(normal),
        }
    }

    /// Removes the pairs of items that a direction proves.
    #[inline(always)]
    fn along<const M: usize, const N: usize>(&mut self, open: &mut OpenLeafPair<M, N>, n: &TriedDirection) {
        let lift = n.lift - self.frame.error;
        let (mut high, mut low) = ([f64::NEG_INFINITY; M], [f64::INFINITY; N]);
        let (mut top, mut bottom) = (f64::NEG_INFINITY, f64::INFINITY);
        if self.a.is_alone() {
            high[0] = n.alone[0];
        } else {
            self.judge.heights_in_a(open.of_a.clone(), &n.in_a, &mut high);
        }
        for high in &high[..open.of_a.len()] {
            top = top.at_least(*high);
        }
        if self.b.is_alone() {
            low[0] = n.alone[1];
        } else {
            self.judge.heights_in_b(open.of_b.clone(), &n.in_b, &mut low);
        }
        for low in &mut low[..open.of_b.len()] {
            *low += lift;
            bottom = bottom.at_most(*low);
        }
        let least = bottom - top;
        if least > self.frame.tie && self.passes(least) {
            open.left = 0;
            open.prove::<J>(least);
        } else {
            let mut closest = f64::INFINITY;
            for bit in bits(open.left) {
                let gap = low[bit as usize % N] - high[bit as usize / N];
                if self.passes(gap) {
                    open.left &= !(1 << bit);
                    open.prove::<J>(gap);
                    if gap <= self.frame.tie {
                        self.touching.push(open.pair(bit));
                    }
                } else if gap < closest {
                    (closest, open.nearest) = (gap, bit);
                }
            }
        }
        if open.best.is_none_or(|b| b.1 < least) {
            open.best = Some((n.in_a, least));
        }
    }
}

/// Work of queries, as counters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TreeWork {
    /// Number of queries.
    pub queries: u64,
    /// Entries of fronts that were tested again at a new pose.
    pub entries: u64,
    /// Tested entries that were not proven again.
    pub failed: u64,
    /// Pairs of boxes bounded in single precision.
    pub bounds: u64,
    /// Pairs of nodes bounded in double precision.
    pub looks: u64,
    /// Pairs of leaves tested item by item.
    pub leaves: u64,
    /// Pairs of triangles or pieces whose distance was computed.
    pub measured: u64,
    /// Pairs of triangles that needed a certified query of two polygons.
    pub settled: u64,
    /// Fronts that were built from the roots.
    pub cuts: u64,
    /// Winding numbers computed.
    pub windings: u64,
}

sum_of_counters!(TreeWork {
    queries,
    entries,
    failed,
    bounds,
    looks,
    leaves,
    measured,
    settled,
    cuts,
    windings
});
