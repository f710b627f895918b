//! Points of PLY, PCD, XYZ and npy files: none is lost, moved or invented, and what does not fit is an error.

mod support;

use lin_canny_formats::{FormatFault, Grid, Invalid, PointFile, PointFormat, Points};
use support::rows::rows;
use support::{encodings, mutants, with_ends};

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    rows(include_str!("points/rows.txt"), section)
}

fn read(bytes: impl AsRef<[u8]>, name: &str) -> PointFile {
    let bytes = bytes.as_ref();
    PointFile::parse(bytes, name).unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(bytes)))
}

/// Returns the error of a file: its line and its text.
fn fault(bytes: impl AsRef<[u8]>, name: &str) -> (Option<usize>, String) {
    let bytes = bytes.as_ref();
    let error = PointFile::parse(bytes, name).expect_err(&String::from_utf8_lossy(bytes));
    let text = error.fault.to_string();
    assert!(text.len() <= 160, "{text}");
    (error.line, text)
}

#[track_caller]
fn is_fault((line, text): (Option<usize>, String), expected: Option<usize>, words: &str) {
    assert_eq!((line, text.as_str()), (expected, words));
}

/// The error of a file says some words.
#[track_caller]
fn fault_says(bytes: impl AsRef<[u8]>, name: &str, words: &str) {
    let (_, text) = fault(bytes, name);
    assert!(text.contains(words), "{text}");
}

/// What was passed over, and its line.
type Passed<'a> = (&'a str, Option<usize>);

fn skipped(file: &PointFile) -> Vec<Passed<'_>> {
    file.skipped.iter().map(|s| (s.what.as_str(), s.line)).collect()
}

const NAN: f32 = f32::NAN;

/// Points of which the second and the last have no return.
const CAMERA: [[f32; 3]; 5] = [
    [0.5, -1.25, 2.0],
    [NAN, NAN, NAN],
    [0.1, 4.0, 5.5],
    [1e-30, -0.0, 3e38],
    [0.0, f32::INFINITY, 1.0],
];

fn is_camera(file: &PointFile, what: &str) {
    let expected = Points::F32(vec![CAMERA[0], CAMERA[2], CAMERA[3]]);
    assert_eq!(file.points, expected, "{what}");
    assert_eq!((file.dropped, &file.radii), (2, &None), "{what}");
}

/// The same points in a text.
fn is_camera_text(file: &PointFile, what: &str) {
    let points = vec![[0.5, -1.25, 2.0], [0.1, 4.0, 5.5], [1e-30, -0.0, 3e38]];
    assert_eq!(file.points, Points::F64(points), "{what}");
    assert_eq!((file.dropped, &file.radii), (2, &None), "{what}");
}

const CAMERA_TEXT: &str = "0.5 -1.25 2\nnan NaN -nan(ind)\n.1 4 5.5\n1e-30 -0 3e38\n0 inf 1\n";

fn refuses(bytes: &[u8], name: &str, line: Option<usize>) {
    let error = PointFile::parse_with(bytes, name, Invalid::Refuse).expect_err(name);
    assert!(matches!(error.fault, FormatFault::Invalid { index: 1, .. }), "{error}");
    assert_eq!(error.line, line, "{error}");
}

fn ply(format: &str, properties: &str, count: usize, body: &[u8]) -> Vec<u8> {
    let header = format!("ply\nformat {format} 1.0\nelement vertex {count}\n{properties}end_header\n");
    [header.as_bytes(), body].concat()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

#[test]
fn vertices_of_a_ply_are_points() {
    let little: Vec<u8> = CAMERA.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let big: Vec<u8> = CAMERA.iter().flatten().flat_map(|x| x.to_be_bytes()).collect();
    for (format, body) in [("binary_little_endian", little), ("binary_big_endian", big)] {
        let bytes = ply(format, XYZ, 5, &body);
        let file = read(&bytes, "a.xyz");
        is_camera(&file, format);
        assert_eq!((file.format, skipped(&file)), (PointFormat::Ply, vec![]));
        refuses(&bytes, "a.ply", None);
        fault_says(&bytes[..bytes.len() - 1], "a.ply", "vertex 4 is cut");
        fault_says([&bytes[..], b"\n"].concat(), "a.ply", "1 bytes follow");
    }
    let text = String::from_utf8(ply("ascii", XYZ, 5, CAMERA_TEXT.as_bytes())).expect("text");
    for bytes in encodings(&text) {
        is_camera_text(&read(&bytes, "a"), "text");
        refuses(&bytes, "a.ply", Some(9));
    }
    // A decimal keeps its digits, and is no infinity.
    let file = read(text.replace("5.5", "5.500000001"), "a.ply");
    assert_eq!(file.points.to_f64()[1][2], 5.500000001);
    is_fault(
        fault(text.replace("5.5", "1e400"), "a.ply"),
        Some(10),
        "vertex 2 has an invalid number: \"1e400\"",
    );
}

#[test]
fn faces_and_properties_of_a_ply_are_listed() {
    let properties = "property uchar red\nproperty float nx\nproperty double z\nproperty float radius\nproperty list uchar int views\n\
        property float X\nproperty short y\nproperty float intensity\nelement face 2\nproperty list uchar int vertex_indices\n\
        element range_grid 2\nproperty list uchar int vertex_indices\nelement camera 0\nproperty float w\n";
    let body = "255 0 3.1 0.5 2 7 7 1.1 2 9\n0 nan 4 0 0 5 6 9\n3 0 1 0\n3 0 0 9\n0\n1 0\n";
    let file = read(ply("ascii", properties, 2, body.as_bytes()), "a.ply");
    assert_eq!(file.points, Points::F64(vec![[1.1, 2.0, 3.1], [5.0, 6.0, 4.0]]));
    assert_eq!(file.radii, Some(vec![0.5, 0.0]));
    let expected = [
        ("colors", Some(4)),
        ("normals", Some(5)),
        ("\"views\"", Some(8)),
        ("\"intensity\"", Some(11)),
        ("\"face\"", Some(12)),
        ("\"range_grid\"", Some(14)),
    ];
    assert_eq!(skipped(&file), expected);
    for radius in ["-0.5", "nan", "inf"] {
        let (line, why) = fault(
            ply("ascii", properties, 2, body.replace("0.5", radius).as_bytes()),
            "a.ply",
        );
        assert_eq!(line, Some(19), "{why}");
        assert!(why.starts_with("point 0 has an invalid radius: "), "{why}");
    }
    // Mixed types are double, and a point without a return needs no radius.
    let properties = "property float x\nproperty double y\nproperty float z\nproperty float radius\n";
    let mut body = Vec::new();
    for (y, radius) in [(0.1, 2.0), (f64::NAN, NAN)] {
        body.extend(
            [
                1f32.to_le_bytes().as_slice(),
                &y.to_le_bytes(),
                &3f32.to_le_bytes(),
                &f32::to_le_bytes(radius),
            ]
            .concat(),
        );
    }
    let file = read(ply("binary_little_endian", properties, 2, &body), "a.ply");
    assert_eq!(file.points, Points::F64(vec![[1.0, 0.1, 3.0]]));
    assert_eq!((file.dropped, file.radii), (1, Some(vec![2.0])));
}

#[test]
fn files_without_points_have_their_own_errors() {
    for name in ["a.ply", "a.pcd", "a.npy", "a.xyz", "a.bin"] {
        let faults = [
            ("", "the file is empty"),
            (" \n\t", "the file is empty"),
            (
                "version https://git-lfs.github.com/spec/v1\noid sha256:1\n",
                "pointer of Git LFS",
            ),
            ("<!DOCTYPE html><html>", "page of HTML"),
            ("PK\x03\x04...", "an archive, such as .npz"),
        ];
        for (text, expected) in faults {
            let (line, why) = fault(text, name);
            assert!(line.is_none() && why.contains(expected), "{why}");
        }
    }
    fault_says("1 2 3\n", "a.obj", "unknown file extension");
    let found = fault(ply("ascii", XYZ, 0, b""), "a.ply").1;
    assert_eq!(found, "the file contains no point");
    assert_eq!(fault("# x y z\n", "a.xyz").1, "the file contains no point");
    let faces = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0\n";
    assert_eq!(fault(faces, "a.ply").1, "the file contains no point");
    let none = "the file contains no point that is finite (2 are not)";
    assert_eq!(fault("nan nan nan\n1 2 inf\n", "a.xyz").1, none);
    assert!(matches!(
        PointFile::read("/no folder/a.xyz").expect_err("no file").fault,
        FormatFault::Read(_)
    ));
}

// Written by pypcd4 1.5.1: six points, of which the fourth has no return.
const PCD: [&[u8]; 3] = [
    b"ascii\n1.0 2.0 3.0\n1.0 2.0 3.0\n1.0 2.0 -3.5\nnan nan nan\n1.0 2.0 3.0\n1.0 2.0 3.0\n",
    b"binary\n\x00\x00\x80?\x00\x00\x00@\x00\x00@@\x00\x00\x80?\x00\x00\x00@\x00\x00@@\x00\x00\x80?\x00\x00\x00@\x00\x00`\xc0\
    \x00\x00\xc0\x7f\x00\x00\xc0\x7f\x00\x00\xc0\x7f\x00\x00\x80?\x00\x00\x00@\x00\x00@@\x00\x00\x80?\x00\x00\x00@\x00\x00@@",
    b"binary_compressed\n)\x00\x00\x00H\x00\x00\x00\x04\x00\x00\x80?\x00\xe0\x00\x03\x01\xc0\x7f\xe0\x01\x0b\x01\x00@\xe0\x01\x03@\
    \x17\xc0\x0f\x00@ \x17@\x03\x01`\xc0\x80\x17@\x0b\x01@@",
];
const PCD_HEADER: &str = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 6\nHEIGHT 1\nVIEWPOINT 0.0 0.0 0.0 1.0 0.0 0.0 0.0\n\
    POINTS 6\nDATA ";

fn pcd(header: &str, data: &[u8]) -> Vec<u8> {
    [header.as_bytes(), data].concat()
}

#[test]
fn text_binary_and_compressed_pcd_are_the_same_points() {
    let expected = vec![
        [1.0, 2.0, 3.0],
        [1.0, 2.0, 3.0],
        [1.0, 2.0, -3.5],
        [1.0, 2.0, 3.0],
        [1.0, 2.0, 3.0],
    ];
    for (k, data) in PCD.iter().enumerate() {
        for header in [
            PCD_HEADER.to_owned(),
            format!("# .PCD v.7 - Point Cloud Data file format\n{PCD_HEADER}"),
            PCD_HEADER.replace("WIDTH 6\nHEIGHT 1", "WIDTH 2\nHEIGHT 3"),
            PCD_HEADER.replace("POINTS 6\n", ""),
            PCD_HEADER.replace("WIDTH 6\nHEIGHT 1\n", ""),
            PCD_HEADER.replace("COUNT 1 1 1\n", ""),
            PCD_HEADER.replace("FIELDS", "COLUMNS"),
            PCD_HEADER.replace('\n', "\r\n"),
            PCD_HEADER.replace("VIEWPOINT 0.0 0.0 0.0 1.0 0.0 0.0 0.0\n", "\n# a comment\n"),
        ] {
            let data: Vec<u8> = if header.contains('\r') {
                let end = data.iter().position(|b| *b == b'\n').expect("a line");
                [&data[..end], b"\r", &data[end..]].concat()
            } else {
                data.to_vec()
            };
            let bytes = pcd(&header, &data);
            let file = read(&bytes, "a.pcd");
            assert_eq!(file.points.to_f64(), expected, "{header}");
            assert_eq!(matches!(file.points, Points::F32(_)), k > 0);
            assert_eq!(file.dropped, 1);
            assert_eq!(skipped(&file), vec![]);
            assert_eq!(file.format, PointFormat::Pcd);
            let error = PointFile::parse_with(&bytes, "a.pcd", Invalid::Refuse).expect_err("a point without a return");
            assert!(matches!(error.fault, FormatFault::Invalid { index: 3, .. }), "{error}");
            assert_eq!(error.line.is_some(), k == 0);
            // All points keep their rows.
            let kept = PointFile::parse_with(&bytes, "a.pcd", Invalid::Keep).expect("points");
            let all = kept.points.to_f64();
            assert_eq!((all.len(), kept.dropped), (expected.len() + 1, 0));
            assert!(all[3].iter().any(|x| !x.is_finite()));
            let finite = all.iter().filter(|point| point.iter().all(|x| x.is_finite()));
            assert!(finite.eq(&expected));
        }
        let bytes = pcd(PCD_HEADER, data);
        assert_eq!(read(&bytes, "a.xyz").format, PointFormat::Pcd);
        // Without its last digits, a number of a text is another number.
        for cut in 0..bytes.len() - if k == 0 { 4 } else { 1 } {
            assert!(PointFile::parse(&bytes[..cut], "a.pcd").is_err(), "{cut}");
        }
        for more in [&b"\x01"[..], b"1 2 3\n"] {
            let why = fault(pcd(PCD_HEADER, &[data, more].concat()), "a.pcd").1;
            assert!(
                why.contains("follow") || why.contains("compressed data (expected 41)"),
                "{why}"
            );
        }
    }
    let text = String::from_utf8(pcd(PCD_HEADER, PCD[0])).expect("text");
    for bytes in with_ends(&text, &["\n", "\r\n"]) {
        assert_eq!(read(bytes, "a.pcd").points.to_f64(), expected);
    }
}

#[test]
fn fields_and_the_viewpoint_of_a_pcd_are_listed() {
    let header = "# .PCD v.7\nVERSION .7\nFIELDS _ rgb z normal_x histogram y radius intensity x\nSIZE 1 4 8 4 4 2 4 1 4\nTYPE U U F F F I F U F\n\
        COUNT 3 1 1 1 2 1 1 1 1\nWIDTH 1\nHEIGHT 2\nVIEWPOINT 0 0 1.5 1 0 0 0\nPOINTS 2\nDATA ";
    let rows = [(0.1f64, -7i16, 0.25f32, 1.5f32), (1e300, 9, 0.0, -0.1)];
    let (mut binary, mut text) = (b"binary\n".to_vec(), "ascii\n".to_owned());
    for (z, y, radius, x) in rows {
        binary.extend([1; 3 + 4]);
        binary.extend(z.to_le_bytes());
        binary.extend([2; 4 + 8]);
        binary.extend([&y.to_le_bytes()[..], &radius.to_le_bytes(), &[3], &x.to_le_bytes()].concat());
        text += &format!("1 1 1 c {z:?} n nan 7 {y} {radius} {} {x}\n", i8::MIN);
    }
    for (data, tenth) in [(&binary[..], f64::from(0.1f32)), (text.as_bytes(), 0.1)] {
        let file = read(pcd(header, data), "a.pcd");
        assert_eq!(file.points, Points::F64(vec![[1.5, -7.0, 0.1], [-tenth, 9.0, 1e300]]));
        assert_eq!(file.radii, Some(vec![0.25, 0.0]));
        let line = Some(3);
        let expected = [
            ("colors", line),
            ("normals", line),
            ("\"histogram\"", line),
            ("\"intensity\"", line),
            ("VIEWPOINT 0.0 0.0 1.5 1.0 0.0 0.0 0.0", Some(9)),
        ];
        assert_eq!(skipped(&file), expected);
    }
}

/// PCL writes into a map of the file, which is as long as a page, or a page longer than the data.
#[test]
fn zeros_up_to_a_page_behind_the_data_of_a_pcd_are_listed() {
    for (k, data) in PCD.iter().enumerate() {
        let bytes = pcd(PCD_HEADER, data);
        let expected = read(&bytes, "a.pcd").points;
        let with = |more: &[u8]| PointFile::parse(&[&bytes[..], more].concat(), "a.pcd");
        let header = PCD_HEADER.len() + data.iter().position(|b| *b == b'\n').expect("a line") + 1;
        for length in [4096 - bytes.len(), 4096 - header, 65_536 - header] {
            let padded = with(&vec![0; length]);
            match padded {
                Ok(file) if k > 0 => {
                    assert_eq!(file.points, expected, "{length}");
                    assert_eq!(skipped(&file), [("zeros behind the data", None)]);
                }
                _ => assert!(k == 0 && padded.is_err(), "{k} {length}"),
            }
            let mut wrong = vec![0; length];
            wrong[length / 2] = 1;
            assert!(with(&wrong).is_err(), "{k} {length}");
        }
        // The sizes of compressed data are stated twice, those of other data by the header alone.
        assert_eq!(with(&[0; 12]).is_ok(), k == 2);
        assert!(with(&vec![0; 1 << 17]).is_err());
    }
}

#[test]
fn a_field_without_numbers_of_a_pcd_has_no_data() {
    let header = PCD_HEADER
        .replace("x y z", "x rgb y z radius")
        .replace("4 4 4", "4 4 4 4 4")
        .replace("F F F", "F F F F F")
        .replace("1 1 1\n", "1 0 1 1 0\n");
    for data in PCD {
        let file = read(pcd(&header, data), "a.pcd");
        assert_eq!(file.points, read(pcd(PCD_HEADER, data), "a.pcd").points);
        assert_eq!(file.radii, None);
        assert_eq!(skipped(&file), [("colors", Some(2)), ("\"radius\"", Some(2))]);
    }
}

#[test]
fn a_fault_of_a_pcd_is_named_with_its_line() {
    for [line, old, new] in cases("faults of a PCD header") {
        for data in PCD {
            let bytes = pcd(&PCD_HEADER.replacen(&old, &new, 1), data);
            let (at, why) = fault(bytes, "a.pcd");
            assert_eq!(at, line.parse().ok(), "{new}: {why}");
        }
    }
    // The data does not fit.
    for (old, new) in [
        ("WIDTH 6", "WIDTH 4000000000000"),
        ("SIZE 4 4 4", "SIZE 8 8 8"),
        ("COUNT 1 1 1\n", "COUNT 18446744073709551615 1 1\n"),
    ] {
        for data in &PCD[1..] {
            let header = PCD_HEADER.replace(old, new).replace("POINTS 6\n", "");
            assert!(PointFile::parse(&pcd(&header, data), "a.pcd").is_err(), "{new}");
        }
    }
    let integers = PCD_HEADER.replace("TYPE F F F", "TYPE I F F");
    fault_says(pcd(&integers, PCD[2]), "a.pcd", "compressed integers");
    let half = PCD_HEADER.replace("SIZE 4 4 4", "SIZE 2 4 4");
    let data: Vec<u8> = [b"binary\n".to_vec(), vec![0; 60]].concat();
    let found = fault(pcd(&half, &data), "a.pcd").1;
    assert_eq!(found, "the type of the field x is not supported");
    // Rows of a text.
    let text = String::from_utf8(pcd(PCD_HEADER, PCD[0])).expect("text");
    for at in [11, 13, 16] {
        for (row, expected) in [
            ("1 2", "has 2 numbers (expected 3)"),
            ("1 2 3 4", "has 4 numbers"),
            ("1 2 x", "has an invalid number: \"x\""),
            ("1 2 1e400", "has an invalid number"),
            ("1,5 2 3", "has an invalid number"),
        ] {
            let mut lines: Vec<&str> = text.lines().collect();
            lines[at - 1] = row;
            for bytes in with_ends(&(lines.join("\n") + "\n"), &["\n", "\r\n"]) {
                let (line, why) = fault(bytes, "a.pcd");
                assert_eq!(line, Some(at), "{why}");
                assert!(why.starts_with(&format!("point {} {expected}", at - 11)), "{why}");
            }
        }
    }
    is_fault(
        fault(text.clone() + "1 2 3\n", "a.pcd"),
        Some(17),
        "line follows the last point: \"1 2 3\"",
    );
    is_fault(
        fault(text.replace("1.0 2.0 -3.5\n", ""), "a.pcd"),
        Some(15),
        "point 5 is missing at the end of the file",
    );
}

#[test]
fn compressed_data_that_points_nowhere_is_an_error() {
    let header = PCD_HEADER.replace('6', "1");
    let data = |bytes: &[u8], size: u32| {
        let sizes = [(bytes.len() as u32).to_le_bytes(), size.to_le_bytes()].concat();
        pcd(&header, &[b"binary_compressed\n", &sizes[..], bytes].concat())
    };
    // Three zeros: four literals, and eight bytes that repeat them.
    let good = [3, 0, 0, 0, 0, 0xc0, 3];
    assert_eq!(read(data(&good, 12), "a.pcd").points, Points::F32(vec![[0.0; 3]]));
    for bad in [
        &[3, 0, 0, 0, 0, 0xc0, 4][..],
        &[3, 0, 0, 0, 0, 0xc0],
        &[3, 0, 0, 0, 0, 0xe0],
        &[3, 0, 0, 0, 0, 0xe0, 255, 3],
        &[3, 0, 0, 0, 0, 0xa0, 3],
        &[3, 0, 0, 0, 0, 0xc0, 3, 0, 0],
        &[31, 0, 0],
        &[0xc0, 0],
        &[],
    ] {
        fault_says(data(bad, 12), "a.pcd", "compressed data is invalid at byte ");
    }
    fault_says(data(&good, 13), "a.pcd", "states 13 bytes (expected 12");
    let many = header
        .replace("WIDTH 1\n", "WIDTH 300000000\n")
        .replace("POINTS 1", "POINTS 300000000");
    let sizes = [7u32.to_le_bytes(), 3_600_000_000u32.to_le_bytes()].concat();
    let bytes = pcd(&many, &[b"binary_compressed\n", &sizes[..], &good].concat());
    fault_says(bytes, "a.pcd", "invalid at byte");
}

#[test]
fn columns_of_a_text_are_read_by_rule_or_by_name() {
    for bytes in encodings(CAMERA_TEXT) {
        for name in ["a.xyz", "a.txt", "a.csv", "a.asc", "a.pts", "A.XYZ"] {
            let file = read(&bytes, name);
            is_camera_text(&file, name);
            assert_eq!((file.format, skipped(&file)), (PointFormat::Xyz, vec![]));
            refuses(&bytes, name, Some(2));
        }
    }
    is_camera_text(&read(CAMERA_TEXT.replace('\n', "\r"), "a.xyz"), "CR");
    let points = Points::F64(vec![[1.0, 2.5, -3.0], [4.0, 5.0, 6e2]]);
    let forms: [(&str, &[Passed]); 18] = [
        ("1 2.5 -3\n4 5 6e2\n", &[]),
        ("+1\t2.5\t-3\n  4   5 \t 6e2", &[]),
        ("1,2.5,-3\n4,5,6e2\n", &[]),
        ("1, 2.5, -3\n\n4, 5, 6e2\n\n", &[]),
        ("1;2.5;-3\n4; 5;6e2\n", &[]),
        ("# made by hand\n// x y z in mm\n1 2.5 -3\n# more\n4 5 6e2\n//end", &[]),
        ("2\n1 2.5 -3\n4 5 6e2\n", &[]),
        ("# points\n2\n# x y z\n1 2.5 -3\n4 5 6e2\n", &[]),
        ("x y z\n1 2.5 -3\n4 5 6e2\n", &[]),
        ("\"X\",\"Y\",\"Z\"\n1,2.5,-3\n4,5,6e2\n", &[]),
        ("1 2.5 -3 7\n4 5 6e2 8\n", &[("column 4", Some(1))]),
        ("# a\n1 2.5 -3 7 b nan\n4 5 6e2 8 c -\n", &[("columns 4 to 6", Some(2))]),
        (
            "x,y,z,nx,ny,nz,label\n1,2.5,-3,0,0,1,a\n4,5,6e2,0,0,1,b",
            &[("normals", Some(1)), ("\"label\"", Some(1))],
        ),
        ("//X Y Z R G B\n1 2.5 -3 0 1 2\n4 5 6e2 0 0 1", &[("colors", Some(1))]),
        ("id;z;y;x\n17;-3;2.5;1\n18;6e2;5;4", &[("\"id\"", Some(1))]),
        ("# z x y\n-3 1 2.5\n6e2 4 5\n", &[]),
        ("# z x y first and then more\n1 2.5 -3\n4 5 6e2\n", &[]),
        (
            "2\nintensity x y z\n9 1 2.5 -3\n9 4 5 6e2\n",
            &[("\"intensity\"", Some(2))],
        ),
    ];
    for (text, expected) in forms {
        for bytes in encodings(text) {
            let file = read(bytes, "a.xyz");
            assert_eq!(file.points, points, "{text}");
            assert_eq!(skipped(&file), expected, "{text}");
        }
    }
    let file = read("x y z radius\n1 2.5 -3 0.5\nnan 0 0 -1\n4 5 6e2 0\n", "a.xyz");
    assert_eq!((file.points, file.radii), (points, Some(vec![0.5, 0.0])));
    // The names of more columns than anybody reads are not listed one by one.
    let names: String = (0..100).map(|k| format!(" n{k}")).collect();
    let file = read(format!("x y z{names}\n1 2 3{}\n", " 0".repeat(100)), "a.xyz");
    assert_eq!(file.skipped.len(), 33);
    assert_eq!(file.skipped[32].what, "other properties");
}

#[test]
fn a_fault_of_a_text_is_named_with_its_line() {
    for [line, text, expected] in cases("faults of a text") {
        for bytes in encodings(&text) {
            let (at, why) = fault(bytes, "a.xyz");
            assert!(why.starts_with(&expected), "{text}: {why}");
            assert_eq!(at, line.parse().ok(), "{why}");
        }
    }
}

/// Returns an array as numpy writes it.
fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn header(descr: &str, is_fortran: bool, shape: &str) -> String {
    let order = if is_fortran { "True" } else { "False" };
    format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}      \n")
}

/// Writes a number in some type.
type Write = fn(u8) -> Vec<u8>;

fn le<const N: usize>(numbers: [f32; N]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn arrays_written_by_numpy_are_read() {
    // np.array([[0.5, -1.25, 2], [nan] * 3, [3, 4, 5.5]], dtype='<f4')
    let bytes = b"\x93NUMPY\x01\x00v\x00{'descr': '<f4', 'fortran_order': False, 'shape': (3, 3), }                                  \
        \x20                       \x0a\x00\x00\x00?\x00\x00\xa0\xbf\x00\x00\x00@\x00\x00\xc0\x7f\x00\x00\xc0\x7f\x00\x00\xc0\x7f\x00\x00@@\
        \x00\x00\x80@\x00\x00\xb0@";
    let file = read(bytes, "a.xyz");
    assert_eq!(file.points, Points::F32(vec![[0.5, -1.25, 2.0], [3.0, 4.0, 5.5]]));
    assert_eq!(file.dropped, 1);
    assert_eq!(file.format, PointFormat::Npy);
    assert_eq!(skipped(&file), vec![]);
    refuses(bytes, "a.npy", None);
    // An aligned structure of rgb <u4, z <f8, x <f4, y <i2 and n 3 <f4.
    let header = "{'descr': [('rgb', '<u4'), ('', '|V4'), ('z', '<f8'), ('x', '<f4'), ('y', '<i2'), ('', '|V2'), \
        ('n', '<f4', (3,)), ('', '|V4')], 'fortran_order': False, 'shape': (2,), }";
    let start = b"\x93NUMPY\x01\x00\xf6\x00";
    let data = b"\
        \x00\x00\x00\x00\x00\x00\x00\x00\x9a\x99\x99\x99\x99\x99\xb9?\x00\x00\x80?\
        \xfd\xff\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\
        \x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x1c@\x00\x00\x00@\
        \x04\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00";
    let bytes = [&start[..], format!("{header:245}\n").as_bytes(), data].concat();
    let file = read(bytes, "a.npy");
    assert_eq!(file.points, Points::F64(vec![[1.0, -3.0, 0.1], [2.0, 4.0, 7.0]]));
    assert_eq!(skipped(&file), [("colors", None), ("\"n\"", None)]);
}

#[test]
fn types_orders_and_shapes_of_arrays_are_read() {
    let expected = vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    for version in [1, 2, 3] {
        for (is_fortran, numbers) in [(false, [1, 2, 3, 4, 5, 6]), (true, [1, 4, 2, 5, 3, 6])] {
            let types: [(&str, Write); 14] = [
                ("'<f4'", |x| f32::from(x).to_le_bytes().to_vec()),
                ("'>f4'", |x| f32::from(x).to_be_bytes().to_vec()),
                ("'<f8'", |x| f64::from(x).to_le_bytes().to_vec()),
                ("\">f8\"", |x| f64::from(x).to_be_bytes().to_vec()),
                ("'|i1'", |x| vec![x]),
                ("'|u1'", |x| vec![x]),
                ("'<i2'", |x| u16::from(x).to_le_bytes().to_vec()),
                ("'>u2'", |x| u16::from(x).to_be_bytes().to_vec()),
                ("'<i4'", |x| u32::from(x).to_le_bytes().to_vec()),
                ("'>u4'", |x| u32::from(x).to_be_bytes().to_vec()),
                ("'<i8'", |x| u64::from(x).to_le_bytes().to_vec()),
                ("'>i8'", |x| u64::from(x).to_be_bytes().to_vec()),
                ("'<u8'", |x| u64::from(x).to_le_bytes().to_vec()),
                ("'>u8'", |x| u64::from(x).to_be_bytes().to_vec()),
            ];
            for (descr, write) in types {
                for shape in ["(2, 3)", "(2,3)", "(1, 2, 3)", "(2, 1, 3)", "(2L, 3L)"] {
                    let data: Vec<u8> = numbers.into_iter().flat_map(write).collect();
                    let bytes = npy(version, &header(descr, is_fortran, shape), &data);
                    let file = read(bytes, "a.npy");
                    assert_eq!(file.points.to_f64(), expected, "{descr} {shape}");
                    assert_eq!(matches!(file.points, Points::F32(_)), descr.contains("f4"));
                }
            }
        }
    }
    // An image of 2 x 3 points with four columns, whose numbers tell row, column and axis.
    let number = |i: usize, j: usize, k: usize| (100 * i + 10 * j + k) as f32;
    let mut expected = Vec::new();
    let (mut c, mut fortran) = (Vec::new(), Vec::new());
    for i in 0..2 {
        for j in 0..3 {
            expected.push([0, 1, 2].map(|k| number(i, j, k)));
            c.extend((0..4).flat_map(|k| number(i, j, k).to_le_bytes()));
        }
    }
    for k in 0..4 {
        for j in 0..3 {
            fortran.extend((0..2).flat_map(|i| number(i, j, k).to_le_bytes()));
        }
    }
    for (data, is_fortran) in [(c, false), (fortran, true)] {
        let file = read(npy(1, &header("'<f4'", is_fortran, "(2, 3, 4)"), &data), "a.npy");
        assert_eq!(file.points, Points::F32(expected.clone()));
        assert_eq!(skipped(&file), [("column 4", None)]);
    }
    // Structures in Fortran order, with a radius, a title, a time, a text and a structure inside.
    let descr = "[(('height', 'z'), '>f4'), ('X', '<f4'), ('y', '<f4'), ('radius', '|u1'), ('t', '<M8[ns]'), ('s', '<U2'), \
        ('in', [('a', '<i4', 2), ('b', '|b1')], (2, 1)), ('half', '<f2')]";
    let item = |k: u8| {
        let x = f32::from(k);
        [
            &(x + 0.5).to_be_bytes()[..],
            &x.to_le_bytes(),
            &(x + 0.25).to_le_bytes(),
            &[k],
            &[9; 8 + 8 + 18 + 2],
        ]
        .concat()
    };
    let data: Vec<u8> = [0, 3, 1, 4, 2, 5].into_iter().flat_map(item).collect();
    let file = read(npy(1, &header(descr, true, "(2, 3)"), &data), "a.npy");
    let points = (0..6u8).map(|k| [f32::from(k), f32::from(k) + 0.25, f32::from(k) + 0.5]);
    assert_eq!(file.points, Points::F32(points.collect()));
    assert_eq!(file.radii, Some((0..6u8).map(f64::from).collect()));
    let names: Vec<&str> = file.skipped.iter().map(|s| s.what.as_str()).collect();
    assert_eq!(names, ["texture coordinates", "\"in\"", "\"half\""]);
}

#[test]
fn arrays_that_do_not_fit_are_errors() {
    let good = header("'<f4'", false, "(2, 3)");
    let data = le([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let bytes = npy(1, &good, &data);
    for cut in 0..bytes.len() {
        assert!(PointFile::parse(&bytes[..cut], "a.npy").is_err(), "{cut}");
    }
    fault_says([&bytes[..], &bytes].concat(), "a.npy", "bytes follow");
    for [old, new, expected] in cases("faults of an array") {
        assert!(good.contains(&old));
        let (line, why) = fault(npy(2, &good.replacen(&old, &new, 1), &data), "a.npy");
        assert!(line.is_none() && why.contains(&expected), "{new}: {why}");
    }
    for deep in ["(", "[", "{", "{1:", "[1,"] {
        let why = fault(npy(2, &deep.repeat(10_000), &data), "a.npy").1;
        assert!(why.contains("brackets") || why.contains("expression"), "{why}");
    }
    fault_says(npy(4, &good, &data), "a.npy", "unknown version: 4");
    // Points in columns, not in rows.
    let columns = header("'<f4'", false, "(3, 65)");
    fault_says(npy(1, &columns, &[0; 780]), "a.npy", "3 to 64 numbers per point");
    // No points.
    for shape in ["(0, 3)", "(5, 0, 3)"] {
        let none = header("'<f4'", false, shape);
        assert_eq!(fault(npy(1, &none, &[]), "a.npy").1, "the file contains no point");
    }
    // Integers that f64 would round.
    let wide = header("'<i8'", false, "(1, 3)");
    for (x, is_read) in [
        ((1i64 << 53) - 1, true),
        (1 << 53, false),
        ((1 << 53) + 1, false),
        (i64::MIN, false),
    ] {
        let data: Vec<u8> = [0, x, 0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let file = PointFile::parse(&npy(1, &wide, &data), "a.npy");
        assert_eq!(file.is_ok(), is_read, "{x}");
    }
}

#[test]
fn mutants_are_read_or_named() {
    let check = |good: &[u8], name: &str| {
        mutants::read(good, &[], 10_000, |bytes| match PointFile::parse(bytes, name) {
            Ok(file) => {
                let points = file.points.to_f64();
                assert!(!points.is_empty() && points.as_flattened().iter().all(|x| x.is_finite()));
                let radii = file.radii.unwrap_or(vec![0.0; points.len()]);
                assert!(radii.len() == points.len() && radii.iter().all(|r| r.is_finite() && *r >= 0.0));
                true
            }
            Err(error) => {
                assert!(error.to_string().len() <= 400, "{error}");
                false
            }
        });
    };
    for data in PCD {
        check(&pcd(PCD_HEADER, data), "a.pcd");
    }
    check(CAMERA_TEXT.as_bytes(), "a.xyz");
    check(b"# id;x;y;z;radius\n1;2;3;4;0\n2;2;3;4;9\n", "a.csv");
    let little: Vec<u8> = CAMERA.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    check(&ply("binary_little_endian", XYZ, 5, &little), "a.ply");
    check(&ply("ascii", XYZ, 5, CAMERA_TEXT.as_bytes()), "a.ply");
    check(&npy(1, &header("'<f4'", true, "(5, 3)"), &little), "a.npy");
    let descr = "[('x', '<f4'), ('y', '<f4'), ('z', '<f4')]";
    check(&npy(2, &header(descr, false, "(5,)"), &little), "a.npy");
}

#[test]
fn grids_are_arrays_of_two_axes_in_every_order() {
    let expected: [f64; 6] = [0.5, -1.0, 2.0, 4.0, 8.0, -16.0];
    let fortran = [0usize, 3, 1, 4, 2, 5].map(|k| expected[k]);
    for (is_fortran, values) in [(false, expected), (true, fortran)] {
        for (descr, data) in [
            (
                "'<f8'",
                values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
            ),
            ("'>f8'", values.iter().flat_map(|x| x.to_be_bytes()).collect()),
            ("'<f4'", values.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect()),
            ("'>f4'", values.iter().flat_map(|x| (*x as f32).to_be_bytes()).collect()),
        ] {
            let bytes = npy(1, &header(descr, is_fortran, "(2, 3)"), &data);
            let grid = Grid::parse(&bytes, "a.npy").expect("a grid");
            assert_eq!((grid.rows, grid.columns), (2, 3));
            assert_eq!(grid.values, expected);
            for cut in 0..bytes.len() {
                assert!(Grid::parse(&bytes[..cut], "a.npy").is_err(), "{cut}");
            }
        }
    }
    let whole = npy(1, &header("'|i1'", false, "(1, 2)"), &[7, 0xff]);
    assert_eq!(Grid::parse(&whole, "a.npy").expect("a grid").values, [7.0, -1.0]);
    for text in encodings("# a hill\n1 2;3\n\n4,5\t-6e0\n") {
        let grid = Grid::parse(&text, "a.txt").expect("a grid");
        assert_eq!((grid.rows, grid.columns), (2, 3));
        assert_eq!(grid.values, [1.0, 2.0, 3.0, 4.0, 5.0, -6.0]);
    }
}

#[test]
fn wrong_grids_are_named_with_their_shape_or_number() {
    let array = |descr: &str, shape: &str, bytes: usize| npy(1, &header(descr, false, shape), &vec![0; bytes]);
    let nan: Vec<u8> = [1.0, f64::NAN].iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
    let arrays = cases("wrong arrays of a grid").into_iter();
    let arrays = arrays.map(|[descr, shape, bytes, why]| (array(&descr, &shape, bytes.parse().expect("a size")), why));
    let texts = cases("wrong texts of a grid").into_iter();
    let texts = texts.map(|[text, why]| (text.into_bytes(), why));
    let nan = npy(1, &header("'<f8'", false, "(1, 2)"), &nan);
    let nan = (nan, "a: number [0][1] is not finite: NaN".to_owned());
    for (bytes, expected) in arrays.chain(texts).chain([nan]) {
        let error = Grid::parse(&bytes, "a").expect_err(&expected).to_string();
        assert_eq!(error, expected);
    }
    assert!(
        Grid::read("/no file")
            .expect_err("no file")
            .to_string()
            .starts_with("/no file: cannot be read")
    );
}
