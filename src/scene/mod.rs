//! Many moving bodies: the broad phase finds overlapping boxes, one tracker follows each pair of
//! overlapping boxes, and a step computes only the enabled queries.
//!
//! ```
//! use std::sync::Arc;
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//! use lin_canny::scene::{Body, Change, PairQueries, Group, Scene};
//!
//! const CELL: Group = Group::new(1).unwrap();
//! const ROBOT: Group = Group::new(2).unwrap();
//!
//! // Shared by all bodies of this shape.
//! let block = Arc::new(solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?);
//! let mut scene = Scene::new();
//! scene.set_queries(ROBOT, CELL, PairQueries::none().within(0.05))?;
//! let wall = Body::fixed(block.clone()).group(CELL);
//! scene.insert(wall, Isometry3::translation(3.005, 0.0, 0.0))?;
//! let arm = Body::moving(block).group(ROBOT);
//! let arm = scene.insert(arm, Isometry3::identity())?;
//!
//! let mut came = None;
//! for frame in 0..200 {
//!     let x = 0.01 * f64::from(frame);
//!     scene.set_pose(arm, Isometry3::translation(x, 0.2, 0.0))?;
//!     scene.step();
//!     if scene.events().iter().any(|e| e.change == Change::CameWithin) {
//!         came = came.or(Some(frame));
//!     }
//! }
//! assert_eq!(came, Some(196)); // 3.005 - 0.5 - 0.5 - 1.96 = 0.045
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A step
//!
//! [`insert`](Scene::insert), [`remove`](Scene::remove), [`set_pose`](Scene::set_pose) and
//! [`set_queries`](Scene::set_queries) gather changes; [`step`](Scene::step) applies the changes:
//!
//! 1. **boxes** of the bodies that moved, grown by half of the distances of the queries;
//! 2. **pairs** of boxes: a new pair gets a tracker if more than boxes is enabled, an ended pair
//!    gives the tracker back;
//! 3. **look**: the narrow phase of each called pair, unless a cheaper test answers (bodies at
//!    rest, the displacement budget, two balls); then the tracker, with the depth of an overlap and
//!    contact points only if enabled;
//! 4. **events** in a fixed order.
//!
//! [`pairs`](Scene::pairs), [`pairs_of`](Scene::pairs_of) a body and [`events`](Scene::events)
//! return the results, [`report`](Scene::report) returns the cost. Further queries that a step does
//! not answer: [`closest_pair`](Scene::closest_pair) of two groups,
//! [`pairs_within`](Scene::pairs_within), [`nearest`](Scene::nearest),
//! [`first_contact`](Scene::any_contact).
//!
//! # The nearest pair of a robot and its cell
//!
//! | when | how | microseconds a cycle |
//! |---|---|---:|
//! | every cycle, a range is known | query `distance` up to the range, least of [`pairs`](Scene::pairs) | 4 to 7 |
//! | now and then, or no range is known | [`closest_pair`](Scene::closest_pair) with query `boxes`; keeps no features between calls | 13 to 21 |
//! | few pairs, always the same | a [`Tracker`](crate::Tracker) for each | 17 to 31 |
//! | distances of all pairs | query `distance` with the range infinity | 30 to 45 |
//!
//! The figures are medians of an arm of seven links among thirty boxes, itself included, 195 pairs,
//! at a range of 0.2 m; the bodies move at 1 kHz.
//!
//! A distance is computed up to a range, and the least distance that a step found is the
//! clearance. The answer for a pair is in the frames of the two bodies, as in
//! [`Outcome`](crate::Outcome); the poses of the bodies lead to the world.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//! use lin_canny::scene::{Body, PairQueries, Group, Scene};
//!
//! const CELL: Group = Group::new(1).unwrap();
//! const ROBOT: Group = Group::new(2).unwrap();
//!
//! let mut scene = Scene::new();
//! let none = PairQueries::none();
//! let queries =
//!     none.distance(0.5).features(true).depth(true);
//! scene.set_queries(ROBOT, CELL, queries)?;
//! let post = solids::prism(24, 1.0, 0.1)?;
//! let post = Body::fixed(post).group(CELL);
//! scene.insert(post, Isometry3::translation(1.0, 0.0, 0.0))?;
//! let link = solids::cuboid(Vector3::new(0.3, 0.05, 0.05))?;
//! let pose = Isometry3::translation(0.4, 0.0, 0.2);
//! let link = scene.insert(Body::moving(link).group(ROBOT), pose)?;
//! scene.step();
//!
//! let answers = scene.pairs().filter_map(|pair| Some((pair, pair.outcome?)));
//! let (pair, nearest) = answers
//!     .min_by(|x, y| x.1.distance.total_cmp(&y.1.distance))
//!     .expect("no farther apart than 0.5");
//! assert!((nearest.distance - 0.2).abs() < 1e-3);
//! let on_link =
//!     if pair.a == link { nearest.point_on_a } else { nearest.point_on_b };
//! let in_world = scene.pose(link).unwrap() * on_link;
//! assert!((in_world.x - 0.7).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Adjacent links of an arm touch by design: [`ignore_pair`](Scene::ignore_pair) excludes pairs.
//!
//! # What it costs
//!
//! [`PairQueries`] is the price list. A pair with only events of overlaps or of `within` is tested
//! when the bodies may have used up the distance between them, and not before: see [`budget`] for
//! the rule and the proof. A distance is computed whenever a body of the pair has moved. A
//! step without changes does nothing.
//!
//! # Promises
//!
//! * Events and predicates are exact (feature `exact`) for the poses given: equal to brute force
//!   over all pairs on every frame, with the budget or without. Distances have the bounds of
//!   [`Tracker::closest`](crate::Tracker::closest).
//! * Dropping a query never raises a counter of the narrow phase on the scenes tested; a query
//!   that is not enabled is counted as exactly zero, and takes no memory.
//! * Equal calls give equal answers, events and counts bit for bit, with any number of threads
//!   (feature `parallel`), and after a scene was written and read back (feature `serde`; only
//!   [`StepWork::swaps`], the work of sorted lists that are rebuilt then, may differ). Trackers of
//!   compounds and meshes are not written: distances of such a pair then agree within the bounds.
//!   The format must keep every bit of an `f64`: with `serde_json` switch on the feature
//!   `float_roundtrip`.
//! * A refused call names the fault and changes nothing ([`SceneError`]).
//!
//! # Limits
//!
//! Coordinates, radii and ranges are at most 1e37. Pairs are found by boxes in `f32` about the
//! origin of [`Settings`]: scenes far from this origin pair more bodies than they need. Groups are
//! 32.
//!
//! # Motion
//!
//! Bodies with velocities go on by [`advance`](Scene::advance), one tick between two steps. Pairs
//! then sleep until the proof of their separation ends, and with the query `impact` a step finds
//! the [`impacts`](Scene::impacts) within the tick in the order of time.
//!
//! Source: Cohen, Lin, Manocha and Ponamgi 1995 (I-COLLIDE) join sweep and prune with one tracker a
//! pair; Lin 1993 (section 5.4) asks that a simulation pay only for the enabled queries.
//! Departures: pairs are kept in one table per level of detail; the wake-up is bounded by
//! displacement instead of by time.
//!
//! What a caller asks of a scene: queries, bodies and their poses.

mod answers;
mod body;
pub mod budget;
mod check;
mod error;
mod filter;
mod lookahead;
#[cfg(feature = "meshes")]
mod meshes;
mod motion;
mod narrow_phase;
mod pair_engine;
mod pair_table;
#[cfg(feature = "parallel")]
mod parallel;
mod queries;
mod report;
mod search;
#[cfg(feature = "serde")]
mod snapshot;
mod step;

use crate::body::polyhedron::BoxHint;
use crate::broad;
pub use crate::broad::{BodyId, PairId, Settings};
use crate::broad::{Groups, SweepAndPrune};
use crate::convex::tracker::Workspace;
use crate::pair_tracker::geometry::Geometry;
pub use crate::scene::answers::PairResults;
pub use crate::scene::answers::{Change, Event, PairImpact};
pub use crate::scene::body::Body;
use crate::scene::body::{BodySolid, BodyTable, box_of, checked};
pub use crate::scene::error::SceneError;
use crate::scene::filter::Ignored;
use crate::scene::pair_table::PairTables;
use crate::scene::queries::Census;
use crate::scene::queries::{GROUPS, Table};
pub use crate::scene::queries::{Group, PairQueries};
pub use crate::scene::report::{MemoryUsage, Report, StepWork, Times};
pub use crate::scene::search::ClosestPair;
use alloc::vec::Vec;
use nalgebra::Isometry3;

/// Bodies, the enabled queries, and the results of the last step. See the [module page](self).
#[doc(alias = "world")]
#[doc(alias = "collision detection")]
#[doc(alias = "i-collide")]
#[derive(Clone)]
pub struct Scene {
    bodies: BodyTable,
    census: Census,
    table: Table,
    broad: SweepAndPrune,
    pair_tables: PairTables,
    ignored: Ignored,
    events: Vec<Event>,
    impacts: Vec<PairImpact>,
    report: Report,
    /// Groups whose queries changed since the last step, as bits.
    replanned: u32,
    /// Whether bodies were inserted, removed or moved to another group since the last step.
    changed: bool,
    /// By group, as of the last step that applied changed queries: the growth of the boxes, and the
    /// groups to pair with as bits.
    growths: [f64; GROUPS],
    partners: [u32; GROUPS],
    budget: bool,
    schedule: bool,
    settings: Settings,
    /// Scratch buffers, kept for their capacity.
    batch: Vec<(broad::BodyId, broad::Aabb)>,
    workspace: Workspace,
}

/// Prints sizes only: a scene is too large to be printed whole.
impl core::fmt::Debug for Scene {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Scene")
            .field("bodies", &self.body_count())
            .field("pairs", &self.pair_count())
            .field("events", &self.events.len())
            .finish_non_exhaustive()
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self::new()
    }
}

impl Scene {
    /// Returns an empty scene about the origin, in which no query is enabled: without
    /// [`set_queries`](Self::set_queries) a step does nothing but count the bodies that no query
    /// covers ([`StepWork::without_queries`]).
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
            broad: SweepAndPrune::with_settings(settings),
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

    /// Returns an empty scene about the origin with the same queries for all pairs of bodies,
    /// whatever the groups.
    ///
    /// # Errors
    /// The errors of [`set_queries`](Self::set_queries).
    pub fn with_queries(queries: PairQueries) -> Result<Self, SceneError> {
        let mut scene = Self::new();
        for g in 0..GROUPS {
            for h in g..GROUPS {
                scene.set_queries(step::group(g), step::group(h), queries)?;
            }
        }
        Ok(scene)
    }

    /// Enables queries for the pairs of two groups (or of one group with itself), replacing the
    /// queries that were enabled before. Takes effect with the next step, for existing pairs and
    /// for pairs to come: new queries are computed, dropped queries are forgotten without an event,
    /// unless no query at all is left.
    ///
    /// # Errors
    /// If a distance is NaN, negative or beyond 1e37 (only `distance` may be infinite), an option
    /// of the manifold is NaN, or bodies of the two groups are of kinds that cannot answer an
    /// query.
    pub fn set_queries(&mut self, these: Group, those: Group, queries: PairQueries) -> Result<(), SceneError> {
        if self.table.queries(these, those) == queries {
            return Ok(());
        }
        self.census.check_effects(these, those, &queries)?;
        self.table.set_queries(these, those, queries)?;
        self.replanned |= 1 << these.number() | 1 << those.number();
        Ok(())
    }

    /// Returns the enabled queries between two groups.
    #[must_use]
    pub fn queries(&self, these: Group, those: Group) -> PairQueries {
        self.table.queries(these, those)
    }

    /// Sets whether pairs sleep while the displacement budget answers for them; on by default. The
    /// answers do not depend on the setting.
    #[cfg(feature = "__internals")]
    #[doc(hidden)]
    pub fn set_budget(&mut self, on: bool) {
        self.budget = on;
    }

    /// Puts a body into the scene.
    ///
    /// # Errors
    /// If the pose is not a rigid motion or too far out, the shape too large or of a kind that
    /// cannot answer an enabled query, the origin of the scene's settings not finite, or there
    /// are too many bodies.
    pub fn insert(&mut self, body: Body, pose: Isometry3<f64>) -> Result<BodyId, SceneError> {
        checked(&pose, None)?;
        let mut solid = BodySolid::new(body)?;
        self.census
            .check_body(solid.member(), |other| self.table.queries(solid.group, other))?;
        let mut hint = BoxHint::default();
        let proxy = self.create_proxy(&mut solid, &pose, &mut hint)?;
        self.changed = true;
        self.census.add(solid.member());
        Ok(self.bodies.insert(solid, pose, proxy, hint))
    }

    /// Creates the box of a body in the broad phase.
    fn create_proxy(
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
    /// If the id is stale, or the shape of the body is of a kind that cannot answer a query of
    /// the group.
    pub fn set_group(&mut self, id: BodyId, group: Group) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        let Some(solid) = &mut self.bodies.solids[i] else {
            return Err(SceneError::StaleBody { body: id });
        };
        let (old, kind, is_fixed) = solid.member();
        self.census.remove((old, kind, is_fixed));
        let queries = |other| self.table.queries(group, other);
        let checked = self.census.check_body((group, kind, is_fixed), queries);
        if checked.is_ok() {
            solid.group = group;
        }
        self.census.add(solid.member());
        checked?;
        // Applied together with the queries of both groups.
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
    /// the order of [`Change`].
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
