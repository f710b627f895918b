//! The promises on `lin_canny_rapier::double`.

use lin_canny_rapier::double as engine;

#[path = "bodies.rs"]
mod bodies;
#[path = "effects.rs"]
mod effects;
#[path = "piles.rs"]
mod piles;
#[path = "terrain.rs"]
mod terrain;
