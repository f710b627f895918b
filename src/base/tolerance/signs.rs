//! Bounds above which the sign of a sum of products is certain, each with its derivation.

use super::UNIT;

/// The sign of `n . e` is certain above this times the sum of the absolute terms, and
/// `LEAST_RISE`: one rounding for each coordinate of `e` (a difference of stored points), one for
/// each product and two additions, to first order `(1 + 1 + 2) UNIT`; 8 leaves room for a direction
/// that is rounded itself, for the second order and for the rounding of the bound. Underflow: case
/// D.
pub(crate) const EDGE_SIGN: f64 = 8.0 * UNIT;

/// The sign of `(n . e) (m . f) - (n . f) (m . e)` is certain above this times the sum of the
/// products of the sums of the absolute terms: each dot errs by 5 UNIT as above, each product by
/// two dots and one rounding more, the difference by one: 12; 16 leaves room. Underflow: an error
/// of a rise is multiplied by another rise, so `LEAST_RISE` is multiplied by the sums too, and
/// added once for the products.
pub(crate) const STEEPER: f64 = 16.0 * UNIT;

/// A rise below this is certain of no sign (case D). An exact direction that is rounded to f64 may
/// be off by `2^-900` of its largest coordinate beside the roundings (`exact::integer::direction`).
/// An edge is shorter than `2^107`, so three coordinates put a rise off by less than `2^-790`, and
/// underflow of three products by `2^-1073`. A rise to which the largest coordinate of a direction
/// contributes has a bound above `2^-563`, so this guard decides nothing there.
pub(crate) const LEAST_RISE: f64 = f64::from_bits((1023 - 768) << 52);

/// Four signed volumes of vertices up to L prove the origin inside if each exceeds this times UNIT
/// L^3 (UNIT of the arithmetic): a determinant of three vectors up to L has an error of at most 14
/// UNIT L^3, and vertices displaced by the `CERTIFICATE` error of the pose change the determinant
/// by three times this error: 398 in all. For vertices of very different lengths less is enough.
/// Displaced by D, the determinant changes by D times the sum of the three products of two lengths,
/// three times D^2 L, and D^3; the rounding is below 14 UNIT L times any of the products. With D =
/// 128 UNIT L the total is below the sum of the products times 512 UNIT L and L (512 UNIT L)^2. A
/// displacement common to all three vertices, as the origins of the bodies add in double-double
/// (128 UNIT times the origins), changes the determinant by no more than the product of this
/// displacement with the triangle's normal `u x v`, whose own displacement is below twice D times
/// the edges and D.
pub(crate) const VOLUME: f64 = 512.0;

/// A triangle `w0 w1 w2` of the Minkowski difference is certainly counter-clockwise from outside if
/// every `n . w` exceeds this times `|e1| |e2| L`, `n = e1 x e2` rounded: the edges err by UNIT,
/// the cross product by 2.5 UNIT more, and the dot by 3. Taken off one `n . w`, with `|e1|^2 +
/// |e2|^2` for the product, this bound leaves less than the `n . w` of any vertex, and room for the
/// rounding of `|n|`.
pub(crate) const ORIENTATION: f64 = 16.0 * UNIT;

/// Whether a direction `v` of the other body's frame rises along a unit normal is uncertain below
/// this times `|v|_1`: the direction is turned by a matrix that errs by 71 UNIT (see
/// `CERTIFICATE`), by a product with the matrix that errs by 6 and two roundings; the product
/// with the normal adds 3: 82 in all. Underflow: case S, and a direction too short to decide is
/// uncertain.
#[cfg_attr(not(feature = "exact"), allow(dead_code, reason = "the filter of the exact rung"))]
pub(crate) const EXACT_FILTER: f64 = 128.0 * UNIT;

/// The signs of the weights of `n = u x w` over the faces adjacent to two edges, `w . n'` and `u' .
/// n'` for face normals `n'` and the edges turned by a pose, are certain above this times the
/// turned edge: then `n` falls, certainly, along the inward direction `n' x e` of each face, `e`
/// its edge. With norms of 1 for all four vectors:
///
/// 1. On A: `(u x w) . (n' x u) = -(w . n') (u . u)`. The edge, a rounded difference, errs by UNIT,
///    and `u . n'` is no more; the cross product by 2.5, and 4 if orthogonalised; the dot by 3 and
///    `n'` by `NORMAL_ERROR`. Sum: below 13.
/// 2. On B, whose inward direction is `n' x w` in its own frame: a matrix that errs by 71 (see
///    `CERTIFICATE`) turns a cross product into the cross product of the turned vectors within
///    213, and keeps the right angle between `w` and `n'` within 142; the turned edges err by 7
///    each; cross product and dot as on A. Sum: below 390.
///
/// A vertex paired with an edge has one frame and no matrix: the direction `d` from the edge to the
/// vertex and `u x d` for `w` leave `(2.5 + 3 + 1.1 + 1) UNIT |u| |d|`, below `DIFFERENCE L` times
/// the 1-norm of `u`.
///
/// The part of `n` along the edges themselves is rounding, times up to `2 r`; `CERTIFICATE`
/// counts this part.
pub(crate) const FLANK: f64 = 512.0 * UNIT;

/// Error of `n . (p - a)`, `n = (b - a) x (c - a)`, all rounded, relative to the sum over k of
/// `(|u_i v_j| + |u_j v_i|) |p_k - a_k|`, `u` and `v` the edges: each of the eight roundings a term
/// passes (two differences, product and difference in n; difference, product and two sums after)
/// adds UNIT to first order, so 8 UNIT; the ninth covers the second order. Underflow: the hull adds
/// the least normal number to its bound.
pub(crate) const SIDE_ERROR: f64 = 9.0 * UNIT;

/// The bound of the error of `n . (p - a)` in double-double over that in f64 (`SIDE_ERROR`):
/// differences are exact; two products and three sums, of 5 and 3 units `2^-106` each, add up to
/// less than 20 such units, and `9 UNIT` times this are 288.
pub(crate) const SIDE_FINE: f64 = 1.0 / (1u64 << 48) as f64;

/// Error of `n . g`, `|g_k| <= 2`, and of `n . a`, for the normal of a facet of a hull of a few
/// points (`polyhedron/build/cloud.rs`), rounded from corners that are rounded themselves, relative
/// to the sums `U + W` of magnitudes of two edges. Corners are below 2, so edges are off by 6 UNIT
/// a coordinate, normals by `6 (U + W) + 3 U W`, where `U W <= 3 (U + W)`; twice three of these and
/// the sum's own rounding make 114.
pub(crate) const CORE_ERROR: f64 = 512.0 * UNIT;

/// By how much a cell of the table of `polyhedron/build/cloud.rs` is wider than it says: the shares
/// of a point have 7 UNIT of rounding; `2^-40`.
pub(crate) const CORE_CELL: f64 = 1.0 / (1u64 << 40) as f64;

/// What is left of the bound of a cell: room for the roundings of the bound, of the sum of a point
/// and of the single precision in which the bound is stored, rounded down.
pub(crate) const CORE_REACH: f64 = 1.0 - 1.0 / (1u64 << 20) as f64;

/// A foot or a crossing computed from the normal of a triangle counts as the place inside the
/// triangle that has its weights if both are nearer than this times the lengths of the two edges
/// and of the difference from which they were computed, root of the sum of squares: at most 3 L.
/// Their distance from a point then differs by at most `24 UNIT L`, for which `CERTIFICATE` has
/// room: its rows of triangles are below 104 of 128. A foot that is farther off is not used.
pub(crate) const SAME_PLACE: f64 = 8.0 * UNIT;

/// Difference of the slants of two edges along one line, rounded: `s = (g . u)^2 / u^2` with `u` a
/// difference of points over the largest of its coordinates and `g` fixed, shorter than 3/4. The
/// coordinates of `u` are off by 2 UNIT of themselves, products and sums add 3: `g . u` is off by
/// `5 UNIT |g| |u|`, and `s` by `10 UNIT |g|^2 < 6 UNIT`. Square, norm and quotient add
/// `(1 + 7 + 1) UNIT s < 6 UNIT`. Two slants: 24 UNIT, and the second order. Nothing underflows: of
/// stored points, differences are above `2^-357` and their largest coordinates below `2^107`.
pub(crate) const SLANT: f64 = 32.0 * UNIT;

/// The distance of two features in closed form (`solve::closed_form`) errs by this times
/// `UNIT_DOUBLE_DOUBLE`, L, and for heights over a plane the lengths of the two edges over that of
/// their normal: by 57 for two vertices, most of it for the placing of one by both rotations, 69
/// beside an edge, 66 over a face, and 166 for two edges, of which one is turned by both rotations.
#[cfg(feature = "exact")]
pub(crate) const CLOSED_FORM: f64 = 256.0;

/// A sign that proves features the closest is certain above this times the lengths: the direction
/// is rounded, turned by a matrix that errs by 71 (see `CERTIFICATE`), by a product with it (6),
/// and multiplied with an edge (4); or three vectors whose coordinates are rounded are multiplied
/// (10). Errors of the double-double direction itself are below `2^-17` UNIT, as `CLOSED_FORM`
/// leaves a distance only where its error is below a quarter of a unit in the last place.
#[cfg(feature = "exact")]
pub(crate) const CLEAR_SIGN: f64 = 128.0 * UNIT;

/// Error of a coordinate of an exact place that is rounded to f64 (`exact::place`), in units of the
/// largest coordinate: a bracket of at most four units in the last place, and its middle.
#[cfg(feature = "exact")]
pub(crate) const EXACT_PLACE: f64 = 8.0 * UNIT;

/// Error of `(b - a) x (p - a)` of plane coordinates, relative to the sum of the absolute products:
/// two differences, a product and the difference of two products are one rounding each, 4 UNIT; the
/// fifth covers the second order. Underflow: the caller adds the least normal number, as the
/// products of stored coordinates with a place that is no stored one may vanish.
#[cfg(feature = "exact")]
pub(crate) const TURN_ERROR: f64 = 5.0 * UNIT;

/// Error of `d . ((a - p) x (b - a))` for a direction `d` and an edge from `a` to `b`, in units of
/// the 1-norms of `a - p` and `b - a`: the direction is turned by a matrix that errs by 71 UNIT and
/// a product with it that errs by 6 (see `CERTIFICATE`); two differences, a cross product (2.5) and
/// the product with the direction (3) add 8. Sum: 85. Underflow: the caller adds the least normal
/// number.
pub(crate) const RAY_SIDE: f64 = 128.0 * UNIT;

/// Error of `n . x` for the normal `n = u x v` of a triangle and the rounded difference `x` of two
/// places, in units of the 1-norms of `u`, `v` and `x`: by `SIDE_ERROR`, 9 UNIT for either of the
/// two products of each coordinate of `n`.
pub(crate) const RAY_PLANE: f64 = 32.0 * UNIT;
