//! Signed distances at the nodes of a grid.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::BoxHint;
use lin_canny::{Distance, DistanceGrid, Geometry as Body, PointError, PointQuery};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::array::{Argument, vector};
use crate::batch::{BLOCK, Batch, Run};
use crate::errors::refused;
use crate::geometry::Geometry;

const LOW: Argument = Argument {
    name: "low",
    error: |why| refused(why),
};
const HIGH: Argument = Argument {
    name: "high",
    error: |why| refused(why),
};

/// Distance of the default box from the geometry, as a fraction of its longest side.
const MARGIN: f64 = 0.1;

/// The numbers of cells as an argument.
#[derive(FromPyObject)]
pub(crate) enum Cells {
    Longest(usize),
    Each([usize; 3]),
}

/// Why a grid was not made.
enum Fault {
    Grid(PointError),
    Python(PyErr),
}

impl From<PointError> for Fault {
    fn from(error: PointError) -> Self {
        Self::Grid(error)
    }
}

/// Returns the box of a geometry with a margin: least and greatest corner.
fn box_of(body: &Body) -> [Point3<f64>; 2] {
    let (low, high) = body.aabb_at(&Isometry3::identity(), &mut BoxHint::default());
    let margin = Vector3::repeat(MARGIN * (high - low).max());
    [low - margin, high + margin]
}

/// The values of the nodes, the errors of the cells, and the coordinates of the nodes.
type Grid<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<f64>>, Axes<'py>);

type Axes<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// Returns the signed distances at the nodes of a grid, with a proven error of each cell.
///
/// Anywhere in the cell `[i, j, k]`, the trilinear interpolation of its eight nodes differs from the
/// signed distance by at most `errors[i, j, k]`.
///
/// Parameters
/// ----------
/// geometry : Geometry
/// cells : int or sequence of three ints
///     The numbers of cells along the axes. One int is that along the longest side; the others are
///     chosen so that cells are about cubes.
/// low, high : array_like, shape (3,), optional
///     Corners of the grid. By default the box of the geometry, and a tenth of its longest side more.
/// threads : int
/// progress : callable or bool, optional
///     A callable that receives the number of finished nodes and of all, or True for a tqdm bar.
///     Ctrl-C ends the call.
///
/// Returns
/// -------
/// values : numpy.ndarray, shape (x + 1, y + 1, z + 1) for the cells (x, y, z)
/// errors : numpy.ndarray, shape (x, y, z)
/// axes : tuple of three arrays
///     The coordinates of the nodes along x, y and z.
///
/// Examples
/// --------
/// >>> values, errors, axes = lc.signed_distance_grid(lc.Geometry.ball(1.0), 16)
/// >>> values.shape, errors.max() < 0.13
/// ((17, 17, 17), True)
#[pyfunction]
#[pyo3(signature = (geometry, cells, *, low=None, high=None, threads=1, progress=None))]
#[allow(clippy::too_many_arguments)] // the signature in Python
pub(crate) fn signed_distance_grid<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    cells: Cells,
    low: Option<&Bound<'py, PyAny>>,
    high: Option<&Bound<'py, PyAny>>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Grid<'py>> {
    let body = &geometry.get().0;
    if matches!(body, Body::HalfSpace(_)) && (low.is_none() || high.is_none()) {
        return Err(refused("a half-space has no box: low and high are missing"));
    }
    let corner = |given: Option<&Bound<'py, PyAny>>, name| given.map(|v| vector(v, name)).transpose();
    let [box_low, box_high] = box_of(body);
    let low = corner(low, LOW)?.map_or(box_low, Point3::from);
    let high = corner(high, HIGH)?.map_or(box_high, Point3::from);
    let size = high - low;
    let cells = match cells {
        Cells::Each(cells) => cells,
        Cells::Longest(0) => [0; 3],
        Cells::Longest(count) => {
            let side = size.max() / count as f64;
            [0, 1, 2].map(|k| ((size[k] / side).round() as usize).clamp(1, count))
        }
    };
    let each = cells.iter().map(|n| n.saturating_add(1));
    let total = each.fold(1, usize::saturating_mul);
    let run = Run::new(py, total, threads, progress)?;
    let query = py.detach(|| PointQuery::new(body).prepared_for(total));
    let mut done = 0;
    let mut layer = |nodes: &[Point3<f64>]| -> PyResult<Vec<Distance>> {
        let mut rows = vec![None; nodes.len()];
        let batch = Nodes { query: &query, nodes };
        Run::new(py, rows.len(), threads, None)?.rows(py, &batch, &mut rows)?;
        done += nodes.len();
        run.report(done, total)?;
        Ok(rows.into_iter().flatten().collect())
    };
    let made = DistanceGrid::from_layers(low, high, cells, |nodes| layer(nodes).map_err(Fault::Python));
    let grid = made.map_err(|fault| match fault {
        Fault::Grid(error) => refused(error),
        Fault::Python(error) => error,
    })?;
    let errors = (0..cells[0]).flat_map(|i| {
        let grid = &grid;
        let row = move |j| (0..cells[2]).filter_map(move |k| grid.error([i, j, k]));
        (0..cells[1]).flat_map(row)
    });
    let errors = PyArray1::from_iter(py, errors).reshape(cells)?;
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let node = |k: usize| grid.origin[axis] + grid.step[axis] * k as f64;
        PyArray1::from_iter(py, (0..grid.nodes[axis]).map(node))
    });
    let nodes = grid.nodes;
    Ok((PyArray1::from_vec(py, grid.values).reshape(nodes)?, errors, (x, y, z)))
}

/// The nodes of a layer.
struct Nodes<'a> {
    query: &'a PointQuery<'a>,
    nodes: &'a [Point3<f64>],
}

impl Batch for Nodes<'_> {
    type State = ();
    type Row = Option<Distance>;
    const CLOCK_STRIDE: usize = BLOCK;

    fn start(&self) -> PyResult<()> {
        Ok(())
    }

    fn answer(&self, (): &mut (), first: usize, rows: &mut [Option<Distance>]) -> PyResult<()> {
        let found = self.query.signed_distances(&self.nodes[first..first + rows.len()]);
        let found = found.map_err(refused)?;
        rows.iter_mut().zip(found).for_each(|(to, found)| *to = Some(found));
        Ok(())
    }
}
