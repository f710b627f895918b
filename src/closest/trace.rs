//! The way of a walk, for those who want to see it: the same walk, watched.

use alloc::vec::Vec;

use super::placed::Placed;
use super::seed;
use super::state::State;
use super::walk::watched;

/// The pairs of features that the walk from `start`, or from the first start, looks at, and whether it ended on the
/// last of them rather than giving up there.
pub(crate) fn trace(placed: &Placed, start: Option<State>) -> (Vec<State>, bool) {
    let mut way = Vec::new();
    let walk = watched::<true>(placed, start.unwrap_or_else(|| seed::facing(placed)), |s| way.push(s));
    (way, walk.found.is_some())
}
