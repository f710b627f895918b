//! One step of a cast: a separating plane that rotates with the closest features, bounded over all
//! points of both shapes at once.
//!
//! # Scheme
//!
//! At the start of the step, n points from A to B, `dc`, `dv`, `da` lead from A's pivot to B's, and
//! the shapes rotate at `wA`, `wB`. Let the normal rotate at any chosen rate,
//! `n(s) = exp(eta s) n`. Let `h_X(m)` be the greatest `m . x` over the points x of X about its
//! pivot, in axes that rotate with X. Then the gap along the normal is
//!
//! `g(s) = n(s) . (dc + dv s + da s^2 / 2) - h_A(mA(s)) - h_B(-mB(s))`,
//!
//! `m_X(s) = exp(-w_X s) exp(eta s) n`,
//!
//! and `g > 0` on an interval proves the shapes separated there, for every eta. Taylor's theorem
//! uses `m' = (eta - w) x n`, `m'' = eta x (eta x n) - 2 w x (eta x n) + w x (w x n)` and a bound M
//! of `|m'''|` on the interval [0, s1]. It puts m within `M s^3 / 6` of a parabola, and a parabola
//! is a Bezier curve. With `D0 = n`, `D1 = n + s1 m' / 2`, `D2 = n + s1 m' + s1^2 m'' / 2` and x =
//! s / s1,
//!
//! `h(m(s)) <= (1 - x)^2 h(D0) + 2 x (1 - x) h(D1) + x^2 h(D2) + r M s^3 / 6`,
//!
//! because h is sublinear and at most r times the length of its argument. Three support points per
//! shape bound all points at all times. The first term f, `n(s) . (dc + dv s + da s^2 / 2)`, is
//! treated in the same way. So g is at least the cubic of four Bernstein coefficients, minus the
//! drifts of both motions, and the first root of this cubic bounds the time.
//!
//! # Third derivatives
//!
//! Let E, W and D be the cross products with eta, w and `eta - w`, and `e = |eta x n|`. As
//! `n' = E n(s)`, derivatives of m are `exp(-w s) P n(s)` with `P = D`, then `-W D + D E`, then
//! `W^2 D - 2 W D E + D E^2`. E commutes with the rotation about eta, so `|E n(s)| = e` and
//! `|E^2 n(s)| = |eta| e` at every s, and n(s) is within `e s` of n. Hence
//!
//! `|D n(s)| <= min(|eta - w|, |(eta - w) x n| + |eta - w| e s1)`,
//!
//! `M = |w|^2 |D n(s)| + |eta - w| e (2 |w| + |eta|)`,
//!
//! `|f'''| <= e (|eta|^2 |dc + dv s + da s^2 / 2| + 3 |eta| |dv + da s| + 3 |da|)`.
//!
//! Both vanish if n is the axis of all rotations (a plate that spins over a parallel plate). e is
//! at most `|eta|`, so M is never more than `|eta - w| (|eta| + |w|)^2`.
//!
//! # How the plane rotates
//!
//! The distance is the greatest gap over all n. So the gap of a plane that rotates as the closest
//! direction does agrees with the distance to first order, and a step to its root converges
//! quadratically. A face carries its normal along (eta = w); two edges keep their normal
//! perpendicular to both.
//!
//! Sources: a plane attached to features is Gregorius 2013 (continuous collision, GDC) and Box2D's
//! time of impact (Catto), there without a bound between the ends. Departures:
//!
//! 1. The bound holds over the interval.
//! 2. The plane of two edges rotates with both.
//! 3. Far from contact a plane that does not rotate is tried as well.
//! 4. Rounding and the drift of motions are included in the bound.

use nalgebra::{Matrix3, Vector3};

use super::bernstein::positive_until;
use super::fixed_normal::{FixedNormal, cut, one_norm, time_to, turns_neither};
use super::{FreeSpan, Measurement, PairMotion, Proof, Separation, Tangent};
use crate::base::motion::{Remainder, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::magnitude;
use crate::base::pose::{Operand, rotation_matrix};
use crate::base::tolerance::{PLANE, TILT};

/// Factor from the expected root to the first interval tried. A longer interval gives the bound
/// more room, but has a larger remainder.
///
/// Measured with [`TRIES`]: 1.2 planes per step.
pub(super) const AHEAD: f64 = 1.25;

/// Fraction of the interval tried below which a plane is tried again, with twice the proven time.
/// This gives a longer step for the cost of another plane.
///
/// Measured with [`TRIES`].
const ENOUGH: f64 = 0.4;

/// Largest number of tries of a plane. The measured average is 1.4.
const TRIES: u32 = 3;

/// Gap beyond which a plane that does not rotate is tried too, in units of the sum of both radii.
///
/// It saves up to 40 % of the measured steps for the time of a second plane.
const FAR: f64 = 0.05;

/// Returns how long a rotating plane proves the shapes more than `flight.required` apart.
pub(crate) fn free_for<S: Separation + ?Sized>(pair: &mut S, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
    if seen.by_plane && turns_neither(flight) {
        let normal = flight.pose_a.rotation * seen.normal.into_inner();
        return FixedNormal::new(pair, flight, &normal, seen.lower).proof();
    }
    let (timed, tick) = flight.on_own_clock();
    let free = free_on_own_clock(pair, seen, &timed);
    let proof = match free.proof {
        Proof::Plane { normal, spin } => Proof::Plane {
            normal,
            spin: spin / tick,
        },
        other => other,
    };
    FreeSpan {
        span: free.span * tick,
        proof,
    }
}

fn free_on_own_clock<S: Separation + ?Sized>(pair: &mut S, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
    let still = Vector3::zeros();
    let setting = PlaneSetting::new(pair, flight);
    let normal = setting.a.rotation * seen.normal.into_inner();
    let at = (setting.a.height(pair, &normal), setting.b.height(pair, &-normal));
    let spin = setting.spin(&normal, &seen.tangent);
    let (mut plane, mut chosen) = (setting.plane(&normal, &spin, &at), spin);
    if spin != still && seen.lower - flight.required > FAR * (setting.a.reach + setting.b.reach) {
        let other = setting.plane(&normal, &still, &at);
        if other.ahead > plane.ahead {
            (plane, chosen) = (other, still);
        }
    }
    FreeSpan {
        span: plane.reach(pair),
        proof: Proof::Plane { normal, spin: chosen },
    }
}

/// Returns the time after which the witnesses are nearer by `way`, to second order; `None` if
/// never.
pub(super) fn forecast<S: Separation + ?Sized>(
    pair: &S,
    seen: &Measurement,
    flight: &PairMotion,
    way: f64,
) -> Option<f64> {
    let tick = magnitude(flight.span);
    let ahead = |slope: f64, bend: f64| Some(time_to(way, slope, bend) * tick).filter(|t| *t < f64::INFINITY);
    if turns_neither(flight) {
        let normal = flight.pose_a.rotation * seen.normal.into_inner();
        let (slope, bend) = (normal.dot(&flight.velocity()), normal.dot(&flight.acceleration()));
        return ahead(slope * tick, bend * tick * tick);
    }
    let (timed, _) = flight.on_own_clock();
    let flight = &timed;
    let set = PlaneSetting::new(pair, flight);
    let normal = set.a.rotation * seen.normal.into_inner();
    let spin = set.spin(&normal, &seen.tangent);
    let (turn_a, turn_b) = (set.a.turn(&normal, &spin), set.b.turn(&normal, &spin));
    let on_a = set.a.rotation * (seen.point_on_a - flight.model_a.pivot);
    let on_b = set.b.rotation * (seen.point_on_b - flight.model_b.pivot);
    let [_, f1, f2] = way_along(&normal, &spin, [&set.between, &set.velocity, &set.acceleration]);
    let slope = f1 - turn_a.first.dot(&on_a) + turn_b.first.dot(&on_b);
    let bend = f2 - turn_a.second.dot(&on_a) + turn_b.second.dot(&on_b);
    ahead(slope, bend)
}

/// One shape at the start of the step.
struct PlaneSide {
    which: Operand,
    /// From the shape's axes to the world's.
    rotation: Matrix3<f64>,
    /// From the pivot to the centre of the ball, in the shape's axes.
    arm: Vector3<f64>,
    /// No point of the shape is farther from the pivot.
    reach: f64,
    angular: Vector3<f64>,
    rate: f64,
}

/// Support values of both shapes along the normal, and their points.
type Heights = ((f64, Vector3<f64>), (f64, Vector3<f64>));

/// Rotation of the direction as seen from a shape: the first and the second derivative, and the
/// bounds of the third.
struct Turn {
    /// Whether the direction does not rotate at all.
    rests: bool,
    first: Vector3<f64>,
    second: Vector3<f64>,
    /// The rate at which the direction rotates minus the rate of the shape.
    off: f64,
    /// Upper bound of the length of the first derivative.
    pace: f64,
}

impl PlaneSide {
    fn new<S: Separation + ?Sized>(pair: &S, which: Operand, flight: &PairMotion) -> Self {
        let (pose, model) = match which {
            Operand::A => (&flight.pose_a, &flight.model_a),
            Operand::B => (&flight.pose_b, &flight.model_b),
        };
        let (centre, radius) = pair.ball_during(which, flight);
        let q = pose.rotation.coords;
        let arm = centre - model.pivot;
        Self {
            which,
            rotation: rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared()),
            arm,
            reach: radius + one_norm(&arm),
            angular: model.angular,
            rate: length(&model.angular),
        }
    }

    /// Returns the support value about the pivot along a direction of the world, and the support
    /// point.
    fn height<S: Separation + ?Sized>(&self, pair: &mut S, direction: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let own = self.rotation.tr_mul(direction);
        let support = pair.support(self.which, &own);
        (
            support.height + own.dot(&self.arm),
            self.rotation * (support.point + self.arm),
        )
    }

    fn turn(&self, n: &Vector3<f64>, spin: &Vector3<f64>) -> Turn {
        let w = &self.angular;
        if w == spin {
            return Turn {
                rests: true,
                first: Vector3::zeros(),
                second: Vector3::zeros(),
                off: 0.0,
                pace: 0.0,
            };
        }
        let [first, second] = derivatives(n, spin, w);
        Turn {
            rests: false,
            first,
            second,
            off: length(&(spin - w)),
            pace: tilt(&first, &(spin - w)),
        }
    }

    /// Returns a bound of the third derivative of a direction, times the cube of an interval.
    ///
    /// Takes the angle by which the direction rotates and the length of the path of its tip.
    fn remainder(&self, turn: &Turn, interval: f64, [angle, tilt]: [f64; 2]) -> f64 {
        let [rate, off, pace] = [self.rate, turn.off, turn.pace].each(|x| x * interval);
        rate * rate * off.smaller(pace + off * tilt) + off * tilt * (2.0 * rate + angle)
    }
}

/// Both shapes at the start of the step.
struct PlaneSetting<'a> {
    flight: &'a PairMotion,
    a: PlaneSide,
    b: PlaneSide,
    /// From A's pivot to B's.
    between: Vector3<f64>,
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    drift: Remainder,
    /// Lengths to which rounding is relative, without the displacements of the pivots.
    size: f64,
}

impl<'a> PlaneSetting<'a> {
    fn new<S: Separation + ?Sized>(pair: &S, flight: &'a PairMotion) -> Self {
        let (model_a, model_b) = (&flight.model_a, &flight.model_b);
        let a = PlaneSide::new(pair, Operand::A, flight);
        let b = PlaneSide::new(pair, Operand::B, flight);
        let offset = flight.pose_b.translation.vector - flight.pose_a.translation.vector;
        let (pivot_a, pivot_b) = (model_a.pivot.coords, model_b.pivot.coords);
        let between = offset + (b.rotation * pivot_b - a.rotation * pivot_a);
        Self {
            between,
            velocity: flight.velocity(),
            acceleration: flight.acceleration(),
            drift: model_a.drift(a.reach) + model_b.drift(b.reach),
            size: flight.size(a.reach + b.reach),
            flight,
            a,
            b,
        }
    }

    /// Returns the rate at which the plane rotates with the features.
    fn spin(&self, n: &Vector3<f64>, tangent: &Tangent) -> Vector3<f64> {
        match tangent {
            Tangent::Free => Vector3::zeros(),
            Tangent::WithA => self.a.angular,
            Tangent::WithB => self.b.angular,
            Tangent::Edges(a, b) => {
                let (ea, eb) = (self.a.rotation * a, self.b.rotation * b);
                let (wa, wb) = (&self.a.angular, &self.b.angular);
                let (across_a, across_b) = (ea.cross(n), eb.cross(n));
                let turned = across_b * (wa.cross(n).dot(&ea) / ea.dot(&across_b))
                    + across_a * (wb.cross(n).dot(&eb) / eb.dot(&across_a));
                let spin = n.cross(&turned) + n * (0.5 * n.dot(&(wa + wb)));
                // Nearly parallel edges; NaN for parallel ones.
                if spin.norm() <= 4.0 * (self.a.rate + self.b.rate) {
                    spin
                } else {
                    Vector3::zeros()
                }
            }
        }
    }

    /// Returns the plane that rotates at a rate, and the interval of the first try.
    fn plane<'b>(&'b self, n: &'b Vector3<f64>, spin: &Vector3<f64>, at: &'b Heights) -> PlaneBetween<'b> {
        let spin_rate = length(spin);
        let mut plane = PlaneBetween {
            setting: self,
            n,
            turn_a: self.a.turn(n, spin),
            turn_b: self.b.turn(n, spin),
            spin_rate,
            tilt: tilt(&spin.cross(n), spin),
            rate: spin_rate + self.a.rate.larger(self.b.rate),
            way: way_along(n, spin, [&self.between, &self.velocity, &self.acceleration]),
            at_a: &at.0,
            at_b: &at.1,
            gap: 0.0,
            ahead: 0.0,
        };
        plane.gap = plane.way[0] - at.0.0 - at.1.0 - plane.taken(0.0);
        if plane.gap > 0.0 {
            plane.ahead = plane.shortened(self.flight.span.smaller(AHEAD * plane.expected()));
        }
        plane
    }
}

/// Returns the first two derivatives of a direction, as seen by a body that rotates at the rate
/// `w`.
///
/// The direction rotates at the rate `spin`.
#[inline(always)]
pub(crate) fn derivatives(n: &Vector3<f64>, spin: &Vector3<f64>, w: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let with_spin = spin.cross(n);
    [
        (spin - w).cross(n),
        spin.cross(&with_spin) - w.cross(&with_spin) * 2.0 + w.cross(&w.cross(n)),
    ]
}

/// Returns `n(s) . (dc + dv s + da s^2 / 2)` and its first two derivatives.
#[inline(always)]
pub(crate) fn way_along(
    n: &Vector3<f64>,
    spin: &Vector3<f64>,
    [between, velocity, acceleration]: [&Vector3<f64>; 3],
) -> [f64; 3] {
    let (turned, bent) = (spin.cross(n), spin.cross(&spin.cross(n)));
    [
        n.dot(between),
        turned.dot(between) + n.dot(velocity),
        bent.dot(between) + 2.0 * turned.dot(velocity) + n.dot(acceleration),
    ]
}

/// A plane that rotates, and the support values of both shapes at the start of the step.
struct PlaneBetween<'a> {
    setting: &'a PlaneSetting<'a>,
    n: &'a Vector3<f64>,
    turn_a: Turn,
    turn_b: Turn,
    spin_rate: f64,
    /// Upper bound of the velocity of the tip of the normal.
    tilt: f64,
    /// Both shapes see every direction rotate at most at this rate.
    rate: f64,
    way: [f64; 3],
    at_a: &'a (f64, Vector3<f64>),
    at_b: &'a (f64, Vector3<f64>),
    /// The gap at the start of the step, minus the margin.
    gap: f64,
    /// The interval of the first try; zero if there is no gap.
    ahead: f64,
}

impl PlaneBetween<'_> {
    fn reach<S: Separation + ?Sized>(&self, pair: &mut S) -> f64 {
        let (mut length, mut best) = (self.ahead, 0.0);
        for _ in 0..TRIES {
            if !(length > best) {
                break;
            }
            let part = positive_until(self.coefficients(pair, length));
            if part >= 1.0 {
                return length;
            }
            let proven = part * length;
            best = proven.larger(best);
            if part >= ENOUGH {
                break;
            }
            length = self.shortened(2.0 * proven);
        }
        best
    }

    /// Returns the margin that is subtracted from every coefficient of an interval.
    ///
    /// It covers rounding, the distance to keep and the constant part of the drifts.
    fn taken(&self, length: f64) -> f64 {
        let (set, q) = (self.setting, 1.0 + self.rate * length);
        let ways = length * (one_norm(&set.velocity) + length * one_norm(&set.acceleration));
        PLANE * q * q * (set.size + ways) + set.flight.required + set.drift.0[0] + f64::MIN_POSITIVE
    }

    /// Returns the time at which the current support points would meet the plane from both sides.
    ///
    /// The drifts count against the gap.
    ///
    /// Infinite if never.
    fn expected(&self) -> f64 {
        let (a, b) = (&self.at_a.1, &self.at_b.1);
        let slope = self.way[1] - self.turn_a.first.dot(a) + self.turn_b.first.dot(b);
        let bend = self.way[2] - self.turn_a.second.dot(a) + self.turn_b.second.dot(b);
        let [_, d1, d2, _] = self.setting.drift.0;
        time_to(self.gap, slope - d1, bend - d2)
    }

    /// Returns a bound of the remainder of Taylor's theorem over an interval.
    ///
    /// This is the bound of the third derivative of the gap, times the cube of the interval, over
    /// six. All factors are angles and displacements of the interval, so no cube of a rate leaves
    /// f64.
    fn remainder(&self, interval: f64) -> f64 {
        let set = self.setting;
        let [angle, tilt] = [self.spin_rate, self.tilt].each(|x| x * interval);
        let push = length(&set.acceleration) * interval * interval;
        let pace = length(&set.velocity) * interval + push;
        let apart = length(&set.between) + pace;
        let of_way = tilt * (angle * (angle * apart + 3.0 * pace) + 3.0 * push);
        let of_a = set.a.reach * set.a.remainder(&self.turn_a, interval, [angle, tilt]);
        let of_b = set.b.reach * set.b.remainder(&self.turn_b, interval, [angle, tilt]);
        (of_way + of_a + of_b) * ((1.0 + PLANE) / 6.0)
    }

    /// Returns the interval, cut to keep the remainder, the bent part of the drifts and the margin
    /// small.
    ///
    /// The remainder and the drifts that grow faster than time are then at most twice the gap, and
    /// the margin leaves half of the gap. Returns zero for an infinite interval.
    fn shortened(&self, interval: f64) -> f64 {
        let mut interval = if interval < f64::INFINITY { interval } else { 0.0 };
        let (now, half) = (self.taken(0.0), 0.5 * self.gap);
        loop {
            let [_, _, d2, d3] = self.setting.drift.on_clock(interval).0;
            let rest = self.remainder(interval) + (0.5 * d2 + d3 / 6.0);
            let margin = self.taken(interval);
            if !(rest > 2.0 * self.gap || margin > now + half) {
                return interval;
            }
            if !(interval > f64::MIN_POSITIVE) {
                return 0.0;
            }
            interval *= cut((rest / (2.0 * self.gap)).at_least((margin - now) / half));
        }
    }

    /// Returns the Bernstein coefficients of a cubic that is nowhere above the gap over an
    /// interval.
    fn coefficients<S: Separation + ?Sized>(&self, pair: &mut S, length: f64) -> [f64; 4] {
        let (set, [f0, f1, f2]) = (self.setting, self.way);
        let taken = self.taken(length);
        let half = 0.5 * length;
        let mut height = |side: &PlaneSide, turn: &Turn, at: f64, sign: f64| {
            if turn.rests {
                return [at, at];
            }
            let near = (self.n + turn.first * half) * sign;
            let far = (self.n + (turn.first + turn.second * half) * length) * sign;
            [side.height(pair, &near).0, side.height(pair, &far).0]
        };
        let a = height(&set.a, &self.turn_a, self.at_a.0, 1.0);
        let b = height(&set.b, &self.turn_b, self.at_b.0, -1.0);
        let b0 = f0 - self.at_a.0 - self.at_b.0 - taken;
        let b1 = f0 + f1 * half - a[0] - b[0] - taken;
        let b2 = f0 + (f1 + f2 * half) * length - a[1] - b[1] - taken;
        let rest = self.remainder(length);
        let (d1, d2, d3) = self.drifts(length);
        [
            b0,
            (b0 + 2.0 * b1) * (1.0 / 3.0) - d1,
            (2.0 * b1 + b2) * (1.0 / 3.0) - d2,
            b2 - rest - d3,
        ]
    }

    /// Returns the Bernstein coefficients of the drifts, without their constant part.
    fn drifts(&self, length: f64) -> (f64, f64, f64) {
        let [_, d1, d2, d3] = self.setting.drift.0;
        let (linear, square) = (d1 * length, 0.5 * d2 * length * length);
        let cube = d3 * length * length * length * (1.0 / 6.0);
        let third = 1.0 / 3.0;
        (linear * third, (2.0 * linear + square) * third, linear + square + cube)
    }
}

/// Returns an upper bound of the length of the cross product of a rate with a unit vector.
///
/// The caller passes the product.
pub(crate) fn tilt(product: &Vector3<f64>, rate: &Vector3<f64>) -> f64 {
    length(product) + TILT * one_norm(rate)
}
