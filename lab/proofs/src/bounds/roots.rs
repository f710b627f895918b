//! Roots of sums of squares, rounded up or down.

use super::Bound;
use crate::factor::{Factor, Positive};
use crate::majorant::{rounding, unit};
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    let whole = Bound::whole;
    let up = |root: Factor| loses(&root) + rounding(53);
    let down = |root: Factor| exceeds(&root) + rounding(53);
    vec![
        whole("ROUND_UP", "roots", up(length(Factor::input))),
        whole("RADIUS_UP", "scene::ball::about_origin", up(scaled_length())),
        // The distance of the centre, the sum with the radius, and the product.
        whole(
            "RADIUS_UP",
            "scene::body::Solid::reach",
            up(length(Factor::input) + Factor::input()),
        )
        .case("reach of a solid"),
        whole(
            "BOX_DISTANCE_DOWN",
            "broad::aabb::distance_squared",
            down(length(Factor::difference)),
        ),
        // The guard against underflow, and the difference after it.
        whole(
            "ROUND_DOWN",
            "scene::ball::least_distance",
            down(length(Factor::difference)) + unit() * half() + rounding(53),
        ),
    ]
}

fn half() -> RBig {
    RBig::from_parts(1.into(), 2u8.into())
}

/// By how much a number may be too low, so that it has to be raised.
fn loses(root: &Factor) -> RBig {
    let one = RBig::ONE;
    (&one - &root.low) / &root.low
}

/// By how much a number may be too high.
fn exceeds(root: &Factor) -> RBig {
    (&root.high - RBig::ONE) / &root.high
}

/// The root of the sum of three squares.
fn length(coordinate: impl Fn() -> Factor) -> Factor {
    let square = || coordinate().squared();
    (square() + square() + square()).root()
}

/// Coordinates over a size, and the root times the size.
fn scaled_length() -> Factor {
    length(|| Factor::input() / Factor::input()) * Factor::input()
}
