//! Branch and bound over the cells of a range.

use core::cmp::Ordering;
use core::fmt::Write;
use core::ops::ControlFlow;
use std::collections::BinaryHeap;
use std::vec::Vec;

use nalgebra::{Isometry3, Vector3};

use super::bound::Scratch;
use super::chain::{Chain, PosedChain};
use super::verdict::{ClearanceWidth, RangeAnswer, RangeCell, RangeOptions, RangeVerdict};
use crate::cell::range_body::RangeBody;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::fingerprint::Fingerprint;
use crate::names::CellPair;
use crate::random::Random;
use lin_canny::{ContactState, Geometry, Outcome, PairTracker, Progress, RelativePose};

/// Number of cells that are searched before configurations are sampled, if the options have no
/// width.
const CELLS_FIRST: u64 = 32;

/// Nearest samples from which the distance is lowered, and queries of each such search. A ridge may
/// take hundreds of thousands of steps.
const STARTS: usize = 6;
const DESCENT: u64 = 3000;

/// Cells with a contact without depth after which a search without a free configuration ends: no
/// cell about such a contact is ever proven blocked.
const FLAT: u32 = 64;

/// First and last step of a search for the least distance, and its growth from step to step, in
/// units of the range of a coordinate, or of 1 if that is less.
const STEPS: [f64; 3] = [0.25, 1.0 / (1u32 << 30) as f64, 0.4];

/// A cell and what orders it: the deepest first for a verdict, the least bound first for a
/// clearance; of equal ones the latest.
struct Queued {
    key: f64,
    number: u64,
    cell: RangeCell,
}

impl PartialEq for Queued {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Queued {}
impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Queued {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key.total_cmp(&other.key).then(self.number.cmp(&other.number))
    }
}

/// Scratch memory of a search.
#[derive(Default)]
pub(super) struct Room {
    pub(super) posed: PosedChain,
    pub(super) half: Vec<f64>,
    pub(super) centre: Vec<f64>,
    /// The half-widths of a single configuration.
    none: Vec<f64>,
    pub(super) levers: Vec<f64>,
    pub(super) bounds: Scratch,
    /// The frame of the best ball bound, and the vector between the balls there.
    between: (usize, Vector3<f64>),
    poses: Vec<Isometry3<f64>>,
    queue: BinaryHeap<Queued>,
    number: u64,
    /// Cells that cannot be halved.
    stuck: Vec<RangeCell>,
}

/// What is proven about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BoxProof {
    /// The pair keeps its distance at each configuration of the cell.
    Free,
    /// At each configuration the pair is in contact or closer than it must keep.
    Contact,
    /// Neither; the levers are set.
    Left,
}

/// Returns the poses of both bodies in the world at a configuration.
pub(super) type Place<'a> = dyn Fn(&[f64], &mut Vec<Isometry3<f64>>) -> [Isometry3<f64>; 2] + 'a;

/// The search for a verdict about a pair.
pub(super) struct Search<'a> {
    pub(super) shapes: [&'a Geometry; 2],
    pub(super) bodies: [&'a RangeBody; 2],
    pub(super) chain: &'a Chain,
    pub(super) place: &'a Place<'a>,
    /// The distance that the pair must keep.
    pub(super) kept: f64,
    /// Hash of the bodies, the joints and the distance to keep.
    pub(super) fingerprint: u64,
    pub(super) options: &'a RangeOptions,
    pub(super) tracker: PairTracker,
    pub(super) answer: RangeAnswer,
    pub(super) room: Room,
}

impl RangeAnswer {
    /// Returns the answer before the first cell.
    pub(super) fn new(pair: CellPair, range: Vec<[f64; 2]>) -> Self {
        Self {
            pair,
            verdict: RangeVerdict::Open { share: 1.0 },
            coordinates: Vec::new(),
            lower: 0.0,
            upper: f64::INFINITY,
            at: range.iter().map(|[low, high]| middle(*low, *high)).collect(),
            range,
            cells: 0,
            queries: 0,
            open: Vec::new(),
            witnesses: [None, None],
            least_free: f64::INFINITY,
            has_blocked: false,
            has_samples: false,
            flat: 0,
            fingerprint: 0,
        }
    }
}

fn middle(low: f64, high: f64) -> f64 {
    (0.5 * low + 0.5 * high).clamped(low, high)
}

impl Search<'_> {
    /// Looks at cells until the pair is decided, the budget is spent or the caller stops.
    pub(super) fn run(
        mut self,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<RangeAnswer, PlanError> {
        let is_new = self.answer.cells == 0 && self.answer.open.is_empty();
        if is_new {
            self.answer.coordinates.clone_from(&self.chain.coordinates);
            self.answer.fingerprint = self.fingerprint;
            let ranges = &self.chain.ranges;
            self.answer.open.push(RangeCell {
                low: ranges.iter().map(|ends| ends[0]).collect(),
                high: ranges.iter().map(|ends| ends[1]).collect(),
                lower: f64::NEG_INFINITY,
                plane: None,
                level: 0,
            });
        }
        self.check_cells()?;
        if !matches!(self.answer.verdict, RangeVerdict::Open { .. }) {
            return Ok(self.answer);
        }
        if is_new && self.chain.is_at_a_point {
            self.at_a_point()?;
            return Ok(self.answer);
        }
        for cell in core::mem::take(&mut self.answer.open) {
            self.push(cell);
        }
        let most = self.answer.cells.saturating_add(self.options.cells);
        while !self.is_both() && self.answer.cells < most && self.answer.flat < FLAT {
            let is_due = self.options.width.is_some() || self.answer.cells >= CELLS_FIRST;
            if is_due && !self.answer.has_samples && !self.room.queue.is_empty() {
                self.answer.has_samples = true;
                self.sample()?;
                continue;
            }
            let Some(next) = self.room.queue.pop() else { break };
            self.search_cell(next.cell)?;
            let total = usize::try_from(most).ok();
            if progress(Progress::new("cells", self.answer.cells as usize, total)).is_break() {
                break;
            }
        }
        self.finish();
        Ok(self.answer)
    }

    /// Checks that the cells belong to this chain.
    fn check_cells(&self) -> Result<(), PlanError> {
        let count = self.chain.ranges.len();
        let is_own = |cell: &RangeCell| {
            let frame = cell.plane.map_or(0, |plane| plane.0);
            cell.low.len() == count && cell.high.len() == count && frame <= self.chain.len()
        };
        let is_known = self.answer.fingerprint == self.fingerprint
            && self.answer.coordinates == self.chain.coordinates
            && self.answer.open.iter().all(is_own);
        is_known.then_some(()).ok_or(PlanError::OtherRange(self.answer.pair))
    }

    fn push(&mut self, cell: RangeCell) {
        let key = match self.options.width {
            Some(_) => -cell.lower,
            None => f64::from(cell.level),
        };
        self.room.number += 1;
        let number = self.room.number;
        self.room.queue.push(Queued { key, number, cell });
    }

    fn is_both(&self) -> bool {
        self.answer.witnesses.iter().all(Option::is_some)
    }

    /// Returns the distance that a bound must exceed for a cell to be left.
    pub(super) fn target(&self) -> f64 {
        let upper = self.answer.upper;
        let wanted = match self.options.width {
            Some(ClearanceWidth::Length(width)) => upper - width,
            Some(ClearanceWidth::Share(share)) => upper - share * upper,
            None => self.kept,
        };
        // Without any distance, every bound would do.
        let wanted = if wanted < f64::INFINITY { wanted } else { self.kept };
        wanted.larger(self.kept)
    }

    /// Returns the verdict and the cells that are left.
    fn finish(&mut self) {
        let mut left: Vec<Queued> = core::mem::take(&mut self.room.queue).into_vec();
        left.sort_by_key(|queued| queued.number);
        let answer = &mut self.answer;
        answer.open = left.into_iter().map(|queued| queued.cell).collect();
        answer.open.append(&mut self.room.stuck);
        let bounds = answer.open.iter().map(|cell| cell.lower);
        let lower = bounds.fold(answer.least_free, f64::smaller).larger(0.0);
        let [free, touching] = &answer.witnesses;
        let is_blocked = answer.has_blocked || touching.is_some();
        // Cells that were proven blocked have left without a bound.
        answer.lower = if is_blocked { 0.0 } else { lower };
        answer.verdict = match (free, touching) {
            (Some(free), Some(touching)) => RangeVerdict::Both {
                free: free.clone(),
                touching: touching.clone(),
            },
            _ if !answer.open.is_empty() => RangeVerdict::Open {
                share: share(&answer.open, &self.chain.ranges),
            },
            (None, _) if is_blocked && answer.least_free == f64::INFINITY => RangeVerdict::Always,
            _ if !is_blocked => RangeVerdict::Never,
            _ => RangeVerdict::Open { share: 0.0 },
        };
        if !matches!(answer.verdict, RangeVerdict::Open { .. }) {
            answer.open.clear();
        }
    }

    /// Decides the only configuration.
    fn at_a_point(&mut self) -> Result<(), PlanError> {
        let centre: Vec<f64> = self.chain.ranges.iter().map(|ends| ends[0]).collect();
        let found = self.measure(&centre)?;
        let is_within = self.is_within(&centre)?;
        self.answer.open.clear();
        self.answer.cells = 1;
        self.answer.upper = found.upper.larger(0.0);
        self.answer.lower = if is_within { 0.0 } else { found.lower.larger(self.kept) };
        self.answer.verdict = if is_within {
            RangeVerdict::Always
        } else {
            RangeVerdict::Never
        };
        let of = usize::from(is_within);
        self.answer.witnesses[of] = Some(self.configuration(&centre));
        Ok(())
    }

    /// Returns the configuration with these values of the coordinates that move the pair.
    fn configuration(&self, values: &[f64]) -> Vec<f64> {
        let mut q: Vec<f64> = self
            .answer
            .range
            .iter()
            .map(|[low, high]| middle(*low, *high))
            .collect();
        for (&coordinate, &value) in self.chain.coordinates.iter().zip(values) {
            q[coordinate] = value;
        }
        q
    }

    fn pose(&mut self, values: &[f64]) -> Result<RelativePose, PlanError> {
        let q = self.configuration(values);
        let [a, b] = (self.place)(&q, &mut self.room.poses);
        Ok(RelativePose::new(&a, &b)?)
    }

    /// Returns the distance at placed poses.
    fn measure(&mut self, values: &[f64]) -> Result<Outcome, PlanError> {
        self.answer.queries += 1;
        let pose = self.pose(values)?;
        self.tracker.reset();
        let [a, b] = self.shapes;
        Ok(self.tracker.closest(a, b, &pose).outcome)
    }

    /// Returns whether the pair is closer than it must be, by the predicate of single configurations.
    pub(super) fn is_within(&mut self, values: &[f64]) -> Result<bool, PlanError> {
        let pose = self.pose(values)?;
        self.tracker.reset();
        let [a, b] = self.shapes;
        Ok(self.tracker.within(a, b, &pose, self.kept))
    }

    /// Keeps a configuration as a witness if there is none of its kind.
    fn witness(&mut self, values: &[f64], is_touching: bool) -> Result<(), PlanError> {
        let of = usize::from(is_touching);
        if self.answer.witnesses[of].is_none() && self.is_within(values)? == is_touching {
            self.answer.witnesses[of] = Some(self.configuration(values));
        }
        Ok(())
    }

    /// Keeps a distance if it is the least, and its configuration as a witness.
    fn note(&mut self, values: &[f64], found: &Outcome, rounding: f64) -> Result<(), PlanError> {
        let is_apart = found.state == ContactState::Separated;
        let upper = if is_apart {
            found.upper.larger(0.0) + rounding
        } else {
            0.0
        };
        if upper < self.answer.upper {
            self.answer.upper = upper;
            self.answer.at = self.configuration(values);
        }
        if found.lower > self.kept + rounding {
            self.witness(values, false)?;
        } else if !is_apart || found.upper <= self.kept + rounding {
            self.witness(values, true)?;
        }
        Ok(())
    }

    /// Measures random configurations, and lowers the distance from the nearest of them.
    fn sample(&mut self) -> Result<(), PlanError> {
        let mut random = Random::new(self.options.seed);
        self.room.none.resize(self.chain.ranges.len(), 0.0);
        self.tracker.reset();
        let mut all: Vec<(f64, Vec<f64>)> = Vec::new();
        for _ in 0..self.options.samples {
            let each = self.chain.ranges.iter();
            let values: Vec<f64> = each
                .map(|[low, high]| (low + (high - low) * random.uniform()).clamped(*low, *high))
                .collect();
            let distance = self.sampled(&values)?;
            if self.is_both() {
                return Ok(());
            }
            all.push((distance, values));
        }
        all.sort_by(|x, y| x.0.total_cmp(&y.0));
        for (distance, values) in all.into_iter().take(STARTS) {
            self.descend(distance, values)?;
            if self.is_both() {
                break;
            }
        }
        Ok(())
    }

    /// Returns the distance at a configuration. The tracker stays warm: samples are never interrupted.
    fn sampled(&mut self, values: &[f64]) -> Result<f64, PlanError> {
        self.answer.queries += 1;
        let none = &self.room.none;
        self.chain.pose_at(values, &none[..values.len()], &mut self.room.posed);
        let pose = RelativePose::from_isometry(&self.room.posed.b)?;
        let [a, b] = self.shapes;
        let found = self.tracker.closest(a, b, &pose).outcome;
        self.note(values, &found, self.room.posed.rounding)?;
        Ok(found.distance)
    }

    /// Lowers the distance along one coordinate after another, until contact.
    fn descend(&mut self, mut distance: f64, mut values: Vec<f64>) -> Result<(), PlanError> {
        let [mut step, last, factor] = STEPS;
        let most = self.answer.queries + DESCENT;
        while step > last && distance > self.kept && self.answer.queries < most {
            let mut is_lower = false;
            for k in 0..values.len() {
                let [low, high] = self.chain.ranges[k];
                for sign in [-1.0, 1.0] {
                    let mut near = values.clone();
                    near[k] = (values[k] + sign * step * (high - low).smaller(1.0)).clamped(low, high);
                    if near[k] == values[k] {
                        continue;
                    }
                    let found = self.sampled(&near)?;
                    if found < distance {
                        (distance, values, is_lower) = (found, near, true);
                        break;
                    }
                }
            }
            if !is_lower {
                step *= factor;
            }
        }
        Ok(())
    }

    /// Returns whether a bound proves a cell free.
    pub(super) fn is_free(&self, cell: &mut RangeCell, bound: f64) -> bool {
        cell.lower = cell.lower.larger(bound);
        bound > self.target()
    }

    /// Leaves a cell that was proven free.
    fn leave_free(&mut self, cell: &RangeCell) -> Result<(), PlanError> {
        self.answer.least_free = self.answer.least_free.smaller(cell.lower);
        if self.answer.witnesses[0].is_none() {
            self.witness_centre(false)?;
        }
        Ok(())
    }

    fn witness_centre(&mut self, is_touching: bool) -> Result<(), PlanError> {
        let centre = core::mem::take(&mut self.room.centre);
        let found = self.witness(&centre, is_touching);
        self.room.centre = centre;
        found
    }

    /// Leaves a cell that is proven free or blocked, and halves any other.
    fn search_cell(&mut self, mut cell: RangeCell) -> Result<(), PlanError> {
        self.answer.cells += 1;
        self.centre_on(&cell);
        let lower = cell.lower;
        if self.is_free(&mut cell, lower) {
            return self.leave_free(&cell);
        }
        let Some(found) = self.by_planes_of_hulls(&mut cell)? else {
            return self.leave_free(&cell);
        };
        let rounding = self.room.posed.rounding;
        let centre = core::mem::take(&mut self.room.centre);
        self.note(&centre, &found, rounding)?;
        self.room.centre = centre;
        if found.lower > self.kept {
            if self.by_distance(&mut cell, &found) || self.by_parts(&mut cell, &found) {
                return self.leave_free(&cell);
            }
        } else if self.answer.witnesses[0].is_none() && self.is_blocked(&found) {
            self.answer.has_blocked = true;
            return self.witness_centre(true);
        }
        if !self.is_both() {
            self.divide(cell);
        }
        Ok(())
    }

    /// Proves a single cell: no witness is kept, nothing is divided.
    pub(super) fn prove_cell(&mut self, cell: &mut RangeCell) -> Result<BoxProof, PlanError> {
        self.centre_on(cell);
        let Some(found) = self.by_planes_of_hulls(cell)? else {
            return Ok(BoxProof::Free);
        };
        let is_apart = found.lower > self.kept;
        if is_apart && (self.by_distance(cell, &found) || self.by_parts(cell, &found)) {
            return Ok(BoxProof::Free);
        }
        if !is_apart && self.is_blocked(&found) {
            return Ok(BoxProof::Contact);
        }
        self.moved();
        Ok(BoxProof::Left)
    }

    /// Poses the chain at the centre of a cell.
    fn centre_on(&mut self, cell: &RangeCell) {
        let count = cell.low.len();
        let Room {
            centre,
            half,
            levers,
            posed,
            ..
        } = &mut self.room;
        centre.clear();
        centre.extend((0..count).map(|k| middle(cell.low[k], cell.high[k])));
        half.clear();
        half.extend((0..count).map(|k| {
            let half = (cell.high[k] - centre[k]).larger(centre[k] - cell.low[k]);
            half * (1.0 + 4.0 * f64::EPSILON)
        }));
        levers.resize(count, 0.0);
        self.chain.pose_at(centre, half, posed);
    }

    /// Proves a cell by balls and by planes between the convex bodies around both; returns the closest
    /// points of the bodies at the centre if it is not proven.
    fn by_planes_of_hulls(&mut self, cell: &mut RangeCell) -> Result<Option<Outcome>, PlanError> {
        if self.by_balls(cell) {
            return Ok(None);
        }
        let parts = self.bodies.map(|body| &body.parts[0]);
        self.room.bounds.prepare(&self.room.posed, parts);
        if self.by_parent(cell) || self.by_swept_balls(cell) {
            return Ok(None);
        }
        let pose = RelativePose::from_isometry(&self.room.posed.b)?;
        let outer = self.bodies.map(RangeBody::is_outer);
        let found = self.closest(&pose, outer);
        if found.lower > 0.0 && self.by_planes(cell, &found) {
            return Ok(None);
        }
        Ok(Some(match outer != [false; 2] {
            true => self.closest(&pose, [false; 2]),
            false => found,
        }))
    }

    /// Returns the closest points of the bodies, or of the convex bodies around them.
    fn closest(&mut self, pose: &RelativePose, is_outer: [bool; 2]) -> Outcome {
        self.answer.queries += 1;
        self.tracker.reset();
        let of = |k: usize| match &self.bodies[k].outer {
            Some(outer) if is_outer[k] => outer,
            _ => self.shapes[k],
        };
        self.tracker.closest(of(0), of(1), pose).outcome
    }

    /// Returns the number of joints before the frames in which planes are tried.
    pub(super) fn frames(&self) -> core::ops::RangeInclusive<usize> {
        let last = self.chain.len();
        match self.bodies[1].plane {
            // No other link sees the whole plane of a half-space.
            Some(_) => last..=last,
            None => 0..=last,
        }
    }

    /// Returns the balls around both bodies, in the frame of A.
    fn balls(&self) -> [(Vector3<f64>, f64); 2] {
        let poses = [Isometry3::identity(), self.room.posed.b];
        [0, 1].map(|k| {
            let part = &self.bodies[k].parts[0];
            ((poses[k] * part.ball.0).coords, part.ball.1 + part.radius)
        })
    }

    fn by_balls(&mut self, cell: &mut RangeCell) -> bool {
        if self.bodies[1].plane.is_some() {
            return false;
        }
        let [a, b] = self.balls();
        let Room { posed, bounds, .. } = &mut self.room;
        let (bound, frame, between) = bounds.balls_apart(posed, [a, b]);
        let bound = bound - posed.rounding;
        self.room.between = (frame, between);
        self.is_free(cell, bound)
    }

    fn by_parent(&mut self, cell: &mut RangeCell) -> bool {
        let Some((frame, normal)) = cell.plane else {
            return false;
        };
        let normal = self.room.posed.rotations[frame] * normal;
        let bound = self.gap(frame, &normal, true).0;
        self.is_free(cell, bound)
    }

    /// Tries the plane between the swept balls.
    fn by_swept_balls(&mut self, cell: &mut RangeCell) -> bool {
        let (frame, between) = self.room.between;
        let length = between.norm();
        if self.bodies[1].plane.is_some() || !(length > 0.0) {
            return false;
        }
        let bound = self.gap(frame, &(between / length), false).0;
        self.is_free(cell, bound)
    }

    /// Returns the bound of a plane of the outer bodies, and what a higher order may reach.
    fn gap(&mut self, frame: usize, normal: &Vector3<f64>, is_second: bool) -> (f64, f64) {
        let parts = [0, 1].map(|k| &self.bodies[k].parts[0]);
        let target = self.target();
        let Room {
            posed, bounds, half, ..
        } = &mut self.room;
        let slack = parts[0].slack() + parts[1].slack();
        let mut found = bounds.gap(parts, true, frame, normal, half, is_second);
        // All points are worth their time where few of them leave the cell undecided.
        let lacks = target - (found.gap - posed.rounding);
        if slack > 0.0 && lacks >= 0.0 && lacks < slack {
            found = bounds.gap(parts, false, frame, normal, half, is_second);
        }
        let gap = found.gap - posed.rounding;
        (gap, gap + found.remainder)
    }

    /// Tries the plane of the closest points: to first order in each frame, to second order in the
    /// two best.
    fn by_planes(&mut self, cell: &mut RangeCell, found: &Outcome) -> bool {
        let normal = match self.bodies[1].plane {
            Some(outward) => -(self.room.posed.b.rotation * outward),
            None => found.normal.into_inner(),
        };
        let mut best = (f64::NEG_INFINITY, 0);
        let mut hopes = Vec::with_capacity(self.chain.len() + 1);
        for frame in self.frames() {
            let (bound, hope) = self.gap(frame, &normal, false);
            if bound > best.0 {
                best = (bound, frame);
            }
            if self.is_free(cell, bound) {
                return true;
            }
            hopes.push((hope, frame));
        }
        hopes.sort_by(|x, y| y.0.total_cmp(&x.0));
        for (k, (hope, frame)) in hopes.into_iter().take(2).enumerate() {
            if k > 0 && hope < best.0.larger(self.target()) {
                break;
            }
            let (bound, _) = self.gap(frame, &normal, true);
            if bound > best.0 {
                best = (bound, frame);
            }
            if self.is_free(cell, bound) {
                return true;
            }
        }
        let frame = best.1;
        cell.plane = Some((frame, self.room.posed.rotations[frame].inverse() * normal));
        false
    }

    /// Takes the greatest displacement off the distance at the centre; sets the levers.
    fn by_distance(&mut self, cell: &mut RangeCell, found: &Outcome) -> bool {
        let bound = found.lower - self.moved() - self.room.posed.rounding;
        self.is_free(cell, bound)
    }

    /// Returns how far points of the bodies move towards each other; sets the levers.
    pub(super) fn moved(&mut self) -> f64 {
        let (balls, frames) = (self.balls(), self.frames());
        let Room {
            posed, bounds, levers, ..
        } = &mut self.room;
        bounds.moved(posed, frames, balls, levers)
    }

    /// Halves a cell along the coordinate that moves the bodies most.
    fn divide(&mut self, cell: RangeCell) {
        self.moved();
        let count = cell.low.len();
        let centre = &self.room.centre;
        let can_halve = |k: &usize| cell.low[*k] < centre[*k] && centre[*k] < cell.high[*k];
        let levers = &self.room.levers;
        let order = |x: &usize, y: &usize| {
            let by_lever = levers[*x].total_cmp(&levers[*y]);
            by_lever
                .then(self.room.half[*x].total_cmp(&self.room.half[*y]))
                .then(y.cmp(x))
        };
        let Some(k) = (0..count).filter(can_halve).max_by(order) else {
            self.room.stuck.push(cell);
            return;
        };
        let at = centre[k];
        let level = cell.level.saturating_add(1);
        let mut lower = RangeCell { level, ..cell };
        let mut upper = lower.clone();
        (lower.high[k], upper.low[k]) = (at, at);
        self.push(lower);
        self.push(upper);
    }
}

/// Returns the share of the volume of a range that cells take.
fn share(cells: &[RangeCell], ranges: &[[f64; 2]]) -> f64 {
    let of = |cell: &RangeCell| {
        let each = ranges.iter().enumerate().filter(|(_, [low, high])| low < high);
        let parts = each.map(|(k, [low, high])| (cell.high[k] - cell.low[k]) / (high - low));
        parts.product::<f64>()
    };
    cells.iter().map(of).sum::<f64>().smaller(1.0)
}

/// Returns the fingerprint of a pair: the kinds and parts of its bodies, all points of clouds, the
/// joints between the bodies, and the distance that the pair must keep.
pub(super) fn fingerprint_of(shapes: [&Geometry; 2], bodies: [&RangeBody; 2], chain: &Chain, kept: f64) -> u64 {
    let mut all = Fingerprint::new();
    for (shape, body) in shapes.into_iter().zip(bodies) {
        // Writing to a hash never fails.
        let _ = write!(all, "{:?}", shape.kind());
        all.word(body.fingerprint);
    }
    let _ = write!(all, "{chain:?}");
    all.number(kept);
    all.0
}
