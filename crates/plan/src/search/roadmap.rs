//! Roadmaps: configurations joined by segments proven free.

use core::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BinaryHeap};
use std::vec::Vec;

use crate::extremes::Extremes;
use crate::motion::space::ConfigurationSpace;
use crate::search::freeway::FreewayEnd;

/// Indices of start and goal in every roadmap.
pub(crate) const START: usize = 0;
pub(crate) const GOAL: usize = 1;

/// The kind of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EdgeKind {
    /// A step along a freeway.
    Freeway,
    /// A step of an ascent within a slice, from a configuration to a freeway.
    Ascent,
    /// A step along a freeway of a slice, with one dimension less: a bridge between freeways.
    Bridge,
    /// A straight segment between two components of the roadmap.
    Link,
    /// A segment of a tree of RRT-Connect, proven free towards the goal.
    Tree,
}

/// A segment proven free between two configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Edge {
    /// Indices of the two configurations.
    pub ends: [usize; 2],
    /// How the edge was found.
    pub kind: EdgeKind,
}

/// A freeway as it was traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Freeway {
    /// The sweep coordinate.
    pub coordinate: usize,
    /// Number of other fixed coordinates: zero for a freeway, more for a bridge.
    pub depth: usize,
    /// Indices of the configurations, from the lower end to the upper end.
    pub nodes: Vec<usize>,
    /// Reasons for the lower and the upper end.
    pub ends: [FreewayEnd; 2],
}

/// Configurations, and segments between them that are proven free.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roadmap {
    /// The configurations. Index 0 is the start, index 1 the goal.
    pub nodes: Vec<Vec<f64>>,
    /// The segments.
    pub edges: Vec<Edge>,
    /// The freeways.
    pub freeways: Vec<Freeway>,
    /// Component number of each node.
    numbers: Vec<usize>,
    /// Nodes of each component, by component number.
    components: BTreeMap<usize, Vec<usize>>,
}

impl Roadmap {
    /// Returns the roadmap of start and goal alone.
    pub(crate) fn new(start: &[f64], goal: &[f64]) -> Self {
        let mut roadmap = Self::default();
        roadmap.add(start.into());
        roadmap.add(goal.into());
        roadmap
    }

    /// Adds the configurations and segments of another roadmap of the same start and goal.
    pub(crate) fn absorb(&mut self, other: Self) {
        // The numbers of other nodes follow those of this roadmap; start and goal are the same.
        let ends = 2;
        let shift = self.nodes.len() - ends;
        let number = |node: usize| if node < ends { node } else { node + shift };
        for q in other.nodes.into_iter().skip(ends) {
            self.add(q);
        }
        for Edge { ends: [a, b], kind } in other.edges {
            self.join(number(a), number(b), kind);
        }
        for mut freeway in other.freeways {
            freeway.nodes.iter_mut().for_each(|node| *node = number(*node));
            self.freeways.push(freeway);
        }
    }

    pub(crate) fn add(&mut self, q: Vec<f64>) -> usize {
        let node = self.nodes.len();
        self.nodes.push(q);
        self.numbers.push(node);
        self.components.insert(node, [node].into());
        node
    }

    /// Joins two nodes; merges the smaller component into the larger.
    pub(crate) fn join(&mut self, a: usize, b: usize, kind: EdgeKind) {
        self.edges.push(Edge { ends: [a, b], kind });
        let size = |number: usize| self.components.get(&number).map_or(0, Vec::len);
        let [x, y] = [a, b].map(|node| self.numbers[node]);
        let (large, small) = if size(x) < size(y) { (y, x) } else { (x, y) };
        if large == small {
            return;
        }
        let moved = self.components.remove(&small).unwrap_or_default();
        for &node in &moved {
            self.numbers[node] = large;
        }
        self.components.entry(large).or_default().extend(moved);
    }

    /// Returns the component number of a node.
    ///
    /// Configurations that are joined by segments share the number, which is the index of one of
    /// them.
    #[must_use]
    pub fn component(&self, node: usize) -> usize {
        self.numbers[node]
    }

    /// Returns whether two nodes are joined by segments.
    pub(crate) fn joins(&self, a: usize, b: usize) -> bool {
        self.component(a) == self.component(b)
    }

    /// Returns the number and the nodes of each component.
    pub(crate) fn components(&self) -> impl Iterator<Item = (usize, &[usize])> {
        self.components
            .iter()
            .map(|(number, nodes)| (*number, nodes.as_slice()))
    }

    /// Returns the neighbours of each node.
    fn neighbours(&self) -> Vec<Vec<usize>> {
        let mut beside: Vec<Vec<usize>> = std::vec![Vec::new(); self.nodes.len()];
        for Edge { ends: [a, b], .. } in &self.edges {
            beside[*a].push(*b);
            beside[*b].push(*a);
        }
        beside
    }

    /// Returns the nodes of a shortest path between two nodes, by the lengths of segments.
    pub(crate) fn way(&self, from: usize, to: usize, length: impl Fn(&[f64], &[f64]) -> f64) -> Option<Vec<usize>> {
        let beside = self.neighbours();
        let mut best = std::vec![(f64::INFINITY, usize::MAX); self.nodes.len()];
        best[from] = (0.0, from);
        let mut heap = BinaryHeap::from([Reverse(Reached { far: 0.0, node: from })]);
        while let Some(Reverse(Reached { far, node })) = heap.pop() {
            if node == to {
                break;
            }
            if far > best[node].0 {
                continue;
            }
            for &next in &beside[node] {
                let far = far + length(&self.nodes[node], &self.nodes[next]);
                if far < best[next].0 {
                    best[next] = (far, node);
                    heap.push(Reverse(Reached { far, node: next }));
                }
            }
        }
        if best[to].0 == f64::INFINITY {
            return None;
        }
        let mut way = std::vec![to];
        let mut node = to;
        while node != from {
            node = best[node].1;
            way.push(node);
        }
        way.reverse();
        Some(way)
    }
}

/// A node in the queue of the shortest-path search.
#[derive(Clone, Copy, Debug)]
struct Reached {
    far: f64,
    node: usize,
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.far.total_cmp(&other.far).then(self.node.cmp(&other.node))
    }
}

/// Returns a lower bound of the distance of two configurations, from their sweep coordinates alone.
pub(crate) fn apart<C: ConfigurationSpace>(space: &C, a: &[f64], b: &[f64]) -> f64 {
    let each = a.iter().zip(b).zip(space.scales()).take(space.bounds().len());
    each.map(|((x, y), s)| ((x - y) * s).abs()).fold(0.0, f64::larger)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn a_roadmap_absorbs_another_of_the_same_ends() {
        let with = |q: f64| {
            let mut roadmap = Roadmap::new(&[0.0], &[1.0]);
            let node = roadmap.add(std::vec![q]);
            roadmap.join(0, node, EdgeKind::Tree);
            roadmap
        };
        let (mut all, mut other) = (with(0.25), with(0.5));
        let freeway = Freeway {
            coordinate: 0,
            depth: 0,
            nodes: [0, 2].into(),
            ends: [FreewayEnd::Bound; 2],
        };
        other.freeways.push(freeway);
        other.join(2, 1, EdgeKind::Link);
        all.absorb(other);
        assert_eq!(all.nodes, [[0.0], [1.0], [0.25], [0.5]]);
        let ends: Vec<[usize; 2]> = all.edges.iter().map(|edge| edge.ends).collect();
        assert_eq!(ends, [[0, 2], [0, 3], [3, 1]]);
        assert_eq!(all.freeways[0].nodes, [0, 3]);
        assert!((0..4).all(|node| all.joins(0, node)));
    }
}
