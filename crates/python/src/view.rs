//! Pages, which the Python module `lin_canny._show` shows.

use lin_canny::nalgebra::Point3;
use lin_canny::{PairTracker, RelativePose};
use lin_canny_record::{BodyLine, Frame, PageOptions, PairLine, Recording, RenderMesh, is_same, page as write};
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;

use crate::errors::refused;
use crate::geometry::Geometry;
use crate::pose::Pose;

/// Calls a function of the module.
pub(crate) fn call<'py>(
    py: Python<'py>,
    function: &str,
    arguments: impl PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("lin_canny._show")?.call_method1(function, arguments)
}

/// A body: name, geometry and colour.
type Body<'py> = (String, Bound<'py, Geometry>, Option<[u8; 3]>);

/// A frame: a pose for each body, a text, the numbers of a pair to query, and a line to draw.
type Shown = (Vec<Pose>, String, Option<[u32; 2]>, Option<Vec<[f64; 3]>>);

/// Returns the page of bodies over frames; None if it has more than `most` triangles.
///
/// bodies: name, geometry, and colour (0 to 255) or None. frames: a pose for each body, a text, two
/// numbers of bodies whose closest points are shown, and points of a line.
#[pyfunction]
#[pyo3(name = "_page", signature = (title, bodies, frames, most=None))]
pub(crate) fn page(
    py: Python<'_>,
    title: String,
    bodies: Vec<Body<'_>>,
    frames: Vec<Shown>,
    most: Option<usize>,
) -> PyResult<Option<String>> {
    let mut recording = Recording {
        title,
        ..Recording::default()
    };
    let colors: Option<Vec<[u8; 3]>> = bodies.iter().map(|(_, _, color)| *color).collect();
    for (k, (name, geometry, _)) in bodies.into_iter().enumerate() {
        let geometry = &geometry.get().0;
        let known = recording.geometries.iter().position(|other| is_same(other, geometry));
        let number = known.unwrap_or(recording.geometries.len());
        if known.is_none() {
            recording.geometries.push(geometry.clone());
        }
        let first = frames.first().and_then(|(poses, ..)| poses.get(k));
        recording.bodies.push(BodyLine {
            name,
            geometry: number as u32,
            pose: first.map_or_else(Default::default, |pose| pose.0),
            since: 0,
        });
    }
    for (poses, note, pair, line) in frames {
        if poses.len() != recording.bodies.len() {
            let (found, expected) = (poses.len(), recording.bodies.len());
            return Err(refused(format!(
                "a frame has {found} poses (expected {expected}, one for each body)"
            )));
        }
        let mut frame = Frame {
            note,
            ..Frame::default()
        };
        if let Some([a, b]) = pair {
            let of = |k: u32| {
                let body = recording.bodies.get(k as usize);
                let body = body.ok_or_else(|| refused(format!("body {k} does not exist")))?;
                PyResult::Ok((&recording.geometries[body.geometry as usize], &poses[k as usize].0))
            };
            let ((first, pose_a), (second, pose_b)) = (of(a)?, of(b)?);
            if let Ok(pose) = RelativePose::new(pose_a, pose_b) {
                let found = PairTracker::new().closest(first, second, &pose);
                frame.pairs.push(PairLine {
                    a,
                    b,
                    outcome: Some(found.outcome),
                    subshapes: [found.locations[0].subshape, found.locations[1].subshape],
                    contacts: Vec::new(),
                });
            }
        }
        frame
            .paths
            .extend(line.map(|points| points.into_iter().map(Point3::from).collect()));
        frame.poses = poses
            .into_iter()
            .enumerate()
            .map(|(k, pose)| (k as u32, pose.0))
            .collect();
        recording.frames.push(frame);
    }
    let options = PageOptions::default().panel(false).colors(colors.unwrap_or_default());
    Ok(py.detach(|| {
        let count = |body: &BodyLine| {
            let geometry = &recording.geometries[body.geometry as usize];
            RenderMesh::from_geometry(geometry).triangles.len()
        };
        let is_small = most.is_none_or(|most| recording.bodies.iter().map(count).sum::<usize>() <= most);
        is_small.then(|| write(&recording, &options))
    }))
}
