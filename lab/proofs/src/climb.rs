//! The largest rounding found by climbing over the inputs of a kernel: bounds from below.
//!
//! Inputs are whole numbers of 53 bits, as multiples of 2^-52: changes of any size, down to the last bit, keep what
//! makes the error larger. Errors are told in the unit of the bound, as [`bounds`](super::bounds) tells them.

mod certificate;
mod chains;
mod closed_form;
mod composed;
mod curved;
mod faces;
mod placed;
mod signs;
mod single;

use super::kernels::double::{self, ErrorFree};
use super::kernels::{patches, places, poses};
use super::number::{Number, Vector, dot};
use super::traced::{Traced, two_product, two_sum};
use truth::rng::Rng;

/// A kernel, and the error of one input in UNIT of what the bound is relative to.
pub struct Climb {
    /// The constant.
    pub constant: &'static str,
    /// The part of its derivation, as in [`bounds`](super::bounds).
    pub part: &'static str,
    inputs: usize,
    /// Tries that one input is worth.
    cost: u64,
    error: fn(&[f64]) -> f64,
}

const UNIT: f64 = f64::EPSILON / 2.0;

/// All kernels that are climbed.
pub fn all() -> impl Iterator<Item = &'static Climb> {
    let others = [
        certificate::ALL,
        chains::ALL,
        closed_form::ALL,
        composed::ALL,
        curved::ALL,
        faces::ALL,
        placed::ALL,
        signs::ALL,
        single::ALL,
    ];
    ALL.iter().chain(others.into_iter().flatten())
}

const ALL: &[Climb] = &[
    climb("CERTIFICATE", "1, quaternion", 8, quaternion),
    climb("CERTIFICATE", "1 and 2, rotation", 8, rotation),
    climb("CERTIFICATE", "3, translation", 7, translation),
    climb("CERTIFICATE", "4, product", 7, product),
    climb("PLACED_PIVOT", "rounding", 7, turned),
    climb("PLACED_CENTRE", "", 4, pivot),
    climb("BERNSTEIN", "", 8, cuts),
    climb("PATCH_POINT", "", 34, patch_point),
    climb("COEFFICIENT", "", 8, coefficient),
    climb("UNIT_DOUBLE_DOUBLE", "product", 4, double_product),
    climb("UNIT_DOUBLE_DOUBLE", "sum", 4, double_sum),
];

const fn climb(constant: &'static str, part: &'static str, inputs: usize, error: fn(&[f64]) -> f64) -> Climb {
    rare(constant, part, inputs, 1, error)
}

/// A kernel that is dear.
const fn rare(constant: &'static str, part: &'static str, inputs: usize, cost: u64, error: fn(&[f64]) -> f64) -> Climb {
    Climb {
        constant,
        part,
        inputs,
        cost,
        error,
    }
}

impl Climb {
    /// The largest error found in so many tries, and its inputs.
    pub fn run(&self, seed: u64, tries: u64) -> (f64, Vec<f64>) {
        let mut rng = Rng::new(seed);
        let mut best = (0.0, vec![0.0; self.inputs]);
        let mut at = (f64::NEG_INFINITY, Vec::new());
        let mut stale = 0;
        for _ in 0..tries.div_ceil(self.cost) {
            if stale > 400 || at.1.is_empty() {
                at = (f64::NEG_INFINITY, (0..self.inputs).map(|_| any(&mut rng)).collect());
                stale = 0;
            }
            let next = moved(&at.1, &mut rng);
            let error = (self.error)(&next);
            // False for NaN.
            if error > at.0 {
                stale = if error > at.0 * 1.0001 { 0 } else { stale + 1 };
                at = (error, next);
            } else {
                stale += 1;
            }
            if at.0 > best.0 {
                best = at.clone();
            }
        }
        best
    }
}

const ONE: f64 = (1u64 << 52) as f64;
const MOST: i64 = (1 << 53) - 1;

fn any(rng: &mut Rng) -> f64 {
    rng.int(-MOST, MOST) as f64 / ONE
}

/// One to three inputs changed by a number of any size, or to that of another.
fn moved(from: &[f64], rng: &mut Rng) -> Vec<f64> {
    let mut to = from.to_vec();
    for _ in 0..*rng.pick(&[1, 1, 1, 2, 3]) {
        let (k, bits) = (rng.below(to.len()), rng.int(1, 53));
        let x = if rng.chance(0.9) {
            (to[k] * ONE) as i64 + rng.int(-(1 << bits), 1 << bits)
        } else {
            (to[rng.below(to.len())] * ONE) as i64
        };
        to[k] = x.clamp(-MOST, MOST) as f64 / ONE;
    }
    to
}

fn vectors<const K: usize>(x: &[f64]) -> [Vector<Traced>; K] {
    std::array::from_fn(|k| Traced::vector(&x[3 * k..]))
}

/// The length of the true vector.
fn length<const K: usize>(v: [Traced; K]) -> f64 {
    v.iter().map(|x| x.truth() * x.truth()).sum::<f64>().sqrt()
}

/// The length of the error of a vector.
fn off<const K: usize>(v: [Traced; K]) -> f64 {
    v.iter().map(|x| x.error * x.error).sum::<f64>().sqrt()
}

/// A direction of length one as the code holds it.
fn unit<const K: usize>(x: &[f64]) -> [f64; K] {
    let norm = x[..K].iter().map(|x| x * x).sum::<f64>().sqrt();
    std::array::from_fn(|k| x[k] / norm)
}

/// The root of a sum of squares, from the first on.
fn root_of_squares<const K: usize>(v: [Traced; K]) -> Traced {
    v[1..].iter().fold(v[0] * v[0], |s, x| s + *x * *x).root()
}

/// By coordinates over the length.
fn divided<const K: usize>(v: [Traced; K]) -> [Traced; K] {
    let length = root_of_squares(v);
    v.map(|x| x.over(length))
}

/// Of a number that is not zero, relative to it.
fn relative(x: Traced) -> f64 {
    (x.error / x.truth()).abs() / UNIT
}

/// The matrix of a relative pose, of two quaternions.
fn relative_rotation(x: &[f64]) -> [Vector<Traced>; 3] {
    let [a, b] = [0, 4].map(|k| unit::<4>(&x[k..]).map(Traced::input));
    let norms = [a, b].map(poses::squared_norm);
    let s = factor_of(&norms, poses::rotation_factor(norms[0].value, norms[1].value));
    poses::matrix(poses::quotient(a, b), s)
}

/// A true number as the code holds it: rounded once.
fn held(x: Traced) -> Traced {
    let value = x.truth();
    Traced {
        value,
        error: (x.value - value) + x.error,
    }
}

fn quaternion(x: &[f64]) -> f64 {
    let (a, b) = (Traced::vector(x), Traced::vector(&x[4..]));
    off(poses::quotient(a, b)) / (length(a) * length(b)) / UNIT
}

/// The factor `2 / (|a|^2 |b|^2)` of the exact matrix, whose error is that of the code's.
fn factor_of(norms: &[Traced], computed: f64) -> Traced {
    let product = norms.iter().fold(Traced::input(1.0), |p, n| p * *n);
    // 2 / product - computed, from the residual.
    let residual = Traced::input(2.0) - product * Traced::input(computed);
    Traced {
        value: computed,
        error: residual.truth() / product.truth(),
    }
}

fn rotation(x: &[f64]) -> f64 {
    spectral(relative_rotation(x).map(|row| row.map(|x| x.error))) / UNIT
}

/// The spectral norm of a matrix, from below.
fn spectral(m: [Vector<f64>; 3]) -> f64 {
    let mut v = [0.6, 0.5, 0.62];
    let mut norm = 0.0;
    for _ in 0..30 {
        let w = m.map(|row| dot(row, v));
        v = [0, 1, 2].map(|j| m[0][j] * w[0] + m[1][j] * w[1] + m[2][j] * w[2]);
        norm = dot(v, v).sqrt();
        v = v.map(|x| x / norm);
    }
    norm.sqrt()
}

fn translation(x: &[f64]) -> f64 {
    let q = Traced::vector(&unit::<4>(x));
    let norm = poses::squared_norm(q);
    let s = factor_of(&[norm], poses::translation_factor(norm.value));
    let offset = Traced::vector(&x[4..]);
    off(poses::rotated_to_a(q, offset, s)) / length(offset) / UNIT
}

fn product(x: &[f64]) -> f64 {
    let q = Traced::vector(&unit::<4>(x));
    let m = poses::matrix(q, Traced::input(2.0)).map(|row| row.map(|x| Traced::input(x.value)));
    let v = Traced::vector(&x[4..]);
    off(poses::product(m, v)) / length(v) / UNIT
}

fn turned(x: &[f64]) -> f64 {
    let (q, v) = (Traced::vector(&unit::<4>(x)), Traced::vector(&x[4..]));
    off(poses::turned(q, v)) / length(v) / UNIT
}

/// At one of the two poses.
fn pivot(x: &[f64]) -> f64 {
    let [c, v, a, t]: [Traced; 4] = Traced::vector(x);
    let size = c.value.abs() + (v.value * t.value).abs() + 0.5 * a.value.abs() * t.value * t.value;
    2.0 * places::pivot([c, v, a], t).error.abs() / size / UNIT
}

fn cuts(x: &[f64]) -> f64 {
    let mut c: [Traced; 4] = Traced::vector(x);
    let most = x[..4].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for at in &x[4..] {
        let at = Traced::input(0.5 * at.abs());
        c = places::rest(c, at, Traced::exact(1.0) - at);
    }
    c.iter().fold(0.0f64, |m, x| m.max(x.error.abs())) / most / UNIT
}

/// Degrees three and three, weights from one to 2^-40.
fn patch_point(x: &[f64]) -> f64 {
    let weight = |k: usize| Traced::input(2f64.powi((-20.0 * x[k].abs()) as i32));
    let (w, p): (Vec<Traced>, Vec<Traced>) = (0..16).map(|k| (weight(k), Traced::input(x[16 + k]))).unzip();
    let both: Vec<Traced> = w.iter().zip(&p).map(|(w, p)| *w * *p).collect();
    let at = [32, 33].map(|k| {
        let t = Traced::input(0.5 * x[k].abs());
        [Traced::exact(1.0) - t, t]
    });
    let [above, below] = [both, w].map(|net| patches::value(&net, [3, 3], at));
    let quotient = above.value / below.value;
    // The true quotient less the computed one.
    let (product, rest) = two_product(quotient, below.value);
    let error = (((above.value - product) - rest) + above.error - quotient * below.error) / below.truth();
    error.abs() / x[16..32].iter().fold(0.0f64, |m, x| m.max(x.abs())) / UNIT
}

fn coefficient(x: &[f64]) -> f64 {
    let [n, p] = vectors(x);
    let (c, w) = (Traced::input(x[6]), Traced::input(x[7]));
    let size = length(n) * length(p).max((x[6] * x[7]).abs() / length(n));
    patches::coefficient(n, p, c, w).error.abs() / size / UNIT
}

fn pair(x: &[f64]) -> [f64; 2] {
    two_sum(x[0], x[1] * UNIT).into()
}

/// In UNIT^2, of a result against the exact sum of parts.
fn of_double(result: [f64; 2], parts: &[f64]) -> f64 {
    let exact = |x: &f64| truth::rational::exact(*x);
    let truth = parts.iter().fold(truth::rational::RBig::ZERO, |s, x| s + exact(x));
    let off = exact(&result[0]) + exact(&result[1]) - &truth;
    if truth.is_zero() {
        0.0
    } else {
        ((off / truth).to_f64().value() / (UNIT * UNIT)).abs()
    }
}

fn double_sum(x: &[f64]) -> f64 {
    let (a, b) = (pair(x), pair(&x[2..]));
    of_double(double::add(a, b), &[a[0], a[1], b[0], b[1]])
}

fn double_product(x: &[f64]) -> f64 {
    let (a, b) = (pair(x), pair(&x[2..]));
    let products = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| a[i].two_product(b[j]));
    let parts: Vec<f64> = products.iter().flat_map(|(p, e)| [*p, *e]).collect();
    of_double(double::mul(a, b), &parts)
}

#[cfg(test)]
mod tests {
    use super::super::number::cross;
    use super::*;

    #[test]
    fn an_error_is_the_true_one() {
        let mut rng = Rng::new(4);
        for _ in 0..1000 {
            let [a, b]: [Vector<Traced>; 2] = vectors(&[0; 6].map(|_| any(&mut rng)));
            let c = cross(a, b)[0];
            let exact = |x: Traced| truth::rational::exact(x.value);
            let truth = exact(a[1]) * exact(b[2]) - exact(a[2]) * exact(b[1]);
            let off = (truth - exact(c)).to_f64().value();
            assert!((off - c.error).abs() <= 1e-6 * off.abs());
        }
    }
}
