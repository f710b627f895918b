//! Promise: a changed receipt is refused, unless what it says is still true. A renewed hash changes
//! nothing.

mod support;

use std::collections::BTreeMap;

use lin_canny_verify::{Verdict, verify};
use support::changes::{CHANGES, change, make, time_of};
use support::*;

fn accepted(text: &str) -> bool {
    matches!(verify(text.as_bytes()), Ok(Verdict::Holds(_)))
}

#[test]
fn no_change_makes_a_receipt_say_what_is_false() {
    let mut rng = Rng(11);
    let mut counts: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for k in 0..150 {
        let receipt = make(&mut rng, k);
        let old = receipt.text();
        assert!(accepted(&old), "{old}");
        let tail = old.lines().next_back().unwrap().to_owned();
        for kind in CHANGES {
            let mut changed = receipt.clone();
            if !change(kind, &mut changed, &mut rng) {
                continue;
            }
            let text = changed.text();
            if text == old {
                continue;
            }
            // With the old hash nothing is accepted.
            let lines: Vec<_> = text.lines().collect();
            let unsealed = lines[..lines.len() - 1].join("\n") + "\n" + &tail + "\n";
            assert!(!accepted(&unsealed), "{kind}: {unsealed}");
            let count = counts.entry(kind).or_default();
            count[0] += 1;
            if accepted(&text) {
                count[1] += 1;
                assert!(!changed.is_false(), "{kind}: accepted, and false:\n{text}");
            }
        }
    }
    for (kind, [changed, accepted]) in &counts {
        println!("{kind}: {changed} changed, {accepted} still true");
    }
    // What can only make a proof shorter is always refused.
    for kind in [
        "the end one unit earlier",
        "the start one unit later",
        "an interval halved",
        "a pair unsaid",
    ] {
        assert_eq!(counts[kind][1], 0, "{kind}");
    }
    assert_eq!(counts.len(), CHANGES.len());
}

#[test]
fn any_changed_byte_is_refused() {
    let mut rng = Rng(12);
    for k in 0..14 {
        let text = make(&mut rng, k).text();
        for _ in 0..40 {
            let mut bytes = text.clone().into_bytes();
            let at = rng.below(bytes.len());
            bytes[at] ^= 1 << rng.below(8);
            assert!(
                !matches!(verify(&bytes[..]), Ok(Verdict::Holds(_))),
                "byte {at} of {text}"
            );
            // A file that ends early.
            assert!(verify(&text.as_bytes()[..at]).is_err(), "{at}");
        }
    }
}

/// What a wrong bound in a kernel would look like: a plane that claims to hold for too long.
#[test]
fn a_plane_stretched_until_its_claim_is_false_is_refused() {
    let mut rng = Rng(13);
    let mut refused = 0;
    for _ in 0..20 {
        // The bodies share a point at t = 1, as the last line proves.
        let mut receipt = hit(&mut rng);
        assert!(accepted(&receipt.text()));
        let Some([_, until, _]) = &mut receipt.apart else {
            unreachable!()
        };
        *until = 1.0;
        let last = receipt.evidence.len() - 2;
        time_of(&mut receipt.evidence[last]).unwrap()[1] = 1.0;
        refused += usize::from(!accepted(&receipt.text()));
    }
    assert_eq!(refused, 20);
}

/// The polynomial of a long turn leaves the arc. What departs from it counts.
#[test]
fn a_plane_that_only_the_polynomial_respects_is_refused() {
    for angle in [2.0f64, 3.0, 4.0] {
        let tip = cuboid([0.1; 3]).iter().map(|p| add(*p, [1.0, 0.0, 0.0])).collect();
        let wall = Move::Rest([angle.cos(), angle.sin(), 0.0, 0.0, 0.0, 0.0, 1.0]);
        let bodies = vec![body(tip, Move::Link(1, None)), body(cuboid([0.125; 3]), wall)];
        let mut receipt = Receipt::new(Some([0.0, 1.0, 0.0]), bodies);
        let (axis, drive) = ([0.0, 0.0, 1.0], (0, 1.0, 0.0));
        receipt.joints = vec![Joint::new(0, "turn", REST, axis, drive)];
        for k in 0..72 {
            receipt.bodies.swap(0, 1);
            let (x, y) = ((f64::from(k / 2) * 0.175).cos(), (f64::from(k / 2) * 0.175).sin());
            receipt.evidence = vec![
                Line::Leg(vec![vec![0.0], vec![angle]]),
                Line::plane([0, 1], [x, y, 0.0], [0.0, 1.0], 0.0),
            ];
            assert!(!accepted(&receipt.text()), "{angle} {k}");
        }
    }
}

/// Four pairs of vertices never prove a common point of bodies that are apart.
#[test]
fn bodies_that_are_apart_share_no_point() {
    let mut rng = Rng(14);
    for k in 0..400 {
        let mut receipt = hit(&mut rng);
        let last = receipt.evidence.len() - 1;
        let Line::Meet { at, points, .. } = &mut receipt.evidence[last] else {
            unreachable!()
        };
        *at = Some(rng.range(0.0, 0.25));
        if k % 2 == 0 {
            *points = std::array::from_fn(|_| [rng.below(8), rng.below(8)]);
        }
        assert!(!accepted(&receipt.text()));
    }
}
