//! Bounds of rounding errors of the motions of robots. The rules of their derivations stand at
//! [`lin_canny::tolerance`].

use lin_canny::tolerance::POSE_UNIT;

/// Unit roundoff of f64.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Error of a ball at a pose, or of the side of a box about a motion, in units of the sum of the
/// radii and of the absolute coordinates of the places: a point placed by a quaternion errs by 33
/// UNIT, by the derivation of the relative pose, and two sums and a norm of three squares by 6.
pub(crate) const PLACED: f64 = 64.0 * UNIT;

/// Error of the place of a ball's middle by the pose of a body, which the caller may give, in units of the 1-norm of the
/// middle in the body's frame: a quaternion whose square is off one by `POSE_UNIT` of `lin_canny::tolerance` puts it off
/// by twice as much, and half as much again is room.
pub(crate) const PLACED_BALL: f64 = 3.0 * POSE_UNIT;

/// Error of the angle of a link of an arm by one joint: the product with the fixed rotation of the
/// joint's frame errs by 8 UNIT as a vector of a quaternion, the quaternion of the joint's value by
/// 5.4 (see `TURN` of `lin_canny::tolerance`), the product with it by 8, and the norm by 2: 24 UNIT, and an error of a
/// quaternion turns by twice as much.
pub(crate) const ARM_TURN: f64 = 64.0 * UNIT;

/// Error of the value of a joint along a segment, in units of the greater absolute value at its
/// ends: the difference of the ends, its product with the time and the sum err by UNIT of at most
/// twice that each.
pub(crate) const ARM_VALUE: f64 = 8.0 * UNIT;

/// Error of the place of the origin of a link by one joint, in units of the length of the vector to
/// the origin and, once more, of the sum of all lengths so far: a product with a quaternion whose
/// square is off one by 12 UNIT is off by 24, and rounded by 24; the value of a prismatic joint
/// errs by 8; the sum by 1. The same bound holds for velocities, which are sums of products of
/// these.
pub(crate) const ARM_PLACE: f64 = 64.0 * UNIT;
