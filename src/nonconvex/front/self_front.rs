//! The front of a body against itself: pairs of nodes of its tree, each with a claimed distance.
//!
//! A claim is a distance that the items of the nodes had at least at some instant. Every pair of
//! items that the query includes is under one claim: the roots of the front are the two children of
//! every node, and every leaf with itself. Items share vertices, so no direction separates the
//! leaves around a vertex, and both nodes are always in one frame. So a claim is a distance without
//! a direction, and it holds as long as the body does not bend.
//!
//! When vertices move, let `c` be a displacement that represents a node. Let `r` be the largest
//! distance of the displacement of one of its vertices from `c`. Both are measured since the front
//! was started. A point of a triangle is a weighted mean of its vertices. So the vector from a
//! point below X to a point below Y has changed since a claim by at most
//!
//! `|(c_X - c_Y) now - (c_X - c_Y) then| + r_X + r_Y now + r_X + r_Y then`.
//!
//! Adjacent nodes move together, so a claim loses the stretch between its nodes, not their
//! displacement. Losses do not add up over frames: if a body swings back, its claims lose nothing.

use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::nonconvex::front::FrontFault;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::query::search::AT_ONCE;
use crate::nonconvex::query::search::{GapProof, Judge, ProofKeeper, TreeSearch};
use crate::nonconvex::tree::{Below, Tree, up};

/// Largest number of claims of a front, per triangle of the mesh; a longer front is dropped.
///
/// A mesh of fewer than 64 triangles counts as one of 64.
const SELF_CLAIMS: usize = 64;

/// A front is started again if this multiple of its claims has failed since it was started.
///
/// The reason is that a claim does not recover what it lost while vertices moved. For a sheet of
/// 20,000 triangles, folded three times, whose layers move by a quarter of their distance per
/// frame, a frame takes 8.2 ms with 1 and 7.0 ms with 4.
const SELF_FAILED: usize = 4;

/// Displacements of the points below a node since the front was started, in units of the tree.
///
/// No displacement is farther than `spread` from `middle`.
#[derive(Clone, Copy, Debug, Default)]
struct NodeDrift {
    middle: [f32; 3],
    spread: f32,
}

/// Two nodes and the least distance of their items, in stored units.
#[derive(Clone, Copy, Debug)]
struct DistanceClaim {
    pair: NodePair,
    /// The distance, reduced by the spreads and the rounding at the time of the claim.
    base: f64,
    /// The difference of both middles at that time, rounded.
    between: [f32; 3],
}

/// The claims of a body against itself, with the state that they need.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfFront {
    claims: Vec<DistanceClaim>,
    /// The vertices when the front was started, in stored units.
    begun: Vec<Vector3<f64>>,
    /// The displacements of every node since then; empty if no vertex has moved.
    drifts: Vec<NodeDrift>,
    /// Number of claims that have failed since the front was started.
    failed: usize,
    stack: Vec<NodePair>,
    /// Claims that must be proven again.
    open: Vec<NodePair>,
}

/// The vertices of a body, and the vertices of each of its items.
#[derive(Clone, Copy)]
pub(crate) struct ItemVertices<'a> {
    pub(crate) points: &'a [Vector3<f64>],
    pub(crate) items: &'a [[u32; 3]],
}

impl SelfFront {
    pub(crate) fn clear(&mut self) {
        self.claims.clear();
        self.begun.clear();
        self.drifts.clear();
        self.failed = 0;
    }

    pub(crate) fn len(&self) -> usize {
        self.claims.len()
    }

    pub(crate) fn memory_usage(&self) -> usize {
        self.claims.capacity() * size_of::<DistanceClaim>()
            + self.begun.capacity() * size_of::<Vector3<f64>>()
            + self.drifts.capacity() * size_of::<NodeDrift>()
            + (self.stack.capacity() + self.open.capacity()) * size_of::<NodePair>()
    }

    /// Takes the current vertices.
    pub(crate) fn follow(&mut self, tree: &Tree, now: ItemVertices<'_>) {
        if self.begun.len() != now.points.len() {
            return self.clear();
        }
        let scale = 1.0 / tree.unit();
        self.drifts.clear();
        self.drifts.resize(tree.len(), NodeDrift::default());
        let moved = |v: u32| (now.points[v as usize] - self.begun[v as usize]) * scale;
        for node in (0..tree.len()).rev() {
            self.drifts[node] = match tree.below(node as u32) {
                Below::Leaf(first, count) => {
                    let items = &now.items[first as usize..(first + count) as usize];
                    NodeDrift::of_vertices(|| items.iter().flatten().map(|v| moved(*v)))
                }
                Below::Children(c) => NodeDrift::of_both(&self.drifts[c as usize], &self.drifts[c as usize + 1]),
            };
        }
    }

    /// Proves failed claims again, or all claims of a new front, and searches the rest.
    pub(crate) fn search<J: Judge>(&mut self, search: &mut TreeSearch<J>, now: ItemVertices<'_>) {
        if search.is_over() {
            return;
        }
        search.work.entries += self.claims.len() as u64;
        self.open.clear();
        if !self.claims.is_empty() {
            self.test(search);
            self.failed += self.open.len();
            search.work.failed += self.open.len() as u64;
        }
        if self.claims.is_empty() || self.failed > SELF_FAILED * self.claims.len() {
            search.work.cuts += 1;
            self.begin(search.a, now);
        }
        self.repair(search);
        if self.claims.len() > SELF_CLAIMS * now.items.len().max(64) {
            self.clear();
        }
    }

    /// Starts the front again from the current vertices, and opens all pairs.
    fn begin(&mut self, tree: &Tree, now: ItemVertices<'_>) {
        self.clear();
        self.begun.extend(now.points);
        self.open.clear();
        let roots = (0..tree.len() as u32).map(|node| match tree.below(node) {
            Below::Children(c) => [c, c + 1],
            Below::Leaf(..) => [node; 2],
        });
        // The last pairs are taken first: the pairs near the leaves.
        self.open.extend(roots);
    }

    /// Removes the claims that do not hold and opens their pairs.
    fn test<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        let (unit, error) = (search.a.unit(), search.frame.error);
        let (drifts, open) = (&self.drifts, &mut self.open);
        self.claims.retain(|claim| {
            let holds = search.passes(claim.lower(drifts, unit, error));
            if !holds {
                open.push(claim.pair);
            }
            holds
        });
    }

    /// Checks every claim against the distance of its items, for debugging.
    pub(crate) fn audit(&self, unit: f64, error: f64, distance: impl Fn(NodePair) -> f64) -> Result<(), FrontFault> {
        for claim in &self.claims {
            let (claimed, gap) = (claim.lower(&self.drifts, unit, error), distance(claim.pair));
            if claimed > gap + error {
                let pair = claim.pair;
                return Err(FrontFault::Claim { pair, claimed, gap });
            }
        }
        Ok(())
    }

    fn repair<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        let mut open = core::mem::take(&mut self.open);
        let mut stack = core::mem::take(&mut self.stack);
        stack.clear();
        while !search.is_over() {
            let mut batch = [[0; 2]; 2 * AT_ONCE];
            let mut count = 0;
            while count < batch.len()
                && let Some(pair) = open.pop()
            {
                batch[count] = pair;
                count += 1;
            }
            if count == 0 {
                break;
            }
            search.settle_all(&batch[..count], &mut stack, Some(self));
            search.descend(&mut stack, Some(self));
        }
        // Nothing is known about the remaining pairs.
        for pair in open.drain(..).chain(stack.drain(..)) {
            self.claim(search.a, pair, f64::NEG_INFINITY);
        }
        (self.open, self.stack) = (open, stack);
    }

    /// Adds a claim of the current distance.
    fn claim(&mut self, tree: &Tree, pair: NodePair, distance: f64) {
        if distance == f64::INFINITY {
            // Two leaves without a pair of items that the query includes.
            return;
        }
        let (mut between, mut base) = ([0.0; 3], distance);
        if !self.drifts.is_empty() {
            between = self::between(&self.drifts, pair).each(|x| x as f32);
            base -= loss(&self.drifts, pair, between) * tree.unit();
        }
        self.claims.push(DistanceClaim { pair, base, between });
    }
}

impl DistanceClaim {
    /// Returns the distance that is proven now; `unit` is the unit of the tree.
    #[inline(always)]
    fn lower(&self, drifts: &[NodeDrift], unit: f64, error: f64) -> f64 {
        if drifts.is_empty() {
            return self.base;
        }
        // Drifts are in single precision, so the only rounding here is that of double precision.
        self.base - loss(drifts, self.pair, self.between) * unit - error
    }
}

impl ProofKeeper for SelfFront {
    fn keep<J: Judge>(&mut self, search: &TreeSearch<J>, pair: NodePair, proof: GapProof) {
        let distance = if proof.normal == [0.0; 3] {
            search.leaf_gap
        } else {
            f64::from(proof.gap) * search.frame.single.unit
        };
        self.claim(search.a, pair, distance);
    }
}

/// Returns the difference of the middles of two nodes.
#[inline(always)]
fn between(drifts: &[NodeDrift], [x, y]: NodePair) -> [f64; 3] {
    let (p, q) = (&drifts[x as usize].middle, &drifts[y as usize].middle);
    [0, 1, 2].each(|k| f64::from(p[k]) - f64::from(q[k]))
}

/// Returns an upper bound of the loss of distance since the middles had the difference `then`.
///
/// The spreads at that time are not included.
#[inline(always)]
fn loss(drifts: &[NodeDrift], pair: NodePair, then: [f32; 3]) -> f64 {
    let now = between(drifts, pair);
    let [x, y, z] = [0, 1, 2].each(|k| now[k] - f64::from(then[k]));
    let [p, q] = pair.each(|node| f64::from(drifts[node as usize].spread));
    sqrt(x * x + y * y + z * z) + p + q
}

impl NodeDrift {
    /// Returns a bound of the displacements of some vertices, in units of the tree.
    fn of_vertices<I: Iterator<Item = Vector3<f64>>>(all: impl Fn() -> I) -> Self {
        let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for way in all() {
            (low, high) = (low.smaller(way), high.larger(way));
        }
        let middle: [f32; 3] = ((low + high) * 0.5).map(|x| x as f32).into();
        let at = Vector3::from(middle.each(f64::from));
        let square = all().fold(0.0, |m: f64, way| m.larger((way - at).norm_squared()));
        let spread = up(sqrt(square)).next_up();
        Self { middle, spread }
    }

    /// Returns a bound of the displacements of two nodes.
    fn of_both(x: &Self, y: &Self) -> Self {
        let middle = [0, 1, 2].each(|k| 0.5 * (x.middle[k] + y.middle[k]));
        let reach = |of: &Self| {
            let [p, q, r] = [0, 1, 2].each(|k| f64::from(of.middle[k]) - f64::from(middle[k]));
            sqrt(p * p + q * q + r * r) + f64::from(of.spread)
        };
        let spread = up(reach(x).larger(reach(y))).next_up();
        Self { middle, spread }
    }
}
