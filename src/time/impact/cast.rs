//! The search of a cast: measure, step, prove.

use alloc::vec::Vec;

use super::{Certificate, Impact, Tolerance};
use crate::base::callbacks;
use crate::base::motion::Motion;
use crate::base::num::extremes::Extremes;
use crate::base::pose::{PoseError, RelativePose, rigid};
use crate::base::tolerance::ROOT;
use crate::pair::outcome::ContactState;
use crate::time::separation::{Measurement, PairMotion, Proof, Separation};

/// Largest number of steps of a cast.
///
/// Measured: at most 21 if bodies rotate by up to one revolution; thousands if gears rotate a
/// hundred times at a tiny gap.
const LOOKS: u32 = 20_000;

/// Number of steps between two checks of the pace of a cast.
///
/// A cast ends if at its pace it would need `PACE` times the limit of steps to reach the end:
/// bodies that rotate by 1e15 radians.
const PACE_LOOKS: u32 = 1024;
const PACE: f64 = 50.0;

/// Fraction of the tolerance that steps aim at as a gap, and the proof behind contact as a depth.
///
/// A larger fraction makes the bracket wider, a smaller one the queries slower. Measured: brackets
/// of 0.2 tolerances.
const AIM: f64 = 0.3;

/// Distance of the balls, as a multiple of the sum of both radii, from which on a cast jumps by
/// balls without a query.
const CLEAR: f64 = 0.1;

/// Smallest tolerance, as a multiple of the rounding of a distance: below it proofs fail.
const LEAST: f64 = 8.0;

/// Factor by which a tolerance shrinks if its overlap was not proven.
const SHRINK: f64 = 1.0 / 16.0;

/// Largest number of doublings of the step behind contact if the tolerance cannot shrink.
const DOUBLINGS: u32 = 6;

/// The state of a cast.
pub(super) struct CastSearch<'a, S: ?Sized, A: ?Sized, B: ?Sized> {
    pub(super) pair: &'a mut S,
    pub(super) motion_a: &'a A,
    pub(super) motion_b: &'a B,
    pub(super) until: f64,
    pub(super) tolerance: Tolerance,
    pub(super) distance: f64,
    /// What is known at the start of the interval.
    pub(super) seen: Option<Measurement>,
    pub(super) queries: u32,
    pub(super) proofs: u32,
    /// Receives the proof of each step, in order from the start of the interval.
    pub(super) trail: Option<&'a mut Vec<Certificate>>,
}

/// What a search keeps from step to step.
struct LookBudget {
    /// Remaining steps; repetitions of a step count too.
    left: u32,
    /// Factor by which the tolerance has shrunk while the pair is nearer than the tolerance.
    shrunk: f64,
}

/// How a search continues after a step.
enum Next {
    /// Free up to this time.
    Go(f64),
    Found(Impact),
}

impl LookBudget {
    /// Returns whether the steps so far are much too slow to reach the end.
    ///
    /// Checked every so many steps.
    fn is_hopeless(&self, gone: f64, whole: f64) -> bool {
        let used = LOOKS - self.left;
        used > 0 && used.is_multiple_of(PACE_LOOKS) && gone * (PACE * f64::from(LOOKS)) < whole * f64::from(used)
    }

    /// Shrinks the tolerance for a repetition; false if no step is left.
    fn again(&mut self) -> bool {
        self.shrunk *= SHRINK;
        self.left = self.left.saturating_sub(1);
        self.left > 0
    }
}

impl<S: Separation + ?Sized, A: Motion + ?Sized, B: Motion + ?Sized> CastSearch<'_, S, A, B> {
    pub(super) fn run(&mut self, from: f64) -> Result<Impact, PoseError> {
        let found = self.search(from);
        if let Ok(Impact::Incomplete { .. }) = found {
            callbacks::spent("a cast", LOOKS);
        }
        found
    }

    fn search(&mut self, from: f64) -> Result<Impact, PoseError> {
        let mut time = from;
        let mut budget = LookBudget {
            left: LOOKS,
            shrunk: 1.0,
        };
        while budget.left > 0 && !budget.is_hopeless(time - from, self.until - from) {
            budget.left -= 1;
            let (relative, mut flight) = flight(self.motion_a, self.motion_b, time, self.until, self.distance)?;
            let (apart, is_known) = (flight.apart(self.pair), flight.is_known());
            if is_known {
                if apart.span >= flight.span && apart.span > 0.0 {
                    self.note(time, self.until, self.distance, Proof::Balls);
                    return Ok(Impact::Miss);
                }
                if apart.gap > CLEAR * apart.reach {
                    let next = later(time, apart.span);
                    if next > time {
                        self.note(time, next, self.distance, Proof::Balls);
                        time = next;
                        continue;
                    }
                }
            }
            let known = self.seen.take().filter(|_| time == from);
            let seen = known.unwrap_or_else(|| {
                self.queries += 1;
                self.pair.measure(&relative)
            });
            // At a positive distance the bounds may leave the start open; later times are proven.
            let is_open = time == from && self.distance > 0.0 && !(seen.lower > self.distance);
            if self.is_met(&seen) || is_open && self.is_proven_met(&relative, &seen) {
                // Steps are proven, so a pair can meet only at the start of the interval, or if a
                // motion breaks its contract.
                return Ok(if time == from {
                    Impact::AtStart { seen }
                } else {
                    Impact::Undecided {
                        safe: time,
                        distance: seen.upper,
                    }
                });
            }
            if !is_known {
                break;
            }
            if flight.span == 0.0 {
                return Ok(self.at_once(time, seen, apart.noise, &relative));
            }
            match self.step(time, &seen, &mut flight, apart.noise, &mut budget, is_open)? {
                Next::Go(next) => time = next,
                Next::Found(impact) => return Ok(impact),
            }
        }
        Ok(Impact::Incomplete { safe: time })
    }

    fn note(&mut self, from: f64, until: f64, distance: f64, proof: Proof) {
        if let Some(trail) = &mut self.trail {
            trail.push(Certificate {
                from,
                until,
                distance,
                proof,
            });
        }
    }

    fn is_met(&self, seen: &Measurement) -> bool {
        if self.distance > 0.0 {
            seen.upper <= self.distance
        } else {
            matches!(seen.state, ContactState::Touching | ContactState::Overlapping)
        }
    }

    fn is_proven_met(&mut self, relative: &RelativePose, seen: &Measurement) -> bool {
        self.proofs += 1;
        self.pair.meets(relative, self.distance, seen)
    }

    /// Returns the result for an interval without length, if the pair is not seen to meet.
    fn at_once(&mut self, time: f64, seen: Measurement, noise: f64, relative: &RelativePose) -> Impact {
        if seen.state == ContactState::Separated && seen.lower - noise > self.distance {
            self.note(time, time, self.distance, Proof::Own);
            return Impact::Miss;
        }
        if self.is_proven_met(relative, &seen) {
            return Impact::AtStart { seen };
        }
        Impact::Undecided {
            safe: time,
            distance: seen.upper,
        }
    }

    /// Makes one step: a hit if the pair is near enough for a proof, otherwise a step as far as a
    /// plane proves. If it is open whether the pair is separated now, only a step can prove this.
    fn step(
        &mut self,
        time: f64,
        seen: &Measurement,
        flight: &mut PairMotion,
        noise: f64,
        budget: &mut LookBudget,
        is_open: bool,
    ) -> Result<Next, PoseError> {
        let gap = seen.upper - self.distance;
        let least = LEAST * noise;
        let whole = self.allowed(seen, flight).larger(least);
        if gap > whole {
            budget.shrunk = 1.0;
        }
        loop {
            let allowed = (whole * budget.shrunk).larger(least);
            if gap <= allowed && !is_open {
                let last = !(allowed > least);
                if let Some(hit) = self.hit(time, seen, flight, gap + AIM * allowed, last)? {
                    let seen = *seen;
                    return Ok(Next::Found(Impact::Hit { safe: time, hit, seen }));
                }
                if !last {
                    if !budget.again() {
                        break;
                    }
                    continue;
                }
            }
            let aim = if gap <= allowed { 0.0 } else { AIM * allowed };
            flight.required = self.distance + aim;
            let by_fixed = flight.by_fixed_normal(&*self.pair, seen);
            let free = by_fixed.unwrap_or_else(|| self.pair.free_for(seen, flight));
            if free.span >= flight.span {
                self.note(time, self.until, flight.required, free.proof);
                return Ok(Next::Found(Impact::Miss));
            }
            let next = later(time, free.span).smaller(self.until);
            if next > time {
                self.note(time, next, flight.required, free.proof);
                return Ok(Next::Go(next));
            }
            if !(allowed > least) {
                let distance = seen.upper;
                return Ok(Next::Found(Impact::Undecided { safe: time, distance }));
            }
            if !budget.again() {
                break;
            }
        }
        Ok(Next::Found(Impact::Incomplete { safe: time }))
    }

    /// Returns the tolerance as a length.
    fn allowed(&self, seen: &Measurement, flight: &PairMotion) -> f64 {
        match self.tolerance {
            Tolerance::Distance(length) => length,
            // The displacement of the witnesses towards each other in half that time, at the pace
            // of the remaining displacement.
            Tolerance::Time(width) => {
                let gap = seen.upper - self.distance;
                flight
                    .forecast(&*self.pair, seen, gap)
                    .map_or(0.0, |time| if time > 0.0 { 0.5 * width * gap / time } else { 0.0 })
            }
        }
    }

    /// Returns a time at which the pair is proven to meet, nearer than now by `way`.
    fn hit(
        &mut self,
        time: f64,
        seen: &Measurement,
        flight: &PairMotion,
        way: f64,
        last: bool,
    ) -> Result<Option<f64>, PoseError> {
        let Some(mut ahead) = flight.forecast(&*self.pair, seen, way) else {
            return Ok(None);
        };
        for _ in 0..if last { DOUBLINGS } else { 1 } {
            let at = (time + ahead).next_up().smaller(self.until);
            if at <= time {
                return Ok(None);
            }
            let relative = RelativePose::new(&self.motion_a.pose(at), &self.motion_b.pose(at))?;
            if self.is_proven_met(&relative, seen) {
                return Ok(Some(at));
            }
            if at == self.until {
                return Ok(None);
            }
            ahead *= 2.0;
        }
        Ok(None)
    }
}

/// Returns both motions from a time until the end of an interval.
///
/// Inlined, because a `PairMotion` has sixty numbers that would be copied from call to call.
#[inline(always)]
pub(super) fn flight<A: Motion + ?Sized, B: Motion + ?Sized>(
    motion_a: &A,
    motion_b: &B,
    time: f64,
    until: f64,
    required: f64,
) -> Result<(RelativePose, PairMotion), PoseError> {
    // Rounded up, so that a proof for the span is a proof to the end.
    let span = if until > time { (until - time).next_up() } else { 0.0 };
    let (mut pose_a, model_a) = motion_a.placed(time, span);
    let (mut pose_b, model_b) = motion_b.placed(time, span);
    let relative = RelativePose::new(&pose_a, &pose_b)?;
    // Motions of the caller may be off unit length by as much as poses may.
    if !relative.is_normalised() {
        (pose_a, pose_b) = (rigid(&pose_a), rigid(&pose_b));
    }
    let flight = PairMotion {
        pose_a,
        pose_b,
        model_a,
        model_b,
        span,
        required,
    };
    Ok((relative, flight))
}

/// Returns the time after a span, never beyond it.
pub(super) fn later(time: f64, span: f64) -> f64 {
    if span > 0.0 {
        (time + span * (1.0 - ROOT)).next_down()
    } else {
        time
    }
}
