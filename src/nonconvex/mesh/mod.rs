//! Triangle meshes: checked, welded and stored in the order of their tree.

mod build;
pub(crate) mod edges;
mod heights;
pub(super) mod hull;
pub(super) mod measure;
#[cfg(feature = "serde")]
mod persist;
mod repair;
mod report;
mod self_distance;
pub(crate) mod tracker;
mod vertices;

use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

pub use hull::HullFit;
pub use repair::{MeshCap, MeshRepair, RepairOptions};
pub use report::{MeshError, MeshInspection, MeshKind, MeshPart, MeshReport, VertexError};

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::sign;
use crate::base::num::sort::sort;
use crate::base::tolerance::PART_EXTENT_MIN;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::polyhedron::obj;
use crate::nonconvex::tree::Tree;
use crate::pair::transform::StoredFrame;
use vertices::{Bending, Stiff};

/// A body made of the caller's triangles, without a convex decomposition.
///
/// A closed mesh is a solid; any other mesh is open and has no inside ([`kind`](Self::kind)). A
/// mesh is `Send + Sync` and cheap to share by reference or `Arc`. It is immutable except for
/// [`set_vertices`](Self::set_vertices), which moves its vertices. Coordinates are in the body's
/// frame and in any unit that the caller chooses. The vertices of a triangle are counter-clockwise
/// seen from outside.
///
/// ```
/// use lin_canny::nalgebra::Point3;
/// use lin_canny::{Mesh, MeshKind};
///
/// let points =
///     [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from);
/// let wedge = Mesh::new(&points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// assert_eq!(wedge.kind(), MeshKind::Solid);
/// let open = Mesh::new(&points, &[[0, 2, 1], [0, 1, 3]])?;
/// assert_eq!(open.kind(), MeshKind::Open);
/// assert_eq!(open.report().boundary_edges.len(), 4);
/// # Ok::<(), lin_canny::MeshError>(())
/// ```
#[doc(alias = "trimesh")]
#[doc(alias = "triangle soup")]
#[derive(Clone, Debug)]
pub struct Mesh {
    /// The vertices in stored coordinates, in the order in which the triangles use them.
    pub(crate) points: Vec<Vector3<f64>>,
    /// Vertices of each triangle, in the order of the tree's leaves.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The caller's index of each vertex; the lowest index of several equal points.
    pub(crate) source_points: Vec<u32>,
    /// The caller's index of each triangle.
    pub(crate) source_triangles: Vec<u32>,
    /// Four vertices of each connected component, far from each other.
    pub(crate) part_vertices: Vec<[u32; 4]>,
    pub(crate) tree: Tree,
    /// The frame of stored coordinates: about the middle of the box if that is far from the
    /// caller's origin. The caller's vertices are mapped there without rounding.
    pub(crate) frame: StoredFrame,
    /// Largest distance of a vertex from the stored origin, rounded up, in stored units.
    pub(crate) radius: f64,
    /// Corners of the bounding box, in stored coordinates.
    pub(crate) low: Vector3<f64>,
    pub(crate) high: Vector3<f64>,
    /// Largest error of the position of a vertex, in stored units. It is zero except for a mesh
    /// that represents the pieces of a compound: the vertices of its posed pieces are rounded.
    pub(crate) off: f64,
    /// Identifies the mesh for trackers. It covers everything that state refers to by index:
    /// points, triangles, the links of the tree, the caller's indices, and every later change. So
    /// an index into one mesh is never used in another mesh of equal fingerprint.
    pub(crate) fingerprint: Fingerprint,
    report: MeshReport,
    /// The reason why the vertices cannot be replaced, if they cannot.
    stiff: Option<Stiff>,
    /// Set if vertices of the mesh have been replaced.
    bending: Option<Box<Bending>>,
}

impl Mesh {
    /// Returns whether the mesh is a solid or an open mesh.
    #[must_use]
    pub fn kind(&self) -> MeshKind {
        self.report.kind
    }

    /// Returns the report of the build: what was kept, dropped and found.
    #[must_use]
    pub fn report(&self) -> &MeshReport {
        &self.report
    }

    /// Returns the number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// Returns the corners of the bounding box in the body's frame.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        (self.given(&self.low), self.given(&self.high))
    }

    /// Returns the size of the mesh on the heap in bytes, without its report.
    #[must_use]
    pub fn memory_usage(&self) -> usize {
        let numbers = self.source_points.len() + self.source_triangles.len() + 4 * self.part_vertices.len();
        size_of_val(&self.points[..]) + size_of_val(&self.triangles[..]) + 4 * numbers + self.tree.memory_usage()
    }

    /// Returns the vertices of every triangle with the caller's index of the triangle.
    ///
    /// The order is that of the tree.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [Point3<f64>; 3])> + '_ {
        let each = self.triangles.iter().zip(&self.source_triangles);
        each.map(|(t, &source)| (source, t.each(|v| self.given(&self.points[v as usize]))))
    }

    /// Returns the mesh as the text of an OBJ file.
    ///
    /// The file holds the welded points, exact to the last bit, and the triangles in the order of
    /// the tree.
    ///
    /// ```
    /// use lin_canny::{Mesh, polyhedron::solids};
    ///
    /// let mesh = Mesh::from_convex(&solids::icosahedron(1.0)?)?;
    /// let text = mesh.to_obj(); // std::fs::write("mesh.obj", text)?;
    /// assert_eq!(text.lines().count(), 12 + 20);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "write")]
    #[doc(alias = "export")]
    #[must_use]
    pub fn to_obj(&self) -> String {
        let faces = self.triangles.iter().map(|t| t.iter().map(|v| *v as usize));
        obj(self.points.iter().map(|p| self.given(p)), faces)
    }

    /// Returns the corners of the box of a tree node, for drawing.
    ///
    /// Corner k is at the far end of axis i if bit i of k is set. Queries compare this box in
    /// single precision; its error is below a millionth of the size of the mesh.
    #[cfg(feature = "__internals")]
    #[doc(hidden)]
    #[must_use]
    pub fn node_box(&self, node: u32) -> Option<[Point3<f64>; 8]> {
        let b = self.tree.boxes.get(node as usize)?;
        let (centre, half) = (b.centre(), b.half());
        Some(core::array::from_fn(|k| {
            let end = |i: usize| b.axis(i) * if k >> i & 1 == 1 { half[i] } else { -half[i] };
            let place = centre + end(0) + end(1) + end(2);
            self.given(&(place * self.tree.unit() + self.tree.centre))
        }))
    }

    pub(crate) fn is_solid(&self) -> bool {
        self.report.kind == MeshKind::Solid
    }

    /// Returns a stored point in the caller's coordinates.
    pub(crate) fn given(&self, stored: &Vector3<f64>) -> Point3<f64> {
        self.frame.given(stored)
    }

    /// Returns one stored unit in the caller's unit.
    pub(crate) fn unit(&self) -> f64 {
        self.frame.unit()
    }

    /// Returns the centroid of a triangle in stored coordinates.
    pub(crate) fn triangle_middle(&self, triangle: u32) -> Vector3<f64> {
        let [a, b, c] = self.corners(triangle);
        (a + b + c) / 3.0
    }

    /// Returns the vertices of a triangle in stored coordinates.
    #[inline(always)]
    pub(crate) fn corners(&self, triangle: u32) -> [Vector3<f64>; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        [
            self.points[a as usize],
            self.points[b as usize],
            self.points[c as usize],
        ]
    }

    /// Returns a triangle as a convex body in the caller's unit.
    ///
    /// The body is a segment or a point if the triangle has no area. The result is `None` if the
    /// triangle is smaller than [`PART_EXTENT_MIN`].
    pub(crate) fn polygon(&self, triangle: u32) -> Option<ConvexPolyhedron> {
        polygon(&self.corners(triangle).each(|p| self.given(&p)))
    }

    /// Returns [`polygon`](Self::polygon) in a frame about the stored origin.
    pub(crate) fn stored_polygon(&self, triangle: u32) -> Option<ConvexPolyhedron> {
        let unit = self.unit();
        polygon(&self.corners(triangle).each(|p| Point3::from(p * unit)))
    }

    /// Returns the mesh with its frame moved to the stored origin.
    pub(crate) fn centred(&self) -> Self {
        let mut mesh = self.clone();
        mesh.frame.origin = Vector3::zeros();
        mesh.fingerprint = self.fingerprint.with(*b"centred ", 0.0);
        mesh
    }

    /// Returns a mesh that is stored about the origin, moved to another one.
    ///
    /// Returns `None` if the mesh is stored about another origin than that of its frame.
    pub(super) fn moved_to(mut self, origin: &Vector3<f64>) -> Option<Self> {
        if !self.frame.is_at_origin() {
            return None;
        }
        self.frame.origin = *origin;
        self.fingerprint = self.fingerprint_as_built();
        Some(self)
    }
}

fn polygon(corners: &[Point3<f64>; 3]) -> Option<ConvexPolyhedron> {
    ConvexPolyhedron::polygon_of(corners, PART_EXTENT_MIN)
        .ok()
        .or_else(|| line(corners))
}

/// Returns the segment or the point that three collinear points span.
#[cold]
fn line([a, b, c]: &[Point3<f64>; 3]) -> Option<ConvexPolyhedron> {
    if sign::projection(&a.coords, &b.coords, &c.coords).is_some() {
        return None;
    }
    // The two ends differ along the axis of the longest side.
    let sides = [b - a, c - b, a - c];
    let axis = sides.each(|s| s.iamax()).into_iter().max_by(|&i, &j| {
        let longest = |k: usize| sides.iter().fold(0.0f64, |m, s| m.larger(s[k].abs()));
        longest(i).total_cmp(&longest(j))
    })?;
    let mut ends = [*a, *b, *c];
    sort(&mut ends, |p, q| p[axis].total_cmp(&q[axis]));
    ConvexPolyhedron::segment_of(ends[0], ends[2], PART_EXTENT_MIN)
        .or_else(|_| ConvexPolyhedron::point(*a))
        .ok()
}
