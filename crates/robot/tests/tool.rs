//! The tool: exit codes, files in and out, errors that name file, line and field.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

/// Runs a command on the example with further arguments.
fn run(command: &str, arguments: &[&str]) -> (i32, String) {
    run_of("gripper.urdf", command, arguments)
}

/// Runs a command on a robot with further arguments.
fn run_of(robot: &str, command: &str, arguments: &[&str]) -> (i32, String) {
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny-robot"));
    tool.current_dir(examples()).arg(command).arg(robot).args(arguments);
    let Output { status, stdout, stderr } = tool.output().expect("the tool runs");
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (status.code().expect("an exit code"), text)
}

/// A file in the folder of this test run.
fn scratch(name: &str, text: &str) -> String {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&file, text).expect("a file");
    file.to_string_lossy().into_owned()
}

const CELL: [&str; 4] = ["--srdf", "gripper.srdf", "--cell", "cell.json"];
const HEAD: &str = "turn,lift,elbow,roll,bend,twist,left\n";

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    CELL.iter().chain(more).copied().collect()
}

#[test]
fn clearances_of_rows() {
    let out = scratch("clearance.csv", "");
    for geometry in ["hull", "mesh"] {
        let (code, text) = run(
            "clearance",
            &with(&["--joints", "carry.csv", "--csv", &out, "--geometry", geometry]),
        );
        assert_eq!(code, 0, "{text}");
        let table = std::fs::read_to_string(&out).expect("the table");
        let rows: Vec<&str> = table.lines().collect();
        assert_eq!(rows.len(), 5);
        assert!(
            rows[0].starts_with("line,time,distance,lower,upper,a,b") && rows[1].starts_with("3,0,0.0"),
            "{table}"
        );
    }
    let down = scratch("down.csv", &format!("{HEAD}0,0.9,1.3,0,0.8,0,0.01\n"));
    let (code, text) = run("clearance", &with(&["--joints", &down]));
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("1 in contact"), "{text}");
}

#[test]
fn rows_are_recorded_for_the_viewer() {
    let out = scratch("carry.jsonl", "");
    let (code, text) = run("clearance", &with(&["--joints", "carry.csv", "--record", &out]));
    assert_eq!(code, 0, "{text}");
    let file = std::io::BufReader::new(std::fs::File::open(&out).expect("the recording"));
    let film = lin_canny_record::Recording::read(file).expect("a recording");
    assert_eq!(film.frames.len(), 4);
    assert!(film.bodies.iter().any(|b| b.name == "fence"), "{:?}", film.bodies);
    for frame in &film.frames {
        let [pair] = &frame.pairs[..] else {
            panic!("{} pairs", frame.pairs.len())
        };
        let outcome = pair.outcome.as_ref().expect("an answer");
        assert!(outcome.lower > 0.0);
        let told: f64 = frame
            .note
            .split(' ')
            .nth(2)
            .and_then(|x| x.parse().ok())
            .expect("a distance");
        assert!((told - outcome.distance).abs() < 1e-12, "{}", frame.note);
    }
    // The arm moves, the cell does not.
    let moved: Vec<_> = film.frames[1]
        .poses
        .iter()
        .map(|(k, _)| &film.bodies[*k as usize].name)
        .collect();
    assert!(
        !moved.is_empty() && moved.iter().all(|name| *name != "fence"),
        "{moved:?}"
    );

    let nowhere = scratch("file", "");
    let (code, text) = run(
        "clearance",
        &with(&["--joints", "carry.csv", "--record", &(nowhere + "/x")]),
    );
    assert_eq!(code, 3, "{text}");
    assert!(text.contains("cannot be written"), "{text}");
}

#[test]
fn motions_are_proven_or_blocked() {
    let (code, text) = run("certify", &with(&["--joints", "carry.csv", "--margin", "0.01"]));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("3 of 3 segments"), "{text}");
    let through = scratch(
        "through.csv",
        &format!("{HEAD}0.6,0.9,1.3,0,0.8,0,0.01\n-0.6,0.9,1.3,0,0.8,0,0.01\n"),
    );
    let out = scratch("certify.csv", "");
    let (code, text) = run("certify", &with(&["--joints", &through, "--csv", &out]));
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("fence") && text.contains("lines 2 to 3"), "{text}");
    assert!(
        std::fs::read_to_string(&out)
            .expect("the table")
            .contains("2,3,blocked,")
    );
    // Around the fence.
    let (path, film) = (scratch("path.csv", ""), scratch("path.jsonl", ""));
    let (code, text) = run(
        "plan",
        &with(&["--joints", &through, "--csv", &path, "--record", &film]),
    );
    assert_eq!(code, 0, "{text}");
    let file = std::io::BufReader::new(std::fs::File::open(&film).expect("the recording"));
    let film = lin_canny_record::Recording::read(file).expect("a recording");
    let rows = std::fs::read_to_string(&path).expect("the path").lines().count() - 1;
    assert_eq!(film.frames.len(), 32 * (rows - 1) + 1);
    let apart = |frame: &lin_canny_record::Frame| frame.pairs[0].outcome.as_ref().is_some_and(|o| o.lower > 0.0);
    assert!(film.frames.iter().all(apart));
    let (code, text) = run("certify", &with(&["--joints", &path]));
    assert_eq!(code, 0, "{text}");
    // Walls and a lid leave a way that no straight segment takes.
    let wall = |name: &str, size: [f64; 3], at: [f64; 3]| {
        format!("{{\"name\": \"{name}\", \"box\": {{\"size\": {size:?}}}, \"xyz\": {at:?}}}")
    };
    let walls = [
        wall("front", [2.0, 0.02, 4.0], [1.15, 0.0, 2.0]),
        wall("back", [2.0, 0.02, 4.0], [-1.15, 0.0, 2.0]),
        wall("lid", [0.4, 0.02, 2.0], [0.0, 0.0, 1.9]),
    ];
    let cell = scratch("walls.json", &format!("{{\"bodies\": [{}]}}", walls.join(", ")));
    let arguments = [
        "--srdf",
        "gripper.srdf",
        "--joints",
        &through,
        "--cell",
        &cell,
        "--seconds",
        "0",
    ];
    let (code, text) = run("plan", &arguments);
    assert_eq!(code, 5, "{text}");
}

#[test]
fn ignorable_pairs_are_an_srdf_of_the_robot() {
    let out = scratch("found.srdf", "");
    let (code, text) = run("ignorable", &["--samples", "50", "--out", &out]);
    assert_eq!(code, 0, "{text}");
    let (code, text) = run("clearance", &["--joints", "carry.csv", "--srdf", &out]);
    assert_eq!(code, 0, "{text}");
}

#[test]
fn meshes_with_turned_triangles_are_named() {
    scratch(
        "turned.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 4 2\nf 2 3 4\nf 3 1 4\n",
    );
    let robot = scratch(
        "turned.urdf",
        "<robot name='r'><link name='base'><collision><geometry><mesh filename='turned.obj'/></geometry></collision></link>
        <link name='tip'><collision><origin xyz='5 0 0'/><geometry><sphere radius='1'/></geometry></collision></link>
        <joint name='j' type='revolute'><parent link='base'/><child link='tip'/><axis xyz='0 0 1'/>
        <limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>",
    );
    let rows = scratch("turned.csv", "j\n0\n0.5\n");
    let arguments = ["--joints", &rows, "--check-adjacent", "--geometry"];
    let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &["mesh"]].concat());
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("turned.obj of link base has no inside"), "{text}");
    let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &["hull"]].concat());
    assert!(code == 0 && !text.contains("warning"), "{text}");
}

#[test]
fn what_is_wrong_is_named() {
    let named = |command: &str, arguments: &[&str], code: i32, words: &[&str]| {
        let (found, text) = run(command, arguments);
        assert_eq!(found, code, "{text}");
        for word in words {
            assert!(text.contains(word), "{text} does not name {word}");
        }
    };
    named("clearance", &[], 2, &["--joints"]);
    named(
        "clearance",
        &["--joints", "nowhere.csv"],
        3,
        &["nowhere.csv", "cannot be read"],
    );
    let file = scratch("word.csv", &format!("{HEAD}0,0,0,0,0,0,0\n0,0,x,0,0,0,0\n"));
    named(
        "clearance",
        &["--joints", &file],
        3,
        &["word.csv:3", "\"elbow\"", "\"x\""],
    );
    let file = scratch("limit.csv", &format!("{HEAD}0,7,0,0,0,0,0\n"));
    named(
        "clearance",
        &["--joints", &file],
        3,
        &["limit.csv:2", "lift", "7", "1.8"],
    );
    let file = scratch("short.csv", &format!("{HEAD}0,0,0\n"));
    named("clearance", &["--joints", &file], 3, &["short.csv:2"]);
    let file = scratch("missing.csv", "turn,lift\n0,0\n");
    named("clearance", &["--joints", &file], 3, &["missing.csv:1", "\"elbow\""]);
    let file = scratch("unknown.csv", &format!("right,{HEAD}"));
    named("clearance", &["--joints", &file], 3, &["unknown.csv:1", "\"right\""]);
    let file = scratch("back.csv", &format!("time,{HEAD}1,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,0\n"));
    named("clearance", &["--joints", &file], 3, &["back.csv:3", "time"]);
    let file = scratch(
        "cell.json",
        "{\"bodies\": [\n{\"name\": \"x\", \"box\": {\"size\": [1, 1]}}]}",
    );
    named(
        "clearance",
        &["--joints", "carry.csv", "--cell", &file],
        3,
        &["cell.json:2", "length"],
    );
    let file = scratch(
        "size.json",
        "{\"bodies\": [{\"name\": \"x\", \"sphere\": {\"radius\": -1}}]}",
    );
    named(
        "clearance",
        &["--joints", "carry.csv", "--cell", &file],
        3,
        &["size.json", "bodies[0]", "radius", "-1"],
    );
    let file = scratch("pair.json", "{\"bodies\": [], \"ignore\": [[\"base\", \"tabel\"]]}");
    named("clearance", &["--joints", "carry.csv", "--cell", &file], 3, &["tabel"]);
    named(
        "clearance",
        &["--joints", "carry.csv", "--link", "hnad=mesh"],
        3,
        &["hnad"],
    );
    named("certify", &["--joints", "carry.csv", "--margin", "-1"], 3, &["margin"]);
}

#[test]
fn a_goal_in_contact_is_no_refused_file() {
    let rows = scratch(
        "goal_down.csv",
        &format!("{HEAD}0,0.3,0.6,0,0.8,0,0.01\n0,0.9,1.3,0,0.8,0,0.01\n"),
    );
    let (code, text) = run("plan", &with(&["--joints", &rows]));
    assert!(code == 1 && text.contains("at the goal"), "{code}: {text}");
}

#[test]
fn bodies_within_the_margin_are_not_said_to_meet() {
    let (code, text) = run("certify", &with(&["--joints", "carry.csv", "--margin", "0.2"]));
    assert_eq!(code, 1, "{text}");
    assert!(
        text.contains("come within the margin of 0.2 at") && !text.contains(" meet at"),
        "{text}"
    );
}

#[test]
fn an_srdf_that_names_a_link_the_robot_does_not_have_is_a_warning() {
    let text = std::fs::read_to_string(examples().join("gripper.srdf")).expect("the example");
    let more = "<disable_collisions link1=\"base\" link2=\"gone\" reason=\"Never\"/>\n</robot>";
    let file = scratch("family.srdf", &text.replace("</robot>", more));
    let (code, text) = run("clearance", &["--joints", "carry.csv", "--srdf", &file]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("warning: ") && text.contains("family.srdf:6: "), "{text}");
    assert!(text.contains("link \"gone\" does not exist"), "{text}");
    // A link of many pairs is one warning.
    let other = "<disable_collisions link1=\"gone\" link2=\"lift\"/>";
    let file = scratch(
        "family.srdf",
        &format!("<robot name=\"r\">\n{}\n{other}\n</robot>", [other; 40].join("\n")),
    );
    let (_, text) = run("clearance", &["--joints", "carry.csv", "--srdf", &file]);
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert_eq!(lines.len(), 2, "{text}");
    assert!(
        lines[0].contains("family.srdf:2: ") && lines[0].contains("gone"),
        "{text}"
    );
    assert!(
        lines[0].ends_with("(and 40 more)") && lines[1].contains("\"lift\" does not exist"),
        "{text}"
    );
}

#[test]
fn missing_meshes_are_errors_or_warnings() {
    let link = |name: &str, file: &str| {
        let shape = format!("<geometry>\n<mesh filename='{file}'/></geometry>");
        format!("<link name='{name}'><collision>{shape}</collision></link>")
    };
    let joint = "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>";
    let text = format!(
        "<robot name='r'>{}{}{joint}</robot>",
        link("a", "gone a.obj"),
        link("b", "gone b.obj")
    );
    let robot = scratch("gone.urdf", &text);
    let rows = scratch("gone.csv", "j\n0\n");
    let (code, text) = run_of(&robot, "clearance", &["--joints", &rows]);
    assert_eq!(code, 3, "{text}");
    assert!(
        text.contains("gone.urdf:2: ") && text.contains("gone a.obj is missing"),
        "{text}"
    );
    let (code, text) = run_of(&robot, "clearance", &["--joints", &rows, "--skip-missing-meshes"]);
    assert_eq!(code, 0, "{text}");
    assert_eq!(text.matches("warning: ").count(), 2, "{text}");
    for words in [
        "gone.urdf:2: link \"a\"",
        "gone a.obj is missing",
        "gone.urdf:3: link \"b\"",
        "gone b.obj is missing",
    ] {
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn a_pointer_or_an_empty_file_is_named() {
    for (text, words) in [
        ("", "is empty"),
        ("version https://git-lfs.github.com/spec/v1\n", "git lfs pull"),
    ] {
        let file = scratch("pointer", text);
        for (robot, option) in [
            (&*file, None),
            ("gripper.urdf", Some("--srdf")),
            ("gripper.urdf", Some("--cell")),
        ] {
            let mut arguments = vec!["--joints", "carry.csv"];
            arguments.extend(option.into_iter().flat_map(|option| [option, &*file]));
            let (code, told) = run_of(robot, "clearance", &arguments);
            assert!(
                code == 3 && told.contains("pointer:1: ") && told.contains(words),
                "{told}"
            );
        }
    }
}
