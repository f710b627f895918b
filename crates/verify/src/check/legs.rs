//! The legs of a path, one after the other.

use super::{Check, Wide};
use crate::Stop;
use crate::file::Head;
use crate::scene::Leg;

impl Check {
    /// Returns the leg that is evaluated.
    pub(super) fn now(&self) -> Option<&Leg> {
        match &self.legs {
            Some(legs) => legs.get(self.count.checked_sub(1)?),
            None => self.leg.as_ref(),
        }
    }

    pub(super) fn start_leg(&mut self, leg: Leg) -> Result<(), Stop> {
        let before = if self.count > 0 { self.end_leg() } else { Ok(()) };
        (self.leg, self.count, self.wide) = (Some(leg), self.count + 1, Wide::default());
        let stage = self.narrow.take();
        let Some(now) = self.now() else {
            return Stop::fails("another scene: a leg is missing");
        };
        self.narrow = stage.and_then(|mut stage| stage.set(&self.scene.joints, now).map(|()| stage));
        before
    }

    pub(super) fn all_legs(&self) -> Result<(), Stop> {
        match &self.legs {
            Some(legs) if legs.len() != self.count && self.different.is_none() => {
                Stop::fails(format!("another scene: {} legs, not {}", legs.len(), self.count))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn end_leg(&mut self) -> Result<(), Stop> {
        let cover = std::mem::take(&mut self.cover);
        match &mut self.head {
            Head::Apart(_) if self.different.is_none() => cover.end(&self.scene),
            Head::Range(cells) if self.different.is_none() => cells.end(&self.scene),
            _ => Ok(()),
        }
    }
    /// Says which of several legs is at hand.
    pub(super) fn of_leg(&self) -> String {
        if self.count > 1 {
            format!(" of leg {}", self.count)
        } else {
            String::new()
        }
    }
}
