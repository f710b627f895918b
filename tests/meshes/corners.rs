//! Contacts in inner corners, slots and steps, against the exact depth of unions of boxes.

use std::cell::Cell;
use truth::driven::corners::{Mix, OVERLAPS, play};
use truth::driven::played;

/// Plays from a seed on until so many overlaps are judged.
fn play_all(first: u64, overlaps: u64) -> Mix {
    let judged = Cell::new(0);
    let seeds = (0xC0_0000_0000 + first..).take_while(|_| judged.get() < overlaps);
    let mix = played(seeds, |seed| {
        let one = play(seed);
        judged.set(judged.get() + one.as_ref().map_or(OVERLAPS.len() as u64, |mix: &Mix| mix.overlaps));
        one
    });
    println!("{mix:?}");
    let parts = [mix.inner, mix.meshes, mix.inward, mix.compounds, mix.voxels, mix.convex];
    assert!(parts.iter().all(|n| *n * 200 > overlaps), "{mix:?}");
    mix
}

/// Bodies whose deepest point along a face is outside the other body, past another side of it: the
/// contact there was as deep as a whole box. The last two had such contacts within rounding of a piece,
/// and beside a shallow contact of the same patches.
#[test]
fn bodies_that_pass_a_face_sideways_have_no_contact_with_it() {
    let seeds = [
        6_431,
        8_627,
        11_520,
        12_556,
        14_012,
        14_087,
        14_602,
        14_967,
        15_972,
        19_344,
        4_294_967_815,
        4_294_968_690,
        4_294_969_119,
        4_294_970_536,
        4_294_972_463,
        4_294_977_004,
        4_294_977_022,
        4_294_977_753,
        4_294_978_653,
        4_294_981_442,
        4_294_981_492,
        4_294_983_871,
        4_294_990_428,
        4_294_999_550,
        4_295_046_375,
        4_295_141_224,
        4_295_152_752,
    ];
    played(seeds.map(|seed| 0xC0_0000_0000 + seed), play);
}

#[test]
fn bodies_pressed_into_inner_corners_have_no_deeper_contact() {
    play_all(0, 10_000);
}

#[test]
#[ignore = "1,000,000 overlaps, minutes: cargo test --release --all-features --test meshes a_million_bodies_pressed -- --ignored --nocapture"]
fn a_million_bodies_pressed_into_inner_corners_have_no_deeper_contact() {
    play_all(1 << 32, 1_000_000);
}
