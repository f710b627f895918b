//! Recordings read back.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Point3};

use crate::format::{BodyLine, FORMAT, Frame, Header, Line, VERSION};
use crate::write::vertices_of;

/// What is wrong with a recording, and in which line, counted from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("line {line}: {source}")]
    File {
        /// The line; 0 if the file cannot be opened.
        line: usize,
        /// The reason.
        source: std::io::Error,
    },
    /// A line is no JSON, or not of this format.
    #[error("line {line}: {source}")]
    Line {
        /// The line.
        line: usize,
        /// The reason, with the column.
        source: serde_json::Error,
    },
    /// The first line names another format.
    #[error("line 1: the format is \"{found}\", expected \"{FORMAT}\"")]
    Format {
        /// The format found.
        found: String,
    },
    /// The first line names another version.
    #[error("line 1: version {found}, this reader knows version {VERSION}")]
    Version {
        /// The version found.
        found: u32,
    },
    /// A line names a geometry or a body that no line before has.
    #[error("line {line}: {what} {number} of {count}")]
    Number {
        /// The line.
        line: usize,
        /// What is numbered.
        what: &'static str,
        /// The number found.
        number: u32,
        /// How many there are.
        count: usize,
    },
    /// A frame has vertices of a body that is no mesh, or another number of them.
    #[error("line {line}: the vertices of body {body} are not those of its mesh")]
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
    /// Files that cannot be read, and lines that are not of this format, by number.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let file = File::open(path).map_err(|source| ReadError::File { line: 0, source })?;
        Self::read(BufReader::new(file))
    }

    /// Reads lines. Empty lines are skipped.
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

/// The state of all bodies at one frame. Going forward costs the poses that change; going back
/// starts again from the first frame.
#[derive(Clone, Debug, Default)]
pub struct Cursor {
    next: usize,
    /// The pose of each body; `None` while the body is not shown.
    pub poses: Vec<Option<Isometry3<f64>>>,
    /// By body, the frame and the number there of its last vertices.
    bent: Vec<Option<(usize, usize)>>,
}

impl Cursor {
    /// Returns the vertices of a mesh that has bent until this frame, in the order of
    /// [`Mesh::vertices`](lin_canny::Mesh::vertices); `None` for a body that is as its geometry.
    #[must_use]
    pub fn vertices<'r>(&self, recording: &'r Recording, body: u32) -> Option<&'r [Point3<f64>]> {
        let (frame, at) = (*self.bent.get(body as usize)?)?;
        let (_, vertices) = recording.frames.get(frame)?.vertices.get(at)?;
        Some(vertices)
    }

    /// Goes to a frame; past the last one, to the last.
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
