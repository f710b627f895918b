//! A recording of a robot in its cell, for the viewer.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use lin_canny_record::{Recorder, WriteError};
use lin_canny_robot::lin_canny::nalgebra::Isometry3;
use lin_canny_robot::lin_canny::{Geometry, PairTracker, RelativePose};
use lin_canny_robot::plan::{Checker, ConfigurationSpace, JointTree, NearPair, WorldId};

use super::ToolError;

/// A recording of which every frame is a configuration and the closest pair there.
pub(super) struct Film {
    file: PathBuf,
    to: Recorder<BufWriter<File>>,
    /// Shapes and poses of the bodies of the robot, then of the obstacles.
    bodies: Vec<(Geometry, Isometry3<f64>)>,
    links: usize,
}

impl Film {
    /// Begins a recording of the bodies of a checker, the robot at a configuration.
    pub(super) fn new(file: &Path, checker: &Checker<JointTree>, q: &[f64]) -> Result<Self, ToolError> {
        let mut poses = Vec::new();
        checker.space().place(q, &mut poses);
        let links = poses.len();
        let world = checker.world();
        let robot = world.robot_bodies().zip(&poses).map(|((n, g), pose)| (n, g, *pose));
        let cell = world.obstacles().map(|(n, g, pose)| (n, g, *pose));
        let begin = || -> Result<_, WriteError> {
            let mut to = Recorder::create(file, "a robot in its cell")?;
            let mut bodies = Vec::new();
            for (name, shape, pose) in robot.chain(cell) {
                to.body(name, shape, &pose)?;
                bodies.push((shape.clone(), pose));
            }
            Ok((to, bodies))
        };
        let (to, bodies) = begin().map_err(|fault| refused(file, &fault))?;
        let file = file.to_owned();
        Ok(Self {
            file,
            to,
            bodies,
            links,
        })
    }

    /// Adds a frame: a configuration, its closest pair, and where it stands.
    pub(super) fn frame(
        &mut self,
        space: &JointTree,
        q: &[f64],
        place: &str,
        near: &NearPair,
    ) -> Result<(), ToolError> {
        let mut poses = Vec::new();
        space.place(q, &mut poses);
        let [a, b] = [near.pair.a, near.pair.b].map(|part| match part {
            WorldId::Robot(k) => k,
            WorldId::Obstacle(k) => self.links + k,
        });
        let write = || -> Result<(), WriteError> {
            for ((k, pose), body) in (0..).zip(poses).zip(&mut self.bodies) {
                body.1 = pose;
                self.to.pose(k, &pose)?;
            }
            let [(x, at), (y, there)] = [&self.bodies[a], &self.bodies[b]];
            if let Ok(pose) = RelativePose::new(at, there) {
                let answer = PairTracker::new().closest(x, y, &pose);
                self.to.answer(a as u32, b as u32, &answer)?;
            }
            self.to.note(format!(
                "{place}: {} from {} to {}",
                near.distance, near.lower, near.upper
            ));
            self.to.end_frame()
        };
        write().map_err(|fault| refused(&self.file, &fault))
    }

    /// Ends the recording.
    pub(super) fn finish(self) -> Result<(), ToolError> {
        let Self { file, to, .. } = self;
        to.finish().map(|_| ()).map_err(|fault| refused(&file, &fault))
    }
}

fn refused(file: &Path, fault: &WriteError) -> ToolError {
    let (file, reason) = (file.to_owned(), std::io::Error::other(fault.to_string()));
    ToolError::Write { file, reason }
}
