//! Every configuration of a range is proven, for every pair that is not ignored.
//!
//! **Lemma 10.** A cut divides a box into two boxes that share a face and together are the box, or
//! the parts of a body in two, as in lemma 11. The cells of a pair start with the range and all
//! parts. Each line first cuts the cell at hand as often as it says, where the lower part is at hand
//! next and the upper part waits, then proves the cell at hand. If no cell waits after the last line
//! of a pair, each part of A was apart from each part of B at each configuration. A file states no
//! cells, so it cannot leave one out.

use std::collections::BTreeSet;

use crate::Stop;
use crate::claim::all_parts;
use crate::cover::Parts;
use crate::cuts::{Cell, cut, halves};
use crate::json::Json;
use crate::pairs::{missing, needed};
use crate::real::Real;
use crate::scene::Scene;

/// Least and greatest value of each coordinate.
pub(crate) type Ranges = Vec<[Real; 2]>;

/// Configurations, and parts of both bodies.
impl Cell for (Ranges, Parts) {
    fn halves(&self, axis: usize, at: &Json) -> Result<Option<[Self; 2]>, Stop> {
        if let Json::Whole(_) = at {
            let both = self.1.halves(axis, at)?;
            return Ok(both.map(|both| both.map(|parts| (self.0.clone(), parts))));
        }
        let both = halves(&self.0, axis, at.real()?);
        Ok(both.map(|both| both.map(|ranges| (ranges, self.1))))
    }
}

/// The claim that pairs stay apart at all configurations, and what of it is proven.
#[derive(Clone)]
pub(crate) struct Cells {
    pub(crate) range: Ranges,
    pub(crate) margin: Real,
    /// The pair at hand, and its cells: the last one is at hand.
    now: Option<(usize, usize)>,
    waiting: Vec<(Ranges, Parts)>,
    done: BTreeSet<(usize, usize)>,
}

impl Cells {
    pub(crate) fn read(head: &Json) -> Result<Self, Stop> {
        let ends = |x: &Json| x.reals::<2>();
        let range = head
            .get("range")?
            .array()?
            .iter()
            .map(ends)
            .collect::<Result<Ranges, _>>()?;
        let margin = head.get("margin")?.real()?;
        if margin < Real::ZERO || range.len() > 1024 || range.iter().any(|[low, high]| low > high) {
            return Stop::bad("the margin is negative, or a range ends before its start, or more than 1024");
        }
        Ok(Self {
            range,
            margin,
            now: None,
            waiting: Vec::new(),
            done: BTreeSet::new(),
        })
    }

    /// Returns the cell that a line proves, and what it keeps.
    pub(crate) fn next(
        &mut self,
        scene: &Scene,
        pair: (usize, usize),
        line: &Json,
    ) -> Result<((Ranges, Parts), Real), Stop> {
        let name = || scene.names(pair);
        if self.now != Some(pair) {
            self.end_pair(scene)?;
            scene.must_prove(pair)?;
            if !self.done.insert(pair) {
                return Stop::fails(format!("{}: cells after the last cell", name()));
            }
            let all = all_parts(scene, pair);
            (self.now, self.waiting) = (Some(pair), vec![(self.range.clone(), all)]);
        }
        let cuts = line.find("cut").map_or(Ok(&[][..]), Json::array)?;
        cut(&mut self.waiting, cuts, name)?;
        let keep = line.find("keep").map_or(Ok(self.margin), Json::real)?;
        if keep < self.margin {
            return Stop::fails(format!("{}: keeps {}, less than the margin", name(), keep.shown()));
        }
        match self.waiting.pop() {
            Some(cell) => Ok((cell, keep)),
            None => Stop::fails(format!("{}: cells after the last cell", name())),
        }
    }

    fn end_pair(&mut self, scene: &Scene) -> Result<(), Stop> {
        let waiting = std::mem::take(&mut self.waiting).len();
        match self.now.take() {
            Some(pair) if waiting > 0 => Stop::fails(format!("{}: {waiting} cells without a proof", scene.names(pair))),
            _ => Ok(()),
        }
    }

    /// Checks that all pairs are proven.
    pub(crate) fn end(&mut self, scene: &Scene) -> Result<(), Stop> {
        self.end_pair(scene)?;
        match needed(scene).0 == self.done.len() {
            true => Ok(()),
            false => missing(scene, |pair| self.done.contains(pair)),
        }
    }
}
