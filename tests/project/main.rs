//! Promise: the source, the README and the lock files are what they say they are.

mod errors;
mod layering;
mod links;
mod locks;
mod readme;
