//! NURBS surfaces split into Bézier patches, and surfaces of revolution.
//!
//! Between two different knots a B-spline is a polynomial. Its control points are the values of its
//! blossom at the two knots (Ramshaw 1989). They are also what repeated insertion of both knots
//! produces between the knots (Boehm 1980; Piegl and Tiller 1997, "The NURBS Book", algorithms A5.6
//! and A5.7). De Boor's algorithm with one argument per step computes a value of the blossom by
//! convex combinations, so errors are relative to the control points
//! (`tolerance::KNOTS`).

use alloc::vec::Vec;
use nalgebra::Point3;

use super::bezier::{NET, ORDER};
use super::bezier_surface::BezierSurface;
use super::error::SurfaceError;
use super::net::{BezierPatch, check_degrees, check_points, check_weights, homogeneous, reach};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{KNOTS, PATCH_MAX};

/// A NURBS surface in the form in which files store it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nurbs<'a> {
    /// The degrees in u and v, 1 to 7.
    pub degrees: [usize; 2],
    /// The knots in u and v, in non-decreasing order.
    ///
    /// The surface is defined from the knot of index `degree` to the knot that is followed by
    /// `degree` knots. End knots need not be repeated.
    pub knots: [&'a [f64]; 2],
    /// The control points, row by row; u is constant in a row and v runs along it.
    pub points: &'a [Point3<f64>],
    /// A weight for each control point; `None` if all are equal.
    pub weights: Option<&'a [f64]>,
    /// The number of trimming curves; [`BezierSurface::from_nurbs`] returns an error if it is not
    /// zero.
    pub trimming_curves: usize,
}

/// A span between knots: the index of its first knot, and its ends.
pub(crate) struct Span {
    pub(crate) knot: usize,
    pub(crate) ends: [f64; 2],
}

/// A Bézier patch of a NURBS surface, and the knots in u and v that bound the patch.
type KnotPatch = (BezierPatch, [[f64; 2]; 2]);

impl Nurbs<'_> {
    /// Returns the Bézier patches; patches of equal u follow each other.
    pub(super) fn patches(&self) -> Result<Vec<KnotPatch>, SurfaceError> {
        if self.trimming_curves > 0 {
            let curves = self.trimming_curves;
            return Err(SurfaceError::Trimmed { curves });
        }
        check_degrees(self.degrees)?;
        let counts = self.counts()?;
        check_points(self.points, counts[0] * counts[1])?;
        let weights = match self.weights {
            Some(w) => Some((w, check_weights(w, self.points.len())?)),
            None => None,
        };
        let spans = [self.spans(0)?, self.spans(1)?];
        let (given, reach) = (homogeneous(self.points, weights), reach(self.points));
        let mut parts = Vec::with_capacity(spans[0].len() * spans[1].len());
        for u in &spans[0] {
            for v in &spans[1] {
                let mut patch = BezierPatch::assembled(self.degrees, self.taken_out(&given, counts[1], [u, v]));
                patch.noise = KNOTS;
                patch.reach = patch.reach.larger(reach);
                parts.push((patch, [u.ends, v.ends]));
            }
        }
        Ok(parts)
    }

    /// Returns the numbers of control points in u and v.
    fn counts(&self) -> Result<[usize; 2], SurfaceError> {
        let mut counts = [0; 2];
        for direction in 0..2 {
            let (given, degree) = (self.knots[direction].len(), self.degrees[direction]);
            if given < 2 * degree + 2 {
                return Err(SurfaceError::KnotCount {
                    direction,
                    given,
                    expected: 2 * degree + 2,
                });
            }
            counts[direction] = given - degree - 1;
        }
        Ok(counts)
    }

    /// Returns the non-empty spans in a direction.
    fn spans(&self, direction: usize) -> Result<Vec<Span>, SurfaceError> {
        let (knots, degree) = (self.knots[direction], self.degrees[direction]);
        for (index, &value) in knots.iter().enumerate() {
            let is_early = index > 0 && value < knots[index - 1];
            // More than `most` equal knots tear the surface inside, and are too many at an end.
            let is_inside = value > knots[degree] && value < knots[knots.len() - degree - 1];
            let most = if is_inside { degree } else { degree + 1 };
            let is_torn = index >= most && value == knots[index - most];
            if !(value.abs() <= PATCH_MAX) || is_early || is_torn {
                return Err(SurfaceError::Knot {
                    direction,
                    index,
                    value,
                });
            }
        }
        let span = |knot: usize| Span {
            knot,
            ends: [knots[knot], knots[knot + 1]],
        };
        let spans: Vec<Span> = (degree..knots.len() - degree - 1)
            .map(span)
            .filter(|s| s.ends[0] < s.ends[1])
            .collect();
        if spans.is_empty() {
            let value = knots[degree];
            return Err(SurfaceError::Knot {
                direction,
                index: degree,
                value,
            });
        }
        Ok(spans)
    }

    /// Returns the control points of the patch in a pair of spans.
    fn taken_out(&self, given: &[[f64; 4]], width: usize, [u, v]: [&Span; 2]) -> Vec<[f64; 4]> {
        let [p, q] = self.degrees;
        let mut rows = [[0.0; 4]; NET];
        for i in 0..=p {
            let from = (u.knot - p + i) * width + v.knot - q;
            for j in 0..=q {
                rows[i * (q + 1) + j] = blossom(&given[from..][..=q], self.knots[1], v, j);
            }
        }
        let mut net = Vec::with_capacity((p + 1) * (q + 1));
        for i in 0..=p {
            for j in 0..=q {
                let mut column = [[0.0; 4]; ORDER];
                (0..=p).for_each(|k| column[k] = rows[k * (q + 1) + j]);
                net.push(blossom(&column[..=p], self.knots[0], u, i));
            }
        }
        net
    }
}

/// Returns a value of the blossom at the two ends of a span.
///
/// The lower end is the argument `degree - upper` times, the upper end `upper` times.
pub(crate) fn blossom(points: &[[f64; 4]], knots: &[f64], span: &Span, upper: usize) -> [f64; 4] {
    let degree = points.len() - 1;
    let mut d = [[0.0; 4]; ORDER];
    d[..=degree].copy_from_slice(points);
    for level in 1..=degree {
        let t = span.ends[usize::from(level <= upper)];
        for i in (level..=degree).rev() {
            let (low, high) = (knots[span.knot + i - degree], knots[span.knot + 1 + i - level]);
            let (s, r) = ((high - t) / (high - low), (t - low) / (high - low));
            d[i] = core::array::from_fn(|k| s * d[i - 1][k] + r * d[i][k]);
        }
    }
    d[degree]
}

/// Returns the surface that Bézier curves sweep in a full rotation about z.
///
/// A curve is given by its control points `[radius, height, weight]`. It is swept through four
/// quarters, each a rational patch of degree 2 in v (Piegl and Tiller 1997, "The NURBS Book",
/// section 8.5); u runs along the curve. The patches of a curve follow each other. The weight of
/// the middle control point of a quarter is the square root of 1/2, rounded, so the error of
/// circles is a few UNIT of their radius.
///
/// # Errors
///
/// Returns an error if there is no curve, if a curve has fewer than two or more than eight control
/// points, or if a coordinate or weight is out of range. The error counts points of the first patch
/// of the curve, three for each point of the curve.
///
/// ```
/// // A cone frustum and a half of a ball below.
/// let half = 0.5_f64.sqrt();
/// let side: &[[f64; 3]] = &[[1.0, 0.0, 1.0], [0.5, 2.0, 1.0]];
/// let bowl: &[[f64; 3]] =
///     &[[0.0, -1.0, 1.0], [1.0, -1.0, half], [1.0, 0.0, 1.0]];
/// let surface = lin_canny::surface::revolution(&[bowl, side])?;
/// assert_eq!(surface.patches().len(), 8);
/// # Ok::<(), lin_canny::surface::SurfaceError>(())
/// ```
pub fn revolution(curves: &[&[[f64; 3]]]) -> Result<BezierSurface, SurfaceError> {
    let corners = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let weights = [1.0, sqrt(0.5), 1.0];
    let mut patches = Vec::with_capacity(4 * curves.len());
    for curve in curves {
        for quarter in 0..4 {
            let mut points = Vec::with_capacity(3 * curve.len());
            let mut all = Vec::with_capacity(3 * curve.len());
            for [radius, height, weight] in *curve {
                for (corner, w) in corners.iter().zip(weights) {
                    let [x, y] = turned(corner, quarter);
                    points.push(Point3::new(radius * x, radius * y, *height));
                    all.push(weight * w);
                }
            }
            patches.push(BezierPatch::rational([curve.len().wrapping_sub(1), 2], &points, &all)?);
        }
    }
    BezierSurface::new(patches)
}

/// Returns a point rotated by quarters of a full rotation.
fn turned([x, y]: &[f64; 2], quarters: usize) -> [f64; 2] {
    match quarters {
        0 => [*x, *y],
        1 => [-y, *x],
        2 => [-x, -y],
        _ => [*y, -x],
    }
}
