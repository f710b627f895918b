//! Reasons to refuse a mesh, and the report of a build: kept, dropped, found.

use alloc::vec::Vec;
use core::fmt;

use crate::base::notice::Stopped;

/// Reason why points and triangles make no mesh. Indices are the caller's, lengths in the caller's
/// unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such point.
        index: usize,
    },
    /// A triangle names a point that does not exist.
    #[error("triangle {triangle} names point {index}, which does not exist")]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The index named.
        index: usize,
    },
    /// More points or triangles than ids of 27 bits can name.
    #[error("{count} points or triangles are more than ids can name")]
    TooMany {
        /// Points or triangles given.
        count: usize,
    },
    /// No triangle is left: none was given, or all are degenerate.
    #[error("no triangle is left of {given}")]
    Empty {
        /// Triangles given.
        given: usize,
    },
    /// The longest side of the bounding box is below 1e-100 or above 1e100, or a coordinate is
    /// above 1e116.
    #[error("the extent {extent:e} lies outside 1e-100..1e100, or a coordinate is above 1e116")]
    OutOfRange {
        /// The longest side of the bounding box.
        extent: f64,
    },
    /// A piece of a composite that is rounded or curved, and has no triangles.
    #[error("piece {piece} is rounded or curved")]
    Curved {
        /// The piece.
        piece: usize,
    },
    /// Triangles cannot be turned to close a mesh: two must meet at every edge. Returned by
    /// [`Mesh::oriented`](super::Mesh::oriented).
    #[error("{triangles} triangles meet at the edge of points {} and {}: only a mesh with two at every edge is oriented", edge[0], edge[1])]
    NotTwo {
        /// The points of the first such edge.
        edge: [u32; 2],
        /// Triangles that meet there.
        triangles: usize,
    },
    /// Triangles cannot be turned to agree: the surface has one side, as a Moebius strip. Returned
    /// by [`Mesh::oriented`](super::Mesh::oriented).
    #[error("the surface has one side: its triangles cannot agree at the edge of points {} and {}", edge[0], edge[1])]
    OneSided {
        /// The points of an edge at which the triangles do not agree.
        edge: [u32; 2],
    },
    /// A piece of a composite that is a point or a segment, or so thin that triangles of its faces
    /// have no area where the piece is placed.
    #[error("piece {piece} is a point, a segment, or too thin to have triangles")]
    Thin {
        /// The piece.
        piece: usize,
    },
    /// Data of a stored mesh that do not describe one.
    #[error("the stored mesh is damaged: {what}")]
    Damaged {
        /// The data that do not fit.
        what: &'static str,
    },
    /// The caller's callback of progress has stopped the call.
    #[error("the caller has stopped the build")]
    Stopped,
}

impl From<Stopped> for MeshError {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

/// Reason why the vertices of a mesh cannot be replaced. Vertices are named by their numbers in
/// [`Mesh::vertices`](super::Mesh::vertices), lengths are in the caller's unit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VertexError {
    /// Another number of vertices than the mesh has.
    #[error("{given} vertices were given for the {count} of the mesh")]
    Count {
        /// Vertices given.
        given: usize,
        /// Vertices of the mesh, without points that were welded or are not used.
        count: usize,
    },
    /// A vertex that does not exist.
    #[error("vertex {index} does not exist: the mesh has {count}")]
    Missing {
        /// The first such vertex.
        index: usize,
        /// Vertices of the mesh.
        count: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such vertex.
        index: usize,
    },
    /// The longest side of the bounding box would be below 1e-100 or above 1e100, or a coordinate
    /// above 1e116.
    #[error("the extent {extent:e} lies outside 1e-100..1e100, or a coordinate is above 1e116")]
    OutOfRange {
        /// The longest side of the bounding box, or the coordinate.
        extent: f64,
    },
    /// The build has dropped a triangle whose corners were on a line: it might have an area now.
    #[error("triangle {triangle} was dropped when the mesh was built: its corners were on a line")]
    Dropped {
        /// The first such triangle, by the caller's index.
        triangle: u32,
    },
    /// Edges that lie on others along a line close the mesh: the surface might open there.
    #[error("the mesh is closed only along lines, where an edge faces two shorter ones")]
    ClosedAlongLines,
}

/// Whether a mesh bounds a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MeshKind {
    /// Closed: along every line as many edges of triangles run one way as the other, all along the
    /// line; an edge may face two shorter ones. Points with a winding number other than zero are
    /// inside and belong to the body.
    Solid,
    /// Not closed: the body is the triangles alone and has no inside.
    Surface,
}

impl fmt::Display for MeshKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Solid => "solid",
            Self::Surface => "surface",
        })
    }
}

/// A connected part of a mesh: triangles that share vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshPart {
    /// One triangle of the part, by the caller's index.
    pub triangle: u32,
    /// Number of triangles.
    pub triangles: u32,
    /// Signed volume if the mesh is a solid, in the caller's unit cubed: negative if the triangles
    /// run clockwise seen from outside, as the triangles of a cavity do.
    pub volume: f64,
}

/// What building a mesh kept, dropped and found. Indices are the caller's.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshReport {
    /// Whether the mesh is closed.
    pub kind: MeshKind,
    /// Points given.
    pub input_points: usize,
    /// Triangles given.
    pub input_triangles: usize,
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Points that were welded to an earlier point with the same coordinates.
    pub welded: usize,
    /// Points that no triangle kept uses.
    pub unused: usize,
    /// Triangles dropped because their corners are collinear or equal. They close nothing: the kind
    /// of the mesh is the same with them.
    pub degenerate: Vec<u32>,
    /// `(dropped, kept)`: triangles with the same corners in the same sense. None is dropped if the
    /// mesh is closed only when they are counted.
    pub repeated: Vec<(u32, u32)>,
    /// Edges of one triangle. In a solid they lie on other edges along the same line.
    pub boundary_edges: Vec<[u32; 2]>,
    /// Edges of more than two triangles.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Edges of two triangles that run along it in the same sense: one of them is turned over.
    /// [`Mesh::oriented`](super::Mesh::oriented) turns it back.
    pub misoriented_edges: Vec<[u32; 2]>,
    /// Connected parts, by their first triangle.
    pub parts: Vec<MeshPart>,
    /// Coordinates replaced by zero: below `2^-200` of the extent, below which exact predicates
    /// would run out of range.
    pub flushed_coordinates: usize,
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} vertices and {} triangles in {} parts",
            self.kind,
            self.vertices,
            self.triangles,
            self.parts.len()
        )?;
        let found = [
            (self.welded, "points welded"),
            (self.unused, "points unused"),
            (self.degenerate.len(), "degenerate triangles dropped"),
            (self.repeated.len(), "repeated triangles dropped"),
            (self.boundary_edges.len(), "boundary edges"),
            (self.non_manifold_edges.len(), "non-manifold edges"),
            (self.misoriented_edges.len(), "edges of triangles turned over"),
            (self.flushed_coordinates, "coordinates flushed to zero"),
        ];
        for (count, what) in found.into_iter().filter(|x| x.0 > 0) {
            write!(f, ", {count} {what}")?;
        }
        let inward = self.parts.iter().filter(|p| p.volume < 0.0).count();
        if inward > 0 {
            write!(f, ", {inward} parts facing inward")?;
        }
        Ok(())
    }
}
