//! The depth from the surface of the last answer.
//!
//! Taken up at another pose, a surface on points of the difference is as good a proof as any, once it is known to be about the
//! origin. It is if it is closed and every triangle is seen from behind (each ray then meets only triangles that count one way). Where
//! all of them are beyond the facet, the depth is proven in one pass, or by the facet itself where that covers the others
//! ([`cover`](super::cover)); else it grows; a surface that has folded is dropped.

use crate::num::scalar::{Vec3, sub};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::outcome::{Class, Outcome, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::FeaturePair;
use crate::tolerance::{AGREE_DEPTH, SHIFTS};

use crate::depth::facet::{facets, height_of};
use crate::depth::facet_disc::{holds_disc, pierced, radius};
use crate::depth::foot::{Witnesses, flush, foot};
use crate::depth::memory::{MOST_POINTS, Memory, Room};
use crate::depth::result::{Best, End, Found};
use crate::depth::search::{Search, search};
use crate::depth::take;
use crate::depth::verify_surface::{Pass, pass};
use crate::tuning::depth::{FEW_POINTS, FEW_WEAK};

/// The depth from the surface of the last answer; nothing is said of bodies that it no longer proves to overlap.
pub(crate) fn resume(posed: &PosedPair, memory: &mut Memory, outcome: &mut Outcome) -> bool {
    let Some(facet) = memory.facet.filter(|f| f.is_of(posed.a, posed.b)) else {
        return false;
    };
    let frame = Transform::of(posed);
    let Some((normal, height)) = height_of(posed, &frame, facet) else {
        return false;
    };
    let best = Best {
        normal,
        height,
        features: Some(facet),
    };
    memory.within(|memory, room| {
        if memory.triangles.is_empty() {
            begin_anew(posed, &frame, memory, room, outcome)
        } else if memory.points.len() <= FEW_POINTS {
            resume_among::<FEW_POINTS>(posed, &frame, (memory, room), best, outcome)
        } else {
            resume_among::<MOST_POINTS>(posed, &frame, (memory, room), best, outcome)
        }
    })
}

/// The same, of a surface of up to `N` points.
fn resume_among<const N: usize>(
    posed: &PosedPair,
    frame: &Transform<f64>,
    (memory, room): (&mut Memory, &mut Room),
    mut best: Best<f64>,
    outcome: &mut Outcome,
) -> bool {
    let mut places = [[0.0; 3]; N];
    for (place, &[a, b]) in places.iter_mut().zip(&memory.points) {
        let (Some(p), Some(q)) = (posed.a.points.get(a as usize), posed.b.points.get(b as usize)) else {
            return false;
        };
        *place = sub(&[p.x, p.y, p.z], &frame.point(q));
    }
    let size = posed.size();
    let mut shows = pass(&memory.triangles, &places, &best, size, &mut room.weak);
    let places = &places[..memory.points.len()];
    if let Pass::About = shows {
        if let Some(witnesses) = memory.cover(posed, frame, (&room.weak, places), &mut best) {
            (memory.facet, memory.stand) = (best.features, None);
            answer(posed, &proven(&best, witnesses, size), outcome);
            return true;
        }
        if memory.lower_beside(posed, frame, &room.weak, &mut best) {
            shows = pass(&memory.triangles, places, &best, size, &mut room.weak);
        }
    }
    let place = (places, best);
    match shows {
        Pass::Folded => begin_anew(posed, frame, memory, room, outcome),
        Pass::Stands => {
            let found = stand(posed, frame, (memory, room), place);
            answer(posed, &found, outcome);
            true
        }
        Pass::About => grow(posed, frame, (memory, room), place, outcome),
    }
}

/// What is found where every triangle is beyond the facet.
#[inline(always)]
fn stand(
    posed: &PosedPair,
    frame: &Transform<f64>,
    (memory, room): (&mut Memory, &mut Room),
    (places, best): (&[Vec3<f64>], Best<f64>),
) -> Found<f64> {
    let size = posed.size();
    match memory.stand(posed, &best) {
        Some((features, witnesses)) => Found {
            features: Some(features),
            ..proven(&best, witnesses, size)
        },
        None => {
            let radius = best.height - AGREE_DEPTH * size;
            memory.recall(room, places, radius);
            Search::resumed(posed, frame, &mut room.surface, best).stands(radius)
        }
    }
}

/// Grows the surface where it is short of the facet; whether it closed.
fn grow(
    posed: &PosedPair,
    frame: &Transform<f64>,
    (memory, room): (&mut Memory, &mut Room),
    (places, best): (&[Vec3<f64>], Best<f64>),
    outcome: &mut Outcome,
) -> bool {
    memory.recall(room, places, best.height - AGREE_DEPTH * posed.size());
    let found = Search::resumed(posed, frame, &mut room.surface, best).run(frame, 0.0);
    if found.end != End::Closed {
        outcome.work.grown += found.grown;
        return false;
    }
    answer(posed, &found, outcome);
    if found.grown > 0 {
        memory.keep(&room.surface, outcome.features, Some(memory.built));
    } else {
        memory.facet = Some(outcome.features);
    }
    true
}

/// From the features of the facet instead of a surface that has folded.
fn begin_anew(
    posed: &PosedPair,
    frame: &Transform<f64>,
    memory: &mut Memory,
    room: &mut Room,
    outcome: &mut Outcome,
) -> bool {
    let Some(facet) = memory.facet else { return false };
    match search(posed, frame, facet, &SHIFTS[..1], &mut room.surface) {
        Some(found) if found.end == End::Closed => {
            answer(posed, &found, outcome);
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
        corners: [MinkowskiPoint::default(); 3],
        witnesses: Some(witnesses),
        features: best.features,
        grown: 0,
    }
}

fn answer(posed: &PosedPair, found: &Found<f64>, outcome: &mut Outcome) {
    outcome.class = Class::Overlapping;
    outcome.solver = Solver::Surface;
    outcome.lower = f64::NEG_INFINITY;
    outcome.work.depths += 1;
    take(posed, found, outcome);
}

impl Best<f64> {
    /// Tries the facets that triangles of three points, as vertices of A and of B, may lie in; whether the difference is lower along
    /// one of them.
    fn lower(
        &mut self,
        posed: &PosedPair,
        frame: &Transform<f64>,
        triangles: impl Iterator<Item = [[u32; 3]; 2]>,
    ) -> bool {
        let before = self.height;
        for [on_a, on_b] in triangles {
            for facet in facets(posed, &on_a, &on_b).into_iter().flatten() {
                if let Some((normal, height)) = height_of(posed, frame, facet)
                    && height < self.height
                {
                    (self.normal, self.height, self.features) = (normal, height, Some(facet));
                }
            }
        }
        self.height < before
    }
}

impl Memory {
    /// Tries the facets of the weak triangles, if they are few; whether the difference is lower along one of them.
    fn lower_beside(&self, posed: &PosedPair, frame: &Transform<f64>, weak: &[u32], best: &mut Best<f64>) -> bool {
        let corners = weak.iter().map(|t| self.corners(*t));
        let names = corners.map(|at| [0, 1].map(|side| at.map(|k| self.points[k][side])));
        weak.len() <= FEW_WEAK && best.lower(posed, frame, names)
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
        posed: &PosedPair,
        frame: &Transform<f64>,
        (weak, places): (&[u32], &[Vec3<f64>]),
        best: &mut Best<f64>,
    ) -> Option<Witnesses> {
        self.disc(weak, places, best, posed.size())?;
        let corner = |k: usize| {
            let [a, b] = self.points[k];
            MinkowskiPoint { a, b, w: places[k] }
        };
        let known = (0..places.len()).map(corner);
        let axis = best.normal;
        let found = weak
            .iter()
            .find_map(|t| pierced(posed, frame, &axis, known.clone(), self.corners(*t).map(corner)));
        let names = found.map(|c| [c.map(|c| c.a), c.map(|c| c.b)]);
        best.lower(posed, frame, names.into_iter());
        let rho = self.disc(weak, places, best, posed.size())?;
        let (facet, at) = (best.features?, best.rounded());
        let witnesses = foot(posed, facet, &at)?;
        holds_disc(posed, facet, &witnesses, &at, rho).then_some(witnesses)
    }

    /// Takes over the deepest facet, and finds features that hold the witnesses: mostly its own.
    #[inline(always)]
    fn stand(&mut self, posed: &PosedPair, best: &Best<f64>) -> Option<(FeaturePair, Witnesses)> {
        let (facet, at) = (best.features?, best.rounded());
        self.facet = Some(facet);
        if self.stand.is_none()
            && let Some(witnesses) = foot(posed, facet, &at)
        {
            return Some((facet, witnesses));
        }
        self.stand_elsewhere(posed, facet, &at)
    }

    /// The features of the last answer, the facet's own or, of faces flush on each other, others.
    #[cold]
    #[inline(never)]
    fn stand_elsewhere(
        &mut self,
        posed: &PosedPair,
        facet: FeaturePair,
        at: &(Vec3<f64>, f64),
    ) -> Option<(FeaturePair, Witnesses)> {
        let old = self.stand.take().filter(|f| f.is_of(posed.a, posed.b));
        let held = |f: FeaturePair| Some((f, foot(posed, f, at)?));
        let own = || held(facet).or_else(|| flush(posed, facet, at));
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
}
