//! Geometries: what bodies are made of.

mod build;
mod cloud;
mod patches;
mod repair;

pub(crate) use cloud::Cloud;
pub(crate) use repair::MeshRepair;

use std::borrow::Cow;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{Compound, Geometry as Body, GeometryKind, Mesh, Piece};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use self::build::VERTICES;
use crate::array::{points, triple};
use crate::errors::geometry_error;
use crate::pickle::{Pickled, pickled};
use crate::pose::Pose;

/// A geometry in its own frame: immutable, shared by any number of trackers, scenes and threads.
///
/// Lengths are in the caller's unit; nothing depends on the unit. Every constructor raises
/// `GeometryError` for input that makes no geometry, and names the point, triangle or parameter.
#[pyclass(frozen, subclass, module = "lin_canny")]
pub(crate) struct Geometry(pub(crate) Body);

/// A piece as an argument: a geometry, or a geometry and its pose.
#[derive(FromPyObject)]
enum PieceArgument<'py> {
    Placed(Bound<'py, Geometry>, Pose),
    Bare(Bound<'py, Geometry>),
}

fn piece(k: usize, argument: &PieceArgument) -> PyResult<Piece> {
    let (geometry, pose) = match argument {
        PieceArgument::Placed(geometry, pose) => (geometry.get(), pose.0),
        PieceArgument::Bare(geometry) => (geometry.get(), Isometry3::identity()),
    };
    let shape = geometry.0.as_convex();
    let shape = shape.ok_or_else(|| {
        geometry_error(format!(
            "piece {k} is a {} (expected a convex geometry)",
            geometry.0.kind()
        ))
    })?;
    let mut piece = Piece::new(shape.into_owned());
    piece.pose = pose;
    Ok(piece)
}

#[pymethods]
impl Geometry {
    /// Returns the union of convex pieces.
    ///
    /// pieces: geometries, or tuples of a geometry and its pose in the frame of the union.
    #[staticmethod]
    fn pieces(py: Python<'_>, pieces: Vec<PieceArgument<'_>>) -> PyResult<Self> {
        let pieces: PyResult<Vec<Piece>> = pieces.iter().enumerate().map(|(k, p)| piece(k, p)).collect();
        let pieces = pieces?;
        let body = py.detach(|| Compound::new(pieces)).map_err(geometry_error)?;
        Ok(Self(body.into()))
    }

    /// Returns the geometry grown by a ball of radius `by` (Minkowski sum): convex geometries only.
    fn rounded(&self, by: f64) -> PyResult<Self> {
        let shape = self.0.as_convex();
        let shape = shape.ok_or_else(|| {
            geometry_error(format!(
                "a {} cannot be rounded (expected a convex geometry); round its pieces, or query `within`",
                self.0.kind()
            ))
        })?;
        let rounded = shape.into_owned().rounded(by).map_err(geometry_error)?;
        Ok(Self(rounded.into()))
    }

    /// The kind: "polyhedron", "point or segment", "rounded polyhedron", "curved shape",
    /// "compound", "mesh", "cloud", "Bézier surface" or "half-space".
    #[getter]
    fn kind(&self) -> String {
        self.0.kind().to_string()
    }

    /// Returns the mesh with other vertices, float64 of shape (N, 3), in the order of `vertices`:
    /// a mesh that bends.
    ///
    /// The triangles stay, and so does whether the mesh is closed; its tree is fitted to the
    /// vertices, which takes a tenth of the time of a new mesh. A tracker goes on from the mesh
    /// before: begin with the mesh of the last frame, not with the first. Fold it far, and queries
    /// take longer until `rebuilt` makes another tree.
    fn with_vertices(&self, py: Python<'_>, vertices: &Bound<'_, PyAny>) -> PyResult<Self> {
        let vertices = points(vertices, VERTICES)?;
        let mut mesh = self.own_mesh()?.clone();
        py.detach(|| mesh.set_vertices(&vertices)).map_err(geometry_error)?;
        Ok(Self(mesh.into()))
    }

    /// Returns the mesh with a new tree, for a mesh `with_vertices` far from those it was built of.
    fn rebuilt(&self, py: Python<'_>) -> PyResult<Self> {
        let mut mesh = self.own_mesh()?.clone();
        py.detach(|| mesh.rebuild());
        Ok(Self(mesh.into()))
    }

    /// Whether the geometry is convex.
    #[getter]
    fn is_convex(&self) -> bool {
        !matches!(
            self.0.kind(),
            GeometryKind::Compound | GeometryKind::Mesh | GeometryKind::Cloud | GeometryKind::BezierSurface
        )
    }

    /// Whether the geometry has an inside: of a mesh, whether it is closed.
    #[getter]
    fn is_solid(&self) -> bool {
        match &self.0 {
            Body::Mesh(mesh) => mesh.kind() == lin_canny::MeshKind::Solid,
            Body::BezierSurface(_) => false,
            _ => true,
        }
    }

    /// What the repair of this mesh has changed; None unless `repaired_mesh` made it.
    #[getter]
    fn repair_report(&self) -> Option<MeshRepair> {
        let Body::Mesh(mesh) = &self.0 else { return None };
        mesh.report().repair.clone().map(MeshRepair)
    }

    /// A ball that contains the geometry: centre, shape (3,), and radius; 1e100 for a half-space.
    #[getter]
    fn bounding_ball<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f64>>, f64) {
        let (centre, radius) = self.0.bounding_ball();
        (triple(py, centre.coords.into()), radius)
    }

    /// The vertices, float64 of shape (N, 3), of a mesh (as given, without points that were welded
    /// to an earlier one or that no triangle uses) or polyhedron, or of the surface of a
    /// compound of polyhedra.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (vertices, _) = self.indexed()?;
        let count = vertices.len();
        PyArray1::from_vec(py, vertices.into_flattened()).reshape([count, 3])
    }

    /// The triangles, int64 of shape (M, 3): indices of `vertices`, counterclockwise from outside.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let (_, triangles) = self.indexed()?;
        let count = triangles.len();
        PyArray1::from_vec(py, triangles.into_flattened()).reshape([count, 3])
    }

    /// Returns a View of the geometry: a page for a notebook or a browser. See `lin_canny.show`.
    fn show<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        crate::view::call(this.py(), "show", (this,))
    }

    /// Returns the page of `show` for a notebook; None beyond 100,000 triangles.
    fn _repr_html_<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        crate::view::call(this.py(), "geometry_html", (this,))
    }

    /// Returns a `trimesh.Trimesh` of `vertices` and `triangles`; needs the package trimesh.
    fn to_trimesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let options = pyo3::types::PyDict::new(py);
        options.set_item("process", false)?;
        let arrays = (self.vertices(py)?, self.triangles(py)?);
        py.import("trimesh")?.call_method("Trimesh", arrays, Some(&options))
    }

    fn __repr__(&self) -> String {
        match &self.0 {
            Body::Polyhedron(p) => {
                format!(
                    "<Geometry hull: {} vertices, {} faces>",
                    p.vertex_count(),
                    p.face_count()
                )
            }
            Body::Mesh(m) => {
                let (vertices, triangles) = (m.vertex_count(), m.triangle_count());
                format!(
                    "<Geometry {} mesh: {vertices} vertices, {triangles} triangles>",
                    m.kind()
                )
            }
            Body::Compound(c) => format!("<Geometry compound: {} pieces>", c.pieces().len()),
            Body::Cloud(c) => format!("<Cloud: {} points>", c.len()),
            Body::HalfSpace(h) => {
                let n = h.normal();
                format!(
                    "<Geometry half-space: normal ({}, {}, {}), offset {}>",
                    n.x,
                    n.y,
                    n.z,
                    h.offset()
                )
            }
            Body::BezierSurface(s) => format!("<Geometry surface: {} patches>", s.patches().len()),
            other => format!("<Geometry {}: radius {:.6}>", other.kind(), other.bounding_ball().1),
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        pickled::<Self>(py, postcard::to_stdvec(&self.0))
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        postcard::from_bytes(bytes).map(Self).map_err(geometry_error)
    }
}

/// Vertices, and triangles of their indices.
type IndexedTriangles = (Vec<[f64; 3]>, Vec<[i64; 3]>);

impl Geometry {
    /// Returns the mesh that the geometry is.
    pub(crate) fn own_mesh(&self) -> PyResult<&Mesh> {
        match &self.0 {
            Body::Mesh(mesh) => Ok(mesh),
            other => Err(geometry_error(format!("a {} is not a mesh", other.kind()))),
        }
    }

    /// Returns the triangles of the surface.
    fn mesh_of(&self) -> PyResult<Cow<'_, Mesh>> {
        match &self.0 {
            Body::Mesh(mesh) => Ok(Cow::Borrowed(mesh)),
            Body::Polyhedron(body) => Mesh::from_convex(body).map(Cow::Owned).map_err(geometry_error),
            Body::Compound(body) => body.to_mesh().map(Cow::Owned).map_err(geometry_error),
            other => Err(geometry_error(format!("a {} has no triangles", other.kind()))),
        }
    }

    fn indexed(&self) -> PyResult<IndexedTriangles> {
        let mesh = self.mesh_of()?;
        if let Body::Mesh(mesh) = &self.0 {
            let vertices = mesh.vertices().iter().map(|p| p.coords.into()).collect();
            let triangles = mesh.triangle_vertices().iter().map(|t| t.map(i64::from)).collect();
            return Ok((vertices, triangles));
        }
        let mut numbers = std::collections::HashMap::new();
        let mut vertices = Vec::with_capacity(mesh.vertex_count());
        let mut number = |p: &Point3<f64>| {
            let coordinates: [f64; 3] = p.coords.into();
            *numbers.entry(coordinates.map(f64::to_bits)).or_insert_with(|| {
                vertices.push(coordinates);
                vertices.len() as i64 - 1
            })
        };
        let mut triangles: Vec<_> = mesh
            .triangles()
            .map(|(k, t)| (k, t.each_ref().map(&mut number)))
            .collect();
        triangles.sort_unstable_by_key(|(k, _)| *k);
        Ok((vertices, triangles.into_iter().map(|(_, t)| t).collect()))
    }
}
