//! What a tracker keeps of an overlap: the surface by the names of its points, and the deepest facet.
//!
//! Points of the difference are vertex pairs, and stay points of it whatever the pose: taken up again at another pose the
//! surface is as good a proof as any, once it is known to be about the origin. It is if it is closed and every triangle is seen
//! from behind (each ray then meets only triangles that count one way). Where all of them are beyond the facet, the depth is proven
//! in one pass, or by the facet itself where that covers the others ([`cover`](super::cover)); else it grows; a surface that has folded
//! is dropped.

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::closest::outcome::{Class, Layer, Outcome};
use crate::closest::placed::{Frame, Placed};
use crate::closest::simplex::Corner;
use crate::polyhedron::FeaturePair;
use crate::scalar::{Vec3, sub};
use crate::tolerance::{AGREE_DEPTH, SHIFTS};

use super::cover::{holds_disc, pierced, radius};
use super::facet::{facets, height_of};
use super::foot::{Witnesses, flush, foot};
use super::pass::{Pass, pass};
use super::search::{Best, End, Found, Search, search};
use super::surface::Surface;
use super::take;

/// Triangles that are worth their memory: their numbers fit a byte.
const MOST: usize = 256;

/// Points of so many triangles.
const MOST_POINTS: usize = MOST / 2 + 2;

/// Points for which a small list is enough.
const FEW_POINTS: usize = 34;

/// So few weak triangles are those of a facet next to the last one.
const FEW_WEAK: usize = 2;

/// Triangles a surface may gain before it is built afresh, beside those it was built with.
const GAIN: usize = 24;

/// A closed surface without places: each edge of a triangle is the reverse of one of its neighbour.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "Raw"))]
pub(crate) struct Memory {
    /// A vertex of each body.
    points: Vec<[u32; 2]>,
    /// Three corners, and the triangle across the edge from corner k to corner k + 1.
    triangles: Vec<[u8; 6]>,
    /// The features of the deepest facet.
    facet: Option<FeaturePair>,
    /// The features that held the witnesses last, where they are not those.
    stand: Option<FeaturePair>,
    /// With how many triangles it was built.
    built: u32,
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
    weak: Vec<u32>,
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

    /// Tries the facets that triangles of three points, as vertices of A and of B, may lie in; whether the difference is lower along
    /// one of them.
    fn lower(
        &self,
        placed: &Placed,
        frame: &Frame<f64>,
        triangles: impl Iterator<Item = [[u32; 3]; 2]>,
        best: &mut Best<f64>,
    ) -> bool {
        let before = best.height;
        for [on_a, on_b] in triangles {
            for facet in facets(placed, &on_a, &on_b).into_iter().flatten() {
                if let Some((normal, height)) = height_of(placed, frame, facet)
                    && height < best.height
                {
                    (best.normal, best.height, best.features) = (normal, height, Some(facet));
                }
            }
        }
        best.height < before
    }

    /// The three corners of a triangle.
    fn corners(&self, t: u32) -> [usize; 3] {
        let [i, j, k, ..] = self.triangles[t as usize];
        [i, j, k].map(usize::from)
    }

    /// The same of few weak triangles: the facet is next to the last one.
    fn lower_beside(&self, placed: &Placed, frame: &Frame<f64>, weak: &[u32], best: &mut Best<f64>) -> bool {
        let corners = weak.iter().map(|t| self.corners(*t));
        let names = corners.map(|at| [0, 1].map(|side| at.map(|k| self.points[k][side])));
        weak.len() <= FEW_WEAK && self.lower(placed, frame, names, best)
    }

    /// The radius of the disc that covers what the weak triangles are short of, if it is worth a try.
    fn disc(&self, weak: &[u32], places: &[Vec3<f64>], best: &Best<f64>, size: f64) -> Option<f64> {
        let triangles = weak.iter().map(|t| self.corners(*t).map(|k| places[k]));
        radius(triangles, best, size)
    }

    /// Makes the facet over the weak triangles the best, if that is lower; the witnesses on the best where it covers what they are
    /// short of. What is beyond the old height is beyond a lower one, so no other triangle counts.
    fn cover(
        &self,
        placed: &Placed,
        frame: &Frame<f64>,
        (weak, places): (&[u32], &[Vec3<f64>]),
        best: &mut Best<f64>,
    ) -> Option<Witnesses> {
        self.disc(weak, places, best, placed.size())?;
        let corner = |k: usize| {
            let [a, b] = self.points[k];
            Corner { a, b, w: places[k] }
        };
        let known = (0..places.len()).map(corner);
        let axis = best.normal;
        let found = weak
            .iter()
            .find_map(|t| pierced(placed, frame, &axis, known.clone(), self.corners(*t).map(corner)));
        let names = found.map(|c| [c.map(|c| c.a), c.map(|c| c.b)]);
        self.lower(placed, frame, names.into_iter(), best);
        let rho = self.disc(weak, places, best, placed.size())?;
        let (facet, at) = (best.features?, best.rounded());
        let witnesses = foot(placed, facet, &at)?;
        holds_disc(placed, facet, &witnesses, &at, rho).then_some(witnesses)
    }

    /// Takes over the deepest facet, and finds features that hold the witnesses: mostly its own.
    #[inline(always)]
    fn stand(&mut self, placed: &Placed, best: &Best<f64>) -> Option<(FeaturePair, Witnesses)> {
        let (facet, at) = (best.features?, best.rounded());
        self.facet = Some(facet);
        if self.stand.is_none()
            && let Some(witnesses) = foot(placed, facet, &at)
        {
            return Some((facet, witnesses));
        }
        self.stand_elsewhere(placed, facet, &at)
    }

    /// The features of the last answer, the facet's own or, of faces flush on each other, others.
    #[cold]
    #[inline(never)]
    fn stand_elsewhere(
        &mut self,
        placed: &Placed,
        facet: FeaturePair,
        at: &(Vec3<f64>, f64),
    ) -> Option<(FeaturePair, Witnesses)> {
        let old = self.stand.take().filter(|f| f.is_of(placed.a, placed.b));
        let held = |f: FeaturePair| Some((f, foot(placed, f, at)?));
        let own = || held(facet).or_else(|| flush(placed, facet, at));
        let (features, witnesses) = old.and_then(held).or_else(own)?;
        let face = |f: &FeaturePair| [f.a, f.b].into_iter().find(|x| x.dimension() == 2);
        let is_same = face(&features).is_some() && face(&features) == face(&facet);
        // Another vertex on the same face names the same facet.
        if is_same && (features.a.dimension() == 2) == (facet.a.dimension() == 2) {
            self.facet = Some(features);
        } else {
            self.stand = Some(features);
        }
        Some((features, witnesses))
    }

    /// Makes the surface to work on the one that is remembered, at its places.
    fn recall(&self, room: &mut Room, places: &[Vec3<f64>], enough: f64) {
        let surface = &mut room.surface;
        surface.clear(enough);
        let points = self.points.iter().zip(places);
        surface.points.extend(points.map(|(&[a, b], &w)| Corner { a, b, w }));
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

/// The depth from the surface of the last answer; nothing is said of bodies that it no longer proves to overlap.
pub(crate) fn resume(placed: &Placed, memory: &mut Memory, outcome: &mut Outcome) -> bool {
    let Some(facet) = memory.facet.filter(|f| f.is_of(placed.a, placed.b)) else {
        return false;
    };
    let frame = Frame::of(placed);
    let Some((normal, height)) = height_of(placed, &frame, facet) else {
        return false;
    };
    let best = Best {
        normal,
        height,
        features: Some(facet),
    };
    memory.within(|memory, room| {
        if memory.triangles.is_empty() {
            begin_anew(placed, &frame, memory, room, outcome)
        } else if memory.points.len() <= FEW_POINTS {
            resume_among::<FEW_POINTS>(placed, &frame, (memory, room), best, outcome)
        } else {
            resume_among::<MOST_POINTS>(placed, &frame, (memory, room), best, outcome)
        }
    })
}

/// The same, of a surface of up to `N` points.
fn resume_among<const N: usize>(
    placed: &Placed,
    frame: &Frame<f64>,
    (memory, room): (&mut Memory, &mut Room),
    mut best: Best<f64>,
    outcome: &mut Outcome,
) -> bool {
    let mut places = [[0.0; 3]; N];
    for (place, &[a, b]) in places.iter_mut().zip(&memory.points) {
        let (Some(p), Some(q)) = (placed.a.points.get(a as usize), placed.b.points.get(b as usize)) else {
            return false;
        };
        *place = sub(&[p.x, p.y, p.z], &frame.point(q));
    }
    let size = placed.size();
    let mut shows = pass(&memory.triangles, &places, &best, size, &mut room.weak);
    let places = &places[..memory.points.len()];
    if let Pass::About = shows {
        if let Some(witnesses) = memory.cover(placed, frame, (&room.weak, places), &mut best) {
            (memory.facet, memory.stand) = (best.features, None);
            answer(placed, &proven(&best, witnesses, size), outcome);
            return true;
        }
        if memory.lower_beside(placed, frame, &room.weak, &mut best) {
            shows = pass(&memory.triangles, places, &best, size, &mut room.weak);
        }
    }
    match shows {
        Pass::Folded => begin_anew(placed, frame, memory, room, outcome),
        Pass::Stands => {
            let found = match memory.stand(placed, &best) {
                Some((features, witnesses)) => Found {
                    features: Some(features),
                    ..proven(&best, witnesses, size)
                },
                None => {
                    memory.recall(room, places, best.height - AGREE_DEPTH * size);
                    let mut search = Search::resumed(placed, frame, &mut room.surface, best);
                    search.stands(best.height - AGREE_DEPTH * size)
                }
            };
            answer(placed, &found, outcome);
            true
        }
        Pass::About => {
            memory.recall(room, places, best.height - AGREE_DEPTH * size);
            let found = Search::resumed(placed, frame, &mut room.surface, best).run(frame, 0.0);
            if found.end != End::Closed {
                return false;
            }
            answer(placed, &found, outcome);
            if found.grown > 0 {
                memory.keep(&room.surface, outcome.features, Some(memory.built));
            } else {
                memory.facet = Some(outcome.features);
            }
            true
        }
    }
}

/// From the features of the facet instead of a surface that has folded.
fn begin_anew(
    placed: &Placed,
    frame: &Frame<f64>,
    memory: &mut Memory,
    room: &mut Room,
    outcome: &mut Outcome,
) -> bool {
    let Some(facet) = memory.facet else { return false };
    match search(placed, frame, facet, &SHIFTS[..1], &mut room.surface) {
        Some(found) if found.end == End::Closed => {
            answer(placed, &found, outcome);
            memory.keep(&room.surface, outcome.features, None);
            true
        }
        _ => false,
    }
}

/// What is found where every triangle is beyond the facet and the facet holds the deepest points.
fn proven(best: &Best<f64>, witnesses: Witnesses, size: f64) -> Found<f64> {
    Found {
        end: End::Closed,
        normal: best.normal,
        height: best.height,
        radius: best.height - AGREE_DEPTH * size,
        corners: [Corner::default(); 3],
        witnesses: Some(witnesses),
        features: best.features,
        grown: 0,
    }
}

fn answer(placed: &Placed, found: &Found<f64>, outcome: &mut Outcome) {
    outcome.class = Class::Overlapping;
    outcome.layer = Layer::Surface;
    outcome.lower = f64::NEG_INFINITY;
    outcome.work.depths += 1;
    take(placed, found, outcome);
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
