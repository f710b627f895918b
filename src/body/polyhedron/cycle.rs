//! Half-edges in counter-clockwise order, by index: the fan of a vertex, the ring of a large face.

use crate::body::polyhedron::feature::HalfEdgeId;
use crate::body::polyhedron::unimodal::top_of_ring;

/// Faces of more edges are kept as rings too: bisection on a list for longer lists in memory. Also
/// the number of edges of a face examined one by one, and the size of the arrays for small faces.
/// Not measured.
pub(crate) const LARGE: usize = 24;

/// Half-edges round a vertex or round a large face, counter-clockwise from outside.
pub(crate) trait Cycle {
    /// Returns the number of half-edges.
    fn count(&self) -> usize;

    /// Returns the half-edge of index `k`, which must be less than [`count`](Self::count).
    fn at(&self, k: usize) -> HalfEdgeId;

    /// Returns the half-edge of index `k` modulo [`count`](Self::count).
    #[inline(always)]
    fn wrapped(&self, k: usize) -> HalfEdgeId {
        let m = self.count();
        self.at(if k < m { k } else { k % m })
    }

    /// Returns the index of the half-edge of the greatest value, by bisection. Values must be
    /// unimodal round the cycle.
    #[inline]
    fn top_index<V: PartialOrd>(&self, value: impl Fn(HalfEdgeId) -> V) -> usize {
        top_of_ring(self.count(), |k| value(self.at(k)))
    }

    /// Returns the half-edge of the greatest value, as [`top_index`](Self::top_index).
    #[inline]
    fn top<V: PartialOrd>(&self, value: impl Fn(HalfEdgeId) -> V) -> HalfEdgeId {
        self.at(self.top_index(value))
    }
}

/// The half-edges that leave a vertex: consecutive numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fan {
    pub(super) start: u32,
    pub(super) end: u32,
}

impl Fan {
    /// Returns the number of half-edges.
    #[inline(always)]
    pub(crate) fn len(self) -> usize {
        (self.end - self.start) as usize
    }

    /// Returns the half-edges in order.
    #[inline(always)]
    pub(crate) fn iter(self) -> impl ExactSizeIterator<Item = HalfEdgeId> + Clone + use<> {
        (self.start..self.end).map(HalfEdgeId)
    }

    /// Returns the half-edge after `h`, counter-clockwise.
    #[inline(always)]
    pub(crate) fn after(self, h: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(if h.0 + 1 == self.end { self.start } else { h.0 + 1 })
    }

    /// Returns the index of a half-edge of the fan; the last index for any other half-edge.
    #[inline(always)]
    pub(crate) fn index_of(self, h: HalfEdgeId) -> usize {
        (h.0.wrapping_sub(self.start) as usize).min(self.len() - 1)
    }
}

impl Cycle for Fan {
    #[inline(always)]
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn at(&self, k: usize) -> HalfEdgeId {
        HalfEdgeId(self.start + k as u32)
    }
}

impl Cycle for [HalfEdgeId] {
    #[inline(always)]
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn at(&self, k: usize) -> HalfEdgeId {
        self[k]
    }
}
