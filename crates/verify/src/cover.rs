//! Certificates that cover an interval of time, for every pair that is not ignored.
//!
//! **Lemma 8.** Closed intervals, each of which starts where the one before ends, cover
//! everything from the start of the first to the end of the last. The list of pairs is made here,
//! from the bodies: every pair with a body that moves and that no line ignores. A file cannot
//! leave one out.
//!
//! **Lemma 11.** A body with parts is the union of their hulls. The cells of a pair start with all
//! parts of both bodies over the interval. A cut divides the parts of one body in two, both for the
//! time that is left; the lower ones are at hand next, the others wait. What keeps all points of the
//! parts of a cell apart keeps each two of its parts apart. If no cell waits at the end, each part of A
//! was apart from each part of B at each time. A file states no cells, so it cannot leave one out.

use std::collections::BTreeMap;

use crate::Stop;
use crate::claim::all_parts;
use crate::cuts::{Cell, cut, halves};
use crate::json::Json;
use crate::motion::Span;
use crate::pairs::{missing, needed};
use crate::real::Real;
use crate::scene::Scene;

/// The claim that pairs stay apart, from the head of a receipt.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    pub(crate) span: Span,
    pub(crate) margin: Real,
}

impl Apart {
    pub(crate) fn read(head: &Json) -> Result<Self, Stop> {
        let [from, until, margin] = [
            head.get("from")?.real()?,
            head.get("until")?.real()?,
            head.get("margin")?.real()?,
        ];
        if margin < Real::ZERO || from > until {
            return Stop::bad("the margin is negative, or the interval ends before its start");
        }
        Ok(Self {
            span: Span { from, until },
            margin,
        })
    }
}

/// Numbers of parts of both bodies: the first one, and the one after the last.
pub(crate) type Parts = [[usize; 2]; 2];

impl Cell for Parts {
    fn halves(&self, side: usize, at: &Json) -> Result<Option<[Self; 2]>, Stop> {
        Ok(halves(self, side, at.whole()?))
    }
}

/// Parts, and the time up to which they are proven.
impl Cell for (Real, Parts) {
    fn halves(&self, side: usize, at: &Json) -> Result<Option<[Self; 2]>, Stop> {
        let both = self.1.halves(side, at)?;
        Ok(both.map(|both| both.map(|parts| (self.0, parts))))
    }
}

/// What is proven of one leg.
#[derive(Default)]
pub(crate) struct Cover {
    /// For each pair the cells that wait, each with the time up to which it is proven. The last one is
    /// at hand.
    waiting: BTreeMap<(usize, usize), Vec<(Real, Parts)>>,
}

impl Cover {
    /// Cuts the cell at hand and returns its parts, if a certificate proves what is missing of it.
    pub(crate) fn next(
        &mut self,
        scene: &Scene,
        apart: &Apart,
        pair: (usize, usize),
        span: Span,
        cuts: &[Json],
    ) -> Result<Parts, Stop> {
        let name = || scene.names(pair);
        scene.must_prove(pair)?;
        let all = || vec![(apart.span.from, all_parts(scene, pair))];
        let waiting = self.waiting.entry(pair).or_insert_with(all);
        cut(waiting, cuts, name)?;
        let Some((start, parts)) = waiting.last() else {
            return Stop::fails(format!("{}: a proof after the last one", name()));
        };
        if span.from != *start || span.until < *start || span.until > apart.span.until {
            let (name, from, until) = (name(), span.from.shown(), start.shown());
            return Stop::fails(format!("{name}: a proof from t = {from}, after one until t = {until}"));
        }
        Ok(*parts)
    }

    /// Adds a proof of the cell at hand.
    pub(crate) fn add(&mut self, apart: &Apart, pair: (usize, usize), until: Real) {
        let Some(waiting) = self.waiting.get_mut(&pair) else {
            return;
        };
        if until == apart.span.until {
            waiting.pop();
        } else if let Some(cell) = waiting.last_mut() {
            cell.0 = until;
        }
    }

    /// Checks that all pairs are proven up to the end.
    pub(crate) fn end(&self, scene: &Scene) -> Result<(), Stop> {
        for (pair, waiting) in &self.waiting {
            if let Some((until, _)) = waiting.last() {
                let (name, until) = (scene.names(*pair), until.shown());
                return Stop::fails(format!("{name} is proven until t = {until} only"));
            }
        }
        if self.waiting.len() == needed(scene).0 {
            return Ok(());
        }
        missing(scene, |pair| self.waiting.contains_key(pair))
    }
}
