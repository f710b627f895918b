//! The front of the last answer: pairs of nodes under which every pair of patches lies, each with
//! the direction that proved it far enough.
//!
//! As [`composite::front`](crate::composite), in double precision: let Y, the points below a node
//! of B, lie in the ball of radius rho about c in B's frame, and X, the points below a node of A,
//! be at least g below Y along n in A's frame, at the pose (R0, t0). At the pose (R, t) the gap is
//! at least
//!
//! `g + n . (R c + t) - n . (R0 c + t0) - rho |R^T n - R0^T n|`,
//!
//! whatever way led there. With the bodies exchanged if the node of A is the smaller. So a claim is
//! never out of date; after a long way it merely proves nothing.

use alloc::vec::Vec;
use nalgebra::Vector3;

use super::frame::NetFrame;
use super::gap::{Gap, NetPair, Trees};
use super::side::NetSide;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::CARRIED;

/// A pair of nodes with the claim of its gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetEntry {
    pub(super) pair: NetPair,
    /// In A's frame.
    n: Vector3<f64>,
    /// In B's frame.
    m: Vector3<f64>,
    /// Middle of the ball, in the frame of its body.
    centre: Vector3<f64>,
    radius: f64,
    base: f64,
    /// Whether the ball is that of A's node.
    is_of_a: bool,
    /// Whether the gap was proven by planes: else nothing is claimed at another pose.
    is_plane: bool,
}

impl NetEntry {
    /// Returns the entry of a pair with a gap at this pose.
    pub(super) fn new<B: NetSide>(trees: &Trees<B>, pair: NetPair, gap: &Gap) -> Self {
        let (x, y) = (trees.a.node(pair[0]), trees.b.node(pair[1]));
        let is_of_a = x.radius < y.radius;
        let ball = if is_of_a { x } else { y };
        let mut entry = Self {
            pair,
            n: gap.n,
            m: trees.frame.direction_in_b(&gap.n),
            centre: ball.centre,
            radius: ball.radius + ball.error,
            base: 0.0,
            is_of_a,
            is_plane: gap.is_plane,
        };
        entry.base = gap.gap - entry.height(trees.frame) - CARRIED * trees.frame.size;
        entry
    }

    /// Returns the height of the ball's middle as seen from the other body.
    #[inline(always)]
    fn height(&self, frame: &NetFrame) -> f64 {
        if self.is_of_a {
            self.m.dot(&frame.rotation.tr_mul(&(frame.translation - self.centre)))
        } else {
            self.n.dot(&frame.place(&self.centre))
        }
    }

    /// Returns a lower bound of the gap at a pose.
    #[inline(always)]
    pub(super) fn gap(&self, frame: &NetFrame) -> f64 {
        if !self.is_plane {
            return f64::NEG_INFINITY;
        }
        let turned = if self.is_of_a {
            frame.rotation * self.m - self.n
        } else {
            frame.direction_in_b(&self.n) - self.m
        };
        let lost = self.radius * sqrt(turned.norm_squared());
        self.base + self.height(frame) - lost - CARRIED * frame.size - frame.placing
    }

    /// Returns the direction in A's frame at a pose.
    pub(super) fn direction(&self, frame: &NetFrame) -> Vector3<f64> {
        if self.is_of_a {
            let n = frame.rotation * self.m;
            n / sqrt(n.norm_squared())
        } else {
            self.n
        }
    }
}

/// The entries, and their number when the front was cut.
#[derive(Clone, Debug, Default)]
pub(super) struct NetFront {
    pub(super) entries: Vec<NetEntry>,
    pub(super) cut: usize,
}
