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

mod shortfall;

use alloc::sync::Arc;
use core::fmt;
use core::ops::ControlFlow;

use crate::base::notice::{Progress, Watch};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::composite::decomposition::shortfall::{PieceHull, excess, hulls, shortfall};
use crate::composite::meet::state::{Inside, PosedTrees};
use crate::composite::mesh::hull::RESOLUTION;
use crate::composite::mesh::{Mesh, MeshError};
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::pieces::Composite;
use crate::pair::outcome::{Class, Distance};
use crate::pair::spot::Answer;

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
/// exact, and often as fast: [`PairTracker`](crate::PairTracker).
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Composite, Decomposition, Mesh};
/// use lin_canny::{PairTracker, Piece, RelativePose};
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
    pieces: Arc<Composite>,
    fit: DecompositionFit,
}

impl Decomposition {
    /// Measures the gaps between a mesh and pieces that stand for it: in general within 0.4 % of
    /// half the diagonal of the mesh's box. Some 0.03 to 0.25 s for meshes of 1,000 to 5,000
    /// triangles.
    ///
    /// # Errors
    ///
    /// A piece that is rounded or curved ([`MeshError::Curved`]).
    pub fn new(mesh: impl Into<Arc<Mesh>>, pieces: impl Into<Arc<Composite>>) -> Result<Self, MeshError> {
        Self::measured(mesh.into(), pieces.into(), &mut Watch::none())
    }

    /// Measures as [`new`](Self::new) does, and tells the caller how far it is: for meshes of a
    /// hundred thousand triangles.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); [`MeshError::Stopped`] if the caller stops it.
    pub fn new_with_progress(
        mesh: impl Into<Arc<Mesh>>,
        pieces: impl Into<Arc<Composite>>,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Self, MeshError> {
        Self::measured(mesh.into(), pieces.into(), &mut Watch::new(progress))
    }

    fn measured(mesh: Arc<Mesh>, pieces: Arc<Composite>, watch: &mut Watch<'_>) -> Result<Self, MeshError> {
        let mut hulls = hulls(&pieces)?;
        let resolution = RESOLUTION * sqrt((mesh.high - mesh.low).norm_squared()) * 0.5;
        watch.slow_stage("excess")?;
        let excess = excess(&mesh, &hulls, resolution, watch);
        watch.slow_stage("shortfall")?;
        let shortfall = shortfall(&mesh, &mut hulls, resolution, watch);
        watch.check()?;
        // The rounding of distances of points.
        let noise = CERTIFICATE * UNIT * (mesh.radius * mesh.unit() + pieces.side().radius * pieces.stored_unit());
        let fit = DecompositionFit {
            excess_lower: (excess.0 * mesh.unit() - noise).at_least(0.0),
            excess_upper: excess.1 * mesh.unit() + noise,
            shortfall_lower: (shortfall.0 * mesh.unit() - noise).at_least(0.0),
            shortfall_upper: shortfall.1 * mesh.unit() + noise,
            depth: hulls.iter().map(PieceHull::depth).fold(0.0, f64::larger) + noise,
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

    /// Returns bounds of the distance of the mesh from another body, by the answer of the pieces
    /// and that body.
    pub(crate) fn bounds(&self, found: &Answer, other: &PartsRef, mesh_from_other: &RelativePose) -> Distance {
        let fit = &self.fit;
        if found.class != Class::Separated {
            // A point of the body is in a piece, or next to one: at most the depth of the piece
            // from the piece's surface.
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
                class: Class::Separated,
                value: found.distance.clamped(lower, upper),
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
