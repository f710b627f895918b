//! The answer that solvers work on, in stored units and frames.

use core::ops::{Deref, DerefMut};

use nalgebra::Unit;

use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::pair::outcome::Outcome;

/// Answer that one solver passes to the next: the fields of an [`Outcome`], in stored units and
/// frames, and not proven until a certificate accepts the bounds.
///
/// A draft is written in place and becomes an outcome at the end of the query alone
/// ([`into_outcome`](Self::into_outcome)), so no solver can return an unproven answer to a caller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draft(Outcome);

impl Draft {
    /// Returns a draft that holds the start of a solver alone.
    #[inline(always)]
    pub(crate) fn starting_at(pair: FeaturePair) -> Self {
        Self(Outcome::starting_at(pair))
    }

    /// Exchanges the bodies: the draft of B against A becomes the draft of A against B.
    pub(crate) fn swap(&mut self, b_from_a: &RelativePose) {
        self.features = self.features.swapped();
        let draft = &mut self.0;
        core::mem::swap(&mut draft.point_on_a, &mut draft.point_on_b);
        let normal = -b_from_a.rotation().tr_mul(&draft.normal);
        draft.normal = Unit::new_normalize(normal);
    }

    /// Converts stored units and frames to the caller's: the only place at which bounds change
    /// their unit. `unit` is a power of two, so only numbers that leave the normal range are
    /// rounded; bounds are rounded outward.
    #[cold]
    pub(crate) fn scale(&mut self, unit: f64, a: &ConvexPolyhedron, b: &ConvexPolyhedron) {
        self.lower = scaled_down(self.lower, unit);
        self.upper = -scaled_down(-self.upper, unit);
        self.distance *= unit;
        self.point_on_a = a.to_user(&self.point_on_a.coords);
        self.point_on_b = b.to_user(&self.point_on_b.coords);
    }

    /// Returns the finished answer, in which no zero has a sign.
    #[inline(always)]
    pub(crate) fn into_outcome(mut self) -> Outcome {
        self.0.unsign_zeros();
        self.0
    }
}

/// An outcome in the caller's units from the start, if the bodies are too far apart for a common
/// unit.
impl From<Outcome> for Draft {
    fn from(outcome: Outcome) -> Self {
        Self(outcome)
    }
}

impl Deref for Draft {
    type Target = Outcome;

    #[inline(always)]
    fn deref(&self) -> &Outcome {
        &self.0
    }
}

impl DerefMut for Draft {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Outcome {
        &mut self.0
    }
}

/// Returns the largest f64 that is no greater than `x` times a power of two.
pub(crate) fn scaled_down(x: f64, unit: f64) -> f64 {
    let y = x * unit;
    // The way back is exact, or overflows as the way there did.
    if y / unit > x { y.next_down() } else { y }
}
