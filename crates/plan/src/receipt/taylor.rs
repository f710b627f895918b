//! Functions over an interval as polynomials with a bound of the rest, in double precision.
//!
//! A checker computes the same in exact numbers. These are its bounds up to rounding, from which a
//! writer knows in advance what a checker accepts.

use nalgebra::{Isometry3, Matrix3, Vector3};

use lin_canny::motion::Velocity;

/// Degree of the polynomials, the one of the checkers.
pub(super) const DEGREE: usize = 4;
pub(super) const TERMS: usize = DEGREE + 1;

/// Angle within a piece of evidence from which on a checker refuses it.
const FARTHEST: f64 = 31.0;

/// Number of halvings of the interval in which a polynomial is bounded.
const HALVINGS: u32 = 3;

/// Binomial coefficients up to the degree.
const CHOOSE: [[f64; TERMS]; TERMS] = [
    [1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0],
];

/// A function of x in [0, 1], within `rest` of the sum of `c[k] x^k`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taylor {
    c: [f64; TERMS],
    pub(super) rest: f64,
}

/// A point or a direction that moves.
pub(super) type Moving = [Taylor; 3];

impl Taylor {
    pub(super) fn constant(value: f64) -> Self {
        let mut c = [0.0; TERMS];
        c[0] = value;
        Self { c, rest: 0.0 }
    }

    /// Returns a polynomial; what is beyond the degree counts as a rest.
    fn polynomial(coefficients: &[f64]) -> Self {
        Self {
            c: core::array::from_fn(|k| coefficients.get(k).copied().unwrap_or_default()),
            rest: coefficients.iter().skip(TERMS).map(|x| x.abs()).sum(),
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            c: core::array::from_fn(|k| self.c[k] + other.c[k]),
            rest: self.rest + other.rest,
        }
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(-1.0))
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            c: self.c.map(|x| x * factor),
            rest: self.rest * factor.abs(),
        }
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut all = [0.0; 2 * DEGREE + 1];
        for (i, x) in self.c.iter().enumerate() {
            for (j, y) in other.c.iter().enumerate() {
                all[i + j] += x * y;
            }
        }
        let beyond: f64 = all[TERMS..].iter().map(|x| x.abs()).sum();
        Self {
            c: core::array::from_fn(|k| all[k]),
            rest: beyond + self.most() * other.rest + other.most() * self.rest + self.rest * other.rest,
        }
    }

    /// Returns an upper bound of the absolute value of the polynomial.
    pub(super) fn most(&self) -> f64 {
        self.c.iter().map(|x| x.abs()).sum()
    }

    /// Returns the Bernstein coefficients of the polynomial.
    pub(super) fn net(&self) -> [f64; TERMS] {
        core::array::from_fn(|k| {
            let term = |j: usize| self.c[j] * CHOOSE[k][j] / CHOOSE[DEGREE][j];
            (0..=k).map(term).sum()
        })
    }
}

/// Returns a lower bound of a polynomial from its Bernstein coefficients.
pub(super) fn least(net: [f64; TERMS]) -> f64 {
    fn halved(net: [f64; TERMS], times: u32) -> f64 {
        let lowest = |net: &[f64; TERMS]| {
            net.iter()
                .copied()
                .fold(f64::INFINITY, |low, x| if x < low { x } else { low })
        };
        if times == 0 {
            return lowest(&net);
        }
        let (mut first, mut last) = (net, net);
        for k in 1..TERMS {
            for j in 0..TERMS - k {
                last[j] = 0.5 * (last[j] + last[j + 1]);
            }
            first[k] = last[0];
        }
        let [x, y] = [first, last].map(|half| halved(half, times - 1));
        if x < y { x } else { y }
    }
    halved(net, HALVINGS)
}

pub(super) fn constant(v: &Vector3<f64>) -> Moving {
    [v.x, v.y, v.z].map(Taylor::constant)
}

pub(super) fn dot(u: &Moving, v: &Moving) -> Taylor {
    u[0].times(&v[0]).plus(&u[1].times(&v[1])).plus(&u[2].times(&v[2]))
}

pub(super) fn cross(u: &Moving, v: &Moving) -> Moving {
    let part = |i: usize, j: usize| u[i].times(&v[j]).minus(&u[j].times(&v[i]));
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// One step of the way from the world to a body.
#[derive(Clone, Debug)]
pub(super) enum Step {
    /// A constant pose: its rotation, and the shift.
    Place(Matrix3<f64>, Vector3<f64>, Isometry3<f64>),
    /// A shift: for each axis the coefficients of the powers of t.
    Shift([Vec<f64>; 3]),
    /// A rotation by the vector `axis` times the sum of `angle[k] t^k`.
    Turn { axis: Vector3<f64>, angle: Vec<f64> },
}

/// A step over an interval.
enum Over<'a> {
    Place(&'a Matrix3<f64>, &'a Vector3<f64>),
    Shift(Moving),
    /// The axis, the sine over its length, and one minus the cosine over its square.
    Turn(Moving, Taylor, Taylor),
}

impl Step {
    pub(super) fn place(at: &Isometry3<f64>) -> Self {
        let rotation = at.rotation.to_rotation_matrix().into_inner();
        Self::Place(rotation, at.translation.vector, *at)
    }

    /// Returns the pose of the step at a time.
    fn at(&self, time: f64) -> Isometry3<f64> {
        match self {
            Self::Place(_, _, at) => *at,
            Self::Shift(way) => {
                let at = way.each_ref().map(|way| value(way, time));
                Isometry3::translation(at[0], at[1], at[2])
            }
            Self::Turn { axis, angle } => {
                let turn = axis * value(angle, time);
                Velocity::new(Vector3::zeros(), turn).applied(&Isometry3::identity(), 1.0)
            }
        }
    }

    fn over(&self, start: f64, span: f64) -> Over<'_> {
        match self {
            Self::Place(rotation, shift, _) => Over::Place(rotation, shift),
            Self::Shift(way) => Over::Shift(way.each_ref().map(|way| Taylor::polynomial(&moved(way, start, span)))),
            Self::Turn { axis, angle } => {
                let [sine, versine] = turn(axis.norm_squared(), &moved(angle, start, span));
                Over::Turn(constant(axis), sine, versine)
            }
        }
    }
}

/// Returns the value of a polynomial.
fn value(coefficients: &[f64], time: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * time + c)
}

/// Returns the coefficients of p(start + span x) in x.
fn moved(p: &[f64], start: f64, span: f64) -> Vec<f64> {
    let mut all = p.to_vec();
    for first in 0..all.len() {
        for k in (first..all.len().saturating_sub(1)).rev() {
            all[k] += all[k + 1] * start;
        }
    }
    let mut factor = 1.0;
    for c in &mut all {
        *c *= factor;
        factor *= span;
    }
    all
}

/// Returns sin(|a| v) / |a| and (1 - cos(|a| v)) / |a|^2 at v = sum of angle[k] x^k, for |a|^2 =
/// `square`.
fn turn(square: f64, angle: &[f64]) -> [Taylor; 2] {
    let start = angle.first().copied().unwrap_or_default();
    let rate = square.sqrt();
    let (sine, cosine) = libm::sincos(rate * start);
    let half = libm::sin(0.5 * rate * start);
    let (s, v) = match rate > 0.0 {
        true => (sine / rate, 2.0 * half * half / square),
        false => (start, 0.5 * start * start),
    };
    // Each is the derivative of the one before.
    let mut derivatives = [0.0; TERMS + 1];
    derivatives[..3].copy_from_slice(&[v, s, cosine]);
    for k in 3..=TERMS {
        derivatives[k] = -square * derivatives[k - 2];
    }
    let mut way = Taylor::polynomial(angle);
    way.c[0] = 0.0;
    // Lagrange's bound: the next derivative, at most a power of the rate.
    let size = way.most() + way.rest;
    let turned = rate * size;
    // A checker refuses turns that are too far.
    let mut rest = if turned < FARTHEST { size } else { f64::INFINITY };
    for k in 1..=DEGREE {
        rest *= turned / (k + 1) as f64;
    }
    let of = |first: usize, rest: f64| {
        let mut factorial: f64 = (1..=DEGREE).map(|k| k as f64).product();
        let mut all = Taylor::constant(derivatives[first + DEGREE] / factorial);
        for k in (0..DEGREE).rev() {
            factorial /= (k + 1) as f64;
            all = all
                .times(&way)
                .plus(&Taylor::constant(derivatives[first + k] / factorial));
        }
        all.rest += rest;
        all
    };
    let rest_of_versine = if turned > 0.0 { rest * size / turned } else { 0.0 };
    [of(1, rest), of(0, rest_of_versine)]
}

impl Over<'_> {
    /// Returns m and o of `m . x + o`, where x is a point before the step, from those after it.
    fn pulled(&self, m: Moving, o: Taylor) -> (Moving, Taylor) {
        match self {
            Self::Place(rotation, shift) => {
                let column = |k: usize| {
                    let part = |i: usize| m[i].scaled(rotation[(i, k)]);
                    part(0).plus(&part(1)).plus(&part(2))
                };
                let o = (0..3).fold(o, |o, k| o.plus(&m[k].scaled(shift[k])));
                ([column(0), column(1), column(2)], o)
            }
            Self::Shift(way) => (m, o.plus(&dot(&m, way))),
            Self::Turn(axis, sine, versine) => {
                let once = cross(&m, axis);
                let twice = cross(&once, axis);
                let part = |k: usize| m[k].plus(&sine.times(&once[k])).plus(&versine.times(&twice[k]));
                ([part(0), part(1), part(2)], o)
            }
        }
    }

    /// Returns a point after the step.
    fn moved(&self, x: &Moving) -> Moving {
        match self {
            Self::Place(rotation, shift) => core::array::from_fn(|k| {
                let part = |i: usize| x[i].scaled(rotation[(k, i)]);
                part(0).plus(&part(1)).plus(&part(2)).plus(&Taylor::constant(shift[k]))
            }),
            Self::Shift(way) => core::array::from_fn(|k| x[k].plus(&way[k])),
            Self::Turn(axis, sine, versine) => {
                let once = cross(axis, x);
                let twice = cross(axis, &once);
                core::array::from_fn(|k| x[k].plus(&sine.times(&once[k])).plus(&versine.times(&twice[k])))
            }
        }
    }
}

/// Returns the position of a point of a body over an interval.
pub(super) fn place(steps: &[Step], point: &Vector3<f64>, start: f64, span: f64) -> Moving {
    let outward = steps.iter().rev();
    outward.fold(constant(point), |x, step| step.over(start, span).moved(&x))
}

/// Returns m and o such that a point x of a body has the height `m . x + o` along a direction.
pub(super) fn heights(steps: &[Step], direction: &Moving, start: f64, span: f64) -> (Moving, Taylor) {
    let none = Taylor::constant(0.0);
    let inward = steps.iter();
    inward.fold((*direction, none), |(m, o), step| step.over(start, span).pulled(m, o))
}

/// Returns the pose of a body at a time.
pub(super) fn pose(steps: &[Step], time: f64) -> Isometry3<f64> {
    steps
        .iter()
        .fold(Isometry3::identity(), |pose, step| pose * step.at(time))
}
