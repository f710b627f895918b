//! The atlas of a checker: it answers where it can.

use std::sync::Arc;

use super::{Atlas, AtlasVerdict};
use crate::checker::Checker;
use crate::error::PlanError;
use crate::space::ConfigurationSpace;

impl<C: ConfigurationSpace> Checker<C> {
    /// Answers by the boxes of an atlas from now on, where they decide.
    ///
    /// [`is_free_at`](Self::is_free_at) looks up its configuration, and [`is_free`](Self::is_free),
    /// [`certify`](Self::certify) and [`plan`](Self::plan) follow their segments through the boxes. Where
    /// nothing is proven they go on as without an atlas. Verdicts stay; only within rounding of the
    /// margin a box may prove a segment free that is undecided without. Calls that return
    /// distances or certificates do not use it. Segments do not if contacts at the start are
    /// accepted ([`set_start_contact_margin`](Self::set_start_contact_margin)), and tubes never do.
    ///
    /// **Any change of the world drops the atlas**: of obstacles, attached objects, margins, paddings,
    /// excluded pairs, or of the time if an obstacle moves. [`atlas`](Self::atlas) returns
    /// whether it is still there. [`free_boxes`](Self::free_boxes) has an example.
    ///
    /// # Errors
    /// Returns an error that names what differs if the limits, pairs, bodies, joints or margins are
    /// not those of the atlas. They are recognised by a hash of corners, points, sizes and poses. A
    /// forged atlas is not recognised.
    pub fn set_atlas(&mut self, atlas: impl Into<Arc<Atlas>>) -> Result<(), PlanError> {
        let atlas = atlas.into();
        self.check_atlas(&atlas)?;
        self.atlas = Some(atlas);
        Ok(())
    }

    /// Returns the atlas by which the checker answers.
    #[must_use]
    pub fn atlas(&self) -> Option<&Arc<Atlas>> {
        self.atlas.as_ref()
    }

    /// Drops the atlas.
    pub fn clear_atlas(&mut self) {
        self.atlas = None;
    }

    /// Returns what the atlas has proven about a configuration.
    pub(crate) fn atlas_at(&mut self, configuration: &[f64]) -> Option<AtlasVerdict> {
        let is_tube = self.tube > 0.0 || self.joint_tube.is_some();
        let atlas = self.atlas.as_ref().filter(|_| !is_tube)?;
        let found = atlas.verdict_at(configuration);
        self.work.lookups += u64::from(found.is_some());
        found
    }

    /// Returns what the atlas has proven about a segment.
    pub(crate) fn atlas_along(&mut self, from: &[f64], to: &[f64]) -> Option<AtlasVerdict> {
        let is_other = self.tube > 0.0 || self.joint_tube.is_some() || self.start_contact_margin.is_some();
        let atlas = self.atlas.as_ref().filter(|_| !is_other)?;
        let found = atlas.verdict_along(from, to);
        self.work.lookups += u64::from(found.is_some());
        found
    }
}
