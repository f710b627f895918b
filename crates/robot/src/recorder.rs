//! Recordings of a robot in its cell.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;
use lin_canny::{Geometry, PairTracker, RelativePose};
use lin_canny_plan::{CellBody, CellPair, Checker, JointTree, NearPair};
use lin_canny_record::{Bracket, Recorder, WriteError, is_same};

use crate::error::{FileError, FileErrorKind};

/// A recording whose frames are configurations with their closest pairs.
///
/// Each frame shows the world of the checker as it then is: bodies that were added, moved, replaced
/// or removed, and objects that were attached or detached. An object that is attached and was an
/// obstacle of the same name and geometry stays one body of the recording.
///
/// ```no_run
/// # use lin_canny_robot::{RobotRecorder, RobotFiles, plan::Checker};
/// let mut checker = Checker::of_robots(RobotFiles::new("arm.urdf").load()?.cell)?;
/// let path = [[0.0; 6], [0.5; 6]];
/// let mut recorder = RobotRecorder::create("arm.jsonl", &checker, &path[0])?;
/// for q in &path {
///     let near = checker.clearance(q)?.ok_or("no pair")?;
///     recorder.frame(&checker, q, "on the path", &near)?;
/// }
/// recorder.finish()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RobotRecorder<W: Write = BufWriter<File>> {
    file: PathBuf,
    to: Recorder<W>,
    /// The bodies of the recording, by their numbers.
    bodies: Vec<Shown>,
    /// The numbers of the bodies that are shown.
    numbers: BTreeMap<CellBody, usize>,
}

/// A body of the recording.
struct Shown {
    name: String,
    geometry: Geometry,
    pose: Isometry3<f64>,
}

impl RobotRecorder {
    /// Starts a recording in a new file, as [`new`](Self::new).
    ///
    /// # Errors
    /// Returns an error if the file cannot be created or written, or if recordings do not support a
    /// shape.
    pub fn create(file: impl AsRef<Path>, checker: &Checker<JointTree>, q: &[f64]) -> Result<Self, FileError> {
        let file = file.as_ref();
        let to = File::create(file).map_err(|fault| refused(file, fault.into()))?;
        Self::new(BufWriter::new(to), file, checker, q)
    }
}

impl<W: Write> RobotRecorder<W> {
    /// Starts a recording of the bodies of a checker, with the robot at the configuration `q`, and
    /// moving obstacles at the time of [`Checker::set_time`]. Errors name `file`.
    ///
    /// # Errors
    /// Returns an error if `to` cannot be written, or if recordings do not support a shape.
    pub fn new(to: W, file: impl AsRef<Path>, checker: &Checker<JointTree>, q: &[f64]) -> Result<Self, FileError> {
        let begin = || -> Result<_, WriteError> {
            let mut recorder = Self {
                file: file.as_ref().to_owned(),
                to: Recorder::new(to, "a robot in its cell")?,
                bodies: Vec::new(),
                numbers: BTreeMap::new(),
            };
            recorder.follow(checker, q)?;
            Ok(recorder)
        };
        begin().map_err(|fault| refused(file.as_ref(), fault))
    }

    /// Adds a frame: a configuration, its closest pair, and a note such as the line of a file.
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
        self.follow(checker, q)?;
        if let [Some(&a), Some(&b)] = [near.pair.a, near.pair.b].map(|id| self.numbers.get(&id)) {
            let [x, y] = [&self.bodies[a], &self.bodies[b]];
            if let Ok(pose) = RelativePose::new(&x.pose, &y.pose) {
                let answer = PairTracker::new().closest(&x.geometry, &y.geometry, &pose);
                self.to.answer(a as u32, b as u32, &answer)?;
            }
        }
        self.to.note(format!(
            "{place}: {} from {} to {}",
            near.distance, near.lower, near.upper
        ));
        self.to.end_frame()
    }

    /// Adds to the next frame the bracket of a first contact: a time at which the pair is proven
    /// apart and one at which it is proven in contact, each with the configuration.
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid or the file cannot be written.
    pub fn bracket(
        &mut self,
        checker: &Checker<JointTree>,
        pair: CellPair,
        [(safe, p), (hit, q)]: &[(f64, Vec<f64>); 2],
    ) -> Result<(), FileError> {
        let poses = |q: &[f64]| {
            let pose = |id: CellBody| match checker.cell().obstacle_pose(id) {
                Some(pose) => *pose,
                None => checker.pose(id, q).unwrap_or_default(),
            };
            [pair.a, pair.b].map(pose)
        };
        let mut write = || {
            self.follow(checker, q)?;
            let [Some(&a), Some(&b)] = [pair.a, pair.b].map(|id| self.numbers.get(&id)) else {
                return Ok(());
            };
            self.to.bracket(Bracket {
                bodies: [a as u32, b as u32],
                safe: *safe,
                hit: *hit,
                at_safe: poses(p),
                at_hit: poses(q),
            })
        };
        write().map_err(|fault| refused(&self.file, fault))
    }

    /// Shows the bodies of the checker at their poses, and no others.
    fn follow(&mut self, checker: &Checker<JointTree>, q: &[f64]) -> Result<(), WriteError> {
        let cell = checker.cell();
        let bodies = &self.bodies;
        let is_shown = |id: CellBody, number: usize| {
            let geometry = cell.geometry(id);
            geometry.is_some_and(|geometry| is_same(geometry, &bodies[number].geometry))
        };
        let (shown, gone): (BTreeMap<_, _>, BTreeMap<_, _>) = std::mem::take(&mut self.numbers)
            .into_iter()
            .partition(|(id, number)| is_shown(*id, *number));
        self.numbers = shown;
        let mut gone: Vec<usize> = gone.into_values().collect();
        for (id, name) in cell.bodies() {
            let Some(geometry) = cell.geometry(id) else { continue };
            // Poses of a configuration that is invalid are those of no configuration.
            let pose = match cell.obstacle_pose(id).filter(|_| cell.obstacle_motion(id).is_none()) {
                Some(pose) => *pose,
                None => checker.pose(id, q).unwrap_or_default(),
            };
            let is_it = |body: &Shown| body.name == name && is_same(&body.geometry, geometry);
            let known = self.numbers.get(&id).copied();
            let known = known.or_else(|| {
                let again = gone.iter().position(|number| is_it(&self.bodies[*number]))?;
                Some(gone.remove(again))
            });
            match known {
                Some(number) => {
                    self.numbers.insert(id, number);
                    self.bodies[number].pose = pose;
                    self.to.pose(number as u32, &pose)?;
                }
                None => {
                    self.to.body(name, geometry, &pose)?;
                    self.numbers.insert(id, self.bodies.len());
                    self.bodies.push(Shown {
                        name: name.into(),
                        geometry: geometry.clone(),
                        pose,
                    });
                }
            }
        }
        gone.into_iter().try_for_each(|number| self.to.remove(number as u32))
    }

    /// Ends the recording and returns the file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(self) -> Result<W, FileError> {
        let Self { file, to, .. } = self;
        to.finish().map_err(|fault| refused(&file, fault))
    }
}

fn refused(file: &Path, fault: WriteError) -> FileError {
    FileError::new(file, None, "", FileErrorKind::Record(fault))
}
