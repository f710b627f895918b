//! Closed forms of COLLADA primitives and transforms over a box, and spellings of exporters.

mod support;

use support::{BOX, bounds, parse, read_mutants, volume};

/// A tetrahedron of triangles, and a cube of a polylist and single polygons, with an input that is
/// skipped.
const FILE: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="half" meter="0.5"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries>
    <geometry id="tetra"><mesh>
      <source id="t-pos"><float_array id="t-arr" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
        <technique_common><accessor source="#t-arr" count="4" stride="3"/></technique_common></source>
      <vertices id="t-v"><input semantic="POSITION" source="#t-pos"/></vertices>
      <triangles count="4"><input semantic="VERTEX" source="#t-v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>
    </mesh></geometry>
    <geometry id="cube"><mesh>
      <source id="c-pos"><float_array id="c-arr" count="24">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1</float_array>
        <technique_common><accessor source="#c-arr" count="8" stride="3"/></technique_common></source>
      <vertices id="c-v"><input semantic="POSITION" source="#c-pos"/></vertices>
      <polylist count="4"><input semantic="NORMAL" source="#c-pos" offset="0"/><input semantic="VERTEX" source="#c-v" offset="1"/>
        <vcount>4 4 4 4</vcount><p>9 0 9 3 9 2 9 1 9 4 9 5 9 6 9 7 9 0 9 1 9 5 9 4 9 1 9 2 9 6 9 5</p></polylist>
      <polygons count="2"><input semantic="VERTEX" source="#c-v" offset="0"/><p>2 3 7 6</p><p>3 0 4 7</p></polygons>
    </mesh></geometry>
  </library_geometries>
  <library_nodes><node id="two"><instance_geometry url="#cube"/></node></library_nodes>
  <library_visual_scenes><visual_scene id="scene">
    <node><translate>10 0 0</translate><rotate>0 0 1 90</rotate>
      <node><scale>2 2 -2</scale><instance_geometry url="#tetra"/></node>
      <node><matrix>1 0 0 4 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_node url="#two"/></node>
      <instance_geometry url="#cube"/>
    </node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>"##;

fn read(text: &str) -> Result<lin_canny_formats::MeshFile, String> {
    parse(text, "a.dae").map_err(|e| e.to_string())
}

/// A file with one geometry of the given primitives over the eight corners of a box, and a triangle.
fn of_box(primitives: &str) -> String {
    let numbers: Vec<String> = BOX.iter().flatten().map(f64::to_string).collect();
    format!(
        r##"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="27">{} .9 .9 .9</float_array>
<technique_common><accessor source="#a" count="9" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
{primitives}
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="sc"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#sc"/></scene></COLLADA>"##,
        numbers.join(" ")
    )
}

const INPUT: &str = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
const VOLUME: f64 = 0.2 * 0.4 * 0.6;

fn is_box(text: &str) {
    let file = read(text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert!((volume(&file) - VOLUME).abs() < 1e-12, "{}: {text}", volume(&file));
    // The ninth point, which nothing uses, is no part of the body.
    assert_eq!(bounds(&file), [[0.0; 3], [0.2, 0.4, 0.6]], "{text}");
    assert_eq!(file.whole().0.len(), 8);
}

#[test]
fn strips_fans_polygons_and_lines_over_a_box() {
    let strip = format!("<tristrips count=\"1\">{INPUT}<p>3 7 1 5 4 7 6 3 2 1 0 4 2 6</p></tristrips>");
    // Inside out in the file, and kept so.
    let file = read(&of_box(&strip)).expect("a strip");
    assert!((volume(&file) + VOLUME).abs() < 1e-12 && file.whole().1.len() == 12);
    let turned = of_box(&strip).replace("<node>", "<node><scale>1 1 -1</scale>");
    assert!((volume(&read(&turned).expect("a strip")) + VOLUME).abs() < 1e-12);
    let fans = format!("<trifans count=\"2\">{INPUT}<p>0 4 5 1 3 2 6 4</p><p>7 3 1 5 4 6 2 3</p></trifans>");
    is_box(&of_box(&fans));
    let quads = "0 1 3 2 4 6 7 5 0 4 5 1 2 3 7 6 0 2 6 4 1 5 7 3";
    let list = format!("<polylist count=\"6\">{INPUT}<vcount>4 4 4 4 4 4</vcount><p>{quads}</p></polylist>");
    is_box(&of_box(&list));
    let lines =
        format!("{list}<lines count=\"1\">{INPUT}<p>0 8</p></lines><linestrips>{INPUT}<p>0 8 1</p></linestrips>");
    is_box(&of_box(&lines));
    assert_eq!(read(&of_box(&lines)).expect("a box").skipped[0].what, "lines");
    let words: Vec<&str> = quads.split(' ').collect();
    let single: String = words.chunks(4).map(|q| format!("<p>{}</p>", q.join(" "))).collect();
    is_box(&of_box(&format!("<polygons count=\"6\">{INPUT}{single}</polygons>")));
    // Exporters and their spellings.
    let box_file = of_box(&list);
    for text in [
        box_file.replace("<node>", "<node><rotate>0 0 0 0</rotate>"),
        box_file.replace("<unit meter=\"1\"/>", "<unit meter=\"1,000000\"/>"),
        box_file.replace("<COLLADA xmlns", "<!DOCTYPE COLLADA>\n<COLLADA xmlns"),
        box_file
            .replace("<param name=\"X\"/>", "<param/><param name=\"X\"/>")
            .replace("stride=\"3\"", "stride=\"3\" offset=\"0\"")
            .replace("<param/>", ""),
        box_file.replace("<scene><instance_visual_scene url=\"#sc\"/></scene>", ""),
        box_file.replace(
            "<node>",
            "<node><skew>0 1 0 0 0 1 0</skew><lookat>0 0 0 0 0 -1 0 1 0</lookat>",
        ),
    ] {
        is_box(&text);
    }
    let no_scene = box_file.find("<library_visual").expect("scenes");
    is_box(&format!("{}</COLLADA>", &box_file[..no_scene]));
    let wide: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain(box_file.encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    let file = parse(&wide, "a.dae").expect("UTF-16");
    assert!((volume(&file) - VOLUME).abs() < 1e-12);
    let shifted = box_file
        .replace("27\">", "29\">7 7 ")
        .replace("count=\"9\" stride", "count=\"9\" offset=\"2\" stride");
    is_box(&shifted);
}

#[test]
fn transforms_are_those_of_the_specification() {
    let quads = "0 1 3 2 4 6 7 5 0 4 5 1 2 3 7 6 0 2 6 4 1 5 7 3";
    let text = of_box(&format!(
        "<polylist count=\"6\">{INPUT}<vcount>4 4 4 4 4 4</vcount><p>{quads}</p></polylist>"
    ));
    let moved = |transform: &str| read(&text.replace("<node>", &format!("<node>{transform}"))).expect("a box");
    let near = |file: &lin_canny_formats::MeshFile, low: [f64; 3], high: [f64; 3]| {
        let found = bounds(file);
        let pairs = found.iter().flatten().zip(low.iter().chain(&high));
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert!(volume(file) > 0.0);
    };
    // An eye at (1, 0, 0) that looks along x: its z axis is -x, its y axis z, its x axis -y.
    near(
        &moved("<lookat>1 0 0 2 0 0 0 0 1</lookat>"),
        [0.4, -0.2, 0.0],
        [1.0, 0.0, 0.4],
    );
    // Points move along x by their y: 45 degrees.
    near(&moved("<skew>45 0 1 0 1 0 0</skew>"), [0.0; 3], [0.6, 0.4, 0.6]);
    near(&moved("<rotate>1 0 0 90</rotate>"), [0.0, -0.6, 0.0], [0.2, 0.0, 0.4]);
    near(&moved("<scale>1 -1 1</scale>"), [0.0, -0.4, 0.0], [0.2, 0.0, 0.6]);
    near(
        &moved("<translate>1 2 3</translate><scale>2 2 2</scale>"),
        [1.0, 2.0, 3.0],
        [1.4, 2.8, 4.2],
    );
}

#[test]
fn holes_and_notches_stay_open() {
    // A plate with a square hole, and a U.
    let plate = r##"<polygons count="1"><input semantic="VERTEX" source="#v" offset="0"/><ph><p>0 1 2 3</p><h>4 5 6 7</h></ph></polygons>"##;
    let u =
        r##"<polygons count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3 4 5 6 7</p></polygons>"##;
    for (corners, primitive, expected) in [
        ("0 0 0 3 0 0 3 3 0 0 3 0 1 1 0 2 1 0 2 2 0 1 2 0", plate, 8.0),
        ("0 0 0 3 0 0 3 3 0 2 3 0 2 1 0 1 1 0 1 3 0 0 3 0", u, 7.0),
    ] {
        let text = of_box(primitive);
        let (from, to) = (
            text.find("27\">").expect("numbers") + 4,
            text.find(" .9 .9 .9").expect("numbers"),
        );
        let text = format!("{}{corners}{}", &text[..from], &text[to..]);
        let file = read(&text).unwrap_or_else(|e| panic!("{e}"));
        let (points, triangles) = file.whole();
        let area: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| points[k as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            })
            .sum();
        assert!((area - expected).abs() < 1e-12, "{area}");
    }
}

#[test]
fn mutants_are_read_or_named() {
    read_mutants(FILE.as_bytes(), "a.dae", 10_000);
}
