//! A vertex beside an edge: the foot must lie on the edge, the vertex between the planes of the edge's faces, and the
//! foot in the region of the vertex.
//!
//! ```text
//!        x            x   the vertex, in the frame of the edge's body
//!        |  d         d   from the foot to x, orthogonal to u
//!   p ---+----> q     u   = q - p
//!  nR (right)  nL (left): d = alpha nL + beta nR with alpha = nR . (u x d), beta = -nL . (u x d), both >= 0
//! ```

use super::placed::Sides;
use super::state::{Found, State, Step};
use crate::pose::Which;
use crate::scalar::sqrt;
use crate::tolerance::{DIFFERENCE, ON_BOUNDARY};

#[inline]
pub(crate) fn look<const CERTIFY: bool>(sides: &Sides, of: Which, vertex: u32, edge: u32) -> Step {
    let Sides {
        x: body,
        y: other,
        y_from_x,
        x_from_y,
    } = *sides;
    let e = other.topology.half_edge(edge);
    let twin = other.topology.half_edge(e.twin);
    let (p, q) = (other.points[twin.to as usize], other.points[e.to as usize]);
    let x = y_from_x.point(&body.points[vertex as usize]);
    let (u, r) = (q - p, x - p);
    let size = y_from_x.size;
    let noise = DIFFERENCE * size;
    let (along, uu) = (r.dot(&u), u.norm_squared());
    let slack = noise * u.abs().sum();
    // V(p), V(q)
    if along < -slack {
        return Step::Move(State::vertices(of, vertex, twin.to));
    }
    if along > uu + slack {
        return Step::Move(State::vertices(of, vertex, e.to));
    }
    let s = (along / uu).clamp(0.0, 1.0);
    let mut d = r - u * (along / uu);
    d -= u * (d.dot(&u) / uu);
    // F(left), F(right)
    let w = u.cross(&d);
    let (left, right) = (&other.planes[e.face as usize], &other.planes[twin.face as usize]);
    let (alpha, beta) = (right.normal.dot(&w), -left.normal.dot(&w));
    if alpha < -slack || beta < -slack {
        let face = if alpha < beta { twin.face } else { e.face };
        return Step::Move(State::VertexFace { of, vertex, face });
    }
    let n = y_from_x.direction(&d);
    let fan = body.fan_minimum(vertex, &n);
    if let Some(h) = body.descent(vertex, &fan, noise) {
        return Step::Move(State::edges(of, body.topology.edge(h), edge));
    }
    let foot = p + u * s;
    let distance = sqrt((x - foot).norm_squared());
    if distance <= ON_BOUNDARY * size {
        return Step::Lost;
    }
    let lower = if CERTIFY && body.proves_lowest(&fan, &n) {
        (d.dot(&x) - other.edge_bound(&d, left, right, alpha, beta)) / sqrt(d.norm_squared()) * y_from_x.unit
    } else {
        f64::NEG_INFINITY
    };
    let distance = distance * y_from_x.unit;
    let on_x = body.points[vertex as usize];
    Step::Found(match of {
        Which::A => Found {
            normal: -x_from_y.vector(&d),
            point_a: on_x,
            point_b: foot,
            distance,
            lower,
        },
        Which::B => Found {
            normal: d,
            point_a: foot,
            point_b: on_x,
            distance,
            lower,
        },
    })
}
