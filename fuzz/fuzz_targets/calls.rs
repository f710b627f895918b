//! Arbitrary bytes are a sequence of calls of the broad phase: the entry of the test `broad`.
#![no_main]

use truth::driven::calls;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    calls::drive(data);
});
