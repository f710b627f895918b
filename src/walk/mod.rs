//! The walk: from a pair of features to the closest one, each step to a neighbour that is closer.
//!
//! Lin and Canny 1991: two points on features of A and B are closest exactly if each lies in the Voronoi region of the
//! other's feature; where one does not, the plane it violates names a neighbouring feature that is closer. Distance
//! falls with every step that raises the dimension of a feature and holds with one that lowers it, so in exact
//! arithmetic and for separated bodies the walk ends.
//!
//! Departures:
//! 1. Four states only (Mirtich 1998): an edge over a face slides off it, and two faces meet as one of their vertices
//!    or edges; the states on which the 1991 walk was seen to cycle are gone.
//! 2. No flare angles, no stickiness: rounding may end the walk early, and the certificate says so.
//! 3. A repeated pair (Brent's mark) or too many steps end it. What stands in then is no worse (`fallback`).

pub(crate) mod edge_edge;
mod ellipsoid;
mod ray_exit_face;
pub(crate) mod rings;
pub(crate) mod seed;
mod slide;
pub(crate) mod step;
pub(crate) mod trace;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;

use crate::num::scalar::sqrt;
use crate::pair::outcome::Outcome;
use crate::pair::posed::{OfA, OfB, PosedPair};
use crate::polyhedron::{Feature, FeaturePair};
use crate::tuning::walk::{FIRST_LEAP, FREE, JUMPS, LEAPS, LONGEST};
use crate::walk::rings::newton_jump::newton_jump;
use crate::walk::step::Step;

/// Looks at one state.
#[inline(always)]
fn look<const CERTIFY: bool>(posed: &PosedPair, outcome: &mut Outcome) -> Step {
    use Feature::{Edge, Face, Vertex};
    match (outcome.features.a, outcome.features.b) {
        (Edge(e), Edge(g)) => edge_edge::look::<CERTIFY>(posed, e.0, g.0, outcome),
        (Vertex(v), Face(f)) => vertex_face::look::<CERTIFY, _>(&OfA(posed), v.0, f.0, outcome),
        (Face(f), Vertex(v)) => vertex_face::look::<CERTIFY, _>(&OfB(posed), v.0, f.0, outcome),
        (Vertex(v), Edge(e)) => vertex_edge::look::<CERTIFY, _>(&OfA(posed), v.0, e.0, outcome),
        (Edge(e), Vertex(v)) => vertex_edge::look::<CERTIFY, _>(&OfB(posed), v.0, e.0, outcome),
        (Vertex(v), Vertex(w)) => vertex_vertex::look::<CERTIFY>(posed, v.0, w.0, outcome),
        // No state; nothing leads here (see `to_stand_on`).
        (Edge(_), Face(_)) | (Face(_), Edge(_) | Face(_)) => Step::Lost,
    }
}

/// Walks from the features of `outcome` until the Voronoi tests accept one; whether they do. At most
/// `4 sqrt(nA + nB) + 16` steps, and 128 on bodies with long rims or large fans.
#[inline(always)]
pub(crate) fn walk<const CERTIFY: bool>(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    watched::<CERTIFY>(posed, outcome, |_| {})
}

/// The same walk, each pair it looks at told to `seen`.
#[inline(always)]
pub(crate) fn watched<const CERTIFY: bool>(
    posed: &PosedPair,
    outcome: &mut Outcome,
    mut seen: impl FnMut(FeaturePair),
) -> bool {
    let has_bands = posed.a.has_bands | posed.b.has_bands;
    // Steps before the guard looks.
    let free = if has_bands { FIRST_LEAP } else { FREE };
    let (mut steps, mut jumps, mut guard) = (0, 0, None);
    loop {
        outcome.work.steps += 1;
        seen(outcome.features);
        let step = look::<CERTIFY>(posed, outcome);
        // The one that most walks begin and end with comes first.
        if step == Step::Found {
            return true;
        }
        if step == Step::Lost {
            return false;
        }
        jumps += u32::from(step == Step::Jump);
        steps += 1;
        if jumps > JUMPS || steps >= free && Guard::stops(&mut guard, steps, posed, outcome) {
            return false;
        }
    }
}

/// Ends walks that go in a circle or too far.
struct Guard {
    leaps: u32,
    /// Where the last one went.
    leapt: Option<FeaturePair>,
    /// When to try a leap along a long rim, or round a large fan.
    next_leap: u32,
    /// The pair remembered at step 8, 16, 32 and so on (Brent): to meet it again is a circle.
    mark: Option<FeaturePair>,
    next_mark: u32,
    limit: u32,
}

impl Guard {
    fn new(posed: &PosedPair) -> Self {
        let has_bands = posed.a.has_bands | posed.b.has_bands;
        Self {
            leaps: 0,
            leapt: None,
            next_leap: if has_bands { FIRST_LEAP } else { u32::MAX },
            mark: None,
            next_mark: FREE,
            limit: step_limit(posed),
        }
    }

    /// Whether the walk ends after so many steps, of which the guard is to be told each from the first one on that is not free.
    #[cold]
    fn stops(guard: &mut Option<Self>, steps: u32, posed: &PosedPair, outcome: &mut Outcome) -> bool {
        let guard = guard.get_or_insert_with(|| Self::new(posed));
        if steps == guard.next_leap {
            guard.newton_jump(steps, posed, outcome);
        }
        let next = Some(outcome.features);
        if steps > FREE && (next == guard.mark || steps >= guard.limit) {
            return true;
        }
        if steps == guard.next_mark {
            (guard.mark, guard.next_mark) = (next, 2 * guard.next_mark);
        }
        false
    }

    fn newton_jump(&mut self, steps: u32, posed: &PosedPair, outcome: &mut Outcome) {
        // One that did not help is tried later again, and so is one that did: leaps are few, so the walk still ends.
        let leapt = newton_jump(posed, outcome);
        let later = if leapt { FIRST_LEAP } else { steps.max(FIRST_LEAP) };
        self.leaps += 1;
        let there = Some(outcome.features);
        // A leap to where the last one went has nothing to add to the steps in between.
        let ends = self.leaps == LEAPS || (leapt && there == self.leapt);
        self.next_leap = if ends { u32::MAX } else { steps + later };
        self.leapt = there;
    }
}

/// Round bodies take about sqrt(n) steps from anywhere; twice the sum of both and a constant leaves room.
#[cold]
fn step_limit(posed: &PosedPair) -> u32 {
    let n = posed.a.topology.vertex_count() + posed.b.topology.vertex_count();
    let round = (4.0 * sqrt(n as f64)) as u32 + 16;
    // Leaps take a walk along long rims and round large fans.
    if posed.a.has_bands | posed.b.has_bands {
        round.min(LONGEST)
    } else {
        round
    }
}
