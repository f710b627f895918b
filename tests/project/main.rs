//! Promise: the source, the README and the lock files are consistent.

mod layering;
mod links;
mod locks;
mod readme;
