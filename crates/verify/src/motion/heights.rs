//! Heights of vertices along a direction.

use std::borrow::Cow;

use super::{Span, Stage};
use crate::int::Int;
use crate::scene::Scene;
use crate::taylor::Taylor;
use crate::vectors::Vector;

impl<I: Int> Stage<I> {
    /// Returns least and greatest Bernstein coefficients of the heights of some vertices along n, or of
    /// all, and of the ellipsoids about them, in units of 2^-2P / W: lower and upper bounds.
    pub(crate) fn heights(
        &self,
        scene: &Scene,
        body: usize,
        some: Option<&[usize]>,
        n: &Vector<I>,
        span: &Span,
    ) -> Option<[Vec<I>; 2]> {
        let solid = &self.solids[body];
        let points = &*chosen(&solid.points, some);
        let (mut m, mut o) = (n.clone(), Taylor::whole(0)?);
        for step in self.steps(scene, solid).iter().rev() {
            (m, o) = step.plane(&m, &o, span)?;
        }
        let (nets, base) = ([m[0].net()?, m[1].net()?, m[2].net()?], o.net()?);
        let off = solid.off(&m, &o)?.mul(&I::small(I::W))?;
        let mut both = [Vec::new(), Vec::new()];
        let mut ends: Option<[I; 2]> = None;
        for (k, b) in base.iter().enumerate() {
            // A plane that rests, against a body that rests: all coefficients are equal.
            let same = k > 0 && nets.iter().all(|net| net[k] == net[k - 1]);
            let found = match ends.filter(|_| same) {
                Some(ends) => ends,
                None => extremes(points, &nets.each_ref().map(|net| net[k].clone()))?,
            };
            let b = b.up()?;
            both[0].push(found[0].add(&b)?.sub(&off)?);
            both[1].push(found[1].add(&b)?.add(&off)?);
            ends = Some(found);
        }
        for ellipsoid in solid.ellipsoids_of(some) {
            let p = &solid.points[ellipsoid.centre];
            for (k, half) in ellipsoid.half_heights(&m)?.into_iter().enumerate() {
                let [middle, _] = extremes(core::slice::from_ref(p), &nets.each_ref().map(|net| net[k].clone()))?;
                let (middle, half) = (middle.add(&base[k].up()?)?, half.add(&off)?);
                both[0][k] = both[0][k].clone().min(middle.sub(&half)?);
                both[1][k] = both[1][k].clone().max(middle.add(&half)?);
            }
        }
        Some(both)
    }
}

/// Returns some of the points, or all.
pub(crate) fn chosen<'a, I: Int>(all: &'a [[I; 3]], some: Option<&[usize]>) -> Cow<'a, [[I; 3]]> {
    match some {
        Some(some) => some.iter().map(|k| all[*k].clone()).collect(),
        None => Cow::Borrowed(all),
    }
}

fn extremes<I: Int>(points: &[[I; 3]], n: &[I; 3]) -> Option<[I; 2]> {
    let height = |p: &[I; 3]| n[0].mul(&p[0])?.add(&n[1].mul(&p[1])?)?.add(&n[2].mul(&p[2])?);
    let first = height(&points[0])?;
    points[1..].iter().try_fold([first.clone(), first], |[low, high], p| {
        let h = height(p)?;
        Some([low.min(h.clone()), high.max(h)])
    })
}
