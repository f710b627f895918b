//! PLY: faces and strips are read in text and both byte orders, and what does not fit is an error.

mod support;

use lin_canny_formats::MeshFile;
use support::errors::says;
use support::rows::rows;
use support::{AREA, BOX, TRIANGLES, VOLUME, area, bounds, encodings, parse, read_mutants, volume};

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    rows(include_str!("ply/rows.txt"), section)
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// A PLY as lines of its header, and rows of numbers with their types.
#[derive(Clone)]
struct Ply {
    header: Vec<String>,
    rows: Vec<Vec<(&'static str, f64)>>,
}

impl Ply {
    /// A box with the given types of coordinates, lengths and indices.
    fn new(coordinate: &'static str, length: &'static str, index: &'static str) -> Self {
        let mut ply = Self {
            header: vec!["comment a box".into()],
            rows: Vec::new(),
        };
        ply.header.push("element vertex 8".into());
        for axis in ["x", "y", "z"] {
            ply.header.push(format!("property {coordinate} {axis}"));
        }
        ply.header.push("element face 12".into());
        ply.header
            .push(format!("property list {length} {index} vertex_indices"));
        ply.rows.extend(BOX.iter().map(|p| p.map(|x| (coordinate, x)).to_vec()));
        for t in TRIANGLES {
            let corners = t.map(|k| (index, k as f64));
            ply.rows.push([&[(length, 3.0)], &corners[..]].concat());
        }
        ply
    }

    /// Adds a vertex.
    fn with_vertex(&self, point: [f64; 3]) -> Self {
        let mut ply = self.clone();
        ply.header[1] = "element vertex 9".into();
        ply.rows.insert(8, point.map(|x| ("double", x)).to_vec());
        ply
    }

    fn write(&self, format: &str) -> Vec<u8> {
        let mut bytes = format!("ply\nformat {format} 1.0\n{}\nend_header\n", self.header.join("\n")).into_bytes();
        for row in &self.rows {
            if format == "ascii" {
                let words: Vec<String> = row.iter().map(|(_, x)| x.to_string()).collect();
                bytes.extend(words.join(" ").bytes().chain(*b"\n"));
                continue;
            }
            for &(of, x) in row {
                let mut number = match of {
                    "char" | "int8" => (x as i8).to_le_bytes().to_vec(),
                    "uchar" | "uint8" => (x as u8).to_le_bytes().to_vec(),
                    "short" | "int16" => (x as i16).to_le_bytes().to_vec(),
                    "ushort" | "uint16" => (x as u16).to_le_bytes().to_vec(),
                    "int" | "int32" => (x as i32).to_le_bytes().to_vec(),
                    "uint" | "uint32" => (x as u32).to_le_bytes().to_vec(),
                    "float" | "float32" => (x as f32).to_le_bytes().to_vec(),
                    _ => x.to_le_bytes().to_vec(),
                };
                if format == "binary_big_endian" {
                    number.reverse();
                }
                bytes.extend(number);
            }
        }
        bytes
    }
}

fn text() -> String {
    String::from_utf8(Ply::new("float", "uchar", "int").write("ascii")).expect("text")
}

fn is_box(bytes: impl AsRef<[u8]>, what: &str) {
    let file = parse(bytes, "a.ply").unwrap_or_else(|e| panic!("{e}: {what}"));
    assert!((volume(&file) - VOLUME).abs() < 1e-7, "{}: {what}", volume(&file));
    assert!((area(&file) - AREA).abs() < 1e-6, "{}: {what}", area(&file));
    for (found, expected) in bounds(&file)[1].iter().zip([0.2, 0.4, 0.6]) {
        assert!((found - expected).abs() < 1e-7, "{what}");
    }
    assert_eq!(bounds(&file)[0], [0.0; 3], "{what}");
    let (points, triangles) = file.whole();
    assert_eq!((points.len(), triangles.len()), (8, 12), "{what}");
}

/// Writes a letter of Latin-1 into the comment.
fn latin(mut bytes: Vec<u8>) -> Vec<u8> {
    let comment = bytes.windows(5).position(|w| w == b"a box").expect("a comment");
    bytes[comment] = 0xfc;
    bytes
}

/// Returns the error of a file: its line and its text.
fn fault(bytes: impl AsRef<[u8]>) -> (Option<usize>, String) {
    let bytes = bytes.as_ref();
    let error = parse(bytes, "a.ply").expect_err(&String::from_utf8_lossy(bytes));
    let text = error.fault.to_string();
    assert!(text.len() <= 120, "{text}");
    (error.line, text)
}

#[test]
fn every_type_is_read_in_text_and_both_byte_orders() {
    for coordinate in ["float", "double", "float32", "float64"] {
        for length in [
            "char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16", "uint16", "int32", "uint32",
        ] {
            for index in [
                "char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint32",
            ] {
                for format in FORMATS {
                    let what = format!("{coordinate} {length} {index} {format}");
                    is_box(Ply::new(coordinate, length, index).write(format), &what);
                }
            }
        }
    }
    // Decimals of a text keep their last digit, whatever type the header states.
    let exact = text().replace("0.2", "0.20000000000000004");
    let found = bounds(&parse(exact, "a.ply").expect("a box"))[1][0];
    assert_eq!(found, 0.20000000000000004);
}

#[test]
fn line_ends_and_encodings_are_read() {
    let text = text();
    for end in ["\n", "\r", "\r\n"] {
        let text = text.replace('\n', end);
        is_box(&text, end);
        is_box(format!("\u{feff}{text}"), end);
        is_box(format!("{end}{text}{end} {end}"), "blank lines around");
        is_box(text.replace("0.6", &format!("0.6{end}\t")), "blank lines between");
        for unit in [u16::to_le_bytes, u16::to_be_bytes] {
            let wide: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(unit).collect();
            is_box(wide, "UTF-16");
        }
        for format in FORMATS {
            let bytes = Ply::new("double", "uchar", "int").write(format);
            let at = bytes.windows(11).position(|w| w == b"end_header\n").expect("an end") + 11;
            let header = String::from_utf8_lossy(&bytes[..at]).replace('\n', end);
            let bytes = [header.as_bytes(), &bytes[at..]].concat();
            is_box(latin(bytes), &format!("{end:?} {format}"));
        }
    }
    is_box(text.replace("vertex_indices", "vertex_index"), "vertex_index");
    is_box(
        text.replace(" x", " X").replace(" y", " Y").replace(" z", " Z"),
        "capitals",
    );
    is_box(&text, "no extension of the format");
    assert!(parse(text.as_bytes(), "a.stl").is_ok());
    assert!(parse(text.as_bytes(), "a").is_ok());
}

#[test]
fn a_body_whose_first_byte_is_a_line_feed_is_whole() {
    // One row of a list comes first: ten corners, written as the byte of a line feed.
    let header = "element face 1\nproperty list uchar uchar vertex_index\nelement vertex 10\n\
        property float x\nproperty float y\nproperty float z";
    let ring = (0..10).map(|k| ("uchar", f64::from(k)));
    let mut rows = vec![[("uchar", 10.0)].into_iter().chain(ring).collect::<Vec<_>>()];
    for k in 0..10 {
        let (x, y) = (f64::from(k % 5), f64::from(k / 5));
        let x = if k < 5 { x } else { 4.0 - x };
        rows.push([x, y, 0.0].map(|x| ("float", x)).to_vec());
    }
    let ply = Ply {
        header: header.lines().map(Into::into).collect(),
        rows,
    };
    for format in FORMATS {
        let bytes = ply.write(format);
        let at = bytes.windows(11).position(|w| w == b"end_header\n").expect("an end") + 11;
        for end in ["\n", "\r", "\r\n"] {
            let header = String::from_utf8_lossy(&bytes[..at]).replace('\n', end);
            let file = parse([header.as_bytes(), &bytes[at..]].concat(), "a.ply").expect("a face of ten corners");
            assert_eq!(file.whole().1.len(), 8, "{format} {end:?}");
        }
    }
}

#[test]
fn other_properties_elements_and_orders_are_passed_over() {
    let plain = Ply::new("float", "uchar", "int");
    let mut ply = plain.clone();
    ply.header = [
        "obj_info num_cols 512",
        "element material 1",
        "property uchar red",
        "element face 12",
        "property uchar red",
        "property list uchar int vertex_indices",
        "property list uchar float texcoord",
        "element edge 2",
        "property int vertex1",
        "property int vertex2",
        "element vertex 8",
        "property float nx",
        "property double z",
        "property list int short neighbours",
        "property float x",
        "property float y",
        "element camera 0",
        "property float view_px",
        "element unknown 0",
        "property list uchar int indices",
    ]
    .map(Into::into)
    .to_vec();
    let (vertices, faces) = plain.rows.split_at(8);
    ply.rows = vec![vec![("uchar", 7.0)]];
    for (k, face) in faces.iter().enumerate() {
        let length = if k % 2 == 0 { 0.0 } else { 2.0 };
        let coordinates = vec![("float", f64::NAN); length as usize];
        ply.rows
            .push([&[("uchar", 9.0)], &face[..], &[("uchar", length)], &coordinates].concat());
    }
    ply.rows.extend(vec![vec![("int", 0.0), ("int", 1.0)]; 2]);
    for (k, v) in vertices.iter().enumerate() {
        let neighbours = vec![("short", -1.0); k];
        let start = [("float", f64::INFINITY), ("double", v[2].1), ("int", k as f64)];
        ply.rows.push([&start, &neighbours[..], &[v[0], v[1]]].concat());
    }
    for format in FORMATS {
        let bytes = ply.write(format);
        is_box(&bytes, format);
        let file = parse(&bytes, "a.ply").expect("a box");
        let skipped: Vec<(&str, Option<usize>)> = file.skipped.iter().map(|s| (s.what.as_str(), s.line)).collect();
        let expected = [
            ("material", Some(4)),
            ("colors", Some(7)),
            ("texture coordinates", Some(9)),
            ("edge", Some(10)),
            ("normals", Some(14)),
            ("other properties", Some(16)),
        ];
        assert_eq!(skipped, expected, "{format}");
    }
    // Numbers of a text that are not used may be anything.
    let text = String::from_utf8(ply.write("ascii")).expect("text");
    is_box(text.replace("inf ", "-nan(ind) "), "normals that are no numbers");
}

/// Returns the header of the vertices of the box, and their rows.
fn vertices() -> (String, String) {
    let text = text();
    let (header, body) = text.split_once("end_header\n").expect("a body");
    let header = header.split("element face").next().expect("vertices");
    let rows: Vec<&str> = body.lines().take(8).collect();
    (header.into(), rows.join("\n"))
}

#[test]
fn strips_alternate() {
    let (header, rows) = vertices();
    let strips = |lists: &[&str]| {
        let lists: Vec<String> = lists
            .iter()
            .map(|list| format!("{} {list}", list.split(' ').count()))
            .collect();
        let count = lists.len();
        let list = "property list int int vertex_indices";
        let lists = lists.join("\n");
        format!("{header}element tristrips {count}\n{list}\nend_header\n{rows}\n{lists}\n")
    };
    is_box(strips(&["1 3 0 2 4 6 5 7 1 3", "4 5 0 1", "3 7 2 6"]), "three strips");
    is_box(strips(&["1 3 0 2 4 6 5 7 1 3 -1 4 5 0 1 -1 3 7 2 6"]), "restarts");
    is_box(
        strips(&["-1 1 3 0 2 4 6 5 7 1 3 -1 -1 4 5 0 1 -1 3 7 2 6 -1"]),
        "more restarts",
    );
    is_box(strips(&["1 3 0 2 4 6 5 7 1 3 3 4 4 5 0 1", "3 7 2 6"]), "joined strips");
    for list in [
        "0 1 -1 4 5 0 1",
        "4 5 0 1 -1 3",
        "4 5 0 1 -2 3 7 2",
        "4 5 0 8",
        "4 5 5 8",
        "4 5 0 -2",
    ] {
        let (line, why) = fault(strips(&["3 7 2 6", list]));
        assert_eq!(line, Some(20), "{why}");
        assert!(why.starts_with("tristrips 1 has "), "{why}");
    }
}

#[test]
fn notches_stay_open() {
    let quad = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n.4 0 0\n.4 .4 0\n.35 .05 0\n";
    for f in ["4 0 1 2 3", "4 1 2 3 0", "4 2 3 0 1", "4 3 0 1 2"] {
        let file = parse(format!("{quad}{f}\n"), "q.ply").expect("a quad");
        assert!((area(&file) - 0.02).abs() < 1e-12, "{}", area(&file));
    }
    let (line, why) = fault(format!("{quad}4 0 2 1 3\n").replace(".35 .05", ".1 .4"));
    assert_eq!(line, Some(14));
    assert!(why.starts_with("face 0 is invalid: polygon is not simple"), "{why}");
}

#[test]
fn a_fault_in_any_row_is_named() {
    let ply = Ply::new("double", "uchar", "int");
    // Numbers that cannot be right, in the first, a middle and the last row of each element.
    let faults: [(&str, usize, f64, &str); 9] = [
        ("vertex", 0, f64::NAN, "not finite"),
        ("vertex", 1, f64::INFINITY, "not finite"),
        ("vertex", 2, f64::NEG_INFINITY, "not finite"),
        ("face", 0, 0.0, ""),
        ("face", 0, 2.0, ""),
        ("face", 1, 8.0, "invalid vertex: 8"),
        ("face", 2, -1.0, "invalid vertex: -1"),
        ("face", 3, 2_147_483_647.0, "invalid vertex: 2147483647"),
        ("face", 2, 1000.0, "invalid vertex: 1000"),
    ];
    for (element, column, value, expected) in faults {
        let rows = if element == "vertex" { [0, 3, 7] } else { [8, 13, 19] };
        for row in rows {
            let mut ply = ply.clone();
            ply.rows[row][column].1 = value;
            for format in FORMATS {
                let (line, why) = fault(ply.write(format));
                assert!(why.contains(expected), "{why}");
                let is_text = format == "ascii";
                assert_eq!(line.is_some(), is_text, "{why}");
                if is_text && element == "face" {
                    assert_eq!(line, Some(11 + row), "{why}");
                    assert!(why.starts_with(&format!("face {} ", row - 8)), "{why}");
                }
            }
        }
    }
    // A face with a corner twice has no area.
    for row in [8, 13, 19] {
        let mut ply = ply.clone();
        ply.rows[row][3].1 = ply.rows[row][1].1;
        for format in FORMATS {
            let file = MeshFile::parse(&ply.write(format), "a.ply").expect("a mesh");
            assert_eq!(file.objects[0].triangles.len(), 11);
            assert!(
                file.skipped.iter().any(|one| one.what == "faces without area"),
                "{:?}",
                file.skipped
            );
        }
    }
    // Points that no face uses may be anything.
    let mut unused = ply.with_vertex([f64::NAN; 3]);
    for format in FORMATS {
        is_box(unused.write(format), "an unused vertex");
    }
    unused.rows[8 + 5][2].1 = 8.0;
    for format in FORMATS {
        assert!(fault(unused.write(format)).1.contains("not finite: 8"));
    }
}

#[test]
fn a_fault_in_any_line_of_a_text_is_named_with_its_line() {
    let text = text();
    let lines: Vec<&str> = text.lines().collect();

    assert_eq!(lines[10 - 1], "end_header");
    for [first, fault_line] in cases("faults of a row") {
        let rows = if first == "11" { [11, 15, 18] } else { [19, 26, 30] };
        for at in rows {
            let mut lines = lines.clone();
            lines[at - 1] = &fault_line;
            let text = lines.join("\n") + "\n";
            for bytes in encodings(&text).into_iter().chain([latin(text.clone().into_bytes())]) {
                let (line, why) = fault(bytes);
                assert_eq!(line, Some(at), "{fault_line}: {why}");
            }
        }
    }
    // Lines more or less shift the rows, and are found at the end of the file at the latest.
    for at in [11, 15, 19, 25, 30] {
        let mut less = lines.clone();
        less.remove(at - 1);
        assert!(fault(less.join("\n")).0.is_some());
        let mut more = lines.clone();
        more.insert(at - 1, lines[at - 1]);
        assert!(fault(more.join("\n")).0.is_some());
    }
    let (line, why) = fault(text.clone() + "3 0 1 2\n");
    assert_eq!(line, Some(31), "{why}");
}

#[test]
fn a_fault_of_the_header_is_named_with_its_line() {
    let text = text();

    for [at, old, new] in cases("faults of a header") {
        assert!(text.contains(&old), "{old}");
        for format in FORMATS {
            let bytes = Ply::new("float", "uchar", "int").write(format);
            let header = bytes.windows(11).position(|w| w == b"end_header\n").expect("an end") + 11;
            let text = String::from_utf8_lossy(&bytes[..header]).replacen(
                &old.replace("ascii", format),
                &new.replace("ascii", format),
                1,
            );
            for end in ["\n", "\r", "\r\n"] {
                let (line, why) = fault([text.replace('\n', end).as_bytes(), &bytes[header..]].concat());
                assert_eq!(line, at.parse().ok(), "{new}: {why}");
            }
        }
    }
    for cut in [
        "ply\n",
        "ply\nformat ascii 1.0\n",
        text.split("end_header").next().expect("a header"),
    ] {
        assert!(fault(cut).1.contains("header is cut"));
    }
    let both = text.replace("property list", "property list uchar int vertex_index\nproperty list");
    assert!(fault(both).1.contains("once"));
    let other = text.replace("property list", "property list uchar int holes\nproperty list");
    assert!(fault(other).1.contains("list of integers"));
}

#[test]
fn counts_are_not_believed() {
    let start = std::time::Instant::now();
    for format in FORMATS {
        let ply = Ply::new("float", "uint", "int");
        let good = ply.write(format);
        for cut in 0..good.len() - 1 {
            assert!(parse(&good[..cut], "a.ply").is_err(), "{format} {cut}");
        }
        for end in [&b"\x01"[..], b"3 0 1 2\n", b"0"] {
            let why = fault([&good, end].concat()).1;
            assert!(why.contains("the last row") || why.contains("number too many"), "{why}");
        }
        for count in ["0", "7", "9", "4000000000", "18446744073709551615"] {
            for (element, old) in [("vertex", "8"), ("face", "12")] {
                let mut ply = ply.clone();
                let line = format!("element {element} {old}");
                let line = ply.header.iter_mut().find(|l| **l == line).expect("an element");
                *line = format!("element {element} {count}");
                assert!(parse(ply.write(format), "a.ply").is_err(), "{element} {count}");
                // Rows without properties have no bytes.
                ply.header = vec![format!("element {element} {count}")];
                assert!(parse(ply.write(format), "a.ply").is_err(), "{element} {count}");
            }
        }
        for row in [8, 13, 19] {
            let mut ply = ply.clone();
            ply.rows[row][0].1 = 4_294_967_295.0;
            assert!(fault(ply.write(format)).1.contains("is cut"));
        }
    }
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    let points = text().replace("element face 12", "element face 0");
    let points = points.split("3 0 1 3").next().expect("vertices");
    assert!(fault(points).1.contains("a point cloud"));
    let file = MeshFile::parse_for_hull(points.as_bytes(), "a.ply").expect("points of a hull");
    assert_eq!(file.whole(), (BOX.to_vec(), vec![]));
    let points = points.replacen("0.6", "nan", 1);
    says(
        MeshFile::parse_for_hull(points.as_bytes(), "a.ply"),
        "vertex 1 is not finite",
    );
}

#[test]
fn mutants_are_read_or_named() {
    let start = std::time::Instant::now();
    let (header, rows) = vertices();
    let strips = format!(
        "{header}element tristrips 1\nproperty list int int vertex_indices\nend_header\n{rows}\n\
        12 1 3 0 2 4 6 -1 4 5 0 1 3\n"
    );
    read_mutants(strips.as_bytes(), "a.ply", 10_000);
    for format in FORMATS {
        let mut ply = Ply::new("float", "uchar", "int");
        ply.header[5] = "element face 13".into();
        let ring = [5.0, 0.0, 1.0, 3.0, 2.0, 0.0].map(|x| ("int", x));
        ply.rows.push([&[("uchar", 5.0)], &ring[1..]].concat());
        read_mutants(&ply.write(format), "a.ply", 20_000);
    }
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}
