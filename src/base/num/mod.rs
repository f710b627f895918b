//! The arithmetic: scalars of the solvers, double-double, packed vectors and exact signs;
//! counters, ranks of heaps, and the fingerprints of numbers.

pub(crate) mod count;
pub(crate) mod double_double;
pub(crate) mod extremes;
pub(crate) mod fingerprint;
pub(crate) mod packed;
pub(crate) mod ranked;
pub(crate) mod scalar;
pub(crate) mod sign;
