//! A pair of bodies at one relative pose: the maps between their stored frames.

use nalgebra::{Matrix3, Vector3};

use crate::double_double::DoubleDouble;
use crate::polyhedron::{ConvexPolyhedron, power_of_two};
use crate::pose::RelativePose;
use crate::scalar::{Scalar, sqrt};
use crate::tolerance::{FAR, NEAR, UNIT, UNIT_DOUBLE_DOUBLE};

/// An affine map between two stored frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map {
    matrix: Matrix3<f64>,
    translation: Vector3<f64>,
    /// The pair's size L in the units of the frame mapped into.
    pub(crate) size: f64,
    /// One unit of the frame mapped into, in A's.
    pub(crate) unit: f64,
}

impl Map {
    /// Where a point of the source frame is.
    #[inline]
    pub(crate) fn point(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * p + self.translation
    }

    /// Where a difference of points of the source frame points.
    #[inline]
    pub(crate) fn vector(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * v
    }

    /// How high the source's origin is along `n`.
    #[inline]
    pub(crate) fn lift(&self, n: &Vector3<f64>) -> f64 {
        n.dot(&self.translation)
    }

    /// The direction of the source frame along which points rise as they do along `n` here.
    #[inline]
    pub(crate) fn direction(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.matrix.tr_mul(n)
    }
}

/// Two bodies placed against each other, in stored units.
pub(crate) struct Placed<'a> {
    pub(crate) a: &'a ConvexPolyhedron,
    pub(crate) b: &'a ConvexPolyhedron,
    pub(crate) a_from_b: Map,
    pub(crate) b_from_a: Map,
    /// How far the stored origins are from the bodies' own, in A's stored units: zero for ordinary bodies.
    offsets: f64,
    pub(crate) pose: &'a RelativePose,
}

/// One body as the walk sees it beside the other: `x` owns the first feature of a pair, `y` the second.
#[derive(Clone, Copy)]
pub(crate) struct Sides<'a> {
    pub(crate) x: &'a ConvexPolyhedron,
    pub(crate) y: &'a ConvexPolyhedron,
    pub(crate) y_from_x: &'a Map,
    pub(crate) x_from_y: &'a Map,
}

/// Why a pair cannot be placed in f64: it is so far apart, or its bodies such points, that only the separation counts.
pub(crate) struct BeyondRange;

impl<'a> Placed<'a> {
    /// Places B beside A. The caller has seen to it that A's units are not far smaller than B's.
    #[inline]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &'a RelativePose,
    ) -> Result<Self, BeyondRange> {
        let ordinary = a.is_as_given() && b.is_as_given();
        let (matrix, translation, scale) = if ordinary {
            (pose.rotation, pose.translation, 1.0)
        } else {
            shifted_and_scaled(a, b, pose)?
        };
        let offsets = if ordinary { 0.0 } else { offsets(a, b) };
        // The shift by the origins is made in double-double, and its error is relative to the origins: as a part of L
        // it is covered by every term in UNIT L.
        let extra = UNIT_DOUBLE_DOUBLE / UNIT * offsets;
        let size = a.radius + scale * b.radius + sqrt(translation.norm_squared()) + extra;
        // Written so that NaN goes the safe way.
        if !(size > NEAR && size < FAR) {
            return Err(BeyondRange);
        }
        let back = matrix.transpose() / scale / scale;
        Ok(Self {
            a,
            b,
            a_from_b: Map {
                matrix,
                translation,
                size,
                unit: 1.0,
            },
            b_from_a: Map {
                matrix: back,
                translation: -(back * translation),
                size: size / scale,
                unit: scale,
            },
            offsets,
            pose,
        })
    }

    /// L in A's stored units.
    #[inline]
    pub(crate) fn size(&self) -> f64 {
        self.a_from_b.size
    }

    /// What the rounding of a solver is relative to: L, and the origins of the bodies in full where the placement rounds
    /// as coarsely as the solver (in double-double; for f64 they are a part of L).
    pub(crate) fn reach<T: Scalar>(&self) -> f64 {
        if T::UNIT == UNIT {
            self.size()
        } else {
            self.size() + self.offsets
        }
    }

    /// A as `x`, B as `y`.
    #[inline]
    pub(crate) fn a_beside_b(&self) -> Sides<'_> {
        Sides {
            x: self.a,
            y: self.b,
            y_from_x: &self.b_from_a,
            x_from_y: &self.a_from_b,
        }
    }

    /// B as `x`, A as `y`.
    #[inline]
    pub(crate) fn b_beside_a(&self) -> Sides<'_> {
        Sides {
            x: self.b,
            y: self.a,
            y_from_x: &self.a_from_b,
            x_from_y: &self.b_from_a,
        }
    }
}

/// How far the stored origins are from the bodies' own, in A's stored units.
#[cold]
fn offsets(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> f64 {
    let length = |v: &Vector3<f64>| v.abs().sum();
    (length(&a.origin) + length(&b.origin)) / a.unit()
}

/// Matrix, translation and scale of `a_from_b` between stored frames that are not the given ones. Scaling alone is exact,
/// so that powers of two change no bit of an answer but the exponent. Shifts are made in double-double, because the
/// origins of the bodies may be far larger than the bodies and cancel.
#[cold]
fn shifted_and_scaled(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
) -> Result<(Matrix3<f64>, Vector3<f64>, f64), BeyondRange> {
    let scale = power_of_two(b.exponent - a.exponent);
    if a.origin == Vector3::zeros() && b.origin == Vector3::zeros() {
        let unit = power_of_two(-a.exponent);
        return Ok((pose.rotation * scale, pose.translation * unit, scale));
    }
    let frame = Frame::<DoubleDouble>::new(a, b, pose).ok_or(BeyondRange)?;
    let matrix = Matrix3::from_fn(|r, c| frame.matrix[r][c].value());
    let translation = Vector3::from_fn(|r, _| frame.translation[r].value());
    Ok((matrix, translation, scale))
}

/// `a_from_b` between stored frames in the arithmetic of a solver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<T> {
    pub(crate) matrix: [[T; 3]; 3],
    pub(crate) translation: [T; 3],
}

impl Frame<f64> {
    pub(crate) fn of(map: &Map) -> Self {
        Self {
            matrix: core::array::from_fn(|r| core::array::from_fn(|c| map.matrix[(r, c)])),
            translation: core::array::from_fn(|r| map.translation[r]),
        }
    }
}

impl Frame<DoubleDouble> {
    /// From the poses as given. `None` where the translation is beyond the range of the products that follow.
    pub(crate) fn new(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> Option<Self> {
        // The bodies' own offsets are at most 1e100 and cannot leave the range alone.
        if pose.translation.amax() > FAR * power_of_two(a.exponent) {
            return None;
        }
        let (ra, rb) = (rotation(&pose.a.q), rotation(&pose.b.q));
        let at_b = apply(&rb, &b.origin.map(DoubleDouble::from).into());
        let offset = core::array::from_fn(|k| at_b[k] + DoubleDouble::sum(pose.b.t[k], -pose.a.t[k]));
        let ra = transposed(&ra);
        let unit = DoubleDouble::from(power_of_two(-a.exponent));
        let in_a = apply(&ra, &offset);
        let translation = core::array::from_fn(|k| (in_a[k] - DoubleDouble::from(a.origin[k])) * unit);
        let scale = DoubleDouble::from(power_of_two(b.exponent - a.exponent));
        let columns: [[DoubleDouble; 3]; 3] =
            core::array::from_fn(|c| apply(&ra, &core::array::from_fn(|r| rb[r][c] * scale)));
        Some(Self {
            matrix: transposed(&columns),
            translation,
        })
    }
}

impl<T: Scalar> Frame<T> {
    /// A stored point of B in A's stored frame.
    #[inline]
    pub(crate) fn point(&self, p: &Vector3<f64>) -> [T; 3] {
        let p = [T::from(p.x), T::from(p.y), T::from(p.z)];
        let r = apply(&self.matrix, &p);
        core::array::from_fn(|k| r[k] + self.translation[k])
    }

    /// The direction of B's stored frame along which points rise as they do along `n` in A's.
    #[inline]
    pub(crate) fn direction(&self, n: &[T; 3]) -> [T; 3] {
        core::array::from_fn(|c| self.matrix[0][c] * n[0] + self.matrix[1][c] * n[1] + self.matrix[2][c] * n[2])
    }
}

/// The matrix of `q`, divided by `|q|^2`.
fn rotation(q: &[f64; 4]) -> [[DoubleDouble; 3]; 3] {
    let [x, y, z, w] = q.map(DoubleDouble::from);
    let two = DoubleDouble::from(2.0);
    let one = DoubleDouble::from(1.0);
    let s = two / (x * x + y * y + z * z + w * w);
    [
        [one - (y * y + z * z) * s, (x * y - w * z) * s, (x * z + w * y) * s],
        [(x * y + w * z) * s, one - (x * x + z * z) * s, (y * z - w * x) * s],
        [(x * z - w * y) * s, (y * z + w * x) * s, one - (x * x + y * y) * s],
    ]
}

#[inline]
fn apply<T: Scalar>(m: &[[T; 3]; 3], v: &[T; 3]) -> [T; 3] {
    core::array::from_fn(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2])
}

fn transposed<T: Copy>(m: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    core::array::from_fn(|r| core::array::from_fn(|c| m[c][r]))
}
