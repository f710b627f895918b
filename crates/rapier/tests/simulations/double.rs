//! The promises on `lin_canny_rapier::double`.

use lin_canny_rapier::double as engine;

#[path = "bodies.rs"]
mod bodies;
#[path = "effects.rs"]
mod effects;
#[path = "falls.rs"]
mod falls;
#[path = "ordinary.rs"]
mod ordinary;
#[path = "piles.rs"]
mod piles;
#[path = "small.rs"]
mod small;
#[path = "../../benches/race/ordinary.rs"]
mod stage;
#[path = "terrain.rs"]
mod terrain;
