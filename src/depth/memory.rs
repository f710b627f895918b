//! What a tracker keeps of an overlap: the surface by the names of its points, and the deepest facet.
//!
//! Points of the difference are vertex pairs, and stay points of it whatever the pose, so a surface of them may be taken up again at
//! any other ([`resume`](mod@crate::depth::resume)).

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::num::scalar::Vec3;
use crate::pair::difference::MinkowskiPoint;
use crate::polyhedron::FeaturePair;

use crate::depth::surface::Surface;
use crate::tuning::depth::{GAIN, MOST};

/// Points of so many triangles.
pub(super) const MOST_POINTS: usize = MOST / 2 + 2;

/// A closed surface without places: each edge of a triangle is the reverse of one of its neighbour.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "Raw"))]
pub(crate) struct Memory {
    /// A vertex of each body.
    pub(super) points: Vec<[u32; 2]>,
    /// Three corners, and the triangle across the edge from corner k to corner k + 1.
    pub(super) triangles: Vec<[u8; 6]>,
    /// The features of the deepest facet.
    pub(super) facet: Option<FeaturePair>,
    /// The features that held the witnesses last, where they are not those.
    pub(super) stand: Option<FeaturePair>,
    /// With how many triangles it was built.
    pub(super) built: u32,
    /// Where surfaces grow, from the first overlap on: no part of what is remembered.
    #[cfg_attr(feature = "serde", serde(skip))]
    room: Option<Box<Room>>,
}

/// The features of the deepest facet, those that held the witnesses, with how many triangles it was built, its points, and its triangles.
type Parts<'a> = (FeaturePair, Option<FeaturePair>, u32, &'a [[u32; 2]], &'a [[u8; 6]]);

/// Lists that keep what they have taken.
#[derive(Clone, Debug)]
pub(super) struct Room {
    pub(super) surface: Surface<f64>,
    /// Triangles where it must grow.
    pub(super) weak: Vec<u32>,
}

impl PartialEq for Memory {
    fn eq(&self, o: &Self) -> bool {
        self.parts() == o.parts()
    }
}

/// The same as it comes from a file: it need not be closed.
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
    /// Nothing, where it is no surface.
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
    /// Takes room for the largest surface that is kept.
    pub(crate) fn reserve(&mut self) {
        self.points.reserve(MOST_POINTS);
        self.triangles.reserve(MOST);
        self.within(|_, room| {
            room.surface.reserve(MOST);
            room.weak.reserve(MOST);
        });
    }

    /// Does what needs room.
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

    /// Forgets the surface, not its room.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.triangles.clear();
        (self.facet, self.stand) = (None, None);
        self.built = 0;
    }

    /// Triangles kept.
    pub(crate) fn facets(&self) -> usize {
        self.triangles.len()
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.points.capacity() * size_of::<[u32; 2]>()
            + self.triangles.capacity() * size_of::<[u8; 6]>()
            + self.room.as_ref().map_or(0, |r| {
                size_of::<Room>() + r.weak.capacity() * size_of::<u32>() + r.surface.heap_bytes()
            })
    }

    /// Whether there is nothing to begin with.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.facet.is_none()
    }

    /// What is remembered, if anything.
    pub(crate) fn parts(&self) -> Option<Parts<'_>> {
        Some((self.facet?, self.stand, self.built, &self.points, &self.triangles))
    }

    /// The three corners of a triangle.
    pub(super) fn corners(&self, t: u32) -> [usize; 3] {
        let [i, j, k, ..] = self.triangles[t as usize];
        [i, j, k].map(usize::from)
    }

    /// Makes the surface to work on the one that is remembered, at its places.
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

    /// Keeps the facet and, if it is small and has not outgrown the one it came from, the surface worked on.
    pub(super) fn keep(&mut self, surface: &Surface<f64>, facet: FeaturePair, built: Option<u32>) {
        self.clear();
        self.facet = Some(facet);
        let count = surface.triangles.len();
        let built = built.unwrap_or(count as u32);
        if count > MOST || surface.points.len() > MOST || count > 2 * built as usize + GAIN {
            return;
        }
        // Points that no triangle uses any more are left behind.
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
