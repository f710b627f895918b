//! Bounds of rounding errors of robot motions. the module `tolerance` of lin-canny gives the rules of their
//! derivations.

use lin_canny::POSE_UNIT;

/// Unit roundoff of f64.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Error of a ball at a pose, or of a side of the box of a motion, in units of the sum of the radii
/// and the absolute coordinates of the positions.
///
/// A point that is transformed by a quaternion errs by 33 UNIT, by the derivation of the relative
/// pose. Two sums and a norm of three squares err by 6.
pub(crate) const PLACED: f64 = 64.0 * UNIT;

/// Error of the position of a ball's centre by the pose of a body, in units of the 1-norm of the
/// centre in the body's frame.
///
/// The caller may give the pose. If the squared norm of its quaternion differs from one by
/// [`POSE_UNIT`], the position errs by twice as much. The rest is reserve.
pub(crate) const PLACED_BALL: f64 = 3.0 * POSE_UNIT;

/// Error of the angle of a link of an arm by one joint.
///
/// As a vector of a quaternion, the product with the fixed rotation of the joint's frame errs by 8
/// UNIT, the quaternion of the joint's value by 5.4 (see `TURN` of the module `tolerance` of lin-canny), the
/// product with it by 8, and the norm by 2. Together this is 24 UNIT. An error of a quaternion
/// rotates by twice as much.
pub(crate) const ARM_TURN: f64 = 64.0 * UNIT;

/// Error of the value of a joint along a curve, for each degree of the curve, in units of the
/// greatest absolute control point.
///
/// A round of de Casteljau's algorithm rounds the difference of two values, its product with the
/// time, and the sum: 5 UNIT of the greatest value. Later rounds do not enlarge the error, because
/// they are averages. There are as many rounds as the degree. The factor and the offset of a mimic
/// joint err by UNIT each. A straight segment has degree 1.
pub(crate) const ARM_VALUE: f64 = 8.0 * UNIT;

/// Error of the control points of a part of a hodograph, for each degree of the curve, in units of
/// the hodograph's greatest absolute control point.
///
/// De Casteljau's algorithm errs by 5 UNIT a round, and runs four times: from the start of the
/// part, to its end, and for two halvings. The start, the end and their quotient err by 4 UNIT of
/// the time. This moves a control point by twice as much, once for each degree. A control point of a
/// hodograph is a rounded difference, times a number: 2 UNIT. Together this is 30 UNIT.
pub(crate) const CURVE_PART: f64 = 40.0 * UNIT;

/// Error of the control points of the second hodograph by the rounding of those of the first, for
/// each degree, in units of the greatest control point of the first. For the third hodograph, for
/// the square of the degree.
///
/// A control point of the first hodograph errs by 2 UNIT. Its differences, times the degree less
/// one, err by 4 n UNIT, and their own rounding by 2 UNIT of at most 2 n: 8 n UNIT. The differences
/// of these, times the degree less two, err by 16 n^2 UNIT, and their own rounding by 8 n^2 UNIT.
pub(crate) const CURVE_DIFFERENCE: f64 = 24.0 * UNIT;

/// Error of a converted control point, for each rounding, in units of the sum of the absolute
/// values of its terms. The second unit is reserve.
pub(crate) const CONVERTED: f64 = 2.0 * UNIT;

/// Greatest distance of a curve from the straight segment between its ends, in units of the greatest
/// absolute control point, at which the proof of the segment is tried first. A cubic or quintic
/// curve along a segment is off by its conversion, 16 UNIT of a sum that is up to five times as
/// large, and by 24 UNIT of the products and sums here. The rest is reserve.
pub(crate) const STRAIGHT: f64 = 256.0 * UNIT;

/// Error of a distance from a straight segment, in units of the greatest absolute control point: a
/// product and two sums, each of at most twice as much, and the quotient, which errs by 3 UNIT.
pub(crate) const STRAIGHT_ERROR: f64 = 16.0 * UNIT;

/// Error of the length of a vector, relative to the length: three squares, two sums and a root.
pub(crate) const LENGTH: f64 = 8.0 * UNIT;

/// Error of the position of the origin of a link by one joint, in units of the length of the vector
/// to the origin and, once more, of the sum of all lengths so far.
///
/// A product with a quaternion whose squared norm differs from one by 12 UNIT errs by 24, and its
/// rounding by 24. The value of a prismatic joint errs by 8, the sum by 1. The same bound holds for
/// velocities, which are sums of products of these.
pub(crate) const ARM_PLACE: f64 = 64.0 * UNIT;

/// Error of the pose of an attached object: of its angle, and of its position in units of the
/// 1-norms of all vectors in it.
///
/// The squared norm of the quaternion of a body may differ from one by [`POSE_UNIT`], so the
/// position of a point of the object, by the product of the poses or by one pose after the other,
/// differs by twice as much. Two norms and two products round by less than 100 UNIT. The rest is
/// reserve.
pub(crate) const ATTACHED: f64 = 4.0 * POSE_UNIT;

/// Error of a bound over a range of joints by the poses of the frames, for each joint between the
/// bodies and one more, and each product of poses, in units of the greatest length of the chain.
///
/// After `s` products a frame errs by `s ARM_TURN` in its angle, and its origin by
/// `s (ARM_TURN + ARM_PLACE)` of the length L of the chain. The bound is exact for a mechanism with
/// the computed axes. If the axis z through o is replaced by z' through o', a rotation about it
/// moves a point x by at most `2 |z - z'| |x - o| + 2 |o - o'|` elsewhere, because `R' = Q R Q^-1`
/// for a rotation Q that takes z to z', and `|Q R - R Q| <= 2 |Q - 1|`. Together this is at most
/// `2 s (2 ARM_TURN + ARM_PLACE) L` for each joint. Rotations about other joints keep it. The pose
/// of the second body at the centre counts as one joint more. An error of the value of a joint
/// ([`ARM_VALUE`]) counts as an error of the angle of all frames.
pub(crate) const RANGE_FRAME: f64 = 512.0 * UNIT;

/// Error of the terms of a bound over a range of joints, for each joint between the bodies and two
/// more, in units of `L (1 + S)^3`: L is the greatest length of the chain, and S the sum of the
/// half-widths of its joints, that of a slide over L.
///
/// Normals, axes and their origins are rotated into the frame of a body: 66 UNIT each. A first
/// derivative is `(n x z) . (x - o)`, of absolute terms `2 L`: with both products this is 300 UNIT.
/// A second derivative has one product more: 400 UNIT. Weighted by half-widths, all derivatives of
/// one order have the error of one, times S or S^2. The sum of m + m^2 / 2 terms and of the
/// remainders errs by UNIT of `L (1 + S)^3` for each term. Two bodies double this: 2 (400 + m + m^2
/// / 2) UNIT. A swept joint multiplies a matrix of norm 1 or less and adds a distance from its axis:
/// 120 UNIT of L each, and once more times S and S^2 in the derivatives of the joints beyond it. All
/// in all this is below 512 (m + 2) UNIT for up to 350 joints.
pub(crate) const RANGE_TERM: f64 = 512.0 * UNIT;

/// Relative error of the time at which a segment crosses a face between two boxes of joint values.
///
/// Two differences and a quotient err by UNIT each, and the end of the interval by one more: 4 UNIT.
pub(crate) const CROSSING: f64 = 8.0 * UNIT;

/// Error of the angle of a body between two timed poses.
///
/// As vectors of quaternions, two norms err by 3 UNIT each and their product by 8, which rotates by
/// twice as much: 28 UNIT. The angle, at most half a turn, errs by 4 UNIT of its value.
pub(crate) const SLERP_TURN: f64 = 64.0 * UNIT;

/// Error of the position of a body between two timed poses, in units of the 1-norms of both
/// positions: their difference, and the sum with the first.
pub(crate) const SLERP_PLACE: f64 = 4.0 * UNIT;

/// Error of a fraction of the motion between two timed poses at a time of a curve, in units of the
/// fraction at the start of the curve, of the change of the fraction along the curve, and of one.
///
/// A quotient of two differences errs by 3 UNIT, the change by one more, and their sum by one: 5
/// UNIT, at the start of a bound and at its end. The velocity errs by 4 UNIT, and the time of a row
/// on the curve by 4. Together this is 18 UNIT.
pub(crate) const CLOCK: f64 = 32.0 * UNIT;

/// Cosine of half the angle between two rotations below which both directions of the rotation from
/// one to the other are equally near. Not a matter of soundness: it chooses the motion.
pub(crate) const HALF_TURN: f64 = 16.0 * UNIT;

/// What a proof in a receipt must exceed beyond its claim, in units of the size of the scene.
///
/// A checker with 58 bits after the point errs by some hundred of its units on the path of a long
/// arm. Not a matter of soundness: a checker decides, and the writer halves intervals until it
/// expects a yes.
pub(crate) const RECEIPT: f64 = 8192.0 * UNIT;

/// By how far the patches that a receipt contains are off, as a part of the farthest point: 40 halvings of up to seven
/// steps, of 2 UNIT each (`NET_STEP` of the library), control points and thickness some more.
#[cfg(feature = "surfaces")]
pub(crate) const CONTAINED: f64 = 1024.0 * UNIT;

/// Least weight of a vertex of a feature, and least sine between two edges, for which a receipt
/// names features instead of a normal. Not a matter of soundness.
pub(crate) const INSIDE: f64 = POSE_UNIT;
