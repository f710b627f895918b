//! Eight boxes fitted at once to the places of their vertices.

use alloc::vec::Vec;
use nalgebra::Vector3;
use wide::{f32x4, f32x8, f64x8};

use super::OrientedBox;
use super::axes::BoxAxes;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::UNIT_SINGLE;

/// Boxes fitted at once.
pub(super) const LANES: usize = 8;

/// Square of the least sine of the angle of two sides of three vertices that have a frame.
pub(super) const NARROW: f64 = 1.0 / (1u64 << 40) as f64;

type Lanes = [f32x8; 3];
/// Axes of eight boxes by axis, coordinate and lane.
pub(super) type StoredAxes = [[[f32; LANES]; 3]; 3];

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
        self.rows.resize(points.len(), f32x4::ZERO);
        self.columns.iter_mut().for_each(|c| c.resize(points.len(), 0.0));
        let [xs, ys, zs] = &mut self.columns;
        let columns = xs.iter_mut().zip(ys).zip(zs);
        let mut farthest = 0.0f64;
        for ((p, row), ((x, y), z)) in points.iter().zip(&mut self.rows).zip(columns) {
            let place = (p - centre) * scale;
            farthest = farthest.at_least(place.norm_squared());
            (*x, *y, *z) = (place.x as f32, place.y as f32, place.z as f32);
            *row = f32x4::new([*x, *y, *z, 0.0]);
        }
        sqrt(farthest) * (1.0 + UNIT_SINGLE)
    }

    /// Returns the heights of a vertex along three axes.
    #[inline(always)]
    pub(super) fn heights_of(&self, vertex: u32, axes: &BoxAxes) -> f32x4 {
        axes.heights(self.rows[vertex as usize])
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
    fn heights(&self, own: core::ops::Range<usize>, others: &[u32], axes: &BoxAxes) -> (f32x4, f32x4) {
        let [xs, ys, zs] = [0, 1, 2].map(|k| self.columns[k][own.clone()].as_chunks::<LANES>());
        let rest = own.end - xs.1.len()..own.end;
        let start = (f32x4::splat(f32::MAX), f32x4::splat(-f32::MAX));
        let singly = rest.map(|v| v as u32).chain(others.iter().copied());
        let (low, high) = singly.fold(start, |(low, high), v| {
            let h = self.heights_of(v, axes);
            (low.fast_min(h), high.fast_max(h))
        });
        if xs.0.is_empty() {
            return (low, high);
        }
        let (mut lows, mut highs) = ([f32x8::splat(f32::MAX); 3], [f32x8::splat(-f32::MAX); 3]);
        for ((x, y), z) in xs.0.iter().zip(ys.0).zip(zs.0) {
            let [x, y, z] = [x, y, z].map(|c| f32x8::new(*c));
            for (k, axis) in axes.rows.iter().enumerate() {
                let h = x * f32x8::splat(axis[0]) + y * f32x8::splat(axis[1]) + z * f32x8::splat(axis[2]);
                (lows[k], highs[k]) = (lows[k].fast_min(h), highs[k].fast_max(h));
            }
        }
        (
            low.fast_min(across(lows, f32x4::fast_min)),
            high.fast_max(across(highs, f32x4::fast_max)),
        )
    }
}

/// Returns the least or the greatest of the lanes of each of three.
#[inline(always)]
fn across(of: Lanes, better: impl Fn(f32x4, f32x4) -> f32x4) -> f32x4 {
    let halves = of.map(|v| {
        let [a, b, c, d, e, f, g, h] = v.to_array();
        better(f32x4::new([a, b, c, d]), f32x4::new([e, f, g, h]))
    });
    let [p, q, r, s] = f32x4::transpose([halves[0], halves[1], halves[2], f32x4::ZERO]);
    better(better(p, q), better(r, s))
}

/// Where the vertices of a node stand.
#[derive(Clone, Copy, Debug)]
pub(super) struct VerticesBelow {
    /// Consecutive ones, from one number to the next.
    pub(super) own: [u32; 2],
    /// The others, as part of a list.
    pub(super) others: [u32; 2],
    /// Of a group, the number after the last node below it.
    pub(super) end: u32,
}

/// Eight nodes as they were when their tree was made.
#[derive(Clone, Debug)]
pub(super) struct EightAtRest {
    pub(super) nodes: [u32; LANES],
    /// Three vertices of each, far from each other.
    pub(super) three: [[u32; LANES]; 3],
    /// The rotation from the frame of the three to the axes, as quaternions; zero if there is none.
    pub(super) rotation: [[f32; LANES]; 4],
    pub(super) below: [VerticesBelow; LANES],
}

impl EightAtRest {
    /// Fits the boxes of the nodes to the places of their vertices, of which `others` lists those
    /// that are not consecutive; heights err by `slack`. Returns how far the boxes reach from the
    /// tree's origin.
    pub(super) fn fit(&self, places: &Places, others: &[u32], slack: f32, boxes: &mut [OrientedBox]) -> f32 {
        let (axes, mut reach) = (self.stored_axes(places, boxes), 0.0f32);
        for (lane, below) in self.below.iter().enumerate() {
            let axes = BoxAxes::new(axes.map(|axis| axis.map(|x| x[lane])));
            let own = below.own[0] as usize..below.own[1] as usize;
            let others = &others[below.others[0] as usize..below.others[1] as usize];
            let (low, high) = places.heights(own, others, &axes);
            let fitted = axes.fitted(low, high, slack);
            reach = reach.larger(fitted.reach());
            boxes[self.nodes[lane] as usize] = fitted;
        }
        reach
    }

    /// Returns the axes as they are stored, by axis, coordinate and lane: turned with the three
    /// vertices, or as they were if these have no frame now.
    #[inline(always)]
    pub(super) fn stored_axes(&self, places: &Places, boxes: &[OrientedBox]) -> StoredAxes {
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
