//! Simulation on `rapier3d`, in `f32`.

pub use rapier3d as rapier;

#[path = "bridge/body_shape.rs"]
mod body_shape;
#[path = "bridge/simulation.rs"]
mod simulation;
#[path = "bridge/world.rs"]
mod world;

pub use body_shape::BodyShape;
use lin_canny_parry::single as engine;
pub use lin_canny_parry::single::{CertifiedDispatcher, ContactOptions, Hull, MeshShape};
pub use simulation::Simulation;
pub use world::certified_world;
