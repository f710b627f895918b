//! RRT-Connect: two trees of segments proven free, from start and goal (Kuffner and LaValle 2000).
//!
//! 1. Draw a random configuration. The nearest node of one tree takes a step towards it.
//! 2. From the new node, the tree goes on towards the nearest node of the other tree, step by step,
//!    until a step is blocked. If it arrives, the trees are joined.
//! 3. The smaller tree is next, so that both trees grow alike.
//!
//! Departures:
//!
//! 1. A step is proven free over its whole length, in the direction of travel, instead of sampled.
//!    The cheap predicate of its new end comes first.
//! 2. A node whose step was blocked is passed over for samples farther than [`REACH`] steps,
//!    because most of them lead into the same obstacle (dynamic domain: Yershova, Jaillet, Simeon
//!    and LaValle 2005). After [`PASSED`] samples in a row, the next is taken in any case: with
//!    many coordinates, nearly all samples are far from every node.
//! 3. In a large tree, the nearest of [`MANY`] random nodes replaces the nearest node.

use std::vec::Vec;

use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::space::ConfigurationSpace;
use crate::random::Random;
use crate::search::options::PlanWork;
use crate::search::roadmap::{EdgeKind, GOAL, Roadmap, START, apart};

/// Length of a step, as a fraction of the largest extent of the bounds.
///
/// On 700 problems of Panda the median and the mean time are 0.97 and 1.9 ms with a tenth, 1.24 and
/// 2.3 with a fourteenth, and 1.14 and 4.3 with a sixth.
const STEP: f64 = 1.0 / 10.0;

/// Steps within which a node takes samples after a step of it was blocked.
const REACH: f64 = 4.0;

/// Maximum number of samples in a row that are passed over.
const PASSED: u32 = 32;

/// Maximum number of nodes of a tree among which the nearest is searched.
const MANY: usize = 512;

/// Maximum number of steps from a new node to the other tree.
const STEPS: f64 = 1024.0;

/// The two trees, whose nodes are in one roadmap.
pub(crate) struct TreeSearch {
    pub(crate) roadmap: Roadmap,
    /// The trees of the start and of the goal.
    trees: [Tree; 2],
    /// The tree that grew last.
    last: usize,
    random: Random,
    step: f64,
    /// Number of samples that were passed over since one was taken.
    passed: u32,
}

/// A tree: nodes of the roadmap, with the distance of samples that each takes.
struct Tree {
    nodes: Vec<usize>,
    reach: Vec<f64>,
}

impl Tree {
    fn of(root: usize) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            reach: Vec::new(),
        };
        tree.push(root);
        tree
    }

    fn push(&mut self, node: usize) {
        self.nodes.push(node);
        self.reach.push(f64::INFINITY);
    }
}

impl TreeSearch {
    /// Returns the trees of start and goal alone; `extent` is the largest extent of the bounds.
    pub(crate) fn new(start: &[f64], goal: &[f64], seed: u64, extent: f64) -> Self {
        Self {
            roadmap: Roadmap::new(start, goal),
            trees: [START, GOAL].map(Tree::of),
            last: GOAL,
            random: Random::new(seed),
            step: STEP * extent,
            passed: 0,
        }
    }

    pub(crate) fn is_solved(&self) -> bool {
        self.roadmap.joins(START, GOAL)
    }

    /// Draws a sample, extends a tree towards it, and then towards the other tree.
    pub(crate) fn grow<C: ConfigurationSpace>(
        &mut self,
        checker: &mut Checker<C>,
        work: &mut PlanWork,
    ) -> Result<(), PlanError> {
        work.samples += 1;
        let side = self.next_tree();
        let random = &mut self.random;
        let sample = checker.space.sample(&mut || random.uniform());
        let (entry, far) = self.nearest(checker, side, &sample);
        if far > self.trees[side].reach[entry] && self.passed < PASSED {
            self.passed += 1;
            return Ok(());
        }
        self.passed = 0;
        let parent = self.trees[side].nodes[entry];
        let new = match far > self.step {
            true => checker
                .space
                .between(&self.roadmap.nodes[parent], &sample, self.step / far),
            false => sample,
        };
        let Some(new) = self.extended(checker, work, side, parent, new)? else {
            self.trees[side].reach[entry] = REACH * self.step;
            return Ok(());
        };
        self.connect(checker, work, side, new)
    }

    /// Goes from a new node of a tree towards the other tree until a step is blocked.
    fn connect<C: ConfigurationSpace>(
        &mut self,
        checker: &mut Checker<C>,
        work: &mut PlanWork,
        side: usize,
        new: usize,
    ) -> Result<(), PlanError> {
        let from = self.roadmap.nodes[new].clone();
        let (entry, far) = self.nearest(checker, 1 - side, &from);
        let other = self.trees[1 - side].nodes[entry];
        let to = self.roadmap.nodes[other].clone();
        let steps = (far / self.step).at_most(STEPS) as usize + 1;
        let mut last = new;
        for k in 1..steps {
            let next = checker.space.between(&from, &to, k as f64 / steps as f64);
            match self.extended(checker, work, side, last, next)? {
                Some(next) => last = next,
                None => return Ok(()),
            }
        }
        if self.is_free(checker, work, side, last, &to)? {
            self.roadmap.join(last, other, EdgeKind::Tree);
        }
        Ok(())
    }

    /// Adds a configuration to a tree if the segment from a node to it is proven free.
    fn extended<C: ConfigurationSpace>(
        &mut self,
        checker: &mut Checker<C>,
        work: &mut PlanWork,
        side: usize,
        node: usize,
        new: Vec<f64>,
    ) -> Result<Option<usize>, PlanError> {
        if !checker.is_free_at(&new)? || !self.is_free(checker, work, side, node, &new)? {
            return Ok(None);
        }
        let next = self.roadmap.add(new);
        self.roadmap.join(node, next, EdgeKind::Tree);
        self.trees[side].push(next);
        Ok(Some(next))
    }

    /// Returns whether the segment between a node and a free configuration is proven free, in the
    /// direction of travel: away from the start, or towards the goal.
    fn is_free<C: ConfigurationSpace>(
        &self,
        checker: &mut Checker<C>,
        work: &mut PlanWork,
        side: usize,
        node: usize,
        q: &[f64],
    ) -> Result<bool, PlanError> {
        let node = &self.roadmap.nodes[node][..];
        let [from, to] = if side == START { [node, q] } else { [q, node] };
        let is_free = checker.is_free_inside(from, to)?;
        work.extensions[0] += 1;
        work.extensions[1] += u64::from(is_free);
        Ok(is_free)
    }

    /// Returns the tree to grow: the other one, unless the one that grew last is at most half as
    /// large.
    fn next_tree(&mut self) -> usize {
        let [own, other] = [self.last, 1 - self.last].map(|side| self.trees[side].nodes.len());
        if 2 * own > other {
            self.last = 1 - self.last;
        }
        self.last
    }

    /// Returns the entry of the node of a tree nearest to a configuration, and its distance.
    fn nearest<C: ConfigurationSpace>(&mut self, checker: &Checker<C>, side: usize, q: &[f64]) -> (usize, f64) {
        let nodes = &self.trees[side].nodes;
        let mut best = (0, f64::INFINITY);
        for k in 0..nodes.len().min(MANY) {
            let entry = if nodes.len() > MANY {
                self.random.below(nodes.len())
            } else {
                k
            };
            let other = &self.roadmap.nodes[nodes[entry]];
            if apart(&checker.space, q, other) >= best.1 {
                continue;
            }
            let far = checker.space.distance(q, other);
            if far < best.1 {
                best = (entry, far);
            }
        }
        best
    }
}
