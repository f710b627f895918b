//! Many moving bodies: the broad phase finds overlapping boxes, one tracker follows each pair of
//! overlapping boxes, and a step computes only the effects called for.
//!
//! ```
//! use std::sync::Arc;
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//! use lin_canny::scene::{Body, Change, Effects, Group, Scene};
//!
//! const CELL: Group = Group::new(1).unwrap();
//! const ROBOT: Group = Group::new(2).unwrap();
//!
//! // Shared by all bodies of this shape.
//! let block = Arc::new(solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?);
//! let mut scene = Scene::new();
//! scene.call_for(ROBOT, CELL, Effects::none().within(0.05))?;
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
//! [`call_for`](Scene::call_for) gather changes; [`step`](Scene::step) applies the changes:
//!
//! 1. **boxes** of the bodies that moved, grown by half of the distances called for;
//! 2. **pairs** of boxes: a new pair gets a tracker if more than boxes is called for, an ended pair
//!    gives the tracker back;
//! 3. **look**: the narrow phase of each called pair, unless a cheaper test answers (bodies at
//!    rest, the displacement budget, two balls); then the tracker, with the depth of an overlap and
//!    contact points only if called for;
//! 4. **events** in a fixed order.
//!
//! [`pairs`](Scene::pairs), [`pairs_of`](Scene::pairs_of) a body and [`events`](Scene::events)
//! return the results, [`report`](Scene::report) returns the cost. Further queries that a step does
//! not answer: [`closest_pair`](Scene::closest_pair) of two groups,
//! [`pairs_within`](Scene::pairs_within), [`nearest`](Scene::nearest),
//! [`first_contact`](Scene::first_contact).
//!
//! # The nearest pair of a robot and its cell
//!
//! | when | how | microseconds a cycle |
//! |---|---|---:|
//! | every cycle, a range is known | effect `distance` up to the range, least of [`pairs`](Scene::pairs) | 4 to 7 |
//! | now and then, or no range is known | [`closest_pair`](Scene::closest_pair) with effect `boxes`; keeps no features between calls | 13 to 21 |
//! | few pairs, always the same | a [`Tracker`](crate::Tracker) for each | 17 to 31 |
//! | distances of all pairs | effect `distance` with the range infinity | 30 to 45 |
//!
//! The figures are medians of an arm of seven links among thirty boxes, itself included, 195 pairs,
//! at a range of 0.2 m; the bodies move at 1 kHz.
//!
//! A distance is called for up to a range, and the least distance that a step found is the
//! clearance. The answer for a pair is in the frames of the two bodies, as in
//! [`Outcome`](crate::Outcome); the poses of the bodies lead to the world.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//! use lin_canny::scene::{Body, Effects, Group, Scene};
//!
//! const CELL: Group = Group::new(1).unwrap();
//! const ROBOT: Group = Group::new(2).unwrap();
//!
//! let mut scene = Scene::new();
//! let none = Effects::none();
//! let effects =
//!     none.distance(0.5).features(true).depth(true);
//! scene.call_for(ROBOT, CELL, effects)?;
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
//! [`Effects`] is the price list. A pair with only events of overlaps or of `within` is tested when
//! the bodies may have used up the distance between them, and not before: see [`budget`] for the
//! rule and the proof. A distance called for is computed whenever a body of the pair has moved. A
//! step without changes does nothing.
//!
//! # Promises
//!
//! * Events and predicates are exact (feature `exact`) for the poses given: equal to brute force
//!   over all pairs on every frame, with the budget or without. Distances have the bounds of
//!   [`Tracker::closest`](crate::Tracker::closest).
//! * Dropping an effect never raises a counter of the narrow phase on the scenes tested; an effect
//!   not called for is counted as exactly zero, and takes no memory.
//! * Equal calls give equal answers, events and counts bit for bit, with any number of threads
//!   (feature `parallel`), and after a scene was written and read back (feature `serde`; only
//!   [`Counts::swaps`], the work of sorted lists that are rebuilt then, may differ). Trackers of
//!   composites and meshes are not written: distances of such a pair then agree within the bounds.
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
//! then sleep until the proof of their separation ends, and with the effect `impact` a step finds
//! the [`impacts`](Scene::impacts) within the tick in the order of time.
//!
//! Source: Cohen, Lin, Manocha and Ponamgi 1995 (I-COLLIDE) join sweep and prune with one tracker a
//! pair; Lin 1993 (section 5.4) asks that a simulation pay only for the effects called for.
//! Departures: pairs are kept in one table per level of detail; the wake-up is bounded by
//! displacement instead of by time.

// First, so that the documentation of `Scene` begins with `new` and `insert`.
mod calls;

mod ahead;
mod answer;
mod ball;
mod body;
pub mod budget;
mod check;
mod closest;
mod effects;
mod error;
mod events;
mod filter;
mod kinds;
mod moving;
mod narrow_phase;
mod pair_engine;
mod pair_table;
#[cfg(feature = "parallel")]
mod parallel;
#[cfg(feature = "meshes")]
mod patches;
mod ray;
mod report;
mod search;
#[cfg(feature = "serde")]
mod snapshot;
mod step;
mod stored_answer;
mod velocity;
#[cfg(feature = "meshes")]
mod vertices;

use alloc::vec::Vec;

use crate::broad::{self, PencilSweep};
use crate::convex::tracker::Workspace;

pub use crate::broad::{BodyId, PairId, Settings};
pub use answer::PairAnswer;
pub use body::Body;
use body::BodyTable;
pub use effects::{Effects, Group};
use effects::{GROUPS, Table};
pub use error::SceneError;
pub use events::{Change, Event, PairImpact};
use filter::Ignored;
use kinds::Census;
use pair_table::PairTables;
pub use report::{Bytes, Counts, Report, Times};
pub use search::ClosestPair;

/// Bodies, the effects called for, and the results of the last step. See the [module page](self).
#[doc(alias = "world")]
#[doc(alias = "collision detection")]
#[doc(alias = "i-collide")]
#[derive(Clone)]
pub struct Scene {
    bodies: BodyTable,
    census: Census,
    table: Table,
    broad: PencilSweep,
    pair_tables: PairTables,
    ignored: Ignored,
    events: Vec<Event>,
    impacts: Vec<PairImpact>,
    report: Report,
    /// Groups whose effects changed since the last step, as bits.
    replanned: u32,
    /// Whether bodies were inserted, removed or moved to another group since the last step.
    changed: bool,
    /// By group, as of the last step that applied changed effects: the growth of the boxes, and the
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
