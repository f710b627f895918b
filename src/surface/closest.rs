//! The closest two points of two patches by Newton's method, and a proof that two patches share a
//! point.
//!
//! The descent minimises `|w|^2 / 2` with `w = b(s, t) - a(u, v)` over the four parameters between
//! 0 and 1. A step is Newton's if the second derivative is positive definite, otherwise a damped
//! Gauss-Newton step (Levenberg 1944). A parameter at a border stays there if the descent would
//! push it outward. Any result proves an upper bound of the distance.
//!
//! The proof ([`crosses`]): with one of the four parameters fixed, `F(z) = b - a = 0` is a system
//! of three equations in three unknowns. Let C be any matrix, and B the ball of radius rho around
//! z0 in the maximum norm. If `|C F(z0)| <= rho / 2` and `|I - C F'(z)| <= 1/2` for all z in B,
//! then `z - C F(z)` maps B into itself. It has a fixed point by Brouwer's theorem. C is not
//! singular, because the norm of `I - C F'` is less than one, so F has a zero in B (Krawczyk 1969;
//! Neumaier 1990, "Interval Methods for Systems of Equations", section 5.1). B must lie inside the
//! patches.

use nalgebra::{Matrix3, Vector3};

use super::bowl::Bowl;
use super::gap::NetFrame;
use super::net::{BezierPatch, SurfaceJet};
use super::tree::Cut;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes, largest};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{AGREE, PARALLEL, PATCH_SLOPE, UNIT};
use crate::body::polyhedron::{FaceId, Feature};
use crate::pair::location::WitnessLocation;

/// Largest number of Newton steps for two points. Convergence is quadratic at the end.
pub(super) const NEWTON: usize = 24;

/// Two close points, one on each body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The patches of A and B.
    pub(super) patches: [u32; 2],
    /// u and v on A, then on B.
    pub(super) at: [f64; 4],
    /// In A's frame.
    pub(super) on_a: Vector3<f64>,
    /// In B's frame.
    pub(super) on_b: Vector3<f64>,
    /// From A to B, in A's frame.
    pub(super) w: Vector3<f64>,
    /// Derivatives by the four parameters of the point of A, and of B in A's frame.
    pub(super) tangents: [Vector3<f64>; 4],
    /// The distance of the points.
    pub(super) distance: f64,
    /// Upper bound of the distance of the bodies.
    pub(super) upper: f64,
    /// Unit direction from A to B, in A's frame.
    pub(super) normal: Option<Vector3<f64>>,
    /// The same direction, more accurate if rounding rotates the line between the points.
    pub(super) along: Option<Vector3<f64>>,
    /// The feature of B; for a surface, the patch.
    pub(super) feature: Feature,
    /// A separating quadric.
    pub(super) bowl: Option<Bowl>,
}

impl Meeting {
    /// Returns the location of the point on A (0) or on B (1).
    pub(super) fn place(&self, k: usize) -> WitnessLocation {
        WitnessLocation::on_patch(self.patches[k], [self.at[2 * k], self.at[2 * k + 1]])
    }

    /// Returns a unit direction from A to B, usually along w. If w is short compared with `size`,
    /// returns the normal of A or B that is nearly parallel to w, because it is more accurate.
    /// `toward` gives the sense of the normal if rounding hides it.
    fn direction(&self, size: f64, toward: &Vector3<f64>) -> Option<Vector3<f64>> {
        let d = self.distance;
        if d > CLOSE * size {
            return Some(self.w / d);
        }
        let t = &self.tangents;
        for n in [t[0].cross(&t[1]), t[2].cross(&t[3])] {
            let along = if d < 16.0 * UNIT * size {
                let rise = n.dot(&self.w);
                let is_clear = rise.abs() > 16.0 * UNIT * size * sqrt(n.norm_squared());
                facing(&n, if is_clear { &self.w } else { toward }, f64::INFINITY)
            } else {
                facing(&n, &(self.w / d), size / d)
            };
            if along.is_some() {
                return along;
            }
        }
        (d > 0.0).then(|| self.w / d)
    }
}

/// Distance, as a fraction of the pair size, below which rounding rotates the line between two
/// points more than the normal of a surface.
pub(super) const CLOSE: f64 = 1.0 / 65_536.0;

/// Returns m, of any length, as a unit vector with the sense of n; `None` if m is not nearly
/// parallel to n. The angle may be as large as rounding may rotate the line between two points
/// whose distance is the pair size divided by `size`. With an infinite `size` any angle is
/// accepted, and n may have any length.
pub(super) fn facing(m: &Vector3<f64>, n: &Vector3<f64>, size: f64) -> Option<Vector3<f64>> {
    let length = sqrt(m.norm_squared());
    let sine = sqrt(m.cross(n).norm_squared()) / length;
    let is_along = length > 0.0 && sine <= 1.0 / 1024.0 + 64.0 * UNIT * size;
    is_along.then(|| m * if m.dot(n) < 0.0 { -1.0 } else { 1.0 } / length)
}

/// Finds close points of a pair, one on each body.
pub(super) trait Meets {
    /// Returns two close points from a start, and the number of steps; `None` if the pair cannot be
    /// measured there.
    fn descend(&mut self, patches: [u32; 2], start: [f64; 4]) -> Option<(Meeting, u64)>;

    /// Returns whether the points at these parameters are less than `most` apart; this is no bound.
    fn is_closer(&mut self, patches: [u32; 2], at: [f64; 4], most: f64) -> bool;

    /// Returns the unit direction from a point of A to the closest point of B, in A's frame; `None`
    /// if the closest point of B would need a search.
    fn direction(&mut self, patch: u32, at: [f64; 2]) -> Option<Vector3<f64>>;

    /// Returns the part of a patch of A (0) or B (1) over a box of parameters; `None` for a body
    /// without patches.
    fn cut(&self, side: usize, patch: u32, sides: [[f64; 2]; 2]) -> Option<Cut>;
}

/// All patches of two surfaces at a pose.
pub(super) struct Patches<'a> {
    pub(super) a: &'a [BezierPatch],
    pub(super) b: &'a [BezierPatch],
    pub(super) frame: &'a NetFrame,
}

impl<'a> Patches<'a> {
    /// Returns the pair of a patch of A and a patch of B.
    pub(super) fn pair(&self, [p, q]: [u32; 2]) -> PatchPair<'a> {
        PatchPair {
            a: &self.a[p as usize],
            b: &self.b[q as usize],
            frame: self.frame,
        }
    }
}

impl Meets for Patches<'_> {
    fn descend(&mut self, patches: [u32; 2], start: [f64; 4]) -> Option<(Meeting, u64)> {
        Some(self.pair(patches).descend(patches, start))
    }

    fn direction(&mut self, _: u32, _: [f64; 2]) -> Option<Vector3<f64>> {
        None
    }

    fn is_closer(&mut self, patches: [u32; 2], [u, v, s, t]: [f64; 4], most: f64) -> bool {
        let PatchPair { a, b, frame } = self.pair(patches);
        let (p, q) = (a.point(u, v), b.point(s, t));
        (frame.place(&q.coords) - p.coords).norm_squared() < most * most
    }

    fn cut(&self, side: usize, patch: u32, sides: [[f64; 2]; 2]) -> Option<Cut> {
        let patches = if side == 0 { self.a } else { self.b };
        Some(Cut::new(&patches[patch as usize], sides))
    }
}

/// State of the descent at four parameters.
struct ClosestState {
    at: [f64; 4],
    a: SurfaceJet,
    /// In B's frame.
    on_b: Vector3<f64>,
    /// Derivatives in A's frame.
    b: SurfaceJet,
    w: Vector3<f64>,
    square: f64,
}

/// Two patches at a pose.
pub(super) struct PatchPair<'a> {
    pub(super) a: &'a BezierPatch,
    pub(super) b: &'a BezierPatch,
    pub(super) frame: &'a NetFrame,
}

pub(super) type Parameters = [f64; 4];

impl PatchPair<'_> {
    /// Returns two close points from a start, and the number of steps.
    pub(super) fn descend(&self, patches: [u32; 2], start: Parameters) -> (Meeting, u64) {
        let mut now = self.state(start);
        let enough = AGREE * UNIT * self.frame.size * self.frame.size * AGREE;
        let mut damping = 1.0 / 1024.0;
        let mut steps = 0;
        while steps < NEWTON && now.square > enough {
            steps += 1;
            let Some(next) = self.step(&now, &mut damping) else {
                break;
            };
            let gained = now.square - next.square;
            now = next;
            if !(gained > AGREE * now.square) {
                break;
            }
        }
        (now.meeting(patches, self.frame), steps as u64)
    }

    fn state(&self, at: Parameters) -> ClosestState {
        let a = self.a.jet([at[0], at[1]]);
        let local = self.b.jet([at[2], at[3]]);
        let turned = |x: &Vector3<f64>| self.frame.rotation * x;
        let b = SurfaceJet {
            point: self.frame.place(&local.point),
            u: turned(&local.u),
            v: turned(&local.v),
            uu: turned(&local.uu),
            uv: turned(&local.uv),
            vv: turned(&local.vv),
        };
        let w = b.point - a.point;
        ClosestState {
            at,
            a,
            on_b: local.point,
            b,
            w,
            square: w.norm_squared(),
        }
    }

    /// Returns a closer state; `None` if no step leads to one.
    fn step(&self, now: &ClosestState, damping: &mut f64) -> Option<ClosestState> {
        let (gradient, gauss, bent) = now.derivatives();
        let held: [bool; 4] =
            core::array::from_fn(|k| now.at[k] <= 0.0 && gradient[k] >= 0.0 || now.at[k] >= 1.0 && gradient[k] <= 0.0);
        if held.iter().all(|h| *h) {
            return None;
        }
        if let Some(next) = solve(&bent, &gradient, &held).and_then(|s| self.tried(now, &s, 2)) {
            return Some(next);
        }
        for _ in 0..6 {
            let mut damped = gauss;
            (0..4).for_each(|k| damped[k][k] += *damping * (gauss[k][k] + gauss[0][0].larger(gauss[2][2]) / 1024.0));
            let step = solve(&damped, &gradient, &held);
            if let Some(next) = step.and_then(|s| self.tried(now, &s, 1)) {
                *damping /= 16.0;
                return Some(next);
            }
            *damping *= 8.0;
        }
        None
    }

    /// Returns the state after a step or a fraction of it; `None` if none is closer.
    fn tried(&self, now: &ClosestState, step: &Parameters, times: usize) -> Option<ClosestState> {
        let mut part = 1.0;
        for _ in 0..times {
            let next = self.state(core::array::from_fn(|k| (now.at[k] - part * step[k]).clamped(0.0, 1.0)));
            if next.square < now.square {
                return Some(next);
            }
            part *= 0.25;
        }
        None
    }
}

impl ClosestState {
    /// Returns the gradient, and the second derivative without and with the curvature of the
    /// patches.
    fn derivatives(&self) -> (Parameters, [Parameters; 4], [Parameters; 4]) {
        let (a, b, w) = (&self.a, &self.b, &self.w);
        let j = [-a.u, -a.v, b.u, b.v];
        let gradient = j.each(|c| c.dot(w));
        let gauss: [Parameters; 4] = core::array::from_fn(|r| core::array::from_fn(|c| j[r].dot(&j[c])));
        let mut bent = gauss;
        bent[0][0] -= w.dot(&a.uu);
        bent[1][1] -= w.dot(&a.vv);
        bent[2][2] += w.dot(&b.uu);
        bent[3][3] += w.dot(&b.vv);
        let (of_a, of_b) = (w.dot(&a.uv), w.dot(&b.uv));
        bent[0][1] -= of_a;
        bent[1][0] -= of_a;
        bent[2][3] += of_b;
        bent[3][2] += of_b;
        (gradient, gauss, bent)
    }

    fn meeting(&self, patches: [u32; 2], frame: &NetFrame) -> Meeting {
        let distance = sqrt(self.square);
        let mut meeting = Meeting {
            patches,
            at: self.at,
            on_a: self.a.point,
            on_b: self.on_b,
            w: self.w,
            tangents: [self.a.u, self.a.v, self.b.u, self.b.v],
            distance,
            upper: distance + frame.error + frame.points,
            normal: None,
            along: None,
            feature: Feature::Face(FaceId(patches[1])),
            bowl: None,
        };
        meeting.normal = meeting.direction(frame.size, &frame.translation);
        meeting.along = meeting.normal;
        let borders = self.at.each(|t| t <= 0.0 || t >= 1.0);
        meeting.bowl = meeting
            .normal
            .and_then(|n| Bowl::between([&self.a, &self.b], &n, distance, borders, frame));
        meeting
    }
}

/// Solves a symmetric system for the parameters that are not `held` fixed; `None` if it is not
/// positive definite.
pub(super) fn solve(matrix: &[Parameters; 4], right: &Parameters, held: &[bool; 4]) -> Option<Parameters> {
    let (mut m, mut x) = (*matrix, *right);
    for k in (0..4).filter(|&k| held[k]) {
        for i in 0..4 {
            (m[k][i], m[i][k]) = (0.0, 0.0);
        }
        (m[k][k], x[k]) = (1.0, 0.0);
    }
    for k in 0..4 {
        if !held[k] && !(m[k][k] > PARALLEL * matrix[k][k].abs()) {
            return None;
        }
        for i in k + 1..4 {
            let factor = m[i][k] / m[k][k];
            for j in k + 1..4 {
                m[i][j] -= factor * m[k][j];
            }
            x[i] -= factor * x[k];
        }
    }
    for k in (0..4).rev() {
        for j in k + 1..4 {
            x[k] -= m[k][j] * x[j];
        }
        x[k] /= m[k][k];
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// Displacements along the curve of intersection at which the proof is tried. They help if the
/// points are near a border.
const ASIDE: [f64; 5] = [0.0, 0.0625, -0.0625, 0.25, -0.25];

/// Returns whether two patches are proven to share a point near two points that almost coincide.
pub(super) fn crosses(pair: &PatchPair, meeting: &Meeting, upper: f64) -> bool {
    let [p, q, r, s] = meeting.tangents;
    let columns = [-p, -q, r, s];
    // The null vector of the derivative moves the parameters along the curve.
    let volume = |i: usize, j: usize, k: usize| columns[i].dot(&columns[j].cross(&columns[k]));
    let null = [volume(1, 2, 3), -volume(0, 2, 3), volume(0, 1, 3), -volume(0, 1, 2)];
    let longest = null.iter().fold(0.0_f64, |m, x| m.larger(x.abs()));
    if !(longest > 0.0) {
        return false;
    }
    ASIDE.iter().any(|way| {
        let at = core::array::from_fn(|k| (meeting.at[k] + way * null[k] / longest).clamped(0.0, 1.0));
        let moved = if *way == 0.0 {
            *meeting
        } else {
            pair.descend(meeting.patches, at).0
        };
        moved.distance <= upper && (0..4).any(|fixed| shares(pair, &moved, fixed))
    })
}

/// Returns whether a zero is proven with this parameter fixed.
fn shares(pair: &PatchPair, meeting: &Meeting, fixed: usize) -> bool {
    let [p, q, r, s] = meeting.tangents;
    let columns = [-p, -q, r, s];
    let mut free = (0..4).filter(|&k| k != fixed);
    let free: [usize; 3] = core::array::from_fn(|_| free.next().unwrap_or(0));
    let slope = Matrix3::from_columns(&free.each(|k| columns[k]));
    let Some(c) = slope.try_inverse() else { return false };
    let off = meeting.w.abs().add_scalar(pair.frame.error + pair.frame.points);
    let eta = largest(&(c.abs() * off));
    let rho = 2.0 * eta;
    let [of_a, of_b] = [bends(pair.a), bends(pair.b)];
    let bend = of_a.1.larger(of_b.1);
    let error = PATCH_SLOPE * of_a.0.larger(of_b.0);
    // A derivative changes by at most two second derivatives times rho; a third covers rounding.
    let change = 3.0 * (3.0 * bend * rho + error);
    let residual = (Matrix3::identity() - c * slope).abs() * Vector3::repeat(1.0);
    let shift = c.abs() * Vector3::repeat(change);
    let is_inside = free
        .iter()
        .all(|&k| meeting.at[k] - rho >= 0.0 && meeting.at[k] + rho <= 1.0);
    // NaN fails the comparison.
    is_inside && largest(&(residual + shift)) < 0.49
}

/// Returns bounds of all first and second derivatives of a patch. Let R be the radius about the
/// origin, d the sum of the degrees and omega the ratio of the largest to the smallest weight. For
/// `x = N / w`, in units of the largest weight, `|N_u| <= 2 d R` and `|w_u| <= d` give
/// `|x_u| <= 3 d R omega`. In the same manner second derivatives are at most `14 d^2 R omega^2`.
fn bends(patch: &BezierPatch) -> (f64, f64) {
    let weights = || patch.net.iter().map(|h| h[3]);
    let ratio = weights().fold(0.0, f64::larger) / weights().fold(f64::INFINITY, f64::smaller);
    let d = (patch.degrees[0] + patch.degrees[1]) as f64 * ratio;
    (3.0 * d * patch.reach, 14.0 * d * d * patch.reach)
}
