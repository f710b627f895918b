//! Events for a subscriber of `tracing`. Without the feature `tracing` these functions are empty.

use core::fmt::Display;

/// The walk did not answer a query: `solver` did.
#[inline(always)]
pub(crate) fn fell_back(solver: &dyn Display, steps: u32) {
    #[cfg(feature = "tracing")]
    tracing::debug!(%solver, steps, "the walk did not answer a query");
    let _ = (solver, steps);
}

/// Input is refused.
#[inline(always)]
pub(crate) fn refused(what: &'static str, why: &dyn Display) {
    #[cfg(feature = "tracing")]
    tracing::warn!(what, %why, "refused");
    let _ = (what, why);
}

/// A search ends without an answer because its budget is spent.
#[inline(always)]
pub(crate) fn spent(what: &'static str, looks: u32) {
    #[cfg(feature = "tracing")]
    tracing::warn!(what, looks, "the budget is spent");
    let _ = (what, looks);
}
