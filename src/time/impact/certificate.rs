//! One step of a cast as a certificate that the caller can check.

use core::ops::Range;

use nalgebra::{Isometry3, Vector3};

use super::cast::{flight, later};
use super::{ImpactError, check};
use crate::base::motion::Motion;
use crate::base::motion::rotation::turned;
use crate::base::num::extremes::Bounded;
use crate::base::pose::{Operand, rigid};
use crate::pair::outcome::ContactState;
use crate::time::separation::{Proof, Separation};

/// A proof that two shapes stay separated from one time until another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Certificate {
    /// The start of the proven interval.
    pub from: f64,
    /// The end of the proven interval: equal to `from` if nothing is proven.
    pub until: f64,
    /// Lower bound of the distance of the shapes from `from` until `until`.
    pub distance: f64,
    /// The proof.
    pub proof: Proof,
}

impl Certificate {
    /// Returns the normal of the plane at a time: from A to B, in the world.
    ///
    /// `None` if no plane proves the certificate.
    ///
    /// From `from` until `until`, all points of A are below all points of B along the normal, by
    /// more than [`distance`](Self::distance). To check the certificate, test every vertex.
    #[must_use]
    pub fn normal(&self, time: f64) -> Option<Vector3<f64>> {
        let Proof::Plane { normal, spin } = self.proof else {
            return None;
        };
        Some(turned(&spin, time - self.from) * normal)
    }

    /// Returns this proof as two, one for each half of the interval.
    ///
    /// Both halves have the same plane: the second starts with its normal at the middle, which
    /// rounds. A checker whose bounds are wider over a longer interval may accept the halves only.
    /// An interval that holds no number between its ends is halved into itself and nothing.
    #[must_use]
    pub fn halved(&self) -> [Self; 2] {
        let middle = (0.5 * self.from + 0.5 * self.until).clamped(self.from, self.until);
        let first = Self { until: middle, ..*self };
        let mut second = Self { from: middle, ..*self };
        if let (Proof::Plane { normal, .. }, Some(turned)) = (&mut second.proof, self.normal(middle)) {
            *normal = turned;
        }
        [first, second]
    }

    /// Returns the gap of the shapes along the plane's normal at a time.
    ///
    /// The gap is computed from the support points of the pair.
    ///
    /// `None` if no plane proves the certificate.
    pub fn gap<S, A, B>(&self, pair: &mut S, motion_a: &A, motion_b: &B, time: f64) -> Option<f64>
    where
        S: Separation + ?Sized,
        A: Motion + ?Sized,
        B: Motion + ?Sized,
    {
        let normal = self.normal(time)?;
        let (pose_a, pose_b) = (rigid(&motion_a.pose(time)), rigid(&motion_b.pose(time)));
        let mut height = |of: Operand, pose: &Isometry3<f64>, n: &Vector3<f64>| {
            let (centre, _) = pair.ball(of);
            n.dot(&(pose.rotation * centre.coords)) + pair.support(of, &(pose.rotation.conjugate() * n)).height
        };
        let (high_a, high_b) = (
            height(Operand::A, &pose_a, &normal),
            height(Operand::B, &pose_b, &-normal),
        );
        let offset = pose_b.translation.vector - pose_a.translation.vector;
        Some(normal.dot(&offset) - high_a - high_b)
    }
}

/// Returns a proof by one step that two shapes stay more than `distance` apart.
///
/// The certificate ends at its start if the shapes are not more than `distance` apart there, or if
/// a motion returns a model that is not finite.
///
/// # Errors
/// Returns an error if the interval ends before its start, the distance is negative or not finite,
/// or a motion leaves the range of poses.
pub fn free_until<S, A, B>(
    pair: &mut S,
    motion_a: &A,
    motion_b: &B,
    interval: Range<f64>,
    distance: f64,
) -> Result<Certificate, ImpactError>
where
    S: Separation + ?Sized,
    A: Motion + ?Sized,
    B: Motion + ?Sized,
{
    check(&interval)?;
    if !(0.0..f64::INFINITY).contains(&distance) {
        let what = "distance";
        return Err(ImpactError::Size { what, value: distance });
    }
    let (from, end) = (interval.start, interval.end);
    let (relative, flight) = flight(motion_a, motion_b, from, end, distance)?;
    let certificate = |span: f64, proof: Proof| Certificate {
        from,
        until: if span >= flight.span {
            end
        } else {
            later(from, span).clamped(from, end)
        },
        distance,
        proof,
    };
    let nothing = Certificate {
        until: from,
        ..certificate(0.0, Proof::Own)
    };
    if !flight.is_known() {
        return Ok(nothing);
    }
    let apart = flight.apart(pair);
    if apart.span > 0.0 && apart.span >= flight.span {
        return Ok(certificate(apart.span, Proof::Balls));
    }
    let seen = pair.measure(&relative);
    if seen.state != ContactState::Separated || !(seen.lower > distance) {
        return Ok(nothing);
    }
    let free = pair.free_for(&seen, &flight);
    Ok(if apart.span > free.span {
        certificate(apart.span, Proof::Balls)
    } else {
        certificate(free.span, free.proof)
    })
}

/// Returns the time until which overlapping shapes are proven to overlap.
///
/// The shapes must overlap by at least `depth` at the start of the interval. Returns the start if
/// nothing is proven, for example if a motion returns a model that is not finite.
///
/// If no point of A, seen from B, moves by more than `m`, the depth changes by at most `m`.
///
/// # Errors
/// Returns an error if the interval ends before its start, the depth is negative or not finite, or
/// a motion leaves the range of poses.
#[cfg(feature = "__internals")]
#[doc(hidden)]
pub fn overlapping_until<S, A, B>(
    pair: &S,
    motion_a: &A,
    motion_b: &B,
    interval: Range<f64>,
    depth: f64,
) -> Result<f64, ImpactError>
where
    S: Separation + ?Sized,
    A: Motion + ?Sized,
    B: Motion + ?Sized,
{
    check(&interval)?;
    if !(0.0..f64::INFINITY).contains(&depth) {
        return Err(ImpactError::Size {
            what: "depth",
            value: depth,
        });
    }
    let (from, end) = (interval.start, interval.end);
    let (_, flight) = flight(motion_a, motion_b, from, end, 0.0)?;
    let span = if flight.is_known() {
        flight.held(pair, depth)
    } else {
        0.0
    };
    Ok(if span > 0.0 && span >= flight.span {
        end
    } else {
        later(from, span).clamped(from, end)
    })
}
