//! One look ahead: a separating plane that turns with the closest features, bounded over all points
//! of both shapes at once.
//!
//! # Scheme
//!
//! At an instant, n points from A to B, `dc`, `dv`, `da` lead from A's pivot to B's, and the shapes
//! turn at `wA`, `wB`. Let the normal turn at any rate chosen, `n(s) = exp(eta s) n`. With `h_X(m)`
//! the greatest `m . x` over the points x of X about its pivot, in axes that turn with X, the gap
//! along the normal is
//!
//! `g(s) = n(s) . (dc + dv s + da s^2 / 2) - h_A(mA(s)) - h_B(-mB(s))`,
//!
//! `m_X(s) = exp(-w_X s) exp(eta s) n`,
//!
//! and `g > 0` on an interval proves the shapes apart there, whatever eta is. Taylor's theorem with
//! `m' = (eta - w) x n`, `m'' = eta x (eta x n) - 2 w x (eta x n) + w x (w x n)` and
//! `|m'''| <= |eta - w| (|eta| + |w|)^2 =: M` (m' is a rotated rotation of `(eta - w) x n`; each
//! further derivative adds a factor of at most `|eta| + |w|`) puts m within `M s^3 / 6` of a
//! parabola, and a parabola is a Bezier curve: with `D0 = n`, `D1 = n + s1 m' / 2`,
//! `D2 = n + s1 m' + s1^2 m'' / 2` and x = s / s1,
//!
//! `h(m(s)) <= (1 - x)^2 h(D0) + 2 x (1 - x) h(D1) + x^2 h(D2) + r M s^3 / 6`,
//!
//! since h is sublinear and at most r times its argument's length. Three support points a shape
//! bound all points at all times. The first term is treated likewise,
//! `|f'''| <= |eta|^3 |dc + dv s + da s^2 / 2| + 3 |eta|^2 |dv + da s| + 3 |eta| |da|`. So g is at
//! least the cubic of four Bernstein coefficients, less the drifts of both motions, and its first
//! root bounds the time.
//!
//! # Which way the plane turns
//!
//! The distance is the greatest gap over all n: a plane that turns as the closest direction does
//! touches it to first order, and a step to its root converges quadratically. A face carries its
//! normal along (eta = w); two edges keep theirs perpendicular to both.
//!
//! Sources: a plane attached to features is Gregorius 2013 (continuous collision, GDC) and Box2D's
//! time of impact (Catto), there without a bound between the ends. Departures: 1. the bound over
//! the interval; 2. the plane of two edges turns with both;
//! 3. far from contact a plane that does not turn is tried, too; 4. rounding and the drift of
//!    motions are part of the bound.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::bernstein::positive_until;
use super::{Flight, Free, Measure, Proof, Separation, Tangent};
use crate::motion::{Course, Drift};
use crate::num::scalar::sqrt;
use crate::pose::{Operand, rotation_matrix};
use crate::tolerance::PLANE;
use crate::tuning::separation::{AHEAD, ENOUGH, FAR, TRIES};

/// Returns the time for which a turning plane proves the shapes more than `flight.keep` apart.
pub(super) fn free_for<S: Separation + ?Sized>(pair: &mut S, seen: &Measure, flight: &Flight) -> Free {
    let still = Vector3::zeros();
    if seen.by_plane && turns_neither(flight) {
        let normal = flight.pose_a.rotation * seen.normal.into_inner();
        return Free {
            span: straight_until(pair, flight, &normal, seen.lower),
            proof: Proof::Plane { normal, spin: still },
        };
    }
    let setting = Setting::new(pair, flight);
    let normal = setting.a.rotation * seen.normal.into_inner();
    let at = (setting.a.height(pair, &normal), setting.b.height(pair, &-normal));
    let spin = setting.spin(&normal, &seen.tangent);
    let (mut plane, mut chosen) = (setting.plane(&normal, &spin, &at), spin);
    if spin != still && seen.lower - flight.keep > FAR * (setting.a.reach + setting.b.reach) {
        let other = setting.plane(&normal, &still, &at);
        if other.ahead > plane.ahead {
            (plane, chosen) = (other, still);
        }
    }
    Free {
        span: plane.reach(pair),
        proof: Proof::Plane { normal, spin: chosen },
    }
}

/// Returns the time in which the witnesses come nearer by `way`, to second order; `None` if never.
pub(super) fn forecast<S: Separation + ?Sized>(pair: &S, seen: &Measure, flight: &Flight, way: f64) -> Option<f64> {
    let ahead = |slope: f64, bend: f64| Some(time_to(way, slope, bend)).filter(|t| *t < f64::INFINITY);
    if turns_neither(flight) {
        let normal = flight.pose_a.rotation * seen.normal.into_inner();
        return ahead(normal.dot(&flight.velocity()), normal.dot(&flight.acceleration()));
    }
    let set = Setting::new(pair, flight);
    let normal = set.a.rotation * seen.normal.into_inner();
    let spin = set.spin(&normal, &seen.tangent);
    let (turn_a, turn_b) = (
        set.a.turn(&normal, &spin, spin.norm()),
        set.b.turn(&normal, &spin, spin.norm()),
    );
    let on_a = set.a.rotation * (seen.point_on_a - flight.course_a.pivot);
    let on_b = set.b.rotation * (seen.point_on_b - flight.course_b.pivot);
    let [_, f1, f2] = set.way(&normal, &spin);
    let slope = f1 - turn_a.first.dot(&on_a) + turn_b.first.dot(&on_b);
    let bend = f2 - turn_a.second.dot(&on_a) + turn_b.second.dot(&on_b);
    ahead(slope, bend)
}

/// Whether neither shape turns: then a plane that proves the shapes apart keeps its normal, and the
/// gap is a parabola, exactly.
fn turns_neither(flight: &Flight) -> bool {
    flight.course_a.angular == Vector3::zeros() && flight.course_b.angular == Vector3::zeros()
}

/// Returns the time for which shapes that do not turn are apart along a normal, from the gap along
/// the normal now.
fn straight_until<S: Separation + ?Sized>(pair: &S, flight: &Flight, n: &Vector3<f64>, gap: f64) -> f64 {
    let reach = |which: Operand, course: &Course| {
        let (centre, radius) = pair.ball(which);
        radius + one_norm(&(centre - course.pivot))
    };
    let (course_a, course_b) = (&flight.course_a, &flight.course_b);
    let (reach_a, reach_b) = (reach(Operand::A, course_a), reach(Operand::B, course_b));
    let size = flight.size(reach_a + reach_b);
    let Drift([d0, d1, d2, d3]) = course_a.drift(reach_a) + course_b.drift(reach_b);
    let (velocity, acceleration) = (flight.velocity(), flight.acceleration());
    let (slope, bend) = (n.dot(&velocity), n.dot(&acceleration));
    let length = flight.span.min(AHEAD * time_to(gap, slope, bend));
    if !(length < f64::INFINITY) {
        return 0.0;
    }
    let ways = length * (one_norm(&velocity) + length * one_norm(&acceleration));
    let b0 = gap - (PLANE * (size + ways) + flight.keep + d0);
    let way = |k: f64| slope * length * (k / 3.0);
    let (late, square) = (d1 * length, 0.5 * (bend - d2) * length * length);
    let cube = d3 * length * length * length * (1.0 / 6.0);
    let part = positive_until([
        b0,
        b0 + way(1.0) - late * (1.0 / 3.0),
        b0 + way(2.0) - late * (2.0 / 3.0) + square * (1.0 / 3.0),
        b0 + way(3.0) - late + square - cube,
    ]);
    part * length
}

impl Flight {
    /// Returns the velocity of B's pivot less that of A's.
    fn velocity(&self) -> Vector3<f64> {
        self.course_b.linear - self.course_a.linear
    }

    fn acceleration(&self) -> Vector3<f64> {
        self.course_b.acceleration - self.course_a.acceleration
    }

    /// Returns lengths to which rounding is relative, without the displacements of the pivots;
    /// `reach` is the sum of those of both shapes.
    fn size(&self, reach: f64) -> f64 {
        let offset = self.pose_b.translation.vector - self.pose_a.translation.vector;
        let pivots = one_norm(&self.course_a.pivot.coords) + one_norm(&self.course_b.pivot.coords);
        reach + one_norm(&offset) + 2.0 * pivots + self.keep
    }
}

/// The first time at which `way + slope s + bend s^2 / 2` is zero; infinite if never.
fn time_to(way: f64, slope: f64, bend: f64) -> f64 {
    let square = slope * slope - 2.0 * way * bend;
    let pace = sqrt(square.max(0.0)) - slope;
    if square >= 0.0 && pace > 0.0 {
        2.0 * way / pace
    } else {
        f64::INFINITY
    }
}

/// One shape at the instant.
struct Side {
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

/// Heights of both shapes along the normal, and their points.
type Heights = ((f64, Vector3<f64>), (f64, Vector3<f64>));

/// Turn of the direction as seen from a shape: first and second derivative, and a bound of the
/// third.
struct Turn {
    /// Whether the direction does not turn at all.
    rests: bool,
    first: Vector3<f64>,
    second: Vector3<f64>,
    third: f64,
}

impl Side {
    fn new<S: Separation + ?Sized>(pair: &S, which: Operand, pose: &Isometry3<f64>, course: &Course) -> Self {
        let (centre, radius) = pair.ball(which);
        let q = pose.rotation.coords;
        let arm = centre - course.pivot;
        Self {
            which,
            rotation: rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared()),
            arm,
            reach: radius + one_norm(&arm),
            angular: course.angular,
            rate: course.angular.norm(),
        }
    }

    /// Returns the height about the pivot along a direction of the world, and the support point.
    fn height<S: Separation + ?Sized>(&self, pair: &mut S, direction: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let own = self.rotation.tr_mul(direction);
        let support = pair.support(self.which, &own);
        (
            support.height + own.dot(&self.arm),
            self.rotation * (support.point + self.arm),
        )
    }

    fn turn(&self, n: &Vector3<f64>, spin: &Vector3<f64>, spin_rate: f64) -> Turn {
        let w = &self.angular;
        if w == spin {
            return Turn {
                rests: true,
                first: Vector3::zeros(),
                second: Vector3::zeros(),
                third: 0.0,
            };
        }
        let with_spin = spin.cross(n);
        let rate = spin_rate + self.rate;
        Turn {
            rests: false,
            first: (spin - w).cross(n),
            second: spin.cross(&with_spin) - w.cross(&with_spin) * 2.0 + w.cross(&w.cross(n)),
            third: (spin - w).norm() * rate * rate,
        }
    }
}

/// Both shapes at the instant.
struct Setting<'a> {
    flight: &'a Flight,
    a: Side,
    b: Side,
    /// From A's pivot to B's.
    between: Vector3<f64>,
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    drift: Drift,
    /// Lengths to which rounding is relative, without the displacements of the pivots.
    size: f64,
}

impl<'a> Setting<'a> {
    fn new<S: Separation + ?Sized>(pair: &S, flight: &'a Flight) -> Self {
        let (course_a, course_b) = (&flight.course_a, &flight.course_b);
        let a = Side::new(pair, Operand::A, &flight.pose_a, course_a);
        let b = Side::new(pair, Operand::B, &flight.pose_b, course_b);
        let offset = flight.pose_b.translation.vector - flight.pose_a.translation.vector;
        let (pivot_a, pivot_b) = (course_a.pivot.coords, course_b.pivot.coords);
        let between = offset + (b.rotation * pivot_b - a.rotation * pivot_a);
        Self {
            between,
            velocity: flight.velocity(),
            acceleration: flight.acceleration(),
            drift: course_a.drift(a.reach) + course_b.drift(b.reach),
            size: flight.size(a.reach + b.reach),
            flight,
            a,
            b,
        }
    }

    /// Returns the rate at which the plane turns with the features.
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

    /// Returns the plane that turns at a rate, and the interval of the first try.
    fn plane<'b>(&'b self, n: &'b Vector3<f64>, spin: &Vector3<f64>, at: &'b Heights) -> Plane<'b> {
        let spin_rate = spin.norm();
        let mut plane = Plane {
            setting: self,
            n,
            turn_a: self.a.turn(n, spin, spin_rate),
            turn_b: self.b.turn(n, spin, spin_rate),
            spin_rate,
            rate: spin_rate + self.a.rate.max(self.b.rate),
            way: self.way(n, spin),
            at_a: &at.0,
            at_b: &at.1,
            gap: 0.0,
            ahead: 0.0,
        };
        plane.gap = plane.way[0] - at.0.0 - at.1.0 - plane.taken(0.0);
        if plane.gap > 0.0 {
            plane.ahead = plane.shortened(self.flight.span.min(AHEAD * plane.expected()));
        }
        plane
    }

    /// `n(s) . (dc + dv s + da s^2 / 2)` and its first two derivatives.
    fn way(&self, n: &Vector3<f64>, spin: &Vector3<f64>) -> [f64; 3] {
        let (turned, bent) = (spin.cross(n), spin.cross(&spin.cross(n)));
        [
            n.dot(&self.between),
            turned.dot(&self.between) + n.dot(&self.velocity),
            bent.dot(&self.between) + 2.0 * turned.dot(&self.velocity) + n.dot(&self.acceleration),
        ]
    }
}

/// A plane that turns, and the heights of both shapes at the instant.
struct Plane<'a> {
    setting: &'a Setting<'a>,
    n: &'a Vector3<f64>,
    turn_a: Turn,
    turn_b: Turn,
    spin_rate: f64,
    /// No direction turns faster as either shape sees it.
    rate: f64,
    way: [f64; 3],
    at_a: &'a (f64, Vector3<f64>),
    at_b: &'a (f64, Vector3<f64>),
    /// The gap at the instant, less the margin.
    gap: f64,
    /// The interval of the first try; zero if there is no gap.
    ahead: f64,
}

impl Plane<'_> {
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
            best = proven.max(best);
            if part >= ENOUGH {
                break;
            }
            length = self.shortened(2.0 * proven);
        }
        best
    }

    /// Returns the margin that rounding, the distance to keep and the constant part of the drifts
    /// take off every coefficient of an interval.
    fn taken(&self, length: f64) -> f64 {
        let (set, q) = (self.setting, 1.0 + self.rate * length);
        let ways = length * (one_norm(&set.velocity) + length * one_norm(&set.acceleration));
        PLANE * q * q * (set.size + ways) + set.flight.keep + set.drift.0[0]
    }

    /// Returns the time at which the present support points would meet the plane from both sides;
    /// infinite if never.
    fn expected(&self) -> f64 {
        let (a, b) = (&self.at_a.1, &self.at_b.1);
        let slope = self.way[1] - self.turn_a.first.dot(a) + self.turn_b.first.dot(b);
        let bend = self.way[2] - self.turn_a.second.dot(a) + self.turn_b.second.dot(b);
        time_to(self.gap, slope, bend)
    }

    /// Bound of the third derivative of the gap over an interval.
    fn third(&self, length: f64) -> f64 {
        let (set, eta) = (self.setting, self.spin_rate);
        let push = set.acceleration.norm();
        let pace = set.velocity.norm() + push * length;
        let apart = set.between.norm() + pace * length;
        let of_way = eta * (eta * (eta * apart + 3.0 * pace) + 3.0 * push);
        (of_way + set.a.reach * self.turn_a.third + set.b.reach * self.turn_b.third) * (1.0 + PLANE)
    }

    /// Returns the interval, cut until the remainder of Taylor's theorem is at most twice the gap;
    /// zero for an interval without end.
    fn shortened(&self, length: f64) -> f64 {
        let mut length = if length < f64::INFINITY { length } else { 0.0 };
        while self.third(length) * length * length * length > 12.0 * self.gap {
            length *= 0.75;
        }
        length
    }

    /// Bernstein coefficients of a cubic that is nowhere above the gap over an interval.
    fn coefficients<S: Separation + ?Sized>(&self, pair: &mut S, length: f64) -> [f64; 4] {
        let (set, [f0, f1, f2]) = (self.setting, self.way);
        let taken = self.taken(length);
        let half = 0.5 * length;
        let mut height = |side: &Side, turn: &Turn, at: f64, sign: f64| {
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
        let rest = self.third(length) * length * length * length * (1.0 / 6.0);
        let (d1, d2, d3) = self.drifts(length);
        [
            b0,
            (b0 + 2.0 * b1) * (1.0 / 3.0) - d1,
            (2.0 * b1 + b2) * (1.0 / 3.0) - d2,
            b2 - rest - d3,
        ]
    }

    /// Bernstein coefficients of the drifts, without their constant part.
    fn drifts(&self, length: f64) -> (f64, f64, f64) {
        let [_, d1, d2, d3] = self.setting.drift.0;
        let (linear, square) = (d1 * length, 0.5 * d2 * length * length);
        let cube = d3 * length * length * length * (1.0 / 6.0);
        let third = 1.0 / 3.0;
        (linear * third, (2.0 * linear + square) * third, linear + square + cube)
    }
}

/// The sum of the absolute coordinates: no less than the length.
fn one_norm(v: &Vector3<f64>) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
