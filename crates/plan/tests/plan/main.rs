//! Promise: what the planner calls free is free at every instant, what it calls blocked is blocked, and paths are made of
//! segments proven free.

mod apart;
mod arcs;
mod arm;
mod balls;
mod certify;
mod changes;
mod curves;
mod far;
mod free;
mod hulls;
mod judge;
mod leave;
mod methods;
mod motions;
mod moving;
mod pair_boxes;
mod planner;
mod range_cases;
mod range_worlds;
mod ranges;
mod required;
mod reset;
mod robots;
mod smooth;
mod spaces;
mod wrapped;

use lin_canny_plan::{CertifyOptions, Checker, ConfigurationSpace, JointMotion, PairProof, PlanError};

/// The numbers of the robots that an ignored test judges: all, or a part as
/// `LIN_CANNY_ROBOTS=100..200`.
pub(crate) fn chosen_robots(all: core::ops::Range<u64>) -> core::ops::Range<u64> {
    std::env::var("LIN_CANNY_ROBOTS").map_or(all, |text| {
        let (from, to) = text.split_once("..").expect("LIN_CANNY_ROBOTS is a range");
        from.parse().expect("the first robot")..to.parse().expect("the last robot")
    })
}

/// Returns the certificates of a motion of one piece; `None` if it is not proven free.
pub(crate) fn prove<C: ConfigurationSpace>(
    checker: &mut Checker<C>,
    motion: &JointMotion,
) -> Result<Option<Vec<PairProof>>, PlanError> {
    let mut found = checker.certify_with(motion, CertifyOptions::default().certificates(true))?;
    Ok(found.verdict.is_free().then(|| found.proofs.swap_remove(0)))
}
