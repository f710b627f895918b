//! First solver of a warm query: the pieces of the last answer are proved again.
//!
//! At the predicted direction both supports are taken. If the pieces of the last answer still hold
//! the closest points, one step of the model and a second pair of supports close the bounds. A new
//! branch joins the pieces, a branch without weight leaves them; steps are neither cut nor taken
//! back. What this solver does not close is the work of `bent`.

use core::convert::Infallible;

use super::bent::{End, far_behind};
use super::best::{Best, Set};
use super::flush::{self, Flush};
use super::model::{MOST, Plane, Top, kink, newton, top};
use super::posed::{Piece, Posed, Tangent, Toward, add, tangent};
use crate::num::scalar::{Scalar, Vec3, dot, root, scaled, sub};
use crate::shape::Support;

/// Directions that a warm query may take before `bent` takes over: a heuristic.
const STEPS: u32 = 8;

/// Below this squared angle a step is close to rounding, and points move along their surfaces.
const SLID: f64 = 1.0 / (1u64 << 40) as f64;

/// A squared angle from which a step is no longer one of a warm query.
const TURN: f64 = 1.0;

/// Squared lengths of directions are from this to its inverse.
const LEAST: f64 = 1.0 / 16.0;

/// Pair and bounds of a warm query.
struct Warm<'r, 'p, A, B, T> {
    posed: &'r Posed<'p, A, B, T>,
    best: &'r mut Best<T>,
    /// Branches at which supports begin.
    first: [u32; 2],
    flush: Flush,
}

/// Proves the pieces of the last answer again, from a direction close to the normal; returns how
/// the attempt ended.
#[inline(always)]
pub(super) fn track<A: Support, B: Support, T: Scalar>(
    posed: &Posed<A, B, T>,
    mut n: Vec3<T>,
    set: &Set,
    best: &mut Best<T>,
) -> Result<Infallible, End> {
    let mut set = *set;
    let mut warm = Warm {
        posed,
        best,
        first: set.first(),
        flush: Flush::new(),
    };
    if let Some(side) = set.flat() {
        n = warm.try_flat(&n, side, &mut set)?;
    }
    for _ in 0..STEPS {
        let (toward, new) = warm.take(&n)?;
        n = if set.is_only(new.of) {
            warm.of_one(&toward, &new, &mut set)?
        } else {
            warm.of_some(&toward, &new, &mut set)?
        };
    }
    Err(End::Open)
}

impl<A: Support, B: Support, T: Scalar> Warm<'_, '_, A, B, T> {
    /// Takes both supports along a direction of a length close to one. The length is divided out of
    /// the height, so that no support waits for a square root.
    #[inline(always)]
    fn take(&mut self, along: &Vec3<T>) -> Result<(Toward<T>, Piece<T>), End> {
        let squared = dot(along, along);
        // NaN is no length.
        if !(squared.value() > LEAST && squared.value() < 1.0 / LEAST) {
            return Err(End::Open);
        }
        let new = self.posed.support_along(along, self.first);
        let inverse = T::from(1.0) / root(squared);
        let toward = self.posed.toward(scaled(along, inverse));
        self.best.prove_height(dot(along, &new.w) * inverse, &toward);
        Ok((toward, new))
    }

    /// Takes a step of Newton's method on the normal: one piece holds the closest points.
    #[inline(always)]
    fn of_one(&mut self, toward: &Toward<T>, new: &Piece<T>, set: &mut Set) -> Result<Vec3<T>, End> {
        let length = self.best.point(new);
        if self.best.closes(self.posed) {
            return Err(End::Closed);
        }
        let plane = self.plane(toward, new, self.posed.bend(new, toward));
        if far_behind(&plane.c, &length) {
            return Err(End::Inside);
        }
        let step = newton(&plane, floor(plane.c, length));
        self.advance(toward, (core::slice::from_ref(new), &[T::from(1.0)]), &step, set)
    }

    /// Takes a step along the kink of two or three pieces, the new one among them.
    ///
    /// # Errors
    ///
    /// [`End::Open`] if one of the pieces has no weight; ends as in [`between`](Self::between).
    #[inline(always)]
    fn of_known<const N: usize>(&mut self, toward: &Toward<T>, new: &Piece<T>, set: &mut Set) -> Result<Vec3<T>, End> {
        let of = set.branches().first_chunk::<N>().ok_or(End::Open)?;
        let beside = core::slice::from_ref(new);
        let pieces: [Piece<T>; N] = core::array::from_fn(|k| {
            if of[k] == new.of {
                *new
            } else {
                self.posed.of_branches(of[k], toward, beside)
            }
        });
        let mut prior = [T::from(0.0); N];
        nearest(&pieces, &mut prior);
        let length = self.between(toward, &pieces, &prior)?;
        let bends = self.posed.bends(new, toward);
        let planes: [Plane<T>; N] = core::array::from_fn(|k| {
            let bend = self.posed.bend_beside(&pieces[k], new, &bends, toward);
            self.plane(toward, &pieces[k], bend)
        });
        let mu = floor(dot(&toward.n, &new.w), length);
        let Top { weights, step } = kink(&planes, &prior, mu).ok_or(End::Open)?;
        self.advance(toward, (&pieces, &weights), &step, set)
    }

    /// Takes a step on several pieces.
    #[inline(never)]
    fn of_some(&mut self, toward: &Toward<T>, new: &Piece<T>, set: &mut Set) -> Result<Vec3<T>, End> {
        let is_known = set.branches().contains(&new.of);
        let found = match set.branches().len() {
            2 if is_known => self.of_known::<2>(toward, new, set),
            3 if is_known => self.of_known::<3>(toward, new, set),
            _ => Err(End::Open),
        };
        match found {
            Err(End::Open) => self.of_any(toward, new, set),
            found => found,
        }
    }

    /// Takes a step on pieces of which some may leave the set; the new one may join.
    #[inline(never)]
    fn of_any(&mut self, toward: &Toward<T>, new: &Piece<T>, set: &mut Set) -> Result<Vec3<T>, End> {
        let (mut pieces, mut len) = ([*new; MOST], 1);
        for &of in set.branches().iter().filter(|&&of| of != new.of) {
            pieces[len] = self.posed.of_branches(of, toward, &pieces[..len]);
            len += 1;
        }
        let (zero, first) = (T::from(0.0), usize::from(!set.branches().contains(&new.of)));
        let mut prior = [zero; MOST];
        nearest(&pieces[first..len], &mut prior[first..len]);
        let length = self.between(toward, &pieces[..len], &prior[..len])?;
        let mut planes = [Plane::default(); MOST];
        let bends = self.posed.bends(new, toward);
        for (plane, piece) in planes.iter_mut().zip(&pieces[..len]) {
            *plane = self.plane(toward, piece, self.posed.bend_beside(piece, new, &bends, toward));
        }
        let mu = floor(planes[0].c, length);
        let Top { weights, step } = top(&planes[..len], &prior, mu).ok_or(End::Open)?;
        *set = Set::default();
        for (piece, _) in pieces.iter().zip(&weights).filter(|(_, x)| **x > zero) {
            set.add(piece.of);
        }
        self.advance(toward, (&pieces[..len], &weights), &step, set)
    }

    /// Takes a weighted sum of pieces and returns the length of the vector between the points.
    ///
    /// # Errors
    ///
    /// [`End::Closed`] if the bounds agree, [`End::Inside`] if the points lie behind each other.
    #[inline(always)]
    fn between(&mut self, toward: &Toward<T>, pieces: &[Piece<T>], weights: &[T]) -> Result<T, End> {
        let v = self.best.mixture(self.posed, pieces, weights);
        if self.best.closes(self.posed) {
            return Err(End::Closed);
        }
        let length = root(dot(&v, &v));
        if far_behind(&dot(&toward.n, &v), &length) {
            return Err(End::Inside);
        }
        Ok(length)
    }

    /// Returns the direction that a step leads to, not of unit length. After a step close to
    /// rounding, the points that carry weight move along their surfaces as well.
    #[inline(always)]
    fn advance(
        &mut self,
        toward: &Toward<T>,
        pieces: (&[Piece<T>], &[T]),
        step: &Tangent<T>,
        set: &mut Set,
    ) -> Result<Vec3<T>, End> {
        let squared = step[0].value() * step[0].value() + step[1].value() * step[1].value();
        if squared < SLID {
            self.slide(toward, pieces, step);
            if self.best.closes(self.posed) {
                return Err(End::Closed);
            }
        }
        // NaN is no step.
        if !(squared < TURN) {
            return Err(End::Open);
        }
        if let Some(found) = flush::near(self.posed, self.best, toward, step, &mut self.flush, 0.0) {
            return self.beyond(&found, set);
        }
        Ok(add(&toward.n, &tangent(toward, step)))
    }

    #[inline(never)]
    fn slide(&mut self, toward: &Toward<T>, (pieces, weights): (&[Piece<T>], &[T]), step: &Tangent<T>) {
        let (mut slid, mut len) = ([Piece::default(); MOST], 0);
        let kept = pieces.iter().zip(weights).filter(|(_, weight)| **weight > T::from(0.0));
        for (slid, (piece, _)) in slid.iter_mut().zip(kept) {
            *slid = self.posed.slid(piece, toward, step);
            len += 1;
        }
        self.best.nearest(self.posed, &slid[..len]);
    }

    /// Tries the axis of the flat round face of the last answer.
    #[inline(never)]
    fn try_flat(&mut self, n: &Vec3<T>, side: usize, set: &mut Set) -> Result<Vec3<T>, End> {
        let toward = self.posed.toward(*n);
        let found = flush::of_side(self.posed, self.best, &toward, side, &mut self.flush);
        let found = found.ok_or(End::Open)?;
        self.beyond(&found, set)
    }

    /// Returns the direction between the nearest points found along the axis of a flat round face.
    fn beyond(&mut self, found: &Piece<T>, set: &mut Set) -> Result<Vec3<T>, End> {
        if self.best.closes(self.posed) {
            return Err(End::Closed);
        }
        *set = Set::default();
        set.add(found.of);
        Ok(scaled(&found.w, T::from(1.0) / root(dot(&found.w, &found.w))))
    }

    #[inline(always)]
    fn plane(&self, toward: &Toward<T>, piece: &Piece<T>, bend: [T; 3]) -> Plane<T> {
        let [d, e] = &toward.tangents;
        Plane {
            c: dot(&toward.n, &piece.w),
            g: [dot(d, &piece.w), dot(e, &piece.w)],
            bend,
        }
    }
}

/// Returns the larger of the height and half the length of the vector between the points: the
/// height of a direction far from the normal says little.
#[inline(always)]
fn floor<T: Scalar>(height: T, length: T) -> T {
    let half = length * T::from(0.5);
    if height > half { height } else { half }
}

/// Computes the weights of the point nearest to the origin between up to three pieces: clamped
/// between two, and equal if the foot is outside of three.
#[inline(always)]
fn nearest<T: Scalar>(pieces: &[Piece<T>], weights: &mut [T]) {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    match (pieces, weights) {
        ([p, q], [first, second]) => {
            let e = sub(&p.w, &q.w);
            let x = -(dot(&q.w, &e) / dot(&e, &e));
            let x = if x > zero { x } else { zero };
            *first = if x < one { x } else { one };
            *second = one - *first;
        }
        ([p, q, r], [first, second, third]) => {
            let (u, v) = (sub(&p.w, &r.w), sub(&q.w, &r.w));
            let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
            let (ru, rv) = (dot(&r.w, &u), dot(&r.w, &v));
            let scale = one / (uu * vv - uv * uv);
            let (x, y) = ((uv * rv - vv * ru) * scale, (uv * ru - uu * rv) * scale);
            let z = one - x - y;
            let is_inside = x >= zero && y >= zero && z >= zero;
            let third_part = T::from(1.0 / 3.0);
            [*first, *second, *third] = if is_inside { [x, y, z] } else { [third_part; 3] };
        }
        (_, weights) => weights.iter_mut().for_each(|weight| *weight = one),
    }
}
