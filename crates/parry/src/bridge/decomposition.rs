//! V-HACD as a step that is asked for by name, with what it changes measured.

use std::sync::Arc;

use lin_canny::nalgebra::Point3;
use lin_canny::{Compound, CompoundError, ConvexPolyhedron, Decomposition, Mesh, MeshError, Piece};

use super::number::{narrow, wide};
use super::parry::math::Vector;
use super::parry::transformation::vhacd::{VHACD, VHACDParameters};

/// Cells along the longest side with which V-HACD is run: fewer make no body, more take gigabytes.
const RESOLUTIONS: std::ops::RangeInclusive<u32> = 4..=512;

/// Reason for which a mesh has no decomposition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DecompositionError {
    /// `VHACDParameters::resolution` lies outside 4..=512.
    #[error("a resolution of {0} lies outside 4..=512")]
    Resolution(u32),
    /// No piece of V-HACD has a volume.
    #[error("none of {pieces} pieces has a volume")]
    Empty {
        /// Pieces that V-HACD made.
        pieces: usize,
    },
    /// The pieces make no body.
    #[error(transparent)]
    Pieces(#[from] CompoundError),
    /// The pieces cannot be measured.
    #[error(transparent)]
    Measure(#[from] MeshError),
}

/// Returns the convex pieces into which parry's V-HACD cuts a mesh, each the hull of the mesh's
/// parts in the piece, with what they add to the mesh and leave out of it.
///
/// V-HACD works on a grid of cells and promises nothing. So the pieces are built by exact
/// predicates, those without volume are left out, and the gaps to the mesh are measured: distances
/// by [`Decomposition::distance`] are intervals that hold for the mesh, however good the pieces are.
/// The mesh is brought to a size of one first, because parry's tolerances are absolute.
///
/// # Errors
///
/// A resolution that V-HACD cannot work with, or no piece with a volume.
///
/// ```
/// use lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny_parry::lin_canny::polyhedron::solids;
/// use lin_canny_parry::lin_canny::{Compound, PairTracker, Piece, RelativePose};
/// use lin_canny_parry::single::{decompose, parry::transformation::vhacd::VHACDParameters};
///
/// // A bracket of two beams, as one mesh.
/// let beam = solids::cuboid(Vector3::new(1.0, 0.1, 0.1))?;
/// let mut upright = Piece::new(beam.clone());
/// upright.pose = Isometry3::new(Vector3::new(1.0, 0.9, 0.0), Vector3::z() * 1.6);
/// let mesh = Compound::new(vec![Piece::new(beam), upright])?.to_mesh()?;
///
/// let parameters = VHACDParameters { resolution: 32, ..Default::default() };
/// let pieces = decompose(mesh.clone(), &parameters)?;
/// println!("{} pieces: {}", pieces.pieces().pieces().len(), pieces.fit());
/// let at = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.5, 0.0))?;
/// let found = pieces.distance(&mut PairTracker::new(), &mesh, &at);
/// let exact = PairTracker::new().distance(&mesh, &mesh, &at);
/// assert!(found.lower <= exact.value && exact.value <= found.upper);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn decompose(
    mesh: impl Into<Arc<Mesh>>,
    parameters: &VHACDParameters,
) -> Result<Decomposition, DecompositionError> {
    if !RESOLUTIONS.contains(&parameters.resolution) {
        return Err(DecompositionError::Resolution(parameters.resolution));
    }
    let mesh: Arc<Mesh> = mesh.into();
    let (low, high) = mesh.aabb();
    let centre = low.coords * 0.5 + high.coords * 0.5;
    let size = (high - low).max();
    let corners = mesh.triangles().flat_map(|(_, t)| t);
    let points: Vec<Vector> = corners.map(|p| narrow(&((p.coords - centre) / size))).collect();
    let triangles: Vec<[u32; 3]> = (0..points.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let parts =
        VHACD::decompose(parameters, &points, &triangles, true).compute_primitive_intersections(&points, &triangles);
    let piece = |part: &Vec<Vector>| {
        let points: Vec<_> = part.iter().map(|p| Point3::from(wide(*p) * size + centre)).collect();
        ConvexPolyhedron::from_points(&points).ok().map(Piece::new)
    };
    let pieces: Vec<Piece> = parts.iter().filter_map(piece).collect();
    if pieces.is_empty() {
        return Err(DecompositionError::Empty { pieces: parts.len() });
    }
    Ok(Decomposition::new(mesh, Compound::new(pieces)?)?)
}
