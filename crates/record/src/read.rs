//! The reader of recordings.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Point3};

use crate::format::{BodyLine, FORMAT, Frame, Header, Line, VERSION};
use crate::write::vertices_of;

/// Error of a recording, with its line; lines count from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Returned if the file cannot be opened or read.
    #[error("line {line}: {source}")]
    File {
        /// The line; 0 if the file cannot be opened.
        line: usize,
        /// The reason.
        source: std::io::Error,
    },
    /// Returned if a line is not valid JSON or does not have this format.
    #[error("line {line}: {source}")]
    Line {
        /// The line.
        line: usize,
        /// The reason, with the column.
        source: serde_json::Error,
    },
    /// Returned if the first line names another format.
    #[error("line 1: unknown format: \"{found}\" (expected \"{FORMAT}\")")]
    Format {
        /// Format of the file.
        found: String,
    },
    /// Returned if the first line names another version.
    #[error("line 1: unsupported version: {found} (expected {VERSION})")]
    Version {
        /// Version of the file.
        found: u32,
    },
    /// Returned if a line uses a geometry or a body that no earlier line defines.
    #[error("line {line}: {what} {number} does not exist: earlier lines define {count}")]
    Number {
        /// The line.
        line: usize,
        /// `geometry` or `body`.
        what: &'static str,
        /// The number that does not exist.
        number: u32,
        /// How many earlier lines define.
        count: usize,
    },
    /// Returned if a frame has vertices of a body that is not a mesh or has another number of them.
    #[error("line {line}: invalid vertices of body {body}: it is not a mesh, or has another number of vertices")]
    Vertices {
        /// The line.
        line: usize,
        /// The body.
        body: u32,
    },
}

/// A recording in memory.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// The title.
    pub title: String,
    /// The geometries.
    pub geometries: Vec<Geometry>,
    /// The bodies, by number.
    pub bodies: Vec<BodyLine>,
    /// The frames.
    pub frames: Vec<Frame>,
}

impl Recording {
    /// Reads a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or a line does not have this format.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let file = File::open(path).map_err(|source| ReadError::File { line: 0, source })?;
        Self::read(BufReader::new(file))
    }

    /// Reads lines, and skips empty lines.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn read(from: impl BufRead) -> Result<Self, ReadError> {
        let mut lines = from.lines().enumerate().map(|(k, text)| (k + 1, text));
        let mut recording = Self {
            title: header(lines.next())?.title,
            ..Self::default()
        };
        for (line, text) in lines {
            let text = text.map_err(|source| ReadError::File { line, source })?;
            if !text.trim().is_empty() {
                let parsed = serde_json::from_str(&text).map_err(|source| ReadError::Line { line, source })?;
                recording.take(line, parsed)?;
            }
        }
        Ok(recording)
    }

    fn take(&mut self, line: usize, parsed: Line<'_>) -> Result<(), ReadError> {
        match parsed {
            Line::Geometry(geometry) => self.geometries.push(geometry),
            Line::Body(body) => {
                known(line, "geometry", body.geometry, self.geometries.len())?;
                let since = self.frames.len();
                self.bodies.push(BodyLine { since, ..body });
            }
            Line::Frame(frame) => {
                let numbers = frame.poses.iter().map(|(k, _)| *k).chain(frame.removed.iter().copied());
                let pairs = frame.pairs.iter().flat_map(|p| [p.a, p.b]);
                let casts = frame.brackets.iter().flat_map(|c| c.bodies);
                for number in numbers.chain(pairs).chain(casts) {
                    known(line, "body", number, self.bodies.len())?;
                }
                for (body, vertices) in &frame.vertices {
                    known(line, "body", *body, self.bodies.len())?;
                    let geometry = &self.geometries[self.bodies[*body as usize].geometry as usize];
                    if vertices_of(geometry) != Some(vertices.len()) {
                        return Err(ReadError::Vertices { line, body: *body });
                    }
                }
                self.frames.push(frame.into_owned());
            }
        }
        Ok(())
    }
}

fn header(first: Option<(usize, std::io::Result<String>)>) -> Result<Header, ReadError> {
    let text = first.map_or(Ok(String::new()), |(_, text)| text);
    let text = text.map_err(|source| ReadError::File { line: 1, source })?;
    let header: Header = serde_json::from_str(&text).map_err(|source| ReadError::Line { line: 1, source })?;
    if header.format != FORMAT {
        return Err(ReadError::Format { found: header.format });
    }
    if header.version != VERSION {
        return Err(ReadError::Version { found: header.version });
    }
    Ok(header)
}

fn known(line: usize, what: &'static str, number: u32, count: usize) -> Result<(), ReadError> {
    if (number as usize) < count {
        return Ok(());
    }
    Err(ReadError::Number {
        line,
        what,
        number,
        count,
    })
}

/// The state of all bodies at one frame.
///
/// A step forward costs only the poses that change. A step back starts again from the first frame.
#[derive(Clone, Debug, Default)]
pub struct Cursor {
    next: usize,
    /// Pose of each body; `None` while the body is not shown.
    pub poses: Vec<Option<Isometry3<f64>>>,
    /// For each body, the frame that sets its last vertices and their index there.
    bent: Vec<Option<(usize, usize)>>,
}

impl Cursor {
    /// Returns the vertices of a mesh that was deformed before or at this frame.
    ///
    /// The order is that of [`Mesh::vertices`](lin_canny::Mesh::vertices). Returns `None` if the
    /// body equals its geometry.
    #[must_use]
    pub fn vertices<'r>(&self, recording: &'r Recording, body: u32) -> Option<&'r [Point3<f64>]> {
        let (frame, at) = (*self.bent.get(body as usize)?)?;
        let (_, vertices) = recording.frames.get(frame)?.vertices.get(at)?;
        Some(vertices)
    }

    /// Goes to a frame, or to the last frame if `frame` is beyond it.
    pub fn seek(&mut self, recording: &Recording, frame: usize) {
        if frame + 1 < self.next {
            self.next = 0;
        }
        if self.next == 0 {
            self.poses = vec![None; recording.bodies.len()];
            self.bent = vec![None; recording.bodies.len()];
        }
        for (k, at) in recording.frames.iter().enumerate().take(frame + 1).skip(self.next) {
            for (pose, body) in self.poses.iter_mut().zip(&recording.bodies) {
                if body.since == k {
                    *pose = Some(body.pose);
                }
            }
            for (body, pose) in &at.poses {
                self.poses[*body as usize] = Some(*pose);
            }
            for (number, (body, _)) in at.vertices.iter().enumerate() {
                self.bent[*body as usize] = Some((k, number));
            }
            for body in &at.removed {
                self.poses[*body as usize] = None;
            }
            self.next = k + 1;
        }
    }
}
