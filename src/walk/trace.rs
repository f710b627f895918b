//! The way of a walk, for those who want to see it: the same walk, watched.

use alloc::vec::Vec;

use crate::pair::outcome::{Outcome, Work};
use crate::pair::posed::PosedPair;
use crate::polyhedron::FeaturePair;
use crate::walk::seed;
use crate::walk::watched;

/// The pairs of features that the walk from `start`, or from the first start, looks at, and whether it ended on the
/// last of them rather than giving up there.
pub(crate) fn trace(posed: &PosedPair, start: Option<FeaturePair>) -> (Vec<FeaturePair>, bool) {
    let mut way = Vec::new();
    let mut outcome = Outcome::open(start.unwrap_or_else(|| seed::cold(posed, &mut Work::default())));
    let ended = posed.same_scale() && watched::<true>(posed, &mut outcome, |pair| way.push(pair));
    (way, ended)
}
