//! Mesh files as other programs write them.

use super::*;
use crate::brute_hull;

const OBJ: &str = "# a square pyramid\nmtllib none.mtl\no pyramid\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 0.1\n\
vn 0 0 -1\nvt 0 0\nusemtl red\nf 4//1 3//1 2//1 1//1\nf 1 2 5\nf 2/1 3/1 5/1\nf 3 4 5\nf -2 -5 -1\n";

const STL: &str =
    "SOLID\n  facet normal 0 0 -1\n outer loop\n vertex 0 0 0\n vertex 0 1E0 0\n vertex 1 0 0\n endloop\n endfacet
facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 0.5\nendloop\nendfacet\nendsolid\n";

fn reason(r: Result<Mesh, Reason>) -> String {
    MeshError {
        path: "m.x".into(),
        reason: r.expect_err("refused"),
    }
    .to_string()
}

/// Returns a binary file of one triangle with the given header.
fn binary(header: &[u8], triangles: u32) -> Vec<u8> {
    let mut out = header.to_vec();
    out.resize(80, b' ');
    out.extend(triangles.to_le_bytes());
    for x in [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.1] {
        out.extend(x.to_le_bytes());
    }
    out.extend([0, 0]);
    out
}

#[test]
fn obj_polygons_keep_their_corners_and_digits() {
    let m = parse_obj(OBJ.into()).unwrap();
    let sizes: Vec<usize> = m.faces.iter().map(Vec::len).collect();
    assert_eq!((m.points.len(), sizes), (5, vec![4, 3, 3, 3, 3]));
    let corners = |f: usize| m.faces[f].iter().map(|&i| m.points[i as usize]).collect::<Vec<_>>();
    assert_eq!(
        corners(0),
        [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]]
    );
    assert_eq!(
        corners(4),
        [[0.0, 1.0, 0.0], [0.0; 3], [0.5, 0.5, 0.1]],
        "counted from the end; doubles, not floats"
    );
}

#[test]
fn obj_of_several_objects_is_one_list() {
    let two = format!("{OBJ}o\ng\nv 5 0 0\r\nv 6 0 \\\n 0\nv 5 1 0\nf 6 7 8\nl 1 2\n");
    let m = parse_obj(two.into()).unwrap();
    assert_eq!((m.points.len(), m.faces.len()), (8, 6));
    assert_eq!(m.points[m.faces[5][1] as usize], [6.0, 0.0, 0.0]);
}

#[test]
fn obj_names_need_not_be_unicode() {
    let mut bytes = b"# caf\xe9\no caf\xe9\nusemtl \xff\n".to_vec();
    bytes.extend(OBJ.bytes());
    assert_eq!(parse_obj(bytes).unwrap(), parse_obj(OBJ.into()).unwrap());
}

#[test]
fn stl_text_and_binary_are_told_apart_by_what_they_hold() {
    let text = parse_stl(STL.into()).unwrap();
    assert_eq!(
        (text.points.len(), text.faces.len()),
        (4, 2),
        "no name after the word, capitals"
    );
    for header in [&b"made by hand"[..], b"solid but binary", b""] {
        let m = parse_stl(binary(header, 1)).unwrap();
        assert_eq!(
            (m.points[2], &m.faces[..]),
            ([0.0, 1.0, f64::from(0.1f32)], &[vec![0, 1, 2]][..])
        );
    }
}

#[test]
fn several_solids_of_a_text_are_one_mesh() {
    let [one, two] = [STL.into(), format!("{STL}\n{STL}").into()].map(|text| parse_stl(text).unwrap());
    assert_eq!((two.points, two.faces.len()), (one.points, 2 * one.faces.len()));
}

#[test]
fn what_is_wrong_is_said() {
    assert!(reason(parse_obj("# a corner\nv 0 0\nf 1 2 3\n".into())).contains("malformed: line 2: "));
    assert!(reason(parse_obj("v 0 0 0\nf 1 2 3\n".into())).contains("out of bounds"));
    assert!(reason(parse_stl(binary(b"short", 2))).contains("neither text"));
    assert!(reason(parse_stl(b"<html>".to_vec())).contains("neither text"));
    assert!(reason(parse_stl(STL[..100].into())).contains("malformed"));
    assert!(
        load("no-such-file.obj")
            .unwrap_err()
            .to_string()
            .contains("no-such-file.obj: cannot be read")
    );
    assert!(
        load("mesh.step")
            .unwrap_err()
            .to_string()
            .contains("only .obj and .stl")
    );
}

#[test]
fn our_own_meshes_are_convex_bodies() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/meshes");
    for (name, points, faces) in [("gem.obj", 40, 69), ("nut.stl", 12, 20)] {
        let m = load(dir.join(name)).unwrap();
        assert_eq!((m.points.len(), m.faces.len()), (points, faces), "{name}");
        assert_eq!(
            brute_hull::extreme(&m.points).len(),
            points,
            "{name}: every point is extreme"
        );
    }
}

#[test]
fn obj_of_other_programs_is_read() {
    // A byte order mark, comments at line ends, colours and weights.
    let text = "\u{feff}v 0 0 0 0.5 0.25 1 # red\nv 1 0 0 1.0 # a weight\nv 0 1 0 0.5 0.25 1 1\nf 1 2 3 # one\n";
    let m = parse_obj(text.into()).unwrap();
    assert_eq!((m.points.len(), m.triangles()), (3, vec![[0, 1, 2]]));
    assert_eq!(m.points[m.faces[0][2] as usize], [0.0, 1.0, 0.0]);
}

#[test]
fn obj_corners_that_name_no_point_are_named_by_their_line() {
    for (face, line) in [("f 1 2 4", 4), ("f 1 0 2", 4), ("f -1 -2 -4", 4), ("f 1 2 x", 4)] {
        let why = reason(parse_obj(format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n").into()));
        assert!(why.contains(&format!("line {line}: ")), "{face}: {why}");
    }
    // Continued lines after a backslash count as lines of the file.
    let text = "v 0 0 0\nv 1 \\\n0 \\\r\n0\nv 0 1 0\nf 1 2 \\\n3\nf 1 2 4\n";
    let why = reason(parse_obj(text.into()));
    assert!(why.contains("line 8: "), "{why}");
    let cut = text.rsplit_once("f 1").map(|(good, _)| parse_obj(good.into()).unwrap());
    assert_eq!(cut.unwrap().triangles(), [[0, 1, 2]]);
}

#[test]
fn concave_polygons_are_cut_inside() {
    // An L, from each vertex and in both orientations: three unit squares.
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let points: Vec<Point> = l.map(|[x, y]| [x, 0.5 * y, y]).to_vec();
    for first in 0..6 {
        for is_back in [false, true] {
            let mut face: Vec<u32> = (0..6).map(|k| (k + first) % 6).collect();
            if is_back {
                face.reverse();
            }
            let m = Mesh {
                points: points.clone(),
                faces: vec![face],
                numbers: Vec::new(),
            };
            let area = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|v| l[v as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            let sign = if is_back { -1.0 } else { 1.0 };
            let areas: Vec<f64> = m.triangles().iter().map(|t| sign * area(t)).collect();
            assert!(areas.len() == 4 && areas.iter().all(|a| *a > 0.0), "{first} {areas:?}");
            assert_eq!(areas.iter().sum::<f64>(), 3.0, "{first}");
        }
    }
}
