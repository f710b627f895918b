//! What a caller asks of a scene: effects, bodies and their poses.

use alloc::vec::Vec;

use nalgebra::Isometry3;

use super::body::{BodySolid, BodyTable, box_of, checked};
use super::effects::{GROUPS, Table};
use super::filter::Ignored;
use super::kinds::Census;
use super::pair_table::PairTables;
use super::step;
use super::{Body, BodyId, Effects, Event, Group, Report, Scene, SceneError, Settings};
use crate::body::polyhedron::BoxHint;
use crate::broad::{self, BroadPhase, Groups, PencilSweep};
use crate::convex::tracker::Workspace;
use crate::pair_tracker::geometry::Geometry;

impl Scene {
    /// Returns an empty scene about the origin, in which nothing is called for: without
    /// [`call_for`](Self::call_for) a step does nothing but count the bodies that no effect covers
    /// ([`Counts::uncovered`](super::Counts::uncovered)).
    #[must_use]
    pub fn new() -> Self {
        Self::with_settings(Settings::default())
    }

    /// Returns an empty scene with the given settings: the origin of the boxes (precision is best
    /// there), and the size from which on threads are used.
    #[must_use]
    pub fn with_settings(settings: Settings) -> Self {
        let bodies = BodyTable {
            step: 1,
            ..BodyTable::default()
        };
        Self {
            bodies,
            census: Census::default(),
            table: Table::default(),
            broad: PencilSweep::with_settings(settings),
            pair_tables: PairTables::default(),
            ignored: Ignored::default(),
            events: Vec::new(),
            impacts: Vec::new(),
            report: Report::default(),
            replanned: 0,
            changed: false,
            growths: [0.0; GROUPS],
            partners: [0; GROUPS],
            budget: true,
            schedule: true,
            settings,
            batch: Vec::new(),
            workspace: Workspace::default(),
        }
    }

    /// Returns an empty scene about the origin with the same effects for all pairs of bodies,
    /// whatever the groups.
    ///
    /// # Errors
    /// The errors of [`call_for`](Self::call_for).
    pub fn with_effects(effects: Effects) -> Result<Self, SceneError> {
        let mut scene = Self::new();
        for g in 0..GROUPS {
            for h in g..GROUPS {
                scene.call_for(step::group(g), step::group(h), effects)?;
            }
        }
        Ok(scene)
    }

    /// Calls for effects for the pairs of two groups (or of one group with itself), replacing the
    /// effects called for before. Takes effect with the next step, for existing pairs and for pairs
    /// to come: new effects are computed, dropped effects are forgotten without an event, unless no
    /// effect at all is left.
    ///
    /// # Errors
    /// If a distance is NaN, negative or beyond 1e37 (only `distance` may be infinite), an option
    /// of the manifold is NaN, or bodies of the two groups are of kinds that cannot answer an
    /// effect.
    pub fn call_for(&mut self, these: Group, those: Group, effects: Effects) -> Result<(), SceneError> {
        if self.table.effects(these, those) == effects {
            return Ok(());
        }
        self.census.check_effects(these, those, &effects)?;
        self.table.call_for(these, those, effects)?;
        self.replanned |= 1 << these.number() | 1 << those.number();
        Ok(())
    }

    /// Returns the effects called for between two groups.
    #[must_use]
    pub fn effects(&self, these: Group, those: Group) -> Effects {
        self.table.effects(these, those)
    }

    /// Sets whether pairs sleep while the displacement budget answers for them; on by default. The
    /// answers do not depend on the setting.
    pub fn set_budget(&mut self, on: bool) {
        self.budget = on;
    }

    /// Puts a body into the scene.
    ///
    /// # Errors
    /// If the pose is not a rigid motion or too far out, the shape too large or of a kind that
    /// cannot answer an effect called for, the origin of the scene's settings not finite, or there
    /// are too many bodies.
    pub fn insert(&mut self, body: Body, pose: Isometry3<f64>) -> Result<BodyId, SceneError> {
        checked(&pose, None)?;
        let mut solid = BodySolid::new(body)?;
        self.census
            .check_body(solid.member(), |other| self.table.effects(solid.group, other))?;
        let mut hint = BoxHint::default();
        let proxy = self.create_proxy(&mut solid, &pose, &mut hint)?;
        self.changed = true;
        self.census.add(solid.member());
        Ok(self.bodies.insert(solid, pose, proxy, hint))
    }

    /// Creates the box of a body in the broad phase.
    pub(super) fn create_proxy(
        &mut self,
        solid: &mut BodySolid,
        pose: &Isometry3<f64>,
        hint: &mut BoxHint,
    ) -> Result<broad::BodyId, SceneError> {
        let groups = self.groups_of(solid.group);
        let growth = self.growths[solid.group.index()];
        let kind = if solid.fixed {
            broad::BodyOptions::fixed()
        } else {
            broad::BodyOptions::moving()
        };
        let kind = kind.groups(groups);
        solid.boxed = growth < f64::INFINITY;
        Ok(if solid.boxed {
            self.broad.insert(&box_of(&solid.shape, pose, growth, hint), kind)?
        } else {
            self.broad.insert_unbounded(&broad::Aabb::everything(), kind)?
        })
    }

    pub(super) fn groups_of(&self, group: Group) -> Groups {
        Groups {
            member_of: 1 << group.number(),
            pairs_with: self.table.partners(group),
        }
    }

    /// Removes a body: the id is stale at once, the pairs of the body end with the next step.
    ///
    /// # Errors
    /// If the id is stale.
    pub fn remove(&mut self, id: BodyId) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        self.broad.remove(self.bodies.proxies[i])?;
        self.ignored.forget(id.index);
        if let Some(solid) = &self.bodies.solids[i] {
            self.census.remove(solid.member());
        }
        self.bodies.remove(i);
        self.changed = true;
        Ok(())
    }

    /// Moves a body, however far. Until the next step all answers remain those of the last step.
    ///
    /// # Errors
    /// If the id is stale or the pose refused; the body keeps its pose.
    pub fn set_pose(&mut self, id: BodyId, pose: Isometry3<f64>) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        checked(&pose, Some(id))?;
        self.bodies.place(i, &pose);
        Ok(())
    }

    /// Puts a body into another group; the pairs of the body are tested again in the next step.
    ///
    /// # Errors
    /// If the id is stale, or the shape of the body is of a kind that cannot answer an effect of
    /// the group.
    pub fn set_group(&mut self, id: BodyId, group: Group) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        let Some(solid) = &mut self.bodies.solids[i] else {
            return Err(SceneError::StaleBody { body: id });
        };
        let (old, kind, is_fixed) = solid.member();
        self.census.remove((old, kind, is_fixed));
        let effects = |other| self.table.effects(group, other);
        let checked = self.census.check_body((group, kind, is_fixed), effects);
        if checked.is_ok() {
            solid.group = group;
        }
        self.census.add(solid.member());
        checked?;
        // Applied together with the effects of both groups.
        self.replanned |= 1 << old.number() | 1 << group.number();
        Ok(())
    }

    /// Returns the pose last set. After [`set_pose`](Self::set_pose) the answers of the last step
    /// are still those of the pose before.
    #[must_use]
    pub fn pose(&self, id: BodyId) -> Option<&Isometry3<f64>> {
        Some(&self.bodies.poses[self.bodies.index_of(id).ok()?])
    }

    /// Returns the shape of a body.
    #[must_use]
    pub fn shape(&self, id: BodyId) -> Option<&Geometry> {
        let solid = self.bodies.solids[self.bodies.index_of(id).ok()?].as_ref()?;
        Some(&solid.shape)
    }

    /// Returns the group of a body.
    #[must_use]
    pub fn group(&self, id: BodyId) -> Option<Group> {
        Some(self.bodies.solids[self.bodies.index_of(id).ok()?].as_ref()?.group)
    }

    /// Returns the caller's number of a body: see [`Body::user_data`].
    #[must_use]
    pub fn user_data(&self, id: BodyId) -> Option<u64> {
        Some(self.bodies.solids[self.bodies.index_of(id).ok()?].as_ref()?.user_data)
    }

    /// Sets the caller's number of a body: see [`Body::user_data`].
    ///
    /// # Errors
    /// If the id is stale.
    pub fn set_user_data(&mut self, id: BodyId, user_data: u64) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        if let Some(solid) = &mut self.bodies.solids[i] {
            solid.user_data = user_data;
        }
        Ok(())
    }

    /// Returns the number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Iterates over all bodies in ascending order.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.bodies.ids()
    }

    /// Returns the changes of the last step, in ascending order of the two bodies; for one pair in
    /// the order of [`Change`](super::Change).
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Returns the work and the times of the last step.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }
}
