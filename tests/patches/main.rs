//! Promise: intervals of curved surfaces contain the true distance and are as narrow as requested.

mod bodies;
mod casts;
mod compounds;
mod forms;
mod hard;
mod random;
mod same;
mod shapes;
mod shared;
mod truth;
