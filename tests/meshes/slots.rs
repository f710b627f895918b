//! Pins in slots: depths where edges cross and no vertex is inside, of U, blocks and doors, beside a closed form.

use super::mesh;
use lin_canny::PairTracker;
use truth::driven::slots::{Mix, play, union_of};
use truth::soups::Soup;

/// A U whose lower arm ends at y = `depth`, and a pin in its gap from y = 0 to 2.
fn pin_in_u(depth: f64) -> [Soup; 2] {
    let u = [
        [[-4.0, -3.0, -4.0], [5.0, depth, 4.0]],
        [[-4.0, 2.5, -4.0], [5.0, 6.0, 4.0]],
        [[5.0, -3.0, -4.0], [8.0, depth, 4.0]],
        [[5.0, depth, -4.0], [8.0, 2.5, 4.0]],
        [[5.0, 2.5, -4.0], [8.0, 6.0, 4.0]],
    ];
    let pin = [[[-1.0, 0.0, -6.0], [1.0, 2.0, 6.0]]];
    [union_of(&u, 1), union_of(&pin, 1)]
}

#[test]
fn a_pin_in_a_slot_has_its_depth() {
    for depth in [0.1, 1e-3, 1e-6] {
        let [u, pin] = pin_in_u(depth).map(|s| mesh(&s));
        let at = super::relative(&truth::Pose::IDENTITY);
        for (a, b) in [(&u, &pin), (&pin, &u)] {
            let found = PairTracker::new().penetration(a, b, &at).unwrap();
            assert!(
                // Twice 1e-13 of the size of the pair, and 1e-6 of the depth.
                found.lower > depth * 0.999_999 - 4e-12 && found.lower <= depth + 1e-12,
                "{depth} {found:?}"
            );
            assert!(found.upper >= depth && found.upper < depth + 1e-9, "{depth} {found:?}");
        }
    }
}

fn play_all(count: u64) -> Mix {
    let mut mix = Mix::default();
    let mut wrong = Vec::new();
    for seed in 0..count {
        match play(0x5107_0000 + seed) {
            Ok(one) => mix.add(&one),
            Err(why) => wrong.push(format!("seed {seed}: {why}")),
        }
    }
    assert!(wrong.is_empty(), "{} of {count}:\n{}", wrong.len(), wrong.join("\n"));
    println!("{mix:?}");
    let parts = [
        mix.joined,
        mix.blocks,
        mix.doors,
        mix.meshes,
        mix.pieces,
        mix.bare,
        mix.shallow,
        mix.fine,
        mix.exchanged,
    ];
    assert!(mix.pins == count && parts.iter().all(|n| *n * 20 > count), "{mix:?}");
    mix
}

#[test]
fn pins_in_slots_have_their_depth() {
    play_all(100);
}

#[test]
#[ignore = "10,000 pins, minutes: cargo test --release --test meshes pins_in_ten -- --ignored --nocapture"]
fn pins_in_ten_thousand_slots_have_their_depth() {
    play_all(10_000);
}
