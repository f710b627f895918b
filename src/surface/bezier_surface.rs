//! A surface of many patches with a tree above them, its parts, and the work of queries.

use alloc::vec::Vec;
use nalgebra::{Point3, Unit, Vector3};

use super::error::SurfaceError;
use super::net::BezierPatch;
use super::nurbs::Nurbs;
use super::tree::NetTree;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::sort::sort;
use crate::base::num::sum_of_counters;
use crate::base::tolerance::{SEAM, SURFACE_POINT};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::separation::ball_about;
use crate::pair::location::WitnessLocation;

/// A surface of Bézier patches, not trimmed: the set of points of its patches.
///
/// A surface has no inside, even if it is [closed](Self::is_closed): a distance to it is the
/// distance to its points. It is immutable. Coordinates are in the caller's unit and the surface's
/// frame.
///
/// ```
/// use lin_canny::nalgebra::Point3;
/// use lin_canny::surface::{Nurbs, BezierSurface};
///
/// // A biquadratic B-spline of two patches.
/// let at = |i: usize| [(i / 3) as f64, (i % 3) as f64, (i % 2) as f64];
/// let points: Vec<_> = (0..12).map(|i| Point3::from(at(i))).collect();
/// let surface = BezierSurface::from_nurbs(&Nurbs {
///     degrees: [2, 2],
///     knots: [
///         &[0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0],
///         &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
///     ],
///     points: &points,
///     ..Nurbs::default()
/// })?;
/// assert_eq!(surface.patches().len(), 2);
/// assert!(!surface.is_closed());
/// # Ok::<(), lin_canny::surface::SurfaceError>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "super::persist::StoredSurface", into = "super::persist::StoredSurface")
)]
pub struct BezierSurface {
    pub(super) patches: Vec<BezierPatch>,
    /// The knots around each patch of a NURBS surface, in u and v.
    pub(super) domains: Vec<[[f64; 2]; 2]>,
    pub(super) tree: NetTree,
    /// The largest distance of a control point from the origin, rounded up.
    pub(super) reach: f64,
    pub(crate) fingerprint: Fingerprint,
    is_closed: bool,
}

impl BezierSurface {
    /// Returns the surface of the given patches.
    ///
    /// # Errors
    ///
    /// Returns [`SurfaceError::Empty`] if there is no patch.
    pub fn new(patches: Vec<BezierPatch>) -> Result<Self, SurfaceError> {
        let domains = patches.iter().map(|_| [[0.0, 1.0]; 2]).collect();
        Self::assembled(patches, domains)
    }

    /// Returns the surface of the Bézier patches of a NURBS surface.
    ///
    /// # Errors
    ///
    /// Returns an error if a degree, knot, control point or weight is out of range, or if the
    /// surface has trimming curves ([`SurfaceError::Trimmed`]).
    pub fn from_nurbs(nurbs: &Nurbs) -> Result<Self, SurfaceError> {
        let (patches, domains) = nurbs.patches()?.into_iter().unzip();
        Self::assembled(patches, domains)
    }

    /// Returns the triangles of a mesh as flat patches, in the order of [`Mesh::triangles`].
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is beyond `2^200`.
    pub fn from_mesh(mesh: &Mesh) -> Result<Self, SurfaceError> {
        Self::from_triangles(mesh.triangles().map(|(_, corners)| corners))
    }

    /// Returns the boundary of a convex polyhedron as flat patches.
    ///
    /// The patches are in the order of its [triangles](ConvexPolyhedron::triangles).
    ///
    /// # Errors
    ///
    /// Returns an error if the body has no faces ([`SurfaceError::Empty`]), or if a coordinate is
    /// beyond `2^200`.
    pub fn from_convex(body: &ConvexPolyhedron) -> Result<Self, SurfaceError> {
        let corner = |v| body.vertex(v).unwrap_or_default();
        Self::from_triangles(body.triangles().map(|t| t.each(corner)))
    }

    fn from_triangles(corners: impl Iterator<Item = [Point3<f64>; 3]>) -> Result<Self, SurfaceError> {
        let flat = |c: [Point3<f64>; 3]| BezierPatch::triangular(1, &c, None);
        Self::new(corners.map(flat).collect::<Result<_, _>>()?)
    }

    pub(super) fn assembled(patches: Vec<BezierPatch>, domains: Vec<[[f64; 2]; 2]>) -> Result<Self, SurfaceError> {
        if patches.is_empty() {
            return Err(SurfaceError::Empty);
        }
        let reach = patches.iter().map(|p| p.reach).fold(0.0, f64::larger);
        let tree = NetTree::new(&patches);
        let (fingerprint, is_closed) = (fingerprint(&patches), is_closed(&patches, reach));
        Ok(Self {
            patches,
            domains,
            tree,
            reach,
            fingerprint,
            is_closed,
        })
    }

    /// Returns the patches.
    #[must_use]
    pub fn patches(&self) -> &[BezierPatch] {
        &self.patches
    }

    /// Returns whether the surface is closed.
    ///
    /// It is closed if every border of a patch that is longer than a point coincides with exactly
    /// one other border, control point by control point.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Returns a point of the surface; `None` if the patch does not exist.
    #[must_use]
    pub fn point(&self, at: &WitnessLocation) -> Option<Point3<f64>> {
        Some(
            self.patches
                .get(at.subshape as usize)?
                .point(at.parameters[0], at.parameters[1]),
        )
    }

    /// Returns the unit normal at a point of the surface, as [`BezierPatch::normal`] does.
    #[must_use]
    pub fn normal(&self, at: &WitnessLocation) -> Option<Unit<Vector3<f64>>> {
        self.patches
            .get(at.subshape as usize)?
            .normal(at.parameters[0], at.parameters[1])
    }

    /// Returns the parameters of a point in the knots of the NURBS surface.
    ///
    /// For any other surface they are the parameters of the patch. The result is `None` if the
    /// patch does not exist.
    #[must_use]
    pub fn parameters(&self, at: &WitnessLocation) -> Option<[f64; 2]> {
        let [u, v] = self.domains.get(at.subshape as usize)?;
        let mixed = |[low, high]: [f64; 2], t: f64| low * (1.0 - t) + high * t;
        Some([mixed(*u, at.parameters[0]), mixed(*v, at.parameters[1])])
    }

    /// Returns the centre and radius of a ball that contains the surface.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (centre, radius) = ball_about(self.aabb());
        (centre, radius + self.reach * SURFACE_POINT)
    }

    /// Returns a box that contains the surface, including the errors of points.
    pub(crate) fn outer_box(&self) -> (Point3<f64>, Point3<f64>) {
        let error = Vector3::repeat(self.reach * SURFACE_POINT);
        let (low, high) = self.aabb();
        (low - error, high + error)
    }

    /// Returns the smallest box that contains all control points.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let start = self.patches[0].aabb();
        self.patches
            .iter()
            .map(BezierPatch::aabb)
            .fold(start, |s, b| (s.0.smaller(b.0), s.1.larger(b.1)))
    }
}

/// Returns the fingerprint of degrees and control points.
fn fingerprint(patches: &[BezierPatch]) -> Fingerprint {
    let mut all = Fingerprinter::new(*b"surface ");
    all.word(patches.len() as u64);
    for patch in patches {
        patch.degrees.iter().for_each(|d| all.word(*d as u64));
        patch.net.as_flattened().iter().for_each(|x| all.number(*x));
    }
    all.end()
}

/// Returns whether borders coincide in pairs, compared by their control points.
fn is_closed(patches: &[BezierPatch], reach: f64) -> bool {
    let near = |p: &Point3<f64>, q: &Point3<f64>| (p - q).amax() <= SEAM * reach;
    let mut borders: Vec<(f64, Vec<Point3<f64>>, bool)> = Vec::new();
    for patch in patches {
        let net: Vec<Point3<f64>> = patch.control_points().map(|(p, _)| p).collect();
        let [p, q] = patch.degrees;
        let at = |i: usize, j: usize| net[i * (q + 1) + j];
        let sides: [Vec<Point3<f64>>; 4] = [
            (0..=q).map(|j| at(0, j)).collect(),
            (0..=q).map(|j| at(p, j)).collect(),
            (0..=p).map(|i| at(i, 0)).collect(),
            (0..=p).map(|i| at(i, q)).collect(),
        ];
        let is_line = |s: &Vec<Point3<f64>>| s.iter().any(|x| !near(x, &s[0]));
        for side in sides.into_iter().filter(is_line) {
            borders.push((side[0].x + side[side.len() - 1].x, side, false));
        }
    }
    sort(&mut borders, |a, b| a.0.total_cmp(&b.0));
    for k in 0..borders.len() {
        if borders[k].2 {
            continue;
        }
        let (key, side, _) = &borders[k];
        let runs_along = |other: &[Point3<f64>]| {
            let forward = || side.iter().zip(other).all(|(p, q)| near(p, q));
            let backward = || side.iter().rev().zip(other).all(|(p, q)| near(p, q));
            other.len() == side.len() && (forward() || backward())
        };
        let close = (k + 1..borders.len()).take_while(|&m| borders[m].0 - key <= 4.0 * SEAM * reach);
        let Some(other) = close.into_iter().find(|&m| !borders[m].2 && runs_along(&borders[m].1)) else {
            return false;
        };
        borders[other].2 = true;
    }
    true
}

/// A part of a surface: a node of its tree.
#[cfg(feature = "__internals")]
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePart {
    /// Index of the patch; `None` for a group of whole patches.
    pub patch: Option<u32>,
    /// Minimum and maximum of the parameter u.
    pub u: [f64; 2],
    /// Minimum and maximum of the parameter v.
    pub v: [f64; 2],
}

#[cfg(feature = "__internals")]
impl SurfacePart {
    pub(super) fn of(node: &crate::surface::tree::Node) -> Self {
        let [u, v] = node.domain();
        let patch = (!node.is_group()).then_some(node.patch());
        Self { patch, u, v }
    }
}

/// Work counters of queries of two surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceWork {
    /// Number of queries.
    pub queries: u64,
    /// Number of front entries that were tested with their directions.
    pub entries: u64,
    /// Number of these entries that their directions did not prove.
    pub failed: u64,
    /// Number of computed gaps of two nets along a direction.
    pub gaps: u64,
    /// Number of pairs that were bounded by second derivatives.
    pub caps: u64,
    /// Number of pairs that were bounded by a separating quadric.
    pub bowls: u64,
    /// Number of regions around closest points that were proven at once.
    pub regions: u64,
    /// Number of regions around closest points that were tried and not proven.
    pub refused: u64,
    /// Number of steps of Newton's method for two points.
    pub steps: u64,
    /// Number of pairs of nodes that were split.
    pub splits: u64,
    /// Number of searches from the roots.
    pub searches: u64,
}

sum_of_counters!(SurfaceWork {
    queries,
    entries,
    failed,
    gaps,
    caps,
    bowls,
    regions,
    refused,
    steps,
    splits,
    searches
});
