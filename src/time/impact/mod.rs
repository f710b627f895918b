//! Time of impact: the instant at which two moving shapes first meet, bounded from both sides.
//!
//! A cast returns a bracket, never an estimate: the shapes are apart at every instant up to `safe`,
//! and meet at `hit`. A miss is proven for every instant of the interval, and an undecided case has
//! a name ([`Impact::Incomplete`], [`Impact::Undecided`]).
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
//! 1. **Balls**: no shape is measured while the balls about the pivots are apart. Most misses end
//!    here.
//! 2. **Planes**: a look measures the pair and bounds the time for which a separating plane that
//!    turns with the closest features stays between the shapes
//!    ([`separation`](crate::separation)); the next look is at the end of this time. Looks converge
//!    quadratically: two to six for a hit, whatever the tolerance. While contact is far and the
//!    shapes approach each other faster than they turn, the plane keeps its normal instead, which
//!    proves most of the same without support points.
//! 3. **Proof**: looks aim at a gap of a part of the tolerance, never at contact itself, since a
//!    query at contact is ten times as slow. From there the cast steps over contact to an equal
//!    depth, and proves the overlap by one predicate.
//! 4. A grazing pair is measured with ever smaller tolerances, until a hit or a miss is proven, or
//!    rounding ends the cast as `Near`.
//!
//! # Guarantees
//!
//! *Apart* is proven of the motions themselves, over the reals, and of the poses that
//! [`Motion::pose`] places at any f64 of the interval up to `safe`. *Meets* is proven of the poses
//! placed at `hit`.
//!
//! # When not to cast
//!
//! A pair whose velocities change at every step for reasons unknown (contact solvers, input) is
//! better served by a distance and a displacement budget ([`scene`](crate::scene)). A resting
//! contact is a hit at once, at every step: leave resting contacts to the solver. Bodies that turn
//! hundreds of times in the interval need a look every part of a turn: swept balls, or shorter
//! intervals, do as well.
//!
//! # Sources
//!
//! Mirtich 1996 (conservative advancement); Catto's and Gregorius's planes attached to features
//! (GDC 2013); Schwarzer, Saha and Latombe 2005 (proofs over an interval). Departures:
//!
//! 1. Bounds are those of a turning plane over all points at once, not of a speed: convergence is
//!    quadratic instead of linear.
//! 2. The upper end of the bracket is proven, too.
//! 3. Limits end as `Unknown` or `Near` with the part proven, never as a miss.
//! 4. Rounding of motions, poses and planes is part of every bound.

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

/// Greatest width of the bracket of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tolerance {
    /// The shapes are nearer than this at `safe`, and about a third as deep in each other at `hit`,
    /// in the caller's unit of length.
    Distance(f64),
    /// `hit - safe` is at most this, unless rounding or a grazing motion makes the bracket wider.
    Time(f64),
}

/// The answer of a cast.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Impact {
    /// The shapes touch, overlap, or are within the distance asked for, at the begin of the
    /// interval.
    AtStart {
        /// The measure at the begin, without the depth of an overlap.
        seen: Measurement,
    },
    /// The first contact lies after `safe`, and not after `hit`.
    Hit {
        /// The shapes are proven apart up to here.
        safe: f64,
        /// The shapes are proven to meet here.
        hit: f64,
        /// Features, witnesses and normal at `safe`: the features that meet.
        seen: Measurement,
    },
    /// The shapes come so near that rounding hides whether they meet, and nothing is known of later
    /// instants. Also the answer if the shapes are seen to meet at `safe`, which happens only to a
    /// [`Motion`] that breaks its contract.
    Undecided {
        /// The shapes are proven apart up to here.
        safe: f64,
        /// Upper bound of the distance at `safe`.
        distance: f64,
    },
    /// The shapes are proven apart over the whole interval, both ends included.
    Miss,
    /// The limit of 20,000 looks was reached, further rounds of a look with a smaller tolerance
    /// counted, as of some motions that graze; or after 1,024 looks or more the pace was less than
    /// a fiftieth of the one that the limit needs, as of bodies that turn by 1e15 radians; or a
    /// motion returned a [`MotionModel`](crate::motion::MotionModel) that is not finite or has a
    /// negative bound: nothing is known of later instants.
    Incomplete {
        /// The shapes are proven apart up to here.
        safe: f64,
    },
}

/// The answer of a cast, and the work done.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Cast {
    /// The answer.
    pub impact: Impact,
    /// Distance queries.
    pub queries: u32,
    /// Predicates that proved, or failed to prove, that the shapes meet.
    pub proofs: u32,
}

/// Reason why a cast was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImpactError {
    /// The interval ends before its begin, or is not finite.
    #[error("invalid time interval {from}..{until}: not finite, or the end is before the start")]
    Interval {
        /// The begin.
        from: f64,
        /// The end.
        until: f64,
    },
    /// A tolerance or a distance that is negative or not finite.
    #[error("{what} is out of range: {value} (expected a number that is not negative)")]
    Size {
        /// The name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A vertex with a coordinate that is not finite or too large.
    #[error("vertex {index} has a coordinate that is out of range: {value}")]
    Vertex {
        /// The number of the vertex, in the order given.
        index: usize,
        /// The coordinate.
        value: f64,
    },
    /// A mesh at the end of a frame that has other triangles, or another tree, than at the begin.
    #[error("the mesh at the end of the frame has other triangles than the mesh at the start")]
    Mesh,
    /// A motion left the range of poses.
    #[error(transparent)]
    Pose(#[from] PoseError),
}

/// Returns the instant at which two shapes first meet in an interval of time, as a bracket.
///
/// The interval holds both of its ends; one whose ends are equal asks for an instant.
///
/// The bracket of a hit is as wide as the tolerance asks for. The cost hardly depends on the
/// tolerance: down to some 1e-13 of the size of the pair each decade is a fraction of a look.
///
/// A cast takes at most 20,000 looks, then it ends as [`Impact::Incomplete`] with the part that is
/// proven. Most take fewer than 21; bodies that graze take hundreds or thousands, the more the
/// closer they pass.
///
/// # Errors
/// If the interval ends before its begin, the tolerance is negative or not finite, or a motion
/// leaves the range of poses.
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

/// Returns the instant at which two shapes first come within a distance of each other in an
/// interval of time, as a bracket.
///
/// # Errors
/// If the interval ends before its begin, the tolerance or the distance is negative or not finite,
/// or a motion leaves the range of poses.
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

/// Casts as [`cast_within`], and appends the certificates of the time proven free, one step after
/// the other.
///
/// # Errors
/// As [`cast_within`].
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
    let (Tolerance::Distance(size) | Tolerance::Time(size)) = tolerance;
    for (what, value) in [("tolerance", size), ("distance", distance)] {
        if !(0.0..f64::INFINITY).contains(&value) {
            return Err(ImpactError::Size { what, value });
        }
    }
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
    })
}

/// The answer of a look ahead.
pub(crate) struct Ahead {
    /// The time until which the shapes are proven to stay beyond the distance asked for.
    pub(crate) until: f64,
    /// The first contact before the end of the tick, if the look proves less than the tick.
    pub(crate) cast: Option<Impact>,
    /// Distance queries and predicates.
    pub(crate) queries: u32,
}

/// Looks ahead from time zero over a `span`; if the look does not prove the shapes to stay more
/// than `distance` apart for a `tick`, casts the tick from the measure of the look.
///
/// # Errors
/// A motion that leaves the range of poses.
pub(crate) fn ahead<S, M>(
    pair: &mut S,
    [motion_a, motion_b]: [&M; 2],
    tick: f64,
    span: f64,
    distance: f64,
    tolerance: Tolerance,
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
        cast: None,
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
    let mut search = CastSearch {
        pair,
        motion_a,
        motion_b,
        until: tick,
        tolerance,
        distance: 0.0,
        seen: Some(seen),
        queries: 1,
        proofs: 0,
        trail: None,
    };
    let impact = search.run(0.0)?;
    Ok(Ahead {
        until: 0.0,
        cast: Some(impact),
        queries: search.queries + search.proofs,
    })
}

/// Refuses an interval that ends before its begin or is not finite.
fn check(interval: &Range<f64>) -> Result<(), ImpactError> {
    let (from, until) = (interval.start, interval.end);
    if from <= until && (until - from) < f64::INFINITY {
        Ok(())
    } else {
        Err(ImpactError::Interval { from, until })
    }
}
