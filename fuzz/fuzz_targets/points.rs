//! Arbitrary bytes are a point file, or are refused: the entry of the test `readers`.
#![no_main]

use truth::driven::readers::{self, PeakAlloc};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    readers::points(data);
});
