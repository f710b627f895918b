//! Sequences of calls, drawn from bytes or seeds and judged by brute force, for tests, `soak` and
//! `fuzz/`.

pub mod bytes;
pub mod calls;
pub mod clouds;
pub mod copies;
pub mod corners;
pub mod curves;
pub mod distances;
pub mod exact_place;
pub mod far;
pub mod lattice;
pub mod overlaps;
pub mod planner;
pub mod points;
pub mod rays;
#[cfg(feature = "readers")]
pub mod readers;
pub mod repairs;
pub mod scenes;
pub mod slivers;
pub mod slots;
pub mod solids;
pub mod surfaces;
pub mod throws;
pub mod turned_boxes;
pub mod underflow;

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::tally::Tally;

/// Wrong answers that a failed test shows.
const SHOWN: usize = 8;

/// The input of a byte-driven test: bytes are read from the front; after the end they are zero.
#[derive(Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    /// Returns the next byte.
    pub fn byte(&mut self) -> u8 {
        let first = self.0.first().copied().unwrap_or(0);
        self.0 = self.0.get(1..).unwrap_or(&[]);
        first
    }
}

/// Plays the sequences of many seeds, and returns their counts.
///
/// # Panics
/// Panics with the seeds of the first wrong answers. A panic of a sequence is a wrong answer.
pub fn played<M: Tally + Default>(seeds: impl IntoIterator<Item = u64>, play: impl Fn(u64) -> Result<M, String>) -> M {
    let (mut sum, mut wrong, mut count) = (M::default(), Vec::new(), 0);
    for seed in seeds {
        count += 1;
        let one = catch_unwind(AssertUnwindSafe(|| play(seed))).unwrap_or_else(|_| Err("a panic".to_owned()));
        match one {
            Ok(one) => sum.add(&one),
            Err(why) => wrong.push(format!("seed {seed}: {why}")),
        }
    }
    let shown = &wrong[..wrong.len().min(SHOWN)];
    assert!(
        wrong.is_empty(),
        "{} of {count} sequences:\n{}",
        wrong.len(),
        shown.join("\n")
    );
    sum
}
