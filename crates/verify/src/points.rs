//! Vertices as integers times one power of two, and means of them.

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::Stop;
use crate::json::Json;
use crate::real::{Exact, Real, two_to};

/// The vertices of a body.
#[derive(Debug)]
pub(crate) struct Points {
    pub(crate) all: Vec<[IBig; 3]>,
    /// The centre of the ball around the vertices.
    pub(crate) pivot: [IBig; 3],
    /// About the middle of the box of the vertices.
    pub(crate) middle: [IBig; 3],
    /// All coordinates are integers times 2^exponent.
    pub(crate) exponent: i64,
}

impl Points {
    /// Most vertices of a body.
    const MOST: usize = 1 << 18;

    pub(crate) fn read(json: &Json, pivot: [Real; 3]) -> Result<(Self, [Real; 3]), Stop> {
        let all = json.array()?;
        if all.is_empty() || all.len() > Self::MOST {
            return Stop::bad(format!("a body has 1 to {} points, not {}", Self::MOST, all.len()));
        }
        let reals = all.iter().map(Json::reals::<3>).collect::<Result<Vec<_>, _>>()?;
        let odd = |x: &Real| {
            let (m, e) = x.parts();
            (m != 0).then(|| e + i64::from(m.trailing_zeros()))
        };
        let exponent = reals
            .iter()
            .chain([&pivot])
            .flatten()
            .filter_map(odd)
            .min()
            .unwrap_or(0);
        let whole = |p: &[Real; 3]| {
            p.map(|x| {
                let (m, e) = x.parts();
                if e < exponent {
                    IBig::from(m >> (exponent - e).min(63))
                } else {
                    IBig::from(m) << (e - exponent) as usize
                }
            })
        };
        let all: Vec<[IBig; 3]> = reals.iter().map(whole).collect();
        let middle = |k: usize| {
            let part = |p: &[IBig; 3]| p[k].clone();
            let ends = all.iter().map(part).min().zip(all.iter().map(part).max());
            ends.map_or(IBig::ZERO, |(low, high)| (low + high) >> 1usize)
        };
        let points = Self {
            middle: std::array::from_fn(middle),
            all,
            pivot: whole(&pivot),
            exponent,
        };
        let mut most = [Real::ZERO; 3];
        for p in &reals {
            for k in 0..3 {
                most[k] = most[k].larger(p[k]);
            }
        }
        Ok((points, most))
    }

    /// Returns the greatest square of a distance of a vertex from a point.
    pub(crate) fn reach_squared(&self, from: &[IBig; 3]) -> RBig {
        let square = |p: &[IBig; 3]| {
            p.iter()
                .zip(from)
                .fold(IBig::ZERO, |sum, (x, c)| sum + (x - c) * (x - c))
        };
        let most = self.all.iter().map(square).max().unwrap_or_default();
        RBig::from(most) * two_to(2 * self.exponent)
    }

    pub(crate) fn get(&self, k: usize) -> Option<Exact> {
        Some(self.exact(self.all.get(k)?))
    }

    pub(crate) fn exact(&self, p: &[IBig; 3]) -> Exact {
        let unit = two_to(self.exponent);
        p.each_ref().map(|x| RBig::from(x.clone()) * &unit)
    }

    /// Returns the mean of vertices with weights, in the frame of the body.
    pub(crate) fn mean(&self, weights: &[(usize, Real)]) -> Option<Exact> {
        let total = weights.iter().fold(RBig::ZERO, |sum, (_, w)| sum + w.exact());
        let mut at = crate::real::zero();
        for (k, w) in weights {
            let (p, w) = (self.get(*k)?, w.exact() / &total);
            for (x, p) in at.iter_mut().zip(p) {
                *x += p * &w;
            }
        }
        Some(at)
    }
}

/// Reads weights `[[index, weight], ...]`: none negative, not all zero.
pub(crate) fn weights(json: &Json) -> Result<Vec<(usize, Real)>, Stop> {
    let entry = |x: &Json| {
        let [k, w] = x.list::<2>()?;
        Ok((k.whole()?, w.real()?))
    };
    let all = json.array()?.iter().map(entry).collect::<Result<Vec<_>, Stop>>()?;
    if all.iter().any(|x| x.1 < Real::ZERO) || !all.iter().any(|x| x.1 > Real::ZERO) {
        return Stop::bad("weights: one is negative, or none is positive");
    }
    Ok(all)
}
