//! Promise: on another scene each certificate is evaluated again, and the first that fails is
//! named.

mod support;

use std::collections::BTreeMap;

use lin_canny_verify::{Verdict, verify_on};
use support::python::{code, codes, printed};
use support::ranged::small_ranged;
use support::scenes::{OnScene, SCENE, flying, text};
use support::*;

/// The scene of a receipt, with its legs and without other evidence.
fn scene(receipt: &Receipt) -> String {
    text(receipt, Some(SCENE))
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
                assert!(text.contains(", at t = "), "{text}");
                assert!(text.contains(&format!("against part {}", 4 + k % 2)), "{text}");
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

/// A receipt, another scene, the exit code of both checkers, and a part of what is printed.
type Case = (String, String, i32, &'static str);

/// The lines of a text without its tail.
fn lines_of(text: &str) -> Vec<String> {
    let mut all: Vec<String> = text.lines().map(str::to_owned).collect();
    all.pop();
    all
}

/// The control points of the last leg.
fn last_leg(receipt: &mut Receipt) -> &mut Vec<Vec<f64>> {
    let found = receipt.evidence.iter_mut().rev().find(|x| matches!(x, Line::Leg(_)));
    let Some(Line::Leg(rows)) = found else { unreachable!() };
    rows
}

/// The claim of a receipt about another scene that breaks a rule is stale.
fn broken_by_the_claim() -> Vec<Case> {
    let mut cases = Vec::new();
    // Configurations: no time, no leg, and a range for each coordinate.
    let ranged = small_ranged(&mut Rng(26), 1);
    let mut add = |change: &dyn Fn(&mut Receipt), why| {
        let mut arm = ranged.arm.clone();
        change(&mut arm);
        cases.push((ranged.text(), scene(&arm), 1, why));
    };
    let flies = |arm: &mut Receipt| arm.bodies[2].motion = flying(&arm.bodies[2].motion, [0.0, 0.0, -1.0]);
    add(&flies, "a body that is steady");
    add(&|arm| arm.joints[1].drive.0 = 5, "a range of each coordinate");
    let leg = || Line::Leg(vec![vec![0.0; 2]]);
    add(&|arm| arm.evidence.push(leg()), "a leg in a claim about configurations");
    // An interval within each leg.
    let at = Move::Rest([3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let still = flying(&at, [0.0; 3]);
    let bodies = vec![
        body(vec![[0.0; 3]], at),
        body(cuboid([0.5; 3]), flying(&Move::Rest(REST), [0.0; 3])),
    ];
    for (time, count, why) in [
        ([-1.0, 2.0], 1, "the interval is not within a leg"),
        ([0.0, 0.5], 2, "or not all of each of several"),
        ([0.0, 1.0], 0, "evidence before the first leg"),
    ] {
        let mut receipt = Receipt::new(Some([time[0], time[1], 0.0]), bodies.clone());
        receipt.evidence = vec![Line::Balls {
            a: 0,
            others: vec![1],
            time,
            keep: 0.0,
        }];
        assert_eq!(code(&receipt.text(), Some(&scene(&receipt))), 0);
        let mut other = receipt.clone();
        (other.joints, other.bodies[1].motion) = (ranged.arm.joints.clone(), Move::Link(1, None));
        other.evidence = (0..count).map(|_| leg()).collect();
        cases.push((receipt.text(), scene(&other), 1, why));
    }
    // Another number of legs, and other bodies.
    let lever = lever(&mut Rng(27), 0.0, 2, 1);
    let mut less = lever.clone();
    let second = less
        .evidence
        .iter()
        .rposition(|line| matches!(line, Line::Leg(_)))
        .unwrap();
    less.evidence.truncate(second);
    cases.push((lever.text(), scene(&less), 1, "a leg is missing"));
    cases.push((less.text(), scene(&lever), 1, "another scene: 2 legs, not 1"));
    let mut fewer = lever.clone();
    fewer.bodies.pop();
    cases.push((lever.text(), scene(&fewer), 1, "another scene: body 2 is not the same"));
    // What a line says of its bodies.
    let rests = overlap(&mut Rng(25));
    let mut moves = rests.clone();
    moves.bodies[0].motion = still;
    cases.push((rests.text(), scene(&moves), 1, "a pair that moves has a time"));
    cases
}

/// A file that breaks a rule by itself cannot be read, neither as the receipt nor as the scene.
fn broken_by_the_file() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut both = |good: &str, broken: String, why| {
        assert_eq!(code(good, Some(good)), 0, "{why}");
        cases.push((good.into(), broken.clone(), 3, why));
        cases.push((broken, good.into(), 3, why));
    };
    let lever = lever(&mut Rng(28), 0.0, 2, 1);
    let good = lever.text();
    let mut with = |change: &dyn Fn(&mut Receipt), why| {
        let mut broken = lever.clone();
        change(&mut broken);
        both(&good, broken.text(), why);
    };
    let empty = |broken: &mut Receipt| {
        broken.bodies.clear();
        broken.ignored.clear();
    };
    let flies = |broken: &mut Receipt| broken.bodies[2].motion = flying(&broken.bodies[2].motion, [0.0; 3]);
    with(&empty, "the scene has no body");
    with(
        &|broken| last_leg(broken).iter_mut().for_each(|row| row.truncate(1)),
        "a coordinate for each joint",
    );
    with(
        &|broken| last_leg(broken)[0][0] += 1e-9,
        "does not start where the one before ends",
    );
    with(&flies, "several legs, and a body that is steady");
    with(
        &|broken| broken.apart = Some([0.0, 1.5, 0.0]),
        "the interval is not within a leg",
    );
    with(
        &|broken| broken.apart = Some([0.0, 0.5, 0.0]),
        "or not all of each of several",
    );
    with(&|broken| broken.apart = None, "this claim is of single lines");
    with(
        &|broken| drop(broken.evidence.remove(0)),
        "evidence before the first leg",
    );
    let plain = lines_of(&good);
    let headed = |head: &str| sealed(&[&[head.to_owned()], &plain[1..]].concat());
    both(&good, headed(SCENE), "evidence in a scene");
    let over = |range: &str| {
        let head = "{\"receipt\":1,\"claim\":\"range\",\"range\":[RANGE],\"margin\":\"0x0p0\"}";
        headed(&head.replace("RANGE", range))
    };
    let zero = "[\"0x0p0\",\"0x0p0\"]";
    both(&good, over(zero), "a range of each coordinate");
    both(
        &good,
        over(&format!("{zero},{zero}")),
        "a leg in a claim about configurations",
    );
    let more = |text: &str, line: &str| sealed(&[lines_of(text), vec![line.to_owned()]].concat());
    both(
        &good,
        more(&good, "{\"cell\":[0,2]}"),
        "a claim about a range has cells alone",
    );
    let mut ranged = small_ranged(&mut Rng(26), 1);
    let good = ranged.text();
    both(
        &good,
        more(&good, "{\"balls\":[0,[2]]}"),
        "a claim about a range has cells alone",
    );
    flies(&mut ranged.arm);
    both(&good, ranged.text(), "a body that is steady");
    let mut base = overlap(&mut Rng(25));
    let good = base.text();
    base.base = Some(REST);
    both(&good, base.text(), "a base without joints");
    cases
}

#[test]
fn every_rule_is_checked_for_both_scenes() {
    let cases = [broken_by_the_claim(), broken_by_the_file()].concat();
    let texts: Vec<_> = cases
        .iter()
        .map(|case| (case.0.clone(), Some(case.1.clone())))
        .collect();
    let python = codes(&texts);
    for (k, (receipt, other, wanted, why)) in cases.iter().enumerate() {
        let found = match verify_on(receipt.as_bytes(), other.as_bytes()) {
            Ok(verdict) => verdict.to_string(),
            Err(error) => error.to_string(),
        };
        if let Some(python) = &python {
            assert_eq!(python[k], *wanted, "in Python: {why}");
        }
        assert_eq!(code(receipt, Some(other)), *wanted, "{why}: {found}");
        assert!(found.contains(why), "{why}: {found}");
    }
}

/// The report names the files from which the bodies were made that it is about.
#[test]
fn files_are_those_of_the_scene_that_is_evaluated() {
    let receipt = arm(&mut Rng(31), 0.0, 1, 1);
    let with_file = |text: &str, name: &str| {
        let mut lines = lines_of(text);
        lines.insert(1, format!("{{\"file\":\"{name}\",\"sha256\":\"{}\"}}", "0".repeat(64)));
        sealed(&lines)
    };
    let [own, other] = [
        with_file(&receipt.text(), "before.urdf"),
        with_file(&scene(&receipt), "after.urdf"),
    ];
    let found = verify_on(own.as_bytes(), other.as_bytes()).unwrap();
    assert!(found.holds());
    for said in [Some(found.to_string()), printed(&[&own, &other])]
        .into_iter()
        .flatten()
    {
        assert!(said.contains("file after.urdf"), "{said}");
        assert!(!said.contains("before.urdf"), "{said}");
    }
}

/// Both checkers on changed scenes: equal codes, and samples do not refute what is accepted.
fn changed_scenes(count: usize, seed: u64) {
    let (mut rng, mut changes) = (Rng(seed), BTreeMap::<&str, [usize; 4]>::new());
    for start in (0..count).step_by(200) {
        let cases: Vec<_> = (start..count.min(start + 200))
            .map(|_| OnScene::random(&mut rng))
            .collect();
        let texts: Vec<_> = cases
            .iter()
            .map(|case| (case.receipt.clone(), Some(case.scene.clone())))
            .collect();
        let python = codes(&texts);
        for (k, case) in cases.iter().enumerate() {
            let found = code(&case.receipt, Some(&case.scene));
            let (change, files) = (case.change, format!("{}\n{}", case.receipt, case.scene));
            let in_python = python.as_ref().map_or(found, |codes| codes[k]);
            assert!(
                found.min(in_python) > 0 || !case.is_false(&mut rng),
                "{change}: accepted, and false:\n{files}"
            );
            assert_eq!(found, in_python, "{change}: another answer in Python:\n{files}");
            changes.entry(change).or_default()[found as usize] += 1;
        }
    }
    for (change, [hold, stale, _, unread]) in &changes {
        println!("{change}: {hold} hold, {stale} stale, {unread} cannot be read");
    }
    let of = |k: usize| changes.values().map(|counts| counts[k]).sum::<usize>();
    assert!(of(0) > count / 10, "{changes:?}");
    assert!(of(1) > count / 10, "{changes:?}");
    assert!(of(3) > count / 50, "{changes:?}");
}

#[test]
fn what_holds_on_a_changed_scene_is_true() {
    changed_scenes(200, 29);
}

#[test]
#[ignore = "minutes: cargo test --release -p lin-canny-verify --test stale ten_thousand -- --ignored --nocapture"]
fn ten_thousand_changed_scenes() {
    changed_scenes(10_000, 30);
}
