//! The queries of two meshes or compounds at a pose, and the state between queries.

use alloc::vec::Vec;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::motion::BallAtPose;
use crate::base::num::Counter;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::UNIT;
#[cfg(feature = "exact")]
use crate::convex::exact::place::ExactVector;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::front::memory::FrontMemory;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::parts::PartsRef;
#[cfg(feature = "exact")]
use crate::nonconvex::query::exact::PointSide;
use crate::nonconvex::query::frame::{TreeFrame, TreeMoves, TreeSide};
use crate::nonconvex::query::overlap::Touching;
use crate::nonconvex::query::search::{Judge, Measured, MeshGoal, TreeSearch};
use crate::nonconvex::tree::Below;
use crate::pair::location::{PairOutcome, WitnessLocation, features_on};
use crate::pair::outcome::{ContactState, Outcome};
use crate::pair::transform::StoredFrame;

/// The state of a tracker between queries.
///
/// Saving a state (feature `serde`) saves only the counters, because claims in a file prove
/// nothing.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TreeState {
    #[cfg_attr(feature = "serde", serde(skip))]
    fingerprints: [Fingerprint; 2],
    pub(crate) kept: FrontMemory,
    /// The last proof that neither body contains the other: clearance, and B's pose.
    #[cfg_attr(feature = "serde", serde(skip))]
    free: Option<(f64, BallAtPose)>,
}

/// The bodies to which a state belonged before a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Recognised {
    /// These bodies, unchanged.
    Same,
    /// These bodies, but some points have moved since.
    Moved,
    /// Other bodies.
    Other,
}

/// Two bodies at a pose.
pub(crate) struct PosedTrees<'a, A, B> {
    pub(crate) a: &'a A,
    pub(crate) b: &'a B,
    pub(crate) pose: &'a RelativePose,
    pub(crate) frame: TreeFrame,
}

/// The closest points, in the caller's units and in the frames of the bodies.
pub(crate) struct TreeAnswer<F> {
    pub(super) state: ContactState,
    pub(super) distance: f64,
    pub(crate) lower: f64,
    pub(super) upper: f64,
    /// The closest items and their features; `None` if the bodies were too far apart for a search.
    pub(crate) of: Option<(NodePair, F)>,
    pub(super) point_on_a: Point3<f64>,
    pub(super) point_on_b: Point3<f64>,
    pub(super) normal: Unit<Vector3<f64>>,
}

/// Whether one body is inside the other.
pub(crate) enum Inside {
    No,
    /// At this point of the inner body, in A's frame and in B's.
    At(Vector3<f64>, Vector3<f64>),
    /// Undecided: a surface is too near all points tested, or every segment met an edge.
    Unclear,
}

impl<'a, A: Parted, B: Parted> PosedTrees<'a, A, B> {
    /// Creates a pair of bodies at a pose.
    ///
    /// Returns `None` if the bodies are so far apart, or so small, that squares of lengths leave
    /// the range of f64.
    pub(crate) fn new(a: &'a A, b: &'a B, pose: &'a RelativePose) -> Option<Self> {
        let frame = TreeFrame::new(a.side(), b.side(), pose)?;
        Some(Self { a, b, pose, frame })
    }

    /// Returns whether the query must be answered with A and B swapped.
    ///
    /// It must if lengths leave the range in A's unit and B's unit is larger.
    pub(crate) fn is_turned(a: &A, b: &B, pose: &RelativePose) -> bool {
        a.side().frame.exponent < b.side().frame.exponent && TreeFrame::new(a.side(), b.side(), pose).is_none()
    }

    fn search<J: Judge>(&self, judge: J, goal: MeshGoal) -> TreeSearch<'_, J> {
        let mut search = TreeSearch::new([self.a.side().tree, self.b.side().tree], &self.frame, judge, goal);
        search.ends_in_contact = !(self.a.is_solid() && self.b.is_solid());
        search
    }

    /// Returns the ball of B around the origin of its tree, seen from A, in A's stored units.
    fn place(&self) -> BallAtPose {
        let (tree, frame) = (self.b.side().tree, &self.frame);
        let radius = f64::from(tree.reach) * tree.unit() * frame.scale;
        let centre = tree.centre * frame.scale;
        BallAtPose::new(Operand::B, &centre, radius, &frame.rotation, &frame.translation)
    }

    /// Maps a point from A's stored frame to B's.
    pub(crate) fn back(&self, p: &Vector3<f64>) -> Vector3<f64> {
        let ratio = self.a.stored_unit() / self.b.stored_unit();
        self.frame.rotation.tr_mul(&(p - self.frame.translation)) * ratio
    }

    /// Returns whether a part of one body is inside the other, and how many winding numbers it
    /// took.
    ///
    /// The surfaces are proven to be at least `lower` apart.
    pub(crate) fn inside(&self, lower: f64) -> (Inside, u64) {
        // A point moved to the other frame is off by the error of the frame. If the surface is
        // farther than twice this error, the point is still on its side of the surface.
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
        let to_a = |p: &Vector3<f64>| self.frame.point(p);
        let few_of_b = deciding_items(self.a.by_kind(), self.b.by_kind(), to_a, 1.0 / ratio, error);
        let to_b = |p: &Vector3<f64>| self.back(p);
        let few_of_a = deciding_items(self.b.by_kind(), self.a.by_kind(), to_b, ratio, error * ratio);
        let of_a = few_of_b.as_ref().map_or(of_a, Vec::len);
        let of_b = few_of_a.as_ref().map_or(of_b, Vec::len);
        let by_integers = |of, k| if lower > 0.0 { self.held_exactly(of, k) } else { None };
        let pick = |few: &Option<Vec<usize>>, k: usize| few.as_ref().map_or(k, |few| few[k]);
        let probes_of_b = (0..of_a).map(|k| {
            let k = pick(&few_of_b, k);
            let held = probes(self.b, k).find_map(in_a);
            held.or_else(|| by_integers(Operand::B, k))
        });
        let probes_of_a = (0..of_b).map(|k| {
            let k = pick(&few_of_a, k);
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

    /// Returns whether the other body contains a connected component, and a point of the component.
    ///
    /// The surfaces of the bodies do not meet. One point of the component decides, without
    /// rounding, and is returned in the frames of A and B. Returns `None` if the point is on the
    /// surface.
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
        let stored = |point: ExactVector, frame: &StoredFrame| point.minus(&frame.origin).in_units(frame.exponent);
        let place = stored(point.clone().in_a(&pose), &mesh.frame);
        let is_held = match mesh.side_of(&place) {
            PointSide::Outside => false,
            PointSide::On => return None,
            PointSide::Inside => true,
        };
        Some(match of {
            Operand::A => (is_held, stored(point, &self.a.side().frame).rounded(), place.rounded()),
            Operand::B => (is_held, place.rounded(), stored(point, &self.b.side().frame).rounded()),
        })
    }

    /// Without exact arithmetic, a component within rounding of the surface is undecided.
    #[cfg(not(feature = "exact"))]
    fn held_exactly(&self, _: Operand, _: usize) -> Option<(bool, Vector3<f64>, Vector3<f64>)> {
        None
    }

    /// Returns the bounds of bodies that are too far apart or too small for a search.
    ///
    /// Only balls around their origins are used.
    pub(crate) fn far<F>(a: &A, b: &B, pose: &RelativePose) -> TreeAnswer<F> {
        let (distance, slack, normal) = crate::nonconvex::query::frame::far(a.side(), b.side(), pose);
        let lower = (distance - slack).at_least(0.0);
        let middle = |side: TreeSide| side.frame.given(&side.tree.centre);
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
            point_on_a: middle(a.side()),
            point_on_b: middle(b.side()),
            normal: Unit::new_unchecked(normal),
        }
    }
}

/// Returns the elements of a cloud that decide whether a solid mesh contains any element.
///
/// All elements of a node are on the side of one of them if the surface of the mesh does not meet
/// the node's ball. `place` maps points from the stored frame of the cloud to that of the mesh,
/// with an error of at most `error`; `scale` is one stored unit of the cloud in those of the mesh.
/// Returns `None` for other bodies, whose components are tested one by one.
fn deciding_items(
    outer: PartsRef,
    inner: PartsRef,
    place: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    scale: f64,
    error: f64,
) -> Option<Vec<usize>> {
    let (PartsRef::Mesh(mesh), PartsRef::Cloud(cloud)) = (outer, inner) else {
        return None;
    };
    let (tree, mut items) = (cloud.side().tree, Vec::new());
    if !mesh.may_hold() {
        return Some(items);
    }
    let mut stack = alloc::vec![0];
    while let Some(node) = stack.pop() {
        let b = &tree.boxes[node as usize];
        let centre = place(&(tree.centre + b.centre() * tree.unit()));
        // Twice the error of the map, and as much again for rounding here.
        let radius = f64::from(b.radius()) * tree.unit() * scale + 4.0 * error;
        let is_outside = |k: usize| centre[k] - radius > mesh.high[k] || centre[k] + radius < mesh.low[k];
        if (0..3).any(is_outside) {
            continue;
        }
        let is_on_one_side = sqrt(mesh.nearest_beyond(&centre, radius).square) > radius * (1.0 + 16.0 * UNIT);
        match tree.below(node) {
            Below::Leaf(first, 1) => items.push(first as usize),
            _ if is_on_one_side => items.push(tree.range(node).start as usize),
            Below::Children(c) => stack.extend([c, c + 1]),
            Below::Leaf(first, count) => items.extend(first as usize..(first + count) as usize),
        }
    }
    Some(items)
}

/// Returns points of a connected component, to be tested until one decides the side of the
/// component.
fn probes<A: Parted>(body: &A, part: usize) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let middles = (0..).map_while(|k| body.further_probe(k));
    body.probe(part).into_iter().chain(middles)
}

impl TreeState {
    /// Drops the state of other bodies and every claim that moved points may have made false.
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

    /// Returns the closest points, from the stored front if there is one.
    pub(crate) fn closest<A: Parted, B: Parted, J: Judge>(
        &mut self,
        posed: &PosedTrees<A, B>,
        judge: J,
    ) -> TreeAnswer<J::Features> {
        let mut search = posed.search(judge, MeshGoal::Least);
        self.kept.closest(&mut search);
        let Some(mut best) = search.best else {
            return PosedTrees::far(posed.a, posed.b, posed.pose);
        };
        let mut lower = search.lower.smaller(best.lower).at_least(0.0);
        if lower == 0.0 && !best.crosses {
            let before = search.judge.settled();
            if let Some(decided) = search.judge.decide_contact(&search.touching, &best) {
                (best, lower, search.touching) = (decided.best, decided.lower, decided.touching);
            }
            self.kept.work.settled.count(search.judge.settled() - before);
        }
        let mut answer = TreeAnswer::of_pair(&best, lower, [posed.a.side().frame, posed.b.side().frame]);
        if best.crosses {
            answer.share(posed.a.is_solid() && posed.b.is_solid());
        } else {
            self.conclude(posed, &search.touching, &best, &mut answer);
        }
        answer
    }

    /// Sets the contact state of bodies whose closest items do not certainly cross.
    fn conclude<A: Parted, B: Parted, F>(
        &mut self,
        posed: &PosedTrees<A, B>,
        touching: &Touching,
        best: &Measured<F>,
        answer: &mut TreeAnswer<F>,
    ) {
        let (of_a, of_b) = (posed.a.side().frame, posed.b.side().frame);
        if answer.lower > 0.0 {
            match self.held(posed, answer.lower / of_a.unit()) {
                Inside::No => answer.state = ContactState::Separated,
                Inside::At(on_a, on_b) => {
                    (answer.point_on_a, answer.point_on_b) = (of_a.given(&on_a), of_b.given(&on_b));
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

    /// Returns whether one body is inside the other; their surfaces are proven to be `lower` apart.
    fn held<A: Parted, B: Parted>(&mut self, posed: &PosedTrees<A, B>, lower: f64) -> Inside {
        let now = posed.place();
        // The bodies moved by less than the proven clearance, so the last proof holds.
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

    /// Returns whether solids in contact certainly share inner points.
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

    /// Returns whether the bodies are at most `d` apart, in A's stored units.
    ///
    /// The judge was created for the same `d`.
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
        // All items are proven farther apart than `d`, but one body may contain the other.
        let lower = search.proven().larger(d);
        let is_apart = matches!(self.inside(posed, lower), Inside::No);
        self.free = is_apart.then(|| (lower, posed.place()));
        !is_apart
    }

    /// Returns a lower bound of the distance in the caller's unit, from the stored state alone.
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
    /// Converts two items and a lower bound of the distance to the caller's units.
    ///
    /// The contact state is touching; the caller may change it.
    fn of_pair(best: &Measured<F>, lower: f64, [of_a, of_b]: [StoredFrame; 2]) -> Self {
        let unit = of_a.unit();
        Self {
            state: ContactState::Touching,
            distance: best.distance * unit,
            lower: lower * unit,
            upper: best.upper * unit,
            of: Some((best.pair, best.features)),
            point_on_a: of_a.given(&best.on_a),
            point_on_b: of_b.given(&best.on_b),
            normal: Unit::new_unchecked(best.normal),
        }
    }

    /// Moves the witness points of bodies that share a point to one point of both, up to rounding.
    pub(crate) fn join<A: Parted, B: Parted>(&mut self, posed: &PosedTrees<A, B>) {
        let [of_a, of_b] = [posed.a.side().frame, posed.b.side().frame];
        let (on_a, on_b) = (of_a.stored(&self.point_on_a), of_b.stored(&self.point_on_b));
        let between = posed.frame.point(&on_b) - on_a;
        let error = posed.frame.error;
        if self.upper == 0.0 && between.norm_squared() > error * error {
            let middle = on_a + between * 0.5;
            self.point_on_a = of_a.given(&middle);
            self.point_on_b = of_b.given(&posed.back(&middle));
        }
    }

    /// Returns the answer for two items of one body, which has no inside.
    ///
    /// `lower` is a lower bound of their distance.
    pub(crate) fn of_one_body(best: &Measured<F>, lower: f64, stored: StoredFrame, frame: &TreeFrame) -> Self {
        let mut answer = Self::of_pair(best, lower, [stored; 2]);
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
    /// Returns the outcome with the locations of the witness points.
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

    /// Sets the contact state of bodies that share points: overlapping for solids, otherwise
    /// touching.
    fn share(&mut self, are_solid: bool) {
        self.state = if are_solid {
            ContactState::Overlapping
        } else {
            ContactState::Touching
        };
        (self.distance, self.lower, self.upper) = (0.0, 0.0, 0.0);
    }
}
