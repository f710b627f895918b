//! Speeds along a path of straight legs within limits of each coordinate.
//!
//! # Time along a leg
//!
//! A place on a leg is given by the time `z` that leads there at full speed: the greatest speed at
//! which each coordinate keeps its limit of velocity. At the speed `s`, a fraction of the full
//! speed, the coordinates move at the velocity `s u`, where `u` is the velocity at full speed.
//!
//! A *corner* is rounded by a blend, from `r` before it to `r` after it, in `z` of both legs. The
//! blend changes the velocity from `s u` to `s u'` within the duration `T`, and its middle control
//! points are at the corner: so `T = 2 r / s`, and the velocity lies between its two ends at all
//! times. The acceleration is `s (u' - u) / T` if it is constant. If it is continuous, it rises and
//! falls as a parabola to 1.5 times as much. This gives the greatest speed of a corner, which is
//! the same before and after it. Kunz and Stilman 2012, "Time-optimal trajectory generation for
//! path following with bounded acceleration and velocity", has blends by arcs.
//!
//! Between two corners the speed rises, stays and falls (a trapezoid). The speeds of corners are
//! lowered, first forwards and then backwards, until each can be reached from its neighbours.
//!
//! # Rounding
//!
//! Positions round, so short pieces have larger errors of their velocities and accelerations. No
//! piece is shorter than a duration at which these errors are below a fraction of the limits
//! ([`RESERVE`]).

use std::vec::Vec;

use crate::extremes::Extremes;

/// Fraction of each limit that is left for rounding.
pub(crate) const RESERVE: f64 = 1.0 / (1u64 << 14) as f64;

/// Error of the second derivative of a Hermite curve over the times 0 to 1 by the rounding of
/// positions, in units of the greatest position. Not sharp: limits are checked afterwards.
const ROUNDED: f64 = 2048.0 * f64::EPSILON;

/// Fraction of the shorter leg at a corner that its blend may take.
const TAKEN: f64 = 3.0 / 8.0;

/// Limits of all coordinates.
pub(crate) struct Limits {
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
    /// Greatest acceleration in units of its mean, while the velocity changes.
    pub(crate) peak: f64,
    /// Least duration of a piece.
    pub(crate) shortest: f64,
}

impl Limits {
    /// Returns the greatest ratio of the absolute entries of a vector to limits.
    fn ratio(vector: impl Iterator<Item = f64>, limits: &[f64]) -> f64 {
        let each = vector.zip(limits).map(|(x, limit)| x.abs() / limit);
        each.fold(0.0, f64::larger)
    }

    /// Lowers limits of velocity that no motion along a path of these points reaches from rest within
    /// the limits of acceleration, so that all ratios are in range.
    pub(crate) fn lower_velocities(&mut self, points: &[Vec<f64>]) {
        for (k, (velocity, acceleration)) in self.velocity.iter_mut().zip(&self.acceleration).enumerate() {
            let way: f64 = points.windows(2).map(|ends| (ends[1][k] - ends[0][k]).abs()).sum();
            if way > 0.0 {
                *velocity = velocity.smaller(2.0 * f64::sqrt(acceleration * way));
            }
        }
    }

    /// Sets the least duration of a piece of a path along these legs.
    pub(crate) fn set_shortest(&mut self, legs: &[Leg]) {
        let time: f64 = legs
            .iter()
            .map(|leg| leg.length + 2.0 * f64::sqrt(leg.length / leg.gain))
            .sum();
        let clock = f64::EPSILON * time;
        let mut shortest = clock / RESERVE * 64.0;
        for (k, (velocity, acceleration)) in self.velocity.iter().zip(&self.acceleration).enumerate() {
            let most = |of: &dyn Fn(&Leg) -> f64| legs.iter().fold(0.0, |most: f64, leg| most.larger(of(leg).abs()));
            let position = most(&|leg| leg.from[k]).larger(most(&|leg| leg.to[k]));
            let error = ROUNDED * position + 8.0 * clock * most(&|leg| leg.unit[k]);
            let by_acceleration = f64::sqrt(error / (RESERVE * acceleration));
            shortest = shortest.larger(by_acceleration).larger(error / (RESERVE * velocity));
        }
        self.shortest = shortest;
    }
}

/// A straight part of a path.
pub(crate) struct Leg {
    /// Index of the segment in the path.
    pub(crate) segment: usize,
    pub(crate) from: Vec<f64>,
    pub(crate) to: Vec<f64>,
    /// Velocity at full speed.
    pub(crate) unit: Vec<f64>,
    /// Duration at full speed.
    pub(crate) length: f64,
    /// Greatest change of the speed by time.
    pub(crate) gain: f64,
}

impl Leg {
    pub(crate) fn new(segment: usize, from: Vec<f64>, to: Vec<f64>, limits: &Limits) -> Self {
        let step = || from.iter().zip(&to).map(|(a, b)| b - a);
        let length = Limits::ratio(step(), &limits.velocity);
        let unit: Vec<f64> = step().map(|x| x / length).collect();
        let gain = 1.0 / (limits.peak * Limits::ratio(unit.iter().copied(), &limits.acceleration));
        Self {
            segment,
            from,
            to,
            unit,
            length,
            gain,
        }
    }

    /// Returns the configuration at a place, between both ends.
    pub(crate) fn at(&self, place: f64) -> Vec<f64> {
        let x = place / self.length;
        let each = self.from.iter().zip(&self.to).map(|(&a, &b)| {
            let [low, high] = if a < b { [a, b] } else { [b, a] };
            match () {
                () if x <= 0.0 => a,
                () if x >= 1.0 => b,
                () => (a + (b - a) * x).clamped(low, high),
            }
        });
        each.collect()
    }
}

/// The end of a leg, and the start of the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Length of the blend on each leg; 0 where the motion stops.
    pub(crate) reach: f64,
    /// The change of the velocity at full speed, in units of the acceleration limits.
    turn: f64,
}

impl Corner {
    /// Returns a corner at which the motion stops.
    pub(crate) const STOP: Self = Self { reach: 0.0, turn: 0.0 };

    /// Returns the corner with the smallest blend that allows the full speed, if the legs are long
    /// enough, and that is nowhere farther than `deviation` from the corner in any coordinate.
    pub(crate) fn new([one, other]: [&Leg; 2], limits: &Limits, deviation: f64) -> Self {
        let change = || one.unit.iter().zip(&other.unit).map(|(u, v)| v - u);
        let turn = limits.peak * Limits::ratio(change(), &limits.acceleration);
        // The middle of the blend is this fraction of the change times the reach off the corner.
        let middle = if limits.peak > 1.0 { 3.0 / 16.0 } else { 0.25 };
        let widest = change().fold(0.0, |most: f64, x| most.larger(x.abs())) * middle;
        let mut reach = (0.5 * turn.larger(limits.shortest)).smaller(TAKEN * one.length.smaller(other.length));
        if widest > 0.0 {
            reach = reach.smaller(deviation / widest);
        }
        Self { reach, turn }
    }

    /// Returns the greatest speed of a blend.
    fn speed(&self, limits: &Limits) -> f64 {
        let way = 2.0 * self.reach;
        if way == 0.0 {
            return 0.0;
        }
        let least = f64::sqrt(way * self.turn).larger(limits.shortest).larger(way);
        way / least
    }
}

/// What the motion between two rows is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    /// A leg, by its index.
    Leg(usize),
    /// The blend at a corner, by its index.
    Blend(usize),
}

/// Configurations and velocities at times, and the pieces between them.
pub(crate) struct Rows {
    pub(crate) times: Vec<f64>,
    pub(crate) positions: Vec<Vec<f64>>,
    pub(crate) velocities: Vec<Vec<f64>>,
    pub(crate) pieces: Vec<Piece>,
}

impl Rows {
    /// Returns the motion along legs from rest to rest. There is one corner more than legs; the
    /// first and the last are the ends.
    pub(crate) fn new(legs: &[Leg], corners: &[Corner], limits: &Limits) -> Self {
        let speeds = speeds(legs, corners, limits);
        let mut rows = Self {
            times: std::vec![0.0],
            positions: std::vec![legs[0].from.clone()],
            velocities: std::vec![std::vec![0.0; legs[0].from.len()]],
            pieces: Vec::new(),
        };
        for (k, leg) in legs.iter().enumerate() {
            let [near, far] = [&corners[k], &corners[k + 1]];
            if near.reach > 0.0 {
                let duration = 2.0 * near.reach / speeds[k];
                rows.add(leg, near.reach, speeds[k], duration, Piece::Blend(k));
            }
            let way = straight(leg, near, far);
            let mut place = near.reach;
            let mut speed = speeds[k];
            let phases = phases(way, [speeds[k], speeds[k + 1]], gain(leg, limits), limits.shortest);
            for (index, phase) in phases.iter().enumerate() {
                place += 0.5 * (speed + phase.speed) * phase.duration;
                speed = phase.speed;
                if index + 1 == phases.len() {
                    place = leg.length - far.reach;
                }
                rows.add(leg, place, speed, phase.duration, Piece::Leg(k));
            }
        }
        rows
    }

    fn add(&mut self, leg: &Leg, place: f64, speed: f64, duration: f64, piece: Piece) {
        self.times.push(self.times[self.times.len() - 1] + duration);
        self.positions.push(leg.at(place));
        self.velocities.push(leg.unit.iter().map(|x| x * speed).collect());
        self.pieces.push(piece);
    }

    /// Doubles all times.
    pub(crate) fn slow_down(&mut self) {
        self.times.iter_mut().for_each(|t| *t *= 2.0);
        self.velocities.iter_mut().flatten().for_each(|v| *v *= 0.5);
    }
}

/// Returns the length of a leg between the blends at its ends.
fn straight(leg: &Leg, near: &Corner, far: &Corner) -> f64 {
    leg.length - near.reach - far.reach
}

/// Returns the gain of a leg, less if the leg is so short that a piece would be too short.
fn gain(leg: &Leg, limits: &Limits) -> f64 {
    let most = 0.5 * (leg.length / limits.shortest).smaller(1.0);
    leg.gain.smaller(most / limits.shortest)
}

/// Returns the speed at each corner.
fn speeds(legs: &[Leg], corners: &[Corner], limits: &Limits) -> Vec<f64> {
    let mut speeds: Vec<f64> = corners.iter().map(|corner| corner.speed(limits)).collect();
    let ways: Vec<f64> = (0..legs.len())
        .map(|k| straight(&legs[k], &corners[k], &corners[k + 1]))
        .collect();
    let reached = |from: f64, k: usize| f64::sqrt(from * from + 2.0 * gain(&legs[k], limits) * ways[k]);
    for (k, way) in ways.iter().enumerate() {
        // The straight part must not be too short a piece.
        let most = way / limits.shortest;
        speeds[k] = speeds[k].smaller(most);
        speeds[k + 1] = speeds[k + 1].smaller(most);
    }
    for k in 0..legs.len() {
        speeds[k + 1] = speeds[k + 1].smaller(reached(speeds[k], k));
    }
    for k in (0..legs.len()).rev() {
        speeds[k] = speeds[k].smaller(reached(speeds[k + 1], k));
    }
    speeds
}

/// A change of speed at a constant rate of the mean, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Phase {
    duration: f64,
    /// Speed at the end.
    speed: f64,
}

/// Returns the phases of a way from one speed to another: up to three.
fn phases(way: f64, [from, to]: [f64; 2], gain: f64, shortest: f64) -> Vec<Phase> {
    let mean = 0.5 * (from * from + to * to);
    let phase = |duration, speed| Phase { duration, speed };
    let peak = f64::sqrt(mean + gain * way);
    let top = peak.smaller(1.0).larger(from).larger(to);
    // Without a cruise the peak is `top`.
    let lower = ((top * top - mean) / way).smaller(gain);
    let cruise = |gain: f64| (way - (top * top - mean) / gain) / top;
    let (rate, even) = match cruise(gain) {
        time if peak > 1.0 && time >= shortest => (gain, time),
        _ => (lower, 0.0),
    };
    let [rise, fall] = [from, to].map(|speed| if rate > 0.0 { (top - speed) / rate } else { 0.0 });
    if from + to == 0.0 || (rise >= shortest && fall >= shortest) {
        let phases = [phase(rise, top), phase(even, top), phase(fall, to)];
        let mut phases: Vec<Phase> = phases.into_iter().filter(|phase| phase.duration > 0.0).collect();
        if phases.is_empty() {
            // The numbers are out of range; no curve has this duration.
            phases.push(phase(f64::INFINITY, to));
        }
        return phases;
    }
    // A rise or fall that is too short gives way to a longer cruise.
    let change = (from * from - to * to).abs() / (2.0 * gain);
    let (faster, slower) = (from.larger(to), from.smaller(to));
    let (even, slope) = ((way - change) / faster, (faster - slower) / gain);
    if even >= shortest && slope >= shortest {
        let slope = phase(slope, to);
        return match from > to {
            true => [phase(even, from), slope].into(),
            false => [slope, phase(even, to)].into(),
        };
    }
    [phase(2.0 * way / (from + to), to)].into()
}
