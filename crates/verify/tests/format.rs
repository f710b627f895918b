//! Promise: what is not of the format is an error with its line, never a panic; limits of the
//! format.

mod support;

use lin_canny_verify::{Unreadable, Verdict, verify};
use support::*;

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    rows::rows(include_str!("format/rows.txt"), section)
}

/// Two boxes, one of which flies past the other.
fn lines() -> Vec<String> {
    let v = [[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]];
    let bodies = vec![
        body(cuboid([0.5; 3]), Move::Rest(REST)),
        body(cuboid([0.5; 3]), Move::Steady([2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], v)),
    ];
    let mut receipt = Receipt::new(Some([0.0, 1.0, 0.0]), bodies);
    let time = [0.0, 1.0];
    receipt.evidence = vec![Line::plane([0, 1], [1.0, 0.0, 0.0], time, 0.0)];
    receipt.lines()
}

/// Replaces a text in a line.
fn with(line: usize, old: &str, new: &str) -> String {
    let mut all = lines();
    assert!(all[line - 1].contains(old), "{old} in {}", all[line - 1]);
    all[line - 1] = all[line - 1].replacen(old, new, 1);
    sealed(&all)
}

fn unreadable(text: &str) -> (usize, String) {
    match verify(text.as_bytes()) {
        Err(Unreadable::Line { line, why }) => (line, why),
        other => panic!("{other:?}\n{text}"),
    }
}

fn fails(text: &str) -> String {
    match verify(text.as_bytes()) {
        Ok(Verdict::Fails(failure)) => failure.to_string(),
        other => panic!("{other:?}\n{text}"),
    }
}

#[test]
fn the_receipt_itself_holds() {
    assert!(verify(sealed(&lines()).as_bytes()).unwrap().holds());
}

#[test]
fn one_written_form_for_each_number() {
    for [number] in cases("numbers in another form").into_iter().chain([[String::new()]]) {
        let (line, why) = unreadable(&with(4, "0x1p0", &number));
        assert_eq!(line, 4, "{number}");
        assert!(why.contains("number"), "{number}: {why}");
    }
    // Subnormal numbers, the least and the greatest, are numbers. This normal proves nothing, but
    // is read.
    for number in ["0x0.0000000000001p-1022", "-0x1.fffffffffffffp1023", "0x0.8p-1022"] {
        verify(with(4, "0x1p0", number).as_bytes()).unwrap();
    }
}

#[test]
fn the_grammar_is_strict() {
    let end = sealed(&lines());
    let number = |text: &str| text.parse::<usize>().expect("a line");
    let changed = cases("lines in another grammar").into_iter();
    let changed = changed.map(|[line, old, new, at]| (with(number(&line), &old, &new), number(&at)));
    for (text, at) in changed.chain([
        (with(1, "\"apart\"", "\"a\\u0070art\""), 1),
        (with(2, "part 0", "part\u{7}0"), 2),
        (end.replace("\"end\":4", "\"end\":5"), 5),
        (end.clone() + "\n", 6),
        (end.clone() + "{}", 6),
        (end.replace('\n', "\r\n"), 1),
        (String::new(), 0),
        (end.trim_end().to_owned(), 5),
        (end.lines().take(4).map(|x| x.to_owned() + "\n").collect(), 4),
    ]) {
        let (line, why) = unreadable(&text);
        assert_eq!(line, at, "{why}: {text}");
    }
    let mut long = lines();
    long[1] = long[1].replacen("part 0", &"x".repeat(1 << 24), 1);
    assert_eq!(unreadable(&sealed(&long)).0, 2);
}

#[test]
fn quaternions_slightly_off_are_taken() {
    for (w, reads) in [
        ("0x1.0000000001p0", true),
        ("0x1.002p0", true),
        ("0x1.01p0", false),
        ("0x0p0", false),
    ] {
        let text = with(2, "\"0x1p0\"]", &format!("\"{w}\"]"));
        assert_eq!(verify(text.as_bytes()).is_ok_and(|x| x.holds()), reads, "{w}");
    }
}

#[test]
fn certificates_cover_the_interval() {
    let plane = |from: f64, until: f64| {
        format!(
            "{{\"plane\":[0,1],\"normal\":[\"0x1p0\",\"0x0p0\",\"0x0p0\"],\"from\":{},\"until\":{}}}",
            hex(from),
            hex(until)
        )
    };
    let of = |times: &[[f64; 2]]| {
        let mut all = lines();
        all.pop();
        all.extend(times.iter().map(|[from, until]| plane(*from, *until)));
        sealed(&all)
    };
    let next = f64::from_bits(0.5f64.to_bits() + 1);
    for times in [
        vec![[0.0, 0.5], [0.5, 1.0]],
        // An instant, a span of one unit, a subnormal one.
        vec![[0.0, 0.5], [0.5, 0.5], [0.5, next], [next, 1.0]],
        vec![[0.0, 5e-324], [5e-324, 1.0]],
    ] {
        assert!(verify(of(&times).as_bytes()).unwrap().holds(), "{times:?}");
    }
    for (times, why) in [
        (
            vec![[0.0, 0.5], [next, 1.0]],
            "certificate 2, part 0 against part 1: a proof from t = 0.5000000000000001",
        ),
        (vec![[0.0, next], [0.5, 1.0]], "certificate 2"),
        (vec![[0.0, 1.0], [1.0, 2.0]], "certificate 2"),
        (vec![[-1.0, 1.0]], "certificate 1"),
        (vec![[0.0, 0.5]], "proven until t = 0.5 only (line 5)"),
        (vec![], "no proof of part 0 against part 1 (line 4)"),
    ] {
        let text = fails(&of(&times));
        assert!(text.starts_with("does not hold") && text.contains(why), "{text}");
    }
    // An instant alone.
    assert!(
        verify(with(1, "\"until\":\"0x1p0\"", "\"until\":\"0x0p0\"").as_bytes())
            .unwrap()
            .holds()
    );
    // Less than the margin.
    let text = with(1, "\"margin\":\"0x0p0\"", "\"margin\":\"0x1p-1040\"");
    assert!(matches!(verify(text.as_bytes()), Err(Unreadable::Line { line: 1, .. })));
    let mut all = lines();
    all[0] = all[0].replace("\"margin\":\"0x0p0\"", "\"margin\":\"0x0.00004p-1022\"");
    assert!(verify(sealed(&all).as_bytes()).unwrap().holds());
    all[3] = all[3].replace('}', ",\"keep\":\"0x0p0\"}");
    assert!(fails(&sealed(&all)).contains("less than the margin"));
}

#[test]
fn times_of_legs_are_from_0_to_1() {
    let receipt = arm(&mut Rng(3), 0.0, 1, 1);
    for [from, until] in [[0.0, 1.5], [-0.5, 1.0]] {
        let mut other = receipt.clone();
        other.apart = Some([from, until, 0.0]);
        assert!(unreadable(&other.text()).1.contains("within a leg"));
    }
    for (time, reads) in [(0.5, true), (1.0, true), (1.5, false), (-0.5, false)] {
        let mut other = receipt.clone();
        let on = [vec![(0, 1.0)], vec![(0, 1.0)]];
        other.evidence.push(Line::Near {
            pair: [3, 4],
            at: Some(time),
            within: 8.0,
            on,
        });
        let found = verify(other.text().as_bytes()).is_ok_and(|x| x.holds());
        assert_eq!(found, reads, "{time}");
    }
    // A path that jumps.
    let mut path = arm(&mut Rng(4), 0.0, 2, 1);
    let last = path.evidence.iter().rposition(|x| matches!(x, Line::Leg(_))).unwrap();
    let Line::Leg(rows) = &mut path.evidence[last] else {
        unreachable!()
    };
    rows[0][1] += 1e-9;
    assert!(
        unreadable(&path.text()).1.contains("starts where") || unreadable(&path.text()).1.contains("does not start")
    );
}

/// The time of a steady body would start again with each leg.
#[test]
fn a_steady_body_has_one_leg() {
    for (legs, reads) in [(1, true), (2, false)] {
        let mut path = arm(&mut Rng(4), 0.0, legs, 1);
        path.bodies[4].motion = Move::Steady(REST, [[0.0; 3]; 4]);
        match verify(path.text().as_bytes()) {
            Err(Unreadable::Line { why, .. }) => assert!(!reads && why.contains("several legs"), "{why}"),
            other => assert!(reads && other.is_ok(), "{other:?}"),
        }
    }
}

#[test]
fn a_receipt_that_claims_nothing_is_refused() {
    let mut receipt = overlap(&mut Rng(1));
    receipt.evidence.clear();
    assert!(fails(&receipt.text()).contains("nothing is claimed"));
    let scene = receipt.text().replace("lines", "scene");
    let lines: Vec<_> = scene.lines().map(str::to_owned).collect();
    assert!(fails(&sealed(&lines[..3])).contains("nothing is claimed"));
}

/// Random bytes and random lines of the format.
#[test]
fn nothing_panics() {
    let mut rng = Rng(9);
    let parts = [
        "{", "}", "[", "]", "\"", ",", ":", "receipt", "1", "0x1p0", "body", "at", "\n", "\u{e9}", "plane", "leg",
    ];
    for _ in 0..20_000 {
        let text: String = (0..rng.below(30)).map(|_| parts[rng.below(parts.len())]).collect();
        assert!(verify(text.as_bytes()).is_err());
        let bytes: Vec<u8> = (0..rng.below(30)).map(|_| rng.bits() as u8).collect();
        assert!(verify(&bytes[..]).is_err());
    }
    // Extreme numbers at every place.
    let extremes = [f64::MAX, -f64::MAX, 5e-324, 1e300, -1e-300, 0.0, 1.0];
    for k in 0..200 {
        let mut receipt = match k % 3 {
            0 => overlap(&mut rng),
            1 => above(&mut rng),
            _ => cast(&mut rng, 0.0),
        };
        for _ in 0..1 + rng.below(4) {
            let mut all = receipt.numbers();
            let count = all.len();
            *all[rng.below(count)].1 = extremes[rng.below(extremes.len())];
        }
        if let Ok(verdict) = verify(receipt.text().as_bytes()) {
            verdict.to_string();
        }
    }
}

#[test]
fn the_example_of_the_chapter_holds() {
    let chapter = include_str!("../docs/format.md");
    let text = chapter.split("```json\n").nth(1).unwrap().split("```").next().unwrap();
    let said = verify(text.as_bytes()).unwrap().to_string();
    assert!(
        said.contains("proven: 1 pair of bodies stays more than 0.0625 apart"),
        "{said}"
    );
}
