//! Promise: evidence about groups of parts covers every part of both bodies at every time, and what
//! could be inside of a solid is said not to be looked at.

mod support;

use lin_canny_verify::{Verdict, verify};
use support::parted::{GAP_CHANGES, Gapped, Parted, lists, vectors};
use support::python::{code, codes, printed};
use support::*;

fn said(lines: &[String]) -> Result<String, String> {
    match verify(sealed(lines).as_bytes()) {
        Ok(Verdict::Holds(report)) => Ok(report.to_string()),
        Ok(other) => Err(other.to_string()),
        Err(error) => Err(error.to_string()),
    }
}

/// A rod of half width .25 that passes the frame along z while it turns by .25, from z = -2 + 2 t.
fn passing(is_solid: bool) -> Parted {
    let motion = (-2.0, [0.0, 0.0, 2.0], [0.0, 0.0, 0.25]);
    Parted::new([0.25; 3], motion, is_solid)
}

const INSIDE: &str = "not looked at: rod against frame: whether one is inside the other; their surfaces stay apart";

#[test]
fn groups_of_parts_prove_a_pair() {
    for is_solid in [false, true] {
        let passing = passing(is_solid);
        let said = said(&passing.all_lines()).unwrap();
        assert!(said.contains("1 pair of bodies stays more than 0 apart"), "{said}");
        assert!(!said.contains("inside"), "{said}");
    }
}

/// Without the time at which the hulls are apart, the rod could be inside the frame.
#[test]
fn what_could_be_inside_is_said() {
    for is_solid in [false, true] {
        let mut lines = passing(is_solid).all_lines();
        // The claim starts when the rod is in the hole.
        lines.remove(3);
        let later = |line: &String| line.replace("\"from\":\"0x0p0\"", "\"from\":\"0x1p-1\"");
        let from_hole = |line: &String| later(line).replace("\"from\":\"0x1p-1\"", "\"from\":\"0x1.cp-1\"");
        let before: Vec<String> = lines.iter().map(later).collect();
        lines = lines.iter().map(from_hole).collect();
        let text = said(&lines).unwrap();
        assert_eq!(text.contains(INSIDE), is_solid, "{text}");
        let outside = |at: f64, z: f64| {
            let (at, normal) = (hex(at), hexes(&[0.0, 0.0, z]));
            format!("{{\"outside\":[0,1],\"at\":{at},\"normal\":{normal}}}")
        };
        let told = |lines: &[String], line: String| said(&[lines, &[line]].concat());
        // In the hole the hulls are not apart; at a time outside of the claim a plane proves nothing.
        for (at, z) in [(0.9, 1.0), (1.0, 1.0), (1.0, -1.0), (0.5, 1.0), (0.0, 1.0), (-1.0, 1.0)] {
            assert!(told(&lines, outside(at, z)).is_err(), "{at} {z}");
        }
        // From t = .5 on, the hulls are apart at first.
        assert_eq!(said(&before).unwrap().contains(INSIDE), is_solid);
        assert!(!told(&before, outside(0.5, 1.0)).unwrap().contains("inside"));
        for (at, z) in [(0.5, -1.0), (0.5, 0.0), (0.75, 1.0)] {
            assert!(told(&before, outside(at, z)).is_err(), "{at} {z}");
        }
    }
}

#[test]
fn a_gap_among_parts_or_times_is_refused() {
    let mut cases = Vec::new();
    for is_solid in [false, true] {
        let lines = passing(is_solid).all_lines();
        let at = passing(is_solid).parts.len() / 4;
        let mut wrong: Vec<(&str, Vec<String>)> = Vec::new();
        for k in 3..8 {
            let mut less = lines.clone();
            less.remove(k);
            wrong.push(("a group left out", less));
            let mut twice = lines.clone();
            twice.insert(k, lines[k].clone());
            wrong.push(("a group twice", twice));
            let mut other = lines.clone();
            other[k] = other[k]
                .replace("\"0x1p0\"", "\"0x0p0\"")
                .replace("\"-0x1p0\"", "\"0x0p0\"");
            wrong.push(("no normal", other));
        }
        let mut changed = |why: &'static str, k: usize, old: &str, new: &str| {
            let mut all = lines.clone();
            all[k] = all[k].replace(old, new);
            assert_ne!(all[k], lines[k], "{why}");
            wrong.push((why, all));
        };
        for (k, cut) in [(4, 2 * at), (6, 3 * at)] {
            for other in [cut - 1, cut + 1] {
                changed(
                    "a part in the group of another bar",
                    k,
                    &format!("[1,{cut}]"),
                    &format!("[1,{other}]"),
                );
            }
            changed(
                "a cut of the other body",
                k,
                &format!("[1,{cut}]"),
                &format!("[0,{cut}]"),
            );
            changed("a cut of no body", k, &format!("[1,{cut}]"), &format!("[2,{cut}]"));
            changed("a cut outside", k, &format!("[1,{cut}]"), &format!("[1,{}]", 4 * at));
            changed("a cut at the start", k, &format!("[1,{cut}]"), "[1,0]");
        }
        for k in 4..8 {
            changed(
                "an interval that starts later",
                k,
                "\"0x1p-1\"",
                "\"0x1.0000000000001p-1\"",
            );
            changed(
                "an interval that ends earlier",
                k,
                "\"from\"",
                "\"until\":\"0x1.fffffffffffffp-1\",\"from\"",
            );
        }
        changed("the first plane stretched", 3, "\"0x1p-1\"", "\"0x1.8p-1\"");
        changed(
            "a rod that flies aside",
            1,
            "\"linear\":[\"0x0p0\"",
            "\"linear\":[\"0x1p-1\"",
        );
        let exchanged = |i: usize, j: usize| {
            let mut all = lines.clone();
            all.swap(i, j);
            all
        };
        wrong.push(("two groups exchanged", exchanged(4, 5)));
        wrong.push(("two groups exchanged", exchanged(5, 7)));
        for (why, lines) in wrong {
            assert!(said(&lines).is_err(), "{why}: {lines:#?}");
            cases.push((sealed(&lines), None));
        }
        cases.push((sealed(&lines), None));
    }
    let expected: Vec<i32> = cases.iter().map(|(text, _)| code(text, None)).collect();
    assert_eq!(expected.iter().filter(|code| **code == 0).count(), 2);
    if let Some(found) = codes(&cases) {
        assert_eq!(found, expected);
    }
}

/// A triangle between two bars spans the hole. Its receipt holds only if the rod passes beside it.
#[test]
fn a_changed_triangle_is_part_of_the_body() {
    let mut rng = Rng(41);
    let (mut counts, mut cases) = ([0; 2], Vec::new());
    for _ in 0..300 {
        let mut passing = passing(true);
        let count = passing.parts.len();
        let part = rng.below(count);
        passing.parts[part][rng.below(3)] = rng.below(32);
        let holds = said(&passing.all_lines()).is_ok();
        counts[usize::from(holds)] += 1;
        if cases.len() < 40 {
            cases.push((sealed(&passing.all_lines()), None));
        }
        assert!(!holds || passing.nearest() > 1e-3, "{:?}", passing.parts[part]);
    }
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
    if let Some(found) = codes(&cases) {
        let expected: Vec<i32> = cases.iter().map(|(text, _)| code(text, None)).collect();
        assert_eq!(found, expected);
    }
}

/// Points of several parts are not those of one hull.
#[test]
fn points_of_several_parts_prove_no_contact() {
    let rest = hexes(&REST);
    let parts: Vec<Vec<usize>> = (0..4).map(|k| (8 * k..8 * k + 8).collect()).collect();
    let frame = format!(
        "{{\"body\":0,\"name\":\"frame\",\"points\":{},\"parts\":{},\"at\":{rest}}}",
        vectors(&passing(false).points),
        lists(&parts)
    );
    let body = |at: V| {
        let pose = hexes(&[at[0], at[1], at[2], 0.0, 0.0, 0.0, 1.0]);
        format!(
            "{{\"body\":1,\"name\":\"die\",\"points\":{},\"at\":{pose}}}",
            vectors(&cuboid([0.125; 3]))
        )
    };
    let head = "{\"receipt\":1,\"claim\":\"lines\"}".to_string();
    let told = |at: V, line: String| said(&[head.clone(), frame.clone(), body(at), line]);
    let one = hex(1.0);
    // The die is in the hole: it is near the frame, but only a point of one bar may prove it.
    let near = |within: f64, on: &str| {
        let within = hex(within);
        format!("{{\"near\":[0,1],\"within\":{within},\"on\":[{on},[[0,{one}]]]}}")
    };
    assert!(told([0.0; 3], near(0.125, &format!("[[0,{one}],[15,{one}]]"))).is_err());
    assert!(told([0.0; 3], near(2.0, &format!("[[0,{one}],[7,{one}]]"))).is_ok());
    // Points of both bars along x enclose the die.
    let meet = |points: &str| format!("{{\"meet\":[0,1],\"points\":{points}}}");
    let mut found = [0; 2];
    let mut rng = Rng(43);
    for _ in 0..4000 {
        let pairs: Vec<String> = (0..4)
            .map(|_| format!("[{},{}]", rng.below(32), rng.below(8)))
            .collect();
        assert!(
            told([0.0; 3], meet(&format!("[{}]", pairs.join(",")))).is_err(),
            "{pairs:?}"
        );
        let pairs: Vec<String> = (0..4).map(|_| format!("[{},{}]", rng.below(8), rng.below(8))).collect();
        // Inside the first bar.
        let holds = told([0.0, -0.75, 0.0], meet(&format!("[{}]", pairs.join(",")))).is_ok();
        found[usize::from(holds)] += 1;
    }
    assert!(found[1] > 20, "{found:?}");
    // A distance to the feature of two bars.
    let distance = |names: &str| {
        let [low, high] = [0.25, 4.0].map(hex);
        format!("{{\"distance\":[0,1],\"lower\":{low},\"upper\":{high},\"on\":[{names},[0]]}}")
    };
    let above = [0.0, 0.0, 2.0];
    assert!(told(above, distance("[1,11]")).is_err());
}

#[test]
fn bodies_of_parts_are_read_strictly() {
    let lines = passing(true).all_lines();
    let triangle = "[0,1,3]";
    for (why, new) in [
        ("no triangle", "[0,1,3,2]".to_string()),
        ("no triangle", "[0,1]".into()),
        ("no triangle", "[]".into()),
        ("an unknown point", "[0,1,32]".into()),
        ("a number of another form", "[0,1,\"0x1p0\"]".into()),
    ] {
        let mut all = lines.clone();
        all[2] = all[2].replacen(triangle, &new, 1);
        assert_eq!(code(&sealed(&all), None), 3, "{why}");
        assert_eq!(codes(&[(sealed(&all), None)]).unwrap_or(vec![3]), [3], "{why}");
    }
    let mut all = lines.clone();
    all[2] = all[2].replace("\"at\":", "\"parts\":[[0]],\"at\":");
    assert_eq!(code(&sealed(&all), None), 3);
    all[2] = lines[2].replace(&lists(&passing(true).parts), "[]");
    assert_eq!(code(&sealed(&all), None), 3);
}

/// Half of the bounds are exact to the last bit.
#[test]
fn groups_of_parts_prove_a_distance() {
    let mut rng = Rng(31);
    let (mut cases, mut exact) = (Vec::new(), 0);
    for _ in 0..40 {
        let gapped = Gapped::random(&mut rng);
        assert!(!gapped.is_false());
        let text = gapped.text();
        let found = verify(text.as_bytes()).unwrap();
        assert!(found.holds(), "{found}\n{text}");
        let said = found.to_string();
        let [lower, upper] = gapped.bounds;
        let bounds = format!("rod and frame are at least {lower:?} and at most {upper:?} apart");
        assert!(said.contains(&bounds), "{said}");
        assert_eq!(said.contains("the surfaces of rod"), gapped.frame.is_solid, "{said}");
        let answer = said.contains("whether one is inside the other");
        assert_eq!(answer, gapped.frame.is_solid, "{said}");
        exact += usize::from(lower == upper);
        cases.push((text, None));
    }
    assert!(exact > 10, "{exact}");
    if let Some(found) = codes(&cases) {
        assert!(found.iter().all(|code| *code == 0), "{found:?}");
    }
}

#[test]
fn a_changed_distance_is_refused_or_true() {
    let mut rng = Rng(32);
    let (mut cases, mut expected, mut counts) = (Vec::new(), Vec::new(), [[0; 2]; GAP_CHANGES.len()]);
    for k in 0..400 {
        let (way, mut gapped) = (k % GAP_CHANGES.len(), Gapped::random(&mut rng));
        let before = gapped.text();
        let must = gapped.change(&mut rng, way);
        let text = gapped.text();
        if text == before {
            continue;
        }
        let found = code(&text, None);
        assert!(!(must && found == 0), "{}: accepted\n{text}", GAP_CHANGES[way]);
        assert!(
            !(found == 0 && gapped.is_false()),
            "{}: false, and accepted\n{text}",
            GAP_CHANGES[way]
        );
        counts[way][usize::from(found == 0)] += 1;
        cases.push((text, None));
        expected.push(found);
    }
    println!("refused, accepted: {counts:?}");
    assert!(counts.iter().all(|count| count[0] > 0), "{counts:?}");
    if let Some(found) = codes(&cases) {
        assert_eq!(found, expected);
    }
}

/// Hulls that are apart need one plane, and then no body is inside the other.
#[test]
fn one_plane_proves_a_distance_and_that_no_body_is_inside() {
    let start = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0];
    let mut gapped = Gapped::new([0.25; 3], REST, true, 0.0);
    gapped.start = start;
    gapped.cells = vec![(Vec::new(), [0.0, 0.0, -1.0])];
    // The bottom of the rod is at 1.75, the top of the frame at .25, between two points of one face.
    gapped.bounds = [1.5, 2.25];
    let said_of = |gapped: &Gapped| verify(gapped.text().as_bytes()).unwrap().to_string();
    let said = said_of(&gapped);
    assert!(said.contains("proven: rod and frame are at least 1.5"), "{said}");
    assert!(!said.contains("inside"), "{said}");
    // In the hole the hulls overlap: a lower bound below zero is true, and would prove them apart.
    let mut inside = gapped.clone();
    (inside.start, inside.bounds) = (REST, [-4.0, 2.25]);
    assert!(said_of(&inside).contains("no gap along the normal"));
    if let Some(found) = codes(&[(inside.text(), None)]) {
        assert_eq!(found, [1]);
    }
    // A normal and cells: not both; a cell of three entries.
    for (old, new) in [
        ("\"cells\"", "\"normal\":[\"0x0p0\",\"0x0p0\",\"-0x1p0\"],\"cells\""),
        ("\"cells\":[[[],", "\"cells\":[[[],[],"),
        ("\"cells\":[[[],", "\"cells\":[[[[0,1]],"),
        ("\"cells\":[[[],", "\"cells\":[[[[2,1]],"),
    ] {
        let text = gapped.text();
        let changed = text.replacen(old, new, 1);
        assert_ne!(changed, text);
        let mut lines: Vec<String> = changed.lines().map(String::from).collect();
        lines.pop();
        let text = sealed(&lines);
        assert_ne!(code(&text, None), 0, "{text}");
        if let Some(found) = codes(&[(text.clone(), None)]) {
            assert_eq!(found, [code(&text, None)], "{text}");
        }
    }
}

/// A rod that slides along z and turns about z in the hole of the frame; one coordinate is cut first. A
/// dent moves a point of the frame into the rod.
fn ranged(is_solid: bool, dent: Option<usize>) -> Vec<String> {
    let mut frame = Parted::new([0.25; 3], (0.0, [0.0; 3], [0.0; 3]), is_solid);
    if let Some(k) = dent {
        frame.points[k][1] = 0.0;
    }
    let (eighth, rest, one) = (hex(0.125), hexes(&REST), hex(1.0));
    let range = format!("[-{eighth},{eighth}]").replace("-\"", "\"-");
    let joint = |k: usize, kind: &str| {
        let (parent, c, zero) = (k - 1, k - 1, hex(0.0));
        let axis = hexes(&[0.0, 0.0, 1.0]);
        format!(
            "{{\"joint\":{k},\"parent\":{parent},\"kind\":\"{kind}\",\"origin\":{rest},\"axis\":{axis},\
             \"drive\":[{c},{one},{zero}]}}"
        )
    };
    let (key, at) = (if is_solid { "faces" } else { "parts" }, frame.parts.len() / 4);
    let (rod, points, parts) = (vectors(&frame.rod), vectors(&frame.points), lists(&frame.parts));
    let mut lines = vec![
        format!("{{\"receipt\":1,\"claim\":\"range\",\"range\":[{range},{range}],\"margin\":\"0x0p0\"}}"),
        joint(1, "slide"),
        joint(2, "turn"),
        format!("{{\"body\":0,\"name\":\"rod\",\"points\":{rod},\"link\":2}}"),
        format!("{{\"body\":1,\"name\":\"frame\",\"points\":{points},\"{key}\":{parts},\"at\":{rest}}}"),
    ];
    let first = format!("[1,{}],[1,{at}]", 2 * at);
    for start in [format!("[0,{}],{first}", hex(0.0)), first.clone()] {
        let cuts = [start, String::new(), format!("[1,{}]", 3 * at), String::new()];
        let normals = [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        for (cuts, normal) in cuts.iter().zip(normals) {
            let cut = if cuts.is_empty() {
                String::new()
            } else {
                format!(",\"cut\":[{cuts}]")
            };
            let normal = hexes(&normal);
            lines.push(format!("{{\"cell\":[0,1]{cut},\"link\":0,\"normal\":{normal}}}"));
        }
    }
    lines
}

#[test]
fn groups_of_parts_prove_a_range() {
    let (mut cases, mut expected) = (Vec::new(), Vec::new());
    for is_solid in [false, true] {
        let lines = ranged(is_solid, None);
        let said = said(&lines).unwrap();
        assert!(
            said.contains("1 pair of bodies stays more than 0 apart at every"),
            "{said}"
        );
        assert_eq!(said.contains(INSIDE), is_solid, "{said}");
        let at = if is_solid { 12 } else { 1 };
        let changed = |k: usize, old: &str, new: &str| {
            let mut lines = lines.clone();
            assert!(lines[k].contains(old), "{old} {}", lines[k]);
            lines[k] = lines[k].replacen(old, new, 1);
            lines
        };
        let without = |k: usize| [&lines[..k], &lines[k + 1..]].concat();
        let twice = |k: usize| [&lines[..=k], &lines[k..]].concat();
        let mut wrong: Vec<Vec<String>> = (5..13).flat_map(|k| [without(k), twice(k)]).collect();
        let cut = format!("[1,{at}]");
        for new in [
            "[1,0]",
            "[0,1]",
            "[2,1]",
            "[1,\"0x0p0\"]",
            "[7,\"0x0p0\"]",
            "[1]",
            "[1,999]",
        ] {
            wrong.push(changed(5, &cut, new));
        }
        let inner = [2, 3, 6, 7, 8, 9, 12, 13];
        wrong.extend(inner.map(|k| ranged(is_solid, Some(k))));
        wrong.push(changed(5, &format!(",{cut}"), ""));
        wrong.push(changed(5, "[0,\"0x0p0\"]", "[0,\"0x1p0\"]"));
        wrong.push(changed(5, "[0,\"0x0p0\"],", ""));
        for k in 5..13 {
            let sign = if k % 2 == 1 {
                ["\"-0x1p0\"", "\"0x1p0\""]
            } else {
                ["\"0x1p0\"", "\"-0x1p0\""]
            };
            wrong.push(changed(k, sign[0], sign[1]));
        }
        // The rod has a room of .25, less what it turns.
        wrong.push(changed(0, "\"margin\":\"0x0p0\"", "\"margin\":\"0x1p-2\""));
        wrong.push(changed(0, "\"-0x1p-3\",\"0x1p-3\"]]", "\"-0x1p-3\",\"0x1p1\"]]"));
        for lines in wrong {
            let text = sealed(&lines);
            assert_ne!(code(&text, None), 0, "{text}");
            expected.push(code(&text, None));
            cases.push((text, None));
        }
        // A margin that is true, and a cut elsewhere.
        let true_ones = [
            lines.clone(),
            changed(0, "\"margin\":\"0x0p0\"", "\"margin\":\"0x1p-3\""),
            changed(5, "[0,\"0x0p0\"]", "[1,\"0x1p-4\"]"),
        ];
        for lines in true_ones {
            let text = sealed(&lines);
            assert_eq!(code(&text, None), 0, "{text}");
            expected.push(0);
            cases.push((text, None));
        }
    }
    if let Some(found) = codes(&cases) {
        assert_eq!(found, expected);
    }
}

/// Both checkers print the same about what could be inside of a solid.
#[test]
fn both_checkers_say_what_could_be_inside() {
    let mut counts = [0; 2];
    for is_solid in [false, true] {
        let passing = passing(is_solid).text();
        let gapped = Gapped::new([0.25; 3], REST, is_solid, 0.0).text();
        let mut apart = Gapped::new([0.25; 3], REST, is_solid, 0.0);
        apart.start[2] = 2.0;
        (apart.cells, apart.bounds) = (vec![(Vec::new(), [0.0, 0.0, -1.0])], [1.5, 2.25]);
        for text in [passing, gapped, apart.text(), sealed(&ranged(is_solid, None))] {
            let found = verify(text.as_bytes()).unwrap();
            assert!(found.holds(), "{found}");
            let has = |said: &str| said.contains("whether one is inside the other");
            let Some(said) = printed(&[&text]) else { return };
            assert!(said.starts_with("holds"), "{said}");
            assert_eq!(has(&found.to_string()), has(&said), "{found}\n{said}");
            counts[usize::from(has(&said))] += 1;
        }
    }
    assert_eq!(counts, [6, 2]);
}
