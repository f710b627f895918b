//! The distance that each pair must keep: the margin of all pairs or its own, and the paddings of both
//! bodies.

use std::vec::Vec;

use crate::cell::{Cell, check_length};
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::names::{CellBody, CellPair, Select};

/// Margins.
impl Cell {
    /// Sets the distance that every pair without an explicit margin must keep. The default is 0.
    ///
    /// # Errors
    /// Returns an error if the margin is negative or not finite.
    pub fn set_margin(&mut self, margin: f64) -> Result<(), PlanError> {
        check_length("margin", margin)?;
        self.margin = margin;
        self.changes.margin = true;
        Ok(())
    }

    /// Returns the distance that every pair without an explicit margin must keep.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// Sets the padding of bodies, and returns them: all their pairs must keep so much more.
    ///
    /// The padded body is the body with a rounded layer of this thickness. The default is 0.
    ///
    /// # Errors
    /// Returns an error if the padding is negative or not finite, or if a body does not exist. Then
    /// nothing changes.
    pub fn pad<'a>(&mut self, bodies: impl Into<Select<'a>>, padding: f64) -> Result<Vec<CellBody>, PlanError> {
        check_length("padding", padding)?;
        let found = self.select(bodies)?;
        for id in &found {
            if padding > 0.0 {
                self.paddings.insert(*id, padding);
            } else {
                self.paddings.remove(id);
            }
        }
        self.changes.note(|changes| changes.pairs_of.extend(&found));
        Ok(found)
    }

    /// Returns the padding of a body.
    #[must_use]
    pub fn padding(&self, id: CellBody) -> f64 {
        self.paddings.get(&id).copied().unwrap_or(0.0)
    }

    /// Returns the bodies with a padding above 0, in ascending order.
    pub fn paddings(&self) -> impl ExactSizeIterator<Item = (CellBody, f64)> {
        self.paddings.iter().map(|(id, padding)| (*id, *padding))
    }

    /// Returns the pairs with an explicit margin, in ascending order.
    pub fn margins(&self) -> impl ExactSizeIterator<Item = (CellPair, f64)> {
        self.margins.iter().map(|(pair, margin)| (*pair, *margin))
    }

    /// Sets or removes the explicit margin of all pairs of a body of `a` and a body of `b`, and
    /// returns the pairs. It replaces the [`margin`](Self::margin).
    ///
    /// # Errors
    /// Returns an error if the margin is negative or not finite, or if a body does not exist. Then
    /// nothing changes.
    pub fn set_pair_margin<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
        margin: Option<f64>,
    ) -> Result<Vec<CellPair>, PlanError> {
        check_length("margin of a pair", margin.unwrap_or(0.0))?;
        let pairs = self.pairs_of(a.into(), b.into())?;
        for pair in &pairs {
            match margin {
                Some(margin) => self.margins.insert(*pair, margin),
                None => self.margins.remove(pair),
            };
        }
        self.changes.note(|changes| changes.pairs.extend(&pairs));
        Ok(pairs)
    }

    /// Returns the explicit margin of a pair.
    #[must_use]
    pub fn pair_margin(&self, pair: CellPair) -> Option<f64> {
        self.margins.get(&pair).copied()
    }

    /// Returns the distance that a pair must keep: its explicit margin, or else the margin of all
    /// pairs, plus the paddings of both bodies.
    #[must_use]
    pub fn kept_distance(&self, pair: CellPair) -> f64 {
        let margin = self.pair_margin(pair).unwrap_or(self.margin);
        let pads = [pair.a, pair.b].map(|id| self.padding(id));
        if pads == [0.0; 2] {
            return margin;
        }
        // Rounded up, so that no verdict allows less than the sum.
        (margin + (pads[0] + pads[1]) * (1.0 + 2.0 * f64::EPSILON)).next_up()
    }

    /// Returns an upper bound of what a pair with an obstacle must keep without the padding of the
    /// other body, and a lower bound of what any pair must keep.
    pub(crate) fn kept_bounds(&self) -> (f64, f64) {
        let margins = || self.margins.values().copied();
        let most = margins().fold(self.margin, f64::larger);
        let pads = self
            .paddings
            .iter()
            .filter(|(id, _)| matches!(id, CellBody::Obstacle(_)));
        let pad = pads.map(|(_, pad)| *pad).fold(0.0, f64::larger);
        (most + pad, margins().fold(self.margin, f64::smaller))
    }
}
