//! Arbitrary bytes are bodies, poses and queries, or are refused: the entry of the test `files`.
#![no_main]

use truth::driven::bytes;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bytes::drive(data);
});
