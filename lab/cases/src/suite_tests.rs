//! Valid files are read, and invalid files are rejected.

use super::*;
use crate::exact::solve;

const FILE: &str = r#"{"t":"suite","version":1,"name":"two boxes","seed":7}
{"t":"shape","id":0,"name":"tetra","v":[0,0,0,1,0,0,0,1,0,0,0,-1e-300],"f":[[0,1,2],[0,3,1],[1,3,2],[0,2,3]]}

{"t":"shape","id":1,"name":"flat","v":[0,0,0,1,0,0.1],"f":[]}
{"t":"note","of":"another kind"}
{"t":"case","id":0,"fam":"rand","lvl":"n4","seq":-1,"frame":0,"a":0,"b":0,"qa":[0,0,0,1],"ta":[0,0,0],"qb":[0,0,0,1],"tb":[0,0,1.0508032761393937e-6],"cls":"sep","s":1.0508032761393937e-6,"s_lo":0,"n":[0,0,1],"wa":[0,0,0],"wb":[0,0,1.0508032761393937e-6],"on":[3,3],"near":[3,3],"ties":1,"L":2.5,"Lw":2.5,"cond":2.6e6}
{"t":"case","id":1,"fam":"m","lvl":"x","seq":3,"frame":12,"a":0,"b":1,"qa":[0,0,0,1],"ta":[0,0,0],"qb":[0.6,0,0,-0.8],"tb":[5e-324,-0.0,2]}
"#;

fn read(text: &str) -> Vec<Result<Line, SuiteError>> {
    Reader::new(text.as_bytes()).collect()
}

fn error_of(text: &str) -> String {
    let lines = read(text);
    let last = lines.last().expect("a line");
    last.as_ref().expect_err("refused").to_string()
}

#[test]
fn all_kinds_of_lines_are_read_bit_for_bit() {
    let lines: Vec<Line> = read(FILE).into_iter().map(Result::unwrap).collect();
    let [
        Line::Header(h),
        Line::Shape(tetra),
        Line::Shape(flat),
        Line::Case(open),
        Line::Case(blind),
    ] = &lines[..]
    else {
        panic!("{lines:?}")
    };
    assert_eq!((h.version, h.name.as_str(), h.seed), (1, "two boxes", 7));
    assert_eq!(
        (tetra.shape.points[3], tetra.shape.faces.len()),
        ([0.0, 0.0, -1e-300], 4)
    );
    assert_eq!((flat.id, flat.shape.points.len(), flat.shape.faces.len()), (1, 2, 0));
    let truth = open.truth.as_ref().unwrap();
    assert_eq!(
        (truth.state, truth.distance.to_bits()),
        (ContactState::Separated, 1.0508032761393937e-6f64.to_bits())
    );
    assert_eq!(
        (truth.normal, truth.size, open.sequence),
        (Some([0.0, 0.0, 1.0]), Some(2.5), None)
    );
    assert_eq!((blind.sequence, blind.frame, &blind.truth), (Some(3), 12, &None));
    assert_eq!(
        blind.pose_b.t.map(f64::to_bits),
        [5e-324f64, -0.0, 2.0].map(f64::to_bits)
    );
}

#[test]
fn a_case_can_be_solved() {
    let lines = read(FILE);
    let Ok(Line::Shape(s)) = &lines[1] else { panic!() };
    let Ok(Line::Case(c)) = &lines[3] else { panic!() };
    let body = (&s.shape).into();
    let e = solve(body, &c.pose_a, body, &c.pose_b);
    assert_eq!(
        (e.state, e.distance),
        (ContactState::Separated, 1.0508032761393937e-6 - 1e-300)
    );
}

/// The example of the description, with its lines joined, agrees with the oracle.
#[test]
fn the_description_is_right() {
    let text = include_str!("../../../tests/CASES.md");
    let json = text
        .lines()
        .filter(|l| l.starts_with("    {\"t\"") || l.starts_with("     \""));
    let file: String = json
        .map(|l| {
            if l.ends_with('}') {
                format!("{}\n", l.trim())
            } else {
                l.trim().to_owned()
            }
        })
        .collect();
    let lines: Vec<Line> = read(&file).into_iter().map(Result::unwrap).collect();
    let [
        Line::Header(_),
        Line::Shape(s),
        Line::Case(c),
        Line::Header(_),
        Line::Shape(mesh),
        queries @ ..,
    ] = &lines[..]
    else {
        panic!("{lines:?}")
    };
    let mut kinds = Vec::new();
    for line in queries {
        let Line::Query(case) = line else { panic!("{line:?}") };
        let truth = crate::solid::solve(&case.query, |id| [&s.shape, &mesh.shape][id]);
        assert_eq!(Some(truth), case.truth, "{case:?}");
        kinds.push(case.query.kind());
    }
    assert_eq!(kinds, ["point", "meshes", "cast", "ray"]);
    let (body, truth) = ((&s.shape).into(), c.truth.as_ref().unwrap());
    let e = solve(body, &c.pose_a, body, &c.pose_b);
    assert_eq!(
        (e.state, e.distance, e.remainder),
        (truth.state, truth.distance, truth.remainder)
    );
    let gap = crate::bound::support_gap(body, &c.pose_a, body, &c.pose_b, truth.normal.unwrap());
    assert_eq!(gap, truth.distance);
}

#[test]
fn lines_are_written_as_they_were_read() {
    let lines: Vec<Line> = read(FILE).into_iter().map(Result::unwrap).collect();
    let mut text = Vec::new();
    lines.iter().for_each(|line| write(&mut text, line).unwrap());
    let text = String::from_utf8(text).unwrap();
    assert!(text.starts_with("{\"t\":\"suite\",\"version\":1,"), "{text}");
    let again: Vec<Line> = read(&text).into_iter().map(Result::unwrap).collect();
    assert_eq!(format!("{lines:?}"), format!("{again:?}"), "-0.0 and all");
}

#[test]
fn bad_lines_are_named() {
    assert!(error_of("\n{\"t\":\"suite\",\"version\":3}\n").contains("line 2: version 3"));
    assert!(error_of("{\"t\":\"shape\",\"id\":4,\"v\":[1,2]}").contains("shape 4 has 2 coordinates"));
    assert!(error_of("{\"t\":\"shape\",\"id\":4,\"v\":[1,2,3],\"f\":[[0,0,7]]}").contains("names point 7 of 1"));
    assert!(error_of("{\"t\":\"case\",\"id\":1}").contains("missing field"));
    assert!(error_of(&FILE.replace("\"sep\"", "\"apart\"")).contains("class \"apart\" of case 0"));
    assert!(error_of(&FILE.replace(",\"s\":", ",\"r\":")).contains("only one of cls and s"));
    assert!(error_of("not json").contains("line 1"));
    assert_eq!(
        read("nonsense\n{\"t\":\"suite\",\"version\":1}").len(),
        1,
        "nothing after an error"
    );
}

#[test]
fn answers_are_written_with_every_bit() {
    let answer = Answer {
        id: 3,
        status: "sep",
        distance: Some(0.1),
        witnesses: Some(([1.0, 2.0, 3.5], [0.0; 3])),
        normal: None,
        nanoseconds: 40,
    };
    assert_eq!(answer.to_string(), "3 sep 1e-1 1e0 2e0 3.5e0 0e0 0e0 0e0 - - - 40");
    let none = Answer {
        status: "none",
        distance: None,
        witnesses: None,
        ..answer
    };
    assert_eq!(none.to_string(), "3 none - - - - - - - - - - 40");
}
