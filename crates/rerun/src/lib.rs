//! Converts recordings of lin-canny to files of the viewer [rerun](https://rerun.io).
//!
//! ```no_run
//! use lin_canny_record::Recording;
//!
//! let recording = Recording::open("pair.jsonl")?;
//! lin_canny_rerun::save(&recording, "pair.rrd")?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | in the recording | in rerun |
//! |---|---|
//! | a body | `bodies/NUMBER NAME`: `Mesh3D` (curved bodies are triangulated); a body without triangles is drawn by its edges, as `LineStrips3D`; its pose as `Transform3D` |
//! | the closest points of a pair | `pairs/A - B`: `LineStrips3D` and `Points3D`; `distances/A - B/distance`, `lower`, `upper` as `Scalars` |
//! | contacts | `pairs/A - B/contacts`: `Points3D` with their ids as labels, `Arrows3D` along the normals |
//! | boxes of the broad phase | `boxes`: `Boxes3D` |
//! | paths | `paths`: `LineStrips3D` |
//! | the bracket of a cast | `casts`: `TextLog` with both times |
//! | the note of a frame | `notes`: `TextLog` |
//!
//! The timeline is called `frame`. The columns of the broad phase (`columns`), which are infinite,
//! and the poses of a bracket are not converted. rerun stores numbers in single precision. If a
//! number must be exact, read it from the recording.

mod shown;

use std::collections::BTreeSet;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny_record::{Cursor, Frame, PairLine, Recording};
use rerun::external::re_log_types::EntityPathPart;
use rerun::{EntityPath, RecordingStream, RecordingStreamBuilder, RecordingStreamError};

/// The timeline of the frames.
pub const TIMELINE: &str = "frame";

/// Error of a file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// Returned if rerun rejects the file or a value.
    #[error(transparent)]
    Stream(#[from] RecordingStreamError),
    /// Returned if the logged data did not reach the file.
    #[error(transparent)]
    Flush(#[from] rerun::sink::SinkFlushError),
}

/// Writes a recording as a file of rerun.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn save(recording: &Recording, path: impl AsRef<Path>) -> Result<(), SaveError> {
    let stream = RecordingStreamBuilder::new("lin-canny")
        .recording_name(recording.title.clone())
        .save(path.as_ref())?;
    log(recording, &stream)?;
    Ok(stream.flush_blocking()?)
}

/// Logs a recording to a stream of rerun: a file, a running viewer, or memory.
///
/// # Errors
/// Returns the error of the stream.
pub fn log(recording: &Recording, stream: &RecordingStream) -> Result<(), RecordingStreamError> {
    let (mut cursor, mut before) = (Cursor::default(), Vec::new());
    let mut entities = BTreeSet::new();
    for (k, frame) in recording.frames.iter().enumerate() {
        stream.set_time_sequence(TIMELINE, k as i64);
        cursor.seek(recording, k);
        bodies(recording, stream, &before, &cursor.poses)?;
        before.clone_from(&cursor.poses);
        let present = things(recording, stream, frame, &cursor.poses)?;
        // Content of the previous frame persists until it is cleared.
        for entity in entities.difference(&present) {
            stream.log(EntityPath::clone(entity), &rerun::Clear::flat())?;
        }
        entities = present;
    }
    Ok(())
}

/// Logs bodies that appear, disappear or have moved.
fn bodies(
    recording: &Recording,
    stream: &RecordingStream,
    before: &[Option<Isometry3<f64>>],
    now: &[Option<Isometry3<f64>>],
) -> Result<(), RecordingStreamError> {
    for (k, pose) in now.iter().enumerate() {
        let last = before.get(k).copied().flatten();
        let entity = body_path(recording, k);
        match (last, pose) {
            (None, Some(_)) => shown::body(
                stream,
                &entity,
                &recording.geometries[recording.bodies[k].geometry as usize],
            )?,
            (Some(_), None) => stream.log(entity.clone(), &rerun::Clear::recursive())?,
            _ => {}
        }
        if let Some(pose) = pose.filter(|pose| last != Some(*pose)) {
            stream.log(entity, &shown::transform(&pose))?;
        }
    }
    Ok(())
}

/// Logs the contents of a frame other than bodies; returns the entities that persist until cleared.
fn things(
    recording: &Recording,
    stream: &RecordingStream,
    frame: &Frame,
    poses: &[Option<Isometry3<f64>>],
) -> Result<BTreeSet<EntityPath>, RecordingStreamError> {
    let mut present = BTreeSet::new();
    for pair in &frame.pairs {
        let name = pair_name(recording, pair);
        let entity = EntityPath::new(vec![EntityPathPart::new("pairs"), EntityPathPart::new(name.clone())]);
        if let Some(points) = closest_points(pair, poses) {
            shown::closest(stream, &entity, points)?;
            present.insert(entity.clone());
        }
        if let Some(outcome) = &pair.outcome {
            for (what, value) in [
                ("distance", outcome.distance),
                ("lower", outcome.lower),
                ("upper", outcome.upper),
            ] {
                let parts = ["distances", &name, what].map(EntityPathPart::new);
                // An unknown depth has no lower bound, and a plot cannot show minus infinity.
                if value.is_finite() {
                    stream.log(EntityPath::new(parts.to_vec()), &rerun::Scalars::single(value))?;
                }
            }
        }
        if !pair.contacts.is_empty() {
            let entity = entity.join(&EntityPath::from("contacts"));
            shown::contacts(stream, &entity, &pair.contacts)?;
            present.insert(entity);
        }
    }
    if !frame.boxes.is_empty() {
        stream.log("boxes", &shown::boxes(&frame.boxes))?;
        present.insert("boxes".into());
    }
    if !frame.paths.is_empty() {
        stream.log("paths", &shown::paths(&frame.paths))?;
        present.insert("paths".into());
    }
    for cast in &frame.brackets {
        let [a, b] = cast.bodies.map(|k| &recording.bodies[k as usize].name);
        let text = format!("{a} and {b}: apart until {}, together at {}", cast.safe, cast.hit);
        stream.log("casts", &rerun::TextLog::new(text))?;
    }
    if !frame.note.is_empty() {
        stream.log("notes", &rerun::TextLog::new(frame.note.as_str()))?;
    }
    Ok(present)
}

/// Returns the closest points of a pair in the world frame.
fn closest_points(pair: &PairLine, poses: &[Option<Isometry3<f64>>]) -> Option<[Point3<f64>; 2]> {
    let outcome = pair.outcome.as_ref()?;
    let pose = |k: u32| poses.get(k as usize).copied().flatten();
    Some([pose(pair.a)? * outcome.point_on_a, pose(pair.b)? * outcome.point_on_b])
}

fn pair_name(recording: &Recording, pair: &PairLine) -> String {
    let [a, b] = [pair.a, pair.b].map(|k| format!("{k} {}", recording.bodies[k as usize].name));
    format!("{a} - {b}")
}

/// Returns the entity of a body; numbers distinguish bodies with the same name.
#[must_use]
pub fn body_path(recording: &Recording, body: usize) -> EntityPath {
    let name = format!("{body} {}", recording.bodies[body].name);
    EntityPath::new(vec![EntityPathPart::new("bodies"), EntityPathPart::new(name)])
}
