//! Two bodies at one relative pose, and the maps between their stored frames.

use nalgebra::{Matrix3, Vector3};

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::packed::{PackedRotation, PackedVec3};
use crate::base::num::scalar::{Scalar, sqrt};
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{FAR, NEAR, UNIT, UNIT_DOUBLE_DOUBLE};
use crate::body::polyhedron::{ConvexPolyhedron, power_of_two};
use crate::pair::transform::{ErrorScale, StoredFrame, Transform};

/// Witnesses on A and on B, each in the stored frame of its body.
pub(crate) type WitnessPair = (Vector3<f64>, Vector3<f64>);

/// Two bodies at a relative pose, in stored units.
pub(crate) struct PosedPair<'a> {
    pub(crate) a: &'a ConvexPolyhedron,
    pub(crate) b: &'a ConvexPolyhedron,
    /// `a_from_b` between stored frames: a rotation times `unit`, and a translation.
    pub(crate) rotation: PackedRotation,
    pub(crate) translation: PackedVec3,
    /// The stored unit of B, in stored units of A.
    unit: f64,
    /// The size L of the pair, in A's stored units.
    size: f64,
    /// Distances of the stored origins from the bodies' origins, in A's stored units; zero for
    /// ordinary bodies.
    offsets: f64,
    pub(crate) pose: &'a RelativePose,
}

/// A pair that f64 cannot pose: so far apart, or with points so close together, that only the
/// separation matters.
pub(crate) struct OutOfRange;

impl<'a> PosedPair<'a> {
    /// Poses B relative to A. The stored unit of A must be at least the stored unit of B.
    #[inline(always)]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &'a RelativePose,
    ) -> Result<Self, OutOfRange> {
        let (rotation, translation, unit, offsets) = if a.is_unscaled && b.is_unscaled {
            (pose.packed_rotation(), pose.packed_translation(), 1.0, 0.0)
        } else {
            shifted_and_scaled(a, b, pose)?
        };
        // The translation by the origins is computed in double-double, with an error relative to
        // the origins. L contains the origins, so every term in UNIT L covers them.
        let extra = UNIT_DOUBLE_DOUBLE / UNIT * offsets;
        let size = a.radius + unit * b.radius + sqrt(translation.norm_squared()) + extra;
        // Written so that NaN is out of range.
        if !(size > NEAR && size < FAR) {
            return Err(OutOfRange);
        }
        Ok(Self {
            a,
            b,
            rotation,
            translation,
            unit,
            size,
            offsets,
            pose,
        })
    }

    /// Returns the size L in A's stored units.
    #[inline(always)]
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Returns whether both bodies are stored in the same unit; the walk requires this.
    ///
    /// Directions and vectors then rotate alike. If the units differ, the radius of a body is at
    /// least 2^105 units, or less than 2^-105.
    #[inline(always)]
    pub(crate) fn same_scale(&self) -> bool {
        self.unit == 1.0
    }

    /// Returns the lengths that scale the rounding errors of a solver.
    ///
    /// These are L, and in double-double also the full origins of the bodies, because there the
    /// pose rounds as coarsely as the solver. In f64 the origins are included in L.
    pub(crate) fn error_scale<T: Scalar>(&self) -> ErrorScale {
        ErrorScale {
            size: self.size,
            shared: if T::UNIT == UNIT { 0.0 } else { self.offsets },
        }
    }

    /// Maps a point from B's frame to A's.
    #[inline(always)]
    pub(crate) fn point_in_a(&self, p: &Vector3<f64>) -> Vector3<f64> {
        (self.rotation.times(PackedVec3::new(p)) + self.translation).vector()
    }

    /// Maps a vector from B's frame to A's.
    #[inline(always)]
    pub(crate) fn vector_in_a(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.times(PackedVec3::new(v)).vector()
    }

    /// Maps a point from A's frame to B's. Both bodies must have the same stored unit.
    #[inline(always)]
    pub(crate) fn point_in_b(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation
            .transposed_times(PackedVec3::new(p) - self.translation)
            .vector()
    }

    /// Maps a vector from A's frame to B's. Both bodies must have the same stored unit.
    #[inline(always)]
    pub(crate) fn vector_in_b(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transposed_times(PackedVec3::new(v)).vector()
    }

    /// Maps a normal from A's frame to B's: B's points rise along the result as they rise along
    /// `n`.
    #[inline(always)]
    pub(crate) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transposed_times(PackedVec3::new(n)).vector()
    }

    /// Returns the matrix of B's ellipsoid in A's frame.
    pub(crate) fn covariance_of_b(&self) -> Matrix3<f64> {
        let matrix = self.rotation.matrix();
        matrix * self.b.covariance3 * matrix.transpose()
    }

    /// Returns the height of B's stored origin along `n`, in A's frame.
    #[inline(always)]
    pub(crate) fn height_of_b_origin(&self, n: &Vector3<f64>) -> f64 {
        PackedVec3::new(n).dot(self.translation)
    }
}

/// The bodies in the order of a feature test.
///
/// `first` has the vertex or edge that moves, `second` has the opposite feature. The test runs in
/// the frame of `second`.
pub(crate) trait OrderedPair {
    /// The operand in the role of `first`.
    const FIRST: Operand;
    /// Returns the body with the vertex or edge that moves.
    fn first(&self) -> &ConvexPolyhedron;
    /// Returns the body with the opposite feature.
    fn second(&self) -> &ConvexPolyhedron;
    /// Returns the size L.
    fn size(&self) -> f64;
    /// Maps a point from the frame of `first` to the frame of `second`.
    fn point_in_second(&self, p: &Vector3<f64>) -> Vector3<f64>;
    /// Maps a normal from the frame of `second` to the frame of `first`: points rise along the
    /// result as they rise along `n`.
    fn direction_in_first(&self, n: &Vector3<f64>) -> Vector3<f64>;
    /// Returns the unit normal from A to B in A's frame, given the unit normal `n` from `second` to
    /// `first` in the frame of `second`.
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64>;
    /// Returns the witnesses in the order A, B.
    fn witnesses(on_first: Vector3<f64>, on_second: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>);
}

/// A pair with A as `first` and B as `second`.
pub(crate) struct AFirst<'a, 'b>(pub(crate) &'a PosedPair<'b>);

/// A pair with B as `first` and A as `second`.
pub(crate) struct BFirst<'a, 'b>(pub(crate) &'a PosedPair<'b>);

impl OrderedPair for AFirst<'_, '_> {
    const FIRST: Operand = Operand::A;
    #[inline(always)]
    fn first(&self) -> &ConvexPolyhedron {
        self.0.a
    }
    #[inline(always)]
    fn second(&self) -> &ConvexPolyhedron {
        self.0.b
    }
    #[inline(always)]
    fn size(&self) -> f64 {
        self.0.size
    }
    #[inline(always)]
    fn point_in_second(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.point_in_b(p)
    }
    #[inline(always)]
    fn direction_in_first(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.0.vector_in_a(n)
    }
    #[inline(always)]
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64> {
        -self.0.vector_in_a(n)
    }
    #[inline(always)]
    fn witnesses(on_first: Vector3<f64>, on_second: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (on_first, on_second)
    }
}

impl OrderedPair for BFirst<'_, '_> {
    const FIRST: Operand = Operand::B;
    #[inline(always)]
    fn first(&self) -> &ConvexPolyhedron {
        self.0.b
    }
    #[inline(always)]
    fn second(&self) -> &ConvexPolyhedron {
        self.0.a
    }
    #[inline(always)]
    fn size(&self) -> f64 {
        self.0.size
    }
    #[inline(always)]
    fn point_in_second(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.point_in_a(p)
    }
    #[inline(always)]
    fn direction_in_first(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.0.direction_in_b(n)
    }
    #[inline(always)]
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64> {
        *n
    }
    #[inline(always)]
    fn witnesses(on_first: Vector3<f64>, on_second: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (on_second, on_first)
    }
}

/// Returns matrix, translation, scale and offsets of `a_from_b` between stored frames that differ
/// from the user's frames.
///
/// Scaling alone is exact, so powers of two change only the exponents of an outcome. Translations
/// are computed in double-double, because the offsets of the bodies may be far larger than the
/// bodies and cancel.
#[cold]
fn shifted_and_scaled(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
) -> Result<(PackedRotation, PackedVec3, f64, f64), OutOfRange> {
    let scale = power_of_two(b.exponent - a.exponent);
    if a.origin == Vector3::zeros() && b.origin == Vector3::zeros() {
        let translation = pose.packed_translation() * power_of_two(-a.exponent);
        return Ok((PackedRotation::new(&(pose.rotation() * scale)), translation, scale, 0.0));
    }
    let shift = Transform::shift(&StoredFrame::of(a), &b.origin, pose).ok_or(OutOfRange)?;
    let translation = Vector3::from(shift.each(DoubleDouble::value));
    let length = |v: &Vector3<f64>| v.abs().sum();
    let offsets = (length(&a.origin) + length(&b.origin)) / a.unit();
    Ok((
        PackedRotation::new(&(pose.rotation() * scale)),
        PackedVec3::new(&translation),
        scale,
        offsets,
    ))
}
