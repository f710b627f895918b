//! Single-pass verification of a cached surface at a new pose, without roots or divisions.

use alloc::vec::Vec;

use wide::f64x2;

use crate::base::num::scalar::{Vec3, cross, dot, neg, sub};
use crate::base::tolerance::{AGREE_DEPTH, CERTIFICATE, ORIENTATION, UNIT};
use crate::convex::depth::direction::min_height;
use crate::convex::depth::result::Best;
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::MinkowskiPoint;

/// Result of the verification.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum SurfaceState {
    /// The surface encloses the origin and every triangle is beyond the facet: the depth is proven.
    Proven,
    /// The surface encloses the origin; some triangles are below target.
    Encloses,
    /// The origin is not certainly behind every triangle.
    Folded,
}

/// Requirements on a triangle.
pub(super) struct Target {
    /// Normal of the best facet.
    normal: Vec3<f64>,
    /// Required distance of a triangle from the origin.
    height: f64,
    /// Heights above `margin` are certainly positive.
    margin: f64,
    noise: f64,
}

/// Verifies two triangles at a time by SIMD and lists the triangles below target in `below_target`.
pub(super) fn verify_surface(
    triangles: &[[u8; 6]],
    positions: &[Vec3<f64>],
    best: &Best<f64>,
    size: f64,
    below_target: &mut Vec<u32>,
) -> SurfaceState {
    let target = Target::new(best, size);
    let is_deep = target.is_deep();
    let (zero, noise) = (f64x2::splat(0.0), f64x2::splat(target.noise));
    let squared_target = f64x2::splat(target.height * target.height);
    below_target.clear();
    for (k, pair) in triangles.chunks(2).enumerate() {
        let (s, t) = (&pair[0], &pair[pair.len() - 1]);
        let w: [Vec3<f64x2>; 3] = core::array::from_fn(|c| {
            let (p, q) = (&positions[s[c] as usize], &positions[t[c] as usize]);
            core::array::from_fn(|axis| f64x2::new([p[axis], q[axis]]))
        });
        let (n, edges) = normals(&w);
        // All vertices are as high along n as the first, up to rounding.
        let low = dot_pair(&n, &w[0]) - noise * edges;
        let is_beyond = low.simd_gt(zero) & (low * low).simd_ge(squared_target * dot_pair(&n, &n));
        if is_deep && is_beyond.all() {
            continue;
        }
        for (lane, t) in pair.iter().enumerate() {
            match target.judge(&[t[0], t[1], t[2]].map(|c| positions[c as usize])) {
                None => return SurfaceState::Folded,
                Some(true) => {}
                Some(false) => below_target.push((2 * k + lane) as u32),
            }
        }
    }
    if below_target.is_empty() {
        SurfaceState::Proven
    } else {
        SurfaceState::Encloses
    }
}

/// Returns the normals of two triangles, of twice the triangle's area, and the sums of two squared
/// edge lengths.
#[inline(always)]
fn normals(w: &[Vec3<f64x2>; 3]) -> (Vec3<f64x2>, f64x2) {
    let less = |p: &Vec3<f64x2>, q: &Vec3<f64x2>| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (u, v) = (less(&w[1], &w[0]), less(&w[2], &w[0]));
    let n = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    (n, dot_pair(&u, &u) + dot_pair(&v, &v))
}

#[inline(always)]
fn dot_pair(u: &Vec3<f64x2>, v: &Vec3<f64x2>) -> f64x2 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

impl Target {
    /// Returns the requirements on triangles of a pair of this size, beside the best facet.
    #[inline(always)]
    pub(super) fn new(best: &Best<f64>, size: f64) -> Self {
        Self {
            normal: best.normal,
            height: best.height - AGREE_DEPTH * size,
            margin: 2.0 * CERTIFICATE * UNIT * size,
            noise: ORIENTATION * size,
        }
    }

    /// Returns the same requirements reflected in the origin.
    pub(super) fn reflected(self) -> Self {
        Self {
            normal: neg(&self.normal),
            ..self
        }
    }

    /// Returns whether the required distance is certainly positive.
    #[inline(always)]
    pub(super) fn is_deep(&self) -> bool {
        self.height > self.margin
    }

    /// Returns whether a triangle is beyond the facet though its plane is not: the triangle lies
    /// entirely beyond its nearest point.
    fn is_far(&self, w: &[Vec3<f64>; 3]) -> bool {
        let nearest = Simplex::triangle(w.map(|w| MinkowskiPoint {
            w,
            ..MinkowskiPoint::default()
        }))
        .direction();
        let low = min_height(&nearest, w);
        low > 0.0 && low * low >= self.height * self.height * dot(&nearest, &nearest)
    }

    /// Returns whether a triangle is beyond the facet; `None` unless the origin is certainly behind
    /// the triangle and clear of it.
    pub(super) fn judge(&self, w: &[Vec3<f64>; 3]) -> Option<bool> {
        let (u, v) = (sub(&w[1], &w[0]), sub(&w[2], &w[0]));
        let n = cross(&u, &v);
        let (low, squared) = (min_height(&n, w), dot(&n, &n));
        let rounding = self.noise * self.noise * dot(&u, &u) * dot(&v, &v);
        // NaN counts as a fold.
        if !(low > 0.0 && low * low > rounding && low * low > self.margin * self.margin * squared) {
            return None;
        }
        let is_beyond = low * low >= self.height * self.height * squared
            || min_height(&self.normal, w) >= self.height
            || self.is_far(w);
        Some(self.height > self.margin && is_beyond)
    }
}
