//! Arbitrary bytes are a recording, a replay or saved JSON, or are refused: the entry of the test
//! `readers`.
#![no_main]

use truth::driven::readers::{self, PeakAlloc};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    readers::stored(data);
});
