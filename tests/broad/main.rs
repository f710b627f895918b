//! Promise: the broad phase finds the pairs that brute force finds, for any calls in any order.

mod calls;
mod frames;
mod lattice;
mod queries;
mod state;
mod steps;
