//! Adjacency of vertices, edges and faces: half-edges by number, without coordinates.
//!
//! The half-edges that leave a vertex are contiguous and counter-clockwise seen from outside (the
//! *fan* of the vertex). The half-edges around a face are linked by `next`, counter-clockwise too
//! (the boundary of the face, `rim` in the code). The boundary of a large face is also stored as an
//! ordered list, its *ring*, for bisection.
//!
//! ```text
//!            to
//!          / | \          h = from -> to     (this half-edge)
//!         /  |  \         face(h)            the face on its left
//!   next(h)  h   .        face(twin(h))      the face on its right
//!       /    |    \       h + 1 in the fan   turns left about `from`
//!            from
//! ```

use alloc::vec;
use alloc::vec::Vec;

use crate::base::num::each::Each;
use crate::base::num::sort::sort_by_key;
use crate::body::polyhedron::fans::Fan;
use crate::body::polyhedron::fans::LARGE;
use crate::body::polyhedron::feature::{EdgeId, FaceId, HalfEdgeId, VertexId};

/// A half-edge: an edge with a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HalfEdge {
    /// The vertex at the end.
    pub(crate) to: VertexId,
    /// The half-edge of the opposite direction.
    pub(crate) twin: HalfEdgeId,
    /// The following half-edge round `face`.
    pub(crate) next: HalfEdgeId,
    /// The face on the left.
    pub(crate) face: FaceId,
}

/// Half-edges in memory, with 16-bit numbers if they are enough. This halves the memory that a
/// query touches.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum HalfEdges {
    Short(Vec<[u16; 4]>),
    Long(Vec<[u32; 4]>),
}

impl HalfEdges {
    /// Stores `[to, twin, next, face]` of each half-edge.
    fn new(half_edges: Vec<[u32; 4]>) -> Self {
        // Half-edges have the largest numbers of all features of a body.
        if half_edges.len() <= usize::from(u16::MAX) {
            HalfEdges::Short(half_edges.iter().map(|e| e.each(|x| x as u16)).collect())
        } else {
            HalfEdges::Long(half_edges)
        }
    }

    #[inline(always)]
    fn len(&self) -> usize {
        match self {
            HalfEdges::Short(l) => l.len(),
            HalfEdges::Long(l) => l.len(),
        }
    }

    #[inline(always)]
    fn get(&self, h: HalfEdgeId) -> HalfEdge {
        let [to, twin, next, face] = match self {
            HalfEdges::Short(l) => l[h.index()].each(u32::from),
            HalfEdges::Long(l) => l[h.index()],
        };
        HalfEdge {
            to: VertexId(to),
            twin: HalfEdgeId(twin),
            next: HalfEdgeId(next),
            face: FaceId(face),
        }
    }
}

/// The vertices, half-edges and faces of one body by number.
///
/// A point has one vertex and an empty fan; a segment has one face of two half-edges, its *null
/// face*, whose plane has a zero normal; a polygon has two faces, one for each side.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Topology {
    /// Start of the fan of each vertex, and one more entry for the end of the last fan.
    first: Vec<u32>,
    links: HalfEdges,
    /// One half-edge of each face.
    rim: Vec<u32>,
    /// `(face, start)` of each large face, `start` being the index in `ring` of the first
    /// half-edge.
    rings: Vec<(FaceId, u32)>,
    /// The half-edges of large faces in order, face after face.
    ring: Vec<HalfEdgeId>,
    /// For each vertex the index in `ring` of a half-edge that leaves the vertex along a large
    /// face; empty if there are no large faces.
    places: Vec<u32>,
}

impl Topology {
    /// Builds the topology from the vertex loops of the faces, counter-clockwise from outside.
    /// `None` if the loops are not a closed surface in which every directed edge occurs once, its
    /// reverse once, and every vertex has one fan.
    pub(crate) fn from_loops(vertices: usize, loops: &[Vec<u32>]) -> Option<Self> {
        // Provisional half-edges in loop order: (from, to, next, face).
        let mut raw: Vec<[u32; 4]> = Vec::new();
        for (face, ring) in loops.iter().enumerate() {
            let base = raw.len() as u32;
            let n = ring.len() as u32;
            for k in 0..n {
                let (from, to) = (ring[k as usize], ring[((k + 1) % n) as usize]);
                if from as usize >= vertices || to as usize >= vertices || from == to {
                    return None;
                }
                raw.push([from, to, base + (k + 1) % n, face as u32]);
            }
        }
        let (start, order) = sort_by_ends(vertices, &raw);
        let find = |from: u32, to: u32| -> Option<u32> {
            let leaving = &order[start[from as usize] as usize..start[from as usize + 1] as usize];
            let i = leaving.partition_point(|&h| raw[h as usize][1] < to);
            let h = *leaving.get(i)?;
            let twin_free = leaving.get(i + 1).is_none_or(|&g| raw[g as usize][1] != to);
            (raw[h as usize][1] == to && twin_free).then_some(h)
        };
        let twin: Vec<u32> = raw.iter().map(|h| find(h[1], h[0])).collect::<Option<_>>()?;
        let mut previous = vec![0u32; raw.len()];
        for (h, r) in raw.iter().enumerate() {
            previous[r[2] as usize] = h as u32;
        }
        let (first, number) = fans(vertices, &raw, &order, |h| twin[previous[h as usize] as usize])?;
        let mut half_edges = vec![[0; 4]; raw.len()];
        for (h, &[_, to, next, face]) in raw.iter().enumerate() {
            let (twin, next) = (number[twin[h] as usize], number[next as usize]);
            half_edges[number[h] as usize] = [to, twin, next, face];
        }
        let mut rim = vec![u32::MAX; loops.len()];
        for (h, &[.., face]) in half_edges.iter().enumerate() {
            let slot = &mut rim[face as usize];
            *slot = (*slot).min(h as u32);
        }
        if rim.contains(&u32::MAX) {
            return None;
        }
        let mut topology = Self {
            first,
            links: HalfEdges::new(half_edges),
            rim,
            rings: Vec::new(),
            ring: Vec::new(),
            places: Vec::new(),
        };
        topology.keep_rings();
        Some(topology)
    }

    /// Returns the topology of one vertex without an edge.
    pub(crate) fn of_vertex() -> Self {
        Self {
            first: vec![0; 2],
            links: HalfEdges::new(Vec::new()),
            rim: Vec::new(),
            rings: Vec::new(),
            ring: Vec::new(),
            places: Vec::new(),
        }
    }

    fn keep_rings(&mut self) {
        for f in FaceId::all(self.rim.len()) {
            if self.rim(f).nth(LARGE).is_some() {
                let ring: Vec<HalfEdgeId> = self.rim(f).collect();
                let start = self.ring.len() as u32;
                self.places.resize(self.vertex_count(), u32::MAX);
                for (&h, place) in ring.iter().zip(start..) {
                    let v = self.from(h);
                    self.places[v.index()] = place;
                }
                self.rings.push((f, start));
                self.ring.extend(ring);
            }
        }
    }

    /// Returns the ring of a large face at vertex `v`, and the index there of the half-edge that
    /// leaves `v`.
    pub(crate) fn long_rim(&self, v: VertexId) -> Option<(&[HalfEdgeId], usize)> {
        let place = *self.places.get(v.index())?;
        let next = self.rings.partition_point(|r| r.1 <= place);
        let start = self.rings.get(next.checked_sub(1)?)?.1;
        let end = self.rings.get(next).map_or(self.ring.len(), |r| r.1 as usize);
        // A vertex on no large face has an index beyond all rings.
        let ring = self.ring.get(start as usize..end)?;
        (place < end as u32).then_some((ring, (place - start) as usize))
    }

    /// Returns whether any face is kept as a ring.
    #[inline(always)]
    pub(crate) fn has_large_faces(&self) -> bool {
        !self.rings.is_empty()
    }

    /// Returns the half-edges of a large face in order; `None` for small faces, whose rims are
    /// short to walk.
    #[inline(always)]
    pub(crate) fn ring(&self, f: FaceId) -> Option<&[HalfEdgeId]> {
        if self.rings.is_empty() {
            None
        } else {
            self.large_ring(f)
        }
    }

    fn large_ring(&self, f: FaceId) -> Option<&[HalfEdgeId]> {
        let k = self.rings.binary_search_by_key(&f, |r| r.0).ok()?;
        let end = self.rings.get(k + 1).map_or(self.ring.len(), |next| next.1 as usize);
        self.ring.get(self.rings[k].1 as usize..end)
    }

    #[inline]
    pub(crate) fn vertex_count(&self) -> usize {
        self.first.len() - 1
    }

    #[inline]
    pub(crate) fn half_edge_count(&self) -> usize {
        self.links.len()
    }

    #[inline]
    pub(crate) fn face_count(&self) -> usize {
        self.rim.len()
    }

    #[inline]
    pub(crate) fn half_edge(&self, h: HalfEdgeId) -> HalfEdge {
        self.links.get(h)
    }

    /// Returns the half-edges that leave `v`, counter-clockwise from outside.
    #[inline]
    pub(crate) fn fan(&self, v: VertexId) -> Fan {
        Fan {
            start: self.first[v.index()],
            end: self.first[v.index() + 1],
        }
    }

    /// Calls `f(half_edge, to)` for the fan of `v`, counter-clockwise from outside.
    #[inline(always)]
    pub(crate) fn each_leaving(&self, v: VertexId, mut f: impl FnMut(HalfEdgeId, VertexId)) {
        let Fan { start, end } = self.fan(v);
        let span = start as usize..end as usize;
        match &self.links {
            HalfEdges::Short(l) => {
                for (k, e) in l[span].iter().enumerate() {
                    f(HalfEdgeId(start + k as u32), VertexId(u32::from(e[0])));
                }
            }
            HalfEdges::Long(l) => {
                for (k, e) in l[span].iter().enumerate() {
                    f(HalfEdgeId(start + k as u32), VertexId(e[0]));
                }
            }
        }
    }

    /// Returns the vertices adjacent to `v`, counter-clockwise from outside.
    pub(crate) fn neighbours(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.fan(v).iter().map(|h| self.links.get(h).to)
    }

    /// Returns the vertices adjacent to `v`, the last one repeated, if there are one to eight:
    /// without a loop whose end is hard to predict.
    #[inline(always)]
    pub(crate) fn up_to_eight(&self, v: VertexId) -> Option<[VertexId; 8]> {
        fn taken<E>(fan: &[E], to: impl Fn(&E) -> u32) -> Option<[VertexId; 8]> {
            (1..=8)
                .contains(&fan.len())
                .then(|| core::array::from_fn(|k| VertexId(to(&fan[k.min(fan.len() - 1)]))))
        }
        let fan = self.first[v.index()] as usize..self.first[v.index() + 1] as usize;
        match &self.links {
            HalfEdges::Short(l) => taken(&l[fan], |e| u32::from(e[0])),
            HalfEdges::Long(l) => taken(&l[fan], |e| e[0]),
        }
    }

    /// Returns the bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        let links = match &self.links {
            HalfEdges::Short(l) => l.capacity() * 8,
            HalfEdges::Long(l) => l.capacity() * 16,
        };
        links
            + 4 * (self.first.capacity() + self.rim.capacity() + self.ring.capacity())
            + 4 * self.places.capacity()
            + 8 * self.rings.capacity()
    }

    /// Returns the vertex that `h` leaves.
    #[inline]
    pub(crate) fn from(&self, h: HalfEdgeId) -> VertexId {
        self.links.get(self.links.get(h).twin).to
    }

    /// Returns one half-edge of the boundary of `f`.
    #[inline]
    pub(crate) fn rim_half_edge(&self, f: FaceId) -> HalfEdgeId {
        HalfEdgeId(self.rim[f.index()])
    }

    /// Returns the half-edges around `f`, counter-clockwise from outside.
    pub(crate) fn rim(&self, f: FaceId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        let start = self.rim_half_edge(f);
        let mut next = Some(start);
        core::iter::from_fn(move || {
            let h = next?;
            let n = self.links.get(h).next;
            next = (n != start).then_some(n);
            Some(h)
        })
    }

    /// Returns the edge of a half-edge.
    #[inline]
    pub(crate) fn edge(&self, h: HalfEdgeId) -> EdgeId {
        EdgeId::of(h, self.links.get(h).twin)
    }
}

/// Sorts the provisional half-edges by (from, to) and returns the start of each vertex's half-edges
/// and the order: a counting sort, as most vertices have few.
fn sort_by_ends(vertices: usize, raw: &[[u32; 4]]) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; vertices + 1];
    for h in raw {
        start[h[0] as usize + 1] += 1;
    }
    for v in 0..vertices {
        start[v + 1] += start[v];
    }
    let mut place = start.clone();
    let mut order = vec![0u32; raw.len()];
    for (h, r) in raw.iter().enumerate() {
        order[place[r[0] as usize] as usize] = h as u32;
        place[r[0] as usize] += 1;
    }
    for v in 0..vertices {
        sort_by_key(&mut order[start[v] as usize..start[v + 1] as usize], |&h| {
            raw[h as usize][1]
        });
    }
    (start, order)
}

/// Numbers the half-edges so that each fan is contiguous and counter-clockwise. Returns the start
/// of each fan and the new number of each old half-edge; `None` if a vertex has no fan (unless the
/// body is a point) or several fans.
fn fans(vertices: usize, raw: &[[u32; 4]], order: &[u32], left: impl Fn(u32) -> u32) -> Option<(Vec<u32>, Vec<u32>)> {
    let mut first = Vec::with_capacity(vertices + 1);
    let mut number = vec![u32::MAX; raw.len()];
    let (mut next, mut i) = (0u32, 0usize);
    for v in 0..vertices as u32 {
        first.push(next);
        let from = i;
        while i < order.len() && raw[order[i] as usize][0] == v {
            i += 1;
        }
        if i == from {
            if vertices == 1 {
                break;
            }
            return None;
        }
        let start = order[from];
        let mut h = start;
        loop {
            if number[h as usize] != u32::MAX {
                return None;
            }
            number[h as usize] = next;
            next += 1;
            h = left(h);
            if h == start {
                break;
            }
        }
        if (next - first[v as usize]) as usize != i - from {
            return None;
        }
    }
    first.push(next);
    Some((first, number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Vec<Vec<u32>> {
        vec![vec![0, 1, 2], vec![0, 3, 1], vec![1, 3, 2], vec![2, 3, 0]]
    }

    #[test]
    fn links_of_a_tetrahedron_agree_with_each_other() {
        let t = Topology::from_loops(4, &tetrahedron()).unwrap();
        assert_eq!((t.vertex_count(), t.half_edge_count(), t.face_count()), (4, 12, 4));
        for v in VertexId::all(4) {
            for h in t.fan(v).iter() {
                let e = t.half_edge(h);
                assert_eq!(t.from(h), v);
                assert_eq!(t.half_edge(e.twin).twin, h);
                assert_eq!(t.from(e.next), e.to);
                assert_eq!(t.half_edge(e.next).face, e.face);
                // turning left about v crosses the face on the left
                let left = t.fan(v).after(h);
                assert_eq!(t.half_edge(t.half_edge(left).twin).face, e.face);
            }
        }
        for f in FaceId::all(4) {
            assert_eq!(t.rim(f).count(), 3);
            assert!(t.rim(f).all(|h| t.half_edge(h).face == f));
        }
    }

    #[test]
    fn flat_bodies_have_a_topology() {
        assert_eq!(Topology::from_loops(1, &[]).unwrap().half_edge_count(), 0);
        let segment = Topology::from_loops(2, &[vec![0, 1]]).unwrap();
        let [h, g] = [0, 1].map(HalfEdgeId);
        assert_eq!((segment.half_edge(h).twin, segment.half_edge(g).twin), (g, h));
        let polygon = Topology::from_loops(4, &[vec![0, 1, 2, 3], vec![3, 2, 1, 0]]).unwrap();
        assert_eq!((polygon.face_count(), polygon.half_edge_count()), (2, 8));
    }

    #[test]
    fn loops_that_are_no_closed_surface_are_refused() {
        let open = &tetrahedron()[..3];
        assert!(Topology::from_loops(4, open).is_none());
        let mut twisted = tetrahedron();
        twisted[3] = vec![0, 3, 2];
        assert!(Topology::from_loops(4, &twisted).is_none());
        assert!(Topology::from_loops(5, &tetrahedron()).is_none());
        assert!(Topology::from_loops(3, &tetrahedron()).is_none());
    }
}
