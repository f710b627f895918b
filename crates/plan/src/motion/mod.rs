//! Motions: configuration spaces, curves of coordinates, and poses at times.

pub(crate) mod carried;
pub(crate) mod curve;
pub(crate) mod joint;
pub(crate) mod joint_motion;
pub(crate) mod rigid;
pub(crate) mod space;
pub(crate) mod timed_poses;
pub(crate) mod tree;
pub(crate) mod tree_motion;
pub(crate) mod tube;
