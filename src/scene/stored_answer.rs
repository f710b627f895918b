//! What is kept of an outcome, by what is called for: nothing, the distance, all of it, or contact points besides.

use alloc::boxed::Box;

use crate::contact::Manifold;
use crate::pair::outcome::{Distance, Outcome};
use crate::polyhedron::FeaturePair;
use crate::pose::Operand;

/// What a lane keeps of an outcome.
pub(super) trait StoredAnswer: Clone + Send + Sync {
    /// Before the first outcome.
    fn blank() -> Self;
    /// Takes over what it keeps.
    fn store(&mut self, outcome: &Outcome);
    fn distance(&self) -> Option<Distance>;
    fn outcome(&self) -> Option<&Outcome>;
    /// Where contact points are kept, in the lane that has them.
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
            // Finite, since not every format of files can hold what is not.
            upper: f64::MAX,
            ..Self::starting_at(FeaturePair::vertices(Operand::A, 0, 0))
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

/// An outcome, and the contact points while the bodies are near enough for them.
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
