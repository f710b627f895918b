//! The Lin-Canny walk: from a feature pair to the closest feature pair, by steps to closer adjacent
//! features.
//!
//! Lin and Canny 1991: a point of A and a point of B are closest if and only if each lies in the
//! Voronoi region of the feature that contains the opposite point. Otherwise, a violated plane of a
//! Voronoi region identifies an adjacent feature that is closer. The distance decreases with every
//! step to a feature of higher dimension and stays equal with every step to a lower dimension. So
//! the walk ends in exact arithmetic if the bodies are separated.
//!
//! [`walk`] is the loop. Each state has a test in a separate file: [`vertex_vertex`],
//! [`vertex_edge`], [`vertex_face`] and [`edge_edge`]. A test returns a [`Step`]: accept the pair,
//! move to the next pair, or stop. A step is written into an outcome in one of two forms.
//!
//! Departures:
//! 1. There are only four states (Mirtich 1998). An edge over a face slides off the face
//!    ([`slide`]), and two faces meet as a vertex or an edge of one of them. The states on which
//!    the 1991 walk was seen to cycle do not exist.
//! 2. Voronoi regions are not flared. Rounding may end the walk early, and the certificate detects
//!    this.
//! 3. A repeated pair (Brent's cycle detection) or too many steps end the walk. The result of the
//!    next solver is no worse (`solve::ladder`).

pub(crate) mod edge_edge;
pub(crate) mod rings;
pub(crate) mod seed;
mod slide;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;

use nalgebra::{Unit, Vector3};

use crate::base::num::scalar::sqrt;
use crate::body::polyhedron::{Feature, FeaturePair};
use crate::convex::walk::rings::newton_jump::newton_jump;
use crate::pair::draft::Draft;
use crate::pair::posed::{AFirst, BFirst, PosedPair, WitnessPair};

/// The largest number of jumps to a far face (vertex-face from behind) in a walk. Jumps are not
/// monotone; with a larger number, walks continue that another solver ends sooner.
const JUMPS: u32 = 3;

/// Number of steps before the guard against cycles starts: most walks end before it and never pay
/// for the guard.
const FREE: u32 = 8;

/// The largest number of Newton jumps of a walk.
const NEWTON_JUMPS: u32 = 12;

/// A walk takes at most this number of steps plus [`STEPS_PER_ROOT`] times the root of the number
/// of vertices of both bodies, because steps grow with the diameter of a body. A longer walk fails
/// and the other solvers run.
const STEPS_AT_LEAST: u32 = 16;

/// Largest number of steps of a walk for each unit of the root of the number of vertices.
const STEPS_PER_ROOT: f64 = 4.0;

/// Largest number of steps of a walk on bodies with long face boundaries or large fans, which
/// Newton jumps pass.
const MOST_STEPS_WITH_JUMPS: u32 = 128;

/// Number of steps before the first Newton jump along a long face boundary or around a large fan: a
/// jump costs several steps, and most walks have ended by then.
const FIRST_NEWTON_JUMP: u32 = 4;

/// Tests the current feature pair of `draft` and moves to the next pair or accepts the pair.
#[inline(always)]
fn test_pair<const CERTIFY: bool>(posed: &PosedPair, draft: &mut Draft) -> Step {
    use Feature::{Edge, Face, Vertex};
    match (draft.features.a, draft.features.b) {
        (Edge(e), Edge(g)) => edge_edge::test::<CERTIFY>(posed, e, g, draft),
        (Vertex(v), Face(f)) => vertex_face::test::<CERTIFY, _>(&AFirst(posed), v, f, draft),
        (Face(f), Vertex(v)) => vertex_face::test::<CERTIFY, _>(&BFirst(posed), v, f, draft),
        (Vertex(v), Edge(e)) => vertex_edge::test::<CERTIFY, _>(&AFirst(posed), v, e, draft),
        (Edge(e), Vertex(v)) => vertex_edge::test::<CERTIFY, _>(&BFirst(posed), v, e, draft),
        (Vertex(v), Vertex(w)) => vertex_vertex::test::<CERTIFY>(posed, v, w, draft),
        // Not a state: no step leads here (see `walkable`).
        (Edge(_), Face(_)) | (Face(_), Edge(_) | Face(_)) => Step::Lost,
    }
}

/// Walks from the features of `draft` and returns whether the Voronoi tests accepted a pair. With
/// `CERTIFY`, an accepted pair has a lower bound of the distance, if the tests prove one. A walk
/// takes at most `4 sqrt(nA + nB) + 16` steps, and at most 128 on bodies with large rings.
#[inline(always)]
pub(crate) fn walk<const CERTIFY: bool>(posed: &PosedPair, draft: &mut Draft) -> bool {
    walk_observed::<CERTIFY>(posed, draft, |_| {})
}

/// Walks as [`walk`] does, and passes each tested pair to `observe`.
#[inline(always)]
pub(crate) fn walk_observed<const CERTIFY: bool>(
    posed: &PosedPair,
    draft: &mut Draft,
    mut observe: impl FnMut(FeaturePair),
) -> bool {
    let has_large_rings = posed.a.has_large_rings | posed.b.has_large_rings;
    // Number of steps before the guard first checks.
    let free = if has_large_rings { FIRST_NEWTON_JUMP } else { FREE };
    let (mut steps, mut jumps, mut guard) = (0, 0, None);
    loop {
        draft.work.steps += 1;
        observe(draft.features);
        let step = test_pair::<CERTIFY>(posed, draft);
        // First, because most walks start and end with this step.
        if step == Step::Found {
            return true;
        }
        if step == Step::Lost {
            return false;
        }
        jumps += u32::from(step == Step::Jump);
        steps += 1;
        if jumps > JUMPS || steps >= free && Guard::stops(&mut guard, steps, posed, draft) {
            return false;
        }
    }
}

/// Ends walks that repeat a feature pair or take too many steps, and starts Newton jumps.
struct Guard {
    newton_jumps: u32,
    /// Feature pair after the last Newton jump.
    last_target: Option<FeaturePair>,
    /// Step at which to try the next Newton jump along a large ring.
    next_jump: u32,
    /// Feature pair stored at steps 8, 16, 32 and so on (Brent): meeting the pair again proves a
    /// cycle.
    mark: Option<FeaturePair>,
    next_mark: u32,
    limit: u32,
}

impl Guard {
    fn new(posed: &PosedPair) -> Self {
        let has_large_rings = posed.a.has_large_rings | posed.b.has_large_rings;
        Self {
            newton_jumps: 0,
            last_target: None,
            next_jump: if has_large_rings { FIRST_NEWTON_JUMP } else { u32::MAX },
            mark: None,
            next_mark: FREE,
            limit: step_limit(posed),
        }
    }

    /// Returns whether the walk must end after `steps` steps. From the first step that is not free,
    /// the walk must call the guard after every step.
    #[cold]
    fn stops(guard: &mut Option<Self>, steps: u32, posed: &PosedPair, draft: &mut Draft) -> bool {
        let guard = guard.get_or_insert_with(|| Self::new(posed));
        if steps == guard.next_jump {
            guard.newton_jump(steps, posed, draft);
        }
        let next = Some(draft.features);
        if steps > FREE && (next == guard.mark || steps >= guard.limit) {
            return true;
        }
        if steps == guard.next_mark {
            (guard.mark, guard.next_mark) = (next, 2 * guard.next_mark);
        }
        false
    }

    fn newton_jump(&mut self, steps: u32, posed: &PosedPair, draft: &mut Draft) {
        // In both cases, if the jump helped or not, another is tried later: jumps are few, so the
        // walk still ends.
        let jumped = newton_jump(posed, draft);
        let later = if jumped {
            FIRST_NEWTON_JUMP
        } else {
            steps.max(FIRST_NEWTON_JUMP)
        };
        self.newton_jumps += 1;
        let target = Some(draft.features);
        // A second jump to the target of the last jump adds nothing to the steps between.
        let ends = self.newton_jumps == NEWTON_JUMPS || (jumped && target == self.last_target);
        self.next_jump = if ends { u32::MAX } else { steps + later };
        self.last_target = target;
    }
}

/// Limit of the steps of a walk. Round bodies take about sqrt(n) steps from any start. Twice the
/// sum for both bodies plus a constant is enough.
#[cold]
fn step_limit(posed: &PosedPair) -> u32 {
    let n = posed.a.topology.vertex_count() + posed.b.topology.vertex_count();
    let round = (STEPS_PER_ROOT * sqrt(n as f64)) as u32 + STEPS_AT_LEAST;
    // Newton jumps move a walk along large rings.
    if posed.a.has_large_rings | posed.b.has_large_rings {
        round.min(MOST_STEPS_WITH_JUMPS)
    } else {
        round
    }
}

/// Result of the test of a feature pair.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// An adjacent feature is closer: test the new pair next.
    Move,
    /// A distant face sees the vertex from outside: test that face next. The distance need not be
    /// smaller.
    Jump,
    /// Each witness lies in the Voronoi region of the opposite feature: the pair is accepted.
    Found,
    /// No adjacent feature is closer: the bodies overlap or nearly touch, or rounding hides the
    /// descent.
    Lost,
}

impl Draft {
    /// Moves to a closer pair.
    #[inline(always)]
    pub(crate) fn move_to(&mut self, pair: FeaturePair) -> Step {
        self.features = pair;
        Step::Move
    }

    /// Accepts the current pair: writes the unit direction from A to B in A's frame, the witnesses
    /// in their stored frames, their distance, and a lower bound of the distance before the error
    /// term (minus infinity if the tests do not prove one).
    #[inline(always)]
    pub(crate) fn accept(&mut self, normal: Vector3<f64>, witnesses: WitnessPair, distance: f64, lower: f64) -> Step {
        self.normal = Unit::new_unchecked(normal);
        self.point_on_a = witnesses.0.into();
        self.point_on_b = witnesses.1.into();
        self.distance = distance;
        self.lower = lower;
        Step::Found
    }
}
