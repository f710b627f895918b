//! Edges of the roadmap: steps of traces, ascents, and straight segments between components.

use std::vec::Vec;

use crate::ascent::ClearConfiguration;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::planner::PathSearch;
use crate::roadmap::EdgeKind;
use crate::space::ConfigurationSpace;

/// Number of random nodes of which the nearest starts a feeler or is its link. Not measured.
///
/// There is one feeler per slice. Average times over 60 seeds of a plank of 0.2 through a hole:
///
/// | feelers per slice | hole of 0.6 | hole of 0.4 | hole of 0.3 |
/// |---:|---:|---:|---:|
/// | 16 | 0.20 s | 0.24 s | 0.53 s |
/// | 4 | 0.11 s | 0.17 s | 0.30 s |
/// | 1 | 0.08 s | 0.15 s | 0.20 s |
const FEW: usize = 64;

/// Maximum number of components to which straight segments from one node are tried. Not measured.
const LINKS: usize = 4;

/// Maximum number of nodes of a component among which the nearest is searched.
///
/// With all nodes, this search took two thirds of the time at 40,000 nodes. Average times over 20
/// seeds of a plank of 0.2 through holes of 0.6, 0.4 and 0.3 were 0.30, 0.59 and 1.4 s with all
/// nodes, and 0.19, 0.31 and 0.64 s with this limit.
const MANY: usize = 1024;

/// Number of nodes of a freeway from which links are tried, less one. Not measured.
const TRIES_A_FREEWAY: usize = 4;

impl<C: ConfigurationSpace> PathSearch<'_, C> {
    /// Adds the configurations of a trace after a node. Every step was proven free during the
    /// trace.
    pub(crate) fn strung(&mut self, node: usize, places: Vec<ClearConfiguration>, kind: EdgeKind) -> Vec<usize> {
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
    pub(crate) fn chain(
        &mut self,
        node: usize,
        places: &[ClearConfiguration],
        kind: EdgeKind,
    ) -> Result<usize, PlanError> {
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

    /// Returns the nearest of a few random nodes, outside the component of `apart_from` if given.
    pub(crate) fn near_one(&mut self, q: &[f64], apart_from: Option<usize>) -> Option<usize> {
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
    pub(crate) fn link(&mut self, nodes: &[usize]) -> Result<(), PlanError> {
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
        let is_free = self.checker.is_free(&self.roadmap.nodes[a], &self.roadmap.nodes[b])?;
        if is_free {
            self.work.links[1] += 1;
            self.roadmap.join(a, b, EdgeKind::Link);
        }
        Ok(is_free)
    }
}

/// Returns a lower bound of the distance of two configurations, from their sweep coordinates alone.
pub(crate) fn apart<C: ConfigurationSpace>(space: &C, a: &[f64], b: &[f64]) -> f64 {
    let each = a.iter().zip(b).zip(space.scales()).take(space.bounds().len());
    each.map(|((x, y), s)| ((x - y) * s).abs()).fold(0.0, f64::larger)
}

/// Returns a few nodes of a freeway, including both ends.
pub(crate) fn spaced(nodes: &[usize]) -> Vec<usize> {
    let last = nodes.len() - 1;
    let mut some: Vec<usize> = (0..=TRIES_A_FREEWAY)
        .map(|k| nodes[k * last / TRIES_A_FREEWAY])
        .collect();
    some.dedup();
    some
}
