//! OBJ: faces are read as polygons, lines are no faces, and what does not fit is an error with its
//! line.

mod support;

use lin_canny_formats::MeshFile;
use support::errors::says;
use support::rows::rows;
use support::{BOX, TRIANGLES, VOLUME, bounds, encodings, parse, read_mutants, volume};

fn vertices() -> String {
    BOX.iter().map(|p| format!("v {} {} {}\n", p[0], p[1], p[2])).collect()
}

fn faces() -> String {
    TRIANGLES
        .iter()
        .map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1))
        .collect()
}

fn is_box(text: &str) {
    let file = parse(text, "a.obj").unwrap_or_else(|e| panic!("{e}: {text}"));
    assert!((volume(&file) - VOLUME).abs() < 1e-12, "{}: {text}", volume(&file));
    assert_eq!(bounds(&file), [[0.0; 3], [0.2, 0.4, 0.6]], "{text}");
    assert_eq!(file.whole().0.len(), 8, "{text}");
}

#[test]
fn lines_points_and_unused_vertices_are_no_part_of_the_body() {
    let body = vertices() + &faces();
    is_box(&body);
    for extra in [
        "v -1 -1 .3\nv 2 -1 .3\nv 2 2 .3\nv -1 2 .3\nl 9 10 11 12 9\n",
        "v 5 5 5\nl 1 9\n",
        "v 5 5 5\np 9\n",
        "v 5 5 5\n",
        "cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nend\n",
    ] {
        is_box(&(body.clone() + extra));
        is_box(&(vertices() + extra + &faces()));
        let file = parse(body.clone() + extra, "a.obj").expect("a box");
        let words = ["l", "p", "curv"];
        let has_word = extra
            .lines()
            .any(|l| words.contains(&l.split(' ').next().unwrap_or("")));
        assert_eq!(has_word, file.skipped.iter().any(|s| words.contains(&s.what.as_str())));
    }
}

#[test]
fn spellings_of_exporters_are_read() {
    let (v, f) = (vertices(), faces());
    let body = v.clone() + &f;
    let spellings = [
        body.replace('\n', "\r\n"),
        body.replace('\n', "\r"),
        format!("\u{feff}{body}"),
        body.replace("v ", " \tV  ").replace("f ", "F "),
        f.clone() + &v,
        v.clone() + "usemtl\nmtllib a b.mtl\ng a b\ns off\n" + &f,
        v.clone() + &f.replace("f 1 ", "f 1 \\\n "),
        body.replace('\n', " # a comment \\\n"),
        v.replacen('\n', " 1 0 0\n", 3) + &f,
        v.replacen('\n', " 1.0\n", 1) + &f,
        v.replace('\n', " nan -nan(ind) inf\n") + &f,
        v.replace('\n', " 1 nan nan nan nan\n") + &f,
        v.clone() + &f.replace("f ", "fo "),
        v.clone() + "vt 0 0\nvn 0 0 1\n" + &f.replacen("f 1 2 4", "f 1/1 2/1/1 4//1", 1),
        v.clone() + &f.replacen("f 1 2 4", "f 1/ 2/1/ 4", 1) + "vt 0 0\n",
        v.clone() + &f.replacen("f 1 2 4", "f -8 -7 -5", 1),
        v + &f.replacen("f 1 2 4", "f 1 1 2 4 4", 1),
    ];
    for text in spellings {
        is_box(&text);
    }
    let mut latin = format!("# gr#n\n{body}").into_bytes();
    latin[4] = 0xfc;
    assert_eq!(parse(&latin, "a.obj").expect("Latin-1").whole().1.len(), 12);
}

#[test]
fn objects_are_apart_and_groups_are_not() {
    let text = format!("o one\n{}{}g left\no two\n{}", vertices(), faces(), faces());
    let file = parse(text, "a.obj").expect("two objects");
    let names: Vec<&str> = file.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["one", "two"]);
    assert_eq!(file.objects[1].points.len(), 8);
    let text = vertices() + "g a\n" + &faces().replacen("f 1 4 3\n", "g b\nf 1 4 3\n", 1);
    assert_eq!(parse(text, "a.obj").expect("one object").objects.len(), 1);
}

#[test]
fn vertices_without_faces_are_points_of_a_hull() {
    let half = |k: usize| vertices().lines().skip(4 * k).take(4).collect::<Vec<_>>().join("\n");
    let text = format!("o empty\no one\n{}\no two\n{}\nl 1 2\n", half(0), half(1));
    let load = |text: &str| MeshFile::parse_for_hull(text.as_bytes(), "a.obj");
    let file = load(&text).expect("points");
    let objects = file
        .objects
        .iter()
        .map(|o| (o.name.as_str(), o.points.len(), o.triangles.len()));
    assert_eq!(objects.collect::<Vec<_>>(), [("one", 4, 0), ("two", 4, 0)]);
    assert_eq!(file.whole().0, BOX);
    assert_eq!(file.skipped[0].what, "l");
    says(parse(&text, "a.obj"), "vertices without faces");
    // A face makes it a mesh, and other points are no part of the body.
    let file = load(&(text + "f 1 2 4\n")).expect("a mesh");
    assert_eq!((file.objects.len(), file.whole().0.len()), (1, 3));
    says(load("l 1 2\n"), "no triangle");
}

#[test]
fn notches_stay_open() {
    // A U of one polygon, 0.1 thick, begun at any corner.
    let ring = [[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]];
    let mut text = String::new();
    for z in ["0", ".1"] {
        ring.iter().for_each(|p| text += &format!("v {} {} {z}\n", p[0], p[1]));
    }
    for start in 0..8 {
        let at = |k: usize| 1 + (k + start) % 8;
        let below: Vec<String> = (0..8).rev().map(|k| at(k).to_string()).collect();
        let above: Vec<String> = (0..8).map(|k| (8 + at(k)).to_string()).collect();
        let mut body = format!("{text}f {}\nf {}\n", below.join(" "), above.join(" "));
        for k in 0..8 {
            let (a, b) = (1 + k, 1 + (k + 1) % 8);
            body += &format!("f {a} {b} {} {}\n", b + 8, a + 8);
        }
        let file = parse(&body, "u.obj").expect("a U");
        assert!((volume(&file) - 0.7 * 1.0).abs() < 1e-12, "{start}: {}", volume(&file));
        assert_eq!(file.whole().1.len(), 6 + 6 + 16);
    }
    let quad = "v 0 0 0\nv .4 0 0\nv .4 .4 0\nv .35 .05 0\n";
    for f in ["f 1 2 3 4", "f 2 3 4 1", "f 3 4 1 2", "f 4 1 2 3"] {
        let file = parse(format!("{quad}{f}\n"), "q.obj").expect("a quad");
        let (points, triangles) = file.whole();
        let area: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| points[k as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            })
            .sum();
        assert!((area - 0.02).abs() < 1e-12, "{area}");
    }
}

#[test]
fn every_encoding_is_read() {
    let text = vertices() + &faces();
    for bytes in encodings(&text)
        .into_iter()
        .chain([[text.as_bytes(), b" # \xfc"].concat()])
    {
        let file = parse(bytes, "a.obj").expect("a box");
        assert!((volume(&file) - VOLUME).abs() < 1e-12);
        assert_eq!(file.whole().1.len(), 12);
    }
}

#[test]
fn errors_are_short() {
    let long = "9x".repeat(50_000);
    for fault in [long.clone(), format!("v {long} 0 0"), format!("f {long} 1 2")] {
        let error = parse(vertices() + &fault, "a.obj").expect_err("a long word");
        assert!(error.fault.to_string().len() <= 120, "{error}");
    }
}

#[test]
fn faces_of_any_size_are_kept() {
    let body = vertices() + &faces();
    for exponent in [-300, -110, -81, -50, 50, 78, 100, 155, 300] {
        let e = format!("e{exponent}");
        let quad = format!("v 0 0 0\nv 1{e} 0 0\nv 1{e} 1{e} 0\nv 0 1{e} 0\n");
        let notch = format!("v 0 0 0\nv 4{e} 0 0\nv 4{e} 4{e} 0\nv 3{e} 1{e} 0\n");
        for points in [quad, notch] {
            match parse(format!("{body}{points}f -4 -3 -2 -1\n"), "a.obj") {
                Ok(file) => assert_eq!(file.whole().1.len(), 14, "{points}"),
                Err(error) => assert!(error.to_string().contains("out of range"), "{error}"),
            }
        }
    }
}

#[test]
fn a_fault_anywhere_is_named_with_its_line() {
    let lines: Vec<String> = (vertices() + &faces()).lines().map(Into::into).collect();
    for at in [0, 5, 8, 13, lines.len()] {
        for [fault] in rows(include_str!("obj/rows.txt"), "faults of a line") {
            let mut lines = lines.clone();
            lines.insert(at, fault.clone());
            let text = lines.join("\n");
            for bytes in encodings(&text)
                .into_iter()
                .chain([[text.as_bytes(), b" # \xfc"].concat()])
            {
                let error = parse(bytes, "a.obj").expect_err(&fault);
                assert_eq!(error.line, Some(at + 1), "{fault}: {error}");
                assert!(error.to_string().starts_with("a.obj, line "), "{error}");
            }
        }
    }
    for word in ["surf", "bzp", "BSP", "cdp"] {
        says(parse(vertices() + &faces() + word + " 1 2 3 4", "a.obj"), "surface");
    }
    let bow = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 1 2 3 4\n";
    says(parse(bow, "a.obj"), "line 5: polygon is not simple");
}

#[test]
fn mutants_are_read_or_named() {
    let text = format!(
        "o a\n{}vt 0 0\nvn 0 0 1\nusemtl x\n{}f 1/1/1 2 4 3\nl 1 2\n",
        vertices(),
        faces()
    );
    read_mutants(text.as_bytes(), "a.obj", 20_000);
    // Faces with notches, spikes, a keyhole and corners on a line, which are not cut as fans.
    let rings = [
        "1 2 3 4 5 6 7 8",
        "8 7 6 5 4 3 2 1",
        "1 2 9 3 8",
        "1 2 3 8 1 5 6 4 5",
        "-9 -8 -7 -2",
    ];
    let points = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 .01\nv 1 3 0\nv 0 3 0\nv 3 1 0\n";
    let faces: String = rings.iter().map(|ring| format!("f {ring}\n")).collect();
    let start = std::time::Instant::now();
    read_mutants((points.to_owned() + &faces).as_bytes(), "a.obj", 20_000);
    assert!(
        start.elapsed().as_secs() < 60,
        "20,000 small files took {:?}",
        start.elapsed()
    );
}

#[test]
fn faces_without_area_and_bent_faces_are_listed() {
    let of = |faces: &str| {
        let text = format!("v 0 0 0\nv 4 0 0\nv 4 4 0.4\nv 0 4 0\nf 1 2 3\n{faces}");
        MeshFile::parse(text.as_bytes(), "a.obj").expect(&text)
    };
    for face in ["f 1 2 1", "f 2 2 2", "f 1 1 2 2"] {
        let file = of(face);
        assert_eq!(file.objects[0].triangles.len(), 1, "{face}");
        assert_eq!(file.skipped[0].line, Some(6));
        assert_eq!(file.skipped[0].what.as_str(), "faces without area");
    }
    let file = of("f 1 2 3 4");
    assert_eq!(file.objects[0].triangles.len(), 3);
    assert!(file.skipped[0].line == Some(6), "{:?}", file.skipped);
    assert!(file.skipped[0].what.contains("not flat"), "{:?}", file.skipped);
}
