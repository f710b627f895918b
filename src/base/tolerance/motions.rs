//! Bounds of rounding errors of motions, impacts and composites, each with its derivation.

use super::{POSE_UNIT, UNIT, UNIT_SINGLE};

/// Error of the posed pivot of a body on a motion, twice (once at the begin of a bound, once at the
/// end), in units of the 1-norms of the pivot's position at time zero, and of the displacements by
/// velocity and acceleration until then: `v t` has one rounding, `a t^2 / 2` three, their sums two,
/// the last difference one, and the velocity at a later time two more times the displacement: 6
/// UNIT.
pub(crate) const PLACED_CENTRE: f64 = 16.0 * UNIT;

/// Error of the posed pivot, twice, in units of the distance of the pivot from the body's own
/// origin: a product with a quaternion whose square is off 1 by 26 UNIT is off by twice as much,
/// and rounded by 24; the difference adds 1. Twice 77.
pub(crate) const PLACED_PIVOT: f64 = 192.0 * UNIT;

/// Error of the angle of a posed body on a motion, twice. The quaternion of a turn: sine and cosine
/// err by less than one in the last place, UNIT; the correction for the remainder of the half
/// angle, UNIT; the axis by 2 UNIT and its product by one: 5.4 UNIT as a vector. The product with
/// the first rotation: 4 UNIT a coordinate, 8 as a vector. An error of a quaternion turns by twice
/// as much: 27 UNIT. A normalised sum of two quaternions: 3 UNIT a coordinate of numbers up to one,
/// over a norm of at least `1 / sqrt 2`: 9 UNIT and, for the part of the way itself, one more: 20
/// UNIT.
pub(crate) const TURN: f64 = 64.0 * UNIT;

/// Deviation of the squared norm of a quaternion that was divided by its norm: the square errs by 4
/// UNIT, the root by half of that and UNIT, the quotient by UNIT: 8 of the square, and 4 of the
/// square taken anew.
#[cfg(feature = "serde")]
pub(crate) const NORMALISED: f64 = 16.0 * UNIT;

/// Error of the coefficients of a plane's gap (`separation::plane`), times `(1 + q)^2` with q the
/// angle that a direction turns by as a shape sees it, in units of both reaches, the ways of the
/// pivots, the difference of the translations, and twice the distances of the pivots from the
/// origins (u = UNIT):
///
/// 1. Directions: derivatives are sums of at most three cross products, 8 u of `(|eta| + |w|)^2`,
///    and the control points two sums and products more: 12 u. Into the body: the matrix of one
///    quaternion 27 u (19 for its entries, 8 for the square of its norm), the product 6 u. Heights
///    over the arm of a pivot 3 u. Together 48 u of the reach.
/// 2. The pivots: a product with that matrix 33 u, two sums 2 u; the difference of the translations
///    u. Products with the normal and with its derivatives 9 u.
/// 3. Sums of at most five terms, and from square to cube, 8 u; the length of the normal, 3 u,
///    times the distance to keep.
///
/// Of a plane that keeps its normal (`separation::fixed_normal`), what turns give to points along
/// the normal errs by 9 u of itself: the length of the cross product 2.5 u beyond [`TILT`], the
/// reach 3 u, products and sums 3.5 u.
pub(crate) const PLANE: f64 = 64.0 * UNIT;

/// Error of the length of a cross product of a unit vector with another, in units of the length of
/// the other: the product errs by 2.5 UNIT, the difference of two rates by 1, the unit vector,
/// turned into the world, is longer than one by less than 4.
pub(crate) const TILT: f64 = 8.0 * UNIT;

/// Error of the coefficients of a cubic that is cut four times: each cut is three rounds of two
/// products and a sum, 3 UNIT each, so 36 UNIT of the largest.
pub(crate) const BERNSTEIN: f64 = 64.0 * UNIT;

/// Relative error of a root: a position between two coefficients errs by at most 8 UNIT of itself,
/// a position composed of four parts by as much again; and a time composed of a start and such a
/// part of an interval, by less than the rest.
pub(crate) const ROOT: f64 = 32.0 * UNIT;

/// Error of the height of a polyhedron, in units of the 1-norm of the direction and of its radius:
/// the product with a vertex errs by 3 UNIT, the product with the centre of the ball by as much,
/// the difference by 1, the sum with this bound by 1; the ninth covers the second order.
pub(crate) const HEIGHT: f64 = 9.0 * UNIT;

/// Squares and products of the flight of two balls err by at most 10 UNIT of the squares of their
/// distance and of the sum of their radii; this much, `2^-40`, is counted to the square of the
/// radii, and settles the signs and the root that follow.
pub(crate) const BALLS: f64 = 1.0 / (1u64 << 40) as f64;

/// Relative reduction of a number of ticks, `2^-30`: a quotient errs by UNIT, and a clock that adds
/// up ticks by UNIT a tick, with fewer than `2^20` ticks in any useful bound.
pub(crate) const TICK: f64 = 1.0 / (1u64 << 30) as f64;

/// Increase of the half extents of a box of a composite before rounding up to f32, in units of the
/// tree's size (2 at most, counted in) and of the farthest coordinate over it: a vertex shifted to
/// the tree's origin errs by UNIT of that coordinate; its difference from the centre by UNIT; a
/// dual axis, of stored axes that are orthonormal within 8 UNIT_SINGLE, by 8 UNIT (a cross product
/// 3, a determinant 4, a quotient 1), and the product with it by 3: all of lengths up to 4. Sum:
/// below 4 (1 + 8 + 3) + 2.
pub(crate) const BOX_EXTENT: f64 = 64.0 * UNIT;

/// Error of the height of a vertex over the centre of a box that is fitted anew, along an axis of
/// the box, in units of the farthest vertex's distance from the tree's origin, with v =
/// UNIT_SINGLE: the place of the vertex is rounded, v of it; a sum of three products errs by 3 v of
/// the product of the lengths, and the axis is longer than one by 2 v. The centre, which three
/// heights put together, is at most sqrt 3 as far, and exact as stored: its height errs by 3 sqrt 3
/// v; the difference of both by 1 + sqrt 3. Sum: below 12 v.
pub(crate) const REFIT_HEIGHT: f64 = 16.0 * UNIT_SINGLE;

/// Largest deviation of the products of the axes of a box that is fitted anew from those of
/// orthonormal vectors: axes are rounded once, or kept as the build left them, within 8
/// UNIT_SINGLE; the quotient by `1 - 24 UNIT_SINGLE` and roundings in double precision add far less
/// than a hundredth.
pub(crate) const BOX_SKEW: f64 = 9.0 * UNIT_SINGLE;

/// Error of a gap of two boxes of a composite in f32, in units of their pair's size L: the reaches
/// of both trees and the distance of their origins. With v = UNIT_SINGLE, `r` a box's reach, `h`
/// its half extents (`|h| <= sqrt(3) r`):
///
/// 1. The matrix and the shift are rounded once: 1.8 v of lengths of B, v of the shift. A product
///    with the matrix adds `3 sqrt(3)` v: axes of B err by 7 v, its centre by 7 v r; two sums more,
///    so the difference of the centres by 10 v L.
/// 2. Along the line of centres: the length errs by 10 v L and 4 v of itself; `h . |a . d|` by the
///    10 v of the difference, 3 of the product, 3 of the sum and 2 of the quotient, times `h` of A;
///    the same and 7 for the axes of B. The direction as rounded is longer than one by 4 v at most.
///    Sum: below 14 L + 18 sqrt(3) rA + 25 sqrt(3) rB, with rA + rB <= L: below 58 v L.
/// 3. Along an excess vector e: products of axes err by 10 v each, by `30 v` as a matrix; `e . d`
///    by 16 v L |e|; the box's own part by 7 v h for axes that are orthonormal within 2 v, and 4
///    more; the part of the other box by 33 v h; the root and the quotient by 5 v. Sum: below 16 L
///    + 11 sqrt(3) rA + 33 sqrt(3) rB + 5 L, below 79 v L.
/// 4. Along a direction c of any length, a cross product of axes or a direction known before: the
///    gap along it is a proof whatever c is, so only the arithmetic behind c counts, in units of
///    `|c|`. The height errs by 10 v L of the difference and 3 v L of its product. The reach of A
///    errs by 3 v of the sum of its half extents, at most 3 rA, and by 3 v of itself, at most
///    sqrt(3) rA; that of B by 7 v more for the axes. Two differences of terms up to sqrt(3) L err
///    by 4 v L, the root and the quotient by 5 v of as much, and the direction as rounded is longer
///    than one by 5 v. Sum: 31 L + 15 rA + 36 rB, below 67 v L.
/// 5. An entry of a front. Made: the placed centre errs by 10 v L, its product with n by 4 v L, the
///    base by 4 v L; a direction turned to the other body's frame by 7 v, which moves heights by 7
///    v L and makes the direction longer than one by as much. Tested: centre and product as before;
///    the turned directions err by 7 v each, their difference and its length, at most 2, by 8 v: 30
///    v r with the product by the radius; the sums by 4 v L. The radius is that of the smaller
///    node, at most L / 2. Sum: below 65 v L.
/// 6. An entry with a segment, of half length `|u| <= r`, and a radius up to r / 2: the product of
///    the difference, which errs by 16 v, with u, which errs by v of itself, errs by 24 v r in all,
///    the product with the radius by 15 v r, one sum more by 2 v L. Sum: 52 L + 39 r, below 72 v L.
///
/// 80 would do.
pub(crate) const BOXES: f64 = 96.0 * UNIT_SINGLE;

/// Square of the sine of the angle of two axes up to which their cross product in f32 is mostly
/// rounding, 10 UNIT_SINGLE: below 128 UNIT_SINGLE. Not a matter of soundness: the bound along any
/// direction holds.
pub(crate) const PARALLEL_SIDES: f64 = (128.0 * UNIT_SINGLE) * (128.0 * UNIT_SINGLE);

/// Error of a height of a vertex of a composite along a unit axis, in units of the farthest
/// vertex's distance from the origin: a sum of three products errs by 3 UNIT, an axis longer than
/// one by 4 UNIT counts by as much. Twice that is the error of a point put together from its
/// heights along three axes that are normalised within 4 UNIT and perpendicular within 6.
pub(crate) const SLAB_HEIGHT: f64 = 12.0 * UNIT;

/// How far a vertex of a placed piece may be off its place, in units of its distance from the
/// origin of the piece plus the length of the translation. The quaternion is normalised: its
/// squared norm differs from one by 8 UNIT (four squares and three sums, half of it by the root,
/// and the quotient), which turns and stretches the rotated vector by up to twice that, 16 UNIT.
/// The vector is `v + 2 w (q x v) + 2 q x (q x v)`: a cross product errs by `2 sqrt(2)` UNIT of the
/// product of the lengths, so the first by 5.7 UNIT with the factor, the second, of a vector up to
/// `2 |v|`, by as much of its own and of the first one's error, the product with w by 2, and the
/// sums of terms up to `2 |v|` by 7: 26.1 UNIT. The translation adds UNIT of the sum. Sum: 43.1.
pub(crate) const PLACED: f64 = 64.0 * UNIT;

/// Largest shortfall of a gap in f64 below the distance, in units of L, at which a pair of nodes or
/// triangles of a composite still passes: pairs in flush contact are all equally far, up to
/// rounding, and no pair could be skipped. With [`CERTIFICATE`](super::CERTIFICATE) above and
/// below, the bounds are no wider than `512 + 2 * 128 = 768` UNIT L, less than `1e-13 L`, 900.
pub(crate) const SHORT_OF: f64 = 512.0 * UNIT;

/// Error of the place of a ball's middle by a pose of the caller, in units of the 1-norm of the
/// middle in the body's frame: a quaternion whose square is off one by [`POSE_UNIT`] puts it off by
/// twice as much, and is rounded by some thirty UNIT, far less than the rest.
pub(crate) const PLACED_BALL: f64 = 3.0 * POSE_UNIT;

/// Error of the part of a ray in a ball, in units of the radius and the absolute coordinates of the
/// ray's origin and of the ball's middle, whose own place is counted by [`PLACED_BALL`]: the
/// difference, the product with the direction, which is of unit length within 4 UNIT, the foot, its
/// length and the sums err by 34 UNIT together. A height of a place of the ray in a mesh's frame
/// along a unit vector, minus that of a corner, errs by 46: the place, a relative translation, by
/// 31 (see [`CERTIFICATE`](super::CERTIFICATE)), and by 4 of the direction; products, the
/// difference and the vector's length by the rest.
pub(crate) const RAY: f64 = 64.0 * UNIT;

/// Doubt of the gap of two sets of vertices on straight paths along a direction `n`, in units of
/// the sum of the magnitudes of n's coordinates, with coordinates below one (`continuous::paths`).
/// A coordinate at an instant errs by 3.5 UNIT: the difference from the first vertex by one, the
/// share of the time by a half, two products and their sum by two. A height adds 3 for product and
/// sums, as every term passes three roundings; two heights 13, their difference, up to two, 2 more,
/// and the product with the sum of magnitudes 3 of itself. Directions whose sum is below
/// [`PATH_DIRECTION`] are not used, so that underflow of products does not count.
pub(crate) const PATH_GAP: f64 = 24.0 * UNIT;

/// Least sum of the magnitudes of a direction that is used on straight paths, `2^-200`; the inverse
/// is the largest.
pub(crate) const PATH_DIRECTION: f64 = f64::from_bits((1023 - 200) << 52);

/// Doubt of six times the volume of four vertices on straight paths, coordinates below one, one
/// vertex the origin, and of the Bernstein coefficients of that cubic: six products of three
/// coordinates, each coordinate off by 4 UNIT (see [`PATH_GAP`]), 72 UNIT; a term passes two
/// products, a difference and two sums, 30 UNIT; the sum of three such volumes and their division
/// by three add 3 UNIT of six, 18. Sum: 120.
pub(crate) const PATH_VOLUME: f64 = 160.0 * UNIT;

/// Doubt of the Bernstein coefficients of `(u x v) . n`, with u and v differences of two vertices
/// on straight paths, coordinates below one, in units of the sum of the magnitudes of n's
/// coordinates: a difference, up to two, errs by 8 UNIT (see [`PATH_GAP`]) and its rounding by 2; a
/// product of two by 40 UNIT and 4; the difference of two products by 88 and 8; the mean of two
/// such by 8 more; products with n and sums by three roundings of eight, 24. Sum: 128.
pub(crate) const PATH_AREA: f64 = 160.0 * UNIT;
