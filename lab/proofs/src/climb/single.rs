//! Boxes and fronts: kernels of single precision beside the same in double precision, and axes.

use super::{Climb, climb, unit};
use crate::kernels::boxes::{self, Oriented};
use crate::kernels::poses;
use crate::measured::Measured;
use crate::number::{Number, Vector, cross, dot, scaled, sub, sum};
use crate::traced::Traced;
use crate::vectors::{Coordinates, Vectors};

const UNIT_SINGLE: f64 = f32::EPSILON as f64 / 2.0;

pub(super) const ALL: &[Climb] = &[
    climb("BOX_SCANNED", "", 6, scanned),
    climb("BOXES", "line of centres", 27, by_centres),
    climb("BOXES", "excess of A", 27, excess_of_a),
    climb("BOXES", "excess of B", 27, excess_of_b),
    climb("BOXES", "direction", 30, direction),
    climb("BOXES", "front", 20, front),
    climb("BOXES", "front, segments", 24, front_of_segments),
    climb("BOXES", "about a segment", 6, around),
    climb("BOX_EXTENT", "", 13, extent),
    climb("REFIT_HEIGHT", "", 10, refit_height),
    climb("BOX_SKEW", "", 4, skew),
    climb("SLAB_HEIGHT", "a point of three heights", 9, of_three_heights),
];

/// A number of the code, and of what it stands for, from the same number of single precision.
trait Held: Number {
    fn held(x: f64) -> Self;
    fn double(self) -> f64;
}

impl Held for f32 {
    fn held(x: f64) -> Self {
        x as f32
    }

    fn double(self) -> f64 {
        self.into()
    }
}

impl Held for f64 {
    fn held(x: f64) -> Self {
        (x as f32).into()
    }

    fn double(self) -> f64 {
        self
    }
}

fn vector<N: Held>(x: &[f64]) -> [N; 3] {
    [0, 1, 2].map(|k| N::held(x[k]))
}

/// A rotation that is rounded where the number is rounded.
fn rotation<N: Held>(x: &[f64]) -> [[N; 3]; 3] {
    poses::matrix(unit::<4>(x), 2.0).map(|row| row.map(N::exact))
}

/// Axes as stored.
fn axes<N: Held>(x: &[f64]) -> [[N; 3]; 3] {
    poses::matrix(unit::<4>(x), 2.0).map(|row| row.map(N::held))
}

fn size(x: &[f64]) -> f64 {
    x[..3].iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Both oriented boxes, and the pose: angles of three rotations, then centres, half extents and the translation.
fn posed<N: Held>(x: &[f64]) -> ([Oriented<Coordinates<N>>; 2], boxes::Posed<Coordinates<N>>) {
    let of = |k: usize| Oriented {
        axes: axes(&x[4 * k..]),
        centre: vector(&x[12 + 3 * k..]),
        half: vector::<N>(&x[18 + 3 * k..]).map(N::abs),
    };
    let (a, b) = (of(0), of(1));
    let shift = [0, 1, 2].map(|k| N::exact(x[24 + k]));
    let posed = boxes::posed::<Coordinates<N>>(rotation(&x[8..]), shift, [&a, &b]);
    ([a, b], posed)
}

/// The lengths of a pair: the half extents are at most the root of three times as long as the bound counts.
fn lengths(x: &[f64]) -> f64 {
    let halves = (size(&x[18..]) + size(&x[21..])) / 3f64.sqrt();
    size(&x[12..]) + size(&x[15..]) + size(&x[24..]) + halves
}

fn over(x: &[f64], single: f64, double: f64) -> f64 {
    (single - double).abs() / lengths(x) / UNIT_SINGLE
}

/// Both vectors are rounded to single precision before, which counts.
fn scanned(x: &[f64]) -> f64 {
    let terms: f64 = (0..3).map(|k| (x[k] * x[3 + k]).abs()).sum();
    let single = dot(vector::<f32>(x), vector::<f32>(&x[3..])).double();
    (single - dot([x[0], x[1], x[2]], [x[3], x[4], x[5]])).abs() / terms / UNIT_SINGLE
}

/// Along the computed line of the centres, exact as such.
fn by_centres(x: &[f64]) -> f64 {
    let ([a, b], posed_) = posed::<f32>(x);
    let single = boxes::by_centres::<Coordinates<f32>>(posed_.between, posed_.along, [a.half, b.half]);
    let n = posed_.between.map(f32::double);
    let ([a, b], posed) = posed::<f64>(x);
    let double = boxes::along::<Coordinates<f64>>(n, posed.between, [a.half, b.half], [a.axes, posed.axes_b]);
    over(x, single.double(), double) / size(&n)
}

/// Along the excess vector of double precision, of length one, so that all but it is rounded.
fn excess(x: &[f64], own: usize) -> f64 {
    let (both, posed_) = posed::<f64>(x);
    let (other, half) = (both[1 - own].half, both[own].half);
    let [_, e] = boxes::beyond::<Coordinates<f64>>(posed_.along[own], [half, other], posed_.products);
    let e = e.map(|x| x.max(0.0));
    let length = size(&e);
    if length == 0.0 {
        return 0.0;
    }
    let e = e.map(|x| x / length);
    let signs = posed_.along[own].map(f64::signum);
    fn of<N: Held>(x: &[f64], own: usize, e: [f64; 3], signs: [f64; 3]) -> f64 {
        let (both, posed) = posed::<N>(x);
        let absolute = vector::<N>(&e);
        let signed = [0, 1, 2].map(|k| absolute[k] * N::exact(signs[k]));
        let over = Coordinates::<N>::sub(posed.along[own].map(N::abs), both[own].half);
        let products = if own == 0 {
            posed.products
        } else {
            Coordinates::<N>::transposed(posed.products)
        };
        boxes::excess::<Coordinates<N>>([signed, absolute], over, both[1 - own].half, products).double()
    }
    over(x, of::<f32>(x, own, e, signs), of::<f64>(x, own, e, signs))
}

fn excess_of_a(x: &[f64]) -> f64 {
    excess(x, 0)
}

fn excess_of_b(x: &[f64]) -> f64 {
    excess(x, 1)
}

fn direction(x: &[f64]) -> f64 {
    fn of<N: Held>(x: &[f64]) -> f64 {
        let ([a, b], posed) = posed::<N>(x);
        let n = vector(&unit::<3>(&x[27..]));
        boxes::along::<Coordinates<N>>(n, posed.between, [a.half, b.half], [a.axes, posed.axes_b]).double()
    }
    over(x, of::<f32>(x), of::<f64>(x))
}

/// An entry of a front at one pose, carried to another.
fn front(x: &[f64]) -> f64 {
    fn of<N: Held>(x: &[f64]) -> f64 {
        let pose = |k: usize| (rotation::<N>(&x[7 * k..]), [4, 5, 6].map(|i| N::exact(x[7 * k + i])));
        let (n, centre) = (vector(&unit::<3>(&x[14..])), vector(&x[17..]));
        let (m, base) = boxes::entry::<Coordinates<N>>(pose(0), n, centre, N::exact(0.0));
        let (_, gap) = boxes::carried::<Coordinates<N>>(pose(1), [n, m], centre, base);
        gap.double()
    }
    let most = size(&x[4..]).max(size(&x[11..])) + size(&x[17..]);
    (of::<f32>(x) - of::<f64>(x)).abs() / most / UNIT_SINGLE
}

/// The same with a ball about a segment, of an axis and half its length.
fn front_of_segments(x: &[f64]) -> f64 {
    fn of<N: Held>(x: &[f64], root: fn(N) -> N) -> f64 {
        let pose = |k: usize| (rotation::<N>(&x[7 * k..]), [4, 5, 6].map(|i| N::exact(x[7 * k + i])));
        let (n, centre) = (vector(&unit::<3>(&x[14..])), vector(&x[17..]));
        let (m, base) = boxes::entry::<Coordinates<N>>(pose(0), n, centre, N::exact(0.0));
        let (turn, gap) = boxes::carried::<Coordinates<N>>(pose(1), [n, m], centre, base);
        let rod = scaled(vector(&unit::<3>(&x[20..])), N::held(x[23]));
        let radius = N::held(x[23] / 3.0).abs();
        (gap - radius * root(dot(turn, turn)) - dot(turn, rod).abs()).double()
    }
    let most = size(&x[4..]).max(size(&x[11..])) + size(&x[17..]) + 2.0 * x[23].abs();
    (of::<f32>(x, f32::sqrt) - of::<f64>(x, f64::sqrt)).abs() / most / UNIT_SINGLE
}

/// A corner of a box against the radius about its longest axis.
fn around(x: &[f64]) -> f64 {
    let [_, wide, deep] = axes::<f64>(x);
    let [h, k] = [x[4], x[5]].map(f32::held);
    let corner = sum(scaled(wide, h.double()), scaled(deep, k.double()));
    let square = h * h + k * k;
    let radius = f32::held(square.double().sqrt()).double();
    (size(&corner) - radius) / radius / UNIT_SINGLE
}

/// A coordinate along a dual axis of axes as stored, of a point up to four from the centre.
fn extent(x: &[f64]) -> f64 {
    let [a, b, c] = axes::<f64>(x).map(|axis| axis.map(Traced::input));
    let across = cross(b, c);
    let volume = dot(a, across);
    let point = sub(
        sub(Traced::vector(&x[4..]), Traced::vector(&x[7..])),
        Traced::vector(&x[10..]),
    );
    let height = dot(across.map(|x| x.over(volume)), point);
    let most = [4, 7, 10].map(|k| size(&x[k..])).into_iter().fold(0.0, f64::max);
    height.error.abs() * 4.0 / most.max(size(&point.map(Traced::truth))) / f64::EPSILON * 2.0
}

fn refit_height(x: &[f64]) -> f64 {
    let [axis, ..] = axes::<f32>(x);
    let centre = vector::<f32>(&x[7..]);
    let single = dot(axis, vector::<f32>(&x[4..])) - dot(axis, centre);
    let [axis, centre] = [axis, centre].map(|v| v.map(f32::double));
    let double = dot(axis, [x[4], x[5], x[6]]) - dot(axis, centre);
    let most = size(&x[4..]).max(size(&x[7..]) / 3f64.sqrt());
    (single.double() - double).abs() / most / UNIT_SINGLE
}

/// By how much the products of axes as stored differ from those of orthonormal ones.
fn skew(x: &[f64]) -> f64 {
    let axes = axes::<f64>(x);
    let off = |i: usize, j: usize| (dot(axes[i], axes[j]) - f64::from(u8::from(i == j))).abs();
    let all = (0..9).map(|k| off(k / 3, k % 3));
    all.fold(0.0, f64::max) / UNIT_SINGLE
}

/// A point that is put together from its heights along a normal, an axis made perpendicular to it, and the third.
fn of_three_heights(x: &[f64]) -> f64 {
    let point: Vector<Traced> = Traced::vector(&x[6..]);
    let divided = |v: Vector<Traced>| v.map(|c| c.over(Traced::length(v)).computed());
    let n = divided(Traced::vector(x));
    let mut v: Vector<Traced> = Traced::vector(&x[3..]);
    // An axis with a cosine of less than a tenth.
    let tilt = dot(n, v).value;
    v = sub(v, scaled(n, Traced::input(tilt))).map(Measured::computed);
    let lean = Traced::input(0.0995 * Traced::length(v).value * tilt.clamp(-1.0, 1.0));
    v = sum(v, scaled(n, lean)).map(Measured::computed);
    let long = divided(sub(v, scaled(n, dot(n, v))).map(Measured::computed));
    let wide = cross(n, long).map(Measured::computed);
    let parts = [n, long, wide].map(|axis| scaled(axis, dot(axis, point)));
    let whole = sum(sum(parts[0], parts[1]), parts[2]);
    let off = [0, 1, 2].map(|k| point[k].above(whole[k]));
    size(&off) / size(&x[6..]) / f64::EPSILON * 2.0
}
