//! The checker: pairs with trackers, swept boxes, and verdicts about configurations and motions.

pub(crate) mod apart;
pub(crate) mod batch;
pub(crate) mod body_boxes;
pub(crate) mod certify;
mod changes;
pub(crate) mod checker;
pub(crate) mod clearance;
mod free;
mod hulls;
pub(crate) mod pairs;
pub(crate) mod swept_boxes;
mod tube;
pub(crate) mod verdict;
