//! The depth from the nearest facet alone: descent, then the proof by a cone.
//!
//! Costs as much as a walk, and answers most overlaps that are shallow beside the facets of the
//! bodies. A surface answers the others: deep overlaps, feet near the rim of a facet, facets that
//! are nearest only in their neighbourhood.

use crate::depth::cone::disc_that_proves;
use crate::depth::descent::{Descent, descend};
use crate::depth::facet::height_of;
use crate::depth::facet_disc::holds_disc;
use crate::depth::foot::foot;
use crate::depth::memory::Memory;
use crate::depth::result::{Best, SearchResult};
use crate::depth::write_overlap;
use crate::pair::draft::Draft;
use crate::pair::outcome::Solver;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::FeaturePair;
use crate::tolerance::{AGREE_DEPTH, CERTIFICATE, UNIT};

/// What the nearest facet says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Nearest {
    /// The depth is proven and written.
    Proven,
    /// The bodies seem to be apart; the features are a start for the walk.
    Apart(FeaturePair),
    /// Nothing.
    Open,
}

/// Searches for the nearest facet from the features `from`, and writes the depth if proven.
pub(crate) fn nearest_facet(posed: &PosedPair, from: FeaturePair, memory: &mut Memory, draft: &mut Draft) -> Nearest {
    if !posed.same_scale() {
        return Nearest::Open;
    }
    let facet = match descend(posed, from) {
        Descent::Facet(facet) => facet,
        Descent::Outside(facet) => return Nearest::Apart(facet),
        Descent::Lost => return Nearest::Open,
    };
    let Some(found) = prove(posed, facet) else {
        return Nearest::Open;
    };
    memory.move_to(facet);
    write_overlap(posed, &found, Solver::Facet, draft);
    Nearest::Proven
}

/// Returns the depth if the facet proves the depth.
fn prove(posed: &PosedPair, facet: FeaturePair) -> Option<SearchResult<f64>> {
    let size = posed.size();
    let at = height_of(posed, &Transform::of(posed), facet)?;
    // Less the rest that the facet may lie beneath its height, the depth must certainly be positive.
    if !(at.1 > (AGREE_DEPTH + 4.0 * CERTIFICATE * UNIT) * size) {
        return None;
    }
    let rho = disc_that_proves(posed, &at)?;
    let witnesses = foot(posed, facet, &at)?;
    let best = Best {
        normal: at.0,
        height: at.1,
        features: Some(facet),
    };
    holds_disc(posed, facet, &witnesses, &at, rho).then(|| SearchResult::proven(&best, witnesses, size))
}
