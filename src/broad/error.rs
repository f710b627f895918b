//! Errors of the calls of a broad phase, and their messages.

use super::BodyId;
use super::aabb::BoxFault;
use crate::base::num::axis_name;
use thiserror::Error;

/// Error of a call of a broad phase; the call changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BroadPhaseError {
    /// A bound is NaN or infinite. Only `insert_unbounded` accepts infinite boxes.
    #[error("{} has a bound on axis {} that is not finite", BoxName(*.body), axis_name(*.axis))]
    NonFinite {
        /// The body whose box is invalid; `None` for a box of no body yet.
        body: Option<BodyId>,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The minimum of a box exceeds its maximum.
    #[error("{} is inverted on axis {}", BoxName(*.body), axis_name(*.axis))]
    Inverted {
        /// The body whose box is invalid; `None` for a box of no body yet.
        body: Option<BodyId>,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The origin of the [`Settings`](super::Settings) is NaN or infinite. Such a broad phase
    /// cannot contain a box.
    #[error("the origin of the broad phase is not finite on axis {}", axis_name(*.axis))]
    Origin {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The growth or the look-ahead of a body is NaN, infinite in `f32`, or negative.
    #[error("{what} of the body is out of range: {value} (expected a finite number that is not negative)")]
    Growth {
        /// `growth` or `lookahead`.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// The id is not of this broad phase, or its body was removed.
    #[error("{body} does not exist in this broad phase, or was removed")]
    StaleId {
        /// The id as given.
        body: BodyId,
    },
    /// There are too many bodies: a broad phase holds at most 2^31 - 1.
    #[error("too many bodies in the broad phase (expected at most 2147483647)")]
    TooManyBodies,
    /// There are too many pairs: a broad phase holds at most 2^32 - 1 at once. A step reports this
    /// in [`Events::refused`](super::Events::refused).
    #[error("too many pairs: {a} and {b}, and {} more (expected at most 4294967295)", .refused - 1)]
    TooManyPairs {
        /// The lower body of the first rejected pair.
        a: BodyId,
        /// The higher body of the first rejected pair.
        b: BodyId,
        /// Number of rejected pairs.
        refused: usize,
    },
}

impl BroadPhaseError {
    pub(in crate::broad) fn from_fault(fault: BoxFault, body: Option<BodyId>) -> Self {
        match fault {
            BoxFault::NonFinite { axis } => Self::NonFinite { body, axis },
            BoxFault::Inverted { axis } => Self::Inverted { body, axis },
        }
    }
}

/// Invalid entries of a batch. Every valid entry was applied.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("entry {index} of the batch and {} more are invalid: {first}", .refused - 1)]
#[non_exhaustive]
pub struct BatchError {
    /// Index in the batch of the first invalid entry.
    pub index: usize,
    /// Number of invalid entries.
    pub refused: usize,
    /// Error of the first invalid entry.
    pub first: BroadPhaseError,
}

impl BatchError {
    /// Joins the errors of two parts of one batch, the second starting at `offset`.
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

struct BoxName(Option<BodyId>);

impl core::fmt::Display for BoxName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            Some(id) => write!(f, "the box of {id}"),
            None => f.write_str("the box"),
        }
    }
}
