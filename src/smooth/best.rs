//! What a solver knows so far: both bounds, and what attains them.

use super::posed::{Piece, Posed, Toward};
use crate::minimum::simplex::Simplex;
use crate::num::scalar::{Scalar, Vec3, dot, root};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::transform::ErrorScale;
use crate::shape::Support;
use crate::tolerance::{AGREE_CURVED, UNIT};

/// Most pieces that hold the closest points: a vertex, an edge, a face of the difference.
const KEPT: usize = 3;

/// The branches of the pieces that hold the closest points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Set {
    of: [[u32; 2]; KEPT],
    len: u8,
}

impl Set {
    pub(super) fn branches(&self) -> &[[u32; 2]] {
        &self.of[..usize::from(self.len).min(KEPT)]
    }

    /// Adds a pair of branches, unless it is there or there is no room.
    pub(super) fn add(&mut self, of: [u32; 2]) {
        let len = usize::from(self.len);
        if len < KEPT && !self.of[..len].contains(&of) {
            self.of[len] = of;
            self.len += 1;
        }
    }
}

/// Bounds of the signed distance before their error terms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best<T> {
    pub(super) lower: T,
    /// The direction that proves it.
    pub(super) n: Vec3<T>,
    pub(super) upper: T,
    /// The points that prove it, each in its own frame.
    pub(super) on_a: Vec3<T>,
    pub(super) on_b: Vec3<T>,
    pub(super) set: Set,
    /// Directions whose supports were taken.
    pub(super) evaluations: u32,
}

impl<T: Scalar> Best<T> {
    pub(super) fn new() -> Self {
        let zero = [T::from(0.0); 3];
        Self {
            lower: T::from(f64::NEG_INFINITY),
            n: [T::from(1.0), T::from(0.0), T::from(0.0)],
            upper: T::from(f64::INFINITY),
            on_a: zero,
            on_b: zero,
            set: Set::default(),
            evaluations: 0,
        }
    }

    /// Takes a support: the least height along a unit direction.
    #[inline(always)]
    pub(super) fn prove(&mut self, toward: &Toward<T>, piece: &Piece<T>) -> T {
        let height = dot(&toward.n, &piece.w);
        self.evaluations += 1;
        if height > self.lower {
            (self.lower, self.n) = (height, toward.n);
        }
        height
    }

    /// Takes a weighted sum of pieces: a point of each core. Weights are not negative; they are
    /// made to sum to one.
    #[inline(always)]
    pub(super) fn witness<A: Support, B: Support>(
        &mut self,
        posed: &Posed<A, B, T>,
        pieces: impl Iterator<Item = (Piece<T>, T)> + Clone,
    ) {
        let zero = [T::from(0.0); 3];
        let (mut on_a, mut on_b, mut sum) = (zero, zero, T::from(0.0));
        for (piece, weight) in pieces.clone() {
            sum = sum + weight;
            for k in 0..3 {
                on_a[k] = on_a[k] + piece.on_a[k] * weight;
                on_b[k] = on_b[k] + piece.on_b[k] * weight;
            }
        }
        if !(sum > T::from(0.0)) {
            return;
        }
        let scale = T::from(1.0) / sum;
        let (on_a, on_b) = (on_a.map(|x| x * scale), on_b.map(|x| x * scale));
        let w = posed.piece([0; 2], on_a, on_b).w;
        let distance = root(dot(&w, &w));
        if distance < self.upper {
            (self.upper, self.on_a, self.on_b) = (distance, on_a, on_b);
            self.set = Set::default();
            pieces.for_each(|(piece, _)| self.set.add(piece.of));
        }
    }

    /// Takes the points nearest to each other in the hull of up to three pieces.
    pub(super) fn nearest<A: Support, B: Support>(&mut self, posed: &Posed<A, B, T>, pieces: &[Piece<T>]) {
        let reach = ErrorScale {
            size: posed.size,
            shared: 0.0,
        };
        let corner = |k: usize| MinkowskiPoint {
            a: k as u32,
            b: 0,
            w: pieces[k].w,
        };
        if pieces.is_empty() {
            return;
        }
        let mut simplex = Simplex::vertex(corner(0));
        for k in 1..pieces.len().min(KEPT) {
            simplex.add(corner(k), reach);
        }
        let kept = simplex.points().iter().zip(simplex.weights());
        self.witness(posed, kept.map(|(c, &weight)| (pieces[c.a as usize], weight)));
    }

    /// Whether the bounds agree.
    #[inline(always)]
    pub(super) fn closes<A, B>(&self, posed: &Posed<A, B, T>) -> bool {
        // In finer arithmetic well below what is added for f64.
        let share = if T::UNIT == UNIT { 1.0 } else { 1.0 / 64.0 };
        let agree = AGREE_CURVED * share + 0.5 * posed.noise * T::UNIT;
        self.upper - self.lower <= T::from(agree * posed.size)
    }
}
