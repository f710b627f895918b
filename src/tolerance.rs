//! Every constant of the crate, each with its derivation.

/// Unit roundoff of f64: the largest relative error of one rounded operation.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// Bound of the relative error of one double-double operation (Joldes, Muller, Popescu 2017, "Tight and rigorous error
/// bounds for basic building blocks of double-word arithmetic": at most 15 UNIT^2 for the division used here, 10 UNIT^2
/// and less for the others).
pub const UNIT_DOUBLE_DOUBLE: f64 = 16.0 * UNIT * UNIT;

/// Least extent (longest side of the bounding box) of a body, in the caller's unit: cubes of lengths, as volumes are,
/// stay above the least f64.
pub const EXTENT_MIN: f64 = 1e-100;

/// Largest extent of a body: cubes of lengths stay finite.
pub const EXTENT_MAX: f64 = 1e100;

/// Bodies whose radius lies between `2^-40` and `2^40` are stored unscaled; others with a radius in [1, 2).
pub(crate) const EXPONENT_FREE: i32 = 40;

/// Stored coordinates below `2^-250` of the radius become zero. Radii are at least `2^-40`, so the last bit of any kept
/// coordinate is worth `2^(-40 - 250 - 52)` or more and a product of three differences `2^-1026`: above the least
/// f64, `2^-1074`, hence the expansions of the orientation predicates are exact.
pub(crate) const FLUSH_EXPONENT: i32 = 250;

/// Error of `n . (p - a)`, `n = (b - a) x (c - a)`, all rounded, relative to the sum over k of
/// `(|u_i v_j| + |u_j v_i|) |p_k - a_k|`, `u` and `v` the edges: each of the eight roundings a term passes (two
/// differences, product and difference in n; difference, product and two sums after) adds UNIT to first order, so 8
/// UNIT; the ninth covers the second order.
pub(crate) const SIDE_ERROR: f64 = 9.0 * UNIT;

/// Where a cross product is below `2^-40` of the products it is the difference of, double-double has lost too much
/// and expansions take over. Above it the direction errs by less than `3 * 2 * 16 UNIT^2 * 2^40 < UNIT / 64`.
pub(crate) const CROSS_CANCELLED: f64 = 1.0 / (1u64 << 40) as f64;

/// Largest distance between the stored and the true unit normal of a face: rounding a unit vector moves it by at most
/// UNIT, the computation in double-double before by less than UNIT / 32 (`CROSS_CANCELLED` and a root).
pub(crate) const NORMAL_ERROR: f64 = 1.0625 * UNIT;

/// Faces given by the caller may leave their plane by this times the diagonal of the body's box: the corners of a polygon
/// computed by a rotation and a shift err by a few UNIT each, and the plane through three of them, extrapolated, by
/// some tens.
pub const PLANARITY: f64 = 64.0 * UNIT;

/// A point of the body exactly in the plane of a face satisfies `n . p >= offset - NEAR_PLANE radius` in rounded
/// arithmetic: `n . p` errs by 4 UNIT radius at most, the tilt of the stored normal by 3 and the rounding up of the
/// offset by 5.
pub(crate) const NEAR_PLANE: f64 = 16.0 * UNIT;

/// From beyond `2^60` radii a body's closest point depends on the direction only, to `2^-60` of its size: below
/// rounding.
pub(crate) const FAR_POINT: f64 = (1u64 << 60) as f64;

/// Error of a rounded `n . (b - a)` relative to the sum of `|n_k| |b_k - a_k|`: difference, product and two sums, one
/// UNIT each; the fifth covers the second order and the rounding of the sum itself.
pub(crate) const DOT_ERROR: f64 = 5.0 * UNIT;
