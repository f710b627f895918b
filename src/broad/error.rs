//! What a broad phase refuses, and how it says so.

use super::{BodyId, BoxFault};
use thiserror::Error;

/// A refused call. The body keeps the box, the pairs and the options it had; nothing else changed either.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BroadPhaseError {
    /// A bound is NaN or infinite. Boxes that reach to infinity enter by `insert_unbounded` only.
    #[error("the box of {} has a bound on axis {axis} that is not finite", Name(*.body))]
    NonFinite {
        /// The body whose box was refused; `None` for one that was to be inserted.
        body: Option<BodyId>,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The minimum of a box exceeds its maximum.
    #[error("the box of {} is inverted on axis {axis}", Name(*.body))]
    Inverted {
        /// The body whose box was refused; `None` for one that was to be inserted.
        body: Option<BodyId>,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The origin of the structure's [`Settings`](super::Settings) is NaN or infinite: it can hold no box.
    #[error("the origin of the broad phase is not finite on axis {axis}")]
    Origin {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// A margin is NaN, infinite or negative.
    #[error("the margin of a body must be finite and not negative")]
    Margin,
    /// The id was never given out by this structure, or its body was removed.
    #[error("{body} is not, or no longer, in this broad phase")]
    StaleId {
        /// The id as it was given.
        body: BodyId,
    },
    /// No more indices: a structure holds at most 2^31 - 1 bodies.
    #[error("a broad phase holds at most 2147483647 bodies")]
    TooManyBodies,
    /// No more slots: a structure names at most 2^32 - 1 pairs at once. Told by a step, see
    /// [`Events::refused`](super::Events::refused).
    #[error("the pair of {a} and {b} and {} more found no place: a broad phase names at most 4294967295 pairs", .refused - 1)]
    TooManyPairs {
        /// A member of the first pair that found no place.
        a: BodyId,
        /// The other.
        b: BodyId,
        /// How many pairs found none.
        refused: usize,
    },
}

impl BroadPhaseError {
    pub(crate) fn from_fault(fault: BoxFault, body: Option<BodyId>) -> Self {
        match fault {
            BoxFault::NonFinite { axis } => Self::NonFinite { body, axis },
            BoxFault::Inverted { axis } => Self::Inverted { body, axis },
        }
    }
}

/// What a batch refused. Every other entry of the batch was applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("entry {index} of the batch and {} more were refused: {first}", .refused - 1)]
#[non_exhaustive]
pub struct BatchError {
    /// The place in the batch of the first refused entry.
    pub index: usize,
    /// How many entries were refused in all.
    pub refused: usize,
    /// Why the first was refused.
    pub first: BroadPhaseError,
}

impl BatchError {
    /// The report on two parts of one batch, the second starting at `offset`.
    pub(crate) fn joined(first: Option<Self>, second: Option<Self>) -> Option<Self> {
        match (first, second) {
            (Some(a), Some(b)) => Some(Self {
                refused: a.refused + b.refused,
                ..a
            }),
            (a, b) => a.or(b),
        }
    }

    pub(crate) fn one(index: usize, first: BroadPhaseError) -> Self {
        Self {
            index,
            refused: 1,
            first,
        }
    }
}

struct Name(Option<BodyId>);

impl core::fmt::Display for Name {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            Some(id) => id.fmt(f),
            None => f.write_str("the body to insert"),
        }
    }
}
