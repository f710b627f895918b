//! Kernels of single precision, beside the same in double precision.

use super::{Climb, climb, unit};
use crate::proofs::kernels::boxes::{self, Oriented};
use crate::proofs::kernels::poses;
use crate::proofs::number::{Number, dot};
use crate::proofs::vectors::{Coordinates, Vectors};

const UNIT_SINGLE: f64 = f32::EPSILON as f64 / 2.0;

pub(super) const ALL: &[Climb] = &[
    climb("BOX_SCANNED", "", 6, scanned),
    climb("BOXES", "line of centres", 27, by_centres),
    climb("BOXES", "excess of A", 27, excess_of_a),
    climb("BOXES", "excess of B", 27, excess_of_b),
    climb("BOXES", "direction", 30, direction),
    climb("BOXES", "front", 20, front),
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

fn by_centres(x: &[f64]) -> f64 {
    fn of<N: Held>(x: &[f64]) -> f64 {
        let ([a, b], posed) = posed::<N>(x);
        boxes::by_centres::<Coordinates<N>>(posed.between, posed.along, [a.half, b.half]).double()
    }
    let (_, truth) = posed::<f64>(x);
    over(x, of::<f32>(x), of::<f64>(x)) / size(&truth.between)
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
