//! The arithmetic: scalars of the solvers, double-double, packed vectors and exact signs.

pub(crate) mod double_double;
pub(crate) mod packed;
pub(crate) mod scalar;
pub(crate) mod sign;
