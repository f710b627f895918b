//! Sequences of calls, drawn from bytes or seeds and judged by brute force, for tests, `soak` and
//! `fuzz/`.

pub mod bytes;
pub mod calls;
pub mod clouds;
pub mod corners;
pub mod curves;
pub mod distances;
pub mod exact_place;
pub mod far;
pub mod lattice;
pub mod planner;
pub mod points;
pub mod rays;
#[cfg(feature = "readers")]
pub mod readers;
pub mod scenes;
pub mod slivers;
pub mod slots;
pub mod solids;
pub mod stand_ins;
pub mod surfaces;
pub mod throws;
pub mod turned_boxes;
pub mod underflow;

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
