//! glTF: meshes at the nodes of the scene, in JSON and GLB; what does not fit is an error with its
//! element.

mod support;

use lin_canny_formats::{MeshFile, MeshFormat};
use serde_json::{Value, json};
use support::errors::says;
use support::rng::Rng;
use support::rows::{numbers, rows};
use support::{AREA, BOX, TRIANGLES, VOLUME, area, bounds, parse, read_mutants, volume};

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    rows(include_str!("gltf/rows.txt"), section)
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect(text)
}

/// A glTF whose buffer is not written yet.
#[derive(Clone)]
struct Gltf {
    json: Value,
    bytes: Vec<u8>,
}

impl Gltf {
    /// A file without a mesh, and one node.
    fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": []}],
            "accessors": [],
            "bufferViews": [],
            "buffers": [{"byteLength": 0}],
        });
        let bytes = Vec::new();
        Self { json, bytes }
    }

    /// A box with indices of a type.
    fn new(component: u64) -> Self {
        let mut gltf = Self::empty();
        let positions = gltf.positions(&BOX);
        let indices: Vec<u32> = TRIANGLES.iter().flatten().map(|k| *k as u32).collect();
        let indices = gltf.indices(component, &indices);
        gltf.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
        gltf
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(item);
        list.len() - 1
    }

    fn primitive(&mut self, primitive: Value) {
        let list = self.json["meshes"][0]["primitives"].as_array_mut().expect("a list");
        list.push(primitive);
    }

    fn view(&mut self, data: &[u8]) -> usize {
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0x55);
        }
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len()});
        self.bytes.extend(data);
        self.json["buffers"][0]["byteLength"] = self.bytes.len().into();
        self.push("bufferViews", view)
    }

    fn accessor(&mut self, view: usize, component: u64, kind: &str, count: usize) -> usize {
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    fn floats(&mut self, numbers: &[f64]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
        self.view(&bytes)
    }

    fn positions(&mut self, points: &[[f64; 3]]) -> usize {
        let view = self.floats(points.as_flattened());
        self.accessor(view, 5126, "VEC3", points.len())
    }

    fn indices(&mut self, component: u64, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = match component {
            5121 => indices.iter().map(|k| *k as u8).collect(),
            5123 => indices.iter().flat_map(|k| (*k as u16).to_le_bytes()).collect(),
            _ => indices.iter().flat_map(|k| k.to_le_bytes()).collect(),
        };
        let view = self.view(&bytes);
        self.accessor(view, component, "SCALAR", indices.len())
    }

    fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), Some(&self.bytes))
    }

    fn text(&self) -> String {
        let mut json = self.json.clone();
        let data = format!("data:application/octet-stream;base64,{}", base64(&self.bytes));
        json["buffers"][0]["uri"] = data.into();
        serde_json::to_string_pretty(&json).expect("a text")
    }

    /// Replaces a value, or adds it to its object.
    fn set(mut self, pointer: &str, value: Value) -> Self {
        let (owner, key) = pointer.rsplit_once('/').expect("a pointer");
        let owner = self.json.pointer_mut(owner).expect(pointer);
        match owner {
            Value::Array(list) => list[key.parse::<usize>().expect("a number")] = value,
            Value::Object(map) => drop(map.insert(key.into(), value)),
            _ => panic!("{pointer}"),
        }
        self
    }

    fn without(mut self, pointer: &str) -> Self {
        let (owner, key) = pointer.rsplit_once('/').expect("a pointer");
        let owner = self.json.pointer_mut(owner).and_then(Value::as_object_mut);
        owner.expect(pointer).remove(key).expect(pointer);
        self
    }

    fn read(&self) -> MeshFile {
        let file = parse(self.glb(), "a.glb").unwrap_or_else(|e| panic!("{e}: {}", self.json));
        assert_eq!(parse(self.text(), "a.gltf").expect("a text"), file);
        file
    }

    /// Returns the error, which is the same in JSON and in GLB, unless the length of the file counts.
    fn fault(&self) -> String {
        let error = |bytes: Vec<u8>, name| {
            let error = parse(bytes, name).expect_err(&self.json.to_string());
            let text = error.fault.to_string();
            assert!(text.len() <= 120, "{text}");
            text
        };
        let why = error(self.glb(), "a.glb");
        let other = error(self.text().into_bytes(), "a.gltf");
        assert!(other == why || why.contains("too large"), "{other}, but {why}");
        why
    }

    /// Returns what was skipped.
    fn skipped(&self) -> Vec<String> {
        self.read().skipped.into_iter().map(|s| s.what).collect()
    }
}

fn glb(json: &[u8], binary: Option<&[u8]>) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data, fill) in [(b"JSON", Some(json), b' '), (b"BIN\0", binary, 0)] {
        let Some(data) = data else {
            continue;
        };
        let mut data = data.to_vec();
        data.resize(data.len().next_multiple_of(4), fill);
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let at = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for k in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * k)) as usize & 63];
            text.push(if k <= group.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[track_caller]
fn is_box(file: &MeshFile) {
    assert!((volume(file) - VOLUME).abs() < 1e-7, "{}", volume(file));
    assert!((area(file) - AREA).abs() < 1e-6, "{}", area(file));
    let (points, triangles) = file.whole();
    assert_eq!((points.len(), triangles.len()), (8, 12));
}

#[track_caller]
fn has_bounds(file: &MeshFile, expected: [[f64; 3]; 2]) {
    let found = bounds(file);
    let pairs = found.as_flattened().iter().zip(expected.as_flattened());
    for (a, b) in pairs {
        assert!((a - b).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn json_and_glb_are_read_with_buffers_of_every_kind() {
    let gltf = Gltf::new(5123);
    let file = gltf.read();
    is_box(&file);
    assert_eq!(file.format, MeshFormat::Gltf);
    // Y is up by definition; points are not turned.
    has_bounds(&file, [[0.0; 3], [0.2, 0.4, 0.6]]);
    let text = gltf.text();
    for name in ["a.gltf", "a.glb", "a.stl", "a"] {
        is_box(&parse(&text, name).expect("JSON"));
        is_box(&parse(gltf.glb(), name).expect("GLB"));
    }
    for end in ["\n", "\r", "\r\n"] {
        let text = text.replace('\n', end);
        is_box(&parse(&text, "a.gltf").expect("line ends"));
        is_box(&parse(format!("{end} {text}{end}"), "a.gltf").expect("blank lines"));
        is_box(&parse(format!("\u{feff}{text}"), "a.gltf").expect("a mark"));
        for unit in [u16::to_le_bytes, u16::to_be_bytes] {
            let wide: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(unit).collect();
            is_box(&parse(wide, "a.gltf").expect("UTF-16"));
        }
    }
    let named = gltf.clone().set("/meshes/0/name", "gr#n".into()).text();
    let latin: Vec<u8> = named.bytes().map(|b| if b == b'#' { 0xfc } else { b }).collect();
    assert_eq!(parse(latin, "a.gltf").expect("Latin-1").objects[0].name, "gr\u{fc}n");
    // The property asset may be far behind the start.
    let late = format!("{{{:9000}{}", "", &text.trim_start()[1..]);
    is_box(&parse(late, "a").expect("JSON"));
    // Whole numbers may be written as decimals.
    let decimal = gltf
        .clone()
        .set("/accessors/0/count", json!(8.0))
        .set("/scene", json!(0.0));
    is_box(&decimal.read());
    // Unknown chunks are no error.
    let mut more = gltf.glb();
    more.extend(b"\x04\0\0\0TEST1234");
    let length = more.len() as u32;
    more[8..12].copy_from_slice(&length.to_le_bytes());
    let file = parse(&more, "a.glb").expect("an unknown chunk");
    is_box(&file);
    assert_eq!(file.skipped[0].what, "unknown chunks");
}

#[test]
fn buffers_are_files_of_the_folder() {
    let folder = std::env::temp_dir().join(format!("lin-canny-formats-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("a b")).expect("a folder");
    let gltf = Gltf::new(5121);
    let length = gltf.bytes.len();
    std::fs::write(folder.join("a b/c.bin"), &gltf.bytes).expect("a file");
    std::fs::write(folder.join("short.bin"), &gltf.bytes[..length - 1]).expect("a file");
    let load = |uri: &str| {
        let json = gltf.clone().set("/buffers/0/uri", uri.into()).json.to_string();
        std::fs::write(folder.join("a.gltf"), json).expect("a file");
        MeshFile::load(folder.join("a.gltf"))
    };
    for uri in ["a b/c.bin", "a%20b/c.bin", "./a%20b/c%2Ebin"] {
        is_box(&load(uri).expect(uri));
    }
    let absolute = folder.join("a b/c.bin").to_string_lossy().into_owned();
    for (uri, expected) in [
        ("short.bin", "buffers[0] has an invalid byteLength: "),
        ("missing.bin", "buffers[0] cannot be read from \"missing.bin\""),
        ("a b", "not a file"),
        ("http://localhost/a.bin", "buffers[0] has an invalid uri"),
        ("file:c.bin", "buffers[0] has an invalid uri"),
        ("a b/../a b/c.bin", "buffers[0] has an invalid uri"),
        ("../a.bin", "buffers[0] has an invalid uri"),
        ("", "buffers[0] has an invalid uri"),
        (&absolute, "buffers[0] has an invalid uri"),
        ("data:;base64,AA=A", "buffers[0] has an invalid uri"),
        ("data:,AAAA", "buffers[0] has an invalid uri"),
        ("data:;base64,AAAA", "buffers[0] has an invalid byteLength"),
    ] {
        let error = load(uri).expect_err(uri).fault.to_string();
        assert!(error.contains(expected) && error.len() <= 120, "{error}");
    }
    std::fs::remove_dir_all(folder).expect("a folder");
}

#[test]
fn indices_of_every_type_strips_and_fans_are_read() {
    for component in [5121, 5123, 5125] {
        is_box(&Gltf::new(component).read());
    }
    // Without indices, every three positions are a triangle.
    let corners: Vec<[f64; 3]> = TRIANGLES.iter().flatten().map(|&k| BOX[k]).collect();
    let mut gltf = Gltf::empty();
    let positions = gltf.positions(&corners);
    gltf.primitive(json!({"attributes": {"POSITION": positions}}));
    let file = gltf.read();
    assert!((volume(&file) - VOLUME).abs() < 1e-7);
    assert_eq!((file.whole().0.len(), file.whole().1.len()), (36, 12));
    // Strips around and at the ends; a strip joined by repeated corners; fans around two corners.
    let around = [1, 3, 0, 2, 4, 6, 5, 7, 1, 3];
    let joined = [&around[..], &[3, 4, 4, 5, 0, 1]].concat();
    let families: [&[(u64, &[u32])]; 3] = [
        &[(5, &around), (5, &[4, 5, 0, 1]), (5, &[3, 7, 2, 6])],
        &[(5, &joined), (5, &[3, 7, 2, 6])],
        &[(6, &[0, 1, 3, 2, 6, 4, 5, 1]), (6, &[7, 6, 2, 3, 1, 5, 4, 6])],
    ];
    for family in families {
        let mut gltf = Gltf::empty();
        let positions = gltf.positions(&BOX);
        for &(mode, corners) in family {
            let indices = gltf.indices(5123, corners);
            gltf.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode}));
        }
        is_box(&gltf.read());
    }
    // The largest index of a type is an index like any other.
    let mut gltf = Gltf::empty();
    let mut points = vec![[9.0; 3]; 256];
    points[..8].copy_from_slice(&BOX);
    points[255] = BOX[7];
    let positions = gltf.positions(&points);
    let indices: Vec<u32> = TRIANGLES
        .iter()
        .flatten()
        .map(|&k| if k == 7 { 255 } else { k as u32 })
        .collect();
    let indices = gltf.indices(5121, &indices);
    gltf.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    is_box(&gltf.read());
}

#[test]
fn lines_points_and_attributes_are_skipped() {
    let mut gltf = Gltf::new(5123);
    let far = gltf.positions(&[[50.0; 3], [60.0; 3]]);
    for mode in 0..4 {
        gltf.primitive(json!({"attributes": {"POSITION": far}, "mode": mode}));
    }
    for (key, value) in [
        ("animations", json!([])),
        ("materials", json!([{}])),
        ("cameras", json!([])),
        ("extensionsUsed", json!(["KHR_materials_unlit", "X_y"])),
    ] {
        gltf.json[key] = value;
    }
    gltf.json["meshes"][0]["primitives"][0]["attributes"] =
        json!({"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 7, "COLOR_0": 0, "JOINTS_0": 0, "_X": 0});
    gltf.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    is_box(&gltf.read());
    let expected = [
        "extensions: KHR_materials_unlit, X_y",
        "animations",
        "cameras",
        "materials",
        "morph targets",
        "colors",
        "joints and weights",
        "normals",
        "texture coordinates",
        "other attributes",
        "points",
        "lines",
    ];
    assert_eq!(gltf.skipped(), expected);
}

#[test]
fn strides_offsets_and_sparse_values_are_read() {
    // Positions between other numbers, in one view with an offset.
    let mut gltf = Gltf::empty();
    let numbers: Vec<f64> = BOX.iter().flat_map(|p| [7.0, 8.0, p[0], p[1], p[2], 9.0]).collect();
    let view = gltf.floats(&numbers);
    gltf.json["bufferViews"][view]["byteStride"] = 24.into();
    let positions = gltf.accessor(view, 5126, "VEC3", 8);
    gltf.json["accessors"][positions]["byteOffset"] = 8.into();
    let indices: Vec<u32> = [99, 99]
        .into_iter()
        .chain(TRIANGLES.iter().flatten().map(|k| *k as u32))
        .collect();
    let indices = gltf.indices(5123, &indices);
    gltf.json["accessors"][indices]["byteOffset"] = 4.into();
    gltf.json["accessors"][indices]["count"] = 36.into();
    gltf.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    is_box(&gltf.read());
    // Some positions, or all that are not zero, are replaced.
    for has_view in [true, false] {
        for component in [5121, 5123, 5125] {
            let mut gltf = Gltf::new(5123);
            let replaced: Vec<usize> = if has_view { vec![0, 3, 7] } else { (1..8).collect() };
            if has_view {
                gltf.bytes[..12].fill(0x41);
                gltf.bytes[36..48].fill(0x41);
                gltf.bytes[84..96].fill(0x41);
                assert!(bounds(&gltf.read())[1][0] > 12.0);
            } else {
                gltf = gltf.without("/accessors/0/bufferView");
            }
            let numbers: Vec<u32> = replaced.iter().map(|k| *k as u32).collect();
            let indices = gltf.indices(component, &numbers);
            let indices = gltf.json["accessors"][indices]["bufferView"].clone();
            let values: Vec<f64> = replaced.iter().flat_map(|&k| BOX[k]).collect();
            let values = gltf.floats(&values);
            gltf.json["accessors"][0]["sparse"] = json!({
                "count": replaced.len(),
                "indices": {"bufferView": indices, "componentType": component},
                "values": {"bufferView": values},
            });
            is_box(&gltf.read());
            for (key, value, expected) in [
                (
                    "count",
                    json!(9),
                    "accessors[0].sparse has an invalid count: 9 (expected 0 to 8)",
                ),
                (
                    "indices",
                    json!({"bufferView": 0, "componentType": component}),
                    "accessors[0].sparse.indices",
                ),
                (
                    "indices",
                    json!({"bufferView": indices, "componentType": 5126}),
                    "invalid componentType",
                ),
                (
                    "values",
                    json!({"bufferView": indices}),
                    "accessors[0].sparse.values needs more bytes",
                ),
            ] {
                let why = gltf.clone().set(&format!("/accessors/0/sparse/{key}"), value).fault();
                assert!(why.contains(expected), "{why}");
            }
        }
    }
}

#[test]
fn nodes_transform_meshes() {
    for [transform, expected, scale] in cases("transforms") {
        let mut gltf = Gltf::new(5123);
        let node = gltf.json["nodes"][0].as_object_mut().expect("a node");
        node.extend(json(&transform).as_object().expect("an object").clone());
        let expected: [f64; 6] = numbers(&expected);
        let expected = [
            [expected[0], expected[1], expected[2]],
            [expected[3], expected[4], expected[5]],
        ];
        let [scale] = numbers(&scale);
        let file = gltf.read();
        has_bounds(&file, expected);
        let off = (volume(&file) - scale * VOLUME).abs();
        assert!(off < 1e-6, "{transform}: {}", volume(&file));
        // The same below two nodes that scale and mirror.
        let mut gltf = gltf.set("/scenes/0/nodes", json!([2]));
        gltf.push("nodes", json!({"children": [0], "translation": [0, 0, 1]}));
        gltf.push("nodes", json!({"children": [1], "scale": [1, 1, -2]}));
        let file = gltf.read();
        assert!((volume(&file) - 2.0 * scale * VOLUME).abs() < 1e-6, "{transform}");
        let [low, high] = expected.map(|p| [p[0], p[1], -2.0 * (p[2] + 1.0)]);
        has_bounds(&file, [[low[0], low[1], high[2]], [high[0], high[1], low[2]]]);
    }
    // Numbers of nodes keep all digits.
    let gltf = Gltf::new(5123).set("/nodes/0/translation", json!([0.1234567890123456, 0, 0]));
    assert_eq!(bounds(&gltf.read())[0][0], 0.1234567890123456);
}

#[test]
fn a_mesh_of_several_nodes_is_there_several_times() {
    let mut gltf = Gltf::new(5123).set("/scenes/0/nodes", json!([0, 1, 2]));
    gltf.push("nodes", json!({"mesh": 0, "translation": [2, 0, 0], "name": "two"}));
    gltf.push("nodes", json!({"children": [3, 4], "translation": [4, 0, 0]}));
    gltf.push("nodes", json!({"mesh": 0, "scale": [1, 1, -1], "name": "three"}));
    gltf.push("nodes", json!({"mesh": 0, "name": "four"}));
    let file = gltf.read();
    assert_eq!(file.objects.len(), 4);
    assert_eq!(file.whole().1.len(), 48);
    assert!((volume(&file) - 4.0 * VOLUME).abs() < 1e-6);
    has_bounds(&file, [[0.0, 0.0, -0.6], [4.2, 0.4, 0.6]]);
    // Objects are in the order of the nodes, from parents to children.
    let names: Vec<&str> = file.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["", "two", "three", "four"]);
    let named = gltf.clone().set("/meshes/0/name", "mesh".into()).read();
    assert!(named.objects.iter().all(|object| object.name == "mesh"));
    assert!(gltf.skipped().is_empty());
}

#[test]
fn the_selected_scene_is_read() {
    let mut gltf = Gltf::new(5123);
    gltf.push("nodes", json!({"mesh": 0, "translation": [2, 0, 0]}));
    gltf.push("nodes", json!({"mesh": 0, "translation": [4, 0, 0]}));
    gltf.push("scenes", json!({"nodes": [1, 2]}));
    assert_eq!(gltf.read().objects.len(), 1);
    assert_eq!(
        gltf.skipped(),
        ["scenes that are not selected", "nodes outside the scene"]
    );
    let second = gltf.clone().set("/scene", 1.into());
    assert_eq!(second.read().objects.len(), 2);
    has_bounds(&second.read(), [[2.0, 0.0, 0.0], [4.2, 0.4, 0.6]]);
    // Without a choice the first scene is read, and without a scene every root node.
    assert_eq!(gltf.clone().without("/scene").read().objects.len(), 1);
    let all = gltf.without("/scene").without("/scenes");
    assert_eq!(all.read().objects.len(), 3);
    assert_eq!(all.skipped(), ["missing scene (all root nodes are read)"]);
    let mut other = Gltf::new(5123);
    other.push("meshes", json!({"primitives": [{"attributes": {"POSITION": 0}}]}));
    assert_eq!(other.skipped(), ["meshes outside the scene"]);
}

#[test]
fn wrong_node_trees_are_named() {
    let mut tree = Gltf::new(5123);
    for children in [[2, 3], [4, 5]] {
        tree.push("nodes", json!({"children": children}));
        tree.push("nodes", json!({"mesh": 0}));
    }
    tree.push("nodes", json!({"mesh": 0}));
    // Nodes: 0; 1 with 2, 3; 3 with 4, 5.
    tree.json["nodes"][5] = json!({"mesh": 0});
    let tree = tree
        .set("/nodes/2", json!({"mesh": 0}))
        .set("/nodes/3", json!({"children": [4, 5]}))
        .set("/scenes/0/nodes", json!([0, 1]));
    assert_eq!(tree.read().objects.len(), 4);
    for [pointer, value, expected] in cases("faults of node trees") {
        let why = tree.clone().set(&pointer, json(&value)).fault();
        assert!(why.contains(&expected), "{why}");
    }
    for node in [0, 2, 5] {
        for [key, value, expected] in cases("faults of a node") {
            let why = tree.clone().set(&format!("/nodes/{node}/{key}"), json(&value)).fault();
            assert!(why.contains(&expected), "{why}");
            assert!(why.starts_with(&format!("nodes[{node}]")) || key == "skin", "{why}");
        }
    }
    let both = Gltf::new(5123).set("/nodes/0/scale", json!([1, 1, 1])).set(
        "/nodes/0/matrix",
        json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
    );
    assert!(both.fault().contains("next to translation"));
    let weights = Gltf::new(5123).set("/meshes/0/weights", json!([0, 1]));
    assert!(weights.fault().contains("a morph with a weight other than 0"));
    is_box(&weights.set("/nodes/0/weights", json!([0, 0])).read());
}

#[test]
fn wrong_meshes_are_named() {
    let gltf = Gltf::new(5123);
    // The fault is in the first, a middle or the last of three primitives.
    let primitive = gltf.json["meshes"][0]["primitives"][0].clone();
    let three = gltf
        .clone()
        .set("/meshes/0/primitives", json!([primitive, primitive, primitive]));
    assert_eq!(three.read().whole().1.len(), 36);
    for k in 0..3 {
        for [key, value, expected] in cases("faults of a primitive") {
            let why = three
                .clone()
                .set(&format!("/meshes/0/primitives/{k}/{key}"), json(&value))
                .fault();
            assert!(why.contains(&expected), "{why}");
            if !expected.contains("accessors") && !expected.contains("quantized") {
                assert!(why.starts_with(&format!("meshes[0].primitives[{k}]")), "{why}");
            }
        }
        // Only eight positions without indices: two triangles and a rest.
        let rest = three
            .clone()
            .without(&format!("/meshes/0/primitives/{k}/indices"))
            .fault();
        assert!(rest.contains("has 8 corners (expected a multiple of 3)"), "{rest}");
    }
    for [pointer, value, expected] in cases("faults of a mesh") {
        let why = gltf.clone().set(&pointer, json(&value)).fault();
        assert!(why.contains(&expected), "{why} instead of {expected}");
    }
    is_box(&gltf.clone().set("/asset", json!({"version": "2.1"})).read());
    for [pointer, expected] in cases("missing properties") {
        let gltf = gltf.clone().without(&pointer);
        let why = if pointer == "/asset" {
            let text = gltf.json.to_string();
            parse(glb(text.as_bytes(), None), "a.glb")
                .expect_err("no asset")
                .fault
                .to_string()
        } else {
            gltf.fault()
        };
        assert!(why.contains(&expected), "{why}");
    }
    says(
        parse(glb(gltf.json.to_string().as_bytes(), None), "a.glb"),
        "buffers[0] has no uri",
    );
}

#[test]
fn a_wrong_number_in_any_place_is_named() {
    for component in [5121, 5123, 5125] {
        let gltf = Gltf::new(component);
        let size = [1, 2, 4][(component - 5121) as usize / 2];
        for k in [0, 17, 35] {
            let mut gltf = gltf.clone();
            let at = 96 + size * k;
            gltf.bytes[at..at + size].fill(0);
            gltf.bytes[at] = 8;
            let why = gltf.fault();
            assert!(
                why.starts_with("meshes[0].primitives[0] uses vertex 8 that does not exist"),
                "{why}"
            );
        }
        for k in [0, 3, 7] {
            for axis in 0..3 {
                for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    let mut gltf = gltf.clone();
                    gltf.bytes[12 * k + 4 * axis..][..4].copy_from_slice(&bad.to_le_bytes());
                    let why = gltf.fault();
                    let expected = format!("meshes[0].primitives[0] uses vertex {k} that is not finite");
                    assert_eq!(why, expected);
                }
            }
        }
    }
    // Positions that no triangle uses may be anything.
    let mut gltf = Gltf::empty();
    let mut points = BOX.to_vec();
    points.insert(0, [f64::NAN; 3]);
    let positions = gltf.positions(&points);
    let indices: Vec<u32> = TRIANGLES.iter().flatten().map(|k| 1 + *k as u32).collect();
    let indices = gltf.indices(5125, &indices);
    gltf.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    is_box(&gltf.read());
    // A repeated corner of a strip has no triangle, but must exist.
    for corners in [[4, 5, 5, 9], [9, 9, 0, 1], [0, 9, 9, 1]] {
        let mut gltf = Gltf::new(5123);
        let indices = gltf.indices(5123, &corners);
        gltf.primitive(json!({"attributes": {"POSITION": 0}, "indices": indices, "mode": 5}));
        assert!(gltf.fault().contains("meshes[0].primitives[1] uses vertex 9"));
    }
    for mode in [5, 6] {
        for count in 0..3 {
            let mut gltf = Gltf::new(5123);
            let indices = gltf.indices(5123, &[0, 1, 2][..count]);
            gltf.primitive(json!({"attributes": {"POSITION": 0}, "indices": indices, "mode": mode}));
            let why = gltf.fault();
            assert!(
                why.contains(&format!("primitives[1] has {count} corners of a strip or fan")),
                "{why}"
            );
        }
    }
}

#[test]
fn extensions_are_named() {
    let gltf = Gltf::new(5123);
    for name in [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "EXT_mesh_gpu_instancing",
        "X_unknown",
    ] {
        for list in [
            json!([name]),
            json!(["KHR_materials_unlit", name]),
            json!([name, "KHR_materials_unlit"]),
        ] {
            let why = gltf.clone().set("/extensionsRequired", list).fault();
            assert!(
                why.contains(&format!("the required extension \"{name}\" is not supported")),
                "{why}"
            );
        }
        is_box(&gltf.clone().set("/extensionsUsed", json!([name])).read());
    }
    is_box(
        &gltf
            .clone()
            .set("/extensionsRequired", json!(["KHR_texture_basisu"]))
            .read(),
    );
    assert!(
        gltf.clone()
            .set("/extensionsRequired", json!([1]))
            .fault()
            .contains("extensionsRequired")
    );
    // Quantized positions are an error by their type; other numbers may be quantized.
    let quantized = gltf
        .clone()
        .set("/extensionsRequired", json!(["KHR_mesh_quantization"]));
    is_box(&quantized.read());
    let why = quantized.set("/accessors/0/componentType", json!(5122)).fault();
    assert!(why.contains("KHR_mesh_quantization"), "{why}");
    // Draco with a fallback, and without.
    let draco = json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    let draco = gltf.set("/meshes/0/primitives/0/extensions", draco);
    is_box(&draco.read());
    assert_eq!(draco.skipped(), ["KHR_draco_mesh_compression (its fallback is read)"]);
    for accessor in [0, 1] {
        let why = draco
            .clone()
            .without(&format!("/accessors/{accessor}/bufferView"))
            .fault();
        assert!(
            why.contains("KHR_draco_mesh_compression without other data is not supported"),
            "{why}"
        );
    }
}

/// A box with a skin of two joints: nodes 1 and 2, the second above the first by 1 along x.
fn skinned(weights: &[[f64; 4]; 8], inverses: Option<[[f64; 3]; 2]>) -> Gltf {
    let mut gltf = Gltf::new(5123);
    let joints = gltf.view(&[[0, 1, 0, 0]; 8].concat());
    let joints = gltf.accessor(joints, 5121, "VEC4", 8);
    let weights = gltf.floats(weights.as_flattened());
    let weights = gltf.accessor(weights, 5126, "VEC4", 8);
    gltf.json["meshes"][0]["primitives"][0]["attributes"] =
        json!({"POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights});
    // The node of a skinned mesh does not move it.
    gltf.json["nodes"][0] = json!({"mesh": 0, "skin": 0, "translation": [100, 0, 0]});
    gltf.push("nodes", json!({"translation": [10, 0, 0], "children": [2]}));
    gltf.push("nodes", json!({"translation": [1, 0, 0]}));
    let mut gltf = gltf.set("/scenes/0/nodes", json!([0, 1]));
    gltf.json["skins"] = json!([{"joints": [1, 2]}]);
    if let Some(inverses) = inverses {
        let columns: Vec<f64> = inverses
            .iter()
            .flat_map(|t| {
                [
                    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, t[0], t[1], t[2], 1.0,
                ]
            })
            .collect();
        let view = gltf.floats(&columns);
        let accessor = gltf.accessor(view, 5126, "MAT4", 2);
        gltf.json["skins"][0]["inverseBindMatrices"] = accessor.into();
    }
    gltf
}

#[test]
fn skins_are_at_rest() {
    let first = [[1.0, 0.0, 0.0, 0.0]; 8];
    let file = skinned(&first, None).read();
    is_box(&file);
    has_bounds(&file, [[10.0, 0.0, 0.0], [10.2, 0.4, 0.6]]);
    has_bounds(
        &skinned(&[[0.0, 1.0, 0.0, 0.0]; 8], None).read(),
        [[11.0, 0.0, 0.0], [11.2, 0.4, 0.6]],
    );
    has_bounds(
        &skinned(&[[0.25, 0.75, 0.0, 0.0]; 8], None).read(),
        [[10.75, 0.0, 0.0], [10.95, 0.4, 0.6]],
    );
    // Inverse bind matrices that undo the joints.
    let undone = skinned(&[[0.5, 0.5, 0.0, 0.0]; 8], Some([[-10.0, 0.0, 0.0], [-11.0, 0.0, 0.0]]));
    let file = undone.read();
    is_box(&file);
    has_bounds(&file, [[0.0; 3], [0.2, 0.4, 0.6]]);
    assert_eq!(undone.skipped(), ["skins (meshes are at rest)"]);
    // The half of the box with x = 0.2 follows the second joint: the box is 1 longer.
    let mut halves = first;
    halves[4..].fill([0.0, 1.0, 0.0, 0.0]);
    let file = skinned(&halves, None).read();
    has_bounds(&file, [[10.0, 0.0, 0.0], [11.2, 0.4, 0.6]]);
    assert!((volume(&file) - 6.0 * VOLUME).abs() < 1e-5);
    // Normalized weights, and joints of 16 bits.
    let mut gltf = skinned(&first, None);
    let view = gltf.view(&[[63, 192, 0, 0]; 8].concat());
    let weights = gltf.accessor(view, 5121, "VEC4", 8);
    gltf.json["accessors"][weights]["normalized"] = true.into();
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = weights.into();
    let wide: Vec<u8> = [[0u16, 1, 0, 0]; 8]
        .as_flattened()
        .iter()
        .flat_map(|k| k.to_le_bytes())
        .collect();
    let view = gltf.view(&wide);
    let joints = gltf.accessor(view, 5123, "VEC4", 8);
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = joints.into();
    let x = 10.0 + 192.0 / 255.0;
    has_bounds(&gltf.read(), [[x, 0.0, 0.0], [x + 0.2, 0.4, 0.6]]);
    // Two sets of joints.
    let mut gltf = skinned(&[[0.25, 0.25, 0.0, 0.0]; 8], None);
    let attributes = &mut gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = attributes["JOINTS_0"].clone();
    attributes["WEIGHTS_1"] = attributes["WEIGHTS_0"].clone();
    has_bounds(&gltf.read(), [[10.5, 0.0, 0.0], [10.7, 0.4, 0.6]]);
    // Weights are relative to their sum, which is 1 up to rounding.
    let file = skinned(&[[0.99, 0.0, 0.0, 0.0]; 8], None).read();
    has_bounds(&file, [[10.0, 0.0, 0.0], [10.2, 0.4, 0.6]]);
    // Two primitives over the same positions with other weights are two boxes.
    let mut gltf = skinned(&first, None);
    let weights = gltf.floats([[0.0, 1.0, 0.0, 0.0]; 8].as_flattened());
    let weights = gltf.accessor(weights, 5126, "VEC4", 8);
    let mut second = gltf.json["meshes"][0]["primitives"][0].clone();
    second["attributes"]["WEIGHTS_0"] = weights.into();
    gltf.primitive(second);
    let file = gltf.read();
    assert!((volume(&file) - 2.0 * VOLUME).abs() < 1e-5);
    has_bounds(&file, [[10.0, 0.0, 0.0], [11.2, 0.4, 0.6]]);
    // A joint that mirrors turns triangles over.
    let gltf = skinned(&first, None).set("/nodes/1/scale", json!([-1, 1, 1]));
    let file = gltf.read();
    is_box(&file);
    has_bounds(&file, [[9.8, 0.0, 0.0], [10.0, 0.4, 0.6]]);
}

#[test]
fn wrong_skins_are_named() {
    let first = [[1.0, 0.0, 0.0, 0.0]; 8];
    for k in [0, 3, 7] {
        for (bad, expected) in [
            ([0.0; 4], "with the sum 0"),
            ([0.5, 0.2, 0.0, 0.0], "with the sum 0.7"),
            ([2.0, -1.0, 0.0, 0.0], "has an invalid weight of vertex"),
            ([f64::NAN, 0.0, 0.0, 0.0], "has an invalid weight of vertex"),
            ([f64::INFINITY, 0.0, 0.0, 0.0], "with the sum inf"),
        ] {
            let mut weights = first;
            weights[k] = bad;
            let why = skinned(&weights, None).fault();
            assert!(why.contains(expected) && why.contains(&format!("vertex {k}")), "{why}");
        }
    }
    let gltf = skinned(&first, Some([[0.0; 3]; 2]));
    for [pointer, value, expected] in cases("faults of a skin") {
        let why = gltf.clone().set(&pointer, json(&value)).fault();
        assert!(why.contains(&expected), "{why} instead of {expected}");
    }
    let both = skinned(&[[0.5, 0.5, 0.0, 0.0]; 8], None).set("/nodes/2/scale", json!([-1, 1, 1]));
    assert!(
        both.fault()
            .contains("of which some joints are mirrored is not supported")
    );
    let unused = skinned(&first, None).set("/nodes/2/scale", json!([0, 1, 1]));
    is_box(&unused.read());
}

#[test]
fn wrong_json_has_a_line() {
    let text = Gltf::new(5123).text();
    let lines: Vec<&str> = text.lines().collect();
    for at in [2, lines.len() / 2, lines.len() - 2] {
        for end in ["\n", "\r\n"] {
            let mut lines = lines.clone();
            lines.insert(at, "?");
            let error = parse(lines.join(end), "a.gltf").expect_err("no JSON");
            assert_eq!(error.line, Some(at + 1), "{error}");
        }
    }
    for bad in ["1e400", "NaN", "-Infinity", "01", "+1", "0x1"] {
        let text = text.replacen("\"scene\": 0", &format!("\"scene\": {bad}"), 1);
        says(parse(text, "a.gltf"), "invalid JSON: ");
    }
    // Two values of a key: which one counts?
    for (key, value) in [
        ("\"meshes\": [", "\"meshes\": [],"),
        ("\"POSITION\": 0", "\"POSITION\": 1,"),
        ("\"scene\": 0", "\"sc\\u0065ne\": 0,"),
    ] {
        let text = text.replacen(key, &format!("{value}{key}"), 1);
        let error = parse(text, "a.gltf").expect_err(key);
        assert!(
            error
                .fault
                .to_string()
                .starts_with("invalid JSON: key is there twice: "),
            "{error}"
        );
        assert!(error.line.is_some());
    }
    for cut in 0..text.trim_end().len() {
        assert!(parse(&text[..cut], "a.gltf").is_err(), "{cut}");
    }
}

#[test]
fn wrong_chunks_are_named() {
    let good = Gltf::new(5123).glb();
    for cut in 0..good.len() {
        let mut bytes = good[..cut].to_vec();
        assert!(parse(&bytes, "a.glb").is_err(), "{cut}");
        // Also with a length that fits.
        if cut > 12 {
            bytes[8..12].copy_from_slice(&(cut as u32).to_le_bytes());
            assert!(parse(&bytes, "a.glb").is_err(), "{cut}");
        }
    }
    let longer = [&good[..], b"\0"].concat();
    let why = parse(longer, "a.glb").expect_err("a byte too many").to_string();
    assert!(why.contains(&format!(
        "states a length of {} bytes, but has {}",
        good.len(),
        good.len() + 1
    )));
    let json = Gltf::new(5123).json.to_string();
    let twice = |first: usize| {
        let start = 12 + first;
        let mut bytes = [&good[..], &good[start..]].concat();
        let length = bytes.len() as u32;
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        parse(bytes, "a.glb").expect_err("a chunk twice").to_string()
    };
    assert!(twice(0).contains("misplaced"));
    assert!(twice(8 + json.len().next_multiple_of(4)).contains("misplaced"));
    for (at, value, expected) in [
        (4, 1u32, "version 1 of GLB is not supported"),
        (12, u32::MAX, "the chunk at byte 12 of the GLB is cut"),
        (12, 4, "GLB"),
        (16, 0, "misplaced"),
        (8, u32::MAX, "states a length"),
    ] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        says(parse(&bytes, "a.glb"), expected);
    }
}

#[test]
fn counts_and_depths_are_not_believed() {
    let start = std::time::Instant::now();
    // A chain of many nodes.
    let mut gltf = Gltf::new(5123);
    let count = 100_000;
    gltf.json["nodes"] = (0..count)
        .map(|k| {
            if k + 1 < count {
                json!({"children": [k + 1]})
            } else {
                json!({"mesh": 0})
            }
        })
        .collect();
    is_box(&gltf.read());
    // Zeros without a view, more than any memory holds.
    let mut gltf = Gltf::new(5123).without("/accessors/0/bufferView");
    let indices = gltf.view(&[0]);
    let values = gltf.floats(&[1.0; 3]);
    gltf.json["accessors"][0]["count"] = 4_294_967_295u64.into();
    gltf.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values},
    });
    let why = gltf.without("/meshes/0/primitives/0/indices").fault();
    assert!(why.contains("too large by repeated use of data"), "{why}");
    // A mesh of many nodes, and data of many primitives.
    let mut gltf = Gltf::new(5123);
    let large: Vec<u32> = TRIANGLES
        .iter()
        .flatten()
        .map(|k| *k as u32)
        .cycle()
        .take(180_000)
        .collect();
    let large = gltf.indices(5121, &large);
    gltf.json["meshes"][0]["primitives"][0]["indices"] = large.into();
    let mut nodes = gltf.clone();
    nodes.json["nodes"] = (0..1000).map(|_| json!({"mesh": 0})).collect();
    nodes.json["scenes"][0]["nodes"] = (0..1000).collect();
    assert!(nodes.fault().contains("too large by repeated use of data"));
    let primitive = gltf.json["meshes"][0]["primitives"][0].clone();
    gltf.json["meshes"][0]["primitives"] = vec![primitive; 1000].into();
    assert!(gltf.fault().contains("too large by repeated use of data"));
    // Primitives without triangles at many nodes.
    let mut gltf = skinned(&[[1.0, 0.0, 0.0, 0.0]; 8], None);
    gltf.json["meshes"][0]["primitives"] = vec![json!({"attributes": {}, "mode": 1}); 5000].into();
    let count = 5000;
    gltf.json["nodes"] = (0..count + 3)
        .map(|k| {
            if k < 3 {
                json!({})
            } else {
                json!({"mesh": 0, "skin": 0})
            }
        })
        .collect();
    gltf.json["scenes"][0]["nodes"] = (0..count + 3).collect();
    assert!(gltf.fault().contains("too large by repeated use of data"));
    // JSON inside JSON.
    for depth in [100, 127, 10_000, 1_000_000] {
        let extras = format!("{}{}", "[".repeat(depth), "]".repeat(depth));
        let text = Gltf::new(5123).text();
        let text = text.replacen('{', &format!("{{\"extras\": {extras},"), 1);
        let read = parse(text, "a.gltf");
        assert_eq!(read.is_ok(), depth == 100, "{depth}");
    }
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn mutants_are_read_or_named() {
    let start = std::time::Instant::now();
    let mut plain = Gltf::new(5123);
    let indices = plain.indices(5121, &[1, 3, 0, 2, 4]);
    plain.primitive(json!({"attributes": {"POSITION": 0}, "indices": indices, "mode": 5}));
    plain.push(
        "nodes",
        json!({"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 1, -1]}),
    );
    plain.json["nodes"][0]["children"] = json!([1]);
    let replaced = plain.view(&[1, 2]);
    let values = plain.floats(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    plain.json["accessors"][0]["sparse"] = json!({
        "count": 2,
        "indices": {"bufferView": replaced, "componentType": 5121},
        "values": {"bufferView": values},
    });
    let skin = skinned(&[[0.5, 0.5, 0.0, 0.0]; 8], Some([[-10.0, 0.0, 0.0], [-11.0, 0.0, 0.0]]));
    for gltf in [plain, skin] {
        read_mutants(&gltf.glb(), "a.glb", 20_000);
        read_mutants(gltf.text().as_bytes(), "a.gltf", 20_000);
        numbers_of_json(&gltf);
    }
    assert!(start.elapsed().as_secs() < 120, "{:?}", start.elapsed());
}

/// Reads files with other numbers in the JSON, which stays valid.
fn numbers_of_json(gltf: &Gltf) {
    let mut rng = Rng::new(1);
    let mut paths = Vec::new();
    paths_of_numbers(&gltf.json, String::new(), &mut paths);
    let values = [
        0.0,
        1.0,
        2.0,
        3.0,
        -1.0,
        0.5,
        7.0,
        8.0,
        12.0,
        5121.0,
        5123.0,
        5125.0,
        5126.0,
        4294967295.0,
        1e300,
    ];
    for _ in 0..20_000 {
        let mut json = gltf.json.clone();
        for _ in 0..=rng.below(2) {
            let path = &paths[rng.below(paths.len())];
            let new = match rng.below(8) {
                0 => json!([]),
                1 => json!("a"),
                2 => json
                    .pointer(&paths[rng.below(paths.len())])
                    .cloned()
                    .unwrap_or_default(),
                _ => json!(values[rng.below(values.len())]),
            };
            if let Some(value) = json.pointer_mut(path) {
                *value = new;
            }
        }
        if let Ok(file) = parse(glb(json.to_string().as_bytes(), Some(&gltf.bytes)), "a.glb") {
            assert!(file.whole().0.as_flattened().iter().all(|x| x.is_finite()));
        }
    }
}

fn paths_of_numbers(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Array(list) => (0..list.len()).for_each(|k| paths_of_numbers(&list[k], format!("{path}/{k}"), paths)),
        Value::Object(map) => map
            .iter()
            .for_each(|(key, value)| paths_of_numbers(value, format!("{path}/{key}"), paths)),
        Value::Number(_) => paths.push(path),
        _ => {}
    }
}

/// The positions of a box in integers of each type that the extension allows, as they are and normalised, at a node that
/// makes metres of them.
#[test]
fn quantized_positions_are_read() {
    for (component, largest) in [(5120, 127), (5121, 255), (5122, 32767), (5123, 65535)] {
        for is_normalized in [false, true] {
            let mut gltf = Gltf::empty();
            let is_signed = component % 2 == 0;
            // The box is from -1 to 1, or from 0 to 1.
            let number = |x: f64| match is_signed {
                true => (x * f64::from(largest)) as i32,
                false => (f64::from(x > 0.0) * f64::from(largest)) as i32,
            };
            let numbers: Vec<i32> = BOX.as_flattened().iter().map(|x| number(x.signum())).collect();
            let size = if component < 5122 { 1 } else { 2 };
            // Elements are aligned to four bytes.
            let mut bytes = Vec::new();
            for point in numbers.chunks(3) {
                point.iter().for_each(|x| bytes.extend(&x.to_le_bytes()[..size]));
                bytes.resize(bytes.len().next_multiple_of(4), 0);
            }
            let view = gltf.view(&bytes);
            gltf.json["bufferViews"][view]["byteStride"] = (4 * size).into();
            let positions = gltf.accessor(view, component, "VEC3", BOX.len());
            gltf.json["accessors"][positions]["normalized"] = is_normalized.into();
            let indices: Vec<u32> = TRIANGLES.iter().flatten().map(|k| *k as u32).collect();
            let indices = gltf.indices(5123, &indices);
            gltf.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
            let scale = if is_normalized { 1.0 } else { 1.0 / f64::from(largest) };
            gltf.json["nodes"][0]["scale"] = json!([scale, scale, scale]);
            assert!(gltf.clone().fault().contains("is a quantized POSITION"), "{component}");
            gltf.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
            gltf.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            let (points, triangles) = gltf.read().whole();
            assert_eq!((points.len(), triangles.len()), (8, 12));
            let low = if is_signed { -1.0 } else { 0.0 };
            for x in points.iter().flat_map(|p| *p) {
                assert!(
                    (x - low).abs() < 1e-15 || (x - 1.0).abs() < 1e-15,
                    "{component} {is_normalized} {x}"
                );
            }
        }
    }
    // The least number of a signed type is -1, too.
    let mut gltf = Gltf::empty();
    let bytes: Vec<u8> = [[-128i8, -127, 127], [127, -128, 0], [0, 127, -128]]
        .iter()
        .flat_map(|point| [point[0] as u8, point[1] as u8, point[2] as u8, 0])
        .collect();
    let view = gltf.view(&bytes);
    gltf.json["bufferViews"][view]["byteStride"] = 4.into();
    let positions = gltf.accessor(view, 5120, "VEC3", 3);
    gltf.json["accessors"][positions]["normalized"] = true.into();
    gltf.primitive(json!({"attributes": {"POSITION": positions}}));
    gltf.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let (points, _) = gltf.read().whole();
    assert!(
        points
            .iter()
            .flat_map(|p| p.iter())
            .all(|x| [-1.0, 0.0, 1.0].contains(x)),
        "{points:?}"
    );
}
