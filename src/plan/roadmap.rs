//! Roadmaps: configurations joined by segments proven free.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::cmp::{Ordering, Reverse};

use super::freeway::FreewayEnd;

/// The kind of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdgeKind {
    /// A step along a freeway.
    Freeway,
    /// A step of an ascent within a slice, from a configuration to a freeway.
    Ascent,
    /// A step along a freeway of a slice, with one dimension less: a bridge between freeways.
    Bridge,
    /// A straight segment between two parts of the roadmap.
    Link,
}

/// A segment proven free between two configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The numbers of the configurations.
    pub ends: [usize; 2],
    /// The kind.
    pub kind: EdgeKind,
}

/// A freeway as it was traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Freeway {
    /// The sweep coordinate.
    pub coordinate: usize,
    /// How many coordinates were fixed besides: zero for a freeway, more for a bridge.
    pub depth: usize,
    /// The numbers of the configurations, from the lower end to the upper end.
    pub nodes: Vec<usize>,
    /// Why the freeway ends at the lower and at the upper end.
    pub ends: [FreewayEnd; 2],
}

/// Configurations, and segments proven free between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roadmap {
    /// The configurations; number 0 is the start, number 1 the goal.
    pub nodes: Vec<Vec<f64>>,
    /// The segments.
    pub edges: Vec<Edge>,
    /// The freeways.
    pub freeways: Vec<Freeway>,
    /// Links of a forest of components.
    parents: Vec<usize>,
}

impl Roadmap {
    pub(super) fn add(&mut self, q: Vec<f64>) -> usize {
        self.nodes.push(q);
        self.parents.push(self.nodes.len() - 1);
        self.nodes.len() - 1
    }

    pub(super) fn join(&mut self, a: usize, b: usize, kind: EdgeKind) {
        self.edges.push(Edge { ends: [a, b], kind });
        let (x, y) = (self.component(a), self.component(b));
        let (low, high) = (x.min(y), x.max(y));
        self.parents[high] = low;
        // Short ways to the roots of both.
        for k in [a, b] {
            self.parents[k] = low;
        }
    }

    /// Returns a number that configurations joined by segments share: the least of their numbers.
    #[must_use]
    pub fn component(&self, node: usize) -> usize {
        let mut root = node;
        while self.parents[root] != root {
            root = self.parents[root];
        }
        root
    }

    /// Returns the component of every node. A parent never has the higher number.
    pub(super) fn components(&self) -> Vec<usize> {
        let mut components: Vec<usize> = Vec::with_capacity(self.parents.len());
        for (node, &parent) in self.parents.iter().enumerate() {
            components.push(if parent == node { node } else { components[parent] });
        }
        components
    }

    /// Returns the nodes of a shortest way between two nodes by the lengths of segments.
    pub(super) fn way(&self, from: usize, to: usize, length: impl Fn(&[f64], &[f64]) -> f64) -> Option<Vec<usize>> {
        let mut beside: Vec<Vec<usize>> = alloc::vec![Vec::new(); self.nodes.len()];
        for edge in &self.edges {
            let [a, b] = edge.ends;
            beside[a].push(b);
            beside[b].push(a);
        }
        let mut best = alloc::vec![(f64::INFINITY, usize::MAX); self.nodes.len()];
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
        let mut way = alloc::vec![to];
        let mut node = to;
        while node != from {
            node = best[node].1;
            way.push(node);
        }
        way.reverse();
        Some(way)
    }
}

/// A node on the front of the search.
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
