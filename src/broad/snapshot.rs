//! Feature `serde`: what of a structure has to be kept so that it goes on as if nothing had happened.
//!
//! Events depend on boxes and ids alone, so bodies and pair slots are all there is to keep; columns and sorted lists are
//! made anew. What is read is checked, so that no text makes a structure that could panic.

use super::body::BodiesState;
use super::ledger::Ledger;
use super::pairs::PairsState;
use super::{PencilSweep, Settings, SortedAxes};
use alloc::string::String;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

/// The serialized form of every structure.
#[derive(Serialize, Deserialize)]
struct Snapshot {
    bodies: BodiesState,
    pairs: PairsState,
    parallel_from: usize,
}

impl Snapshot {
    fn of(ledger: &Ledger, parallel_from: usize) -> Self {
        Self {
            bodies: ledger.bodies.state(),
            pairs: ledger.pairs.state(),
            parallel_from,
        }
    }

    fn restored(self) -> Result<(Ledger, usize), String> {
        let settings = Settings::default();
        let mut ledger = Ledger::new(settings.origin);
        let parallel_from = self.parallel_from;
        ledger.bodies = self.bodies.restored()?;
        ledger.pairs = self.pairs.restored(ledger.bodies.records.len())?;
        Ok((ledger, parallel_from))
    }
}

impl Serialize for PencilSweep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Snapshot::of(&self.ledger, self.parallel_from).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for PencilSweep {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (ledger, parallel_from) = Snapshot::deserialize(deserializer)?
            .restored()
            .map_err(D::Error::custom)?;
        Ok(Self::from_ledger(ledger, parallel_from))
    }
}

impl Serialize for SortedAxes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Snapshot::of(&self.ledger, Settings::default().parallel_from).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for SortedAxes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (ledger, _) = Snapshot::deserialize(deserializer)?
            .restored()
            .map_err(D::Error::custom)?;
        Ok(Self::from_ledger(ledger))
    }
}
