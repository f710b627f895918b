//! Trajectories: the lines of rows and errors, with every line end, blank lines, comments and quotes; and smooth motions,
//! written and read.

use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Cell, Checker, JointMotion};
use lin_canny_robot::plan::{SmoothOptions, Smoother};
use lin_canny_robot::{CellFile, FileError, LoadOptions, Packages, Robot, Trajectory};
use truth::errors::says;
use truth::plans::Ask;

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("trajectory/rows.txt"), section)
}

fn robot() -> Robot {
    let joint = |name: &str, parent: &str| {
        let ends = format!("<parent link=\"{parent}\"/><child link=\"{name}\"/>");
        format!("<link name=\"{name}\"/><joint name=\"{name}\" type=\"continuous\">{ends}</joint>")
    };
    let text = format!(
        "<robot name=\"r\"><link name=\"a\"/>{}{}</robot>",
        joint("s", "a"),
        joint("t", "s")
    );
    Robot::parse(&text, "r.urdf", &Packages::default(), &LoadOptions::default()).expect("a robot")
}

fn parse(text: &str) -> Result<Trajectory, FileError> {
    Trajectory::parse(text, "q.csv", robot().coordinates())
}

/// Texts of which the numbered rows `1,1`, `2,2`, ... stand in these lines; `|` ends a line.
const TEXTS: [(&str, &[u32]); 12] = [
    ("s,t|1,1|2,2|3,3|", &[2, 3, 4]),
    ("s,t|1,1|2,2|3,3", &[2, 3, 4]),
    ("|s,t|1,1|2,2", &[3, 4]),
    ("s,t||1,1|||2,2|3,3|||", &[3, 6, 7]),
    ("||s,t||1,1", &[5]),
    ("# a|s,t|1,1|# b, c|2,2", &[3, 5]),
    ("# a||# b|s,t|# c|||# d|1,1|#|2,2|# e", &[9, 11]),
    ("\"s\",\"t\"|\"1\",\"1\"|2,\"2\"", &[2, 3]),
    ("\"s\",\"t\"|\"|1\",1|2,2|\"3|\",\"|3|\"|4,4", &[2, 4, 5, 9]),
    ("\"|s\",t|1,1", &[3]),
    (" s , t | 1 , 1 |2,2", &[2, 3]),
    ("time,s,t|1,1,1|2,2,2|", &[2, 3]),
];

/// All line ends, the last of each row another one.
fn ended(text: &str, end: usize) -> String {
    let mut parts = text.split('|');
    let mut all = parts.next().unwrap_or_default().to_owned();
    for (k, part) in parts.enumerate() {
        all += ["\n", "\r\n", ["\r\n", "\n"][k % 2], ["\n", "\r\n"][k % 2]][end];
        all += part;
    }
    all
}

#[test]
fn rows_have_their_lines_with_every_line_end() {
    for (text, lines) in TEXTS {
        for end in 0..4 {
            for mark in ["", "\u{feff}"] {
                let text = mark.to_owned() + &ended(text, end);
                let read = parse(&text).unwrap_or_else(|e| panic!("{text:?}: {e}"));
                assert_eq!(read.lines, lines, "{text:?}");
                let rows: Vec<Vec<f64>> = (1..=lines.len()).map(|k| vec![k as f64; 2]).collect();
                assert_eq!(read.rows, rows, "{text:?}");
            }
        }
    }
}

#[test]
fn errors_have_the_line_of_their_row() {
    for (text, lines) in TEXTS {
        for (k, line) in lines.iter().enumerate() {
            let value = (k + 1).to_string();
            // The last field of the row.
            for (fault, words) in [
                ("x", "\"x\""),
                ("1e9", "out of range"),
                ("1,1", "wrong number of fields"),
            ] {
                let (before, header) = text.split_once('t').expect("a header");
                let (header, rows) = match header.split_once(['t', '"']) {
                    Some((time, rest)) if before.is_empty() => (format!("t{time}t"), rest.to_owned()),
                    _ => ("t".to_owned(), header.to_owned()),
                };
                let Some(at) = rows.rfind(&value) else {
                    panic!("{text}: {value}")
                };
                let changed = format!("{before}{header}{}{fault}{}", &rows[..at], &rows[at + 1..]);
                for end in 0..4 {
                    let text = ended(&changed, end);
                    let error = parse(&text).expect_err(&text);
                    if error.to_string().contains(words) {
                        assert_eq!(error.line, Some(*line), "{text:?}: {error}");
                    } else {
                        // A quoted field holds the comma.
                        assert!(changed.contains('"') && error.line == Some(*line), "{text:?}: {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn errors_of_the_header_have_its_line() {
    for before in ["", "|", "||# a|", "# a||"] {
        for (header, words) in [
            ("s|1", "column \"t\" is missing"),
            ("s,t,x|1,1,1", "\"x\""),
            ("s,s|1,1", "already in use"),
            ("s;t|1;1", "semicolons between the columns: \"s;t\" (expected commas)"),
        ] {
            for end in 0..4 {
                let text = ended(&format!("{before}{header}"), end);
                let error = says(parse(&text), words);
                assert_eq!(error.line, Some(1 + before.matches('|').count() as u32), "{text:?}");
            }
        }
    }
}

const TIMED: &str = "time,t,s,s.velocity,t.velocity\n0,0.5,0,1,0\n2,1,1,0,-1\n2.5,0,1,0,0\n";

const JSON: &str = r#"{"header": {}, "joint_names": ["t", "s"], "points": [
 {"positions": [0.5, 0], "velocities": [0, 1], "time_from_start": {"sec": 0, "nanosec": 0}},
 {"positions": [1, 1], "velocities": [-1, 0], "accelerations": [], "time_from_start": {"sec": 2, "nanosec": 0}},
 {"positions": [0, 1], "velocities": [0, 0], "effort": [], "time_from_start": 2.5}]}"#;

const YAML: &str = "---
# As `ros2 topic echo` writes it.
joint_trajectory:
  header:
    stamp: {sec: 0, nanosec: 0}
    frame_id: ''
  joint_names:
  - 't'
  - s  # a comment
  points:
    - positions: [0.5, 0]
      velocities:
      - 0.0
      - 1.0
      accelerations: []
      time_from_start:
        sec: 0
        nanosec: 0
    - positions: [1,
        1]
      velocities: [-1, 0]
      time_from_start: {secs: 2, nsecs: 0}
    -
      positions: [0, 1]
      velocities: [0, 0]
      time_from_start: {sec: 2, nanosec: 500000000}
---
";

fn timed(text: &str, file: &str) -> Result<Trajectory, FileError> {
    Trajectory::parse_timed(text, file, robot().coordinates(), &[])
}

#[test]
fn timed_trajectories_are_equal_in_every_format() {
    let of_csv = timed(TIMED, "q.csv").expect("a trajectory");
    assert_eq!(of_csv.rows, [[0.0, 0.5], [1.0, 1.0], [1.0, 0.0]]);
    assert_eq!(of_csv.velocities, [[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]]);
    assert_eq!(of_csv.times.as_deref(), Some(&[0.0, 2.0, 2.5][..]));
    for (text, file) in [(JSON, "q.json"), (YAML, "q.yaml"), (YAML, "q.YML")] {
        let mut other = timed(text, file).expect("a trajectory");
        assert_eq!(other.lines, [1, 2, 3]);
        other.lines = of_csv.lines.clone();
        assert_eq!(other, of_csv, "{file}");
    }
    // Cubic pieces, through the points at their velocities.
    let curves = of_csv.curves().expect("curves");
    assert_eq!(curves.len(), 2);
    for (k, curve) in curves.iter().enumerate() {
        assert_eq!(curve.degree(), 3);
        assert_eq!(curve.control_point(0), of_csv.rows[k]);
        assert_eq!(curve.control_point(3), of_csv.rows[k + 1]);
        let duration = [2.0, 0.5][k];
        for (time, row) in [(0.0, k), (1.0, k + 1)] {
            for (found, expected) in curve.velocity(time).iter().zip(&of_csv.velocities[row]) {
                assert!((found - expected * duration).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_degree_is_that_of_the_controller() {
    let degree =
        |text: &str, file: &str| timed(text, file).expect("a trajectory").curves().expect("curves")[0].degree();
    assert_eq!(degree("time,s,t\n0,0,0\n1,1,1\n", "q.csv"), 1);
    let quintic = "time,s,t,s.velocity,t.velocity,s.acceleration,t.acceleration\n0,0,0,0,0,1,1\n1,1,1,0,0,0,0\n";
    assert_eq!(degree(quintic, "q.csv"), 5);
    // A point without velocities: the pieces at its sides are linear.
    let mixed = r#"{"joint_names": ["s", "t"], "points": [
        {"positions": [0, 0], "velocities": [1, 1], "time_from_start": 0},
        {"positions": [1, 1], "time_from_start": 1}]}"#;
    assert_eq!(degree(mixed, "q.json"), 1);
    // A joint at rest that the file does not name.
    let rest = [Some(0.25), None];
    let found = Trajectory::parse_timed(
        "time,t,t.velocity\n0,0,1\n1,1,1\n",
        "q.csv",
        robot().coordinates(),
        &rest,
    );
    let found = found.expect("a trajectory");
    assert_eq!(&found.rows[1], &vec![0.25, 1.0]);
    assert_eq!(&found.velocities[1], &vec![0.0, 1.0]);
}

#[test]
fn timed_trajectories_that_are_wrong_name_the_place() {
    for [text, file, expected] in cases("faults of timed trajectories") {
        let error = timed(&text, &file).expect_err("an error").to_string();
        assert!(error.contains(&expected), "{text:?}: {error}");
    }
    // Deep nesting ends.
    for text in ["[".repeat(100_000), "- ".repeat(100_000), "{a: ".repeat(10_000)] {
        assert!(timed(&text, "q.yaml").is_err());
    }
}

#[test]
fn smooth_motions_are_read_back_bit_for_bit_and_proven() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let packages = Packages::default();
    let robot = Robot::load(folder.join("arm.urdf"), &packages).expect("a robot");
    assert!(robot.coordinates().iter().all(|c| c.velocity == Some(2.0)));
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    CellFile::load(folder.join("cell.json"), &packages, &LoadOptions::default())
        .expect("a cell")
        .add_to(&mut setup)
        .expect("a cell");
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let mut rng = truth::rng::Rng::new(3);
    let mut stops = 0;
    for round in 0..20 {
        let mut path: Vec<Vec<f64>> = vec![vec![0.6, 0.3, 1.2, 0.0, 0.8, 0.5]];
        while path.len() < 5 {
            let last = &path[path.len() - 1];
            let way = rng.log_range(1e-4, 1.5);
            let next: Vec<f64> = last
                .iter()
                .map(|x| (x + rng.range(-way, way)).clamp(-1.8, 1.8))
                .collect();
            if checker
                .is_free(&JointMotion::segment(last, &next))
                .expect("within limits")
            {
                path.push(next);
            }
        }
        let velocity: Vec<f64> = setup.coordinates().iter().filter_map(|c| c.velocity).collect();
        let options =
            SmoothOptions::new(velocity, [rng.log_range(0.1, 30.0); 6]).continuous_acceleration(round % 2 == 0);
        let smooth = Smoother::new(&options)
            .smooth(&mut checker, &path)
            .expect("a free path");
        stops += smooth.stops.len();
        let spans = smooth.times.windows(2).map(|ends| [ends[0], ends[1]]);
        let timed = smooth.curves.iter().zip(spans);
        let curves: Vec<_> = timed
            .map(|(curve, times)| curve.clone().with_times(times).expect("rising times"))
            .collect();
        let written = Trajectory::from(smooth);
        assert_eq!(written.curves().expect("curves"), curves);
        let text = written.csv_text(setup.coordinates());
        let read = Trajectory::parse_timed(&text, "q.csv", setup.coordinates(), &[]).expect("a trajectory");
        assert_eq!(read.curves().expect("curves"), curves);
        assert_eq!(read, written);
        for curve in read.curves().expect("curves") {
            assert!(checker.is_free_along(&JointMotion::curve(&curve)));
        }
    }
    assert!(stops < 20, "{stops}");
    // Without times and velocities, the text is that of the rows.
    let rows = vec![vec![0.1; 6], vec![-0.0, 1e-300, 1e300, 0.3, 1.0 / 3.0, 2.0]];
    let mut plain = Trajectory::default();
    plain.rows.clone_from(&rows);
    let found = plain.csv_text(setup.coordinates());
    assert_eq!(found, lin_canny_robot::csv_text(setup.coordinates(), &rows));
}

#[test]
fn joints_that_mimic_limit_the_velocity_of_their_leader() {
    let joint = |name: &str, more: &str| {
        let ends = format!("<parent link=\"a\"/><child link=\"{name}\"/>");
        format!("<link name=\"{name}\"/><joint name=\"{name}\" type=\"continuous\">{ends}{more}</joint>")
    };
    let robot = |first: &str, factor: &str, second: &str| {
        let limit = |text: &str| match text {
            "" => String::new(),
            text => format!("<limit effort=\"1\" velocity=\"{text}\"/>"),
        };
        let follows = format!("<mimic joint=\"s\" multiplier=\"{factor}\"/>{}", limit(second));
        let joints = joint("s", &limit(first)) + &joint("t", &follows);
        let text = format!("<robot name=\"r\"><link name=\"a\"/>{joints}</robot>");
        Robot::parse(&text, "r.urdf", &Packages::default(), &LoadOptions::default())
    };
    let velocity = |first: &str, factor: &str, second: &str| {
        let robot = robot(first, factor, second).expect("a robot");
        assert_eq!(robot.coordinates().len(), 1);
        robot.coordinates()[0].velocity
    };
    assert_eq!(velocity("2", "1", "3"), Some(2.0));
    assert_eq!(velocity("2", "-4", "3"), Some(0.75));
    assert_eq!(velocity("2", "0", "3"), Some(2.0));
    assert_eq!(velocity("", "0.5", "3"), Some(6.0));
    assert_eq!(velocity("inf", "1", ""), None);
    assert_eq!(velocity("0", "1", ""), Some(0.0));
    let error = robot("fast", "1", "").expect_err("no number").to_string();
    assert!(error.contains("velocity") && error.contains("\"fast\""), "{error}");
}
