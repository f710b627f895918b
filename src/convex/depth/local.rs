//! A local depth: the height of a facet of P = A - B that is the nearest in its neighbourhood.
//!
//! The height of any facet bounds the depth from above, as the facet lies in a supporting plane; a
//! descent finds the facet ([`descent`](super::descent)). What is left to prove is the overlap: by
//! the pyramid over the facet, whose apex is the difference of two points inside the bodies, else
//! by four points around the origin
//! ([`overlap_proof`](crate::convex::minimum::overlap_proof)), which are kept.
//!
//! The pyramid lies in P, so the distance of its nearest side is a lower bound of the depth, and
//! the depth is the height if no side is nearer than the facet. [`pyramid`](super::pyramid) does
//! more for a proof of the depth: it looks beyond sides that are too near. Here the depth stays
//! open.

use crate::body::polyhedron::FeaturePair;
use crate::convex::depth::descent::{Descent, LowFacet, descend};
use crate::convex::depth::foot::{flush, foot};
use crate::convex::depth::memory::Memory;
use crate::convex::depth::nearest::{NearestFeature, touch_or_open};
use crate::convex::depth::pyramid::Pyramid;
use crate::convex::depth::result::SearchResult;
use crate::convex::depth::write_overlap;
use crate::convex::minimum::overlap_proof::OverlapProof;
use crate::pair::draft::Draft;
use crate::pair::posed::PosedPair;

/// Writes the height of the facet on which a descent from the features `from` ends, if the bodies
/// are proven to overlap.
pub(crate) fn local_depth(
    posed: &PosedPair,
    from: FeaturePair,
    (memory, proof): (&mut Memory, &mut Option<OverlapProof>),
    draft: &mut Draft,
) -> NearestFeature {
    if !posed.same_scale() {
        return NearestFeature::Open(None);
    }
    let facet = match descend(posed, from, &mut draft.work.facets) {
        Descent::Facet(facet) => facet,
        Descent::Outside(facet) => return NearestFeature::Apart(facet.features()),
        Descent::Lost => return NearestFeature::Open(None),
    };
    let Some(found) = overlap_at(posed, &facet, proof, draft) else {
        return touch_or_open(posed, &facet, draft);
    };
    memory.clear();
    memory.move_to(facet.facet);
    write_overlap(posed, &found, draft);
    NearestFeature::Proven
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

/// Returns whether four points enclose the origin: those kept, or those that the solver finds.
#[cold]
fn is_enclosed(posed: &PosedPair, facet: FeaturePair, proof: &mut Option<OverlapProof>, draft: &mut Draft) -> bool {
    let mut solved = *draft;
    *proof = proof.unwrap_or_default().renewed(posed, facet, &mut solved);
    draft.work = solved.work;
    proof.is_some()
}
