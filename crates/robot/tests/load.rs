//! URDF files: what is read, and that errors name the element.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion};
use lin_canny::{ConvexPolyhedron, GeometryKind, PairTracker, RelativePose};
use lin_canny_robot::{
    CellFile, FileError, FileErrorKind, LoadOptions, MeshUse, MotionKind, Packages, Robot, Srdf, Trajectory,
};
use truth::errors::says;

/// A folder of the examples.
pub fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

fn parse(text: &str) -> Result<Robot, FileError> {
    let packages = Packages::default();
    Robot::parse(text, examples().join("test.urdf"), &packages, &LoadOptions::default())
}

/// A robot of three links `a`, `b`, `c` in a chain with some of its text replaced.
fn changed(from: &str, to: &str) -> Result<Robot, FileError> {
    let text = include_str!("load/chain.urdf").trim_end();
    assert!(text.contains(from), "{from}");
    parse(&text.replacen(from, to, 1))
}

/// The error names the line, the element and, in its reason, some words.
fn refused(from: &str, to: &str, line: u32, words: &[&str]) -> FileErrorKind {
    let error = changed(from, to).expect_err(to);
    let text = error.to_string();
    assert_eq!(error.line, Some(line), "{text}");
    for word in words {
        assert!(text.contains(word), "{text} does not name {word}");
    }
    error.reason
}

#[test]
fn the_example_has_one_coordinate_for_both_fingers() {
    let robot = Robot::load(examples().join("gripper.urdf"), &Packages::default()).expect("a robot");
    let names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["turn", "lift", "elbow", "roll", "bend", "twist", "left"]);
    let right = robot.joints().iter().find(|j| j.name == "right").expect("a joint");
    assert_eq!(right.mimics.as_deref(), Some("left"));
    assert_eq!(right.kind, MotionKind::Prismatic);
    let found = right.drive.map(|d| (d.coordinate, d.factor, d.offset));
    assert_eq!(found, Some((6, 1.0, 0.0)));
    let kinds: Vec<GeometryKind> = robot.links().iter().map(|l| l.bodies[0].geometry.kind()).collect();
    assert!(kinds.contains(&GeometryKind::Curved) && kinds.contains(&GeometryKind::Polyhedron));
    for (k, joint) in robot.joints().iter().enumerate() {
        assert_eq!(joint.child, k + 1);
        assert!(joint.parent <= k);
    }
    assert_eq!(robot.adjacent().len(), 8);
}

#[test]
fn every_solid_and_joint_is_read() {
    let robot = parse(include_str!("load/all.urdf")).expect("a robot");
    assert_eq!(robot.coordinates().len(), 6 + 3 + 1);
    assert_eq!(robot.coordinates()[6].name, "p/x");
    let bodies = &robot.links()[robot.link("c").expect("a link")].bodies;
    let kinds: Vec<GeometryKind> = bodies.iter().map(|b| b.geometry.kind()).collect();
    let expected = [
        GeometryKind::Rounded,
        GeometryKind::Curved,
        GeometryKind::Rounded,
        GeometryKind::Polyhedron,
    ];
    assert_eq!(kinds, expected);
    assert!((bodies[0].geometry.bounding_ball().1 - 2.0).abs() < 1e-12);
    assert_eq!(bodies[0].origin.translation.vector.as_slice(), [1.0, 2.0, 3.0]);
}

#[test]
fn meshes_are_hulls_meshes_or_pieces() {
    let load = |options: LoadOptions| {
        let robot = Robot::load_with(examples().join("gripper.urdf"), &Packages::default(), &options)?;
        let of = |name: &str| robot.links()[robot.link(name).expect("a link")].bodies[0].clone();
        Ok::<_, FileError>([of("left finger"), of("right finger")])
    };
    let of_one = LoadOptions::default()
        .meshes(MeshUse::Mesh)
        .link_meshes([("left finger".into(), MeshUse::Hull)])
        .measure_hulls(true);
    let [left, right] = load(of_one).expect("a robot");
    assert_eq!(left.geometry.kind(), GeometryKind::Polyhedron);
    assert_eq!(right.geometry.kind(), GeometryKind::Mesh);
    let fit = left.hull_fit.expect("measured");
    assert!(fit.gap_lower < 1e-12, "{fit:?}");
    assert!(fit.void_fraction().expect("a volume") < 1e-6, "{fit:?}");
    // The mirrored mesh is closed and not inside out.
    let lin_canny::Geometry::Mesh(mesh) = &right.geometry else {
        panic!("a mesh")
    };
    assert!(mesh.volume() > 0.0);
    let mut pieces = LoadOptions::default().meshes(MeshUse::Pieces);
    says(load(pieces.clone()), "pieces");
    pieces.pieces = Some(examples());
    says(load(pieces.clone()), "finger.obj");
    pieces.pieces = Some(examples().join("gripper_arm"));
    let found = load(pieces).expect("a robot")[0].geometry.kind();
    assert_eq!(found, GeometryKind::Compound);
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let rows = truth::rows::rows(include_str!("load/rows.txt"), "faults");
    for [from, to, line, words, kind] in rows {
        let words: Vec<&str> = words.split("; ").collect();
        let reason = refused(&from, &to, line.parse().expect("a line"), &words);
        assert!(format!("{reason:?}").starts_with(&kind), "{reason:?}");
    }
}

#[test]
fn deep_files_are_refused() {
    let deep = format!(
        "<link name=\"c\">{}{}</link>",
        "<x>".repeat(100_000),
        "</x>".repeat(100_000)
    );
    refused("<link name=\"c\"/>", &deep, 4, &["64"]);
}

#[test]
fn mimics_end_at_a_joint_of_its_own() {
    let limit = "<limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/>\n  </joint>\n</robot>";
    let with = |mimic: &str| limit.replacen("\n", &format!("{mimic}\n"), 1);
    let own = "<mimic joint=\"two\"/>";
    let reason = refused(limit, &with(own), 9, &["joint \"two\"", "itself"]);
    assert!(matches!(reason, FileErrorKind::MimicLoop(names) if names == ["two"]));
    // A joint that mimics a loop is not part of it.
    let mimic = |joint: &str, of: &str| {
        format!(
            "<joint name=\"{joint}\" type=\"continuous\"><parent link=\"a\"/><child link=\"{joint}\"/><mimic joint=\"{of}\"/></joint>"
        )
    };
    let text = ["x", "y", "z"].map(|link| format!("<link name=\"{link}\"/>")).concat();
    let joints = mimic("x", "y") + &mimic("y", "z") + &mimic("z", "y");
    let error = parse(&format!("<robot name=\"r\"><link name=\"a\"/>{text}{joints}</robot>")).expect_err("a loop");
    assert!(matches!(error.reason, FileErrorKind::MimicLoop(names) if names == ["y", "z"]));
    // Each joint follows the one before.
    for (count, is_good) in [(100, true), (101, false)] {
        let links: String = (0..count).map(|k| format!("<link name=\"l{k}\"/>")).collect();
        let joints: String = (0..count)
            .map(|k: usize| {
                mimic(
                    &format!("l{k}"),
                    &k.checked_sub(1).map_or("first".into(), |before| format!("l{before}")),
                )
            })
            .collect();
        let first = "<joint name=\"first\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>";
        let text = format!("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>{links}{first}{joints}</robot>");
        let error = parse(&text).err().map(|error| error.to_string());
        assert_eq!(error.is_none(), is_good);
        assert!(error.is_none_or(|error| error.contains("chain of mimics is too long (expected at most 100 joints)")));
    }
    let reason = refused(limit, &with("<mimic joint=\"six\"/>"), 9, &["joint \"two\"", "six"]);
    assert!(matches!(reason, FileErrorKind::Unknown { kind: "joint", .. }));
    // A fixed joint stays where it is, whatever it mimics.
    let fixed = "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/><mimic joint=\"j\"/></joint>";
    let links = "<link name=\"a\"/><link name=\"b\"/>";
    let robot = parse(&format!("<robot name=\"r\">{links}{fixed}</robot>")).expect("a robot");
    assert!(robot.coordinates().is_empty() && robot.joints()[0].drive.is_none());
    let robot = changed(limit, &with("<mimic joint=\"one\" multiplier=\"-2\" offset=\"0.5\"/>")).expect("a robot");
    assert_eq!(robot.coordinates().len(), 1);
    let drive = robot.joints()[1].drive.expect("a drive");
    assert_eq!((drive.coordinate, drive.factor, drive.offset), (0, -2.0, 0.5));
}

#[test]
fn missing_and_foreign_meshes_are_named() {
    let sphere = "<sphere radius=\"0.5\"/>";
    let mesh = |file: &str| format!("<mesh filename=\"{file}\"/>");
    let reason = refused(
        sphere,
        &mesh("package://nowhere/x.stl"),
        3,
        &[
            "link \"b\"",
            "nowhere/x.stl",
            "; add the folder of its package to the packages",
        ],
    );
    assert!(matches!(reason, FileErrorKind::MissingMesh(_)));
    let reason = refused(sphere, &mesh("x.obj"), 3, &["link \"b\"", "x.obj"]);
    assert!(matches!(reason, FileErrorKind::MissingMesh(_)));
    // A file that is there, and no mesh.
    let reason = refused(
        sphere,
        &mesh("gripper.urdf"),
        3,
        &["link \"b\"", "gripper.urdf", ".stl"],
    );
    assert!(matches!(reason, FileErrorKind::Mesh(_)));
}

/// A file of vertices without faces is a hull, as in MuJoCo, and no mesh.
#[test]
fn points_alone_are_a_hull_where_a_hull_is_wanted() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("points_alone");
    std::fs::create_dir_all(&folder).expect("a folder");
    let rows: Vec<String> = (0..8).map(|k| format!("{} {} {}", k & 1, k >> 1 & 1, k >> 2)).collect();
    let header =
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let words = [8, 0, 0, 0].into_iter().flat_map(u32::to_le_bytes);
    let numbers = rows
        .iter()
        .flat_map(|row| row.split(' '))
        .flat_map(|x| x.parse::<f32>().expect("a number").to_le_bytes());
    std::fs::write(folder.join("c.obj"), format!("v {}\n", rows.join("\nv "))).expect("a file");
    std::fs::write(folder.join("c.ply"), header.to_owned() + &rows.join("\n")).expect("a file");
    std::fs::write(folder.join("c.msh"), words.chain(numbers).collect::<Vec<u8>>()).expect("a file");
    for name in ["c.obj", "c.ply", "c.msh"] {
        let urdf = format!(
            "<robot name='r'><link name='a'><collision><geometry><mesh filename='{name}' scale='2 2 2'/></geometry></collision></link></robot>"
        );
        let mjcf = format!(
            "<mujoco><asset><mesh name='c' file='{name}' scale='2 2 2'/></asset><worldbody><geom type='mesh' mesh='c'/></worldbody></mujoco>"
        );
        let sdf = format!(
            "<sdf version='1.9'><model name='m'><link name='l'><collision name='c'><geometry><mesh><uri>{name}</uri><scale>2 2 2</scale></mesh></geometry></collision></link></model></sdf>"
        );
        for text in [urdf, mjcf, sdf] {
            let load = |options: &LoadOptions| Robot::parse(&text, folder.join("r.xml"), &Packages::default(), options);
            let robot = load(&LoadOptions::default().measure_hulls(true)).unwrap_or_else(|e| panic!("{e}: {text}"));
            let mut bodies = robot.links().iter().flat_map(|link| &link.bodies);
            let body = bodies.next().expect("a body");
            let lin_canny::Geometry::Polyhedron(hull) = &body.geometry else {
                panic!("a hull")
            };
            assert!((hull.volume() - 8.0).abs() < 1e-12 && body.hull_fit.is_none());
            let pieces = load(&LoadOptions::default().meshes(MeshUse::Pieces).pieces(&folder)).expect("pieces");
            assert!(pieces.links().iter().any(|link| !link.bodies.is_empty()));
            let error = load(&LoadOptions::default().meshes(MeshUse::Mesh))
                .expect_err("no triangle")
                .to_string();
            assert!(
                error.contains(name) && error.contains("a point cloud (vertices without faces) as a mesh"),
                "{error}"
            );
        }
    }
}

/// A tetrahedron as STL: text, binary, and binary with a header that begins as text does.
#[test]
fn stl_files_of_every_kind_are_read() {
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let (mut text, mut binary) = (String::from("solid tetra\n"), vec![0u8; 80]);
    binary.extend(4u32.to_le_bytes());
    for face in faces {
        text += "facet normal 0 0 1\nouter loop\n";
        binary.extend([0; 12]);
        for [x, y, z] in face.map(|k| corners[k]) {
            text += &format!("vertex {x} {y} {z}\n");
            binary.extend([x, y, z].iter().flat_map(|c| c.to_le_bytes()));
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid tetra\n";
    let mut like_text = binary.clone();
    like_text[..11].copy_from_slice(b"solid tetra");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stl");
    std::fs::create_dir_all(&folder).expect("a folder");
    let options = LoadOptions::default().meshes(MeshUse::Mesh);
    let load = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).expect("a file");
        let shape = format!("<mesh filename=\"{name}\" scale=\"2 2 2\"/>");
        let text = format!(
            "<robot name=\"r\"><link name=\"a\"><collision><geometry>{shape}</geometry></collision></link></robot>"
        );
        Robot::parse(&text, folder.join("r.urdf"), &Packages::default(), &options)
    };
    for (name, bytes) in [
        ("text.stl", text.as_bytes()),
        ("binary.STL", &binary),
        ("like.stl", &like_text),
    ] {
        let robot = load(name, bytes).expect(name);
        let lin_canny::Geometry::Mesh(mesh) = &robot.links()[0].bodies[0].geometry else {
            panic!("{name}")
        };
        assert!((mesh.volume() - 8.0 / 6.0).abs() < 1e-12, "{name}");
    }
    let names = |name: &str, bytes: &[u8], word: &str| {
        let error = load(name, bytes).expect_err(name).to_string();
        assert!(error.contains(name) && error.contains(word), "{error}");
    };
    // A second solid is a part of the body, and so is every triangle of a binary file.
    let shifted = text.replace("vertex 1 0 0", "vertex -1 0 0").replace("tetra", "two");
    let both = load("both.stl", (text.clone() + &shifted).as_bytes()).expect("two solids");
    let lin_canny::Geometry::Mesh(mesh) = &both.links()[0].bodies[0].geometry else {
        panic!("a mesh")
    };
    assert_eq!(mesh.triangle_count(), 8);
    let mut half = binary.clone();
    half[80] = 2;
    names("half.stl", &half, "states 2 triangles");
    names("cut.stl", &binary[..150], "states 4 triangles");
    names("x.dae", b"<COLLADA/>", "no triangle");
    names(
        "x.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n",
        "line 3: invalid number",
    );
    names(
        "y.obj",
        b"v 0 0 0\nf 1 2 9\n",
        "line 2: vertex of a face does not exist: 2",
    );
}

#[test]
fn packages_are_found_in_folders_of_either_kind() {
    let text = |name: &str| {
        let mesh =
            format!("<link name=\"a\"><collision><geometry><mesh filename=\"{name}\"/></geometry></collision></link>");
        format!("<robot name=\"one\">{mesh}</robot>")
    };
    let load = |name: &str, packages: &Packages| {
        let path = Path::new("/nowhere/at/all.urdf");
        Robot::parse(&text(name), path, packages, &LoadOptions::default())
    };
    let name = "package://gripper_arm/finger.obj";
    assert!(load(name, &Packages::default()).is_err());
    assert!(load(name, &Packages::new([examples()])).is_ok());
    assert!(load("package:///gripper_arm/finger.obj", &Packages::new([examples()])).is_ok());
    assert!(load(name, &Packages::new([examples().join("gripper_arm")])).is_ok());
    let file = format!("file://{}", examples().join("gripper_arm/finger.obj").display());
    assert!(load(&file, &Packages::default()).is_ok());
}

/// Elements that only draw, and those of other tools, are passed over however they are written.
#[test]
fn what_is_only_drawn_is_passed_over() {
    let ball = "<collision><geometry><sphere radius=\"1\"/></geometry></collision>";
    let drawn =
        "<visual><geometry><sphere radius=\"1\"/></geometry><material name=\"m\"><texture/></material></visual>";
    let other = "<collision_checking><capsule name=\"test\"/></collision_checking>";
    let text = format!(
        "<robot name=\"r\"><material name=\"m\"><texture/></material><link name=\"a\">{ball}{drawn}{other}</link></robot>"
    );
    assert_eq!(parse(&text).expect("a robot").links()[0].bodies.len(), 1);
}

/// A robot of a version whose origin of the joint `one`, of both collisions or of none has a text.
fn with_origin(version: &str, place: usize, origin: &str) -> Result<Robot, FileError> {
    let at = |k: usize| if k == place { origin } else { "<origin/>" };
    let ball = |k: usize| {
        let at = at(k);
        format!("<collision>\n{at}<geometry><sphere radius=\"1\"/></geometry></collision>")
    };
    parse(&format!(
        "<robot name=\"r\" {version}><link name=\"a\">{}</link>\n<link name=\"b\">{}{}</link>
        <joint name=\"one\" type=\"fixed\">\n{}<parent link=\"a\"/><child link=\"b\"/></joint></robot>",
        ball(0),
        ball(1),
        ball(2),
        at(3)
    ))
}

/// The line of each place of `with_origin`.
const ORIGINS: [u32; 4] = [2, 4, 5, 7];

#[test]
fn quaternions_are_kept_near_every_pitch_and_at_every_length() {
    for degrees in (-1800..=1800).map(|k| f64::from(k) / 20.0) {
        for [roll, yaw] in [[0.0, 0.0], [0.35, 0.5]] {
            let turn = UnitQuaternion::from_euler_angles(roll, degrees.to_radians(), yaw);
            let length = [1.0, 1e-200, 1e200, 0.003][(degrees.abs() * 20.0) as usize % 4];
            let [x, y, z, w] = <[f64; 4]>::from(turn.coords).map(|c| c * length);
            let origin = format!("<origin quat_xyzw=\"{x} {y} {z} {w}\"/>");
            for place in 0..4 {
                let robot = with_origin("version=\"1.1\"", place, &origin).expect(&origin);
                let found = match place {
                    3 => robot.joints()[0].origin,
                    0 => robot.links()[0].bodies[0].origin,
                    _ => robot.links()[1].bodies[place - 1].origin,
                };
                let off = (found.rotation.into_inner() - turn.into_inner()).norm();
                assert!(off < 1e-15, "{degrees}: {off:e}");
            }
        }
    }
}

#[test]
fn wrong_quaternions_are_named_wherever_they_stand() {
    let wrong = [
        ("1.1", "quat_xyzw=\"0 0 0 0\"", "length of quat_xyzw"),
        ("1.1", "quat_xyzw=\"0 0 0 NaN\"", "NaN"),
        ("1.1", "quat_xyzw=\"0 0 0 1e400\"", "1e400"),
        ("1.1", "quat_xyzw=\"0 0 1\"", "4 finite numbers"),
        ("1.1", "rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\"", "at most one"),
        ("1.0", "quat_xyzw=\"0 0 0 1\"", "1.1 or later"),
        ("0.9", "quat_xyzw=\"0 0 0 1\"", "1.1 or later"),
        ("one", "", "invalid version"),
        ("1.x", "", "invalid version"),
    ];
    for (version, attribute, words) in wrong {
        for (place, line) in ORIGINS.into_iter().enumerate() {
            let origin = format!("<origin xyz=\"1 2 3\" {attribute}/>");
            let error = with_origin(&format!("version=\"{version}\""), place, &origin).expect_err(attribute);
            let line = if attribute.is_empty() { 1 } else { line };
            assert!(error.to_string().contains(words), "{error}");
            assert_eq!(error.line, Some(line), "{error}");
        }
    }
    let error = with_origin("", 3, "<origin quat_xyzw=\"0 0 0 1\"/>").expect_err("version 1.0");
    let FileErrorKind::Version { version, since, .. } = error.reason else {
        panic!("{error}")
    };
    assert_eq!((version, since), ([1, 0], [1, 1]));
    for version in ["1.1", " 1.2 ", "1.10", "2.0"] {
        let version = format!("version=\"{version}\"");
        assert!(with_origin(&version, 3, "<origin quat_xyzw=\"0 0 0 1\"/>").is_ok());
    }
}

/// The square of a large axis overflows, that of a small one is zero.
#[test]
fn axes_of_every_length_are_kept() {
    for length in ["1e-200", "0.001", "5", "1e200"] {
        let axis = format!("<axis xyz=\"0 0 {length}\"/>");
        let robot = changed("<axis xyz=\"0 1 0\"/>", &axis).expect(length);
        assert_eq!(robot.joints()[1].axis.as_slice(), [0.0, 0.0, 1.0]);
    }
}

/// A link `b` of one shape at the origin, as a robot reads it or as an obstacle of a cell.
fn solid(urdf: &str, json: &str) -> Vec<Result<lin_canny::Geometry, FileError>> {
    let robot = parse(&format!(
        "<robot name=\"r\"><link name=\"b\">\n<collision><geometry>{urdf}</geometry></collision></link></robot>"
    ));
    let text = format!("{{\"bodies\": [{{\"name\": \"b\", {json}}}]}}");
    let cell = CellFile::parse(&text, "cell.json", &Packages::default(), &LoadOptions::default());
    vec![
        robot.map(|robot| robot.links()[0].bodies[0].geometry.clone()),
        cell.map(|cell| cell.obstacles[0].geometry.clone()),
    ]
}

/// Every pair of sizes that may be zero, with the distance from a point far away on each axis.
#[test]
fn solids_without_size_are_points_segments_and_rectangles() {
    let far = lin_canny::Geometry::from(ConvexPolyhedron::point(Point3::origin()).expect("a point"));
    let distance = |body: &lin_canny::Geometry, at: [f64; 3]| {
        let pose = RelativePose::from_isometry(&Isometry3::translation(at[0], at[1], at[2])).expect("a pose");
        PairTracker::new().closest(body, &far, &pose).distance
    };
    let check = |urdf: &str, json: &str, half: [f64; 3]| {
        for body in solid(urdf, json) {
            let body = body.expect(urdf);
            for axis in 0..3 {
                for sign in [-1.0, 1.0] {
                    let mut at = [0.0; 3];
                    at[axis] = 10.0 * sign;
                    let found = distance(&body, at);
                    let off = (found - (10.0 - half[axis])).abs();
                    assert!(off < 1e-12, "{urdf} along {axis}: {found}");
                }
            }
        }
    };
    for k in 0..8 {
        let [x, y, z] = std::array::from_fn(|axis| if k >> axis & 1 == 1 { 0.0 } else { axis as f64 + 1.0 });
        let half = [0.5 * x, 0.5 * y, 0.5 * z];
        let urdf = format!("<box size=\"{x} {y} {z}\"/>");
        check(&urdf, &format!("\"box\": {{\"size\": [{x}, {y}, {z}]}}"), half);
    }
    for (radius, length, half) in [
        (0.0, 0.0, [0.0; 3]),
        (0.0, 2.0, [0.0, 0.0, 1.0]),
        (0.5, 0.0, [0.5; 3]),
        (0.5, 2.0, [0.5, 0.5, 1.5]),
    ] {
        let sizes = format!("{{\"radius\": {radius}, \"length\": {length}}}");
        let urdf = format!("<capsule radius=\"{radius}\" length=\"{length}\"/>");
        check(&urdf, &format!("\"capsule\": {sizes}"), half);
        if radius == 0.0 {
            check(
                &urdf.replace("capsule", "cylinder"),
                &format!("\"cylinder\": {sizes}"),
                half,
            );
        }
    }
    check("<sphere radius=\"0\"/>", "\"sphere\": {\"radius\": 0}", [0.0; 3]);
    check("<sphere radius=\"-0\"/>", "\"sphere\": {\"radius\": -0.0}", [0.0; 3]);
    // A disc has no body; the message says what to write.
    for error in solid(
        "<cylinder radius=\"0.5\" length=\"0\"/>",
        "\"cylinder\": {\"radius\": 0.5, \"length\": 0}",
    ) {
        let error = error.expect_err("a disc").to_string();
        assert!(error.contains("disc of radius 0.5"), "{error}");
        assert!(error.contains("1e-6"), "{error}");
    }
}

#[test]
fn negative_sizes_are_errors_in_every_place() {
    let names = |urdf: String, json: String, field: &str| {
        for error in solid(&urdf, &json) {
            says(error, &format!("{field} is out of range: -1"));
        }
    };
    for other in [0.0, 1.0] {
        for axis in 0..3 {
            let mut size = [other; 3];
            size[axis] = -1.0;
            let [x, y, z] = size;
            names(
                format!("<box size=\"{x} {y} {z}\"/>"),
                format!("\"box\": {{\"size\": [{x}, {y}, {z}]}}"),
                "size",
            );
        }
        for (radius, length, field) in [(-1.0, other, "radius"), (other, -1.0, "length")] {
            for name in ["cylinder", "capsule"] {
                let urdf = format!("<{name} radius=\"{radius}\" length=\"{length}\"/>");
                let json = format!("\"{name}\": {{\"radius\": {radius}, \"length\": {length}}}");
                names(urdf, json, field);
            }
        }
    }
    names(
        "<sphere radius=\"-1\"/>".into(),
        "\"sphere\": {\"radius\": -1}".into(),
        "radius",
    );
}

#[test]
fn hulls_of_flat_meshes_are_polygons() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("flat");
    std::fs::create_dir_all(&folder).expect("a folder");
    let load = |text: &str, options: &LoadOptions| {
        std::fs::write(folder.join("flat.obj"), text).expect("a file");
        let shape = "<mesh filename=\"flat.obj\" scale=\"2 2 2\"/>";
        let text = format!(
            "<robot name=\"r\"><link name=\"a\"><collision><geometry>{shape}</geometry></collision></link></robot>"
        );
        Robot::parse(&text, folder.join("r.urdf"), &Packages::default(), options)
    };
    // A square of two triangles in each plane, and one turned.
    let square = |f: &dyn Fn(f64, f64) -> [f64; 3]| {
        let point = |[x, y, z]: [f64; 3]| format!("v {x} {y} {z}\n");
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        corners.map(|[u, v]| point(f(u, v))).concat() + "f 1 2 3\nf 1 3 4\n"
    };
    let planes: [&dyn Fn(f64, f64) -> [f64; 3]; 4] = [
        &|u, v| [u, v, 0.25],
        &|u, v| [0.25, u, v],
        &|u, v| [v, 0.25, u],
        &|u, v| [u, v, 0.5 * u - v],
    ];
    for plane in planes {
        for options in [
            LoadOptions::default().measure_hulls(true),
            LoadOptions::default().meshes(MeshUse::Pieces).pieces(&folder),
        ] {
            let robot = load(&square(plane), &options).expect("a robot");
            let body = &robot.links()[0].bodies[0];
            let (low, high) = match &body.geometry {
                lin_canny::Geometry::Polyhedron(hull) => {
                    assert_eq!((hull.face_count(), hull.vertex_count()), (2, 4));
                    hull.aabb()
                }
                other => {
                    assert_eq!(other.kind(), GeometryKind::Compound);
                    continue;
                }
            };
            let [a, b] = [plane(0.0, 0.0), plane(1.0, 1.0)].map(|p| 2.0 * p[0]);
            assert!(low.x <= a.min(b) && high.x >= a.max(b), "{low} {high}");
        }
    }
}

/// A robot of three links of two meshes each, of which some files do not exist.
fn with_meshes(is_there: impl Fn(usize) -> bool) -> String {
    let mesh = |k: usize| {
        let name = if is_there(k) {
            "finger".into()
        } else {
            format!("gone{k}")
        };
        let mesh = format!("<mesh filename=\"package://gripper_arm/{name}.obj\"/>");
        format!("<collision><geometry>\n{mesh}</geometry></collision>")
    };
    let links = (0..3).map(|k| format!("<link name=\"l{k}\">{}{}</link>", mesh(2 * k), mesh(2 * k + 1)));
    let joint = |k: usize| {
        let ends = format!("<parent link=\"l{}\"/><child link=\"l{k}\"/>", k - 1);
        format!("<joint name=\"j{k}\" type=\"continuous\">{ends}</joint>")
    };
    let links: String = links.collect();
    format!("<robot name=\"r\">{links}{}{}</robot>", joint(1), joint(2))
}

#[test]
fn missing_meshes_are_skipped_only_if_asked_for() {
    let load = |text: &str, options: &LoadOptions| {
        Robot::parse(text, examples().join("r.urdf"), &Packages::default(), options)
    };
    let skip = LoadOptions::default().skip_missing_meshes(true);
    for gone in 0..64usize {
        let text = with_meshes(|k| gone >> k & 1 == 0);
        let missing: Vec<usize> = (0..6).filter(|k| gone >> k & 1 == 1).collect();
        match load(&text, &LoadOptions::default()) {
            Ok(robot) => assert!(missing.is_empty() && robot.skipped().is_empty()),
            Err(error) => assert_eq!(error.line, Some(missing[0] as u32 + 2), "{error}"),
        }
        let robot = load(&text, &skip).expect("a robot");
        let lines: Vec<Option<u32>> = robot.skipped().iter().map(|s| s.line).collect();
        let expected: Vec<Option<u32>> = missing.iter().map(|k| Some(*k as u32 + 2)).collect();
        assert_eq!(lines, expected);
        for (skipped, k) in robot.skipped().iter().zip(&missing) {
            let told = skipped.to_string();
            assert!(told.contains(&format!("gone{k}.obj")), "{told}");
            assert!(told.contains("is missing"), "{told}");
        }
        for (l, link) in robot.links().iter().enumerate() {
            let there = [2 * l, 2 * l + 1].iter().filter(|k| !missing.contains(k)).count();
            assert_eq!(link.bodies.len(), there);
        }
    }
    // Any other fault of a mesh is still an error.
    let text = with_meshes(|_| true);
    for (from, to) in [
        (" filename=\"package://gripper_arm/finger.obj\"", ""),
        ("package://gripper_arm/finger.obj", "gripper.urdf"),
        ("finger.obj\"", "finger.obj\" scale=\"0 1 1\""),
        ("package://gripper_arm/finger.obj", "https://example.org/finger.obj"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert!(changed != text && load(&changed, &skip).is_err(), "{to}");
    }
    assert!(load(&text, &skip.clone().meshes(MeshUse::Pieces)).is_err());
}

#[test]
fn empty_files_and_pointers_get_a_message_of_their_own() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 12345\n";
    let robot = changed("chain", "chain").expect("a robot");
    for (text, words) in [
        ("", "the file is empty"),
        (" \r\n\t\n", "the file is empty"),
        ("\u{feff}", "the file is empty"),
        (pointer, "git lfs pull"),
        (&pointer.replace('\n', "\r\n"), "git lfs pull"),
    ] {
        let packages = Packages::default();
        let errors = [
            parse(text).err(),
            Srdf::parse(text, "r.srdf", &robot).err(),
            CellFile::parse(text, "cell.json", &packages, &LoadOptions::default()).err(),
            Trajectory::parse(text, "q.csv", robot.coordinates()).err(),
        ];
        for error in errors {
            let error = error.expect("an error");
            assert!(error.line == Some(1) && error.to_string().contains(words), "{error}");
        }
    }
}

/// The line ends of Windows change nothing: robots, groups, and cells as JSON and SDFormat.
#[test]
fn line_ends_of_windows_change_nothing() {
    let (packages, options) = (Packages::default(), LoadOptions::default());
    let robot = Robot::load(examples().join("gripper.urdf"), &packages).expect("a robot");
    let read = |name: &str, text: &str| {
        let path = examples().join(name);
        let shown = match name.rsplit_once('.').expect("a kind").1 {
            "urdf" => Robot::parse(text, path, &packages, &options).map(|x| format!("{x:?}")),
            "srdf" => Srdf::parse(text, path, &robot).map(|x| format!("{x:?}")),
            _ => CellFile::parse(text, path, &packages, &options).map(|x| format!("{x:?}")),
        };
        shown.unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    for name in ["gripper.urdf", "gripper.srdf", "cell.json", "bench.sdf"] {
        let text = std::fs::read_to_string(examples().join(name)).expect("an example");
        assert!(text.contains('\n') && !text.contains('\r'), "{name}");
        assert!(
            read(name, &text) == read(name, &text.replace('\n', "\r\n")),
            "{name} differs with the line ends of Windows"
        );
    }
}
