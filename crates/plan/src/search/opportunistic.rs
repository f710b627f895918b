//! The search of the opportunistic planner.

use core::ops::ControlFlow;
use std::vec::Vec;

use crate::check::checker::Checker;
use crate::check::clearance::NearPair;
use crate::check::verdict::CheckWork;
use crate::error::PlanError;
use crate::motion::joint_motion::JointMotion;
use crate::motion::space::ConfigurationSpace;
use crate::random::Random;
use crate::search::ascent::{ClearConfiguration, Slice, dot};
use crate::search::freeway::CLOSED;
use crate::search::freeway::FreewayEnd;
use crate::search::options::PlanWork;
use crate::search::roadmap::{EdgeKind, Freeway, GOAL, Roadmap, START, apart};
use crate::search::shorten::Path;
use lin_canny::Progress;

/// Cosine beyond which gradients count as opposite.
const OPPOSITE: f64 = 0.25;

/// Fraction of the path to a contact that an extension leaves out.
const SHORT: f64 = 1.0 / 64.0;

/// Distance, in units of the clearance, within which a configuration counts as known.
const KNOWN: f64 = 1.0;

/// Maximum depth of slices within slices.
const DEPTH: usize = 1;

/// Number of random nodes of which the nearest starts an extension or is its link.
///
/// There is one extension per slice. Average times over 60 seeds of a plank of 0.2 through a hole:
///
/// | extensions per slice | hole of 0.6 | hole of 0.4 | hole of 0.3 |
/// |---:|---:|---:|---:|
/// | 16 | 0.20 s | 0.24 s | 0.53 s |
/// | 4 | 0.11 s | 0.17 s | 0.30 s |
/// | 1 | 0.08 s | 0.15 s | 0.20 s |
const FEW: usize = 64;

/// Maximum number of components to which straight segments from one node are tried.
const LINKS: usize = 4;

/// Maximum number of nodes of a component among which the nearest is searched.
///
/// With all nodes, this search took two thirds of the time at 40,000 nodes. Average times over 20
/// seeds of a plank of 0.2 through holes of 0.6, 0.4 and 0.3 were 0.30, 0.59 and 1.4 s with all
/// nodes, and 0.19, 0.31 and 0.64 s with this limit.
const MANY: usize = 1024;

/// Number of nodes of a freeway from which links are tried, less one.
const TRIES_A_FREEWAY: usize = 4;

/// State of a search, and of the opportunistic planner.
pub(crate) struct PathSearch<'a, C> {
    pub(crate) checker: &'a mut Checker<C>,
    pub(crate) roadmap: Roadmap,
    pub(crate) work: PlanWork,
    pub(crate) random: Random,
    /// A slice without fixed components.
    pub(crate) lengths: Slice,
    pub(crate) queries: u64,
    /// Number of slices through start and goal that are explored.
    pub(crate) explored: usize,
    pub(crate) before: CheckWork,
    pub(crate) progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl<C: ConfigurationSpace> PathSearch<'_, C> {
    /// Returns whether the planner may explore another slice, of at most so many random ones.
    pub(crate) fn has_slices(&self, slices: u64) -> bool {
        self.explored < self.first_slices() || self.work.slices < slices
    }

    /// Returns the number of slices through start and goal: one for each sweep coordinate.
    fn first_slices(&self) -> usize {
        2 * self.checker.space.bounds().len()
    }

    /// Explores the next slice: first those through start and goal, then random ones.
    ///
    /// Distances of warm trackers differ by rounding, so that a slice would depend on earlier queries.
    /// It begins with new trackers.
    pub(crate) fn next_slice(&mut self) -> Result<(), PlanError> {
        self.checker.reset();
        let first = self.first_slices();
        if self.explored < first {
            let (node, coordinate) = match self.explored.checked_sub(first / 2) {
                None => (START, self.explored),
                Some(coordinate) => (GOAL, coordinate),
            };
            self.explored += 1;
            let slice = self.lengths.clone();
            return self.explore(node, coordinate, &slice, 0);
        }
        self.work.slices += 1;
        self.random_slice()
    }

    pub(crate) fn is_solved(&self) -> bool {
        self.roadmap.joins(START, GOAL)
    }

    /// Returns whether there is a path, the budget of queries is spent, or the callback stops the
    /// search.
    pub(crate) fn is_over(&mut self) -> bool {
        let spent = self.checker.work.since(&self.before);
        let queries = spent.queries + spent.measures + spent.decisions + spent.hulls;
        if self.is_solved() || queries >= self.queries {
            return true;
        }
        let total = usize::try_from(self.queries).ok().filter(|&most| most < usize::MAX);
        (self.progress)(Progress::new("queries", queries as usize, total)).is_break()
    }

    /// Returns the shortest path of a roadmap from start to goal.
    pub(crate) fn path(&self, roadmap: &Roadmap) -> Option<Path> {
        let space = &self.checker.space;
        let way = roadmap.way(START, GOAL, |a, b| space.distance(a, b))?;
        Some(way.into_iter().map(|k| roadmap.nodes[k].clone()).collect())
    }

    /// Starts a slice between two obstacles if an extension finds such a configuration, otherwise at a
    /// random configuration.
    fn random_slice(&mut self) -> Result<(), PlanError> {
        let outer = self.lengths.clone();
        if let Some((node, coordinate)) = self.extension()? {
            return self.explore(node, coordinate, &outer, 0);
        }
        if self.is_solved() {
            return Ok(());
        }
        let coordinate = self.random.below(self.checker.space.bounds().len());
        let mut slice = outer.clone();
        slice.fixed[coordinate] = true;
        match self.uniform(&slice)? {
            Some(node) if !self.is_solved() => self.explore(node, coordinate, &outer, 0),
            _ => Ok(()),
        }
    }

    /// Ascends within a slice from a uniform random configuration, in contact or not.
    fn uniform(&mut self, slice: &Slice) -> Result<Option<usize>, PlanError> {
        let random = &mut self.random;
        let sample = self.checker.space.sample(&mut || random.uniform());
        let mut passed = self.checker.ascend(sample, slice)?;
        let margin = self.checker.cell.margin();
        passed.retain(|place| place.distance > margin);
        let mut places = passed.into_iter();
        let Some(first) = places.next() else {
            return Ok(None);
        };
        let node = self.roadmap.add(first.q);
        let last = self.chain(node, &places.collect::<Vec<_>>(), EdgeKind::Ascent)?;
        self.link(&[node, last])?;
        Ok(Some(last))
    }

    /// Moves from a close node straight towards a uniform random configuration, as far as the
    /// motion is proven free.
    ///
    /// Adds the configuration reached and tries to link it to another component. If it is between
    /// obstacles on opposite sides, where channels split and join, returns its node and the sweep
    /// coordinate along the channel.
    fn extension(&mut self) -> Result<Option<(usize, usize)>, PlanError> {
        let random = &mut self.random;
        let goal = self.checker.space.sample(&mut || random.uniform());
        let Some(node) = self.near_one(&goal, None) else {
            return Ok(None);
        };
        let from = self.roadmap.nodes[node].clone();
        let safe = self.checker.certify(&JointMotion::segment(&from, &goal))?.free_until();
        let part = if safe < 1.0 { safe * (1.0 - SHORT) } else { 1.0 };
        let reached = self.checker.space.between(&from, &goal, part);
        let is_short = self.checker.space.distance(&from, &reached) < 16.0 * self.lengths.shortest;
        if is_short || !self.checker.is_segment_free(&from, &reached)? {
            return Ok(None);
        }
        let next = self.roadmap.add(reached.clone());
        self.roadmap.join(node, next, EdgeKind::Link);
        if let Some(other) = self.near_one(&reached, Some(next)) {
            self.tried(next, other)?;
        }
        if safe >= 1.0 || self.is_solved() {
            return Ok(None);
        }
        let near = self.checker.nearest(&reached, self.lengths.clearance_cap)?;
        Ok(self.channel(&near).map(|coordinate| (next, coordinate)))
    }

    /// Returns the sweep coordinate that changes the distances of two opposite pairs least.
    ///
    /// Two pairs are opposite if a step away from one is a step towards the other. Returns `None`
    /// if no two pairs are opposite.
    fn channel(&self, near: &[NearPair]) -> Option<usize> {
        let norm = |g: &[f64]| f64::sqrt(dot(g, g));
        let scales = self.checker.space.scales();
        let slopes: Vec<Vec<f64>> = near.iter().map(|near| near.scaled_gradient(scales)).collect();
        let opposite = slopes.iter().enumerate().find_map(|(k, x)| {
            let is_opposite = |y: &&Vec<f64>| dot(x, y) < -OPPOSITE * norm(x) * norm(y);
            slopes[..k].iter().find(is_opposite).map(|y| (x, y))
        });
        let (x, y) = opposite?;
        let change = |k: &usize| x[*k].abs() + y[*k].abs();
        (0..self.checker.space.bounds().len()).min_by(|i, j| change(i).total_cmp(&change(j)))
    }

    /// Climbs from a node to the freeway of its slice, follows it in both directions, and links the
    /// new nodes to the rest. Does the same within the slices of its ends, with one dimension less.
    fn explore(&mut self, node: usize, coordinate: usize, outer: &Slice, depth: usize) -> Result<(), PlanError> {
        let mut slice = outer.clone();
        slice.fixed[coordinate] = true;
        let mut passed = self.checker.ascend(self.roadmap.nodes[node].clone(), &slice)?;
        let Some(top) = passed.last().cloned() else {
            return Ok(());
        };
        if self.is_known(&top, depth) {
            return Ok(());
        }
        let foot = self.chain(node, &passed.split_off(1), EdgeKind::Ascent)?;
        if self.roadmap.nodes[foot] != top.q {
            return Ok(());
        }
        let least = self.checker.cell.margin() + CLOSED * slice.shortest;
        for (tip, end) in self.follow((foot, &top), coordinate, &slice, depth)? {
            // If a channel has closed, its slice contains nothing of it.
            let q = self.roadmap.nodes[tip].clone();
            let is_open = |distance: f64| distance > least && distance < f64::INFINITY;
            if end != FreewayEnd::Bound && is_open(self.checker.place(q, 0.0)?.distance) {
                self.bridge(tip, &slice, depth)?;
            }
        }
        Ok(())
    }

    /// Follows the freeway through a node in both directions and links the new nodes to the rest.
    /// Returns the nodes at its ends.
    fn follow(
        &mut self,
        (foot, top): (usize, &ClearConfiguration),
        coordinate: usize,
        slice: &Slice,
        depth: usize,
    ) -> Result<[(usize, FreewayEnd); 2], PlanError> {
        let (down, lower) = self.checker.trace(top, coordinate, -1.0, slice)?;
        let (up, upper) = self.checker.trace(top, coordinate, 1.0, slice)?;
        let (kind, count) = match depth {
            0 => (EdgeKind::Freeway, &mut self.work.freeways),
            _ => (EdgeKind::Bridge, &mut self.work.bridges),
        };
        *count += 1;
        let mut nodes = self.strung(foot, down, kind);
        nodes.reverse();
        nodes.push(foot);
        nodes.extend(self.strung(foot, up, kind));
        self.link(&spaced(&nodes))?;
        let tips = [(nodes[0], lower), (nodes[nodes.len() - 1], upper)];
        let ends = [lower, upper];
        self.roadmap.freeways.push(Freeway {
            coordinate,
            depth,
            nodes,
            ends,
        });
        Ok(tips)
    }

    /// Explores the slice at an end of a freeway, swept along another coordinate.
    fn bridge(&mut self, node: usize, slice: &Slice, depth: usize) -> Result<(), PlanError> {
        let bounds = self.checker.space.bounds().len();
        let open: Vec<usize> = (0..bounds).filter(|&k| !slice.fixed[k]).collect();
        if depth >= DEPTH || open.is_empty() || self.is_over() {
            return Ok(());
        }
        let coordinate = open[self.random.below(open.len())];
        self.explore(node, coordinate, slice, depth + 1)
    }

    /// Returns whether a configuration is within its clearance of a node of a freeway of this
    /// depth, so that exploring it finds nothing new.
    fn is_known(&self, top: &ClearConfiguration, depth: usize) -> bool {
        let (roadmap, space) = (&self.roadmap, &self.checker.space);
        let near = KNOWN * top.distance;
        let freeways = roadmap.freeways.iter().filter(|f| f.depth == depth);
        let freeways = freeways.flat_map(|f| &f.nodes);
        let mut close = freeways
            .map(|&k| &roadmap.nodes[k])
            .filter(|q| apart(space, &top.q, q) < near);
        close.any(|q| space.distance(&top.q, q) < near)
    }
}

/// Edges of the roadmap: steps of traces, ascents, and straight segments between components.
impl<C: ConfigurationSpace> PathSearch<'_, C> {
    /// Adds the configurations of a trace after a node. Every step was proven free during the
    /// trace.
    fn strung(&mut self, node: usize, places: Vec<ClearConfiguration>, kind: EdgeKind) -> Vec<usize> {
        let mut last = node;
        let each = places.into_iter().map(|place| {
            let next = self.roadmap.add(place.q);
            self.roadmap.join(last, next, kind);
            last = next;
            next
        });
        each.collect()
    }

    /// Joins a node to the last of some configurations, and returns the node reached.
    ///
    /// Tries the straight segment first, then the segments from one configuration to the next, as
    /// long as they are proven free.
    fn chain(&mut self, node: usize, places: &[ClearConfiguration], kind: EdgeKind) -> Result<usize, PlanError> {
        let Some(last) = places.last() else {
            return Ok(node);
        };
        let from = self.roadmap.nodes[node].clone();
        if self.checker.is_segment_free(&from, &last.q)? {
            let next = self.roadmap.add(last.q.clone());
            self.roadmap.join(node, next, kind);
            return Ok(next);
        }
        let (mut at, mut here) = (node, from);
        for place in places {
            if !self.checker.is_segment_free(&here, &place.q)? {
                break;
            }
            let next = self.roadmap.add(place.q.clone());
            self.roadmap.join(at, next, kind);
            (at, here) = (next, place.q.clone());
        }
        Ok(at)
    }

    /// Returns the nearest of a few random nodes, outside the component of `apart_from` if given.
    fn near_one(&mut self, q: &[f64], apart_from: Option<usize>) -> Option<usize> {
        let own = apart_from.map(|node| self.roadmap.component(node));
        let mut best = (f64::INFINITY, None);
        for _ in 0..FEW {
            let node = self.random.below(self.roadmap.nodes.len());
            let other = &self.roadmap.nodes[node];
            if own.is_some_and(|own| self.roadmap.component(node) == own)
                || apart(&self.checker.space, q, other) >= best.0
            {
                continue;
            }
            let far = self.checker.space.distance(q, other);
            if far < best.0 {
                best = (far, Some(node));
            }
        }
        best.1
    }

    /// Tries straight segments from nodes to the nearest nodes of other components.
    fn link(&mut self, nodes: &[usize]) -> Result<(), PlanError> {
        for &node in nodes {
            for other in self.strangers(node) {
                let is_joined = self.roadmap.component(other) == self.roadmap.component(node);
                if !is_joined && self.tried(node, other)? && self.is_solved() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Returns the nearest node of each of the nearest other components. Of a large component, only
    /// [`MANY`] random nodes are considered.
    fn strangers(&mut self, node: usize) -> Vec<usize> {
        let Self {
            roadmap,
            random,
            checker,
            ..
        } = self;
        let space = &checker.space;
        let q = &roadmap.nodes[node];
        let own = roadmap.component(node);
        let mut nearest: Vec<(f64, usize)> = Vec::new();
        for (_, members) in roadmap.components().filter(|(number, _)| *number != own) {
            let is_small = members.len() <= MANY;
            let mut best = (f64::INFINITY, node);
            for k in 0..members.len().min(MANY) {
                let other = members[if is_small { k } else { random.below(members.len()) }];
                if apart(space, q, &roadmap.nodes[other]) < best.0 {
                    let far = space.distance(q, &roadmap.nodes[other]);
                    best = if far < best.0 { (far, other) } else { best };
                }
            }
            nearest.push(best);
        }
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        nearest.into_iter().take(LINKS).map(|(_, other)| other).collect()
    }

    /// Tries the straight segment between two nodes.
    pub(crate) fn tried(&mut self, a: usize, b: usize) -> Result<bool, PlanError> {
        self.work.links[0] += 1;
        let is_free = self
            .checker
            .is_segment_free(&self.roadmap.nodes[a], &self.roadmap.nodes[b])?;
        if is_free {
            self.work.links[1] += 1;
            self.roadmap.join(a, b, EdgeKind::Link);
        }
        Ok(is_free)
    }
}

/// Returns a few nodes of a freeway, including both ends.
fn spaced(nodes: &[usize]) -> Vec<usize> {
    let last = nodes.len() - 1;
    let mut some: Vec<usize> = (0..=TRIES_A_FREEWAY)
        .map(|k| nodes[k * last / TRIES_A_FREEWAY])
        .collect();
    some.dedup();
    some
}
