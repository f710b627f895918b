//! The best bounds of a solve so far, with the points and directions that attain them.

use super::posed::{DifferencePoint, PosedCores, Toward, add};
use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, dot, neg, root, scaled, sub};
use crate::base::tolerance::{AGREE_CURVED, ASIDE, UNIT};
use crate::body::shape::Support;
use crate::convex::minimum::simplex::{Indexed, Simplex};
use crate::pair::transform::ErrorScale;
#[cfg(feature = "__proofs")]
use crate::pair::transform::Transform;

/// Largest number of branch pairs that contain the closest points: one for a vertex of the
/// difference, two for an edge, three for a face.
const KEPT: usize = 3;

/// Tilt of the directions whose branches are added to a start that has only a direction: a
/// heuristic.
const TILT: f64 = 1.0 / 32.0;

/// Branch pairs that contain the closest points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BranchSet {
    of: [[u32; 2]; KEPT],
    len: u8,
    /// Core whose point lies inside a flat round face: 1 for A, 2 for B, 0 for neither.
    flat: u8,
}

impl BranchSet {
    pub(super) fn branches(&self) -> &[[u32; 2]] {
        &self.of[..usize::from(self.len).min(KEPT)]
    }

    /// Returns the branches. If none are known, returns the branches of the support points along a
    /// direction and around it. Each superfluous branch costs a step; a missing branch may cost a
    /// solver.
    #[inline(always)]
    pub(super) fn or_about<A: Support, B: Support>(self, posed: &PosedCores<A, B, f64>, n: Vec3<f64>) -> Self {
        if self.is_empty() { Self::about(posed, n) } else { self }
    }

    #[inline(never)]
    fn about<A: Support, B: Support>(posed: &PosedCores<A, B, f64>, n: Vec3<f64>) -> Self {
        let toward = posed.toward(n);
        let first = posed.support(&toward, [0; 2]).of;
        let mut parts = first.each(EqualBranches::only);
        for tilt in toward.tangents.iter().flat_map(|t| [*t, neg(t)]) {
            let near = posed.toward(add(&n, &scaled(&tilt, TILT)));
            let of = posed.support(&near, first).of;
            parts[0].add(of[0]);
            parts[1].add(of[1]);
        }
        Self::of_parts(&parts)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the branch pair to start with.
    #[inline(always)]
    pub(super) fn first(&self) -> [u32; 2] {
        self.of[0]
    }

    /// Returns the core (0 for A, 1 for B) whose point lies inside a flat round face.
    pub(super) fn flat(&self) -> Option<usize> {
        usize::from(self.flat).checked_sub(1).filter(|&side| side < 2)
    }

    /// Records that a point lies in a flat round face of core `side`.
    pub(super) fn lie(&mut self, side: usize) {
        self.flat = side as u8 + 1;
    }

    /// Returns the support set of each core.
    #[inline(always)]
    pub(super) fn parts(&self) -> [EqualBranches; 2] {
        let [a, b] = self.of[0];
        let mut parts = [EqualBranches::only(a), EqualBranches::only(b)];
        for of in self.branches().iter().skip(1) {
            parts[0].add(of[0]);
            parts[1].add(of[1]);
        }
        parts
    }

    /// Returns branch pairs of two support sets, as many as are needed to contain all branches.
    #[inline(always)]
    pub(super) fn of_parts([a, b]: &[EqualBranches; 2]) -> Self {
        let mut set = Self {
            of: [[a.first(), b.first()]; KEPT],
            len: 1,
            flat: 0,
        };
        a.branches().iter().skip(1).for_each(|&of| set.push([of, b.first()]));
        b.branches().iter().skip(1).for_each(|&of| set.push([a.first(), of]));
        set
    }

    /// Adds a branch pair, unless the set contains it already or is full.
    pub(super) fn add(&mut self, of: [u32; 2]) {
        if !self.branches().contains(&of) {
            self.push(of);
        }
    }

    #[inline(always)]
    fn push(&mut self, of: [u32; 2]) {
        if let Some(place) = self.of.get_mut(usize::from(self.len)) {
            *place = of;
            self.len += 1;
        }
    }
}

/// Support set of one core: one branch for a point, two for a ridge, three for a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EqualBranches {
    of: [u32; KEPT],
    len: u8,
}

impl EqualBranches {
    #[inline(always)]
    pub(super) fn only(of: u32) -> Self {
        Self { of: [of; KEPT], len: 1 }
    }

    #[inline(always)]
    pub(super) fn len(&self) -> u8 {
        self.len
    }

    #[inline(always)]
    pub(super) fn first(&self) -> u32 {
        self.of[0]
    }

    /// Returns the first `N` branches. There must be at least `N`.
    #[inline(always)]
    pub(super) fn all<const N: usize>(&self) -> [u32; N] {
        let mut all = [0; N];
        all.copy_from_slice(&self.of[..N]);
        all
    }

    fn branches(&self) -> &[u32] {
        &self.of[..usize::from(self.len).min(KEPT)]
    }

    /// Adds a branch. Returns false if the set is full and does not contain it.
    #[inline(always)]
    pub(super) fn add(&mut self, of: u32) -> bool {
        if self.branches().contains(&of) {
            return true;
        }
        let place = self.of.get_mut(usize::from(self.len));
        if let Some(place) = place {
            *place = of;
            self.len += 1;
            return true;
        }
        false
    }

    /// Keeps only one branch.
    pub(super) fn keep(&mut self, k: usize) {
        *self = Self::only(self.of[k % KEPT]);
    }

    /// Removes one of three branches.
    pub(super) fn drop(&mut self, k: usize) {
        let [first, second] = [1, 2].each(|by| self.of[(k + by) % KEPT]);
        *self = Self {
            of: [first, second, second],
            len: 2,
        };
    }
}

/// Bounds of the signed distance, without their error terms.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProvenBounds<T> {
    pub(super) lower: T,
    /// Direction that proves the lower bound.
    pub(super) n: Vec3<T>,
    pub(super) upper: T,
    /// Points that prove the upper bound, each in the frame of its core.
    pub(super) on_a: Vec3<T>,
    pub(super) on_b: Vec3<T>,
    pub(super) set: BranchSet,
    /// Number of directions whose support points were computed.
    pub(super) evaluations: u32,
}

impl<T: Scalar> ProvenBounds<T> {
    pub(super) fn new() -> Self {
        let zero = [T::from(0.0); 3];
        Self {
            lower: T::from(f64::NEG_INFINITY),
            n: [T::from(1.0), T::from(0.0), T::from(0.0)],
            upper: T::from(f64::INFINITY),
            on_a: zero,
            on_b: zero,
            set: BranchSet::default(),
            evaluations: 0,
        }
    }

    /// Updates the lower bound by a support point; returns the support value along the direction.
    #[inline(always)]
    pub(super) fn prove(&mut self, toward: &Toward<T>, piece: &DifferencePoint<T>) -> T {
        let height = dot(&toward.n, &piece.w);
        self.prove_height(height, toward);
        height
    }

    /// Updates the lower bound by the support value along a direction.
    #[inline(always)]
    pub(super) fn prove_height(&mut self, height: T, toward: &Toward<T>) {
        self.evaluations += 1;
        if height > self.lower {
            (self.lower, self.n) = (height, toward.n);
        }
    }

    /// Updates the upper bound by the points of one branch pair; returns their distance.
    #[inline(always)]
    pub(super) fn point(&mut self, piece: &DifferencePoint<T>) -> T {
        let distance = root(dot(&piece.w, &piece.w));
        if distance < self.upper {
            (self.upper, self.on_a, self.on_b) = (distance, piece.on_a, piece.on_b);
            self.set = BranchSet {
                of: [piece.of; KEPT],
                len: 1,
                flat: 0,
            };
        }
        distance
    }

    /// Updates the upper bound by a weighted sum of branch pairs. Returns the vector between the
    /// two points.
    ///
    /// Weights must not be negative; they are normalised to sum to one. Returns zero if all are
    /// zero.
    #[inline(always)]
    pub(super) fn mixture<A: Support, B: Support>(
        &mut self,
        posed: &PosedCores<A, B, T>,
        pieces: &[DifferencePoint<T>],
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
            self.set = BranchSet::default();
            let kept = pieces.iter().zip(weights).filter(|(_, weight)| **weight > zero);
            kept.for_each(|(piece, _)| self.set.add(piece.of));
        }
        mixed.w
    }

    /// Updates the upper bound by the nearest points in the hull of up to three branch pairs.
    pub(super) fn nearest<A: Support, B: Support>(
        &mut self,
        posed: &PosedCores<A, B, T>,
        pieces: &[DifferencePoint<T>],
    ) {
        let reach = ErrorScale {
            size: posed.size,
            shared: 0.0,
        };
        let corner = |k: usize| Indexed {
            index: k,
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
            weights[c.index % KEPT] = weight;
        }
        self.mixture(posed, pieces, &weights);
    }

    /// Returns whether the points are opposite each other along the direction.
    pub(super) fn is_opposite<A: Support, B: Support>(&self, posed: &PosedCores<A, B, T>) -> bool {
        let w = posed.piece([0; 2], self.on_a, self.on_b).w;
        let aside = sub(&w, &scaled(&self.n, dot(&self.n, &w)));
        let most = ASIDE * posed.size;
        dot(&aside, &aside).value() <= most * most
    }

    /// Returns the largest difference of bounds that agree.
    #[inline(always)]
    pub(super) fn agreement<A, B>(posed: &PosedCores<A, B, T>) -> T {
        // In finer arithmetic the tolerance is far below the error terms of f64.
        let share = if T::UNIT == UNIT { 1.0 } else { 1.0 / 64.0 };
        T::from(AGREE_CURVED * share * posed.size)
    }

    /// Returns whether the bounds agree.
    #[inline(always)]
    pub(super) fn closes<A, B>(&self, posed: &PosedCores<A, B, T>) -> bool {
        self.upper - self.lower <= Self::agreement(posed)
    }
}

/// Direction, height and distance of the support points for two directions; distance of a mixture.
#[cfg(feature = "__proofs")]
type ToldAlong = ([(Vec3<f64>, f64, f64); 2], f64);

/// Returns the bounds that two unit directions give, for the tests of the error bounds.
///
/// For each direction: the direction, and height and distance of its support points. Then the
/// distance of their mixture.
#[cfg(feature = "__proofs")]
pub(crate) fn bounds_along<A: Support, B: Support>(
    a: &A,
    b: &B,
    frame: Transform<f64>,
    directions: [Vec3<f64>; 2],
    weights: [f64; 2],
) -> Option<ToldAlong> {
    let posed = &PosedCores { a, b, frame, size: 0.0 };
    let mut pieces = [DifferencePoint::default(); 2];
    let mut reported = [([0.0; 3], 0.0, 0.0); 2];
    for k in 0..2 {
        let n = super::posed::unit(&directions[k])?;
        let toward = posed.toward(n);
        pieces[k] = posed.support(&toward, [0; 2]);
        let mut best = ProvenBounds::new();
        reported[k] = (n, best.prove(&toward, &pieces[k]), best.point(&pieces[k]));
    }
    let mut best = ProvenBounds::new();
    best.mixture(posed, &pieces, &weights);
    Some((reported, best.upper))
}
