//! Promise: intervals of curved surfaces hold the truth and are as narrow as asked.

mod bodies;
mod casts;
mod forms;
mod hard;
mod random;
mod same;
mod shapes;
mod truth;
#[path = "../curved/wide.rs"]
#[expect(dead_code, reason = "shared with the tests of curved shapes")]
mod wide;
