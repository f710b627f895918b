//! Cold start of a walk, without a cached pair: two vertices that face each other.
//!
//! For flat bodies, two ellipsoids replace the bodies and are scaled until they touch. The
//! direction of the start is the normal at the touching point ([`direction`]).
//!
//! Perram and Wertheim 1985, "Statistical mechanics of hard ellipsoids": with P and Q the matrices
//! of the ellipsoids and c the vector between the centres, the normal at the touching point is
//! `x = ((1 - s) P + s Q)^-1 c` for the `s` in 0..1 at which `(1 - s)^2 x P x = s^2 x Q x`. Hence
//! `s = p / (p + q)` with `p = sqrt(x P x)` and `q = sqrt(x Q x)`, the heights of the ellipsoids
//! along x.
//!
//! For flat bodies the line of centres is a poor direction. The ellipsoids show the sides that face
//! each other, at a cost that does not depend on the size of the bodies. The direction is only a
//! start and proves nothing, so a few iterations of the last equation are enough.

use nalgebra::{Matrix3, Vector3};

use crate::base::num::scalar::{magnitude, sqrt};
use crate::base::pose::Operand;
use crate::body::polyhedron::FeaturePair;
use crate::pair::outcome::Work;
use crate::pair::posed::PosedPair;

/// Returns the cold start: the support vertices (cube map and hill climb) along the line of
/// centres, on round bodies a few steps from the closest features. If a body is flat, the direction
/// is the normal of two touching ellipsoids instead ([`direction`]).
pub(crate) fn cold(posed: &PosedPair, work: &mut Work) -> FeaturePair {
    let n = if posed.a.seems_flat || posed.b.seems_flat {
        work.ellipsoids += 1;
        direction(posed)
    } else {
        posed.point_in_a(&posed.b.center()) - posed.a.center()
    };
    let a = posed.a.support_cold(&n);
    let b = posed.b.support_cold(&-posed.direction_in_b(&n));
    FeaturePair::vertices(Operand::A, a, b)
}

/// Number of iterations of the fixed-point equation for the touching ellipsoids. More give a better
/// first direction but take time.
const ROUNDS: usize = 6;

/// Returns the direction from A to B, in A's stored frame.
pub(super) fn direction(posed: &PosedPair) -> Vector3<f64> {
    let c = posed.point_in_a(&posed.b.vertex_mean) - posed.a.vertex_mean;
    let (p, q) = (posed.a.covariance3, posed.covariance_of_b());
    let (mut s, mut x) = (0.5, c);
    for _ in 0..ROUNDS {
        let Some(next) = solve(&(p * (1.0 - s) + q * s), &c) else {
            return x;
        };
        // Scaled exactly: `next` is a product of five lengths, its squared heights of twelve.
        x = next / magnitude(next.amax());
        let (h, k) = (sqrt(x.dot(&(p * x))), sqrt(x.dot(&(q * x))));
        s = h / (h + k);
    }
    x
}

/// Solves `matrix x = right` by Cramer's rule, up to a positive factor; `None` if the determinant
/// is not positive.
fn solve(matrix: &Matrix3<f64>, right: &Vector3<f64>) -> Option<Vector3<f64>> {
    let (a, b, c) = (
        matrix.column(0).into_owned(),
        matrix.column(1).into_owned(),
        matrix.column(2).into_owned(),
    );
    let bc = b.cross(&c);
    (a.dot(&bc) > 0.0).then(|| Vector3::new(right.dot(&bc), right.dot(&c.cross(&a)), right.dot(&a.cross(&b))))
}
