//! Numbers of twice the precision.

use crate::proofs::number::Number;

/// Sums and products with their errors, which are numbers of the format.
pub trait ErrorFree: Number {
    /// The rounded sum of any two numbers, and its error.
    fn two_sum(self, other: Self) -> (Self, Self);

    /// The same if the first is not the smaller.
    fn quick_two_sum(self, other: Self) -> (Self, Self);

    /// The rounded product, and its error.
    fn two_product(self, other: Self) -> (Self, Self);
}

impl ErrorFree for f64 {
    fn two_sum(self, other: Self) -> (Self, Self) {
        let s = self + other;
        let t = s - self;
        (s, (self - (s - t)) + (other - t))
    }

    fn quick_two_sum(self, other: Self) -> (Self, Self) {
        let s = self + other;
        (s, other - (s - self))
    }

    fn two_product(self, other: Self) -> (Self, Self) {
        let split = |a: f64| {
            let c = 134_217_729.0 * a; // 2^27 + 1
            let high = c - (c - a);
            (high, a - high)
        };
        let p = self * other;
        let ((ah, al), (bh, bl)) = (split(self), split(other));
        (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
    }
}

/// High and low part.
pub type Double<N> = [N; 2];

/// `DoubleDouble::add`.
pub fn add<N: ErrorFree>(a: Double<N>, b: Double<N>) -> Double<N> {
    let ((s, e), (t, f)) = (a[0].two_sum(b[0]), a[1].two_sum(b[1]));
    let (s, e) = s.quick_two_sum(e + t);
    s.quick_two_sum(e + f).into()
}

/// `DoubleDouble::mul`.
pub fn mul<N: ErrorFree>(a: Double<N>, b: Double<N>) -> Double<N> {
    let (p, e) = a[0].two_product(b[0]);
    p.quick_two_sum(e + (a[0] * b[1] + a[1] * b[0])).into()
}

/// `DoubleDouble::div`, of a quotient that is not zero.
pub fn div(a: Double<f64>, b: Double<f64>) -> Double<f64> {
    let minus = |d: Double<f64>| d.map(|x| -x);
    let q = a[0] / b[0];
    let r = add(a, minus(mul(b, [q, 0.0])));
    let q2 = r[0] / b[0];
    let r = add(r, minus(mul(b, [q2, 0.0])));
    let (s, e) = q.quick_two_sum(q2);
    s.quick_two_sum(e + r[0] / b[0]).into()
}
