//! The way from a body to a link, at one configuration.
//!
//! From the body it leads down its joints to the last one that the link shares, or to the base, and
//! from there backwards through the joints of the link. What both share moves neither against the
//! other.

use dashu_ratio::RBig;

use crate::int::Int;
use crate::motion::{Span, Stage, Step, Turn};
use crate::real::Real;
use crate::scene::{Kind, Scene};
use crate::vectors::{Vector, fixed3};

/// A step of the way, and the joint that it is, with the axis along which its value moves the body.
pub(crate) struct Hop<'a, I> {
    pub(crate) step: Held<'a, I>,
    pub(crate) joint: Option<(usize, Vector<I>)>,
}

pub(crate) enum Held<'a, I> {
    Known(&'a Step<I>),
    Made(Box<Step<I>>),
}

impl<I> Held<'_, I> {
    pub(crate) fn get(&self) -> &Step<I> {
        match self {
            Self::Known(step) => step,
            Self::Made(step) => step,
        }
    }
}

/// The only time of a configuration.
pub(crate) fn at_once() -> Span {
    Span::at(Real::ZERO)
}

impl<I: Int> Stage<I> {
    /// Returns the steps from a body to a link, with these values of the joints.
    pub(crate) fn hops(
        &self,
        scene: &Scene,
        link: usize,
        body: usize,
        value: impl Fn(usize) -> RBig,
    ) -> Option<Vec<Hop<'_, I>>> {
        let known = |step| Hop {
            step: Held::Known(step),
            joint: None,
        };
        let made = |step| Hop {
            step: Held::Made(Box::new(step)),
            joint: None,
        };
        let solid = &self.solids[body];
        let mut hops: Vec<_> = solid.steps.iter().rev().map(known).collect();
        let (mut down, mut up) = (solid.link.map_or(Vec::new(), |on| scene.chain(on)), scene.chain(link));
        while down.last().is_some_and(|joint| up.last() == Some(joint)) {
            down.pop();
            up.pop();
        }
        if let (None, Some(base)) = (solid.link, &scene.base) {
            hops.push(made(Step::place(&base.inverse(), &self.unit)?));
        }
        let motion = |k: usize, back: bool| {
            let (joint, sign) = (&scene.joints[k], RBig::from(if back { -1 } else { 1 }));
            let (axis, v) = (joint.axis.each_ref().map(|x| x * &sign), value(k));
            Some(match joint.kind {
                Kind::Fixed => None,
                Kind::Turn => Some(Hop {
                    step: Held::Made(Box::new(Step::Turn(Turn::new(&axis, vec![v])?))),
                    joint: Some((k, fixed3(&axis)?)),
                }),
                Kind::Slide => {
                    let axis = axis.map(|x| x * &self.unit);
                    let way = axis.each_ref().map(|x| vec![x * &v]);
                    Some(Hop {
                        step: Held::Made(Box::new(Step::Shift(way))),
                        joint: Some((k, fixed3(&axis)?)),
                    })
                }
            })
        };
        for joint in down {
            hops.extend(motion(joint, false)?);
            hops.extend(self.joints[joint][0].as_ref().map(known));
        }
        for joint in up.into_iter().rev() {
            hops.push(made(Step::place(&scene.joints[joint].origin.inverse(), &self.unit)?));
            hops.extend(motion(joint, true)?);
        }
        Some(hops)
    }
}
