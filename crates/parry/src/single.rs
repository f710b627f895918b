//! Shape and dispatcher for `parry3d`, in `f32`.

pub use parry3d as parry;

#[path = "bridge/mod.rs"]
mod bridge;

pub use bridge::*;
