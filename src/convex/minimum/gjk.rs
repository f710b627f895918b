//! GJK: the minimum-norm point of the Minkowski difference A - B, by the solver that stands in for
//! the walk.
//!
//! Gilbert, Johnson and Keerthi 1988, in f64 and in double-double. Departures:
//! 1. The solver starts from the features on which the walk ended
//!    ([`start`](crate::convex::minimum::start)), so one support or a few settle most cases.
//! 2. The direction of a triangle is the normal, and the direction of an edge is orthogonalised
//!    once more (never the rounded nearest point), so the last support is also the certificate.
//! 3. Supports are proven (see [`support`]). The solver ends if the support is in the simplex
//!    already or nothing is gained, and then returns bounds.
//! 4. Origin inside means four signed volumes beyond rounding: a proof of overlap.

use crate::base::num::scalar::{Scalar, Vec3, dot, neg, root};
use crate::base::tolerance::{ON_BOUNDARY, UNIT};
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::support;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Support points of one solve, at most. Measured: right answers took at most 24, and some 90 if
/// nearly parallel faces of 32,768 vertices lie boundary over boundary.
const SUPPORTS: u32 = 256;

/// Result of a solve.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Minimum<T> {
    /// The origin is outside, or on the surface up to rounding: `direction . w / |direction|` is at
    /// least `lower` over the whole difference (before the error term).
    Outside {
        simplex: Simplex<T>,
        lower: T,
        direction: Vec3<T>,
    },
    /// The tetrahedron contains the origin, proven.
    Inside { simplex: Simplex<T> },
}

/// Solves from a simplex of points of the difference.
pub(crate) fn solve<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, mut simplex: Simplex<T>) -> Minimum<T> {
    let scale = posed.error_scale::<T>();
    let touches = T::from(ON_BOUNDARY * T::UNIT / UNIT * scale.total());
    let (mut lower, mut direction) = (T::from(f64::NEG_INFINITY), simplex.direction());
    for _ in 0..SUPPORTS {
        let d = simplex.direction();
        let norm_squared = dot(&d, &d);
        if !(simplex.squared_distance() > touches * touches) || !(norm_squared > T::from(0.0)) {
            break;
        }
        let (hint, toward) = (simplex.points()[simplex.len() - 1], neg(&d));
        let c = support(posed, frame, &toward, &hint);
        let reach = dot(&d, &c.w);
        let height = reach / root(norm_squared);
        if height > lower {
            (lower, direction) = (height, d);
        }
        // The support is no closer than the simplex: another vertex of the same face, for example.
        let is_closest = simplex.points().iter().all(|p| dot(&d, &p.w) <= reach);
        if is_closest || simplex.contains(c.a, c.b) || !simplex.add(c, scale) {
            break;
        }
        if simplex.len() == 4 {
            return Minimum::Inside { simplex };
        }
    }
    Minimum::Outside {
        simplex,
        lower,
        direction,
    }
}
