//! Balls or a hull of few faces that contain a geometry, and balls inside.

use lin_canny::HalfSpace;
use lin_canny::cover::{BallCover, CoverGoal};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::errors::refused;
use crate::geometry::Geometry;

/// Centres, radii and gap.
type Balls<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, f64);

/// Polyhedron, normals, offsets and gap.
type Hull<'py> = (Geometry, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, f64);

fn arrays(py: Python<'_>, cover: BallCover) -> PyResult<Balls<'_>> {
    let centers = cover.balls.iter().flat_map(|ball| <[f64; 3]>::from(ball.center));
    let centers = PyArray1::from_iter(py, centers).reshape([cover.balls.len(), 3])?;
    let radii = PyArray1::from_iter(py, cover.balls.iter().map(|ball| ball.radius));
    Ok((centers, radii, cover.gap))
}

/// Returns balls whose union contains a geometry, with a proven bound of how far they stick out.
///
/// A polyhedron, shape or closed mesh is contained with its inside, an open mesh with each
/// triangle. So what is clear of all balls is clear of the geometry.
///
/// Parameters
/// ----------
/// geometry : Geometry
/// balls : int, optional
///     Greatest number of balls, at most 1024. Either this or `gap` is given.
/// gap : float, optional
///     Greatest distance by which balls stick out.
///
/// Returns
/// -------
/// centers : numpy.ndarray, shape (N, 3), in the frame of the geometry
/// radii : numpy.ndarray, shape (N,)
/// gap : float
///     No point of a ball is farther from the geometry.
///
/// Examples
/// --------
/// >>> rod = lc.Geometry.cylinder(half_height=1.0, radius=0.2)
/// >>> centers, radii, gap = lc.cover_outside(rod, 8)
/// >>> centers.shape[0] <= 8, gap < 0.2
/// (True, True)
#[pyfunction]
#[pyo3(signature = (geometry, balls=None, *, gap=None))]
pub(crate) fn cover_outside<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    balls: Option<usize>,
    gap: Option<f64>,
) -> PyResult<Balls<'py>> {
    let goal = match (balls, gap) {
        (Some(balls), None) => CoverGoal::Balls(balls),
        (None, Some(gap)) => CoverGoal::Gap(gap),
        _ => return Err(refused("balls, gap: expected one of them")),
    };
    let body = &geometry.get().0;
    let found = py.detach(|| lin_canny::cover::cover_outside(body, goal));
    arrays(py, found.map_err(refused)?)
}

/// Returns a polyhedron of few faces that contains a geometry, with a proven bound of the gap.
///
/// Rounding included, the polyhedron contains the whole geometry, and each half-space
/// `normal . x <= offset` does. So what is clear of the polyhedron is clear of the geometry.
///
/// Parameters
/// ----------
/// geometry : Geometry
///     A bounded body of any kind.
/// faces : int
///     Greatest number of faces, from 4 to 256.
///
/// Returns
/// -------
/// hull : Geometry
///     The polyhedron, in the frame of the geometry: `hull.vertices`, `hull.triangles`. A face with
///     more than three corners is flat up to rounding.
/// normals : numpy.ndarray, shape (K, 3), unit normals of the faces
/// offsets : numpy.ndarray, shape (K,)
/// gap : float
///     No point of the polyhedron is farther from the convex hull of the geometry.
///
/// Examples
/// --------
/// >>> rod = lc.Geometry.cylinder(half_height=1.0, radius=0.2)
/// >>> hull, normals, offsets, gap = lc.hull_outside(rod, 16)
/// >>> len(offsets) <= 16, gap < 0.02
/// (True, True)
#[pyfunction]
pub(crate) fn hull_outside<'py>(py: Python<'py>, geometry: &Bound<'py, Geometry>, faces: usize) -> PyResult<Hull<'py>> {
    let body = &geometry.get().0;
    let found = py.detach(|| lin_canny::cover::hull_outside(body, faces));
    let cover = found.map_err(refused)?;
    let normals = cover
        .planes
        .iter()
        .flat_map(|plane| <[f64; 3]>::from(plane.normal().into_inner()));
    let normals = PyArray1::from_iter(py, normals).reshape([cover.planes.len(), 3])?;
    let offsets = PyArray1::from_iter(py, cover.planes.iter().map(HalfSpace::offset));
    Ok((Geometry(cover.hull.into()), normals, offsets, cover.gap))
}

/// Returns balls inside a geometry, with a proven bound of what they leave out.
///
/// Each ball is inside the geometry: what meets a ball meets the geometry.
///
/// Parameters
/// ----------
/// geometry : Geometry
///     A body with an inside: no open mesh, surface, polygon or segment.
/// balls : int
///     Greatest number of balls, at most 1024.
///
/// Returns
/// -------
/// centers : numpy.ndarray, shape (N, 3), in the frame of the geometry
/// radii : numpy.ndarray, shape (N,)
/// gap : float
///     No point of the geometry is farther from the balls.
#[pyfunction]
pub(crate) fn cover_inside<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    balls: usize,
) -> PyResult<Balls<'py>> {
    let body = &geometry.get().0;
    let found = py.detach(|| lin_canny::cover::cover_inside(body, balls));
    arrays(py, found.map_err(refused)?)
}
