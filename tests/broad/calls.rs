//! Promise: the broad phase accepts or rejects any sequence of calls without a panic, and its pairs
//! are those of brute force.

use proptest::prelude::*;
use truth::driven::calls::{self, drive};
use truth::rng::Rng;
use truth::tally::Tally;

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
    #[test]
    fn any_calls(bytes in prop::collection::vec(any::<u8>(), 1..2500)) {
        drive(&bytes);
    }
}

/// A reduced finding of the fuzz target: a body moved from one end of the range to the other within
/// one column.
const FOUND: [&[u8]; 1] = [&[
    1, 1, 38, 251, 48, 1, 6, 0, 128, 128, 128, 128, 1, 0, 11, 0, 32, 0, 0, 128, 128, 128, 128, 128, 251, 254, 255, 255,
    250, 38, 251, 38, 251, 38, 251, 255, 48, 29, 255, 255, 48, 251, 38, 251, 251, 38, 59, 59, 219, 38, 251, 48, 1, 0,
    38, 0, 0, 0, 16, 38, 219, 38, 251, 59, 48, 255, 255,
]];

#[test]
fn what_was_found_stays_mended() {
    for bytes in FOUND {
        assert!(drive(bytes).steps > 1);
    }
}

/// The bytes of a generator reach every case: calls are accepted and rejected, pairs start and end.
#[test]
fn the_mix_of_calls() {
    let mut rng = Rng::new(62);
    let mut sum = calls::Tally::default();
    for _ in 0..200 {
        let bytes: Vec<u8> = (0..2500).map(|_| rng.bits() as u8).collect();
        sum.add(&drive(&bytes));
    }
    assert!(sum.calls[0] > 5000 && sum.calls[1] > 2000, "{sum:?}");
    assert!(sum.steps > 2000 && sum.events > 2000 && sum.pairs > 20_000, "{sum:?}");
}
