//! The stored part of an outcome, by level of detail: nothing, the distance, the whole outcome, or
//! the outcome with contact points.

use alloc::boxed::Box;

use crate::body::polyhedron::FeaturePair;
use crate::convex::contact::Manifold;
use crate::pair::outcome::{Distance, Outcome};

/// The part of an outcome that a table stores.
pub(super) trait StoredAnswer: Clone + Send + Sync {
    /// Returns the answer before the first outcome.
    fn blank() -> Self;
    /// Stores the part of `outcome` that this table keeps.
    fn store(&mut self, outcome: &Outcome);
    fn distance(&self) -> Option<Distance>;
    fn outcome(&self) -> Option<&Outcome>;
    /// Returns the stored contact points, in the table that has them.
    fn manifold(&mut self) -> Option<&mut Option<Box<Manifold>>> {
        None
    }
    fn contacts(&self) -> Option<&Manifold> {
        None
    }
}

impl StoredAnswer for () {
    fn blank() {}
    fn store(&mut self, _: &Outcome) {}
    fn distance(&self) -> Option<Distance> {
        None
    }
    fn outcome(&self) -> Option<&Outcome> {
        None
    }
}

impl StoredAnswer for Distance {
    fn blank() -> Self {
        Self::from(&<Outcome as StoredAnswer>::blank())
    }
    #[inline]
    fn store(&mut self, outcome: &Outcome) {
        *self = Self::from(outcome);
    }
    fn distance(&self) -> Option<Distance> {
        Some(*self)
    }
    fn outcome(&self) -> Option<&Outcome> {
        None
    }
}

impl StoredAnswer for Outcome {
    fn blank() -> Self {
        Self {
            // Finite, since not every file format can hold infinity.
            upper: f64::MAX,
            ..Self::starting_at(FeaturePair::FIRST)
        }
    }
    #[inline]
    fn store(&mut self, outcome: &Outcome) {
        *self = *outcome;
    }
    fn distance(&self) -> Option<Distance> {
        Some(Distance::from(self))
    }
    fn outcome(&self) -> Option<&Outcome> {
        Some(self)
    }
}

/// An outcome, and the contact points while the bodies are within the prediction.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StoredContact {
    pub(super) outcome: Outcome,
    pub(super) manifold: Option<Box<Manifold>>,
}

impl StoredAnswer for StoredContact {
    fn blank() -> Self {
        Self {
            outcome: <Outcome as StoredAnswer>::blank(),
            manifold: None,
        }
    }
    #[inline]
    fn store(&mut self, outcome: &Outcome) {
        self.outcome = *outcome;
    }
    fn distance(&self) -> Option<Distance> {
        self.outcome.distance()
    }
    fn outcome(&self) -> Option<&Outcome> {
        Some(&self.outcome)
    }
    #[inline]
    fn manifold(&mut self) -> Option<&mut Option<Box<Manifold>>> {
        Some(&mut self.manifold)
    }
    fn contacts(&self) -> Option<&Manifold> {
        self.manifold.as_deref()
    }
}
