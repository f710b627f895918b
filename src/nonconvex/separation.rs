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
//! Four more proofs are for pairs that pass each other closely, and would need many short steps:
//!
//! * Directions perpendicular to the relative velocity, along which the gap of a translation stays
//!   as it is.
//! * Two leaves are split into items. Single precision hides gaps below 2e-7 of the size in the
//!   boxes of leaves, and no single direction separates all their items.
//! * Two items are also bounded along the direction between their middles.
//! * Last, a plane rotates with the closest features or with either body, bounded over the corners
//!   of both items ([`plane`]). A ball around a node loses `rho |w x n|` to its own rotation.
//!
//! Sources: conservative advancement with the speed along the closest direction, Mirtich 1996; over
//! pairs of nodes, Tang, Kim and Manocha 2009. Departures:
//!
//! 1. The direction of each pair is the one that separates its boxes.
//! 2. The bound includes accelerations and drift, with second-order terms.

use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

use crate::base::motion::{MotionModel, Remainder, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{BOX_TURNED, LEAST_SQUARE, ROOT};
use crate::convex::shape_tracker::ShapeTracker;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::front::memory::FrontMemory;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::tracker::MeshTracker;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::pieces::CompoundTracker;
use crate::nonconvex::query::box_gaps::{BoundAim, bounds};
use crate::nonconvex::query::frame::{TreeSide, split_pair};
use crate::nonconvex::query::state::PosedTrees;
use crate::nonconvex::tree::{Below, Tree, height};
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::Decision;
use crate::time::separation::plane::{self, tilt};
use crate::time::separation::{FreeSpan, Measurement, PairMotion, Proof, Separation, SupportPoint, Tangent};

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
pub(crate) fn ball_about((low, high): (Point3<f64>, Point3<f64>)) -> (Point3<f64>, f64) {
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
    let mut span = flight.held(pair, seen.lower - flight.required - apart.noise);
    if span < flight.span
        && seen.lower > flight.required
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
        ball_about(if of == Operand::A { self.a } else { self.b }.corners_of_box())
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
        ball_about(if of == Operand::A { self.a } else { self.b }.aabb())
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

/// Largest number of pairs of nodes that a look-ahead splits.
const AHEAD_PAIRS: usize = 2048;

/// Largest number of items of a node that a look-ahead tests one by one.
const AHEAD_ITEMS: u32 = 8;

/// Fraction of the goal below which a pair is tried along further directions, leaves item by item.
///
/// Measured on meshes, compounds and clouds: random casts take as long with 1/16 and 1/4. A mesh
/// that swings past a plate takes at most 258 queries with 1/16, and 82 with 1/4.
const SHORT_TIME: f64 = 1.0 / 4.0;

/// Least length of a unit direction without its part along the motion.
const LEAST_ACROSS: f64 = 1.0 / 1024.0;

/// Largest number of horizons for the second-order bound, each at most half the one before.
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
            keep: flight.required + noise,
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
        let tried = [*seen.normal, n];
        for n in &tried {
            time = time.larger(self.time(pair, n, self.gap(pair, n)));
            if time >= goal {
                return f64::INFINITY;
            }
        }
        let is_short = time < SHORT_TIME * goal;
        if is_short || self.movers.iter().all(|m| m.rate == 0.0) {
            for n in self.across(pair, &tried) {
                time = time.larger(self.time(pair, &n, self.gap(pair, &n)));
                if time >= goal {
                    return f64::INFINITY;
                }
            }
        }
        let trees = [self.posed.a.side().tree, self.posed.b.side().tree];
        if is_short && let (Below::Leaf(i, m), Below::Leaf(j, n)) = (trees[0].below(pair[0]), trees[1].below(pair[1])) {
            return self.time_of_items(pair, [i..i + m, j..j + n], seen, &tried, time, goal);
        }
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

    /// Returns the time of two leaves, each pair of items along its direction.
    ///
    /// Returns infinity if all pairs last for `goal`. `time` is that of the leaves as wholes.
    fn time_of_items(
        &self,
        pair: NodePair,
        [of_a, of_b]: [Range<u32>; 2],
        seen: &Measurement,
        tried: &[Vector3<f64>; 2],
        time: f64,
        goal: f64,
    ) -> f64 {
        let PosedTrees { a, b, frame, .. } = self.posed;
        let middles_b: Vec<_> = of_b.clone().map(|j| frame.point(&middle(*b, j))).collect();
        let mut least = f64::INFINITY;
        for i in of_a {
            let middle_a = middle(*a, i);
            for (j, middle_b) in of_b.clone().zip(&middles_b) {
                let between = middle_b - middle_a;
                let all = [
                    between / length(&between).at_least(f64::MIN_POSITIVE),
                    tried[0],
                    tried[1],
                ];
                let mut own = time;
                let mut is_long = |n: &Vector3<f64>| {
                    own = own.larger(self.time(pair, n, self.gap_of([i..i + 1, j..j + 1], n)));
                    own >= goal
                };
                if all.iter().any(&mut is_long) || self.across(pair, &all).any(|n| is_long(&n)) {
                    continue;
                }
                let normal = self.normal_of([i, j]).unwrap_or(seen.normal);
                if self.across(pair, &[*normal]).any(|n| is_long(&n)) {
                    continue;
                }
                own = own.larger(self.time_of_planes([i, j], &Measurement { normal, ..*seen }));
                if own >= goal {
                    continue;
                }
                least = least.smaller(own);
                if least <= time {
                    return time;
                }
            }
        }
        least
    }

    /// Returns the direction of the closest points of two items, in A's frame.
    fn normal_of(&self, [i, j]: [u32; 2]) -> Option<Unit<Vector3<f64>>> {
        let PosedTrees { a, b, .. } = self.posed;
        let ((first, of_a), (second, of_b)) = (a.part(i)?, b.part(j)?);
        let [a, b] = &self.movers;
        let pose = RelativePose::new(&(a.pose * of_a), &(b.pose * of_b)).ok()?;
        let seen = ShapeTracker::new().closest(&first, &second, &pose);
        Some(of_a.rotation * seen.normal)
    }

    /// Returns the time for which a plane with the closest direction separates two items.
    ///
    /// The plane rotates with the closest features, or with either body. It bounds the corners of
    /// the items, where a ball around a node would lose to its rotation.
    fn time_of_planes(&self, items: [u32; 2], seen: &Measurement) -> f64 {
        let PosedTrees { a, b, frame, .. } = self.posed;
        let mut pair = ItemPair {
            balls: [ball_of_item(*a, items[0]), ball_of_item(*b, items[1])],
            bodies: (*a, *b),
            items,
            seen,
            error: frame.error * a.stored_unit(),
        };
        let flight = PairMotion {
            required: self.keep,
            ..*self.flight
        };
        let mut best = 0.0f64;
        for tangent in [seen.tangent, Tangent::WithA, Tangent::WithB] {
            let seen = Measurement {
                tangent,
                by_plane: false,
                ..*seen
            };
            best = best.larger(plane::free_for(&mut pair, &seen, &flight).span);
        }
        best
    }

    /// Returns directions without their parts along the relative velocity of two nodes.
    ///
    /// Along these, the gap of a pair that moves past each other stays as it is.
    fn across<const N: usize>(&self, [_, y]: NodePair, all: &[Vector3<f64>; N]) -> impl Iterator<Item = Vector3<f64>> {
        let [a, b] = &self.movers;
        let side = self.posed.b.side();
        let centre = side.tree.centre + side.tree.boxes[y as usize].centre() * side.tree.unit();
        let place = b.origin + b.pose.rotation * (centre * side.frame.unit() + side.frame.origin);
        let velocity = |m: &Mover| m.model.linear + m.model.angular.cross(&(place - m.pivot));
        let way = a.pose.rotation.inverse() * (velocity(b) - velocity(a));
        let square = way.norm_squared();
        (*all).into_iter().filter_map(move |n| {
            let left = n - way * (n.dot(&way) / square);
            let length = length(&left);
            // Written so that NaN, for bodies at rest, gives none.
            (length > LEAST_ACROSS).then(|| left / length)
        })
    }

    /// Returns the gap of two nodes along a unit direction.
    ///
    /// Boxes and slabs bound the heights, or the items of a node if they are few.
    fn gap(&self, [x, y]: NodePair, n: &Vector3<f64>) -> f64 {
        let PosedTrees { a, b, frame, .. } = self.posed;
        let (of_a, of_b) = (a.side().tree, b.side().tree);
        let in_b = -frame.direction_in_b(n);
        let few = |tree: &Tree, node: u32| {
            let items = tree.range(node);
            (items.end - items.start <= AHEAD_ITEMS || tree.is_leaf(node)).then_some(items)
        };
        let high = few(of_a, x).map_or_else(|| height(of_a, x, n), |items| top(*a, items, n));
        let low = -few(of_b, y).map_or_else(|| height(of_b, y, &in_b), |items| top(*b, items, &in_b));
        self.lifted(low, high, n)
    }

    /// Returns the gap of some items along a unit direction.
    fn gap_of(&self, [of_a, of_b]: [Range<u32>; 2], n: &Vector3<f64>) -> f64 {
        let PosedTrees { a, b, frame, .. } = self.posed;
        let high = top(*a, of_a, n);
        self.lifted(-top(*b, of_b, &-frame.direction_in_b(n)), high, n)
    }

    /// Returns the gap of heights in both frames, in the caller's unit.
    fn lifted(&self, low: f64, high: f64, n: &Vector3<f64>) -> f64 {
        let frame = &self.posed.frame;
        (low + n.dot(&frame.translation) - 2.0 * frame.error - high) * self.posed.a.stored_unit()
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

/// An item of each body, for the step of a plane.
struct ItemPair<'a, A, B> {
    bodies: (&'a A, &'a B),
    items: [u32; 2],
    balls: [(Point3<f64>, f64); 2],
    seen: &'a Measurement,
    /// Error of a height along a unit direction, in the caller's unit.
    error: f64,
}

impl<A: Parted, B: Parted> Separation for ItemPair<'_, A, B> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        self.balls[usize::from(of == Operand::B)]
    }

    fn measure(&mut self, _: &RelativePose) -> Measurement {
        *self.seen
    }

    fn meets(&mut self, _: &RelativePose, _: f64, _: &Measurement) -> bool {
        false
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let centre = self.ball(of).0.coords;
        let [i, j] = self.items;
        let mut support = match of {
            Operand::A => support_of_item(self.bodies.0, i, direction, &centre),
            Operand::B => support_of_item(self.bodies.1, j, direction, &centre),
        };
        // The direction may be longer than one.
        support.height += self.error * length(direction);
        support
    }
}

/// Returns the support value and the support point of an item, about a centre in the body's frame.
fn support_of_item<A: Parted>(of: &A, item: u32, direction: &Vector3<f64>, centre: &Vector3<f64>) -> SupportPoint {
    let from = centre - of.side().frame.origin;
    let length = length(direction).at_least(f64::MIN_POSITIVE);
    SupportPoint {
        height: of.highest(item, direction) * of.stored_unit() - direction.dot(&from),
        point: of.peak(item, &(direction / length)).point - centre,
    }
}

/// Returns the corners of the box around an item, in stored coordinates.
fn box_of_item<A: Parted>(of: &A, item: u32) -> (Vector3<f64>, Vector3<f64>) {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let low = axes.each(|n| -of.highest(item, &-n));
    let high = axes.each(|n| of.highest(item, &n));
    (low.into(), high.into())
}

/// Returns the middle of the box around an item, in stored coordinates.
fn middle<A: Parted>(of: &A, item: u32) -> Vector3<f64> {
    let (low, high) = box_of_item(of, item);
    (high + low) * 0.5
}

/// Returns a ball around an item, in the body's frame and the caller's unit.
fn ball_of_item<A: Parted>(of: &A, item: u32) -> (Point3<f64>, f64) {
    let (low, high) = box_of_item(of, item);
    let (unit, origin) = (of.stored_unit(), of.side().frame.origin);
    ball_about(((low * unit + origin).into(), (high * unit + origin).into()))
}

/// Returns the greatest height of some items along a direction, in stored units.
fn top<A: Parted>(of: &A, items: Range<u32>, n: &Vector3<f64>) -> f64 {
    items.map(|k| of.highest(k, n)).fold(f64::NEG_INFINITY, f64::larger)
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
