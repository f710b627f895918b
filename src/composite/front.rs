//! The front of the last answer: pairs of nodes, each with the direction that proved it far enough.
//!
//! Let the points below B's node lie in the ball of radius rho about c, in B's frame, and let the
//! gap along the unit direction n (A's frame) be at least g at the pose (R0, t0). Then at (R1, t1)
//! it is at least `g + n . (R1 c + t1) - n . (R0 c + t0) - rho |R1 - R0|`, because
//! `n . R1 v >= n . R0 v - |R1 - R0| |v|`. Sums of `|R1 - R0|` over frames bound that norm
//! ([`Front::turn`]). So an entry is eight numbers, and its test 16 products; nothing of A moves,
//! since n is in A's frame. A budget of path length instead of a direction fails ten times as
//! often.

use alloc::vec::Vec;
use nalgebra::Matrix3;
use wide::f32x8;

use super::frame::{Frame, Single};
use super::tree::OrientedBox;
use crate::num::scalar::sqrt;
use crate::tolerance::{REBASED, TURNED};

/// A node of A and a node of B.
pub(super) type Pair = [u32; 2];

/// Eight entries by component: direction, centre, radius, base.
#[derive(Clone, Debug, PartialEq)]
struct Block([[f32; 8]; 8]);

/// After so much turning the sums begin anew, so that they stay exact enough.
const TURN_MOST: f64 = 2.0;

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Front {
    blocks: Vec<Block>,
    pairs: Vec<Pair>,
    /// The rotation of the last test, and how much the body turned since the entries' common zero.
    rotation: Option<Matrix3<f64>>,
    turn: f64,
    /// The largest error of single precision since the front was empty: entries carry the rounding
    /// of the pose at which they were made.
    error: f32,
    /// Entries at the last cut.
    pub(super) cut: usize,
}

impl Front {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.pairs.clear();
        (self.rotation, self.turn, self.error, self.cut) = (None, 0.0, 0.0, 0);
    }

    pub(super) fn len(&self) -> usize {
        self.pairs.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    pub(super) fn pair(&self, k: usize) -> Pair {
        self.pairs[k]
    }

    pub(super) fn heap_bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>() + self.pairs.capacity() * size_of::<Pair>()
    }

    /// Takes the pose of a query. Must be called before entries are tested or made.
    pub(super) fn turn_to(&mut self, frame: &Frame) {
        if let Some(last) = &self.rotation {
            // A difference of rotations stretches two directions alike and one not at all.
            self.turn += sqrt(0.5 * (frame.rotation - last).norm_squared()) * (1.0 + TURNED) + TURNED;
        }
        self.rotation = Some(frame.rotation);
        self.error = self.error.max(frame.single.error);
        if self.turn > TURN_MOST {
            self.rebase();
        }
    }

    /// Takes the turning so far into every entry and begins to sum anew.
    fn rebase(&mut self) {
        let (turn, lost) = (f32x8::splat(self.turn as f32), f32x8::splat(REBASED * self.error));
        for block in &mut self.blocks {
            let [.., radius, base] = &mut block.0;
            *base = (f32x8::new(*base) - f32x8::new(*radius) * turn - lost).to_array();
        }
        self.turn = 0.0;
    }

    /// Calls `failed` with the number of every entry that is not proven to be at least `distance`
    /// apart, in rising order.
    pub(super) fn test(&self, frame: &Single, distance: f32, mut failed: impl FnMut(usize)) {
        let level = f32x8::splat(distance + self.error);
        let turn = f32x8::splat(self.turn as f32);
        for (k, block) in self.blocks.iter().enumerate() {
            let mut open = !block.gaps(frame, turn).simd_ge(level).to_bitmask() & 0xff;
            while open != 0 {
                let at = 8 * k + open.trailing_zeros() as usize;
                if at < self.pairs.len() {
                    failed(at);
                }
                open &= open - 1;
            }
        }
    }

    /// Calls `each` with every pair and its proven gap at this pose.
    pub(super) fn gaps(&self, frame: &Single, mut each: impl FnMut(Pair, f32)) {
        let turn = f32x8::splat(self.turn as f32);
        for (block, pairs) in self.blocks.iter().zip(self.pairs.chunks(8)) {
            let gaps = block.gaps(frame, turn).to_array();
            pairs
                .iter()
                .zip(gaps)
                .for_each(|(pair, gap)| each(*pair, gap - self.error));
        }
    }

    /// Adds an entry whose gap along `normal` is at least `gap` at this pose.
    pub(super) fn push(&mut self, frame: &Single, pair: Pair, ball: &OrientedBox, normal: [f32; 3], gap: f32) {
        self.pairs.push(pair);
        if self.pairs.len() > 8 * self.blocks.len() {
            self.blocks.push(Block([[0.0; 8]; 8]));
        }
        self.set(frame, self.pairs.len() - 1, ball, normal, gap);
    }

    /// Gives an entry another direction.
    pub(super) fn set(&mut self, frame: &Single, k: usize, ball: &OrientedBox, [x, y, z]: [f32; 3], gap: f32) {
        let s = frame.scale_b;
        let [_, cx, cy, cz, _, _, _, radius] = ball.rows[1].map(|c| c * s);
        let r = frame.rotation.map(first);
        let t = frame.translation.map(first);
        let at = [
            r[0] * cx + r[1] * cy + r[2] * cz + t[0],
            r[3] * cx + r[4] * cy + r[5] * cz + t[1],
            r[6] * cx + r[7] * cy + r[8] * cz + t[2],
        ];
        let base = gap - (x * at[0] + y * at[1] + z * at[2]) + radius * self.turn as f32;
        let block = &mut self.blocks[k / 8].0;
        for (slot, value) in block.iter_mut().zip([x, y, z, cx, cy, cz, radius, base]) {
            slot[k % 8] = value;
        }
    }

    /// Removes an entry; the last one takes its place.
    pub(super) fn remove(&mut self, k: usize) {
        let last = self.pairs.len() - 1;
        self.pairs.swap_remove(k);
        for c in 0..8 {
            let moved = self.blocks[last / 8].0[c][last % 8];
            self.blocks[k / 8].0[c][k % 8] = moved;
        }
        if last.is_multiple_of(8) {
            self.blocks.pop();
        }
    }

    /// Spoils an entry, so that a test can see it found.
    #[cfg(test)]
    pub(super) fn corrupt(&mut self, k: usize, by: f32) {
        self.blocks[k / 8].0[7][k % 8] += by;
    }

    /// The direction of an entry.
    pub(super) fn normal(&self, k: usize) -> [f32; 3] {
        let block = &self.blocks[k / 8].0;
        [block[0][k % 8], block[1][k % 8], block[2][k % 8]]
    }
}

#[inline(always)]
fn first(x: f32x8) -> f32 {
    x.to_array()[0]
}

impl Block {
    #[inline(always)]
    fn gaps(&self, frame: &Single, turn: f32x8) -> f32x8 {
        let [nx, ny, nz, cx, cy, cz, radius, base] = &self.0;
        let (r, t) = (&frame.rotation, &frame.translation);
        let (cx, cy, cz) = (f32x8::new(*cx), f32x8::new(*cy), f32x8::new(*cz));
        let x = r[0] * cx + r[1] * cy + r[2] * cz + t[0];
        let y = r[3] * cx + r[4] * cy + r[5] * cz + t[1];
        let z = r[6] * cx + r[7] * cy + r[8] * cz + t[2];
        let along = f32x8::new(*nx) * x + f32x8::new(*ny) * y + f32x8::new(*nz) * z;
        f32x8::new(*base) + along - f32x8::new(*radius) * turn
    }
}
