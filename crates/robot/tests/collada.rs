//! COLLADA files: primitives of every kind at the places of their nodes; whatever is wrong is an
//! error that names its line.

use std::path::Path;

use lin_canny::Geometry;
use lin_canny::nalgebra::Point3;
use lin_canny_robot::{LoadOptions, MeshUse, Packages, Robot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A tetrahedron of triangles, and a cube of a polylist and single polygons, with an input that is
/// passed over.
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

fn load(text: &str) -> Result<Robot, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("collada");
    std::fs::create_dir_all(&folder).expect("a folder");
    let name = format!("{:?}.dae", std::thread::current().id());
    std::fs::write(folder.join(&name), text).expect("a file");
    let urdf = format!(
        "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"{name}\"/></geometry></collision></link></robot>"
    );
    let options = LoadOptions::default().meshes(MeshUse::Mesh);
    Robot::parse(&urdf, folder.join("r.urdf"), &Packages::default(), &options).map_err(|e| e.to_string())
}

#[test]
fn primitives_stand_where_their_nodes_say() {
    let robot = load(FILE).expect("a robot");
    let Geometry::Mesh(mesh) = &robot.links()[0].bodies[0].geometry else {
        panic!("a mesh")
    };
    // Half a metre a unit; the mirrored tetrahedron is turned outside again.
    assert!(
        (mesh.volume() - (8.0 / 6.0 + 1.0 + 1.0) / 8.0).abs() < 1e-12,
        "{}",
        mesh.volume()
    );
    let (low, high) = mesh.aabb();
    let near = |p: Point3<f64>, q: [f64; 3]| (p - Point3::from(q)).norm() < 1e-12;
    assert!(
        near(low, [4.0, 0.0, -1.0]) && near(high, [5.0, 2.5, 0.5]),
        "{low} {high}"
    );
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let refused = |from: &str, to: &str, line: usize, word: &str| {
        assert!(FILE.contains(from), "{from}");
        let error = load(&FILE.replacen(from, to, 1)).expect_err(to);
        assert!(
            error.contains(&format!("line {line}")) && error.contains(word),
            "{error}"
        );
    };
    refused("0 2 1 0 1 3", "0 2 4 0 1 3", 9, "does not exist");
    refused("0 2 1 0 1 3", "0 2 -1 0 1 3", 9, "not an index");
    refused("4 4 4 4<", "4 4 4 5<", 16, "fewer corners");
    refused("0 0 0 1 0 0 0 1 0", "0 0 0 1 x 0 0 1 0", 6, "not a number");
    refused("0 0 0 1 0 0 0 1 0", "0 0 0 1 NaN 0 0 1 0", 6, "not finite");
    refused("stride=\"3\"", "stride=\"0\"", 6, "fewer than three");
    refused("url=\"#tetra\"", "url=\"#tetrad\"", 23, "tetrad");
    refused("source=\"#t-v\"", "source=\"#t\"", 9, "no element");
    refused("<matrix>1 0", "<matrix>1", 24, "transform");
    refused("<rotate>0 0 1", "<rotate>0 0 0", 22, "no length");
    // A node of itself, and doubling without end.
    refused(
        "<instance_geometry url=\"#cube\"/></node></library",
        "<instance_node url=\"#two\"/><instance_node url=\"#two\"/></node></library",
        20,
        "form a cycle",
    );
    assert!(load(&FILE.replace("COLLADA", "collada")).is_err());
    assert!(load("<COLLADA").is_err_and(|e| e.contains("malformed")));
}

#[test]
fn changed_files_never_panic() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let places: Vec<usize> = FILE.char_indices().map(|(k, _)| k).collect();
    let (mut read, mut refused) = (0, 0);
    for _ in 0..2000 {
        let mut text = FILE.to_owned();
        let at = places[random.random_range(0..places.len())];
        let end = (at + random.random_range(0..12)).min(text.len());
        let words = [
            "",
            "7",
            "-",
            "1e308",
            "#cube",
            "\"",
            "<",
            ">",
            "99999999999",
            "NaN",
            "/",
        ];
        text.replace_range(at..end, words[random.random_range(0..words.len())]);
        match load(&text) {
            Ok(_) => read += 1,
            Err(error) => refused += usize::from(!error.is_empty()),
        }
    }
    assert!(read > 200 && refused > 200, "{read} {refused}");
}
