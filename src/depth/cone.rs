//! A proof of the depth by one facet: the facet and a single point deep in P = A - B hold a ball.
//!
//! Let `n` be the outward normal of a facet F of P, `r` the height of F above the origin, and let F
//! contain a disc of radius `rho` about the foot `r n` of the origin. Let `c` be a point of P.
//!
//! ```text
//!        n  ^
//!    F -----+-----+------   disc of radius rho about the foot
//!            \ r  |rho
//!             o   .         origin; every direction m at an angle up to T from n sees the disc
//!              \            at height r or more, every other direction sees c
//!               \ phi
//!                * c
//! ```
//!
//! P contains the ball of radius `r` about the origin if the support of P along every unit vector
//! `m` is at least `r`. For `m` at an angle `t` to `n`:
//!
//! * The disc is at least `r cos t + rho sin t` high, which is `r` or more if `tan(t / 2) <=
//!   rho / r`.
//! * With `phi` the angle between `c` and `-n`, `c . m >= -|c| cos(t - phi)`, which is `r` or more
//!   if `t >= phi + b`, `cos b = -r / |c|`.
//!
//! So the ball is in P if `rho >= r tan((phi + b) / 2)` and `phi + b` is less than two right angles.
//! Then the depth is `r`: the origin is at `r` beneath a supporting plane of P, and no nearer to any
//! other. Overlaps shallow beside the facet are proven like this; of all others nothing is said.

use nalgebra::Vector3;

use crate::num::scalar::{Vec3, sqrt};
use crate::pair::posed::PosedPair;
use crate::tolerance::{CERTIFICATE, CONE_LEAST, DISC, UNIT};

/// Returns the radius of a disc about the foot of the origin in a facet at this normal and height
/// that proves the depth; `None` if no disc does, or the height is not certainly positive.
pub(super) fn disc_that_proves(posed: &PosedPair, (normal, height): &(Vec3<f64>, f64)) -> Option<f64> {
    // The means of the vertices lie in the bodies, and off all sides of solid bodies.
    let c = posed.a.vertex_mean - posed.point_in_a(&posed.b.vertex_mean);
    radius(&c, &Vector3::from(*normal), *height, 2.0 * CERTIFICATE * UNIT * posed.size())
}

/// Returns the radius for a point `c` of the difference that is right up to `margin`.
fn radius(c: &Vector3<f64>, normal: &Vector3<f64>, height: f64, margin: f64) -> Option<f64> {
    let (length, along) = (sqrt(c.norm_squared()), -normal.dot(c));
    let reach = height + margin;
    // NaN proves nothing.
    if !(length > reach && along > -0.5 * length) {
        return None;
    }
    let aside = sqrt((c + normal * along).norm_squared());
    // Tangents of half of each angle.
    let (phi, b) = (aside / (length + along), sqrt((length + reach) / (length - reach)));
    let rest = 1.0 - phi * b;
    (rest > CONE_LEAST).then(|| reach * ((phi + b) / rest) * DISC + margin)
}
