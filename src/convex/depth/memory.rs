//! Cached state of an overlap: the polytope as vertex pairs, and the deepest facet.
//!
//! Points of A - B are vertex pairs and remain points of A - B at every pose. So a polytope on such
//! points can be resumed at any pose ([`resume`](mod@crate::convex::depth::resume)).

use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use crate::base::num::each::Each;
use crate::base::num::scalar::Vec3;
use crate::body::polyhedron::{FeaturePair, VertexId};
use crate::pair::difference::DifferenceFacet;
use crate::pair::difference::MinkowskiPoint;
use crate::pair::posed::PosedPair;

use crate::convex::depth::polytope::EnclosingSurface;

/// Largest number of triangles of a polytope that is cached between queries, so that the index of a
/// triangle fits a byte. Larger polytopes are built again, because their memory costs more than the
/// time saved.
pub(super) const MAX_TRIANGLES: usize = 256;

/// A polytope with more triangles than twice their number at its build plus this number is not
/// cached, but built again. An old polytope contains triangles that give no bound.
const GAIN: usize = 24;

/// Largest number of points of a cached polytope: a closed surface of `MAX_TRIANGLES` triangles has
/// no more.
pub(super) const MAX_POINTS: usize = MAX_TRIANGLES / 2 + 2;

/// A polytope without coordinates: each edge of a triangle is the reverse of an edge of the
/// adjacent triangle.
#[derive(Clone, Debug, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "RawMemory")
)]
pub(crate) struct Memory {
    /// Vertex of A and vertex of B of each point.
    pub(super) points: Vec<[VertexId; 2]>,
    /// Three point indices, then the triangle across the edge from vertex k to vertex k + 1.
    pub(super) triangles: Vec<[u8; 6]>,
    /// Features of the deepest facet.
    pub(super) facet: Option<FeaturePair>,
    /// Features of the last witnesses, if different from `facet`.
    pub(super) witness_features: Option<FeaturePair>,
    /// Number of triangles when the polytope was built.
    pub(super) built: u32,
    /// Working memory, allocated at the first overlap; not part of the cached state.
    #[cfg_attr(feature = "serde", serde(skip))]
    scratch: Workspace,
}

/// Working memory of searches, allocated at the first overlap. It contains nothing between two
/// searches, so trackers may share one workspace one after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace(Option<Box<Scratch>>);

impl Workspace {
    /// Returns the allocated bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        self.0.as_ref().map_or(0, |r| {
            size_of::<Scratch>() + r.below_target.capacity() * size_of::<u32>() + r.surface.memory_usage()
        })
    }
}

/// Features of the deepest facet, features of the witnesses, initial number of triangles, points,
/// and triangles.
type MemoryParts<'a> = (
    FeaturePair,
    Option<FeaturePair>,
    u32,
    &'a [[VertexId; 2]],
    &'a [[u8; 6]],
);

/// Buffers that keep their allocation between queries.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    pub(super) surface: EnclosingSurface<f64>,
    /// Triangles below the target height, at which the polytope must grow.
    pub(super) below_target: Vec<u32>,
}

impl PartialEq for Memory {
    fn eq(&self, o: &Self) -> bool {
        self.parts() == o.parts()
    }
}

/// Cached polytope as deserialised: not yet known to be closed.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
pub(crate) struct RawMemory {
    pub(crate) points: Vec<[VertexId; 2]>,
    pub(crate) triangles: Vec<[u32; 6]>,
    pub(crate) facet: Option<FeaturePair>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) witness_features: Option<FeaturePair>,
    pub(crate) built: u32,
}

impl From<RawMemory> for Memory {
    /// Returns an empty cache if the data is not a closed surface.
    fn from(raw: RawMemory) -> Self {
        if !raw.is_closed() {
            return Self::default();
        }
        let bytes = |t: &[u32; 6]| t.each(|k| k as u8);
        Self {
            triangles: raw.triangles.iter().map(bytes).collect(),
            points: raw.points,
            facet: raw.facet,
            witness_features: raw.witness_features,
            built: raw.built,
            scratch: Workspace::default(),
        }
    }
}

impl RawMemory {
    fn is_closed(&self) -> bool {
        self.points.len() <= MAX_POINTS
            && self.triangles.len() <= MAX_TRIANGLES
            && unmatched_edge(self.points.len(), &self.triangles).is_none()
    }
}

/// Returns the first triangle that is not joined to three others edge by edge, if any: three point
/// indices, then the triangle across the edge from vertex k to vertex k + 1.
fn unmatched_edge(points: usize, triangles: &[[u32; 6]]) -> Option<usize> {
    let is_joined = |(k, t): (usize, &[u32; 6])| {
        (0..3).all(|i| {
            let (from, to) = (t[i], t[(i + 1) % 3]);
            (from as usize) < points
                && triangles
                    .get(t[3 + i] as usize)
                    .is_some_and(|o| (0..3).any(|j| (o[j], o[(j + 1) % 3], o[3 + j]) == (to, from, k as u32)))
        })
    };
    triangles.iter().enumerate().position(|joined| !is_joined(joined))
}

impl Memory {
    /// Allocates for the largest polytope that is cached.
    pub(crate) fn reserve(&mut self) {
        self.points.reserve(MAX_POINTS);
        self.triangles.reserve(MAX_TRIANGLES);
        self.with_scratch(|_, scratch| {
            scratch.surface.reserve(MAX_TRIANGLES);
            scratch.below_target.reserve(MAX_TRIANGLES);
        });
    }

    /// Runs `work` with the working memory, allocated if absent.
    pub(super) fn with_scratch<R>(&mut self, work: impl FnOnce(&mut Self, &mut Scratch) -> R) -> R {
        let mut scratch = self.scratch.0.take().unwrap_or_else(|| {
            Box::new(Scratch {
                surface: EnclosingSurface::new(),
                below_target: Vec::new(),
            })
        });
        let result = work(self, &mut scratch);
        self.scratch.0 = Some(scratch);
        result
    }

    /// Exchanges the working memory for another.
    #[inline]
    pub(crate) fn exchange(&mut self, workspace: &mut Workspace) {
        core::mem::swap(&mut self.scratch, workspace);
    }

    /// Returns a cache without a polytope, after an overlap with this deepest facet.
    pub(crate) fn after(facet: FeaturePair) -> Self {
        Self {
            facet: Some(facet),
            ..Self::default()
        }
    }

    /// Makes another facet the deepest. The polytope stays: it is checked before use.
    pub(crate) fn move_to(&mut self, facet: DifferenceFacet) {
        (self.facet, self.witness_features) = (Some(facet.features()), None);
    }

    /// Drops the polytope and keeps the allocations.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.triangles.clear();
        (self.facet, self.witness_features) = (None, None);
        self.built = 0;
    }

    /// Returns the number of cached triangles.
    pub(crate) fn facets(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the allocated bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        self.points.capacity() * size_of::<[VertexId; 2]>()
            + self.triangles.capacity() * size_of::<[u8; 6]>()
            + self.scratch.memory_usage()
    }

    /// Returns the first broken invariant of the cached polytope: it must be closed, with few
    /// points. Its vertices may belong to bodies other than those of the next query, which checks
    /// them.
    pub(crate) fn check(&self) -> Result<(), String> {
        let triangles: Vec<[u32; 6]> = self.triangles.iter().map(|t| t.each(u32::from)).collect();
        match unmatched_edge(self.points.len(), &triangles) {
            Some(k) => Err(format!(
                "triangle {k} of the cached surface is not joined to its neighbours"
            )),
            None if self.points.len() > MAX_POINTS => Err("the cached surface has too many points".into()),
            None => Ok(()),
        }
    }

    /// Returns the cached facet if the bodies have one of this name.
    pub(crate) fn facet_of(&self, posed: &PosedPair) -> Option<FeaturePair> {
        self.facet.filter(|facet| facet.is_of(posed.a, posed.b))
    }

    /// Returns whether the cache holds no facet to resume from.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.facet.is_none()
    }

    /// Returns the cached parts; `None` if the cache is empty.
    pub(crate) fn parts(&self) -> Option<MemoryParts<'_>> {
        Some((
            self.facet?,
            self.witness_features,
            self.built,
            &self.points,
            &self.triangles,
        ))
    }

    /// Returns the three point indices of a triangle.
    pub(super) fn vertices(&self, t: u32) -> [usize; 3] {
        let [i, j, k, ..] = self.triangles[t as usize];
        [i, j, k].each(usize::from)
    }

    /// Loads the cached polytope, with the points at `positions`, into the working memory.
    pub(super) fn recall(&self, scratch: &mut Scratch, positions: &[Vec3<f64>], target: f64) {
        let surface = &mut scratch.surface;
        surface.clear(target);
        let points = self.points.iter().zip(positions);
        surface
            .points
            .extend(points.map(|(&[a, b], &w)| MinkowskiPoint { a, b, w }));
        for &[p, q, r, x, y, z] in &self.triangles {
            surface.push([p, q, r].each(u32::from), [x, y, z].each(u32::from));
        }
        for &t in &scratch.below_target {
            surface.compute_bound(t);
        }
    }

    /// Caches the facet, and also the polytope if it is small and has not gained too many triangles
    /// since its build.
    pub(super) fn keep(&mut self, surface: &EnclosingSurface<f64>, facet: FeaturePair, built: Option<u32>) {
        self.clear();
        self.facet = Some(facet);
        let count = surface.triangles.len();
        let built = built.unwrap_or(count as u32);
        // A closed surface of so few triangles uses at most MAX_POINTS points.
        if count > MAX_TRIANGLES || surface.points.len() > MAX_TRIANGLES || count > 2 * built as usize + GAIN {
            return;
        }
        // Drops points no triangle uses any more.
        let mut index = [u8::MAX; MAX_TRIANGLES];
        for (vertices, neighbours) in surface.indices() {
            let mut t = [0; 6];
            for k in 0..3 {
                let c = vertices[k] as usize;
                if index[c] == u8::MAX {
                    index[c] = self.points.len() as u8;
                    self.points.push([surface.points[c].a, surface.points[c].b]);
                }
                (t[k], t[3 + k]) = (index[c], neighbours[k] as u8);
            }
            self.triangles.push(t);
        }
        self.built = built;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scratch_of_later_overlaps_has_the_documented_size() {
        let mut memory = Memory::default();
        assert_eq!(memory.memory_usage(), 0);
        memory.reserve();
        let bytes = memory.memory_usage();
        assert!((45_000..55_000).contains(&bytes), "{bytes}");
    }
}
