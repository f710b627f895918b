//! Simulation on `rapier3d_f64`, in `f64`.

pub use rapier3d_f64 as rapier;

#[path = "bridge/body_shape.rs"]
mod body_shape;
#[path = "bridge/simulation.rs"]
mod simulation;
#[path = "bridge/world.rs"]
mod world;

pub use body_shape::BodyShape;
use lin_canny_parry::double as engine;
pub use lin_canny_parry::double::{CertifiedDispatcher, ContactOptions, Hull, MeshShape};
pub use simulation::Simulation;
pub use world::certified_world;
