//! Pairs of leaves, item by item: along directions first, as a gap along one costs far less than a
//! distance.

use nalgebra::Vector3;

use crate::base::num::extremes::{Bounded, Extremes};
use crate::composite::front::NodePair;
use crate::composite::meet::search::{GapProof, Judge, TreeSearch, TriedDirection};
use crate::composite::tree::{Below, LEAF};

/// Pairs of items of two leaves that are not proven yet.
struct OpenLeafPair {
    of_a: (u32, u32),
    of_b: (u32, u32),
    /// A bit for each pair, four to an item of A.
    left: u32,
    /// The direction with the greatest least gap.
    best: Option<(Vector3<f64>, f64)>,
    /// Lower bound over the pairs that are proven.
    proven: f64,
}

impl OpenLeafPair {
    fn new(of_a: (u32, u32), of_b: (u32, u32)) -> Self {
        let row = (1 << of_b.1) - 1;
        let left = (0..of_a.1).fold(0, |bits, x| bits | row << (4 * x));
        Self {
            of_a,
            of_b,
            left,
            best: None,
            proven: f64::INFINITY,
        }
    }

    /// Takes a distance that is proven of some pairs, if it is of use.
    #[inline(always)]
    fn prove<J: Judge>(&mut self, distance: f64) {
        if J::IS_SELF {
            self.proven = self.proven.smaller(distance);
        }
    }

    /// Leaves out pairs that are not asked for.
    fn only_asked<J: Judge>(&mut self, judge: &J) {
        for bit in bits(self.left) {
            if !judge.is_asked([self.of_a.0 + bit / 4, self.of_b.0 + bit % 4]) {
                self.left &= !(1 << bit);
            }
        }
    }
}

/// Returns the numbers of the bits that are set.
#[inline(always)]
fn bits(mut left: u32) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let bit = (left != 0).then(|| left.trailing_zeros())?;
        left &= left - 1;
        Some(bit)
    })
}

impl<J: Judge> TreeSearch<'_, J> {
    /// Judges all items of two leaves: along the best direction so far, along the boxes' own, by
    /// measuring. The proof returned is the best single direction, whether it proves the pair far
    /// enough or not.
    pub(in crate::composite) fn judge_leaves(&mut self, pair: NodePair, normal: [f32; 3]) -> GapProof {
        self.work.leaves += 1;
        let (Below::Leaf(i, m), Below::Leaf(j, n)) = (self.a.below(pair[0]), self.b.below(pair[1])) else {
            return (normal, -f32::MAX);
        };
        let mut open = OpenLeafPair::new((i, m), (j, n));
        if J::IS_SELF {
            open.only_asked(&self.judge);
        }
        for k in 0..3 {
            if J::IS_SELF && open.left == 0 {
                break;
            }
            let known = self.directions.get(k).map(|d| d.map(|d| d.1));
            if let Some(n) = known.unwrap_or_else(|| self.own_direction(normal)) {
                self.along(&mut open, &n);
            }
            if open.left == 0 {
                break;
            }
        }
        while open.left != 0 && !self.is_over() {
            let bit = open.left.trailing_zeros();
            open.left &= open.left - 1;
            let (n, lower) = self.measure([i + bit / 4, j + bit % 4]);
            open.prove::<J>(lower);
            self.along(&mut open, &TriedDirection::new(self.frame, &n));
        }
        if J::IS_SELF {
            let is_whole = open.left == 0;
            self.leaf_gap = if is_whole { open.proven } else { f64::NEG_INFINITY };
            return ([0.0; 3], -f32::MAX);
        }
        match open.best {
            Some((n, gap)) => self.proof(&n, gap),
            None => (normal, -f32::MAX),
        }
    }

    /// Passes by the pairs of items that a direction proves.
    #[inline(always)]
    fn along(&mut self, open: &mut OpenLeafPair, n: &TriedDirection) {
        let (i, j) = (open.of_a.0, open.of_b.0);
        let lift = n.lift - self.frame.error;
        let (mut high, mut low) = ([f64::NEG_INFINITY; LEAF], [f64::INFINITY; LEAF]);
        let (mut top, mut bottom) = (f64::NEG_INFINITY, f64::INFINITY);
        for (item, to) in (i..i + open.of_a.1).zip(&mut high) {
            *to = self.judge.highest_in_a(item, &n.in_a);
            top = top.at_least(*to);
        }
        for (item, to) in (j..j + open.of_b.1).zip(&mut low) {
            *to = self.judge.lowest_in_b(item, &n.in_b) + lift;
            bottom = bottom.at_most(*to);
        }
        let least = bottom - top;
        if least > self.frame.tie && self.passes(least) {
            open.left = 0;
            open.prove::<J>(least);
        } else {
            for bit in bits(open.left) {
                let gap = low[bit as usize % LEAF] - high[bit as usize / LEAF];
                if self.passes(gap) {
                    open.left &= !(1 << bit);
                    open.prove::<J>(gap);
                    if gap <= self.frame.tie {
                        self.touching.push([i + bit / 4, j + bit % 4]);
                    }
                }
            }
        }
        if open.best.is_none_or(|b| b.1 < least) {
            open.best = Some((n.in_a, least));
        }
    }
}
