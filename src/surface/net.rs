//! One Bézier patch, given by its control points.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Unit, Vector3};

use super::bezier::{Jet, ORDER, jet, value};
use super::error::SurfaceError;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{PATCH_MAX, RAISED, ROUND_UP, WEIGHT_RATIO};

/// A Bézier patch of degrees 1 to 7: tensor-product or triangular, polynomial or rational.
///
/// Weights are positive.
///
/// Coordinates are in the caller's unit and in the frame of the surface that the patch belongs to.
/// Parameters u and v are between 0 and 1. The patch is immutable.
///
/// A triangular patch is stored as the tensor-product patch of equal degrees whose row `u = 0` is
/// its first vertex (Goldman and Filip 1987). The point at (u, v) has the barycentric coordinates
/// `(1 - u, u (1 - v), u v)`.
///
/// ```
/// use lin_canny::nalgebra::Point3;
/// use lin_canny::surface::BezierPatch;
///
/// // A quarter of a cylinder of radius 1 about z, between z = 0 and z = 2.
/// let (one, half) = (1.0, 0.5_f64.sqrt());
/// let arc = [(1.0, 0.0, one), (1.0, 1.0, half), (0.0, 1.0, one)];
/// let row = |z: f64| arc.map(|(x, y, _)| Point3::new(x, y, z));
/// let points = [row(0.0), row(2.0)].concat();
/// let weights = [arc.map(|a| a.2); 2].concat();
/// let patch = BezierPatch::rational([1, 2], &points, &weights)?;
/// let p = patch.point(0.5, 0.5);
/// assert!((p.x.hypot(p.y) - 1.0).abs() < 1e-15 && p.z == 1.0);
/// # Ok::<(), lin_canny::surface::SurfaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "super::persist::StoredPatch", into = "super::persist::StoredPatch")
)]
pub struct BezierPatch {
    pub(super) degrees: [usize; 2],
    /// Weight times point, and the weight; the largest weight is about one.
    pub(super) net: Vec<[f64; 4]>,
    pub(super) is_rational: bool,
    pub(super) is_triangular: bool,
    /// Error of the control points, as a multiple of `reach`.
    pub(super) noise: f64,
    /// The largest distance of a control point from the origin, rounded up.
    ///
    /// If the net was computed from given control points, they count too, because rounding is
    /// relative to the terms of the sums.
    pub(super) reach: f64,
}

/// Value, first and second derivatives at a point of a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceJet {
    pub(super) point: Vector3<f64>,
    pub(super) u: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) uu: Vector3<f64>,
    pub(super) uv: Vector3<f64>,
    pub(super) vv: Vector3<f64>,
}

impl BezierPatch {
    /// Returns the polynomial patch of degrees `[p, q]` in u and v.
    ///
    /// It has `(p + 1) (q + 1)` control points. They are given row by row; u is constant in a row
    /// and v runs along it.
    ///
    /// # Errors
    ///
    /// Returns an error if a degree is not between 1 and 7, if the number of points does not fit,
    /// or if a coordinate is not finite or beyond `2^200`.
    pub fn polynomial(degrees: [usize; 2], points: &[Point3<f64>]) -> Result<Self, SurfaceError> {
        check_tensor(degrees, points)?;
        Ok(Self::assembled(degrees, homogeneous(points, None)))
    }

    /// Returns the rational patch of degrees `[p, q]`, with a weight for each control point.
    ///
    /// Points and weights are in the order of [`polynomial`](Self::polynomial).
    ///
    /// # Errors
    ///
    /// Returns the errors of [`polynomial`](Self::polynomial). Also returns an error if the number
    /// of weights does not fit, or if a weight is not positive and finite or is below `2^-40` of
    /// the largest.
    pub fn rational(degrees: [usize; 2], points: &[Point3<f64>], weights: &[f64]) -> Result<Self, SurfaceError> {
        check_tensor(degrees, points)?;
        let scale = check_weights(weights, points.len())?;
        Ok(Self::assembled(degrees, homogeneous(points, Some((weights, scale)))))
    }

    /// Returns the triangular patch of a degree; without weights it is polynomial.
    ///
    /// Its `(n + 1)(n + 2) / 2` control points are given row by row from the first vertex: row r
    /// has `r + 1` points.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`rational`](Self::rational).
    pub fn triangular(degree: usize, points: &[Point3<f64>], weights: Option<&[f64]>) -> Result<Self, SurfaceError> {
        check_degrees([degree; 2])?;
        check_points(points, (degree + 1) * (degree + 2) / 2)?;
        let scaled = match weights {
            Some(w) => Some((w, check_weights(w, points.len())?)),
            None => None,
        };
        let given = homogeneous(points, scaled);
        let mut net = Vec::with_capacity((degree + 1) * (degree + 1));
        for r in 0..=degree {
            let mut row = [[0.0; 4]; ORDER];
            row[..=r].copy_from_slice(&given[r * (r + 1) / 2..][..=r]);
            (r..degree).for_each(|n| raise(&mut row, n));
            net.extend_from_slice(&row[..=degree]);
        }
        let mut patch = Self::assembled([degree; 2], net);
        patch.is_triangular = true;
        patch.reach = patch.reach.larger(reach(points));
        patch.noise = if degree > 1 { RAISED } else { 0.0 };
        Ok(patch)
    }

    /// Returns the patch of a checked control net.
    pub(super) fn assembled(degrees: [usize; 2], net: Vec<[f64; 4]>) -> Self {
        let is_rational = net.iter().any(|h| h[3] != 1.0);
        let mut patch = Self {
            degrees,
            net,
            is_rational,
            is_triangular: false,
            noise: 0.0,
            reach: 0.0,
        };
        let points: Vec<_> = patch.control_points().map(|(p, _)| p).collect();
        patch.reach = reach(&points);
        patch
    }

    /// Returns the degrees in u and v.
    #[must_use]
    pub fn degrees(&self) -> [usize; 2] {
        self.degrees
    }

    /// Returns whether the weights differ.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.is_rational
    }

    /// Returns whether the patch was given as a triangular one.
    #[must_use]
    pub fn is_triangular(&self) -> bool {
        self.is_triangular
    }

    /// Returns the control points and weights of the tensor-product form.
    ///
    /// The weights are determined up to a common factor.
    pub fn control_points(&self) -> impl ExactSizeIterator<Item = (Point3<f64>, f64)> + '_ {
        self.net
            .iter()
            .map(|[x, y, z, w]| (Point3::new(x / w, y / w, z / w), *w))
    }

    /// Returns the point at (u, v); parameters are clamped to 0..=1.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let [x, y, z, w] = value::<4>(&self.net, self.degrees, [u, v].each(|t| t.clamped(0.0, 1.0)));
        if self.is_rational {
            Point3::new(x / w, y / w, z / w)
        } else {
            Point3::new(x, y, z)
        }
    }

    /// Returns the derivatives by u and by v at (u, v); parameters are clamped to 0..=1.
    #[must_use]
    pub fn tangents(&self, u: f64, v: f64) -> [Vector3<f64>; 2] {
        let jet = self.jet([u, v]);
        [jet.u, jet.v]
    }

    /// Returns the unit normal at (u, v).
    ///
    /// It is the direction of the cross product of the derivatives by u and by v. If the product is
    /// zero there, as at a pole, the normal is computed at a point a little inside the patch. The
    /// result is `None` if the product is zero there as well.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let inside = |t: f64| t.clamped(0.0, 1.0) + (0.5 - t.clamped(0.0, 1.0)) / 65_536.0;
        [[u, v], [inside(u), inside(v)]].into_iter().find_map(|at| {
            let jet = self.jet(at);
            let n = jet.u.cross(&jet.v);
            let square = n.norm_squared();
            let least = jet.u.norm_squared() * jet.v.norm_squared() * crate::base::tolerance::PARALLEL;
            (square > least && square.is_normal()).then(|| Unit::new_unchecked(n / sqrt(square)))
        })
    }

    /// Returns the two halves of the patch at the middle of u (`direction` 0) or of v (any other).
    ///
    /// De Casteljau's algorithm computes them. The halves are patches whose control points are
    /// rounded. The halves of a triangular patch are tensor-product patches.
    #[must_use]
    pub fn split(&self, direction: usize) -> [Self; 2] {
        let count = self.net.len();
        let mut parts = [vec![[0.0; 4]; count], vec![[0.0; 4]; count]];
        for k in 0..4 {
            let plane: Vec<f64> = self.net.iter().map(|h| h[k]).collect();
            let (mut low, mut high) = (vec![0.0; count], vec![0.0; count]);
            super::bezier::halves(&plane, self.degrees, direction.min(1) as u8, &mut low, &mut high);
            for (part, plane) in parts.iter_mut().zip([low, high]) {
                part.iter_mut().zip(plane).for_each(|(h, x)| h[k] = x);
            }
        }
        parts.each(|net| {
            let half = Self::assembled(self.degrees, net);
            let reach = half.reach.larger(self.reach);
            Self {
                noise: self.noise,
                is_triangular: false,
                reach,
                ..half
            }
        })
    }

    /// Returns the smallest box that contains the control points; it contains the patch.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let start = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
        self.control_points()
            .fold(start, |(low, high), (p, _)| (low.smaller(p), high.larger(p)))
    }

    pub(super) fn jet(&self, at: [f64; 2]) -> SurfaceJet {
        let at = at.each(|t| t.clamped(0.0, 1.0));
        let Jet {
            value,
            u,
            v,
            uu,
            uv,
            vv,
        } = jet::<4>(&self.net, self.degrees, at);
        let xyz = |h: &[f64; 4]| Vector3::new(h[0], h[1], h[2]);
        if !self.is_rational {
            let [point, u, v, uu, uv, vv] = [value, u, v, uu, uv, vv].each(|h| xyz(&h));
            return SurfaceJet {
                point,
                u,
                v,
                uu,
                uv,
                vv,
            };
        }
        let w = value[3];
        let point = xyz(&value) / w;
        let first = |h: &[f64; 4]| (xyz(h) - point * h[3]) / w;
        let (pu, pv) = (first(&u), first(&v));
        SurfaceJet {
            point,
            u: pu,
            v: pv,
            uu: first(&uu) - pu * (2.0 * u[3] / w),
            uv: first(&uv) - pu * (v[3] / w) - pv * (u[3] / w),
            vv: first(&vv) - pv * (2.0 * v[3] / w),
        }
    }
}

/// Returns the largest distance of a point from the origin, rounded up.
pub(super) fn reach(points: &[Point3<f64>]) -> f64 {
    let far = |p: &Point3<f64>| sqrt(p.coords.norm_squared()) * ROUND_UP;
    points.iter().map(far).fold(0.0, f64::larger)
}

/// Raises the degree of a curve from n to n + 1.
pub(crate) fn raise(row: &mut [[f64; 4]; ORDER], n: usize) {
    let m = (n + 1) as f64;
    row[n + 1] = row[n];
    for j in (1..=n).rev() {
        let (s, t) = ((n + 1 - j) as f64 / m, j as f64 / m);
        row[j] = core::array::from_fn(|k| s * row[j][k] + t * row[j - 1][k]);
    }
}

pub(super) fn homogeneous(points: &[Point3<f64>], weights: Option<(&[f64], f64)>) -> Vec<[f64; 4]> {
    let weight = |k: usize| weights.map_or(1.0, |(w, scale)| w[k] * scale);
    let of = |(k, p): (usize, &Point3<f64>)| {
        let w = weight(k);
        [w * p.x, w * p.y, w * p.z, w]
    };
    points.iter().enumerate().map(of).collect()
}

fn check_tensor(degrees: [usize; 2], points: &[Point3<f64>]) -> Result<(), SurfaceError> {
    check_degrees(degrees)?;
    check_points(points, (degrees[0] + 1) * (degrees[1] + 1))
}

pub(super) fn check_degrees(degrees: [usize; 2]) -> Result<(), SurfaceError> {
    match (0..2).find(|&k| !(1..ORDER).contains(&degrees[k])) {
        Some(direction) => Err(SurfaceError::Degree {
            direction,
            degree: degrees[direction],
        }),
        None => Ok(()),
    }
}

pub(super) fn check_points(points: &[Point3<f64>], expected: usize) -> Result<(), SurfaceError> {
    let given = points.len();
    if given != expected {
        return Err(SurfaceError::Count { given, expected });
    }
    for (index, p) in points.iter().enumerate() {
        // NaN fails the comparison.
        if let Some(axis) = (0..3).find(|&k| !(p[k].abs() <= PATCH_MAX)) {
            let value = p[axis];
            return Err(SurfaceError::Coordinate { index, axis, value });
        }
    }
    Ok(())
}

/// Checks the weights and returns the power of two that brings the largest weight near one.
pub(super) fn check_weights(weights: &[f64], expected: usize) -> Result<f64, SurfaceError> {
    let given = weights.len();
    if given != expected {
        return Err(SurfaceError::WeightCount { given, expected });
    }
    let largest = weights.iter().copied().fold(0.0, f64::larger);
    let is_bad = |w: f64| !((1.0 / PATCH_MAX..=PATCH_MAX).contains(&w) && w >= largest * WEIGHT_RATIO);
    match weights.iter().position(|&w| is_bad(w)) {
        Some(index) => Err(SurfaceError::Weight {
            index,
            value: weights[index],
        }),
        None => {
            let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
            Ok(crate::body::polyhedron::power_of_two(-exponent))
        }
    }
}
