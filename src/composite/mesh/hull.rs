//! The convex hull of a mesh, and how well the hull fits.
//!
//! The gap of a point is its distance from the mesh. Over a triangle of the hull's surface the gap
//! is at most the gap of the centroid plus the radius of the triangle about the centroid, and at
//! most the greatest distance of the three vertices from any one triangle of the mesh, because the
//! distance from a convex set is a convex function. Triangles are halved, the one with the greatest
//! bound first (branch and bound: Land and Doig 1960), until no bound exceeds the greatest gap
//! found by more than the resolution.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt;
use core::ops::Range;

use nalgebra::{Point3, Vector3};

use super::Mesh;
use crate::num::scalar::sqrt;
use crate::polyhedron::{BuildError, ConvexPolyhedron, bounding_box};

/// Triangles of the mesh that share a box. Not measured.
const GROUP: usize = 32;

/// The gap is bracketed to this part of half the diagonal of the mesh's box: 0.4 %.
const RESOLUTION: f64 = 1.0 / 256.0;

/// Triangles of the hull that are examined at most; a tenth of a second and more. Not measured.
const EXAMINED: usize = 1 << 16;

/// How much a convex hull adds to a mesh. Lengths and volumes are in the caller's unit, right up to
/// rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HullFit {
    /// Volume of the mesh; `None` if the mesh is a surface and bounds no volume.
    pub mesh_volume: Option<f64>,
    /// Volume of the hull.
    pub hull_volume: f64,
    /// Largest distance of a point of the hull's surface from the mesh: a lower bound, met by a
    /// point examined.
    pub gap_lower: f64,
    /// Upper bound of the same distance, in general at most 0.4 % of half the diagonal of the
    /// mesh's box above the lower bound.
    pub gap_upper: f64,
}

impl HullFit {
    /// Returns the share of the hull's volume that is not in the mesh, from 0 for a convex mesh to
    /// 1; `None` for a surface, and for a hull without volume.
    #[must_use]
    pub fn air(&self) -> Option<f64> {
        let full = self.mesh_volume.filter(|_| self.hull_volume > 0.0)?;
        Some((1.0 - full / self.hull_volume).clamp(0.0, 1.0))
    }
}

impl fmt::Display for HullFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.air() {
            Some(air) => write!(f, "{:.1} % of the hull is air", 100.0 * air)?,
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
    /// Returns the convex hull of the mesh; [`source_vertex`](ConvexPolyhedron::source_vertex)
    /// gives the caller's indices of the mesh. [`hull_fit`](Self::hull_fit) measures what the hull
    /// adds.
    ///
    /// # Errors
    ///
    /// A mesh whose vertices all lie in one plane ([`BuildError::Flat`]).
    pub fn hull(&self) -> Result<ConvexPolyhedron, BuildError> {
        let points: Vec<Point3<f64>> = self.points.iter().map(|p| self.given(p)).collect();
        let mut hull = ConvexPolyhedron::from_points(&points)?;
        for source in &mut hull.source {
            *source = self.source_points[*source as usize];
        }
        Ok(hull)
    }

    /// Measures how much a convex body, such as the [`hull`](Self::hull) of the mesh, adds to the
    /// mesh: volumes, and the largest gap between the two surfaces. Milliseconds for meshes of
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
        let groups = Groups::new(self);
        let scale = 1.0 / self.unit();
        let points: Vec<Vector3<f64>> = hull.vertex_points().map(|p| p.coords * scale).collect();
        let corners = |t: [crate::polyhedron::VertexId; 3]| t.map(|v| points[v.index()]);
        let (mut lower, mut heap) = (0.0f64, BinaryHeap::new());
        let size = sqrt((self.high - self.low).norm_squared()) * 0.5;
        for t in hull.triangles() {
            heap.push(groups.examined(corners(t), &mut lower));
        }
        for _ in 0..EXAMINED {
            let Some(widest) = heap.peek().filter(|t| t.upper > lower + RESOLUTION * size) else {
                break;
            };
            let halves = halves(&widest.corners);
            heap.pop();
            for half in halves {
                heap.push(groups.examined(half, &mut lower));
            }
        }
        (lower, heap.peek().map_or(lower, |t| t.upper.max(lower)))
    }
}

/// Returns the two halves of a triangle, cut at the middle of the longest side.
fn halves([a, b, c]: &[Vector3<f64>; 3]) -> [[Vector3<f64>; 3]; 2] {
    let long = |p: &Vector3<f64>, q: &Vector3<f64>| (q - p).norm_squared();
    let (ab, bc, ca) = (long(a, b), long(b, c), long(c, a));
    let [a, b, c] = if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = (a + b) * 0.5;
    [[*a, middle, *c], [middle, *b, *c]]
}

/// A triangle of the hull's surface and an upper bound of the gap over the triangle.
struct Examined {
    upper: f64,
    corners: [Vector3<f64>; 3],
}

impl Ord for Examined {
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper)
    }
}

impl PartialOrd for Examined {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Examined {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Examined {}

/// The triangles of a mesh in groups with a box, in the order of the mesh's tree: triangles of a
/// group are close together.
struct Groups<'a> {
    mesh: &'a Mesh,
    boxes: Vec<(Vector3<f64>, Vector3<f64>)>,
}

impl<'a> Groups<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let of_group = |triangles: &[[u32; 3]]| {
            let vertices = triangles.iter().flatten();
            bounding_box(vertices.map(|v| &mesh.points[*v as usize]))
        };
        Self {
            mesh,
            boxes: mesh.triangles.chunks(GROUP).map(of_group).collect(),
        }
    }

    /// Bounds the gap over a triangle, and raises `lower` to the gap of the centroid.
    fn examined(&self, corners: [Vector3<f64>; 3], lower: &mut f64) -> Examined {
        let [a, b, c] = corners;
        let centroid = (a + b + c) / 3.0;
        let (squared, closest) = self.closest(&centroid);
        let gap = sqrt(squared);
        *lower = lower.max(gap);
        let greatest = |of: &dyn Fn(&Vector3<f64>) -> f64| sqrt(corners.iter().map(of).fold(0.0, f64::max));
        let by_radius = gap + greatest(&|p| (p - centroid).norm_squared());
        let by_triangle = greatest(&|p| distance_squared(p, &self.mesh.corners(closest)));
        Examined {
            upper: by_radius.min(by_triangle),
            corners,
        }
    }

    /// Returns the squared distance of a point from the mesh, and the closest triangle.
    fn closest(&self, p: &Vector3<f64>) -> (f64, u32) {
        let mut best = (f64::INFINITY, 0);
        let apart = |(low, high): &(Vector3<f64>, Vector3<f64>)| {
            let out = (low - p).sup(&(p - high)).sup(&Vector3::zeros());
            out.norm_squared()
        };
        // The group with the closest box first, so that most of the others are passed over.
        let bounds: Vec<f64> = self.boxes.iter().map(apart).collect();
        let first = (0..bounds.len()).min_by(|&x, &y| bounds[x].total_cmp(&bounds[y]));
        for group in first.into_iter().chain(0..bounds.len()) {
            if bounds[group] < best.0 {
                for t in self.members(group) {
                    let squared = distance_squared(p, &self.mesh.corners(t));
                    if squared < best.0 {
                        best = (squared, t);
                    }
                }
            }
        }
        best
    }

    fn members(&self, group: usize) -> Range<u32> {
        let end = ((group + 1) * GROUP).min(self.mesh.triangles.len());
        (group * GROUP) as u32..end as u32
    }
}

/// Returns the squared distance of a point from a triangle with an area.
fn distance_squared(p: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    let n = (b - a).cross(&(c - a));
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(s, e)| (*e - *s).cross(&(p - *s)).dot(&n) >= 0.0) {
        let height = (p - a).dot(&n);
        return height * height / n.norm_squared();
    }
    let from_side = |(s, e): (&Vector3<f64>, &Vector3<f64>)| {
        let (along, to) = (e - s, p - s);
        let t = (to.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (to - along * t).norm_squared()
    };
    sides.into_iter().map(from_side).fold(f64::INFINITY, f64::min)
}
