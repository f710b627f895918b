//! Roadmaps: configurations joined by segments proven free.

use core::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BinaryHeap};
use std::vec::Vec;

use crate::freeway::FreewayEnd;

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
