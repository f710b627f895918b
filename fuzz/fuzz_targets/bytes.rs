//! Arbitrary bytes are bodies, poses and queries, or are refused: the entry of the test `bytes`.
#![no_main]

#[path = "../../tests/support/bytes.rs"]
#[allow(dead_code)]
mod bytes;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    bytes::drive(data);
});
