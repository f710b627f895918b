//! A body in fixed point.

use dashu_int::IBig;
use dashu_ratio::RBig;

use super::step::{Step, Turn};
use crate::ellipsoid::FixedEllipsoid;
use crate::int::Int;
use crate::pose::Pose;
use crate::real::{Exact, dot as exact_dot, root_above, two_to};
use crate::scene::{Body, Motion, Steady};
use crate::taylor::Taylor;
use crate::vectors::{Vector, each, fixed3};

/// The vertices of a body in fixed point, within `inexact` units.
pub(crate) struct Solid<I> {
    pub(crate) points: Vec<[I; 3]>,
    pub(crate) ellipsoids: Vec<FixedEllipsoid<I>>,
    pub(super) inexact: I,
    pub(super) most: [I; 3],
    pub(super) pivot: Vector<I>,
    /// Radius of the ball around the vertices and ellipsoids.
    pub(super) reach: RBig,
    /// The middle of the box of the vertices, and the radius of a ball around it that holds them and the ellipsoids.
    pub(crate) middle: Vector<I>,
    pub(crate) round: RBig,
    /// The steps of the body itself, the one next to the world first.
    pub(crate) steps: Vec<Step<I>>,
    pub(crate) link: Option<usize>,
}

impl<I: Int> Solid<I> {
    pub(super) fn new(body: &Body, scale: i64) -> Option<Self> {
        let (points, motion) = (&body.points, &body.motion);
        let (shift, unit) = (points.exponent - scale + I::P as i64, two_to(-scale));
        let mut inexact = false;
        let mut fixed = |x: &IBig| {
            let size = shift.unsigned_abs() as usize;
            let whole = if shift < 0 { x >> size } else { x << size };
            inexact |= shift < 0 && &whole << size != *x;
            I::of(whole)
        };
        let mut all = Vec::new();
        for p in &points.all {
            all.push([fixed(&p[0])?, fixed(&p[1])?, fixed(&p[2])?]);
        }
        let most = |k: usize| {
            let sizes = all.iter().map(|p| p[k].size()).collect::<Option<Vec<_>>>()?;
            sizes.into_iter().max()?.add(&I::small(1))
        };
        let scaled = |v: &Exact| v.each_ref().map(|x| x * &unit);
        let (mut pivot, mut link) = (crate::real::zero(), None);
        let steps = match motion {
            Motion::Rest(pose) => vec![Step::place(pose, &unit)?],
            Motion::Link(on, pose) => {
                link = Some(*on);
                vec![Step::place(pose, &unit)?]
            }
            Motion::Steady(steady) => {
                let Steady {
                    pose,
                    pivot: about,
                    linear,
                    angular,
                    push,
                } = &**steady;
                pivot = scaled(about);
                let lever: Exact = std::array::from_fn(|k| exact_dot(&pose.rows[k], about));
                let way = |k: usize| {
                    [&pose.shift[k] + &lever[k], linear[k].clone(), &push[k] / RBig::from(2)]
                        .map(|x| x * &unit)
                        .to_vec()
                };
                let inner = Pose {
                    rows: pose.rows.clone(),
                    shift: lever.each_ref().map(|x| -x),
                };
                let spin = Turn::new(angular, vec![RBig::ZERO, RBig::ONE])?;
                vec![
                    Step::Shift([way(0), way(1), way(2)]),
                    Step::Turn(spin),
                    Step::place(&inner, &unit)?,
                ]
            }
        };
        let (most, pivot) = (each(most)?, fixed3(&pivot)?);
        let wider = body.ellipsoids.iter().map(|ellipsoid| ellipsoid.radius(&unit));
        let wider = wider.max().unwrap_or(RBig::ZERO);
        let reach = root_above(&(points.reach_squared(&points.pivot) * &unit * &unit)) + &wider;
        let round = root_above(&(points.reach_squared(&points.middle) * &unit * &unit)) + &wider;
        let middle = fixed3(&points.exact(&points.middle).map(|x| x * &unit))?;
        Some(Self {
            middle,
            round,
            ellipsoids: body
                .ellipsoids
                .iter()
                .map(|ellipsoid| FixedEllipsoid::new(ellipsoid, &unit))
                .collect::<Option<_>>()?,
            points: all,
            inexact: I::small(inexact.into()),
            most,
            pivot,
            reach,
            steps,
            link,
        })
    }

    /// Returns the ellipsoids about some of the points, which are sorted, or all.
    pub(crate) fn ellipsoids_of(&self, some: Option<&[usize]>) -> impl Iterator<Item = &FixedEllipsoid<I>> {
        let is_of =
            move |ellipsoid: &&FixedEllipsoid<I>| some.is_none_or(|some| some.binary_search(&ellipsoid.centre).is_ok());
        self.ellipsoids.iter().filter(is_of)
    }

    /// By how much the height m . x + o of a vertex departs from that of the polynomials, in units of
    /// 2^-2P.
    pub(crate) fn off(&self, m: &Vector<I>, o: &Taylor<I>) -> Option<I> {
        let mut off = o.r.up()?;
        for (part, most) in m.iter().zip(&self.most) {
            off = off
                .add(&part.r.mul(most)?)?
                .add(&self.inexact.mul(&part.most()?.add(&part.r)?)?)?;
        }
        Some(off)
    }
}
