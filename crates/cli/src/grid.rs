//! The option `--grid` of the command `points`: signed distances at the nodes of a grid, as a file.

use std::path::{Path, PathBuf};

use clap::Args;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{DistanceGrid, Mesh, PointError, PointQuery, Progress, WithProgress};
use lin_canny_cli::output::progress;
use lin_canny_formats::{Volume, VolumeFormat};

use crate::end::ToolError;

#[derive(Args)]
pub(crate) struct GridOptions {
    /// Signed distances at the nodes of a grid around the mesh: number of cells along its longest side;
    /// the cells are cubes
    #[arg(long, value_name = "CELLS", requires = "out", value_parser = clap::value_parser!(u32).range(1..))]
    grid: Option<u32>,
    /// Number of cells around the mesh on each side
    #[arg(long, value_name = "CELLS", default_value_t = 1, requires = "grid")]
    border: u16,
    /// Output file of the grid: npy, NRRD or raw, by its extension
    #[arg(long, value_name = "OUT.nrrd", requires = "grid")]
    out: Option<PathBuf>,
    /// Output file with the proven error of trilinear interpolation in each cell: npy, NRRD or raw
    #[arg(long, value_name = "OUT.nrrd", requires = "grid")]
    errors: Option<PathBuf>,
}

impl GridOptions {
    pub(crate) fn is_given(&self) -> bool {
        self.grid.is_some()
    }

    /// Computes and writes the grid, if there is one.
    pub(crate) fn run(&self, file: &Path, mesh: &Mesh) -> Result<(), ToolError> {
        let (Some(count), Some(out)) = (self.grid, &self.out) else {
            return Ok(());
        };
        // A wrong extension is an error before the work.
        for file in [Some(out), self.errors.as_ref()].into_iter().flatten() {
            VolumeFormat::of(file)?;
        }
        let (low, high, cells) = self.place(mesh, count);
        let bar = progress("nodes", 0);
        let mut show = |progress: Progress| {
            bar.set_length(progress.total.unwrap_or_default() as u64);
            bar.set_position(progress.done as u64);
            Progress::stop_if(false)
        };
        let query = PointQuery::new(mesh);
        let found = WithProgress::new(&mut show).signed_distance_grid(&query, low, high, cells);
        bar.finish_and_clear();
        let grid = found.map_err(|error| ToolError::Input {
            file: file.to_owned(),
            reason: match error {
                PointError::Grid { .. } => format!("--grid {count}: {error}"),
                error => error.to_string(),
            },
        })?;
        let ([x, y, z], step) = (grid.nodes, grid.step);
        let origin = grid.origin.coords;
        Volume::new(grid.nodes, origin.into(), step.into(), &grid.values).write(out)?;
        let (errors, most) = errors(&grid);
        if let Some(out) = &self.errors {
            // The middle of a cell.
            let middle = origin + 0.5 * step;
            Volume::new(cells, middle.into(), step.into(), &errors).write(out)?;
        }
        say!(
            "{x} x {y} x {z} nodes from {low}, step {step}; interpolated distances err by at most {most:e}",
            low = shown(&origin),
            step = step.x
        );
        Ok(())
    }

    /// Returns two corners of the grid and the numbers of its cells: the box of the mesh lies in its
    /// middle.
    fn place(&self, mesh: &Mesh, count: u32) -> (Point3<f64>, Point3<f64>, [usize; 3]) {
        let mut ends = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
        for p in mesh.vertices() {
            ends = [ends[0].inf(&p.coords), ends[1].sup(&p.coords)];
        }
        let [low, high] = ends;
        let (longest, count) = ((high - low).max(), f64::from(count));
        let side = longest / count;
        let along = |k: usize| ((high[k] - low[k]) / longest * count).ceil() as usize;
        let cells = [0, 1, 2].map(|k| (along(k) + 2 * usize::from(self.border)).max(1));
        let half = Vector3::from_fn(|k, _| 0.5 * side * cells[k] as f64);
        let middle = 0.5 * low + 0.5 * high;
        (Point3::from(middle - half), Point3::from(middle + half), cells)
    }
}

/// Returns the error of each cell, and the largest.
fn errors(grid: &DistanceGrid) -> (Vec<f64>, f64) {
    let [x, y, z] = grid.nodes.map(|n| n - 1);
    let cells = (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k])));
    let errors: Vec<f64> = cells.filter_map(|cell| grid.error(cell)).collect();
    let most = errors.iter().fold(0.0, |most, x| f64::max(most, *x));
    (errors, most)
}

fn shown(p: &Vector3<f64>) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}
