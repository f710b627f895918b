//! Pairs over time: how long a pair stays separated, times of impact, and when a pair is due.

pub mod impact;
pub mod schedule;
pub mod separation;
