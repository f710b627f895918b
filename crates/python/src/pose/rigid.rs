//! Rigid motions from 16 or 7 numbers, and what is wrong with others.

use std::ops::Range;

use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// Largest accepted entry of `R^T R - 1`, and of `|q|^2 - 1`: poses in single precision pass.
const ORTHONORMAL: f64 = 1e-6;

/// A quaternion whose squared norm is this near to one is left as given.
const UNIT: f64 = 1e-15;

/// Returns the pose of a row-major matrix; `None` unless it is a rigid motion.
#[inline]
pub(crate) fn of_matrix(m: &[f64; 16]) -> Option<Isometry3<f64>> {
    let (q, largest) = quaternion_of(m);
    let n = q.norm_squared();
    // `n` is four times `largest` for a rotation, and far from it for a reflection.
    let is_rigid = skewness(m) <= ORTHONORMAL && (n - 4.0 * largest).abs() <= 1e-3 && m[12..] == [0.0, 0.0, 0.0, 1.0];
    let rotation = UnitQuaternion::new_unchecked(q * (1.0 / n.sqrt()));
    is_rigid.then(|| Isometry3::from_parts(Translation3::new(m[3], m[7], m[11]), rotation))
}

/// Returns the quaternion of a rotation matrix times twice the root of its largest component, and
/// that component (Shepperd 1978).
#[inline]
fn quaternion_of(m: &[f64; 16]) -> (Quaternion<f64>, f64) {
    let [a, b, c, _, d, e, f, _, g, h, i, ..] = *m;
    let trace = a + e + i;
    if trace > 0.0 {
        (Quaternion::new(1.0 + trace, h - f, c - g, d - b), 1.0 + trace)
    } else if a >= e && a >= i {
        (Quaternion::new(h - f, 1.0 + a - e - i, b + d, c + g), 1.0 + a - e - i)
    } else if e >= i {
        (Quaternion::new(c - g, b + d, 1.0 - a + e - i, f + h), 1.0 - a + e - i)
    } else {
        (Quaternion::new(d - b, c + g, f + h, 1.0 - a - e + i), 1.0 - a - e + i)
    }
}

/// Returns the largest entry of `R^T R - 1`, NaN if any is.
#[inline]
fn skewness(m: &[f64; 16]) -> f64 {
    let [a, b, c, _, d, e, f, _, g, h, i, ..] = *m;
    let entries = [
        a * a + d * d + g * g - 1.0,
        b * b + e * e + h * h - 1.0,
        c * c + f * f + i * i - 1.0,
        a * b + d * e + g * h,
        a * c + d * f + g * i,
        b * c + e * f + h * i,
    ];
    entries
        .iter()
        .fold(0.0, |worst: f64, v| if v.abs() <= worst { worst } else { v.abs() })
}

/// Returns what is wrong with a matrix that is no rigid motion.
#[cold]
pub(crate) fn fault_of_matrix(m: &[f64; 16]) -> String {
    let worst = skewness(m);
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        format!("last row of a 4x4 pose is {:?} (expected [0, 0, 0, 1])", &m[12..])
    } else if !(worst <= ORTHONORMAL) {
        format!(
            "rotation of a pose is not orthonormal: an entry of R^T R - 1 is {worst:.1e} (expected {ORTHONORMAL:.0e})"
        )
    } else {
        "rotation of a pose is a reflection: its determinant is negative".into()
    }
}

/// Returns the pose of a position and a quaternion xyzw; `None` unless it is a rigid motion.
#[inline]
pub(crate) fn of_seven(v: &[f64; 7]) -> Option<Isometry3<f64>> {
    let [x, y, z, qx, qy, qz, qw] = *v;
    let q = Quaternion::new(qw, qx, qy, qz);
    let n = q.norm_squared();
    let unit = if (n - 1.0).abs() <= UNIT {
        q
    } else {
        q * (1.0 / n.sqrt())
    };
    let rotation = UnitQuaternion::new_unchecked(unit);
    ((n - 1.0).abs() <= ORTHONORMAL).then(|| Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

/// Returns what is wrong with seven numbers that are no rigid motion.
#[cold]
pub(crate) fn fault_of_seven(v: &[f64; 7]) -> String {
    let n: f64 = v[3..].iter().map(|c| c * c).sum();
    format!("quaternion (x, y, z, w) is not of unit length: its squared norm is {n} (expected 1 to {ORTHONORMAL:.0e})")
}

#[inline]
fn relative(pose: Option<Isometry3<f64>>) -> Option<RelativePose> {
    RelativePose::from_isometry(&pose?).ok()
}

/// The poses of a batch, without the lock of the interpreter.
#[derive(Clone, Copy)]
pub(crate) enum PoseView<'a> {
    /// Row-major matrices.
    Matrices(&'a [[f64; 16]]),
    /// Positions and quaternions xyzw.
    Sevens(&'a [[f64; 7]]),
}

impl PoseView<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Matrices(m) => m.len(),
            Self::Sevens(v) => v.len(),
        }
    }

    /// Returns a pose; `None` unless it is a rigid motion.
    #[inline]
    pub(crate) fn isometry(&self, k: usize) -> Option<Isometry3<f64>> {
        match self {
            Self::Matrices(m) => of_matrix(&m[k]),
            Self::Sevens(v) => of_seven(&v[k]),
        }
    }

    /// Reads poses as those of B in the frame of A.
    ///
    /// # Errors
    /// The index of a pose that is no rigid motion in range.
    pub(crate) fn read(&self, range: Range<usize>, to: &mut Vec<RelativePose>) -> Result<(), usize> {
        to.clear();
        let first = range.start;
        let count = range.len();
        match self {
            Self::Matrices(m) => to.extend(m[range].iter().map_while(|m| relative(of_matrix(m)))),
            Self::Sevens(v) => to.extend(v[range].iter().map_while(|v| relative(of_seven(v)))),
        }
        if to.len() == count {
            Ok(())
        } else {
            Err(first + to.len())
        }
    }

    /// Returns what is wrong with a pose, and its index.
    #[cold]
    pub(crate) fn fault(&self, k: usize) -> String {
        let fault = match self {
            Self::Matrices(m) => fault_of_matrix(&m[k]),
            Self::Sevens(v) => fault_of_seven(&v[k]),
        };
        let range = self.isometry(k).and_then(|p| RelativePose::from_isometry(&p).err());
        format!("pose {k}: {}", range.map_or(fault, |e| e.to_string()))
    }
}
