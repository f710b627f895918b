//! Every instrument starts and prints its usage.

use std::process::Command;

#[test]
fn every_instrument_says_how_it_is_used() {
    for (name, program) in [
        ("accuracy_cost", env!("CARGO_BIN_EXE_accuracy_cost")),
        ("corpus", env!("CARGO_BIN_EXE_corpus")),
        ("falling_pile", env!("CARGO_BIN_EXE_falling_pile")),
        ("figures", env!("CARGO_BIN_EXE_figures")),
        ("grade", env!("CARGO_BIN_EXE_grade")),
        ("race", env!("CARGO_BIN_EXE_race")),
        ("soak", env!("CARGO_BIN_EXE_soak")),
    ] {
        let told = Command::new(program).arg("-h").output().expect("a program");
        let text = String::from_utf8_lossy(&told.stdout);
        assert!(
            told.status.success() && text.contains(&format!("Usage: {name}")),
            "{name}: {} {text}",
            told.status
        );
    }
}
