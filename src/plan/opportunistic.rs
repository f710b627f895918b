//! The opportunistic global path planner of Canny and Lin.

use alloc::string::ToString;
use alloc::vec::Vec;

use super::ascent::{Place, Slice, dot};
use super::checker::{CheckWork, Checker};
use super::clearance::Near;
use super::error::PlanError;
use super::freeway::FreewayEnd;
use super::path::Path;
use super::random::Random;
use super::roadmap::{EdgeKind, Freeway, Roadmap};
use super::space::ConfigurationSpace;
use crate::tuning::plan::{
    CLOSED, DEPTH, FEELERS, FEW, KNOWN, LINKS, LONGEST, OPPOSITE, SHORT, SHORTEST, TRIES_A_FREEWAY,
};

/// The budget of a search, and its seed.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOptions {
    /// The seed of the random slices: the same seed gives the same answer.
    pub seed: u64,
    /// Random slices, at most.
    pub slices: u64,
    /// Distance queries, at most; looked at between freeways.
    pub queries: u64,
    /// The clearance beyond which no configuration is better: ascents end there. `None` for an
    /// eighth of the largest extent of the bounds.
    pub enough: Option<f64>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            slices: 10_000,
            queries: u64::MAX,
            enough: None,
        }
    }
}

/// The work of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlanWork {
    /// Random slices.
    pub slices: u64,
    /// Freeways traced, those in slices not counted.
    pub freeways: u64,
    /// Freeways traced within slices: bridges.
    pub bridges: u64,
    /// Straight segments tried between parts of the roadmap, and those proven free.
    pub links: [u64; 2],
    /// The work of the checker.
    pub checks: CheckWork,
}

/// The answer of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The path from start to goal, every segment proven free; `None` if the budget ended first.
    /// No answer says that there is no path.
    pub path: Option<Path>,
    /// What was found.
    pub roadmap: Roadmap,
    /// The work done.
    pub work: PlanWork,
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Searches a path from one configuration to another: see the [module](super).
    ///
    /// # Errors
    /// A configuration that is not of the space or not clear of contact by the margin, or options
    /// out of range.
    pub fn plan(&mut self, start: &[f64], goal: &[f64], options: &PlanOptions) -> Result<Plan, PlanError> {
        self.plan_until(start, goal, options, &mut || false)
    }

    /// Searches a path until `stop` returns true, which is asked between freeways: for limits of
    /// time.
    ///
    /// # Errors
    /// As [`plan`](Self::plan).
    pub fn plan_until(
        &mut self,
        start: &[f64],
        goal: &[f64],
        options: &PlanOptions,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<Plan, PlanError> {
        for (q, end) in [(start, "start"), (goal, "goal")] {
            if let Some(near) = self.clearance(q)?.filter(|near| !(near.lower > self.margin())) {
                let (a, b) = (self.name(near.pair.a).to_string(), self.name(near.pair.b).to_string());
                return Err(PlanError::Contact { end, a, b });
            }
        }
        let lengths = self.lengths(options)?;
        let before = self.work;
        let mut search = Search {
            checker: self,
            roadmap: Roadmap::default(),
            work: PlanWork::default(),
            random: Random::new(options.seed),
            lengths,
            queries: options.queries,
            before,
            stop,
        };
        search.run(start, goal, options.slices)?;
        let path = search.path();
        let (roadmap, mut work) = (search.roadmap, search.work);
        work.checks = self.work.since(&before);
        Ok(Plan { path, roadmap, work })
    }

    /// Lengths of steps, from the extent of the bounds.
    fn lengths(&self, options: &PlanOptions) -> Result<Slice, PlanError> {
        let bounds = self.space.bounds().iter().zip(self.space.scales());
        let extents = bounds.map(|([low, high], scale)| (high - low) * scale);
        let extent = extents.fold(0.0, f64::max);
        if !(extent > 0.0) {
            let what = "extent of the bounds";
            return Err(PlanError::Value { what, value: extent });
        }
        let enough = options.enough.unwrap_or(0.125 * extent);
        if !(enough > 0.0) {
            let what = "clearance that is enough";
            return Err(PlanError::Value { what, value: enough });
        }
        Ok(Slice {
            fixed: alloc::vec![false; self.space.freedom()],
            longest: LONGEST * extent,
            shortest: SHORTEST * extent,
            enough: enough + self.margin(),
        })
    }
}

impl CheckWork {
    fn since(&self, before: &Self) -> Self {
        Self {
            segments: self.segments - before.segments,
            free: self.free - before.free,
            pairs: self.pairs - before.pairs,
            queries: self.queries - before.queries,
            configurations: self.configurations - before.configurations,
            measures: self.measures - before.measures,
        }
    }
}

/// A search in the making.
struct Search<'a, C> {
    checker: &'a mut Checker<C>,
    roadmap: Roadmap,
    work: PlanWork,
    random: Random,
    /// No component fixed.
    lengths: Slice,
    queries: u64,
    before: CheckWork,
    stop: &'a mut dyn FnMut() -> bool,
}

const START: usize = 0;
const GOAL: usize = 1;

impl<C: ConfigurationSpace> Search<'_, C> {
    fn run(&mut self, start: &[f64], goal: &[f64], slices: u64) -> Result<(), PlanError> {
        self.roadmap.add(start.into());
        self.roadmap.add(goal.into());
        if self.tried(START, GOAL)? {
            return Ok(());
        }
        for node in [START, GOAL] {
            for coordinate in 0..self.checker.space.bounds().len() {
                let slice = self.lengths.clone();
                self.explore(node, coordinate, &slice, 0)?;
                if self.is_over() {
                    return Ok(());
                }
            }
        }
        while self.work.slices < slices && !self.is_over() {
            self.work.slices += 1;
            self.random_slice()?;
        }
        Ok(())
    }

    fn is_solved(&self) -> bool {
        self.roadmap.component(START) == self.roadmap.component(GOAL)
    }

    fn is_over(&mut self) -> bool {
        let spent = self.checker.work.since(&self.before);
        self.is_solved() || spent.queries + spent.measures >= self.queries || (self.stop)()
    }

    fn path(&self) -> Option<Path> {
        let space = &self.checker.space;
        let way = self.roadmap.way(START, GOAL, |a, b| space.distance(a, b))?;
        Some(way.into_iter().map(|k| self.roadmap.nodes[k].clone()).collect())
    }

    /// Begins a slice between two obstacles that a few feelers find, else at a random
    /// configuration.
    fn random_slice(&mut self) -> Result<(), PlanError> {
        for _ in 0..FEELERS {
            if let Some((node, coordinate)) = self.feeler()? {
                let outer = self.lengths.clone();
                return self.explore(node, coordinate, &outer, 0);
            }
            if self.is_solved() {
                return Ok(());
            }
        }
        let coordinate = self.random.below(self.checker.space.bounds().len());
        let mut slice = self.lengths.clone();
        slice.fixed[coordinate] = true;
        match self.uniform(&slice)? {
            Some(node) if !self.is_solved() => {
                let outer = self.lengths.clone();
                self.explore(node, coordinate, &outer, 0)
            }
            _ => Ok(()),
        }
    }

    /// Ascends within a slice from a configuration that is uniform, in contact or not.
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

    /// Goes from a near node straight towards a uniform configuration as far as the way is proven
    /// free, adds the place reached, and tries to link the place to another component. Returns the
    /// place, and the sweep coordinate along the channel, if the place lies between obstacles on
    /// opposite sides: where channels split and join.
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
        let near = self.checker.nearest(&reached, self.lengths.enough)?;
        Ok(self.channel(&near).map(|coordinate| (next, coordinate)))
    }

    /// The nearest to a configuration of a few random nodes, of those of other components than a
    /// node's if one is given.
    fn near_one(&mut self, q: &[f64], apart_from: Option<usize>) -> Option<usize> {
        let own = apart_from.map(|node| self.roadmap.component(node));
        let mut best = (f64::INFINITY, None);
        for _ in 0..FEW {
            let node = self.random.below(self.roadmap.nodes.len());
            let other = &self.roadmap.nodes[node];
            if own.is_some_and(|own| self.roadmap.component(node) == own) || self.apart(q, other) >= best.0 {
                continue;
            }
            let far = self.checker.space.distance(q, other);
            if far < best.0 {
                best = (far, Some(node));
            }
        }
        best.1
    }

    /// Returns the sweep coordinate that changes the distances of two opposite pairs least; `None`
    /// if no two pairs are opposite: a step away from one is a step towards the other.
    fn channel(&self, near: &[Near]) -> Option<usize> {
        let norm = |g: &[f64]| crate::num::scalar::sqrt(dot(g, g));
        let opposite = near.iter().enumerate().find_map(|(k, x)| {
            let is_opposite =
                |y: &&Near| dot(&x.gradient, &y.gradient) < -OPPOSITE * norm(&x.gradient) * norm(&y.gradient);
            near[..k].iter().find(is_opposite).map(|y| (x, y))
        });
        let (x, y) = opposite?;
        let change = |k: &usize| x.gradient[*k].abs() + y.gradient[*k].abs();
        (0..self.checker.space.bounds().len()).min_by(|i, j| change(i).total_cmp(&change(j)))
    }

    /// Climbs from a node to the freeway of its slice, follows it both ways, links what is new to
    /// the rest, and does the same within the slices of its ends, with one dimension less.
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
        let foot = self.chain(node, &passed.split_off(1.min(passed.len())), EdgeKind::Ascent)?;
        if self.roadmap.nodes[foot] != top.q {
            return Ok(());
        }
        let (down, lower) = self.checker.trace(&top, coordinate, -1.0, &slice)?;
        let (up, upper) = self.checker.trace(&top, coordinate, 1.0, &slice)?;
        let kind = if depth == 0 {
            EdgeKind::Freeway
        } else {
            EdgeKind::Bridge
        };
        let mut nodes = self.strung(foot, down, kind);
        nodes.reverse();
        nodes.push(foot);
        nodes.extend(self.strung(foot, up, kind));
        *if depth == 0 {
            &mut self.work.freeways
        } else {
            &mut self.work.bridges
        } += 1;
        let tips = [nodes[0], nodes[nodes.len() - 1]];
        let least = self.checker.margin() + CLOSED * slice.shortest;
        self.link(&spaced(&nodes))?;
        self.roadmap.freeways.push(Freeway {
            coordinate,
            depth,
            nodes,
            ends: [lower, upper],
        });
        for (tip, end) in tips.into_iter().zip([lower, upper]) {
            // Where a channel has closed altogether, its slice holds nothing about it.
            let is_open = |near: Near| near.distance > least;
            let q = &self.roadmap.nodes[tip];
            if end != FreewayEnd::Bound && self.checker.clearance(q)?.is_some_and(is_open) {
                self.bridge(tip, &slice, depth)?;
            }
        }
        Ok(())
    }

    /// Explores the slice of an end of a freeway, swept along another coordinate.
    fn bridge(&mut self, node: usize, slice: &Slice, depth: usize) -> Result<(), PlanError> {
        let bounds = self.checker.space.bounds().len();
        let open: Vec<usize> = (0..bounds).filter(|&k| !slice.fixed[k]).collect();
        if depth >= DEPTH || open.is_empty() || self.is_over() {
            return Ok(());
        }
        let coordinate = open[self.random.below(open.len())];
        self.explore(node, coordinate, slice, depth + 1)
    }

    /// Adds the places of a trace behind a node; every step was proven free when it was traced.
    fn strung(&mut self, node: usize, places: Vec<Place>, kind: EdgeKind) -> Vec<usize> {
        let mut last = node;
        let each = places.into_iter().map(|place| {
            let next = self.roadmap.add(place.q);
            self.roadmap.join(last, next, kind);
            last = next;
            next
        });
        each.collect()
    }

    /// Joins a node with the last of some places: straight, else from place to place as far as
    /// segments are proven free. Returns the node reached.
    fn chain(&mut self, node: usize, places: &[Place], kind: EdgeKind) -> Result<usize, PlanError> {
        let Some(last) = places.last() else {
            return Ok(node);
        };
        let from = self.roadmap.nodes[node].clone();
        if self.checker.is_free(&from, &last.q)? {
            let next = self.roadmap.add(last.q.clone());
            self.roadmap.join(node, next, kind);
            return Ok(next);
        }
        let (mut at, mut here) = (node, from);
        for place in places {
            if !self.checker.is_free(&here, &place.q)? {
                break;
            }
            let next = self.roadmap.add(place.q.clone());
            self.roadmap.join(at, next, kind);
            (at, here) = (next, place.q.clone());
        }
        Ok(at)
    }

    /// Returns whether a place lies so near a place of a freeway, or for a place in a slice of a
    /// bridge, that the ball of its clearance holds nothing new.
    fn is_known(&self, top: &Place, depth: usize) -> bool {
        let (roadmap, space) = (&self.roadmap, &self.checker.space);
        let near = KNOWN * top.distance;
        let freeways = roadmap.freeways.iter().filter(|f| f.depth == depth);
        let freeways = freeways.flat_map(|f| &f.nodes);
        let mut close = freeways
            .map(|&k| &roadmap.nodes[k])
            .filter(|q| self.apart(&top.q, q) < near);
        close.any(|q| space.distance(&top.q, q) < near)
    }

    /// Lower bound of the distance of two configurations, by their sweep coordinates alone.
    fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let space = &self.checker.space;
        let each = a.iter().zip(b).zip(space.scales()).take(space.bounds().len());
        each.map(|((x, y), s)| ((x - y) * s).abs()).fold(0.0, f64::max)
    }

    /// Tries straight segments from some nodes to the nearest nodes of other components.
    fn link(&mut self, nodes: &[usize]) -> Result<(), PlanError> {
        for &node in nodes {
            for (_, _, other) in self.strangers(node) {
                let is_joined = self.roadmap.component(other) == self.roadmap.component(node);
                if !is_joined && self.tried(node, other)? && self.is_solved() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The nearest node of each of the nearest other components: distance, component, node.
    fn strangers(&self, node: usize) -> Vec<(f64, usize, usize)> {
        let (roadmap, space) = (&self.roadmap, &self.checker.space);
        let components = roadmap.components();
        let q = &roadmap.nodes[node];
        let mut best: Vec<(f64, usize, usize)> = Vec::new();
        for (k, other) in roadmap.nodes.iter().enumerate() {
            let component = components[k];
            let of_component = best.iter().position(|b| b.1 == component);
            let farthest = match of_component {
                Some(at) => best[at].0,
                None if best.len() < LINKS => f64::INFINITY,
                None => best[LINKS - 1].0,
            };
            if component == components[node] || self.apart(q, other) >= farthest {
                continue;
            }
            let far = space.distance(q, other);
            if far < farthest {
                if let Some(at) = of_component {
                    best.remove(at);
                }
                let at = best.partition_point(|b| b.0 <= far);
                best.insert(at, (far, component, k));
                best.truncate(LINKS);
            }
        }
        best
    }

    /// Tries the straight segment between two nodes.
    fn tried(&mut self, a: usize, b: usize) -> Result<bool, PlanError> {
        self.work.links[0] += 1;
        let is_free = self.checker.is_free(&self.roadmap.nodes[a], &self.roadmap.nodes[b])?;
        if is_free {
            self.work.links[1] += 1;
            self.roadmap.join(a, b, EdgeKind::Link);
        }
        Ok(is_free)
    }
}

/// A few nodes of a freeway, both ends among them.
fn spaced(nodes: &[usize]) -> Vec<usize> {
    let last = nodes.len() - 1;
    let mut some: Vec<usize> = (0..=TRIES_A_FREEWAY)
        .map(|k| nodes[k * last / TRIES_A_FREEWAY])
        .collect();
    some.dedup();
    some
}
