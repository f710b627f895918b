//! The search of the opportunistic planner.

use std::vec::Vec;

use lin_canny::Progress;

use crate::ascent::{ClearConfiguration, Slice, dot};
use crate::clearance::NearPair;
use crate::error::PlanError;
use crate::freeway::CLOSED;
use crate::freeway::FreewayEnd;
use crate::links::{apart, spaced};
use crate::path::Path;
use crate::planner::PathSearch;
use crate::roadmap::{EdgeKind, Freeway, Roadmap};
use crate::space::ConfigurationSpace;

/// Cosine beyond which gradients count as opposite. Not measured.
const OPPOSITE: f64 = 0.25;

/// Fraction of the path to a contact that a feeler leaves out. Not measured.
const SHORT: f64 = 1.0 / 64.0;

/// Distance, in units of the clearance, within which a configuration counts as known. Not measured.
const KNOWN: f64 = 1.0;

/// Maximum depth of slices within slices. Not measured.
const DEPTH: usize = 1;

/// Indices of start and goal in every roadmap.
pub(crate) const START: usize = 0;
pub(crate) const GOAL: usize = 1;

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
        self.checker.forget();
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

    /// Starts a slice between two obstacles if a feeler finds such a configuration, otherwise at a
    /// random configuration.
    fn random_slice(&mut self) -> Result<(), PlanError> {
        let outer = self.lengths.clone();
        if let Some((node, coordinate)) = self.feeler()? {
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
        let margin = self.checker.margin();
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
    fn feeler(&mut self) -> Result<Option<(usize, usize)>, PlanError> {
        let random = &mut self.random;
        let goal = self.checker.space.sample(&mut || random.uniform());
        let Some(node) = self.near_one(&goal, None) else {
            return Ok(None);
        };
        let from = self.roadmap.nodes[node].clone();
        let safe = self.checker.certify(&from, &goal)?.safe();
        let part = if safe < 1.0 { safe * (1.0 - SHORT) } else { 1.0 };
        let reached = self.checker.space.between(&from, &goal, part);
        let is_short = self.checker.space.distance(&from, &reached) < 16.0 * self.lengths.shortest;
        if is_short || !self.checker.is_free(&from, &reached)? {
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
        let least = self.checker.margin() + CLOSED * slice.shortest;
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
