//! A lower bound of the distance of two bodies at rest, by planes between groups of their parts.
//!
//! **Lemma 7.** The cells of lemma 11, without time: they start with all parts of both bodies, each
//! entry of the list first cuts the cell at hand as often as it says, then proves it. If along n all
//! points of the parts of A in a cell lie below all of those of B by g > 0, each part of A is at least
//! g / |n| from each part of B in it. If no cell waits at the end, this was shown of each part of A and
//! each part of B, so the bodies are at least the least of these apart; of a solid, its surface is. If
//! one cell is all parts, the hulls are apart, so no body is inside the other.

use dashu_ratio::RBig;

use crate::Stop;
use crate::claim::{Moment, all_parts, radii};
use crate::cover::Parts;
use crate::cuts::cut;
use crate::json::Json;
use crate::pose::Placed;
use crate::real::{Exact, Real, at_most, dot};
use crate::scene::Scene;

/// Checks that some points of A, or all, are below some of B along n, by `lower` and more than 0.
pub(crate) fn below(
    placed: &[Placed; 2],
    some: [Option<Vec<usize>>; 2],
    n: &Exact,
    lower: &RBig,
) -> Result<(), &'static str> {
    let [[_, high], [low, _]] = [0, 1].map(|k| placed[k].heights(some[k].as_deref(), n));
    let gap = low - high;
    if gap <= RBig::ZERO {
        return Err("no gap along the normal");
    }
    // lower |n| <= gap
    match at_most(&-gap, &-lower, &dot(n, n)) {
        true => Ok(()),
        false => Err("the lower bound is not proven"),
    }
}

/// Checks the list of `[cuts, normal]`; returns whether the hulls are apart.
pub(crate) fn check(
    scene: &Scene,
    moment: &Moment,
    placed: &[Placed; 2],
    list: &Json,
    lower: &RBig,
) -> Result<bool, Stop> {
    let name = || scene.names(moment.pair);
    let bodies = [moment.pair.0, moment.pair.1].map(|k| &scene.bodies[k]);
    let mut waiting: Vec<Parts> = vec![all_parts(scene, moment.pair)];
    let list = list.array()?;
    for entry in list {
        let [cuts, normal] = entry.list::<2>()?;
        cut(&mut waiting, cuts.array()?, name)?;
        let Some(parts) = waiting.pop() else {
            return Stop::fails(format!("{}: a group after the last one", name()));
        };
        let n = normal.reals::<3>()?.map(Real::exact);
        let some = [0, 1].map(|k| bodies[k].of_parts(parts[k]));
        let lower = lower + radii(scene, moment.pair, parts);
        if let Err(why) = below(placed, some, &n, &lower) {
            return Stop::fails(format!("{}: {why} of parts {parts:?}", name()));
        }
    }
    match waiting.len() {
        0 => Ok(list.len() == 1),
        left => Stop::fails(format!("{}: {left} groups without a plane", name())),
    }
}
