//! A plane between two bodies over a cell: a box of configurations.
//!
//! **Lemma 9.** Let q be the middle of the cell, h_c its half width along coordinate c, and n fixed to
//! a link. The height f = n . x of a vertex x of a body depends on the joints between link and body
//! alone. Along the straight way from q to any configuration of the cell, by Taylor,
//!
//! |f - f(q)| <= sum over c of h_c |df/dc (q)| + |n| R, R = sum over turns i of t_i (S_i + W_i h_i / 2).
//!
//! Joints count from the body to the link; h_i is the half width of joint i, |factor| h_c, and t_i =
//! |axis| h_i for a turn. W_i is no less than the speed |axis x (x - o_i)| of any vertex by a turn, or
//! |axis| for a slide, over the whole cell, and S_i = sum of W_k h_k over the joints k before i. For a
//! second derivative by joints k and i, k no later than i, is n times rotations of [axis_i] applied to
//! the velocity by k, or 0 if i is a slide: at most |n| |axis_i| W_k. The way moves x in the frame of
//! joint i by at most S_i, and W_i is the speed at q of the middle of the body's box, plus |axis| times
//! the distance of any vertex from it, plus |axis| S_i.
//!
//! If the heights of all of B exceed those of all of A by g > 0 over the cell, and g^2 > (keep +
//! radii)^2 |n|^2, the bodies are more than `keep` apart at every configuration of the cell.

mod rest;

use std::collections::BTreeMap;

use dashu_ratio::RBig;

use crate::claim::{Claim, beyond};
use crate::ellipsoid::{FixedEllipsoid, above};
use crate::half_space::Floor;
use crate::hops::at_once;
use crate::int::Int;
use crate::motion::{Stage, chosen};
use crate::real::{Exact, Real};
use crate::scene::{Kind, Scene};
use crate::taylor::Taylor;
use crate::vectors::{Vector, cross, dot, each, fixed3};

/// A plane fixed to a link keeps two bodies, or some of their vertices, more than `kept` apart over a cell.
pub(crate) struct InCell {
    pub(crate) pair: (usize, usize),
    pub(crate) some: [Option<Vec<usize>>; 2],
    pub(crate) cell: Vec<[Real; 2]>,
    pub(crate) link: usize,
    pub(crate) normal: Exact,
    /// One of the two is a half-space.
    pub(crate) floor: Option<Floor>,
    /// What the line keeps, and the radii.
    pub(crate) kept: RBig,
}

/// The height m . x + o of a vertex, all of them constants, in units of 2^-2P.
fn height<I: Int>(p: &[I; 3], m: &Vector<I>, o: &Taylor<I>) -> Option<I> {
    if o.c.len() != 1 || m.iter().any(|part| part.c.len() != 1) {
        return None;
    }
    (0..3).try_fold(o.c[0].up()?, |sum, k| sum.add(&m[k].c[0].mul(&p[k])?))
}

impl InCell {
    fn half(&self, coordinate: usize) -> RBig {
        let [low, high] = self.cell[coordinate].map(Real::exact);
        (high - low) / RBig::from(2)
    }

    fn middle(&self, coordinate: usize) -> RBig {
        let [low, high] = self.cell[coordinate].map(Real::exact);
        (high + low) / RBig::from(2)
    }

    /// Bounds the heights of some vertices of A or B from below and from above, in units of 2^-2P.
    fn heights<I: Int>(&self, scene: &Scene, stage: &Stage<I>, side: usize) -> Option<[I; 2]> {
        if let Some(floor) = self.floor.as_ref().filter(|floor| floor.side == side) {
            let height = floor.height::<I>(&stage.unit)?;
            return Some([height.clone(), height]);
        }
        let body = [self.pair.0, self.pair.1][side];
        let value = |k: usize| scene.joints[k].at(|c| self.middle(c));
        let hops = stage.hops(scene, self.link, body, value)?;
        let solid = &stage.solids[body];
        let rest = self.rest(scene, solid, &hops)?;
        let mut rows = vec![(usize::MAX, fixed3(&self.normal)?, Taylor::whole(0)?)];
        for hop in hops.iter().rev() {
            for (_, m, o) in &mut rows {
                (*m, *o) = hop.step.get().plane(m, o, &at_once())?;
            }
            let Some((joint, axis)) = &hop.joint else { continue };
            let (joint, zero) = (&scene.joints[*joint], Taylor::whole(0)?);
            let factor = Taylor::fixed(joint.factor())?;
            let none = [zero.clone(), zero.clone(), zero.clone()];
            let (m, o) = match joint.kind {
                Kind::Turn => (cross(&rows[0].1, axis)?, zero),
                _ => (none, dot(&rows[0].1, axis)?),
            };
            rows.push((joint.coordinate(), each(|k| m[k].times(&factor))?, o.times(&factor)?));
        }
        let mut slopes: BTreeMap<usize, (Vector<I>, Taylor<I>)> = BTreeMap::new();
        for (coordinate, m, o) in rows.drain(1..) {
            let sum = match slopes.remove(&coordinate) {
                Some((n, p)) => (each(|k| m[k].plus(&n[k]))?, o.plus(&p)?),
                None => (m, o),
            };
            slopes.insert(coordinate, sum);
        }
        let (_, m, o) = &rows[0];
        let off = solid.off(m, o)?.add(&rest.up()?)?;
        let mut bends = Vec::new();
        for (coordinate, (m, o)) in &slopes {
            bends.push((m, o, solid.off(m, o)?, above::<I>(&self.half(*coordinate))?));
        }
        let mut ends: Option<[I; 2]> = None;
        let mut take = |p: &[I; 3], ellipsoid: Option<&FixedEllipsoid<I>>| {
            // A point of the ellipsoid departs from the centre by half its height.
            let wider = |m| ellipsoid.map_or(Some(I::small(0)), |ellipsoid| ellipsoid.half_height(m));
            let mut slack = off.add(&wider(m)?)?;
            for (m, o, off, half) in &bends {
                let slope = height(p, m, o)?.size()?.add(off)?.add(&wider(m)?)?;
                slack = slack.add(&half.mul(&slope.down().add(&I::small(1))?)?)?;
            }
            let height = height(p, m, o)?;
            let [low, high] = [height.sub(&slack)?, height.add(&slack)?];
            ends = Some(match ends.take() {
                Some([least, most]) => [least.min(low), most.max(high)],
                None => [low, high],
            });
            Some(())
        };
        for p in &*chosen(&solid.points, self.some[side].as_deref()) {
            take(p, None)?;
        }
        for ellipsoid in solid.ellipsoids_of(self.some[side].as_deref()) {
            take(&solid.points[ellipsoid.centre], Some(ellipsoid))?;
        }
        ends
    }
}

impl Claim for InCell {
    fn holds<I: Int>(&self, scene: &Scene, stage: &Stage<I>) -> Option<bool> {
        let [_, high] = self.heights(scene, stage, 0)?;
        let [low, _] = self.heights(scene, stage, 1)?;
        Some(beyond(&low.sub(&high)?, 1, &self.kept, &self.normal, &stage.unit))
    }
}
