//! The bodies in fixed point, and how they move over an interval of time.
//!
//! A body's vertex x is in the world at S_1(S_2(... x)), where each step S is a constant pose, a
//! shift that is a polynomial in time, or a turn exp([axis] v(t)) = I + s [axis] + u [axis]^2
//! with s and u of lemma 1. Lengths are divided by a power of two no less than any coordinate,
//! exactly: a scene scaled by a power of two gives the same integers.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::int::Int;
use crate::points::{Points, Pose};
use crate::real::{Exact, Real, dot as exact_dot, two_to};
use crate::scene::{Joint, Kind, Leg, Motion, Scene, Steady};
use crate::taylor::{Taylor, Vector, cross, dot, each, fixed3};
use crate::turn::{moved, root_above, turn};

/// An interval of time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) from: Real,
    pub(crate) until: Real,
}

impl Span {
    pub(crate) fn at(time: Real) -> Self {
        Self {
            from: time,
            until: time,
        }
    }

    pub(crate) fn length(&self) -> RBig {
        self.until.exact() - self.from.exact()
    }

    fn moved(&self, p: &[RBig]) -> Vec<RBig> {
        moved(p, &self.from.exact(), &self.length())
    }
}

/// One step of the way from the world to a body.
pub(crate) enum Step<I> {
    Place([Vector<I>; 3], Vector<I>),
    /// Polynomials in time.
    Shift([Vec<RBig>; 3]),
    Turn(Turn<I>),
}

type Known<I> = RefCell<HashMap<(u64, u64), Rc<[Taylor<I>; 2]>>>;

/// exp([axis] angle), the angle a polynomial in time; square is that of the axis.
pub(crate) struct Turn<I> {
    axis: Vector<I>,
    square: RBig,
    angle: Vec<RBig>,
    known: Known<I>,
}

impl<I: Int> Turn<I> {
    pub(crate) fn new(axis: &Exact, angle: Vec<RBig>) -> Option<Self> {
        Some(Self {
            axis: fixed3(axis)?,
            square: exact_dot(axis, axis),
            angle,
            known: Known::default(),
        })
    }

    /// Returns s and u of lemma 1.
    fn over(&self, span: &Span) -> Option<Rc<[Taylor<I>; 2]>> {
        let key = (span.from.bits(), span.until.bits());
        let mut known = self.known.borrow_mut();
        if let Some(parts) = known.get(&key) {
            return Some(parts.clone());
        }
        let parts = Rc::new(turn(&self.square, &span.moved(&self.angle))?);
        if known.len() == 1024 {
            known.clear();
        }
        known.insert(key, parts.clone());
        Some(parts)
    }

    pub(crate) fn point(&self, x: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        let (parts, once) = (self.over(span)?, cross(&self.axis, x)?);
        let twice = cross(&self.axis, &once)?;
        each(|k| x[k].plus(&parts[0].times(&once[k])?)?.plus(&parts[1].times(&twice[k])?))
    }

    fn row(&self, m: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        let (parts, once) = (self.over(span)?, cross(m, &self.axis)?);
        let twice = cross(&once, &self.axis)?;
        each(|k| m[k].plus(&parts[0].times(&once[k])?)?.plus(&parts[1].times(&twice[k])?))
    }
}

impl<I: Int> Step<I> {
    pub(crate) fn place(pose: &Pose, unit: &RBig) -> Option<Self> {
        let rows = each(|k| fixed3(&pose.rows[k]))?;
        Some(Self::Place(rows, fixed3(&pose.shift.each_ref().map(|x| x * unit))?))
    }

    pub(crate) fn point(&self, x: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        match self {
            Self::Place(rows, shift) => each(|k| dot(&rows[k], x)?.plus(&shift[k])),
            Self::Shift(way) => each(|k| x[k].plus(&Taylor::polynomial(&span.moved(&way[k]))?)),
            Self::Turn(turn) => turn.point(x, span),
        }
    }

    /// Of m . (step of x) + o the new m and o.
    pub(crate) fn plane(&self, m: &Vector<I>, o: &Taylor<I>, span: &Span) -> Option<(Vector<I>, Taylor<I>)> {
        Some(match self {
            Self::Place(rows, shift) => {
                let column = |k: usize| {
                    m[0].times(&rows[0][k])?
                        .plus(&m[1].times(&rows[1][k])?)?
                        .plus(&m[2].times(&rows[2][k])?)
                };
                (each(column)?, o.plus(&dot(m, shift)?)?)
            }
            Self::Shift(way) => {
                let way = each(|k| Taylor::polynomial(&span.moved(&way[k])))?;
                (m.clone(), o.plus(&dot(m, &way)?)?)
            }
            Self::Turn(turn) => (turn.row(m, span)?, o.clone()),
        })
    }
}

/// The vertices of a body in fixed point, within `inexact` units.
pub(crate) struct Solid<I> {
    pub(crate) points: Vec<[I; 3]>,
    inexact: I,
    most: [I; 3],
    pivot: Vector<I>,
    /// Radius of the ball around the vertices.
    reach: RBig,
    /// The middle of the box of the vertices, and the radius of a ball around it that holds them.
    pub(crate) middle: Vector<I>,
    pub(crate) round: RBig,
    /// The steps of the body itself, the one next to the world first.
    pub(crate) steps: Vec<Step<I>>,
    pub(crate) link: Option<usize>,
}

impl<I: Int> Solid<I> {
    fn new(points: &Points, motion: &Motion, scale: i64) -> Option<Self> {
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
        let reach = root_above(&(points.reach_squared(&points.pivot) * &unit * &unit));
        let round = root_above(&(points.reach_squared(&points.middle) * &unit * &unit));
        let middle = fixed3(&points.exact(&points.middle).map(|x| x * &unit))?;
        Some(Self {
            middle,
            round,
            points: all,
            inexact: I::small(inexact.into()),
            most,
            pivot,
            reach,
            steps,
            link,
        })
    }
}

impl<I: Int> Solid<I> {
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

/// All bodies in fixed point.
pub(crate) struct Stage<I> {
    pub(crate) unit: RBig,
    base: Option<Step<I>>,
    /// For each joint its origin and its motion.
    pub(crate) joints: Vec<[Option<Step<I>>; 2]>,
    pub(crate) solids: Vec<Solid<I>>,
}

impl<I: Int> Stage<I> {
    /// Returns `None` if a number is too large.
    pub(crate) fn new(scene: &Scene, leg: Option<&Leg>) -> Option<Self> {
        let unit = two_to(-scene.scale);
        let solids = scene
            .bodies
            .iter()
            .map(|b| Solid::new(&b.points, &b.motion, scene.scale))
            .collect::<Option<_>>()?;
        let base = match &scene.base {
            Some(base) => Some(Step::place(base, &unit)?),
            None => None,
        };
        let mut joints = Vec::new();
        for joint in &scene.joints {
            joints.push([Some(Step::place(&joint.origin, &unit)?), None]);
        }
        let mut stage = Self {
            unit,
            base,
            joints,
            solids,
        };
        if let Some(leg) = leg {
            stage.set(&scene.joints, leg)?;
        }
        Some(stage)
    }

    /// Sets the motion of the joints.
    pub(crate) fn set(&mut self, joints: &[Joint], leg: &Leg) -> Option<()> {
        for (joint, steps) in joints.iter().zip(&mut self.joints) {
            steps[1] = match joint.kind {
                Kind::Fixed => None,
                Kind::Turn => Some(Step::Turn(Turn::new(&joint.axis, joint.value(leg))?)),
                Kind::Slide => {
                    let value = joint.value(leg);
                    let way = |x: &RBig| value.iter().map(|v| v * x * &self.unit).collect();
                    Some(Step::Shift(joint.axis.each_ref().map(way)))
                }
            };
        }
        Some(())
    }

    /// Returns the steps from the body to the world.
    fn steps<'a>(&'a self, scene: &Scene, solid: &'a Solid<I>) -> Vec<&'a Step<I>> {
        let mut steps: Vec<_> = solid.steps.iter().rev().collect();
        if let Some(link) = solid.link {
            for joint in scene.chain(link) {
                steps.extend(self.joints[joint].iter().rev().flatten());
            }
            steps.extend(&self.base);
        }
        steps
    }

    /// Encloses a point of a body over an interval.
    pub(crate) fn point(&self, scene: &Scene, body: usize, x: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        self.steps(scene, &self.solids[body])
            .iter()
            .try_fold(x.clone(), |x, step| step.point(&x, span))
    }

    /// Encloses the centre of the ball of a body.
    pub(crate) fn centre(&self, scene: &Scene, body: usize, span: &Span) -> Option<Vector<I>> {
        self.point(scene, body, &self.solids[body].pivot, span)
    }

    pub(crate) fn reach(&self, body: usize) -> &RBig {
        &self.solids[body].reach
    }

    /// Encloses a vertex over an interval.
    pub(crate) fn vertex(&self, scene: &Scene, body: usize, k: usize, span: &Span) -> Option<Vector<I>> {
        let solid = &self.solids[body];
        let part = |x: &I| Taylor {
            c: vec![x.clone()],
            r: solid.inexact.clone(),
        };
        self.point(scene, body, &solid.points[k].each_ref().map(part), span)
    }

    /// Returns least and greatest Bernstein coefficients of the heights of some vertices along n, or of
    /// all, in units of 2^-2P / W: lower and upper bounds.
    pub(crate) fn heights(
        &self,
        scene: &Scene,
        body: usize,
        some: Option<&[usize]>,
        n: &Vector<I>,
        span: &Span,
    ) -> Option<[Vec<I>; 2]> {
        let solid = &self.solids[body];
        let chosen: Option<Vec<_>> = some.map(|some| some.iter().map(|k| solid.points[*k].clone()).collect());
        let points = chosen.as_ref().unwrap_or(&solid.points);
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
        Some(both)
    }
}

fn extremes<I: Int>(points: &[[I; 3]], n: &[I; 3]) -> Option<[I; 2]> {
    let height = |p: &[I; 3]| n[0].mul(&p[0])?.add(&n[1].mul(&p[1])?)?.add(&n[2].mul(&p[2])?);
    let first = height(&points[0])?;
    points[1..].iter().try_fold([first.clone(), first], |[low, high], p| {
        let h = height(p)?;
        Some(if h < low {
            [h, high]
        } else if h > high {
            [low, h]
        } else {
            [low, high]
        })
    })
}
