//! Resumes the depth from the facet or the polytope of the previous query.
//!
//! A cached polytope remains a valid certificate at a new pose if it still encloses the origin. A
//! closed surface does if the origin lies behind every triangle, because every ray from the origin
//! then crosses the surface only outward. If every triangle is beyond the facet, a single pass
//! proves the depth. If the facet covers the triangles below target, the facet itself proves it
//! ([`facet`](super::facet)). A polytope that proves nothing grows. A folded polytope is dropped,
//! unless the nearest facet alone proves the depth ([`nearest`](super::nearest)). The method that
//! proved the last depth runs first.

use crate::base::num::each::Each;
use crate::base::num::scalar::{Vec3, sub};
use crate::base::tolerance::{AGREE_DEPTH, ORIGIN_SHIFTS};
use crate::body::polyhedron::{FeaturePair, VertexId};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::draft::Draft;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

use crate::convex::depth::descent::{WitnessPoints, flush, foot};
use crate::convex::depth::facet::{disc_radius, holds_disc, pierced_facet};
use crate::convex::depth::memory::{MAX_POINTS, Memory, Scratch};
use crate::convex::depth::nearest::{NearestFeature, nearest_facet};
use crate::convex::depth::polytope::{SurfaceState, verify_surface};
use crate::convex::depth::search::{Best, DepthSearch, SearchEnd, SearchResult, search, search_from};
use crate::convex::depth::write_overlap;
use crate::pair::difference::DifferenceFacet;

/// Number of points up to which a resumed polytope uses a small array, which costs less to clear.
const FEW_POINTS: usize = 34;

/// Up to this number of weak triangles, they count as facets next to the last deepest facet, and
/// are tried before the polytope grows.
const FEW_TRIANGLES: usize = 2;

/// Resumes the depth from the deepest facet and the cached polytope. Without a proof there is no
/// result about the bodies.
pub(crate) fn resume(posed: &PosedPair, memory: &mut Memory, draft: &mut Draft) -> NearestFeature {
    let Some(features) = memory.facet_of(posed) else {
        return NearestFeature::Open(None);
    };
    let frame = Transform::of(posed);
    if memory.triangles.is_empty() {
        return match nearest_facet(posed, features, memory, draft) {
            NearestFeature::Open(_) => {
                memory.with_scratch(|memory, scratch| restart(posed, &frame, memory, scratch, draft))
            }
            done => done,
        };
    }
    let of_facet = |facet: DifferenceFacet| {
        let (normal, height) = facet.height(posed, &frame)?;
        Some(Best {
            normal,
            height,
            facet: Some(facet),
        })
    };
    let Some(best) = DifferenceFacet::of(features).and_then(of_facet) else {
        return NearestFeature::Open(None);
    };
    memory.with_scratch(|memory, scratch| {
        if memory.points.len() <= FEW_POINTS {
            resume_with::<FEW_POINTS>(posed, &frame, memory, scratch, best, draft)
        } else {
            resume_with::<MAX_POINTS>(posed, &frame, memory, scratch, best, draft)
        }
    })
}

/// Resumes from a cached polytope of at most `N` points. If it proves nothing, the nearest facet is
/// tested before the polytope grows.
fn resume_with<const N: usize>(
    posed: &PosedPair,
    frame: &Transform<f64>,
    memory: &mut Memory,
    scratch: &mut Scratch,
    mut best: Best<f64>,
    draft: &mut Draft,
) -> NearestFeature {
    let mut positions = [[0.0; 3]; N];
    for (position, &[a, b]) in positions.iter_mut().zip(&memory.points) {
        let (Some(p), Some(q)) = (posed.a.points.get(a.index()), posed.b.points.get(b.index())) else {
            return NearestFeature::Open(None);
        };
        *position = sub(&[p.x, p.y, p.z], &frame.point(q));
    }
    let (size, target) = (posed.size(), best.height);
    let mut state = verify_surface(&memory.triangles, &positions, &best, size, &mut scratch.below_target);
    let positions = &positions[..memory.points.len()];
    if state != SurfaceState::Proven {
        let Some(facet) = best.facet else {
            return NearestFeature::Open(None);
        };
        match nearest_facet(posed, facet.features(), memory, draft) {
            NearestFeature::Open(nearest) => best.try_facet(posed, frame, nearest.unwrap_or(facet)),
            done => return done,
        }
    }
    if state == SurfaceState::Encloses {
        if let Some(witnesses) = memory.prove_by_disc(posed, frame, &scratch.below_target, positions, &mut best) {
            (memory.facet, memory.witness_features) = (best.facet.map(DifferenceFacet::features), None);
            write_overlap(posed, &SearchResult::proven(&best, witnesses, size), draft);
            return NearestFeature::Proven;
        }
        memory.try_facets_of(posed, frame, &scratch.below_target, &mut best);
        if best.height < target {
            state = verify_surface(&memory.triangles, positions, &best, size, &mut scratch.below_target);
        }
    }
    match state {
        SurfaceState::Folded => restart(posed, frame, memory, scratch, draft),
        SurfaceState::Proven => {
            let found = finish(posed, frame, memory, scratch, positions, best);
            write_overlap(posed, &found, draft);
            NearestFeature::Proven
        }
        SurfaceState::Encloses => grow(posed, frame, memory, scratch, positions, best, draft),
    }
}

/// Returns the result if every triangle is beyond the facet.
#[inline(always)]
fn finish(
    posed: &PosedPair,
    frame: &Transform<f64>,
    memory: &mut Memory,
    scratch: &mut Scratch,
    positions: &[Vec3<f64>],
    best: Best<f64>,
) -> SearchResult<f64> {
    let size = posed.size();
    match memory.find_witnesses(posed, &best) {
        Some((features, witnesses)) => SearchResult {
            features: Some(features),
            ..SearchResult::proven(&best, witnesses, size)
        },
        None => {
            let radius = best.height - AGREE_DEPTH * size;
            memory.recall(scratch, positions, radius);
            DepthSearch::resumed(posed, frame, &mut scratch.surface, best).proven(radius)
        }
    }
}

/// Grows the polytope at the triangles below target.
fn grow(
    posed: &PosedPair,
    frame: &Transform<f64>,
    memory: &mut Memory,
    scratch: &mut Scratch,
    positions: &[Vec3<f64>],
    best: Best<f64>,
    draft: &mut Draft,
) -> NearestFeature {
    memory.recall(scratch, positions, best.height - AGREE_DEPTH * posed.size());
    let found = DepthSearch::resumed(posed, frame, &mut scratch.surface, best).run(frame, 0.0);
    if found.end != SearchEnd::Closed {
        draft.work.points_added += found.points_added;
        return NearestFeature::Open(None);
    }
    write_overlap(posed, &found, draft);
    if found.points_added > 0 {
        memory.keep(&scratch.surface, draft.features, Some(memory.built));
    } else {
        memory.facet = Some(draft.features);
    }
    NearestFeature::Proven
}

/// Searches again from the features of the facet, instead of from a folded polytope.
fn restart(
    posed: &PosedPair,
    frame: &Transform<f64>,
    memory: &mut Memory,
    scratch: &mut Scratch,
    draft: &mut Draft,
) -> NearestFeature {
    let Some(facet) = memory.facet else {
        return NearestFeature::Open(None);
    };
    let surface = &mut scratch.surface;
    let seeded = DifferenceFacet::of(facet).and_then(|facet| search_from(posed, frame, facet, surface));
    match seeded.or_else(|| search(posed, frame, facet, &ORIGIN_SHIFTS[..1], surface)) {
        Some(found) if found.end == SearchEnd::Closed => {
            write_overlap(posed, &found, draft);
            memory.keep(&scratch.surface, draft.features, None);
            NearestFeature::Proven
        }
        _ => NearestFeature::Open(None),
    }
}

impl Best<f64> {
    /// Tries the facets that may contain triangles, each given by three vertices of A and of B.
    fn try_facets(
        &mut self,
        posed: &PosedPair,
        frame: &Transform<f64>,
        triangles: impl Iterator<Item = [[VertexId; 3]; 2]>,
    ) {
        for [on_a, on_b] in triangles {
            for facet in DifferenceFacet::at(posed, &on_a, &on_b).into_iter().flatten() {
                self.try_facet(posed, frame, facet);
            }
        }
    }

    /// Makes a facet the best if the support along its normal is lower.
    fn try_facet(&mut self, posed: &PosedPair, frame: &Transform<f64>, facet: DifferenceFacet) {
        if let Some((normal, height)) = facet.height(posed, frame)
            && height < self.height
        {
            (self.normal, self.height, self.facet) = (normal, height, Some(facet));
        }
    }
}

impl Memory {
    /// Tries the facets of the triangles below target if there are few.
    fn try_facets_of(&self, posed: &PosedPair, frame: &Transform<f64>, below_target: &[u32], best: &mut Best<f64>) {
        let vertices = below_target.iter().map(|t| self.vertices(*t));
        let vertex_pairs = vertices.map(|at| [0, 1].each(|side| at.each(|k| self.points[k][side])));
        if below_target.len() <= FEW_TRIANGLES {
            best.try_facets(posed, frame, vertex_pairs);
        }
    }

    /// Returns the radius of the disc that proves the triangles below target, if it is small enough
    /// to try.
    fn disc(&self, below_target: &[u32], positions: &[Vec3<f64>], best: &Best<f64>, size: f64) -> Option<f64> {
        let triangles = below_target.iter().map(|t| self.vertices(*t).each(|k| positions[k]));
        disc_radius(triangles, best, size)
    }

    /// Makes the facet over the triangles below target the best if its support value is lower.
    /// Returns the witness points on the best facet if it covers the triangles below target. A
    /// triangle beyond the old height is beyond a lower height, so no further triangle matters.
    fn prove_by_disc(
        &self,
        posed: &PosedPair,
        frame: &Transform<f64>,
        below_target: &[u32],
        positions: &[Vec3<f64>],
        best: &mut Best<f64>,
    ) -> Option<WitnessPoints> {
        self.disc(below_target, positions, best, posed.size())?;
        let vertex = |k: usize| {
            let [a, b] = self.points[k];
            MinkowskiPoint { a, b, w: positions[k] }
        };
        let known = (0..positions.len()).map(vertex);
        let axis = best.normal;
        let found = below_target
            .iter()
            .find_map(|t| pierced_facet(posed, frame, &axis, known.clone(), self.vertices(*t).each(vertex)));
        let vertex_pairs = found.map(|c| [c.each(|c| c.a), c.each(|c| c.b)]);
        best.try_facets(posed, frame, vertex_pairs.into_iter());
        let rho = self.disc(below_target, positions, best, posed.size())?;
        let (facet, at) = (best.facet?, best.rounded());
        let witnesses = foot(posed, facet, &at)?;
        holds_disc(posed, facet, &witnesses, &at, rho).then_some(witnesses)
    }

    /// Makes the deepest facet the current facet, and returns features with witness points: usually
    /// those of the facet.
    #[inline(always)]
    fn find_witnesses(&mut self, posed: &PosedPair, best: &Best<f64>) -> Option<(FeaturePair, WitnessPoints)> {
        let (facet, at) = (best.facet?, best.rounded());
        self.facet = Some(facet.features());
        if self.witness_features.is_none()
            && let Some(witnesses) = foot(posed, facet, &at)
        {
            return Some((facet.features(), witnesses));
        }
        self.find_other_witnesses(posed, facet, &at)
    }

    /// Returns witness points on the features of the previous outcome, on those of the facet or, if
    /// faces are flush, on another feature pair.
    #[cold]
    #[inline(never)]
    fn find_other_witnesses(
        &mut self,
        posed: &PosedPair,
        facet: DifferenceFacet,
        at: &Best<f64>,
    ) -> Option<(FeaturePair, WitnessPoints)> {
        let old = self.witness_features.take().filter(|f| f.is_of(posed.a, posed.b));
        let held = |f: DifferenceFacet| Some((f, foot(posed, f, at)?));
        let own = || held(facet).or_else(|| flush(posed, facet, at));
        let (found, witnesses) = old.and_then(DifferenceFacet::of).and_then(held).or_else(own)?;
        let features = Some(found.features());
        // A different vertex on the same face gives the same facet.
        if found.is_on_face_of(facet) {
            self.facet = features;
        } else {
            self.witness_features = features;
        }
        Some((found.features(), witnesses))
    }
}
