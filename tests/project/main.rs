//! Promise: the source and the README are what they say they are.

mod layering;
mod readme;
