//! Every constant of the crate, each with its derivation.

/// Unit roundoff of f64: the largest relative error of one rounded operation.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// Bound of the relative error of one double-double operation (Joldes, Muller, Popescu 2017, "Tight and rigorous error
/// bounds for basic building blocks of double-word arithmetic": at most 15 UNIT^2 for the division used here, 10 UNIT^2
/// and less for the others).
pub const UNIT_DOUBLE_DOUBLE: f64 = 16.0 * UNIT * UNIT;
