//! The relative pose of two bodies; the only place that rejects a pose.

use nalgebra::{Isometry3, Matrix3, Quaternion, UnitQuaternion, Vector3};
use wide::f64x2;

use crate::base::callbacks;
use crate::base::num::axis_name;
use crate::base::num::each::Each;
use crate::base::num::packed::{self, PackedRotation, PackedVec3};
use crate::base::tolerance::{NORMALISED, POSE_UNIT, REACH};

/// Error of a pose that is no rigid motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A coordinate of the translation is NaN, infinite or too large.
    ///
    /// If the bodies are so far apart that their distance may overflow f64, `body` is B and `value`
    /// is a coordinate of the translation from A to B.
    #[error("translation of {body} is out of range: {} is {value} (expected a finite number)", axis_name(*.axis))]
    Translation {
        /// Body with the invalid pose.
        body: Operand,
        /// Index of the coordinate: 0, 1 or 2.
        axis: usize,
        /// Value of the coordinate.
        value: f64,
    },
    /// The rotation is not a unit quaternion: `| |q|^2 - 1 |` must not exceed 1e-12.
    ///
    /// [`RelativePose::new_normalized`] accepts rotations from `f32`, from files and from products
    /// of many rotations.
    #[error(
        "rotation of {body} is not a unit quaternion: squared norm {norm_squared} (expected 1); call `normalize_rotation`"
    )]
    Rotation {
        /// Body with the invalid pose.
        body: Operand,
        /// Squared norm of the quaternion; NaN or infinite if a coordinate is.
        norm_squared: f64,
    },
}

/// Number of values of a pose that can be rejected: three coordinates and the rotation.
const PARTS: usize = 4;

impl PoseError {
    /// Returns the error of a value: the values of A come first, then those of B.
    fn of(which: usize, value: f64) -> Self {
        let body = if which < PARTS { Operand::A } else { Operand::B };
        match which % PARTS {
            axis @ 0..=2 => Self::Translation { body, axis, value },
            _ => Self::Rotation {
                body,
                norm_squared: value,
            },
        }
    }
}

/// The first or the second body of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Operand {
    /// First body.
    A,
    /// Second body.
    B,
}

impl core::fmt::Display for Operand {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(if *self == Operand::A { "A" } else { "B" })
    }
}

/// Pose of B relative to A.
///
/// A vertex `v` of a body at pose `(q, t)` is at `R(q) v / |q|^2 + t` over the rationals, for
/// exactly the given bits of `q` and `t`. All bounds of a certified outcome refer to this exact
/// position, not to its rounding. World offsets cancel first, because the relative translation is
/// computed from `t_b - t_a`. So a common shift that both translations absorb exactly changes no
/// bit of any outcome.
///
/// A rotation must be a unit quaternion in `f64`. Rotations from `f32`, from files or from products
/// of many rotations are less accurate than [`new`](Self::new) accepts.
/// [`new_normalized`](Self::new_normalized) divides them by their norm first:
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{PoseError, RelativePose};
///
/// let (shift, turn) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, 0.2, 0.1));
/// let pose = Isometry3::new(shift, turn).cast::<f32>();
/// let pose: Isometry3<f64> = pose.cast();
/// let refused = RelativePose::from_isometry(&pose);
/// assert!(matches!(refused, Err(PoseError::Rotation { .. })));
/// let a_from_b = RelativePose::new_normalized(&Isometry3::identity(), &pose)?;
/// # Ok::<(), PoseError>(())
/// ```
///
/// Poses of parry and rapier: see the [front page](crate#bodies-and-poses-of-parry-and-rapier).
#[doc(alias = "isometry")]
#[doc(alias = "transform")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct RelativePose {
    pub(crate) a: PoseBits,
    pub(crate) b: PoseBits,
}

/// A pose as given by the caller, packed for SIMD, because a query reads the pose moments after it
/// was stored.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(into = "RawPose"))]
pub(crate) struct PoseBits {
    /// Quaternion: vector part, then scalar part.
    q: [f64x2; 2],
    /// Translation; the spare lane contains `|q|^2`, rounded.
    t: PackedVec3,
}

impl PoseBits {
    #[inline(always)]
    pub(crate) fn new(pose: &Isometry3<f64>) -> Self {
        let (q, t) = (&pose.rotation.coords, &pose.translation.vector);
        Self::of([q.x, q.y, q.z, q.w], [t.x, t.y, t.z])
    }

    #[inline(always)]
    fn of([x, y, z, w]: [f64; 4], t: [f64; 3]) -> Self {
        let q = [f64x2::new([x, y]), f64x2::new([z, w])];
        let [even, odd] = (q[0] * q[0] + q[1] * q[1]).to_array();
        Self {
            q,
            t: PackedVec3::with_spare(&t.into(), even + odd),
        }
    }

    #[inline(always)]
    pub(crate) fn q(&self) -> [f64; 4] {
        let [[x, y], [z, w]] = self.q.each(f64x2::to_array);
        [x, y, z, w]
    }

    #[inline(always)]
    pub(crate) fn t(&self) -> [f64; 3] {
        self.t.vector().into()
    }

    #[inline(always)]
    fn norm_squared(&self) -> f64 {
        self.t.spare()
    }

    /// Returns whether the rotation is a unit quaternion. NaN fails the comparison.
    #[inline(always)]
    fn is_unit(&self) -> bool {
        (self.norm_squared() - 1.0).abs() <= POSE_UNIT
    }

    /// Returns whether the rotation is of unit length up to rounding.
    #[inline(always)]
    fn is_normalised(&self) -> bool {
        (self.norm_squared() - 1.0).abs() <= NORMALISED
    }

    /// Returns the first invalid value of the pose and its index, or `None`.
    ///
    /// The index is the axis of the translation, or 3 for the squared norm of the rotation.
    fn refused(&self) -> Option<(usize, f64)> {
        let t = self.t();
        if let Some(axis) = (0..3).find(|&k| !t[k].is_finite()) {
            return Some((axis, t[axis]));
        }
        (!self.is_unit()).then(|| (PARTS - 1, self.norm_squared()))
    }

    #[inline(always)]
    pub(crate) fn isometry(&self) -> Isometry3<f64> {
        let [x, y, z, w] = self.q();
        let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        Isometry3::from_parts(Vector3::from(self.t()).into(), q)
    }
}

/// Returns whether the rotation of a pose is a unit quaternion, as [`RelativePose::new`] requires.
#[inline]
pub(crate) fn is_unit(pose: &Isometry3<f64>) -> bool {
    PoseBits::new(pose).is_unit()
}

/// Returns a rotation of unit length up to rounding: the given one, or the quaternion divided by
/// its norm.
///
/// A product of nalgebra with a vector needs it: a quaternion off unit length, by as little as a
/// pose may be, stretches the vector by far more than rounding. If the result is normalised again,
/// it is the same bit for bit.
pub(crate) fn normalised(rotation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    if (rotation.norm_squared() - 1.0).abs() <= NORMALISED {
        return rotation;
    }
    UnitQuaternion::new_normalize(rotation.into_inner())
}

/// Returns a pose with its rotation [`normalised`].
pub(crate) fn rigid(pose: &Isometry3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(pose.translation, normalised(pose.rotation))
}

/// Returns the pose with its quaternion divided by the norm.
///
/// [`RelativePose::new`] and a scene require such poses.
///
/// A quaternion that is zero or not finite is returned unchanged; `RelativePose::new` and a scene
/// reject it.
#[must_use]
pub fn normalize_rotation(pose: &Isometry3<f64>) -> Isometry3<f64> {
    let q = pose.rotation.coords;
    let largest = q.amax();
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return *pose;
    }
    // Scaled first: the squares of a very long or short quaternion leave the range of f64.
    let scaled = q / largest;
    let unit = scaled / crate::base::num::scalar::sqrt(scaled.norm_squared());
    let rotation = UnitQuaternion::new_unchecked(Quaternion::from(unit));
    Isometry3::from_parts(pose.translation, rotation)
}

impl RelativePose {
    /// Returns the relative pose of two bodies from their poses in a common frame.
    ///
    /// # Errors
    /// Returns an error if a translation is not finite or out of range, or if the squared norm of a
    /// rotation differs from 1 by more than 1e-12.
    #[inline]
    pub fn new(pose_a: &Isometry3<f64>, pose_b: &Isometry3<f64>) -> Result<Self, PoseError> {
        let (a, b) = (PoseBits::new(pose_a), PoseBits::new(pose_b));
        let offset = offset(&a, &b);
        // Comparisons with NaN are false.
        let near = offset.one_norm() < REACH;
        if near && a.is_unit() && b.is_unit() {
            Ok(Self { a, b })
        } else {
            // Starts again from the arguments and returns two registers: a pose whose address is
            // taken, or a result that a cold path writes to, would be copied whole in every query.
            let (which, value) = refusal(pose_a, pose_b);
            Err(PoseError::of(which, value))
        }
    }

    /// Returns the pose of a body relative to itself.
    pub(crate) fn identity() -> Self {
        let here = PoseBits::of([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
        Self { a: here, b: here }
    }

    /// Returns the relative pose from the pose of B in A's frame, `pose_a.inverse() * pose_b`.
    ///
    /// For two world poses [`RelativePose::new`] is more accurate, because their offset cancels
    /// first.
    ///
    /// # Errors
    /// Returns an error in the same cases as [`RelativePose::new`].
    pub fn from_isometry(a_from_b: &Isometry3<f64>) -> Result<Self, PoseError> {
        Self::new(&Isometry3::identity(), a_from_b)
    }

    /// Returns the relative pose of two poses, and normalises their rotations first.
    ///
    /// See [`normalize_rotation`]. The bounds of outcomes then hold for the normalised poses.
    ///
    /// # Errors
    /// Returns an error if a translation is not finite or out of range, or if a quaternion is zero
    /// or not finite.
    pub fn new_normalized(pose_a: &Isometry3<f64>, pose_b: &Isometry3<f64>) -> Result<Self, PoseError> {
        Self::new(&normalize_rotation(pose_a), &normalize_rotation(pose_b))
    }

    /// Returns whether both rotations are of unit length up to rounding.
    #[inline(always)]
    pub(crate) fn is_normalised(&self) -> bool {
        self.a.is_normalised() && self.b.is_normalised()
    }

    /// Returns the relative pose with A and B exchanged.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self { a: self.b, b: self.a }
    }

    /// Returns the two original poses, bit for bit.
    #[inline]
    #[must_use]
    pub fn poses(&self) -> (Isometry3<f64>, Isometry3<f64>) {
        (self.a.isometry(), self.b.isometry())
    }

    /// Returns the translation of `a_from_b`.
    #[inline]
    pub(crate) fn translation(&self) -> Vector3<f64> {
        self.packed_translation().vector()
    }

    /// Returns the translation of `a_from_b`, packed for SIMD.
    #[inline(always)]
    pub(crate) fn packed_translation(&self) -> PackedVec3 {
        self.rotated_to_a(offset(&self.a, &self.b))
    }

    /// Returns a sixteenth of the translation: its computation overflows only if the translation
    /// does.
    pub(crate) fn translation_sixteenth(&self) -> Vector3<f64> {
        self.rotated_to_a(offset(&self.a, &self.b) * (1.0 / 16.0)).vector()
    }

    /// Returns `R_a^T offset`.
    #[inline(always)]
    fn rotated_to_a(&self, offset: PackedVec3) -> PackedVec3 {
        let (axis, w) = packed::parts(&self.a.q);
        let c = offset.cross(axis);
        let s = 2.0 * (2.0 - self.a.norm_squared());
        offset + (c * w + c.cross(axis)) * s
    }

    /// Returns a vector of A's frame in B's frame, to about 40 UNIT.
    ///
    /// For a single vector this costs less than a matrix.
    #[inline(always)]
    pub(crate) fn vector_in_b(&self, v: PackedVec3) -> PackedVec3 {
        let (axis, w) = packed::parts(&packed::quotient(&self.a.q, &self.b.q));
        let c = v.cross(axis);
        let s = 2.0 * (2.0 - self.a.norm_squared()) * (2.0 - self.b.norm_squared());
        v + (c * w + c.cross(axis)) * s
    }

    /// Returns the rotation of `a_from_b`: the matrix of `conj(qa) qb`, divided by its squared
    /// norm. The norms are within 1e-12 of one, so `2 - n` is `1 / n` to 1e-24.
    #[inline]
    pub(crate) fn rotation(&self) -> Matrix3<f64> {
        self.packed_rotation().matrix()
    }

    /// Returns the rotation of `a_from_b`, packed for SIMD.
    #[inline(always)]
    pub(crate) fn packed_rotation(&self) -> PackedRotation {
        let s = 2.0 * (2.0 - self.a.norm_squared()) * (2.0 - self.b.norm_squared());
        PackedRotation::between(&self.a.q, &self.b.q, s)
    }
}

/// Returns the index of the first invalid value of two poses, as [`PoseError::of`] reads it, and
/// the value.
///
/// At least one of the two poses, or their offset, must be invalid.
#[cold]
#[inline(never)]
fn refusal(pose_a: &Isometry3<f64>, pose_b: &Isometry3<f64>) -> (usize, f64) {
    let (which, value) = invalid_part(pose_a, pose_b);
    callbacks::refused("a pose", &PoseError::of(which, value));
    (which, value)
}

fn invalid_part(pose_a: &Isometry3<f64>, pose_b: &Isometry3<f64>) -> (usize, f64) {
    let (a, b) = (PoseBits::new(pose_a), PoseBits::new(pose_b));
    if let Some((part, value)) = a.refused() {
        return (part, value);
    }
    if let Some((part, value)) = b.refused() {
        return (PARTS + part, value);
    }
    let offset = offset(&a, &b).vector();
    // If the sum of three absolute coordinates is too large, the largest is at least a third of the
    // sum.
    let axis = offset.iamax();
    (PARTS + axis, offset[axis])
}

/// Returns `t_b - t_a`: world offsets cancel here.
#[inline(always)]
fn offset(a: &PoseBits, b: &PoseBits) -> PackedVec3 {
    b.t - a.t
}

/// Returns the rotation matrix of `q`, for `s = 2 / |q|^2`.
#[inline(always)]
pub(crate) fn rotation_matrix(q: &[f64; 4], s: f64) -> Matrix3<f64> {
    let [x, y, z, w] = *q;
    let (xs, ys, zs) = (x * s, y * s, z * s);
    let (xx, yy, zz) = (x * xs, y * ys, z * zs);
    let (xy, xz, yz) = (x * ys, x * zs, y * zs);
    let (wx, wy, wz) = (w * xs, w * ys, w * zs);
    let (xx, yy, zz) = (1.0 - (yy + zz), 1.0 - (xx + zz), 1.0 - (xx + yy));
    Matrix3::new(xx, xy - wz, xz + wy, xy + wz, yy, yz - wx, xz - wy, yz + wx, zz)
}

/// The serialised form of a pose.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct RawPose {
    q: [f64; 4],
    t: [f64; 3],
}

#[cfg(feature = "serde")]
impl From<PoseBits> for RawPose {
    fn from(p: PoseBits) -> Self {
        Self { q: p.q(), t: p.t() }
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for RelativePose {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        struct RawRelativePose {
            a: RawPose,
            b: RawPose,
        }
        let raw = RawRelativePose::deserialize(deserializer)?;
        let pose = |p: RawPose| PoseBits::of(p.q, p.t).isometry();
        Self::new(&pose(raw.a), &pose(raw.b)).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Translation3;

    #[test]
    fn agrees_with_inv_mul() {
        let a = Isometry3::new(Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.3, 0.4, -0.9));
        let b = Isometry3::new(Vector3::new(-4.0, 0.5, 2.0), Vector3::new(-1.3, 0.2, 0.7));
        let pose = RelativePose::new(&a, &b).unwrap();
        let expected = a.inv_mul(&b);
        assert!((pose.translation() - expected.translation.vector).norm() < 1e-14);
        assert!((pose.rotation() - expected.rotation.to_rotation_matrix().matrix()).norm() < 1e-14);
        assert_eq!(pose.poses(), (a, b));
    }

    #[test]
    fn a_vector_turns_as_by_the_matrix() {
        let a = Isometry3::new(Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.3, 0.4, -0.9));
        let b = Isometry3::new(Vector3::new(-4.0, 0.5, 2.0), Vector3::new(-1.3, 0.2, 0.7));
        let pose = RelativePose::new(&a, &b).unwrap();
        let v = Vector3::new(0.6, -0.3, 0.8);
        let turned = pose.vector_in_b(PackedVec3::new(&v)).vector();
        assert!((turned - pose.rotation().tr_mul(&v)).norm() < 1e-15);
    }

    #[test]
    fn a_normalised_rotation_stays_as_it_is() {
        let mut rng = crate::rng::Rng::new(9);
        for _ in 0..100_000 {
            let [x, y, z, w] = [1.0, 1e-3, 1.0, 1e3].map(|most| rng.range(-most, most));
            let given = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            let once = normalised(given);
            assert!((once.norm_squared() - 1.0).abs() <= NORMALISED, "{given}");
            assert_eq!(normalised(once), once, "{given}");
        }
    }

    #[test]
    fn invalid_poses_are_refused_by_name() {
        let one = Isometry3::identity();
        let nan = Isometry3::from_parts(Translation3::new(0.0, f64::NAN, 0.0), UnitQuaternion::identity());
        assert!(matches!(
            RelativePose::new(&one, &nan),
            Err(PoseError::Translation {
                body: Operand::B,
                axis: 1,
                ..
            })
        ));
        let long = UnitQuaternion::new_unchecked(Quaternion::new(1.0 + 1e-9, 0.0, 0.0, 0.0));
        let long = Isometry3::from_parts(Translation3::identity(), long);
        assert!(matches!(
            RelativePose::new(&long, &one),
            Err(PoseError::Rotation { body: Operand::A, .. })
        ));
        let far = |x| Isometry3::translation(x, 0.0, 0.0);
        assert!(RelativePose::new(&far(-1.7e308), &far(1.7e308)).is_err());
    }

    #[test]
    fn a_common_shift_changes_nothing() {
        let at = |x: f64| Isometry3::translation(x, 2.0, 3.0);
        let near = RelativePose::new(&at(1.0), &at(1.5)).unwrap();
        let far = RelativePose::new(&at(1048577.0), &at(1048577.5)).unwrap();
        assert_eq!(
            (near.rotation(), near.translation()),
            (far.rotation(), far.translation())
        );
    }
}
