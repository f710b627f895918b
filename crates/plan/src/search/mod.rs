//! The search for a path, and what makes a path shorter, wider or smooth.

mod ascent;
pub(crate) mod freeway;
mod opportunistic;
pub(crate) mod options;
pub(crate) mod plan;
pub(crate) mod roadmap;
mod rrt_connect;
pub(crate) mod shorten;
pub(crate) mod smooth;
mod speeds;
