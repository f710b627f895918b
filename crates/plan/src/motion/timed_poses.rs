//! Poses at times, and the motion of a body from each to the next.
//!
//! # Bounds
//!
//! Let a curve run from `t0` to `t1` on the clock, and let row k be at `u`, `d` before row k + 1.
//! At the time s of the curve, the body is at the fraction `x = (t0 - u) / d + (t1 - t0) / d s` of
//! the motion between both rows. This motion is a [`Steady`]: the position runs along a straight
//! line and the rotation about one axis. Velocities by s are those by x, times `(t1 - t0) / d`.
//!
//! The fraction errs by `e`, a few units of rounding times `|(t0 - u) / d| + (t1 - t0) / d + 1`
//! ([`CLOCK`]). The times of the rows on the curve err likewise, so near its ends a part may also
//! hold a little of the motion before and after. Hence the body is off by at most the sum of `e`
//! times the length, and times the angle, of the motions before, between and after both rows.

use std::vec::Vec;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::tolerance::{CLOCK, HALF_TURN, PLACED, SLERP_PLACE, SLERP_TURN};
use lin_canny::broad::Aabb;
use lin_canny::motion::{Motion, MotionModel, Remainder, Steady, Velocity};
use lin_canny::{EXTENT_MAX, RelativePose, normalize_rotation};

/// Largest error of a fraction between two rows. Rows that are nearer than this to the rounding of
/// the time prove nothing.
const FRACTION_ERROR_MAX: f64 = 0.25;

/// Poses of a body at times on a clock, in ascending order.
///
/// Between two poses the position moves along a straight line at constant speed, and the rotation
/// is by slerp: about one axis, at a constant rate, by at most half a turn. A quaternion and its
/// negative are the same rotation. If the rotation is half a turn to rounding, both directions are
/// equally near, and the signs of the quaternions decide: from `q` to `r`, not to `-r`.
///
/// There is no pose before the first time or after the last.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny_plan::TimedPoses;
///
/// let quarter = Isometry3::rotation(Vector3::z() * std::f64::consts::FRAC_PI_2);
/// let poses = [Isometry3::translation(2.0, 0.0, 0.0), quarter];
/// let poses = TimedPoses::new(&[10.0, 14.0], &poses)?;
/// let at = poses.at(11.0).expect("a pose");
/// assert_eq!(at.translation.vector, Vector3::new(1.5, 0.0, 0.0));
/// assert!((at.rotation.angle() - std::f64::consts::FRAC_PI_8).abs() < 1e-15);
/// assert!(poses.at(15.0).is_none());
/// # Ok::<(), lin_canny_plan::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredPoses", into = "StoredPoses"))]
pub struct TimedPoses {
    times: Vec<f64>,
    poses: Vec<Isometry3<f64>>,
    /// The motion from each pose to the next, over the fractions 0 to 1.
    motions: Vec<Steady>,
}

/// Timed poses as they are stored.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "TimedPoses")]
struct StoredPoses {
    times: Vec<f64>,
    poses: Vec<Isometry3<f64>>,
}

#[cfg(feature = "serde")]
impl From<TimedPoses> for StoredPoses {
    fn from(TimedPoses { times, poses, .. }: TimedPoses) -> Self {
        Self { times, poses }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredPoses> for TimedPoses {
    type Error = PlanError;

    fn try_from(stored: StoredPoses) -> Result<Self, PlanError> {
        Self::new(&stored.times, &stored.poses)
    }
}

impl TimedPoses {
    /// Returns the poses of a body at times.
    ///
    /// # Errors
    /// Returns an error if there are fewer than two poses or not as many times, and the number of
    /// the row if a time is not finite or not later than the one before, if a pose is invalid, or
    /// if two poses are too far apart.
    pub fn new(times: &[f64], poses: &[Isometry3<f64>]) -> Result<Self, PlanError> {
        let refused = |what, value| PlanError::Value { what, value };
        if poses.len() < 2 {
            return Err(refused("number of timed poses", poses.len() as f64));
        }
        if times.len() != poses.len() {
            return Err(refused("number of times of poses", times.len() as f64));
        }
        let of_row = |row, error| PlanError::TimedPose {
            row,
            error: std::boxed::Box::new(error),
        };
        let mut motions = Vec::with_capacity(poses.len() - 1);
        for (row, (&time, pose)) in times.iter().zip(poses).enumerate() {
            let is_later = row == 0 || time > times[row - 1];
            if !(time.abs() <= EXTENT_MAX && is_later) {
                return Err(of_row(row, refused("time", time)));
            }
            RelativePose::from_isometry(pose).map_err(|error| of_row(row, error.into()))?;
            if row > 0 {
                let motion = between(&poses[row - 1], pose);
                motions.push(motion.map_err(|error| of_row(row, error))?);
            }
        }
        Ok(Self {
            times: times.into(),
            poses: poses.into(),
            motions,
        })
    }

    /// Returns the times.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the poses, with the bits that were given.
    #[must_use]
    pub fn poses(&self) -> &[Isometry3<f64>] {
        &self.poses
    }

    /// Returns the pose at a time; `None` before the first time and after the last.
    #[must_use]
    pub fn at(&self, time: f64) -> Option<Isometry3<f64>> {
        if !self.covers(time) {
            return None;
        }
        let k = self.row(time);
        let fraction = (time - self.times[k]) / (self.times[k + 1] - self.times[k]);
        Some(self.placed(k, fraction))
    }

    fn covers(&self, time: f64) -> bool {
        time >= self.times[0] && time <= self.times[self.times.len() - 1]
    }

    /// Returns the first and the last time.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Returns the last row at a time or before, without the last of all.
    fn row(&self, time: f64) -> usize {
        let after = self.times.partition_point(|t| *t <= time);
        after.clamp(1, self.motions.len()) - 1
    }

    /// Returns the pose at a fraction of the motion after a row. At both ends it is that of the row.
    fn placed(&self, row: usize, fraction: f64) -> Isometry3<f64> {
        match fraction {
            1.0 => normalize_rotation(&self.poses[row + 1]),
            _ => self.motions[row].pose(fraction),
        }
    }

    /// Returns a box that holds a ball of the body at all times.
    pub(crate) fn swept(&self, (centre, radius): (Point3<f64>, f64)) -> Aabb {
        let reach = radius + centre.coords.norm();
        if !(reach < f64::INFINITY) {
            return Aabb::everything();
        }
        let at = |pose: &Isometry3<f64>| Point3::from(pose.translation.vector);
        let start = at(&self.poses[0]);
        let mut all = Aabb::new(start, start);
        let mut far = 0.0;
        for pose in &self.poses {
            all = all.united(&Aabb::new(at(pose), at(pose)));
            far = pose.translation.vector.abs().sum().larger(far);
        }
        all.grown(reach + PLACED * (reach + far))
    }

    /// Returns the rotation of the last row at a time or before.
    pub(crate) fn rotation_before(&self, time: f64) -> UnitQuaternion<f64> {
        normalize_rotation(&self.poses[self.row(time)]).rotation
    }

    /// Returns the rotations between two times: for each row that turns the body its time, that of the next, and the
    /// rotation vector.
    pub(crate) fn turns(&self, [begin, end]: [f64; 2]) -> Vec<([f64; 2], Vector3<f64>)> {
        let rows = self.row(begin)..self.motions.len();
        let all = rows.map(|k| ([self.times[k], self.times[k + 1]], self.motions[k].velocity().angular));
        all.filter(|(times, turn)| times[0] < end && *turn != Vector3::zeros())
            .collect()
    }

    /// Returns the motion over the times 0 to 1 of a curve that runs between these times on the
    /// clock, in parts from row to row; `None` if a time has no pose.
    pub(crate) fn parts(&self, [begin, end]: [f64; 2]) -> Option<Vec<PosePart>> {
        if !(self.covers(begin) && self.covers(end)) {
            return None;
        }
        let whole = end - begin;
        let mut parts: Vec<PosePart> = Vec::new();
        for row in self.row(begin)..self.motions.len() {
            let [time, next] = [self.times[row], self.times[row + 1]];
            let from = match parts.is_empty() {
                true => 0.0,
                false => (time - begin) / whole,
            };
            let is_first = parts.is_empty();
            if time >= end || (!is_first && from >= 1.0) {
                break;
            }
            if let Some(last) = parts.last_mut() {
                last.until = from;
            }
            let is_last = next >= end;
            let [start, rate] = self.clock(row, begin, end);
            parts.push(PosePart {
                from,
                until: 1.0,
                steady: self.motions[row],
                start,
                rate,
                last: if is_last { (end - time) / (next - time) } else { 1.0 },
                next: normalize_rotation(&self.poses[row + 1]),
                error: self.error(row, begin, end),
            });
        }
        Some(parts)
    }

    /// Returns the fraction of the motion after a row at the time 0 of a curve, and its rate.
    fn clock(&self, row: usize, begin: f64, end: f64) -> [f64; 2] {
        let duration = self.times[row + 1] - self.times[row];
        [(begin - self.times[row]) / duration, (end - begin) / duration]
    }

    /// Returns upper bounds of how far the body is off by rounding, as a length and as an angle,
    /// less what the [`Steady`] motion counts.
    fn error(&self, row: usize, begin: f64, end: f64) -> [f64; 2] {
        let far = |k: usize| self.poses[k].translation.vector.abs().sum();
        let mut error = [SLERP_PLACE * (far(row) + far(row + 1)), SLERP_TURN];
        for k in row.saturating_sub(1)..(row + 2).min(self.motions.len()) {
            let [start, rate] = self.clock(k, begin, end);
            let of_fraction = CLOCK * (start.abs() + rate + 1.0) + f64::MIN_POSITIVE;
            if !(of_fraction <= FRACTION_ERROR_MAX) {
                return [f64::INFINITY; 2];
            }
            let velocity = self.motions[k].velocity();
            error[0] += of_fraction * velocity.linear.abs().sum();
            error[1] += of_fraction * velocity.angular.abs().sum();
        }
        error
    }
}

/// Returns the motion from one pose to another, over the times 0 to 1.
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>) -> Result<Steady, PlanError> {
    let (from, to) = (normalize_rotation(from), normalize_rotation(to));
    let turn = to.rotation.into_inner() * from.rotation.into_inner().conjugate();
    let turn = if turn.w < -HALF_TURN { -turn } else { turn };
    let sine = f64::sqrt(turn.imag().norm_squared());
    let per_sine = match sine > 0.0 {
        true => 2.0 * libm::atan2(sine, turn.w) / sine,
        false => 2.0,
    };
    let way: Vector3<f64> = to.translation.vector - from.translation.vector;
    Ok(Steady::new(&from, Velocity::new(way, turn.imag() * per_sine))?)
}

/// The motion of a body between two of its timed poses, over the times of a curve.
#[derive(Clone, Debug)]
pub(crate) struct PosePart {
    /// The times of the curve at which the part starts and ends.
    pub(crate) from: f64,
    until: f64,
    steady: Steady,
    /// The fraction of the motion at the time 0 of the curve, its rate, and the fraction at the end
    /// of the part.
    start: f64,
    rate: f64,
    last: f64,
    /// The pose at the fraction 1.
    next: Isometry3<f64>,
    /// Upper bounds of the errors of position and angle.
    error: [f64; 2],
}

impl PosePart {
    fn fraction(&self, time: f64) -> f64 {
        if time >= self.until {
            return self.last;
        }
        (self.start + self.rate * time).larger(0.0).smaller(self.last)
    }
}

impl Motion for PosePart {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        match self.fraction(time) {
            1.0 => self.next,
            fraction => self.steady.pose(fraction),
        }
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        let model = self.steady.model(self.fraction(time), self.rate * span);
        let grown = |Remainder(bound): Remainder, error: f64| Remainder([bound[0] + error, 0.0, 0.0, 0.0]);
        MotionModel {
            linear: model.linear * self.rate,
            angular: model.angular * self.rate,
            shift: grown(model.shift, self.error[0]),
            turn: grown(model.turn, self.error[1]),
            ..model
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Translation3;
    use truth::rng::Rng;

    /// Points stay as near to their models as the bounds say: those of the part, and those of the
    /// poses at the time on the clock, also where a part ends and the next begins.
    #[test]
    fn parts_keep_the_contract_of_motions() {
        let mut rng = Rng::new(1);
        let mut tight = 0;
        for round in 0..300 {
            let count = 2 + rng.below(5);
            let offset = [0.0, -3.0, 1.7e9, 1e-9][round % 4];
            let mut times = std::vec![offset];
            for _ in 1..count {
                times.push(times[times.len() - 1] + rng.log_range(1e-6, 10.0));
            }
            let poses: Vec<Isometry3<f64>> = (0..count)
                .map(|_| {
                    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.2));
                    Isometry3::from_parts(Translation3::from(Vector3::from(rng.unit()) * 3.0), turn)
                })
                .collect();
            let timed = TimedPoses::new(&times, &poses).expect("timed poses");
            let [first, last] = timed.ends();
            let mut ends = [rng.range(first, last), rng.range(first, last)];
            if round % 3 == 0 {
                ends = [first, last];
            }
            let [begin, end] = [ends[0].smaller(ends[1]), ends[0].larger(ends[1])];
            if begin == end {
                continue;
            }
            let parts = timed.parts([begin, end]).expect("poses at all times");
            assert!(parts[0].from == 0.0 && parts[parts.len() - 1].until == 1.0);
            for (k, part) in parts.iter().enumerate() {
                assert!(k == 0 || parts[k - 1].until == part.from && part.from > parts[k - 1].from);
                for _ in 0..20 {
                    let within = |x: f64| part.from + (part.until - part.from) * x;
                    let time = if rng.chance(0.3) {
                        part.from
                    } else {
                        within(rng.uniform())
                    };
                    let span = part.until - time;
                    let s = if rng.chance(0.3) { span } else { span * rng.uniform() };
                    let model = part.model(time, span);
                    let start = part.pose(time);
                    let arm = Vector3::from(rng.unit()) * rng.range(0.0, 2.0);
                    let turn = UnitQuaternion::from_scaled_axis(model.angular * s);
                    let at = start.translation.vector + model.linear * s + turn * (start.rotation * arm);
                    let bound = model.shift.at(s) + arm.norm() * model.turn.at(s);
                    let later = (time + s).smaller(part.until);
                    let off = |pose: Isometry3<f64>| (pose * Point3::from(arm) - Point3::from(at)).norm();
                    assert!(
                        off(part.pose(later)) <= bound,
                        "{round}: {:e} {bound:e}",
                        off(part.pose(later))
                    );
                    tight += u32::from(off(part.pose(later)) > 1e-3 * bound);
                    // The time on the clock rounds, so rows of any distance move by so much.
                    let clock = (begin + (end - begin) * later).larger(begin).smaller(end);
                    let rounded = 4.0 * f64::EPSILON * (begin.abs() + end.abs());
                    let speed = model.linear.norm() + 2.0 * model.angular.norm();
                    let slack = rounded / (end - begin) * speed;
                    let now = timed.at(clock).expect("a pose");
                    let is_inner = later > within(1e-3) && later < within(1.0 - 1e-3);
                    assert!(
                        !is_inner || off(now) <= bound + slack,
                        "{round}: {:e} {bound:e} {slack:e}",
                        off(now)
                    );
                }
                if k > 0 {
                    let [before, after] = [parts[k - 1].pose(part.from), part.pose(part.from)];
                    let far = (before.translation.vector - after.translation.vector).norm();
                    let bound = part.error[0] + parts[k - 1].error[0] + 1e-15;
                    assert!(far <= bound, "{round}: {far:e} {bound:e}");
                }
            }
        }
        assert!(tight > 100, "{tight}");
    }
}
