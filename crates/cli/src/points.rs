//! The command `points`: signed distances of points, or of a grid of points, from a mesh.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, MeshError, MeshKind, PointOutcome, PointQuery, RepairOptions};
use lin_canny_cli::output::progress;
use lin_canny_formats::{Invalid, MeshFile, PointFile};

use crate::end::{End, ToolError};
use crate::grid::GridOptions;
use crate::text::write;

/// Number of points between two updates of the progress bar.
const BLOCK: usize = 1 << 16;

/// What a repaired mesh is used for.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Repair {
    /// The mesh as given
    None,
    /// The sides of points; distances are to the given triangles alone
    Sides,
    /// Sides and distances: the triangles that close a hole are a part of the surface
    Surface,
}

#[derive(Args)]
pub(crate) struct PointOptions {
    /// Mesh as STL, OBJ, COLLADA, PLY, glTF or MSH; all its objects are one body
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Points in the frame and unit of the mesh, as npy, PLY, PCD or XYZ
    #[arg(long, value_name = "FILE", required_unless_present = "grid")]
    points: Option<PathBuf>,
    /// Output file with one row per point: the point, the signed distance and its bounds, the side,
    /// the closest point and its triangle. A point without a return (NaN or infinite) has the side
    /// `invalid` and no more
    #[arg(long, value_name = "OUT.csv", requires = "points")]
    csv: Option<PathBuf>,
    /// What a repair is used for that turns inverted triangles and closes holes, so that the mesh has an
    /// inside
    #[arg(long, value_enum, value_name = "USE", default_value = "none")]
    repair: Repair,
    #[command(flatten)]
    grid: GridOptions,
}

fn invalid(file: &Path, reason: impl ToString) -> ToolError {
    ToolError::Input {
        file: file.to_owned(),
        reason: reason.to_string(),
    }
}

pub(crate) fn run(options: &PointOptions) -> Result<End, ToolError> {
    let read = MeshFile::load(&options.mesh)?;
    let (points, triangles) = read.whole();
    let corners: Vec<_> = points.into_iter().map(Point3::from).collect();
    let reported = |error: MeshError| invalid(&options.mesh, error);
    let mut solid = None;
    if options.repair != Repair::None {
        let repaired = Mesh::repaired(&corners, &triangles, &RepairOptions::default()).map_err(reported)?;
        let repair = repaired.report().repair.as_deref();
        say!("repaired the mesh: {}", repair.cloned().unwrap_or_default());
        solid = Some(repaired);
    }
    let mesh = match solid.take_if(|_| options.repair == Repair::Surface) {
        Some(solid) => solid,
        None => Mesh::new(&corners, &triangles).map_err(reported)?,
    };
    if mesh.kind() == MeshKind::Open && solid.is_none() {
        let count = mesh.report().boundary_edges.len();
        warn!(
            "the mesh is open ({count} boundary edges): it has no inside, and no distance is negative; `--repair \
            surface` closes it"
        );
    }
    if let Some(file) = &options.points {
        measure(file, options, &mesh, solid.as_ref())?;
    }
    if solid.is_some() && options.grid.is_given() {
        let reason = "a grid has no `--repair sides`: a signed distance would jump at the holes";
        return Err(invalid(&options.mesh, reason));
    }
    options.grid.run(&options.mesh, &mesh)?;
    Ok(End::Free)
}

/// Measures the points of a file. Their sides are those of the solid, if there is one.
fn measure(file: &Path, options: &PointOptions, mesh: &Mesh, solid: Option<&Mesh>) -> Result<(), ToolError> {
    let rows = PointFile::read_with(file, Invalid::Keep)?.points.to_f64();
    // A depth image has points without a return: each has a row, and no answer.
    let is_valid = |point: &[f64; 3]| point.iter().all(|x| x.is_finite());
    let points: Vec<_> = rows.iter().filter(|p| is_valid(p)).copied().map(Point3::from).collect();
    let query = PointQuery::new(mesh).prepared_for(points.len());
    let sides = solid.map(|solid| PointQuery::new(solid).prepared_for(points.len()));
    let bar = progress("points", points.len() as u64);
    let mut found: Vec<PointOutcome> = Vec::with_capacity(points.len());
    for block in points.chunks(BLOCK) {
        let first = found.len();
        found.extend(query.closest_points(block).map_err(|e| invalid(file, e))?);
        if let Some(sides) = &sides {
            let inside = sides.contains_each(block).map_err(|e| invalid(file, e))?;
            found[first..]
                .iter_mut()
                .zip(inside)
                .filter(|(at, is_inside)| *is_inside && at.state == ContactState::Separated)
                .for_each(|(at, _)| {
                    at.state = ContactState::Overlapping;
                    (at.distance, at.lower, at.upper) = (-at.distance, -at.upper, -at.lower);
                });
        }
        bar.set_position(found.len() as u64);
    }
    bar.finish_and_clear();
    let inside = found.iter().filter(|f| f.is_contained()).count();
    let least = found.iter().map(|f| f.distance).fold(f64::INFINITY, f64::min);
    let without = match rows.len() - points.len() {
        0 => String::new(),
        count => format!(", {count} without a return"),
    };
    let least = match found.is_empty() {
        true => String::new(),
        false => format!(", least signed distance {least}"),
    };
    say!(
        "{} points{without}, {inside} in the body or on its surface{least}",
        rows.len()
    );
    if let Some(csv) = &options.csv {
        let mut text = String::from("x,y,z,distance,lower,upper,state,closest_x,closest_y,closest_z,triangle\n");
        let mut answers = found.iter();
        for row in &rows {
            let [x, y, z] = row;
            let Some(f) = is_valid(row).then(|| answers.next()).flatten() else {
                let _ = writeln!(text, "{x},{y},{z},,,,invalid,,,,");
                continue;
            };
            let closest = f.point;
            let _ = writeln!(
                text,
                "{x},{y},{z},{},{},{},{},{},{},{},{}",
                f.distance, f.lower, f.upper, f.state, closest.x, closest.y, closest.z, f.location.subshape
            );
        }
        write(csv, &text)?;
    }
    Ok(())
}
