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

use super::placed::Placed;
use super::state::{Found, State, Step};
use super::{edge_edge, vertex_edge, vertex_face, vertex_vertex};
use crate::pose::Which;
use crate::scalar::sqrt;

/// Jumps to a far face (vertex-face from behind) a walk may take: they are not monotone.
const JUMPS: u32 = 3;

/// Where a walk ended.
pub(crate) struct Walk {
    /// The last pair looked at.
    pub(crate) state: State,
    /// Its witnesses, where the Voronoi tests accept it.
    pub(crate) found: Option<Found>,
    /// Pairs looked at.
    pub(crate) steps: u32,
}

/// Looks at one state.
#[inline]
fn look<const CERTIFY: bool>(placed: &Placed, state: State) -> Step {
    let sides = |of| match of {
        Which::A => placed.a_beside_b(),
        Which::B => placed.b_beside_a(),
    };
    match state {
        State::VertexVertex { a, b } => vertex_vertex::look::<CERTIFY>(placed, a, b),
        State::VertexEdge { of, vertex, edge } => vertex_edge::look::<CERTIFY>(&sides(of), of, vertex, edge),
        State::VertexFace { of, vertex, face } => vertex_face::look::<CERTIFY>(&sides(of), of, vertex, face),
        State::EdgeEdge { a, b } => edge_edge::look::<CERTIFY>(placed, a, b),
    }
}

/// Walks from `start`; at most `4 sqrt(nA + nB) + 16` steps.
#[inline]
pub(crate) fn walk<const CERTIFY: bool>(placed: &Placed, start: State) -> Walk {
    watched::<CERTIFY>(placed, start, |_| {})
}

/// The same walk, each pair it looks at told to `seen`.
#[inline]
pub(crate) fn watched<const CERTIFY: bool>(placed: &Placed, start: State, mut seen: impl FnMut(State)) -> Walk {
    let (mut state, mut mark) = (start, start);
    let (mut jumps, mut next_mark) = (0, 8);
    let mut limit = u32::MAX;
    let mut steps = 0;
    loop {
        steps += 1;
        seen(state);
        let next = match look::<CERTIFY>(placed, state) {
            Step::Move(next) => next,
            Step::Jump(next) if jumps < JUMPS => {
                jumps += 1;
                next
            }
            Step::Found(found) => {
                return Walk {
                    state,
                    found: Some(found),
                    steps,
                };
            }
            Step::Jump(_) | Step::Lost => break,
        };
        if steps >= 8 {
            if steps == 8 {
                limit = step_limit(placed);
            }
            if next == mark || steps >= limit {
                break;
            }
            if steps == next_mark {
                (mark, next_mark) = (next, 2 * next_mark);
            }
        }
        state = next;
    }
    Walk {
        state,
        found: None,
        steps,
    }
}

/// Round bodies take about sqrt(n) steps from anywhere; twice the sum of both and a constant leaves room.
#[cold]
fn step_limit(placed: &Placed) -> u32 {
    let n = placed.a.topology.vertex_count() + placed.b.topology.vertex_count();
    (4.0 * sqrt(n as f64)) as u32 + 16
}
