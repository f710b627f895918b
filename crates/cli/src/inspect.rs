//! The command `inspect`: what keeps a mesh from being a clean solid, and what a repair would change.

use std::fmt::Display;
use std::path::PathBuf;

use clap::Args;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{Mesh, MeshKind, MeshRepair, RepairOptions};
use lin_canny_cli::values;
use lin_canny_formats::MeshFile;
use lin_canny_record::{PageOptions, Recorder, Recording, page};

use crate::end::{End, ToolError};
use crate::text::write;

/// Colours of the caps and of the inverted triangles on a page, after that of the mesh.
const COLORS: [[u8; 3]; 3] = [[150, 160, 170], [220, 120, 20], [200, 30, 60]];

#[derive(Args)]
pub(crate) struct InspectOptions {
    /// Mesh as STL, OBJ, COLLADA, PLY, glTF or MSH; all its objects are one body. Points and triangles are
    /// counted from 0
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Points at most this far from an earlier point are welded to it, in the unit of the mesh
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, value_parser = values::not_negative)]
    weld: f64,
    /// Greatest number of rows that are printed of each list
    #[arg(long, value_name = "N", default_value_t = 10)]
    most: usize,
    /// Output page that shows the mesh, its caps and inverted triangles, and one loop per frame
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,
}

pub(crate) fn run(options: &InspectOptions) -> Result<End, ToolError> {
    let invalid = |error: lin_canny::MeshError| ToolError::Input {
        file: options.mesh.clone(),
        reason: error.to_string(),
    };
    let (points, triangles) = MeshFile::load(&options.mesh)?.whole();
    let points: Vec<_> = points.into_iter().map(Point3::from).collect();
    let given = Mesh::new(&points, &triangles).map_err(invalid)?;
    let repair_options = RepairOptions::default().weld(options.weld);
    let repaired = Mesh::repaired(&points, &triangles, &repair_options).map_err(invalid)?;
    let repair = repaired.report().repair.clone().unwrap_or_default();

    say!("as given: {}", given.report());
    let parts = (0..).zip(&given.report().parts);
    options.list(parts.map(|(k, part)| {
        let volume = match given.kind() {
            MeshKind::Solid => format!(", volume {}", part.volume),
            _ => String::new(),
        };
        let (count, first) = (part.triangles, part.triangle);
        format!("component {k}: {count} triangles, one is {first}{volume}")
    }));
    let found = given.inspect(options.most.saturating_add(1));
    options.list(
        found
            .crossings
            .iter()
            .map(|[t, u]| format!("triangles {t} and {u} cross")),
    );
    let cancelling = found.cancelling.iter();
    options
        .list(cancelling.map(|[t, u]| format!("triangles {t} and {u} lie on each other and face opposite directions")));
    let inner = found.inner_parts.iter();
    options
        .list(inner.map(|(k, winding)| format!("component {k} is in others, where the winding number is {winding}")));

    say!("repair: {repair}");
    options.list(repair.turned.iter().map(|t| format!("triangle {t} is inverted")));
    let edges = repair.one_sided_edges.iter();
    options.list(edges.map(|[a, b]| format!("edge of points {a} and {b}: the surface has one side")));
    options.list(repair.caps.iter().map(|cap| {
        let corners: Vec<String> = cap.corners.iter().take(12).map(u32::to_string).collect();
        let (count, dots) = (cap.corners.len(), if cap.corners.len() > 12 { " ..." } else { "" });
        format!("loop of {count} points: {}{dots}", corners.join(" "))
    }));
    if let Some(file) = &options.page {
        write(file, &drawn(options, &points, &repaired, &repair)?)?;
    }
    Ok(match repair.is_nothing() {
        true => End::Free,
        false => End::Blocked,
    })
}

impl InspectOptions {
    /// Prints the first rows of a list, and that there are more.
    fn list(&self, rows: impl Iterator<Item = impl Display>) {
        for (k, row) in rows.enumerate() {
            if k == self.most {
                say!("  and more: see --most");
                return;
            }
            say!("  {row}");
        }
    }
}

/// Returns the page: the given triangles, the caps and the inverted triangles; then a frame for each loop.
fn drawn(
    options: &InspectOptions,
    points: &[Point3<f64>],
    repaired: &Mesh,
    repair: &MeshRepair,
) -> Result<String, ToolError> {
    let failed = |error: &dyn Display| ToolError::Input {
        file: options.mesh.clone(),
        reason: error.to_string(),
    };
    let name = options.mesh.file_name().unwrap_or_default().to_string_lossy();
    let mut recorder = Recorder::new(Vec::new(), &format!("Inspection of {name}")).map_err(|e| failed(&e))?;
    // The given triangles, those of caps, and the inverted ones.
    let group_of = |t: u32| match (repaired.is_cap(t), repair.turned.binary_search(&t)) {
        (true, _) => 1,
        (false, Ok(_)) => 2,
        (false, Err(_)) => 0,
    };
    let mut colors = Vec::new();
    for (k, name) in ["given", "caps", "inverted"].into_iter().enumerate() {
        let own = repaired.triangles().filter(|(t, _)| group_of(*t) == k);
        let corners: Vec<Point3<f64>> = own.flat_map(|(_, corners)| corners).collect();
        let triangles: Vec<[u32; 3]> = (0..corners.len() as u32 / 3)
            .map(|k| [0, 1, 2].map(|i| 3 * k + i))
            .collect();
        if let Ok(part) = Mesh::new(&corners, &triangles) {
            let added = recorder.body(name, &part.into(), &Isometry3::identity());
            added.map_err(|e| failed(&e))?;
            colors.push(COLORS[k]);
        }
    }
    recorder.note(repair.to_string());
    recorder.end_frame().map_err(|e| failed(&e))?;
    for (k, cap) in repair.caps.iter().enumerate() {
        let corners = cap.corners.iter().chain(cap.corners.first());
        recorder.path(corners.map(|v| points[*v as usize]));
        recorder.note(format!(
            "loop {} of {}: {} points",
            k + 1,
            repair.caps.len(),
            cap.corners.len()
        ));
        recorder.end_frame().map_err(|e| failed(&e))?;
    }
    let lines = recorder.finish().map_err(|e| failed(&e))?;
    let recording = Recording::read(&lines[..]).map_err(|e| failed(&e))?;
    Ok(page(&recording, &PageOptions::default().colors(colors)))
}
