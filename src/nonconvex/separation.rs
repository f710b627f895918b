//! Compounds and meshes over time: how long two bodies with many members stay separated.
//!
//! No single plane separates bodies that extend into each other's hollows. So a look-ahead bounds
//! every pair of nodes of the two trees along its separate direction ([`LookAhead`]). It also
//! bounds the displacement of all points: bodies that are `d` apart stay separated until their
//! points may have moved by `d` relative to each other (Mirtich 1996, conservative advancement).
//! The longer of the two times is used.
//!
//! Let n be a unit direction that rotates with one body P, and let Q be the other body. Let c be
//! the centre of a ball of radius rho around the node of Q, and `g` the gap of the two nodes along
//! n at the start. Let `wP` and `wQ` be the angular velocities of a [`PairMotion`], `D` the vector
//! from P's pivot to c, and `a` the arm of c about Q's pivot. Let `V` be the velocity of c minus
//! the velocity of P's pivot, and `e = |wP x n|`. In time s the height of c above P's pivot along n
//! changes by at least
//!
//! `s ((wP x n) . D + n . V)`
//!
//! `- s^2 / 2 (e |wP| |D| + 2 e |V| + |acceleration| + |wQ x n(s)| |wQ| |a|)`
//!
//! within a horizon over which the lengths in the last term are bounded; n moves by at most `e s`.
//! The height of P's node above its pivot does not change. The height of Q's node above c changes
//! by at most `rho (s |(wP - wQ) x n| + s^2 / 2 e |wP - wQ|)`: nothing, if both rotate about n. So
//! each pair of nodes has a separate time, which is long if the bodies move perpendicular to its
//! direction. Take any set of pairs that covers all pairs of members: a front, or the two roots.
//! The bodies stay separated for the least of the times of that set. Pairs that last less than the
//! closest pair are split.
//!
//! Sources: conservative advancement with the speed along the closest direction, Mirtich 1996; over
//! pairs of nodes, Tang, Kim and Manocha 2009. Departures:
//!
//! 1. The direction of each pair is the one that separates its boxes.
//! 2. The bound includes accelerations and drift, with second-order terms.

use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::motion::{MotionModel, Remainder, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{BOX_TURNED, LEAST_SQUARE, ROOT};
use crate::nonconvex::front::NodePair;
use crate::nonconvex::front::memory::FrontMemory;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::tracker::MeshTracker;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::pieces::CompoundTracker;
use crate::nonconvex::query::box_gaps::{BoundAim, bounds};
use crate::nonconvex::query::frame::{TreeSide, split_pair};
use crate::nonconvex::query::state::PosedTrees;
use crate::nonconvex::tree::height;
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::Decision;
use crate::time::separation::plane::tilt;
use crate::time::separation::{FreeSpan, Measurement, PairMotion, Proof, Separation};

/// Two compounds, or a compound and a mesh, that can be measured over time.
#[derive(Debug)]
pub(crate) struct CompoundPair<'a> {
    pub(crate) a: PartsRef<'a>,
    pub(crate) b: PartsRef<'a>,
    pub(crate) tracker: &'a mut CompoundTracker,
}

/// Two meshes that can be measured over time.
#[derive(Debug)]
pub(crate) struct MeshPair<'a> {
    pub(crate) a: &'a Mesh,
    pub(crate) b: &'a Mesh,
    pub(crate) tracker: &'a mut MeshTracker,
}

impl CompoundPair<'_> {
    /// Returns the closest points.
    pub(crate) fn closest_with(&mut self, a_from_b: &RelativePose, _: &QueryOptions) -> PairOutcome {
        self.tracker.closest(&self.a, &self.b, a_from_b).without_depth()
    }

    /// Returns whether the bodies are at most `d` apart.
    pub(crate) fn decide_within(&mut self, a_from_b: &RelativePose, d: f64, _: &QueryOptions) -> Decision {
        Decision::of(self.tracker.within(&self.a, &self.b, a_from_b, d))
    }
}

impl MeshPair<'_> {
    /// Returns the closest points.
    pub(crate) fn closest_with(&mut self, a_from_b: &RelativePose, _: &QueryOptions) -> PairOutcome {
        self.tracker.closest(self.a, self.b, a_from_b).without_depth()
    }

    /// Returns whether the meshes are at most `d` apart.
    pub(crate) fn decide_within(&mut self, a_from_b: &RelativePose, d: f64, _: &QueryOptions) -> Decision {
        Decision::of(self.tracker.within(self.a, self.b, a_from_b, d))
    }
}

/// Returns the ball around a bounding box that is exact up to rounding.
pub(crate) fn ball_about(low: Point3<f64>, high: Point3<f64>) -> (Point3<f64>, f64) {
    let half: Vector3<f64> = (high - low) * 0.5;
    let centre = low + half;
    let far = centre.coords.abs().sum() + half.sum();
    (centre, sqrt(half.norm_squared()) + BOX_TURNED * far)
}

/// Returns how long two bodies stay separated.
///
/// This is the longer of two times: until the displacement of all points may use up the distance,
/// and until a pair of nodes may meet.
fn ahead<S: Separation, A: Parted, B: Parted>(
    pair: &S,
    a: &A,
    b: &B,
    kept: &FrontMemory,
    seen: &Measurement,
    flight: &PairMotion,
) -> FreeSpan {
    let (timed, tick) = flight.on_own_clock();
    let flight = &timed;
    let apart = flight.apart(pair);
    let mut span = flight.held(pair, seen.lower - flight.keep - apart.noise);
    if span < flight.span
        && seen.lower > flight.keep
        && let Ok(pose) = RelativePose::new(&flight.pose_a, &flight.pose_b)
        && let Some(posed) = PosedTrees::new(a, b, &pose)
    {
        span = span.larger(LookAhead::new(&posed, flight, apart.noise, apart.radii).span(kept, seen));
    }
    FreeSpan {
        span: span * tick,
        proof: Proof::Own,
    }
}

impl Separation for CompoundPair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let (low, high) = if of == Operand::A { self.a } else { self.b }.corners_of_box();
        ball_about(low, high)
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        Measurement::from(&self.tracker.closest(&self.a, &self.b, a_from_b))
    }

    /// Uses `CompoundTracker::meets`, which proves what rounding of composed poses hides.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        self.tracker.meets(&self.a, &self.b, a_from_b, distance)
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        ahead(self, &self.a, &self.b, self.tracker.kept(), seen, flight)
    }
}

impl Separation for MeshPair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let (low, high) = if of == Operand::A { self.a } else { self.b }.aabb();
        ball_about(low, high)
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        Measurement::from(&self.tracker.closest(self.a, self.b, a_from_b))
    }

    /// Uses `MeshTracker::within`; a tie counts as met.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        self.tracker.within(self.a, self.b, a_from_b, distance)
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        ahead(self, self.a, self.b, self.tracker.kept(), seen, flight)
    }
}

/// Largest number of pairs of nodes that a look-ahead splits. Not measured.
const AHEAD_PAIRS: usize = 2048;

/// Largest number of items of a node that a look-ahead tests one by one. Not measured.
const AHEAD_ITEMS: u32 = 8;

/// Largest number of horizons for the second-order bound, each at most half the one before.
///
/// Not measured.
const HORIZONS: usize = 6;

/// One body at the start of the motion.
struct Mover {
    pose: Isometry3<f64>,
    model: MotionModel,
    /// The pivot in the world, relative to the origin of A's frame.
    pivot: Vector3<f64>,
    /// The origin of the body's frame in the world, relative to the origin of A's frame.
    origin: Vector3<f64>,
    rate: f64,
}

impl Mover {
    fn new(pose: &Isometry3<f64>, model: &MotionModel, origin: Vector3<f64>) -> Self {
        Self {
            pose: *pose,
            model: *model,
            pivot: origin + pose.rotation * model.pivot.coords,
            origin,
            rate: length(&model.angular),
        }
    }
}

/// Two bodies in motion, for a look-ahead over their pairs of nodes.
struct LookAhead<'a, A, B> {
    posed: &'a PosedTrees<'a, A, B>,
    flight: &'a PairMotion,
    movers: [Mover; 2],
    drift: Remainder,
    /// The distance to exceed, with the effect of rounding.
    keep: f64,
    /// Pairs of nodes that may still be split.
    left: usize,
}

/// Two nodes, a unit direction from A to B in A's frame, and the gap in the caller's unit.
type Claim = (NodePair, Vector3<f64>, f64);

impl<'a, A: Parted, B: Parted> LookAhead<'a, A, B> {
    /// `noise` is the effect of rounding on a distance; `radii` are the radii around the pivots.
    pub(super) fn new(posed: &'a PosedTrees<'a, A, B>, flight: &'a PairMotion, noise: f64, radii: [f64; 2]) -> Self {
        let offset = flight.pose_b.translation.vector - flight.pose_a.translation.vector;
        let (a, b) = (&flight.model_a, &flight.model_b);
        Self {
            posed,
            flight,
            movers: [
                Mover::new(&flight.pose_a, a, Vector3::zeros()),
                Mover::new(&flight.pose_b, b, offset),
            ],
            drift: a.drift(radii[0]) + b.drift(radii[1]),
            keep: flight.keep + noise,
            left: AHEAD_PAIRS,
        }
    }

    /// Returns the time for which all pairs of members are proven separated, at most the flight's
    /// span.
    pub(super) fn span(&mut self, kept: &FrontMemory, seen: &Measurement) -> f64 {
        let goal = self.goal(seen);
        let mut stack: Vec<Claim> = Vec::new();
        let (single, unit) = (&self.posed.frame.single, self.posed.a.stored_unit());
        kept.front.gaps(single, |place, pair, gap| {
            let n = Vector3::from(kept.front.normal(single, place).each(f64::from));
            let length = sqrt(n.norm_squared());
            let claim = if length > 0.5 {
                (pair, n / length, f64::from(gap) * single.unit * unit)
            } else {
                (pair, *seen.normal, f64::NEG_INFINITY)
            };
            stack.push(claim);
        });
        if stack.is_empty() {
            stack.push(([0, 0], *seen.normal, f64::NEG_INFINITY));
        }
        let mut least = goal;
        while let Some(claim) = stack.pop() {
            least = least.smaller(self.settle(claim, seen, least, &mut stack));
            if !(least > 0.0) {
                return 0.0;
            }
        }
        least
    }

    /// Returns the time until the closest points may meet along their direction; no pair needs
    /// more.
    ///
    /// Returns the flight's span if the points do not approach fast enough.
    fn goal(&self, seen: &Measurement) -> f64 {
        let [a, b] = &self.movers;
        let n = a.pose.rotation * seen.normal.into_inner();
        let velocity = |m: &Mover, p: Vector3<f64>| m.model.linear + m.model.angular.cross(&(p - m.pivot));
        let on_a = a.origin + a.pose.rotation * seen.point_on_a.coords;
        let on_b = b.origin + b.pose.rotation * seen.point_on_b.coords;
        let approach = -n.dot(&(velocity(b, on_b) - velocity(a, on_a)));
        let way = seen.lower - self.keep;
        if approach * self.flight.span <= way {
            self.flight.span
        } else {
            way / approach
        }
    }

    /// Returns the time of a pair; infinity if the pair lasts for `goal` or was split.
    fn settle(&mut self, (pair, n, gap): Claim, seen: &Measurement, goal: f64, stack: &mut Vec<Claim>) -> f64 {
        let mut time = self.time(pair, &n, gap);
        if time >= goal {
            return f64::INFINITY;
        }
        for n in [&*seen.normal, &n] {
            time = time.larger(self.time(pair, n, self.gap(pair, n)));
            if time >= goal {
                return f64::INFINITY;
            }
        }
        let trees = [self.posed.a.side().tree, self.posed.b.side().tree];
        let Some(halves) = split_pair(trees, &self.posed.frame, pair).filter(|_| self.left > 0) else {
            return time;
        };
        self.left -= 1;
        let frame = &self.posed.frame;
        let found = bounds(&frame.single, trees, &halves, &BoundAim::to(f32::MAX));
        for (k, half) in halves.into_iter().enumerate() {
            let m = Vector3::from(found.normal[k].each(f64::from));
            let length = sqrt(m.norm_squared());
            let claim = if frame.single.error.is_finite() && length > 0.5 {
                let gap = f64::from(found.gap[k] - frame.single.error) * frame.single.unit;
                (half, m / length, gap * self.posed.a.stored_unit())
            } else {
                (half, n, f64::NEG_INFINITY)
            };
            stack.push(claim);
        }
        f64::INFINITY
    }

    /// Returns the gap of two nodes along a unit direction.
    ///
    /// Boxes and slabs bound the heights, or the items of a node if they are few.
    fn gap(&self, [x, y]: NodePair, n: &Vector3<f64>) -> f64 {
        let PosedTrees { a, b, frame, .. } = self.posed;
        let (of_a, of_b) = (a.side().tree, b.side().tree);
        let in_b = -frame.direction_in_b(n);
        let few = |items: Range<u32>| (items.end - items.start <= AHEAD_ITEMS).then_some(items);
        let top = |items: Range<u32>| items.map(|k| a.highest(k, n)).fold(f64::NEG_INFINITY, f64::larger);
        let bottom = |items: Range<u32>| items.map(|k| b.highest(k, &in_b)).fold(f64::NEG_INFINITY, f64::larger);
        let high = few(of_a.range(x)).map_or_else(|| height(of_a, x, n), top);
        let low = -few(of_b.range(y)).map_or_else(|| height(of_b, y, &in_b), bottom);
        (low + n.dot(&frame.translation) - 2.0 * frame.error - high) * a.stored_unit()
    }

    /// Returns the time for which two nodes stay separated along a direction.
    ///
    /// `gap` is their gap at the start. The time is at most the flight's span.
    fn time(&self, [x, y]: NodePair, n: &Vector3<f64>, gap: f64) -> f64 {
        let way = gap - self.keep;
        if !(way > 0.0) {
            return 0.0;
        }
        let (a, b) = (self.posed.a, self.posed.b);
        let ball = |side: TreeSide, node: u32| {
            let (of, unit) = (&side.tree.boxes[node as usize], side.frame.unit());
            let scale = side.tree.unit() * unit;
            let centre = side.tree.centre * unit + of.centre() * scale;
            (centre + side.frame.origin, f64::from(of.radius()) * scale)
        };
        let (of_a, radius_a) = ball(a.side(), x);
        let (of_b, radius_b) = ball(b.side(), y);
        let n = self.movers[0].pose.rotation * n;
        // The direction rotates with the body of the larger node.
        if radius_b <= radius_a {
            self.time_with([0, 1], &n, &of_b, radius_b, way)
        } else {
            self.time_with([1, 0], &-n, &of_a, radius_a, way)
        }
    }

    /// Returns the time for which a ball of Q stays separated from a node of P.
    ///
    /// `centre` is in the frame of Q's body. `n` is a direction in the world that leads from P to
    /// Q.
    fn time_with(&self, [p, q]: [usize; 2], n: &Vector3<f64>, centre: &Vector3<f64>, radius: f64, way: f64) -> f64 {
        let (p, q) = (&self.movers[p], &self.movers[q]);
        let place = q.origin + q.pose.rotation * centre;
        let (between, arm) = (place - p.pivot, place - q.pivot);
        let (of_p, of_q) = (&p.model, &q.model);
        let velocity = of_q.linear - of_p.linear + of_q.angular.cross(&arm);
        let push = of_q.acceleration - of_p.acceleration;
        let rise = of_p.angular.cross(n).dot(&between) + n.dot(&velocity);
        let spin = of_p.angular - of_q.angular;
        let across = |w: &Vector3<f64>| tilt(&w.cross(n), w);
        let (turned_p, turned_q) = (across(&of_p.angular), across(&of_q.angular));
        let pace = radius * across(&spin) - rise;
        let (pushed, swung) = (length(&push), q.rate * length(&arm));
        let rolled = radius * length(&spin) * turned_p;
        let straight = length(&(of_q.linear - of_p.linear)) + swung;
        let (mut horizon, mut best) = (self.flight.span, 0.0f64);
        for _ in 0..HORIZONS {
            let fastest = straight + pushed * horizon;
            let farthest = length(&between) + fastest * horizon;
            let inward = (turned_q + q.rate * turned_p * horizon).smaller(q.rate) * swung;
            let bend = turned_p * (p.rate * farthest + 2.0 * fastest) + pushed + inward + rolled;
            let time = first_root(way - self.drift.at(horizon), pace, bend) * (1.0 - ROOT);
            best = best.larger(time.smaller(horizon));
            if time >= horizon {
                break;
            }
            horizon = (2.0 * time).clamped(horizon / 64.0, horizon / 2.0);
        }
        best
    }
}

/// Returns the first time at which `way - pace s - bend s^2 / 2` is zero.
///
/// `bend` must not be negative. Returns infinity if there is no such time. Returns zero if `way` is
/// not positive or its square is at most [`LEAST_SQUARE`].
fn first_root(way: f64, pace: f64, bend: f64) -> f64 {
    // Written so that NaN returns zero.
    if !(way > 0.0 && way * way > LEAST_SQUARE) {
        return 0.0;
    }
    let root = sqrt(pace * pace + 2.0 * bend * way);
    let below = pace + root;
    if below <= 0.0 {
        f64::INFINITY
    } else {
        (2.0 * way / below).at_least(0.0)
    }
}
