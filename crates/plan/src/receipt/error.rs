//! Errors of the writers of receipts.

use crate::error::PlanError;
use lin_canny::GeometryKind;
use lin_canny::impact::ImpactError;

/// Error of a writer: an answer has no receipt, or its evidence is not enough for a checker.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReceiptError {
    /// Returned if a body has no form in a receipt: a Bézier surface without the feature `surfaces`.
    #[error("body {name:?} has no receipt: it is a {kind}")]
    Body {
        /// Name of the body.
        name: String,
        /// Its kind.
        kind: GeometryKind,
    },
    /// Returned if a body has more than 262,144 vertices.
    #[error("body {name:?} has {count} vertices (expected at most 262144)")]
    Vertices {
        /// Name of the body.
        name: String,
        /// Number of its vertices.
        count: usize,
    },
    /// Returned if a body has more than 262,144 triangles or pieces.
    #[error("body {name:?} has {count} triangles or pieces (expected at most 262144)")]
    Parts {
        /// Name of the body.
        name: String,
        /// Number of its triangles or pieces.
        count: usize,
    },
    /// Returned if a motion has no form in a receipt.
    #[error("the motion of {name:?} has no receipt: {why}")]
    Motion {
        /// Name of the body.
        name: String,
        /// What the motion is.
        why: &'static str,
    },
    /// Returned if nothing is claimed, because the answer is undecided.
    #[error("outcome is undecided from time {time:?} on: a receipt would claim nothing")]
    Undecided {
        /// Up to this time all pairs are proven apart.
        time: f64,
    },
    /// Returned if a motion of several pieces is blocked; [`Receipt::motion`](super::Receipt::motion)
    /// of the piece alone writes why.
    #[error("piece {piece} of the motion is not proven free")]
    Blocked {
        /// Index of the piece.
        piece: usize,
    },
    /// Returned if the motion has a tube of the coordinates around it: a receipt is about the motion itself.
    #[error("the motion has a tube of the coordinates around it (expected none, or a tube of points)")]
    Tube,
    /// Returned if a pair has no evidence that a checker would accept.
    #[error("{a} and {b} have no evidence {}: {why}", when(*.from, *.until))]
    Pair {
        /// Name of the first body.
        a: String,
        /// Name of the second body.
        b: String,
        /// Start of the time without evidence.
        from: f64,
        /// End of the time without evidence.
        until: f64,
        /// The reason.
        why: &'static str,
    },
    /// Returned if no pair is proven over a range, or no pair moves: a receipt would claim nothing.
    #[error("no pair is proven: a receipt would claim nothing")]
    Nothing,
    /// Returned if the checker or the space returns an error.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Returned if a cast is invalid.
    #[error(transparent)]
    Impact(#[from] ImpactError),
}

fn when(from: f64, until: f64) -> String {
    match from == until {
        true => format!("at time {from:?}"),
        false => format!("from time {from:?} to {until:?}"),
    }
}
