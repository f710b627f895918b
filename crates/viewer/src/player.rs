//! Plays a recording on the stage, frame by frame.

use lin_canny_record::{Cursor, Recording};

use crate::stage::{Pair, Stage};

/// A recording and its shown frame.
#[derive(Default)]
pub struct Player {
    /// The recording.
    pub recording: Recording,
    /// The shown frame.
    pub frame: usize,
    /// Whether the frames advance automatically.
    pub plays: bool,
    cursor: Cursor,
    /// Whether the vertices of a mesh change.
    bends: bool,
}

/// Text under every frame of a recording in which a mesh deforms.
const BENDS: &str = "Meshes whose vertices change are drawn as they are at first.";

impl Player {
    /// Puts the bodies of a recording on a stage and shows the first frame.
    #[must_use]
    pub fn new(recording: Recording) -> (Self, Stage) {
        let mut stage = Stage::default();
        for geometry in &recording.geometries {
            stage.geometry(geometry.clone());
        }
        for body in &recording.bodies {
            stage.body(body.name.clone(), body.geometry as usize, body.pose);
        }
        let mut player = Self {
            bends: recording.frames.iter().any(|frame| !frame.vertices.is_empty()),
            recording,
            ..Self::default()
        };
        player.show(0, &mut stage);
        (player, stage)
    }

    /// Shows a frame, or the last frame if the number is too large.
    pub fn show(&mut self, frame: usize, stage: &mut Stage) {
        self.frame = frame.min(self.recording.frames.len().saturating_sub(1));
        self.cursor.seek(&self.recording, self.frame);
        for (body, pose) in stage.bodies.iter_mut().zip(&self.cursor.poses) {
            body.shown = pose.is_some();
            if let Some(pose) = pose {
                body.pose = *pose;
            }
        }
        let Some(frame) = self.recording.frames.get(self.frame) else {
            return;
        };
        stage.pairs.clear();
        stage.pairs.extend(frame.pairs.iter().map(|p| Pair {
            bodies: [p.a as usize, p.b as usize],
            outcome: p.outcome,
            subshapes: p.subshapes,
            contacts: p.contacts.clone(),
        }));
        stage.boxes.clone_from(&frame.boxes);
        stage.columns.clone_from(&frame.columns);
        stage.brackets.clone_from(&frame.brackets);
        stage.paths.clone_from(&frame.paths);
        stage.note.clone_from(&frame.note);
        if self.bends {
            let gap = if stage.note.is_empty() { "" } else { "\n" };
            stage.note += &format!("{gap}{BENDS}");
        }
    }

    /// Advances by one frame if the recording plays; the first frame follows the last.
    pub fn advance(&mut self, stage: &mut Stage) {
        if self.plays && !self.recording.frames.is_empty() {
            self.show((self.frame + 1) % self.recording.frames.len(), stage);
        }
    }
}
