//! Promise: what the planner calls free is free at every instant, what it calls blocked is blocked, and paths are made of
//! segments proven free.

mod apart;
mod arcs;
mod arm;
mod certify;
mod changes;
mod curves;
mod far;
mod forget;
mod free;
mod hulls;
mod judge;
mod leave;
mod methods;
mod moving;
mod pair_boxes;
mod planner;
mod range_cases;
mod range_worlds;
mod ranges;
mod smooth;
mod spaces;

/// The numbers of the robots that an ignored test judges: all, or a part as
/// `LIN_CANNY_ROBOTS=100..200`.
pub(crate) fn chosen_robots(all: core::ops::Range<u64>) -> core::ops::Range<u64> {
    std::env::var("LIN_CANNY_ROBOTS").map_or(all, |text| {
        let (from, to) = text.split_once("..").expect("LIN_CANNY_ROBOTS is a range");
        from.parse().expect("the first robot")..to.parse().expect("the last robot")
    })
}
