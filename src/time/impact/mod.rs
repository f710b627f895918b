//! Time of impact: when two moving shapes first meet, between two proven bounds.
//!
//! A cast returns a bracket, never an estimate. The shapes are separated at every time up to
//! `safe`, and they meet at `hit`. A miss is proven for every time of the interval. An undecided
//! result says why: [`Impact::Incomplete`] or [`Impact::Undecided`].
//!
//! ```
//! use lin_canny::impact::{self, Impact, Tolerance};
//! use lin_canny::motion::Steady;
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::{Tracker, Velocity, polyhedron::solids};
//!
//! let a = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
//! let b = solids::octahedron(0.5)?;
//! let rest = Steady::new(&Isometry3::identity(), Velocity::default())?;
//! let spin = Velocity::new(-Vector3::x(), Vector3::x() * 0.3);
//! let flight = Steady::new(&Isometry3::translation(4.0, 0.0, 0.0), spin)?;
//!
//! let mut tracker = Tracker::new();
//! let mut pair = tracker.pair(&a, &b);
//! let tolerance = Tolerance::Distance(1e-9);
//! let cast = impact::cast(&mut pair, &rest, &flight, 0.0..10.0, tolerance)?;
//! let Impact::Hit { safe, hit, .. } = cast.impact else { panic!("they meet") };
//! assert!(safe < 3.0 && 3.0 < hit && hit - safe < 3e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Method
//!
//! 1. **Balls**: the cast measures no shape while the balls around the pivots are separated. Most
//!    misses end here.
//! 2. **Planes**: each step measures the pair and bounds how long a plane that rotates with the
//!    closest features separates the shapes ([`separation`](crate::separation)). The next step
//!    starts at the end of this time. Steps converge quadratically: two to six for a hit, at any
//!    tolerance. While contact is far and the shapes approach each other faster than they rotate,
//!    the plane keeps its normal instead. This proves most of the same time without support points.
//! 3. **Proof**: steps aim at a gap of a fraction of the tolerance, never at contact itself,
//!    because a query at contact takes ten times as long. From the gap, the cast steps over contact
//!    to an equal depth and proves the overlap by one predicate.
//! 4. **Grazing**: a grazing pair is measured with ever smaller tolerances until a hit or a miss is
//!    proven, or rounding ends the cast as [`Impact::Undecided`].
//!
//! # Guarantees
//!
//! *Separated* is proven for the motions themselves, over the reals, and for the poses that
//! [`Motion::pose`] returns at any f64 of the interval up to `safe`. *Meet* is proven for the poses
//! returned at `hit`.
//!
//! # When not to cast
//!
//! - **Velocities that change at every step for unknown reasons** (contact solvers, input): use a
//!   distance and a displacement budget ([`scene`](crate::scene)).
//! - **Resting contacts**: a resting contact is a hit at once, at every step. Leave it to the
//!   solver. To prove that a body leaves a contact or slides along it, use
//!   [`PairTracker::cast_from_contact`](crate::PairTracker::cast_from_contact).
//! - **Hundreds of revolutions in one interval**: such bodies need a step for every fraction of a
//!   revolution. Use swept balls or shorter intervals.
//!
//! # Sources
//!
//! Mirtich 1996 (conservative advancement); Catto's and Gregorius's planes attached to features
//! (GDC 2013); Schwarzer, Saha and Latombe 2005 (proofs over an interval). Departures:
//!
//! 1. Bounds hold for a rotating plane over all points at once, not for a speed: convergence is
//!    quadratic instead of linear.
//! 2. The upper end of the bracket is proven as well.
//! 3. If a limit is reached, the cast ends as `Incomplete` or `Undecided` with the proven time,
//!    never as a miss.
//! 4. The rounding of motions, poses and planes is included in every bound.

mod cast;
mod certificate;

use alloc::vec::Vec;
use core::ops::Range;

use crate::base::motion::Motion;
use crate::base::pose::PoseError;
use crate::pair::outcome::ContactState;
use crate::time::separation::{Measurement, Separation};

use cast::CastSearch;
#[cfg(feature = "__internals")]
#[doc(hidden)]
pub use certificate::overlapping_until;
pub use certificate::{Certificate, free_until};

/// Largest width of the bracket of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Tolerance {
    /// The shapes are nearer than this at `safe`, and overlap by about a third of this at `hit`, in
    /// the caller's unit of length.
    Distance(f64),
    /// `hit - safe` is at most this, unless rounding or a grazing motion makes the bracket wider.
    Time(f64),
}

/// The result of a cast.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Impact {
    /// The shapes touch, overlap, or are within the requested distance at the start of the
    /// interval.
    AtStart {
        /// The measurement at the start, without the depth of an overlap.
        seen: Measurement,
    },
    /// The first contact is after `safe` and at the latest at `hit`.
    Hit {
        /// The shapes are proven separated up to this time.
        safe: f64,
        /// The shapes are proven to meet at this time.
        hit: f64,
        /// Features, witnesses and normal at `safe`: the features that will meet.
        seen: Measurement,
    },
    /// The shapes come so near that rounding hides whether they meet; nothing is known about later
    /// times.
    ///
    /// Also returned if the shapes are seen to meet at `safe`, which happens only if a [`Motion`]
    /// breaks its contract.
    Undecided {
        /// The shapes are proven separated up to this time.
        safe: f64,
        /// Upper bound of the distance at `safe`.
        distance: f64,
    },
    /// The shapes are proven separated over the whole interval, both ends included.
    Miss,
    /// The cast ended early; nothing is known about later times.
    ///
    /// Returned in three cases:
    ///
    /// - The cast reached the limit of 20,000 steps, repetitions with a smaller tolerance included
    ///   (for example, for some grazing motions).
    /// - After 1,024 steps or more, the pace was less than a fiftieth of the pace that the limit
    ///   needs (for example, for bodies that rotate by 1e15 radians).
    /// - A motion returned a [`MotionModel`](crate::motion::MotionModel) that is not finite or has
    ///   a negative bound.
    Incomplete {
        /// The shapes are proven separated up to this time.
        safe: f64,
    },
}

/// The result of a cast, and its work.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Cast {
    /// The result.
    pub impact: Impact,
    /// Number of distance queries.
    pub queries: u32,
    /// Number of predicates that proved, or failed to prove, that the shapes meet.
    pub proofs: u32,
    /// The contact at the start that the cast accepted
    /// ([`CastOptions::start_contact_margin`]).
    #[cfg_attr(feature = "serde", serde(default))]
    pub start_contact: Option<StartContact>,
}

/// Options of [`PairTracker::cast_from_contact`](crate::PairTracker::cast_from_contact).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CastOptions {
    /// Largest width of the bracket of a hit. The default is `Distance(0.0)`: as narrow as rounding
    /// allows.
    pub tolerance: Tolerance,
    /// The distance that the bodies must keep, in the caller's unit. The default is 0.
    pub distance: f64,
    /// The largest distance, or depth of an overlap, of a contact at the start that the cast
    /// accepts, in the caller's unit. The default is `None`: the cast accepts no contact.
    pub start_contact_margin: Option<f64>,
}

impl Default for CastOptions {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::Distance(0.0),
            distance: 0.0,
            start_contact_margin: None,
        }
    }
}

impl CastOptions {
    /// Sets the largest width of the bracket of a hit.
    #[must_use]
    pub fn tolerance(mut self, tolerance: Tolerance) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Sets the distance that the bodies must keep.
    #[must_use]
    pub fn distance(mut self, distance: f64) -> Self {
        self.distance = distance;
        self
    }

    /// Accepts a contact at the start of at most this distance, or of at most this depth.
    #[must_use]
    pub fn start_contact_margin(mut self, margin: f64) -> Self {
        self.start_contact_margin = Some(margin);
        self
    }

    /// Rejects a number that is negative or not finite.
    pub(crate) fn check(&self) -> Result<(), ImpactError> {
        let (Tolerance::Distance(size) | Tolerance::Time(size)) = self.tolerance;
        let margin = self.start_contact_margin.unwrap_or(0.0);
        let all = [
            ("tolerance", size),
            ("distance", self.distance),
            ("start contact margin", margin),
        ];
        for (what, value) in all {
            if !(0.0..f64::INFINITY).contains(&value) {
                return Err(ImpactError::Size { what, value });
            }
        }
        Ok(())
    }
}

/// A contact at the start of a cast that the bodies may leave, or along which they may slide.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StartContact {
    /// Proven lower bound of the signed distance at the start.
    pub distance: f64,
    /// The signed distance that the bodies are proven to keep from the start until
    /// [`until`](Self::until): [`distance`](Self::distance) minus `2^-30` of the pair size.
    pub kept: f64,
    /// The time at which the bodies have left the margin; from then on they keep the distance of
    /// the cast. `None` if they are within the margin at each of 64 times evenly spaced over the
    /// interval.
    pub until: Option<f64>,
}

/// Error of a cast.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImpactError {
    /// The interval ends before its start, or is not finite.
    #[error("invalid time interval {from}..{until}: not finite, or the end is before the start")]
    Interval {
        /// The start.
        from: f64,
        /// The end.
        until: f64,
    },
    /// A tolerance or a distance is negative or not finite.
    #[error("{what} is out of range: {value} (expected a number that is not negative)")]
    Size {
        /// The name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// The mesh at the end of a frame has other triangles, or another tree, than at the start.
    #[error("the mesh at the end of the frame has other triangles than the mesh at the start")]
    Mesh,
    /// A motion left the range of poses.
    #[error(transparent)]
    Pose(#[from] PoseError),
}

/// Returns the time at which two shapes first meet in an interval, as a bracket.
///
/// The interval contains both ends. If the ends are equal, it is a single instant.
///
/// The bracket of a hit is at most as wide as the tolerance. The cost hardly depends on the
/// tolerance: down to about 1e-13 of the pair size, each decade costs a fraction of a step.
///
/// A cast takes at most 20,000 steps. If it needs more, it ends as [`Impact::Incomplete`] with the
/// proven time. Most casts take fewer than 21 steps. Grazing bodies take hundreds or thousands, and
/// more the closer they pass.
///
/// # Errors
/// Returns an error if the interval ends before its start, the tolerance is negative or not finite,
/// or a motion leaves the range of poses.
#[doc(alias = "toi")]
#[doc(alias = "ccd")]
#[doc(alias = "time of impact")]
#[doc(alias = "cast_shapes")]
#[doc(alias = "continuous")]
pub fn cast<S, A, B>(
    pair: &mut S,
    motion_a: &A,
    motion_b: &B,
    interval: Range<f64>,
    tolerance: Tolerance,
) -> Result<Cast, ImpactError>
where
    S: Separation + ?Sized,
    A: Motion + ?Sized,
    B: Motion + ?Sized,
{
    cast_within(pair, motion_a, motion_b, interval, tolerance, 0.0)
}

/// Returns when two shapes first come within a distance of each other, as a bracket.
///
/// At distance 0 this is [`cast`], bit for bit. At a positive distance, *meet* in an [`Impact`]
/// means to be at most the distance apart, and *separated* to be farther apart.
///
/// # Errors
/// Returns an error if the interval ends before its start, the tolerance or the distance is
/// negative or not finite, or a motion leaves the range of poses.
#[doc(alias = "impact_within")]
pub fn cast_within<S, A, B>(
    pair: &mut S,
    motion_a: &A,
    motion_b: &B,
    interval: Range<f64>,
    tolerance: Tolerance,
    distance: f64,
) -> Result<Cast, ImpactError>
where
    S: Separation + ?Sized,
    A: Motion + ?Sized,
    B: Motion + ?Sized,
{
    search(pair, motion_a, motion_b, interval, tolerance, distance, None)
}

/// Casts like [`cast_within`], and appends one certificate per step.
///
/// The certificates cover the time that is proven free, in order.
///
/// # Errors
/// Returns an error in the same cases as [`cast_within`].
pub fn cast_with_certificates<S, A, B>(
    pair: &mut S,
    motion_a: &A,
    motion_b: &B,
    interval: Range<f64>,
    tolerance: Tolerance,
    distance: f64,
    certificates: &mut Vec<Certificate>,
) -> Result<Cast, ImpactError>
where
    S: Separation + ?Sized,
    A: Motion + ?Sized,
    B: Motion + ?Sized,
{
    search(
        pair,
        motion_a,
        motion_b,
        interval,
        tolerance,
        distance,
        Some(certificates),
    )
}

/// Casts within a distance, and appends the certificate of every step to a trail.
fn search<S, A, B>(
    pair: &mut S,
    motion_a: &A,
    motion_b: &B,
    interval: Range<f64>,
    tolerance: Tolerance,
    distance: f64,
    trail: Option<&mut Vec<Certificate>>,
) -> Result<Cast, ImpactError>
where
    S: Separation + ?Sized,
    A: Motion + ?Sized,
    B: Motion + ?Sized,
{
    check(&interval)?;
    CastOptions::default().tolerance(tolerance).distance(distance).check()?;
    let mut search = CastSearch {
        pair,
        motion_a,
        motion_b,
        until: interval.end,
        tolerance,
        distance,
        seen: None,
        queries: 0,
        proofs: 0,
        trail,
    };
    let impact = search.run(interval.start)?;
    Ok(Cast {
        impact,
        queries: search.queries,
        proofs: search.proofs,
        start_contact: None,
    })
}

/// The result of a look-ahead.
pub(crate) struct Ahead {
    /// The time until which the shapes are proven to stay beyond the requested distance.
    pub(crate) until: f64,
    /// By distance, the result of the cast of the tick; none if the look-ahead proves the tick.
    pub(crate) casts: [Option<Impact>; 2],
    /// Distance queries and predicates.
    pub(crate) queries: u32,
}

/// Bounds from time zero over a `span` how long the shapes stay more than `distance` apart.
///
/// If this time is shorter than a `tick`, casts the tick from the same measurement, for each of the
/// distances and tolerances `asked`, none of which is above `distance`.
///
/// # Errors
/// Returns an error if a motion leaves the range of poses.
pub(crate) fn ahead<S, M>(
    pair: &mut S,
    [motion_a, motion_b]: [&M; 2],
    tick: f64,
    span: f64,
    distance: f64,
    asked: &[Option<(f64, Tolerance)>; 2],
) -> Result<Ahead, PoseError>
where
    S: Separation + ?Sized,
    M: Motion + ?Sized,
{
    let (relative, flight) = cast::flight(motion_a, motion_b, 0.0, span, distance)?;
    let until = |free: f64| {
        if free >= flight.span {
            span
        } else {
            cast::later(0.0, free)
        }
    };
    let proven = |until: f64, queries: u32| Ahead {
        until,
        casts: [None; 2],
        queries,
    };
    let is_known = flight.is_known();
    let by_balls = if is_known { until(flight.apart(pair).span) } else { 0.0 };
    if by_balls >= tick {
        return Ok(proven(by_balls, 0));
    }
    let seen = pair.measure(&relative);
    if is_known && seen.state == ContactState::Separated && seen.lower > distance {
        let by_plane = until(pair.free_for(&seen, &flight).span);
        if by_plane >= tick {
            return Ok(proven(by_plane, 1));
        }
    }
    let mut ahead = proven(0.0, 1);
    for (cast, asked) in ahead.casts.iter_mut().zip(asked) {
        let Some((distance, tolerance)) = *asked else { continue };
        let mut search = CastSearch {
            pair: &mut *pair,
            motion_a,
            motion_b,
            until: tick,
            tolerance,
            distance,
            seen: Some(seen),
            queries: 0,
            proofs: 0,
            trail: None,
        };
        *cast = Some(search.run(0.0)?);
        ahead.queries += search.queries + search.proofs;
    }
    Ok(ahead)
}

/// Rejects an interval that ends before its start or is not finite.
pub(crate) fn check(interval: &Range<f64>) -> Result<(), ImpactError> {
    let (from, until) = (interval.start, interval.end);
    if from <= until && (until - from) < f64::INFINITY {
        Ok(())
    } else {
        Err(ImpactError::Interval { from, until })
    }
}
