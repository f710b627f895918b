//! The queries of two bodies of parts, for every kind of parts.

use nalgebra::{Point3, Unit, Vector3};

use crate::base::motion::BallAtPose;
use crate::base::num::Counter;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::{Operand, RelativePose};
use crate::nonconvex::front::NodePair;
use crate::nonconvex::front::memory::FrontMemory;
use crate::nonconvex::parts::Parted;
#[cfg(feature = "exact")]
use crate::nonconvex::parts::PartsRef;
#[cfg(feature = "exact")]
use crate::nonconvex::query::exact::PointSide;
use crate::nonconvex::query::frame::{TreeFrame, TreeMoves, TreeSide};
use crate::nonconvex::query::overlap::Touching;
use crate::nonconvex::query::search::{Judge, Measured, MeshGoal, TreeSearch};
use crate::pair::location::{PairOutcome, WitnessLocation, features_on};
use crate::pair::outcome::{ContactState, Outcome};

/// The state of a tracker between queries. Saving a state (feature `serde`) keeps the counters
/// alone: claims in a file prove nothing.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TreeState {
    #[cfg_attr(feature = "serde", serde(skip))]
    fingerprints: [Fingerprint; 2],
    pub(crate) kept: FrontMemory,
    /// Last proof that the bodies do not contain each other: clearance and B's pose.
    #[cfg_attr(feature = "serde", serde(skip))]
    free: Option<(f64, BallAtPose)>,
}

/// What a state was before a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Recognised {
    /// Of these bodies as they are.
    Same,
    /// Of these bodies, of which some points have moved since.
    Moved,
    /// Of other bodies.
    Other,
}

/// Two bodies at a pose.
pub(crate) struct PosedTrees<'a, A, B> {
    pub(crate) a: &'a A,
    pub(crate) b: &'a B,
    pub(crate) pose: &'a RelativePose,
    pub(crate) frame: TreeFrame,
}

/// The closest points, in the caller's units and the bodies' own frames.
pub(crate) struct TreeAnswer<F> {
    pub(super) state: ContactState,
    pub(super) distance: f64,
    pub(crate) lower: f64,
    pub(super) upper: f64,
    /// The closest items and their features; `None` for bodies too far apart to look at.
    pub(crate) of: Option<(NodePair, F)>,
    pub(super) point_on_a: Point3<f64>,
    pub(super) point_on_b: Point3<f64>,
    pub(super) normal: Unit<Vector3<f64>>,
}

/// Whether one body is inside the other.
pub(crate) enum Inside {
    No,
    /// At a point of the inner one, in A's frame and in B's.
    At(Vector3<f64>, Vector3<f64>),
    /// The points looked at are too near a surface, or every segment met an edge.
    Unclear,
}

impl<'a, A: Parted, B: Parted> PosedTrees<'a, A, B> {
    /// `None` if the bodies are so far apart, or so small, that squares of lengths leave the range
    /// of f64.
    pub(crate) fn new(a: &'a A, b: &'a B, pose: &'a RelativePose) -> Option<Self> {
        let frame = TreeFrame::new(a.side(), b.side(), pose)?;
        Some(Self { a, b, pose, frame })
    }

    /// Returns whether the pair is answered as B and A: lengths leave the range in the unit of A,
    /// and B's is larger.
    pub(crate) fn is_turned(a: &A, b: &B, pose: &RelativePose) -> bool {
        a.side().exponent < b.side().exponent && TreeFrame::new(a.side(), b.side(), pose).is_none()
    }

    fn search<J: Judge>(&self, judge: J, goal: MeshGoal) -> TreeSearch<'_, J> {
        let mut search = TreeSearch::new([self.a.side().tree, self.b.side().tree], &self.frame, judge, goal);
        search.ends_in_contact = !(self.a.is_solid() && self.b.is_solid());
        search
    }

    /// Returns the ball of B about its tree's origin, as seen from A, in A's stored units.
    fn place(&self) -> BallAtPose {
        let (tree, frame) = (self.b.side().tree, &self.frame);
        let radius = f64::from(tree.reach) * tree.unit() * frame.scale;
        let centre = tree.centre * frame.scale;
        BallAtPose::new(Operand::B, &centre, radius, &frame.rotation, &frame.translation)
    }

    /// Returns a point of A in B's stored frame.
    pub(crate) fn back(&self, p: &Vector3<f64>) -> Vector3<f64> {
        let ratio = self.a.stored_unit() / self.b.stored_unit();
        self.frame.rotation.tr_mul(&(p - self.frame.translation)) * ratio
    }

    /// Returns whether a part of one body is inside the other, whose surfaces are proven to be
    /// `lower` apart; and the winding numbers taken.
    pub(crate) fn inside(&self, lower: f64) -> (Inside, u64) {
        // A point moved to the other frame is off its place by the error of the frame: on its side
        // of a surface that is farther.
        let error = self.frame.error;
        let doubt = if lower > 2.0 * error { 0.0 } else { 2.0 * error };
        let ratio = self.a.stored_unit() / self.b.stored_unit();
        let in_a = |local: Vector3<f64>| {
            let place = self.frame.point(&local);
            Some((self.a.holds(&place, doubt)?, place, local))
        };
        let in_b = |local: Vector3<f64>| {
            let place = self.back(&local);
            Some((self.b.holds(&place, doubt * ratio)?, local, place))
        };
        let (of_a, of_b) = (self.b.probe_count(), self.a.probe_count());
        let (of_a, of_b) = (
            if self.a.may_hold() { of_a } else { 0 },
            if self.b.may_hold() { of_b } else { 0 },
        );
        let by_integers = |of, k| if lower > 0.0 { self.held_exactly(of, k) } else { None };
        let probes_of_b = (0..of_a).map(|k| {
            let held = probes(self.b, k).find_map(in_a);
            held.or_else(|| by_integers(Operand::B, k))
        });
        let probes_of_a = (0..of_b).map(|k| {
            let held = probes(self.a, k).find_map(in_b);
            held.or_else(|| by_integers(Operand::A, k))
        });
        let (mut windings, mut found) = (0, Inside::No);
        for held in probes_of_b.chain(probes_of_a) {
            windings += 1;
            match held {
                Some((false, ..)) => {}
                Some((true, on_a, on_b)) => return (Inside::At(on_a, on_b), windings),
                None => found = Inside::Unclear,
            }
        }
        (found, windings)
    }

    /// Returns whether the other body holds a connected part of a body, whose surface does not meet
    /// its own, by a point of the part without rounding; and the point in the frames of A and B.
    /// `None` if the point is on the surface after all.
    #[cfg(feature = "exact")]
    #[cold]
    fn held_exactly(&self, of: Operand, k: usize) -> Option<(bool, Vector3<f64>, Vector3<f64>)> {
        let (point, pose, other) = match of {
            Operand::A => (self.a.exact_probe(k), self.pose.swapped(), self.b.by_kind()),
            Operand::B => (self.b.exact_probe(k), *self.pose, self.a.by_kind()),
        };
        let PartsRef::Mesh(mesh) = other else {
            return Some((false, Vector3::zeros(), Vector3::zeros()));
        };
        let place = point.clone().in_a(&pose).in_units(mesh.exponent);
        let is_held = match mesh.side_of(&place) {
            PointSide::Outside => false,
            PointSide::On => return None,
            PointSide::Inside => true,
        };
        Some(match of {
            Operand::A => (
                is_held,
                point.in_units(self.a.side().exponent).rounded(),
                place.rounded(),
            ),
            Operand::B => (
                is_held,
                place.rounded(),
                point.in_units(self.b.side().exponent).rounded(),
            ),
        })
    }

    /// Without exact arithmetic a part as near as rounding stays undecided.
    #[cfg(not(feature = "exact"))]
    fn held_exactly(&self, _: Operand, _: usize) -> Option<(bool, Vector3<f64>, Vector3<f64>)> {
        None
    }

    /// Bodies so far apart, or so small beside their distance, that only balls about their origins
    /// count.
    pub(crate) fn far<F>(a: &A, b: &B, pose: &RelativePose) -> TreeAnswer<F> {
        let (distance, slack, normal) = crate::nonconvex::query::frame::far(a.side(), b.side(), pose);
        let lower = (distance - slack).at_least(0.0);
        let middle = |side: TreeSide, unit: f64| Point3::from(side.tree.centre * unit);
        TreeAnswer {
            state: if lower > 0.0 {
                ContactState::Separated
            } else {
                ContactState::Undecided
            },
            distance,
            lower,
            upper: distance + slack,
            of: None,
            point_on_a: middle(a.side(), a.stored_unit()),
            point_on_b: middle(b.side(), b.stored_unit()),
            normal: Unit::new_unchecked(normal),
        }
    }
}

/// Points of a connected part, one of which is to decide on which side of a surface the part is.
fn probes<A: Parted>(body: &A, part: usize) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let middles = (0..).map_while(|k| body.further_probe(k));
    body.probe(part).into_iter().chain(middles)
}

impl TreeState {
    /// Forgets the state of other bodies, and what moved points make untrue.
    pub(crate) fn recognise<A: Parted, B: Parted>(&mut self, a: &A, b: &B) -> Recognised {
        let (before, now) = (self.fingerprints, [a.fingerprint(), b.fingerprint()]);
        if before == now {
            return Recognised::Same;
        }
        self.fingerprints = now;
        self.free = None;
        let moves = TreeMoves::new(a.side(), b.side());
        let have_moved =
            (before[0] == now[0] || a.came_from(before[0])) && (before[1] == now[1] || b.came_from(before[1]));
        if have_moved {
            self.kept.follow(&moves);
            return Recognised::Moved;
        }
        let work = self.kept.work;
        self.kept = FrontMemory::of_bodies(&moves);
        self.kept.work = work;
        Recognised::Other
    }

    /// Returns the closest points, by the front if there is one.
    pub(crate) fn closest<A: Parted, B: Parted, J: Judge>(
        &mut self,
        posed: &PosedTrees<A, B>,
        judge: J,
    ) -> TreeAnswer<J::Features> {
        let mut search = posed.search(judge, MeshGoal::Least);
        self.kept.closest(&mut search);
        let Some(best) = search.best else {
            return PosedTrees::far(posed.a, posed.b, posed.pose);
        };
        let lower = search.lower.smaller(best.lower).at_least(0.0);
        let mut answer = TreeAnswer::of_pair(&best, lower, [posed.a.stored_unit(), posed.b.stored_unit()]);
        if best.crosses {
            answer.share(posed.a.is_solid() && posed.b.is_solid());
        } else {
            self.conclude(posed, &search.touching, &best, &mut answer);
        }
        answer
    }

    /// From the closest parts of bodies that do not cross to the contact state of the bodies.
    fn conclude<A: Parted, B: Parted, F>(
        &mut self,
        posed: &PosedTrees<A, B>,
        touching: &Touching,
        best: &Measured<F>,
        answer: &mut TreeAnswer<F>,
    ) {
        let (unit_a, unit_b) = (posed.a.stored_unit(), posed.b.stored_unit());
        if answer.lower > 0.0 {
            match self.held(posed, answer.lower / unit_a) {
                Inside::No => answer.state = ContactState::Separated,
                Inside::At(on_a, on_b) => {
                    (answer.point_on_a, answer.point_on_b) = ((on_a * unit_a).into(), (on_b * unit_b).into());
                    answer.share(posed.a.is_solid() && posed.b.is_solid());
                }
                Inside::Unclear => (answer.state, answer.lower) = (ContactState::Undecided, 0.0),
            }
        } else if self.shares_inside(posed, touching, best) {
            answer.share(true);
        } else if best.upper > 2.0 * posed.frame.tie {
            answer.state = ContactState::Undecided;
        }
    }

    /// Returns whether one body is inside the other, whose surfaces are proven to be `lower` apart.
    fn held<A: Parted, B: Parted>(&mut self, posed: &PosedTrees<A, B>, lower: f64) -> Inside {
        let now = posed.place();
        // The bodies moved less than the proven clearance, so the old proof holds.
        let carried = self
            .free
            .as_ref()
            .is_some_and(|(before, then)| now.displacement(then) < *before);
        let inside = if carried { Inside::No } else { self.inside(posed, lower) };
        self.free = matches!(inside, Inside::No).then_some((lower, now));
        inside
    }

    fn inside<A: Parted, B: Parted>(&mut self, posed: &PosedTrees<A, B>, lower: f64) -> Inside {
        let (inside, windings) = posed.inside(lower);
        self.kept.work.windings.count(windings);
        inside
    }

    /// Returns whether solids that touch certainly share inner points.
    fn shares_inside<A: Parted, B: Parted, F>(
        &mut self,
        posed: &PosedTrees<A, B>,
        touching: &Touching,
        best: &Measured<F>,
    ) -> bool {
        let (is_shared, windings) = posed.shares_inside(touching, best, true);
        self.kept.work.windings.count(windings);
        is_shared
    }

    /// Returns whether the bodies are at most `d` apart, in A's stored units; the judge knows `d`.
    pub(crate) fn within<A: Parted, B: Parted, J: Judge>(
        &mut self,
        posed: &PosedTrees<A, B>,
        judge: J,
        d: f64,
    ) -> bool {
        if let Some((lower, then)) = &self.free
            && lower - posed.place().displacement(then) > d
        {
            return false;
        }
        let mut search = posed.search(judge, MeshGoal::Within(d));
        if self.kept.is_within(&mut search) {
            return true;
        }
        // Now all parts are proven farther apart than `d`, and one body may hold the other.
        let lower = search.proven().larger(d);
        let is_apart = matches!(self.inside(posed, lower), Inside::No);
        self.free = is_apart.then(|| (lower, posed.place()));
        !is_apart
    }

    /// Returns a lower bound of the distance in the caller's unit, by the state alone.
    pub(crate) fn lower_bound<A: Parted, B: Parted>(&mut self, posed: &PosedTrees<A, B>) -> f64 {
        let moved = |(lower, then): &(f64, BallAtPose)| lower - posed.place().displacement(then);
        let carried = self.free.as_ref().map_or(0.0, moved);
        if self.kept.front.is_empty() {
            return carried.at_least(0.0) * posed.a.stored_unit();
        }
        let single = &posed.frame.single;
        self.kept.front.meet(single);
        let mut least = f32::INFINITY;
        self.kept.front.gaps(single, |_, _, gap| least = least.smaller(gap));
        let mut bound = f64::from(least) * single.unit;
        if bound > 0.0 && !(carried > 0.0) && !matches!(self.inside(posed, bound), Inside::No) {
            bound = 0.0;
        }
        bound.larger(carried).at_least(0.0) * posed.a.stored_unit()
    }
}

impl<F: Copy> TreeAnswer<F> {
    /// Returns two items and a lower bound of the distance of the bodies, in A's stored units, in
    /// those of the caller: as of bodies that touch.
    fn of_pair(best: &Measured<F>, lower: f64, [unit, unit_b]: [f64; 2]) -> Self {
        Self {
            state: ContactState::Touching,
            distance: best.distance * unit,
            lower: lower * unit,
            upper: best.upper * unit,
            of: Some((best.pair, best.features)),
            point_on_a: Point3::from(best.on_a * unit),
            point_on_b: Point3::from(best.on_b * unit_b),
            normal: Unit::new_unchecked(best.normal),
        }
    }

    /// Returns two items of one body, which has no inside, and a lower bound of their distance.
    pub(crate) fn of_one_body(best: &Measured<F>, lower: f64, unit: f64, frame: &TreeFrame) -> Self {
        let mut answer = Self::of_pair(best, lower, [unit; 2]);
        if best.crosses {
            answer.share(false);
        } else if lower > 0.0 {
            answer.state = ContactState::Separated;
        } else if best.upper > 2.0 * frame.tie {
            answer.state = ContactState::Undecided;
        }
        answer
    }
}

impl<F> TreeAnswer<F> {
    /// Returns the answer with the places of the witnesses.
    pub(crate) fn on(&self, locations: [WitnessLocation; 2]) -> PairOutcome {
        let outcome = Outcome {
            state: self.state,
            distance: self.distance,
            lower: self.lower,
            upper: self.upper,
            point_on_a: self.point_on_a,
            point_on_b: self.point_on_b,
            normal: self.normal,
            ..Outcome::starting_at(features_on(&locations))
        };
        PairOutcome {
            outcome,
            locations,
            is_converged: true,
        }
    }

    /// The bodies share points; only solids share inner ones.
    fn share(&mut self, are_solid: bool) {
        self.state = if are_solid {
            ContactState::Overlapping
        } else {
            ContactState::Touching
        };
        (self.distance, self.lower, self.upper) = (0.0, 0.0, 0.0);
    }
}
