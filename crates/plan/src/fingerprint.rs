//! A hash by which an answer recognises the bodies and joints that it is about.
//!
//! The hash is FNV-1a over words of 64 bits (Fowler, Noll and Vo). It finds changes of a robot or a
//! cell between two runs, not forged files.

use core::fmt::{self, Write};

/// Offset and prime of FNV-1a with 64 bits.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// A hash to which words and texts are added.
pub(crate) struct Fingerprint(pub(crate) u64);

impl Fingerprint {
    pub(crate) fn new() -> Self {
        Self(OFFSET)
    }

    pub(crate) fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    }

    pub(crate) fn number(&mut self, x: f64) {
        self.word(x.to_bits());
    }
}

impl Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().for_each(|byte| self.word(byte.into()));
        Ok(())
    }
}
