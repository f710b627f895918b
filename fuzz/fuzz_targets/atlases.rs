//! Arbitrary bytes are a stored atlas of boxes, or are refused.
#![no_main]

use truth::driven::atlases;
use truth::driven::readers::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    atlases::drive(data);
});
