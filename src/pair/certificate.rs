//! The certificate: bounds of the distance, proven for the given pose, rounding included.
//!
//! ```text
//!     supporting planes        n     direction from A to B
//!      ____|          |____    p, q  witnesses, points of A and B
//!     /    |          |    \   |p - q| is an upper bound of the distance
//!    |  A p|   n -->  |q B  |  (min over B of n . b - max over A of n . a) / |n|, the distance of
//!     \____|          |____/   the supporting planes, is a lower bound
//! ```
//!
//! For any direction `n`, the distance is at least the lower bound. For any two points of the
//! bodies, the distance is at most the upper bound. The walk proposes both: the witnesses, and the
//! direction between them. The certificate is the agreement of the two bounds. How the pair was
//! found does not matter, so no error of the walk survives. A cycle, a wrong end, or a bad witness
//! of nearly parallel edges appears as a gap between the bounds.
//!
//! The support value of a body along `n` is proven in four ways:
//! * **face**: the plane of a face of the body; its offset was computed over the whole body when
//!   the body was built;
//! * **edge**: `n` is perpendicular to the edge and certainly falls into both adjacent faces
//!   ([`falls_into_both_faces`](super::star::falls_into_both_faces));
//! * **two planes**, if rounding leaves the signs of an edge in doubt: linear programming duality
//!   ([`edge_bound`](crate::ConvexPolyhedron::edge_bound));
//! * **vertex**: every edge of the fan certainly falls, so no adjacent vertex is higher along `n`,
//!   and hence no vertex is.
//!
//! If rounding leaves one support value unproven, both are searched and proven
//! ([`support_distance`]). The error terms are in `tolerance`.
//!
//! Source: the duality gap of Gilbert, Johnson and Keerthi 1988. Its use as an acceptance test of a
//! feature walk is ours.

use crate::body::polyhedron::VertexId;
use nalgebra::Vector3;

use crate::pair::posed::PosedPair;

/// Returns the distance of the supporting planes perpendicular to `normal`: a lower bound of the
/// distance, before the error term.
///
/// `normal` is in A's stored frame and of any length.
#[cold]
pub(crate) fn support_distance(posed: &PosedPair, normal: &Vector3<f64>, hint_a: VertexId, hint_b: VertexId) -> f64 {
    let norm = crate::base::num::scalar::sqrt(normal.norm_squared());
    if !(norm > 0.0) {
        return f64::NEG_INFINITY;
    }
    let n = normal / norm;
    let high_a = posed.a.support_certified(&n, hint_a).value;
    let high_b = posed.b.support_certified(&-posed.direction_in_b(&n), hint_b).value;
    posed.height_of_b_origin(&n) - high_a - high_b
}
