//! Narrows the bounds of a penetration depth by branch and bound over translations.
//!
//! ```text
//!      .-----------.  sphere of the shortest separating translation so far
//!    .' +----+----+ '.
//!   /   |    | r  |   \   B moved by the centre c of a cell overlaps A with the depth r: no
//!  |    +----c----+    |  translation closer to c than r separates the bodies. If the cell is
//!   \   |    |    |   /   within this ball, it needs no further search. Otherwise it is split
//!    '. +----+----+ .'    into eight cells.
//!      '-----------'
//! ```
//!
//! 1. Take the open cell that is closest to the origin. No open cell is closer, so its distance
//!    from the origin is a lower bound of the depth.
//! 2. Prove a depth at its centre, by convex regions of both bodies that are kept from cell to
//!    cell, or else by the deepest point (`inner`). If the depth covers the cell, drop the cell.
//! 3. If the bodies are separated at the centre, or after they are moved on by the depth found,
//!    the translation is a new upper bound.
//! 4. Split the cell. Children beyond the upper bound are dropped.
//!
//! The number of cells grows about with the depth divided by the width, because cells are as small
//! as the width where separating translations are about as long as the shortest one.
//!
//! Source: adaptive subdivision of the space of translations, with an inner bound of the obstacle
//! in it (Zhang, Kim, Varadhan and Manocha 2007). Departure: the inner bound is proven.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::inner::{self, ProvenDepth, Regions};
use super::{BEYOND, CELL_REACH, FoundAtPose, PenetrationSearch};
use crate::base::num::Ranked;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::pair::options::QueryOptions;

/// Default number of cells that may be split.
const SPLITS: usize = 1000;

/// Largest number of cells that may be split; open cells take 400 bytes for each of them.
const MOST_SPLITS: usize = 1 << 20;

/// Largest number of pairs of convex regions that are kept.
const KEPT_REGIONS: usize = 64;

/// The square root of 3, rounded up: half the diagonal of a cube of side 2.
const HALF_DIAGONAL: f64 = 1.732_050_807_568_877_6;

/// Factor that makes up for the rounding of the distance of a cell from the origin.
const SHORTER: f64 = 1.0 - 8.0 * UNIT;

/// How far the bounds are narrowed.
#[derive(Clone, Copy)]
pub(crate) struct Narrowing {
    /// The largest width of the interval, in the caller's unit.
    pub(crate) width: f64,
    /// The largest number of cells that are split.
    pub(crate) splits: usize,
}

impl Narrowing {
    /// Returns the narrowing that options ask for; `None` without a width, or with NaN.
    pub(crate) fn new(options: &QueryOptions) -> Option<Self> {
        let width = options.width.filter(|width| !width.is_nan())?;
        let splits = options.splits.unwrap_or(SPLITS).min(MOST_SPLITS);
        Some(Self { width, splits })
    }
}

/// A cube of translations of B.
#[derive(Clone, Copy)]
struct TranslationCell {
    centre: Vector3<f64>,
    half: f64,
}

impl TranslationCell {
    /// Returns a lower bound of the length of its translations.
    fn shortest(&self) -> f64 {
        let gap = self.centre.map(|x| (x.abs() - self.half).at_least(0.0));
        sqrt(gap.norm_squared()) * SHORTER
    }

    /// Returns an upper bound of the length of its translations.
    fn longest(&self) -> f64 {
        let end = self.centre.map(|x| x.abs() + self.half);
        sqrt(end.norm_squared()) * BEYOND
    }

    fn children(self) -> impl Iterator<Item = Self> {
        let half = 0.5 * self.half;
        (0..8_u8).map(move |k| {
            let side = |axis: u8| if (k >> axis) & 1 == 0 { -half } else { half };
            Self {
                centre: self.centre + Vector3::new(side(0), side(1), side(2)),
                half,
            }
        })
    }
}

impl<A: Parted, B: Parted, Q: FnMut(&RelativePose) -> FoundAtPose> PenetrationSearch<'_, A, B, Q> {
    /// Narrows the bounds until they are at most `width` apart, or no more cells may be split.
    pub(super) fn narrow(&mut self, Narrowing { width, splits }: Narrowing, lower: &mut f64, best: &mut Vector3<f64>) {
        let length = |shift: &Vector3<f64>| sqrt(shift.norm_squared());
        let mut regions = alloc::vec![inner::whole_regions(self.bodies.a, self.bodies.b)];
        let all = TranslationCell {
            centre: Vector3::zeros(),
            half: length(best) * BEYOND,
        };
        let (mut open, mut count, mut left) = (BinaryHeap::new(), 0_u64, splits);
        let ranked = |rank: f64, key: u64, item: TranslationCell| Ranked { rank, key, item };
        open.push(ranked(0.0, count, all));
        while length(best) - *lower > width {
            let Some(Ranked { rank, item: cell, .. }) = open.pop() else {
                // No shorter translation separates the bodies.
                *lower = length(best) * SHORTER;
                return;
            };
            *lower = lower.larger(rank);
            if length(best) - *lower <= width {
                return;
            }
            if cell.longest() < *lower || self.covers(&cell, &mut regions, width, *lower, best) {
                continue;
            }
            if left == 0 {
                return;
            }
            left -= 1;
            for child in cell.children() {
                let rank = child.shortest();
                if rank < length(best) {
                    count += 1;
                    open.push(ranked(rank, count, child));
                }
            }
        }
    }

    /// Returns whether a depth at the centre proves that no translation of the cell separates the
    /// bodies. May find a shorter separating translation, and more regions.
    fn covers(
        &mut self,
        cell: &TranslationCell,
        regions: &mut Vec<Regions>,
        width: f64,
        lower: f64,
        best: &mut Vector3<f64>,
    ) -> bool {
        let (a, b) = (self.bodies.a, self.bodies.b);
        let radius = cell.half * HALF_DIAGONAL * BEYOND + 2.0 * self.noise;
        let Some(pose) = self.shifted(&cell.centre) else {
            return false;
        };
        let mut deepest: Option<ProvenDepth> = None;
        for k in 0..regions.len() {
            let found = inner::of_regions(a, b, &regions[k], &pose);
            if found.is_some_and(|d| d.depth > radius) {
                // Nearby cells try these regions first.
                regions[..=k].rotate_right(1);
                return true;
            }
            deepest = inner::deeper_of(deepest, found);
        }
        // The regions of two compounds are all of their pieces, which are the deepest already.
        if !matches!((a.by_kind(), b.by_kind()), (PartsRef::Pieces(_), PartsRef::Pieces(_))) {
            deepest = inner::deeper_of(deepest, self.deepest(&pose));
        }
        if deepest.is_some_and(|d| d.depth > radius) {
            return true;
        }
        let Some(found) = deepest else {
            if self.parts(&cell.centre) {
                self.offer(cell.centre, width, lower, best);
                return false;
            }
            return self.covered_at_edges(&pose, radius, regions);
        };
        let shift = cell.centre + self.longer(&found.way);
        if !self.parts(&shift) {
            return false;
        }
        let middle = self.parted.as_ref().map(|(_, on_a)| on_a - found.way * 0.5);
        self.offer(shift, width, lower, best);
        let reach = CELL_REACH * sqrt(found.way.norm_squared());
        let around = middle.and_then(|middle| inner::regions(a, b, &pose, &middle, reach));
        around.is_some_and(|around| self.keep(around, &pose, found.depth, radius, regions))
    }

    /// Returns whether regions around an edge's point inside the other body cover a cell.
    fn covered_at_edges(&mut self, pose: &RelativePose, radius: f64, regions: &mut Vec<Regions>) -> bool {
        let (a, b) = (self.bodies.a, self.bodies.b);
        let (found, windings) = inner::deepest_middle(a, b, pose);
        self.windings += windings;
        let Some((middle, depth)) = found else { return false };
        let around = inner::regions(a, b, pose, &middle, CELL_REACH * depth);
        around.is_some_and(|around| self.keep(around, pose, 0.0, radius, regions))
    }

    /// Keeps regions that prove more than `known` at a pose; returns whether they cover a cell.
    fn keep(&self, around: Regions, pose: &RelativePose, known: f64, radius: f64, regions: &mut Vec<Regions>) -> bool {
        let found = inner::of_regions(self.bodies.a, self.bodies.b, &around, pose);
        let depth = found.map_or(0.0, |d| d.depth);
        if depth > known {
            regions.truncate(KEPT_REGIONS - 1);
            regions.insert(0, around);
        }
        depth > radius
    }

    /// Takes a separating translation if it is shorter than the best one by a part of the width.
    fn offer(&mut self, shift: Vector3<f64>, width: f64, lower: f64, best: &mut Vector3<f64>) {
        let length = sqrt(best.norm_squared());
        if sqrt(shift.norm_squared()) + 0.25 * width < length {
            let shift = self.shortened(shift, lower);
            if shift.norm_squared() < best.norm_squared() {
                *best = shift;
            }
        }
    }
}
