//! What building a body kept, merged and dropped.

use alloc::vec::Vec;
use core::fmt;

/// What building a body kept, merged and dropped. Indices are the caller's, lengths in the caller's
/// unit.
#[derive(Clone, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BuildReport {
    /// Points given.
    pub input_points: usize,
    /// Vertices of the body.
    pub vertices: usize,
    /// Edges of the body.
    pub edges: usize,
    /// Faces of the body.
    pub faces: usize,
    /// `(dropped, kept)`: exactly equal points.
    pub duplicates: Vec<(u32, u32)>,
    /// Points dropped because they lie strictly inside.
    pub interior: Vec<u32>,
    /// Points dropped because they lie inside a face.
    pub on_faces: Vec<u32>,
    /// Points dropped because they lie inside an edge.
    pub on_edges: Vec<u32>,
    /// Points no face uses (bodies from faces).
    pub unused: Vec<u32>,
    /// Triangles of the hull that were merged away into exactly coplanar faces.
    pub merged_facets: usize,
    /// Coordinates replaced by zero: below `2^-200` of the extent, where exact arithmetic would run
    /// out of range.
    pub flushed_coordinates: usize,
    /// Thickness over longest box side, at most 1 and 0 for flat bodies: the least width across the
    /// box's axes and across the eight largest faces, an upper estimate of the least width in any
    /// direction.
    pub flatness: f64,
    /// Largest distance of a corner from the plane of its face as given (bodies from faces).
    pub non_planarity: f64,
    /// Vertices - edges + faces: 2 for every body with faces.
    pub euler_characteristic: i64,
}

impl fmt::Display for BuildReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} vertices, {} edges, {} faces from {} points",
            self.vertices, self.edges, self.faces, self.input_points
        )?;
        let dropped = [
            (self.duplicates.len(), "duplicates"),
            (self.interior.len(), "interior points"),
            (self.on_faces.len(), "points on faces"),
            (self.on_edges.len(), "points on edges"),
            (self.unused.len(), "unused points"),
        ];
        for (count, what) in dropped.into_iter().filter(|d| d.0 > 0) {
            write!(f, ", {count} {what} dropped")?;
        }
        if self.merged_facets > 0 {
            write!(f, ", {} coplanar facets merged", self.merged_facets)?;
        }
        if self.flushed_coordinates > 0 {
            write!(f, ", {} coordinates flushed to zero", self.flushed_coordinates)?;
        }
        if self.non_planarity > 0.0 {
            write!(f, ", faces planar to {:.1e}", self.non_planarity)?;
        }
        write!(f, ", flatness {:.1e}", self.flatness)
    }
}
