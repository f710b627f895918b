//! Superquadrics.

use nalgebra::{Point3, Vector3};

use super::power::power;
use super::support::{Disc, Support};
use super::{Curved, Mass};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, scaled, sqrt};
use crate::base::tolerance::{TIP, UNIT};
use crate::body::polyhedron::{FaceId, Feature};

/// A superquadric about the origin: `((x/a)^(2/e2) + (y/b)^(2/e2))^(e2/e1) + (z/c)^(2/e1) <= 1`
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

    /// Returns the gauge of a place: at most one inside.
    pub(crate) fn gauge<T: Scalar>(&self, place: &Vec3<T>) -> T {
        let x = [0, 1, 2].map(|k| absolute(place[k]) / T::from(self.semi_axes[k]));
        let [p, q] = self.exponents.map(|e| T::from(2.0) / T::from(e));
        norm(norm(x[0], x[1], q), x[2], p)
    }

    #[inline(always)]
    fn dual<T: Scalar>(&self, n: &Vec3<T>) -> Dual<T> {
        let (two, zero) = (T::from(2.0), T::from(0.0));
        // p / (p - 1) of p = 2 / e.
        let q = self.exponents.map(|e| two / (two - T::from(e)));
        let axes = [0, 1, 2].map(|k| {
            T::from(if n[k] < zero {
                -self.semi_axes[k]
            } else {
                self.semi_axes[k]
            })
        });
        let [x, y, z] = [0, 1, 2].map(|k| axes[k] * n[k]);
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
        let [du, dv, dw] = [0, 1, 2].map(|k| dual.axes[k] * d[k]);
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
