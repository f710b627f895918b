//! Convex pieces that replace a mesh, and how far the two differ.
//!
//! No point of the pieces' surface is farther than the *excess* from the mesh. No point of the
//! mesh's surface is farther than the *shortfall* from the pieces. Let the distance of another body
//! from the pieces be `d`:
//!
//! - **Upper bound.** The closest point of the pieces is on their surface, so the mesh is at most
//!   `d + excess` away.
//! - **Lower bound.** If the surface of the mesh were nearer than `d - shortfall`, the pieces would
//!   be nearer than `d`. Otherwise the mesh can meet the body only if it contains the body, which a
//!   winding number decides.
//!
//! Over a triangle the distance from a convex set is greatest at a vertex, because it is a convex
//! function. This bounds the shortfall by the piece nearest to the centroid, and the excess by the
//! triangle nearest to the centroid.
//!
//! Points are measured in the order of the mesh's tree, so that consecutive points are near each
//! other. For each piece a tracker is cached, and the plane that the last point was outside of,
//! which is tested first.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt;
use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::callbacks::{Watch, WithProgress};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes, smallest};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::Core;
use crate::convex::tracker::Tracker;
use crate::nonconvex::mesh::hull::{RESOLUTION, greatest};
use crate::nonconvex::mesh::{Mesh, MeshError};
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::pieces::{Compound, Piece};
use crate::nonconvex::query::state::{Inside, PosedTrees};
use crate::nonconvex::query::triangle::Triangle;
use crate::pair::location::PairOutcome;
use crate::pair::outcome::{ContactState, Distance};

/// How far convex pieces and a mesh differ, in the caller's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct DecompositionFit {
    /// Lower bound of the excess: some point of the pieces' surface is at least this far outside
    /// the mesh.
    pub excess_lower: f64,
    /// Upper bound of the excess: no point of the pieces' surface is farther from the mesh.
    pub excess_upper: f64,
    /// Lower bound of the shortfall: some point of the mesh's surface is at least this far outside
    /// the pieces.
    pub shortfall_lower: f64,
    /// Upper bound of the shortfall: no point of the mesh's surface is farther from the pieces.
    pub shortfall_upper: f64,
    /// Upper bound of the depth of a point of a piece inside that piece.
    pub depth: f64,
}

impl fmt::Display for DecompositionFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "pieces stand out by {:.2e} to {:.2e} and fall short by {:.2e} to {:.2e}",
            self.excess_lower, self.excess_upper, self.shortfall_lower, self.shortfall_upper
        )
    }
}

/// Convex pieces that replace a mesh, with proven bounds of their difference.
///
/// With these bounds, the distance of the pieces from a body gives an interval that holds for the
/// mesh.
///
/// The caller provides the pieces, from any decomposition (V-HACD, CoACD, by hand). Queries of the
/// mesh itself ([`PairTracker`](crate::PairTracker)) are exact and often as fast.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Compound, Decomposition, Mesh};
/// use lin_canny::{PairTracker, Piece, RelativePose};
///
/// // A ball of 1,280 triangles, and a coarser one in its place.
/// let mesh = Mesh::from_convex(&solids::geodesic_sphere(3, 1.0)?)?;
/// let coarse = Piece::new(solids::geodesic_sphere(2, 1.0)?);
/// let pieces = Compound::new(vec![coarse])?;
/// let coarse = Decomposition::new(mesh.clone(), pieces)?;
/// let fit = coarse.fit();
/// assert!(fit.excess_upper < 0.01 && fit.shortfall_upper < 0.03);
///
/// let at = RelativePose::from_isometry(&Isometry3::translation(2.5, 0.1, 0.2))?;
/// let found = coarse.distance(&mut PairTracker::new(), &mesh, &at);
/// let exact = PairTracker::new().distance(&mesh, &mesh, &at);
/// assert!(found.lower <= exact.value && exact.value <= found.upper);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "V-HACD")]
#[doc(alias = "CoACD")]
#[derive(Clone, Debug)]
pub struct Decomposition {
    mesh: Arc<Mesh>,
    pieces: Arc<Compound>,
    fit: DecompositionFit,
}

impl WithProgress<'_> {
    /// Measures the gaps between a mesh and its pieces as [`Decomposition::new`] does.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`Decomposition::new`], and [`MeshError::Stopped`] if the callback
    /// stops the call.
    pub fn decomposition(
        mut self,
        mesh: impl Into<Arc<Mesh>>,
        pieces: impl Into<Arc<Compound>>,
    ) -> Result<Decomposition, MeshError> {
        Decomposition::measured(mesh.into(), pieces.into(), &mut self.watch)
    }
}

impl Decomposition {
    /// Measures the gaps between a mesh and the pieces that replace it.
    ///
    /// The bounds are generally within 0.4 % of half the diagonal of the mesh's box. The call takes
    /// about 0.03 to 0.25 s for meshes of 1,000 to 5,000 triangles.
    ///
    /// # Errors
    ///
    /// Returns [`MeshError::Curved`] if a piece is rounded or curved.
    pub fn new(mesh: impl Into<Arc<Mesh>>, pieces: impl Into<Arc<Compound>>) -> Result<Self, MeshError> {
        Self::measured(mesh.into(), pieces.into(), &mut Watch::none())
    }

    fn measured(mesh: Arc<Mesh>, pieces: Arc<Compound>, watch: &mut Watch<'_>) -> Result<Self, MeshError> {
        // About the middle of the mesh, if the mesh is stored about it.
        let origin = &mesh.frame.origin;
        let (near, members) = (mesh.centred(), pieces.pieces_about(origin));
        let mut hulls = hulls(&members)?;
        let resolution = RESOLUTION * sqrt((mesh.high - mesh.low).norm_squared()) * 0.5;
        watch.slow_stage("excess")?;
        let excess = excess(&near, &hulls, resolution, watch);
        watch.slow_stage("shortfall")?;
        let shortfall = shortfall(&near, &mut hulls, resolution, watch);
        watch.check()?;
        // The rounding error of distances of points.
        let off = (pieces.side().frame.origin - origin).abs().sum();
        let size = mesh.radius * mesh.unit() + pieces.side().radius * pieces.stored_unit() + off;
        let noise = CERTIFICATE * UNIT * size;
        let fit = DecompositionFit {
            excess_lower: (excess.0 * mesh.unit() - noise).at_least(0.0),
            excess_upper: excess.1 * mesh.unit() + noise,
            shortfall_lower: (shortfall.0 * mesh.unit() - noise).at_least(0.0),
            shortfall_upper: shortfall.1 * mesh.unit() + noise,
            depth: hulls.iter().map(PieceHull::depth).fold(0.0, f64::larger) + noise,
        };
        Ok(Self { mesh, pieces, fit })
    }

    /// Returns the decomposition with each piece grown until the pieces cover the mesh.
    ///
    /// Each piece is rounded by a ball of the radius [`DecompositionFit::shortfall_upper`], the
    /// least one that is proven to suffice. What holds then:
    ///
    /// - **Surface.** Each point of the mesh's surface is in a piece. The shortfall is zero.
    /// - **Inside.** The inside of a closed mesh is covered, except hollows that grown pieces
    ///   enclose, as those of pieces that fill only the walls of a solid. A body on a continuous
    ///   path from outside meets the pieces before it meets such a hollow.
    /// - **Excess.** No point of the surface of a grown piece is farther from the mesh than the new
    ///   [`DecompositionFit::excess_upper`], the one before plus the radius.
    ///
    /// [`hull_outside`](crate::cover::hull_outside) turns a grown piece into a polyhedron that
    /// contains it, for programs without rounded shapes.
    ///
    /// ```
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Compound, Decomposition, Mesh, Piece};
    ///
    /// // A ball of 1,280 triangles, and a coarser one that is inside.
    /// let mesh = Mesh::from_convex(&solids::geodesic_sphere(3, 1.0)?)?;
    /// let coarse = Piece::new(solids::geodesic_sphere(2, 1.0)?);
    /// let pieces = Compound::new(vec![coarse])?;
    /// let grown = Decomposition::new(mesh, pieces)?.grown()?;
    /// assert_eq!(grown.fit().shortfall_upper, 0.0);
    /// assert!(grown.fit().excess_upper < 0.04);
    /// assert!(grown.pieces().pieces()[0].shape.rounding_radius() < 0.03);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns [`MeshError::Growth`] if the radius is not in `1e-100..=1e100`, or a grown piece
    /// reaches farther than 1e116 from the origin.
    #[doc(alias = "inflate")]
    #[doc(alias = "pad")]
    pub fn grown(&self) -> Result<Self, MeshError> {
        let radius = self.fit.shortfall_upper;
        let wrong = || MeshError::Growth { radius };
        let grow = |piece: &Piece| {
            let shape = piece.shape.clone().rounded(radius).map_err(|_| wrong())?;
            Ok(Piece { shape, ..piece.clone() })
        };
        let pieces: Result<Vec<Piece>, MeshError> = self.pieces.pieces().iter().map(grow).collect();
        let pieces = Compound::new(pieces?).map_err(|_| wrong())?;
        let fit = DecompositionFit {
            // A point of a grown surface is within the radius of each point of the one before.
            excess_lower: (self.fit.excess_lower - radius).next_down().at_least(0.0),
            // The nearest point of the piece is on its surface, unless the radius is zero.
            excess_upper: (self.fit.excess_upper + radius).next_up(),
            shortfall_lower: 0.0,
            shortfall_upper: 0.0,
            depth: (self.fit.depth + radius).next_up(),
        };
        Ok(Self {
            mesh: Arc::clone(&self.mesh),
            pieces: Arc::new(pieces),
            fit,
        })
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the pieces.
    #[must_use]
    pub fn pieces(&self) -> &Compound {
        &self.pieces
    }

    /// Returns how far pieces and mesh differ.
    #[must_use]
    pub fn fit(&self) -> &DecompositionFit {
        &self.fit
    }

    /// Returns bounds of the distance of the mesh from another body.
    ///
    /// `found` is the outcome of the pieces and that body.
    pub(crate) fn bounds(&self, found: &PairOutcome, other: &PartsRef, mesh_from_other: &RelativePose) -> Distance {
        let fit = &self.fit;
        if found.state != ContactState::Separated {
            // A point of the body is in a piece or next to one, so its distance from the piece's
            // surface is at most the depth of the piece.
            return open(found.upper.at_least(0.0) + fit.excess_upper + fit.depth);
        }
        let Some(posed) = PosedTrees::new(&*self.mesh, other, mesh_from_other) else {
            return open(found.upper + fit.excess_upper);
        };
        let unit = self.mesh.unit();
        let noise = posed.frame.error * unit;
        let (lower, upper) = (
            found.lower - fit.shortfall_upper - noise,
            found.upper + fit.excess_upper + noise,
        );
        if !(lower > 0.0) {
            return open(upper);
        }
        match posed.inside(lower / unit).0 {
            Inside::No => Distance {
                state: ContactState::Separated,
                value: found.distance.clamped(lower, upper),
                lower,
                upper,
            },
            Inside::At(..) => Distance {
                state: if Parted::is_solid(&*self.mesh) && other.is_solid() {
                    ContactState::Overlapping
                } else {
                    ContactState::Touching
                },
                value: 0.0,
                lower: 0.0,
                upper: 0.0,
            },
            Inside::Unclear => open(upper),
        }
    }
}

/// Returns the distance of bodies that may share a point and are at most `upper` apart.
fn open(upper: f64) -> Distance {
    Distance {
        state: ContactState::Undecided,
        value: 0.0,
        lower: 0.0,
        upper,
    }
}

/// Width of the bounds by planes, as a fraction of the resolution, below which no exact distance of
/// a point from a piece is computed.
const GAP: f64 = 1.0 / 64.0;

/// A piece that is a polyhedron.
pub(super) struct PieceHull<'a> {
    body: &'a ConvexPolyhedron,
    pose: &'a Isometry3<f64>,
    /// Centre of a ball that contains the piece, in the body's frame.
    centre: Point3<f64>,
    radius: f64,
    inner: InnerPlanes,
    tracker: Tracker,
}

/// The planes of a piece around an inner point, in the frame of the piece.
struct InnerPlanes {
    point: Point3<f64>,
    /// Normal, offset, and depth of the inner point; empty for a piece without volume.
    planes: Vec<(Vector3<f64>, f64, f64)>,
    /// Index of the plane that the last point was farthest outside of.
    last: usize,
}

pub(super) fn hulls(pieces: &[Piece]) -> Result<Vec<PieceHull<'_>>, MeshError> {
    let mut hulls = Vec::with_capacity(pieces.len());
    for (piece, Piece { shape, pose, .. }) in pieces.iter().enumerate() {
        let (Core::Polyhedron(body), 0.0) = (shape.core(), shape.rounding_radius()) else {
            return Err(MeshError::Curved { piece });
        };
        let (centre, radius) = body.bounding_ball();
        hulls.push(PieceHull {
            body,
            pose,
            centre: pose * centre,
            radius,
            inner: InnerPlanes::new(body),
            tracker: Tracker::new(),
        });
    }
    Ok(hulls)
}

impl InnerPlanes {
    fn new(body: &ConvexPolyhedron) -> Self {
        let point = body.centroid();
        let plane = |(n, offset): (nalgebra::Unit<Vector3<f64>>, f64)| {
            let depth = offset - n.dot(&point.coords);
            (depth > 0.0).then(|| (n.into_inner(), offset, depth))
        };
        let planes = body.faces().map(|face| body.face_plane(face).and_then(plane));
        Self {
            planes: planes.collect::<Option<_>>().unwrap_or_default(),
            point,
            last: 0,
        }
    }

    /// Returns bounds of the distance of a point from the planes; `None` if it exceeds `most`.
    fn bracket(&mut self, p: &Point3<f64>, most: f64) -> Option<(f64, f64)> {
        let height = |(n, offset, _): &(Vector3<f64>, f64, f64)| n.dot(&p.coords) - offset;
        let Some(plane) = self.planes.get(self.last) else {
            return Some((0.0, f64::INFINITY));
        };
        let (mut lower, mut part) = (height(plane).at_least(0.0), 0.0f64);
        for (k, plane) in self.planes.iter().enumerate() {
            if lower > most {
                return None;
            }
            let h = height(plane);
            if h > lower {
                (lower, self.last) = (h, k);
            }
            if h > 0.0 {
                // After this fraction of the path to the inner point, the point is below the plane.
                part = part.larger(h / (h + plane.2));
            }
        }
        Some((lower, part * sqrt((p - self.point).norm_squared())))
    }
}

impl PieceHull<'_> {
    /// Returns bounds of the distance of a point from the piece; `None` if it exceeds `most`.
    ///
    /// The bounds are in the caller's unit. They need not be tightened once they are less than
    /// `enough` apart.
    fn distance(&mut self, p: &Point3<f64>, most: f64, enough: f64) -> Option<(f64, f64)> {
        if sqrt((p - self.centre).norm_squared()) - self.radius > most {
            return None;
        }
        let local = self.pose.inverse_transform_point(p);
        let found = self.inner.bracket(&local, most)?;
        if found.1 - found.0 <= enough {
            return Some(found);
        }
        let at = Isometry3::translation(local.x, local.y, local.z);
        let dot = ConvexPolyhedron::origin();
        let at = RelativePose::from_isometry(&at).ok()?;
        let found = self.tracker.closest(self.body, &dot, &at);
        Some((found.lower.at_least(0.0), found.upper.at_least(0.0)))
    }

    /// Returns half the shortest side of the box: no point of the piece is deeper inside.
    fn depth(&self) -> f64 {
        let (low, high) = self.body.aabb();
        0.5 * smallest(&(high - low))
    }
}

/// Returns bounds of the excess, in stored units of the mesh.
pub(super) fn excess(mesh: &Mesh, hulls: &[PieceHull], resolution: f64, watch: &mut Watch<'_>) -> (f64, f64) {
    let scale = 1.0 / mesh.unit();
    let triangles = hulls.iter().flat_map(|hull| {
        let at = |v| {
            hull.body
                .vertex(v)
                .map_or_else(Vector3::zeros, |p| (hull.pose * p).coords * scale)
        };
        // A segment or a point is a triangle without area.
        let mut ends = hull.body.vertices();
        let first = ends.next();
        let wire = first.map(|v| [v, v, ends.last().unwrap_or(v)]);
        let is_wire = hull.body.face_count() == 0;
        hull.body
            .triangles()
            .chain(wire.filter(|_| is_wire))
            .map(move |t| t.each(at))
    });
    greatest(triangles, resolution, watch, |corners: &Triangle, enough| {
        let gap = mesh.gap_over(corners);
        if gap.upper <= enough {
            return (0.0, gap.upper);
        }
        let is_in = mesh.is_solid() && mesh.winding(&gap.centroid).is_some_and(|w| w != 0);
        if is_in {
            // The distance from a solid is zero inside.
            (0.0, gap.upper.smaller((gap.radius - gap.at_centroid).at_least(0.0)))
        } else {
            (gap.at_centroid, gap.upper)
        }
    })
}

/// Returns bounds of the shortfall, in stored units of the mesh.
fn shortfall(mesh: &Mesh, hulls: &mut [PieceHull], resolution: f64, watch: &mut Watch<'_>) -> (f64, f64) {
    let (unit, scale) = (mesh.unit(), 1.0 / mesh.unit());
    let triangles = (0..mesh.triangles.len() as u32).map(|t| mesh.corners(t));
    let (mut last, slack) = (0, GAP * resolution * unit);
    greatest(triangles, resolution, watch, |corners: &Triangle, enough| {
        let corners = corners.each(|p| Point3::from(p * unit));
        let most = enough * unit;
        // The piece that was nearest to the last triangle.
        if let Some(by_piece) = farthest(&mut hulls[last], &corners, most, slack).filter(|d| *d <= most) {
            return (0.0, by_piece * scale);
        }
        let [a, b, c] = &corners;
        let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let distance = nearest(hulls, &mut last, &centroid, slack);
        let radius = corners
            .iter()
            .map(|p| (p - centroid).norm_squared())
            .fold(0.0, f64::larger);
        let by_radius = distance.1 + sqrt(radius);
        let by_piece = farthest(&mut hulls[last], &corners, by_radius, slack).unwrap_or(f64::INFINITY);
        (distance.0 * scale, by_radius.smaller(by_piece) * scale)
    })
}

/// Returns an upper bound of the distances of three points from a piece; `None` if it exceeds
/// `most`.
fn farthest(hull: &mut PieceHull, points: &[Point3<f64>; 3], most: f64, slack: f64) -> Option<f64> {
    points
        .iter()
        .try_fold(0.0f64, |d, p| Some(d.larger(hull.distance(p, most, slack)?.1)))
}

/// Returns bounds of the distance of a point from the nearest piece; there must be a piece.
///
/// The index of that piece is stored in `last` and tested first next time.
fn nearest(hulls: &mut [PieceHull], last: &mut usize, p: &Point3<f64>, slack: f64) -> (f64, f64) {
    let first = *last;
    let mut best = (0.0, f64::INFINITY);
    for k in core::iter::once(first).chain(0..hulls.len()) {
        if let Some(found) = hulls[k].distance(p, best.1, slack)
            && found.1 < best.1
        {
            (best, *last) = (found, k);
        }
        if best.1 == 0.0 {
            break;
        }
    }
    best
}
