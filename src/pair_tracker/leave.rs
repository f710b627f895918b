//! Casts of bodies that are in contact at the start: proofs that they leave it or slide along it.
//!
//! An ordinary cast ends at once if the bodies touch. Here such a contact is accepted if the bodies
//! are proven not to come closer than at the start. A cast needs a gap to prove anything, so the
//! cast opens one: it translates one body by `d` along the contact's normal, away from the other.
//!
//! If the translated bodies stay separated, the bodies themselves overlap by at most `d`, because
//! the opposite translation is no longer than `d`. So an ordinary cast of the translated bodies is
//! the proof, for every kind of geometry. `d` is the depth at the start plus `2^-30` of the pair
//! size ([`START_CONTACT`]).
//!
//! The normal rotates with one of the bodies. Both are tried, first A.

use alloc::vec::Vec;
use core::ops::Range;

use nalgebra::{Isometry3, Vector3};

use crate::base::motion::{Motion, MotionModel, length};
use crate::base::num::extremes::Extremes;
use crate::base::pose::{Operand, RelativePose, normalised};
use crate::base::tolerance::{START_CONTACT, TRANSLATED};
use crate::pair::options::QueryOptions;
use crate::pair::outcome::ContactState;
use crate::pair_tracker::PairTracker;
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};
use crate::time::impact::{
    Cast, CastOptions, Certificate, Impact, ImpactError, StartContact, Tolerance, cast_with_certificates, check,
};
use crate::time::separation::{Measurement, Separation};

/// Number of times at which the bodies may be seen to have left the margin.
const EXITS: u32 = 64;

/// The tolerance of the cast of the translated bodies, as a fraction of `2^-30` of the pair size.
/// A larger tolerance would make the cast prove hits of bodies that slide.
const NARROW: f64 = 0.25;

/// Largest number of times after a possible approach at which the approach may be proven, each
/// twice as far ahead as the one before.
const PROOFS: u32 = 40;

/// A motion of a body whose frame is translated, by a vector in the frame.
struct Translated<'a, M: ?Sized> {
    motion: &'a M,
    by: Vector3<f64>,
}

impl<M: Motion + ?Sized> Translated<'_, M> {
    fn posed(&self, mut pose: Isometry3<f64>) -> Isometry3<f64> {
        pose.translation.vector += normalised(pose.rotation) * self.by;
        pose
    }
}

impl<M: Motion + ?Sized> Motion for Translated<'_, M> {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        self.posed(self.motion.pose(time))
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        self.placed(time, span).1
    }

    fn placed(&self, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        let (pose, mut model) = self.motion.placed(time, span);
        // The pivot stays where it is in the world.
        let pivot = length(&model.pivot.coords);
        let size = pose.translation.vector.abs().sum() + model.displacement(pivot, span) + pivot + length(&self.by);
        model.pivot -= self.by;
        model.shift.0[0] += TRANSLATED * size;
        (self.posed(pose), model)
    }
}

/// A contact at the start of a cast.
struct Contact {
    /// Lower bound of the signed distance.
    distance: f64,
    /// Unit direction from A to B, in A's frame.
    normal: Vector3<f64>,
    /// The pair size.
    size: f64,
}

impl PairTracker {
    /// Casts two bodies that may be in contact at the start of the interval.
    ///
    /// Without a contact at the start this is
    /// [`impact::cast_within`](crate::impact::cast_within). If the bodies are within
    /// [`CastOptions::start_contact_margin`] at the start, and overlap by no more than this margin,
    /// the cast accepts the contact:
    ///
    /// 1. Until the bodies have left the margin, they must not come closer than at the start, minus
    ///    `2^-30` of the pair size (the sum of both radii and the distance of the centres). So they
    ///    may separate, slide along each other, or rest.
    /// 2. From then on they must keep [`CastOptions::distance`], like all bodies.
    ///
    /// The cast tests at 64 evenly spaced times whether the bodies have left the margin.
    /// [`Cast::start_contact`] returns the distances and the time.
    ///
    /// The result says which rule is proven:
    ///
    /// - [`Impact::Miss`]: both rules hold over the whole interval.
    /// - [`Impact::Hit`]: both rules hold up to `safe`, and one is broken at `hit`.
    /// - [`Impact::Undecided`], [`Impact::Incomplete`]: both rules hold up to `safe`.
    /// - [`Impact::AtStart`]: the bodies are nearer than the distance at the start, and the contact
    ///   is not accepted.
    ///
    /// The proof translates one body by the allowed approach along the contact's normal, which
    /// rotates with one of the bodies. A contact of two vertices, or of a vertex and an edge, has
    /// no such normal; there the cast may end as undecided. Open meshes and surfaces have no
    /// inside: a contact with them is accepted only if rounding leaves them separated.
    ///
    /// Certificates of the time before the bodies have left the margin have a negative distance if
    /// the bodies touch.
    ///
    /// ```
    /// use lin_canny::impact::{CastOptions, Impact, Tolerance};
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{PairTracker, Velocity};
    ///
    /// // A box on a table, and two motions: up and to the side, and into the table.
    /// let table = solids::cuboid(Vector3::new(1.0, 1.0, 0.1))?;
    /// let part = solids::cuboid(Vector3::new(0.1, 0.1, 0.1))?;
    /// let still = Steady::new(&Isometry3::identity(), Velocity::default())?;
    /// let moving = |v: Vector3<f64>| {
    ///     let start = Isometry3::translation(0.0, 0.0, 0.2);
    ///     Steady::new(&start, Velocity::new(v, Vector3::zeros()))
    /// };
    /// let (lift, press) = (Vector3::new(0.1, 0.0, 1.0), Vector3::z() * -0.01);
    ///
    /// let mut tracker = PairTracker::new();
    /// let mut cast = |v: Vector3<f64>| {
    ///     let (a, b) = ((&table).into(), (&part).into());
    ///     let options = CastOptions::default().tolerance(Tolerance::Distance(1e-9));
    ///     let options = options.start_contact_margin(1e-3);
    ///     let moving = moving(v).expect("a finite velocity");
    ///     let time = 0.0..1.0;
    ///     tracker.cast_from_contact(
    ///         [a, b], &still, &moving, time, &options, None
    ///     )
    /// };
    /// let found = cast(lift)?;
    /// assert_eq!(found.impact, Impact::Miss);
    /// assert!(found.start_contact.unwrap().until.unwrap() < 0.02);
    /// let found = cast(press)?;
    /// assert!(matches!(found.impact, Impact::Hit { hit, .. } if hit < 1e-6));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the interval ends before its start, a number of the options is negative
    /// or not finite, or a motion leaves the range of poses.
    pub fn cast_from_contact<A, B>(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        motion_a: &A,
        motion_b: &B,
        interval: Range<f64>,
        options: &CastOptions,
        certificates: Option<&mut Vec<Certificate>>,
    ) -> Result<Cast, ImpactError>
    where
        A: Motion + ?Sized,
        B: Motion + ?Sized,
    {
        check(&interval)?;
        options.check()?;
        let mut unused = Vec::new();
        let wants_proof = certificates.is_some();
        let mut search = Leaving {
            tracker: self,
            bodies,
            motion_a,
            motion_b,
            options,
            certificates: certificates.unwrap_or(&mut unused),
            wants_proof,
            queries: 0,
            proofs: 0,
        };
        let mark = search.certificates.len();
        let first = search.cast(interval.clone(), options.distance)?;
        // Rounding may hide the contact, or show it only later.
        let is_start = proven(&first, &interval) == interval.start && first != Impact::Miss;
        let mut found = (first, None);
        if is_start
            && let Some(margin) = options.start_contact_margin
            && let Some(contact) = search.contact(interval.start, margin)?
        {
            search.certificates.truncate(mark);
            found = search.leave(&contact, interval, margin)?;
        }
        Ok(Cast {
            impact: found.0,
            queries: search.queries,
            proofs: search.proofs,
            start_contact: found.1,
        })
    }
}

/// A cast from a contact.
struct Leaving<'a, A: ?Sized, B: ?Sized> {
    tracker: &'a mut PairTracker,
    bodies: [GeometryRef<'a>; 2],
    motion_a: &'a A,
    motion_b: &'a B,
    options: &'a CastOptions,
    certificates: &'a mut Vec<Certificate>,
    wants_proof: bool,
    queries: u32,
    proofs: u32,
}

impl<A: Motion + ?Sized, B: Motion + ?Sized> Leaving<'_, A, B> {
    fn pose(&self, time: f64) -> Result<RelativePose, ImpactError> {
        Ok(RelativePose::new(&self.motion_a.pose(time), &self.motion_b.pose(time))?)
    }

    /// Casts the bodies within a distance.
    fn cast(&mut self, interval: Range<f64>, distance: f64) -> Result<Impact, ImpactError> {
        let (a, b, tolerance) = (self.motion_a, self.motion_b, self.options.tolerance);
        self.cast_along(a, b, interval, tolerance, distance, 0.0)
    }

    /// Casts the bodies on other motions. Their certificates hold for a distance that is less by
    /// `less`.
    fn cast_along<P: Motion + ?Sized, Q: Motion + ?Sized>(
        &mut self,
        motion_a: &P,
        motion_b: &Q,
        interval: Range<f64>,
        tolerance: Tolerance,
        distance: f64,
        less: f64,
    ) -> Result<Impact, ImpactError> {
        let mark = self.certificates.len();
        let [a, b] = self.bodies;
        let mut pair = self.tracker.pair(a, b);
        let cast = cast_with_certificates(
            &mut pair,
            motion_a,
            motion_b,
            interval,
            tolerance,
            distance,
            self.certificates,
        )?;
        if self.wants_proof {
            for certificate in &mut self.certificates[mark..] {
                certificate.distance -= less;
            }
        } else {
            self.certificates.clear();
        }
        self.queries = self.queries.saturating_add(cast.queries);
        self.proofs = self.proofs.saturating_add(cast.proofs);
        Ok(cast.impact)
    }

    /// Returns bounds of the signed distance and a direction that separates the bodies; the lower
    /// bound is infinite if no depth is known.
    fn signed(&mut self, pose: &RelativePose) -> ([f64; 2], Vector3<f64>) {
        let [a, b] = self.bodies;
        self.queries += 1;
        let found = self.tracker.closest(a, b, pose);
        let (state, normal) = (found.state, found.normal.into_inner());
        // These pairs have a depth.
        let kinds = [a.kind(), b.kind()];
        let is_signed = kinds.iter().all(|kind| kind.is_convex()) || kinds.contains(&GeometryKind::HalfSpace);
        if state == ContactState::Separated || is_signed {
            return ([found.lower, found.upper], normal);
        }
        #[cfg(feature = "meshes")]
        if let Some(depth) = self.tracker.penetration(a, b, pose) {
            self.queries = self.queries.saturating_add(depth.queries);
            let far = length(&depth.shift);
            let normal = if far > 0.0 { depth.shift / far } else { normal };
            return ([-depth.upper, -depth.lower], normal);
        }
        ([f64::NEG_INFINITY, f64::INFINITY], normal)
    }

    /// Returns the contact at a time; `None` if the bodies are farther apart than the margin, or
    /// overlap by more.
    fn contact(&mut self, time: f64, margin: f64) -> Result<Option<Contact>, ImpactError> {
        let pose = self.pose(time)?;
        let ([lower, upper], normal) = self.signed(&pose);
        if !(lower >= -margin && (lower <= margin || upper <= margin)) {
            return Ok(None);
        }
        let [a, b] = self.bodies;
        let pair = self.tracker.pair(a, b);
        let [(p, r), (q, s)] = [pair.ball(Operand::A), pair.ball(Operand::B)];
        let between = self.motion_b.pose(time) * q - self.motion_a.pose(time) * p;
        Ok(Some(Contact {
            distance: lower,
            normal,
            size: r + s + length(&between),
        }))
    }

    /// Returns the first of some times at which the bodies are farther apart than the margin.
    fn exit(&mut self, interval: &Range<f64>, margin: f64) -> Result<Option<f64>, ImpactError> {
        let [a, b] = self.bodies;
        for k in 1..=EXITS {
            let part = f64::from(k) / f64::from(EXITS);
            let time = interval.start * (1.0 - part) + interval.end * part;
            let pose = self.pose(time)?;
            self.proofs += 1;
            if self
                .tracker
                .decide_within(a, b, &pose, margin, &QueryOptions::default())
                .is_no()
            {
                return Ok(Some(time));
            }
        }
        Ok(None)
    }

    /// Proves that the bodies do not come closer until they have left the margin, and then casts
    /// the rest.
    fn leave(
        &mut self,
        contact: &Contact,
        interval: Range<f64>,
        margin: f64,
    ) -> Result<(Impact, Option<StartContact>), ImpactError> {
        let until = self.exit(&interval, margin.larger(self.options.distance))?;
        let kept = contact.distance - START_CONTACT * contact.size;
        let start = StartContact {
            distance: contact.distance,
            kept,
            until,
        };
        let near = interval.start..until.unwrap_or(interval.end);
        let mut impact = self.keep(contact, kept, near.clone())?;
        if let (Impact::Miss, Some(time)) = (impact, until) {
            impact = self.cast(time..interval.end, self.options.distance)?;
        } else if let Impact::Hit { safe, hit, seen } = impact {
            impact = self.closer(safe, hit, near.end, kept, seen)?;
        }
        Ok((impact, Some(start)))
    }

    /// Casts the bodies within the signed distance `kept`.
    fn keep(&mut self, contact: &Contact, kept: f64, interval: Range<f64>) -> Result<Impact, ImpactError> {
        if kept > 0.0 {
            return self.cast(interval, kept);
        }
        let (a, b) = (self.motion_a, self.motion_b);
        let tolerance = Tolerance::Distance(NARROW * START_CONTACT * contact.size);
        let mark = self.certificates.len();
        let on_a = Translated {
            motion: a,
            by: contact.normal * kept,
        };
        let with_a = self.cast_along(&on_a, b, interval.clone(), tolerance, 0.0, -kept)?;
        if with_a == Impact::Miss {
            return Ok(with_a);
        }
        let kept_with_a = self.certificates.split_off(mark.min(self.certificates.len()));
        let [turn_a, turn_b] = [a.pose(interval.start), b.pose(interval.start)].map(|pose| normalised(pose.rotation));
        let normal = turn_a * contact.normal;
        let on_b = Translated {
            motion: b,
            by: turn_b.conjugate() * (normal * -kept),
        };
        let with_b = self.cast_along(a, &on_b, interval.clone(), tolerance, 0.0, -kept)?;
        if proven(&with_b, &interval) >= proven(&with_a, &interval) {
            return Ok(with_b);
        }
        self.certificates.truncate(mark);
        self.certificates.extend(kept_with_a);
        Ok(with_a)
    }

    /// Returns a hit if the bodies are proven closer than `kept` at a time after `safe`.
    fn closer(&mut self, safe: f64, hit: f64, until: f64, kept: f64, seen: Measurement) -> Result<Impact, ImpactError> {
        let mut ahead = hit - safe;
        let mut hit = hit;
        for _ in 0..PROOFS {
            let pose = self.pose(hit)?;
            let ([_, upper], _) = self.signed(&pose);
            self.proofs += 1;
            if upper <= kept {
                return Ok(Impact::Hit { safe, hit, seen });
            }
            if hit >= until {
                break;
            }
            ahead *= 2.0;
            hit = (safe + ahead).next_up().smaller(until);
        }
        Ok(Impact::Undecided {
            safe,
            distance: seen.upper,
        })
    }
}

/// Returns the time up to which a cast is proven free.
fn proven(impact: &Impact, interval: &Range<f64>) -> f64 {
    match *impact {
        Impact::Miss => interval.end,
        Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => safe,
        Impact::AtStart { .. } => interval.start,
    }
}
