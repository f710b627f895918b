//! Geometries from points, triangles and parameters.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{ConvexPolyhedron, HalfSpace, Mesh, RepairOptions, Shape, ShapeError};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;

use super::Geometry;
use crate::array::{Argument, contiguous, points, rows, shape_text, vector};
use crate::errors::geometry_error;

const POINTS: Argument = Argument {
    name: "points",
    error: |why| geometry_error(why),
};
const POINT: Argument = Argument {
    name: "a point",
    ..POINTS
};
pub(super) const VERTICES: Argument = Argument {
    name: "vertices",
    ..POINTS
};
const TRIANGLES: Argument = Argument {
    name: "triangles",
    ..POINTS
};
const NORMAL: Argument = Argument {
    name: "a normal",
    ..POINTS
};
const HEIGHTS: Argument = Argument {
    name: "heights",
    ..POINTS
};

fn of_shape(shape: Result<Shape, ShapeError>) -> PyResult<Geometry> {
    Ok(Geometry(shape.map_err(geometry_error)?.into()))
}

/// Returns the triangles of an array of shape (M, 3).
fn triangles_of(obj: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    let array = contiguous::<i64>(obj, TRIANGLES)?;
    let given = rows::<i64, 3>(&array, TRIANGLES)?;
    let mut triangles = Vec::with_capacity(given.len());
    for (k, corners) in given.iter().enumerate() {
        let mut triangle = [0; 3];
        for (to, &corner) in triangle.iter_mut().zip(corners) {
            *to = u32::try_from(corner)
                .map_err(|_| geometry_error(format!("triangle {k} uses a point that does not exist: {corner}")))?;
        }
        triangles.push(triangle);
    }
    Ok(triangles)
}

/// Returns the error of an object that has no `vertices` and `faces`.
#[cold]
fn not_a_mesh(obj: &Bound<'_, PyAny>) -> PyErr {
    let kind = obj.get_type();
    let kind = kind.name().map_or_else(|_| "object".into(), |name| name.to_string());
    // A scene of trimesh has its meshes in a dict.
    let hint = match obj.hasattr("to_mesh") {
        Ok(true) => "; pass its `to_mesh()`",
        _ => "",
    };
    geometry_error(format!(
        "a {kind} has no `vertices` and `faces` (expected a trimesh.Trimesh){hint}"
    ))
}

#[pymethods]
impl Geometry {
    /// Returns the convex hull of points, shape (N, 3), that do not all lie in a plane.
    #[staticmethod]
    fn hull(py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let points = self::points(points, POINTS)?;
        let body = py.detach(|| ConvexPolyhedron::from_points(&points));
        Ok(Self(body.map_err(geometry_error)?.into()))
    }

    /// Returns the convex polygon that is the hull of points of a plane, shape (N, 3).
    #[staticmethod]
    fn polygon(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let body = ConvexPolyhedron::polygon(&self::points(points, POINTS)?);
        Ok(Self(body.map_err(geometry_error)?.into()))
    }

    /// Returns the segment between two points, each of shape (3,).
    #[staticmethod]
    fn segment(start: &Bound<'_, PyAny>, end: &Bound<'_, PyAny>) -> PyResult<Self> {
        let [start, end] = [vector(start, POINT)?, vector(end, POINT)?].map(Point3::from);
        let body = ConvexPolyhedron::segment(start, end);
        Ok(Self(body.map_err(geometry_error)?.into()))
    }

    /// Returns a single point, shape (3,).
    #[staticmethod]
    fn point(point: &Bound<'_, PyAny>) -> PyResult<Self> {
        let body = ConvexPolyhedron::point(Point3::from(vector(point, POINT)?));
        Ok(Self(body.map_err(geometry_error)?.into()))
    }

    /// Returns the mesh of triangles as they are: a solid if the mesh is closed, else a surface.
    ///
    /// vertices: shape (N, 3). triangles: indices of vertices, shape (M, 3), counterclockwise from
    /// outside.
    #[staticmethod]
    fn mesh(py: Python<'_>, vertices: &Bound<'_, PyAny>, triangles: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (vertices, triangles) = (points(vertices, VERTICES)?, triangles_of(triangles)?);
        let mesh = py.detach(|| Mesh::new(&vertices, &triangles));
        Ok(Self(mesh.map_err(geometry_error)?.into()))
    }

    /// Returns the mesh after a repair of cracks, inverted triangles and holes; `repair_report` says what
    /// was changed.
    ///
    /// With caps the result is a solid for every input: its sides and winding numbers are exact. Triangles
    /// of caps count on from those given.
    ///
    /// Parameters
    /// ----------
    /// weld : points at most this far from an earlier point move to it; 0 welds equal points.
    /// orient : whether triangles are inverted, so that neighbours agree and solids face outward.
    /// caps : whether holes are closed by triangles between their corners.
    #[staticmethod]
    #[pyo3(signature = (vertices, triangles, *, weld=0.0, orient=true, caps=true))]
    fn repaired_mesh(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        weld: f64,
        orient: bool,
        caps: bool,
    ) -> PyResult<Self> {
        let (vertices, triangles) = (points(vertices, VERTICES)?, triangles_of(triangles)?);
        let options = RepairOptions::default().weld(weld).orient(orient).caps(caps);
        let mesh = py.detach(|| Mesh::repaired(&vertices, &triangles, &options));
        Ok(Self(mesh.map_err(geometry_error)?.into()))
    }

    /// Returns the mesh of a `trimesh.Trimesh`, or of any object with `vertices` and `faces`.
    ///
    /// Raises GeometryError for another object. Of a `trimesh.Scene`, which `trimesh.load` returns
    /// for some formats, pass `scene.to_mesh()`.
    #[staticmethod]
    fn from_trimesh(py: Python<'_>, mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        let part = |name: &str| mesh.getattr(name).map_err(|_| not_a_mesh(mesh));
        Self::mesh(py, &part("vertices")?, &part("faces")?)
    }

    /// Returns the mesh of a height field.
    ///
    /// The value `[i][j]` is the z at x = j * spacing[0] and y = i * spacing[1]. Every square is
    /// cut along the diagonal from `[i][j]` to `[i + 1][j + 1]`.
    ///
    /// Parameters
    /// ----------
    /// heights : array_like, shape (rows, columns)
    ///     At least two rows and two columns.
    /// spacing : tuple of two floats
    ///     Distances of neighbouring values along x and y.
    /// base : float, optional
    ///     The z of a base below all heights: the mesh is a solid with walls down to it. Without a
    ///     base, the mesh is an open surface, and a body below it does not overlap it.
    ///
    /// Raises
    /// ------
    /// GeometryError
    ///     If a height is not finite or not above the base: names the index, row by row.
    #[staticmethod]
    #[pyo3(signature = (heights, *, spacing, base=None))]
    fn from_heights(
        py: Python<'_>,
        heights: &Bound<'_, PyAny>,
        spacing: [f64; 2],
        base: Option<f64>,
    ) -> PyResult<Self> {
        let array = contiguous::<f64>(heights, HEIGHTS)?;
        let &[rows, columns] = array.shape() else {
            let shape = shape_text(array.shape());
            return Err(geometry_error(format!("heights: shape is {shape} (expected (M, N))")));
        };
        let heights = array.as_slice()?.to_vec();
        let mesh = py.detach(|| Mesh::from_heights(rows, columns, spacing, &heights, base));
        Ok(Self(mesh.map_err(geometry_error)?.into()))
    }

    /// Returns the half-space of all points x with `normal . x <= offset`, such as a floor.
    ///
    /// The signed distance of any geometry is the height of its lowest point over the plane. So
    /// depths are known for every kind.
    ///
    /// Parameters
    /// ----------
    /// normal : array_like, shape (3,)
    ///     Points out of the half-space; of any length except zero.
    /// offset : float
    ///     The bound of `normal . x`: the height of the plane if the normal has length one.
    #[staticmethod]
    #[pyo3(signature = (normal, offset=0.0))]
    fn half_space(normal: &Bound<'_, PyAny>, offset: f64) -> PyResult<Self> {
        let space = HalfSpace::new(vector(normal, NORMAL)?, offset);
        Ok(Self(space.map_err(geometry_error)?.into()))
    }

    /// Returns the box about the origin with the given half extents along x, y and z.
    #[staticmethod]
    #[pyo3(name = "box")]
    fn cuboid(half_x: f64, half_y: f64, half_z: f64) -> PyResult<Self> {
        of_shape(Shape::cuboid(Vector3::new(half_x, half_y, half_z)))
    }

    /// Returns the ball about the origin.
    #[staticmethod]
    fn ball(radius: f64) -> PyResult<Self> {
        of_shape(Shape::ball(radius))
    }

    /// Returns the capsule about the origin along z: the points within `radius` of the segment from
    /// -half_length to half_length.
    #[staticmethod]
    #[pyo3(signature = (*, half_length, radius))]
    fn capsule(half_length: f64, radius: f64) -> PyResult<Self> {
        of_shape(Shape::capsule(half_length, radius))
    }

    /// Returns the cylinder about the origin along z.
    #[staticmethod]
    #[pyo3(signature = (*, half_height, radius))]
    fn cylinder(half_height: f64, radius: f64) -> PyResult<Self> {
        of_shape(Shape::cylinder(half_height, radius))
    }

    /// Returns the cone about the origin along z: apex at half_height, base disc at -half_height.
    #[staticmethod]
    #[pyo3(signature = (*, half_height, radius))]
    fn cone(half_height: f64, radius: f64) -> PyResult<Self> {
        of_shape(Shape::cone(half_height, radius))
    }

    /// Returns the ellipsoid about the origin with the given semi-axes along x, y and z.
    #[staticmethod]
    fn ellipsoid(semi_x: f64, semi_y: f64, semi_z: f64) -> PyResult<Self> {
        of_shape(Shape::ellipsoid(Vector3::new(semi_x, semi_y, semi_z)))
    }
}
