//! The tool: exit codes, files in and out, errors that name file, line and field.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../robot/examples")
}

/// Runs a command on the example with further arguments.
fn run(command: &str, arguments: &[&str]) -> (i32, String) {
    run_of("gripper.urdf", command, arguments)
}

/// Runs a command on a robot with further arguments.
fn run_of(robot: &str, command: &str, arguments: &[&str]) -> (i32, String) {
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
    tool.current_dir(examples()).arg(command).arg(robot).args(arguments);
    let Output { status, stdout, stderr } = tool.output().expect("the tool runs");
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (status.code().expect("an exit code"), text)
}

/// A file in the folder of this test: tests run at once, each in a thread that has its name.
fn scratch(name: &str, text: &str) -> String {
    let thread = std::thread::current();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(thread.name().unwrap_or("tool"));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join(name);
    std::fs::write(&file, text).expect("a file");
    file.to_string_lossy().into_owned()
}

const CELL: [&str; 4] = ["--srdf", "gripper.srdf", "--cell", "cell.json"];
const HEAD: &str = "turn,lift,elbow,roll,bend,twist,left\n";

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    CELL.iter().chain(more).copied().collect()
}

#[test]
fn bodies_float_as_far_as_the_option_says() {
    let names = "arm::shoulder,arm::elbow,arm::left_slide,part::block/x,part::block/y,part::block/z,part::block/roll,part::block/pitch,part::block/yaw";
    let row = scratch("far.csv", &format!("{names}\n0,0,0,20,0,0,0,0,0\n"));
    let (code, text) = run_of("bench.sdf", "clearance", &["--joints", &row]);
    assert!(code != 0 && text.contains("limits -10 and 10"), "{text}");
    let (code, text) = run_of("bench.sdf", "clearance", &["--joints", &row, "--floating", "20"]);
    assert_eq!(code, 0, "{text}");
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
            rows[0].starts_with("line,time,distance,lower,upper,excess,a,b") && rows[1].starts_with("3,0,0.0"),
            "{table}"
        );
    }
    let down = scratch("down.csv", &format!("{HEAD}0,0.9,1.3,0,0.8,0,0.01\n"));
    let (code, text) = run("clearance", &with(&["--joints", &down]));
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("1 in contact"), "{text}");
}

#[test]
fn rows_are_recorded_and_played_by_a_page() {
    let (out, page) = (scratch("carry.jsonl", ""), scratch("carry.html", ""));
    let arguments = ["--joints", "carry.csv", "--record", &out, "--page", &page];
    let (code, text) = run("clearance", &with(&arguments));
    assert_eq!(code, 0, "{text}");
    // The page alone is the same page, and the page of the recording.
    let html = std::fs::read_to_string(&page).expect("the page");
    let (code, text) = run("clearance", &with(&["--joints", "carry.csv", "--page", &page]));
    assert_eq!(code, 0, "{text}");
    assert_eq!(std::fs::read_to_string(&page).expect("the page"), html);
    let played = lin_canny_record::Recording::open(&out).expect("a recording");
    let options = lin_canny_record::PageOptions::default();
    assert_eq!(lin_canny_record::page(&played, &options), html);
    for command in ["certify", "plan"] {
        let page = scratch("moved.html", "");
        let (code, text) = run(command, &with(&["--joints", "carry.csv", "--page", &page]));
        assert_eq!(code, 0, "{command}: {text}");
        let html = std::fs::read_to_string(&page).expect("the page");
        assert!(
            html.contains("\"name\":\"fence\"") && html.ends_with("</html>\n"),
            "{command}"
        );
    }
    let (code, text) = run(
        "clearance",
        &with(&["--joints", "carry.csv", "--along", "--page", &page]),
    );
    assert!(code == 2 && text.contains("--page"), "{text}");
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
    let nowhere = scratch("file", "") + "/x";
    let (code, text) = run("clearance", &with(&["--joints", "carry.csv", "--page", &nowhere]));
    assert_eq!(code, 3, "{text}");
    assert!(text.contains("cannot be written"), "{text}");
}

/// Checks a receipt with further arguments.
fn verified(receipt: &str, arguments: &[&str]) -> (i32, String) {
    run_of(receipt, "verify", arguments)
}

#[test]
fn receipts_of_motions_are_verified() {
    let (proof, scene) = (scratch("proof.jsonl", ""), scratch("scene.jsonl", ""));
    let rows = ["--joints", "carry.csv", "--margin", "0.01"];
    let outputs = ["--receipt", &proof, "--scene", &scene];
    let (code, text) = run("certify", &with(&[rows, outputs].concat()));
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains("proof.jsonl: ") && text.contains(" pieces of evidence"),
        "{text}"
    );
    let (code, text) = verified(&proof, &[]);
    assert_eq!(code, 0, "{text}");
    for part in ["of each of 3 legs", "gripper.urdf", "cell.json", "excluded: Adjacent"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let (code, text) = verified(&proof, &["--on", &scene]);
    assert_eq!(code, 0, "{text}");
    // The post moves into the arm: the proof is stale, and names a line.
    let cell = std::fs::read_to_string(examples().join("cell.json")).expect("the cell");
    let moved = scratch(
        "moved.json",
        &cell.replacen("\"xyz\": [0.2, 0.68, 0.45]", "\"xyz\": [0.2, 0, 0.45]", 1),
    );
    assert_ne!(std::fs::read_to_string(&moved).expect("a cell"), cell);
    let other = ["--srdf", "gripper.srdf", "--cell", &moved, "--scene", &scene];
    let (code, text) = run("certify", &[&other[..], &rows[..]].concat());
    assert_eq!(code, 1, "{text}");
    let (code, text) = verified(&proof, &["--on", &scene]);
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("stale") && text.contains("post"), "{text}");

    let text = std::fs::read_to_string(&proof).expect("a receipt");
    let (code, said) = verified(
        &scratch("changed.jsonl", &text.replacen("\"fence\"", "\"bench\"", 1)),
        &[],
    );
    assert_eq!(code, 1, "{said}");
    let (code, said) = verified(&scratch("cut.jsonl", &text[..text.len() / 2]), &[]);
    assert_eq!(code, 3, "{said}");
    assert_eq!(verified("nowhere.jsonl", &[]).0, 3);
    // Motions with velocities are curves.
    let head = "time,lift,turn,lift.velocity,turn.velocity";
    let rows = "0,0.6,0.6,0,0\n1,0.4,0.62,-0.2,0\n2,0.3,0.6,0,0\n";
    let curved = scratch("curved.csv", &format!("{head}\n{rows}"));
    let others = scratch("curved-others.csv", "elbow,roll,bend,twist,left\n1.2,0,0.8,0,0.01\n");
    let given = ["--trajectory", &curved, "--rest", &others];
    let (code, text) = run("certify", &with(&[&given[..], &outputs].concat()));
    assert_eq!(code, 0, "{text}");
    let (code, text) = verified(&proof, &["--on", &scene]);
    assert!(code == 0 && text.contains("of each of 2 legs"), "{text}");
    // Tubes have none.
    let (code, text) = run(
        "certify",
        &with(&["--trajectory", "carry.csv", "--tube", "elbow=0.01", "--receipt", &proof]),
    );
    assert_eq!(code, 2, "{text}");
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
    let (out, proof) = (scratch("certify.csv", ""), scratch("blocked.jsonl", ""));
    let arguments = ["--joints", &through, "--csv", &out, "--receipt", &proof];
    let (code, text) = run("certify", &with(&arguments));
    assert_eq!(code, 1, "{text}");
    let (code, said) = verified(&proof, &[]);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("and fence at t = ") && said.contains("share a point"),
        "{said}"
    );
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
    for method in ["rrt-connect", "opportunistic"] {
        let search = ["--joints", &through, "--csv", &path, "--method", method];
        let (code, text) = run("plan", &with(&search));
        assert_eq!(code, 0, "{method}: {text}");
        let (code, text) = run("certify", &with(&["--joints", &path]));
        assert_eq!(code, 0, "{method}: {text}");
    }
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
fn excludable_pairs_are_an_srdf_of_the_robot() {
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
        &["cell.json:2", "expected 3"],
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
    named("certify", &["--joints", "carry.csv", "--margin", "-1"], 2, &["margin"]);
}

/// A swing: spheres of radius 0.1 at (0.5, 0, 0) and (1, 0, 0) that rotate about a sphere of radius
/// 0.1 at the origin.
fn swing(joint: &str) -> String {
    let ball =
        |x: f64| format!("<collision><origin xyz='{x} 0 0'/><geometry><sphere radius='0.1'/></geometry></collision>");
    let text = format!(
        "<robot name='r'><link name='hub'>{}</link><link name='arm'>{}{}</link>{joint}</robot>",
        ball(0.0),
        ball(0.5),
        ball(1.0)
    );
    let name = format!("swing_{}.urdf", joint.len());
    scratch(&name, &text)
}

const TURN: &str = "<joint name='turn' type='revolute'><parent link='hub'/><child link='arm'/><axis xyz='0 0 1'/>
    <limit lower='-1.5' upper='1.5' effort='1' velocity='1'/></joint>";
const ENDLESS: &str =
    "<joint name='turn' type='continuous'><parent link='hub'/><child link='arm'/><axis xyz='0 0 1'/></joint>";

/// Two balls of radius 0.2 at (3, 0, 0) and (0, 1.5, 0).
fn balls() -> String {
    let ball =
        |name: &str, at: &str| format!("{{\"name\": \"{name}\", \"sphere\": {{\"radius\": 0.2}}, \"xyz\": {at}}}");
    let bodies = [ball("far ball", "[3, 0, 0]"), ball("side ball", "[0, 1.5, 0]")];
    scratch("balls.json", &format!("{{\"bodies\": [{}]}}", bodies.join(", ")))
}

/// Distance of the far ball from the nearer ball of the arm at an angle.
fn far(q: f64) -> f64 {
    (10.0 - 6.0 * q.cos()).min(9.25 - 3.0 * q.cos()).sqrt() - 0.3
}

/// Distance of the side ball from the nearer ball of the arm at an angle.
fn side(q: f64) -> f64 {
    (3.25 - 3.0 * q.sin()).min(2.5 - 1.5 * q.sin()).sqrt() - 0.3
}

/// The rows of a table, each by the names of its columns.
fn table(file: &str) -> Vec<std::collections::HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(file).expect("the table");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number")
}

#[test]
fn the_robot_is_measured_against_the_cell_or_itself() {
    let (robot, cell) = (swing(TURN), balls());
    let (rows, out) = (
        scratch("against.csv", "turn\n0\n0.4\n-1.5\n"),
        scratch("against_out.csv", ""),
    );
    let measure = |against: &str| {
        let arguments = ["--cell", &cell, "--joints", &rows, "--csv", &out, "--check-adjacent"];
        let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &["--against", against]].concat());
        assert_eq!(code, 0, "{text}");
        (table(&out), text)
    };
    // The arm keeps its distance of 0.3 from the hub: the least of all.
    for against in ["all", "self"] {
        let (found, text) = measure(against);
        for row in found {
            assert!((number(&row["distance"]) - 0.3).abs() < 1e-12, "{row:?}");
            assert_eq!([&row["a"], &row["b"]], ["hub", "arm"]);
        }
        assert!(text.contains("least clearance 0.30000 +- "), "{text}");
    }
    let (found, _) = measure("cell");
    for (row, q) in found.iter().zip([0.0, 0.4, -1.5]) {
        // Of the hub, of the balls of the arm.
        let least = far(q).min(side(q)).min(1.2);
        let [lower, upper] = ["lower", "upper"].map(|name| number(&row[name]));
        assert!(
            lower <= least + 1e-15 && least - 1e-15 <= upper && upper - lower < 1e-12,
            "{row:?}"
        );
    }
    assert_eq!([&found[1]["a"], &found[1]["b"]], ["arm", "side ball"]);
    // Nothing would be checked.
    let (code, text) = run_of(&robot, "clearance", &["--joints", &rows, "--against", "cell"]);
    assert!(code == 2 && text.contains("--cell"), "{text}");
}

#[test]
fn pairs_have_columns() {
    let (robot, cell) = (swing(TURN), balls());
    let (rows, out) = (
        scratch("pairs.csv", "turn\n0\n0.4\n-1.5\n"),
        scratch("pairs_out.csv", ""),
    );
    let arguments = [
        "--cell",
        &cell,
        "--joints",
        &rows,
        "--csv",
        &out,
        "--pairs",
        "--check-adjacent",
    ];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert_eq!(code, 0, "{text}");
    let head = std::fs::read_to_string(&out).expect("the table");
    let titles = "hub - arm,hub - far ball,hub - side ball,arm - far ball,arm - side ball";
    assert!(
        head.lines()
            .next()
            .is_some_and(|line| line.ends_with(&format!(",b_z,{titles}"))),
        "{head}"
    );
    for (row, q) in table(&out).iter().zip([0.0f64, 0.4, -1.5]) {
        for (name, distance) in [
            ("hub - arm", 0.3),
            ("hub - far ball", 2.7),
            ("hub - side ball", 1.2),
            ("arm - far ball", far(q)),
            ("arm - side ball", side(q)),
        ] {
            assert!((number(&row[name]) - distance).abs() < 1e-12, "{name}: {row:?}");
        }
    }
    let (code, text) = run_of(&robot, "clearance", &["--joints", &rows, "--pairs"]);
    assert!(code == 2 && text.contains("--csv"), "{text}");
}

#[test]
fn the_least_clearance_along_a_motion_is_enclosed() {
    let (robot, cell) = (swing(TURN), balls());
    let rows = scratch("along.csv", "turn,time\n-1,0\n0.5,2\n0.25,3\n");
    let out = scratch("along_out.csv", "");
    let arguments = [
        "--cell",
        &cell,
        "--joints",
        &rows,
        "--csv",
        &out,
        "--along",
        "--check-adjacent",
        "--against",
    ];
    let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &["cell"]].concat());
    assert_eq!(code, 0, "{text}");
    let found = table(&out);
    // The side ball is closest at the greatest angle.
    for (row, ([from, to], t, time)) in found.iter().zip([(["2", "3"], 1.0, 2.0), (["3", "4"], 0.0, 2.0)]) {
        assert_eq!(
            [&*row["from_line"], &*row["to_line"], &*row["verdict"]],
            [from, to, "free"]
        );
        let [lower, upper] = ["lower", "upper"].map(|name| number(&row[name]));
        let least = side(0.5);
        assert!(
            lower <= least && least <= upper + 1e-15 && upper - lower < 2e-3 * least,
            "{row:?}"
        );
        assert!(
            (number(&row["t"]) - t).abs() < 1e-2 && (number(&row["time"]) - time).abs() < 2e-2,
            "{row:?}"
        );
        assert_eq!([&row["a"], &row["b"]], ["arm", "side ball"]);
    }
    assert!(
        text.contains("lines 2 to 3: least clearance 1.03") && text.contains("time 2.000000: arm"),
        "{text}"
    );
    assert!(
        text.contains("0 of 2 segments in contact; least clearance 1.03"),
        "{text}"
    );
    let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &["self"]].concat());
    assert!(code == 0 && text.contains("hub - arm"), "{text}");
    let least = number(&table(&out)[0]["lower"]);
    assert!((0.2995..=0.3).contains(&least), "{least}");

    // Least between the rows: the arm passes the far ball at angle 0, where no row is.
    let cell = scratch(
        "near.json",
        "{\"bodies\": [{\"name\": \"near\", \"sphere\": {\"radius\": 0.2}, \"xyz\": [1.301, 0, 0]}]}",
    );
    let rows = scratch("past.csv", "turn\n-1\n1.4\n");
    let arguments = ["--cell", &cell, "--joints", &rows, "--csv", &out, "--along"];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert_eq!(code, 0, "{text}");
    let row = &table(&out)[0];
    let [lower, upper, t] = ["lower", "upper", "t"].map(|name| number(&row[name]));
    assert!(
        lower > 0.0 && lower <= 0.001 && upper >= 0.001 && upper - lower < 0.1 * upper,
        "{row:?}"
    );
    assert!((t - 1.0 / 2.4).abs() < 1e-2, "{row:?}");

    // The arm meets the ball at the angle at which the centres are 0.3 apart.
    let cell = scratch(
        "ahead.json",
        "{\"bodies\": [{\"name\": \"ahead\", \"sphere\": {\"radius\": 0.2}, \"xyz\": [1.2, 0, 0]}]}",
    );
    let arguments = ["--cell", &cell, "--joints", &rows, "--csv", &out, "--along"];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert_eq!(code, 1, "{text}");
    let row = &table(&out)[0];
    let angle = ((1.0 + 1.44 - 0.09) / 2.4f64).acos();
    assert!((number(&row["t"]) - (1.0 - angle) / 2.4).abs() < 1e-5, "{row:?}");
    assert_eq!([&*row["verdict"], &*row["lower"], &*row["upper"]], ["blocked", "", "0"]);
    assert!(
        text.contains("1 of 1 segments in contact") && text.contains("first contact at 0.33"),
        "{text}"
    );

    // The arm touches the ball between the rows.
    let cell = scratch(
        "touch.json",
        "{\"bodies\": [{\"name\": \"touched\", \"sphere\": {\"radius\": 0.2}, \"xyz\": [1.3, 0, 0]}]}",
    );
    let arguments = ["--cell", &cell, "--joints", &rows, "--csv", &out, "--along"];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert_eq!(code, 4, "{text}");
    let row = &table(&out)[0];
    assert_eq!(
        [&*row["verdict"], &*row["lower"], &*row["b"]],
        ["undecided", "", "touched"]
    );
    assert!(text.contains("undecided, at most "), "{text}");

    let rows = scratch("one.csv", "turn\n0\n");
    let (code, text) = run_of(&robot, "clearance", &["--joints", &rows, "--along"]);
    assert!(
        code == 3 && text.contains("one.csv: too few rows: 1 (expected at least 2)"),
        "{text}"
    );
}

#[test]
fn joints_without_a_column_have_a_value_in_another_file() {
    let out = scratch("rest_out.csv", "");
    let few = scratch("few.csv", "elbow,turn\n1.2,0.6\n1.2,0.5\n");
    let all = scratch(
        "all.csv",
        &format!("{HEAD}0.6,0.6,1.2,0,0.8,0,0.01\n0.5,0.6,1.2,0,0.8,0,0.01\n"),
    );
    // A column of the rows comes before the same column of the rest.
    let rest = scratch("rest.csv", &format!("{HEAD}0,0.6,0,0,0.8,0,0.01\n"));
    let distances = |arguments: &[&str]| {
        let (code, text) = run("clearance", &with(&[&["--csv", &out], arguments].concat()));
        assert_eq!(code, 0, "{text}");
        std::fs::read_to_string(&out).expect("the table")
    };
    let (ours, theirs) = (
        distances(&["--joints", &few, "--rest", &rest]),
        distances(&["--joints", &all]),
    );
    assert_eq!(ours, theirs);
    for command in ["certify", "plan"] {
        let (code, text) = run(command, &with(&["--joints", &few, "--rest", &rest]));
        assert_eq!(code, 0, "{text}");
    }
    let named = |arguments: &[&str], words: &[&str]| {
        let (code, text) = run("clearance", arguments);
        assert_eq!(code, 3, "{text}");
        for word in words {
            assert!(text.contains(word), "{text} does not name {word}");
        }
    };
    let words = ["few.csv:1: column \"lift\" (first of 5) is missing; see --rest and --state"];
    named(&["--joints", &few], &words);
    let part = scratch("part.csv", "lift,roll,bend,twist\n0.6,0,0.8,0\n");
    named(
        &["--joints", &few, "--rest", &part],
        &["few.csv:1: column \"left\" is missing; see --rest and --state"],
    );
    let two = scratch("two.csv", &format!("{HEAD}0,0,0,0,0,0,0\n0,0,0,0,0,0,0\n"));
    named(
        &["--joints", &few, "--rest", &two],
        &["two.csv: too many rows: 2 (expected 1)"],
    );
    let odd = scratch("odd.csv", "lift,roll,bend,twist,left,tail\n0.6,0,0.8,0,0,0\n");
    named(
        &["--joints", &few, "--rest", &odd],
        &["odd.csv:1", "\"tail\" does not exist"],
    );
    let wild = scratch("wild.csv", "lift,roll,bend,twist,left\n9,0,0.8,0,0\n");
    named(
        &["--joints", &few, "--rest", &wild],
        &["wild.csv:2", "lift", "9.0; see --limit-slack"],
    );
}

#[test]
fn joints_without_a_column_have_the_values_of_a_state() {
    let out = scratch("state_out.csv", "");
    let few = scratch("state.csv", "elbow,turn\n1.2,0.6\n1.2,0.5\n");
    let joint = |(name, value): (&str, f64)| format!("<joint name=\"{name}\" value=\"{value}\"/>");
    let state = |group: &str, name: &str, values: &[(&str, f64)]| {
        let joints: String = values.iter().copied().map(joint).collect();
        format!("<group_state name=\"{name}\" group=\"{group}\">{joints}</group_state>\n")
    };
    let states = [
        state("arm", "home", &[("lift", 0.6), ("roll", 0.0), ("elbow", -1.0)]),
        state(
            "hand",
            "home",
            &[("bend", 0.8), ("twist", 0.0), ("left", 0.01), ("right", 0.01)],
        ),
        state("arm", "low", &[("lift", 0.9), ("roll", 0.5), ("bend", 0.1)]),
        state("arm", "wild", &[("lift", 9.0)]),
        state("arm", "far", &[("lift", 0.6), ("rol", 0.0)]),
    ];
    let text = std::fs::read_to_string(examples().join("gripper.srdf")).expect("the example");
    let groups = "<group name=\"hand\"/>";
    let srdf = scratch(
        "states.srdf",
        &text.replace("</robot>", &format!("{groups}{}</robot>", states.concat())),
    );
    let measure = |command: &str, arguments: &[&str]| {
        let given = ["--srdf", &srdf, "--cell", "cell.json", "--joints"];
        run(command, &[&given[..], arguments].concat())
    };
    let distances = |arguments: &[&str]| {
        let (code, text) = measure("clearance", &[arguments, &["--csv", &out]].concat());
        assert!(code == 0 || code == 1, "{text}");
        std::fs::read_to_string(&out).expect("the table")
    };
    let all = |name: &str, lift: f64, roll: f64, bend: f64| {
        let row = |turn: f64| format!("{turn},{lift},1.2,{roll},{bend},0,0.01\n");
        distances(&[&scratch(name, &format!("{HEAD}{}{}", row(0.6), row(0.5)))])
    };
    let home = all("state_home.csv", 0.6, 0.0, 0.8);
    let low = all("state_low.csv", 0.9, 0.5, 0.8);
    let (arm, hand) = (["--state", "arm/home"], ["--state", "hand/home"]);
    let both = [arm, hand].concat();
    // The elbow of the state is not the one of the rows.
    assert_eq!(distances(&[&[&*few], &both[..]].concat()), home);
    // The later state wins where both name a joint, and each may come first.
    let first = [&[&*few], &["--state", "low"][..], &both].concat();
    assert_eq!(distances(&first), home);
    let last = [&[&*few], &arm[..], &["--state", "low"], &hand].concat();
    assert_eq!(distances(&last), low);
    // The values of --rest win, wherever the option is.
    let rest = scratch("state_rest.csv", "lift,roll\n0.6,0\n");
    for arguments in [
        [&["--rest", &*rest, "--state", "low"][..], &hand].concat(),
        [&["--state", "low"][..], &hand, &["--rest", &*rest]].concat(),
    ] {
        assert_eq!(distances(&[&[&*few], &arguments[..]].concat()), home);
    }
    for command in ["certify", "plan"] {
        let (code, text) = measure(command, &[&[&*few], &both[..]].concat());
        assert_eq!(code, 0, "{text}");
    }
    let named = |arguments: &[&str], words: &str| {
        let (code, text) = measure("clearance", arguments);
        assert!(code == 3 && text.contains(words), "{text}");
    };
    let part = "state.csv:1: column \"bend\" (first of 3) is missing; see --rest and --state";
    named(&[&few, "--state", "arm/home"], part);
    // A joint that does not exist is a warning if its state is used.
    let warns = |state: &str| measure("clearance", &[&few, "--state", state]).1.contains("warning: ");
    assert!(warns("far") && !warns("low"));
    let unknown =
        "states.srdf:10: group_state \"far\" joint \"rol\": joint \"rol\" does not exist; did you mean \"roll\"?";
    named(&[&few, "--state", "far"], unknown);
    // A fault in the first, the middle or the last of the states.
    for at in 0..3 {
        for (name, words) in [
            (
                "arm/hoem",
                "states.srdf: state \"arm/hoem\" does not exist; did you mean \"arm/home\"?",
            ),
            ("loww", "state \"loww\" does not exist; did you mean \"low\"?"),
            (
                "home",
                "states.srdf: ambiguous state: \"home\" (expected a group, such as \"arm/home\")",
            ),
            ("wild", "state \"wild\": lift (limits "),
            ("wild", "9.0; see --limit-slack, --turns and --floating"),
        ] {
            let mut given = vec![arm, hand];
            given.insert(at, ["--state", name]);
            named(&[&[&*few], &given.concat()[..]].concat(), words);
        }
    }
    let (code, text) = run("clearance", &["--joints", &few, "--state", "home"]);
    assert!(code == 2 && text.contains("--srdf"), "{text}");
}

#[test]
fn limits_are_widened_by_options() {
    let rows = scratch("over.csv", "turn\n-1.5000001\n0\n");
    let robot = swing(TURN);
    let (code, text) = run_of(&robot, "clearance", &["--joints", &rows]);
    assert!(
        code == 3 && text.contains("-1.5000001; see --limit-slack, --turns and --floating"),
        "{text}"
    );
    let out = scratch("over_out.csv", "");
    let cell = balls();
    let slack = ["--cell", &cell, "--limit-slack", "1e-6", "--joints", &rows];
    let (code, text) = run_of(&robot, "clearance", &[&slack[..], &["--pairs", "--csv", &out]].concat());
    assert_eq!(code, 0, "{text}");
    // The row is measured as it is.
    assert!((number(&table(&out)[0]["arm - far ball"]) - far(-1.500_000_1)).abs() < 1e-12);
    for command in ["certify", "plan"] {
        let (code, text) = run_of(&robot, command, &slack);
        assert_eq!(code, 0, "{text}");
    }
    let robot = swing(ENDLESS);
    let rows = scratch("turns.csv", "turn\n0\n18\n");
    let (code, text) = run_of(&robot, "certify", &["--joints", &rows]);
    assert!(
        code == 3 && text.contains("turns.csv:3") && text.contains("--turns"),
        "{text}"
    );
    for (turns, code) in [("2.8", 3), ("2.9", 0)] {
        let (found, text) = run_of(&robot, "certify", &["--joints", &rows, "--turns", turns]);
        assert_eq!(found, code, "{text}");
    }
    for option in ["--turns", "--limit-slack"] {
        let (code, text) = run_of(&robot, "certify", &["--joints", &rows, option, "inf"]);
        assert!(code == 2 && text.contains("expected a finite number"), "{text}");
    }
}

#[test]
fn a_blocked_start_or_goal_has_its_own_code() {
    let rows = scratch(
        "goal_down.csv",
        &format!("{HEAD}0,0.3,0.6,0,0.8,0,0.01\n0,0.9,1.3,0,0.8,0,0.01\n"),
    );
    let (code, text) = run("plan", &with(&["--joints", &rows]));
    assert!(
        code == 6 && text.contains("goal_down.csv:3: ") && text.contains("in contact at the goal"),
        "{code}: {text}"
    );
    let (robot, cell) = (swing(TURN), balls());
    let rows = scratch("start_near.csv", "turn\n0.5\n-1\n");
    let arguments = ["--cell", &cell, "--joints", &rows, "--margin", "1.2"];
    let (code, text) = run_of(&robot, "plan", &arguments);
    assert_eq!(code, 6, "{text}");
    let mut found = text.split(' ').filter_map(|word| word.parse::<f64>().ok());
    let [value, width] = [(); 2].map(|()| found.next().expect("a number"));
    assert!((value - side(0.5)).abs() <= width && width < 1e-4, "{text}");
    let words = "m apart at the start (expected more than 1.2 m (margin))";
    assert!(
        text.contains("start_near.csv:2: arm and side ball are 1.0345 +- ") && text.contains(words),
        "{text}"
    );
}

#[test]
fn bodies_within_the_margin_are_not_said_to_meet() {
    // The centres are 1.4 apart if the sine of the angle is 0.36.
    let (robot, cell) = (swing(TURN), balls());
    let rows = scratch("margin.csv", "turn,time\n-1,0\n0.5,3\n");
    let arguments = ["--cell", &cell, "--joints", &rows, "--margin", "1.1"];
    let (code, text) = run_of(&robot, "certify", &arguments);
    assert_eq!(code, 1, "{text}");
    let t = (0.36f64.asin() + 1.0) / 1.5;
    let mut found = text
        .split([' ', ','])
        .filter_map(|word| word.parse::<f64>().ok())
        .skip(2);
    let [at, time] = [(); 2].map(|()| found.next().expect("a number"));
    assert!((at - t).abs() < 1e-5 && (time - 3.0 * t).abs() < 3e-5, "{text}");
    let words = "lines 2 to 3: arm - side ball come within 1.1 m (margin) at 0.9";
    assert!(text.contains(words) && !text.contains(" meet "), "{text}");
}

/// A padding, a margin and their sum are one rule: rows and motions that do not keep it end with 1, and say
/// where it comes from.
#[test]
fn a_required_distance_is_that_of_rows_and_motions() {
    let (robot, cell) = (swing(TURN), balls());
    let text = std::fs::read_to_string(&cell).expect("the cell");
    let with =
        |name: &str, keys: &str| scratch(name, &text.replacen("{\"bodies\"", &format!("{{{keys}, \"bodies\""), 1));
    let margin = with("margin.json", "\"margin\": 1.05");
    let pair = with("pair.json", "\"margins\": [[\"arm\", \"side ball\", 1.05]]");
    let sum = with("sum.json", "\"margin\": 0.5");
    let (rows, out) = (
        scratch("required.csv", "turn\n-1\n0.5\n"),
        scratch("required_out.csv", ""),
    );
    for (cell, pad, required, origin) in [
        (&cell, None, 0.0, ""),
        (&margin, None, 1.05, "(margin)"),
        (&pair, None, 1.05, "(margin of the pair)"),
        (&cell, Some("side ball=1.05"), 1.05, "(padding of side ball)"),
        (&cell, Some("arm=1.05"), 1.05, "(padding of arm)"),
        (
            &sum,
            Some("side ball=0.55"),
            1.05,
            "(margin 0.5 + padding of side ball 0.55)",
        ),
    ] {
        let mut arguments = vec!["--cell", cell, "--joints", &rows, "--csv", &out];
        arguments.extend(pad.iter().flat_map(|pad| ["--pad", pad]));
        let blocked = i32::from(required > 0.0);
        let (code, text) = run_of(&robot, "clearance", &arguments);
        assert_eq!(code, blocked, "{pad:?}: {text}");
        let found = table(&out);
        let row = found.last().expect("a row");
        let [distance, excess] = ["distance", "excess"].map(|name| number(&row[name]));
        assert!(
            (distance - side(0.5)).abs() < 1e-12 && excess == distance - required,
            "{row:?}"
        );
        assert_eq!([&*row["a"], &*row["b"]], ["arm", "side ball"]);
        let all: Vec<f64> = found.iter().map(|row| number(&row["excess"])).collect();
        let too_close = all.iter().filter(|excess| **excess <= 0.0).count();
        assert_eq!(too_close, blocked as usize, "{all:?}");
        let words = match required {
            0.0 => "2 rows, 0 in contact; least clearance 1.0345 +- ".to_owned(),
            _ => format!("m apart, required 1.05 m {origin}"),
        };
        assert!(text.contains(&words), "{text}");
        assert!(
            required == 0.0 || text.contains("2 rows, 1 closer than required; least excess -0.0155"),
            "{text}"
        );
        // Along the motion.
        let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &["--along"]].concat());
        assert_eq!(code, blocked, "{pad:?}: {text}");
        let row = &table(&out)[0];
        let [upper, excess] = ["upper", "excess"].map(|name| number(&row[name]));
        assert_eq!([&*row["a"], &*row["b"]], ["arm", "side ball"]);
        match required {
            0.0 => assert!(excess == upper && text.contains("0 of 1 segments in contact"), "{text}"),
            _ => {
                assert_eq!(
                    [&*row["verdict"], &*row["upper"], &*row["excess"]],
                    ["blocked", "1.05", "0"]
                );
                let words = format!(": first within 1.05 m {origin} at 0.9");
                assert!(
                    text.contains(&words) && text.contains("1 of 1 segments closer than required"),
                    "{text}"
                );
            }
        }
        // The proof of the motion says the same.
        let (code, text) = run_of(&robot, "certify", &arguments);
        assert_eq!(code, blocked, "{pad:?}: {text}");
        let words = format!("arm - side ball come within 1.05 m {origin} at 0.9");
        assert_eq!(text.contains(&words), required > 0.0, "{text}");
        assert!(!text.contains(" meet "), "{text}");
        // A search whose goal is too close names the same pair and distance.
        let (code, text) = run_of(&robot, "plan", &arguments);
        assert_eq!(code, 6 * blocked, "{pad:?}: {text}");
        let words = format!("apart at the goal (expected more than 1.05 m {origin})");
        assert_eq!(text.contains(&words), required > 0.0, "{text}");
    }
    // A margin of the options replaces that of the cell.
    let arguments = ["--cell", &margin, "--joints", &rows, "--margin", "0"];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert!(code == 0 && text.contains("2 rows, 0 in contact"), "{text}");
    // Below the distance they do not meet: they come within.
    let rows = scratch("meet.csv", "turn\n-1\n1.5\n");
    let near = scratch(
        "near_post.json",
        "{\"bodies\": [{\"name\": \"post\", \"sphere\": {\"radius\": 0.2}, \"xyz\": [1.301, 0, 0]}]}",
    );
    let arguments = ["--cell", &near, "--joints", &rows, "--pad", "post=0.01"];
    let (code, text) = run_of(&robot, "certify", &arguments);
    assert_eq!(code, 1, "{text}");
    assert!(
        text.contains("arm - post come within 0.01 m (padding of post) at "),
        "{text}"
    );
}

/// The padding of a link covers what it carries, unless the object has its own.
#[test]
fn the_padding_of_a_link_covers_an_attached_object() {
    let (robot, cell) = (swing(TURN), balls());
    let tool = scratch(
        "tool.json",
        r#"{"name": "tool", "sphere": {"radius": 0.1}, "xyz": [1.5, 0, 0], "touch_links": ["arm"]}"#,
    );
    let attach = format!("arm={tool}");
    let rows = scratch("carried.csv", "turn\n-0.5\n");
    let run = |more: &[&str]| {
        let arguments = ["--cell", &cell, "--joints", &rows, "--attach", &attach];
        let pairs = ["--against", "cell", "--exclude", "arm,side ball"];
        run_of(&robot, "clearance", &[&arguments[..], &pairs, more].concat())
    };
    let (code, text) = run(&[]);
    assert_eq!(code, 0, "{text}");
    let (code, text) = run(&["--pad", "arm=1.6"]);
    assert!(
        code == 1 && text.contains("tool - far ball") && text.contains("(padding of arm)"),
        "{text}"
    );
    let (code, text) = run(&["--pad", "arm=1.6", "--pad", "tool=0.1"]);
    assert!(code == 0 && text.contains("1 rows, 0 closer than required"), "{text}");
    // A padding of 0 of its own is saved in a cell.
    let saved = scratch("carried.json", "");
    let options = [
        "--cell", &cell, "--attach", &attach, "--pad", "arm=1.6", "--pad", "tool=0", "--out", &saved,
    ];
    let (code, text) = run_of(&robot, "cell", &options);
    assert!(code == 0 && text.contains("paddings: 3"), "{text}");
    let arguments = ["--cell", &saved, "--joints", &rows, "--against", "cell"];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert!(code == 1 && text.contains("arm - side ball"), "{code} {text}");
    let more = ["--exclude", "arm,side ball"];
    let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &more].concat());
    assert_eq!(code, 0, "{text}");
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
    // Balls around a part of a link are no cover of it.
    let (code, said) = run_of(&robot, "cover", &["--skip-missing-meshes"]);
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("gone.urdf: a mesh is missing, and the cover"), "{said}");
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
fn missing_meshes_of_a_cell_are_errors_or_warnings() {
    let text = "{\"bodies\": [
        {\"name\": \"side ball\", \"sphere\": {\"radius\": 0.2}, \"xyz\": [0, 1.5, 0]},
        {\"name\": \"part\", \"mesh\": {\"file\": \"gone part.stl\"}},
        {\"name\": \"side ball\", \"mesh\": {\"file\": \"gone ball.stl\"}}],
        \"ignore\": [[\"hub\", \"part\"], [\"arm\", \"side ball\"]]}";
    let (robot, cell) = (swing(TURN), scratch("gone.json", text));
    let rows = scratch("gone_cell.csv", "turn\n0.5\n");
    let arguments = ["--cell", &cell, "--joints", &rows];
    let (code, text) = run_of(&robot, "clearance", &arguments);
    assert_eq!(code, 3, "{text}");
    assert!(
        text.contains("gone.json: bodies[1] \"part\": file ") && text.contains("gone part.stl is missing"),
        "{text}"
    );
    let out = scratch("gone_out.csv", "");
    let more = ["--skip-missing-meshes", "--csv", &out, "--pairs"];
    let (code, text) = run_of(&robot, "clearance", &[&arguments[..], &more].concat());
    assert_eq!(code, 0, "{text}");
    assert_eq!(text.matches("warning: ").count(), 2, "{text}");
    assert!(
        text.contains("bodies[1] \"part\"") && text.contains("bodies[2] \"side ball\""),
        "{text}"
    );
    // The pairs of the other body of the name are still ignored.
    let head = std::fs::read_to_string(&out).expect("the table");
    assert!(
        head.lines()
            .next()
            .is_some_and(|line| line.ends_with("b_z,hub - side ball")),
        "{head}"
    );
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

/// An attached object is measured, and names and numbers that are wrong are named.
#[test]
fn attached_objects_are_measured_and_wrong_names_are_named() {
    let part = scratch(
        "part.json",
        r#"{"name": "part", "sphere": {"radius": 0.02}, "xyz": [0, 0, 3.0], "touch_links": ["gripper"]}"#,
    );
    let (attach, out) = (format!("gripper={part}"), scratch("attached.csv", ""));
    let (code, text) = run(
        "clearance",
        &with(&["--joints", "carry.csv", "--attach", &attach, "--pairs", "--csv", &out]),
    );
    assert!(code <= 1, "{code} {text}");
    let table = std::fs::read_to_string(&out).expect("the table");
    assert!(
        table.lines().next().is_some_and(|head| head.contains("part")),
        "{table}"
    );
    for (arguments, expected) in [
        (["--attach", "hnad=part.json"], "part.json"),
        (["--pad", "gripper=-1"], "at least 0"),
        (["--pad", "gripper"], "NAME=LENGTH"),
        (["--pad", "hnad=1"], "hnad"),
        (["--exclude", "gripper"], "two names"),
        (["--exclude", "gripper,tabel"], "tabel"),
        (["--exclude", "gripper,gripper"], "\"gripper\" has no pair with itself"),
    ] {
        let (code, text) = run(
            "clearance",
            &with(&[&["--joints", "carry.csv"][..], &arguments].concat()),
        );
        assert!(code > 1 && text.contains(expected), "{arguments:?}: {code} {text}");
    }
}

/// The options of a run are saved in a cell: with the cell alone, the table of distances is the same.
#[test]
fn the_world_of_the_options_is_saved_as_a_cell() {
    let part = scratch(
        "saved_part.json",
        r#"{"name": "part", "sphere": {"radius": 0.02}, "xyz": [0, 0, 0.1], "touch_links": ["gripper"]}"#,
    );
    let attach = format!("gripper={part}");
    let options = ["--attach", &attach, "--pad", "part=0.01", "--exclude", "part,table"];
    let saved = scratch("saved_world.json", "");
    let (code, text) = run(
        "cell",
        &with(&[&options[..], &["--margin", "0.04", "--out", &saved]].concat()),
    );
    assert!(
        code == 0 && text.contains("attached objects: 1, paddings: 1"),
        "{code} {text}"
    );
    let measured = |arguments: &[&str], out: &str| {
        let out = scratch(out, "");
        let (code, text) = run(
            "clearance",
            &[arguments, &["--joints", "carry.csv", "--pairs", "--csv", &out]].concat(),
        );
        assert!(code <= 1, "{code} {text}");
        (text, std::fs::read_to_string(&out).expect("the table"))
    };
    let by_options = measured(&with(&[&options[..], &["--margin", "0.04"]].concat()), "by_options.csv");
    let head = by_options.1.lines().next().expect("a head");
    assert!(head.contains("part") && !head.contains("part - table"), "{head}");
    // The SRDF is in the cell.
    assert_eq!(measured(&["--cell", &saved], "by_cell.csv"), by_options);
    // The margin and the padding are in the cell: the verdicts equal those with the options.
    let certified = |arguments: &[&str]| run("certify", &[arguments, &["--joints", "carry.csv"]].concat());
    let by_options = certified(&with(&[&options[..], &["--margin", "0.04"]].concat()));
    assert_eq!(certified(&["--cell", &saved]), by_options);
    // Saved again, and on stdout, the cell is the same.
    let text = std::fs::read_to_string(&saved).expect("the cell");
    let (code, again) = run("cell", &["--cell", &saved]);
    assert!(code == 0 && again.starts_with(&text), "{again}");
    for (arguments, expected, said) in [
        (
            ["--out", "no_such_folder/world.json"],
            3,
            "no_such_folder/world.json: cannot be written",
        ),
        (["--pad", "prat=0.01"], 3, "prat"),
        (["--margin", "x"], 2, "invalid float"),
        (["--margin", "nan"], 2, "margin"),
    ] {
        let (code, text) = run("cell", &with(&arguments));
        assert!(code == expected && text.contains(said), "{arguments:?}: {code} {text}");
    }
}

/// A box on a vertical rail.
const HOIST: &str = "<robot name='r'><link name='rail'/><link name='part'><collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link>
    <joint name='lift' type='prismatic'><parent link='rail'/><child link='part'/><axis xyz='0 0 1'/>
    <limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";

/// A box rests on a table: without the option its lift is blocked at the start, and its press always.
#[test]
fn a_part_is_lifted_from_the_table() {
    let robot = scratch("hoist.urdf", HOIST);
    let cell = scratch(
        "floor.json",
        r#"{"bodies": [{"name": "floor", "half_space": {"normal": [0, 0, 1], "offset": -0.1}},
        {"name": "lid", "half_space": {"normal": [0, 0, -1], "offset": -0.9}}]}"#,
    );
    let [up, down, under] = [("up.csv", 0.5), ("down.csv", -0.01), ("under.csv", 0.9)]
        .map(|(name, z)| scratch(name, &format!("lift\n0\n{z}\n")));
    for (rows, option, expected, said) in [
        (&up, None, 1, "part - floor meet"),
        (&up, Some("0.001"), 0, "part - floor leave their contact"),
        (&down, Some("0.001"), 1, "part - floor meet"),
        (&under, Some("0.001"), 1, "part - floor leave their contact"),
        (&under, Some("0.001"), 1, "part - lid meet"),
    ] {
        let mut arguments = vec!["--cell", &cell, "--joints", rows];
        arguments.extend(option.iter().flat_map(|length| ["--start-contact", length]));
        let (code, text) = run_of(&robot, "certify", &arguments);
        assert!(code == expected && text.contains(said), "{option:?}: {code} {text}");
    }
    // The proof is about the lid; the contact that was accepted is named.
    let proof = scratch("lift.jsonl", "");
    let lift = [
        "--cell",
        &cell,
        "--joints",
        &up,
        "--start-contact",
        "0.001",
        "--receipt",
        &proof,
    ];
    let (code, text) = run_of(&robot, "certify", &lift);
    assert_eq!(code, 0, "{text}");
    let (code, text) = run_of(&proof, "verify", &[]);
    let accepted = "part against floor: in contact at the start, which was accepted";
    assert!(
        code == 0 && text.contains("1 pair of bodies stays more than 0 apart") && text.contains(accepted),
        "{code} {text}"
    );
    let (code, text) = run_of(&robot, "certify", &["--joints", &up, "--start-contact", "-1"]);
    assert!(code > 1, "{code} {text}");
}

/// A motion that is blocked ends with 1, also if what blocks has no receipt: the tool says why.
#[test]
fn a_blocked_motion_without_a_receipt_is_blocked() {
    let robot = scratch("hoist.urdf", HOIST);
    // A contact of an ellipsoid has no receipt, a motion above it has one.
    let cell = |exclude: &str| {
        let body = r#"{"name": "floor", "ellipsoid": {"radii": [1, 1, 0.5]}, "xyz": [0, 0, -1]}"#;
        scratch("floor.json", &format!("{{\"bodies\": [{body}]{exclude}}}"))
    };
    let one = cell("");
    let [down, above] =
        [("down.csv", -0.8), ("above.csv", 0.5)].map(|(name, z)| scratch(name, &format!("lift\n0\n{z}\n")));
    let proof = scratch("none.jsonl", "");
    std::fs::remove_file(&proof).expect("a file");
    let (code, text) = run_of(
        &robot,
        "certify",
        &["--cell", &one, "--joints", &down, "--receipt", &proof],
    );
    assert_eq!(code, 1, "{text}");
    assert!(
        text.contains("part - floor meet at ") && text.contains("0 of 1 segments proven free"),
        "{text}"
    );
    assert!(
        text.contains("none.jsonl: not written: ") && text.contains("floor"),
        "{text}"
    );
    assert!(!Path::new(&proof).exists());
    let (code, text) = run_of(
        &robot,
        "certify",
        &["--cell", &one, "--joints", &above, "--receipt", &proof],
    );
    assert!(code == 0 && Path::new(&proof).exists(), "{code}: {text}");
    std::fs::remove_file(&proof).expect("a file");
    // A free motion whose proof cannot be written has none: that is an error.
    let none = cell(r#", "exclude": [["part", "floor"]]"#);
    let (code, text) = run_of(
        &robot,
        "certify",
        &["--cell", &none, "--joints", &above, "--receipt", &proof],
    );
    assert!(
        code == 3 && text.contains("none.jsonl: ") && text.contains("would claim nothing"),
        "{code}: {text}"
    );
    // A file that cannot be written is an error in both cases.
    let nowhere = scratch("file", "") + "/x";
    let box_cell = scratch(
        "box.json",
        r#"{"bodies": [{"name": "block", "box": {"size": [1, 1, 0.2]}, "xyz": [0, 0, -0.6]}]}"#,
    );
    let (code, text) = run_of(
        &robot,
        "certify",
        &["--cell", &box_cell, "--joints", &down, "--receipt", &nowhere],
    );
    assert!(code == 3 && text.contains("cannot be written"), "{code}: {text}");
}

#[test]
fn points_have_signed_distances_from_a_mesh() {
    let wedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let mesh = scratch("wedge.obj", wedge);
    let points = scratch("three.xyz", "0.25 0.25 0.25\n-0.5 0.25 0.25\n0 0.25 0.25\n");
    let out = scratch("three.csv", "");
    let (code, text) = run_of(&mesh, "points", &["--points", &points, "--csv", &out]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("3 points, 2 in the body or on its surface"), "{text}");
    let table = std::fs::read_to_string(&out).expect("the table");
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[0].starts_with("x,y,z,distance,lower,upper,state,"), "{table}");
    let field = |row: usize, k: usize| rows[row].split(',').nth(k).expect("a field");
    assert_eq!(
        [field(1, 6), field(2, 6), field(3, 6)],
        ["overlapping", "separated", "touching"],
        "{table}"
    );
    let distance: f64 = field(2, 3).parse().expect("a number");
    assert!((distance - 0.5).abs() < 1e-15, "{table}");
    // Points without a return have rows, and are counted.
    let image = scratch("image.xyz", "nan nan nan\n0.25 0.25 0.25\ninf 0 0\n");
    let (code, text) = run_of(&mesh, "points", &["--points", &image, "--csv", &out]);
    let words = "3 points, 2 without a return, 1 in the body or on its surface, least signed distance -0.144";
    assert!(code == 0 && text.contains(words), "{code}: {text}");
    let lines = std::fs::read_to_string(&out).expect("the table");
    let rows: Vec<&str> = lines.lines().collect();
    assert_eq!(
        [rows[1], rows[3]],
        ["NaN,NaN,NaN,,,,invalid,,,,", "NaN,0,0,,,,invalid,,,,"]
    );
    assert!(
        rows[2].starts_with("0.25,0.25,0.25,-0.144") && rows.len() == 4,
        "{lines}"
    );
    let empty = scratch("empty.xyz", "nan nan nan\n");
    let (code, text) = run_of(&mesh, "points", &["--points", &empty, "--csv", &out]);
    assert!(
        code == 0 && text.contains("1 points, 1 without a return, 0 in the body"),
        "{code}: {text}"
    );
}

#[test]
fn trajectories_are_certified() {
    // A straight trajectory has the verdicts of its rows.
    let rows = ["--joints", "carry.csv", "--margin", "0.051"];
    let points = ["--trajectory", "carry.csv", "--margin", "0.051"];
    let (one, other) = (run("certify", &with(&rows)), run("certify", &with(&points)));
    assert_eq!(one, other);
    let (code, text) = run("certify", &with(&["--trajectory", "carry.csv", "--margin", "0.01"]));
    assert!(code == 0 && text.contains("3 of 3 segments proven free"), "{text}");

    // From rest to rest, and over the middle point at speed: the arm dips below the fence.
    let head = "time,turn,turn.velocity,lift,lift.velocity";
    let others = scratch("others.csv", "elbow,roll,bend,twist,left\n1.2,0,0.8,0,0.01\n");
    let file = |name: &str, rows: &str| scratch(name, &format!("{head}\n{rows}"));
    let above = file("above.csv", "0,0.6,0,0.3,0\n2,-0.6,0,0.3,0\n");
    let out = scratch("curve.csv", "");
    let arguments = ["--trajectory", &above, "--rest", &others, "--csv", &out];
    let (code, text) = run("certify", &with(&arguments));
    assert!(code == 0 && text.contains("1 of 1 segments proven free"), "{text}");
    let table = std::fs::read_to_string(&out).expect("the table");
    assert_eq!(table, "from_line,to_line,verdict,safe,t,time,a,b\n2,3,free,1,,,,\n");
    // Half a second at one and a half metres a second, down and up.
    let dip = file("dip.csv", "0,0.6,0,0.3,1.5\n2,-0.6,0,0.3,-1.5\n");
    let (code, text) = run("certify", &with(&["--trajectory", &dip, "--rest", &others]));
    assert!(code == 1 || text.contains("exceeds its limits"), "{code} {text}");

    // A curve that leaves the limits between its points names joint, limits and time.
    let far = file("far.csv", "0,0.6,0,0.3,0\n2,-0.6,100,0.3,0\n");
    let (code, text) = run("certify", &with(&["--trajectory", &far, "--rest", &others]));
    assert!(
        code == 3 && text.contains("turn exceeds its limits") && text.contains("lines 2 to 3"),
        "{text}"
    );

    // Tubes.
    let tube = |joint: &str| {
        let (code, text) = run(
            "certify",
            &with(&["--trajectory", &above, "--rest", &others, "--tube", joint]),
        );
        println!("{joint}: {text}");
        code
    };
    assert_eq!(
        ["turn=0", "turn=0.001", "lift=0.6", "turm=1", "turn=-1"].map(tube),
        [0, 0, 1, 3, 2]
    );
    // A tube that is not free: a configuration in it that is in contact.
    let wide = ["--trajectory", &above, "--rest", &others, "--tube", "lift=0.6"];
    let (_, text) = run("certify", &with(&wide));
    assert!(
        text.contains("not free in the tube at ") && text.contains(" lift="),
        "{text}"
    );
    // A tube of a column, and an option that replaces it.
    let head = "time,lift,turn,turn.tube,lift.tube";
    let tubed = |end: &str| {
        scratch(
            "tubed.csv",
            &format!("{head}\n0,0.3,0,0,0.001\n2,0.3,0.4,0.001,{end}\n"),
        )
    };
    let narrow = tubed("0.002");
    let given = ["--trajectory", &narrow, "--rest", &others];
    assert_eq!(run("certify", &with(&given)).0, 0);
    let (code, text) = run("certify", &with(&[&given[..], &["--start-contact", "0.1"]].concat()));
    assert!(
        code == 3 && text.contains("cannot be used with --start-contact"),
        "{text}"
    );
    let wide = tubed("0.9");
    let given = ["--trajectory", &wide, "--rest", &others];
    let (code, text) = run("certify", &with(&given));
    assert!(code == 1 && text.contains("not free in the tube at "), "{text}");
    assert_eq!(
        run("certify", &with(&[&given[..], &["--tube", "lift=0.001"]].concat())).0,
        0
    );
    let below = tubed("-0.1");
    let (code, text) = run("certify", &with(&["--trajectory", &below, "--rest", &others]));
    assert!(
        code == 3 && text.contains("tubed.csv:3: column \"lift.tube\": deviation is -0.1"),
        "{text}"
    );
    let both = ["--trajectory", "carry.csv", "--joints", "carry.csv"];
    assert_eq!(run("certify", &with(&both)).0, 2);
    assert_eq!(run("certify", &with(&[])).0, 2);
}

#[test]
fn an_audit_proves_pairs_and_refutes_an_srdf() {
    let [table, out, answers] = ["audit.csv", "audit.srdf", "audit.json"].map(|name| scratch(name, ""));
    std::fs::remove_file(&answers).expect("a file");
    let claimed = r#"<robot name="gripper arm">
        <disable_collisions link1="base" link2="upper arm" reason="Never"/>
        <disable_collisions link1="base" link2="gripper" reason="Never"/>
        </robot>"#;
    let srdf = scratch("claimed.srdf", claimed);
    let mut arguments = vec!["--srdf", &srdf, "--csv", &table, "--out", &out, "--resume", &answers];
    arguments.extend(["--cells", "100", "--width", "0.5"]);
    let (code, text) = run("audit", &arguments);
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("excluded as Never, but meets at turn="), "{text}");
    let rows = std::fs::read_to_string(&table).expect("the table");
    assert!(
        rows.starts_with("a,b,joints,verdict,lower,upper,open,cells,ms\n"),
        "{rows}"
    );
    let row = |start: &str| {
        rows.lines()
            .find(|row| row.starts_with(start))
            .expect("a row")
            .to_owned()
    };
    assert!(row("base,upper arm,2,never,0.").contains(",0.0,"), "{rows}");
    row("base,gripper,6,both,0.0,0.0,0.0,");
    let srdf = std::fs::read_to_string(&out).expect("the SRDF");
    assert!(
        srdf.contains(r#"link1="base" link2="upper arm" reason="Proven""#),
        "{srdf}"
    );
    assert!(!srdf.contains(r#"link1="base" link2="gripper""#), "{srdf}");
    // A receipt of the pairs that never meet.
    let proof = scratch("audit.jsonl", "");
    let (code, said) = run(
        "audit",
        &[&arguments[..], &["--receipt", &proof, "--receipt-cells", "2000"]].concat(),
    );
    assert!(code == 1 && said.contains("cells with a plane"), "{said}");
    let (code, said) = verified(&proof, &[]);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("at every configuration of [") && said.contains("upper arm"),
        "{said}"
    );
    assert!(said.contains(" against gripper: excluded: Never"), "{said}");
    // A second run takes the answers over, and goes on with open pairs.
    let (code, again) = run("audit", &arguments);
    assert_eq!(code, 1, "{again}");
    // A pair that is decided has no reason any more.
    let pairs = |text: &str| text.lines().filter(|line| !line.starts_with("open: ")).count();
    assert_eq!(pairs(&text), pairs(&again));
    // Answers of other margins are refused.
    let padded = ["--resume", &answers, "--pad", "base=0.01"];
    let (code, text) = run("audit", &padded);
    assert!(code == 3 && text.contains("does not belong"), "{code} {text}");
    let broken = scratch("broken.json", "[1]");
    let (code, text) = run("audit", &["--resume", &broken]);
    assert!(code == 3 && text.contains("broken.json"), "{text}");
    let (code, text) = run("audit", &["--seconds", "0"]);
    assert!(code == 4 && text.contains("need more cells: --cells"), "{text}");
}

#[test]
fn plan_and_certify_say_the_same_with_boxes_of_pairs() {
    for command in ["certify", "plan"] {
        let arguments = with(&["--joints", "carry.csv"]);
        let without = run(command, &arguments);
        let with_pairs = run(command, &[&arguments[..], &["--pair-boxes", "50"]].concat());
        assert_eq!(with_pairs, without, "{command}");
    }
}

#[test]
fn the_page_of_an_audit_draws_each_pair() {
    let [page, table] = ["audit.html", "audit.csv"].map(|name| scratch(name, ""));
    let claimed = r#"<robot name="gripper arm">
        <disable_collisions link1="base" link2="upper arm" reason="Never"/>
        <disable_collisions link1="base" link2="gripper" reason="Never"/>
        </robot>"#;
    let srdf = scratch("claimed.srdf", claimed);
    // A name that must be escaped, and a half-space.
    let cell = scratch(
        "floor.json",
        r#"{"bodies": [{"name": "<floor> & \"mat\"", "half_space": {"normal": [0, 0, 1], "offset": -0.5}}]}"#,
    );
    let arguments = ["--srdf", &srdf, "--cell", &cell, "--csv", &table, "--report", &page];
    let (code, text) = run("audit", &[&arguments[..], &["--cells", "100", "--width", "0"]].concat());
    assert_eq!(code, 1, "{text}");
    let rows = std::fs::read_to_string(&table).expect("the table").lines().count() - 1;
    let page = std::fs::read_to_string(&page).expect("the page");
    // Nothing is loaded from elsewhere, and there are no scripts.
    for word in ["http", "src=", "url(", "<script", "NaN", "inf"] {
        assert!(!page.contains(word), "{word}");
    }
    // The page is well-formed XML, so names are escaped.
    let tree = roxmltree::Document::parse_with_options(
        &page,
        roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        },
    );
    let tree = tree.expect("a page");
    let all = |name: &'static str| tree.descendants().filter(move |node| node.has_tag_name(name));
    assert_eq!(
        [all("figure").count(), all("svg").count(), all("tr").count()],
        [rows, rows, rows + 1]
    );
    assert_eq!(
        all("title")
            .filter(|t| t.text() == Some("gripper – <floor> & \"mat\""))
            .count(),
        1
    );
    for svg in all("svg") {
        let count = |name: &str, class: &str| {
            let each = svg.descendants().filter(|node| node.has_tag_name(name));
            each.filter(|node| node.attribute("class").unwrap_or_default().starts_with(class))
                .count()
        };
        let title = svg
            .first_element_child()
            .and_then(|title| title.text())
            .expect("a title");
        assert!(count("polygon", "a") > 0 && count("polygon", "b") > 0, "{title}");
        assert_eq!(count("circle", "end"), 2, "{title}");
        for circle in svg.descendants().filter(|node| node.has_tag_name("circle")) {
            let [x, y] = ["cx", "cy"].map(|name| circle.attribute(name).and_then(|x| x.parse::<f64>().ok()));
            assert!(x.is_some_and(|x| (0.0..=420.0).contains(&x)), "{title}");
            assert!(y.is_some_and(|y| (0.0..=280.0).contains(&y)), "{title}");
        }
    }
    // The refuted exclusion comes first.
    let first = all("figure").next().expect("a figure");
    let text: String = first.descendants().filter_map(|node| node.text()).collect();
    assert!(text.contains("base – gripper") && text.contains("turn="), "{text}");
    assert!(page.contains("Refuted exclusions: 1."), "{page}");
}

#[test]
fn an_audit_says_why_pairs_are_open() {
    let (code, text) = run("audit", &with(&["--cells", "2000", "--width", "0"]));
    assert_eq!(code, 4, "{text}");
    let of = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!([of("open   "), of("open: ")], [6, 6], "{text}");
    assert!(text.contains("open: forearm - lamp need more cells"), "{text}");
    assert!(!text.contains("inf"), "{text}");
    for pair in ["base - shoulder", "forearm - wrist 1", "gripper - left finger"] {
        assert!(
            text.contains(&format!("open: {pair} touch without depth at their joint")),
            "{text}"
        );
    }
}

const CROSSING: [&str; 4] = ["--srdf", "gripper.srdf", "--cell", "crossing.json"];

#[test]
fn obstacles_move_on_the_clock_of_the_trajectory() {
    let with = |more: &[&'static str]| -> Vec<&'static str> { CROSSING.iter().chain(more).copied().collect() };
    let (code, text) = run("certify", &with(&["--trajectory", "carry.csv"]));
    assert!(code == 0 && text.contains("3 of 3 segments proven free"), "{text}");
    // Rows with times are the same motion.
    assert_eq!(run("certify", &with(&["--joints", "carry.csv"])), (code, text));
    // Two seconds later the crate is there.
    let rows = std::fs::read_to_string(examples().join("carry.csv")).expect("the rows");
    let later = |by: f64, name: &str| {
        let shifted = rows.lines().map(|line| match line.split_once(',') {
            Some((time, rest)) if time.parse::<f64>().is_ok() => {
                format!("{},{rest}", time.parse::<f64>().expect("a time") + by)
            }
            _ => line.to_owned(),
        });
        scratch(name, &shifted.collect::<Vec<_>>().join("\n"))
    };
    let run_file = |command: &str, option: &'static str, file: &str, more: &[&str]| {
        let mut arguments = CROSSING.to_vec();
        arguments.extend([option, file]);
        arguments.extend(more);
        run(command, &arguments)
    };
    let late = later(2.5, "late.csv");
    let (code, text) = run_file("certify", "--trajectory", &late, &[]);
    assert!(code == 1 && text.contains("- crate meet at"), "{text}");
    // A trajectory that lasts longer than the poses.
    let long = later(4.0, "long.csv");
    let (code, text) = run_file("certify", "--trajectory", &long, &[]);
    let expected = "lines 5 to 6: obstacle \"crate\" has no pose at time 7.0 (its poses cover 0.0 to 6.0)";
    assert!(code == 3 && text.contains(expected), "{text}");
    let (code, text) = run_file("clearance", "--joints", &long, &[]);
    assert!(
        code == 3 && text.contains("line 6: obstacle \"crate\" has no pose at time 7.0"),
        "{text}"
    );
    // Clearances are those at the times of the rows, and along the motion.
    let (code, text) = run("clearance", &with(&["--joints", "carry.csv"]));
    assert!(code == 0 && text.contains("4 rows, 0 in contact"), "{text}");
    let (code, text) = run_file("clearance", "--joints", &late, &["--along", "--against", "cell"]);
    assert!(code == 1 && text.contains("- crate"), "{text}");
    // Without times.
    let still: Vec<String> = rows
        .lines()
        .filter_map(|line| line.split_once(',').filter(|(time, _)| !time.starts_with('#')))
        .map(|(_, rest)| rest.to_owned())
        .collect();
    let still = scratch("still.csv", &still.join("\n"));
    for command in ["certify", "clearance"] {
        let (code, text) = run_file(command, "--joints", &still, &[]);
        let expected = "obstacle \"crate\" moves (expected a column \"time\")";
        assert!(code == 3 && text.contains(expected), "{command}: {text}");
    }
    let (code, text) = run("plan", &with(&["--joints", "carry.csv"]));
    let expected = "obstacle \"crate\" moves (expected obstacles at rest in the search for a path)";
    assert!(code == 3 && text.contains(expected), "{text}");
    // The cell is saved with its poses.
    let out = scratch("saved.json", "");
    let (code, text) = run_file("cell", "--out", &out, &["--pad", "crate=0.01"]);
    assert_eq!(code, 0, "{text}");
    let saved = ["--cell", &out, "--trajectory", "carry.csv"];
    let padded = with(&["--pad", "crate=0.01", "--trajectory", "carry.csv"]);
    assert_eq!(run("certify", &saved), run("certify", &padded));
}

#[test]
fn two_robots_have_one_clock() {
    let names = ["turn", "lift", "elbow", "roll", "bend", "twist", "left"];
    let head: Vec<String> = ["", "b_"]
        .iter()
        .flat_map(|prefix| names.iter().map(move |name| format!("{prefix}{name}")))
        .collect();
    let reach = "0.9,1.3,0,0.8,0,0.01";
    let rows = |turns: &[[f64; 3]]| {
        let each = turns
            .iter()
            .map(|[time, a, b]| format!("{time},{a},{reach},{b},{reach}\n"));
        format!("time,{}\n{}", head.join(","), each.collect::<String>())
    };
    let robots = [
        "--srdf",
        "gripper.srdf",
        "--robot",
        "b_=gripper.urdf",
        "--robot-srdf",
        "b_=gripper.srdf",
    ];
    let certify = |name: &str, pose: &str, text: &str| {
        let file = scratch(name, text);
        let mut arguments = robots.to_vec();
        arguments.extend(["--robot-pose", pose, "--trajectory", &file]);
        run("certify", &arguments)
    };
    // They face each other, and swing to opposite sides or to the same.
    let facing = "b_=0.9,0,0,0,0,3.141592653589793";
    let (code, text) = certify("apart.csv", facing, &rows(&[[0.0, 1.2, 1.2], [2.0, 1.5, 1.5]]));
    assert!(code == 0, "{text}");
    let (code, text) = certify("meet.csv", facing, &rows(&[[0.0, 1.2, -1.2], [2.0, 0.0, 0.0]]));
    assert!(
        code == 1 && text.contains(" - b_") && text.contains("meet at"),
        "{text}"
    );
    let (code, text) = certify("far.csv", "b_=9,0,0", &rows(&[[0.0, 1.2, -1.2], [2.0, 0.0, 0.0]]));
    assert!(code == 0, "{text}");
    // Errors.
    let some = rows(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let (code, text) = certify("some.csv", "c_=1,0,0", &some);
    assert!(
        code == 3 && text.contains("robot with the prefix \"c_\" does not exist; did you mean"),
        "{text}"
    );
    for pose in ["b_", "b_=1,0", "b_=1,0,0,0", "b_=1,0,x", "b_=1,0,inf"] {
        let (code, text) = certify("some.csv", pose, &some);
        assert_eq!(code, 2, "{pose}: {text}");
    }
    let short = some.replacen(",b_left", "", 1);
    let (code, text) = certify("short.csv", facing, &short);
    assert!(
        code == 3 && text.contains("short.csv:1: column \"b_left\" is missing"),
        "{text}"
    );
    let twice = [
        "--robot",
        "b_=gripper.urdf",
        "--robot",
        "b_=gripper.urdf",
        "--trajectory",
        "carry.csv",
    ];
    let (code, text) = run("certify", &twice);
    assert!(code == 3 && text.contains("name is already in use"), "{text}");
    assert_eq!(
        run("certify", &["--robot", "=gripper.urdf", "--trajectory", "carry.csv"]).0,
        2
    );
}

#[test]
fn smooth_trajectories_are_certified_when_they_are_read_back() {
    let path = scratch(
        "corners.csv",
        &format!("{HEAD}0.6,0.9,1.2,0,0.8,0,0.01\n0.6,0.3,1.2,0,0.8,0.5,0.01\n-0.6,0.3,1.2,0,0.8,0.5,0.01\n"),
    );
    let out = scratch("smooth.csv", "");
    let smooth = |more: &[&str]| run("smooth", &with(&[&["--joints", &path, "--csv", &out], more].concat()));
    let certify = |more: &[&str]| run("certify", &with(&[&["--trajectory", &out], more].concat()));
    for (more, columns, stops) in [
        (&["--acceleration", "4"][..], 15, 0),
        (
            &[
                "--acceleration",
                "4",
                "--acceleration",
                "left=0.5",
                "--velocity",
                "turn=1",
            ],
            15,
            0,
        ),
        (&["--acceleration", "4", "--continuous-acceleration"], 22, 0),
        (&["--acceleration", "4", "--deviation", "0"], 15, 1),
    ] {
        let (code, text) = smooth(more);
        assert!(
            code == 0 && text.contains(&format!("stops at {stops} of 1 inner rows")),
            "{text}"
        );
        let table = std::fs::read_to_string(&out).expect("the table");
        let header = table.lines().next().expect("a header");
        assert!(
            header.starts_with("time,turn,lift") && header.contains(",turn.velocity,"),
            "{header}"
        );
        assert_eq!(header.split(',').count(), columns);
        let (code, text) = certify(&[]);
        assert!(code == 0, "{text}");
    }
    // Faults name the joint and the limit.
    let fault = |more: &[&str], expected: i32, words: &[&str]| {
        let (code, text) = smooth(more);
        assert!(
            code == expected && words.iter().all(|word| text.contains(word)),
            "{code} {text}"
        );
    };
    fault(&[], 2, &["--acceleration"]);
    fault(&["--acceleration=-1"], 2, &["at least 0"]);
    fault(
        &["--acceleration", "turn=1"],
        3,
        &["joint \"lift\" has no acceleration limit"],
    );
    fault(
        &["--acceleration", "1", "--velocity", "elbow=0"],
        3,
        &["velocity limit of joint \"elbow\"", "0 (expected"],
    );
    fault(
        &["--acceleration", "1", "--velocity", "elbw=1"],
        3,
        &["joint \"elbw\" does not exist", "nearest: \"elbow\""],
    );
    fault(
        &["--acceleration", "1", "--margin", "9"],
        1,
        &["lines 2 to 3: not proven free"],
    );
}

#[test]
fn a_trajectory_is_recorded_with_its_verdict() {
    let head = "time,turn,turn.velocity,lift,lift.velocity";
    let others = scratch("recorded-others.csv", "elbow,roll,bend,twist,left\n1.2,0,0.8,0,0.01\n");
    let film = |name: &str, rows: &str, more: &[&str]| {
        let file = scratch(&format!("{name}.csv"), &format!("{head}\n{rows}"));
        let [out, table] = ["jsonl", "table.csv"].map(|end| scratch(&format!("{name}.{end}"), ""));
        let arguments = [
            &[
                "--trajectory",
                &file,
                "--rest",
                &others,
                "--record",
                &out,
                "--csv",
                &table,
            ],
            more,
        ]
        .concat();
        let (code, text) = run("certify", &with(&arguments));
        let file = std::io::BufReader::new(std::fs::File::open(&out).expect("the recording"));
        let film = lin_canny_record::Recording::read(file).expect("a recording");
        (code, text, film, std::fs::read_to_string(&table).expect("a table"))
    };
    // Two segments: 33 and 32 frames, with the times of the file.
    let rows = "0,0.6,0,0.3,0\n2,0,-0.5,0.3,0\n4,-0.6,0,0.3,0\n";
    let (code, text, free, _) = film("recorded-free", rows, &[]);
    assert!(code == 0, "{text}");
    assert_eq!(free.frames.len(), 65);
    let note = |k: usize| free.frames[k].note.as_str();
    assert!(
        note(0).starts_with("lines 2 to 3, at 0.000000 of the segment, time 0.000000 (free): "),
        "{}",
        note(0)
    );
    assert!(
        note(16).starts_with("lines 2 to 3, at 0.500000 of the segment, time 1.000000 (free): "),
        "{}",
        note(16)
    );
    assert!(
        note(64).starts_with("lines 3 to 4, at 1.000000 of the segment, time 4.000000 (free): "),
        "{}",
        note(64)
    );
    assert!(
        free.frames
            .iter()
            .all(|f| f.brackets.is_empty() && f.pairs[0].outcome.as_ref().is_some_and(|o| o.lower > 0.0))
    );
    // A motion through the fence: one more frame, at the contact, with its bracket.
    let (code, text, hit, table) = film("recorded-hit", "1,0.6,0,0.9,0\n3,-0.6,0,0.9,0\n", &[]);
    assert!(code == 1 && text.contains("fence"), "{text}");
    let cells: Vec<&str> = table.lines().nth(1).expect("a row").split(',').collect();
    let [safe, t, time]: [f64; 3] = [3, 4, 5].map(|k| cells[k].parse().expect("a number"));
    assert_eq!(hit.frames.len(), 34);
    let [frame] = hit.frames.iter().filter(|f| !f.brackets.is_empty()).collect::<Vec<_>>()[..] else {
        panic!("{} brackets", hit.frames.len())
    };
    let [bracket] = &frame.brackets[..] else {
        panic!("a bracket")
    };
    assert_eq!((bracket.safe, bracket.hit), (1.0 + 2.0 * safe, time));
    let pair = bracket.bodies.map(|k| hit.bodies[k as usize].name.as_str());
    assert_eq!(pair, [cells[6], cells[7]]);
    // Apart at the one end of the bracket, in contact at the other.
    let distance = |poses: &[lin_canny::nalgebra::Isometry3<f64>; 2]| {
        let relative = lin_canny::RelativePose::new(&poses[0], &poses[1]).expect("poses");
        let [a, b] = bracket
            .bodies
            .map(|k| &hit.geometries[hit.bodies[k as usize].geometry as usize]);
        lin_canny::PairTracker::new().closest(a, b, &relative).distance
    };
    assert!(distance(&bracket.at_safe) > 0.0 && distance(&bracket.at_hit) <= 0.0);
    let said = format!(
        "blocked at {t:.6} of the segment, time {time:.6}: {} - {}",
        cells[6], cells[7]
    );
    assert!(
        hit.frames.iter().all(|f| f.note.contains(&said)),
        "{}: {said}",
        hit.frames[0].note
    );
    // A pair that only comes closer than the margin has no bracket of a contact.
    let (code, text, near, _) = film(
        "recorded-near",
        "1,0.6,0,0.9,0\n3,-0.6,0,0.9,0\n",
        &["--margin", "0.01"],
    );
    assert!(code == 1 && text.contains("come within 0.01 m"), "{text}");
    assert!(near.frames.len() == 34 && near.frames.iter().all(|f| f.brackets.is_empty()));
    // Rows without times.
    let out = scratch("recorded-rows.jsonl", "");
    let (code, text) = run("certify", &with(&["--joints", "carry.csv", "--record", &out]));
    assert_eq!(code, 0, "{text}");
    let nowhere = scratch("recorded-file", "") + "/x";
    let (code, text) = run("certify", &with(&["--joints", "carry.csv", "--record", &nowhere]));
    assert!(code == 3 && text.contains("cannot be written"), "{text}");
}

#[test]
fn a_grid_of_signed_distances_is_written() {
    use lin_canny::nalgebra::Point3;
    // A box of 2 x 1 x 0.5: cubes of 1/4, and a border of two.
    let corner = |k: u32| {
        [2.0, 1.0, 0.5]
            .map(|s| s)
            .iter()
            .enumerate()
            .map(|(a, s)| s * f64::from(k >> a & 1))
            .collect::<Vec<f64>>()
    };
    let mut text: String = (0..8)
        .map(corner)
        .map(|p| format!("v {} {} {}\n", p[0], p[1], p[2]))
        .collect();
    text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    let mesh = scratch("block.obj", &text);
    let out = |name: &str| {
        Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(name)
            .to_string_lossy()
            .into_owned()
    };
    let numbers = |file: &str, header: usize| -> Vec<f64> {
        let bytes = std::fs::read(file).expect("a grid");
        bytes[header..]
            .chunks(8)
            .map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes")))
            .collect()
    };
    let [npy, nrrd, raw, errors] = ["block.npy", "block.nrrd", "block.raw", "block.errors.npy"].map(out);
    for file in [&npy, &nrrd, &raw] {
        let (code, text) = run_of(
            &mesh,
            "points",
            &["--grid", "8", "--border", "2", "--out", file, "--errors", &errors],
        );
        assert_eq!(code, 0, "{text}");
        assert!(
            text.contains("13 x 9 x 7 nodes from (-0.5, -0.5, -0.5), step 0.25; "),
            "{text}"
        );
    }
    let values = numbers(&npy, 128);
    assert_eq!(values.len(), 13 * 9 * 7);
    let header = String::from_utf8_lossy(&std::fs::read(&nrrd).expect("a grid")).into_owned();
    let header = &header[..header.find("\n\n").expect("an end") + 2];
    assert!(
        header.contains("sizes: 13 9 7\n") && header.contains("space origin: (-0.5,-0.5,-0.5)\n"),
        "{header}"
    );
    assert_eq!(numbers(&raw, 0), numbers(&nrrd, header.len()));
    let x_first = numbers(&raw, 0);
    let errors = numbers(&errors, 128);
    assert_eq!(errors.len(), 12 * 8 * 6);
    let bound = 0.5 * 0.25 * 3f64.sqrt();
    assert!(errors.iter().all(|e| (bound..1.001 * bound).contains(e)), "{errors:?}");
    let (half, middle) = ([1.0, 0.5, 0.25], [1.0, 0.5, 0.25]);
    for (i, j, k) in (0..13).flat_map(|i| (0..9).flat_map(move |j| (0..7).map(move |k| (i, j, k)))) {
        let p = Point3::from([i, j, k].map(|n| f64::from(n) * 0.25 - 0.5));
        let over = [0, 1, 2].map(|a| (p[a] - middle[a]).abs() - half[a]);
        let outside = over.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt();
        let truth = outside + over.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x)).min(0.0);
        let [i, j, k] = [i, j, k].map(|n| n as usize);
        let found = values[(i * 9 + j) * 7 + k];
        assert!((found - truth).abs() < 1e-14, "{p}: {found} {truth}");
        assert_eq!(found.to_bits(), x_first[(k * 9 + j) * 13 + i].to_bits());
    }
    // Errors name the file, and come before the work.
    let wrong = out("block.vti");
    let no_folder = mesh.clone() + "/x.npy";
    for (arguments, expected, said) in [
        (["--grid", "8", "--out", &wrong], 3, "block.vti: extension"),
        (["--grid", "8", "--out", &no_folder], 3, "x.npy: cannot be written"),
        (
            ["--grid", "4000000000", "--out", &npy],
            3,
            "block.obj: --grid 4000000000: grid has ",
        ),
        (["--grid", "0", "--out", &npy], 2, "--grid"),
        (["--border", "2", "--out", &npy], 2, "--grid"),
    ] {
        let (code, text) = run_of(&mesh, "points", &arguments);
        assert!(code == expected && text.contains(said), "{arguments:?}: {code} {text}");
    }
    assert_eq!(run_of(&mesh, "points", &["--grid", "8"]).0, 2);
    assert_eq!(run_of(&mesh, "points", &[]).0, 2);
}

/// Runs a command whose output nobody reads.
fn run_unread(command: &[&str]) -> (Option<i32>, String) {
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
    tool.current_dir(examples()).args(command);
    tool.stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped());
    let mut child = tool.spawn().expect("the tool runs");
    drop(child.stdout.take());
    let Output { status, stderr, .. } = child.wait_with_output().expect("the tool ends");
    (status.code(), String::from_utf8_lossy(&stderr).into_owned())
}

#[test]
fn a_reader_that_has_gone_is_no_error() {
    let wedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let mesh = scratch("unread.obj", wedge);
    let points = scratch("unread.xyz", "0.25 0.25 0.25\n");
    let [table, grid] = ["unread.csv", "unread.npy"].map(|name| scratch(name, ""));
    let through = format!("{HEAD}0.6,0.9,1.3,0,0.8,0,0.01\n-0.6,0.9,1.3,0,0.8,0,0.01\n");
    let through = scratch("unread-through.csv", &through);
    let robot = |command: &'static str, more: &[&'static str]| [&[command, "gripper.urdf"], &CELL[..], more].concat();
    let joints = ["--joints", "carry.csv"];
    for (command, expected) in [
        (robot("clearance", &joints), 0),
        (robot("clearance", &["--joints", "carry.csv", "--along"]), 0),
        (
            [&robot("certify", &["--joints"])[..], &[&through, "--csv", &table]].concat(),
            1,
        ),
        (robot("plan", &joints), 0),
        (robot("cell", &[]), 0),
        (vec!["ignorable", "gripper.urdf"], 0),
        (vec!["points", &mesh, "--points", &points], 0),
        (vec!["points", &mesh, "--grid", "4", "--out", &grid], 0),
        (vec!["--help"], 0),
    ] {
        let (code, text) = run_unread(&command);
        assert!(
            code == Some(expected) && !text.contains("panicked"),
            "{command:?}: {code:?} {text}"
        );
    }
    // The files are written all the same.
    assert!(
        std::fs::read_to_string(&table)
            .expect("a table")
            .contains("2,3,blocked,")
    );
    assert!(std::fs::metadata(&grid).expect("a grid").len() > 128);
}
