//! A body as distances of points, and the cells that may meet it.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::{Ball, CoverError};
use crate::base::num::extremes::{Extremes, largest};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{COVER, COVER_CELL};
use crate::pair::point::PointOutcome;
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};
use crate::point::{PointQuery, PointTracker};

/// Most halvings of a cell: the slack of cells is derived for them.
pub(super) const DEPTH: u32 = 90;

/// A box with sides along the axes, without its slack.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxCell {
    pub(super) center: Point3<f64>,
    half: Vector3<f64>,
}

/// A body whose points are measured, and the root cell, which contains it.
pub(super) struct Body<'a> {
    query: PointQuery<'a>,
    tracker: PointTracker,
    pub(super) kind: GeometryKind,
    pub(super) root: BoxCell,
    /// A cell is its box enlarged by this on each side.
    pub(super) slack: f64,
}

impl BoxCell {
    /// Returns the two halves across the longest side.
    pub(super) fn halves(&self) -> [Self; 2] {
        let axis = self.half.imax();
        let half = {
            let mut half = self.half;
            half[axis] *= 0.5;
            half
        };
        [-1.0, 1.0].map(|side| {
            let mut center = self.center;
            center[axis] += side * half[axis];
            Self { center, half }
        })
    }
}

impl<'a> Body<'a> {
    pub(super) fn new(geometry: GeometryRef<'a>) -> Result<Self, CoverError> {
        let kind = geometry.kind();
        let (low, high) = geometry.outer_box();
        let unbounded = CoverError::Unbounded { kind };
        if kind == GeometryKind::HalfSpace {
            return Err(unbounded);
        }
        let reach = largest(low.coords.abs().iter()).larger(largest(high.coords.abs().iter()));
        let half = (high - low) * 0.5;
        let center = low + half;
        let query = PointQuery::new(geometry).prepared();
        let mut body = Self {
            query,
            tracker: PointTracker::new(),
            kind,
            root: BoxCell { center, half },
            slack: COVER_CELL * reach,
        };
        // The centre is a point that can be measured, so all points of the root are.
        body.ask(&center).ok_or(unbounded)?;
        Ok(body)
    }

    /// Returns the closest point and the signed distance; `None` beyond the range of coordinates.
    pub(super) fn ask(&mut self, p: &Point3<f64>) -> Option<PointOutcome> {
        self.tracker.closest_point(&self.query, p).ok()
    }

    /// Returns an upper bound of half the diagonal of a cell.
    pub(super) fn radius(&self, cell: &BoxCell) -> f64 {
        let half = cell.half.add_scalar(self.slack);
        sqrt(half.norm_squared()) * (1.0 + COVER)
    }

    /// Returns whether no point of the body is proven to be in a cell with this outcome of its
    /// centre.
    pub(super) fn is_empty(&self, cell: &BoxCell, outcome: &PointOutcome) -> bool {
        outcome.lower > self.radius(cell)
    }

    /// Returns the square of the distance from a point to the farthest corner of a cell, up to the
    /// relative error that `COVER` allows.
    pub(super) fn reach_squared(&self, cell: &BoxCell, from: &Point3<f64>) -> f64 {
        ((cell.center - from).abs() + cell.half.add_scalar(self.slack)).norm_squared()
    }

    /// Returns whether a ball is proven to contain a cell.
    pub(super) fn holds(&self, ball: &Ball, cell: &BoxCell) -> bool {
        self.reach_squared(cell, &ball.center) <= ball.radius * ball.radius * (1.0 - COVER)
    }

    /// Returns about `count` cells whose union contains the body, with the outcomes of their
    /// centres: all of the same size, none proven empty.
    ///
    /// There are fewer if the cells are smaller than a fraction of 2^-`levels` of the root.
    pub(super) fn cells(&mut self, count: usize, levels: u32) -> Vec<(BoxCell, PointOutcome)> {
        let (mut all, least) = (vec![self.root], self.radius(&self.root) / (1u64 << levels) as f64);
        let mut depth = 0;
        loop {
            let mut kept = Vec::with_capacity(all.len());
            for cell in &all {
                if let Some(found) = self.ask(&cell.center)
                    && !self.is_empty(cell, &found)
                {
                    kept.push((*cell, found));
                }
            }
            let is_small = kept.first().is_none_or(|(cell, _)| !(self.radius(cell) > least));
            if kept.len() >= count || is_small || depth == DEPTH {
                return kept;
            }
            depth += 1;
            all = kept.iter().flat_map(|(cell, _)| cell.halves()).collect();
        }
    }

    /// Returns an upper bound of how far a ball sticks out of the body; infinite if unknown.
    ///
    /// It is negative for a ball that is inside.
    pub(super) fn excess(&mut self, ball: &Ball) -> f64 {
        let upper = self.ask(&ball.center).map_or(f64::INFINITY, |found| found.upper);
        let sum = upper + ball.radius;
        // The sum rounds by a fraction of itself, unless the terms cancel: then it is exact or less
        // than either.
        sum + COVER * (upper.abs() + ball.radius)
    }
}
