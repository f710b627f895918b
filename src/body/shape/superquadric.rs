//! Superquadrics, with powers in the arithmetic of a solver.

use crate::base::num::each::Each;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, scaled, sqrt};
use crate::base::tolerance::{TIP, UNIT};
use crate::body::polyhedron::{FaceId, Feature};
use crate::body::shape::support::{Disc, Support};
use crate::body::shape::{Curved, Mass};
use nalgebra::{Point3, Vector3};

/// A superquadric around the origin: `((x/a)^(2/e2) + (y/b)^(2/e2))^(e2/e1) + (z/c)^(2/e1) <= 1`
/// (Barr 1981).
///
/// With `p = 2 / e` the gauge is a norm of a norm. The support function is the dual norm of the
/// direction times the semi-axes, with exponents `q = p / (p - 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superquadric {
    pub(super) semi_axes: Vector3<f64>,
    pub(super) exponents: [f64; 2],
}

/// Dual norm of a direction, part by part.
struct Dual<T> {
    /// Exponents of the outer and of the inner norm.
    q: [T; 2],
    /// Signed semi-axes.
    axes: Vec3<T>,
    /// First coordinate of the direction times the semi-axis, over the inner norm; `v` is the
    /// second, `inner` the inner norm, `height` the outer norm.
    u: T,
    v: T,
    inner: T,
    /// Inner norm and last coordinate over the height.
    f: T,
    w: T,
    height: T,
}

impl Superquadric {
    /// Returns the semi-axes along x, y and z.
    #[must_use]
    pub fn semi_axes(&self) -> Vector3<f64> {
        self.semi_axes
    }

    /// Returns the exponents `e1` (north to south) and `e2` (east to west).
    #[must_use]
    pub fn exponents(&self) -> [f64; 2] {
        self.exponents
    }

    /// Returns the gauge of a point: at most one inside.
    pub(crate) fn gauge<T: Scalar>(&self, place: &Vec3<T>) -> T {
        let x = [0, 1, 2].each(|k| absolute(place[k]) / T::from(self.semi_axes[k]));
        let [p, q] = self.exponents.each(|e| T::from(2.0) / T::from(e));
        norm(norm(x[0], x[1], q), x[2], p)
    }

    #[inline(always)]
    fn dual<T: Scalar>(&self, n: &Vec3<T>) -> Dual<T> {
        let (two, zero) = (T::from(2.0), T::from(0.0));
        // p / (p - 1) of p = 2 / e.
        let q = self.exponents.each(|e| two / (two - T::from(e)));
        let axes = [0, 1, 2].each(|k| {
            T::from(if n[k] < zero {
                -self.semi_axes[k]
            } else {
                self.semi_axes[k]
            })
        });
        let [x, y, z] = [0, 1, 2].each(|k| axes[k] * n[k]);
        let inner = norm(x, y, q[1]);
        let height = norm(inner, z, q[0]);
        let share = |x: T, of: T| if of > zero { x / of } else { zero };
        Dual {
            q,
            axes,
            u: share(x, inner),
            v: share(y, inner),
            inner,
            f: share(inner, height),
            w: share(z, height),
            height,
        }
    }
}

fn absolute<T: Scalar>(x: T) -> T {
    if x < T::from(0.0) { -x } else { x }
}

/// Returns `(x^q + y^q)^(1/q)` for numbers that are not negative.
fn norm<T: Scalar>(x: T, y: T, q: T) -> T {
    let (large, small) = if x > y { (x, y) } else { (y, x) };
    if !(large > T::from(0.0)) {
        return T::from(0.0);
    }
    let one = T::from(1.0);
    large * power(one + power(small / large, q), one / q)
}

/// Returns `(q - 1) (x y)^(q - 2)` for shares that may vanish: at flat places and tips they count
/// as [`TIP`].
fn curvature<T: Scalar>(x: T, y: T, q: T) -> T {
    let product = x * y;
    let product = if product.value() > TIP { product } else { T::from(TIP) };
    (q - T::from(1.0)) * power(product, q - T::from(2.0))
}

impl Curved for Superquadric {
    const ORDER: u32 = 4;

    fn fingerprint(&self) -> Fingerprint {
        let ([x, y, z], [e, f]) = (self.semi_axes.into(), self.exponents);
        Fingerprint::of(*b"superqua", &[x, y, z, e, f])
    }

    fn scaled(&self, by: f64) -> Self {
        Self {
            semi_axes: self.semi_axes * by,
            ..*self
        }
    }

    fn contains(&self, p: &Vector3<f64>) -> bool {
        self.gauge(&[p.x, p.y, p.z]) <= 1.0
    }

    /// Returns the mass by beta functions (Jaklic, Leonardis and Solina 2000, "Segmentation and
    /// recovery of superquadrics", section 2.3).
    fn mass(&self) -> Mass {
        let ([e1, e2], a) = (self.exponents, self.semi_axes);
        let beta = |x: f64, y: f64| libm::tgamma(x) * libm::tgamma(y) / libm::tgamma(x + y);
        let volume = 2.0 * a.x * a.y * a.z * e1 * e2 * beta(e1 / 2.0 + 1.0, e1) * beta(e2 / 2.0, e2 / 2.0);
        let crosswise = 0.5 * a.x * a.y * a.z * e1 * e2 * beta(1.5 * e2, 0.5 * e2) * beta(0.5 * e1, 2.0 * e1 + 1.0);
        let lengthwise = 2.0 * a.x * a.y * a.z * e1 * e2 * beta(0.5 * e2, 0.5 * e2 + 1.0) * beta(1.5 * e1, e1 + 1.0);
        let mean = Vector3::new(crosswise, crosswise, lengthwise).component_mul(&a.component_mul(&a)) / volume;
        Mass::symmetric(volume, Point3::origin(), mean)
    }
}

impl Support for Superquadric {
    const IS_SMOOTH: bool = true;

    fn reach(&self) -> f64 {
        // A superquadric lies in the box of its semi-axes.
        sqrt(self.semi_axes.norm_squared()) * (1.0 + 4.0 * UNIT)
    }

    fn noise(&self) -> f64 {
        32.0 + self.exponents.iter().map(|e| 8.0 / (2.0 - e)).sum::<f64>()
    }

    fn support<T: Scalar>(&self, n: &Vec3<T>, _: u32) -> (u32, Vec3<T>) {
        (0, self.of_branch(0, n))
    }

    fn of_branch<T: Scalar>(&self, _: u32, n: &Vec3<T>) -> Vec3<T> {
        let dual = self.dual(n);
        let one = T::from(1.0);
        let outer = power(dual.f, dual.q[0] - one);
        [
            dual.axes[0] * power(dual.u, dual.q[1] - one) * outer,
            dual.axes[1] * power(dual.v, dual.q[1] - one) * outer,
            dual.axes[2] * power(dual.w, dual.q[0] - one),
        ]
    }

    fn bent<T: Scalar>(&self, _: u32, _: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
        let dual = self.dual(n);
        let (one, [q, p]) = (T::from(1.0), dual.q);
        let [du, dv, dw] = [0, 1, 2].each(|k| dual.axes[k] * d[k]);
        let (fu, fv) = (power(dual.u, p - one), power(dual.v, p - one));
        let along = fu * du + fv * dv;
        let inner = if dual.inner > T::from(0.0) {
            curvature(dual.u, dual.v, p) / dual.inner * (dual.v * du - dual.u * dv) * power(dual.f, q - one)
        } else {
            T::from(0.0)
        };
        let outer = curvature(dual.f, dual.w, q) / dual.height * (dual.w * along - dual.f * dw);
        [
            dual.axes[0] * (inner * dual.v + outer * dual.w * fu),
            dual.axes[1] * (outer * dual.w * fv - inner * dual.u),
            -dual.axes[2] * outer * dual.f,
        ]
    }

    #[inline(always)]
    fn ridge<T: Scalar>(&self, _: [u32; 2]) -> Option<(Vec3<T>, T)> {
        None
    }

    fn onto<T: Scalar>(&self, _: u32, place: &Vec3<T>) -> Vec3<T> {
        scaled(place, T::from(1.0) / self.gauge(place))
    }

    fn inner_ball(&self, point: &Vector3<f64>, _: &Vector3<f64>) -> (Vector3<f64>, f64) {
        (*point, 0.0)
    }

    fn disc(&self, _: &Vector3<f64>) -> Option<Disc> {
        None
    }

    fn feature(&self, _: &[u32], _: &Vector3<f64>) -> Feature {
        Feature::Face(FaceId(0))
    }
}

/// Terms of the series of the exponential: the rest is below 2^-110 for arguments below 2^-9.
const TERMS: u32 = 10;

/// Halvings of the argument.
const HALVINGS: i32 = 8;

/// `ln 2` in two parts.
const LN2: [f64; 2] = [core::f64::consts::LN_2, crate::base::tolerance::LN2_REST];

/// Returns `x^p` for an `x` that is not negative; zero if `x` is zero and `p` positive.
pub(super) fn power<T: Scalar>(x: T, p: T) -> T {
    let rough = libm::pow(x.value(), p.value());
    if T::UNIT == f64::UNIT || !(rough > 0.0 && rough.is_finite() && x.value() > 0.0) {
        return T::from(rough);
    }
    // One step of Newton's method doubles the digits of the logarithm.
    let l = T::from(libm::log(x.value()));
    // As a product of two roots: the inverse of a subnormal number is infinite.
    let inverse_root = exponential(-l * T::from(0.5));
    let l = l + (x * inverse_root * inverse_root - T::from(1.0));
    exponential(p * l)
}

/// Returns `e^x`.
fn exponential<T: Scalar>(x: T) -> T {
    let k = libm::round(x.value() / LN2[0]);
    let r = x - T::from(k) * T::from(LN2[0]) - T::from(k * LN2[1]);
    let small = r * T::from(1.0 / f64::from(1 << HALVINGS));
    // The series times the factorial of its last term: all factors are whole numbers.
    let (mut sum, mut factor) = (T::from(1.0), T::from(1.0));
    for n in (1..=TERMS).rev() {
        factor = factor * T::from(f64::from(n));
        sum = sum * small + factor;
    }
    sum = sum / factor;
    for _ in 0..HALVINGS {
        sum = sum * sum;
    }
    sum * T::from(libm::exp2(k))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::num::double_double::DoubleDouble;

    #[test]
    fn powers_keep_the_digits_of_their_arithmetic() {
        let of = DoubleDouble::from;
        for (x, n) in [(1.25, 3), (0.3, 5), (7.0, 2), (0.01, 7)] {
            let product = (0..n).fold(of(1.0), |y, _| y * of(x));
            let error = (power(of(x), of(f64::from(n))) / product - of(1.0)).value();
            assert!(error.abs() < 1e-28, "{x} {n} {error}");
        }
        let root = power(of(2.0), of(0.5));
        assert!((root * root - of(2.0)).value().abs() < 1e-28);
    }

    #[test]
    fn powers_of_subnormal_numbers_are_numbers() {
        for k in [1, 2, 3, 1 << 20, (1 << 52) - 1] {
            let x = f64::from_bits(k);
            let fourth = power(DoubleDouble::from(x), DoubleDouble::from(0.25));
            let error = (fourth * fourth * fourth * fourth).value() / x - 1.0;
            assert!(error.abs() < 1e-15 || x < 1e-308, "{x:e} {fourth:?} {error}");
            assert!((fourth.value() - libm::pow(x, 0.25)).abs() < 1e-90, "{x:e} {fourth:?}");
        }
    }
}
