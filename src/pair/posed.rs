//! A pair of bodies at one relative pose: the maps between their stored frames.

use nalgebra::{Matrix3, Vector3};

use crate::num::double_double::DoubleDouble;
use crate::num::packed::{PackedRotation, PackedVec3};
use crate::num::scalar::{Scalar, sqrt};
use crate::pair::transform::{Reach, Transform};
use crate::polyhedron::{ConvexPolyhedron, power_of_two};
use crate::pose::{Operand, RelativePose};
use crate::tolerance::{FAR, NEAR, UNIT, UNIT_DOUBLE_DOUBLE};

/// A point of A and a point of B, each in its body's stored frame.
pub(crate) type Witnesses = (Vector3<f64>, Vector3<f64>);

/// Two bodies placed against each other, in stored units.
pub(crate) struct PosedPair<'a> {
    pub(crate) a: &'a ConvexPolyhedron,
    pub(crate) b: &'a ConvexPolyhedron,
    /// `a_from_b` between stored frames: a rotation times `unit`, and a shift.
    pub(crate) rotation: PackedRotation,
    pub(crate) translation: PackedVec3,
    /// One unit of B's stored frame in A's.
    unit: f64,
    /// The pair's size L in A's stored units.
    size: f64,
    /// How far the stored origins are from the bodies' own, in A's stored units: zero for ordinary bodies.
    offsets: f64,
    pub(crate) pose: &'a RelativePose,
}

/// Why a pair cannot be placed in f64: it is so far apart, or its bodies such points, that only the separation counts.
pub(crate) struct BeyondRange;

impl<'a> PosedPair<'a> {
    /// Places B beside A. The caller has seen to it that A's units are not the smaller ones.
    #[inline(always)]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &'a RelativePose,
    ) -> Result<Self, BeyondRange> {
        let (rotation, translation, unit, offsets) = if a.is_unscaled && b.is_unscaled {
            (pose.turn(), pose.shift(), 1.0, 0.0)
        } else {
            shifted_and_scaled(a, b, pose)?
        };
        // The shift by the origins is made in double-double, and its error is relative to the origins: as a part of L
        // it is covered by every term in UNIT L.
        let extra = UNIT_DOUBLE_DOUBLE / UNIT * offsets;
        let size = a.radius + unit * b.radius + sqrt(translation.norm_squared()) + extra;
        // Written so that NaN goes the safe way.
        if !(size > NEAR && size < FAR) {
            return Err(BeyondRange);
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

    /// L in A's stored units.
    #[inline(always)]
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Whether both bodies are stored in the same unit, so that directions and vectors turn alike: what the walk needs.
    /// Pairs that are not have a body 2^105 units or more, or less than 2^-105, in radius.
    #[inline(always)]
    pub(crate) fn same_scale(&self) -> bool {
        self.unit == 1.0
    }

    /// What the rounding of a solver is relative to: L, and the origins of the bodies in full where the placement rounds
    /// as coarsely as the solver (in double-double; for f64 they are a part of L).
    pub(crate) fn reach<T: Scalar>(&self) -> Reach {
        Reach {
            size: self.size,
            shared: if T::UNIT == UNIT { 0.0 } else { self.offsets },
        }
    }

    /// Where a point of B is in A's frame.
    #[inline(always)]
    pub(crate) fn point_in_a(&self, p: &Vector3<f64>) -> Vector3<f64> {
        (self.rotation.times(PackedVec3::new(p)) + self.translation).vector()
    }

    /// A vector of B's frame in A's.
    #[inline(always)]
    pub(crate) fn vector_in_a(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.times(PackedVec3::new(v)).vector()
    }

    /// Where a point of A is in B's frame. Needs one unit.
    #[inline(always)]
    pub(crate) fn point_in_b(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation
            .transposed_times(PackedVec3::new(p) - self.translation)
            .vector()
    }

    /// A vector of A's frame in B's. Needs one unit.
    #[inline(always)]
    pub(crate) fn vector_in_b(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transposed_times(PackedVec3::new(v)).vector()
    }

    /// The direction of B's frame along which points rise as they do along `n` of A's.
    #[inline(always)]
    pub(crate) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transposed_times(PackedVec3::new(n)).vector()
    }

    /// The matrix of B's ellipsoid in A's frame.
    pub(crate) fn spread_of_b(&self) -> Matrix3<f64> {
        let matrix = self.rotation.matrix();
        matrix * self.b.covariance3 * matrix.transpose()
    }

    /// How high B's stored origin is along `n` of A's frame.
    #[inline(always)]
    pub(crate) fn lift(&self, n: &Vector3<f64>) -> f64 {
        PackedVec3::new(n).dot(self.translation)
    }
}

/// The bodies in the order a test needs them: `x` owns the vertex or edge that moves, `y` the feature beside it, and
/// the test is done in `y`'s frame.
pub(crate) trait Sides {
    /// Which body is `x`.
    const OF: Operand;
    fn x(&self) -> &ConvexPolyhedron;
    fn y(&self) -> &ConvexPolyhedron;
    /// L.
    fn size(&self) -> f64;
    fn point_in_y(&self, p: &Vector3<f64>) -> Vector3<f64>;
    /// The direction of `x`'s frame along which points rise as they do along `n` of `y`'s.
    fn direction_in_x(&self, n: &Vector3<f64>) -> Vector3<f64>;
    /// From A to B in A's frame, for the unit direction `n` from `y` to `x` in `y`'s.
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64>;
    /// The witnesses on A and on B.
    fn witnesses(on_x: Vector3<f64>, on_y: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>);
}

/// A as `x`, B as `y`.
pub(crate) struct OfA<'a, 'b>(pub(crate) &'a PosedPair<'b>);

/// B as `x`, A as `y`.
pub(crate) struct OfB<'a, 'b>(pub(crate) &'a PosedPair<'b>);

impl Sides for OfA<'_, '_> {
    const OF: Operand = Operand::A;
    #[inline(always)]
    fn x(&self) -> &ConvexPolyhedron {
        self.0.a
    }
    #[inline(always)]
    fn y(&self) -> &ConvexPolyhedron {
        self.0.b
    }
    #[inline(always)]
    fn size(&self) -> f64 {
        self.0.size
    }
    #[inline(always)]
    fn point_in_y(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.point_in_b(p)
    }
    #[inline(always)]
    fn direction_in_x(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.0.vector_in_a(n)
    }
    #[inline(always)]
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64> {
        -self.0.vector_in_a(n)
    }
    #[inline(always)]
    fn witnesses(on_x: Vector3<f64>, on_y: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (on_x, on_y)
    }
}

impl Sides for OfB<'_, '_> {
    const OF: Operand = Operand::B;
    #[inline(always)]
    fn x(&self) -> &ConvexPolyhedron {
        self.0.b
    }
    #[inline(always)]
    fn y(&self) -> &ConvexPolyhedron {
        self.0.a
    }
    #[inline(always)]
    fn size(&self) -> f64 {
        self.0.size
    }
    #[inline(always)]
    fn point_in_y(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.point_in_a(p)
    }
    #[inline(always)]
    fn direction_in_x(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.0.direction_in_b(n)
    }
    #[inline(always)]
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64> {
        *n
    }
    #[inline(always)]
    fn witnesses(on_x: Vector3<f64>, on_y: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (on_y, on_x)
    }
}

/// Matrix, translation, scale and offsets of `a_from_b` between stored frames that are not the given ones. Scaling alone
/// is exact, so that powers of two change no bit of an answer but the exponent. Shifts are made in double-double, because
/// the offsets of the bodies may be far larger than the bodies and cancel.
#[cold]
fn shifted_and_scaled(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
) -> Result<(PackedRotation, PackedVec3, f64, f64), BeyondRange> {
    let scale = power_of_two(b.exponent - a.exponent);
    if a.origin == Vector3::zeros() && b.origin == Vector3::zeros() {
        let translation = pose.shift() * power_of_two(-a.exponent);
        return Ok((PackedRotation::new(&(pose.rotation() * scale)), translation, scale, 0.0));
    }
    let frame = Transform::<DoubleDouble>::new(a, b, pose).ok_or(BeyondRange)?;
    let matrix = Matrix3::from_fn(|r, c| frame.matrix[r][c].value());
    let translation = Vector3::from_fn(|r, _| frame.translation[r].value());
    let length = |v: &Vector3<f64>| v.abs().sum();
    let offsets = (length(&a.origin) + length(&b.origin)) / a.unit();
    Ok((
        PackedRotation::new(&matrix),
        PackedVec3::new(&translation),
        scale,
        offsets,
    ))
}
