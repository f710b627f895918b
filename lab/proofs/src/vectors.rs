//! Vectors by their lengths: errors of composed kernels, where errors of coordinates would need too many names.

use super::majorant::{DOUBLE, Majorant, rounding};
use super::norm::length;
use super::number::{self, Number};
use super::polynomial::Polynomial;
use dashu_ratio::RBig;
use std::collections::BTreeMap;
use std::marker::PhantomData;
use std::ops::{Add, Mul, Neg, Sub};
use std::sync::Mutex;

/// What kernels of vectors are transcribed over: [`Coordinates`] of numbers compute as the crate does, [`Lengths`] bound
/// the rounding of every input at once.
pub trait Vectors {
    /// A number.
    type Number: Number;
    /// Three coordinates.
    type Vector: Copy;
    /// Three rows.
    type Matrix: Copy;

    /// `a . b`, summed from the first coordinate on.
    fn dot(a: Self::Vector, b: Self::Vector) -> Self::Number;
    /// `a x b`.
    fn cross(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a + b`.
    fn sum(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a - b`.
    fn sub(a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a s`.
    fn scaled(a: Self::Vector, s: Self::Number) -> Self::Vector;
    /// The absolute coordinates.
    fn absolute(a: Self::Vector) -> Self::Vector;
    /// A matrix times a vector, each row summed from the first coordinate on.
    fn product(m: Self::Matrix, v: Self::Vector) -> Self::Vector;
    /// The other matrix, so that [`product`](Self::product) sums along columns.
    fn transposed(m: Self::Matrix) -> Self::Matrix;
    /// The matrix of the products of the rows of `a` with those of `b`.
    fn products(a: Self::Matrix, b: Self::Matrix) -> Self::Matrix;
    /// The absolute entries times a vector.
    fn spread(m: Self::Matrix, v: Self::Vector) -> Self::Vector;
}

/// Vectors of numbers.
pub struct Coordinates<N>(PhantomData<N>);

impl<N: Number> Vectors for Coordinates<N> {
    type Number = N;
    type Vector = [N; 3];
    type Matrix = [[N; 3]; 3];

    fn dot(a: [N; 3], b: [N; 3]) -> N {
        number::dot(a, b)
    }

    fn cross(a: [N; 3], b: [N; 3]) -> [N; 3] {
        number::cross(a, b)
    }

    fn sum(a: [N; 3], b: [N; 3]) -> [N; 3] {
        number::sum(a, b)
    }

    fn sub(a: [N; 3], b: [N; 3]) -> [N; 3] {
        number::sub(a, b)
    }

    fn scaled(a: [N; 3], s: N) -> [N; 3] {
        number::scaled(a, s)
    }

    fn absolute(a: [N; 3]) -> [N; 3] {
        a.map(N::abs)
    }

    fn product(m: [[N; 3]; 3], v: [N; 3]) -> [N; 3] {
        m.map(|row| number::dot(row, v))
    }

    fn transposed(m: [[N; 3]; 3]) -> [[N; 3]; 3] {
        [0, 1, 2].map(|k| [m[0][k], m[1][k], m[2][k]])
    }

    fn products(a: [[N; 3]; 3], b: [[N; 3]; 3]) -> [[N; 3]; 3] {
        a.map(|row| b.map(|other| number::dot(row, other)))
    }

    fn spread(m: [[N; 3]; 3], v: [N; 3]) -> [N; 3] {
        m.map(|row| number::dot(v, row.map(N::abs)))
    }
}

/// A number no larger than `most`, or a vector or a matrix no longer, and the largest error of what the code computes
/// instead. Both are numbers, or polynomials of lengths that are not known: a radius, a distance.
#[derive(Clone, Debug)]
struct Extent {
    most: Polynomial,
    error: Polynomial,
    precision: u32,
}

impl Extent {
    /// The sum of the most and the error.
    fn reach(&self) -> Polynomial {
        self.most.plus(&self.error)
    }

    /// The error of a product with another, before rounding: `d(ab) = a db + da (b + db)`.
    fn crossed(&self, other: &Self) -> Polynomial {
        let first = self.most.times(&other.error);
        first.plus(&self.error.times(&other.reach()))
    }

    fn product(&self, other: &Self, roundings: &RBig) -> Self {
        let rounded = self.reach().times(&other.reach()).scaled(roundings);
        Self {
            most: self.most.times(&other.most),
            error: self.crossed(other).plus(&rounded),
            precision: self.precision.max(other.precision),
        }
    }

    fn beside(&self, other: &Self) -> Self {
        let precision = self.precision.max(other.precision);
        let error = self.error.plus(&other.error);
        let most = self.most.plus(&other.most);
        Self {
            error: error.plus(&most.plus(&error).scaled(&rounding(precision))),
            most,
            precision,
        }
    }
}

macro_rules! bounded {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name(&'static Extent);

        impl $name {
            fn of(extent: Extent) -> Self {
                Self(Box::leak(Box::new(extent)))
            }

            /// A size, and an error.
            pub fn new(precision: u32, most: impl Into<Polynomial>, error: impl Into<Polynomial>) -> Self {
                let (most, error) = (most.into(), error.into());
                Self::of(Extent { most, error, precision })
            }

            /// An input of at most this size, in double precision, without an error.
            pub fn input(most: impl Into<Polynomial>) -> Self {
                Self::new(DOUBLE, most, RBig::ZERO)
            }

            /// The bound of the size.
            pub fn most(self) -> RBig {
                self.0.most.number()
            }

            /// The bound of the error.
            pub fn error(self) -> RBig {
                self.0.error.number()
            }

            /// The bound of the error, by lengths that are not known.
            pub fn error_by_lengths(self) -> &'static Polynomial {
                &self.0.error
            }

            /// The same, of a size that is known better.
            #[must_use]
            pub fn at_most(self, most: impl Into<Polynomial>) -> Self {
                let most = most.into();
                Self::of(Extent { most, ..self.0.clone() })
            }
        }
    };
}

bounded!(
    /// A number.
    Within
);
bounded!(
    /// A vector, by its length.
    Arrow
);
bounded!(
    /// A matrix, by the greatest length of the image of a vector of length one; nearly a rotation, so that its rows and
    /// entries are those of one.
    Turn
);

impl Within {
    /// The root of three squares: `root` its relative error, of the code's own operations.
    pub fn length_of(v: Arrow) -> Self {
        let r = rounding(v.0.precision);
        // Three squares and two sums, half of which the root leaves, and the root.
        let own = RBig::from(4) * &r;
        Self::of(Extent {
            most: v.0.most.clone(),
            error: v.0.error.plus(&v.0.reach().scaled(&own)),
            precision: v.0.precision,
        })
    }
}

impl Add for Within {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::of(self.0.beside(other.0))
    }
}

impl Sub for Within {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::of(self.0.beside(other.0))
    }
}

impl Neg for Within {
    type Output = Self;
    fn neg(self) -> Self {
        self
    }
}

impl Mul for Within {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let r = rounding(self.0.precision.max(other.0.precision));
        Self::of(self.0.product(other.0, &r))
    }
}

impl Number for Within {
    fn exact(x: f64) -> Self {
        Self::new(0, truth::rational::exact(x.abs()), RBig::ZERO)
    }

    fn abs(self) -> Self {
        self
    }

    fn times_power(self, exponent: i32) -> Self {
        let by = super::majorant::power(i64::from(exponent));
        Self::new(self.0.precision, self.0.most.scaled(&by), self.0.error.scaled(&by))
    }
}

/// What an operation of vectors of length one is rounded by, by name and precision.
static ROUNDINGS: Mutex<BTreeMap<(&str, u32), RBig>> = Mutex::new(BTreeMap::new());

fn roundings(name: &'static str, precision: u32, of: impl Fn([[Majorant; 3]; 2]) -> RBig) -> RBig {
    let mut known = ROUNDINGS.lock().expect("no panic before");
    let found = known.entry((name, precision)).or_insert_with(|| {
        let vector = |c| [0, 1, 2].map(|k| Majorant::input_in(precision, c, k, &RBig::ZERO));
        of([vector('a'), vector('b')])
    });
    found.clone()
}

fn of_dot(precision: u32) -> RBig {
    roundings("dot", precision, |[a, b]| length(&[number::dot(a, b).error()], &[]))
}

fn of_cross(precision: u32) -> RBig {
    roundings("cross", precision, |[a, b]| {
        let c = number::named('c', number::cross(a, b));
        length(&c.map(Majorant::error), &[])
    })
}

/// Of a matrix whose rows are no longer than one each: three dot products, as a vector no more than this times the root
/// of three; a matrix of a Frobenius norm of the root of three does no worse than `poses::product`.
fn of_product(precision: u32) -> RBig {
    roundings("product", precision, |_| super::bounds::product_in(precision))
}

/// Vectors by their lengths.
pub struct Lengths;

impl Vectors for Lengths {
    type Number = Within;
    type Vector = Arrow;
    type Matrix = Turn;

    fn dot(a: Arrow, b: Arrow) -> Within {
        Within::of(a.0.product(b.0, &of_dot(a.0.precision.max(b.0.precision))))
    }

    fn cross(a: Arrow, b: Arrow) -> Arrow {
        Arrow::of(a.0.product(b.0, &of_cross(a.0.precision.max(b.0.precision))))
    }

    fn sum(a: Arrow, b: Arrow) -> Arrow {
        Arrow::of(a.0.beside(b.0))
    }

    fn sub(a: Arrow, b: Arrow) -> Arrow {
        Arrow::of(a.0.beside(b.0))
    }

    fn scaled(a: Arrow, s: Within) -> Arrow {
        let r = rounding(a.0.precision.max(s.0.precision));
        Arrow::of(a.0.product(s.0, &r))
    }

    fn absolute(a: Arrow) -> Arrow {
        a
    }

    fn product(m: Turn, v: Arrow) -> Arrow {
        Arrow::of(m.0.product(v.0, &of_product(m.0.precision.max(v.0.precision))))
    }

    fn transposed(m: Turn) -> Turn {
        m
    }

    fn products(a: Turn, b: Turn) -> Turn {
        // Each row of one is turned by the other; three rows, by the Frobenius norm.
        let row = a.0.product(b.0, &of_product(a.0.precision.max(b.0.precision)));
        Turn::of(Extent {
            error: row.error.scaled(&super::bounds::root(3)),
            ..row
        })
    }

    fn spread(m: Turn, v: Arrow) -> Arrow {
        // The absolute entries stretch by no more than the Frobenius norm.
        let most = super::bounds::root(3);
        let wide = Extent {
            most: m.0.most.scaled(&most),
            error: m.0.error.scaled(&most),
            precision: m.0.precision,
        };
        Arrow::of(wide.product(v.0, &of_product(m.0.precision.max(v.0.precision))))
    }
}
