//! Arbitrary bytes are a sequence of calls of the broad phase: the entry of the test `broad_calls`.
#![no_main]

#[path = "../../tests/support/calls.rs"]
#[allow(dead_code)]
mod calls;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    calls::drive(data);
});
