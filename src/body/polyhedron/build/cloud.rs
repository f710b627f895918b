//! From the caller's points to stored coordinates, which are checked, shifted, scaled, sorted and
//! without duplicates. If there are many points, those that are proven strictly inside the hull of
//! a few others are dropped before the hull is built (after Akl and Toussaint 1978), as follows.
//!
//! The *core* is the hull of points of the cloud that are extreme along some directions. Space is
//! divided into pyramids around a centre inside the core, in coordinates `q` relative to the
//! centre. There are eight octants, and each has the cells of a square grid over the fractions of
//! `|x|` and `|y|` in `|x| + |y| + |z|`. Each cell stores a bound of the sum up to which its
//! pyramid lies inside the core. So one look-up decides a point, for any number of planes of the
//! core.
//!
//! Proof that a dropped point is strictly inside, rounding included. Coordinates are relative to
//! the centre and scaled by powers of two, so that each has one rounding, relative to itself. Sums
//! of magnitudes, quotients and the position on the grid have six more. So a point is in its cell
//! enlarged by `CORE_CELL`, and its sum `s` has an error of at most `CORE_CELL`. Its position is `s
//! g`, with a `g` of the cell, `|g_k| <= 2` (a cell that is crossed by the line on which the
//! fractions add up to one counts completely). Let `n` be the rounded normal of a facet with a
//! vertex `a`. Then `n . g` and `n . a` differ from the exact values by less than an `e`
//! (`CORE_ERROR`). So the points of a cell are below the facet if `s (max n . g + e) < n . a - e`,
//! and the maximum is at a corner of the cell, because `g` is linear in the fractions. A point
//! below all facets of the hull of points of the cloud is strictly inside the cloud's hull. Equal
//! points have equal results, and no point on the surface is ever dropped.

use crate::base::callbacks::Watch;
use crate::base::num::double_double::two_sum;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Extremes, largest};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::tolerance::{CORE_CELL, CORE_ERROR, CORE_REACH, EXPONENT_FREE, EXTENT_MAX, FLUSH_EXPONENT, PLACE_MAX};
use crate::body::polyhedron::build::error::BuildError;
use crate::body::polyhedron::build::hull::hull;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

/// Largest number of points accepted: a body of n vertices has fewer than 6 n half-edges, each with
/// a 32-bit number.
const POINTS_MAX: usize = 1 << 29;

/// Largest number of points among which the points of a core are searched.
const SAMPLE: usize = 8192;
/// Directions of the first core, and as many opposite ones.
const DIRECTIONS: usize = 16;

/// Distinct points in stored coordinates, in Morton order: points adjacent in space are adjacent in
/// memory.
pub(crate) struct Cloud {
    pub(crate) points: Vec<Vector3<f64>>,
    /// The caller's index of each point, the lowest among equal points.
    pub(crate) source: Vec<u32>,
    /// Equal points as the caller's indices `(dropped, kept)`.
    pub(crate) duplicates: Vec<(u32, u32)>,
    pub(crate) origin: Vector3<f64>,
    pub(crate) exponent: i32,
    pub(crate) flushed: usize,
    /// Points proven strictly inside the hull and left out: bit `i % 64` of word `i / 64` for the
    /// caller's index `i`. Empty if no points were left out.
    pub(crate) inside: Vec<u64>,
    /// Number of points given, used or not.
    pub(crate) given: usize,
}

/// Returns `2^k` for `|k| < 1022`.
pub(crate) fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((1023 + k.clamp(-1022, 1022)) as u64) << 52)
}

/// Returns the `k` with `2^k <= x < 2^(k+1)` of a normal positive number.
pub(crate) fn exponent_of(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// Returns odd `m` and `e` with `x = m 2^e`, for a finite number that is not zero.
#[cfg(feature = "exact")]
pub(crate) fn odd_part(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (field, fraction) = (((bits >> 52) & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (m, e) = if field == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, field - 1075)
    };
    let zeros = m.trailing_zeros();
    let m = m >> zeros;
    (if x < 0.0 { -m } else { m }, e + zeros as i32)
}

/// Returns the exponent of the lowest bit set in any of the numbers, if any is not zero.
#[cfg(feature = "exact")]
pub(crate) fn lowest_bit(numbers: impl IntoIterator<Item = f64>) -> Option<i32> {
    numbers.into_iter().filter(|&x| x != 0.0).map(|x| odd_part(x).1).min()
}

impl Cloud {
    /// Makes a cloud of the origin alone.
    pub(crate) fn origin() -> Self {
        Self {
            points: vec![Vector3::zeros()],
            source: vec![0],
            duplicates: Vec::new(),
            origin: Vector3::zeros(),
            exponent: 0,
            flushed: 0,
            inside: Vec::new(),
            given: 1,
        }
    }

    /// Makes a cloud of the points named by `indices`. The indices must exist; `needed` is the
    /// least count accepted, `least` the least extent of different points.
    pub(crate) fn new(given: &[Point3<f64>], indices: Vec<u32>, needed: usize, least: f64) -> Result<Self, BuildError> {
        let points = indices.iter().map(|&i| (i, &given[i as usize]));
        let placement = Placement::new(given.len(), points, needed, least)?;
        let mut flushed = 0;
        let place = |&i: &u32| placement.place(&given[i as usize], &mut flushed);
        let stored: Vec<_> = indices.iter().map(place).collect();
        Ok(Self::sorted(&placement, flushed, indices, stored, given.len()))
    }

    /// Makes a cloud of all points as [`new`](Self::new) does. If there are more than `many`, it
    /// leaves out points that are proven strictly inside the hull.
    pub(crate) fn sifted(given: &[Point3<f64>], needed: usize, many: usize, least: f64) -> Result<Self, BuildError> {
        let count = given.len();
        if count <= many {
            return Self::new(given, (0..count as u32).collect(), needed, least);
        }
        let placement = Placement::new(count, (0..).zip(given), needed, least)?;
        let sample: Vec<_> = given
            .iter()
            .step_by(count.div_ceil(SAMPLE.min(count / 4)))
            .map(|p| placement.place(p, &mut 0))
            .collect();
        let core = InnerHull::new(&sample, DIRECTIONS, if count > 100_000 { 32 } else { 16 });
        let mut flushed = 0;
        let mut inside = vec![0u64; count.div_ceil(BLOCK)];
        let (mut indices, mut stored) = (Vec::new(), Vec::new());
        let mut block = PointBlock { at: [[0.0; BLOCK]; 3] };
        for (number, chunk) in given.chunks(BLOCK).enumerate() {
            placement.place_block(chunk, &mut block, &mut flushed);
            let held = core.as_ref().map_or(0, |core| core.holds(&block, chunk.len()));
            inside[number] = held;
            for k in zeros(held, chunk.len()) {
                indices.push((number * BLOCK + k) as u32);
                stored.push(block.point(k));
            }
        }
        // Again with more directions while it pays.
        let (mut before, mut directions) = (count, DIRECTIONS);
        loop {
            let left = indices.len();
            directions *= 3;
            if 4 * left > 3 * before || left < 400 * directions {
                break;
            }
            let sample: Vec<_> = stored.iter().step_by(left.div_ceil(SAMPLE)).copied().collect();
            let Some(core) = InnerHull::new(&sample, directions, 32) else {
                break;
            };
            let mut kept = 0;
            for start in (0..left).step_by(BLOCK) {
                let end = left.min(start + BLOCK);
                (start..end).for_each(|i| block.set(i - start, &stored[i]));
                let held = core.holds(&block, end - start);
                for i in (start..end).filter(|i| held >> (i - start) & 1 == 1) {
                    inside[indices[i] as usize / BLOCK] |= 1 << (indices[i] as usize % BLOCK);
                }
                for k in zeros(held, end - start) {
                    (indices[kept], stored[kept]) = (indices[start + k], stored[start + k]);
                    kept += 1;
                }
            }
            indices.truncate(kept);
            stored.truncate(kept);
            before = left;
        }
        let cloud = Self::sorted(&placement, flushed, indices, stored, count);
        Ok(Self { inside, ..cloud })
    }

    /// Returns the cloud of stored points, with the caller's index of each point.
    fn sorted(
        placement: &Placement,
        flushed: usize,
        indices: Vec<u32>,
        stored: Vec<Vector3<f64>>,
        given: usize,
    ) -> Self {
        let order = morton_order(&stored, &indices);
        let mut cloud = Self {
            points: Vec::with_capacity(order.len()),
            source: Vec::with_capacity(order.len()),
            duplicates: Vec::new(),
            origin: placement.origin,
            exponent: placement.exponent,
            flushed,
            inside: Vec::new(),
            given,
        };
        for k in order {
            let (point, index) = (stored[k as usize], indices[k as usize]);
            match (cloud.points.last(), cloud.source.last()) {
                (Some(last), Some(&kept)) if *last == point => cloud.duplicates.push((index, kept)),
                _ => {
                    cloud.points.push(point);
                    cloud.source.push(index);
                }
            }
        }
        cloud
    }

    /// Returns the stored coordinates of a given point, without flushing.
    pub(crate) fn place(&self, given: &Point3<f64>) -> Vector3<f64> {
        stored_place(given, &self.origin, self.exponent)
    }

    /// Converts a stored point to the caller's coordinates.
    #[cfg(feature = "exact")]
    pub(crate) fn given_place(&self, stored: &Vector3<f64>) -> Vector3<f64> {
        stored * power_of_two(self.exponent) + self.origin
    }

    /// Returns the diagonal of the bounding box, in stored units.
    pub(crate) fn diagonal(&self) -> f64 {
        let (low, high) = bounding_box(&self.points);
        sqrt((high - low).norm_squared())
    }
}

/// Returns the positions of the zeros among the lowest `count` bits, in ascending order.
fn zeros(bits: u64, count: usize) -> impl Iterator<Item = usize> {
    let mut rest = !bits & (u64::MAX >> (u64::BITS as usize - count));
    core::iter::from_fn(move || {
        let k = (rest != 0).then_some(rest.trailing_zeros() as usize)?;
        rest &= rest - 1;
        Some(k)
    })
}

fn stored_place(given: &Point3<f64>, origin: &Vector3<f64>, exponent: i32) -> Vector3<f64> {
    (given.coords - origin) * power_of_two(-exponent)
}

/// Returns the least and greatest corner of the bounding box.
pub(crate) fn bounding_box<'a>(points: impl IntoIterator<Item = &'a Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let start = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points
        .into_iter()
        .fold(start, |(low, high), p| (low.smaller(*p), high.larger(*p)))
}

/// Returns the origin about which a body is stored, given the middle of its box, half the diagonal
/// of the box, and its points.
///
/// A coordinate is that of the middle if the body is far from its own origin, and zero otherwise.
/// Then the rounding of positions is relative to the size of the body, not to its distance.
pub(crate) fn far_origin(
    middle: &Vector3<f64>,
    radius: f64,
    points: impl Iterator<Item = Vector3<f64>> + Clone,
) -> Vector3<f64> {
    // The shift is exact by Sterbenz' lemma; the check costs nothing and covers the rounding of
    // `middle`.
    Vector3::from_fn(|k, _| {
        let shifts = middle[k].abs() > 2.0 * radius && points.clone().all(|p| two_sum(p[k], -middle[k]).1 == 0.0);
        if shifts { middle[k] } else { 0.0 }
    })
}

/// Returns the magnitude below which stored coordinates count as zero, given half the diagonal of
/// the stored box.
pub(crate) fn flush_below(radius: f64) -> f64 {
    power_of_two(exponent_of(radius) - FLUSH_EXPONENT)
}

/// How the caller's points become stored coordinates.
struct Placement {
    origin: Vector3<f64>,
    exponent: i32,
    /// Magnitude below which stored coordinates become zero.
    flush: f64,
}

impl Placement {
    /// Returns the placement of points, each with the caller's index, of `given` points in all.
    /// Returns an error for fewer than `needed` points, for numbers that are not finite, and for
    /// extents below `least`.
    fn new<'a>(
        given: usize,
        points: impl Iterator<Item = (u32, &'a Point3<f64>)> + Clone,
        needed: usize,
        least: f64,
    ) -> Result<Self, BuildError> {
        if given > POINTS_MAX {
            return Err(BuildError::TooMany { count: given });
        }
        // A product with zero is not a number if the coordinate is not finite. One pass over the
        // points, as memory is what a pass waits for.
        let (mut low, mut high) = bounding_box(None);
        let (mut zeros, mut count) = (Vector3::zeros(), 0);
        for (_, p) in points.clone() {
            (low, high) = (low.smaller(p.coords), high.larger(p.coords));
            zeros += p.coords * 0.0;
            count += 1;
        }
        if zeros != Vector3::zeros() {
            let broken = points.clone().find(|(_, p)| !p.iter().all(|x| x.is_finite()));
            let index = broken.map_or(0, |(i, _)| i as usize);
            return Err(BuildError::NotFinite { index });
        }
        if count < needed {
            return Err(BuildError::TooFewPoints { count, needed });
        }
        let sides = high - low;
        let axis = sides.imax();
        let extent = sides[axis];
        if extent == 0.0 || count == 0 {
            if let Some((i, p)) = points.clone().find(|(_, p)| p.coords.amax() > PLACE_MAX) {
                return Err(BuildError::OutOfRange {
                    index: i as usize,
                    extent: p.coords.amax(),
                });
            }
            // A single point becomes the origin, so the position is not rounded, but for magnitudes
            // that count as zero.
            let place = if count == 0 { Vector3::zeros() } else { low };
            return Ok(Self {
                origin: place.map(|x| if x.abs() < f64::MIN_POSITIVE { 0.0 } else { x }),
                exponent: 0,
                flush: f64::MIN_POSITIVE,
            });
        }
        if !(least..=EXTENT_MAX).contains(&extent) {
            let end = points.clone().find(|(_, p)| p[axis] == high[axis]);
            return Err(BuildError::OutOfRange {
                index: end.map_or(0, |(i, _)| i as usize),
                extent,
            });
        }
        // Half the diagonal, not the distance of the farthest point: the diagonal depends on
        // extreme points only, without rounding in between.
        let middle = low * 0.5 + high * 0.5;
        let radius = sqrt((sides * 0.5).norm_squared());
        let origin = far_origin(&middle, radius, points.clone().map(|(_, p)| p.coords));
        let size = exponent_of(radius);
        // The nearest multiple of the window, so that bodies of similar size share a stored unit,
        // for any unit of the caller.
        let window = 2 * EXPONENT_FREE;
        let exponent = (size + EXPONENT_FREE).div_euclid(window) * window;
        Ok(Self {
            origin,
            exponent,
            flush: flush_below(radius * power_of_two(-exponent)),
        })
    }

    /// Returns the stored coordinates of a given point, and counts those that become zero.
    fn place(&self, given: &Point3<f64>, flushed: &mut usize) -> Vector3<f64> {
        stored_place(given, &self.origin, self.exponent).map(|x| self.flush(x, flushed))
    }

    /// Stores the coordinates of up to [`BLOCK`] given points, and counts those that become zero.
    fn place_block(&self, given: &[Point3<f64>], block: &mut PointBlock, flushed: &mut usize) {
        let unit = power_of_two(-self.exponent);
        for (axis, at) in block.at.iter_mut().enumerate() {
            for (x, p) in at.iter_mut().zip(given) {
                *x = self.flush((p[axis] - self.origin[axis]) * unit, flushed);
            }
        }
    }

    #[inline(always)]
    fn flush(&self, x: f64, flushed: &mut usize) -> f64 {
        let is_small = x.abs() < self.flush;
        *flushed += (is_small & (x != 0.0)) as usize;
        if is_small { 0.0 } else { x } // also turns -0 into 0
    }
}

/// Returns the order of `points` along the Morton curve of their bounding box, equal points by
/// index.
fn morton_order(points: &[Vector3<f64>], indices: &[u32]) -> Vec<u32> {
    let (low, high) = bounding_box(points);
    let extent = if points.is_empty() { 0.0 } else { largest(&(high - low)) };
    let scale = if extent > 0.0 {
        power_of_two(20 - exponent_of(extent))
    } else {
        0.0
    };
    let mut keys: Vec<(u64, u32)> = points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let cell = (p - low) * scale; // below 2^21
            (
                spread(cell.x as u64) << 2 | spread(cell.y as u64) << 1 | spread(cell.z as u64),
                i as u32,
            )
        })
        .collect();
    keys.sort_unstable();
    for run in keys.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        sort(run, |a, b| {
            let (p, q) = (&points[a.1 as usize], &points[b.1 as usize]);
            let by_place = p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z));
            by_place.then(indices[a.1 as usize].cmp(&indices[b.1 as usize]))
        });
    }
    keys.into_iter().map(|k| k.1).collect()
}

/// Inserts two zero bits before each of the low 21 bits.
fn spread(x: u64) -> u64 {
    let x = x & 0x1f_ffff;
    let x = (x | x << 32) & 0x1f_0000_0000_ffff;
    let x = (x | x << 16) & 0x1f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Cosine and sine of the golden angle.
const GOLDEN: [f64; 2] = [-0.737_368_878_078_319_7, 0.675_490_294_261_523_8];

/// Points that are decided at once.
pub(crate) const BLOCK: usize = 64;

/// Points of a block, coordinate by coordinate.
pub(crate) struct PointBlock {
    pub(crate) at: [[f64; BLOCK]; 3],
}

impl PointBlock {
    fn point(&self, k: usize) -> Vector3<f64> {
        Vector3::new(self.at[0][k], self.at[1][k], self.at[2][k])
    }

    fn set(&mut self, k: usize, point: &Vector3<f64>) {
        (0..3).for_each(|axis| self.at[axis][k] = point[axis]);
    }
}

pub(crate) struct InnerHull {
    centre: Vector3<f64>,
    scale: Vector3<f64>,
    cells: usize,
    /// Rounded down, -1 where nothing is proven.
    reach: Vec<f32>,
}

impl InnerHull {
    /// Returns the core of the points extreme among `sample` along `2 directions` directions, with
    /// `cells` squared in an octant, a power of two. `None` if none is proven.
    pub(crate) fn new(sample: &[Vector3<f64>], directions: usize, cells: usize) -> Option<Self> {
        let (low, high) = bounding_box(sample);
        let sides = high - low;
        if sides.iter().any(|side| *side <= 0.0) {
            return None;
        }
        let scale = sides.map(|s| power_of_two(-exponent_of(s)));
        let points = extremes(sample, &low, &scale, directions);
        let surface = hull(&points, &mut Watch::none()).ok()?;
        let mut used = vec![false; points.len()];
        surface
            .triangles
            .iter()
            .flat_map(|t| t.v)
            .for_each(|v| used[v as usize] = true);
        let corners = points.iter().zip(&used).filter(|c| *c.1).map(|c| c.0);
        let count = used.iter().filter(|&&u| u).count() as f64;
        let centre = corners.sum::<Vector3<f64>>() / count;
        let place = |p: &Vector3<f64>| (p - centre).component_mul(&scale);
        let grid = (cells - 1) as f64;
        let mut reach = vec![f64::INFINITY; 8 * cells * cells];
        for t in &surface.triangles {
            let [a, b, c] = t.v.each(|v| place(&points[v as usize]));
            let (u, w) = (b - a, c - a);
            let n = u.cross(&w);
            let error = CORE_ERROR * (u.abs().sum() + w.abs().sum()) + 8.0 * f64::MIN_POSITIVE;
            let height = n.dot(&a) - error;
            if !(height > 0.0) {
                return None;
            }
            for (octant, side) in reach.chunks_exact_mut(cells * cells).enumerate() {
                let signed = |k: usize| if octant >> k & 1 == 1 { -n[k] } else { n[k] };
                // `n . g` is `last` plus the shares times the slopes.
                let last = signed(2);
                let slopes = [signed(0) - last, signed(1) - last];
                // The greatest product with a share of a cell, whose middle is `k / grid`.
                let most = |slope: f64, k: usize| {
                    let (middle, half) = (k as f64 / grid, 0.5 / grid + CORE_CELL);
                    slope * middle + slope.abs() * half
                };
                let slack = error + CORE_ERROR * (last.abs() + slopes[0].abs() + slopes[1].abs());
                for (i, row) in side.chunks_exact_mut(cells).enumerate() {
                    let first = last + slack + most(slopes[0], i);
                    for (j, slot) in row[..(cells + 1 - i).min(cells)].iter_mut().enumerate() {
                        let rise = first + most(slopes[1], j);
                        let bound = height / rise;
                        // A plane that falls away bounds nothing.
                        *slot = if rise > 0.0 && bound < *slot { bound } else { *slot };
                    }
                }
            }
        }
        let round_down = |r: &f64| {
            if r.is_finite() { (*r * CORE_REACH) as f32 } else { -1.0 }
        };
        Some(Self {
            centre,
            scale,
            cells,
            reach: reach.iter().map(round_down).collect(),
        })
    }

    /// Returns which of the first `count` points of a block are proven strictly inside the core:
    /// bit `k` for point `k`.
    #[inline]
    pub(crate) fn holds(&self, block: &PointBlock, count: usize) -> u64 {
        /// Added to a number below `2^51`, leaves the nearest integer in the lowest bits.
        const ROUND: f64 = 4503599627370496.0;
        let grid = (self.cells - 1) as f64;
        let (row, mask) = (self.cells.trailing_zeros(), self.cells as u64 - 1);
        let mut number = [0u64; BLOCK];
        let mut far = [0.0; BLOCK];
        for k in 0..BLOCK {
            let q = [0, 1, 2].each(|a| (block.at[a][k] - self.centre[a]) * self.scale[a]);
            let [x, y, z] = q.each(f64::abs);
            let sum = x + y + z;
            let by = grid / sum;
            let i = (x * by + ROUND).to_bits() & mask;
            let j = (y * by + ROUND).to_bits() & mask;
            let [a, b, c] = q.each(|x| x.to_bits() >> 63);
            number[k] = ((((c << 1 | b) << 1 | a) << row | i) << row) | j;
            far[k] = sum;
        }
        let mut held = 0;
        for k in 0..count.min(BLOCK) {
            let reach = self.reach.get(number[k] as usize).map_or(-1.0, |&r| r as f64);
            held |= ((far[k] < reach) as u64) << k;
        }
        held
    }
}

/// Returns the distinct points extreme along `directions` directions and their opposites, in the
/// order of the sample.
fn extremes(sample: &[Vector3<f64>], low: &Vector3<f64>, scale: &Vector3<f64>, directions: usize) -> Vec<Vector3<f64>> {
    let placed: [Vec<f64>; 3] = [0, 1, 2].each(|k| sample.iter().map(|p| (p[k] - low[k]) * scale[k]).collect());
    let mut heights = vec![0.0; sample.len()];
    let mut found: Vec<u32> = Vec::with_capacity(2 * directions);
    let mut turn = [1.0, 0.0];
    for k in 0..directions {
        // Points of a spiral over the upper half of a sphere.
        let z = (k as f64 + 0.5) / directions as f64;
        let r = sqrt(1.0 - z * z);
        let (x, y) = (r * turn[0], r * turn[1]);
        turn = [
            turn[0] * GOLDEN[0] - turn[1] * GOLDEN[1],
            turn[0] * GOLDEN[1] + turn[1] * GOLDEN[0],
        ];
        let coordinates = placed[0].iter().zip(&placed[1]).zip(&placed[2]);
        for (h, ((px, py), pz)) in heights.iter_mut().zip(coordinates) {
            *h = x * px + y * py + z * pz;
        }
        let mut ends = [[f64::INFINITY; 8], [f64::NEG_INFINITY; 8]];
        let (eights, rest) = heights.as_chunks::<8>();
        for eight in eights {
            for l in 0..8 {
                ends[0][l] = ends[0][l].smaller(eight[l]);
                ends[1][l] = ends[1][l].larger(eight[l]);
            }
        }
        let least = ends[0].iter().chain(rest).fold(f64::INFINITY, |a, &b| a.smaller(b));
        let most = ends[1].iter().chain(rest).fold(f64::NEG_INFINITY, |a, &b| a.larger(b));
        let place = |end: f64| heights.iter().position(|&h| h == end);
        found.extend([least, most].into_iter().filter_map(place).map(|i| i as u32));
    }
    found.sort_unstable();
    found.dedup();
    let mut points: Vec<Vector3<f64>> = found.into_iter().map(|i| sample[i as usize]).collect();
    sort(&mut points, |p, q| {
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z))
    });
    points.dedup();
    points
}
