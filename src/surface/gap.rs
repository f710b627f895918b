//! Lower bounds of the distance of two nodes at the relative pose of their bodies ([`NetFrame`]):
//! gaps between two parallel planes, or separating quadrics.

use nalgebra::{Matrix3, Vector3};

use super::bowl::Bowl;
use super::height::NetSide;
use super::tree::Nodes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{BENT_POSE, CERTIFICATE, FAR, NEAR, PATCH_LIMIT, UNIT};
use crate::convex::minimum::simplex::{Indexed, Simplex};
use crate::pair::transform::ErrorScale;

/// Largest number of steps of the minimum-norm solver on two nets before the pair is split.
const STEPS: usize = 4;

/// A node of A and a node of B.
pub(super) type NetPair = [u32; 2];

/// A lower bound of the distance of the parts in two nodes, along a unit direction from A to B in
/// A's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) n: Vector3<f64>,
    pub(super) gap: f64,
    /// Whether planes perpendicular to `n` prove the gap. Otherwise the gap holds at this pose
    /// only.
    pub(super) is_plane: bool,
}

/// Numbers of computed bounds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SearchWork {
    /// Gaps of two nets along a direction.
    pub(super) gaps: u64,
    /// Bounds by second derivatives.
    pub(super) caps: u64,
    /// Bounds by a separating quadric.
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
    /// Returns the gap along a direction between the convex sets that contain the parts.
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

    /// Returns the gap along one direction, without any improvement.
    pub(super) fn along(&mut self, pair: NetPair, n: &Vector3<f64>) -> Gap {
        let gap = self.gap(pair, n);
        Gap {
            n: *n,
            gap,
            is_plane: true,
        }
    }

    /// Returns the gap along `start`. If it is less than `target`, also tries `hint`.
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

    /// Raises a gap that is below `target`, along the directions of a minimum-norm search.
    pub(super) fn turn(&mut self, pair: NetPair, target: f64, best: &mut Gap) {
        let along = best.n;
        self.descend(pair, target, best);
        if best.gap < target && best.n != along {
            let now = *best;
            self.cap(pair, &now, target, best);
        }
    }

    /// Raises a gap to the gap along another direction, if that is larger.
    pub(super) fn improve(&mut self, pair: NetPair, n: &Vector3<f64>, target: f64, best: &mut Gap) {
        let of = self.along(pair, n);
        if of.gap > best.gap {
            *best = of;
        }
        if of.gap < target {
            self.cap(pair, &of, target, best);
        }
    }

    /// Returns whether a separating quadric proves a pair at least `target` apart.
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

    /// Tries second derivatives along the direction of a gap.
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

    /// Returns the support point of A - B along `n`, and the gap along `n`.
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

/// `a_from_b`, and the errors of points that it maps.
pub(super) struct NetFrame {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
    /// The pair size L: both radii about the origins, plus the distance of the origins.
    pub(super) size: f64,
    /// Error of a height or of a distance, caused by the pose and by dot products.
    pub(super) error: f64,
    /// How far a composed pose may displace points of B; included in `error`.
    pub(super) placing: f64,
    /// Error of a distance, caused by the errors of points.
    pub(super) points: f64,
    /// The narrowest interval that a search aims at.
    pub(super) limit: f64,
}

impl NetFrame {
    /// Returns the frame of two bodies with these radii about their origins and this error of
    /// points. `None` if the bodies are so far apart, or so small, that squares of lengths leave
    /// the range of f64.
    pub(super) fn new(reach: [f64; 2], points: f64, pose: &RelativePose) -> Option<Self> {
        let translation = pose.translation();
        let size = reach[0] + reach[1] + sqrt(translation.norm_squared());
        // Written so that NaN returns `None`.
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

    /// Returns the frame of a pose that may displace points of B by up to `placing`.
    pub(super) fn placed(self, placing: f64) -> Self {
        Self {
            error: self.error + placing,
            placing,
            ..self
        }
    }

    /// Maps a point from B's frame to A's.
    #[inline(always)]
    pub(super) fn place(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * p + self.translation
    }

    /// Maps a normal from A's frame to B's: B's points rise along the result as they rise along
    /// `n`.
    #[inline(always)]
    pub(super) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(n)
    }
}
