//! The promises, in one precision.

use super::engine;

mod bodies;
mod effects;
mod falls;
mod ordinary;
mod piles;
mod small;
#[path = "../../benches/race/ordinary.rs"]
mod stage;
mod terrain;
