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

use super::leap::leap;
use super::outcome::Outcome;
use super::placed::{OfA, OfB, Placed};
use super::state::Step;
use super::{edge_edge, vertex_edge, vertex_face, vertex_vertex};
use crate::polyhedron::{Feature, FeaturePair};
use crate::scalar::sqrt;

/// Jumps to a far face (vertex-face from behind) a walk may take: they are not monotone.
const JUMPS: u32 = 3;

/// Steps before the guard looks.
const FREE: u32 = 8;

/// Leaps a walk may try.
const LEAPS: u32 = 12;

/// Steps a walk may take on bodies it leaps on.
const LONGEST: u32 = 128;

/// A walk leaps along a long rim or round a large fan after so many steps: most have ended by then.
const FIRST_LEAP: u32 = 4;

/// Looks at one state.
#[inline(always)]
fn look<const CERTIFY: bool>(placed: &Placed, outcome: &mut Outcome) -> Step {
    use Feature::{Edge, Face, Vertex};
    match (outcome.features.a, outcome.features.b) {
        (Edge(e), Edge(g)) => edge_edge::look::<CERTIFY>(placed, e.0, g.0, outcome),
        (Vertex(v), Face(f)) => vertex_face::look::<CERTIFY, _>(&OfA(placed), v.0, f.0, outcome),
        (Face(f), Vertex(v)) => vertex_face::look::<CERTIFY, _>(&OfB(placed), v.0, f.0, outcome),
        (Vertex(v), Edge(e)) => vertex_edge::look::<CERTIFY, _>(&OfA(placed), v.0, e.0, outcome),
        (Edge(e), Vertex(v)) => vertex_edge::look::<CERTIFY, _>(&OfB(placed), v.0, e.0, outcome),
        (Vertex(v), Vertex(w)) => vertex_vertex::look::<CERTIFY>(placed, v.0, w.0, outcome),
        // No state; nothing leads here (see `to_stand_on`).
        (Edge(_), Face(_)) | (Face(_), Edge(_) | Face(_)) => Step::Lost,
    }
}

/// Walks from the features of `outcome` until the Voronoi tests accept one; whether they do. At most
/// `4 sqrt(nA + nB) + 16` steps, and 128 on bodies with long rims or large fans.
#[inline(always)]
pub(crate) fn walk<const CERTIFY: bool>(placed: &Placed, outcome: &mut Outcome) -> bool {
    watched::<CERTIFY>(placed, outcome, |_| {})
}

/// The same walk, each pair it looks at told to `seen`.
#[inline(always)]
pub(crate) fn watched<const CERTIFY: bool>(
    placed: &Placed,
    outcome: &mut Outcome,
    mut seen: impl FnMut(FeaturePair),
) -> bool {
    let first_leap = if placed.a.has_bands | placed.b.has_bands {
        FIRST_LEAP
    } else {
        u32::MAX
    };
    let mut guard = Guard {
        free: first_leap.min(FREE),
        next_leap: first_leap,
        leaps: 0,
        leapt: outcome.features,
        steps: 0,
        jumps: 0,
        mark: outcome.features,
        next_mark: FREE,
        limit: u32::MAX,
    };
    loop {
        outcome.work.steps += 1;
        seen(outcome.features);
        match look::<CERTIFY>(placed, outcome) {
            Step::Found => return true,
            Step::Move => {}
            Step::Jump => guard.jumps += 1,
            Step::Lost => return false,
        }
        guard.steps += 1;
        if guard.steps >= guard.free && guard.stops(placed, outcome) || guard.jumps > JUMPS {
            return false;
        }
    }
}

/// Ends walks that go in a circle or too far.
struct Guard {
    steps: u32,
    /// Steps before it looks.
    free: u32,
    leaps: u32,
    /// Where the last one went.
    leapt: FeaturePair,
    /// When to try a leap along a long rim, or round a large fan.
    next_leap: u32,
    jumps: u32,
    /// The pair remembered at step 8, 16, 32 and so on (Brent): to meet it again is a circle.
    mark: FeaturePair,
    next_mark: u32,
    limit: u32,
}

impl Guard {
    #[cold]
    fn stops(&mut self, placed: &Placed, outcome: &mut Outcome) -> bool {
        if self.steps == self.next_leap {
            // One that did not help is tried later again, and so is one that did: leaps are few, so the walk still ends.
            let leapt = leap(placed, outcome);
            let later = if leapt { FIRST_LEAP } else { self.steps.max(FIRST_LEAP) };
            self.leaps += 1;
            // A leap to where the last one went has nothing to add to the steps in between.
            let ends = self.leaps == LEAPS || (leapt && outcome.features == self.leapt);
            self.next_leap = if ends { u32::MAX } else { self.steps + later };
            self.leapt = outcome.features;
        }
        let next = outcome.features;
        if self.steps < FREE {
            return false;
        }
        if self.steps == FREE {
            self.limit = step_limit(placed);
        } else if next == self.mark || self.steps >= self.limit {
            return true;
        }
        if self.steps == self.next_mark {
            (self.mark, self.next_mark) = (next, 2 * self.next_mark);
        }
        false
    }
}

/// Round bodies take about sqrt(n) steps from anywhere; twice the sum of both and a constant leaves room.
#[cold]
fn step_limit(placed: &Placed) -> u32 {
    let n = placed.a.topology.vertex_count() + placed.b.topology.vertex_count();
    let round = (4.0 * sqrt(n as f64)) as u32 + 16;
    // Leaps take a walk along long rims and round large fans.
    if placed.a.has_bands | placed.b.has_bands {
        round.min(LONGEST)
    } else {
        round
    }
}
