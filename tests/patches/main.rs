//! Promise: intervals of curved surfaces hold the truth and are as narrow as asked.

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
