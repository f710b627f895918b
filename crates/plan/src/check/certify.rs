//! Verdicts about motions, piece by piece, and the certificates behind them.

use core::fmt;
use core::ops::ControlFlow;
use std::vec::Vec;

use crate::check::checker::Checker;
use crate::check::verdict::{LeavingPair, Verdict};
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::curve::JointCurve;
use crate::motion::joint_motion::{JointMotion, PieceRef, Tube};
use crate::motion::space::{BodyBall, ConfigurationSpace, SegmentMotion};
use crate::names::CellPair;
use lin_canny::Progress;
use lin_canny::impact::{Certificate, Impact};
use lin_canny::separation::Proof;
use nalgebra::Point3;

/// The proof that a pair stays apart on a piece of a motion: consecutive certificates from time 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairProof {
    /// The pair.
    pub pair: CellPair,
    /// The certificates, in order of time.
    pub certificates: Vec<Certificate>,
}

/// What [`Checker::certify_with`] keeps and reports.
#[derive(Default)]
#[non_exhaustive]
pub struct CertifyOptions<'a> {
    /// Whether the certificates of all pairs are kept (default `false`).
    pub certificates: bool,
    /// Receives the number of pieces that are proven, before each piece, and may stop the proof.
    pub progress: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
}

impl fmt::Debug for CertifyOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut all = f.debug_struct("CertifyOptions");
        all.field("certificates", &self.certificates).finish_non_exhaustive()
    }
}

impl<'a> CertifyOptions<'a> {
    /// Keeps the certificates of all pairs.
    #[must_use]
    pub fn certificates(mut self, certificates: bool) -> Self {
        self.certificates = certificates;
        self
    }

    /// Sets the progress callback.
    #[must_use]
    pub fn progress(mut self, progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        self.progress = Some(progress);
        self
    }
}

/// A verdict, and the certificates behind it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Certified {
    /// The verdict.
    pub verdict: Verdict,
    /// Number of pieces of the motion.
    pub pieces: usize,
    /// The certificates of all pairs on each piece that is free, and on the piece that is not, up to
    /// [`Verdict::free_until`]; empty if they were not asked for.
    ///
    /// They contain pairs whose boxes never overlap as well, so they do not depend on the boxes. A
    /// piece that is free only by the boxes has none.
    pub proofs: Vec<Vec<PairProof>>,
    /// Whether the callback stopped the proof.
    pub is_stopped: bool,
}

impl Certified {
    /// Returns the answer about a motion that is followed by another one: its pieces, and then those
    /// of the other. A motion that is not free keeps its verdict.
    #[must_use]
    pub fn followed_by(mut self, next: Self) -> Self {
        if let Verdict::Free { start_contacts, .. } = self.verdict {
            let piece = self.pieces + next.verdict.piece().unwrap_or(0);
            self.verdict = next.verdict.on_piece(piece, start_contacts);
            self.proofs.extend(next.proofs);
            self.is_stopped = next.is_stopped;
        }
        self.pieces += next.pieces;
        self
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns whether a motion is free, blocked at a time, or undecided.
    ///
    /// The verdict covers the whole length of the motion, not samples of it. A motion that is blocked
    /// is proven free up to `free_until`, so the reported contact is the first.
    ///
    /// Inside a tube ([`JointMotion::with_tube`], [`with_radius`](JointMotion::with_radius)) the
    /// margin of the checker holds for all motions of the tube. There `Blocked` and `Undecided` mean
    /// that a pair comes closer on the motion itself than the margin plus a bound of what the tube
    /// moves. A free motion may still exist in the tube; [`tube_contact`](Self::tube_contact) searches
    /// for a configuration that is in contact.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::{Checker, Joint, JointCurve, JointMotion, JointTree, Cell};
    ///
    /// // A block on two rails, x and y.
    /// let origin = Isometry3::identity();
    /// let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// let block = JointTree::serial(origin, rails, vec![2], 0.1)?;
    /// let mut cell = Cell::new();
    /// cell.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// let post = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// cell.add_obstacle("post", post, Isometry3::identity())?;
    /// let mut checker = Checker::new(block, cell)?;
    ///
    /// let around = JointMotion::path(&[[-2.0, 0.0], [0.0, 1.0], [2.0, 0.0]])?;
    /// assert!(checker.certify(&around)?.is_free());
    /// let straight = JointMotion::segment(&[-2.0, 0.0], &[2.0, 0.0]);
    /// assert_eq!(checker.certify(&straight)?.name(), "blocked");
    ///
    /// // The lowest point of this parabola is half as high as its middle control point.
    /// let over = |y: f64| JointCurve::bezier(&[[-2.0, 0.0], [0.0, y], [2.0, 0.0]]);
    /// let high = JointMotion::curve(&over(1.7)?);
    /// assert!(checker.certify(&high)?.is_free());
    /// assert!(!checker.certify(&JointMotion::curve(&over(1.1)?))?.is_free());
    ///
    /// // A controller that follows the parabola to 0.2 may meet the post, to 0.1 it may not.
    /// assert!(checker.certify(&high.clone().with_tube(&[0.0, 0.1])?)?.is_free());
    /// assert!(!checker.certify(&high.with_tube(&[0.0, 0.3])?)?.is_free());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid, if a coordinate leaves its bounds at any time
    /// ([`PlanError::CurveLimit`]), if the space follows straight segments only
    /// ([`PlanError::CurveDegree`]) or has no tubes, or if an obstacle moves and the motion has no
    /// times ([`PlanError::NoTime`]).
    pub fn certify(&mut self, motion: &JointMotion) -> Result<Verdict, PlanError> {
        Ok(self.certify_with(motion, CertifyOptions::default())?.verdict)
    }

    /// Returns the verdict as [`certify`](Self::certify) does, with the certificates of all pairs or a
    /// progress callback.
    ///
    /// If the callback stops the proof, the verdict is undecided: the pieces before are proven free.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{CertifyOptions, Checker, JointMotion, TranslationSpace, Cell};
    /// # let die = solids::cuboid(Vector3::repeat(0.5))?;
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("die", die.clone());
    /// # cell.add_obstacle("block", die, Isometry3::translation(3.0, 0.0, 0.0))?;
    /// # let bounds = [[-9.0, 9.0]; 3];
    /// # let space = TranslationSpace::new(bounds, UnitQuaternion::identity(), 1)?;
    /// # let mut checker = Checker::new(space, cell)?;
    /// let motion = JointMotion::segment(&[0.0; 3], &[6.0, 0.1, 0.0]);
    /// let options = CertifyOptions::default().certificates(true);
    /// let found = checker.certify_with(&motion, options)?;
    /// assert!(!found.verdict.is_free(), "the block is in the way");
    /// let last = found.proofs[0][0].certificates.last().expect("free so far");
    /// assert_eq!(last.until, found.verdict.free_until());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`certify`](Self::certify).
    pub fn certify_with(&mut self, motion: &JointMotion, options: CertifyOptions<'_>) -> Result<Certified, PlanError> {
        let count = motion.pieces();
        let CertifyOptions {
            certificates,
            mut progress,
        } = options;
        let (mut contacts, mut proofs) = (Vec::new(), Vec::new());
        for piece in 0..count {
            let now = Progress::new("pieces", piece, Some(count));
            if progress.as_mut().is_some_and(|call| call(now).is_break()) {
                let verdict = Verdict::Undecided {
                    free_until: 0.0,
                    piece,
                    start_contacts: contacts,
                };
                return Ok(Certified {
                    verdict,
                    pieces: count,
                    proofs,
                    is_stopped: true,
                });
            }
            let verdict = self.piece(motion, piece, certificates, &mut proofs)?;
            let verdict = verdict.on_piece(piece, core::mem::take(&mut contacts));
            match verdict {
                Verdict::Free { start_contacts, .. } => contacts = start_contacts,
                verdict => {
                    return Ok(Certified {
                        verdict,
                        pieces: count,
                        proofs,
                        is_stopped: false,
                    });
                }
            }
        }
        Ok(Certified {
            verdict: Verdict::Free {
                clearance: self.pairs.least_kept,
                start_contacts: contacts,
            },
            pieces: count,
            proofs,
            is_stopped: false,
        })
    }

    /// Returns whether a motion is proven free.
    ///
    /// Does not search for the first contact. A predicate costs less than a proof, so the middle
    /// configuration of a segment is tested first ([`is_free_at`](Self::is_free_at)), and the last one
    /// if a body is not convex.
    ///
    /// # Errors
    /// As [`certify`](Self::certify).
    pub fn is_free(&mut self, motion: &JointMotion) -> Result<bool, PlanError> {
        for k in 0..motion.pieces() {
            let is_free = match motion.piece_ref(k) {
                PieceRef::Segment([from, to]) if motion.times(k).is_none() && motion.tube == Tube::None => {
                    self.is_segment_free(from, to)?
                }
                _ => self.in_tube(motion, k, |checker| {
                    Ok(checker.judged_piece(motion, k, true)?.is_free())
                })?,
            };
            if !is_free {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns whether the segment between two configurations is proven free.
    pub(crate) fn is_segment_free(&mut self, from: &[f64], to: &[f64]) -> Result<bool, PlanError> {
        self.check_ends(from, to)?;
        if self.has_parts && self.samples_first() && !self.is_free_at(to)? {
            self.work.segments += 1;
            return Ok(false);
        }
        self.is_free_inside(from, to)
    }

    /// Returns whether a segment is proven free whose last configuration is free.
    pub(crate) fn is_free_inside(&mut self, from: &[f64], to: &[f64]) -> Result<bool, PlanError> {
        if self.samples_first() && !self.is_free_at(&self.space.between(from, to, 0.5))? {
            self.work.segments += 1;
            return Ok(false);
        }
        self.is_proven_free(from, to)
    }

    /// Returns whether a segment is proven free.
    pub(crate) fn is_proven_free(&mut self, from: &[f64], to: &[f64]) -> Result<bool, PlanError> {
        let segment = self.segment(from, to)?;
        Ok(self.judged(&segment, Some([from, to]), true)?.is_free())
    }

    /// Returns whether predicates at single configurations come before the proof of a segment.
    fn samples_first(&self) -> bool {
        self.start_contact_margin.is_none()
    }

    /// Returns the verdict about a piece, and appends its certificates if they are kept.
    fn piece(
        &mut self,
        motion: &JointMotion,
        k: usize,
        certificates: bool,
        proofs: &mut Vec<Vec<PairProof>>,
    ) -> Result<Verdict, PlanError> {
        self.in_tube(motion, k, |checker| {
            if !certificates {
                return checker.judged_piece(motion, k, false);
            }
            // A free piece needs its certificates alone.
            if let Some((found, start_contacts)) = checker.proven_piece(motion, k, 1.0)? {
                proofs.push(found);
                checker.work.segments += 1;
                checker.work.free += 1;
                let clearance = checker.pairs.least_kept;
                return Ok(Verdict::Free {
                    clearance,
                    start_contacts,
                });
            }
            let verdict = checker.judged_piece(motion, k, false)?;
            let found = match verdict.free_until() {
                until if until > 0.0 && until < 1.0 => checker.proven_piece(motion, k, until)?,
                _ => None,
            };
            proofs.push(found.map_or(Vec::new(), |found| found.0));
            Ok(verdict)
        })
    }

    /// Calls a function inside the tube of a motion, if it has one. Contacts at the start are not
    /// accepted in tubes.
    fn in_tube<T>(
        &mut self,
        motion: &JointMotion,
        k: usize,
        call: impl FnOnce(&mut Self) -> Result<T, PlanError>,
    ) -> Result<T, PlanError> {
        match &motion.tube {
            Tube::None => return call(self),
            Tube::Radius(radius) => self.tube = self.widened(*radius),
            Tube::Joints(tube) => {
                self.check_tube(motion, k)?;
                self.joint_tube = Some(tube.clone());
            }
        }
        let start_contact = self.start_contact_margin.take();
        let found = call(self);
        self.start_contact_margin = start_contact;
        (self.tube, self.joint_tube) = (0.0, None);
        found
    }

    /// Returns by how much a tube of points brings a pair nearer.
    pub(crate) fn widened(&self, radius: f64) -> f64 {
        let moving = if self.pairs.own.is_empty() { 1.0 } else { 2.0 };
        moving * radius
    }

    /// Returns an error if the space of a motion with a tube of joints has no tubes.
    pub(crate) fn check_tube(&mut self, motion: &JointMotion, k: usize) -> Result<(), PlanError> {
        let Tube::Joints(tube) = &motion.tube else {
            return Ok(());
        };
        let (expected, found) = (self.space.coordinates(), tube.coordinates());
        if found != expected {
            return Err(PlanError::Length { expected, found });
        }
        let along = self.along(motion, k)?;
        let ball = BodyBall {
            body: 0,
            centre: Point3::origin(),
            radius: 0.0,
        };
        if self.space.bodies() > 0 && along.spread(ball, None, 0.0, 1.0, &tube.over(0.0, 1.0)).is_none() {
            let (what, value) = ("length of a tube in a space without joints", expected as f64);
            return Err(PlanError::Value { what, value });
        }
        Ok(())
    }

    /// Returns the motion of the bodies along a piece, after a check of the piece, and sets the motions
    /// of the obstacles along it.
    pub(crate) fn along(&mut self, motion: &JointMotion, k: usize) -> Result<C::Segment, PlanError> {
        let segment = self.moved(motion, k)?;
        match motion.times(k) {
            Some(times) => self.set_parts(times)?,
            None => self.cell.check_at_rest()?,
        }
        Ok(segment)
    }

    /// Returns the motion of the bodies along a piece, after a check of the piece.
    pub(crate) fn moved(&self, motion: &JointMotion, k: usize) -> Result<C::Segment, PlanError> {
        self.check_cell()?;
        match motion.piece_ref(k) {
            PieceRef::Segment([from, to]) => {
                self.space.check(from)?;
                self.space.check(to)?;
                self.space.segment(from, to)
            }
            PieceRef::Curve(curve) => self.space.curve(curve),
        }
    }

    /// Judges a piece. A curve that stays on a straight segment is judged as the segment first, whose
    /// proof takes fewer queries. If `any`, any contact ends the search.
    fn judged_piece(&mut self, motion: &JointMotion, k: usize, any: bool) -> Result<Verdict, PlanError> {
        let along = self.along(motion, k)?;
        let ends = match motion.piece_ref(k) {
            PieceRef::Segment(ends) => Some(ends).filter(|_| motion.tube == Tube::None),
            PieceRef::Curve(curve) => {
                if let Some(straight) = self.straightened(curve)? {
                    let verdict = self.judged(&straight, None, true)?;
                    if verdict.is_free() {
                        return Ok(verdict);
                    }
                    self.work.segments -= 1;
                }
                None
            }
        };
        self.judged(&along, ends, any)
    }

    /// Returns the motion along the straight segment on which a curve stays, if its proof is one of
    /// the curve: contacts that are left have their times on the curve, obstacles that move theirs, and
    /// tubes their entries.
    fn straightened(&self, curve: &JointCurve) -> Result<Option<C::Segment>, PlanError> {
        if self.start_contact_margin.is_some() || self.joint_tube.is_some() || !self.cell.motions.is_empty() {
            return Ok(None);
        }
        let straight = curve.straightened();
        straight.map(|straight| self.space.curve(&straight)).transpose()
    }

    /// Returns the certificates of all pairs along a piece until a time, and the contacts that are
    /// left; `None` if a pair is not proven apart.
    ///
    /// The certificates hold at the times of the piece. Very close to contact, a curve that stays on a
    /// straight segment may be proven only as the segment, whose times differ: then each pair has one
    /// certificate of the kind [`Proof::Own`].
    fn proven_piece(&mut self, motion: &JointMotion, k: usize, until: f64) -> Result<Option<Proven>, PlanError> {
        let segment = self.along(motion, k)?;
        let found = self.proven(&segment, until)?;
        let PieceRef::Curve(curve) = motion.piece_ref(k) else {
            return Ok(found);
        };
        if found.is_some() || until < 1.0 {
            return Ok(found);
        }
        let Some(straight) = self.straightened(curve)? else {
            return Ok(None);
        };
        let mut found = self.proven(&straight, 1.0)?;
        for proof in found.iter_mut().flat_map(|found| &mut found.0) {
            let distance = proof.certificates.iter().map(|c| c.distance);
            let distance = distance.fold(f64::INFINITY, f64::smaller);
            // The last certificate ends at 1.
            if let Some(mut whole) = proof.certificates.pop() {
                (whole.from, whole.distance, whole.proof) = (0.0, distance, Proof::Own);
                proof.certificates = std::vec![whole];
            }
        }
        Ok(found)
    }

    fn proven(&mut self, segment: &C::Segment, until: f64) -> Result<Option<Proven>, PlanError> {
        let (mut proofs, mut contacts) = (Vec::new(), Vec::new());
        for k in self.pairs.ordered() {
            let pair = self.pairs.all[k].pair;
            let mut certificates = Vec::new();
            let start_contact = self.start_contact_margin.filter(|_| !self.is_moving(k));
            let parts = if start_contact.is_none() {
                self.parts(segment)
            } else {
                1
            };
            for mut part in self.intervals(k, parts) {
                if part.start >= until && part.start > 0.0 {
                    break;
                }
                part.end = part.end.smaller(until);
                let kept = self.kept_along(k, segment, &part);
                let found = self.cast(k, segment, part, kept, start_contact, Some(&mut certificates))?;
                self.work.queries += u64::from(found.queries + found.proofs);
                if found.impact != Impact::Miss {
                    return Ok(None);
                }
                contacts.extend(found.start_contact.map(|contact| LeavingPair { pair, contact }));
            }
            proofs.push(PairProof { pair, certificates });
        }
        Ok(Some((proofs, contacts)))
    }

    /// Returns the motion along a segment, after a check of its ends.
    pub(crate) fn segment(&self, from: &[f64], to: &[f64]) -> Result<C::Segment, PlanError> {
        self.check_ends(from, to)?;
        self.space.segment(from, to)
    }

    /// Returns an error if an end of a segment is invalid, or if an obstacle moves.
    pub(crate) fn check_ends(&self, from: &[f64], to: &[f64]) -> Result<(), PlanError> {
        self.check_cell()?;
        self.cell.check_at_rest()?;
        self.space.check(from)?;
        self.space.check(to)
    }
}

/// The certificates of all pairs along a piece, and the contacts that are left.
type Proven = (Vec<PairProof>, Vec<LeavingPair>);
