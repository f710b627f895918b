//! Broad phase: finds overlapping boxes from boxes and ids alone, usable without the rest of the
//! crate.
//!
//! ```
//! use lin_canny::broad::{Aabb, BodyOptions, BroadPhase, PencilSweep};
//! use lin_canny::nalgebra::{Point3, Vector3};
//!
//! let half = Vector3::repeat(0.5);
//! let cube = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), half);
//! let mut broad = PencilSweep::new();
//! let a = broad.insert(&cube(0.0), BodyOptions::moving())?;
//! let b = broad.insert(&cube(3.0), BodyOptions::moving())?;
//! assert!(broad.step().began.is_empty());
//!
//! broad.set_box(b, &cube(1.0))?; // touching boxes are a pair
//! let events = broad.step();
//! assert_eq!((events.began[0].a, events.began[0].b), (a, b));
//! # Ok::<(), lin_canny::broad::BroadPhaseError>(())
//! ```
//!
//! Calls between two steps are gathered: [`insert`](BroadPhase::insert),
//! [`remove`](BroadPhase::remove), [`set_box`](BroadPhase::set_box) (moves and teleports alike).
//! [`step`](BroadPhase::step) applies all calls at once and returns the pairs that began and ended.
//! [`pairs`](BroadPhase::pairs) and all queries describe the last step.
//!
//! # Which structure
//!
//! | | [`PencilSweep`] | [`SortedAxes`] |
//! |---|---|---|
//! | idea | columns along one axis, each swept | Baraff's and Lin's three sorted axes |
//! | a step, all moving, constant density | about linear in n | grows as n^(5/3) |
//! | a step, few moving | reads the moved boxes | reads all endpoints |
//! | use | always | as reference, and to check `PencilSweep` |
//!
//! Both return equal pairs, equal events in equal order and equal [`PairId`]s for equal calls.
//!
//! # Promises
//!
//! - The pairs are exactly the overlapping pairs among all pairs of stored boxes
//!   ([`BroadPhase::stored_box`]), less the pairs that groups, filters and fixedness rule out.
//!   Boxes are closed: touching is overlapping.
//! - Stored boxes contain the given boxes ([`StoredBox`]; beyond 1e38 bounds are clamped), so no
//!   pair of given boxes is missed.
//! - A refused call changes nothing and names the body. Nothing panics. Far boxes are handled
//!   correctly, only slower. Bodies beyond 2^31 - 1 and pairs beyond 2^32 - 1 are refused as well
//!   ([`BroadPhaseError`]).
//! - Memory grows with bodies and overlapping pairs.
//!
//! Reading order: [`Aabb`] and [`StoredBox`], the table of bodies, `change` (the changes of a
//! step), `pairs`, [`SortedAxes`], then `grid` and [`PencilSweep`].

mod aabb;
mod body;
mod bounds;
mod change;
mod error;
mod grid;
#[cfg(test)]
mod limits;
mod options;
mod pairs;
mod parallel;
mod pencil;
pub(crate) mod slots;
#[cfg(feature = "serde")]
mod snapshot;
mod sorted_axes;
mod state;
mod tables;

use alloc::string::String;
use alloc::vec::Vec;

pub use aabb::{Aabb, BoxFault, StoredBox};
use body::Bodies;
pub use body::BodyId;
pub use error::{BatchError, BroadPhaseError};
pub use options::{BodyOptions, Groups, Settings};
pub use pairs::{Events, Pair, PairId};
use parallel::Threads;
pub use pencil::{Pencil, PencilSweep};
pub use sorted_axes::SortedAxes;
pub use state::Nearest;
use state::{BroadPhaseState, HasState};

/// A broad phase: finds overlapping boxes. The two implementations differ in cost only.
#[doc(alias = "sap")]
#[doc(alias = "bvh")]
pub trait BroadPhase: HasState {
    /// Applies all calls since the last step and returns the pairs that began and ended. `filter`
    /// is called once for each pair whose boxes begin to overlap and whose groups match; a pair
    /// refused by the filter is tried again only after the boxes parted or after
    /// [`regroup`](Self::regroup).
    fn step_with(&mut self, filter: &mut dyn FnMut(BodyId, BodyId) -> bool) -> Events<'_>;

    /// Appends the bodies whose boxes overlapped `aabb` in the last step, in ascending order.
    ///
    /// # Errors
    /// If a bound of the box is NaN or the box is inverted. The box may be infinite.
    fn overlapping(&self, aabb: &Aabb, found: &mut Vec<BodyId>) -> Result<(), BroadPhaseError> {
        let asked = self.state().asked(aabb)?;
        self.overlapping_stored(&asked, found);
        Ok(())
    }

    /// Calls [`step_with`](Self::step_with) with a filter that lets every pair pass.
    fn step(&mut self) -> Events<'_> {
        self.step_with(&mut |_, _| true)
    }

    /// Adds a body; its pairs begin with the next step.
    ///
    /// # Errors
    /// If the box, a margin or the origin of the structure is unusable, or there are too many
    /// bodies.
    fn insert(&mut self, aabb: &Aabb, body: BodyOptions) -> Result<BodyId, BroadPhaseError> {
        self.state_mut().insert(aabb, body, false)
    }

    /// Adds a body whose box may reach to infinity: a half-space, the ground, a world-wide sensor.
    /// An unbounded body is compared with every body that moves, so keep unbounded bodies few.
    /// Margins do not apply.
    ///
    /// # Errors
    /// If a bound is NaN, the box is inverted, the origin of the structure is unusable, or there
    /// are too many bodies.
    fn insert_unbounded(&mut self, aabb: &Aabb, body: BodyOptions) -> Result<BodyId, BroadPhaseError> {
        self.state_mut().insert(
            aabb,
            BodyOptions {
                margin: 0.0,
                lookahead: 0.0,
                ..body
            },
            true,
        )
    }

    /// Removes a body: its id is stale at once, its pairs end with the next step.
    ///
    /// # Errors
    /// If the id is stale.
    fn remove(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.remove(id)
    }

    /// Moves a body, however far.
    ///
    /// # Errors
    /// If the id is stale or the box unusable; the body keeps its box and its pairs.
    #[doc(alias = "teleport")]
    fn set_box(&mut self, id: BodyId, aabb: &Aabb) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.set_box(id, aabb)
    }

    /// Moves many bodies. Every valid entry is applied, even if another entry is refused. Fastest
    /// if the entries are in ascending order of their ids.
    ///
    /// # Errors
    /// If any entry was refused: index and fault of the first refused entry, and the number of
    /// refused entries.
    fn set_boxes(&mut self, batch: &[(BodyId, Aabb)]) -> Result<(), BatchError> {
        self.state_mut().bodies.set_boxes(batch, Threads::ONE)
    }

    /// Puts a body into another set of groups; groups and filter are asked again for all its pairs
    /// in the next step.
    ///
    /// # Errors
    /// If the id is stale.
    fn set_groups(&mut self, id: BodyId, groups: Groups) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.set_groups(id, Some(groups))
    }

    /// Asks groups and filter again for all pairs of a body in the next step.
    ///
    /// # Errors
    /// If the id is stale.
    fn regroup(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.set_groups(id, None)
    }

    /// Returns the number of bodies.
    fn body_count(&self) -> usize {
        self.state().bodies.len()
    }

    /// Iterates over all bodies in ascending order.
    fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.state().bodies.ids()
    }

    /// Returns whether the id names a body.
    fn contains(&self, id: BodyId) -> bool {
        self.state().bodies.index_of(id).is_ok()
    }

    /// Returns the options of a body; margins as stored, in `f32`.
    fn body(&self, id: BodyId) -> Option<BodyOptions> {
        let bodies = &self.state().bodies;
        bodies.index_of(id).ok().map(|_| bodies.body(id.index))
    }

    /// Returns the box of a body as the next step will see the box, margins included.
    fn stored_box(&self, id: BodyId) -> Option<StoredBox> {
        let bodies = &self.state().bodies;
        let record = &bodies.records[bodies.index_of(id).ok()?];
        Some(record.now().to_box().rotated(3 - bodies.grid.axis))
    }

    /// Iterates over the pairs of the last step, in the order of their slots.
    fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let BroadPhaseState { bodies, pairs, .. } = self.state();
        pairs.iter(bodies)
    }

    /// Returns the number of pairs of the last step.
    fn pair_count(&self) -> usize {
        self.state().pairs.len()
    }

    /// Returns the pair of two bodies, in either order, if the boxes overlapped in the last step.
    fn pair(&self, a: BodyId, b: BodyId) -> Option<Pair> {
        self.state().pair(a, b)
    }

    /// Returns the pair with this id, if the pair has not ended.
    fn pair_of(&self, id: PairId) -> Option<Pair> {
        self.state().pair_of(id)
    }

    /// Iterates over the pairs of a member of any group of `these` with a member of any group of
    /// `those`.
    fn pairs_between(&self, these: u32, those: u32) -> impl Iterator<Item = Pair> + '_ {
        let bodies = &self.state().bodies;
        self.pairs().filter(move |pair| {
            let [a, b] = [pair.a, pair.b].map(|id| bodies.body(id.index).groups.member_of);
            (a & these != 0 && b & those != 0) || (b & these != 0 && a & those != 0)
        })
    }

    /// Returns at most `count` bodies whose boxes are nearest to `aabb` and no farther than
    /// `farthest`, nearest first, ties in ascending order of ids. Distances are between stored
    /// boxes, 0 if the boxes overlap.
    ///
    /// # Errors
    /// If a bound of the box is NaN or infinite, or the box is inverted.
    fn nearest(&self, aabb: &Aabb, count: usize, farthest: f64) -> Result<Vec<Nearest>, BroadPhaseError> {
        state::nearest(self, aabb, count, farthest)
    }

    /// Returns the bytes reserved for bodies and pairs, by the structure itself and for scratch.
    fn bytes(&self) -> usize;

    /// Returns the first contradiction between lists, bodies and pairs, if any: used by tests and
    /// fuzzing after each step. The check reads everything, so the cost is far more than the cost
    /// of a step.
    ///
    /// # Errors
    /// The contradiction. A contradiction is a defect of the crate, whatever was called.
    #[doc(hidden)]
    fn check(&self) -> Result<(), String>;
}
