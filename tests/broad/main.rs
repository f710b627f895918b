//! Promise: the broad phase finds the pairs that brute force finds, by either structure, whatever is called in whatever order.

mod calls;
mod frames;
mod lattice;
mod queries;
mod state;
mod steps;
