//! Arbitrary bytes are two closed meshes of lattice points, whose shared volume is judged over the rationals.
#![no_main]

use truth::driven::overlaps;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Err(why) = overlaps::play_bytes(data) {
        panic!("{why}");
    }
});
