//! Arbitrary bytes are curves of joints, or are refused: the entry of the test `driven`.
#![no_main]

use truth::driven::curves;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    curves::drive(data);
});
