//! Promise: on another scene each certificate is evaluated again, and the first that fails is
//! named.

mod support;

use lin_canny_verify::{Verdict, verify_on};
use support::*;

/// The scene of a receipt, with its legs and without other evidence.
fn scene(receipt: &Receipt) -> String {
    let mut scene = receipt.clone();
    scene.apart = None;
    scene.evidence.retain(|x| matches!(x, Line::Leg(_)));
    let mut lines = scene.lines();
    lines[0] = lines[0].replace("lines", "scene");
    sealed(&lines)
}

fn moved(receipt: &Receipt, body: usize, by: V) -> Receipt {
    let mut other = receipt.clone();
    let Move::Rest(pose) = &mut other.bodies[body].motion else {
        unreachable!()
    };
    (0..3).for_each(|k| pose[k] += by[k]);
    other
}

fn on(receipt: &Receipt, other: &Receipt) -> Verdict {
    verify_on(receipt.text().as_bytes(), scene(other).as_bytes()).unwrap()
}

#[test]
fn an_obstacle_that_moved() {
    let mut rng = Rng(21);
    let (mut held, mut stale) = (0, 0);
    for k in 0..60 {
        let receipt = arm(&mut rng, 0.0, 1 + k % 2, 1);
        assert!(on(&receipt, &receipt).holds());
        // By a little, or towards the arm.
        let Move::Rest(pose) = receipt.bodies[4 + k % 2].motion else {
            unreachable!()
        };
        let by = add(
            rng.vector(0.01),
            scale([-pose[0], -pose[1], -pose[2]], [0.0, 0.5, 0.9][k % 3]),
        );
        let other = moved(&receipt, 4 + k % 2, by);
        match on(&receipt, &other) {
            Verdict::Holds(_) => {
                held += 1;
                assert!(!other.is_false());
            }
            Verdict::Fails(failure) => {
                stale += 1;
                let text = failure.to_string();
                assert!(failure.stale && text.starts_with("stale: certificate "), "{text}");
                assert!(
                    text.contains(", at t = ") && text.contains(&format!("against part {}", 4 + k % 2)),
                    "{text}"
                );
            }
            _ => unreachable!(),
        }
    }
    println!("{held} hold, {stale} stale");
    assert!(held > 10 && stale > 10, "{held} {stale}");
}

#[test]
fn what_is_no_receipt_is_an_error_on_another_scene_too() {
    let receipt = arm(&mut Rng(21), 0.0, 1, 1);
    let mut lines: Vec<String> = receipt.text().lines().map(str::to_owned).collect();
    lines.pop();
    lines.push("{\"line\":[0,1]}".into());
    assert!(verify_on(sealed(&lines).as_bytes(), scene(&receipt).as_bytes()).is_err());
}

#[test]
fn another_motion() {
    let mut rng = Rng(22);
    let receipt = arm(&mut rng, 0.0, 1, 1);
    let mut other = receipt.clone();
    let Line::Leg(rows) = &mut other.evidence[0] else {
        unreachable!()
    };
    rows[1][0] += 1e-6;
    assert!(on(&receipt, &other).holds());
    let Line::Leg(rows) = &mut other.evidence[0] else {
        unreachable!()
    };
    rows[1][0] += 20.0;
    assert!(!on(&receipt, &other).holds());
}

#[test]
fn another_scene_is_said_to_be_one() {
    let receipt = arm(&mut Rng(23), 0.0, 2, 1);
    let mut fewer = receipt.clone();
    fewer.bodies.pop();
    assert!(
        on(&receipt, &fewer)
            .to_string()
            .contains("another scene: body 5 is not the same")
    );
    let mut one = receipt.clone();
    let second = one.evidence.iter().rposition(|x| matches!(x, Line::Leg(_))).unwrap();
    one.evidence.truncate(second);
    assert!(
        on(&receipt, &one)
            .to_string()
            .contains("another scene: a leg is missing")
    );
    assert!(on(&one, &receipt).to_string().contains("another scene: 2 legs, not 1"));
    // A vertex that is not there any more.
    let meets = overlap(&mut Rng(25));
    let mut smaller = meets.clone();
    smaller.bodies[0].points.truncate(1);
    smaller.bodies[1].points.truncate(1);
    assert!(on(&meets, &smaller).to_string().contains("no such vertex"));
    // A scene with a wrong hash cannot be read.
    let broken = scene(&receipt).replace("part 5", "part 6");
    let error = verify_on(receipt.text().as_bytes(), broken.as_bytes()).unwrap_err();
    assert!(error.to_string().contains("other scene: the hash"), "{error}");
}
