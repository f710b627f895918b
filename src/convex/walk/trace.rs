//! Record of a walk for diagnosis: the walk of a query, with every tested pair listed.

use alloc::vec::Vec;

use crate::body::polyhedron::FeaturePair;
use crate::convex::walk::seed;
use crate::convex::walk::walk_observed;
use crate::pair::draft::Draft;
use crate::pair::outcome::Work;
use crate::pair::posed::PosedPair;

/// Returns the feature pairs tested by the walk from `start` (from a cold start if `None`), and
/// whether the walk accepted the last pair rather than giving up there.
pub(crate) fn trace(posed: &PosedPair, start: Option<FeaturePair>) -> (Vec<FeaturePair>, bool) {
    let mut path = Vec::new();
    let mut draft = Draft::starting_at(start.unwrap_or_else(|| seed::cold(posed, &mut Work::default())));
    let ended = posed.same_scale() && walk_observed::<true>(posed, &mut draft, |pair| path.push(pair));
    (path, ended)
}
