//! Feature `serde`: the complete state of a broad phase, so that a restored one continues as if it
//! was never interrupted.
//!
//! Events depend on boxes and ids alone, so bodies and pair slots are enough; columns are rebuilt.
//! All input is checked, so no text produces a structure that panics or that
//! [`SweepAndPrune::check`] rejects.

use super::body::BodiesState;
use super::pairs::PairsState;
use super::state::BroadPhaseState;
use super::{Settings, SweepAndPrune};
use alloc::string::String;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

/// The serialized form.
#[derive(Serialize, Deserialize)]
struct BroadSnapshot {
    bodies: BodiesState,
    pairs: PairsState,
    parallel_from: usize,
}

impl BroadSnapshot {
    fn of(state: &BroadPhaseState, parallel_from: usize) -> Self {
        Self {
            bodies: state.bodies.state(),
            pairs: state.pairs.state(),
            parallel_from,
        }
    }

    fn restored(self) -> Result<(BroadPhaseState, usize), String> {
        let settings = Settings::default();
        let mut state = BroadPhaseState::new(settings.origin);
        let parallel_from = self.parallel_from;
        state.bodies = self.bodies.restored()?;
        state.pairs = self.pairs.restored(state.bodies.records.len())?;
        Ok((state, parallel_from))
    }
}

impl Serialize for SweepAndPrune {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        BroadSnapshot::of(&self.state, self.parallel_from).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for SweepAndPrune {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (state, parallel_from) = BroadSnapshot::deserialize(deserializer)?
            .restored()
            .map_err(D::Error::custom)?;
        let read = Self::from_state(state, parallel_from);
        read.check().map_err(D::Error::custom)?;
        Ok(read)
    }
}
