//! COLLADA files: primitives of every kind at the places of their nodes; whatever is wrong is an
//! error that names its line.

mod support;

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use lin_canny_formats::{MeshFile, MeshFormat, MeshObject};
use support::errors::says;
use support::rows::{numbers, rows};
use support::{AREA, VOLUME, area, bounds, mutants, volume};

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    rows(include_str!("collada/rows.txt"), section)
}

/// A tetrahedron of triangles, and a cube of a polylist and single polygons, with an input that is
/// passed over.
const FILE: &str = include_str!("collada/two.dae");

/// The corners of a box 0.2 x 0.4 x 0.6, numbered x slowest and z fastest, and its triangles.
const CORNERS: &str = "0 0 0 0 0 0.6 0 0.4 0 0 0.4 0.6 0.2 0 0 0.2 0 0.6 0.2 0.4 0 0.2 0.4 0.6";
const SIDES: &str = "0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3";
const STRIP: &str = "5 7 1 3 2 7 6 5 4 1 0 2 4 6";
const VERTEX: &str = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;

/// Objects of a file, measured by the kit; every point is used.
#[derive(Debug)]
struct Measure {
    triangles: usize,
    bounds: [[f64; 3]; 2],
    area: f64,
    volume: f64,
}

fn measure(objects: &[MeshObject]) -> Measure {
    for object in objects {
        let mut used = vec![false; object.points.len()];
        object.triangles.iter().flatten().for_each(|k| used[*k as usize] = true);
        assert!(used.into_iter().all(|used| used), "{object:?}");
    }
    let mut file = support::parse(FILE, "a.dae").expect("a mesh");
    file.objects = objects.to_vec();
    let triangles = objects.iter().map(|object| object.triangles.len()).sum();
    let (bounds, area, volume) = (bounds(&file), area(&file), volume(&file));
    Measure {
        triangles,
        bounds,
        area,
        volume,
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12 * (1.0 + b.abs())
}

impl Measure {
    fn check(&self, triangles: usize, low: [f64; 3], high: [f64; 3], area: f64, volume: f64) {
        let of_box = (0..3).all(|k| near(self.bounds[0][k], low[k]) && near(self.bounds[1][k], high[k]));
        assert!(
            of_box && self.triangles == triangles && near(self.area, area) && near(self.volume, volume),
            "{self:?}"
        );
    }
}

fn read(text: &str) -> Result<MeshFile, String> {
    parse(text.as_bytes())
}

fn parse(bytes: &[u8]) -> Result<MeshFile, String> {
    let file = MeshFile::parse(bytes, "a.dae").map_err(|e| {
        let fault = e.fault.to_string();
        assert!(fault.chars().count() <= 120 && !fault.ends_with('.'), "{fault}");
        e.to_string()
    })?;
    assert_eq!(file.format, MeshFormat::Collada);
    for object in &file.objects {
        assert!(object.points.iter().flatten().all(|x| x.is_finite()));
        let count = object.points.len();
        assert!(object.triangles.iter().flatten().all(|k| (*k as usize) < count));
    }
    Ok(file)
}

/// A source of positions with its vertices.
fn source(name: &str, numbers: &str, accessor: &str) -> String {
    let count = numbers.split_whitespace().count();
    format!(
        r##"<source id="{name}-s"><float_array id="{name}-a" count="{count}">{numbers}</float_array>
<technique_common><accessor source="#{name}-a" {accessor}</technique_common></source>
<vertices id="{name}"><input semantic="POSITION" source="#{name}-s"/></vertices>"##
    )
}

/// A file of a unit, libraries, and nodes of the scene.
fn file(libraries: &str, nodes: &str) -> String {
    format!(
        r##"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1" name="meter"/><up_axis>Z_UP</up_axis></asset>
{libraries}
<library_visual_scenes><visual_scene id="sc">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#sc"/></scene></COLLADA>"##
    )
}

/// A file of one mesh at the origin.
fn of_mesh(mesh: &str) -> String {
    file(&geometry(mesh), &placed(""))
}

fn geometry(mesh: &str) -> String {
    format!(r#"<library_geometries><geometry id="g">{mesh}</geometry></library_geometries>"#)
}

fn placed(transforms: &str) -> String {
    format!(r##"<node>{transforms}<instance_geometry url="#g"/></node>"##)
}

/// The mesh of the box, with primitives.
fn box_mesh(primitives: &str) -> String {
    let source = source("v", CORNERS, r#"count="8" stride="3"/>"#);
    format!("<mesh>{source}\n{primitives}</mesh>")
}

fn sides() -> String {
    format!(r#"<triangles count="12">{VERTEX}<p>{SIDES}</p></triangles>"#)
}

/// The box with transforms of its node.
fn moved(transforms: &str) -> Result<MeshFile, String> {
    read(&file(&geometry(&box_mesh(&sides())), &placed(transforms)))
}

const FAR: [f64; 3] = [0.2, 0.4, 0.6];

fn is_the_box(text: &str) {
    let file = read(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    measure(&file.objects).check(12, [0.0; 3], FAR, AREA, VOLUME);
}

/// Asserts the error of a text.
fn fails(text: &str, line: usize, words: &str) {
    let error = read(text).expect_err(words);
    assert!(
        error.contains(&format!("line {line}: ")) && error.contains(words),
        "{error} instead of line {line}: {words}"
    );
}

/// Returns the line of the first letter of a part of a text.
fn line_of(text: &str, part: &str) -> usize {
    let at = text.find(part).unwrap_or_else(|| panic!("{part} in {text}"));
    text[..at].matches('\n').count() + 1
}

#[test]
fn primitives_stand_where_their_nodes_say() {
    let file = read(FILE).expect("a mesh");
    assert_eq!(file.objects.len(), 3);
    let names: Vec<_> = file.objects.iter().map(|o| &o.name[..]).collect();
    assert_eq!(names, ["tetra", "cube", "cube"]);
    // Half a metre a unit; the mirrored tetrahedron is turned outside again.
    let all = measure(&file.objects);
    assert!(near(all.volume, (8.0 / 6.0 + 1.0 + 1.0) / 8.0), "{all:?}");
    all.check(4 + 12 + 12, [4.0, 0.0, -1.0], [5.0, 2.5, 0.5], all.area, all.volume);
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for [from, to, line, words] in cases("faults of a file") {
        assert!(FILE.contains(&from), "{from}");
        fails(&FILE.replacen(&from, &to, 1), line.parse().expect("a line"), &words);
    }
    assert!(read(&FILE.replace("COLLADA", "collada")).is_err());
    assert!(read("<COLLADA").is_err_and(|e| e.contains("malformed")));
}

#[test]
fn every_second_triangle_of_a_strip_is_turned() {
    let strip = box_mesh(&format!(r#"<tristrips count="1">{VERTEX}<p>{STRIP}</p></tristrips>"#));
    is_the_box(&of_mesh(&strip));
    // Two boxes as one strip, joined by repeated corners, and as two.
    let far: Vec<String> = STRIP
        .split(' ')
        .map(|k| (k.parse::<u32>().expect("an index") + 8).to_string())
        .collect();
    let far = far.join(" ");
    let corners = format!(
        "{CORNERS} {}",
        CORNERS
            .split(' ')
            .enumerate()
            .map(|(k, x)| if k % 3 == 0 && x == "0" {
                "2"
            } else if k % 3 == 0 {
                "2.2"
            } else {
                x
            })
            .collect::<Vec<_>>()
            .join(" ")
    );
    let source = source("v", &corners, r#"count="16" stride="3"/>"#);
    for lists in [
        format!(r#"count="1">{VERTEX}<p>{STRIP} 6 13 {far}</p>"#),
        format!(r#"count="2">{VERTEX}<p>{STRIP}</p><p>{far}</p>"#),
    ] {
        let file = read(&of_mesh(&format!(
            "<mesh>{source}<tristrips {lists}</tristrips></mesh>"
        )))
        .expect("a mesh");
        measure(&file.objects).check(24, [0.0; 3], [2.2, 0.4, 0.6], 2.0 * AREA, 2.0 * VOLUME);
    }
}

/// Fans go round their first corner; polygons stand in lists or alone, beside lines.
#[test]
fn fans_and_polygons_are_the_box() {
    for [lists] in cases("primitives of the box") {
        is_the_box(&of_mesh(&box_mesh(&lists)));
    }
}

/// The file of the report: a strip beside a geometry with one triangle.
#[test]
fn strips_stand_beside_triangles() {
    let one = format!(
        r##"<geometry id="h"><mesh>{}<triangles count="1"><input semantic="VERTEX" source="#v2" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>"##,
        source("v2", "-1 -1 -1 -1.1 -1 -1 -1 -1.1 -1", r#"count="3" stride="3"/>"#)
    );
    let accessor = r#"count="8" stride="3"><param name="X" type="float"/></accessor>"#;
    let strip = format!(
        r#"<mesh>{}<tristrips count="1">{VERTEX}<p>3 7 1 5 4 7 6 3 2 1 0 4 2 6</p></tristrips></mesh>"#,
        source("v", CORNERS, accessor)
    );
    let libraries = geometry(&strip).replace("</library_geometries>", &format!("{one}</library_geometries>"));
    let node = r##"<node><instance_geometry url="#g"/><instance_geometry url="#h"/></node>"##;
    let file = read(&file(&libraries, node)).expect("a mesh");
    // This strip is inside out, and stays so in a mirror.
    measure(&file.objects[..1]).check(12, [0.0; 3], FAR, AREA, -VOLUME);
    let mirrored = self::file(&libraries, &node.replace("<node>", "<node><scale>1 1 -1</scale>"));
    let mirrored = read(&mirrored).expect("a mesh");
    assert!(near(measure(&mirrored.objects[..1]).volume, -VOLUME));
    measure(&file.objects[1..]).check(
        1,
        [-1.1, -1.1, -1.0],
        [-1.0; 3],
        0.005,
        measure(&file.objects[1..]).volume,
    );
}

#[test]
fn points_that_no_triangle_uses_are_left_out() {
    let corners = format!("{CORNERS} 0.9 0.9 0.9");
    let source = source("v", &corners, r#"count="9" stride="3"/>"#);
    let lines = format!(r#"<lines count="1">{VERTEX}<p>0 8</p></lines>"#);
    for mesh in [sides(), format!("{}{lines}", sides()), format!("{lines}{}", sides())] {
        let text = of_mesh(&format!("<mesh>{source}\n{mesh}</mesh>"));
        is_the_box(&text);
        let has_lines = mesh.contains("lines");
        let skipped = read(&text).expect("a mesh").skipped;
        let line = has_lines.then(|| line_of(&text, "<lines"));
        assert_eq!(skipped.iter().find(|s| s.what == "lines").and_then(|s| s.line), line);
    }
}

#[test]
fn numbers_that_no_triangle_uses_may_be_anything() {
    for word in ["NaN", "inf", "-INF", "1e400", "-nan(ind)", "1.#QNAN", "-1.#IND"] {
        let corners = format!("{CORNERS} 0.9 {word} 0.9");
        let count = r#"count="9" stride="3"/>"#;
        let mesh = |lists: &str| format!("<mesh>{}\n{lists}</mesh>", source("v", &corners, count));
        is_the_box(&of_mesh(&mesh(&sides())));
        let used = mesh(&sides().replace("1 7 3<", "1 7 8<"));
        fails(&of_mesh(&used), 4, "position 8 is not finite");
    }
    for word in ["x", "1,5", "0x10", "1e", "--1"] {
        let corners = format!("{CORNERS} 0.9 {word} 0.9");
        let mesh = source("v", &corners, r#"count="9" stride="3"/>"#);
        fails(
            &of_mesh(&format!("<mesh>{mesh}{}</mesh>", sides())),
            4,
            "invalid number",
        );
    }
}

#[test]
fn polygons_keep_their_notch() {
    // A U of one polygon, 0.1 thick.
    let outline = "0 0 3 0 3 3 2 3 2 1 1 1 1 3 0 3";
    let flat: Vec<&str> = outline.split(' ').collect();
    let mut corners = String::new();
    for z in ["0", "0.1"] {
        flat.chunks(2)
            .for_each(|p| write!(corners, "{} {} {z} ", p[0], p[1]).expect("a string"));
    }
    for first in 0..8 {
        let ring = |k: usize| (k + first) % 8;
        let mut faces = String::new();
        (0..8)
            .rev()
            .for_each(|k| write!(faces, "{} ", ring(k)).expect("a string"));
        (0..8).for_each(|k| write!(faces, "{} ", ring(k) + 8).expect("a string"));
        for k in 0..8 {
            let next = (k + 1) % 8;
            write!(faces, "{k} {next} {} {} ", next + 8, k + 8).expect("a string");
        }
        let text = of_mesh(&format!(
            r#"<mesh>{}<polylist count="10">{VERTEX}<vcount>8 8 4 4 4 4 4 4 4 4</vcount><p>{faces}</p></polylist></mesh>"#,
            source("v", &corners, r#"count="16" stride="3"/>"#)
        ));
        let file = read(&text).expect("a mesh");
        measure(&file.objects).check(28, [0.0; 3], [3.0, 3.0, 0.1], 14.0 + 1.6, 0.7);
    }
    // A quad with a notch at its last corner.
    let text = of_mesh(&format!(
        r#"<mesh>{}<polygons count="1">{VERTEX}<p>0 1 2 3</p></polygons></mesh>"#,
        source("v", "0 0 0 0.4 0 0 0.4 0.4 0 0.35 0.05 0", r#"count="4" stride="3"/>"#)
    ));
    let file = read(&text).expect("a mesh");
    measure(&file.objects).check(2, [0.0; 3], [0.4, 0.4, 0.0], 0.02, 0.0);
}

/// A plate 3 x 3 x 1 with a hole 1 x 1.
#[test]
fn polygons_keep_their_holes() {
    let mut corners = String::new();
    for z in [0, 1] {
        for [x, y] in [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [2, 1], [2, 2], [1, 2]] {
            write!(corners, "{x} {y} {z} ").expect("a string");
        }
    }
    let mut sides = String::new();
    for k in 0..4 {
        let next = (k + 1) % 4;
        write!(sides, "<p>{k} {next} {} {}</p>", next + 8, k + 8).expect("a string");
        write!(sides, "<p>{} {} {} {}</p>", next + 4, k + 4, k + 12, next + 12).expect("a string");
    }
    let plate = |lists: &str, count: usize| {
        of_mesh(&format!(
            r#"<mesh>{}
<polygons count="{count}">{VERTEX}{lists}</polygons></mesh>"#,
            source("v", &corners, r#"count="16" stride="3"/>"#)
        ))
    };
    // Holes may turn either way.
    for (bottom, top) in [("4 5 6 7", "15 14 13 12"), ("7 6 5 4", "12 13 14 15")] {
        let bottom = format!("<ph><p>3 2 1 0</p><h>{bottom}</h></ph>");
        let top = format!("<ph><p>8 9 10 11</p><h>{top}</h></ph>");
        for lists in [
            format!("{bottom}{top}{sides}"),
            format!("{sides}{bottom}{top}"),
            format!("{bottom}{sides}{top}"),
        ] {
            let file = read(&plate(&lists, 10)).expect("a mesh");
            measure(&file.objects).check(32, [0.0; 3], [3.0, 3.0, 1.0], 32.0, 8.0);
            fails(&plate(&lists, 9), 7, "wrong count of primitives: 9 (expected 10");
        }
    }
    let file = read(&plate("<ph><p>0 1 2 3</p><h>4 5 6 7</h></ph>", 1)).expect("a plate");
    assert!(near(area(&file), 8.0));
    for list in [
        "<ph><h>4 5 6 7</h></ph>",
        "<ph><p>0 1 2 3</p><p>4 5 6 7</p></ph>",
        "<ph><p>0 1 2 3</p><x>4 5 6 7</x></ph>",
    ] {
        fails(&plate(list, 1), 7, "is at the wrong place");
    }
    fails(&plate("<ph/>", 1), 7, "has no corners");
    fails(
        &plate("<ph><p>0 1 2 3</p><h>4 5</h></ph>", 1),
        7,
        "polygon of 2 corners",
    );
    fails(
        &plate("<ph><p>0 1 2 3</p><h>4 5 16</h></ph>", 1),
        7,
        "vertex 16 does not exist",
    );
    // A hole outside the ring, and a bow tie.
    fails(
        &plate("<ph><p>4 5 6 7</p><h>0 1 2 3</h></ph>", 1),
        7,
        "has an invalid face",
    );
    fails(&plate("<p>0 2 1 3</p>", 1), 7, "has an invalid face");
}

#[test]
fn a_polygon_that_crosses_itself_is_an_error() {
    for list in ["<p>0 2 1 3</p>", "<p>0 1 3 2</p>", "<ph><p>1 3 2 0</p></ph>"] {
        let text = format!("<polygons>{VERTEX}{list}</polygons>");
        let corners = source("v", "0 0 0 4 0 0 4 4 0 0 3 0", r#"count="4" stride="3"/>"#);
        fails(
            &of_mesh(&format!("<mesh>{corners}\n{text}</mesh>")),
            7,
            "has an invalid face",
        );
    }
}

#[test]
fn primitives_of_a_mesh_may_have_different_points() {
    let lower = source("v", CORNERS, r#"count="8" stride="3"/>"#);
    let reversed: Vec<&str> = CORNERS.split(' ').collect();
    let reversed: Vec<String> = reversed.chunks(3).rev().map(|p| p.join(" ")).collect();
    let upper = source("w", &reversed.join(" "), r#"count="8" stride="3"/>"#);
    let other = VERTEX.replace("#v", "#w");
    let (first, last) = SIDES.split_at(SIDES.len() / 2 + 1);
    let last: Vec<String> = last
        .split_whitespace()
        .map(|k| (7 - k.parse::<u32>().expect("an index")).to_string())
        .collect();
    let text = of_mesh(&format!(
        "<mesh>{lower}{upper}<triangles>{VERTEX}<p>{first}</p></triangles><triangles>{other}<p>{}</p></triangles></mesh>",
        last.join(" ")
    ));
    is_the_box(&text);
    assert_eq!(read(&text).expect("a mesh").objects.len(), 1);
}

#[test]
fn counts_and_rests_are_checked() {
    let text = of_mesh(&box_mesh(&sides()));
    for [from, to, line, words] in cases("faults of counts") {
        assert!(text.contains(&from), "{from}");
        fails(&text.replacen(&from, &to, 1), line.parse().expect("a line"), &words);
    }
    for [lists, words] in cases("faults of primitives") {
        fails(&of_mesh(&box_mesh(&lists)), 7, &words);
    }
    // An accessor without counts, and primitives with nothing.
    is_the_box(&text.replace(" count=\"8\" stride=\"3\"", ""));
    is_the_box(&text.replace(" count=\"12\"", "").replace(" count=\"24\"", ""));
    let nothing = format!("<polylist count=\"0\">{VERTEX}<vcount/><p/></polylist><triangles count=\"0\"/><triangles");
    is_the_box(&text.replace("<triangles", &nothing));
}

#[test]
fn accessors_choose_the_numbers_of_a_position() {
    let with = |offset: usize, names: &[&str], order: &dyn Fn([&str; 3]) -> String| {
        let mut numbers = "7 ".repeat(offset);
        let all: Vec<&str> = CORNERS.split(' ').collect();
        all.chunks(3).for_each(|p| numbers += &order([p[0], p[1], p[2]]));
        let params: String = names
            .iter()
            .map(|name| match *name {
                "" => "<param type=\"float\"/>".into(),
                name => format!("<param name=\"{name}\" type=\"float\"/>"),
            })
            .collect();
        let stride = order(["0"; 3]).split_whitespace().count();
        let accessor = format!("count=\"8\" offset=\"{offset}\" stride=\"{stride}\">{params}</accessor>");
        format!("<mesh>{}{}</mesh>", source("v", &numbers, &accessor), sides())
    };
    let is_the_box = |mesh: String| is_the_box(&of_mesh(&mesh));
    is_the_box(with(0, &["X", "Y", "Z"], &|[x, y, z]| format!("{x} {y} {z} ")));
    is_the_box(with(5, &["X", "Y", "Z"], &|[x, y, z]| format!("{x} {y} {z} ")));
    is_the_box(with(0, &["", "X", "Y", "Z"], &|[x, y, z]| format!("9 {x} {y} {z} ")));
    is_the_box(with(1, &["X", "", "Y", "", "Z"], &|[x, y, z]| {
        format!("{x} 9 {y} NaN {z} ")
    }));
    is_the_box(with(0, &["", "A", "B", "", "C"], &|[x, y, z]| {
        format!("8 {x} {y} 9 {z} ")
    }));
    is_the_box(with(0, &["Z", "X", "Y"], &|[x, y, z]| format!("{z} {x} {y} ")));
    is_the_box(with(0, &["x", "y", "z"], &|[x, y, z]| format!("{x} {y} {z} 1 ")));
    is_the_box(with(0, &[], &|[x, y, z]| format!("{x} {y} {z} ")));
    let none = with(0, &["", "", "X"], &|[x, y, z]| format!("{x} {y} {z} "));
    fails(&of_mesh(&none), 5, "names fewer than three coordinates");
    let none = with(0, &["X", "Y", "Z", "W"], &|[x, y, z]| format!("{x} {y} {z} "));
    fails(&of_mesh(&none), 5, "invalid stride: 3 (expected 4 or more)");
}

#[test]
fn nodes_transform_in_the_order_of_the_file() {
    for [transforms, low, high, volume] in cases("transforms") {
        let all = measure(&moved(&transforms).expect(&transforms).objects);
        let [volume] = numbers(&volume);
        all.check(12, numbers(&low), numbers(&high), all.area, volume * VOLUME);
    }
    let file = moved("\n<rotate>0 0 0 0</rotate>").expect("a mesh");
    assert!(
        file.skipped
            .iter()
            .any(|s| s.what.starts_with("rotate") && s.line.is_some())
    );
    for [transforms, words] in cases("faults of transforms") {
        let error = moved(&transforms).expect_err(&words);
        assert!(error.contains(&words) && error.contains("line"), "{error}");
    }
}

#[test]
fn a_geometry_may_be_placed_often() {
    let nodes = |count: usize| {
        (0..count).fold(String::new(), |text, k| {
            text + &placed(&format!("<translate>{k} 0 0</translate>"))
        })
    };
    let file = read(&file(&geometry(&box_mesh(&sides())), &nodes(100))).expect("a mesh");
    assert_eq!(file.objects.len(), 100);
    measure(&file.objects).check(1200, [0.0; 3], [99.2, 0.4, 0.6], 100.0 * AREA, 100.0 * VOLUME);
}

/// A file that doubles a box ever again asks for more memory than its size allows.
#[test]
fn instances_have_bounds() {
    let library = |levels: usize, first: &str| {
        let mut nodes = format!("<node id=\"n0\">{first}</node>");
        for k in 1..=levels {
            let below = format!("<instance_node url=\"#n{}\"/>", k - 1);
            nodes += &format!("<node id=\"n{k}\">{below}{below}</node>");
        }
        let libraries = format!(
            "{}<library_nodes>{nodes}</library_nodes>",
            geometry(&box_mesh(&sides()))
        );
        file(&libraries, &format!("<node><instance_node url=\"#n{levels}\"/></node>"))
    };
    let body = "<instance_geometry url=\"#g\"/>";
    assert_eq!(read(&library(6, body)).expect("a mesh").objects.len(), 64);
    let start = Instant::now();
    // The third has as many boxes as its limit in bytes does not allow: 262,144 of 408 bytes.
    for text in [
        library(60, body),
        library(60, ""),
        library(18, body),
        library(900, body),
    ] {
        says(read(&text), "too large by repeated instances");
    }
    says(read(&library(1001, body)), "nested more than 1000 deep");
    let deep = format!(
        "{}{}{}",
        "<node>".repeat(100_000),
        placed(""),
        "</node>".repeat(100_000)
    );
    says(
        read(&file(&geometry(&box_mesh(&sides())), &deep)),
        "nested more than 1000 deep",
    );
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
}

/// A file of a skin of the box.
fn skinned(skin: &str, controllers: &str, transforms: &str) -> String {
    let skin = format!("<controller id=\"c\"><skin source=\"#g\">{skin}<joints/><vertex_weights/></skin></controller>");
    let libraries = format!(
        "{}\n<library_controllers>{skin}{controllers}</library_controllers>",
        geometry(&box_mesh(&sides()))
    );
    let instance = "\n<instance_controller url=\"#c\">\n<skeleton>#root</skeleton></instance_controller>";
    file(&libraries, &format!("<node>{transforms}{instance}</node>"))
}

#[test]
fn skins_are_at_rest() {
    is_the_box(&skinned("", "", ""));
    let matrix = |entries: &str| format!("<bind_shape_matrix>{entries} 0 0 0 1</bind_shape_matrix>");
    let text = skinned(&matrix("1 0 0 5 0 1 0 6 0 0 1 7"), "", "<scale>2 2 2</scale>");
    let file = read(&text).expect("a mesh");
    measure(&file.objects).check(12, [10.0, 12.0, 14.0], [10.4, 12.8, 15.2], 4.0 * AREA, 8.0 * VOLUME);
    let skeleton = file.skipped.iter().find(|s| s.what.starts_with("skeletons"));
    assert_eq!(skeleton.and_then(|s| s.line), Some(line_of(&text, "<skeleton>")));
    // A mirror turns triangles over.
    let file = read(&skinned(&matrix("-1 0 0 0 0 1 0 0 0 0 1 0"), "", "")).expect("a mesh");
    measure(&file.objects).check(12, [-0.2, 0.0, 0.0], [0.0, 0.4, 0.6], AREA, VOLUME);
    // A skin of a skin, and of a morph.
    let other = format!(
        "<controller id=\"d\"><skin source=\"#g\">{}</skin></controller>",
        matrix("2 0 0 0 0 2 0 0 0 0 2 0")
    );
    let text = skinned(&matrix("1 0 0 5 0 1 0 6 0 0 1 7"), &other, "").replacen("source=\"#g\"", "source=\"#d\"", 1);
    let file = read(&text).expect("a mesh");
    measure(&file.objects).check(12, [5.0, 6.0, 7.0], [5.4, 6.8, 8.2], 4.0 * AREA, 8.0 * VOLUME);
    let at = line_of(&skinned("", "", ""), "<controller");
    for [entries, words] in cases("faults of a matrix of a skin") {
        fails(&skinned(&matrix(&entries), "", ""), at, &words);
    }
    fails(&skinned("<twist/>", "", ""), at, "the element \"twist\" of skin");
    for [source, words] in cases("faults of the source of a skin") {
        fails(&skinned("", "", "").replace("source=\"#g\"", &source), at, &words);
    }
    let empty = skinned("", "", "").replace("<skin source=\"#g\"><joints/><vertex_weights/></skin>", "");
    fails(&empty, at, "no skin or morph");
    let infinite = skinned(&matrix("1 0 0 inf 0 1 0 6 0 0 1 7"), "", "");
    fails(&infinite, line_of(&infinite, "<instance_controller"), "not finite");
}

#[test]
fn morphs_are_their_base_mesh() {
    let morph = |weights: &str| {
        let controller = format!(
            r##"<controller id="c"><morph source="#g">
<source id="w"><float_array id="wa" count="2">{weights}</float_array></source>
<targets><input semantic="MORPH_TARGET" source="#t"/><input semantic="MORPH_WEIGHT" source="#w"/></targets></morph></controller>"##
        );
        skinned("", "", "").replace(
            "<controller id=\"c\"><skin source=\"#g\"><joints/><vertex_weights/></skin></controller>",
            &controller,
        )
    };
    is_the_box(&morph("0 0"));
    let skipped = read(&morph("0 0")).expect("a mesh").skipped;
    assert!(skipped.iter().any(|s| s.what == "morph targets" && s.line.is_some()));
    let line = line_of(&morph("0 0"), "<float_array id=\"wa\"");
    for weights in ["0 0.5", "1 0", "0 NaN"] {
        fails(
            &morph(weights),
            line,
            "a morph with a weight other than 0 is not supported",
        );
    }
    let skin = "<controller id=\"d\"><skin source=\"#c\"/></controller><controller id=\"c\">";
    let text = morph("0 0")
        .replace("<controller id=\"c\">", skin)
        .replace("url=\"#c\"", "url=\"#d\"");
    is_the_box(&text);
}

#[test]
fn convex_meshes_are_meshes() {
    let convex = box_mesh(&sides()).replace("mesh>", "convex_mesh>");
    is_the_box(&of_mesh(&convex));
    let hull = convex.replacen("<convex_mesh", "<convex_mesh convex_hull_of=\"#h\"", 1);
    fails(&of_mesh(&hull), 4, "convex_hull_of) is not supported");
}

#[test]
fn what_could_be_geometry_and_is_not_read_is_an_error() {
    let text = of_mesh(&format!("\n{}\n", box_mesh(&sides())));
    // Unknown elements, in the first, a middle and the last place.
    for (behind, of) in [
        ("<geometry id=\"g\">", "geometry"),
        ("</mesh>\n", "geometry"),
        ("<mesh>", "mesh"),
        ("</source>", "mesh"),
        ("</triangles>", "mesh"),
        ("<triangles count=\"12\">", "triangles"),
        ("</p>", "triangles"),
        ("<node>", "node"),
        ("<instance_geometry url=\"#g\"/>", "node"),
        ("<visual_scene id=\"sc\">", "visual_scene"),
        ("</node>", "visual_scene"),
    ] {
        for element in ["spline", "brep", "quads", "instance_mesh"] {
            let at = text.find(behind).expect(behind) + behind.len();
            let text = format!("{}\n<{element}/>{}", &text[..at], &text[at..]);
            fails(
                &text,
                line_of(&text, &format!("<{element}/>")),
                &format!("the element \"{element}\" of {of} is not"),
            );
        }
    }
    for [from, to, place, words] in cases("references that are not read") {
        let changed = text.replacen(&from, &to, 1);
        fails(&changed, line_of(&text, &place), &words);
    }
    is_the_box(&text.replacen("<triangles", "<source id=\"v\"/><triangles", 1));
    is_the_box(&text.replacen("url=\"#g\"", "url=\"g\"", 1));
    // No scene.
    let start = text.find("<library_visual_scenes>").expect("a library");
    let none = format!("{}</COLLADA>", &text[..start]);
    is_the_box(&none);
    let nodes = none.replace("</COLLADA>", "<library_nodes>\n<node/></library_nodes></COLLADA>");
    fails(
        &nodes,
        line_of(&nodes, "<node/>"),
        "a node in a file without a scene is not supported",
    );
    is_the_box(&text.replace("<scene><instance_visual_scene url=\"#sc\"/></scene>", ""));
    is_the_box(&text.replace("<COLLADA xmlns", "<!DOCTYPE COLLADA>\n<COLLADA xmlns"));
    let twice = text.replace("</scene>", "<instance_visual_scene url=\"#sc\"/></scene>");
    fails(
        &twice,
        line_of(&twice, "<scene>"),
        "instance_visual_scene is there twice",
    );
    // Nothing in the scene.
    let empty = text.replace("<instance_geometry url=\"#g\"/>", "");
    assert!(read(&empty).is_err_and(|e| e.contains("contains no triangle")));
}

#[test]
fn the_unit_is_that_of_the_file() {
    let text = of_mesh(&box_mesh(&sides()));
    let unit = "<unit meter=\"1\" name=\"meter\"/>";
    let with = |new: &str| read(&text.replacen(unit, new, 1));
    for (meter, size) in [("0.01", 0.01), ("0,010000", 0.01), ("1e-2", 0.01), (" 2 ", 2.0)] {
        let file = with(&format!("<unit meter=\"{meter}\"/>")).expect(meter);
        let all = measure(&file.objects);
        all.check(
            12,
            [0.0; 3],
            FAR.map(|x| x * size),
            all.area,
            VOLUME * size * size * size,
        );
    }
    for none in ["", "<unit/>", "<unit name=\"meter\"/>"] {
        assert!(near(measure(&with(none).expect("a mesh").objects).volume, VOLUME));
    }
    for meter in ["", "0", "-1", "inf", "NaN", "1e400", "x", "1.000,5", "1,000,5", "0,5 m"] {
        says(with(&format!("<unit meter=\"{meter}\"/>")), "line 3: unit is invalid");
    }
    says(with(&format!("{unit}{unit}")), "line 3: unit is there twice");
    // The asset of a library counts for nothing, wherever it stands.
    let other = "<library_cameras><asset>\n<unit meter=\"0.0254\"/></asset></library_cameras>";
    for at in ["<asset>", "<library_geometries>", "<scene>"] {
        let text = text.replacen(at, &format!("{other}{at}"), 1);
        is_the_box(&text);
        let skipped = read(&text).expect("a mesh").skipped;
        let line = skipped
            .iter()
            .find(|s| s.what.starts_with("units"))
            .and_then(|s| s.line);
        assert_eq!(line, Some(line_of(&text, "<unit meter=\"0.0254\"")));
    }
    // A decimal comma anywhere else is an error.
    fails(&text.replacen("0.4", "0,4", 1), 4, "invalid number: \"0,4\"");
}

#[test]
fn what_is_passed_over_is_listed() {
    let file = read(include_str!("collada/passed.dae")).expect("a mesh");
    let mut skipped: Vec<_> = file
        .skipped
        .iter()
        .map(|s| (s.line.unwrap_or(0), &s.what[..]))
        .collect();
    skipped.sort_unstable();
    let skipped: Vec<String> = skipped.iter().map(|(line, what)| format!("{line} | {what}")).collect();
    let expected: Vec<String> = cases::<2>("what is passed over")
        .into_iter()
        .map(|row| row.join(" | "))
        .collect();
    assert_eq!(skipped, expected);
    assert_eq!(file.objects[0].name, "plate");
    assert_eq!(file.objects[0].points, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

/// The bytes of a text in every encoding and with every line end.
fn encodings(text: &str) -> Vec<(&'static str, Vec<u8>)> {
    let wide = |text: &str, bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(0xfeff)
            .chain(text.encode_utf16())
            .flat_map(bytes)
            .collect()
    };
    let mut all = vec![
        ("UTF-8", text.as_bytes().to_vec()),
        ("byte order mark", ["\u{feff}", text].concat().into_bytes()),
        ("UTF-16 LE", wide(text, u16::to_le_bytes)),
        ("UTF-16 BE", wide(text, u16::to_be_bytes)),
        ("CR", text.replace('\n', "\r").into_bytes()),
        ("CR LF", text.replace('\n', "\r\n").into_bytes()),
        ("UTF-16 CR LF", wide(&text.replace('\n', "\r\n"), u16::to_le_bytes)),
        ("UTF-16 CR", wide(&text.replace('\n', "\r"), u16::to_be_bytes)),
        ("tabs", text.replace(' ', "\t").into_bytes()),
    ];
    // A letter of Latin-1 in a comment, in the first, a middle and the last place.
    for at in [
        text.find("?>").map_or(0, |k| k + 2),
        text.find("<mesh>").unwrap_or(0),
        text.len(),
    ] {
        let mut bytes = text.as_bytes().to_vec();
        bytes.splice(at..at, b"<!-- \xe9 -->".iter().copied());
        all.push(("Latin-1", bytes));
    }
    all
}

#[test]
fn all_encodings_and_line_ends_give_the_same_mesh() {
    let expected = read(FILE).expect("a mesh");
    for (encoding, bytes) in encodings(FILE) {
        assert_eq!(parse(&bytes).expect(encoding), expected, "{encoding}");
    }
    // A name in Latin-1 and in UTF-8.
    let named = FILE.replace("geometry id=\"tetra\"", "geometry id=\"tetra\" name=\"K\u{f6}rper\"");
    let latin: Vec<u8> = named.chars().map(|c| c as u32 as u8).collect();
    for bytes in [latin, named.into_bytes()] {
        assert_eq!(parse(&bytes).expect("a mesh").objects[0].name, "K\u{f6}rper");
    }
    // A document type, blank lines in front, comments between and within numbers, CDATA.
    for (from, to) in [
        ("<COLLADA", "<!DOCTYPE COLLADA SYSTEM \"http://a/b.dtd\"><COLLADA"),
        ("<COLLADA", "<!DOCTYPE COLLADA [ <!ELEMENT p (#PCDATA)> ]><COLLADA"),
        ("0 2 1 0 1 3", "0 2<!-- two --> 1 0 1 3"),
        ("0 2 1 0 1 3", "<!-- none -->0 2 1 0 1 3"),
        ("0 2 1 0 1 3", "0 2<!-- a -- b < c > <!ENTITY d> ---> 1 0 1 3"),
        ("0 2 1 0 1 3", "0 2 1 <![CDATA[0 1]]> 3"),
        ("0 2 1 0 1 3", "0 2 1 &#48; 1 3"),
        ("4 4 4 4<", "4 <?x y?>4 4 4<"),
    ] {
        assert_eq!(read(&FILE.replacen(from, to, 1)).expect(to), expected, "{to}");
    }
    let later = read(&format!(" \n\n{FILE}")).expect("a mesh");
    assert_eq!(later.objects, expected.objects);
    assert!(
        later
            .skipped
            .iter()
            .zip(&expected.skipped)
            .all(|(a, b)| a.line == b.line.map(|line| line + 2))
    );
    fails(
        &format!("\n\n{}", FILE.replacen("0 2 1 0", "0 2 x 0", 1)),
        11,
        "invalid index",
    );
    fails(
        &format!("\n\n{}", FILE.replacen("</mesh>", "</mash>", 1)),
        12,
        "malformed XML",
    );
    // Entities can grow without bound.
    for entity in ["<!ENTITY a \"0 1 2\">", "<!ENTITY a SYSTEM \"/etc/passwd\">"] {
        let text = FILE.replacen("<COLLADA", &format!("<!DOCTYPE COLLADA [\n{entity}]><COLLADA"), 1);
        fails(&text, 3, "the declaration of an entity is not supported");
    }
    // The XML parser needs a long time for these.
    let start = Instant::now();
    let prefixes = (0..3000).fold(String::new(), |text, k| text + &format!("<a xmlns:n{k}=\"u{k}\">"));
    let attributes = (0..100_000).fold(String::new(), |text, k| text + &format!(" a{k}=''"));
    for text in [
        format!("<COLLADA>{prefixes}{}</COLLADA>", "</a>".repeat(3000)),
        format!("<COLLADA {attributes}/>"),
    ] {
        says(read(&text), "prefixes or attributes is not supported");
    }
    assert!(start.elapsed() < Duration::from_secs(2));
    // Any prefix of the namespace.
    let prefixed = FILE
        .replace("</", "</c:")
        .replace('<', "<c:")
        .replace("<c:/c:", "</c:")
        .replace("<c:?", "<?");
    assert_eq!(read(&prefixed.replace("xmlns=", "xmlns:c=")).expect("a mesh"), expected);
}

#[test]
fn faults_keep_their_line_in_all_encodings() {
    // Each number on a line of its own, so that the line tells the place.
    let text = |corners: &[&str], sides: &[&str]| {
        let triangles = format!(
            "<triangles count=\"12\">{VERTEX}<p>\n{}</p></triangles>",
            sides.join("\n")
        );
        of_mesh(&box_mesh(&triangles).replace(CORNERS, &format!("\n{}", corners.join("\n"))))
    };
    let corners: Vec<&str> = CORNERS.split(' ').collect();
    let sides: Vec<&str> = SIDES.split(' ').collect();
    let good = text(&corners, &sides);
    is_the_box(&good);
    let check = |text: &str, line: usize, fault: &str| {
        for (encoding, bytes) in encodings(text) {
            let error = parse(&bytes).expect_err(fault);
            let is_right = error.contains(&format!("line {line}: ")) && error.contains(fault);
            assert!(is_right, "{encoding}, line {line}, {fault}: {error}");
        }
    };
    for (word, fault) in [("x", "invalid number"), ("NaN", "not finite"), ("1e999", "not finite")] {
        for k in 0..corners.len() {
            let mut changed = corners.clone();
            changed[k] = word;
            check(&text(&changed, &sides), line_of(&good, "<float_array") + 1 + k, fault);
        }
    }
    for (word, fault) in [
        ("x", "invalid index"),
        ("-1", "invalid index"),
        ("1.0", "invalid index"),
        ("99999999999999999999", "invalid index"),
        ("8", "vertex 8 does not exist"),
    ] {
        for k in 0..sides.len() {
            let mut changed = sides.clone();
            changed[k] = word;
            check(&text(&corners, &changed), line_of(&good, "<triangles") + 1 + k, fault);
        }
    }
}

/// A small file with every kind of primitive, node and controller.
fn everything() -> String {
    let lists = format!(
        r#"<triangles count="2">{VERTEX}<p>0 1 3 0 3 2</p></triangles>
<trifans count="1">{VERTEX}<p>4 6 7 5</p></trifans>
<tristrips count="1">{VERTEX}<p>0 4 1 5</p></tristrips>
<polylist count="1">{VERTEX}<vcount>4</vcount><p>2 3 7 6</p></polylist>
<polygons count="2">{VERTEX}<p>0 2 6 4</p><ph><p>1 5 7 3</p></ph></polygons>
<lines count="1">{VERTEX}<p>0 7</p></lines>"#
    );
    skinned("<bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>", "", "<translate>1 0 0</translate><rotate>0 1 0 30</rotate><lookat>5 0 0 1 0 0 0 0 1</lookat><skew>45 0 1 0 1 0 0</skew>")
        .replace(&sides(), &lists)
        .replace("</instance_controller>", "</instance_controller><instance_geometry url=\"#g\"/>")
}

#[test]
fn mutants_are_read_or_named() {
    let wide: Vec<u8> = std::iter::once(0xfeff)
        .chain(FILE.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    let words = ["#cube", "#two", "<p>", "</p>", "&#48;", "99999999999"];
    for (good, count) in [
        (FILE.as_bytes(), 15_000),
        (everything().as_bytes(), 5_000),
        (&wide, 5_000),
    ] {
        let start = Instant::now();
        mutants::read(good, &words, count, |bytes| parse(bytes).is_ok());
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    }
}
