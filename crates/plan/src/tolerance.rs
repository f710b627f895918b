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

/// Error of the value of a joint along a segment, in units of the greater absolute value at its
/// ends.
///
/// The difference of the ends, its product with the time, and the sum err by UNIT of at most twice
/// this value each.
pub(crate) const ARM_VALUE: f64 = 8.0 * UNIT;

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
