//! Lower bounds of the distance of eight pairs of boxes at once.
//!
//! Three directions are tried: the line of centres, and the excess vector in the axes of either
//! box, with the amounts by which the centres are farther apart along each axis than both
//! boxes reach. The best of the three is 5 to 20 % above the least number of pairs that the exact
//! distance of boxes would leave. The gap along each direction is taken of the axes as stored, so
//! that the gap is a proof whether or not the axes are orthonormal. The error term is
//! [`BOXES`](crate::tolerance::BOXES).

use wide::f32x8;

use super::frame::Single;
use super::tree::OrientedBox;

/// Gaps along unit directions in A's frame, in the unit of the frame in single precision.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) gap: [f32; 8],
    pub(super) normal: [[f32; 8]; 3],
}

/// Eight boxes by component.
struct Eight {
    axes: [[f32x8; 3]; 3],
    centre: [f32x8; 3],
    half: [f32x8; 3],
}

impl Eight {
    #[inline(always)]
    fn new(boxes: [&OrientedBox; 8], scale: f32) -> Self {
        let [b0, b1, b2, b3, b4, b5, b6, b7] = boxes;
        let row = |b: &OrientedBox, k: usize| f32x8::new(b.rows[k]);
        let [xx, xy, xz, yx, yy, yz, zx, zy] = f32x8::transpose([
            row(b0, 0),
            row(b1, 0),
            row(b2, 0),
            row(b3, 0),
            row(b4, 0),
            row(b5, 0),
            row(b6, 0),
            row(b7, 0),
        ]);
        let [zz, cx, cy, cz, hx, hy, hz, _] = f32x8::transpose([
            row(b0, 1),
            row(b1, 1),
            row(b2, 1),
            row(b3, 1),
            row(b4, 1),
            row(b5, 1),
            row(b6, 1),
            row(b7, 1),
        ]);
        let s = f32x8::splat(scale);
        Self {
            axes: [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]],
            centre: [cx * s, cy * s, cz * s],
            half: [hx * s, hy * s, hz * s],
        }
    }
}

#[inline(always)]
fn dot(a: [f32x8; 3], b: [f32x8; 3]) -> f32x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn turned(r: &[f32x8; 9], v: [f32x8; 3]) -> [f32x8; 3] {
    [
        r[0] * v[0] + r[1] * v[1] + r[2] * v[2],
        r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
        r[6] * v[0] + r[7] * v[1] + r[8] * v[2],
    ]
}

/// `x` with the sign of `s`, for `x` not negative.
#[inline(always)]
fn signed(x: f32x8, s: f32x8) -> f32x8 {
    x | (s & f32x8::splat(-0.0))
}

#[inline(always)]
fn combined(w: [f32x8; 3], v: &[[f32x8; 3]; 3]) -> [f32x8; 3] {
    [
        w[0] * v[0][0] + w[1] * v[1][0] + w[2] * v[2][0],
        w[0] * v[0][1] + w[1] * v[1][1] + w[2] * v[2][1],
        w[0] * v[0][2] + w[1] * v[1][2] + w[2] * v[2][2],
    ]
}

/// The gap along an excess vector, and its length: coordinates of the centres' difference in the
/// axes of one box, half extents of that box and of the other, and the products of the axes, by the
/// axis of the first.
#[inline(always)]
fn excess(d: [f32x8; 3], h: [f32x8; 3], g: [f32x8; 3], m: &[[f32x8; 3]; 3]) -> (f32x8, f32x8, [f32x8; 3]) {
    let over = [d[0].abs() - h[0], d[1].abs() - h[1], d[2].abs() - h[2]];
    let reach = |k: usize| g[0] * m[k][0].abs() + g[1] * m[k][1].abs() + g[2] * m[k][2].abs();
    let zero = f32x8::splat(0.0);
    let x = (over[0] - reach(0)).fast_max(zero);
    let y = (over[1] - reach(1)).fast_max(zero);
    let z = (over[2] - reach(2)).fast_max(zero);
    let square = x * x + y * y + z * z;
    let e = [signed(x, d[0]), signed(y, d[1]), signed(z, d[2])];
    let [p, q, r] = combined(e, m);
    let own = x * over[0] + y * over[1] + z * over[2];
    let other = g[0] * p.abs() + g[1] * q.abs() + g[2] * r.abs();
    let inverse = f32x8::splat(1.0) / square.sqrt().fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let open = square.simd_gt(zero);
    let gap = open.select((own - other) * inverse, f32x8::splat(-f32::MAX));
    (gap, inverse, e)
}

/// The best gap of each pair, and its direction.
#[inline(never)]
pub(super) fn bounds(frame: &Single, a: [&OrientedBox; 8], b: [&OrientedBox; 8]) -> Bounds {
    let (a, b) = (Eight::new(a, frame.scale_a), Eight::new(b, frame.scale_b));
    let r = &frame.ways[0].rotation;
    let axes = [turned(r, b.axes[0]), turned(r, b.axes[1]), turned(r, b.axes[2])];
    let at = turned(r, b.centre);
    let t = &frame.ways[0].translation;
    let d = [
        at[0] + t[0] - a.centre[0],
        at[1] + t[1] - a.centre[1],
        at[2] + t[2] - a.centre[2],
    ];
    let row = |k: usize| {
        [
            dot(a.axes[k], axes[0]),
            dot(a.axes[k], axes[1]),
            dot(a.axes[k], axes[2]),
        ]
    };
    let m = [row(0), row(1), row(2)];
    let mt = [
        [m[0][0], m[1][0], m[2][0]],
        [m[0][1], m[1][1], m[2][1]],
        [m[0][2], m[1][2], m[2][2]],
    ];
    let da = [dot(a.axes[0], d), dot(a.axes[1], d), dot(a.axes[2], d)];
    let db = [dot(axes[0], d), dot(axes[1], d), dot(axes[2], d)];

    let square = dot(d, d);
    let inverse = f32x8::splat(1.0) / square.sqrt().fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let reach_a = a.half[0] * da[0].abs() + a.half[1] * da[1].abs() + a.half[2] * da[2].abs();
    let reach_b = b.half[0] * db[0].abs() + b.half[1] * db[1].abs() + b.half[2] * db[2].abs();
    let by_centres = (square - reach_a - reach_b) * inverse;

    let (by_a, inverse_a, ea) = excess(da, a.half, b.half, &m);
    let (by_b, inverse_b, eb) = excess(db, b.half, a.half, &mt);
    let (na, nb) = (combined(ea, &a.axes), combined(eb, &axes));
    let first = by_a.simd_ge(by_b);
    let gap = by_a.fast_max(by_b);
    let excess_wins = gap.simd_ge(by_centres);
    let normal = |k: usize| {
        let n = first.select(na[k] * inverse_a, nb[k] * inverse_b);
        excess_wins.select(n, d[k] * inverse).to_array()
    };
    Bounds {
        gap: gap.fast_max(by_centres).to_array(),
        normal: [normal(0), normal(1), normal(2)],
    }
}
