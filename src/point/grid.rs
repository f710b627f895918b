//! Signed distances at the nodes of a grid, with a proven error of the interpolation.

use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::{PointError, PointMemory, PointQuery, check};
use crate::base::callbacks::{Watch, WithProgress};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::POINT_HEIGHT;
use crate::pair::outcome::Distance;

/// Largest number of nodes of a grid.
const NODES: usize = 1 << 31;

/// Number of nodes between two reports of progress.
const BLOCK: usize = 1 << 13;

/// Signed distances at the nodes of a grid of boxes, and the errors of its cells.
///
/// Made by [`PointQuery::signed_distance_grid`] or [`from_layers`](Self::from_layers).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DistanceGrid {
    /// The node `[0, 0, 0]`.
    pub origin: Point3<f64>,
    /// The sides of a cell.
    pub step: Vector3<f64>,
    /// Numbers of nodes along the axes: one more than cells.
    pub nodes: [usize; 3],
    /// The signed distance at the node `[i, j, k]`, at the index `(i nodes[1] + j) nodes[2] + k`.
    pub values: Vec<f64>,
    /// Largest distance of the value from a bound, in units of the longest side of a cell, rounded
    /// up, at the same index.
    widths: Vec<f32>,
}

impl DistanceGrid {
    /// Returns the grid of signed distances that a function returns, layer by layer.
    ///
    /// For callers that show progress, stop early or use threads. `distances` receives the nodes
    /// `[i, .., ..]`, for one `i` after the other, and returns their signed distances in this
    /// order. A distance that is missing counts as unknown: it is NaN, with an infinite error.
    /// Corners and cells are those of [`PointQuery::signed_distance_grid`].
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::{DistanceGrid, PointQuery, Shape};
    ///
    /// let ball = Shape::ball(1.0)?;
    /// let query = PointQuery::new(&ball);
    /// let [low, high] = [-2.0, 2.0].map(|x| Point3::new(x, x, x));
    /// let mut done = 0;
    /// let grid = DistanceGrid::from_layers(low, high, [8; 3], |nodes| {
    ///     done += nodes.len(); // here a bar is drawn
    ///     query.signed_distances(nodes)
    /// })?;
    /// assert_eq!(done, grid.values.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns the error of the function, or that of
    /// [`PointQuery::signed_distance_grid`].
    pub fn from_layers<E: From<PointError>>(
        low: Point3<f64>,
        high: Point3<f64>,
        cells: [usize; 3],
        mut distances: impl FnMut(&[Point3<f64>]) -> Result<Vec<Distance>, E>,
    ) -> Result<Self, E> {
        let step = Self::checked_step(low, high, cells)?;
        let nodes = [cells[0] + 1, cells[1] + 1, cells[2] + 1];
        let mut grid = Self {
            origin: low,
            step,
            nodes,
            values: Vec::with_capacity(nodes.iter().product()),
            widths: Vec::with_capacity(nodes.iter().product()),
        };
        let side = step.amax();
        // Rounding may put the last node beyond `high`.
        check(
            1,
            &(low + step.component_mul(&Vector3::from_fn(|k, _| cells[k] as f64))),
        )?;
        for i in 0..nodes[0] {
            let at = |j: usize, k: usize| low + step.component_mul(&Vector3::new(i as f64, j as f64, k as f64));
            let layer: Vec<_> = (0..nodes[1])
                .flat_map(|j| (0..nodes[2]).map(move |k| at(j, k)))
                .collect();
            for found in distances(&layer)?.into_iter().take(layer.len()) {
                grid.values.push(found.value);
                let width = (found.upper - found.value).larger(found.value - found.lower);
                grid.widths.push(((width / side) as f32).next_up().at_least(0.0));
            }
            grid.values.resize((i + 1) * layer.len(), f64::NAN);
            grid.widths.resize((i + 1) * layer.len(), f32::INFINITY);
        }
        Ok(grid)
    }

    /// Returns the sides of a cell, after a check of the grid.
    fn checked_step(low: Point3<f64>, high: Point3<f64>, cells: [usize; 3]) -> Result<Vector3<f64>, PointError> {
        check(0, &low)?;
        check(1, &high)?;
        let count = cells
            .iter()
            .try_fold(1usize, |all, n| all.checked_mul(n.checked_add(1)?));
        let size = high - low;
        let is_bad = |k: usize| cells[k] == 0 || !(size[k] / cells[k] as f64 > 0.0);
        let axis = (0..3)
            .find(|k| is_bad(*k))
            .or(if count.is_none_or(|n| n > NODES) { Some(0) } else { None });
        if let Some(axis) = axis {
            let (cells, side) = (cells[axis], size[axis]);
            return Err(PointError::Grid { axis, cells, side });
        }
        let step = Vector3::from_fn(|k, _| size[k] / cells[k] as f64);
        // Rounding may put the last node beyond `high`.
        check(
            1,
            &(low + step.component_mul(&Vector3::from_fn(|k, _| cells[k] as f64))),
        )?;
        Ok(step)
    }

    /// Returns a bound of the error of the interpolated signed distance in a cell.
    ///
    /// It bounds the difference to the true signed distance everywhere in the cell. A signed
    /// distance grows at most as fast as a point moves. So the weights of the eight nodes, times
    /// their distances, add up to half the diagonal at most; the errors of the nodes and of
    /// rounding are added. `None` for a cell beyond the last.
    #[must_use]
    pub fn error(&self, cell: [usize; 3]) -> Option<f64> {
        let corners = self.corners(cell)?;
        // The square of a side may underflow.
        let side = self.step.amax();
        let half = 0.5 * side * sqrt((self.step / side).norm_squared());
        let width = corners
            .iter()
            .fold(0.0f64, |most, at| most.larger(f64::from(self.widths[*at])));
        let width = side * width;
        let size = corners
            .iter()
            .fold(half, |most, at| most.larger(self.values[*at].abs()));
        let far = self.origin.coords.amax() + side * self.nodes.iter().fold(0, |m, n| m.max(*n)) as f64;
        Some(half + width + POINT_HEIGHT * (size + far))
    }

    /// Returns the interpolated signed distance of a point and a bound of its error.
    ///
    /// `None` outside the grid.
    #[must_use]
    pub fn value_at(&self, point: &Point3<f64>) -> Option<(f64, f64)> {
        let place = (point - self.origin).component_div(&self.step);
        let (mut cell, mut part) = ([0; 3], [0.0; 3]);
        for k in 0..3 {
            let last = self.nodes[k] - 2;
            // Written so that NaN is outside.
            if !(place[k] >= 0.0 && place[k] <= (last + 1) as f64) {
                return None;
            }
            cell[k] = (place[k] as usize).min(last);
            part[k] = place[k] - cell[k] as f64;
        }
        let corners = self.corners(cell)?;
        let weight = |k: usize| {
            let along = |axis: usize| {
                if k >> axis & 1 == 1 {
                    part[axis]
                } else {
                    1.0 - part[axis]
                }
            };
            along(0) * along(1) * along(2)
        };
        let value = (0..8).map(|k| weight(k) * self.values[corners[k]]).sum();
        Some((value, self.error(cell)?))
    }

    /// Returns the indices of the nodes of a cell; bit k of a number is the end along axis k.
    fn corners(&self, cell: [usize; 3]) -> Option<[usize; 8]> {
        if (0..3).any(|k| cell[k] + 1 >= self.nodes[k]) {
            return None;
        }
        let [_, rows, columns] = self.nodes;
        let at = |k: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis: usize| cell[axis] + (k >> axis & 1));
            (x * rows + y) * columns + z
        };
        Some(core::array::from_fn(at))
    }
}

impl WithProgress<'_> {
    /// Returns the grid of [`PointQuery::signed_distance_grid`]. Progress is in nodes.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`PointQuery::signed_distance_grid`], and [`PointError::Stopped`] if
    /// the callback stops the call.
    pub fn signed_distance_grid(
        mut self,
        query: &PointQuery<'_>,
        low: Point3<f64>,
        high: Point3<f64>,
        cells: [usize; 3],
    ) -> Result<DistanceGrid, PointError> {
        query.grid(low, high, cells, &mut self.watch)
    }
}

impl PointQuery<'_> {
    /// Returns the signed distances at the nodes of a grid between two corners.
    ///
    /// `cells` are the numbers of cells along the axes. The node `[i, j, k]` is at
    /// `low + step (i, j, k)`, rounded. Inside a compound or a cloud the lower bound is coarse, and
    /// so is the error of a cell there.
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::{PointQuery, Shape};
    ///
    /// let ball = Shape::ball(1.0)?;
    /// let [low, high] = [-2.0, 2.0].map(|x| Point3::new(x, x, x));
    /// let query = PointQuery::new(&ball);
    /// let grid = query.signed_distance_grid(low, high, [16; 3])?;
    /// let p = Point3::new(1.1, 0.2, 0.3);
    /// let (value, error) = grid.value_at(&p).ok_or("outside")?;
    /// let truth = 1.34_f64.sqrt() - 1.0;
    /// assert!((value - truth).abs() <= error && error < 0.22);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns an error if a corner is not finite or out of range, if `high` is not above `low`, if
    /// there is no cell along an axis, or if there are more than 2^31 nodes.
    #[doc(alias = "SDF")]
    #[doc(alias = "voxels")]
    pub fn signed_distance_grid(
        &self,
        low: Point3<f64>,
        high: Point3<f64>,
        cells: [usize; 3],
    ) -> Result<DistanceGrid, PointError> {
        self.grid(low, high, cells, &mut Watch::none())
    }

    fn grid(
        &self,
        low: Point3<f64>,
        high: Point3<f64>,
        cells: [usize; 3],
        watch: &mut Watch<'_>,
    ) -> Result<DistanceGrid, PointError> {
        // A wrong grid is an error before the first report.
        DistanceGrid::checked_step(low, high, cells)?;
        let count = cells.iter().map(|n| n + 1).product();
        watch.stage("grid", Some(count))?;
        let prepared = self.if_worth_preparing(count);
        let query = prepared.as_ref().unwrap_or(self);
        let answer = |query: &Self, p: &Point3<f64>, memory: &mut PointMemory| Distance::from(&query.ask(p, memory));
        let (mut done, mut reported) = (0, 0);
        DistanceGrid::from_layers(low, high, cells, |layer| {
            let mut found = Vec::with_capacity(layer.len());
            for block in layer.chunks(BLOCK) {
                found.extend(query.answers(block, answer));
                done += block.len();
                if done - reported >= BLOCK || done == count {
                    reported = done;
                    watch.done(done);
                    watch.check()?;
                }
            }
            Ok(found)
        })
    }
}
