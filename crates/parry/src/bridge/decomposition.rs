//! Convex decomposition with parry's V-HACD, with measured gaps.

use std::sync::Arc;

use lin_canny::nalgebra::Point3;
use lin_canny::{Compound, CompoundError, ConvexPolyhedron, Decomposition, Mesh, MeshError, Piece};

use super::number::{narrow, wide};
use super::parry::math::Vector;
use super::parry::transformation::vhacd::{VHACD, VHACDParameters};

/// Range of cells along the longest side: with fewer V-HACD makes no body, more take gigabytes.
const RESOLUTIONS: std::ops::RangeInclusive<u32> = 4..=512;

/// Error of [`decompose`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DecompositionError {
    /// Returned if `VHACDParameters::resolution` is out of range.
    #[error("resolution is out of range: {0} (expected 4..=512)")]
    Resolution(u32),
    /// Returned if no piece of V-HACD has a volume.
    #[error("none of the {pieces} pieces of V-HACD has a volume")]
    Empty {
        /// Number of pieces that V-HACD made.
        pieces: usize,
    },
    /// Returned if the pieces cannot form a compound.
    #[error(transparent)]
    Pieces(#[from] CompoundError),
    /// Returned if the pieces cannot be measured.
    #[error(transparent)]
    Measure(#[from] MeshError),
}

/// Returns the convex pieces of a mesh by parry's V-HACD, with the measured gaps to the mesh.
///
/// Each piece is the hull of the part of the mesh within it. V-HACD works on a grid of cells and
/// guarantees nothing. So the pieces are built with exact predicates, pieces without volume are
/// removed, and the gaps are measured. Distances by [`Decomposition::distance`] are intervals that
/// hold for the mesh, for any quality of the pieces. The mesh is first scaled to size one, because
/// parry's tolerances are absolute.
///
/// # Errors
/// Returns an error if the resolution is out of range or no piece has a volume.
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
