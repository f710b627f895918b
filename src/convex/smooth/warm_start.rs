//! First solver of a warm query: proves the support sets of the last answer again.
//!
//! The support set of a core is a point (one branch), a ridge (two branches) or a face (three
//! branches, or a flat round face). Two branches are equally high along the directions of a circle,
//! `n . u = c`, with a constant unit vector `u` of the core ([`Support::ridge`]). So a ridge
//! removes one degree of freedom from the direction:
//!
//! | support sets | direction |
//! |---|---|
//! | point and point | two unknowns: Newton's method on the normal |
//! | ridge and point | one unknown: Newton's method on the circle |
//! | ridge and ridge | intersection of both circles |
//! | face and point | normal of the face |
//!
//! 1. At each direction, compute the nearest points of the two support sets.
//! 2. If their distance agrees with the height of the sets, compute both support points.
//! 3. If the height of the support points agrees as well, the answer is proven. Otherwise a branch
//!    that is higher joins its set.
//! 4. A branch that has a negative weight at the nearest point leaves its set.
//!
//! Steps are neither cut nor undone. If the bounds do not agree, `newton_gjk` continues.

use core::convert::Infallible;

use super::best_bounds::{BranchSet, EqualBranches, ProvenBounds};
use super::flat_round_faces::{self, Flush};
use super::model::{ModelPlane, newton};
use super::newton_gjk::{RunEnd, far_behind};
use super::posed::{DifferencePoint, PosedCores, Toward, add, tangent, tangents, unit};
use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, root, scaled, sub};
use crate::base::tolerance::ASIDE;
use crate::body::shape::Support;

/// Directions that a warm query may try before `newton_gjk` continues: a heuristic.
const STEPS: u32 = 8;

/// Below this squared angle a step is close to rounding, and points move along their surfaces.
const SLID: f64 = 1.0 / (1u64 << 62) as f64;

/// Above this squared angle a step is too long for a warm query.
const TURN: f64 = 1.0;

/// Largest number of further steps until the points are along the direction: a heuristic.
const LATE: u32 = 3;

/// Squared lengths of directions must lie between `LEAST` and its inverse. Two circles whose axes
/// have a squared sine below `PARALLEL` are left to `newton_gjk`.
const LEAST: f64 = 1.0 / 16.0;
const PARALLEL: f64 = 1.0 / (1u64 << 40) as f64;

/// Pair and bounds of a warm query.
struct Warm<'r, 'p, A, B, T> {
    posed: &'r PosedCores<'p, A, B, T>,
    best: &'r mut ProvenBounds<T>,
    /// Support sets of A and of B: the branches that contain the closest points.
    parts: [EqualBranches; 2],
    flush: Flush,
    /// Bounds agree if they differ by at most this.
    agree: T,
    /// Number of steps at which the distance agreed with the height, but the points were not along
    /// the direction.
    late: u32,
}

/// A unit direction in both frames, with the height of the support sets.
struct At<T> {
    n: Vec3<T>,
    m: Vec3<T>,
    height: T,
    /// The direction for which the points were computed, of any length, in both frames.
    along: [Vec3<T>; 2],
}

/// Proves the support sets of the last answer again, from a direction close to the normal. Returns
/// how the attempt ended.
#[inline(always)]
pub(super) fn track<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    mut n: Vec3<T>,
    set: &BranchSet,
    best: &mut ProvenBounds<T>,
) -> Result<Infallible, RunEnd> {
    let mut warm = Warm {
        posed,
        agree: ProvenBounds::agreement(posed),
        best,
        parts: set.parts(),
        flush: Flush::new(),
        late: 0,
    };
    if let Some(side) = set.flat() {
        n = warm.try_flat(&n, side)?;
    }
    for _ in 0..STEPS {
        n = match [warm.parts[0].len(), warm.parts[1].len()] {
            [1, 1] => warm.of_points(&n)?,
            [2, 1] => warm.of_ridge::<0>(&n)?,
            [1, 2] => warm.of_ridge::<1>(&n)?,
            [2, 2] => warm.of_ridges(&n)?,
            [3, 1] => warm.of_face::<0>(&n)?,
            [1, 3] => warm.of_face::<1>(&n)?,
            _ => break,
        };
    }
    Err(warm.open(&n))
}

impl<A: Support, B: Support, T: Scalar> Warm<'_, '_, A, B, T> {
    /// Passes direction and support sets on to the next solver.
    #[cold]
    fn open(&mut self, n: &Vec3<T>) -> RunEnd {
        if !(self.best.lower.value() > f64::NEG_INFINITY)
            && let Some(n) = unit(n)
        {
            self.best.n = n;
        }
        self.best.set = BranchSet::of_parts(&self.parts);
        RunEnd::Open
    }

    /// Returns a unit direction in both frames; the height is not yet known.
    #[inline(always)]
    fn at(&mut self, n: Vec3<T>) -> At<T> {
        self.best.evaluations += 1;
        let m = neg(&self.posed.frame.direction(&n));
        At {
            n,
            m,
            height: T::from(0.0),
            along: [n, m],
        }
    }

    /// Compares the distance of two points, `w` apart, with the height of the support sets. Returns
    /// the distance, or `None` if a branch has joined a support set.
    ///
    /// Support points are computed only if the distance agrees with the height. If a further step
    /// can rotate the direction (`can_turn`), the points must also be along the direction; after
    /// [`LATE`] such steps this condition is dropped.
    ///
    /// # Errors
    ///
    /// Returns [`RunEnd::Closed`] if the distance agrees with the height of the support points, and
    /// [`RunEnd::Inside`] if the points lie behind each other.
    #[inline(always)]
    fn between(&mut self, at: &At<T>, points: [&Vec3<T>; 2], w: &Vec3<T>, can_turn: bool) -> Result<Option<T>, RunEnd> {
        let length = root(dot(w, w));
        if length - at.height <= self.agree {
            let aside = sub(w, &scaled(&at.n, at.height));
            let most = T::from(ASIDE * self.posed.size);
            if can_turn && self.late < LATE && dot(&aside, &aside) > most * most {
                self.late += 1;
                return Ok(Some(length));
            }
            return self.certify(at, points, length);
        }
        if far_behind(&dot(&at.n, w), &length) {
            return Err(RunEnd::Inside);
        }
        Ok(Some(length))
    }

    /// Compares the distance with the height of the supports.
    #[inline(always)]
    fn certify(&mut self, at: &At<T>, points: [&Vec3<T>; 2], length: T) -> Result<Option<T>, RunEnd> {
        let of = [self.parts[0].first(), self.parts[1].first()];
        // The point of a smooth core is its support point.
        let (a, on_a) = if A::IS_SMOOTH {
            (of[0], *points[0])
        } else {
            self.posed.a.support(&at.along[0], of[0])
        };
        let (b, on_b) = if B::IS_SMOOTH {
            (of[1], *points[1])
        } else {
            self.posed.b.support(&at.along[1], of[1])
        };
        let height = if A::IS_SMOOTH && B::IS_SMOOTH {
            at.height
        } else {
            dot(&at.n, &sub(&self.posed.at(&on_b), &on_a))
        };
        if length - height <= self.agree {
            (self.best.lower, self.best.n, self.best.upper) = (height, at.n, length);
            (self.best.on_a, self.best.on_b) = (*points[0], *points[1]);
            self.best.set = BranchSet::of_parts(&self.parts);
            return Err(RunEnd::Closed);
        }
        self.join(at, height, [a, b])
    }

    /// Adds the branches of the support points to the support sets.
    #[cold]
    #[inline(never)]
    fn join(&mut self, at: &At<T>, height: T, of: [u32; 2]) -> Result<Option<T>, RunEnd> {
        if height > self.best.lower {
            (self.best.lower, self.best.n) = (height, at.n);
        }
        let has_joined = self.parts[0].add(of[0]) & self.parts[1].add(of[1]);
        if has_joined { Ok(None) } else { Err(self.open(&at.n)) }
    }

    /// Makes a step of Newton's method on the normal, along a direction whose length is close to
    /// one. The length is divided out at the end, so that the points do not wait for the square
    /// root.
    #[inline(always)]
    fn of_points(&mut self, along: &Vec3<T>) -> Result<Vec3<T>, RunEnd> {
        let squared = dot(along, along);
        // NaN is not a length.
        if !(squared.value() > LEAST && squared.value() < 1.0 / LEAST) {
            return Err(self.open(along));
        }
        let inverse = T::from(1.0) / root(squared);
        let along_b = neg(&self.posed.frame.direction(along));
        let of = [self.parts[0].first(), self.parts[1].first()];
        let on_a = self.posed.a.of_branch(of[0], along);
        let on_b = self.posed.b.of_branch(of[1], &along_b);
        let piece = self.posed.piece(of, on_a, on_b);
        self.best.evaluations += 1;
        let at = At {
            n: scaled(along, inverse),
            m: scaled(&along_b, inverse),
            height: dot(along, &piece.w) * inverse,
            along: [*along, along_b],
        };
        match self.between(&at, [&on_a, &on_b], &piece.w, true)? {
            Some(length) => self.turn(&at, &piece, length),
            None => Ok(at.n),
        }
    }

    /// Returns the next direction of Newton's method on the normal, not of unit length. If the step
    /// is close to rounding, the points also move along their surfaces.
    #[inline(always)]
    fn turn(&mut self, at: &At<T>, piece: &DifferencePoint<T>, length: T) -> Result<Vec3<T>, RunEnd> {
        let (n, m) = (at.n, at.m);
        let tangents = tangents(&n);
        let toward = Toward { n, m, tangents };
        let [d, e] = &toward.tangents;
        let plane = ModelPlane {
            c: at.height,
            g: [dot(d, &piece.w), dot(e, &piece.w)],
            bend: self.posed.bend(piece, &toward),
        };
        let step = newton(&plane, floor(plane.c, length));
        let squared = step[0].value() * step[0].value() + step[1].value() * step[1].value();
        if squared < SLID && self.late == 0 {
            self.slide(&toward, piece, &step)?;
        }
        // NaN is not a step.
        if !(squared < TURN) {
            return Err(self.open(&at.n));
        }
        if let Some(found) = flat_round_faces::near(self.posed, self.best, &toward, &step, &mut self.flush, 0.0) {
            return self.beyond(&found);
        }
        Ok(add(&toward.n, &tangent(&toward, &step)))
    }

    #[inline(never)]
    fn slide(&mut self, toward: &Toward<T>, piece: &DifferencePoint<T>, step: &[T; 2]) -> Result<(), RunEnd> {
        let top = self.posed.support(toward, piece.of);
        self.best.prove(toward, &top);
        self.best.point(piece);
        self.best.point(&self.posed.slid(piece, toward, step));
        if self.best.closes(self.posed) {
            return Err(RunEnd::Closed);
        }
        Ok(())
    }

    /// Returns axis and level of the circle of the ridge of core `SIDE`, in the frame of A.
    #[inline(always)]
    fn circle<const SIDE: usize>(&self) -> Option<(Vec3<T>, T)> {
        let of = self.parts[SIDE].all::<2>();
        if SIDE == 0 {
            self.posed.a.ridge(of)
        } else {
            let (u, c) = self.posed.b.ridge(of)?;
            Some((neg(&self.posed.frame.vector(&u)), c))
        }
    }

    /// Returns the points of a branch of core `SIDE` and of the first branch of the other core.
    #[inline(always)]
    fn end<const SIDE: usize>(&self, at: &At<T>, k: u32) -> DifferencePoint<T> {
        let other = self.parts[1 - SIDE].first();
        let of = if SIDE == 0 { [k, other] } else { [other, k] };
        let on_a = self.posed.a.of_branch(of[0], &at.n);
        self.posed.piece(of, on_a, self.posed.b.of_branch(of[1], &at.m))
    }

    /// Makes a step along the circle of a ridge of core `SIDE`, with a point of the other core.
    #[inline(never)]
    fn of_ridge<const SIDE: usize>(&mut self, along: &Vec3<T>) -> Result<Vec3<T>, RunEnd> {
        let (one, zero) = (T::from(1.0), T::from(0.0));
        let (u, c) = self.circle::<SIDE>().ok_or_else(|| self.open(along))?;
        let off = sub(along, &scaled(&u, dot(along, &u)));
        let squared = dot(&off, &off);
        if !(squared.value() > LEAST && squared.value() < 1.0 / LEAST) {
            return Err(self.open(along));
        }
        let mut at = self.at(add(&scaled(&off, root((one - c * c) / squared)), &scaled(&u, c)));
        let [first, second] = self.parts[SIDE].all::<2>();
        let (p, q) = (self.end::<SIDE>(&at, first), self.end::<SIDE>(&at, second));
        at.height = dot(&at.n, &p.w);
        let e = sub(&q.w, &p.w);
        let share = -dot(&p.w, &e) / dot(&e, &e);
        let is_inside = share >= zero && share <= one;
        let share = if share > zero { share } else { zero };
        let share = if share < one { share } else { one };
        let (on_a, on_b) = (mix(&p.on_a, &q.on_a, share), mix(&p.on_b, &q.on_b, share));
        let w = add(&p.w, &scaled(&e, share));
        let Some(length) = self.between(&at, [&on_a, &on_b], &w, true)? else {
            return Ok(at.n);
        };
        if !is_inside {
            let end = if share > zero { &q } else { &p };
            self.parts[SIDE] = EqualBranches::only(end.of[SIDE]);
            return self.turn(&at, end, length);
        }
        let t = cross(&u, &at.n);
        let t_in_b = self.posed.frame.direction(&t);
        let bend = dot(&t, &self.posed.a.bent(p.of[0], &p.on_a, &at.n, &t))
            + dot(&t_in_b, &self.posed.b.bent(p.of[1], &p.on_b, &at.m, &t_in_b));
        let down = bend + (floor(at.height, length) - c * dot(&p.w, &u));
        let step = dot(&t, &p.w) / down;
        // NaN is not a step.
        if !(down > zero && step.value() * step.value() < TURN) {
            return Err(self.open(&at.n));
        }
        Ok(add(&at.n, &scaled(&t, step)))
    }

    /// Tries the direction in which the circles of two ridges intersect.
    #[inline(never)]
    fn of_ridges(&mut self, along: &Vec3<T>) -> Result<Vec3<T>, RunEnd> {
        let (one, zero) = (T::from(1.0), T::from(0.0));
        let circles = self.circle::<0>().zip(self.circle::<1>());
        let ((u, c), (v, d)) = circles.ok_or_else(|| self.open(along))?;
        let (k, x) = (dot(&u, &v), cross(&u, &v));
        let squared = dot(&x, &x);
        let inverse = one / squared;
        let flat = add(&scaled(&u, (c - k * d) * inverse), &scaled(&v, (d - k * c) * inverse));
        let rest = one - dot(&flat, &flat);
        if !(squared.value() > PARALLEL && rest > zero) {
            return Err(self.open(along));
        }
        let up = root(rest * inverse);
        let up = if dot(along, &x) < zero { -up } else { up };
        let mut at = self.at(add(&flat, &scaled(&x, up)));
        let ([p, q], [_, r]) = (self.parts[0].all::<2>(), self.parts[1].all::<2>());
        let (p, q, r) = (self.end::<0>(&at, p), self.end::<0>(&at, q), self.end::<1>(&at, r));
        at.height = dot(&at.n, &p.w);
        let (e, f) = (sub(&q.w, &p.w), sub(&r.w, &p.w));
        let [s, t] = foot(&p.w, &e, &f);
        if [s, t].iter().all(|x| *x >= zero && *x <= one) {
            let w = add(&p.w, &add(&scaled(&e, s), &scaled(&f, t)));
            let (on_a, on_b) = (mix(&p.on_a, &q.on_a, s), mix(&p.on_b, &r.on_b, t));
            self.between(&at, [&on_a, &on_b], &w, false)?;
            return Err(self.open(&at.n));
        }
        for (part, share) in self.parts.iter_mut().zip([s, t]) {
            if !(share >= zero) {
                part.keep(0);
            } else if !(share <= one) {
                part.keep(1);
            }
        }
        Ok(at.n)
    }

    /// Tries the normal of a face of core `SIDE`, given by three vertices, with a point of the
    /// other core.
    #[inline(never)]
    fn of_face<const SIDE: usize>(&mut self, along: &Vec3<T>) -> Result<Vec3<T>, RunEnd> {
        let (one, zero) = (T::from(1.0), T::from(0.0));
        let of = self.parts[SIDE].all::<3>();
        let place = |k: u32| {
            if SIDE == 0 {
                self.posed.a.of_branch(k, along)
            } else {
                self.posed.frame.vector(&self.posed.b.of_branch(k, along))
            }
        };
        let x = place(of[0]);
        let normal = cross(&sub(&place(of[1]), &x), &sub(&place(of[2]), &x));
        let length = root(dot(&normal, &normal));
        if !(length > zero) {
            return Err(self.open(along));
        }
        let sign = if dot(&normal, along) < zero { -one } else { one };
        let mut at = self.at(scaled(&normal, sign / length));
        let [p, q, r] = [
            self.end::<SIDE>(&at, of[0]),
            self.end::<SIDE>(&at, of[1]),
            self.end::<SIDE>(&at, of[2]),
        ];
        at.height = dot(&at.n, &p.w);
        let (e, f) = (sub(&q.w, &p.w), sub(&r.w, &p.w));
        let [s, t] = foot(&p.w, &e, &f);
        let weights = [one - s - t, s, t];
        if let Some(k) = (0..3).find(|&k| !(weights[k] >= zero)) {
            self.parts[SIDE].drop(k);
            return Ok(at.n);
        }
        let w = add(&p.w, &add(&scaled(&e, s), &scaled(&f, t)));
        let point = |p: &Vec3<T>, q: &Vec3<T>, r: &Vec3<T>| add(&mix(p, q, s), &scaled(&sub(r, p), t));
        let (on_a, on_b) = (point(&p.on_a, &q.on_a, &r.on_a), point(&p.on_b, &q.on_b, &r.on_b));
        self.between(&at, [&on_a, &on_b], &w, false)?;
        // The lowest point of the other core is another one.
        if [self.parts[SIDE].len(), self.parts[1 - SIDE].len()] == [3, 2] {
            self.parts[1 - SIDE].keep(1);
            return Ok(at.n);
        }
        Err(self.open(&at.n))
    }

    /// Tries the axis of the flat round face of the last answer.
    #[inline(never)]
    fn try_flat(&mut self, n: &Vec3<T>, side: usize) -> Result<Vec3<T>, RunEnd> {
        let toward = self.posed.toward(*n);
        let found = flat_round_faces::of_side(self.posed, self.best, &toward, side, &mut self.flush);
        let found = found.ok_or_else(|| self.open(n))?;
        self.beyond(&found)
    }

    /// Returns the direction between the nearest points that were found along the axis of a flat
    /// round face.
    fn beyond(&mut self, found: &DifferencePoint<T>) -> Result<Vec3<T>, RunEnd> {
        if self.best.closes(self.posed) {
            return Err(RunEnd::Closed);
        }
        self.parts = found.of.each(EqualBranches::only);
        Ok(scaled(&found.w, T::from(1.0) / root(dot(&found.w, &found.w))))
    }
}

/// Returns the larger of the height and half the distance of the points. Far from the normal the
/// height of a direction is a poor estimate of the distance.
#[inline(always)]
fn floor<T: Scalar>(height: T, length: T) -> T {
    let half = length * T::from(0.5);
    if height > half { height } else { half }
}

/// Returns the point at `share` of the segment from `p` to `q`.
#[inline(always)]
fn mix<T: Scalar>(p: &Vec3<T>, q: &Vec3<T>, share: T) -> Vec3<T> {
    add(p, &scaled(&sub(q, p), share))
}

/// Returns the coordinates `s` and `t` of the foot of the origin on the plane `p + s e + t f`.
#[inline(always)]
fn foot<T: Scalar>(p: &Vec3<T>, e: &Vec3<T>, f: &Vec3<T>) -> [T; 2] {
    let (ee, ef, ff) = (dot(e, e), dot(e, f), dot(f, f));
    let (pe, pf) = (dot(p, e), dot(p, f));
    let scale = T::from(1.0) / (ee * ff - ef * ef);
    [(pf * ef - pe * ff) * scale, (pe * ef - pf * ee) * scale]
}
