//! Bounds of rounding errors of Bezier and NURBS patches, each with its derivation.
//!
//! Sums `sum of c_k w_k P_k` of a patch have factors `c_k` and weights `w_k` that are not negative.
//! If each term errs by `e` of itself, the sum errs by at most `e R sum of c_k w_k`, with R the
//! largest distance of a control point from the origin, and the denominator `sum of c_k w_k` by `e`
//! of itself: after the division the point errs by `2 e R`, and one rounding. The ratio of the
//! weights drops out. Underflow: coordinates and weights are limited ([`PATCH_MAX`],
//! [`WEIGHT_RATIO`]), case S.

use super::UNIT;

/// Largest coordinate of a control point, `2^200`, and the limits of knots.
pub(crate) const PATCH_MAX: f64 = f64::from_bits((1023 + 200) << 52);

/// Weights of a patch are no smaller than this times the largest, `2^-40`.
pub(crate) const WEIGHT_RATIO: f64 = 1.0 / (1u64 << 40) as f64;

/// Error of a point at given parameters, times R. A step of de Casteljau, `(1 - t) a + t b`, has
/// three roundings a term, and a patch of degrees up to 7 has up to 14 steps: 42 UNIT, doubled by
/// the division: 84; the product of weight and coordinate, doubled, and the division: 3 more.
pub(crate) const PATCH_POINT: f64 = 96.0 * UNIT;

/// Error of a control point of a node, times R, beside [`NET_STEP`]: the product of weight and
/// coordinate, doubled, and the division 3 UNIT, and room.
pub(crate) const NET: f64 = 4.0 * UNIT;

/// Error of a control point of a node, times R, for each step of de Casteljau since the patch
/// itself: half of a sum has one rounding, doubled by the division.
pub(crate) const NET_STEP: f64 = 2.0 * UNIT;

/// Error of a control point of a part cut out of a patch over a box of parameters, times R and the
/// sum of the degrees: two cuts in each direction, each step `(1 - t) a + t b` with three roundings
/// a term, doubled by the division.
pub(crate) const NET_CUT: f64 = 12.0 * UNIT;

/// By how much the ends of such a box, between 0 and 1, may be off: a quotient of two of them is
/// rounded once, and the difference from one once.
pub(crate) const REGION: f64 = 4.0 * UNIT;

/// Error, times R, of a triangular patch as a tensor-product patch: raising the degree of a row has
/// four roundings a term (two quotients, a product, a sum), up to six times, doubled by the
/// division: 48 UNIT, and room.
pub(crate) const RAISED: f64 = 64.0 * UNIT;

/// Error, times R, of patches taken out of a NURBS surface: a step of de Boor's algorithm has five
/// roundings a term (two differences, a quotient, a product, a sum), with up to seven steps in each
/// direction 70 UNIT, doubled by the division, and room.
pub(crate) const KNOTS: f64 = 160.0 * UNIT;

/// Error, times R, of a point of a surface at given parameters, however its patches were given.
pub(crate) const SURFACE_POINT: f64 = PATCH_POINT + if RAISED > KNOTS { RAISED } else { KNOTS };

/// Error of the distance of a point from a convex shape, in units of the largest distance of the
/// shape's points from its origin, beside the shape's own bounds and
/// [`CERTIFICATE`](super::CERTIFICATE): the relative rotation as a product of two quaternions,
/// eight roundings, normalised with eight more, twice as many for the turned vector, and room.
pub(crate) const SHAPE_POINT: f64 = 64.0 * UNIT;

/// Corners of two borders closer than this times the size of the surface are the same corner: both
/// err by [`KNOTS`] or [`RAISED`], and control points of one surface computed twice by some tens of
/// UNIT. Steers what is reported as closed, no bound.
pub(crate) const SEAM: f64 = 1024.0 * UNIT;

/// Error of a height over a node by its second derivatives, in UNIT times `(p + q)^2` times the
/// largest coefficient G. With `d = p + q` and UNIT G as the unit:
///
/// 1. Each second difference of coefficients has two roundings of numbers up to 3 G and 4 G, and
///    the two products with its factor one each of 4 G: 15 times the factor, at most 42 of degrees
///    7 and 1, so below `10 d^2`. This is added to each of the three bounds before use
///    ([`CURVATURE`]), so that their signs can be trusted.
/// 2. The value by de Casteljau: `3 d`. A first derivative: differences up to 2 G with one
///    rounding, `3 d` roundings each, times p or q: both together `6 d^2 + 2 d`.
/// 3. The sums of the three bounds, numbers up to `4 d^2 G`, have up to four roundings each:
///    `16 d^2`. The quotients, which may be larger, are rounded up; beside a first derivative they
///    matter only as far as they are no larger than that.
///
/// Together below `24 d^2 + 5 d`, and d is at least 2.
pub(crate) const TAYLOR: f64 = 32.0 * UNIT;

/// Step 1 of [`TAYLOR`].
pub(crate) const CURVATURE: f64 = 12.0 * UNIT;

/// Error of a coefficient of a height, `n . N - c w`, times R and the weight: the dot product three
/// UNIT, the product with c, at most R, two, and the difference two.
pub(crate) const COEFFICIENT: f64 = 8.0 * UNIT;

/// Error of a coefficient of a height above a bowl (`patch::bowl`), times the denominator's
/// coefficient, R and the distance of the point of contact from the origin. Where the gradient of
/// the quadratic part is at most one, that part is no larger than the height; a larger gradient
/// multiplies the error. A term of the numerator passes 50 roundings: two of the shift by the point
/// of contact, those of the products with directions, form, weight and binomials, and the sums of
/// up to 16 terms; one of the denominator passes 20, and the quotient adds one. The quadratic part
/// is half as large again. The orthogonality of the directions is off by six UNIT: 113 in all.
pub(crate) const BENT: f64 = 128.0 * UNIT;

/// Gradient of the quadratic part of a bowl over a node, at most: errors of points grow by one more
/// than that.
pub(crate) const SLOPE: f64 = 4.0;

/// Effect of the error of a pose on the heights of both bodies above a bowl: on each body twice,
/// by its points and by the point of contact, as gradients up to `1 + SLOPE` carry it.
pub(crate) const BENT_POSE: f64 = 4.0 * (1.0 + SLOPE);

/// A pair on a front claims its gap less this times the size L at each of the two poses: the claim
/// is a sum of heights of points of B's frame, [`CERTIFICATE`](super::CERTIFICATE) UNIT L at each
/// pose, and the turn of a direction times the radius of a ball, 80 UNIT L at each pose.
pub(crate) const CARRIED: f64 = 256.0 * UNIT;

/// Intervals of two surfaces are not asked to be narrower than this times the size L, `2^-42`: the
/// errors of both bounds are about [`CERTIFICATE`](super::CERTIFICATE) UNIT L each, those of points
/// 256 UNIT L at most, those of nodes split forty times as much, and those of second derivatives
/// some 1,000 UNIT times the size of a node.
pub(crate) const PATCH_LIMIT: f64 = 1.0 / (1u64 << 42) as f64;

/// Error of a first derivative of a patch, times its bound `3 d R omega` (`patch::crossing`): the
/// differences of control points and up to 14 steps of three roundings are 45 UNIT, each of
/// numerator and denominator and of the point that multiplies the derivative of the denominator,
/// times omega (counted in the bound); the turn into the other frame 80 UNIT. A product with the
/// inverse adds some UNIT. Room by a factor of two.
pub(crate) const PATCH_SLOPE: f64 = 512.0 * UNIT;
