//! The rest of lemma 9: by how much the second derivatives move a height over a cell.

use dashu_ratio::RBig;

use super::InCell;
use crate::ellipsoid::{above, length};
use crate::hops::{Hop, at_once};
use crate::int::Int;
use crate::motion::Solid;
use crate::scene::{Kind, Scene};
use crate::vectors::{cross, fixed3};

fn product<I: Int>(x: &I, y: &I) -> Option<I> {
    x.mul(y)?.down().add(&I::small(1))
}

impl InCell {
    /// Returns |n| R of the lemma, in units of 2^-P.
    pub(super) fn rest<I: Int>(&self, scene: &Scene, solid: &Solid<I>, hops: &[Hop<'_, I>]) -> Option<I> {
        let (mut x, reach) = (solid.middle.clone(), above::<I>(&solid.round)?);
        let (mut moved, mut rest) = (I::small(0), I::small(0));
        for hop in hops {
            if let Some((joint, axis)) = &hop.joint {
                let (joint, size) = (&scene.joints[*joint], length(axis)?);
                let factor = joint.factor().clone();
                let factor = if factor < RBig::ZERO { -factor } else { factor };
                let half = above::<I>(&(self.half(joint.coordinate()) * factor))?;
                let speed = match joint.kind {
                    Kind::Turn => length(&cross(axis, &x)?)?.add(&product(&size, &reach.add(&moved)?)?)?,
                    _ => size.clone(),
                };
                let way = product(&speed, &half)?;
                if joint.kind == Kind::Turn {
                    let between = moved.add(&way.half().add(&I::small(1))?)?;
                    rest = rest.add(&product(&product(&size, &half)?, &between)?)?;
                }
                moved = moved.add(&way)?;
            }
            x = hop.step.get().point(&x, &at_once())?;
        }
        product(&rest, &length(&fixed3(&self.normal)?)?)
    }
}
