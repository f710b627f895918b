//! Promise: users see of each command of the tool what is recorded. `TRYCMD=overwrite` records it again.
//!
//! A transcript is a file of commands that run one after the other in a copy of
//! `transcripts/files`. What they write is printed by `cat`, or, if it is large, as the sum and the
//! size that `cksum` prints; of pages only the last line, because their script has its own tests.

use std::path::Path;

#[test]
fn transcripts_are_as_recorded() {
    let cases = trycmd::TestCases::new();
    cases.register_bin("lin-canny", Path::new(env!("CARGO_BIN_EXE_lin-canny")));
    for name in ["cat", "cksum", "head", "tail"] {
        cases.register_bin(name, Path::new("/usr/bin").join(name).as_path());
    }
    cases.case("tests/transcripts/*.trycmd");
}
