//! Paths of straight segments: length, shortening, widening.

use core::ops::{ControlFlow, Range};
use std::vec::Vec;

use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::space::ConfigurationSpace;
use crate::random::Random;
use lin_canny::Progress;

/// A path: configurations that are joined by segments.
pub type Path = Vec<Vec<f64>>;

/// Shortens a path by random shortcuts.
///
/// A shortcut joins two random points of the path by a straight segment, if this segment is
/// proven free and keeps the margin. If every segment of the input is proven free, so is every
/// segment of the result. A shortcut that starts inside a segment leaves a part of it; the parts
/// in the result are proven at the end.
pub struct Shortcuts<'a> {
    tries: usize,
    seed: u64,
    progress: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
}

impl<'a> Shortcuts<'a> {
    /// Returns the call that tries this number of shortcuts, at random places by the seed.
    #[must_use]
    pub fn new(tries: usize, seed: u64) -> Self {
        let progress = None;
        Self { tries, seed, progress }
    }

    /// Sets the progress callback. It receives the number of shortcuts that were tried, before each
    /// one and between the proofs that remove configurations. If it stops the call, the result is
    /// the path so far, with the same guarantee.
    #[must_use]
    pub fn progress(mut self, progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Returns the shortened path.
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid.
    pub fn shorten<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        path: &[Vec<f64>],
    ) -> Result<Path, PlanError> {
        let Self { tries, seed, progress } = self;
        let mut unwatched = |_| ControlFlow::Continue(());
        let progress = progress.unwrap_or(&mut unwatched);
        let mut report = |done| progress(Progress::new("shortcuts", done, Some(tries)));
        // A part of a proven segment deviates from it by rounding, so its proof rarely fails.
        if let Some(found) = checker.shortened(path, tries, seed, Parts::ProveLast, &mut report)? {
            return Ok(found);
        }
        let found = checker.shortened(path, tries, seed, Parts::ProveAtOnce, &mut report)?;
        Ok(found.unwrap_or_else(|| path.into()))
    }
}

/// Moves the inner configurations of a path away from obstacles.
///
/// Each segment is first halved until none is longer than `longest`. In each of `rounds`
/// rounds, every inner configuration moves towards larger clearance, up to `clearance`, if both
/// adjacent segments are proven free.
///
/// # Errors
/// Returns an error if a configuration is invalid or `longest` is not positive.
pub fn widen<C: ConfigurationSpace>(
    checker: &mut Checker<C>,
    path: &[Vec<f64>],
    clearance: f64,
    longest: f64,
    rounds: usize,
) -> Result<Path, PlanError> {
    if !(longest > 0.0) {
        return Err(PlanError::Value {
            what: "longest segment",
            value: longest,
        });
    }
    let mut path = checker.divided(path, longest);
    for _ in 0..rounds {
        for k in 1..path.len().saturating_sub(1) {
            checker.push(&mut path, k, clearance, longest)?;
        }
    }
    Ok(path)
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the shortened path; `None` if the proof of a part of a segment fails at the end.
    fn shortened(
        &mut self,
        path: &[Vec<f64>],
        tries: usize,
        seed: u64,
        parts: Parts,
        report: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> Result<Option<Path>, PlanError> {
        let mut random = Random::new(seed);
        let mut path = Corners::new(path);
        let mut done = 0;
        if self.thin(&mut path, &mut || report(0))?.is_continue() {
            while done < tries && path.nodes.len() > 2 && report(done).is_continue() {
                self.cut(&mut path, &mut random, parts)?;
                done += 1;
            }
            if done == tries || path.nodes.len() <= 2 {
                let _ = self.thin(&mut path, &mut || report(done))?;
            }
        }
        let ends = path.nodes.windows(2).zip(&path.is_proven);
        for (ends, _) in ends.filter(|(_, is_proven)| !**is_proven) {
            if !self.is_segment_free(&ends[0], &ends[1])? {
                return Ok(None);
            }
        }
        Ok(Some(path.nodes))
    }

    /// Removes configurations whose neighbours can be joined by a segment that is proven free, until
    /// `report` stops it.
    fn thin(
        &mut self,
        path: &mut Corners,
        report: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, PlanError> {
        let mut before = path.nodes.len() + 1;
        while path.nodes.len() < before {
            before = path.nodes.len();
            let mut k = 1;
            while k + 1 < path.nodes.len() {
                if path.is_open[k] && report().is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                if path.is_open[k] && self.is_corner_spare(&path.nodes[k - 1..=k + 1])? {
                    path.replace(k..k + 1, [], [true]);
                } else {
                    path.is_open[k] = false;
                    k += 1;
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Returns whether the first and the last of three configurations are joined by a segment that
    /// is not longer and is proven free.
    fn is_corner_spare(&mut self, corner: &[Vec<f64>]) -> Result<bool, PlanError> {
        let (from, to) = (&corner[0], &corner[2]);
        Ok(self.space.distance(from, to) <= self.space.path_length(corner) && self.is_shortcut_free(from, to)?)
    }

    /// Returns whether the segment between two points of a free path is proven free.
    ///
    /// Most shortcuts are blocked inside, and a predicate costs far less than a proof.
    fn is_shortcut_free(&mut self, from: &[f64], to: &[f64]) -> Result<bool, PlanError> {
        self.check_ends(from, to)?;
        if self.start_contact_margin.is_none() {
            for t in INSIDE {
                if !self.is_free_at(&self.space.between(from, to, t))? {
                    self.work.segments += 1;
                    return Ok(false);
                }
            }
        }
        self.is_proven_free(from, to)
    }

    /// Tries one shortcut between two points of a path.
    fn cut(&mut self, corners: &mut Corners, random: &mut Random, parts: Parts) -> Result<(), PlanError> {
        let path = &corners.nodes;
        let lengths: Vec<f64> = path.windows(2).map(|e| self.space.distance(&e[0], &e[1])).collect();
        let whole: f64 = lengths.iter().sum();
        let mut places = [random.uniform() * whole, random.uniform() * whole];
        places.sort_by(f64::total_cmp);
        let [(i, x), (j, y)] = places.map(|at| place(&lengths, at));
        if i == j {
            return Ok(());
        }
        let from = self.space.between(&path[i], &path[i + 1], x);
        let to = self.space.between(&path[j], &path[j + 1], y);
        let way: f64 = lengths[i] * (1.0 - x) + lengths[i + 1..j].iter().sum::<f64>() + lengths[j] * y;
        // A shortcut that saves almost nothing only adds configurations.
        if self.space.distance(&from, &to) > way - SAVED * whole {
            return Ok(());
        }
        let at_once = parts == Parts::ProveAtOnce;
        let is_free = self.is_shortcut_free(&from, &to)?
            && (!at_once || (self.is_segment_free(&path[i], &from)? && self.is_segment_free(&to, &path[j + 1])?));
        if is_free {
            corners.replace(i + 1..j + 1, [from, to], [at_once, true, at_once]);
        }
        Ok(())
    }

    /// Moves one configuration, and halves the displacement after each failure.
    fn push(&mut self, path: &mut Path, k: usize, clearance: f64, longest: f64) -> Result<(), PlanError> {
        let Some(near) = self.clearance(&path[k])? else {
            return Ok(());
        };
        let short = clearance - near.distance;
        let slope = near.scaled_gradient(self.space.scales());
        let square: f64 = slope.iter().map(|g| g * g).sum();
        if !(short > 0.0) || square == 0.0 {
            return Ok(());
        }
        let mut way = short.smaller(0.5 * longest);
        for _ in 0..4 {
            let parts = slope.iter().zip(self.space.scales());
            let step: Vec<f64> = parts.map(|(g, s)| g * way / (square * s)).collect();
            let moved = self.space.moved(&path[k], &step);
            let is_better = self.clearance(&moved)?.is_some_and(|n| n.distance > near.distance);
            if is_better && self.is_segment_free(&path[k - 1], &moved)? && self.is_segment_free(&moved, &path[k + 1])? {
                path[k] = moved;
                return Ok(());
            }
            way *= 0.5;
        }
        Ok(())
    }

    fn divided(&self, path: &[Vec<f64>], longest: f64) -> Path {
        let mut all: Path = path.iter().take(1).cloned().collect();
        for ends in path.windows(2) {
            let parts = (self.space.distance(&ends[0], &ends[1]) / longest).at_most(PARTS as f64) as usize + 1;
            let inner = (1..parts).map(|k| self.space.between(&ends[0], &ends[1], k as f64 / parts as f64));
            all.extend(inner);
            all.push(ends[1].clone());
        }
        all
    }
}

/// When the parts of segments that shortcuts leave are proven.
#[derive(Clone, Copy, PartialEq)]
enum Parts {
    /// Before a shortcut is accepted.
    ProveAtOnce,
    /// Those of the last path, at the end.
    ProveLast,
}

/// A path, and for each configuration whether its neighbours may be joined: they were not tried
/// since one of the three changed.
struct Corners {
    nodes: Path,
    is_open: Vec<bool>,
    /// Whether each segment was given or proven, and is not a part of such a segment.
    is_proven: Vec<bool>,
}

impl Corners {
    fn new(path: &[Vec<f64>]) -> Self {
        Self {
            nodes: path.into(),
            is_open: std::vec![true; path.len()],
            is_proven: std::vec![true; path.len().saturating_sub(1)],
        }
    }

    /// Replaces inner configurations, and the segments between their neighbours.
    fn replace<const N: usize, const M: usize>(
        &mut self,
        range: Range<usize>,
        by: [Vec<f64>; N],
        is_proven: [bool; M],
    ) {
        self.is_proven.splice(range.start - 1..range.end, is_proven);
        self.is_open[range.start - 1] = true;
        self.is_open[range.end] = true;
        self.is_open.splice(range.clone(), [true; N]);
        self.nodes.splice(range, by);
    }
}

/// Times at which a predicate tests a shortcut before it is proven.
const INSIDE: [f64; 3] = [0.5, 0.25, 0.75];

/// Part of the length of the path that a shortcut must save. On 700 problems of Panda, paths are
/// 0.1 % longer than with a thousandth and take 7 % less time; with 0.004 it is 0.3 and 8 % more.
const SAVED: f64 = 1.0 / 512.0;

/// Maximum number of parts of a divided segment.
const PARTS: usize = 1024;

/// Returns the segment that contains a point of a path, and the fraction of the segment before it.
fn place(lengths: &[f64], mut at: f64) -> (usize, f64) {
    for (k, &length) in lengths.iter().enumerate() {
        if at < length || k + 1 == lengths.len() {
            return (k, if length > 0.0 { (at / length).at_most(1.0) } else { 0.0 });
        }
        at -= length;
    }
    (0, 0.0)
}
