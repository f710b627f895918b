//! A tree over points in Morton order, in linear time.
//!
//! 1. Each point gets a key: 12 bits per coordinate in the cube around all points, interleaved.
//!    A radix sort orders the keys. Cells that hold many points are sorted again in their own cube,
//!    so that one outlier does not put all other points into one cell.
//! 2. Nodes are split where the highest bit of their keys changes.
//! 3. Large nodes get the axes of their spread, and smaller nodes the axes of the node above.
//! 4. Extents are computed from the leaves upward. Every point stands for a convex element, so the
//!    extents grow by the support values of the element.
//!
//! Positions are rounded to single precision, and heights are those of the stored axes,
//! as in a tree whose vertices have moved (`refit`): the error of a height is the same, and so is
//! the box around the heights.
//!
//! Sources: Morton 1966; trees by common prefixes, Lauterbach et al. 2009, Karras 2012.

use alloc::vec;
use alloc::vec::Vec;
use core::iter::once;
use core::ops::Range;
use nalgebra::{Matrix3, Vector3};
use wide::{f32x4, f32x8};

use super::refit::BoxAxes;
use super::split::axes;
use super::{Below, CLOUD_LEAF, COUNT_SHIFT, LEAF_MARK, OrientedBox, Tree, up};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort_by_key;
use crate::base::tolerance::{BOX_EXTENT, REFIT_HEIGHT, UNIT};
use crate::body::polyhedron::{exponent_of, power_of_two};

/// Bits of a key per coordinate.
const BITS: u32 = 12;

/// Bits of the index below a key.
const INDEX: u32 = 27;

/// Number of buckets of one pass of the radix sort.
const BUCKETS: usize = 1 << BITS;

/// Nodes of at most so many points have the axes of the node above them.
///
/// Axes of their own would cost more in the build than they save in queries.
const GROUP: usize = 64;

/// Number of times that a crowded cell is sorted again. Twelve bits each time resolve any f64.
const REFINEMENTS: usize = 12;

/// Cells with more points are sorted again.
const CROWD: usize = 4 * CLOUD_LEAF;

/// How far the element at a point extends.
pub(in crate::nonconvex) struct ElementExtent<'a> {
    /// Largest distance of a point of any element from its point of the cloud.
    pub(in crate::nonconvex) reach: f64,
    /// The support value of the common part of all elements, for a direction of any length.
    pub(in crate::nonconvex) support: &'a dyn Fn(&Vector3<f64>) -> f64,
    /// The radius around the common part, by the caller's index, if points have their own.
    pub(in crate::nonconvex) round: Option<&'a dyn Fn(u32) -> f64>,
}

/// Spreads twelve bits to every third place.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

fn box_of(points: &[[f64; 3]], of: impl Iterator<Item = u32>) -> (Vector3<f64>, Vector3<f64>) {
    let start = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    of.fold(start, |(low, high), i| {
        let p = Vector3::from(points[i as usize]);
        (low.smaller(p), high.larger(p))
    })
}

/// Puts the points of `order` in Morton order in their cube, and returns their keys.
///
/// Returns no keys if all points are equal.
fn sort_once(points: &[[f64; 3]], order: &mut [u32]) -> Vec<u64> {
    let (low, high) = box_of(points, order.iter().copied());
    let size = (high - low).iter().copied().fold(0.0, f64::larger);
    let last = f64::from((1u32 << BITS) - 1);
    let scale = last / size;
    // Written so that NaN returns no keys.
    if !(size > 0.0 && scale.is_finite()) {
        return Vec::new();
    }
    let mut keys: Vec<u64> = (0u64..)
        .zip(&*order)
        .map(|(at, &i)| {
            let cell = |k: usize| spread(((points[i as usize][k] - low[k]) * scale).smaller(last) as u32);
            (cell(0) << 2 | cell(1) << 1 | cell(2)) << INDEX | at
        })
        .collect();
    let digit = |x: &u64, pass: u32| (x >> (INDEX + BITS * pass)) as usize & (BUCKETS - 1);
    let mut counts = vec![[0u32; 3]; BUCKETS];
    for x in &keys {
        (0..3).for_each(|pass| counts[digit(x, pass)][pass as usize] += 1);
    }
    let mut to = vec![0; keys.len()];
    for pass in 0..3 {
        let column = pass as usize;
        if counts.iter().any(|c| c[column] as usize == keys.len()) {
            continue;
        }
        let mut sum = 0;
        for count in &mut counts {
            sum += core::mem::replace(&mut count[column], sum);
        }
        for x in &keys {
            let slot = &mut counts[digit(x, pass)][column];
            to[*slot as usize] = *x;
            *slot += 1;
        }
        core::mem::swap(&mut keys, &mut to);
    }
    let before = order.to_vec();
    for (to, key) in order.iter_mut().zip(&mut keys) {
        *to = before[(*key & ((1 << INDEX) - 1)) as usize];
        *key >>= INDEX;
    }
    keys
}

/// Returns at most 2^27 points in an order in which neighbours follow each other.
pub(crate) fn order(points: &[[f64; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    sort_once(points, &mut order);
    order
}

/// Returns the order of the points, their keys in the cube around all points, and where many equal
/// points follow each other.
fn sorted(points: &[[f64; 3]]) -> (Vec<u32>, Vec<u64>, Vec<Range<usize>>) {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    let (mut keys, mut equal) = (Vec::new(), Vec::new());
    let mut tasks = vec![(0, 0..points.len())];
    while let Some((depth, range)) = tasks.pop() {
        let cell = &mut order[range.clone()];
        let of_cell = sort_once(points, cell);
        if of_cell.is_empty() && cell.iter().all(|&i| points[i as usize] == points[cell[0] as usize]) {
            equal.push(range.clone());
        }
        if depth <= REFINEMENTS {
            push_crowds(&of_cell, range.start, depth + 1, &mut tasks);
        }
        if depth == 0 {
            keys = of_cell;
        }
    }
    keys.resize(points.len(), 0);
    equal.retain(|range| range.len() > CROWD);
    sort_by_key(&mut equal, |range| range.start);
    (order, keys, equal)
}

/// Moves all but one of many equal points to the end, and removes their keys.
///
/// The one that stays has the largest radius, so that it contains the others.
fn keep_one_of_equals(order: &mut Vec<u32>, keys: &mut Vec<u64>, equal: &[Range<usize>], radius: &dyn Fn(u32) -> f64) {
    let mut hidden: Vec<u32> = Vec::new();
    let (mut kept, mut from) = (0, 0);
    for range in equal.iter().cloned().chain(once(order.len()..order.len())) {
        order.copy_within(from..range.start, kept);
        keys.copy_within(from..range.start, kept);
        kept += range.start - from;
        from = range.end;
        let Some(&first) = order[range.clone()].first() else {
            continue;
        };
        let largest = |best: u32, &i: &u32| if radius(i) > radius(best) { i } else { best };
        let stays = order[range.clone()].iter().fold(first, largest);
        hidden.extend(order[range.clone()].iter().filter(|i| **i != stays));
        (order[kept], keys[kept]) = (stays, keys[range.start]);
        kept += 1;
    }
    keys.truncate(kept);
    order.truncate(kept);
    order.extend(hidden);
}

/// Adds the ranges of many equal keys.
fn push_crowds(keys: &[u64], first: usize, depth: usize, tasks: &mut Vec<(usize, Range<usize>)>) {
    let mut at = first;
    for cell in keys.chunk_by(|x, y| x == y) {
        if cell.len() > CROWD {
            tasks.push((depth, at..at + cell.len()));
        }
        at += cell.len();
    }
}

/// Sums of places, and of their products.
#[derive(Clone, Copy, Default)]
struct PlaceSums {
    count: f64,
    first: [f64; 3],
    second: [f64; 6],
}

impl PlaceSums {
    fn add(&mut self, [x, y, z]: [f64; 3]) {
        self.count += 1.0;
        for (sum, value) in self.first.iter_mut().zip([x, y, z]) {
            *sum += value;
        }
        for (sum, value) in self.second.iter_mut().zip([x * x, x * y, x * z, y * y, y * z, z * z]) {
            *sum += value;
        }
    }

    fn plus(mut self, other: &Self) -> Self {
        self.count += other.count;
        (0..3).for_each(|k| self.first[k] += other.first[k]);
        (0..6).for_each(|k| self.second[k] += other.second[k]);
        self
    }

    fn axes(&self) -> [Vector3<f64>; 3] {
        let mean = Vector3::from(self.first) / self.count;
        let [xx, xy, xz, yy, yz, zz] = self.second.each(|s| s / self.count);
        let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        axes(&(second - mean * mean.transpose())).0
    }
}

/// The axes of a group of nodes, and the support values of the element along them, rounded up.
struct GroupAxes {
    axes: BoxAxes,
    below: f32x4,
    above: f32x4,
}

impl GroupAxes {
    fn new(rows: &[Vector3<f64>; 3], scale: f64, support: &dyn Fn(&Vector3<f64>) -> f64) -> Self {
        let single = rows.each(|r| [r.x as f32, r.y as f32, r.z as f32]);
        let ends = |sign: f64| {
            let [x, y, z] = single.each(|row| up(support(&(Vector3::from(row.each(f64::from)) * sign)) * scale));
            f32x4::new([x, y, z, 0.0])
        };
        Self {
            below: ends(-1.0),
            above: ends(1.0),
            axes: BoxAxes::new(single),
        }
    }
}

/// The positions of all points in the tree's order, one column per coordinate.
type PlaceColumns = [Vec<f32>; 3];

/// The least and the greatest heights along three axes.
type Heights = (f32x4, f32x4);

impl Tree {
    /// Builds a tree over points, each of which stands for an element.
    ///
    /// Returns the tree and the order of the points. There is at least one point and at most 2^27,
    /// and the coordinates are finite. Of more than [`CROWD`] equal points, the tree holds one. The
    /// others are at the end of the order, because pairs of equal points are tied, and a search
    /// would visit them all.
    pub(in crate::nonconvex) fn over_points(points: &[[f64; 3]], element: &ElementExtent<'_>) -> (Self, Vec<u32>) {
        let (mut order, mut keys, equal) = sorted(points);
        keep_one_of_equals(&mut order, &mut keys, &equal, element.round.unwrap_or(&|_| 0.0));
        let held = keys.len();
        let (low, high) = box_of(points, 0..points.len() as u32);
        let centre = low * 0.5 + high * 0.5;
        // At least the rounding of the position.
        let place = low.amax().larger(high.amax()) * UNIT;
        let far = (sqrt(((high - low) * 0.5).norm_squared()) + element.reach).larger(place);
        let exponent = if far > 0.0 { exponent_of(far) } else { 0 };
        let scale = power_of_two(-exponent);
        let mut tree = Self {
            centre,
            exponent,
            ..Self::default()
        };
        tree.link(&keys);
        drop(keys);
        let columns: PlaceColumns = [0, 1, 2].each(|k| {
            let place = |&i: &u32| ((points[i as usize][k] - centre[k]) * scale) as f32;
            order[..held].iter().map(place).collect()
        });
        let far = far * scale * (1.0 + f64::from(f32::EPSILON));
        let slack = up(BOX_EXTENT * (1.0 + 2.0 * far + centre.amax() * scale) + REFIT_HEIGHT * far);
        tree.fit_points(&columns, &order, slack, element);
        let farthest = tree.boxes.iter().map(OrientedBox::reach).fold(0.0f32, f32::larger);
        tree.reach = farthest * (1.0 + 8.0 * f32::EPSILON);
        (tree, order)
    }

    /// Creates the nodes over sorted keys.
    fn link(&mut self, keys: &[u64]) {
        self.links.reserve(4 * keys.len().div_ceil(CLOUD_LEAF));
        self.links.push(0);
        let mut tasks = vec![(0u32, 0..keys.len())];
        while let Some((node, range)) = tasks.pop() {
            let count = range.len();
            if count <= CLOUD_LEAF {
                self.links[node as usize] = LEAF_MARK | (count as u32 - 1) << COUNT_SHIFT | range.start as u32;
                continue;
            }
            let part = &keys[range.clone()];
            let bits = part[0] ^ part[count - 1];
            let left = if bits == 0 {
                count / 2
            } else {
                let bit = 63 - bits.leading_zeros();
                part.partition_point(|key| key >> bit & 1 == 0)
            };
            let child = self.links.len() as u32;
            self.links.extend([0, 0]);
            self.links[node as usize] = child;
            tasks.push((child + 1, range.start + left..range.end));
            tasks.push((child, range.start..range.start + left));
        }
        self.links.shrink_to_fit();
        self.boxes = vec![OrientedBox::default(); self.links.len()];
    }

    fn fit_points(&mut self, columns: &PlaceColumns, order: &[u32], slack: f32, element: &ElementExtent<'_>) {
        let (ranges, sums) = (self.ranges(), self.place_sums(columns));
        let scale = power_of_two(-self.exponent);
        let mut group = vec![0usize; self.links.len()];
        let mut groups: Vec<GroupAxes> = Vec::new();
        for node in 0..self.links.len() {
            if node == 0 || ranges[node].len() > GROUP {
                group[node] = groups.len();
                groups.push(GroupAxes::new(&sums[node].axes(), scale, element.support));
            }
            if let Below::Children(c) = self.below(node as u32) {
                let own = group[node];
                group[c as usize..c as usize + 2].fill(own);
            }
        }
        drop(sums);
        let mut extents = vec![(f32x4::ZERO, f32x4::ZERO); self.links.len()];
        let mut round = vec![0.0f32; if element.round.is_some() { self.links.len() } else { 0 }];
        for node in (0..self.links.len()).rev() {
            let GroupAxes { axes, below, above } = &groups[group[node]];
            let children = match self.below(node as u32) {
                Below::Children(c) => Some([c as usize, c as usize + 1]),
                Below::Leaf(..) => None,
            };
            let (low, high) = match children {
                Some(two) if two.iter().all(|c| group[*c] == group[node]) => {
                    let [(low, high), (other_low, other_high)] = two.each(|c| extents[c]);
                    (low.fast_min(other_low), high.fast_max(other_high))
                }
                _ => heights(columns, ranges[node].clone(), axes),
            };
            extents[node] = (low, high);
            let mut grown = slack;
            if let Some(of_point) = element.round {
                let largest = match children {
                    Some([x, y]) => round[x].larger(round[y]),
                    None => {
                        let of_items = order[ranges[node].clone()].iter().map(|&i| of_point(i));
                        up(of_items.fold(0.0, f64::larger) * scale)
                    }
                };
                round[node] = largest;
                // Axes are longer than one by at most 8 units of single precision.
                grown += largest * (1.0 + 8.0 * f32::EPSILON);
            }
            self.boxes[node] = axes.fitted(low - *below, high + *above, grown);
        }
    }

    /// Returns the sums over the points below each node.
    fn place_sums(&self, columns: &PlaceColumns) -> Vec<PlaceSums> {
        let mut sums = vec![PlaceSums::default(); self.links.len()];
        for node in (0..self.links.len()).rev() {
            sums[node] = match self.below(node as u32) {
                Below::Children(c) => sums[c as usize].plus(&sums[c as usize + 1]),
                Below::Leaf(first, count) => {
                    let mut all = PlaceSums::default();
                    for i in first as usize..(first + count) as usize {
                        all.add([0, 1, 2].each(|k: usize| f64::from(columns[k][i])));
                    }
                    all
                }
            };
        }
        sums
    }
}

/// Returns the least and greatest heights of places along three axes.
fn heights(columns: &PlaceColumns, range: Range<usize>, axes: &BoxAxes) -> Heights {
    let [(xs, rest), (ys, _), (zs, _)] = [0, 1, 2].each(|k: usize| columns[k][range.clone()].as_chunks::<8>());
    let start = (f32x4::splat(f32::MAX), f32x4::splat(-f32::MAX));
    let (mut low, mut high) = (range.end - rest.len()..range.end).fold(start, |(low, high), i| {
        let h = axes.heights(f32x4::new([columns[0][i], columns[1][i], columns[2][i], 0.0]));
        (low.fast_min(h), high.fast_max(h))
    });
    if !xs.is_empty() {
        let (mut lows, mut highs) = ([f32x8::splat(f32::MAX); 3], [f32x8::splat(-f32::MAX); 3]);
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            let [x, y, z] = [x, y, z].each(|c| f32x8::new(*c));
            for (k, axis) in axes.rows.iter().enumerate() {
                let h = x * f32x8::splat(axis[0]) + y * f32x8::splat(axis[1]) + z * f32x8::splat(axis[2]);
                (lows[k], highs[k]) = (lows[k].fast_min(h), highs[k].fast_max(h));
            }
        }
        let [p, q, r] = lows.each(|v| v.to_array().into_iter().fold(f32::MAX, f32::smaller));
        low = low.fast_min(f32x4::new([p, q, r, f32::MAX]));
        let [p, q, r] = highs.each(|v| v.to_array().into_iter().fold(-f32::MAX, f32::larger));
        high = high.fast_max(f32x4::new([p, q, r, -f32::MAX]));
    }
    // The fourth lane is unused, and must stay finite.
    let used = f32x4::new([1.0, 1.0, 1.0, 0.0]);
    (low * used, high * used)
}
