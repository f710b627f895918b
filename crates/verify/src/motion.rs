//! The bodies in fixed point, and how they move over an interval of time.
//!
//! A body's vertex x is in the world at S_1(S_2(... x)), where each step S is a constant pose, a
//! shift that is a polynomial in time, or a turn exp([axis] v(t)) = I + s [axis] + u [axis]^2
//! with s and u of lemma 1. Lengths are divided by a power of two no less than any coordinate,
//! exactly: a scene scaled by a power of two gives the same integers.

mod heights;
mod solid;
mod step;

pub(crate) use heights::chosen;
pub(crate) use solid::Solid;
pub(crate) use step::{Step, Turn};

use dashu_ratio::RBig;

use crate::int::Int;
use crate::polynomial::moved;
use crate::real::{Real, two_to};
use crate::scene::{Joint, Kind, Leg, Scene};
use crate::taylor::Taylor;
use crate::vectors::Vector;

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
            .map(|b| Solid::new(b, scene.scale))
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
}
