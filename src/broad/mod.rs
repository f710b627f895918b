//! Broad phase: finds the pairs of overlapping boxes. It needs only boxes and ids, and works
//! without the rest of the crate.
//!
//! ```
//! use lin_canny::broad::{Aabb, BodyOptions, SweepAndPrune};
//! use lin_canny::nalgebra::{Point3, Vector3};
//!
//! let half = Vector3::repeat(0.5);
//! let cube = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), half);
//! let mut broad = SweepAndPrune::new();
//! let a = broad.insert(&cube(0.0), BodyOptions::default())?;
//! let b = broad.insert(&cube(3.0), BodyOptions::default())?;
//! assert!(broad.step().began.is_empty());
//!
//! broad.set_box(b, &cube(1.0))?; // touching boxes are a pair
//! let events = broad.step();
//! assert_eq!((events.began[0].a, events.began[0].b), (a, b));
//! # Ok::<(), lin_canny::broad::BroadPhaseError>(())
//! ```
//!
//! [`insert`](SweepAndPrune::insert), [`remove`](SweepAndPrune::remove) and
//! [`set_box`](SweepAndPrune::set_box) (for small and large moves alike) collect changes.
//! [`step`](SweepAndPrune::step) applies them all and returns the pairs that started and ended.
//! [`pairs`](SweepAndPrune::pairs) and all queries describe the last step.
//!
//! # The method
//!
//! Sweep and prune (Baraff 1992, thesis, section 2.3; Lin 1993, thesis, section 2.4; Cohen, Lin,
//! Manocha, Ponamgi 1995, I-COLLIDE, section 4): boxes overlap if and only if their intervals
//! overlap on all three axes. Lists of the ends of the intervals are kept sorted from step to step,
//! and show which intervals started or stopped overlapping. Departures:
//!
//! 1. One axis is swept instead of three, and the world is divided into columns along this axis.
//!    With three sorted axes the exchanges of a step grow as n^(5/3) at constant density, and
//!    faster on a flat floor. With columns a step is about linear in the number of boxes that move.
//! 2. The method compares old and new boxes. It does not store three flags per pair, which would
//!    take n^2 bits.
//!
//! # Promises
//!
//! - The pairs are exactly the overlapping pairs of stored boxes ([`SweepAndPrune::stored_box`]),
//!   without the pairs that groups, the filter or two fixed bodies exclude. Boxes are closed:
//!   touching boxes overlap.
//! - Stored boxes contain the given boxes ([`StoredBox`]; bounds beyond 1e38 are clamped), so no
//!   pair of given boxes is missed.
//! - A call that returns an error ([`BroadPhaseError`]) changes nothing, and the error names the
//!   body. Nothing panics. Boxes far from the origin are handled correctly, but more slowly. There
//!   are at most 2^31 - 1 bodies and 2^32 - 1 pairs.
//! - Memory grows with the number of bodies and overlapping pairs.
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

pub use aabb::{Aabb, StoredBox};
pub use body::BodyId;
pub use error::{BatchError, BroadPhaseError};
pub use options::{BodyOptions, Groups, Settings};
pub use pairs::{Events, Pair, PairId};
pub use state::Nearest;
pub use sweep::{ColumnBounds, SweepAndPrune};
