//! Discs: the ends of cylinders and cones.
//!
//! **Lemma 13.** The disc of radius r about c, perpendicular to a, has the heights m . c - B to m . c + B along
//! m, where B = r |m x a| / |a|: of a point c + y of the disc, m . y is at most |y| times the length of the
//! part of m that is perpendicular to a. Where m is a form of lemma 0, P = |m x a|^2 is one as well, and
//! for every s > 0 the root of P is at most (P + s^2) / (2 s), because (root - s)^2 is not negative. So
//! the Bernstein coefficients of P, changed in this way, bound B from above. The number s is rounded up from
//! the root of the greatest of them; nearer to the root of P the bound is closer, and any s holds.

use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

use crate::Stop;
use crate::int::Int;
use crate::json::Json;
use crate::real::{Exact, Real, dot as exact_dot, root_above};
use crate::taylor::below;
use crate::vectors::{Vector, cross, dot, fixed3};

/// Most discs of a body.
const MOST: usize = 1024;

/// A disc about a point of its body.
#[derive(Debug)]
pub(crate) struct Disc {
    /// The number of the point.
    pub(crate) centre: usize,
    axis: Exact,
    pub(crate) radius: Real,
}

impl Disc {
    /// Reads `[[i,VECTOR,REAL],...]` of a body with so many points.
    pub(crate) fn read(json: &Json, points: usize) -> Result<Vec<Self>, Stop> {
        let disc = |json: &Json| {
            let [centre, axis, radius] = json.list::<3>()?;
            let (centre, axis, radius) = (centre.whole()?, axis.reals::<3>()?, radius.real()?);
            if centre >= points || radius < Real::ZERO || axis == [Real::ZERO; 3] {
                return Stop::bad("a disc of an unknown point, without an axis, or with a negative radius");
            }
            let axis = axis.map(Real::exact);
            Ok(Self { centre, axis, radius })
        };
        match json.array()? {
            [] => Stop::bad("a list of discs without a disc"),
            all if all.len() > MOST => Stop::bad(format!("a body has at most {MOST} discs")),
            all => all.iter().map(disc).collect(),
        }
    }
}

/// A disc in fixed point.
pub(crate) struct FixedDisc<I> {
    pub(crate) centre: usize,
    axis: Vector<I>,
    /// The radius over the length of the axis, rounded up.
    slim: I,
}

impl<I: Int> FixedDisc<I> {
    pub(crate) fn new(disc: &Disc, unit: &RBig) -> Option<Self> {
        let shorter = root_above(&(RBig::ONE / exact_dot(&disc.axis, &disc.axis)));
        Some(Self {
            centre: disc.centre,
            axis: fixed3(&disc.axis)?,
            slim: above(&(disc.radius.exact() * unit * shorter))?,
        })
    }

    /// No half height along constants m is larger, in units of 2^-2P.
    pub(crate) fn half_height(&self, m: &Vector<I>) -> Option<I> {
        self.slim.mul(&length(&cross(m, &self.axis)?)?)
    }

    /// Returns Bernstein coefficients of a polynomial that is no less than the half height along m, in units
    /// of 2^-2P / W.
    pub(crate) fn half_heights(&self, m: &Vector<I>) -> Option<Vec<I>> {
        let way = cross(m, &self.axis)?;
        let square = dot(&way, &way)?;
        let (whole, rest) = (I::small(I::W), square.r.mul(&I::small(I::W))?);
        let net = square.net()?.iter().map(|c| c.add(&rest)).collect::<Option<Vec<I>>>()?;
        let most = net.iter().max()?.clone().max(I::small(0));
        let s = root(&most.over(I::W).add(&I::small(1))?)?;
        let squared = whole.mul(&s.mul(&s)?.down().add(&I::small(1))?)?;
        let twice = s.add(&s)?;
        let half = |c: &I| {
            self.slim
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

/// No length of a vector of constants is larger.
pub(crate) fn length<I: Int>(v: &Vector<I>) -> Option<I> {
    let square = dot(v, v)?;
    root(&square.c[0].add(&square.r)?)
}
