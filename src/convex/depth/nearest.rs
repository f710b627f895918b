//! The depth from the nearest facet alone: a descent, and then the proof by a pyramid. Also the
//! local depth, with the proof of an overlap.
//!
//! Costs about as much as a walk and proves most overlaps that are shallow compared with the size
//! of the facets. The polytope proves the others: deep overlaps, feet near the boundary of a facet,
//! facets that are nearest only in their neighbourhood.
//!
//! # Local depth
//!
//! A local depth is the height of a facet of P = A - B that is the nearest in its neighbourhood
//! ([`local_depth`]).
//!
//! The height of any facet is an upper bound of the depth, because the facet lies in a supporting
//! plane. A descent finds the facet ([`descent`](super::descent)). The overlap remains to be
//! proven: by the pyramid over the facet, whose apex is the difference of two points inside the
//! bodies, or otherwise by four points around the origin ([`OverlapProof`]), which are kept.
//!
//! The pyramid lies in P, so the distance of its nearest side is a lower bound of the depth. If no
//! side is nearer than the facet, the depth is the height. [`pyramid`](super::pyramid) does more to
//! prove the depth: it continues beyond sides that are too near. Here the bounds of the depth are
//! not tight in that case.

use crate::base::tolerance::AGREE_DEPTH;
use crate::body::polyhedron::FeaturePair;
use crate::convex::depth::descent::{Descent, LowFacet, descend, flush, foot};
use crate::convex::depth::memory::Memory;
use crate::convex::depth::pyramid::{Pyramid, proves};
use crate::convex::depth::search::{Best, SearchResult, search_from};
use crate::convex::depth::write_overlap;
use crate::convex::minimum::OverlapProof;
use crate::pair::difference::DifferenceFacet;
use crate::pair::draft::Draft;
use crate::pair::draft::unit;
use crate::pair::outcome::ContactState;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Result of a search from cached state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NearestFeature {
    /// The depth is written, with bounds as tight as the request requires.
    Proven,
    /// The bodies seem to be separated; the features are a start for the walk.
    Apart(FeaturePair),
    /// The nearest facet is within rounding of the origin: the draft contains features, witness
    /// points and direction of the touch.
    Touch,
    /// None of these. The facet on which a descent ended, if any, is a start for a search.
    Open(Option<DifferenceFacet>),
}

/// Searches for the nearest facet from the features `from`, and writes the depth if proven.
pub(crate) fn nearest_facet(
    posed: &PosedPair,
    from: FeaturePair,
    memory: &mut Memory,
    draft: &mut Draft,
) -> NearestFeature {
    depth_at_facet(posed, from, memory, draft, |facet, memory, _| {
        let found = prove(posed, facet);
        if found.is_none() && !memory.is_empty() {
            memory.move_to(facet.facet);
        }
        found
    })
}

/// Writes the depth that `prove` finds at the facet on which a descent from the features `from`
/// ends.
#[inline(always)]
fn depth_at_facet(
    posed: &PosedPair,
    from: FeaturePair,
    memory: &mut Memory,
    draft: &mut Draft,
    prove: impl FnOnce(&LowFacet, &mut Memory, &mut Draft) -> Option<SearchResult<f64>>,
) -> NearestFeature {
    if !posed.same_scale() {
        return NearestFeature::Open(None);
    }
    let facet = match descend(posed, from, &mut draft.work.facets) {
        Descent::Facet(facet) => facet,
        Descent::Outside(facet) => return NearestFeature::Apart(facet.features()),
        Descent::Lost => return NearestFeature::Open(None),
    };
    let Some(found) = prove(&facet, memory, draft) else {
        return touch_or_open(posed, &facet, draft);
    };
    // The next query tests the facet before a polytope.
    memory.clear();
    memory.move_to(facet.facet);
    write_overlap(posed, &found, draft);
    NearestFeature::Proven
}

/// Returns the result for a facet that proves no depth: a touch, or a start for a search.
pub(super) fn touch_or_open(posed: &PosedPair, facet: &LowFacet, draft: &mut Draft) -> NearestFeature {
    if writes_touch(posed, facet, draft) {
        NearestFeature::Touch
    } else {
        NearestFeature::Open(Some(facet.facet))
    }
}

/// Writes the touch of bodies at a facet that is no higher than rounding; returns false for a
/// higher facet.
fn writes_touch(posed: &PosedPair, facet: &LowFacet, draft: &mut Draft) -> bool {
    let low = facet.support.filter(|at| at.1 <= AGREE_DEPTH * posed.size());
    let best = low.map(|(normal, height)| Best {
        normal,
        height,
        facet: Some(facet.facet),
    });
    let Some((best, witnesses)) = best.and_then(|best| Some((best, foot(posed, facet.facet, &best)?))) else {
        return false;
    };
    draft.state = ContactState::Touching;
    draft.features = facet.facet.features();
    draft.normal = unit(&best.normal.into());
    [draft.point_on_a, draft.point_on_b] = witnesses;
    true
}

/// Searches for the depth of bodies not yet known to overlap, from a facet. Returns false, without
/// a result about the bodies, if the search does not close.
#[cold]
pub(crate) fn depth_from(posed: &PosedPair, facet: DifferenceFacet, memory: &mut Memory, draft: &mut Draft) -> bool {
    let frame = Transform::of(posed);
    memory.with_scratch(|memory, scratch| {
        let Some(found) = search_from(posed, &frame, facet, &mut scratch.surface) else {
            return false;
        };
        write_overlap(posed, &found, draft);
        memory.keep(&scratch.surface, draft.features, None);
        true
    })
}

/// Returns the depth if the facet proves the depth.
fn prove(posed: &PosedPair, facet: &LowFacet) -> Option<SearchResult<f64>> {
    let best = facet.best(posed)?;
    if !proves(posed, facet.facet, &best) {
        return None;
    }
    let witnesses = foot(posed, facet.facet, &best.rounded())?;
    Some(SearchResult::proven(&best, witnesses, posed.size()))
}

impl LowFacet {
    /// Returns normal and height of the facet; `None` if the features have no normal.
    #[inline(always)]
    pub(super) fn best(&self, posed: &PosedPair) -> Option<Best<f64>> {
        let of_features = || self.facet.height(posed, &Transform::of(posed));
        let (normal, height) = self.support.or_else(of_features)?;
        Some(Best {
            normal,
            height,
            facet: Some(self.facet),
        })
    }
}

/// Writes the height of the facet on which a descent from the features `from` ends, if the bodies
/// are proven to overlap.
pub(crate) fn local_depth(
    posed: &PosedPair,
    from: FeaturePair,
    memory: &mut Memory,
    proof: &mut Option<OverlapProof>,
    draft: &mut Draft,
) -> NearestFeature {
    depth_at_facet(posed, from, memory, draft, |facet, _, draft| {
        overlap_at(posed, facet, proof, draft)
    })
}

/// Returns the height of a facet as the depth if the bodies are proven to overlap.
#[inline(always)]
fn overlap_at(
    posed: &PosedPair,
    facet: &LowFacet,
    proof: &mut Option<OverlapProof>,
    draft: &mut Draft,
) -> Option<SearchResult<f64>> {
    let (facet, best) = (facet.facet, facet.best(posed)?);
    let at = best.rounded();
    let own = foot(posed, facet, &at).map(|witnesses| (facet, witnesses));
    let (witness_facet, witnesses) = own.or_else(|| flush(posed, facet, &at))?;
    let radius = match Pyramid::new(posed, facet, &best).radius() {
        Some(radius) => radius,
        None if is_enclosed(posed, facet.features(), proof, draft) => 0.0,
        None => return None,
    };
    Some(SearchResult {
        features: Some(witness_facet.features()),
        ..SearchResult::of_facet(&best, witnesses, radius)
    })
}

/// Returns whether four points enclose the origin: the kept points, or points that the solver
/// finds.
#[cold]
fn is_enclosed(posed: &PosedPair, facet: FeaturePair, proof: &mut Option<OverlapProof>, draft: &mut Draft) -> bool {
    let mut solved = *draft;
    *proof = proof.unwrap_or_default().renewed(posed, facet, &mut solved);
    draft.work = solved.work;
    proof.is_some()
}
