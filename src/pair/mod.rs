//! Two posed shapes: their relative transform, their Minkowski difference, and the outcome of a
//! query with its certificate.
//!
//! All solvers use this module; this module uses no solver.

pub(crate) mod certificate;
pub(crate) mod difference;
pub(crate) mod draft;
pub(crate) mod face;
pub(crate) mod location;
pub(crate) mod options;
pub(crate) mod outcome;
pub(crate) mod point;
pub(crate) mod posed;
pub(crate) mod rounding;
pub(crate) mod soundness;
pub(crate) mod star;
pub(crate) mod transform;
