//! Vectors and rotations packed into SIMD lanes of two f64.
//!
//! If a load splits or joins recently stored values differently from the stores, it waits until the
//! values have left the processor's store queue. This takes longer than computing a whole relative
//! pose. For plain vectors of three, the compiler loads and stores any two adjacent coordinates.
//! For packed vectors, it always takes the first two together and the third alone. Results are
//! rounded like those of the plain formulas.

use crate::base::num::each::Each;
use core::ops::{Add, Mul, Neg, Sub};

use nalgebra::{Matrix3, Vector3};
use wide::f64x2;

/// A vector: the first two coordinates, and the third in the first lane of a second pair.
///
/// The spare lane may contain anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PackedVec3 {
    xy: f64x2,
    z: f64x2,
}

/// Returns both first lanes, and both second lanes.
#[inline(always)]
fn interleaved(p: f64x2, q: f64x2) -> (f64x2, f64x2) {
    let [first, second] = f64x2::transpose([p, q]);
    (first, second)
}

/// Returns the first lane twice, and the second lane twice.
#[inline(always)]
fn duplicated(p: f64x2) -> (f64x2, f64x2) {
    interleaved(p, p)
}

/// Returns the two lanes exchanged.
#[inline(always)]
fn swapped(p: f64x2) -> f64x2 {
    let (x, y) = duplicated(p);
    interleaved(y, x).0
}

/// Returns `(-x, y)`.
#[inline(always)]
fn mirrored(p: f64x2) -> f64x2 {
    p ^ f64x2::new([-0.0, 0.0])
}

/// Returns `(-y, x)`: a rotation by 90 degrees.
#[inline(always)]
fn quarter_turn(p: f64x2) -> f64x2 {
    mirrored(swapped(p))
}

#[inline(always)]
fn first(p: f64x2) -> f64 {
    p.to_array()[0]
}

/// Returns the vector part and the scalar part of a quaternion.
#[inline(always)]
pub(crate) fn parts([xy, zw]: &[f64x2; 2]) -> (PackedVec3, f64) {
    (PackedVec3 { xy: *xy, z: *zw }, first(duplicated(*zw).1))
}

/// Returns `conj(a) b`.
#[inline(always)]
pub(crate) fn quotient(a: &[f64x2; 2], b: &[f64x2; 2]) -> [f64x2; 2] {
    let ([a_xy, a_zw], [b_xy, b_zw]) = (*a, *b);
    let ((az, aw), (bx, by), (bz, bw)) = (duplicated(a_zw), duplicated(b_xy), duplicated(b_zw));
    let swapped = swapped(a_xy);
    let xy = (aw * b_xy - bw * a_xy) + (bz * mirrored(swapped) - az * quarter_turn(b_xy));
    let zw = (aw * b_zw + az * quarter_turn(b_zw)) + (bx * swapped + by * mirrored(a_xy));
    [xy, zw]
}

impl PackedVec3 {
    #[inline(always)]
    pub(crate) fn new(v: &Vector3<f64>) -> Self {
        Self {
            xy: f64x2::new([v.x, v.y]),
            z: f64x2::new([v.z, 0.0]),
        }
    }

    /// Returns the packed vector with `other` in the spare lane.
    #[inline(always)]
    pub(crate) fn with_spare(v: &Vector3<f64>, other: f64) -> Self {
        Self {
            z: interleaved(f64x2::splat(v.z), f64x2::splat(other)).0,
            ..Self::new(v)
        }
    }

    #[inline(always)]
    pub(crate) fn spare(self) -> f64 {
        first(duplicated(self.z).1)
    }

    #[inline(always)]
    pub(crate) fn vector(self) -> Vector3<f64> {
        let [x, y] = self.xy.to_array();
        Vector3::new(x, y, first(self.z))
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        let products = self.xy * swapped(other.xy);
        let (z, other_z) = (duplicated(self.z).0, duplicated(other.z).0);
        Self {
            xy: quarter_turn(other.xy) * z - quarter_turn(self.xy) * other_z,
            z: products - swapped(products),
        }
    }

    /// Returns the sum of the coordinates.
    #[inline(always)]
    fn sum(self) -> f64 {
        first(self.xy + swapped(self.xy) + self.z)
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> f64 {
        let products = Self {
            xy: self.xy * other.xy,
            z: self.z * other.z,
        };
        products.sum()
    }

    #[inline(always)]
    pub(crate) fn norm_squared(self) -> f64 {
        self.dot(self)
    }

    /// Returns the sum of absolute coordinates: a norm without a root.
    #[inline(always)]
    pub(crate) fn one_norm(self) -> f64 {
        let absolutes = Self {
            xy: self.xy.abs(),
            z: self.z.abs(),
        };
        absolutes.sum()
    }
}

impl Add for PackedVec3 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            xy: self.xy + other.xy,
            z: self.z + other.z,
        }
    }
}

impl Sub for PackedVec3 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            xy: self.xy - other.xy,
            z: self.z - other.z,
        }
    }
}

impl Neg for PackedVec3 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let signs = f64x2::splat(-0.0);
        Self {
            xy: self.xy ^ signs,
            z: self.z ^ signs,
        }
    }
}

impl Mul<f64> for PackedVec3 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        let s = f64x2::splat(s);
        Self {
            xy: self.xy * s,
            z: self.z * s,
        }
    }
}

/// A rotation matrix, possibly scaled: nine numbers.
///
/// All but the last are among the first two of a column or of a row.
#[derive(Clone, Copy)]
pub(crate) struct PackedRotation {
    /// First two numbers of each column.
    columns: [f64x2; 3],
    /// First two numbers of each row.
    rows: [f64x2; 3],
    /// Last number.
    last: f64x2,
}

impl PackedRotation {
    /// Returns the matrix of `conj(a) b`, for `s` equal to two over the squares of both norms.
    ///
    /// Each quaternion has a vector part of three numbers and a scalar part.
    #[inline(always)]
    pub(crate) fn between(a: &[f64x2; 2], b: &[f64x2; 2], s: f64) -> Self {
        let [xy, zw] = quotient(a, b);
        Self::of(xy, zw, s)
    }

    /// Returns the matrix of a quaternion, for `s = 2 / |q|^2`.
    #[inline(always)]
    fn of(xy: f64x2, zw: f64x2, s: f64) -> Self {
        let s = f64x2::splat(s);
        let (xy_s, zw_s) = (xy * s, zw * s);
        let ((zs, _), (_, w)) = (duplicated(zw_s), duplicated(zw));
        let squares = xy * xy_s; // xx, yy
        let (zz, wz) = duplicated(zw * zs);
        let xz_yz = xy * zs; // xz, yz
        let quarter_turn = quarter_turn(xy_s * w); // -wy, wx
        let swapped = swapped(squares);
        let diagonal = f64x2::splat(1.0) - (swapped + zz);
        let xy_wz = duplicated(xy).0 * duplicated(xy_s).1 - mirrored(wz); // xy + wz, xy - wz
        let ([d, e], [plus, minus]) = (diagonal.to_array(), xy_wz.to_array());
        Self {
            columns: [f64x2::new([d, plus]), f64x2::new([minus, e]), xz_yz - quarter_turn],
            rows: [f64x2::new([d, minus]), f64x2::new([plus, e]), xz_yz + quarter_turn],
            last: f64x2::splat(1.0) - (squares + swapped),
        }
    }

    #[inline(always)]
    pub(crate) fn new(m: &Matrix3<f64>) -> Self {
        let pair = |x, y| f64x2::new([x, y]);
        Self {
            columns: [0, 1, 2].each(|k| pair(m[(0, k)], m[(1, k)])),
            rows: [0, 1, 2].each(|k| pair(m[(k, 0)], m[(k, 1)])),
            last: f64x2::splat(m[(2, 2)]),
        }
    }

    #[inline]
    pub(crate) fn matrix(&self) -> Matrix3<f64> {
        let [a, b, c] = self.columns.each(f64x2::to_array);
        let [x, y] = self.rows[2].to_array();
        Matrix3::new(a[0], b[0], c[0], a[1], b[1], c[1], x, y, first(self.last))
    }

    /// Returns the matrix times `v`.
    #[inline(always)]
    pub(crate) fn times(&self, v: PackedVec3) -> PackedVec3 {
        combined(&self.columns, self.rows[2], self.last, v)
    }

    /// Returns the transposed matrix times `v`.
    #[inline(always)]
    pub(crate) fn transposed_times(&self, v: PackedVec3) -> PackedVec3 {
        combined(&self.rows, self.columns[2], self.last, v)
    }
}

#[inline(always)]
fn combined(lines: &[f64x2; 3], third: f64x2, last: f64x2, v: PackedVec3) -> PackedVec3 {
    let ((x, y), (z, _)) = (duplicated(v.xy), duplicated(v.z));
    let products = third * v.xy;
    PackedVec3 {
        xy: lines[0] * x + lines[1] * y + lines[2] * z,
        z: products + swapped(products) + last * v.z,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tolerance::UNIT;
    use crate::rng::Rng;

    fn vector(rng: &mut Rng) -> Vector3<f64> {
        Vector3::from(rng.unit()) * 2f64.powi(rng.below(40) as i32 - 20)
    }

    #[test]
    fn roundings_are_those_of_the_plain_formulas() {
        let mut rng = Rng::new(17);
        for _ in 0..2000 {
            let (u, v, s) = (vector(&mut rng), vector(&mut rng), rng.range(-2.0, 2.0));
            let (a, b) = (PackedVec3::new(&u), PackedVec3::new(&v));
            assert_eq!((a + b).vector(), u + v);
            assert_eq!((a - b).vector(), u - v);
            assert_eq!((-a * s).vector(), -u * s);
            assert_eq!(a.cross(b).vector(), u.cross(&v));
            assert_eq!(a.dot(b), u.x * v.x + u.y * v.y + u.z * v.z);
            assert_eq!(a.one_norm(), u.x.abs() + u.y.abs() + u.z.abs());
            let with_spare = PackedVec3::with_spare(&u, s);
            assert_eq!((with_spare.spare(), with_spare.dot(b)), (s, a.dot(b)));
            let m = Matrix3::from_fn(|_, _| rng.range(-1.0, 1.0));
            let rotation = PackedRotation::new(&m);
            assert_eq!(rotation.matrix(), m);
            let row = |r: [f64; 3]| r[0] * v.x + r[1] * v.y + r[2] * v.z;
            let rows = |m: Matrix3<f64>| Vector3::from_fn(|k, _| row([m[(k, 0)], m[(k, 1)], m[(k, 2)]]));
            assert_eq!(rotation.times(b).vector(), rows(m));
            assert_eq!(rotation.transposed_times(b).vector(), rows(m.transpose()));
        }
    }

    #[test]
    fn a_rotation_between_two_quaternions_is_theirs() {
        let mut rng = Rng::new(18);
        let quaternion = |rng: &mut Rng| {
            let q = nalgebra::Vector4::from_fn(|_, _| rng.range(-1.0, 1.0)).normalize();
            nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_vector(q))
        };
        let lanes = |q: &nalgebra::UnitQuaternion<f64>| [f64x2::new([q.i, q.j]), f64x2::new([q.k, q.w])];
        for _ in 0..2000 {
            let (a, b) = (quaternion(&mut rng), quaternion(&mut rng));
            let m = PackedRotation::between(&lanes(&a), &lanes(&b), 2.0);
            let off = m.matrix() - (a.inverse() * b).to_rotation_matrix().into_inner();
            assert!(off.amax() < 32.0 * UNIT, "{off}");
            let v = vector(&mut rng);
            let size = v.norm();
            let there = m.transposed_times(m.times(PackedVec3::new(&v))).vector();
            assert!((there - v).norm() < 64.0 * UNIT * size);
        }
    }
}
