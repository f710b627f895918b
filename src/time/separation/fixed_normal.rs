//! A plane that keeps its normal: the gap along the normal is at least a parabola.
//!
//! Shapes that do not rotate need no other plane. In a cast far from contact, this plane proves
//! most of what a plane that rotates with the features proves, and it needs no support points. A
//! step by this plane leaves the part of the gap by which the shapes may rotate into each other. So
//! rotating planes make the last steps.

use crate::time::separation::plane::AHEAD;
use nalgebra::Vector3;

use super::bernstein::{line_positive_until, positive_until};
use super::plane::tilt;
use super::{FreeSpan, Measurement, PairMotion, Proof, Separation};
use crate::base::motion::{MotionModel, Remainder};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::{magnitude, sqrt};
use crate::base::pose::Operand;
use crate::base::tolerance::PLANE;

/// Factor by which an interval is cut if its bound is slightly too large.
const CUT: f64 = 0.75;

/// Excess of a bound, `2^24`, from which on an interval is cut more.
const CUT_FAR: f64 = (1u64 << 24) as f64;

/// The largest cut in one round, `2^-60`: 18 such cuts reduce an interval of one to zero.
const CUT_MOST: f64 = 1.0 / (1u64 << 60) as f64;

/// Largest velocity by rotation at which a plane keeps its normal in a cast.
///
/// It is a fraction of the velocity at which the pivots approach each other. The plane then proves
/// three quarters or more of the time to contact, without support points.
const FIXED_SHARE: f64 = 0.3;

/// Smallest gap at which a plane of rotating shapes keeps its normal in a cast, as a fraction of
/// the sum of both radii. Nearer, it rotates with the features, because these steps converge
/// quadratically.
///
/// Values from 1e-4 to 0.4 were measured on casts of hulls of 8 to 512 vertices. With 0.001 to
/// 0.005 the casts take 9 to 18 % less time than with planes that always rotate.
const FIXED_GAP: f64 = 0.002;

/// Returns whether neither shape rotates: then the gap along a normal is exactly a parabola.
pub(super) fn turns_neither(flight: &PairMotion) -> bool {
    flight.model_a.angular == Vector3::zeros() && flight.model_b.angular == Vector3::zeros()
}

/// A plane that keeps its normal while the shapes move, on the motion's own clock (see
/// [`PairMotion::on_own_clock`]).
///
/// A point `x` of a shape that rotates at `w` has the velocity `w x x` about the pivot, and
/// `(n x w) . x` of it along the normal. This is at most `|n x w|` times the radius of the shape.
/// So the gap along the normal is at least a parabola.
pub(super) struct FixedNormal<'a> {
    flight: &'a PairMotion,
    n: &'a Vector3<f64>,
    /// The gap along the normal now.
    gap: f64,
    tick: f64,
    reach: [f64; 2],
    velocity: Vector3<f64>,
    /// The velocity of the pivots along the normal: B's minus A's.
    slope: f64,
    /// No point of A or B approaches the other shape faster than this, relative to its pivot.
    turning: f64,
}

impl<'a> FixedNormal<'a> {
    pub(super) fn new<S: Separation + ?Sized>(
        pair: &S,
        flight: &'a PairMotion,
        n: &'a Vector3<f64>,
        gap: f64,
    ) -> FixedNormal<'a> {
        let reach = |which: Operand, model: &MotionModel| {
            let (centre, radius) = pair.ball_during(which, flight);
            radius + one_norm(&(centre - model.pivot))
        };
        let (a, b) = (&flight.model_a, &flight.model_b);
        let tick = magnitude(flight.span);
        let reach = [reach(Operand::A, a), reach(Operand::B, b)];
        let velocity = flight.velocity() * tick;
        let pace = |angular: &Vector3<f64>| {
            if *angular == Vector3::zeros() {
                return 0.0;
            }
            let angular = angular * tick;
            tilt(&angular.cross(n), &angular)
        };
        Self {
            flight,
            n,
            gap,
            tick,
            reach,
            slope: n.dot(&velocity),
            velocity,
            turning: pace(&a.angular) * reach[0] + pace(&b.angular) * reach[1],
        }
    }

    /// Returns whether the plane is expected to prove most of what a plane that rotates can.
    ///
    /// This holds for shapes that do not rotate, and for most of the time to a contact that is not
    /// near.
    fn lasts(&self) -> bool {
        let gap = self.gap - self.flight.required;
        let is_far = gap > FIXED_GAP * (self.reach[0] + self.reach[1]);
        self.turning == 0.0 || is_far && self.turning <= -FIXED_SHARE * self.slope
    }

    /// Returns whether the plane may prove the whole motion, without the drifts of motions.
    fn may_prove_all(&self) -> bool {
        let way = (self.turning - self.slope) * (self.flight.span / self.tick);
        self.gap - self.flight.required > way
    }

    /// Returns how long the plane separates the shapes, and the plane.
    pub(super) fn proof(&self) -> FreeSpan {
        let proof = Proof::Plane {
            normal: *self.n,
            spin: Vector3::zeros(),
        };
        FreeSpan {
            span: self.until(),
            proof,
        }
    }

    fn until(&self) -> f64 {
        let (flight, tick, [reach_a, reach_b]) = (self.flight, self.tick, self.reach);
        let size = flight.size(reach_a + reach_b);
        let drift = flight.model_a.drift(reach_a) + flight.model_b.drift(reach_b);
        let Remainder([d0, d1, d2, d3]) = drift.on_clock(tick);
        let d1 = d1 + self.turning;
        let acceleration = flight.acceleration() * tick * tick;
        let (slope, bend) = (self.slope, self.n.dot(&acceleration));
        let rates = one_norm(&self.velocity) + self.turning;
        let margin = |length: f64| PLANE * length * (rates + length * one_norm(&acceleration));
        let now = self.gap - (PLANE * size + flight.required + d0 + f64::MIN_POSITIVE);
        let mut length = (flight.span / tick).smaller(AHEAD * time_to(self.gap, slope - d1, bend - d2));
        if !(length < f64::INFINITY && now > 0.0) {
            return 0.0;
        }
        while margin(length) > 0.5 * now && length > f64::MIN_POSITIVE {
            length *= cut(margin(length) / (0.5 * now));
        }
        let b0 = now - margin(length);
        let way = |k: f64| slope * length * (k / 3.0);
        let (late, square) = (d1 * length, 0.5 * (bend - d2) * length * length);
        let cube = d3 * length * length * length * (1.0 / 6.0);
        if square == 0.0 && cube == 0.0 {
            return line_positive_until(b0, b0 + way(3.0) - late) * length * tick;
        }
        let part = positive_until([
            b0,
            b0 + way(1.0) - late * (1.0 / 3.0),
            b0 + way(2.0) - late * (2.0 / 3.0) + square * (1.0 / 3.0),
            b0 + way(3.0) - late + square - cube,
        ]);
        part * length * tick
    }
}

impl PairMotion {
    /// Returns a proof by a plane that keeps its normal, if the plane proves enough.
    ///
    /// It must prove the whole motion, or be expected to prove most of what a rotating plane can. A
    /// rotating plane needs support points.
    pub(crate) fn by_fixed_normal<S: Separation + ?Sized>(&self, pair: &S, seen: &Measurement) -> Option<FreeSpan> {
        if !seen.by_plane {
            return None;
        }
        let normal = self.pose_a.rotation * seen.normal.into_inner();
        let plane = FixedNormal::new(pair, self, &normal, seen.lower);
        let lasts = plane.lasts();
        if !lasts && !plane.may_prove_all() {
            return None;
        }
        Some(plane.proof()).filter(|free| lasts || free.span >= self.span)
    }

    /// Returns the velocity of B's pivot minus that of A's.
    pub(super) fn velocity(&self) -> Vector3<f64> {
        self.model_b.linear - self.model_a.linear
    }

    pub(super) fn acceleration(&self) -> Vector3<f64> {
        self.model_b.acceleration - self.model_a.acceleration
    }

    /// Returns the lengths to which rounding is relative, without the displacements of the pivots.
    ///
    /// `reach` is the sum of the radii of both shapes.
    pub(super) fn size(&self, reach: f64) -> f64 {
        let offset = self.pose_b.translation.vector - self.pose_a.translation.vector;
        let pivots = one_norm(&self.model_a.pivot.coords) + one_norm(&self.model_b.pivot.coords);
        reach + one_norm(&offset) + 2.0 * pivots + self.required
    }
}

/// Returns the first time at which `way + slope s + bend s^2 / 2` is zero; infinite if never.
pub(super) fn time_to(way: f64, slope: f64, bend: f64) -> f64 {
    let square = slope * slope - 2.0 * way * bend;
    let pace = sqrt(square.at_least(0.0)) - slope;
    if square >= 0.0 && pace > 0.0 {
        2.0 * way / pace
    } else {
        f64::INFINITY
    }
}

/// Returns the factor by which an interval is cut if its bound is `excess` times the allowed value.
///
/// - **Near the bound**: by a quarter, so that no cut is much too deep.
/// - **Far from the bound**: by what a bound of degree eight needs at least, so that about a
///   hundred cuts suffice for any bound.
/// - **An infinite bound**: by the largest cut.
pub(super) fn cut(excess: f64) -> f64 {
    if excess < CUT_FAR {
        CUT
    } else {
        sqrt(sqrt(sqrt(1.0 / excess))).at_least(CUT_MOST)
    }
}

/// Returns the sum of the absolute coordinates, which is at least the length.
pub(super) fn one_norm(v: &Vector3<f64>) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::rng::Rng;

    /// For bounds of every degree and size, and infinite ones, about a hundred cuts suffice.
    ///
    /// No cut is much too deep.
    #[test]
    fn cuts_end_soon_and_none_is_much_too_deep() {
        let mut rng = Rng::new(29);
        let mut most = 0;
        for case in 0..3000 {
            let terms: [f64; 8] = core::array::from_fn(|_| {
                if rng.chance(0.3) {
                    rng.log_range(1e-290, 1e290)
                } else {
                    0.0
                }
            });
            let allowed = rng.log_range(1e-290, 1e290);
            let bound = |x: f64| {
                terms
                    .iter()
                    .fold((0.0, x), |(sum, power), c| (sum + c * power, power * x))
                    .0
            };
            let mut interval = rng.log_range(1e-300, 2.0);
            let mut cuts = 0;
            let mut last = interval;
            while bound(interval) > allowed && interval > f64::MIN_POSITIVE {
                last = interval;
                interval *= cut(bound(interval) / allowed);
                cuts += 1;
            }
            assert!(cuts < 150, "{case}: {terms:?} {allowed} {cuts}");
            // Powers of such intervals are not normal numbers.
            let is_known = bound(last) < f64::INFINITY && interval > 1e-37;
            assert!(
                !is_known || cuts == 0 || bound(1.34 * interval) > allowed,
                "{case}: {terms:?} {allowed} {interval}"
            );
            most = cuts.max(most);
        }
        assert!(most > 30, "{most}");
        assert_eq!([cut(1.0), cut(f64::INFINITY), cut(f64::NAN)], [CUT, CUT_MOST, CUT_MOST]);
    }
}
