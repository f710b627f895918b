//! Convex pieces that stand for a mesh, and how far the two are apart.
//!
//! No surface point of the pieces is farther than the *excess* from the mesh, no point of the
//! mesh's surface farther than the *shortfall* from the pieces. Let another body be `d` apart from
//! the pieces. The closest point of the pieces is on their surface, so the mesh is at most
//! `d + excess` apart. If the mesh were nearer than `d - shortfall`, so would be a point of its
//! surface, and the pieces nearer than `d`; the only other way for the mesh to meet the body is to
//! hold it, which a winding number decides.
//!
//! Over a triangle the distance from a convex set is greatest at a corner, because it is a convex
//! function. This bounds the shortfall by the piece nearest to the centroid, and the excess by the
//! triangle nearest to it.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt;

use nalgebra::{Isometry3, Point3, Vector3};

use super::greatest::greatest;
use super::mesh::hull::RESOLUTION;
use super::mesh::{Mesh, MeshError};
use super::parts::{Parted, Parts};
use super::pieces::{Composite, CompositeTracker, Piece};
use super::state::{Inside, Posed};
use super::triangle::Triangle;
use crate::num::scalar::sqrt;
use crate::pair::outcome::{Class, Distance};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::RelativePose;
use crate::shape::Core;
use crate::tolerance::{CERTIFICATE, UNIT};

/// How far convex pieces and a mesh are apart, in the caller's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct DecompositionFit {
    /// Some point of the pieces' surface is at least this far outside the mesh.
    pub excess_lower: f64,
    /// No point of the pieces' surface is farther from the mesh.
    pub excess_upper: f64,
    /// Some point of the mesh's surface is at least this far outside the pieces.
    pub shortfall_lower: f64,
    /// No point of the mesh's surface is farther from the pieces.
    pub shortfall_upper: f64,
    /// No point of a piece is deeper inside the piece.
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

/// Convex pieces that stand for a mesh, checked: the largest gaps between the two are bounded, so
/// that distances of the pieces are intervals that hold for the mesh.
///
/// The pieces are the caller's, from any decomposition (V-HACD, CoACD, by hand). The mesh itself is
/// exact, and often as fast: [`MeshTracker`](crate::MeshTracker).
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Composite, CompositeTracker, Decomposition};
/// use lin_canny::{Mesh, Piece, RelativePose};
///
/// // A ball of 1,280 triangles, and a coarser one in its place.
/// let mesh = Mesh::from_convex(&solids::geodesic_sphere(3, 1.0)?)?;
/// let coarse = Piece::new(solids::geodesic_sphere(2, 1.0)?);
/// let pieces = Composite::new(vec![coarse])?;
/// let coarse = Decomposition::new(mesh.clone(), pieces)?;
/// let fit = coarse.fit();
/// assert!(fit.excess_upper < 0.01 && fit.shortfall_upper < 0.03);
///
/// let at = RelativePose::from_isometry(&Isometry3::translation(2.5, 0.1, 0.2))?;
/// let found = coarse.distance(&mut CompositeTracker::new(), &mesh, &at);
/// let exact = CompositeTracker::new().distance(&mesh, &mesh, &at);
/// assert!(found.lower <= exact.value && exact.value <= found.upper);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "V-HACD")]
#[doc(alias = "CoACD")]
#[derive(Clone, Debug)]
pub struct Decomposition {
    mesh: Arc<Mesh>,
    pieces: Arc<Composite>,
    fit: DecompositionFit,
}

impl Decomposition {
    /// Measures the gaps between a mesh and pieces that stand for it: in general within 0.4 % of
    /// half the diagonal of the mesh's box. A second for a hundred thousand triangles.
    ///
    /// # Errors
    ///
    /// A piece that is rounded or curved ([`MeshError::Curved`]).
    pub fn new(mesh: impl Into<Arc<Mesh>>, pieces: impl Into<Arc<Composite>>) -> Result<Self, MeshError> {
        let (mesh, pieces) = (mesh.into(), pieces.into());
        let hulls = hulls(&pieces)?;
        let resolution = RESOLUTION * sqrt((mesh.high - mesh.low).norm_squared()) * 0.5;
        let (excess, shortfall) = (excess(&mesh, &hulls, resolution), shortfall(&mesh, &hulls, resolution));
        // The rounding of distances of points.
        let noise = CERTIFICATE * UNIT * (mesh.radius * mesh.unit() + pieces.side().radius * pieces.stored_unit());
        let fit = DecompositionFit {
            excess_lower: (excess.0 * mesh.unit() - noise).max(0.0),
            excess_upper: excess.1 * mesh.unit() + noise,
            shortfall_lower: (shortfall.0 * mesh.unit() - noise).max(0.0),
            shortfall_upper: shortfall.1 * mesh.unit() + noise,
            depth: hulls.iter().map(Hull::depth).fold(0.0, f64::max) + noise,
        };
        Ok(Self { mesh, pieces, fit })
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the pieces.
    #[must_use]
    pub fn pieces(&self) -> &Composite {
        &self.pieces
    }

    /// Returns how far pieces and mesh are apart.
    #[must_use]
    pub fn fit(&self) -> &DecompositionFit {
        &self.fit
    }

    /// Returns bounds of the distance of the mesh from another body, by the distance of the pieces.
    ///
    /// If the bounds leave open whether the bodies meet, the class is [`Class::Undecided`];
    /// no depth is told.
    pub fn distance<B: Parts>(
        &self,
        tracker: &mut CompositeTracker,
        other: &B,
        mesh_from_other: &RelativePose,
    ) -> Distance {
        let found = tracker.closest(&*self.pieces, other, mesh_from_other);
        let fit = &self.fit;
        if found.class != Class::Separated {
            // A point of the body is in a piece, or next to one: at most the depth of the piece
            // from the piece's surface.
            return open(found.upper.max(0.0) + fit.excess_upper + fit.depth);
        }
        let Some(posed) = Posed::new(&*self.mesh, other, mesh_from_other) else {
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
                class: Class::Separated,
                value: found.distance.clamp(lower, upper),
                lower,
                upper,
            },
            Inside::At(..) => Distance {
                class: if Parted::is_solid(&*self.mesh) && other.is_solid() {
                    Class::Overlapping
                } else {
                    Class::Touching
                },
                value: 0.0,
                lower: 0.0,
                upper: 0.0,
            },
            Inside::Unclear => open(upper),
        }
    }
}

/// Bodies that may share a point, at most `upper` apart.
fn open(upper: f64) -> Distance {
    Distance {
        class: Class::Undecided,
        value: 0.0,
        lower: 0.0,
        upper,
    }
}

/// A piece that is a polyhedron.
struct Hull<'a> {
    body: &'a ConvexPolyhedron,
    pose: &'a Isometry3<f64>,
    /// A ball about the piece in the body's frame.
    centre: Point3<f64>,
    radius: f64,
}

fn hulls(pieces: &Composite) -> Result<Vec<Hull<'_>>, MeshError> {
    let mut hulls = Vec::with_capacity(pieces.pieces().len());
    for (piece, Piece { shape, pose, .. }) in pieces.pieces().iter().enumerate() {
        let (Core::Polyhedron(body), 0.0) = (shape.core(), shape.round()) else {
            return Err(MeshError::Curved { piece });
        };
        let (centre, radius) = body.bounding_ball();
        hulls.push(Hull {
            body,
            pose,
            centre: pose * centre,
            radius,
        });
    }
    Ok(hulls)
}

impl Hull<'_> {
    /// The distance of a point from the piece, in the caller's unit.
    fn distance(&self, p: &Point3<f64>) -> f64 {
        let local = self.pose.inverse_transform_point(p);
        let foot = self.body.closest_point(&local);
        foot.map_or(f64::INFINITY, |foot| sqrt((foot - local).norm_squared()))
    }

    /// Half the shortest side of the box: no point of the piece is deeper inside.
    fn depth(&self) -> f64 {
        let (low, high) = self.body.aabb();
        0.5 * (high - low).min()
    }
}

/// Bounds of the farthest point of the pieces' surface from the mesh, in stored units of the mesh.
fn excess(mesh: &Mesh, hulls: &[Hull], resolution: f64) -> (f64, f64) {
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
            .map(move |t| t.map(at))
    });
    greatest(triangles, resolution, |corners: &Triangle| {
        let gap = mesh.gap_over(corners);
        let is_in = mesh.is_solid() && gap.upper > 0.0 && mesh.winding(&gap.centroid).is_some_and(|w| w != 0);
        if is_in {
            // The distance from a solid is zero inside.
            (0.0, gap.upper.min((gap.radius - gap.at_centroid).max(0.0)))
        } else {
            (gap.at_centroid, gap.upper)
        }
    })
}

/// Bounds of the farthest point of the mesh's surface from the pieces, in stored units of the mesh.
fn shortfall(mesh: &Mesh, hulls: &[Hull], resolution: f64) -> (f64, f64) {
    let (unit, scale) = (mesh.unit(), 1.0 / mesh.unit());
    let triangles = (0..mesh.triangles.len() as u32).map(|t| mesh.corners(t));
    greatest(triangles, resolution, |corners: &Triangle| {
        let [a, b, c] = corners.map(|p| Point3::from(p * unit));
        let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let (distance, nearest) = nearest(hulls, &centroid);
        let radius = [a, b, c]
            .iter()
            .map(|p| (p - centroid).norm_squared())
            .fold(0.0, f64::max);
        let by_piece = [a, b, c].iter().map(|p| nearest.distance(p)).fold(0.0, f64::max);
        (distance * scale, (distance + sqrt(radius)).min(by_piece) * scale)
    })
}

/// The piece that is nearest to a point, and its distance. There is at least one piece.
fn nearest<'a, 'b>(hulls: &'a [Hull<'b>], p: &Point3<f64>) -> (f64, &'a Hull<'b>) {
    let mut best = (f64::INFINITY, &hulls[0]);
    for hull in hulls {
        if sqrt((p - hull.centre).norm_squared()) - hull.radius < best.0 {
            let distance = hull.distance(p);
            if distance < best.0 {
                best = (distance, hull);
            }
        }
    }
    best
}
