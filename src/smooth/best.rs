//! Best bounds of a solve so far, and the points and directions that attain them.

use super::posed::{Piece, Posed, Toward};
use crate::minimum::simplex::Simplex;
use crate::num::scalar::{Scalar, Vec3, dot, root, scaled};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::transform::ErrorScale;
use crate::polyhedron::VertexId;
use crate::shape::Support;
use crate::tolerance::{AGREE_CURVED, UNIT};

/// Most pieces that hold the closest points: one for a vertex of the difference, two for an edge,
/// three for a face.
const KEPT: usize = 3;

/// Branches of the pieces that hold the closest points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Set {
    of: [[u32; 2]; KEPT],
    len: u8,
    /// Core whose point lies inside a flat round face: 1 for A, 2 for B, 0 for neither.
    flat: u8,
}

impl Set {
    pub(super) fn branches(&self) -> &[[u32; 2]] {
        &self.of[..usize::from(self.len).min(KEPT)]
    }

    /// Returns the pair of branches to begin with.
    #[inline(always)]
    pub(super) fn first(&self) -> [u32; 2] {
        self.of[0]
    }

    /// Returns whether the set is one pair of branches alone.
    #[inline(always)]
    pub(super) fn is_only(&self, of: [u32; 2]) -> bool {
        self.len == 1 && self.of[0] == of
    }

    /// Returns the core (0 for A, 1 for B) whose point lies inside a flat round face.
    pub(super) fn flat(&self) -> Option<usize> {
        usize::from(self.flat).checked_sub(1).filter(|&side| side < 2)
    }

    /// Notes that a point lies in a flat round face of core `side`.
    pub(super) fn lie(&mut self, side: usize) {
        self.flat = side as u8 + 1;
    }

    /// Adds a pair of branches, unless the pair is in the set or the set is full.
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
    /// Direction that proves the lower bound.
    pub(super) n: Vec3<T>,
    pub(super) upper: T,
    /// Points that prove the upper bound, each in the frame of the core.
    pub(super) on_a: Vec3<T>,
    pub(super) on_b: Vec3<T>,
    pub(super) set: Set,
    /// Number of directions whose supports were taken.
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

    /// Takes a support; returns the least height along the unit direction.
    #[inline(always)]
    pub(super) fn prove(&mut self, toward: &Toward<T>, piece: &Piece<T>) -> T {
        let height = dot(&toward.n, &piece.w);
        self.prove_height(height, toward);
        height
    }

    /// Takes the least height along a direction.
    #[inline(always)]
    pub(super) fn prove_height(&mut self, height: T, toward: &Toward<T>) {
        self.evaluations += 1;
        if height > self.lower {
            (self.lower, self.n) = (height, toward.n);
        }
    }

    /// Takes the points of one piece; returns their distance.
    #[inline(always)]
    pub(super) fn point(&mut self, piece: &Piece<T>) -> T {
        let distance = root(dot(&piece.w, &piece.w));
        if distance < self.upper {
            (self.upper, self.on_a, self.on_b) = (distance, piece.on_a, piece.on_b);
            self.set = Set {
                of: [piece.of; KEPT],
                len: 1,
                flat: 0,
            };
        }
        distance
    }

    /// Takes a weighted sum of pieces, a point of each core, and returns the vector between them.
    /// Weights are not negative; they are made to sum to one. Zero if they are all zero.
    #[inline(always)]
    pub(super) fn mixture<A: Support, B: Support>(
        &mut self,
        posed: &Posed<A, B, T>,
        pieces: &[Piece<T>],
        weights: &[T],
    ) -> Vec3<T> {
        let zero = T::from(0.0);
        let (mut on_a, mut on_b, mut sum) = ([zero; 3], [zero; 3], zero);
        for (piece, &weight) in pieces.iter().zip(weights) {
            sum = sum + weight;
            for k in 0..3 {
                on_a[k] = on_a[k] + piece.on_a[k] * weight;
                on_b[k] = on_b[k] + piece.on_b[k] * weight;
            }
        }
        if !(sum > zero) {
            return [zero; 3];
        }
        let scale = T::from(1.0) / sum;
        let mixed = posed.piece([0; 2], scaled(&on_a, scale), scaled(&on_b, scale));
        let distance = root(dot(&mixed.w, &mixed.w));
        if distance < self.upper {
            (self.upper, self.on_a, self.on_b) = (distance, mixed.on_a, mixed.on_b);
            self.set = Set::default();
            let kept = pieces.iter().zip(weights).filter(|(_, weight)| **weight > zero);
            kept.for_each(|(piece, _)| self.set.add(piece.of));
        }
        mixed.w
    }

    /// Takes the points nearest to each other in the hull of up to three pieces.
    pub(super) fn nearest<A: Support, B: Support>(&mut self, posed: &Posed<A, B, T>, pieces: &[Piece<T>]) {
        let reach = ErrorScale {
            size: posed.size,
            shared: 0.0,
        };
        let corner = |k: usize| MinkowskiPoint {
            a: VertexId(k as u32),
            b: VertexId(0),
            w: pieces[k].w,
        };
        if pieces.is_empty() {
            return;
        }
        let mut simplex = Simplex::vertex(corner(0));
        for k in 1..pieces.len().min(KEPT) {
            simplex.add(corner(k), reach);
        }
        let mut weights = [T::from(0.0); KEPT];
        for (c, &weight) in simplex.points().iter().zip(simplex.weights()) {
            weights[c.a.index() % KEPT] = weight;
        }
        self.mixture(posed, pieces, &weights);
    }

    /// Returns whether the bounds agree.
    #[inline(always)]
    pub(super) fn closes<A, B>(&self, posed: &Posed<A, B, T>) -> bool {
        // In finer arithmetic well below what is added for f64.
        let share = if T::UNIT == UNIT { 1.0 } else { 1.0 / 64.0 };
        let agree = AGREE_CURVED * share + 0.5 * posed.noise * T::UNIT;
        self.upper - self.lower <= T::from(agree * posed.size)
    }
}
