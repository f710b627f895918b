//! Promise: nodes of a scene share their mesh and stand where the file puts them, links of a robot stand where
//! its joints put them, and rules are the same in JSON and TOML.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use lin_canny::Geometry;
use lin_canny_clash::{ClashOptions, Clashes, Kind, Model, ModelOptions, Rules, Unit, find};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn found(model: &Model, rules: &Rules) -> Clashes {
    let options = ClashOptions::default().volume(true);
    find(model, rules, &options, |_| ControlFlow::Continue(())).expect("parts in range")
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letters = bytes.chunks(3).flat_map(|three| {
        let all = (0..3).fold(0, |all, k| all << 8 | u32::from(*three.get(k).unwrap_or(&0)));
        let letter = move |k: u32| LETTERS[(all >> (18 - 6 * k) & 63) as usize] as char;
        [letter(0), letter(1), letter(2), letter(3)]
    });
    let mut text: String = letters.collect();
    let padding = (3 - bytes.len() % 3) % 3;
    text.replace_range(text.len() - padding.., &"=".repeat(padding));
    text
}

/// Writes a glTF with nodes of one mesh, the cube from the origin to (1, 1, 1), and returns its path.
fn gltf(folder: &Path, nodes: &str) -> PathBuf {
    let cube = truth::soups::cuboid([0.0; 3], [1.0; 3]);
    let corners = cube.points.iter().flatten().map(|x| *x as f32);
    let mut bytes: Vec<u8> = corners.flat_map(f32::to_le_bytes).collect();
    bytes.extend(cube.triangles.iter().flatten().map(|v| *v as u8));
    let count = nodes.matches("{").count();
    let roots: Vec<_> = (0..count)
        .filter(|k| !nodes.contains(&format!("\"children\": [{k}]")))
        .collect();
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": {roots:?}}}], "nodes": [{nodes}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}},
{{"bufferView": 1, "componentType": 5121, "count": 36, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 0, "byteLength": 96}}, {{"buffer": 0, "byteOffset": 96, "byteLength": 36}}],
"buffers": [{{"byteLength": 132, "uri": "data:application/octet-stream;base64,{}"}}]}}"#,
        base64(&bytes)
    );
    let file = folder.join("model.gltf");
    std::fs::write(&file, text).expect("a file");
    file
}

/// The number of meshes that the parts hold in memory.
fn meshes(model: &Model) -> usize {
    let all = model.parts().iter().filter_map(|part| match &part.geometry {
        Geometry::Mesh(mesh) => Some(std::sync::Arc::as_ptr(mesh)),
        _ => None,
    });
    all.collect::<std::collections::HashSet<_>>().len()
}

/// The corners of the box of each part, and whether it faces outward.
fn corners(model: &Model) -> Vec<([f64; 6], bool)> {
    let parts = model.parts().iter().map(|part| {
        let Geometry::Mesh(mesh) = &part.geometry else {
            panic!("{}: no mesh", part.name);
        };
        let points: Vec<_> = mesh.vertices().iter().map(|p| part.pose * p).collect();
        let edge = |k: usize, end: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(end).expect("points");
        let low = [0, 1, 2].map(|k| edge(k, f64::min));
        let high = [0, 1, 2].map(|k| edge(k, f64::max));
        (
            [low, high].concat().try_into().expect("six"),
            mesh.volume_bounds().0 > 0.0,
        )
    });
    parts.collect()
}

#[test]
fn nodes_stand_where_the_file_puts_them() {
    // Half of the root of two in the digits of an f32, which exporters write.
    let nodes = r#"{"name": "frame", "children": [1], "scale": [0.5, 0.5, 0.5]},
        {"name": "left", "mesh": 0, "translation": [2, 0, 0], "children": [2]},
        {"name": "bolt", "mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678], "translation": [0, 4, 0]},
        {"name": "mirror", "mesh": 0, "scale": [-1, 1, 1]},
        {"name": "plate", "mesh": 0, "matrix": [4, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1, 0, 0, 0, 8, 1]},
        {"name": "nothing"},
        {"mesh": 0, "translation": [0, 0, 32]},
        {"name": "plate", "mesh": 0, "translation": [0, 0, 8.5]}"#;
    let file = gltf(&folder("nodes"), nodes);
    let model = Model::load(std::slice::from_ref(&file), &ModelOptions::default()).expect("a model");
    let names: Vec<_> = model.parts().iter().map(|part| part.name.as_str()).collect();
    assert_eq!(
        names,
        ["frame/left", "frame/left/bolt", "mirror", "plate", "object4", "plate#2"]
    );
    // Halves, of which one is turned; the mirror, the plate, and the two as they are.
    assert_eq!(meshes(&model), 4);
    let expected = [
        [1.0, 0.0, 0.0, 1.5, 0.5, 0.5],
        [0.5, 2.0, 0.0, 1.0, 2.5, 0.5],
        [-1.0, 0.0, 0.0, 0.0, 1.0, 1.0],
        [0.0, 0.0, 8.0, 4.0, 0.25, 9.0],
        [0.0, 0.0, 32.0, 1.0, 1.0, 33.0],
        [0.0, 0.0, 8.5, 1.0, 1.0, 9.5],
    ];
    for ((found, is_outward), expected) in corners(&model).into_iter().zip(expected) {
        assert!(is_outward, "{found:?}");
        for (x, y) in found.iter().zip(expected) {
            assert!((x - y).abs() < 1e-8, "{found:?} {expected:?}");
        }
    }
    let rows = found(&model, &Rules::default()).rows;
    let told: Vec<_> = rows.iter().map(|row| (&*row.a, &*row.b, row.kind)).collect();
    assert_eq!(told, [("plate", "plate#2", Kind::Overlapping)]);
    let volume = rows[0].volume.expect("a volume");
    assert!(volume[0] <= 0.125 && 0.125 <= volume[1], "{volume:?}");
    // Millimetres.
    let options = ModelOptions::default().unit(Unit::Millimetre);
    let small = Model::load(&[file], &options).expect("a model");
    assert!((corners(&small)[0].0[3] - 1500.0).abs() < 1e-9);
}

#[test]
fn a_thousand_nodes_share_a_mesh_and_touch() {
    let at = |k: usize| [k % 10, k / 10 % 10, k / 100];
    let node = |k: usize| {
        let [x, y, z] = at(k);
        // Quarter turns about z put the cube on the other side of the axis.
        let (x, y, turn) = match k % 4 {
            0 => (x, y, "0, 0, 0, 1"),
            1 => (x + 1, y, "0, 0, 0.70710678118654752, 0.70710678118654752"),
            2 => (x + 1, y + 1, "0, 0, 1, 0"),
            _ => (x, y + 1, "0, 0, -0.70710678118654752, 0.70710678118654752"),
        };
        format!(r#"{{"name": "die", "mesh": 0, "translation": [{x}, {y}, {z}], "rotation": [{turn}]}}"#)
    };
    let nodes: Vec<_> = (0..1000).map(node).collect();
    let file = gltf(&folder("grid"), &nodes.join(", "));
    let model = Model::load(&[file], &ModelOptions::default()).expect("a model");
    let rules = Rules::from_json(r#"{"allowed_depth": [["*", "*", 1e-14]]}"#).expect("rules");
    let found = found(&model, &rules);
    // Neighbours on a side, an edge and a corner; none is deeper than the rounding of a turn.
    let neighbours = (28 * 28 * 28 - 1000) / 2;
    assert_eq!((model.parts().len(), found.measured), (1000, neighbours));
    assert_eq!(meshes(&model), 1);
    assert!(
        found.rows.iter().all(|row| !row.broken),
        "{:?}",
        found.rows.iter().find(|row| row.broken)
    );
}

#[test]
fn a_robot_stands_where_its_joints_put_it() {
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../robot/examples/six_axis.urdf");
    let srdf = robot.with_extension("srdf");
    let load = |joints: &[(&str, f64)], srdf: Option<PathBuf>| {
        let joints = joints.iter().map(|(name, value)| ((*name).to_owned(), *value));
        let options = ModelOptions::default().joints(joints).srdf(srdf);
        Model::load(std::slice::from_ref(&robot), &options)
    };
    let rest = load(&[], Some(srdf.clone())).expect("a robot");
    let rows = found(&rest, &Rules::default());
    assert!(
        rows.excluded > 0 && rows.rows.iter().all(|row| !row.broken),
        "{:?}",
        rows.rows
    );
    let bent = load(&[("elbow", 2.0)], Some(srdf)).expect("a robot");
    let moved = rest.parts().iter().zip(bent.parts()).filter(|(a, b)| a.pose != b.pose);
    assert!((1..rest.parts().len()).contains(&moved.count()));
    // Neither is passed over without a robot, or with two.
    for inputs in [vec![], vec![robot.clone(); 2]] {
        let file = gltf(&folder("no_robot"), r#"{"name": "die", "mesh": 0}"#);
        let inputs = [inputs, vec![file]].concat();
        for options in [
            ModelOptions::default().joints([("elbow".to_owned(), 1.0)]),
            ModelOptions::default().srdf(Some(robot.with_extension("srdf"))),
        ] {
            let wrong = Model::load(&inputs, &options).expect_err("not one robot").to_string();
            assert!(wrong.contains("those of one robot"), "{wrong}");
        }
    }
    let wrong = load(&[("elbw", 1.0)], None).expect_err("no joint").to_string();
    assert!(wrong.contains("no joint \"elbw\" (expected one of "), "{wrong}");
    let wrong = load(&[("elbow", f64::NAN)], None)
        .map(|_| ())
        .expect_err("no angle")
        .to_string();
    assert!(wrong.contains("six_axis.urdf"), "{wrong}");
}

#[test]
fn rules_are_the_same_in_toml() {
    let text = "margin = 0.25\nmargins = [[\"bolt*\", \"*\", 0.5]]\nexclude = [[\"seal\", \"lid\", \"soft\"]]\n\
                allowed_depth = [[\"pin\", \"hole\", 1e-6]]\ntouching = true\n";
    let rules = Rules::from_toml(text).expect("rules");
    assert_eq!(rules.required("lid", "box").distance, 0.25);
    assert_eq!(rules.required("box", "bolt#2").distance, 0.5);
    assert_eq!(rules.excluded("lid", "seal"), Some("soft"));
    for (wrong, why) in [
        ("margn = 1", "margn"),
        ("margin = -1", "margin is -1"),
        ("margin = nan", "margin is NaN"),
        ("margins = [[\"a\", \"b\"]]", "rules: "),
        ("[", "rules: "),
    ] {
        let error = Rules::from_toml(wrong).expect_err(wrong).to_string();
        assert!(error.contains(why), "{wrong}: {error}");
    }
}
