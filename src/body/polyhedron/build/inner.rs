//! Points proven strictly inside the hull of a few others, before the hull is built (after Akl and
//! Toussaint 1978).
//!
//! The *core* is the hull of points of the cloud that are extreme along some directions. Seen
//! from a centre inside it, in coordinates `q` relative to the centre, space is cut into
//! pyramids: the eight octants, in each of them cells of a square grid over the shares `|x|` and
//! `|y|` have of `|x| + |y| + |z|`. Each cell stores a bound of the sum up to which its pyramid
//! lies inside the core: one look-up decides a point, however many planes the core has.
//!
//! Why a dropped point is strictly inside, rounding included. Coordinates are relative to the
//! centre and scaled by powers of two, so that each has one rounding, relative to itself; sums of
//! magnitudes, quotients and the position on the grid have six more. So a point is in its cell
//! widened by `CORE_CELL`, and its sum `s` is right to `CORE_CELL`: its place is `s g`, with a
//! `g` of the cell, `|g_k| <= 2` (a cell that the line of shares one crosses counts whole). With
//! `n` the rounded normal of a facet with a corner `a`, `n . g` and `n . a` differ from the exact
//! ones by less than an `e` (`CORE_ERROR`). So the points of a cell are below the facet if
//! `s (max n . g + e) < n . a - e`, and the maximum is at a corner of the cell, because `g` is
//! linear in the shares. What is below all facets of the hull of points of the cloud is strictly
//! inside the cloud's hull. Equal points have equal verdicts, and no point on the surface is ever
//! dropped.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::notice::progress::Watch;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{CORE_CELL, CORE_ERROR, CORE_REACH};
use crate::body::polyhedron::build::cloud::{bounding_box, exponent_of, power_of_two};
use crate::body::polyhedron::build::hull::hull;

/// Cosine and sine of the golden angle.
const GOLDEN: [f64; 2] = [-0.737_368_878_078_319_7, 0.675_490_294_261_523_8];

/// Points that are decided at once.
pub(crate) const BLOCK: usize = 64;

/// Points of a block, coordinate by coordinate.
pub(crate) struct PointBlock {
    pub(crate) at: [[f64; BLOCK]; 3],
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
            let [a, b, c] = t.v.map(|v| place(&points[v as usize]));
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

    /// Returns for each point of a block whether it is proven strictly inside the core.
    #[inline]
    pub(crate) fn holds(&self, block: &PointBlock, inside: &mut [bool; BLOCK]) {
        /// Added to a number below `2^51`, leaves the nearest integer in the lowest bits.
        const ROUND: f64 = 4503599627370496.0;
        let grid = (self.cells - 1) as f64;
        let (row, mask) = (self.cells.trailing_zeros(), self.cells as u64 - 1);
        let mut number = [0u64; BLOCK];
        let mut far = [0.0; BLOCK];
        for k in 0..BLOCK {
            let q = [0, 1, 2].map(|a| (block.at[a][k] - self.centre[a]) * self.scale[a]);
            let [x, y, z] = q.map(f64::abs);
            let sum = x + y + z;
            let by = grid / sum;
            let i = (x * by + ROUND).to_bits() & mask;
            let j = (y * by + ROUND).to_bits() & mask;
            let [a, b, c] = q.map(|x| x.to_bits() >> 63);
            number[k] = ((((c << 1 | b) << 1 | a) << row | i) << row) | j;
            far[k] = sum;
        }
        for k in 0..BLOCK {
            inside[k] = far[k] < self.reach.get(number[k] as usize).map_or(-1.0, |&r| r as f64);
        }
    }
}

/// Returns the distinct points extreme along `directions` directions and their opposites, in the
/// order of the sample.
fn extremes(sample: &[Vector3<f64>], low: &Vector3<f64>, scale: &Vector3<f64>, directions: usize) -> Vec<Vector3<f64>> {
    let placed: [Vec<f64>; 3] = [0, 1, 2].map(|k| sample.iter().map(|p| (p[k] - low[k]) * scale[k]).collect());
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
    points.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)));
    points.dedup();
    points
}
