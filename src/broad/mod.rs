//! Broad phase: finds overlapping boxes from boxes and ids alone, usable without the rest of the
//! crate.
//!
//! ```
//! use lin_canny::broad::{Aabb, BodyOptions, SweepAndPrune};
//! use lin_canny::nalgebra::{Point3, Vector3};
//!
//! let half = Vector3::repeat(0.5);
//! let cube = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), half);
//! let mut broad = SweepAndPrune::new();
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
//! Calls between two steps are gathered: [`insert`](SweepAndPrune::insert),
//! [`remove`](SweepAndPrune::remove), [`set_box`](SweepAndPrune::set_box) (moves and teleports
//! alike). [`step`](SweepAndPrune::step) applies all calls at once and returns the pairs that began
//! and ended. [`pairs`](SweepAndPrune::pairs) and all queries describe the last step.
//!
//! # The method
//!
//! Sweep and prune (Baraff 1992, thesis, section 2.3; Lin 1993, thesis, section 2.4; Cohen, Lin,
//! Manocha, Ponamgi 1995, I-COLLIDE, section 4): boxes overlap if and only if their intervals
//! overlap on all three axes, and lists of the ends of the intervals, kept sorted from step to
//! step, show which intervals began or ceased to overlap. Departures:
//!
//! 1. One axis is swept instead of three, and the world is cut into columns along this axis. With
//!    three sorted axes the exchanges of a step grow as n^(5/3) at constant density, and on a flat
//!    floor faster; here a step is about linear in the number of boxes that move.
//! 2. Old and new boxes are compared instead of three flags a pair, which would take n^2 bits.
//!
//! # Promises
//!
//! - The pairs are exactly the overlapping pairs among all pairs of stored boxes
//!   ([`SweepAndPrune::stored_box`]), less the pairs that groups, filters and fixedness rule out.
//!   Boxes are closed: touching is overlapping.
//! - Stored boxes contain the given boxes ([`StoredBox`]; beyond 1e38 bounds are clamped), so no
//!   pair of given boxes is missed.
//! - A refused call changes nothing and names the body. Nothing panics. Far boxes are handled
//!   correctly, only slower. Bodies beyond 2^31 - 1 and pairs beyond 2^32 - 1 are refused as well
//!   ([`BroadPhaseError`]).
//! - Memory grows with bodies and overlapping pairs.
//!
//! Reading order: [`Aabb`] and [`StoredBox`], the table of bodies, `change` (the changes of a
//! step), `pairs`, then `grid` and [`SweepAndPrune`].

mod aabb;
mod body;
mod change;
mod error;
mod grid;
#[cfg(test)]
mod limits;
mod options;
mod pairs;
mod parallel;
mod simd_box;
pub(crate) mod slots;
#[cfg(feature = "serde")]
mod snapshot;
mod state;
mod sweep;
mod tables;

pub use aabb::{Aabb, AabbError, StoredBox};
pub use body::BodyId;
pub use error::{BatchError, BroadPhaseError};
pub use options::{BodyOptions, Groups, Settings};
pub use pairs::{Events, Pair, PairId};
pub use state::Nearest;
pub use sweep::{ColumnBounds, SweepAndPrune};
