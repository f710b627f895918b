//! The convex hull of a mesh, and how well the hull fits the mesh.
//!
//! The gap of a point is its distance from the mesh. Over a triangle of the hull's surface the gap
//! has two upper bounds:
//!
//! - the gap of the centroid plus the radius of the triangle about the centroid;
//! - for any one triangle of the mesh, the greatest distance of the three vertices from it, because
//!   the distance from a convex set is a convex function.
//!
//! So the greatest gap over all triangles lies between a value found and such a bound. Halving the
//! triangles brings the two together ([`greatest`]).

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::fmt;
use nalgebra::{Point3, Vector3};

use super::Mesh;
use crate::base::callbacks::Watch;
use crate::base::num::Ranked;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::body::polyhedron::{BuildError, ConvexPolyhedron};
use crate::nonconvex::query::triangle::{self, Triangle};

/// Width of the gap's interval, as a fraction of half the diagonal of the mesh's box: 0.4 %.
pub(crate) const RESOLUTION: f64 = 1.0 / 256.0;

/// How much a convex hull adds to a mesh.
///
/// Lengths and volumes are in the caller's unit and are exact up to rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HullFit {
    /// Volume of the mesh; `None` if the mesh is open and bounds no volume.
    pub mesh_volume: Option<f64>,
    /// Volume of the hull.
    pub hull_volume: f64,
    /// Lower bound of the largest distance of the hull's surface from the mesh.
    ///
    /// A tested point of the hull's surface is that far from the mesh.
    pub gap_lower: f64,
    /// Upper bound of the same distance.
    ///
    /// It generally exceeds the lower bound by at most 0.4 % of half the diagonal of the mesh's
    /// box.
    pub gap_upper: f64,
}

impl HullFit {
    /// Returns the share of the hull's volume that is outside the mesh.
    ///
    /// The share is from 0 for a convex mesh to 1. It is `None` for an open mesh and for a hull
    /// without volume.
    #[must_use]
    pub fn void_fraction(&self) -> Option<f64> {
        let full = self.mesh_volume.filter(|_| self.hull_volume > 0.0)?;
        Some((1.0 - full / self.hull_volume).clamped(0.0, 1.0))
    }
}

impl fmt::Display for HullFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.void_fraction() {
            Some(void_fraction) => write!(f, "{:.1} % of the hull is air", 100.0 * void_fraction)?,
            None => f.write_str("the mesh is not closed")?,
        }
        write!(
            f,
            ", the largest gap is between {:.2e} and {:.2e}",
            self.gap_lower, self.gap_upper
        )
    }
}

impl Mesh {
    /// Returns the convex hull of the mesh.
    ///
    /// [`source_vertex`](ConvexPolyhedron::source_vertex) of the hull returns the caller's indices
    /// of the mesh. [`hull_fit`](Self::hull_fit) measures what the hull adds.
    ///
    /// # Errors
    ///
    /// Returns [`BuildError::Flat`] if all vertices of the mesh lie in one plane.
    pub fn hull(&self) -> Result<ConvexPolyhedron, BuildError> {
        let points: Vec<Point3<f64>> = self.points.iter().map(|p| self.given(p)).collect();
        let mut hull = ConvexPolyhedron::from_points(&points)?;
        for source in &mut hull.source {
            *source = self.source_points[*source as usize];
        }
        Ok(hull)
    }

    /// Measures how much a convex body adds to the mesh.
    ///
    /// The body is usually the [`hull`](Self::hull) of the mesh. The result has both volumes and
    /// the largest gap between the two surfaces. The call takes milliseconds for meshes of
    /// thousands of triangles.
    ///
    /// ```
    /// use lin_canny::Mesh;
    /// use lin_canny::nalgebra::Point3;
    ///
    /// // A cube of side 2 with one corner of side 1 cut out.
    /// let points: Vec<_> = [
    ///     [0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [0, 2, 2],
    ///     [2, 1, 1], [1, 2, 1], [1, 1, 1], [2, 1, 2], [1, 2, 2], [1, 1, 2], [2, 2, 1],
    /// ]
    /// .map(|p: [i32; 3]| Point3::from(p.map(f64::from)))
    /// .to_vec();
    /// let faces: [&[u32]; 9] = [
    ///     &[0, 3, 2, 1], &[0, 1, 5, 4], &[0, 4, 6, 3], &[4, 5, 10, 12, 11, 6],
    ///     &[1, 2, 13, 7, 10, 5], &[3, 6, 11, 8, 13, 2], &[7, 9, 12, 10],
    ///     &[9, 8, 11, 12], &[9, 7, 13, 8],
    /// ];
    /// let fan = |f: &&[u32]| {
    ///     let first = f[0];
    ///     f[1..].windows(2).map(move |w| [first, w[0], w[1]]).collect::<Vec<_>>()
    /// };
    /// let triangles: Vec<_> = faces.iter().flat_map(fan).collect();
    /// let mesh = Mesh::new(&points, &triangles)?;
    /// let fit = mesh.hull_fit(&mesh.hull()?);
    /// assert!((fit.mesh_volume.unwrap() - 7.0).abs() < 1e-12);
    /// assert!((fit.hull_volume - (8.0 - 1.0 / 6.0)).abs() < 1e-12);
    /// // The middle of the face that closes the notch is 2/3 from its walls.
    /// assert!(fit.gap_lower > 0.66 && fit.gap_upper < 0.68);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn hull_fit(&self, hull: &ConvexPolyhedron) -> HullFit {
        let (lower, upper) = self.gap(hull);
        HullFit {
            mesh_volume: self.is_solid().then(|| self.volume().abs()),
            hull_volume: hull.volume(),
            gap_lower: lower * self.unit(),
            gap_upper: upper * self.unit(),
        }
    }

    /// Returns bounds of the largest gap, in stored units.
    fn gap(&self, hull: &ConvexPolyhedron) -> (f64, f64) {
        let points: Vec<Vector3<f64>> = hull.vertex_points().map(|p| self.frame.stored(&p)).collect();
        let triangles = hull.triangles().map(|t| t.each(|v| points[v.index()]));
        let size = sqrt((self.high - self.low).norm_squared()) * 0.5;
        greatest(triangles, RESOLUTION * size, &mut Watch::none(), |corners, _| {
            let gap = self.gap_over(corners);
            (gap.at_centroid, gap.upper)
        })
    }

    /// Returns the gap of a triangle's centroid, and an upper bound of the gap over the triangle.
    ///
    /// The triangle is in stored coordinates.
    pub(crate) fn gap_over(&self, corners: &Triangle) -> GapOver {
        let [a, b, c] = corners;
        let centroid = (a + b + c) / 3.0;
        let nearest = self.nearest(&centroid);
        let at_centroid = sqrt(nearest.square);
        let greatest = |of: &dyn Fn(&Vector3<f64>) -> f64| sqrt(corners.iter().map(of).fold(0.0, f64::larger));
        let radius = greatest(&|p| (p - centroid).norm_squared());
        let other = self.corners(nearest.triangle);
        let by_triangle = greatest(&|p| triangle::nearest(p, &other).0);
        GapOver {
            centroid,
            at_centroid,
            radius,
            upper: (at_centroid + radius).smaller(by_triangle),
        }
    }
}

/// The distance of a triangle from a mesh, in stored units.
pub(crate) struct GapOver {
    pub(crate) centroid: Vector3<f64>,
    pub(crate) at_centroid: f64,
    /// The largest distance of a vertex from the centroid.
    pub(crate) radius: f64,
    /// Upper bound of the gap of every point of the triangle.
    pub(crate) upper: f64,
}

/// Maximum number of triangles that are halved: a tenth of a second or more.
const HALVED: usize = 1 << 16;

/// A triangle whose bound exceeds the greatest value found by less than this fraction of the
/// resolution is not halved further.
const ENOUGH: f64 = 1.0 / 16.0;

/// A triangle, ranked by the negative of an upper bound over the triangle.
type Open = Ranked<(), Triangle>;

/// Bounds the greatest value of a non-negative function over triangles.
///
/// `judge` returns a lower bound of the value at some point of a triangle, and an upper bound over
/// the triangle. The upper bound must tend to the value as the triangle shrinks. The second
/// argument of `judge` is the greatest value found so far plus a small margin: `judge` need not
/// tighten an upper bound that is below it.
///
/// The triangle with the greatest bound is halved first (branch and bound: Land and Doig 1960),
/// until no bound exceeds the greatest value found by more than `resolution`. The watch counts
/// tested triangles. If the callback stops the search, the result is meaningless.
pub(crate) fn greatest(
    triangles: impl Iterator<Item = Triangle>,
    resolution: f64,
    watch: &mut Watch<'_>,
    mut judge: impl FnMut(&Triangle, f64) -> (f64, f64),
) -> (f64, f64) {
    let (mut lower, mut settled, mut open, mut done) = (0.0f64, 0.0f64, BinaryHeap::new(), 0);
    let mut examine = |corners: Triangle, open: &mut BinaryHeap<Open>| {
        let (value, upper) = judge(&corners, lower + ENOUGH * resolution);
        lower = lower.larger(value);
        if upper > lower + resolution {
            open.push(Ranked {
                rank: -upper,
                key: (),
                item: corners,
            });
        } else {
            settled = settled.larger(upper);
        }
        lower
    };
    let mut reached = 0.0;
    for corners in triangles {
        reached = examine(corners, &mut open);
        done += 1;
        if !watch.done(done) {
            return (lower, f64::INFINITY);
        }
    }
    for halved in 0..HALVED {
        let widest = open.peek().filter(|t| -t.rank > reached + resolution);
        let Some(widest) = widest.filter(|_| watch.done(done + halved)) else {
            break;
        };
        let halves = halves(&widest.item);
        open.pop();
        for half in halves {
            reached = examine(half, &mut open);
        }
    }
    (
        lower,
        open.peek().map_or(0.0, |t| -t.rank).larger(settled).larger(lower),
    )
}

/// Returns the two halves of a triangle, cut at the midpoint of the longest side.
fn halves([a, b, c]: &Triangle) -> [Triangle; 2] {
    let ends = [(a, b, c), (b, c, a), (c, a, b)];
    let long = |(p, q, _): (&nalgebra::Vector3<f64>, &nalgebra::Vector3<f64>, _)| (q - p).norm_squared();
    let longest = ends.into_iter().reduce(|x, y| {
        if long((y.0, y.1, y.2)) > long((x.0, x.1, x.2)) {
            y
        } else {
            x
        }
    });
    let (a, b, c) = longest.unwrap_or((a, b, c));
    let middle = (a + b) * 0.5;
    [[*a, middle, *c], [middle, *b, *c]]
}
