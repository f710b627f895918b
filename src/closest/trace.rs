//! The way of a walk, for those who want to see it: the same walk, watched.

use alloc::vec::Vec;

use super::outcome::{Outcome, Work};
use super::placed::Placed;
use super::seed;
use super::walk::watched;
use crate::polyhedron::FeaturePair;

/// The pairs of features that the walk from `start`, or from the first start, looks at, and whether it ended on the
/// last of them rather than giving up there.
pub(crate) fn trace(placed: &Placed, start: Option<FeaturePair>) -> (Vec<FeaturePair>, bool) {
    let mut way = Vec::new();
    let mut outcome = Outcome::open(start.unwrap_or_else(|| seed::cold(placed, &mut Work::default())));
    let ended = placed.has_one_unit() && watched::<true>(placed, &mut outcome, |pair| way.push(pair));
    (way, ended)
}
