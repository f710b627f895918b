//! Lower bounds of the distance of two nodes, the gap between two planes, at the relative pose of
//! their bodies ([`NetFrame`]).

use nalgebra::{Matrix3, Vector3};

use super::bowl::Bowl;
use super::height::NetSide;
use super::tree::Nodes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{BENT_POSE, CERTIFICATE, FAR, NEAR, PATCH_LIMIT, UNIT};
use crate::convex::minimum::simplex::{Indexed, Simplex};
use crate::pair::transform::ErrorScale;

/// Steps of the minimum-norm solver on two nets before a pair is split instead. Not measured.
const STEPS: usize = 4;

/// A node of A and a node of B.
pub(super) type NetPair = [u32; 2];

/// A gap along a unit direction from A to B in A's frame: a lower bound of the distance of the
/// parts of the surfaces below two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) n: Vector3<f64>,
    pub(super) gap: f64,
    /// Whether planes perpendicular to `n` prove the gap: else a bowl does, at this pose alone.
    pub(super) is_plane: bool,
}

/// Counters of bounds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SearchWork {
    /// Heights of two nets along a direction.
    pub(super) gaps: u64,
    /// Heights by second derivatives.
    pub(super) caps: u64,
    /// Heights above a bowl.
    pub(super) bowls: u64,
}

/// A surface and another body at a pose.
pub(super) struct Trees<'a, B> {
    pub(super) a: Nodes<'a>,
    pub(super) b: B,
    pub(super) frame: &'a NetFrame,
    pub(super) counts: SearchWork,
}

impl<B: NetSide> Trees<'_, B> {
    /// Returns the gap along a direction by the convex sets about both parts.
    #[inline]
    fn gap(&mut self, [x, y]: NetPair, n: &Vector3<f64>) -> f64 {
        self.counts.gaps += 1;
        let m = -self.frame.direction_in_b(n);
        let (high_a, high_b) = (self.a.highest(x, n), self.b.highest(y, &m));
        n.dot(&self.frame.translation) - high_b - high_a - self.error([x, y])
    }

    #[inline]
    fn error(&self, [x, y]: NetPair) -> f64 {
        self.frame.error + self.a.node(x).error + self.b.node(y).error
    }

    /// Returns the gap along a direction alone.
    pub(super) fn along(&mut self, pair: NetPair, n: &Vector3<f64>) -> Gap {
        let gap = self.gap(pair, n);
        Gap {
            n: *n,
            gap,
            is_plane: true,
        }
    }

    /// Returns the gap along `start`, or along `hint` if that is larger and the first is less than
    /// `target`.
    pub(super) fn bound(
        &mut self,
        pair: NetPair,
        start: &Vector3<f64>,
        hint: Option<&Vector3<f64>>,
        target: f64,
    ) -> Gap {
        let mut best = self.along(pair, start);
        if best.gap < target
            && let Some(n) = hint
        {
            self.improve(pair, n, target, &mut best);
        }
        best
    }

    /// Raises a gap below `target` along directions from the minimum-norm point of both nets.
    pub(super) fn turn(&mut self, pair: NetPair, target: f64, best: &mut Gap) {
        let along = best.n;
        self.descend(pair, target, best);
        if best.gap < target && best.n != along {
            let now = *best;
            self.cap(pair, &now, target, best);
        }
    }

    /// Raises a gap by that along another direction.
    pub(super) fn improve(&mut self, pair: NetPair, n: &Vector3<f64>, target: f64, best: &mut Gap) {
        let of = self.along(pair, n);
        if of.gap > best.gap {
            *best = of;
        }
        if of.gap < target {
            self.cap(pair, &of, target, best);
        }
    }

    /// Returns whether a bowl proves a pair at least `target` apart.
    pub(super) fn is_about(&mut self, [x, y]: NetPair, bowl: &Bowl, target: f64) -> bool {
        let (of_a, of_b) = (bowl.of_a(target), bowl.of_b(target, self.frame));
        let least = [self.a.least_above(x, &of_a), self.b.least_above(y, &of_b)];
        let [Some(least_a), Some(least_b)] = least else {
            return false;
        };
        let most = -target - BENT_POSE * self.frame.error;
        if !(least_a + least_b <= most) {
            return false;
        }
        self.counts.bowls += 1;
        let Some(high_a) = self.a.above(x, &of_a) else {
            return false;
        };
        let Some(high_b) = self.b.above(y, &of_b) else {
            return false;
        };
        -high_a - high_b - BENT_POSE * self.frame.error >= target
    }

    /// Tries the heights by second derivatives along the direction of a gap.
    fn cap(&mut self, [x, y]: NetPair, of: &Gap, target: f64, best: &mut Gap) {
        let (a, b) = (self.a.node(x), self.b.node(y));
        if a.is_group() || b.is_group() {
            return;
        }
        let m = -self.frame.direction_in_b(&of.n);
        let (high_a, high_b) = (self.a.highest(x, &of.n), self.b.highest(y, &m));
        let need = target - of.gap;
        let least_a = self.a.least(x, &of.n, high_a);
        let least_b = self.b.least(y, &m, high_b);
        if !((high_a - least_a) + (high_b - least_b) > need) {
            return;
        }
        self.counts.caps += 1;
        let top_a = self.a.cap(x, &of.n, high_a, need);
        let top_b = self.b.cap(y, &m, high_b, need);
        let gap = of.n.dot(&self.frame.translation) - top_b - top_a - self.error([x, y]);
        if gap > best.gap {
            *best = Gap { gap, ..*of };
        }
    }

    /// Raises a gap by a few steps of the minimum-norm solver on the convex sets (Gilbert, Johnson
    /// and Keerthi 1988).
    fn descend(&mut self, pair: NetPair, target: f64, best: &mut Gap) {
        let scale = ErrorScale {
            size: self.frame.size,
            shared: 0.0,
        };
        let mut simplex = Simplex::vertex(self.support(pair, &best.n).0);
        for _ in 0..STEPS {
            let d = Vector3::from(simplex.direction());
            let square = d.norm_squared();
            if !(square > 0.0 && square.is_finite()) {
                return;
            }
            let n = d / -sqrt(square);
            let (point, gap) = self.support(pair, &n);
            if gap > best.gap {
                *best = Gap { n, gap, is_plane: true };
            }
            let is_known = simplex.points().iter().any(|c| c.index == point.index);
            if best.gap >= target || is_known || !simplex.add(point, scale) || simplex.len() == 4 {
                return;
            }
        }
    }

    /// Returns the support point of the difference against `n`, and the gap along `n`.
    fn support(&mut self, [x, y]: NetPair, n: &Vector3<f64>) -> (Indexed<f64, [u32; 2]>, f64) {
        self.counts.gaps += 1;
        let m = -self.frame.direction_in_b(n);
        let (i, p, high_a) = self.a.support(x, n);
        let (j, q, high_b) = self.b.support(y, &m);
        let w = p - self.frame.place(&q);
        let point = Indexed {
            index: [i, j],
            w: w.into(),
        };
        let gap = n.dot(&self.frame.translation) - high_b - high_a - self.error([x, y]);
        (point, gap)
    }
}

/// `a_from_b` with the errors of points placed by it.
pub(super) struct NetFrame {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
    /// The size L of the pair: both reaches and the distance of the origins.
    pub(super) size: f64,
    /// Error of a height or of a distance by the pose and by dot products.
    pub(super) error: f64,
    /// How far the pose may put points of B aside, as part of `error`: of poses that were composed.
    pub(super) placing: f64,
    /// Error of a distance by the points.
    pub(super) points: f64,
    /// Intervals are not asked to be narrower.
    pub(super) limit: f64,
}

impl NetFrame {
    /// Returns the frame of bodies with points so far from their origins, whose points err by
    /// `points`. `None` if the bodies are so far apart, or so small, that squares of lengths leave
    /// the range of f64.
    pub(super) fn new(reach: [f64; 2], points: f64, pose: &RelativePose) -> Option<Self> {
        let translation = pose.translation();
        let size = reach[0] + reach[1] + sqrt(translation.norm_squared());
        // Written so that NaN goes the safe way.
        (size > NEAR && size < FAR).then(|| Self {
            rotation: pose.rotation(),
            translation,
            size,
            error: CERTIFICATE * UNIT * size,
            placing: 0.0,
            points,
            limit: PATCH_LIMIT * size,
        })
    }

    /// Returns the frame of a pose that puts points of B up to `placing` aside.
    pub(super) fn placed(self, placing: f64) -> Self {
        Self {
            error: self.error + placing,
            placing,
            ..self
        }
    }

    /// Returns the place of a point of B in A's frame.
    #[inline(always)]
    pub(super) fn place(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * p + self.translation
    }

    /// Returns the direction of B's frame along which points rise as along `n` in A's.
    #[inline(always)]
    pub(super) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(n)
    }
}
