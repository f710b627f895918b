//! Promise: receipts of every kind hold, and say what they prove and what was not looked at.

mod support;

use lin_canny_verify::{Report, Verdict, verify};
use support::*;

fn holds(text: &str) -> Report {
    match verify(text.as_bytes()) {
        Ok(Verdict::Holds(report)) => report,
        other => panic!("{other:?}\n{text}"),
    }
}

/// A generator with a name.
pub(crate) type Kind = (&'static str, fn(&mut Rng) -> Receipt);

const KINDS: [Kind; 8] = [
    ("overlap", overlap),
    ("distance", above),
    ("cast", |rng| cast(rng, 0.0)),
    ("cast with a margin", |rng| cast(rng, 0.01)),
    ("hit", hit),
    ("segment", |rng| arm(rng, 0.0, 1, 1)),
    ("curve", |rng| arm(rng, 0.0, 1, 3)),
    ("path", |rng| arm(rng, 0.01, 3, 1)),
];

#[test]
fn every_kind_holds() {
    for (name, make) in KINDS {
        let mut rng = Rng(1);
        let (mut certificates, mut wide) = (0, 0);
        for _ in 0..40 {
            let receipt = make(&mut rng);
            assert!(!receipt.is_false(), "{name}: the generator is wrong");
            let report = holds(&receipt.text());
            (certificates, wide) = (certificates + report.certificates, wide + report.wide);
            assert!(!report.proven.is_empty());
        }
        println!("{name}: {certificates} certificates, {wide} with wide integers");
        assert!(
            wide * 20 <= certificates,
            "{name}: narrow integers should do: {wide} of {certificates}"
        );
    }
}

#[test]
fn the_text_says_what_is_proven_and_what_was_not_looked_at() {
    let receipt = arm(&mut Rng(2), 0.01, 2, 1);
    let text = holds(&receipt.text()).to_string();
    for part in [
        "proven: 7 pairs of bodies stay more than 0.01 apart from t = 0 until t = 1 of each of 2 legs",
        "moving: part 1, part 2, part 3; at rest: part 0, part 4, part 5",
        "not looked at: part 0 against part 3: cannot meet",
        "not looked at: 3 pairs of bodies that both rest",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}

/// A receipt that holds by other lines alone lists the pairs that it ignores, too.
#[test]
fn ignored_pairs_are_listed_if_no_pair_is_proven_apart() {
    let die = |motion| body(cuboid([0.5; 3]), motion);
    let still = Move::Steady(REST, [[0.0; 3]; 4]);
    let bodies = vec![die(Move::Rest(REST)), die(Move::Rest(REST)), die(still)];
    let mut receipt = Receipt::new(Some([0.0, 1.0, 0.0]), bodies);
    receipt.ignored = vec![(2, vec![0, 1], "elsewhere")];
    receipt.evidence = vec![Line::Near {
        pair: [0, 1],
        at: None,
        within: 0.0,
        on: [vec![(0, 1.0)], vec![(0, 1.0)]],
    }];
    let report = holds(&receipt.text());
    assert_eq!((report.proven.len(), report.not_looked_at.len()), (1, 2), "{report}");
}

/// A gap of exactly the margin is not more than the margin.
#[test]
fn exactly_the_margin_is_refused() {
    let boxes = |gap: f64| {
        let at = [1.0 + gap, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let half = cuboid([0.5; 3]);
        let still = [[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]];
        let bodies = vec![
            body(half.clone(), Move::Rest(REST)),
            body(half, Move::Steady(at, still)),
        ];
        let mut receipt = Receipt::new(Some([0.0, 1.0, 0.25]), bodies);
        let line = Line::plane([0, 1], [1.0, 0.0, 0.0], [0.0, 1.0], 0.25);
        receipt.evidence.push(line);
        receipt
    };
    let report = holds(&boxes(0.25 + f64::EPSILON).text());
    assert!(report.to_string().contains("stays more than 0.25 apart"));
    for gap in [0.25, 0.25 - f64::EPSILON] {
        assert!(!verify(boxes(gap).text().as_bytes()).unwrap().holds());
    }
    // Touching is not apart.
    let mut touching = boxes(0.0);
    touching.apart = Some([0.0, 1.0, 0.0]);
    let Line::Plane { keep, .. } = &mut touching.evidence[0] else {
        unreachable!()
    };
    *keep = 0.0;
    assert!(!verify(touching.text().as_bytes()).unwrap().holds());
}

/// A turn by many revolutions, and the greatest one that is not refused.
#[test]
fn sines_of_large_angles_are_enclosed() {
    for (k, angle) in [0.0f64, 1e-3, 1.0, 40.0, 3e3, 1e6].into_iter().enumerate() {
        let (tip, wall) = (cuboid([0.1; 3]), cuboid([0.125; 3]));
        let end = [angle.cos(), angle.sin(), 0.0];
        let origin = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let arm = tip.iter().map(|p| add(*p, [1.0, 0.0, 0.0])).collect();
        let beyond = |x: f64| [end[0] * x, end[1] * x, end[2] * x, 0.0, 0.0, 0.0, 1.0];
        let bodies = vec![body(arm, Move::Link(1, None)), body(wall, Move::Rest(beyond(1.5)))];
        let mut receipt = Receipt::new(Some([0.0, 1.0, 0.0]), bodies);
        let drive = (0, 1.0, angle);
        receipt.joints = vec![Joint::new(0, "turn", origin, [0.0, 0.0, 1.0], drive)];
        receipt.evidence = vec![
            Line::Leg(vec![vec![0.0], vec![0.0]]),
            Line::plane([0, 1], end, [0.0, 1.0], 0.0),
        ];
        holds(&receipt.text());
        // The same wall where the tip is.
        receipt.bodies[1].motion = Move::Rest(beyond(1.1));
        assert!(!verify(receipt.text().as_bytes()).unwrap().holds(), "{k}");
    }
}

/// Scaling by a power of two changes nothing; sizes from 1e-100 to 1e100.
#[test]
fn scaled_scenes_hold() {
    for exponent in [-332, -1, 1, 332] {
        let factor = 2f64.powi(exponent);
        let mut receipt = cast(&mut Rng(5), 0.01);
        let apart = receipt.apart.as_mut().unwrap();
        apart[2] *= factor;
        for b in &mut receipt.bodies {
            b.points.iter_mut().flatten().for_each(|x| *x *= factor);
            let Move::Steady(pose, v) = &mut b.motion else {
                unreachable!()
            };
            pose[..3].iter_mut().for_each(|x| *x *= factor);
            v.iter_mut()
                .enumerate()
                .filter(|x| x.0 != 2)
                .for_each(|(_, v)| *v = scale(*v, factor));
        }
        for line in &mut receipt.evidence {
            let (Line::Plane { keep, .. } | Line::Balls { keep, .. }) = line else {
                unreachable!()
            };
            *keep *= factor;
        }
        assert_eq!(holds(&receipt.text()).wide, holds(&cast(&mut Rng(5), 0.01).text()).wide);
    }
}

#[test]
fn rounded_bodies_touch_without_their_hulls() {
    let ball = |x: f64| Body {
        points: vec![[0.0; 3]],
        radius: 0.5,
        motion: Move::Rest([x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    };
    let mut receipt = Receipt::new(None, vec![ball(0.0), ball(1.0)]);
    let on = [vec![(0, 1.0)], vec![(0, 2.0)]];
    receipt.evidence.push(Line::Near {
        pair: [0, 1],
        at: None,
        within: 0.0,
        on,
    });
    receipt.evidence.push(Line::Features {
        pair: [0, 1],
        bounds: [0.0, 0.0],
        on: [vec![0], vec![0]],
    });
    let text = holds(&receipt.text()).to_string();
    assert!(text.contains("part 0 and part 1 are at most 0 apart"), "{text}");
    receipt.bodies[1] = ball(0.875);
    let Line::Features { bounds, .. } = &mut receipt.evidence[1] else {
        unreachable!()
    };
    *bounds = [-0.125, -0.125];
    holds(&receipt.text());
    let Line::Features { bounds, .. } = &mut receipt.evidence[1] else {
        unreachable!()
    };
    *bounds = [-0.125 + 1e-17, -0.125];
    assert!(!verify(receipt.text().as_bytes()).unwrap().holds());
}

/// Two boxes at rest that share a face, an edge or a vertex share a point; one unit farther they do
/// not.
#[test]
fn touching_at_rest_is_proven() {
    let half = cuboid([0.5; 3]);
    for shift in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 0.25, -0.125]] {
        let at = |s: f64| [shift[0] * s, shift[1], shift[2], 0.0, 0.0, 0.0, 1.0];
        let touches = |s: f64| {
            let bodies = vec![
                body(half.clone(), Move::Rest(REST)),
                body(half.clone(), Move::Rest(at(s))),
            ];
            let mut receipt = Receipt::new(None, bodies);
            let mut rng = Rng(7);
            (0..2_000).any(|_| {
                let points = std::array::from_fn(|_| [rng.below(8), rng.below(8)]);
                receipt.evidence = vec![Line::meet(None, points)];
                verify(receipt.text().as_bytes()).unwrap().holds()
            })
        };
        assert!(touches(1.0), "{shift:?}");
        assert!(!touches(1.0 + f64::EPSILON), "{shift:?}");
    }
}
