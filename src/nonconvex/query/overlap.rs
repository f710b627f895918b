//! Decides whether two solids share inner points if their surfaces touch and do not certainly
//! cross.
//!
//! 1. Most solids in contact are separated by a plane and share no inner points. So planes are
//!    tried first.
//! 2. If a part of one surface is inside the other body, either a whole connected component is, or
//!    the part ends where the surfaces meet. There two triangles have a segment in common, from
//!    which one of the two continues inside the other body.
//! 3. If no part of either surface is inside the other body, the bodies share inner points only
//!    where they fill the same space. There two triangles lie in one plane with normals of the same
//!    direction, and both bodies are behind them.
//! 4. So the pairs of triangles in contact decide, together with a point of each connected
//!    component. [`common`] returns what two triangles have in common up to rounding, and
//!    [`leaving`] where one leaves the other. Points near there are tested.
//!    If a mesh may be inside out, both directions of a normal are tested.
//! 5. Exact winding numbers prove every such point inside both bodies.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::Operand;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::query::box_gaps::{BoundAim, WIDTH, bounds};
use crate::nonconvex::query::frame::split_pair;
use crate::nonconvex::query::search::Measured;
use crate::nonconvex::query::state::{Inside, PosedTrees};
use crate::nonconvex::query::triangle::{self, Triangle};
use crate::nonconvex::tree::{Below, height};

/// Number of pairs of triangles in contact that are tested for inner points.
const TOUCHES: usize = 128;

/// Number of planes that are tried to separate two solids in contact.
const PARTINGS: usize = 8;

/// Cosine of the angle of two normals that count as the same among these planes.
const SAME_NORMAL: f64 = 1.0 - 1.0 / (1u64 << 40) as f64;

/// Limits of the search for common inner points if no plane separates the bodies.
///
/// They count pairs of boxes and winding numbers.
const MEETING_BOXES: usize = 16_384;
const LOOKS: u64 = 1024;

/// Pairs of items at distance zero up to rounding.
pub(crate) struct Touching {
    pairs: [NodePair; TOUCHES],
    count: usize,
}

impl Touching {
    pub(crate) const NONE: Self = Self {
        pairs: [[0; 2]; TOUCHES],
        count: 0,
    };

    pub(crate) fn push(&mut self, pair: NodePair) {
        if self.count < TOUCHES {
            self.pairs[self.count] = pair;
            self.count += 1;
        }
    }

    pub(crate) fn pairs(&self) -> &[NodePair] {
        &self.pairs[..self.count]
    }

    /// Returns whether further pairs were left out.
    #[cfg(feature = "exact")]
    pub(crate) fn is_full(&self) -> bool {
        self.count == TOUCHES
    }

    /// Sorts the pairs by their items.
    #[cfg(feature = "exact")]
    pub(crate) fn sort(&mut self) {
        self.pairs[..self.count].sort_unstable();
    }
}

/// A ball in the stored frame of a mesh.
struct NearBall {
    centre: Vector3<f64>,
    radius: f64,
}

impl Mesh {
    /// Returns whether no point of the solid in a ball is higher than `level` along a unit vector.
    ///
    /// The result is right up to rounding of the heights.
    fn is_below(&self, n: &Vector3<f64>, level: f64, near: &NearBall) -> bool {
        let unit = self.tree.unit();
        let mut stack = alloc::vec![0];
        while let Some(node) = stack.pop() {
            let b = &self.tree.boxes[node as usize];
            let apart = self.tree.centre + b.centre() * unit - near.centre;
            let reach = near.radius + f64::from(b.radius()) * unit;
            if apart.norm_squared() > reach * reach || height(&self.tree, node, n) <= level {
                continue;
            }
            match self.tree.below(node) {
                Below::Children(c) => stack.extend([c, c + 1]),
                Below::Leaf(first, count) => {
                    let rises = |t: u32| {
                        let corners = self.corners(t);
                        corners.iter().any(|p| n.dot(p) > level)
                            && triangle::nearest(&near.centre, &corners).0 <= near.radius * near.radius
                    };
                    if (first..first + count).any(rises) {
                        return false;
                    }
                }
            }
        }
        // No triangle is in the cap of the ball above the level, so all of the cap is inside or
        // outside.
        let rise = level - n.dot(&near.centre);
        if rise >= near.radius {
            return true;
        }
        let middle = near.centre + n * (0.5 * (rise.larger(-near.radius) + near.radius));
        self.winding(&middle) == Some(0)
    }
}

/// Two solid meshes whose surfaces touch, in A's stored frame.
struct SolidContact<'a, A, B> {
    posed: &'a PosedTrees<'a, A, B>,
    a: &'a Mesh,
    b: &'a Mesh,
    /// Position error of a point.
    doubt: f64,
    /// Whether triangles of a body may face inward.
    may_face_inward: bool,
    /// Triangles of A and of B whose centroids were tested.
    seen: [BTreeSet<u32>; 2],
    /// Number of winding numbers computed.
    windings: u64,
}

impl<A: Parted, B: Parted> SolidContact<'_, A, B> {
    /// Returns whether a plane separates the bodies.
    ///
    /// The planes tried are the plane of the contact `found` and the planes of triangles in
    /// contact.
    fn is_parted<F>(&self, touching: &Touching, found: &Measured<F>) -> bool {
        let mut tried = [Vector3::zeros(); PARTINGS];
        let mut count = 0;
        let mut is_parted = |n: Vector3<f64>, at: &Vector3<f64>| {
            let is_known = tried[..count].iter().any(|m: &Vector3<f64>| m.dot(&n) > SAME_NORMAL);
            if is_known || count == PARTINGS {
                return false;
            }
            tried[count] = n;
            count += 1;
            self.parts(&n, at)
        };
        if is_parted(found.normal, &found.on_a) {
            return true;
        }
        touching.pairs().iter().any(|&pair| {
            let (p, q) = self.corners(pair);
            let mut any = |n: Vector3<f64>, at| is_parted(n, at) || self.may_face_inward && is_parted(-n, at);
            unit_normal(&p).is_some_and(|n| any(n, &p[0])) || unit_normal(&q).is_some_and(|n| any(-n, &q[0]))
        })
    }

    /// Returns whether the plane through `at` with normal `n` separates the bodies, A below it.
    fn parts(&self, n: &Vector3<f64>, at: &Vector3<f64>) -> bool {
        let (frame, ratio) = (&self.posed.frame, self.a.unit() / self.b.unit());
        // Both slacks with their rounding sum to less than 1e-13 L. Shallower overlaps count as
        // touching.
        let slack = 3.0 * frame.error;
        let ball = |mesh: &Mesh| (mesh.tree.centre, f64::from(mesh.tree.reach) * mesh.tree.unit());
        let (of_a, of_b) = (ball(self.a), ball(self.b));
        let b_in_a = NearBall {
            centre: frame.point(&of_b.0),
            radius: of_b.1 / ratio + slack,
        };
        let a_in_b = NearBall {
            centre: self.posed.back(&of_a.0),
            radius: (of_a.1 + slack) * ratio,
        };
        let down = -frame.rotation.tr_mul(n);
        self.a.is_below(n, n.dot(at) + slack, &b_in_a)
            && self
                .b
                .is_below(&down, down.dot(&self.posed.back(at)) + slack * ratio, &a_in_b)
    }

    fn corners(&self, [i, j]: NodePair) -> (Triangle, Triangle) {
        let q = self.b.corners(j);
        (self.a.corners(i), q.each(|x| self.posed.frame.point(&x)))
    }

    /// Returns whether a point is certainly inside a body.
    fn is_held(&mut self, by: Operand, p: &Vector3<f64>) -> bool {
        self.windings += 1;
        let held = match by {
            Operand::A => self.a.holds(p, self.doubt),
            Operand::B => {
                let ratio = self.a.unit() / self.b.unit();
                self.b.holds(&self.posed.back(p), self.doubt * ratio)
            }
        };
        held == Some(true)
    }

    /// Returns the fraction of a segment before it meets a surface; 1 if it meets none.
    ///
    /// Meetings within four position errors of the start are ignored.
    fn free(&self, of: Operand, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
        let least = 4.0 * self.doubt / sqrt((to - from).norm_squared());
        let first = match of {
            Operand::A => self.a.first_meeting(from, to, least),
            Operand::B => self
                .b
                .first_meeting(&self.posed.back(from), &self.posed.back(to), least),
        };
        first.unwrap_or(1.0)
    }

    /// Returns whether a segment from a point of a body's surface continues inside the body.
    fn enters(&mut self, into: Operand, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
        let part = 0.5 * self.free(into, from, to);
        self.is_held(into, &(from + (to - from) * part))
    }

    /// Returns whether both bodies are behind a point of both surfaces, in direction `-n`, or
    /// before it if triangles may face inward.
    fn are_beside(&mut self, at: &Vector3<f64>, n: &Vector3<f64>) -> bool {
        self.are_behind(at, n) || self.may_face_inward && self.are_behind(at, &-n)
    }

    fn are_behind(&mut self, at: &Vector3<f64>, n: &Vector3<f64>) -> bool {
        let to = at - n * sqrt((self.a.high - self.a.low).norm_squared());
        let part = 0.5 * self.free(Operand::A, at, &to).smaller(self.free(Operand::B, at, &to));
        let point = at + (to - at) * part;
        self.is_held(Operand::A, &point) && self.is_held(Operand::B, &point)
    }

    /// Returns whether the bodies certainly share inner points near the common part of two
    /// triangles.
    ///
    /// If this part is a point, the centroids of both triangles and points behind them are tested.
    /// A part of a surface that touches the other surface only at points may be inside the other
    /// body. If the bodies fill the same space, the search may meet adjacent triangles first.
    fn is_shared_at(&mut self, pair: NodePair) -> bool {
        let ((p, q), slack) = (self.corners(pair), self.doubt);
        match common(&p, &q, slack) {
            CommonPart::Point => {
                triangle::closest(&p, &q).square <= slack * slack
                    && (self.is_shared_behind(Operand::B, pair[0], &p)
                        || self.is_shared_behind(Operand::A, pair[1], &q))
            }
            CommonPart::Flat(_, false) if !self.may_face_inward => false,
            CommonPart::Flat(at, _) => unit_normal(&p).is_some_and(|n| self.are_beside(&at, &n)),
            CommonPart::Segment(at, s) => {
                leaving(&p, &q, &at, &s, slack).any(|to| self.enters(Operand::B, &at, &to))
                    || leaving(&q, &p, &at, &s, slack).any(|to| self.enters(Operand::A, &at, &to))
            }
        }
    }

    /// Returns whether the centroid of a triangle, or a point behind it, certainly is a common
    /// inner point.
    ///
    /// The centroid must be inside the other body, the point behind it inside both. Returns false
    /// for a triangle that was tested before.
    fn is_shared_behind(&mut self, other: Operand, t: u32, corners: &Triangle) -> bool {
        if !self.seen[usize::from(other == Operand::A)].insert(t) {
            return false;
        }
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        self.is_held(other, &middle) || unit_normal(corners).is_some_and(|n| self.are_beside(&middle, &n))
    }

    /// Tests the pairs of triangles whose boxes meet, up to the limits.
    fn is_shared_anywhere(&mut self) -> bool {
        let (posed, level) = (self.posed, self.doubt);
        let mut is_shared = false;
        posed.meet(level, MEETING_BOXES, |pair| {
            is_shared = self.is_shared_at(pair);
            is_shared || self.windings >= LOOKS
        });
        is_shared
    }
}

impl<A: Parted, B: Parted> PosedTrees<'_, A, B> {
    /// Passes the pairs of items of leaves whose boxes are at most `level` apart to a function,
    /// until it returns true or about `limit` pairs of boxes are tested.
    ///
    /// Returns whether all pairs were passed.
    pub(crate) fn meet(&self, level: f64, limit: usize, mut is_enough: impl FnMut(NodePair) -> bool) -> bool {
        let (frame, trees) = (&self.frame, [self.a.side().tree, self.b.side().tree]);
        let level = frame.single_up(level);
        let aim = BoundAim::to((level + frame.single.error).next_up());
        let (mut stack, mut tested) = (alloc::vec![[0, 0]], 0);
        while !stack.is_empty() {
            let batch = stack.split_off(stack.len().saturating_sub(WIDTH));
            tested += batch.len();
            if tested > limit {
                return false;
            }
            let gaps = bounds(&frame.single, trees, &batch, &aim);
            for (&pair, gap) in batch.iter().zip(gaps.gap) {
                if frame.single.error.is_finite() && gap - frame.single.error > level {
                    continue;
                }
                if let Some(two) = split_pair(trees, frame, pair) {
                    stack.extend(two);
                    continue;
                }
                let [of_a, of_b] = [0, 1].each(|k| trees[k].range(pair[k]));
                let mut all = of_a.flat_map(|i| of_b.clone().map(move |j| [i, j]));
                if all.any(&mut is_enough) {
                    return false;
                }
            }
        }
        true
    }
}

impl<A: Parted, B: Parted> PosedTrees<'_, A, B> {
    /// Returns whether two solids certainly share inner points, and how many winding numbers it
    /// took.
    ///
    /// `found` is a contact. `is_last` is true if the search is over, so that no more contacts will
    /// come. Then connected components and all pairs of triangles are tested too.
    pub(crate) fn shares_inside<F>(&self, touching: &Touching, found: &Measured<F>, is_last: bool) -> (bool, u64) {
        if !(self.a.is_solid() && self.b.is_solid()) {
            return (false, 0);
        }
        let (PartsRef::Mesh(a), PartsRef::Mesh(b)) = (self.a.by_kind(), self.b.by_kind()) else {
            let (inside, windings) = self.inside(0.0);
            return (matches!(inside, Inside::At(..)), windings);
        };
        let mut contact = SolidContact {
            posed: self,
            a,
            b,
            doubt: 2.0 * self.frame.error,
            may_face_inward: a.may_face_inward() || b.may_face_inward(),
            seen: Default::default(),
            windings: 0,
        };
        if contact.is_parted(touching, found) {
            return (false, 0);
        }
        let is_shared = touching.pairs().iter().any(|pair| contact.is_shared_at(*pair));
        if is_shared || !is_last {
            return (is_shared, contact.windings);
        }
        let (inside, windings) = self.inside(0.0);
        let is_shared = matches!(inside, Inside::At(..)) || contact.is_shared_anywhere();
        (is_shared, contact.windings + windings)
    }
}

/// Fraction of a segment, or of a side of a triangle, at which points are taken.
///
/// It is not a round number, so a point rarely lies on an edge of a third triangle.
const GENERIC: f64 = 0.438_7;

/// Common part of two triangles.
#[derive(Clone, Copy, Debug)]
pub(super) enum CommonPart {
    /// At most a point or, in one plane, a part of an edge.
    Point,
    /// A point of the common segment, and the unit direction of the segment.
    Segment(Vector3<f64>, Vector3<f64>),
    /// A point inside the common part of one plane, and whether the normals have the same
    /// direction.
    Flat(Vector3<f64>, bool),
}

/// Returns the unit normal of a triangle; `None` for a triangle without area.
pub(crate) fn unit_normal(t: &Triangle) -> Option<Vector3<f64>> {
    let n = triangle::normal(t);
    let length = sqrt(n.norm_squared());
    (length > 0.0 && length.is_finite()).then(|| n / length)
}

/// Returns whether two triangles lie in one plane, with heights up to `slack`.
///
/// It is true of two triangles without area, which have no plane.
#[cfg(feature = "exact")]
pub(crate) fn is_flush(p: &Triangle, q: &Triangle, slack: f64) -> bool {
    let is_in = |t: &Triangle, from: &Triangle| {
        unit_normal(from).is_none_or(|n| t.iter().all(|x| n.dot(&(x - from[0])).abs() <= slack))
    };
    is_in(p, q) && is_in(q, p)
}

/// Returns the common part of two triangles.
///
/// Heights up to `slack` count as zero, and so do lengths up to four times `slack`.
pub(super) fn common(p: &Triangle, q: &Triangle, slack: f64) -> CommonPart {
    let (Some(n), Some(m)) = (unit_normal(p), unit_normal(q)) else {
        return CommonPart::Point;
    };
    let (over_q, over_p) = (p.each(|x| m.dot(&(x - q[0]))), q.each(|x| n.dot(&(x - p[0]))));
    if over_q.iter().chain(&over_p).all(|h| h.abs() <= slack) {
        return flat(p, q, &n, slack).map_or(CommonPart::Point, |at| CommonPart::Flat(at, n.dot(&m) > 0.0));
    }
    let across = n.cross(&m);
    let s = across / sqrt(across.norm_squared());
    let (Some(of_p), Some(of_q)) = (trace(p, &over_q, &s, slack), trace(q, &over_p, &s, slack)) else {
        return CommonPart::Point;
    };
    let at = |x: &Vector3<f64>| s.dot(&(x - p[0]));
    let (low, high) = (at(&of_p[0]).larger(at(&of_q[0])), at(&of_p[1]).smaller(at(&of_q[1])));
    if high - low > 4.0 * slack {
        let place = low + GENERIC * (high - low);
        CommonPart::Segment(of_p[0] + s * (place - at(&of_p[0])), s)
    } else {
        CommonPart::Point
    }
}

/// Returns the ends of the part of a triangle that lies in a plane; `None` if there is none.
///
/// The lower end along `s` is first.
/// `heights` are the heights of the vertices above the plane.
fn trace(t: &Triangle, heights: &[f64; 3], s: &Vector3<f64>, slack: f64) -> Option<[Vector3<f64>; 2]> {
    let mut ends: Option<[Vector3<f64>; 2]> = None;
    let mut take = |x: Vector3<f64>| {
        let [low, high] = ends.get_or_insert([x; 2]);
        if s.dot(&(x - *low)) < 0.0 {
            *low = x;
        }
        if s.dot(&(x - *high)) > 0.0 {
            *high = x;
        }
    };
    for k in 0..3 {
        let j = (k + 1) % 3;
        let (h, l) = (heights[k], heights[j]);
        if h.abs() <= slack {
            take(t[k]);
        } else if l.abs() > slack && (h > 0.0) != (l > 0.0) {
            take(t[k] + (t[j] - t[k]) * (h / (h - l)));
        }
    }
    ends
}

/// Returns a point inside the common part of two triangles in one plane.
///
/// `n` is the unit normal of the first triangle. Returns `None` if the part is no wider than a few
/// `slack`.
///
/// Source: clipping by half-planes, Sutherland and Hodgman 1974.
fn flat(p: &Triangle, q: &Triangle, n: &Vector3<f64>, slack: f64) -> Option<Vector3<f64>> {
    let mut polygon = q.to_vec();
    for k in 0..3 {
        let inward = n.cross(&(p[(k + 1) % 3] - p[k]));
        let room = |x: &Vector3<f64>| inward.dot(&(x - p[k]));
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, x) in polygon.iter().enumerate() {
            let y = &polygon[(i + 1) % polygon.len()];
            let (h, l) = (room(x), room(y));
            if h >= 0.0 {
                kept.push(*x);
            }
            if h > 0.0 && l < 0.0 || h < 0.0 && l > 0.0 {
                kept.push(x + (y - x) * (h / (h - l)));
            }
        }
        polygon = kept;
    }
    let first = *polygon.first()?;
    let fan = polygon.windows(2).map(|w| (w[0] - first).cross(&(w[1] - first)).dot(n));
    let around = polygon.iter().map(|x| sqrt((x - first).norm_squared()));
    if !(fan.sum::<f64>().abs() > 8.0 * slack * around.sum::<f64>()) {
        return None;
    }
    let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
    for (k, x) in polygon.iter().enumerate() {
        let weight = 1.0 + GENERIC * k as f64;
        (sum, weights) = (sum + (x - first) * weight, weights + weight);
    }
    Some(first + sum / weights)
}

/// Returns ends of segments in `t` that start at a point of a common segment and may enter `other`.
///
/// There is at most one for each side of the common segment on which `t` continues. If `other`
/// continues on both sides, an end must lie behind its plane.
pub(super) fn leaving(
    t: &Triangle,
    other: &Triangle,
    at: &Vector3<f64>,
    s: &Vector3<f64>,
    slack: f64,
) -> impl Iterator<Item = Vector3<f64>> {
    let aside = |x: &Triangle| unit_normal(x).map(|n| (n, x.each(|c| n.cross(s).dot(&(c - at)))));
    let is_beyond = move |d: f64| d > 4.0 * slack;
    let front = aside(other)
        .filter(|(_, d)| d.iter().any(|d| is_beyond(*d)) && d.iter().any(|d| is_beyond(-d)))
        .map(|(n, _)| n);
    let of_t = aside(t);
    let (t, at) = (*t, *at);
    [1.0, -1.0].into_iter().filter_map(move |side| {
        let (_, d) = of_t?;
        let mut beyond = (0..3).filter(|k| is_beyond(side * d[*k])).map(|k| t[k]);
        let first = beyond.next()?;
        let to = beyond.next().map_or(first, |second| first + (second - first) * GENERIC);
        front.is_none_or(|n| n.dot(&(to - at)) < -slack).then_some(to)
    })
}
