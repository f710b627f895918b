//! The same queries on every target, and a hash of the answers to each kind of query.
//!
//! Answers of `lin-canny` have the same bits on every target with IEEE 754 arithmetic. The program
//! `bits` prints one line `kind hash` for each kind of query, and `.ci/bits` compares the output of
//! several targets with each other and with the recorded output.
//!
//! * Inputs come from SplitMix64, + - * / and square roots alone. So a difference of two outputs is
//!   a difference of answers.
//! * An answer is hashed as its `Debug` text: all fields, work counters included, and floats in the
//!   shortest text that reads back to the same bits. `-0.0` differs from `0.0`.
//! * Each kind has its own seed. A new kind does not change the hash of any other.

mod kinds;
mod make;

pub use kinds::KINDS;
use std::fmt::{Debug, Write};

/// Returns the version of `lin-canny`.
#[must_use]
pub fn version() -> &'static str {
    let manifest = include_str!("../../../Cargo.toml");
    let line = manifest.lines().find_map(|line| line.strip_prefix("version = "));
    line.map_or("", |version| version.trim_matches('"'))
}

/// Returns the first line of an output: the version and the scale in percent.
#[must_use]
pub fn heading(scale: u64) -> String {
    format!("lin-canny {}, scale {scale} %", version())
}

/// Returns the line of a kind: its name and its hash.
#[must_use]
pub fn line(kind: &str, hash: u64) -> String {
    format!("{kind} {hash:016x}")
}

/// The generator SplitMix64.
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    /// Returns the next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Returns a number below `n`.
    pub fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    /// Returns one of the choices.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// Returns a number between two others.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// FNV-1a over the bytes of a text.
fn fnv(mut hash: u64, text: &str) -> u64 {
    for byte in text.bytes() {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    hash
}

/// Is called with the number and the text of every answer.
pub type Trace<'a> = &'a mut dyn FnMut(u64, &str);

/// Takes the answers of a kind and hashes them.
pub struct Teller<'a> {
    scale: u64,
    text: String,
    count: u64,
    hash: u64,
    trace: Option<Trace<'a>>,
}

impl<'a> Teller<'a> {
    /// Returns a teller for a share of all answers, in percent.
    pub fn new(scale: u64, trace: Option<Trace<'a>>) -> Self {
        Self {
            scale,
            text: String::new(),
            count: 0,
            hash: 0xcbf2_9ce4_8422_2325,
            trace,
        }
    }

    /// Returns the number of rounds, at least one, from the number at full scale.
    #[must_use]
    pub fn rounds(&self, full: u64) -> u64 {
        (full * self.scale / 100).max(1)
    }

    /// Adds an answer.
    pub fn tell(&mut self, what: &str, value: impl Debug) {
        self.text.clear();
        write!(self.text, "{what} {value:?}").expect("text");
        self.hash = fnv(self.hash, &self.text);
        if let Some(trace) = &mut self.trace {
            trace(self.count, &self.text);
        }
        self.count += 1;
    }

    /// Returns the number of answers and their hash.
    #[must_use]
    pub fn sum(&self) -> (u64, u64) {
        (self.count, self.hash)
    }
}

/// Asks all queries of a kind.
pub type Kind = fn(&mut Teller<'_>, &mut Random);

/// Returns the number of answers of a kind and their hash.
#[must_use]
pub fn sum(seed: u64, kind: Kind, scale: u64) -> (u64, u64) {
    let mut teller = Teller::new(scale, None);
    kind(&mut teller, &mut Random(seed));
    teller.sum()
}
