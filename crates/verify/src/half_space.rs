//! Half-spaces: floors and walls without end.
//!
//! **Lemma 14.** A half-space {x : n . x <= e} that rests at x -> R x + p is {x : (R n) . x <= e + (R n) . p} in the
//! world. Along R n no point of it is higher than e + (R n) . p, so lemmas 3 and 9 hold with R n as the normal and
//! this one height. The normal is that of the half-space, in fractions: any other plane meets the half-space.
//!
//! One that moves is this at each time t, with n(t) = R(t) n and p(t). Rotations keep the length of n. So n(t) is the
//! difference of two points of the body, n and 0, and e more than the height of the point 0 along n(t) is the height:
//! forms of lemma 0.

use dashu_ratio::RBig;

use crate::Stop;
use crate::ellipsoid::above;
use crate::int::Int;
use crate::json::Json;
use crate::motion::{Span, Stage};
use crate::real::{Exact, Real, dot};
use crate::scene::Scene;
use crate::vectors::{Vector, fixed3, minus};

/// The points below a plane, in the frame of the body.
#[derive(Debug)]
pub(crate) struct HalfSpace {
    pub(crate) normal: [Real; 3],
    pub(crate) end: Real,
}

impl HalfSpace {
    /// Reads `[VECTOR,REAL]`.
    pub(crate) fn read(json: &Json) -> Result<Self, Stop> {
        let [normal, end] = json.list::<2>()?;
        let (normal, end) = (normal.reals::<3>()?, end.real()?);
        match normal == [Real::ZERO; 3] {
            true => Stop::bad("a half-space without a normal"),
            false => Ok(Self { normal, end }),
        }
    }
}

/// The plane between a half-space and a body: the normal from A to B, and how high the half-space is.
#[derive(Clone)]
pub(crate) struct Floor {
    /// Which of A and B the half-space is.
    pub(crate) side: usize,
    pub(crate) normal: Exact,
    height: RBig,
    /// The half-space if it moves; then normal and height are in its frame.
    moving: Option<usize>,
}

impl Floor {
    /// Returns the plane of a pair with a half-space, in the world or in the frame of link 0.
    pub(crate) fn of_pair(scene: &Scene, pair: (usize, usize), in_base: bool) -> Result<Option<Self>, Stop> {
        let bodies = [pair.0, pair.1];
        let Some(side) = bodies.iter().position(|k| scene.bodies[*k].half.is_some()) else {
            return Ok(None);
        };
        let Some(half) = &scene.bodies[bodies[side]].half else {
            return Ok(None);
        };
        if scene.bodies[bodies[1 - side]].half.is_some() {
            return Stop::fails(format!("{}: two half-spaces", scene.names(pair)));
        }
        let moving = Some(bodies[side]).filter(|k| scene.bodies[*k].moves && !in_base);
        let (mut normal, mut height) = (half.normal.map(Real::exact), half.end.exact());
        if moving.is_none() {
            let mut pose = scene.placed(bodies[side])?.pose;
            if let Some(base) = scene.base.as_ref().filter(|_| in_base) {
                pose = base.inverse().then(&pose);
            }
            normal = std::array::from_fn(|k| dot(&pose.rows[k], &normal));
            height += dot(&normal, &pose.shift);
        }
        if side == 1 {
            (normal, height) = (normal.map(|x| -x), -height);
        }
        Ok(Some(Self {
            side,
            normal,
            height,
            moving,
        }))
    }

    /// Encloses the normal in the world over an interval.
    pub(crate) fn direction<I: Int>(&self, scene: &Scene, stage: &Stage<I>, span: &Span) -> Option<Vector<I>> {
        let tip = self.moved(scene, stage, fixed3(&self.normal)?, span)?;
        minus(&tip, &self.foot(scene, stage, span)?)
    }

    /// Encloses the point from which the height counts: the origin of the half-space, or of the world if it rests.
    pub(crate) fn foot<I: Int>(&self, scene: &Scene, stage: &Stage<I>, span: &Span) -> Option<Vector<I>> {
        self.moved(scene, stage, fixed3(&crate::real::zero())?, span)
    }

    fn moved<I: Int>(&self, scene: &Scene, stage: &Stage<I>, point: Vector<I>, span: &Span) -> Option<Vector<I>> {
        match self.moving {
            Some(body) => stage.point(scene, body, &point, span),
            None => Some(point),
        }
    }

    /// Returns Bernstein coefficients of the height along the normal, rounded away from the half-space, in units of
    /// 2^-2P / W.
    pub(crate) fn heights<I: Int>(
        &self,
        scene: &Scene,
        stage: &Stage<I>,
        n: &Vector<I>,
        span: &Span,
    ) -> Option<Vec<I>> {
        let height = self.height::<I>(&stage.unit)?.mul(&I::small(I::W))?;
        let Some(body) = self.moving else {
            return Some(vec![height; I::D + 1]);
        };
        let both = stage.heights(scene, body, None, n, span)?;
        // As a bound from above if it is A, from below if it is B.
        both[1 - self.side].iter().map(|foot| foot.add(&height)).collect()
    }

    /// Returns how far the half-space is from a point of the other body with this height, times the length of the
    /// normal; less than 0 inside.
    pub(crate) fn gap(&self, along: RBig) -> RBig {
        match self.side {
            0 => along - &self.height,
            _ => &self.height - along,
        }
    }

    /// Returns the height of the half-space along the normal, rounded away from it, in units of 2^-2P.
    pub(crate) fn height<I: Int>(&self, unit: &RBig) -> Option<I> {
        let height = &self.height * unit;
        match self.side {
            0 => above::<I>(&height)?.up(),
            _ => I::small(0).sub(&above::<I>(&-height)?.up()?),
        }
    }
}

/// Refuses a line about a half-space that only bodies with an end can have.
pub(crate) fn refuse(scene: &Scene, pair: (usize, usize)) -> Result<(), Stop> {
    match scene.bodies[pair.0].half.is_some() || scene.bodies[pair.1].half.is_some() {
        true => Stop::bad("a half-space has planes, cells and near points as evidence alone"),
        false => Ok(()),
    }
}
