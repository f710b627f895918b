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

use super::placed::{OfA, OfB, Placed};
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
    /// Whether the Voronoi tests accept it.
    pub(crate) ended: bool,
    /// Pairs looked at.
    pub(crate) steps: u32,
}

/// Looks at one state.
#[inline]
fn look<const CERTIFY: bool>(placed: &Placed, state: State, found: &mut Found) -> Step {
    match state {
        State::EdgeEdge { a, b } => edge_edge::look::<CERTIFY>(placed, a, b, found),
        State::VertexFace {
            of: Which::A,
            vertex,
            face,
        } => vertex_face::look::<CERTIFY, _>(&OfA(placed), vertex, face, found),
        State::VertexFace {
            of: Which::B,
            vertex,
            face,
        } => vertex_face::look::<CERTIFY, _>(&OfB(placed), vertex, face, found),
        State::VertexEdge {
            of: Which::A,
            vertex,
            edge,
        } => vertex_edge::look::<CERTIFY, _>(&OfA(placed), vertex, edge, found),
        State::VertexEdge {
            of: Which::B,
            vertex,
            edge,
        } => vertex_edge::look::<CERTIFY, _>(&OfB(placed), vertex, edge, found),
        State::VertexVertex { a, b } => vertex_vertex::look::<CERTIFY>(placed, a, b, found),
    }
}

/// Walks from `start`; at most `4 sqrt(nA + nB) + 16` steps.
#[inline]
pub(crate) fn walk<const CERTIFY: bool>(placed: &Placed, start: State, found: &mut Found) -> Walk {
    let (mut state, mut mark) = (start, start);
    let (mut jumps, mut next_mark) = (0, 8);
    let mut limit = u32::MAX;
    let mut steps = 0;
    loop {
        steps += 1;
        let next = match look::<CERTIFY>(placed, state, found) {
            Step::Move(next) => next,
            Step::Jump(next) if jumps < JUMPS => {
                jumps += 1;
                next
            }
            Step::Found => {
                return Walk {
                    state,
                    ended: true,
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
        ended: false,
        steps,
    }
}

/// Round bodies take about sqrt(n) steps from anywhere; twice the sum of both and a constant leaves room.
#[cold]
fn step_limit(placed: &Placed) -> u32 {
    let n = placed.a.topology.vertex_count() + placed.b.topology.vertex_count();
    (4.0 * sqrt(n as f64)) as u32 + 16
}
