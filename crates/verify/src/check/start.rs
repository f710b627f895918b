//! Which scene is evaluated: that of the receipt, or another one.

use super::Check;
use crate::file::Head;
use crate::motion::Stage;
use crate::report::{Failure, Report, StatedFile};
use crate::scene::{Leg, Scene};

impl Check {
    pub(super) fn new(head: Head, mut stated: Scene, other: Option<(Scene, Vec<Leg>)>) -> Self {
        let report = Report {
            files: stated
                .files
                .drain(..)
                .map(|(name, sha256)| StatedFile { name, sha256 })
                .collect(),
            ..Report::default()
        };
        let (mut scene, mut legs, mut different) = (stated, None, None);
        if let Some((mut new, new_legs)) = other {
            let same = scene
                .bodies
                .iter()
                .zip(&new.bodies)
                .take_while(|(x, y)| x.name == y.name)
                .count();
            if same != scene.bodies.len().max(new.bodies.len()) {
                different = Some(format!("another scene: body {same} is not the same"));
            }
            (new.ignored, new.reasons) = (std::mem::take(&mut scene.ignored), std::mem::take(&mut scene.reasons));
            (scene, legs) = (new, Some(new_legs));
        }
        Self {
            head,
            scene,
            legs,
            different,
            report,
            ..Self::default()
        }
    }

    pub(super) fn start(&mut self, line: usize) {
        match self.different.clone() {
            Some(why) => self.failure = Some(Failure::new(line, None, true, why)),
            None => self.narrow = Stage::new(&self.scene, None),
        }
    }
}
