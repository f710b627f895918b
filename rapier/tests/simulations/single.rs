//! The promises on `lin_canny_rapier::single`.

use lin_canny_rapier::single as engine;

#[path = "bodies.rs"]
mod bodies;
#[path = "effects.rs"]
mod effects;
#[path = "piles.rs"]
mod piles;
#[path = "terrain.rs"]
mod terrain;
