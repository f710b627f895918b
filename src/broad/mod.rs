//! Which boxes overlap: a broad phase on boxes and ids alone, usable without the rest of the crate.
//!
//! ```
//! use lin_canny::broad::{Aabb, Body, BroadPhase, PencilSweep};
//! use nalgebra::{Point3, Vector3};
//!
//! let cube = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), Vector3::repeat(0.5));
//! let mut broad = PencilSweep::new();
//! let a = broad.insert(&cube(0.0), Body::moving())?;
//! let b = broad.insert(&cube(3.0), Body::moving())?;
//! assert!(broad.step().began.is_empty());
//!
//! broad.set_box(b, &cube(1.0))?; // touching boxes are a pair
//! let events = broad.step();
//! assert_eq!((events.began[0].a, events.began[0].b), (a, b));
//! # Ok::<(), lin_canny::broad::BroadPhaseError>(())
//! ```
//!
//! Calls between two steps are gathered: [`insert`](BroadPhase::insert), [`remove`](BroadPhase::remove),
//! [`set_box`](BroadPhase::set_box) (moves and teleports alike). [`step`](BroadPhase::step) takes them over at once and
//! tells which pairs began and ended. [`pairs`](BroadPhase::pairs) and all queries speak of the last step.
//!
//! # Which structure
//!
//! | | [`PencilSweep`] | [`SortedAxes`] |
//! |---|---|---|
//! | idea | columns along one axis, each swept | Baraff's and Lin's three sorted axes |
//! | a step, all moving, constant density | about linear in n | grows as n^(5/3) |
//! | a step, few moving | what moved | all endpoints are looked at |
//! | use it | always | to read, and to check the other |
//!
//! Both give the same pairs, the same events in the same order and the same [`PairId`]s on the same calls.
//!
//! # Promises
//!
//! - The pairs are exactly those of all pairs of stored boxes ([`BroadPhase::stored_box`]), less what groups, filters
//!   and fixedness rule out. Boxes are closed: touching is overlapping.
//! - Stored boxes hold the given ones ([`StoredBox`]; beyond 1e38 they are clamped), so no pair of given boxes is
//!   missed.
//! - A refused call changes nothing and names the body. Nothing panics. Far boxes are right, only slower. What finds no
//!   place, beyond 2^31 - 1 bodies or 2^32 - 1 pairs, is refused as well ([`BroadPhaseError`]).
//! - Memory grows with bodies and overlapping pairs.
//!
//! Reading order: [`Aabb`] and [`StoredBox`], the table of bodies, `change` (what is looked for), `pairs`,
//! [`SortedAxes`], then `grid` and [`PencilSweep`].

mod aabb;
mod body;
mod bounds;
mod change;
mod check;
mod compact_vec;
mod error;
mod grid;
#[cfg(test)]
mod limits;
mod options;
mod pairs;
mod parallel;
mod pencil;
mod prefetch;
#[cfg(feature = "serde")]
mod snapshot;
mod sorted_axes;
mod state;

use alloc::string::String;
use alloc::vec::Vec;

pub use aabb::{Aabb, BoxFault, StoredBox};
use body::Bodies;
pub use body::BodyId;
pub use error::{BatchError, BroadPhaseError};
pub use options::{Body, Groups, Settings};
pub use pairs::{Events, Pair, PairId};
use parallel::Threads;
pub use pencil::{Pencil, PencilSweep};
pub use sorted_axes::SortedAxes;
pub use state::Nearest;
use state::{BroadPhaseState, HasState};

/// A broad phase. The two implementations differ in cost only.
#[doc(alias = "sap")]
#[doc(alias = "bvh")]
pub trait BroadPhase: HasState {
    /// Takes over all calls since the last step and tells which pairs began and ended. `filter` is asked once for
    /// each pair whose boxes begin to overlap and whose groups meet; a pair it refuses is asked again only after the
    /// boxes parted or after [`regroup`](Self::regroup).
    fn step_with(&mut self, filter: &mut dyn FnMut(BodyId, BodyId) -> bool) -> Events<'_>;

    /// Bodies whose boxes overlapped `aabb` in the last step, appended in ascending order.
    ///
    /// # Errors
    /// When a bound of the box is NaN or the box is inverted. It may be infinite.
    fn overlapping(&self, aabb: &Aabb, found: &mut Vec<BodyId>) -> Result<(), BroadPhaseError> {
        let asked = self.state().asked(aabb)?;
        self.overlapping_stored(&asked, found);
        Ok(())
    }

    /// [`step_with`](Self::step_with) a filter that lets every pair pass.
    fn step(&mut self) -> Events<'_> {
        self.step_with(&mut |_, _| true)
    }

    /// Adds a body; its pairs begin with the next step.
    ///
    /// # Errors
    /// When the box, a margin or the origin of the structure is unusable, or there are too many bodies.
    fn insert(&mut self, aabb: &Aabb, body: Body) -> Result<BodyId, BroadPhaseError> {
        self.state_mut().insert(aabb, body, false)
    }

    /// Adds a body whose box may reach to infinity: a half-space, the ground, a world-wide sensor. It is compared with
    /// every body that moves, so keep these few. Margins do not apply.
    ///
    /// # Errors
    /// When a bound is NaN, the box is inverted, the origin of the structure is unusable, or there are too many bodies.
    fn insert_unbounded(&mut self, aabb: &Aabb, body: Body) -> Result<BodyId, BroadPhaseError> {
        self.state_mut().insert(
            aabb,
            Body {
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
    /// When the id is stale.
    fn remove(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.remove(id)
    }

    /// Moves a body, however far.
    ///
    /// # Errors
    /// When the id is stale or the box unusable; the body keeps its box and its pairs.
    #[doc(alias = "teleport")]
    fn set_box(&mut self, id: BodyId, aabb: &Aabb) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.set_box(id, aabb)
    }

    /// Moves many bodies. Every sound entry is applied, whatever becomes of the others. Fastest when the entries are
    /// in ascending order of their ids.
    ///
    /// # Errors
    /// When any entry was refused: which was the first, why, and how many there were.
    fn set_boxes(&mut self, batch: &[(BodyId, Aabb)]) -> Result<(), BatchError> {
        self.state_mut().bodies.set_boxes(batch, Threads::ONE)
    }

    /// Puts a body into other groups and asks all its pairs again in the next step.
    ///
    /// # Errors
    /// When the id is stale.
    fn set_groups(&mut self, id: BodyId, groups: Groups) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.set_groups(id, Some(groups))
    }

    /// Asks groups and filter again for all pairs of a body in the next step.
    ///
    /// # Errors
    /// When the id is stale.
    fn regroup(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        self.state_mut().bodies.set_groups(id, None)
    }

    /// Number of bodies.
    fn body_count(&self) -> usize {
        self.state().bodies.len()
    }

    /// All bodies in ascending order.
    fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.state().bodies.ids()
    }

    /// Whether the id names a body.
    fn contains(&self, id: BodyId) -> bool {
        self.state().bodies.index_of(id).is_ok()
    }

    /// The options of a body; margins as they are kept, in `f32`.
    fn body(&self, id: BodyId) -> Option<Body> {
        let bodies = &self.state().bodies;
        bodies.index_of(id).ok().map(|_| bodies.body(id.index))
    }

    /// The box of a body as the next step will see it, margins included.
    fn stored_box(&self, id: BodyId) -> Option<StoredBox> {
        let bodies = &self.state().bodies;
        let record = &bodies.records[bodies.index_of(id).ok()?];
        Some(record.now().to_box().rotated(3 - bodies.grid.axis))
    }

    /// The pairs of the last step, in the order of their slots.
    fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let BroadPhaseState { bodies, pairs, .. } = self.state();
        pairs.iter(bodies)
    }

    /// Number of pairs of the last step.
    fn pair_count(&self) -> usize {
        self.state().pairs.len()
    }

    /// The pair of two bodies, in either order, if there is one.
    fn pair(&self, a: BodyId, b: BodyId) -> Option<Pair> {
        self.state().pair(a, b)
    }

    /// The pair of this name, if it has not ended.
    fn pair_of(&self, id: PairId) -> Option<Pair> {
        self.state().pair_of(id)
    }

    /// The pairs of one member of any group of `these` with one member of any group of `those`.
    fn pairs_between(&self, these: u32, those: u32) -> impl Iterator<Item = Pair> + '_ {
        let bodies = &self.state().bodies;
        self.pairs().filter(move |pair| {
            let [a, b] = [pair.a, pair.b].map(|id| bodies.body(id.index).groups.member_of);
            (a & these != 0 && b & those != 0) || (b & these != 0 && a & those != 0)
        })
    }

    /// At most `count` bodies whose boxes are nearest to `aabb` and no farther than `farthest`, nearest first, ties in
    /// ascending order of ids. Distances are between stored boxes, 0 when they overlap.
    ///
    /// # Errors
    /// When a bound of the box is NaN or infinite, or the box is inverted.
    fn nearest(&self, aabb: &Aabb, count: usize, farthest: f64) -> Result<Vec<Nearest>, BroadPhaseError> {
        state::nearest(self, aabb, count, farthest)
    }

    /// Bytes reserved for bodies and pairs, by the structure itself and for scratch.
    fn bytes(&self) -> usize;

    /// The first contradiction between lists, bodies and pairs, if there is one: what tests and fuzzing ask after each step.
    /// It looks at everything, so it costs far more than a step.
    ///
    /// # Errors
    /// What contradicts what. It is a defect of the crate, whatever was called.
    #[doc(hidden)]
    fn check(&self) -> Result<(), String>;
}
