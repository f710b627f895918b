//! The front of the last answer: pairs of nodes, each with the direction that proved it far enough
//! apart.
//!
//! Let X and Y be the points below two nodes, each in the frame of its body. Let Y lie in the ball
//! of radius rho around c, and let `y -> R y + t` map the frame of Y to the frame of X. If the gap
//! along a unit direction n in the frame of X is at least g at the pose (R0, t0), the gap at (R1,
//! t1) is at least
//!
//! `g + n . (R1 c + t1) - n . (R0 c + t0) - rho |R1^T n - R0^T n|`,
//!
//! because no point of X moves in its own frame and `n . (R1 - R0) v >= -|(R1 - R0)^T n| |v|`. So
//! an entry consists of the eleven numbers n, `m = R0^T n`, c, rho and
//! `base = g - n . (R0 c + t0)`. The bound depends only on the two poses, not on the path or the
//! distance that the bodies moved in between. A rotation about n does not weaken it.
//!
//! If a node is long, a ball fits it badly. If all points of Y are within rho of the segment from
//! `c - u` to `c + u`, the last term is `|u . w| + rho |w|` with `w = R1^T n - R0^T n`. It is small
//! if the node rotates about its length. So an entry consists of the eleven numbers and u. For
//! nearly all entries the ball is enough and u is zero. Blocks of entries without a segment skip
//! its term.
//!
//! X is the larger of the two nodes, so rho is the radius of the smaller. A budget of path length
//! instead of a direction fails ten times as often.
//!
//! For debugging, [`audit`] compares every claim of the front with all vertices below the nodes of
//! the entry, and checks that the front covers all pairs.

pub(super) mod memory;
pub(super) mod self_front;

use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::Vector3;
use wide::f32x8;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort_by_key;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::box_gaps::WIDTH;
use crate::nonconvex::query::frame::{Single, TreeFrame, TreeMoves, Way};
use crate::nonconvex::query::search::GapProof;
use crate::nonconvex::tree::{OrientedBox, Paths, Tree};

/// Largest number of entries of a front; a longer front is dropped.
///
/// An entry takes 64 bytes, so a front takes 2 MB, and twice as much while vectors grow. If each of
/// two linked rings of 100,000 triangles is in the middle of the other's hole, the front has about
/// 30,000 entries.
const MOST_ENTRIES: usize = 1 << 15;

/// A node of A and a node of B.
pub(super) type NodePair = [u32; 2];

/// Number of components of an entry.
const NUMBERS: usize = 14;

/// Index of the base in the components.
const BASE: usize = 10;

/// Eight entries by component: n, m, c, the radius, the base and u.
#[derive(Clone, Debug, PartialEq)]
struct FrontBlock {
    numbers: [[f32; WIDTH]; NUMBERS],
    /// Whether an entry of the block has a segment, or had one.
    has_rods: bool,
}

/// The entries whose larger node belongs to one of the bodies.
#[derive(Clone, Debug, Default, PartialEq)]
struct FrontHalf {
    blocks: Vec<FrontBlock>,
    pairs: Vec<NodePair>,
    /// The paths of both nodes that are already subtracted from the bases.
    ///
    /// They are zero for entries beyond the end of the list. The list is empty for bodies that do
    /// not bend.
    paths: Vec<[u32; 2]>,
}

/// The position of an entry: the half, and the index in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EntryId {
    half: u8,
    at: u32,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Front {
    /// Entries with directions in A's frame, then entries with directions in B's frame.
    halves: [FrontHalf; 2],
    /// The largest error of single precision since the front was empty.
    ///
    /// It is the largest because entries contain the rounding of the pose at which they were
    /// created.
    error: f32,
    /// Number of entries when the front was last built from the roots.
    pub(super) cut: usize,
}

impl Front {
    pub(super) fn clear(&mut self) {
        for half in &mut self.halves {
            half.blocks.clear();
            half.pairs.clear();
            half.paths.clear();
        }
        (self.error, self.cut) = (0.0, 0);
    }

    pub(super) fn len(&self) -> usize {
        self.halves[0].pairs.len() + self.halves[1].pairs.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns whether the front takes no more entries.
    ///
    /// Then it does not cover all pairs and must be cleared at the end of the query.
    pub(super) fn is_full(&self) -> bool {
        self.len() >= MOST_ENTRIES
    }

    #[cfg(feature = "__internals")]
    pub(super) fn pairs(&self) -> impl Iterator<Item = NodePair> + '_ {
        self.halves.iter().flat_map(|h| h.pairs.iter().copied())
    }

    pub(super) fn pair(&self, place: EntryId) -> NodePair {
        self.halves[place.half as usize].pairs[place.at as usize]
    }

    pub(super) fn memory_usage(&self) -> usize {
        let of = |h: &FrontHalf| {
            h.blocks.capacity() * size_of::<FrontBlock>()
                + (h.pairs.capacity() + h.paths.capacity()) * size_of::<NodePair>()
        };
        self.halves.iter().map(of).sum()
    }

    /// Takes the error of a pose; must be called before entries are tested or created.
    pub(super) fn meet(&mut self, frame: &Single) {
        self.error = self.error.larger(frame.error);
    }

    /// Returns whether points below entries may have moved in their frames since they were created.
    pub(super) fn has_moved(&self) -> bool {
        self.halves.iter().any(|h| !h.paths.is_empty())
    }

    /// Reduces the base of every entry by how far points below its nodes have moved since the last
    /// call.
    ///
    /// Heights along a unit direction change by no more. The direction may be longer than one by
    /// some UNIT_SINGLE. `tolerance::BOXES` has room for this, because an entry
    /// that loses more than L fails.
    pub(super) fn follow(&mut self, moves: &TreeMoves) {
        let [a, b] = moves.trees;
        for half in &mut self.halves {
            half.paths.resize(half.pairs.len(), [0; 2]);
            for (k, (pair, counted)) in half.pairs.iter().zip(&mut half.paths).enumerate() {
                let now = [a.paths.of(pair[0]), b.paths.of(pair[1])];
                if now == *counted {
                    continue;
                }
                let length = |k: usize| Paths::length(now[k].wrapping_sub(counted[k])) * moves.scales[k];
                let base = &mut half.blocks[k / WIDTH].numbers[BASE][k % WIDTH];
                *base = (*base - (length(0) + length(1)).next_up()).next_down();
                *counted = now;
            }
        }
    }

    /// Calls `failed` with every entry that is not proven to be at least `distance` apart.
    ///
    /// In each half, the indices rise.
    pub(super) fn test(&self, frame: &Single, distance: f32, mut failed: impl FnMut(EntryId)) {
        let level = f32x8::splat(distance + self.error);
        for (half, (entries, way)) in (0u8..).zip(self.halves.iter().zip(&frame.ways)) {
            for (k, block) in (0u32..).zip(&entries.blocks) {
                let mut open = !block.gaps(way).simd_ge(level).to_bitmask() & 0xff;
                while open != 0 {
                    let at = WIDTH as u32 * k + open.trailing_zeros();
                    if (at as usize) < entries.pairs.len() {
                        failed(EntryId { half, at });
                    }
                    open &= open - 1;
                }
            }
        }
    }

    /// Calls `each` with every entry, its pair and the gap that it proves at this pose.
    pub(super) fn gaps(&self, frame: &Single, mut each: impl FnMut(EntryId, NodePair, f32)) {
        for (half, (entries, way)) in (0u8..).zip(self.halves.iter().zip(&frame.ways)) {
            for (k, (block, pairs)) in (0u32..).zip(entries.blocks.iter().zip(entries.pairs.chunks(WIDTH))) {
                for (at, (pair, gap)) in (WIDTH as u32 * k..).zip(pairs.iter().zip(block.gaps(way).to_array())) {
                    each(EntryId { half, at }, *pair, gap - self.error);
                }
            }
        }
    }

    /// Adds an entry with a gap that is proven at this pose, unless the front is full.
    pub(super) fn push(&mut self, frame: &Single, trees: [&Tree; 2], pair: NodePair, proof: GapProof) {
        if self.is_full() {
            return;
        }
        let half = half(frame, trees, pair);
        let entries = &mut self.halves[half as usize];
        let at = entries.pairs.len() as u32;
        entries.pairs.push(pair);
        if entries.pairs.len() > WIDTH * entries.blocks.len() {
            entries.blocks.push(FrontBlock::EMPTY);
        }
        self.set(frame, trees, EntryId { half, at }, proof);
    }

    /// Replaces the direction and the gap of an entry.
    pub(super) fn set(&mut self, frame: &Single, [a, b]: [&Tree; 2], place: EntryId, proof: GapProof) {
        let GapProof { normal, gap } = proof;
        let entries = &mut self.halves[place.half as usize];
        let [x, y] = entries.pairs[place.at as usize];
        let way = &frame.ways[place.half as usize];
        let (ball, scale, n) = if place.half == 0 {
            (&b.boxes[y as usize], frame.scale_b, normal)
        } else {
            let n = frame.ways[0].back(normal).each(|x| -x);
            (&a.boxes[x as usize], frame.scale_a, n)
        };
        let [_, cx, cy, cz] = ball.rows[2].each(|c| c * scale);
        let (radius, [ux, uy, uz]) = ball.rod(scale);
        let (m, base) = claim(way, n, [cx, cy, cz], gap);
        let values = [n[0], n[1], n[2], m[0], m[1], m[2], cx, cy, cz, radius, base, ux, uy, uz];
        entries.blocks[place.at as usize / WIDTH].set(place.at as usize % WIDTH, values);
        if a.bends() || b.bends() {
            entries.paths.resize(entries.pairs.len(), [0; 2]);
            entries.paths[place.at as usize] = [a.paths.of(x), b.paths.of(y)];
        }
    }

    /// Removes an entry; the last entry of its half moves to its index.
    pub(super) fn remove(&mut self, place: EntryId) {
        let (entries, k) = (&mut self.halves[place.half as usize], place.at as usize);
        let last = entries.pairs.len() - 1;
        entries.pairs.swap_remove(k);
        if !entries.paths.is_empty() {
            entries.paths.resize(last + 1, [0; 2]);
            entries.paths.swap_remove(k);
        }
        for c in 0..NUMBERS {
            let moved = entries.blocks[last / WIDTH].numbers[c][last % WIDTH];
            entries.blocks[k / WIDTH].numbers[c][k % WIDTH] = moved;
        }
        entries.blocks[k / WIDTH].has_rods |= entries.blocks[last / WIDTH].has_rods;
        if last.is_multiple_of(WIDTH) {
            entries.blocks.pop();
        }
    }

    /// Increases the claim of an entry, so that a test can check the audit.
    #[cfg(test)]
    pub(super) fn corrupt(&mut self, place: EntryId, by: f32) {
        self.halves[place.half as usize].blocks[place.at as usize / WIDTH].numbers[BASE][place.at as usize % WIDTH] +=
            by;
    }

    /// Returns the position of an entry by its index in the whole front.
    #[cfg(test)]
    pub(super) fn place(&self, k: usize) -> EntryId {
        let first = self.halves[0].pairs.len();
        let (half, at) = if k < first { (0, k) } else { (1, k - first) };
        EntryId { half, at: at as u32 }
    }

    /// Returns the direction of an entry at a pose, in A's frame.
    pub(super) fn normal(&self, frame: &Single, place: EntryId) -> [f32; 3] {
        let block = &self.halves[place.half as usize].blocks[place.at as usize / WIDTH].numbers;
        let n = [0, 1, 2].each(|c| block[c][place.at as usize % WIDTH]);
        if place.half == 0 {
            n
        } else {
            frame.ways[1].back(n).each(|x| -x)
        }
    }
}

/// Returns the direction in the other frame, and the base of an entry.
#[inline(always)]
fn claim(way: &Way, n: [f32; 3], centre: [f32; 3], gap: f32) -> ([f32; 3], f32) {
    let [x, y, z] = way.place(centre);
    (way.back(n), gap - (n[0] * x + n[1] * y + n[2] * z))
}

/// Returns the direction and base of an entry, and the gap that it proves at another pose.
///
/// The tests of the error bounds use it. The last two arguments are the radius and a segment.
#[cfg(feature = "__proofs")]
pub(crate) fn entry_at(
    [made, now]: [Way; 2],
    n: [f32; 3],
    gap: f32,
    centre: [f32; 3],
    radius: f32,
    [ux, uy, uz]: [f32; 3],
) -> ([f32; 3], f32, f32) {
    let (m, base) = claim(&made, n, centre, gap);
    let [cx, cy, cz] = centre;
    let mut block = FrontBlock::EMPTY;
    block.set(
        0,
        [n[0], n[1], n[2], m[0], m[1], m[2], cx, cy, cz, radius, base, ux, uy, uz],
    );
    (m, base, block.gaps(&now).to_array()[0])
}

/// Returns the half to which the entry of a pair belongs: the half of the larger node.
fn half(frame: &Single, [a, b]: [&Tree; 2], [x, y]: NodePair) -> u8 {
    let radius = |b: &OrientedBox, scale: f32| b.radius() * scale;
    u8::from(radius(&a.boxes[x as usize], frame.scale_a) < radius(&b.boxes[y as usize], frame.scale_b))
}

impl FrontBlock {
    const EMPTY: Self = Self {
        numbers: [[0.0; WIDTH]; NUMBERS],
        has_rods: false,
    };

    /// Writes the components of one entry.
    fn set(&mut self, lane: usize, values: [f32; NUMBERS]) {
        for (slot, value) in self.numbers.iter_mut().zip(values) {
            slot[lane] = value;
        }
        self.has_rods |= values[11..] != [0.0; 3];
    }

    #[inline(always)]
    fn gaps(&self, way: &Way) -> f32x8 {
        let [nx, ny, nz, mx, my, mz, cx, cy, cz, radius, base, ux, uy, uz] = &self.numbers;
        let (r, t) = (way.rotation.map(f32x8::splat), way.translation.each(f32x8::splat));
        let (nx, ny, nz) = (f32x8::new(*nx), f32x8::new(*ny), f32x8::new(*nz));
        let (cx, cy, cz) = (f32x8::new(*cx), f32x8::new(*cy), f32x8::new(*cz));
        let (x, y, z) = (
            r[0] * nx + r[3] * ny + r[6] * nz,
            r[1] * nx + r[4] * ny + r[7] * nz,
            r[2] * nx + r[5] * ny + r[8] * nz,
        );
        let along = x * cx + y * cy + z * cz + (nx * t[0] + ny * t[1] + nz * t[2]);
        let (p, q, s) = (x - f32x8::new(*mx), y - f32x8::new(*my), z - f32x8::new(*mz));
        let turned = (p * p + q * q + s * s).sqrt();
        let gap = f32x8::new(*base) + along - f32x8::new(*radius) * turned;
        if self.has_rods {
            gap - (p * f32x8::new(*ux) + q * f32x8::new(*uy) + s * f32x8::new(*uz)).abs()
        } else {
            gap
        }
    }
}

/// An error in a front.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum FrontFault {
    /// An entry claims a larger gap along its direction than the vertices have.
    #[error("nodes {} and {} are claimed {claimed} apart and are {gap} apart", pair[0], pair[1])]
    Claim {
        /// A node of A's tree and one of B's.
        pair: [u32; 2],
        /// The gap claimed, in A's stored units.
        claimed: f64,
        /// The gap of all vertices along the entry's direction.
        gap: f64,
    },
    /// A pair of leaves is under no entry, or an entry is stored twice or is under another entry.
    #[error("nodes {} and {} are not covered exactly once", pair[0], pair[1])]
    Cover {
        /// A node of A's tree and one of B's.
        pair: [u32; 2],
    },
}

/// Checks a front at the pose of its last test.
pub(super) fn audit(front: &Front, a: &Mesh, b: &Mesh, frame: &TreeFrame) -> Result<(), FrontFault> {
    let mut entries = BTreeMap::new();
    let mut fault = None;
    front.gaps(&frame.single, |place, pair, gap| {
        if entries.insert(pair, ()).is_some() {
            fault = Some(FrontFault::Cover { pair });
        }
        let n = Vector3::from(front.normal(&frame.single, place).each(f64::from));
        let claimed = f64::from(gap) * frame.single.unit;
        let gap = true_gap(a, b, frame, pair, &n);
        if claimed > gap {
            fault = Some(FrontFault::Claim { pair, claimed, gap });
        }
    });
    if let Some(fault) = fault {
        return Err(fault);
    }
    covers_once(&entries, a, b)
}

/// Checks that every pair of triangles is under exactly one entry.
///
/// No two entries may have a pair in common, and together they must have all pairs. The order in
/// which boxes are split does not matter, because boxes of a mesh that bends change their order of
/// size.
fn covers_once(entries: &BTreeMap<NodePair, ()>, a: &Mesh, b: &Mesh) -> Result<(), FrontFault> {
    let ranges = |&pair: &NodePair| (pair, a.tree.range(pair[0]), b.tree.range(pair[1]));
    let mut all: Vec<_> = entries.keys().map(ranges).collect();
    sort_by_key(&mut all, |(_, of_a, _)| (of_a.start, of_a.end));
    let meet = |x: &Range<u32>, y: &Range<u32>| x.start < y.end && y.start < x.end;
    let mut pairs = 0;
    for (k, (pair, of_a, of_b)) in all.iter().enumerate() {
        pairs += of_a.len() as u64 * of_b.len() as u64;
        let later = all[k + 1..].iter().take_while(|e| e.1.start < of_a.end);
        if later.clone().any(|e| meet(&e.1, of_a) && meet(&e.2, of_b)) {
            return Err(FrontFault::Cover { pair: *pair });
        }
    }
    if pairs == a.triangle_count() as u64 * b.triangle_count() as u64 {
        return Ok(());
    }
    let pair = all.first().map_or([0, 0], |e| e.0);
    Err(FrontFault::Cover { pair })
}

/// Returns the gap of all vertices below two nodes along a direction that is nearly unit.
///
/// Returns zero for a zero direction, with which an entry claims nothing.
fn true_gap(a: &Mesh, b: &Mesh, frame: &TreeFrame, [x, y]: NodePair, n: &Vector3<f64>) -> f64 {
    let length = sqrt(n.norm_squared());
    if length == 0.0 {
        return 0.0;
    }
    let n = n / length;
    let corners = |mesh: &Mesh, node: u32| {
        let range = mesh.tree.range(node);
        range.flat_map(|t| mesh.corners(t)).collect::<Vec<_>>()
    };
    let high = corners(a, x)
        .iter()
        .map(|p| n.dot(p))
        .fold(f64::NEG_INFINITY, f64::larger);
    let low = corners(b, y)
        .iter()
        .map(|p| n.dot(&frame.point(p)))
        .fold(f64::INFINITY, f64::smaller);
    low - high
}

#[cfg(test)]
mod tests {
    extern crate std;
    use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

    use super::*;
    use crate::base::pose::RelativePose;
    use crate::nonconvex::mesh::tracker::MeshTracker;

    /// Returns a torus of `n` times `m` squares around z, with a tube of radius `thick` and waves.
    fn torus(n: u32, m: u32, thick: f64, wave: f64) -> Mesh {
        let angle = |k: u32, of: u32| f64::from(k) * core::f64::consts::TAU / f64::from(of);
        let point = |k: u32| {
            let (u, v) = (angle(k / m, n), angle(k % m, m));
            let tube = thick * (1.0 + wave * (7.0 * u).sin() * (3.0 * v).cos());
            let out = 1.0 + tube * v.cos();
            Point3::new(out * u.cos(), out * u.sin(), tube * v.sin())
        };
        let at = |i: u32, j: u32| (i % n) * m + j % m;
        let square = |i: u32, j: u32| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        let triangles: Vec<_> = squares.flat_map(|(i, j)| square(i, j)).collect();
        let points: Vec<_> = (0..n * m).map(point).collect();
        Mesh::new(&points, &triangles).unwrap()
    }

    #[test]
    fn fronts_hold_what_they_claim_and_a_spoiled_one_is_found() {
        let (a, b) = (torus(40, 20, 0.3, 0.0), torus(30, 20, 0.5, 0.2));
        let mut tracker = MeshTracker::default();
        let turn = UnitQuaternion::new(Vector3::new(0.6, 0.0, 0.8) * 0.009);
        let mut q = UnitQuaternion::identity();
        let (mut entries, mut audited, mut spoiled) = (0, 0, 0);
        for k in 0..400 {
            q = UnitQuaternion::new_normalize((turn * q).into_inner());
            let swing = 0.2 * (0.01 * f64::from(k)).sin();
            let place = Vector3::new(3.0 + swing, 0.3, 0.2);
            let pose = RelativePose::from_isometry(&Isometry3::from_parts(place.into(), q)).unwrap();
            let found = tracker.closest(&a, &b, &pose);
            if k % 10 != 9 {
                continue;
            }
            assert_eq!(tracker.audit(&a, &b, &pose), Ok(()), "{k}");
            if tracker.front_len() == 0 {
                // Two triangles that meet prove the contact state; no front is needed.
                assert!(found.distance <= 0.0, "{k}: no front at {}", found.distance);
                continue;
            }
            audited += 1;
            entries += tracker.front_len();
            let mut worse = tracker.clone();
            worse.spoil(k as usize, 0.5);
            spoiled += u32::from(matches!(worse.audit(&a, &b, &pose), Err(FrontFault::Claim { .. })));
            worse = tracker.clone();
            worse.drop_entry(k as usize);
            assert!(matches!(worse.audit(&a, &b, &pose), Err(FrontFault::Cover { .. })));
        }
        assert!(
            entries > 2000 && audited > 30 && spoiled == audited,
            "{entries} {audited} {spoiled}"
        );
    }
}
