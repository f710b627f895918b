//! Surfaces of revolution.

use alloc::vec::Vec;
use nalgebra::Point3;

use super::error::PatchError;
use super::net::Patch;
use super::surface::Surface;
use crate::base::num::scalar::sqrt;

/// Returns the surface that some Bezier curves sweep in a turn about z.
///
/// A curve is given by its control points `[radius, height, weight]`, and swept through four
/// quarters of a turn, each a rational patch of degree 2 in v (Piegl and Tiller 1997, "The NURBS
/// Book", section 8.5); u runs along the curve. The patches of a curve follow each other. The
/// weight of the middle of a quarter is the root of 1/2, rounded: circles are round to some UNIT of
/// their radius.
///
/// # Errors
///
/// No curve; a curve with fewer than two or more than eight control points, with a coordinate or
/// weight out of range: the error names points of the first patch of the curve, three for each
/// point of the curve.
///
/// ```
/// // A cone frustum and a half of a ball below.
/// let half = 0.5_f64.sqrt();
/// let side: &[[f64; 3]] = &[[1.0, 0.0, 1.0], [0.5, 2.0, 1.0]];
/// let bowl: &[[f64; 3]] =
///     &[[0.0, -1.0, 1.0], [1.0, -1.0, half], [1.0, 0.0, 1.0]];
/// let surface = lin_canny::patch::revolution(&[bowl, side])?;
/// assert_eq!(surface.patches().len(), 8);
/// # Ok::<(), lin_canny::patch::PatchError>(())
/// ```
pub fn revolution(curves: &[&[[f64; 3]]]) -> Result<Surface, PatchError> {
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
            patches.push(Patch::rational([curve.len().wrapping_sub(1), 2], &points, &all)?);
        }
    }
    Surface::new(patches)
}

/// Returns a point turned by quarters of a turn.
fn turned([x, y]: &[f64; 2], quarters: usize) -> [f64; 2] {
    match quarters {
        0 => [*x, *y],
        1 => [-y, *x],
        2 => [-x, -y],
        _ => [*y, -x],
    }
}
