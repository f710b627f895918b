//! The solver that stands in for the walk: the minimum-norm point of the Minkowski difference A - B.
//!
//! Gilbert, Johnson and Keerthi 1988, in f64 and in double-double. Departures:
//! 1. It starts from the features the walk ended on, so a few supports settle most cases.
//! 2. The direction of a triangle is its normal and that of an edge is orthogonalised once more (never the rounded
//!    nearest point), so the last support is also the certificate.
//! 3. Supports are proven (see [`ConvexPolyhedron::highest`]); it ends where the support is in the simplex already or
//!    nothing is gained, and what it then knows are bounds.
//! 4. Origin inside means four signed volumes beyond rounding: a proof of overlap.
//!
//! [`ConvexPolyhedron::highest`]: crate::ConvexPolyhedron

use crate::minimum::simplex::Simplex;
use crate::num::scalar::{Scalar, Vec3, dot, neg, root};
use crate::pair::difference::{difference_point, support};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::FeaturePair;
use crate::tolerance::{ON_BOUNDARY, UNIT};
use crate::tuning::minimum::SUPPORTS;

/// Where a solve ended.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Minimum<T> {
    /// The origin is outside, or on the surface up to rounding: `direction . w / |direction|` is at least `lower` over
    /// the whole difference (its error term still to be taken off).
    Outside {
        simplex: Simplex<T>,
        lower: T,
        direction: Vec3<T>,
    },
    /// The tetrahedron holds the origin, proven.
    Inside { simplex: Simplex<T> },
}

/// Solves from a vertex of each feature.
pub(crate) fn solve<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, from: FeaturePair) -> Minimum<T> {
    let (a, b) = from.vertices_of(posed.a, posed.b);
    let reach = posed.reach::<T>();
    let touches = T::from(ON_BOUNDARY * T::UNIT / UNIT * reach.whole());
    let mut simplex = Simplex::vertex(difference_point(posed, frame, a, b));
    let (mut lower, mut direction) = (T::from(f64::NEG_INFINITY), simplex.direction());
    for _ in 0..SUPPORTS {
        let d = simplex.direction();
        let norm_squared = dot(&d, &d);
        if !(simplex.squared() > touches * touches) || !(norm_squared > T::from(0.0)) {
            break;
        }
        let (hint, toward) = (simplex.kept()[simplex.len() - 1], neg(&d));
        let c = support(posed, frame, &toward, &hint);
        let height = dot(&d, &c.w) / root(norm_squared);
        if height > lower {
            (lower, direction) = (height, d);
        }
        if simplex.holds(c.a, c.b) || !simplex.add(c, reach) {
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
