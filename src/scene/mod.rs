//! Scenes of many moving bodies. The broad phase finds the pairs whose boxes overlap, one tracker
//! follows each of these pairs, and a step computes only the enabled queries.
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
//! [`set_queries`](Scene::set_queries) collect changes. [`step`](Scene::step) applies them in four
//! stages:
//!
//! 1. **boxes**: compute the boxes of the bodies that moved, each grown by half of the largest
//!    distance of its queries;
//! 2. **pairs**: find the pairs of boxes that start or stop overlapping. A new pair gets a tracker
//!    if more than `boxes` is enabled; a pair that ends drops its tracker;
//! 3. **narrow phase**: query each active pair that no cheaper test has decided (bodies at rest,
//!    displacement budget, two balls). The tracker computes the depth of an overlap and the contact
//!    points only if they are enabled;
//! 4. **events**: sort the events into a fixed order.
//!
//! [`pairs`](Scene::pairs), [`pairs_of`](Scene::pairs_of) a body and [`events`](Scene::events)
//! return the results; [`report`](Scene::report) returns the cost. Four queries are computed on
//! request, not by a step: [`closest_pair`](Scene::closest_pair) of two groups,
//! [`pairs_within`](Scene::pairs_within), [`nearest`](Scene::nearest) and
//! [`any_contact`](Scene::any_contact).
//!
//! # The nearest pair of a robot and its cell
//!
//! | when | how | µs per cycle |
//! |---|---|---:|
//! | every cycle, a range is known | enable `distance` up to the range and take the least of [`pairs`](Scene::pairs) | 4 to 7 |
//! | sometimes, or no range is known | [`closest_pair`](Scene::closest_pair) with `boxes` enabled; keeps no features between calls | 13 to 21 |
//! | few pairs, always the same | one [`Tracker`](crate::Tracker) for each pair | 17 to 31 |
//! | distances of all pairs | enable `distance` with an infinite range | 30 to 45 |
//!
//! The times are medians for an arm of seven links among thirty boxes: 195 pairs, including the
//! pairs of two links. The range is 0.2 m, and the bodies move at 1 kHz.
//!
//! A step computes a distance up to a range, and the least distance that it finds is the clearance.
//! The results of a pair are in the frames of the two bodies, as in [`Outcome`](crate::Outcome);
//! the poses of the bodies transform them to the world.
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
//! Adjacent links of an arm touch by design: [`exclude_pair`](Scene::exclude_pair) excludes pairs.
//!
//! # What it costs
//!
//! [`PairQueries`] lists the work of each query. A pair with only events of overlaps or of `within`
//! is tested only when the bodies may have used up the distance between them: see [`budget`] for
//! the rule and the proof. A distance is computed whenever a body of the pair has moved. A step
//! without changes does nothing.
//!
//! # Guarantees
//!
//! * Events and predicates are exact for the poses given (feature `exact`). They equal those of
//!   brute force over all pairs in every frame, with the budget and without it. Distances have the
//!   bounds of [`Tracker::closest`](crate::Tracker::closest).
//! * Switching off a query never raised a counter of the narrow phase in the scenes tested. A query
//!   that is not enabled has a count of exactly zero and takes no memory.
//! * Equal calls give equal results, events and counts bit for bit. This holds for any number of
//!   threads (feature `parallel`) and after a scene was written and read back (feature `serde`).
//!   Exceptions after reading: [`StepWork::swaps`], the work of sorted lists, may differ because
//!   the lists are rebuilt. Trackers of compounds and meshes are not written, so the distances of
//!   such a pair agree within the bounds. The format must keep every bit of an `f64`: with
//!   `serde_json`, enable its feature `float_roundtrip`.
//! * No bound of a file is believed. Reading costs a query for each pair. A pair keeps a stored
//!   answer if the query gives the same contact state and predicates, and bounds that agree up to
//!   rounding. Any other pair has no answer before the next step, which tests it: so does a pair
//!   with a measured distance if a body was moved after the last step. Events, impacts and counts
//!   of that step are read as a record.
//! * A call that returns an error ([`SceneError`]) changes nothing.
//!
//! # Limits
//!
//! Coordinates, radii and ranges are at most 1e37. The broad phase stores boxes in `f32`, relative
//! to the origin of [`Settings`], so far from this origin more pairs of boxes overlap than
//! necessary. There are 32 groups.
//!
//! # Motion
//!
//! [`advance`](Scene::advance) moves the bodies that have velocities, by one tick between two
//! steps. Pairs then sleep until the proof of their separation ends. With the query `impact`, a
//! step finds the [`impacts`](Scene::impacts) within the tick and returns them in the order of
//! time; with `impact_within`, also the times at which bodies come within a distance.
//!
//! # Fixed bodies
//!
//! Two bodies that are both [`fixed`](Body::fixed) are not a pair: a scene of fixed bodies alone
//! finds nothing, for all enabled queries. The report of a step counts the pairs that were
//! left out ([`StepWork::fixed_left_out`]). [`PairQueries::fixed`](field@PairQueries::fixed)
//! queries them, for instance to find the [parts of an assembly that
//! clash](crate::guide::distances#do-parts-of-an-assembly-clash).
//!
//! Source: Cohen, Lin, Manocha and Ponamgi 1995 (I-COLLIDE) combine sweep and prune with one
//! tracker per pair. Lin 1993 (section 5.4) requires that a simulation pay only for the enabled
//! queries. Departures: pairs are stored in one table per level of detail; displacement bounds the
//! wake-up, not time.
//!
//! This file holds the calls that set queries, bodies and their poses.

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
#[cfg(feature = "serde")]
mod reprove;
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
use crate::scene::filter::Excluded;
use crate::scene::pair_table::PairTables;
use crate::scene::queries::Census;
use crate::scene::queries::{GROUPS, Table};
pub use crate::scene::queries::{Group, PairQueries};
pub use crate::scene::report::{MemoryUsage, Report, StepWork, Times};
pub use crate::scene::search::ClosestPair;
use alloc::vec::Vec;
use nalgebra::Isometry3;

/// A scene: bodies, the enabled queries, and the results of the last step. See the [module
/// page](self).
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
    excluded: Excluded,
    events: Vec<Event>,
    impacts: Vec<PairImpact>,
    report: Report,
    /// Pairs of fixed bodies that no query tests, after the last step that changed any.
    fixed_left_out: u64,
    /// Groups whose queries changed since the last step, as bits.
    replanned: u32,
    /// Whether bodies were inserted, removed or moved to another group since the last step.
    changed: bool,
    /// By group, after the last step that applied changed queries: the growth of the boxes, and the
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
    /// Returns an empty scene around the origin, without any enabled query.
    ///
    /// Before [`set_queries`](Self::set_queries) enables a query, a step only counts the bodies
    /// without queries ([`StepWork::without_queries`]).
    #[must_use]
    pub fn new() -> Self {
        Self::with_settings(Settings::default())
    }

    /// Returns an empty scene with the given settings: the origin of the boxes, where they are most
    /// precise, and the number of bodies from which threads are used.
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
            excluded: Excluded::default(),
            events: Vec::new(),
            impacts: Vec::new(),
            report: Report::default(),
            fixed_left_out: 0,
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

    /// Returns an empty scene with the same queries for all pairs of groups.
    ///
    /// # Errors
    /// Returns the errors of [`set_queries`](Self::set_queries).
    pub fn with_queries(queries: PairQueries) -> Result<Self, SceneError> {
        let mut scene = Self::new();
        for g in 0..GROUPS {
            for h in g..GROUPS {
                scene.set_queries(step::group(g), step::group(h), queries)?;
            }
        }
        Ok(scene)
    }

    /// Sets the queries for pairs of two groups, or of one group with itself.
    ///
    /// The new queries replace those that were enabled before. They take effect with the next step,
    /// for existing and for new pairs. Results of queries that are no longer enabled are dropped
    /// without an event; only if no query is left, the pairs end with events.
    ///
    /// # Errors
    /// Returns an error if a distance is NaN, negative or beyond 1e37 (only `distance` may be
    /// infinite), if an option of the manifold is NaN, or if bodies of the two groups are of kinds
    /// that cannot answer one of the queries.
    pub fn set_queries(&mut self, these: Group, those: Group, queries: PairQueries) -> Result<(), SceneError> {
        if self.table.queries(these, those) == queries {
            return Ok(());
        }
        self.census.check_queries(these, those, &queries)?;
        self.table.set_queries(these, those, queries)?;
        self.replanned |= 1 << these.number() | 1 << those.number();
        Ok(())
    }

    /// Returns the enabled queries between two groups.
    #[must_use]
    pub fn queries(&self, these: Group, those: Group) -> PairQueries {
        self.table.queries(these, those)
    }

    /// Sets whether pairs sleep as long as the displacement budget decides their queries. The
    /// default is on; results do not depend on the setting.
    #[cfg(feature = "__internals")]
    #[doc(hidden)]
    pub fn set_budget(&mut self, on: bool) {
        self.budget = on;
    }

    /// Inserts a body into the scene.
    ///
    /// # Errors
    /// Returns an error if the pose is not a rigid motion or is out of range, if the geometry is
    /// too large or of a kind that cannot answer an enabled query, if the origin of the scene's
    /// settings is not finite, or if there are too many bodies.
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
            broad::BodyOptions::default().fixed(true)
        } else {
            broad::BodyOptions::default()
        };
        let kind = kind.groups(groups);
        solid.boxed = growth < f64::INFINITY;
        let is_half_space = matches!(solid.shape, Geometry::HalfSpace(_));
        Ok(if solid.boxed && is_half_space {
            self.broad
                .insert_unbounded(&box_of(&solid.shape, pose, growth, hint), kind)?
        } else if solid.boxed {
            self.broad.insert(&box_of(&solid.shape, pose, growth, hint), kind)?
        } else {
            self.broad.insert_unbounded(&broad::Aabb::everything(), kind)?
        })
    }

    pub(super) fn groups_of(&self, group: Group) -> Groups {
        Groups {
            member_of: 1 << group.number(),
            pairs_with: self.table.partners(group),
            fixed_with: self.table.fixed_partners(group),
        }
    }

    /// Removes a body. Its id is stale at once; its pairs end with the next step.
    ///
    /// # Errors
    /// Returns an error if the id is stale.
    pub fn remove(&mut self, id: BodyId) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        self.broad.remove(self.bodies.proxies[i])?;
        self.excluded.remove_body(id.index);
        if let Some(solid) = &self.bodies.solids[i] {
            self.census.remove(solid.member());
        }
        self.bodies.remove(i);
        self.changed = true;
        Ok(())
    }

    /// Sets the pose of a body, at any distance from the last one. Until the next step all results
    /// remain those of the last step.
    ///
    /// # Errors
    /// Returns an error if the id is stale or the pose is invalid; the body keeps its pose.
    pub fn set_pose(&mut self, id: BodyId, pose: Isometry3<f64>) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        checked(&pose, Some(id))?;
        self.bodies.place(i, &pose);
        Ok(())
    }

    /// Moves a body to another group. The next step tests its pairs again.
    ///
    /// # Errors
    /// Returns an error if the id is stale, or if the geometry of the body is of a kind that cannot
    /// answer a query of the group.
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

    /// Returns the current pose of a body. After [`set_pose`](Self::set_pose), the results of the
    /// last step still belong to the previous pose.
    #[must_use]
    pub fn pose(&self, id: BodyId) -> Option<&Isometry3<f64>> {
        Some(&self.bodies.poses[self.bodies.index_of(id).ok()?])
    }

    /// Returns the geometry of a body.
    #[must_use]
    pub fn geometry(&self, id: BodyId) -> Option<&Geometry> {
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
    /// Returns an error if the id is stale.
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

    /// Returns the changes of the last step, in ascending order of the two bodies. Changes of one
    /// pair are in the order of [`Change`].
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
