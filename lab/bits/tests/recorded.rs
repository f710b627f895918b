//! Promise: answers have the bits of the recorded output.

use bits::{KINDS, line, sum};
use std::collections::BTreeSet;

/// The scale of the recorded output that this test compares, in percent.
const SCALE: u64 = 10;

/// Answers that change on purpose are recorded by the command of the message.
#[test]
fn answers_have_the_recorded_bits() {
    let recorded = include_str!("../recorded-10.txt");
    let mut lines = recorded.lines();
    let heading = lines.next().unwrap_or_default();
    assert!(heading.ends_with(&format!("scale {SCALE} %")), "{heading:?}");
    let recorded: BTreeSet<&str> = lines.collect();
    let now: BTreeSet<String> = KINDS
        .iter()
        .map(|&(name, seed, kind)| line(name, sum(seed, kind, SCALE).1))
        .collect();
    let name = |line: &str| line.split(' ').next().unwrap_or_default().to_owned();
    let changed = now.iter().filter(|line| !recorded.contains(&line[..]));
    let changed: Vec<_> = changed.map(|line| name(line)).collect();
    let lost = recorded.iter().filter(|line| !now.contains(**line));
    let lost: Vec<_> = lost.map(|line| name(line)).filter(|n| !changed.contains(n)).collect();
    assert!(
        changed.is_empty() && lost.is_empty(),
        "the bits of the answers to {changed:?} have changed, kinds lost: {lost:?}; \
         if the change is wanted, name it in CHANGELOG.md and run `.ci/bits record`"
    );
}

#[test]
fn kinds_have_names_and_seeds_of_their_own() {
    let names: BTreeSet<_> = KINDS.iter().map(|kind| kind.0).collect();
    let seeds: BTreeSet<_> = KINDS.iter().map(|kind| kind.1).collect();
    assert_eq!([names.len(), seeds.len()], [KINDS.len(); 2]);
}
