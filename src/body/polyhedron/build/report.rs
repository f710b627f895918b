//! The report of building a body.

use alloc::vec::Vec;
use core::fmt;

/// The report of building a body.
#[derive(Clone, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BuildReport {
    /// Number of points given.
    pub input_points: usize,
    /// Vertices of the body.
    pub vertices: usize,
    /// Edges of the body.
    pub edges: usize,
    /// Faces of the body.
    pub faces: usize,
    /// Exactly equal points that are not strictly inside the body, as `(dropped, kept)`.
    pub duplicates: Vec<(u32, u32)>,
    /// Points dropped as strictly inside the body, copies included, in rising order.
    pub interior: Vec<u32>,
    /// Points dropped as inside a face.
    pub on_faces: Vec<u32>,
    /// Points dropped as inside an edge.
    pub on_edges: Vec<u32>,
    /// Points that no face uses (bodies from faces).
    pub unused: Vec<u32>,
    /// Triangles of the hull that were merged away into exactly coplanar faces.
    pub merged_facets: usize,
    /// Number of coordinates replaced by zero: below `2^-200` of the extent, at which exact
    /// arithmetic would run out of range.
    pub flushed_coordinates: usize,
    /// Thickness over length: 1 for a cube, small for sheets and needles, 0 for polygons, segments
    /// and points. The thickness is the least width along the axes of the box and the normals of
    /// the eight largest faces, an upper estimate of the least width in any direction; the length
    /// is the longest side of the box.
    pub thickness_ratio: f64,
    /// Largest distance of a vertex from the plane of its given face (bodies from faces).
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
        write!(f, ", thickness {:.1e} of the length", self.thickness_ratio)
    }
}
