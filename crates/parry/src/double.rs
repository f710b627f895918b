//! Shape and dispatcher for `parry3d_f64`, in `f64`.

pub use parry3d_f64 as parry;

#[path = "bridge/mod.rs"]
mod bridge;

pub use bridge::*;
