//! Ellipsoids and ellipses about points: the ends of cylinders and cones, and bodies that are ellipsoids.
//!
//! **Lemma 13.** The ellipsoid about c with the semi-axes v_k is the set of all c + x_1 v_1 + x_2 v_2 + ... with
//! |x| <= 1; with two of them it is an ellipse. Along m its heights are m . c - B to m . c + B, where B is the
//! length of the vector of all m . v_k, by the inequality of Cauchy and Schwarz. Where m is a form of lemma 0,
//! P = B^2 is one as well, and for every s > 0 the root of P is at most (P + s^2) / (2 s), because
//! (root - s)^2 is not negative. So the Bernstein coefficients of P, changed in this way, bound B from above. The
//! number s is rounded up from the root of the greatest of them; nearer to the root of P the bound is closer, and
//! any s holds.
//!
//! The ellipsoid is in the ball about c whose squared radius is the greatest sum of a row of all |v_i . v_j|, because no
//! eigenvalue of this matrix is larger (Gershgorin).

use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

use crate::Stop;
use crate::int::Int;
use crate::json::Json;
use crate::real::{Exact, Real, dot as exact_dot, root_above};
use crate::taylor::{Taylor, below};
use crate::vectors::{Vector, dot, fixed3};

/// Most ellipsoids of a body.
const MOST: usize = 1 << 18;

/// An ellipsoid about a point of its body.
#[derive(Debug)]
pub(crate) struct Ellipsoid {
    /// The number of the point.
    pub(crate) centre: usize,
    /// The semi-axes: one to three.
    axes: Vec<Exact>,
    /// The greatest absolute component of the semi-axes.
    pub(crate) size: Real,
}

impl Ellipsoid {
    /// Reads `[[i,[VECTOR,...]],...]` of a body with so many points.
    pub(crate) fn read(json: &Json, points: usize) -> Result<Vec<Self>, Stop> {
        let ellipsoid = |json: &Json| {
            let [centre, axes] = json.list::<2>()?;
            let (centre, axes) = (centre.whole()?, axes.array()?);
            let axes = axes.iter().map(Json::reals::<3>).collect::<Result<Vec<_>, _>>()?;
            let size = axes.iter().flatten().fold(Real::ZERO, |most, x| most.larger(*x));
            if centre >= points || axes.len() > 3 || size == Real::ZERO {
                return Stop::bad("an ellipsoid about an unknown point, without extent, or with more than three axes");
            }
            let axes = axes.iter().map(|axis| axis.map(Real::exact)).collect();
            Ok(Self { centre, axes, size })
        };
        match json.array()? {
            [] => Stop::bad("a list of ellipsoids without one"),
            all if all.len() > MOST => Stop::bad(format!("a body has at most {MOST} ellipsoids")),
            all => all.iter().map(ellipsoid).collect(),
        }
    }

    /// Returns the radius of a ball about the point that contains the ellipsoid, in units.
    pub(crate) fn radius(&self, unit: &RBig) -> RBig {
        let row = |u: &Exact| {
            let sizes = self.axes.iter().map(|v| exact_dot(u, v));
            sizes.fold(RBig::ZERO, |sum, x| if x < RBig::ZERO { sum - x } else { sum + x })
        };
        root_above(&(self.axes.iter().map(row).max().unwrap_or(RBig::ZERO) * unit * unit))
    }
}

/// An ellipsoid in fixed point.
pub(crate) struct FixedEllipsoid<I> {
    pub(crate) centre: usize,
    /// The semi-axes over the size.
    axes: Vec<Vector<I>>,
    /// Rounded up.
    size: I,
}

impl<I: Int> FixedEllipsoid<I> {
    pub(crate) fn new(of: &Ellipsoid, unit: &RBig) -> Option<Self> {
        let size = of.size.exact();
        let axis = |axis: &Exact| fixed3(&axis.each_ref().map(|x| x / &size));
        Some(Self {
            centre: of.centre,
            axes: of.axes.iter().map(axis).collect::<Option<_>>()?,
            size: above(&(&size * unit))?,
        })
    }

    /// Returns the square of the half height along m, over that of the size.
    fn square(&self, m: &Vector<I>) -> Option<Taylor<I>> {
        self.axes.iter().try_fold(Taylor::whole(0)?, |sum, axis| {
            let way = dot(m, axis)?;
            sum.plus(&way.times(&way)?)
        })
    }

    /// No half height along constants m is larger, in units of 2^-2P.
    pub(crate) fn half_height(&self, m: &Vector<I>) -> Option<I> {
        self.size.mul(&root_of(&self.square(m)?)?)
    }

    /// Returns Bernstein coefficients of a polynomial that is no less than the half height along m, in units
    /// of 2^-2P / W.
    pub(crate) fn half_heights(&self, m: &Vector<I>) -> Option<Vec<I>> {
        let square = self.square(m)?;
        let (whole, rest) = (I::small(I::W), square.r.mul(&I::small(I::W))?);
        let net = square.net()?.iter().map(|c| c.add(&rest)).collect::<Option<Vec<I>>>()?;
        let most = net.iter().max()?.clone().max(I::small(0));
        let s = root(&most.over(I::W).add(&I::small(1))?)?;
        let squared = whole.mul(&s.mul(&s)?.down().add(&I::small(1))?)?;
        let twice = s.add(&s)?;
        let half = |c: &I| {
            self.size
                .mul(&c.add(&squared)?.up()?.quotient(&twice).add(&I::small(1))?)
        };
        net.iter().map(half).collect()
    }
}

/// Rounded up, in units of 2^-P.
pub(crate) fn above<I: Int>(q: &RBig) -> Option<I> {
    let (whole, rest) = below(q, I::P);
    I::of(whole + IBig::from(rest))
}

/// More than the root of a number that is not negative, both in units of 2^-P.
fn root<I: Int>(x: &I) -> Option<I> {
    let root = UBig::try_from(x.wide() << I::P).map_or(UBig::ZERO, |x| dashu_base::SquareRoot::sqrt(&x));
    I::of(IBig::from(root) + IBig::ONE)
}

/// No root of a constant is larger.
fn root_of<I: Int>(x: &Taylor<I>) -> Option<I> {
    root(&x.c[0].add(&x.r)?)
}

/// No length of a vector of constants is larger.
pub(crate) fn length<I: Int>(v: &Vector<I>) -> Option<I> {
    root_of(&dot(v, v)?)
}
