//! Promise: solids with faces in common have the class of exact arithmetic wherever their origin lies.

use lab::driven::solids::{Mix, play};

fn played(seeds: u64) -> Mix {
    let (mut mix, mut failed) = (Mix::default(), Vec::new());
    for seed in 0..seeds {
        match play(seed) {
            Ok(played) => mix.add(&played),
            Err(what) => failed.push(format!("seed {seed}: {what}")),
        }
    }
    let count = failed.len();
    failed.truncate(3);
    assert!(failed.is_empty(), "{count} of {seeds}: {failed:#?}");
    println!("{mix:?}");
    mix
}

#[test]
fn solids_with_faces_in_common_have_the_class_of_whole_numbers() {
    played(1000);
}
