//! The writer of recordings, line by line.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::scene::BodyId;
use lin_canny::{ContactGroup, Geometry, PairOutcome};

use crate::format::{BodyLine, Bracket, ColumnLine, Contact, FORMAT, Frame, Header, Line, PairLine, VERSION, poses};

/// Error of a [`Recorder`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Returned if the file cannot be written.
    #[error(transparent)]
    File(#[from] std::io::Error),
    /// Returned if a value cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// Returned if no body with this number was recorded.
    #[error("body {number} does not exist: {count} bodies were recorded")]
    Body {
        /// The number that does not exist.
        number: u32,
        /// How many bodies were recorded.
        count: usize,
    },
    /// Returned if vertices are recorded for a body that is not a mesh.
    #[error("body {body} is not a mesh")]
    NotAMesh {
        /// The body.
        body: u32,
    },
    /// Returned if the number of vertices differs from that of the mesh, or a vertex is not finite.
    #[error("invalid vertices of body {body} (expected {count} finite vertices)")]
    Vertices {
        /// The body.
        body: u32,
        /// Number of vertices of the mesh.
        count: usize,
    },
    /// Returned if a pose is not finite or its rotation is not a unit quaternion.
    #[error("invalid pose: {0:?} (expected a finite translation and a unit quaternion)")]
    Pose([f64; 7]),
}

/// Writes a recording.
///
/// Add bodies first. Then, for each frame, add its contents and call
/// [`end_frame`](Self::end_frame). A geometry that several bodies share is written once.
pub struct Recorder<W: Write> {
    to: W,
    geometries: Vec<Geometry>,
    poses: Vec<Option<Isometry3<f64>>>,
    geometry_of: Vec<u32>,
    pub(crate) frame: Frame,
    pub(crate) of_scene: BTreeMap<BodyId, u32>,
}

impl Recorder<BufWriter<File>> {
    /// Starts a recording in a new file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be created or written.
    pub fn create(path: impl AsRef<Path>, title: &str) -> Result<Self, WriteError> {
        Self::new(BufWriter::new(File::create(path)?), title)
    }
}

impl<W: Write> Recorder<W> {
    /// Starts a recording.
    ///
    /// # Errors
    /// Returns an error if `to` cannot be written.
    pub fn new(to: W, title: &str) -> Result<Self, WriteError> {
        let mut recorder = Self {
            to,
            geometries: Vec::new(),
            poses: Vec::new(),
            geometry_of: Vec::new(),
            frame: Frame::default(),
            of_scene: BTreeMap::new(),
        };
        recorder.line(&Header {
            format: FORMAT.into(),
            version: VERSION,
            title: title.into(),
        })?;
        Ok(recorder)
    }

    /// Adds a body and returns its number.
    ///
    /// # Errors
    /// Returns an error if the pose is invalid or the file cannot be written.
    pub fn body(&mut self, name: &str, geometry: &Geometry, pose: &Isometry3<f64>) -> Result<u32, WriteError> {
        checked(pose)?;
        let found = self.geometries.iter().position(|known| is_same(known, geometry));
        let index = match found {
            Some(index) => index,
            None => {
                self.line(&Line::Geometry(geometry.clone()))?;
                self.geometries.push(geometry.clone());
                self.geometries.len() - 1
            }
        };
        self.line(&Line::Body(BodyLine {
            name: name.into(),
            geometry: index as u32,
            pose: *pose,
            since: 0,
        }))?;
        self.poses.push(Some(*pose));
        self.geometry_of.push(index as u32);
        Ok(self.poses.len() as u32 - 1)
    }

    /// Sets the pose of a body from this frame on. A pose that did not change is not written.
    ///
    /// # Errors
    /// Returns an error if the body does not exist or the pose is invalid.
    pub fn pose(&mut self, body: u32, pose: &Isometry3<f64>) -> Result<(), WriteError> {
        checked(pose)?;
        self.known(body)?;
        let last = &mut self.poses[body as usize];
        if *last != Some(*pose) {
            *last = Some(*pose);
            self.frame.poses.push((body, *pose));
        }
        Ok(())
    }

    /// Sets the vertices of a mesh from this frame on, in the order of
    /// [`Mesh::vertices`](lin_canny::Mesh::vertices).
    ///
    /// # Errors
    /// Returns an error if the body does not exist or is not a mesh, if the number of vertices
    /// differs from that of the mesh, or if a vertex is not finite.
    pub fn vertices(&mut self, body: u32, vertices: &[Point3<f64>]) -> Result<(), WriteError> {
        self.known(body)?;
        let geometry = &self.geometries[self.geometry_of[body as usize] as usize];
        let count = vertices_of(geometry).ok_or(WriteError::NotAMesh { body })?;
        let is_finite = vertices.iter().all(|p| p.iter().all(|x| x.is_finite()));
        if vertices.len() != count || !is_finite {
            return Err(WriteError::Vertices { body, count });
        }
        self.frame.vertices.retain(|(known, _)| *known != body);
        self.frame.vertices.push((body, vertices.to_vec()));
        Ok(())
    }

    /// Removes a body from this frame on.
    ///
    /// # Errors
    /// Returns an error if the body does not exist.
    pub fn remove(&mut self, body: u32) -> Result<(), WriteError> {
        self.known(body)?;
        self.poses[body as usize] = None;
        self.frame.removed.push(body);
        Ok(())
    }

    /// Adds the closest points of two bodies.
    ///
    /// # Errors
    /// Returns an error if a body does not exist.
    pub fn answer(&mut self, a: u32, b: u32, answer: &PairOutcome) -> Result<(), WriteError> {
        let line = self.pair(a, b)?;
        line.outcome = Some(answer.outcome);
        line.subshapes = [answer.locations[0].subshape, answer.locations[1].subshape];
        Ok(())
    }

    /// Adds contact points of two bodies, at their current poses.
    ///
    /// # Errors
    /// Returns an error if a body does not exist or is not shown.
    pub fn contacts(&mut self, a: u32, b: u32, groups: &[ContactGroup]) -> Result<(), WriteError> {
        let (pose_a, pose_b) = (self.pose_of(a)?, self.pose_of(b)?);
        let points = groups.iter().flat_map(|group| &group.contacts);
        let contacts: Vec<Contact> = points
            .map(|c| Contact {
                name: format!("{}/{} {}", c.patches[0], c.patches[1], c.point.id),
                on_a: pose_a * c.point.point_on_a,
                on_b: pose_b * c.point.point_on_b,
                normal: pose_a * c.normal.into_inner(),
                separation: c.point.separation,
            })
            .collect();
        self.pair(a, b)?.contacts = contacts;
        Ok(())
    }

    /// Adds a box of the broad phase.
    pub fn aabb(&mut self, min: Point3<f64>, max: Point3<f64>) {
        self.frame.boxes.push([min, max]);
    }

    /// Adds a column of the broad phase.
    pub fn column(&mut self, column: ColumnLine) {
        self.frame.columns.push(column);
    }

    /// Adds the bracket of a first contact.
    ///
    /// # Errors
    /// Returns an error if a body does not exist.
    pub fn bracket(&mut self, bracket: Bracket) -> Result<(), WriteError> {
        bracket.bodies.iter().try_for_each(|&body| self.known(body))?;
        self.frame.brackets.push(bracket);
        Ok(())
    }

    /// Adds a path through the world.
    pub fn path(&mut self, points: impl IntoIterator<Item = Point3<f64>>) {
        self.frame.paths.push(points.into_iter().collect());
    }

    /// Sets the line of text about this frame.
    pub fn note(&mut self, text: impl Into<String>) {
        self.frame.note = text.into();
    }

    /// Writes the frame and starts the next one.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn end_frame(&mut self) -> Result<(), WriteError> {
        let frame = std::mem::take(&mut self.frame);
        self.line(&Line::Frame(Cow::Borrowed(&frame)))
    }

    /// Writes the data that is still in memory, and returns the file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.to.flush()?;
        Ok(self.to)
    }

    /// Returns the entry of a pair in this frame.
    pub(crate) fn pair(&mut self, a: u32, b: u32) -> Result<&mut PairLine, WriteError> {
        self.known(a)?;
        self.known(b)?;
        // Callers add the outcome and the contacts of a pair one after the other.
        let pairs = &mut self.frame.pairs;
        if pairs.last().is_none_or(|p| (p.a, p.b) != (a, b)) {
            pairs.push(PairLine {
                a,
                b,
                outcome: None,
                subshapes: [0; 2],
                contacts: Vec::new(),
            });
        }
        let last = pairs.len() - 1;
        Ok(&mut pairs[last])
    }

    fn pose_of(&self, body: u32) -> Result<Isometry3<f64>, WriteError> {
        let pose = self.poses.get(body as usize).copied().flatten();
        pose.ok_or_else(|| self.unknown(body))
    }

    fn known(&self, body: u32) -> Result<(), WriteError> {
        let is_known = (body as usize) < self.poses.len();
        if is_known { Ok(()) } else { Err(self.unknown(body)) }
    }

    fn unknown(&self, number: u32) -> WriteError {
        WriteError::Body {
            number,
            count: self.poses.len(),
        }
    }

    fn line(&mut self, value: &impl serde::Serialize) -> Result<(), WriteError> {
        serde_json::to_writer(&mut self.to, value)?;
        Ok(self.to.write_all(b"\n")?)
    }
}

fn checked(pose: &Isometry3<f64>) -> Result<(), WriteError> {
    let numbers = poses::numbers(pose);
    poses::pose(numbers).map(|_| ()).ok_or(WriteError::Pose(numbers))
}

/// Returns whether two geometries share one body in memory, which a recording holds once.
#[must_use]
pub fn is_same(a: &Geometry, b: &Geometry) -> bool {
    use std::sync::Arc;
    match (a, b) {
        (Geometry::Polyhedron(a), Geometry::Polyhedron(b)) => Arc::ptr_eq(a, b),
        (Geometry::Convex(a), Geometry::Convex(b)) => Arc::ptr_eq(a, b),
        (Geometry::Compound(a), Geometry::Compound(b)) => Arc::ptr_eq(a, b),
        (Geometry::Mesh(a), Geometry::Mesh(b)) => Arc::ptr_eq(a, b),
        #[cfg(feature = "surfaces")]
        (Geometry::BezierSurface(a), Geometry::BezierSurface(b)) => Arc::ptr_eq(a, b),
        (Geometry::HalfSpace(a), Geometry::HalfSpace(b)) => Arc::ptr_eq(a, b),
        (Geometry::Cloud(a), Geometry::Cloud(b)) => Arc::ptr_eq(a, b),
        _ => false,
    }
}

/// Returns the number of vertices of a mesh.
pub(crate) fn vertices_of(geometry: &Geometry) -> Option<usize> {
    match geometry {
        Geometry::Mesh(mesh) => Some(mesh.vertex_count()),
        _ => None,
    }
}
