//! The seam between a curved core and a shape, and the match of a core.

use nalgebra::Vector3;

use super::{Mass, Support};
use crate::base::num::fingerprint::Fingerprint;

/// A core with curved sides: what a shape asks besides support points.
pub(crate) trait Curved: Support + Copy {
    /// Place of the kind in the order in which a pair is solved: polyhedra, of place 0, come first.
    const ORDER: u32;

    /// Returns the fingerprint of kind and parameters.
    fn fingerprint(&self) -> Fingerprint;

    /// Returns the core with all lengths multiplied by a power of two.
    fn scaled(&self, by: f64) -> Self;

    /// Returns whether the closed core contains a point, up to rounding.
    fn contains(&self, point: &Vector3<f64>) -> bool;

    /// Returns the mass properties at unit density.
    fn mass(&self) -> Mass;
}

/// Returns the place of the kind of a curved core in the order in which a pair is solved.
pub(crate) fn order_of<C: Curved>(_: &C) -> u32 {
    C::ORDER
}

/// Matches a core: an expression for the polyhedron, and one for every kind of [`Curved`] core.
macro_rules! match_core {
    ($core:expr, $body:pat => $polyhedral:expr, $curved:pat => $round:expr) => {
        match $core {
            Core::Polyhedron($body) => $polyhedral,
            Core::Ellipsoid($curved) => $round,
            Core::Cylinder($curved) => $round,
            Core::Cone($curved) => $round,
            Core::Superquadric($curved) => $round,
        }
    };
}

pub(crate) use match_core;
