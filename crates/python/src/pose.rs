//! Poses from Python: arrays of shape (4, 4) or (7,), (position, quaternion xyzw), objects that
//! have such a form, `None` for the identity.

mod argument;
mod rigid;

pub(crate) use argument::{Pose, relative};
pub(crate) use batch::Poses;
pub(crate) use rigid::PoseView;

mod batch;
