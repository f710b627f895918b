//! Recordings of a robot in its cell, for the viewer.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;
use lin_canny::{Geometry, PairTracker, RelativePose};
use lin_canny_plan::{Checker, JointTree, NearPair, WorldId};
use lin_canny_record::{Recorder, WriteError};

use crate::error::{FileError, FileErrorKind};

/// A recording whose frames are configurations with their closest pairs.
///
/// ```no_run
/// # use lin_canny_robot::{RobotRecorder, RobotFiles};
/// let mut checker = RobotFiles::new("arm.urdf").load()?.1.checker()?;
/// let path = [[0.0; 6], [0.5; 6]];
/// let mut recorder = RobotRecorder::create("arm.jsonl", &checker, &path[0])?;
/// for q in &path {
///     let near = checker.clearance(q)?.ok_or("no pair")?;
///     recorder.frame(&checker, q, "on the path", &near)?;
/// }
/// recorder.finish()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RobotRecorder {
    file: PathBuf,
    to: Recorder<BufWriter<File>>,
    /// The bodies with geometries and poses: of the robot, then attached objects, then obstacles.
    bodies: Vec<(WorldId, Geometry, Isometry3<f64>)>,
}

impl RobotRecorder {
    /// Starts a recording of the bodies of a checker, with the robot at the configuration `q`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, or if recordings do not support a shape.
    pub fn create(file: impl AsRef<Path>, checker: &Checker<JointTree>, q: &[f64]) -> Result<Self, FileError> {
        let world = checker.world();
        let begin = || -> Result<_, WriteError> {
            let mut to = Recorder::create(file.as_ref(), "a robot in its cell")?;
            let mut bodies = Vec::new();
            for (id, name) in world.bodies() {
                let Some(shape) = world.geometry(id) else { continue };
                // Poses of a configuration that is invalid are those of no configuration.
                let pose = checker.pose(id, q).unwrap_or_default();
                to.body(name, shape, &pose)?;
                bodies.push((id, shape.clone(), pose));
            }
            Ok((to, bodies))
        };
        let (to, bodies) = begin().map_err(|fault| refused(file.as_ref(), fault))?;
        let file = file.as_ref().to_owned();
        Ok(Self { file, to, bodies })
    }

    /// Adds a frame: a configuration, its closest pair, and a note such as the line of a file.
    ///
    /// Bodies that the checker has no more since the recording began stay where they were.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn frame(
        &mut self,
        checker: &Checker<JointTree>,
        q: &[f64],
        place: &str,
        near: &NearPair,
    ) -> Result<(), FileError> {
        let written = self.write_frame(checker, q, place, near);
        written.map_err(|fault| refused(&self.file, fault))
    }

    fn write_frame(
        &mut self,
        checker: &Checker<JointTree>,
        q: &[f64],
        place: &str,
        near: &NearPair,
    ) -> Result<(), WriteError> {
        for (k, (id, _, at)) in (0..).zip(&mut self.bodies) {
            let moves = !matches!(id, WorldId::Obstacle(_));
            if let Some(pose) = moves.then(|| checker.pose(*id, q).ok()).flatten() {
                *at = pose;
                self.to.pose(k, &pose)?;
            }
        }
        let index = |id: WorldId| self.bodies.iter().position(|body| body.0 == id);
        if let [Some(a), Some(b)] = [near.pair.a, near.pair.b].map(index) {
            let [(_, x, at), (_, y, there)] = [&self.bodies[a], &self.bodies[b]];
            if let Ok(pose) = RelativePose::new(at, there) {
                let answer = PairTracker::new().closest(x, y, &pose);
                self.to.answer(a as u32, b as u32, &answer)?;
            }
        }
        self.to.note(format!(
            "{place}: {} from {} to {}",
            near.distance, near.lower, near.upper
        ));
        self.to.end_frame()
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(self) -> Result<(), FileError> {
        let Self { file, to, .. } = self;
        to.finish().map(|_| ()).map_err(|fault| refused(&file, fault))
    }
}

fn refused(file: &Path, fault: WriteError) -> FileError {
    FileError::new(file, None, "", FileErrorKind::Record(fault))
}
