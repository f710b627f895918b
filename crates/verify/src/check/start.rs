//! Which scene is evaluated: that of the receipt, or another one.

use super::Check;
use crate::Stop;
use crate::file::Head;
use crate::motion::Stage;
use crate::report::{Failure, StatedFile};
use crate::rules;
use crate::scene::{Leg, Scene};

impl Check {
    pub(super) fn new(head: Head, mut stated: Scene, other: Option<(Scene, Vec<Leg>)>) -> Self {
        let mut check = Self {
            head,
            ..Self::default()
        };
        if let Some((mut scene, legs)) = other {
            check.different = check.differs(&stated, &scene, &legs);
            scene.ignored = std::mem::take(&mut stated.ignored);
            scene.reasons = std::mem::take(&mut stated.reasons);
            (check.stated, check.legs) = (Some(stated), Some(legs));
            stated = scene;
        }
        let file = |(name, sha256)| StatedFile { name, sha256 };
        check.report.files = stated.files.drain(..).map(file).collect();
        check.scene = stated;
        check
    }

    /// Says why no evidence of a receipt can be evaluated on another scene.
    fn differs(&self, stated: &Scene, other: &Scene, legs: &[Leg]) -> Option<String> {
        let pairs = stated.bodies.iter().zip(&other.bodies);
        let same = pairs.take_while(|(x, y)| x.name == y.name).count();
        if same != stated.bodies.len().max(other.bodies.len()) {
            return Some(format!("another scene: body {same} is not the same"));
        }
        let mut before = None;
        let each = legs
            .iter()
            .map(|leg| rules::of_leg(&self.head, other, before.replace(leg), leg));
        let (Stop::Bad(why) | Stop::Fails(why)) = [rules::of_scene(&self.head, other)]
            .into_iter()
            .chain(each)
            .find_map(Result::err)?;
        Some(format!("another scene: {why}"))
    }

    pub(super) fn start(&mut self, line: usize) {
        match self.different.clone() {
            Some(why) => self.failure = Some(Failure::new(line, None, true, why)),
            None => self.narrow = Stage::new(&self.scene, None),
        }
    }
}
