//! Double-double numbers and vectors of the judge, with fused multiply-add.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// An unevaluated sum of two numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wide(pub f64, pub f64);

fn quick(a: f64, b: f64) -> Wide {
    let s = a + b;
    Wide(s, b - (s - a))
}

fn sum(a: f64, b: f64) -> Wide {
    let s = a + b;
    let c = s - a;
    Wide(s, (a - (s - c)) + (b - c))
}

impl From<f64> for Wide {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (s, t) = (sum(self.0, o.0), sum(self.1, o.1));
        let s = quick(s.0, s.1 + t.0);
        quick(s.0, s.1 + t.1)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = self.0 * o.0;
        let e = self.0.mul_add(o.0, -p);
        quick(p, e + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let q = Self::from(self.0 / o.0);
        let r = self - q * o;
        q + Self::from(r.0 / o.0)
    }
}

impl Wide {
    /// Returns the square root; zero if the number is not positive.
    pub fn root(self) -> Self {
        if self.0 <= 0.0 {
            return Self(0.0, 0.0);
        }
        let r = Self::from(self.0.sqrt());
        r + Self::from((self - r * r).0 / (2.0 * r.0))
    }

    /// Returns the larger of two numbers.
    pub fn max(self, o: Self) -> Self {
        if (self - o).0 >= 0.0 { self } else { o }
    }
}

/// Three coordinates.
pub type Triple = [Wide; 3];

/// Returns coordinates without a second part.
pub fn wide(v: [f64; 3]) -> Triple {
    v.map(Wide::from)
}

/// Returns the scalar product.
pub fn dot(a: &Triple, b: &Triple) -> Wide {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the length.
pub fn norm(a: &Triple) -> Wide {
    dot(a, a).root()
}

/// Returns the rotation matrix of `q`, normalised.
pub fn matrix(q: [f64; 4]) -> [Triple; 3] {
    let [x, y, z, w] = q.map(Wide::from);
    let (one, two) = (Wide::from(1.0), Wide::from(2.0));
    let s = two / (x * x + y * y + z * z + w * w);
    [
        [one - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), one - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), one - s * (x * x + y * y)],
    ]
}

/// `m v`.
pub fn turned(m: &[Triple; 3], v: &Triple) -> Triple {
    [dot(&m[0], v), dot(&m[1], v), dot(&m[2], v)]
}

/// Returns the transpose of `m` times `v`.
pub fn turned_back(m: &[Triple; 3], v: &Triple) -> Triple {
    [0, 1, 2].map(|c| m[0][c] * v[0] + m[1][c] * v[1] + m[2][c] * v[2])
}
