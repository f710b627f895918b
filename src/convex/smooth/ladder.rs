//! Runs solver after solver on one pair of cores until the bounds agree ([`separate`]).

use nalgebra::{Unit, Vector3};

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::{Scalar, Vec3, dot, sqrt, sub};
use crate::base::pose::RelativePose;
use crate::base::tolerance::{AGREE_CURVED, CERTIFICATE, SMALL_PAIR, SPECK, UNIT, UNIT_DOUBLE_DOUBLE};
use crate::body::polyhedron::{FeaturePair, exponent_of, power_of_two};
use crate::body::shape::{Core, Curved, Support, match_core};
use crate::convex::smooth::best_bounds::{BranchSet, ProvenBounds};
use crate::convex::smooth::cores::{Any, CoreKind, PolyhedralCore};
use crate::convex::smooth::gjk::{Around, Frozen, SolveGoal};
use crate::convex::smooth::newton_gjk::{RunEnd, SolverRun};
use crate::convex::smooth::posed::{DifferencePoint, PosedCores, add, askew, unit, values};
use crate::convex::smooth::{depth, gjk, warm_start};
use crate::pair::draft::round_outward;
use crate::pair::outcome::{ContactState, DepthMode, Outcome, Solver};
use crate::pair::transform::{StoredFrame, Transform};

/// The direction is extrapolated if each coordinate changed by less than this: a heuristic.
const SLIGHT: f64 = 0.25;

/// The change is extrapolated with its own change if that is below this share: a heuristic.
const STEADY: f64 = 0.25;

/// State of a pair between queries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WarmStart {
    start: Option<(Vec3<f64>, BranchSet)>,
    /// Change of the direction between the last two answers, and the change before it.
    turn: Vec3<f64>,
    #[cfg_attr(feature = "serde", serde(default))]
    before: Vec3<f64>,
}

impl WarmStart {
    /// Returns a start along a direction from A to B, in the frame of A. Its branches are unknown;
    /// those of the support points along the direction are used instead.
    pub(crate) fn along(n: &Vector3<f64>) -> Self {
        Self {
            start: Some(((*n).into(), BranchSet::default())),
            ..Self::default()
        }
    }

    /// Converts a direction without branches to the cores in swapped order.
    #[inline(always)]
    pub(super) fn swap(&mut self, swapped: &RelativePose) {
        if let Some((n, set)) = &mut self.start
            && set.is_empty()
        {
            *n = (-(swapped.rotation() * Vector3::from(*n))).into();
        }
    }

    /// Returns a direction to start with, of a length close to one, and branches. A deserialised
    /// state may contain no valid direction.
    fn start(&self) -> Option<(Vec3<f64>, BranchSet)> {
        let (n, set) = self.start?;
        let is_small = n.iter().all(|x| x.abs() <= 2.0);
        is_small.then(|| (self.ahead(n), set))
    }

    /// Extrapolates the direction by its last change, and by the change of that if it is small.
    #[inline(always)]
    fn ahead(&self, n: Vec3<f64>) -> Vec3<f64> {
        let most = |v: &Vec3<f64>| v[0].abs().larger(v[1].abs()).larger(v[2].abs());
        let (change, size) = (sub(&self.turn, &self.before), most(&self.turn));
        // NaN is not small.
        if !(size < SLIGHT) {
            return n;
        }
        let n = add(&n, &self.turn);
        if most(&change) < size * STEADY {
            add(&n, &change)
        } else {
            n
        }
    }

    /// Stores an answer.
    fn keep(&mut self, n: Vec3<f64>, set: BranchSet) {
        self.before = self.turn;
        self.turn = self.start.map_or([0.0; 3], |(before, _)| sub(&n, &before));
        self.start = Some((n, set));
    }
}

/// Frame and unit of length in which a pair is solved.
#[derive(Clone, Copy)]
pub(super) struct SolverSetting<'p> {
    pose: &'p RelativePose,
    cores: [&'p Core; 2],
    until: DepthMode,
    /// Translation of the pose, if both cores are stored unscaled and the sizes are ordinary.
    plain: Option<Vec3<f64>>,
    /// A length of the solvers times `2^exponent` is in the caller's unit.
    exponent: i32,
    /// Distance of the stored origins from the origins of the frames, in the unit of the solvers.
    offsets: f64,
}

impl<'p> SolverSetting<'p> {
    #[inline(always)]
    pub(super) fn new(a: &'p Core, b: &'p Core, pose: &'p RelativePose, until: DepthMode) -> Self {
        let given = |core: &Core| !matches!(core, Core::Polyhedron(body) if !body.is_unscaled);
        let radii = [a.radius(), b.radius()];
        let t = pose.translation();
        let size = radii[0].larger(radii[1]).larger(t.amax());
        // NaN is not near.
        let is_near = t.iter().all(|x| x.abs() < 1.0 / SMALL_PAIR);
        let is_seen = radii.iter().all(|&r| r > SPECK * size || r == 0.0);
        let is_ordinary = is_near && size < 1.0 / SMALL_PAIR && size > SMALL_PAIR && is_seen;
        let is_plain = given(a) && given(b) && is_ordinary;
        Self {
            pose,
            cores: [a, b],
            until,
            plain: is_plain.then_some([t.x, t.y, t.z]),
            exponent: 0,
            offsets: 0.0,
        }
    }

    /// Returns the radii of both cores, in the caller's unit.
    fn radii(&self) -> [f64; 2] {
        self.cores.each(Core::radius)
    }

    /// Returns the origins about which the points of A and of B are stored.
    fn origins(&self) -> [Vector3<f64>; 2] {
        self.cores.each(Core::origin)
    }

    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.plain.is_some()
    }

    #[inline(always)]
    fn frame(&self) -> Option<Transform<f64>> {
        let Some(translation) = self.plain else {
            return self.rounded_frame();
        };
        let m = self.pose.rotation();
        let matrix = [
            [m[(0, 0)], m[(0, 1)], m[(0, 2)]],
            [m[(1, 0)], m[(1, 1)], m[(1, 2)]],
            [m[(2, 0)], m[(2, 1)], m[(2, 2)]],
        ];
        Some(Transform { matrix, translation })
    }

    #[cold]
    fn rounded_frame(&self) -> Option<Transform<f64>> {
        let fine = self.fine_frame()?;
        Some(Transform {
            matrix: fine.matrix.each(|row| row.each(Scalar::value)),
            translation: fine.translation.each(Scalar::value),
        })
    }

    fn fine_frame(&self) -> Option<Transform<DoubleDouble>> {
        let [a, b] = self.origins().each(|origin| StoredFrame {
            origin,
            exponent: self.exponent,
        });
        Transform::between(&a, &b, self.pose)
    }
}

/// Returns the outcome of a pair of known kinds, in the unit of the solvers.
#[inline(never)]
pub(super) fn closest_of<A: CoreKind, B: CoreKind>(
    a: &A,
    b: &B,
    setting: &SolverSetting,
    memory: &mut WarmStart,
) -> Outcome {
    let mut outcome = Outcome::starting_at(FeaturePair::FIRST);
    let Some(frame) = setting.frame() else { return outcome };
    let t = Vector3::from(frame.translation);
    let size = a.reach() + b.reach() + sqrt(t.norm_squared()) + UNIT_DOUBLE_DOUBLE / UNIT * setting.offsets;
    let posed = PosedCores { a, b, frame, size };
    let mut best = ProvenBounds::new();
    let (mut solver, mut set) = (Solver::Walk, None);
    let start = memory.start().map(|(n, set)| (n, set.or_about(&posed, n)));
    let mut deep = |known: &ProvenBounds<f64>, corners| {
        let proven = deepen(&posed, known, corners, setting.until, &mut outcome);
        set = proven.or(set);
        proven.is_some()
    };
    let ended = separate(&posed, start, &mut best, &mut solver, &mut deep);
    outcome.work.steps += best.evaluations;
    if outcome.solver == Solver::Walk {
        outcome.solver = solver;
    }
    match ended {
        Ended::Deep => best.set = set.unwrap_or(best.set),
        Ended::Closed if take(&posed, &best, CERTIFICATE * UNIT * size, &mut outcome) => {}
        Ended::Closed | Ended::Open => finer(&posed, setting, &best, &mut outcome),
    }
    memory.keep((*outcome.normal).into(), best.set);
    outcome
}

/// Searches the depth of cores that seem to overlap. Returns the branches of the deepest points if
/// the cores overlap or touch.
#[inline(never)]
fn deepen<A: CoreKind, B: CoreKind>(
    posed: &PosedCores<A, B, f64>,
    known: &ProvenBounds<f64>,
    corners: Option<Around<f64>>,
    until: DepthMode,
    outcome: &mut Outcome,
) -> Option<BranchSet> {
    let term = CERTIFICATE * UNIT * posed.size;
    outcome.work.depths += 1;
    let mut deep = depth::deepen(posed, known, corners, until);
    let is_done = deep.inside || depth::is_enough(posed, &deep.best, until);
    let found = is_done.then(|| depth::witnesses(posed, &mut deep.best));
    outcome.work.steps += deep.best.evaluations - known.evaluations;
    let ProvenBounds { on_a, on_b, set, .. } = found?;
    let answer = ProvenBounds {
        on_a,
        on_b,
        set,
        ..deep.best
    };
    if !take(posed, &answer, term, outcome) {
        return None;
    }
    if deep.grown {
        outcome.solver = Solver::Polytope;
    }
    if deep.inside {
        outcome.state = ContactState::Overlapping;
        outcome.upper = outcome.upper.at_most(0.0);
        outcome.distance = outcome.distance.smaller(outcome.upper);
    }
    Some(deep.best.set)
}

/// Runs the solvers in double-double.
#[cold]
#[inline(never)]
fn finer<A: CoreKind, B: CoreKind>(
    posed: &PosedCores<A, B, f64>,
    setting: &SolverSetting,
    best: &ProvenBounds<f64>,
    outcome: &mut Outcome,
) {
    outcome.work.double_doubles += 1;
    outcome.solver = Solver::DoubleDouble;
    // No two points of the cores are farther apart than L, nor is a depth greater.
    (outcome.lower, outcome.upper) = (-2.0 * posed.size, 2.0 * posed.size);
    let mut known = *best;
    if !take(posed, best, CERTIFICATE * UNIT * posed.size, outcome) {
        known = ProvenBounds::new();
    }
    let (a, b) = (posed.a.any(), posed.b.any());
    let Some(frame) = setting.fine_frame() else { return };
    let (a, b, size) = (&a, &b, posed.size);
    let fine = PosedCores { a, b, frame, size };
    let mut found = ProvenBounds::<DoubleDouble>::new();
    let mut solver = Solver::DoubleDouble;
    let start = best.n.each(DoubleDouble::from);
    let start = unit(&start).map(|n| (n, best.set));
    let ended = separate_in_double_double(&fine, start, &mut found, &mut solver, &mut |finest, corners| {
        let (mut known, toward) = (known, posed.toward(finest.n.each(Scalar::value)));
        known.prove(&toward, &posed.support(&toward, [0; 2]));
        let rounded = |p: DifferencePoint<DoubleDouble>| {
            posed.piece(p.of, p.on_a.each(Scalar::value), p.on_b.each(Scalar::value))
        };
        corners.is_some_and(|c| deepen(posed, &known, Some(c.map(rounded)), setting.until, outcome).is_some())
    });
    outcome.work.steps += found.evaluations;
    outcome.solver = Solver::DoubleDouble;
    if ended == Ended::Deep {
        return;
    }
    let offsets = if setting.is_plain() { 0.0 } else { setting.offsets };
    let term = CERTIFICATE * UNIT_DOUBLE_DOUBLE * (size + offsets);
    take(&fine, &found, term, outcome);
}

/// Runs [`separate`] in double-double, compiled once for all pairs.
#[cold]
#[inline(never)]
fn separate_in_double_double(
    posed: &PosedCores<Any, Any, DoubleDouble>,
    start: Option<(Vec3<DoubleDouble>, BranchSet)>,
    best: &mut ProvenBounds<DoubleDouble>,
    solver: &mut Solver,
    deep: &mut ProveOverlap<DoubleDouble>,
) -> Ended {
    separate(posed, start, best, solver, deep)
}

/// Copies the bounds and witness points of a solver to the outcome. Returns false, and copies
/// nothing, if the solver has failed: a coordinate is not finite, or the bounds contradict each
/// other.
#[inline(always)]
fn take<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    best: &ProvenBounds<T>,
    term: f64,
    outcome: &mut Outcome,
) -> bool {
    let agree = (AGREE_CURVED + 2.0 * CERTIFICATE * UNIT) * posed.size;
    if !take_bounds(best, term, agree, outcome) {
        return false;
    }
    let (mut a, mut b, mut len) = ([0; 3], [0; 3], 0);
    for of in best.set.branches() {
        (a[len], b[len]) = (of[0], of[1]);
        len += 1;
    }
    outcome.features = FeaturePair {
        a: posed.a.feature(&a[..len], &outcome.point_on_a.coords),
        b: posed.b.feature(&b[..len], &outcome.point_on_b.coords),
    };
    true
}

/// Copies everything except the features. Bounds that differ by at most `agree` count as touching.
#[inline]
fn take_bounds<T: Scalar>(best: &ProvenBounds<T>, term: f64, agree: f64, outcome: &mut Outcome) -> bool {
    let upper = round_outward(best.upper, term).at_most(f64::MAX);
    let points = best.on_a.iter().chain(&best.on_b);
    if !points.fold(true, |all, x| all & x.value().is_finite()) || !(best.lower.value() <= upper) {
        return false;
    }
    (outcome.lower, outcome.upper) = (round_outward(best.lower, -term), upper);
    let estimate = if outcome.lower > 0.0 { best.upper } else { best.lower };
    outcome.distance = estimate
        .value()
        .clamped(outcome.lower.at_least(-f64::MAX).smaller(outcome.upper), outcome.upper);
    outcome.unsign_zeros();
    outcome.normal = Unit::new_unchecked(values(&best.n).into());
    outcome.point_on_a = values(&best.on_a).into();
    outcome.point_on_b = values(&best.on_b).into();
    outcome.state = if outcome.lower > 0.0 {
        ContactState::Separated
    } else if outcome.upper < 0.0 {
        ContactState::Overlapping
    } else if outcome.upper - outcome.lower <= agree {
        ContactState::Touching
    } else {
        ContactState::Undecided
    };
    true
}

/// Returns the outcome of a pair of extreme sizes or positions, solved in a unit chosen for the
/// pair. A core that is negligibly small counts as a point.
#[cold]
pub(super) fn extreme(a: &Core, b: &Core, setting: &SolverSetting, memory: &mut WarmStart) -> Outcome {
    let [ra, rb] = setting.radii();
    let [oa, ob] = setting.origins();
    let t = setting.pose.translation_sixteenth() + setting.pose.rotation() * ob / 16.0 - oa / 16.0;
    let largest = t.amax();
    let apart = if largest > 0.0 {
        largest * (t / largest).norm()
    } else {
        0.0
    };
    let offsets = oa.abs().sum() + ob.abs().sum();
    if !(SPECK * apart <= ra + rb) {
        return far(setting, &t, apart, offsets);
    }
    let exponent = exponent_of(ra.larger(rb).larger(apart));
    let unit = power_of_two(-exponent);
    let setting = SolverSetting {
        plain: None,
        exponent,
        offsets: offsets * unit,
        ..*setting
    };
    let size = (ra + rb + apart) * unit;
    let (speck_a, speck_b) = (ra * unit < SPECK * size, rb * unit < SPECK * size);
    let a = if speck_a { Any::Point } else { scaled(a, exponent) };
    let b = if speck_b { Any::Point } else { scaled(b, exponent) };
    let mut outcome = closest_of(&a, &b, &setting, memory);
    let lost = |speck: bool, r: f64| if speck { 2.0 * r * unit } else { 0.0 };
    let (less, back) = (lost(speck_a, ra) + lost(speck_b, rb), power_of_two(exponent));
    outcome.lower = ((outcome.lower - less) * back).next_down();
    outcome.upper = ((outcome.upper + less) * back).next_up().at_most(f64::MAX);
    outcome.distance = (outcome.distance * back).clamped(outcome.lower, outcome.upper);
    outcome.point_on_a = (outcome.point_on_a.coords * back + oa).into();
    outcome.point_on_b = (outcome.point_on_b.coords * back + ob).into();
    if less > 0.0 {
        outcome.state = match outcome.state {
            ContactState::Separated if outcome.lower > 0.0 => ContactState::Separated,
            ContactState::Overlapping if outcome.upper < 0.0 => ContactState::Overlapping,
            ContactState::Undecided => ContactState::Undecided,
            _ => ContactState::Touching,
        };
    }
    outcome
}

/// Returns a core in the unit of the solvers.
fn scaled(core: &Core, exponent: i32) -> Any<'_> {
    let by = power_of_two(-exponent);
    match_core!(core, body => Any::Hull(PolyhedralCore {
        body,
        unit: power_of_two(body.exponent - exponent),
    }), core => core.scaled(by).into())
}

/// Returns the outcome of cores so far apart that their sizes are below the rounding of the
/// distance. `t` and `apart` are in sixteenths.
fn far(setting: &SolverSetting, t: &Vector3<f64>, apart: f64, offsets: f64) -> Outcome {
    let mut outcome = Outcome::starting_at(FeaturePair::FIRST);
    let radii: f64 = setting.radii().iter().sum();
    let distance = 16.0 * apart;
    let slack = CERTIFICATE * UNIT * (distance + radii + offsets) + 2.0 * radii;
    outcome.lower = distance - slack;
    outcome.upper = (distance + slack).at_most(f64::MAX);
    outcome.distance = distance.clamped(outcome.lower, outcome.upper);
    outcome.normal = crate::pair::draft::unit(t);
    outcome.state = if outcome.lower > 0.0 {
        ContactState::Separated
    } else {
        ContactState::Undecided
    };
    outcome.solver = Solver::Far;
    [outcome.point_on_a, outcome.point_on_b] = setting.origins().each(Into::into);
    outcome
}

/// How the solvers of one arithmetic ended.
#[derive(PartialEq)]
pub(super) enum Ended {
    /// The bounds agree.
    Closed,
    Open,
    /// An overlap is proven.
    Deep,
}

/// Proves an overlap from bounds and, if known, from points of the difference around the origin.
/// Returns whether the proof has succeeded.
type ProveOverlap<'f, T> = dyn FnMut(&ProvenBounds<T>, Option<Around<T>>) -> bool + 'f;

/// Runs solver after solver until the bounds agree. If the cores seem to overlap, or if points of
/// the difference are around the origin, `deep` tries to prove the overlap.
#[inline(always)]
pub(super) fn separate<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    start: Option<(Vec3<T>, BranchSet)>,
    best: &mut ProvenBounds<T>,
    solver: &mut Solver,
    deep: &mut ProveOverlap<T>,
) -> Ended {
    let (mut start, mut closed) = (start, None);
    loop {
        if let Some((n, set)) = start {
            let end = warm_start::track(posed, n, &set, best);
            if end == Err(RunEnd::Closed) {
                return Ended::Closed;
            }
            // A lower bound keeps the direction that proves it. A start has a length of about one.
            let is_proven = best.lower > T::from(f64::NEG_INFINITY);
            let n = unit(&n).filter(|_| !is_proven).unwrap_or(best.n);
            if end == Err(RunEnd::Inside) && closed.is_none() && deep(&ProvenBounds { n, set, ..*best }, None) {
                return Ended::Deep;
            }
        }
        if let Some(closed) = closed {
            *best = closed;
            return Ended::Closed;
        }
        let ended = search(posed, start.is_some(), best, solver, deep);
        if ended != Ended::Closed || best.is_opposite(posed) {
            return ended;
        }
        // Bounds that agree determine the direction only to the square root of the tolerance.
        (start, closed) = (Some((best.n, best.set)), Some(*best));
    }
}

/// Runs the solvers after the first solver of a warm query.
#[inline(never)]
pub(super) fn search<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    is_warm: bool,
    best: &mut ProvenBounds<T>,
    solver: &mut Solver,
    deep: &mut ProveOverlap<T>,
) -> Ended {
    if is_warm {
        if let Some(ended) = bend(posed, best.n, best, deep) {
            return ended;
        }
        *solver = Solver::Restart;
    }
    let axis = [T::from(1.0), T::from(0.0), T::from(0.0)];
    let n = unit(&posed.frame.translation).unwrap_or(axis);
    match gjk::solve(posed, n, SolveGoal::Approach, best) {
        Frozen::Closed => return Ended::Closed,
        Frozen::Inside(corners) if deep(best, Some(corners)) => return Ended::Deep,
        _ => {}
    }
    if let Some(ended) = bend(posed, toward_witness(posed, best), best, deep) {
        return ended;
    }
    *solver = Solver::Gjk;
    match gjk::solve(posed, toward_witness(posed, best), SolveGoal::Close, best) {
        Frozen::Closed => Ended::Closed,
        Frozen::Inside(corners) if deep(best, Some(corners)) => Ended::Deep,
        _ => Ended::Open,
    }
}

/// Runs the main solver from a direction and the best branch pairs. Returns `None` if the bounds do
/// not agree and no overlap is proven.
fn bend<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    n: Vec3<T>,
    best: &mut ProvenBounds<T>,
    deep: &mut ProveOverlap<T>,
) -> Option<Ended> {
    let (set, is_deep) = (best.set, false);
    let mut run = SolverRun {
        posed,
        best,
        deep: is_deep,
    };
    match run.run(n, &set) {
        RunEnd::Closed => Some(Ended::Closed),
        RunEnd::Inside if deep(best, None) => Some(Ended::Deep),
        _ => None,
    }
}

/// Returns the direction between the nearest known points. If the points coincide, returns a
/// direction away from the symmetries that caused this.
fn toward_witness<A: Support, B: Support, T: Scalar>(posed: &PosedCores<A, B, T>, best: &ProvenBounds<T>) -> Vec3<T> {
    let w = posed.piece([0; 2], best.on_a, best.on_b).w;
    let least = T::from(AGREE_CURVED * posed.size);
    unit(&w)
        .filter(|_| dot(&w, &w) > least * least)
        .unwrap_or_else(|| askew(&best.n))
}
