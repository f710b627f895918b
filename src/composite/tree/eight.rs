//! Eight boxes fitted at once to the places of their vertices.

use alloc::vec::Vec;
use nalgebra::Vector3;
use wide::{f32x4, f32x8, f64x8};

use super::OrientedBox;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{BOX_SKEW, UNIT_SINGLE};

/// Boxes fitted at once.
pub(super) const LANES: usize = 8;

/// Square of the least sine of the angle of two sides of three vertices that have a frame.
pub(super) const NARROW: f64 = 1.0 / (1u64 << 40) as f64;

type Lanes = [f32x8; 3];
type Columns = [[f64x8; 3]; 3];

/// The places of the vertices in the tree's coordinates, in single precision: by vertex and by
/// coordinate.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    rows: Vec<f32x4>,
    columns: [Vec<f32>; 3],
}

impl Places {
    /// Takes the places; returns an upper bound of their distances from the tree's origin.
    pub(super) fn take(&mut self, points: &[Vector3<f64>], centre: &Vector3<f64>, scale: f64) -> f64 {
        self.rows.clear();
        self.columns.iter_mut().for_each(Vec::clear);
        let mut farthest = 0.0f64;
        for p in points {
            let place = (p - centre) * scale;
            farthest = farthest.max(place.norm_squared());
            let [x, y, z] = [place.x as f32, place.y as f32, place.z as f32];
            self.rows.push(f32x4::new([x, y, z, 0.0]));
            for (column, x) in self.columns.iter_mut().zip([x, y, z]) {
                column.push(x);
            }
        }
        sqrt(farthest) * (1.0 + UNIT_SINGLE)
    }

    /// Returns the places of eight vertices.
    #[inline(always)]
    fn gather(&self, vertices: &[u32; LANES]) -> Lanes {
        let row = |k: usize| self.rows[vertices[k] as usize];
        let low = f32x4::transpose([row(0), row(1), row(2), row(3)]);
        let high = f32x4::transpose([row(4), row(5), row(6), row(7)]);
        core::array::from_fn(|k| {
            let ([a, b, c, d], [e, f, g, h]) = (low[k].to_array(), high[k].to_array());
            f32x8::new([a, b, c, d, e, f, g, h])
        })
    }

    /// Returns the least and greatest heights of consecutive vertices and of others.
    fn heights(&self, own: core::ops::Range<usize>, others: &[u32], axes: &[[f32; 3]; 3]) -> ([f32; 3], [f32; 3]) {
        let (mut low, mut high) = ([f32x8::splat(f32::MAX); 3], [f32x8::splat(-f32::MAX); 3]);
        let mut take = |[x, y, z]: Lanes| {
            for k in 0..3 {
                let h = x * f32x8::splat(axes[k][0]) + y * f32x8::splat(axes[k][1]) + z * f32x8::splat(axes[k][2]);
                (low[k], high[k]) = (low[k].fast_min(h), high[k].fast_max(h));
            }
        };
        let [xs, ys, zs] = [0, 1, 2].map(|k| self.columns[k][own.clone()].as_chunks::<LANES>());
        for ((x, y), z) in xs.0.iter().zip(ys.0).zip(zs.0) {
            take([f32x8::new(*x), f32x8::new(*y), f32x8::new(*z)]);
        }
        // The last ones again in the lanes that are left.
        let rest = own.end - xs.1.len()..own.end;
        if let Some(&last) = rest.clone().last().as_ref() {
            take(self.gather(&core::array::from_fn(|k| (rest.start + k).min(last) as u32)));
        }
        for eight in others.chunks(LANES) {
            take(self.gather(&core::array::from_fn(|k| eight[k.min(eight.len() - 1)])));
        }
        (
            low.map(|v| v.to_array().into_iter().fold(f32::MAX, f32::min)),
            high.map(|v| v.to_array().into_iter().fold(-f32::MAX, f32::max)),
        )
    }
}

/// Where the vertices of eight nodes stand.
#[derive(Clone, Debug)]
pub(super) enum Below8 {
    /// Of small nodes: the first and the last round of a list, one vertex of each node a round.
    Rounds(u32, u32),
    /// Of large ones, for each node: consecutive vertices, and the first and last of a list.
    Ranges([[u32; 4]; LANES]),
}

/// Eight nodes as they were when their tree was made.
#[derive(Clone, Debug)]
pub(super) struct EightAtRest {
    pub(super) nodes: [u32; LANES],
    /// Three vertices of each, far from each other.
    pub(super) three: [[u32; LANES]; 3],
    /// The rotation from the frame of the three to the axes, as quaternions; zero if there is none.
    pub(super) rotation: [[f32; LANES]; 4],
    pub(super) below: Below8,
}

impl EightAtRest {
    /// Fits the boxes of the nodes to the places of their vertices; heights err by `slack`. Returns
    /// how far the boxes reach from the tree's origin.
    pub(super) fn fit(
        &self,
        places: &Places,
        (rounds, others): (&[[u32; LANES]], &[u32]),
        slack: f32,
        boxes: &mut [OrientedBox],
    ) -> f32 {
        let axes = self.stored_axes(places, boxes);
        let lanes: [Lanes; 3] = axes.map(|axis| axis.map(f32x8::new));
        let (low, high) = match &self.below {
            Below8::Rounds(first, last) => heights(places, &rounds[*first as usize..*last as usize], &lanes),
            Below8::Ranges(ranges) => {
                let (mut low, mut high) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
                for (lane, &[first, last, from, to]) in ranges.iter().enumerate() {
                    let own = first as usize..last as usize;
                    let axes = axes.map(|axis| axis.map(|x| x[lane]));
                    let found = places.heights(own, &others[from as usize..to as usize], &axes);
                    for k in 0..3 {
                        (low[k][lane], high[k][lane]) = (found.0[k], found.1[k]);
                    }
                }
                (low.map(f32x8::new), high.map(f32x8::new))
            }
        };
        let fitted = FittedEight::new(lanes, low, high, slack);
        self.nodes
            .iter()
            .enumerate()
            .for_each(|(lane, &node)| boxes[node as usize] = fitted.of(lane));
        fitted.reach()
    }

    /// Returns the axes as they are stored, by axis, coordinate and lane: turned with the three
    /// vertices, or as they were if these have no frame now.
    #[inline(always)]
    fn stored_axes(&self, places: &Places, boxes: &[OrientedBox]) -> [[[f32; LANES]; 3]; 3] {
        let (axes, exists) = self.axes(places);
        let mut stored = axes.map(|axis| axis.map(|x| x.to_array().map(|x| x as f32)));
        for lane in (0..LANES).filter(|lane| !exists[*lane]) {
            let old = &boxes[self.nodes[lane] as usize].rows;
            for k in 0..9 {
                stored[k / 3][k % 3][lane] = old[k / 4][k % 4];
            }
        }
        stored
    }

    /// Returns the axes in double precision, and which of them exist.
    #[inline(always)]
    fn axes(&self, places: &Places) -> (Columns, [bool; LANES]) {
        let at = |k: usize| places.gather(&self.three[k]).map(double);
        let (a, b, c) = (at(0), at(1), at(2));
        let (side, other) = (minus(&b, &a), minus(&c, &a));
        let normal = cross(&side, &other);
        let [x, y, z, w] = self.rotation.map(|q| double(f32x8::new(q)));
        let norm = x * x + y * y + z * z + w * w;
        let (square, area) = (dot(&side, &side), dot(&normal, &normal));
        let narrow = (f64x8::splat(NARROW) * square * dot(&other, &other)).to_array();
        let (areas, norms) = (area.to_array(), norm.to_array());
        // Written so that NaN is none.
        let exists = core::array::from_fn(|k| areas[k] > narrow[k] && areas[k] > f64::MIN_POSITIVE && norms[k] > 0.5);
        let one = f64x8::splat(1.0);
        let (per_side, per_area) = (one / square.sqrt(), one / area.sqrt());
        let (e, n) = (side.map(|x| x * per_side), normal.map(|x| x * per_area));
        let f = cross(&n, &e);
        // The columns of the rotation in the frame of the three.
        let s = f64x8::splat(2.0) / norm;
        let (xs, ys, zs) = (x * s, y * s, z * s);
        let rotated = [
            [one - (y * ys + z * zs), x * ys + w * zs, x * zs - w * ys],
            [x * ys - w * zs, one - (x * xs + z * zs), y * zs + w * xs],
            [x * zs + w * ys, y * zs - w * xs, one - (x * xs + y * ys)],
        ];
        let axes = rotated.map(|[p, q, r]| core::array::from_fn(|k| e[k] * p + f[k] * q + n[k] * r));
        (axes, exists)
    }
}

/// Returns the least and greatest heights of the vertices of eight nodes, one of each a round.
#[inline(always)]
fn heights(places: &Places, rounds: &[[u32; LANES]], axes: &[Lanes; 3]) -> (Lanes, Lanes) {
    let (mut low, mut high) = ([f32x8::splat(f32::MAX); 3], [f32x8::splat(-f32::MAX); 3]);
    for vertices in rounds {
        let [x, y, z] = places.gather(vertices);
        for k in 0..3 {
            let h = x * axes[k][0] + y * axes[k][1] + z * axes[k][2];
            (low[k], high[k]) = (low[k].fast_min(h), high[k].fast_max(h));
        }
    }
    (low, high)
}

/// Eight boxes by component.
struct FittedEight {
    axes: [[[f32; LANES]; 3]; 3],
    centre: [[f32; LANES]; 3],
    half: [[f32; LANES]; 3],
    radius: [f32; LANES],
}

impl FittedEight {
    /// Returns boxes that hold all points whose heights along the axes as stored are at least `low`
    /// and at most `high`, up to `slack`, the longest side first.
    ///
    /// Heights `h` about the centre are the coordinates `s` of a point, `p = sum of s_k axis_k`, up
    /// to the products of the axes: `h = G s` with the matrix G of products, which is the unit
    /// matrix up to `e = 8 UNIT_SINGLE` in every place. So `|s_k - h_k| <= e sum |s_j|`, and `sum
    /// |s_j| <= sum |h_j| / (1 - 3 e)`; `|p|^2 = s . G s <= (1 + 3 e) |s|^2`. The last factors hold
    /// the roundings of the sums of positive numbers.
    #[inline(always)]
    fn new(mut axes: [Lanes; 3], mut low: Lanes, mut high: Lanes, slack: f32) -> Self {
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            let swaps = (high[j] - low[j]).simd_gt(high[i] - low[i]);
            let swap = |p: &mut f32x8, q: &mut f32x8| (*p, *q) = (swaps.select(*q, *p), swaps.select(*p, *q));
            let (first, second) = axes.split_at_mut(j);
            for (p, q) in first[i].iter_mut().zip(&mut second[0]) {
                swap(p, q);
            }
            for side in [&mut low, &mut high] {
                let (first, second) = side.split_at_mut(j);
                swap(&mut first[i], &mut second[0]);
            }
        }
        let middle = |k: usize| (low[k] + high[k]) * f32x8::splat(0.5);
        let (p, q, r) = (middle(0), middle(1), middle(2));
        let centre: Lanes = core::array::from_fn(|k| axes[0][k] * p + axes[1][k] * q + axes[2][k] * r);
        let reach: Lanes = core::array::from_fn(|k| {
            let at = axes[k][0] * centre[0] + axes[k][1] * centre[1] + axes[k][2] * centre[2];
            (high[k] - at).fast_max(at - low[k]) + f32x8::splat(slack)
        });
        let skew = (reach[0] + reach[1] + reach[2]) * f32x8::splat(BOX_SKEW as f32);
        let up = f32x8::splat(1.0 + 8.0 * f32::EPSILON);
        let half = reach.map(|h| (h + skew) * up);
        let square = half[0] * half[0] + half[1] * half[1] + half[2] * half[2];
        let radius = square.sqrt() * f32x8::splat(1.0 + 3.0 * BOX_SKEW as f32) * up;
        Self {
            axes: axes.map(|axis| axis.map(|x| x.to_array())),
            centre: centre.map(|x| x.to_array()),
            half: half.map(|x| x.to_array()),
            radius: radius.to_array(),
        }
    }

    /// Returns one of the boxes.
    #[inline(always)]
    fn of(&self, k: usize) -> OrientedBox {
        let ([x, y, z], [p, q, r], [a, b, c]) = (self.axes, self.centre, self.half);
        OrientedBox {
            rows: [
                [x[0][k], x[1][k], x[2][k], y[0][k]],
                [y[1][k], y[2][k], z[0][k], z[1][k]],
                [z[2][k], p[k], q[k], r[k]],
                [a[k], b[k], c[k], self.radius[k]],
            ],
        }
    }

    /// Returns how far the boxes reach from the tree's origin, up to rounding.
    #[inline(always)]
    fn reach(&self) -> f32 {
        let [x, y, z] = self.centre.map(f32x8::new);
        let reach = (x * x + y * y + z * z).sqrt() + f32x8::new(self.radius);
        reach.to_array().into_iter().fold(0.0, f32::max)
    }
}

#[inline(always)]
fn double(x: f32x8) -> f64x8 {
    f64x8::new(x.to_array().map(f64::from))
}

#[inline(always)]
fn minus(a: &[f64x8; 3], b: &[f64x8; 3]) -> [f64x8; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: &[f64x8; 3], b: &[f64x8; 3]) -> f64x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: &[f64x8; 3], b: &[f64x8; 3]) -> [f64x8; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
