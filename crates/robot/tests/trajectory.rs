//! Trajectories: the lines of rows and errors, with every line end, blank lines, comments and quotes.

use lin_canny_robot::{FileError, LoadOptions, Packages, Robot, Trajectory};

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
        ] {
            for end in 0..4 {
                let text = ended(&format!("{before}{header}"), end);
                let error = parse(&text).expect_err(&text);
                assert!(error.to_string().contains(words), "{error}");
                assert_eq!(error.line, Some(1 + before.matches('|').count() as u32), "{text:?}");
            }
        }
    }
}
