//! The tool as a user runs it.

use crate::{said, scratch, tool};

#[test]
fn two_commands_make_clearances_and_a_query_finds_the_worst() {
    let folder = scratch("three");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let (code, text) = said(tool("sample").args(["--rows", "3000", "--rows-per-file", "2000", "--out", &at("q")]));
    assert!(
        code == 0 && text.contains("3000 configurations of 6 joints in 2 file(s)"),
        "{text}"
    );
    let (code, text) = said(tool("run").args(["--in", &at("q"), "--out", &at("out")]));
    assert!(
        code == 0 && text.contains("3000 rows in 2 part(s), 0 kept from before, 0 bad"),
        "{text}"
    );
    let (code, text) = said(tool("run").args(["--in", &at("q"), "--out", &at("out")]));
    assert!(code == 0 && text.contains("3000 rows in 2 part(s), 2 kept"), "{text}");
    let query = "SELECT turn, lift, elbow, roll, bend, twist FROM configs ORDER BY distance LIMIT 10";
    let run = [
        "--in",
        &at("out"),
        "--out",
        &at("worst"),
        "--format",
        "csv",
        "--sql",
        query,
    ];
    let (code, text) = said(tool("run").args(run));
    assert_eq!(code, 0, "{text}");
    let worst = std::fs::read_to_string(at("worst/result.csv")).expect("an answer");
    assert_eq!(worst.lines().next(), Some("turn,lift,elbow,roll,bend,twist"));
    assert_eq!(worst.lines().count(), 11, "{worst}");
}

#[test]
fn a_query_is_answered_as_a_whole() {
    let folder = scratch("query");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let random = [
        "--rows",
        "2000",
        "--method",
        "random",
        "--format",
        "csv",
        "--out",
        &at("q"),
    ];
    assert_eq!(said(tool("sample").args(random)).0, 0);
    let query = "SELECT is_free(turn, lift, elbow, roll, bend, twist) AS free, count(*) AS n FROM configs GROUP BY 1 ORDER BY 1";
    let run = ["--in", &at("q"), "--out", &at("out"), "--format", "csv", "--sql", query];
    let (code, text) = said(tool("run").args(run));
    assert_eq!(code, 0, "{text}");
    let answer = std::fs::read_to_string(at("out/result.csv")).expect("an answer");
    let count = |word: &str| {
        let line = answer.lines().find_map(|l| l.strip_prefix(word));
        line.and_then(|n| n.parse::<u32>().ok()).expect("a count")
    };
    assert_eq!(count("true,") + count("false,"), 2000, "{answer}");
}

#[test]
fn options_of_the_scene_change_the_study() {
    let folder = scratch("scene");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    assert_eq!(said(tool("sample").args(["--rows", "200", "--out", &at("q")])).0, 0);
    let run = ["--in", &at("q"), "--out", &at("out")];
    assert_eq!(said(tool("run").args(run)).0, 0);
    let part = r#"{"name": "rod", "box": {"size": [0.04, 0.04, 0.5]}, "xyz": [0, 0, 0.3], "touch_links": ["gripper"]}"#;
    std::fs::write(at("part.json"), part).expect("a file");
    let attach = format!("gripper={}", at("part.json"));
    for scene in [
        ["--attach", attach.as_str()],
        ["--pad", "gripper=0.01"],
        ["--exclude", "gripper,table"],
        ["--start-contact", "0.001"],
        ["--limit-slack", "0.1"],
    ] {
        let (code, text) = said(tool("run").args(run).args(scene));
        assert!(
            code == 3 && text.contains("another robot, cell or option"),
            "{scene:?}: {text}"
        );
        let other = at(scene[0].trim_start_matches('-'));
        let (code, text) = said(tool("run").args(["--in", &at("q"), "--out", &other]).args(scene));
        assert!(code == 0 && text.contains("200 rows in 1 part(s)"), "{scene:?}: {text}");
    }
    for (wrong, word) in [
        (["--attach", "gripper"], "LINK=FILE.json"),
        (["--attach", "gripper=none.json"], "none.json"),
        (["--pad", "gripper"], "NAME=LENGTH"),
        (["--pad", "gripper=-1"], "expected a finite number, at least 0"),
        (["--margin", "-1"], "expected a finite number, at least 0"),
        (["--limit-slack", "nan"], "expected a finite number, at least 0"),
        (["--pad", "hnad=1"], "hnad"),
        (["--exclude", "gripper"], "two names"),
        (["--exclude", "gripper,tabel"], "tabel"),
        (["--start-contact", "nan"], "expected a finite number, at least 0"),
    ] {
        let (code, text) = said(tool("run").args(run).args(wrong));
        assert!(code != 0 && text.contains(word), "{wrong:?}: {code} {text}");
    }
}

#[test]
fn points_without_a_return_are_dropped_or_rejected() {
    let folder = scratch("invalid");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    assert_eq!(said(tool("sample").args(["--rows", "50", "--out", &at("q")])).0, 0);
    std::fs::write(at("scan.xyz"), "0.1 0 0\nnan nan nan\n0 0.1 0\n").expect("a file");
    let part = r#"{"name": "scan", "cloud": {"file": "scan.xyz", "radius": 0.01}, "xyz": [0, 0, 0.3]}"#;
    std::fs::write(at("part.json"), part).expect("a file");
    let attach = format!("gripper={}", at("part.json"));
    let run = ["--in", &at("q"), "--out", &at("out"), "--attach", &attach];
    let (code, text) = said(tool("run").args(run));
    assert!(code == 0 && text.contains("1 points without a return"), "{code} {text}");
    let (code, text) = said(tool("run").args(run).arg("--keep-invalid"));
    assert!(code == 3 && text.contains("scan.xyz"), "{code} {text}");
}

#[test]
fn a_roadmap_has_nodes_and_edges() {
    let folder = scratch("roadmap");
    let out = folder.join("map").to_string_lossy().into_owned();
    let run = ["--samples", "300", "--neighbours", "5", "--out", &out];
    let (code, text) = said(tool("roadmap").args(run));
    assert!(code == 0 && text.contains("segments are proven free"), "{text}");
    let again = said(tool("roadmap").args(run));
    assert!(again.0 == 0, "{}", again.1);
    assert_eq!(text, again.1);
}

#[test]
fn what_does_not_fit_is_named() {
    let folder = scratch("unfit");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let refused = |arguments: &[&str], parts: &[&str]| {
        let (code, text) = said(tool("run").args(arguments));
        assert!(code == 3 && parts.iter().all(|p| text.contains(p)), "{code} {text}");
    };
    refused(
        &["--in", &at("none.csv"), "--out", &at("o")],
        &["none.csv", "No such file"],
    );
    std::fs::write(at("a.txt"), "turn\n0\n").expect("a file");
    refused(
        &["--in", &at("a.txt"), "--out", &at("o")],
        &["a.txt", ".parquet, .csv or .arrow"],
    );
    std::fs::write(at("b.csv"), "turn,lift,elbow,roll,bend\n0,0,0,0,0\n").expect("a file");
    refused(
        &["--in", &at("b.csv"), "--out", &at("o")],
        &["no column \"twist\"", "turn, lift"],
    );
    let head = "id,turn,lift,elbow,roll,bend,twist\n";
    std::fs::write(
        at("c.csv"),
        format!("{head}7,0,0,0,0,0,0\n8,0,0,,0,0,0\n9,0,0,0,0,0,3\n"),
    )
    .expect("a file");
    refused(
        &["--in", &at("c.csv"), "--out", &at("o")],
        &["id 8", "elbow is NULL", "--lenient"],
    );
    let lenient = ["--in", &at("c.csv"), "--out", &at("lenient"), "--lenient"];
    let (code, text) = said(tool("run").args(lenient));
    assert!(
        code == 0 && text.contains("3 rows in 1 part(s), 0 kept from before, 2 bad"),
        "{text}"
    );
    refused(
        &[
            "--in",
            &at("c.csv"),
            "--out",
            &at("o"),
            "--sql",
            "SELECT clearnce(turn) FROM configs",
        ],
        &["clearnce"],
    );
}

#[test]
fn selected_columns_are_added_part_by_part() {
    let folder = scratch("select");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    assert_eq!(said(tool("sample").args(["--rows", "900", "--out", &at("q")])).0, 0);
    let point = "make_array(turn, lift, elbow, roll, bend, twist)";
    let columns = format!("signed_distance('table', turn, lift, elbow) AS d, certify_curve({point}, {point}) AS v");
    let run = |columns: &str| {
        let arguments = [
            "--in",
            &at("q"),
            "--out",
            &at("out"),
            "--rows-per-part",
            "400",
            "--select",
            columns,
        ];
        said(tool("run").args(arguments))
    };
    let (code, text) = run(&columns);
    assert!(
        code == 0 && text.contains("900 rows in 3 part(s), 0 kept from before;"),
        "{text}"
    );
    let part = |k: usize| std::fs::read(folder.join(format!("out/part-0000{k}.parquet"))).expect("a part");
    let before: Vec<_> = (0..3).map(part).collect();
    std::fs::remove_file(at("out/part-00001.parquet")).expect("a part");
    let (code, text) = run(&columns);
    assert!(
        code == 0 && text.contains("900 rows in 3 part(s), 2 kept from before;"),
        "{text}"
    );
    assert!((0..3).map(part).collect::<Vec<_>>() == before);
    let (code, text) = run("certify_curve(make_array(0.0)) AS v");
    assert!(code == 3 && text.contains("another query"), "{text}");
}
