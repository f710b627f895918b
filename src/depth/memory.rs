//! Cached state of an overlap: the surface as vertex pairs, and the deepest facet.
//!
//! Points of A - B are vertex pairs and remain points of A - B at every pose, so a surface on such
//! points can be resumed at any pose ([`resume`](mod@crate::depth::resume)).

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::num::scalar::Vec3;
use crate::pair::difference::MinkowskiPoint;
use crate::polyhedron::FeaturePair;

use crate::depth::surface::Surface;

/// Most triangles worth caching: a triangle index fits in a byte.
pub(super) const MOST: usize = 256;

/// Most points of a cached surface: a closed surface of `MOST` triangles has no more.
pub(super) const MOST_POINTS: usize = MOST / 2 + 2;

/// Triangles a surface may gain, beyond twice its initial number, before it is built afresh.
const GAIN: usize = 24;

/// A closed surface without coordinates: each edge of a triangle is the reverse of an edge of the
/// adjacent triangle.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "Raw"))]
pub(crate) struct Memory {
    /// Vertex of A and vertex of B of each point.
    pub(super) points: Vec<[u32; 2]>,
    /// Three point indices, then the triangle across the edge from vertex k to vertex k + 1.
    pub(super) triangles: Vec<[u8; 6]>,
    /// Features of the deepest facet.
    pub(super) facet: Option<FeaturePair>,
    /// Features of the last witnesses, if different from `facet`.
    pub(super) stand: Option<FeaturePair>,
    /// Number of triangles when the surface was built.
    pub(super) built: u32,
    /// Working memory, allocated at the first overlap; not part of the cached state.
    #[cfg_attr(feature = "serde", serde(skip))]
    room: Option<Box<Room>>,
}

/// Features of the deepest facet, features of the witnesses, initial number of triangles, points,
/// and triangles.
type Parts<'a> = (FeaturePair, Option<FeaturePair>, u32, &'a [[u32; 2]], &'a [[u8; 6]]);

/// Buffers that keep their allocation between queries.
#[derive(Clone, Debug)]
pub(super) struct Room {
    pub(super) surface: Surface<f64>,
    /// Triangles below the target height, at which the surface must grow.
    pub(super) weak: Vec<u32>,
}

impl PartialEq for Memory {
    fn eq(&self, o: &Self) -> bool {
        self.parts() == o.parts()
    }
}

/// Cached surface as deserialized: not yet known to be closed.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
pub(crate) struct Raw {
    pub(crate) points: Vec<[u32; 2]>,
    pub(crate) triangles: Vec<[u32; 6]>,
    pub(crate) facet: Option<FeaturePair>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) stand: Option<FeaturePair>,
    pub(crate) built: u32,
}

impl From<Raw> for Memory {
    /// Returns an empty cache if the data is no closed surface.
    fn from(raw: Raw) -> Self {
        if !raw.is_closed() {
            return Self::default();
        }
        let bytes = |t: &[u32; 6]| t.map(|k| k as u8);
        Self {
            triangles: raw.triangles.iter().map(bytes).collect(),
            points: raw.points,
            facet: raw.facet,
            stand: raw.stand,
            built: raw.built,
            room: None,
        }
    }
}

impl Raw {
    fn is_closed(&self) -> bool {
        let closed = |(k, t): (usize, &[u32; 6])| {
            (0..3).all(|i| {
                let (from, to) = (t[i], t[(i + 1) % 3]);
                (from as usize) < self.points.len()
                    && self
                        .triangles
                        .get(t[3 + i] as usize)
                        .is_some_and(|o| (0..3).any(|j| (o[j], o[(j + 1) % 3], o[3 + j]) == (to, from, k as u32)))
            })
        };
        self.points.len() <= MOST_POINTS
            && self.triangles.len() <= MOST
            && self.triangles.iter().enumerate().all(closed)
    }
}

impl Memory {
    /// Allocates for the largest surface that is cached.
    pub(crate) fn reserve(&mut self) {
        self.points.reserve(MOST_POINTS);
        self.triangles.reserve(MOST);
        self.within(|_, room| {
            room.surface.reserve(MOST);
            room.weak.reserve(MOST);
        });
    }

    /// Runs `work` with the working memory, allocated if absent.
    pub(super) fn within<R>(&mut self, work: impl FnOnce(&mut Self, &mut Room) -> R) -> R {
        let mut room = self.room.take().unwrap_or_else(|| {
            Box::new(Room {
                surface: Surface::new(),
                weak: Vec::new(),
            })
        });
        let result = work(self, &mut room);
        self.room = Some(room);
        result
    }

    /// Forgets the surface and keeps the allocations.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.triangles.clear();
        (self.facet, self.stand) = (None, None);
        self.built = 0;
    }

    /// Returns the number of cached triangles.
    pub(crate) fn facets(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the allocated bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.points.capacity() * size_of::<[u32; 2]>()
            + self.triangles.capacity() * size_of::<[u8; 6]>()
            + self.room.as_ref().map_or(0, |r| {
                size_of::<Room>() + r.weak.capacity() * size_of::<u32>() + r.surface.heap_bytes()
            })
    }

    /// Returns whether the cache holds no facet to resume from.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.facet.is_none()
    }

    /// Returns the cached parts; `None` if the cache is empty.
    pub(crate) fn parts(&self) -> Option<Parts<'_>> {
        Some((self.facet?, self.stand, self.built, &self.points, &self.triangles))
    }

    /// Returns the three point indices of a triangle.
    pub(super) fn corners(&self, t: u32) -> [usize; 3] {
        let [i, j, k, ..] = self.triangles[t as usize];
        [i, j, k].map(usize::from)
    }

    /// Loads the cached surface, with the points at `positions`, into the working memory.
    pub(super) fn recall(&self, room: &mut Room, places: &[Vec3<f64>], enough: f64) {
        let surface = &mut room.surface;
        surface.clear(enough);
        let points = self.points.iter().zip(places);
        surface
            .points
            .extend(points.map(|(&[a, b], &w)| MinkowskiPoint { a, b, w }));
        for &[p, q, r, x, y, z] in &self.triangles {
            surface.push([p, q, r].map(u32::from), [x, y, z].map(u32::from));
        }
        for &t in &room.weak {
            surface.weigh(t);
        }
    }

    /// Caches the facet and also the surface, if the surface is small and has not outgrown its
    /// initial number of triangles.
    pub(super) fn keep(&mut self, surface: &Surface<f64>, facet: FeaturePair, built: Option<u32>) {
        self.clear();
        self.facet = Some(facet);
        let count = surface.triangles.len();
        let built = built.unwrap_or(count as u32);
        if count > MOST || surface.points.len() > MOST || count > 2 * built as usize + GAIN {
            return;
        }
        // Drops points no triangle uses any more.
        let mut place = [u8::MAX; MOST];
        for (corners, beside) in surface.names() {
            let mut t = [0; 6];
            for k in 0..3 {
                let c = corners[k] as usize;
                if place[c] == u8::MAX {
                    place[c] = self.points.len() as u8;
                    self.points.push([surface.points[c].a, surface.points[c].b]);
                }
                (t[k], t[3 + k]) = (place[c], beside[k] as u8);
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
    fn the_room_for_later_overlaps_is_what_the_documentation_says() {
        let mut memory = Memory::default();
        assert_eq!(memory.heap_bytes(), 0);
        memory.reserve();
        let bytes = memory.heap_bytes();
        assert!((45_000..55_000).contains(&bytes), "{bytes}");
    }
}
