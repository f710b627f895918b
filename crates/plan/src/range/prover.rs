//! Proofs of single boxes of configurations for a pair.

use std::vec::Vec;

use nalgebra::Isometry3;

use super::search::{BoxProof, Place, Search, fingerprint_of};
use super::verdict::{RangeAnswer, RangeCell, RangeOptions};
use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::names::CellPair;
use lin_canny::PairTracker;

/// Proves boxes of configurations for a pair.
pub(crate) struct PairProver<'a> {
    search: Search<'a>,
    cell: RangeCell,
    /// Whether the pair keeps its distance, if no joint of the range moves it.
    fixed: Option<bool>,
}

impl PairProver<'_> {
    /// Proves a box of configurations, given by all coordinates.
    pub(crate) fn prove(&mut self, low: &[f64], high: &[f64]) -> Result<BoxProof, PlanError> {
        if let Some(is_free) = self.fixed {
            return Ok(if is_free { BoxProof::Free } else { BoxProof::Contact });
        }
        let coordinates = &self.search.chain.coordinates;
        self.cell.low.clear();
        self.cell.low.extend(coordinates.iter().map(|&c| low[c]));
        self.cell.high.clear();
        self.cell.high.extend(coordinates.iter().map(|&c| high[c]));
        self.cell.lower = f64::NEG_INFINITY;
        self.cell.plane = None;
        self.search.prove_cell(&mut self.cell)
    }

    /// Returns the coordinates that move the pair, each with the greatest displacement that it causes
    /// in the box that was left last.
    pub(crate) fn levers(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let coordinates = self.search.chain.coordinates.iter();
        coordinates.copied().zip(self.search.room.levers.iter().copied())
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Calls a function with the prover of a pair over boxes within a range of all coordinates.
    pub(crate) fn with_prover<R>(
        &mut self,
        pair: CellPair,
        low: &[f64],
        high: &[f64],
        call: impl FnOnce(&mut PairProver<'_>) -> Result<R, PlanError>,
    ) -> Result<R, PlanError> {
        self.prepare_pair(pair)?;
        let (space, body_poses) = (&self.space, &self.pairs.body_poses);
        let chain = self.chain(pair, low, high)?;
        let place: &Place<'_> = &|q: &[f64], poses: &mut Vec<Isometry3<f64>>| {
            space.place(q, poses);
            body_poses.carry(poses);
            [pair.a, pair.b].map(|id| *body_poses.pose(id, poses))
        };
        let shapes = self.cell.shapes(pair);
        let bodies = [pair.a, pair.b].map(|id| &self.range_bodies[&id]);
        let kept = self.cell.required_distance(pair).distance;
        let range: Vec<[f64; 2]> = low.iter().zip(high).map(|(low, high)| [*low, *high]).collect();
        let mut search = Search {
            shapes,
            bodies,
            fingerprint: fingerprint_of(shapes, bodies, &chain, kept),
            chain: &chain,
            place,
            kept,
            options: &RangeOptions::default(),
            tracker: PairTracker::new(),
            answer: RangeAnswer::new(pair, range),
            room: Default::default(),
        };
        let fixed = match chain.is_at_a_point {
            true => {
                let values: Vec<f64> = chain.ranges.iter().map(|ends| ends[0]).collect();
                Some(!search.is_within(&values)?)
            }
            false => None,
        };
        let cell = RangeCell {
            low: Vec::new(),
            high: Vec::new(),
            lower: f64::NEG_INFINITY,
            plane: None,
            level: 0,
        };
        call(&mut PairProver { search, cell, fixed })
    }
}
