//! How right is an answer: bounds of the distance, proven for the placement given, rounding included.
//!
//! For any direction `n`, the bodies are at least `(min over B of n . b - max over A of n . a) / |n|` apart; any two
//! points of the bodies are at least the distance apart. The walk offers both (witnesses and their direction); the
//! certificate is that they agree. It does not ask how the pair was found, so no error of the walk survives it: a
//! cycle, a wrong end, a bad witness of nearly parallel edges all show as a gap between the bounds.
//!
//! The height of a body along `n` is had four ways, each with its proof:
//! * **face**: the plane of a face of the body, whose offset was taken over the whole body when it was built;
//! * **edge**: `n` is across it and certainly falls into both faces beside it (`is_flanked` in `closest::fan`);
//! * **two planes**, where the signs of an edge leave doubt: linear programming duality (`edge_bound` there);
//! * **vertex**: every edge of the fan certainly falls, so no neighbour and hence no vertex is higher.
//!
//! Where rounding leaves one of them open, both supports are searched for and proven ([`supports`]). The error terms
//! are in [`tolerance`](crate::tolerance).
//!
//! Source: the duality gap is that of Gilbert, Johnson and Keerthi 1988; its use as an acceptance test of a feature
//! walk is ours.

use nalgebra::Vector3;

use crate::pair::posed::PosedPair;

/// The distance of the supporting planes across `normal` (A's stored frame, any length), before its error term.
#[cold]
pub(crate) fn supports(posed: &PosedPair, normal: &Vector3<f64>, hint_a: u32, hint_b: u32) -> f64 {
    let norm = crate::num::scalar::sqrt(normal.norm_squared());
    if !(norm > 0.0) {
        return f64::NEG_INFINITY;
    }
    let n = normal / norm;
    let high_a = posed.a.support_certified(&n, hint_a).value;
    let high_b = posed.b.support_certified(&-posed.direction_in_b(&n), hint_b).value;
    posed.lift(&n) - high_a - high_b
}
