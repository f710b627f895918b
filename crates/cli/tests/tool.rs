//! The tool: closed forms of what its tables state, what recordings and pages hold, and a reader that has gone.
//!
//! What users see of each command is in `transcripts`, whose files these tests use.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use lin_canny_record::{Frame, PageOptions, Recording};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/transcripts/files")
}

/// Runs a line of a command with further arguments, which may hold blanks.
fn run(line: &str, arguments: &[&str]) -> (i32, String) {
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
    tool.current_dir(folder()).args(line.split(' ')).args(arguments);
    let Output { status, stdout, stderr } = tool.output().expect("the tool runs");
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (status.code().expect("an exit code"), text)
}

/// A file in the folder of this test: tests run at once, each in a thread that has its name.
fn out(name: &str) -> String {
    let thread = std::thread::current();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(thread.name().unwrap_or("tool"));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.join(name).to_string_lossy().into_owned()
}

fn text(file: &str) -> String {
    std::fs::read_to_string(file).expect(file)
}

/// The rows of the table that a command writes, each by the names of its columns.
fn table(line: &str, arguments: &[&str], code: i32) -> Vec<HashMap<String, String>> {
    let file = out("table.csv");
    let (found, text) = run(line, &[arguments, &["--csv", &file]].concat());
    assert_eq!(found, code, "{line}: {text}");
    let mut reader = csv::Reader::from_path(file).expect("the table");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().expect("a number")
}

/// The numbers among the words of a text.
fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

/// Distance of the far ball of `balls.json` at (3, 0, 0) from the nearer ball of the arm of `swing.urdf` at an angle.
/// Its balls of radius 0.1 at (0.5, 0, 0) and (1, 0, 0) rotate about one at the origin.
fn far(q: f64) -> f64 {
    (10.0 - 6.0 * q.cos()).min(9.25 - 3.0 * q.cos()).sqrt() - 0.3
}

/// Distance of the side ball at (0, 1.5, 0) from the nearer ball of the arm at an angle.
fn side(q: f64) -> f64 {
    (3.25 - 3.0 * q.sin()).min(2.5 - 1.5 * q.sin()).sqrt() - 0.3
}

#[test]
fn distances_of_rows_have_closed_forms() {
    let rows = "clearance swing.urdf --cell balls.json --joints distances/against.csv --check-adjacent";
    // The arm keeps its distance of 0.3 from the hub: the least of all.
    for against in ["all", "self"] {
        for row in table(rows, &["--against", against], 0) {
            assert!((number(&row, "distance") - 0.3).abs() < 1e-12, "{row:?}");
            assert_eq!([&row["a"], &row["b"]], ["hub", "arm"]);
        }
    }
    let (cell, pairs) = (table(rows, &["--against", "cell"], 0), table(rows, &["--pairs"], 0));
    for ((row, pairs), q) in cell.iter().zip(&pairs).zip([0.0, 0.4, -1.5]) {
        // Of the hub, of the balls of the arm.
        let least = far(q).min(side(q)).min(1.2);
        let [lower, upper] = ["lower", "upper"].map(|name| number(row, name));
        assert!(lower <= least + 1e-15, "{row:?}");
        assert!(least - 1e-15 <= upper, "{row:?}");
        assert!(upper - lower < 1e-12, "{row:?}");
        for (name, distance) in [
            ("hub - arm", 0.3),
            ("hub - far ball", 2.7),
            ("hub - side ball", 1.2),
            ("arm - far ball", far(q)),
            ("arm - side ball", side(q)),
        ] {
            assert!((number(pairs, name) - distance).abs() < 1e-12, "{name}: {pairs:?}");
        }
    }
    assert_eq!([&cell[1]["a"], &cell[1]["b"]], ["arm", "side ball"]);
    // A row outside of the limits is measured as it is.
    let over = "clearance swing.urdf --cell balls.json --limit-slack 1e-6 --joints joints/over.csv --pairs";
    let row = &table(over, &[], 0)[0];
    assert!((number(row, "arm - far ball") - far(-1.500_000_1)).abs() < 1e-12);
}

#[test]
fn the_least_clearance_along_a_motion_is_enclosed() {
    let along =
        "clearance swing.urdf --cell balls.json --joints distances/along.csv --along --check-adjacent --against";
    // The side ball is closest at the greatest angle.
    let found = table(&format!("{along} cell"), &[], 0);
    for (row, ([from, to], t, time)) in found.iter().zip([(["2", "3"], 1.0, 2.0), (["3", "4"], 0.0, 2.0)]) {
        assert_eq!(
            [&row["from_line"], &row["to_line"], &row["verdict"]],
            [from, to, "free"]
        );
        let [lower, upper] = ["lower", "upper"].map(|name| number(row, name));
        let least = side(0.5);
        assert!(lower <= least, "{row:?}");
        assert!(least <= upper + 1e-15, "{row:?}");
        assert!(upper - lower < 2e-3 * least, "{row:?}");
        assert!((number(row, "t") - t).abs() < 1e-2, "{row:?}");
        assert!((number(row, "time") - time).abs() < 2e-2, "{row:?}");
        assert_eq!([&row["a"], &row["b"]], ["arm", "side ball"]);
    }
    let least = number(&table(&format!("{along} self"), &[], 0)[0], "lower");
    assert!((0.2995..=0.3).contains(&least), "{least}");
    // Least between the rows: the arm passes the near ball at angle 0, where no row is.
    let past = "clearance swing.urdf --joints distances/past.csv --along --cell";
    let row = &table(past, &["distances/near.json"], 0)[0];
    let [lower, upper, t] = ["lower", "upper", "t"].map(|name| number(row, name));
    assert!(
        lower > 0.0 && lower <= 0.001 && upper >= 0.001 && upper - lower < 0.1 * upper,
        "{row:?}"
    );
    assert!((t - 1.0 / 2.4).abs() < 1e-2, "{row:?}");
    // The arm meets the ball at the angle at which the centres are 0.3 apart.
    let row = &table(past, &["distances/ahead.json"], 1)[0];
    let angle = ((1.0 + 1.44 - 0.09) / 2.4f64).acos();
    assert!((number(row, "t") - (1.0 - angle) / 2.4).abs() < 1e-5, "{row:?}");
    // The arm touches the ball between the rows.
    let row = &table(past, &["distances/touch.json"], 4)[0];
    assert_eq!(
        [&row["verdict"], &row["lower"], &row["b"]],
        ["undecided", "", "touched"]
    );
}

#[test]
fn times_and_distances_of_messages_have_closed_forms() {
    let start = "plan swing.urdf --cell balls.json --joints required/start_near.csv --margin 1.2";
    let (_, text) = run(start, &[]);
    let [value, width, ..] = numbers(&text)[..] else {
        panic!("{text}")
    };
    assert!((value - side(0.5)).abs() <= width && width < 1e-4, "{text}");
    // The centres are 1.4 apart if the sine of the angle is 0.36.
    let (_, text) = run(
        "certify swing.urdf --cell balls.json --joints required/margin.csv --margin 1.1",
        &[],
    );
    let t = (0.36f64.asin() + 1.0) / 1.5;
    let [at, time] = [2, 3].map(|k| numbers(&text)[k]);
    assert!((at - t).abs() < 1e-5 && (time - 3.0 * t).abs() < 3e-5, "{text}");
}

/// A padding, a margin and their sum are one rule: rows and motions that do not keep it end with 1.
#[test]
fn a_required_distance_is_that_of_rows_and_motions() {
    let rows = "clearance swing.urdf --joints required/required.csv --cell";
    for (cell, pad, required) in [
        ("balls.json", None, 0.0),
        ("required/margin.json", None, 1.05),
        ("required/pair.json", None, 1.05),
        ("balls.json", Some("side ball=1.05"), 1.05),
        ("balls.json", Some("arm=1.05"), 1.05),
        ("required/sum.json", Some("side ball=0.55"), 1.05),
    ] {
        let mut arguments = vec![cell];
        arguments.extend(pad.iter().flat_map(|pad| ["--pad", pad]));
        let blocked = i32::from(required > 0.0);
        let found = table(rows, &arguments, blocked);
        let row = found.last().expect("a row");
        let [distance, excess] = ["distance", "excess"].map(|name| number(row, name));
        assert!((distance - side(0.5)).abs() < 1e-12, "{row:?}");
        assert!(excess == distance - required, "{row:?}");
        let too_close = found.iter().filter(|row| number(row, "excess") <= 0.0).count();
        assert_eq!(too_close, blocked as usize, "{found:?}");
        // Along the motion.
        arguments.push("--along");
        let along = &table(rows, &arguments, blocked)[0];
        match required {
            0.0 => assert_eq!(along["excess"], along["upper"]),
            _ => assert_eq!(
                [&along["verdict"], &along["upper"], &along["excess"]],
                ["blocked", "1.05", "0"]
            ),
        }
        for row in [row, along] {
            assert_eq!([&row["a"], &row["b"]], ["arm", "side ball"]);
        }
    }
}

const CELL: &str = "gripper.urdf --srdf gripper.srdf --cell cell.json";

/// Runs a command whose recording is played: its exit code, what it says, and the recording.
fn recorded(line: &str, arguments: &[&str]) -> (i32, String, Recording) {
    let film = out("film.jsonl");
    let (code, text) = run(line, &[arguments, &["--record", &film]].concat());
    (code, text, Recording::open(&film).expect("a recording"))
}

fn is_apart(frame: &Frame) -> bool {
    frame.pairs[0].outcome.as_ref().is_some_and(|o| o.lower > 0.0)
}

#[test]
fn rows_are_recorded_and_played_by_a_page() {
    let page = out("carry.html");
    let (code, told, film) = recorded(&format!("clearance {CELL} --joints carry.csv"), &["--page", &page]);
    assert_eq!(code, 0, "{told}");
    assert_eq!(lin_canny_record::page(&film, &PageOptions::default()), text(&page));
    assert_eq!(film.frames.len(), 4);
    assert!(film.bodies.iter().any(|b| b.name == "fence"), "{:?}", film.bodies);
    for frame in &film.frames {
        let [pair] = &frame.pairs[..] else {
            panic!("{} pairs", frame.pairs.len())
        };
        let outcome = pair.outcome.as_ref().expect("an answer");
        assert!(outcome.lower > 0.0);
        let told = frame.note.split(' ').nth(2).and_then(|x| x.parse::<f64>().ok());
        assert!(
            (told.expect("a distance") - outcome.distance).abs() < 1e-12,
            "{}",
            frame.note
        );
    }
    // The arm moves, the cell does not.
    let moved = film.frames[1].poses.iter().map(|(k, _)| &film.bodies[*k as usize].name);
    let moved: Vec<_> = moved.collect();
    assert!(!moved.is_empty(), "{moved:?}");
    assert!(moved.iter().all(|name| *name != "fence"), "{moved:?}");
    for command in ["certify", "plan"] {
        let (code, told) = run(&format!("{command} {CELL} --joints carry.csv"), &["--page", &page]);
        assert_eq!(code, 0, "{command}: {told}");
        let html = text(&page);
        assert!(html.contains("\"name\":\"fence\""), "{command}");
        assert!(html.ends_with("</html>\n"), "{command}");
    }
}

#[test]
fn a_path_around_the_fence_is_recorded_and_certified() {
    let path = out("path.csv");
    let line = format!("plan {CELL} --joints proofs/through.csv");
    let (code, told, film) = recorded(&line, &["--csv", &path]);
    assert_eq!(code, 0, "{told}");
    let rows = text(&path).lines().count() - 1;
    assert_eq!(film.frames.len(), 32 * (rows - 1) + 1);
    assert!(film.frames.iter().all(is_apart));
}

#[test]
fn a_trajectory_is_recorded_with_its_verdict() {
    let line = format!("certify {CELL} --rest trajectories/others.csv --trajectory");
    // Two segments: 33 and 32 frames, with the times of the file.
    let (code, told, free) = recorded(&line, &["recorded/free.csv"]);
    assert!(code == 0, "{told}");
    assert_eq!(free.frames.len(), 65);
    for (k, start) in [
        (0, "lines 2 to 3, at 0.000000 of the segment, time 0.000000 (free): "),
        (16, "lines 2 to 3, at 0.500000 of the segment, time 1.000000 (free): "),
        (64, "lines 3 to 4, at 1.000000 of the segment, time 4.000000 (free): "),
    ] {
        assert!(free.frames[k].note.starts_with(start), "{}", free.frames[k].note);
    }
    assert!(free.frames.iter().all(|f| f.brackets.is_empty() && is_apart(f)));
    // A motion through the fence: one more frame, at the contact, with its bracket.
    let table = out("hit.csv");
    let (code, told, hit) = recorded(&line, &["recorded/hit.csv", "--csv", &table]);
    assert!(code == 1 && told.contains("fence"), "{told}");
    let table = text(&table);
    let cells: Vec<&str> = table.lines().nth(1).expect("a row").split(',').collect();
    let [safe, t, time]: [f64; 3] = [3, 4, 5].map(|k| cells[k].parse().expect("a number"));
    assert_eq!(hit.frames.len(), 34);
    let brackets: Vec<_> = hit.frames.iter().flat_map(|f| &f.brackets).collect();
    let [bracket] = brackets[..] else {
        panic!("{} brackets", brackets.len())
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
    for frame in &hit.frames {
        assert!(frame.note.contains(&said), "{}: {said}", frame.note);
    }
    // A pair that only comes closer than the margin has no bracket of a contact.
    let (code, told, near) = recorded(&line, &["recorded/hit.csv", "--margin", "0.01"]);
    assert!(code == 1 && told.contains("come within 0.01 m"), "{told}");
    assert!(near.frames.len() == 34 && near.frames.iter().all(|f| f.brackets.is_empty()));
    // Rows without times.
    let (code, told, _) = recorded(&format!("certify {CELL} --joints carry.csv"), &[]);
    assert_eq!(code, 0, "{told}");
}

#[test]
fn the_page_of_an_audit_draws_each_pair() {
    let [page, table] = ["audit.html", "audit.csv"].map(out);
    // A name that must be escaped, and a half-space.
    let line = "audit gripper.urdf --srdf audit/claimed.srdf --cell audit/floor.json --cells 100 --relative-width 0";
    let (code, told) = run(line, &["--csv", &table, "--report", &page]);
    assert_eq!(code, 1, "{told}");
    let rows = text(&table).lines().count() - 1;
    let page = text(&page);
    // Nothing is loaded from elsewhere, and there are no scripts.
    for word in ["http", "src=", "url(", "<script", "NaN", "inf"] {
        assert!(!page.contains(word), "{word}");
    }
    // The page is well-formed XML, so names are escaped.
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..Default::default()
    };
    let tree = roxmltree::Document::parse_with_options(&page, options).expect("a page");
    let all = |name: &'static str| tree.descendants().filter(move |node| node.has_tag_name(name));
    assert_eq!(
        ["figure", "svg", "tr"].map(|name| all(name).count()),
        [rows, rows, rows + 1]
    );
    let escaped = all("title").filter(|t| t.text() == Some("gripper – <floor> & \"mat\""));
    assert_eq!(escaped.count(), 1);
    for svg in all("svg") {
        let of = |name: &'static str| svg.descendants().filter(move |node| node.has_tag_name(name));
        let count = |name: &'static str, class: &str| {
            of(name)
                .filter(|node| node.attribute("class").unwrap_or_default().starts_with(class))
                .count()
        };
        let title = svg.first_element_child().and_then(|title| title.text());
        assert!(title.is_some(), "{title:?}");
        assert!(count("polygon", "a") > 0, "{title:?}");
        assert!(count("polygon", "b") > 0, "{title:?}");
        assert_eq!(count("circle", "end"), 2, "{title:?}");
        for (name, end) in [("cx", 420.0), ("cy", 280.0)] {
            let within = |x: &str| x.parse::<f64>().is_ok_and(|x| (0.0..=end).contains(&x));
            assert!(of("circle").all(|c| c.attribute(name).is_some_and(within)), "{title:?}");
        }
    }
    // The refuted exclusion comes first.
    let first = all("figure").next().expect("a figure");
    let text: String = first.descendants().filter_map(|node| node.text()).collect();
    assert!(text.contains("base – gripper") && text.contains("turn="), "{text}");
    assert!(page.contains("Refuted exclusions: 1."), "{page}");
}

/// A box of 2 x 1 x 0.5: cubes of 1/4, and a border of two.
#[test]
fn a_grid_of_signed_distances_is_written() {
    use lin_canny::nalgebra::Point3;
    let numbers = |file: &str, header: usize| -> Vec<f64> {
        let bytes = std::fs::read(file).expect("a grid");
        let numbers = bytes[header..].chunks(8);
        numbers
            .map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes")))
            .collect()
    };
    let [npy, nrrd, raw, errors] = ["block.npy", "block.nrrd", "block.raw", "block.errors.npy"].map(out);
    for file in [&npy, &nrrd, &raw] {
        let (code, text) = run(
            "points block.obj --grid 8 --border 2",
            &["--out", file, "--errors", &errors],
        );
        assert_eq!(code, 0, "{text}");
        let size = "13 x 9 x 7 nodes from (-0.5, -0.5, -0.5), step 0.25; ";
        assert!(text.contains(size), "{text}");
    }
    let values = numbers(&npy, 128);
    assert_eq!(values.len(), 13 * 9 * 7);
    let header = String::from_utf8_lossy(&std::fs::read(&nrrd).expect("a grid")).into_owned();
    let header = &header[..header.find("\n\n").expect("an end") + 2];
    assert!(header.contains("sizes: 13 9 7\n"), "{header}");
    assert!(header.contains("space origin: (-0.5,-0.5,-0.5)\n"), "{header}");
    let x_first = numbers(&raw, 0);
    assert_eq!(x_first, numbers(&nrrd, header.len()));
    let errors = numbers(&errors, 128);
    assert_eq!(errors.len(), 12 * 8 * 6);
    let bound = 0.5 * 0.25 * 3f64.sqrt();
    assert!(errors.iter().all(|e| (bound..1.001 * bound).contains(e)), "{errors:?}");
    let half = [1.0, 0.5, 0.25];
    for (n, found) in values.into_iter().enumerate() {
        let [i, j, k] = [n / 63, n / 7 % 9, n % 7];
        let p = Point3::from([i, j, k].map(|n| n as f64 * 0.25 - 0.5));
        let over = [0, 1, 2].map(|a| (p[a] - half[a]).abs() - half[a]);
        let outside = over.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt();
        let truth = outside + over.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x)).min(0.0);
        assert!((found - truth).abs() < 1e-14, "{p}: {found} {truth}");
        assert_eq!(found.to_bits(), x_first[(k * 9 + j) * 13 + i].to_bits());
    }
}

#[test]
fn a_reader_that_has_gone_is_no_error() {
    let [table, grid] = ["unread.csv", "unread.npy"].map(out);
    for (line, files, expected) in [
        (format!("clearance {CELL} --joints carry.csv"), vec![], 0),
        (format!("clearance {CELL} --joints carry.csv --along"), vec![], 0),
        (
            format!("certify {CELL} --joints proofs/through.csv"),
            vec!["--csv", &table],
            1,
        ),
        (format!("plan {CELL} --joints carry.csv"), vec![], 0),
        (format!("cell {CELL}"), vec![], 0),
        ("find-excluded gripper.urdf".into(), vec![], 0),
        ("points wedge.obj --points three.xyz".into(), vec![], 0),
        ("points wedge.obj --grid 4".into(), vec!["--out", &grid], 0),
        ("--help".into(), vec![], 0),
    ] {
        let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
        tool.current_dir(folder()).args(line.split(' ')).args(files);
        tool.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = tool.spawn().expect("the tool runs");
        drop(child.stdout.take());
        let Output { status, stderr, .. } = child.wait_with_output().expect("the tool ends");
        let text = String::from_utf8_lossy(&stderr);
        assert!(status.code() == Some(expected), "{line}: {status:?} {text}");
        assert!(!text.contains("panicked"), "{line}: {status:?} {text}");
    }
    // The files are written all the same.
    assert!(text(&table).contains("2,3,blocked,"));
    assert!(std::fs::metadata(&grid).expect("a grid").len() > 128);
}

/// Ctrl-C during `clash` writes the rows that are done.
#[cfg(unix)]
#[test]
fn a_stopped_search_for_clashes_writes_its_rows() {
    use std::fmt::Write as _;
    use std::io::{BufRead, BufReader, Read as _};

    let ball = lin_canny::polyhedron::solids::geodesic_sphere(4, 1.0).expect("a ball");
    let ball = lin_canny::Mesh::from_convex(&ball).expect("a mesh");
    let mut model = String::new();
    for p in ball.vertices() {
        writeln!(model, "v {} {} {}", p.x, p.y, p.z).expect("a line");
    }
    for k in 0..60 {
        writeln!(model, "o ball{k}").expect("a line");
        // The first one is open, which the tool prints before it searches.
        for [a, b, c] in ball.triangle_vertices().into_iter().skip(usize::from(k == 0)) {
            writeln!(model, "f {} {} {}", a + 1, b + 1, c + 1).expect("a line");
        }
    }
    let (file, rows) = (out("model.obj"), out("rows.jsonl"));
    std::fs::write(&file, model).expect("a model");
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
    let arguments = ["clash", &file, "--volume", "--jsonl", &rows];
    let mut tool = tool
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the tool");
    let mut stdout = BufReader::new(tool.stdout.take().expect("stdout"));
    let mut first = String::new();
    stdout.read_line(&mut first).expect("a line");
    assert!(first.starts_with("ball0: repaired"), "{first}");
    std::thread::sleep(std::time::Duration::from_millis(500));
    let stopped = Command::new("kill")
        .args(["-INT", &tool.id().to_string()])
        .status()
        .expect("kill");
    assert!(stopped.success());
    let mut rest = String::new();
    stdout.read_to_string(&mut rest).expect("text");
    assert_eq!(tool.wait().expect("an end").code(), Some(130), "{rest}");
    let rows = text(&rows);
    assert!(rows.lines().all(|line| line.starts_with("{\"a\":\"ball")), "{rows}");
    let count = rows.lines().count();
    assert!((1..60 * 59 / 2).contains(&count), "{count}: {rest}");
}

/// Packages of the tool have a manual page for each command, and completions that name each.
#[test]
fn packaging_writes_pages_and_completions_of_every_command() {
    let folder = out("packaging");
    assert_eq!(run("packaging", &[&folder]), (0, String::new()));
    let (_, help) = run("--help", &[]);
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands = commands.take_while(|line| !line.is_empty()).map(|line| line.trim());
    let names: Vec<_> = commands
        .filter_map(|line| line.split(' ').next())
        .filter(|name| *name != "help")
        .collect();
    assert!(names.len() > 10, "{names:?}");
    let bash = text(&format!("{folder}/completions/lin-canny.bash"));
    for name in names {
        assert!(
            text(&format!("{folder}/man1/lin-canny-{name}.1")).contains("OPTIONS"),
            "{name}"
        );
        assert!(bash.contains(&format!("lin__canny,{name})")), "{name}");
    }
    assert!(text(&format!("{folder}/man1/lin-canny.1")).contains("lin\\-canny\\-certify(1)"));
    let (code, said) = run("packaging", &["cell.json/x"]);
    assert!(code == 3 && said.contains("cannot be written"), "{said}");
}
