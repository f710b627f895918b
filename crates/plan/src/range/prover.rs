//! Proofs of single boxes of configurations, pair by pair.

use std::boxed::Box;
use std::vec::Vec;

use nalgebra::Isometry3;

use super::chain::Chain;
use super::fingerprint;
use super::search::{CellProof, Place, Search};
use super::verdict::{RangeAnswer, RangeCell, RangeOptions};
use crate::checker::Checker;
use crate::error::PlanError;
use crate::space::ConfigurationSpace;
use crate::world::WorldPair;
use lin_canny::PairTracker;

/// What is proven about a pair over a box of configurations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BoxProof {
    /// The pair keeps its distance at each configuration.
    Free,
    /// At each configuration the pair is in contact or closer than it must keep.
    Contact,
    /// Neither, with the lower bound of the distance that was found.
    Left(f64),
}

/// Proves boxes of configurations for a pair.
pub(crate) struct PairProver<'a> {
    search: Search<'a>,
    cell: RangeCell,
    /// Whether the pair keeps its distance, if no joint of the range moves it.
    fixed: Option<bool>,
}

impl PairProver<'_> {
    /// Returns the pair.
    pub(crate) fn pair(&self) -> WorldPair {
        self.search.answer.pair
    }

    /// Returns the hash of the bodies, the joints and the distance to keep.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.search.fingerprint
    }

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
        Ok(match self.search.prove_cell(&mut self.cell)? {
            CellProof::Free => BoxProof::Free,
            CellProof::Contact => BoxProof::Contact,
            CellProof::Left => BoxProof::Left(self.cell.lower),
        })
    }

    /// Returns the coordinates that move the pair, each with the greatest displacement that it causes
    /// in the box that was left last.
    pub(crate) fn levers(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let coordinates = self.search.chain.coordinates.iter();
        coordinates.copied().zip(self.search.room.levers.iter().copied())
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Calls a function with the provers of all pairs that are measured, in ascending order.
    pub(crate) fn with_provers<R>(
        &mut self,
        low: &[f64],
        high: &[f64],
        call: impl FnOnce(&mut [PairProver<'_>]) -> Result<R, PlanError>,
    ) -> Result<R, PlanError> {
        let mut pairs: Vec<WorldPair> = self.pairs.ordered().iter().map(|k| self.pairs.all[*k].pair).collect();
        pairs.sort_unstable();
        self.with_provers_of(pairs, low, high, call)
    }

    /// Calls a function with the provers of pairs.
    pub(crate) fn with_provers_of<R>(
        &mut self,
        pairs: Vec<WorldPair>,
        low: &[f64],
        high: &[f64],
        call: impl FnOnce(&mut [PairProver<'_>]) -> Result<R, PlanError>,
    ) -> Result<R, PlanError> {
        for pair in &pairs {
            self.prepare_pair(*pair)?;
        }
        let (space, places) = (&self.space, &self.pairs.places);
        let options = RangeOptions::default();
        let chains = pairs.iter().map(|pair| self.chain(*pair, low, high));
        let chains: Vec<Chain> = chains.collect::<Result<_, _>>()?;
        let place = |pair: WorldPair| -> Box<Place<'_>> {
            Box::new(move |q: &[f64], poses: &mut Vec<Isometry3<f64>>| {
                space.place(q, poses);
                places.carry(poses);
                [pair.a, pair.b].map(|id| *places.pose(id, poses))
            })
        };
        let placers: Vec<Box<Place<'_>>> = pairs.iter().map(|pair| place(*pair)).collect();
        let range: Vec<[f64; 2]> = low.iter().zip(high).map(|(low, high)| [*low, *high]).collect();
        let mut provers = Vec::with_capacity(pairs.len());
        for ((pair, chain), place) in pairs.iter().zip(&chains).zip(&placers) {
            let shapes = self.world.shapes(*pair);
            let bodies = [pair.a, pair.b].map(|id| &self.range_bodies[&id]);
            let kept = self.world.kept_distance(*pair);
            let mut search = Search {
                shapes,
                bodies,
                fingerprint: fingerprint::of_pair(shapes, bodies, chain, kept),
                chain,
                place: &**place,
                kept,
                options: &options,
                tracker: PairTracker::new(),
                answer: RangeAnswer::new(*pair, range.clone()),
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
            provers.push(PairProver { search, cell, fixed });
        }
        call(&mut provers)
    }
}
