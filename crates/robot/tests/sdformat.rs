//! The SDFormat reader: poses with closed forms, a fault in every place it can stand, and another reader as oracle.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use lin_canny_plan::{Cell, CellBody, Checker, ConfigurationSpace};
use lin_canny_robot::{CellFile, FileError, FileErrorKind, LoadOptions, MotionKind, Packages, Robot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truth::errors::says;
use truth::plans::Furnish;
use truth::rows::{numbers, rows};

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    rows(include_str!("sdformat/rows.txt"), section)
}

const BOX: &str = "<geometry><box><size>1 1 1</size></box></geometry>";

fn parse(text: &str) -> Result<Robot, FileError> {
    Robot::parse(text, "r.sdf", &Packages::default(), &LoadOptions::default())
}

fn cell(text: &str) -> Result<CellFile, FileError> {
    CellFile::parse(text, "r.sdf", &Packages::default(), &LoadOptions::default())
}

/// A file of a version with one model `m`.
fn model(version: &str, inside: &str) -> String {
    format!("<sdf version=\"{version}\"><model name=\"m\">{inside}</model></sdf>")
}

/// A file of the newest version with one world `w`.
fn world(inside: &str) -> String {
    format!("<sdf version=\"1.12\"><world name=\"w\">{inside}</world></sdf>")
}

/// A link with a box at its origin.
fn link(name: &str, pose: &str) -> String {
    format!("<link name=\"{name}\">{pose}<collision name=\"c\">{BOX}</collision></link>")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!("<joint name=\"{name}\" type=\"{kind}\"><parent>{parent}</parent><child>{child}</child>{inside}</joint>")
}

const AXIS: &str = "<axis><xyz>0 0 1</xyz></axis>";

/// The poses of all bodies at a configuration, in the order of the links.
fn poses_at(robot: &Robot, q: &[f64]) -> Vec<(String, Isometry3<f64>)> {
    let mut setup = Cell::new();
    setup.add_robot("", robot, Isometry3::identity()).expect("a robot");
    let mut poses = Vec::new();
    setup.space().expect("a space").place(q, &mut poses);
    let names = robot
        .links()
        .iter()
        .flat_map(|link| link.bodies.iter().map(|_| link.name.clone()));
    names.zip(poses).collect()
}

fn is_near(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    (a.to_homogeneous() - b.to_homogeneous()).amax() < 1e-12
}

/// Where a file draws the first body of each link: the same as a robot and as a cell.
fn drawn(text: &str) -> BTreeMap<String, Isometry3<f64>> {
    let robot = parse(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let cell = cell(text).expect("a cell");
    let mut poses = BTreeMap::new();
    let mut obstacles: Vec<_> = cell.obstacles.iter().map(|o| (o.name.clone(), o.pose)).collect();
    for (name, pose) in poses_at(&robot, robot.start()) {
        let is_same = |(other, at): &(String, Isometry3<f64>)| {
            (*other == name || other.split_once("::").is_some_and(|(_, other)| other == name)) && is_near(at, &pose)
        };
        let found = obstacles
            .iter()
            .position(is_same)
            .unwrap_or_else(|| panic!("{name} at {pose}: {obstacles:?}"));
        obstacles.remove(found);
        poses.entry(name).or_insert(pose);
    }
    assert!(obstacles.is_empty());
    poses
}

/// The link is drawn at a position, turned about z by quarter turns.
fn is_drawn_at(text: &str, link: &str, xyz: [f64; 3], quarters: f64) {
    let yaw = quarters * std::f64::consts::FRAC_PI_2;
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, yaw);
    let expected = Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), turn);
    let found = drawn(text);
    let found = found.get(link).unwrap_or_else(|| panic!("no link {link} in {text}"));
    assert!(
        is_near(found, &expected),
        "{link} at {found}, expected {expected}:\n{text}"
    );
}

const QUARTER: &str = "0 0 1.5707963267948966";

#[test]
fn poses_are_relative_to_the_frames_of_the_specification() {
    let m = |inside: &str| model("1.12", inside);
    for [inside, expected, quarters] in cases("poses") {
        is_drawn_at(&m(&inside), "b", numbers(&expected), numbers::<1>(&quarters)[0]);
    }
    // A collision element is relative to its link, or to a frame.
    for (pose, expected, quarters) in [
        ("<pose>0 0 1 0 0 0</pose>", [1.0, 0.0, 1.0], 1.0),
        ("<pose relative_to=\"b\">0 0 1 0 0 0</pose>", [0.0, 2.0, 1.0], 0.0),
        (
            "<pose relative_to=\"__model__\">0 0 1 0 0 0</pose>",
            [0.0, 0.0, 1.0],
            0.0,
        ),
    ] {
        let a = format!(
            "<link name=\"a\"><pose>1 0 0 {QUARTER}</pose><collision name=\"c\">{pose}{BOX}</collision></link>"
        );
        let inside = a
            + &link("b", "<pose>0 2 0 0 0 0</pose>")
            + &joint("j", "revolute", "b", "a", &format!("<pose>0 1 0 0 0 0</pose>{AXIS}"));
        is_drawn_at(&m(&inside), "a", expected, quarters);
    }
    // The world has frames, too.
    let a = link("a", &format!("<pose>1 0 0 {QUARTER}</pose>"));
    let inside = format!(
        "<frame name=\"f\" attached_to=\"m::a\"><pose>0 0 1 0 0 0</pose></frame><model name=\"m\">{a}</model>\
         <model name=\"n\"><pose relative_to=\"f\"/>{}</model><model name=\"o\"><pose relative_to=\"world\">1 2 3 0 0 0</pose>{}</model>",
        link("x", ""),
        link("y", "")
    );
    is_drawn_at(&world(&inside), "n::x", [1.0, 0.0, 1.0], 1.0);
    is_drawn_at(&world(&inside), "o::y", [1.0, 2.0, 3.0], 0.0);
}

/// A pose far from the world loses no accuracy: bodies of a link keep their numbers.
#[test]
fn numbers_of_bodies_and_joints_are_kept_exactly() {
    let body = format!("<collision name=\"c\"><pose>0.1 0.2 0.3 0 0 0</pose>{BOX}</collision>");
    let inside = format!(
        "<pose>1e6 -1e6 1e5 0.3 0.2 0.1</pose><link name=\"a\"><pose>0.7 0.1 0 1 2 3</pose>{body}</link>\
         <link name=\"b\"><pose relative_to=\"a\">0.3 0.2 0.1 0 0 0</pose>{body}</link>{}",
        joint("j", "revolute", "a", "b", AXIS)
    );
    let robot = parse(&model("1.12", &inside)).expect("a robot");
    for link in &robot.links()[1..] {
        assert_eq!(link.bodies[0].origin, Isometry3::translation(0.1, 0.2, 0.3));
    }
    assert_eq!(robot.joints()[1].origin, Isometry3::translation(0.3, 0.2, 0.1));
}

#[test]
fn axes_are_in_the_frame_of_the_version() {
    let file = |version: &str, xyz: &str, inside: &str| {
        let pose = format!("<pose>1 2 3 {QUARTER}</pose>");
        let axis = format!("{pose}<axis>{xyz}{inside}</axis>");
        model(
            version,
            &(link("a", "")
                + &link("b", "<pose>0 0 0 0 1.5707963267948966 0</pose>")
                + &joint("j", "revolute", "a", "b", &axis)),
        )
    };
    // The child is turned by a quarter about y, and the joint in it by a quarter about z.
    for [version, xyz, inside, expected] in cases("axes") {
        let robot = parse(&file(&version, &xyz, &inside)).expect(&version);
        let axis = robot.joints()[1].axis.into_inner();
        let off = (axis - Vector3::from(numbers(&expected))).amax();
        assert!(off < 1e-15, "{version} {xyz} {inside}: {axis}");
    }
}

/// The joint turns its child about the axis through the joint, wherever the child has its origin.
#[test]
fn joints_move_their_child_about_the_joint() {
    for (kind, expected) in [
        ("revolute", Vector3::new(1.0, -1.0, 0.0)),
        ("prismatic", Vector3::new(2.0, 0.0, std::f64::consts::FRAC_PI_2)),
    ] {
        let axis = format!("<pose>-1 0 0 0 0 0</pose>{AXIS}");
        let inside = link("a", "") + &link("b", "<pose>2 0 0 0 0 0</pose>") + &joint("j", kind, "a", "b", &axis);
        let robot = parse(&model("1.12", &inside)).expect("a robot");
        let poses = poses_at(
            &robot,
            &[if kind == "revolute" { -1.0 } else { 1.0 } * std::f64::consts::FRAC_PI_2],
        );
        let (name, pose) = &poses[1];
        assert_eq!(name, "b");
        assert!((pose.translation.vector - expected).amax() < 1e-15, "{kind}: {pose}");
    }
}

#[test]
fn limits_are_those_of_the_axis() {
    for [kind, limit, expected] in cases("limits") {
        let axis = format!("<axis><xyz>0 0 1</xyz>{limit}</axis>");
        let inside = link("a", "") + &link("b", "") + &joint("j", &kind, "a", "b", &axis);
        let robot = parse(&model("1.12", &inside)).expect(&limit);
        assert_eq!(robot.joints()[1].limits, numbers(&expected), "{kind} {limit}");
    }
}

/// A file with a mark `@name@` in every place where an element can stand, each in a line of its own.
const MARKED: &str = include_str!("sdformat/marked.xml");

/// The names of the marks.
fn places() -> impl Iterator<Item = &'static str> {
    MARKED
        .lines()
        .filter_map(|line| line.strip_prefix('@')?.strip_suffix('@'))
}

/// A folder for the files of a test, with a mesh `part.stl` in it.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sdformat").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("part.stl"), TETRAHEDRON).expect("a file");
    folder
}

const TETRAHEDRON: &str = "solid t
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 1 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 1 0 0 vertex 0 1 0 vertex 0 0 1 endloop endfacet
endsolid t
";

/// The marked file with an element in one place, and the line of the place.
fn with(place: &str, element: &str) -> (String, u32) {
    let mark = format!("@{place}@");
    let line = MARKED.lines().position(|line| line == mark).expect(place) as u32 + 1;
    let mut text = MARKED.trim_end().replace(&mark, element);
    for other in places() {
        text = text.replace(&format!("@{other}@"), "");
    }
    (text, line)
}

/// Reads a text as a file of a folder with the mesh.
fn parse_in(folder: &Path, text: &str) -> Result<Robot, FileError> {
    let path = folder.join("r.sdf");
    Robot::parse(text, path, &Packages::default(), &LoadOptions::default())
}

#[test]
fn unknown_elements_are_errors_in_every_place() {
    let folder = folder("unknown");
    assert!(parse_in(&folder, &with("sdf", "").0).is_ok());
    for place in places() {
        for name in ["colision", "origin", "robot", "Link", "loop_joint", "sdf", "limits"] {
            let (text, line) = with(place, &format!("<{name} name=\"n\"/>"));
            let error = parse_in(&folder, &text).expect_err(&format!("{name} in {place}"));
            assert_eq!(error.line, Some(line), "{place}: {error}");
            assert!(
                matches!(error.reason, FileErrorKind::UnknownPart { what: "element", .. }),
                "{place}: {error}"
            );
        }
        // What tinyxml takes is listed.
        for element in ["stray>", "<![CDATA[stray]]>", "<!-- -- -->", "<y:link name=\"a\"/>"] {
            let (text, line) = with(place, element);
            let robot = parse_in(&folder, &text).expect(place);
            let [skipped] = robot.skipped() else {
                panic!("{place}: {:?}", robot.skipped())
            };
            assert_eq!(skipped.line, Some(line), "{skipped}");
            let path = folder.join("r.sdf");
            let cell = CellFile::parse(&text, path, &Packages::default(), &LoadOptions::default()).expect("a cell");
            assert_eq!(cell.skipped, robot.skipped());
        }
        // Elements of a foreign namespace are none of ours.
        assert!(parse_in(&folder, &with(place, "<x:link name=\"a\">1</x:link>").0).is_ok());
    }
    for (place, element, words) in [
        ("link", "<colision/>", "did you mean \"collision\"?"),
        ("geometry", "<shpere/>", "did you mean \"sphere\"?"),
        ("joint", "<parnt/>", "did you mean \"parent\"?"),
        ("contact", "<colide_bitmask/>", "did you mean \"collide_bitmask\"?"),
        ("world", "<modle/>", "did you mean \"model\"?"),
        ("sdf", "<modle/>", "did you mean \"model\"?"),
    ] {
        says(parse_in(&folder, &with(place, element).0), words);
    }
}

#[test]
fn elements_given_twice_and_names_in_use_are_errors() {
    let folder = folder("twice");
    for [place, element] in cases("elements given twice") {
        let (text, line) = with(&place, &element);
        let error = parse_in(&folder, &text).expect_err(&element);
        assert!(matches!(error.reason, FileErrorKind::Twice(_)), "{element}: {error}");
        assert!(error.line > Some(line), "{error}");
    }
    let names = ["link name=\"NAME\"", "frame name=\"NAME\"", "model name=\"NAME\""];
    for place in ["model", "middle", "end"] {
        for name in ["a", "b", "j", "k", "n"] {
            for element in names {
                let text = with(place, &format!("<{}/>", element.replace("NAME", name))).0;
                let error = parse_in(&folder, &text).expect_err(element);
                assert!(
                    matches!(error.reason, FileErrorKind::Repeated) && error.line.is_some(),
                    "{element} {name}: {error}"
                );
            }
        }
        for name in ["world", "__model__", "__x__", "a::b", "", " "] {
            for element in names {
                let (text, line) = with(place, &format!("<{}/>", element.replace("NAME", name)));
                let error = says(parse_in(&folder, &text), "invalid name");
                assert_eq!(error.line, Some(line), "{error}");
            }
        }
    }
    for element in ["<model name=\"m\"/>", "<model name=\"f\"/>", "<frame name=\"m\"/>"] {
        assert!(parse_in(&folder, &with("world", element).0).is_err());
    }
    // Before version 1.7, joints were no frames, and names could hold colons.
    for order in [0, 1] {
        let mut parts = vec![
            link("a", ""),
            link("x::y", ""),
            joint("x::y", "revolute", "a", "x::y", AXIS),
        ];
        parts.rotate_right(order);
        let robot = parse(&model("1.6", &parts.concat())).expect("a robot");
        assert_eq!(robot.links().len(), 3);
        assert!(parse(&model("1.7", &parts.concat())).is_err());
        parts.push(link("a", ""));
        assert!(parse(&model("1.6", &parts.concat())).is_err());
    }
}

#[test]
fn what_is_no_body_is_passed_over_whatever_is_in_it() {
    let folder = folder("passed");
    let content = |text: &str| {
        let robot = parse_in(&folder, text).unwrap_or_else(|e| panic!("{e}"));
        format!(
            "{:?} {:?} {:?} {:?}",
            robot.links(),
            robot.joints(),
            robot.start(),
            robot.skipped()
        )
    };
    let plain = content(&with("sdf", "").0);
    for [place, names] in cases("what is passed over") {
        for name in names.split(' ') {
            let fault = "<pose>x</pose><geometry/><link name=\"a\"/>text";
            let text = with(&place, &format!("<{name} a=\"x\">{fault}</{name}><{name}/>")).0;
            assert_eq!(content(&text), plain, "{name} in {place}");
        }
    }
}

#[test]
fn what_is_left_out_is_listed_with_its_line() {
    let folder = folder("left_out");
    for (place, element) in [
        ("sdf", "actor"),
        ("world", "actor"),
        ("world", "road"),
        ("world", "population"),
        ("world", "state"),
    ] {
        let (text, line) = with(place, &format!("<{element} name=\"n\"><pose>x</pose></{element}>"));
        let robot = parse_in(&folder, &text).expect("a robot");
        let skipped = &robot.skipped()[0];
        assert_eq!((robot.skipped().len(), skipped.line), (1, Some(line)));
        assert!(
            skipped
                .to_string()
                .contains(&format!("element {element} is not supported")),
            "{skipped}"
        );
        let path = folder.join("r.sdf");
        let cell = CellFile::parse(&text, path, &Packages::default(), &LoadOptions::default()).expect("a cell");
        assert_eq!(cell.skipped, robot.skipped());
        let mut setup = Cell::new();
        let noted = cell.add_to(&mut setup).expect("a cell");
        assert_eq!(noted[..cell.skipped.len()], cell.skipped[..]);
    }
    let (text, line) = with("axis", "<initial_position>0.5</initial_position>");
    let robot = parse_in(&folder, &text).expect("a robot");
    assert_eq!(robot.skipped()[0].line, Some(line));
    let text = text.replace(">0.5<", ">0<");
    assert!(parse_in(&folder, &text).expect("a robot").skipped().is_empty());
    // A missing mesh is an error, or listed if the caller wants it.
    std::fs::remove_file(folder.join("part.stl")).expect("the file");
    let error = parse_in(&folder, &text).expect_err("no mesh");
    assert!(matches!(error.reason, FileErrorKind::MissingMesh(_)), "{error}");
    let options = LoadOptions::default().skip_missing_meshes(true);
    let robot = Robot::parse(&text, folder.join("r.sdf"), &Packages::default(), &options).expect("a robot");
    assert_eq!(robot.skipped().len(), 1);
    assert!(CellFile::parse(&text, folder.join("r.sdf"), &Packages::default(), &options).is_err());
}

/// Every name of a frame, link or joint that does not exist is an error with a near name.
#[test]
fn names_that_do_not_exist_are_named_with_a_near_one() {
    let near = |text: String, words: &str, line: u32| {
        let error = parse(&text).expect_err(words);
        assert!(error.to_string().contains(words), "{error}\n{text}");
        assert_eq!(error.line, Some(line), "{error}");
    };
    for place in 0..3 {
        let chain = |element: &str, of: usize| {
            if of == place {
                format!("\n{element}\n")
            } else {
                String::new()
            }
        };
        let text = |element: &str| {
            let inside: String = (0..3)
                .map(|k| link(&format!("finger_{k}"), "") + &chain(element, k) + "<!-- -->")
                .collect();
            model(
                "1.12",
                &(inside + "<frame name=\"palm\"/><model name=\"nested\"><link name=\"inner\"/></model>"),
            )
        };
        for [element, name] in cases("near names") {
            near(text(&element), &format!("did you mean \"{name}\"?"), 2);
        }
        // A frame of the model outside is none of the nested model.
        near(
            text("<model name=\"g\"><link name=\"a\"><pose relative_to=\"palm\"/></link></model>"),
            "frame \"palm\" does not exist",
            2,
        );
        near(
            text("<link name=\"g\"><pose relative_to=\"world\"/></link>"),
            "frame \"world\" does not exist",
            2,
        );
    }
    // A name belongs to the element that the message shows.
    let error = parse(&model("1.12", "<link name=\"a\"><pose relative_to=\"b\"/></link>")).expect_err("no b");
    assert_eq!(error.element, "model \"m\" link \"a\" pose");
}

#[test]
fn cycles_of_frames_and_joints_are_errors() {
    let base = link("base", "");
    for count in [1, 2, 3, 50] {
        for first in 0..count.min(3) {
            let frames = |attribute: &str, of: &dyn Fn(usize) -> String| -> String {
                (0..count)
                    .map(|k| (first + k) % count)
                    .map(|k| format!("<frame name=\"f{k}\" {attribute}>{}</frame>", of((k + 1) % count)))
                    .collect()
            };
            let by_pose = frames("attached_to=\"base\"", &|next| {
                format!("<pose relative_to=\"f{next}\"/>")
            });
            let by_attachment: String = (0..count)
                .map(|k| {
                    format!(
                        "<frame name=\"f{k}\" attached_to=\"f{}\"><pose relative_to=\"base\"/></frame>",
                        (k + 1) % count
                    )
                })
                .collect();
            for (frames, words) in [
                (by_pose, "relative_to forms a cycle: "),
                (by_attachment, "attached_to forms a cycle: "),
            ] {
                let error = says(parse(&model("1.12", &format!("{base}{frames}"))), words);
                assert_eq!(error.line, Some(1), "{error}");
                assert!(count > 10 || error.to_string().contains("f0"), "{error}");
                assert!(error.reason.to_string().len() <= 120, "{error}");
            }
        }
    }
}

/// libsdformat converts a file to its own version first, so that it reads what later versions added.
#[test]
fn what_a_later_version_added_is_read_and_listed() {
    let a = link("a", "<pose>1 0 0 0 0 0</pose>");
    for [version, newer, inside, words] in cases("later versions") {
        let text = model(&version, &(a.clone() + &inside));
        let robot = parse(&text).expect(&text);
        let [skipped] = robot.skipped() else {
            panic!("{:?}", robot.skipped())
        };
        assert!(skipped.line == Some(2), "{skipped}");
        assert!(skipped.to_string().contains(&words), "{skipped}");
        let later = parse(&model(&newer, &(a.clone() + &inside))).expect(&newer);
        assert!(later.skipped().is_empty());
        let q = [0.3];
        for ((name, pose), (other, at)) in poses_at(&robot, &q).iter().zip(poses_at(&later, &q)) {
            assert!(*name == other, "{text}: {name} at {pose}, expected {at}");
            assert!(is_near(pose, &at), "{text}: {name} at {pose}, expected {at}");
        }
    }
}

/// Each fault is named, whatever it is: of versions, poses, axes, limits, cycles, shapes and their numbers.
#[test]
fn faults_are_named_with_their_line() {
    let refused = |text: &str, words: &str| {
        let error = parse(text).expect_err(text);
        assert!(error.to_string().contains(words), "{error} instead of {words}: {text}");
        assert_eq!(error.line, Some(1), "{error}");
    };
    for [version, inside, words] in cases("faults of a model") {
        refused(&model(&version, &inside), &words);
    }
    for [text, words] in cases("faults of a file") {
        refused(&text, &words);
    }
    for [shape, words] in cases("faults of a shape") {
        refused(&model("1.9", &of_shape(&shape)), &words);
    }
    for [version, inside] in cases("what is no fault") {
        assert!(parse(&model(&version, &inside)).is_ok(), "{inside}");
    }
}

/// A ball joint turns by its angles about its place, a universal joint about two axes, and a screw
/// slides as it turns; a mimic may follow the second axis.
#[test]
fn joints_with_several_coordinates_move_their_links() {
    let two = link("a", "") + &link("b", "");
    let at = "<pose>0.1 0.2 0.3 0 0 0</pose>";
    let axis2 = "<axis2><xyz>1 0 0</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis2>";
    let screw = |pitch: &str| format!("{at}{AXIS}{pitch}");
    let place = Translation3::new(0.1, 0.2, 0.3);
    let turn = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), angle);
    let about = |turn: UnitQuaternion<f64>| place * turn * place.inverse();
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let slide = |pitch: f64| Translation3::new(0.0, 0.0, pitch * 0.7 / std::f64::consts::TAU) * about(turn(z, 0.7));
    let ball = about(turn(z, -0.4) * turn(y, 1.1) * turn(x, 0.7));
    let rows = [
        ("ball", at.into(), vec!["j/roll", "j/pitch", "j/yaw"], ball),
        (
            "ball",
            format!("{at}{AXIS}{axis2}"),
            vec!["j/roll", "j/pitch", "j/yaw"],
            ball,
        ),
        (
            "universal",
            format!("{at}{AXIS}{axis2}"),
            vec!["j/axis", "j/axis2"],
            about(turn(z, 0.7) * turn(x, 1.1)),
        ),
        (
            "revolute2",
            format!("{at}{AXIS}{axis2}"),
            vec!["j/axis", "j/axis2"],
            about(turn(z, 0.7) * turn(x, 1.1)),
        ),
        ("screw", screw(""), vec!["j"], slide(1.0)),
        (
            "screw",
            screw("<screw_thread_pitch>0.5</screw_thread_pitch><thread_pitch>0</thread_pitch>"),
            vec!["j"],
            slide(0.5),
        ),
        (
            "screw",
            screw("<thread_pitch>-4</thread_pitch>"),
            vec!["j"],
            slide(0.5 * std::f64::consts::PI),
        ),
    ];
    for (kind, inside, names, expected) in rows {
        let robot = parse(&model("1.9", &(two.clone() + &joint("j", kind, "a", "b", &inside)))).expect(kind);
        let found: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
        assert_eq!(found, names, "{kind}");
        assert_eq!(robot.adjacent().len(), 1, "{kind}");
        let q = &[0.7, 1.1, -0.4][..names.len()];
        let poses = poses_at(&robot, q);
        let found = poses.iter().find(|(name, _)| name == "b").expect("the body").1;
        let off = (found.to_homogeneous() - expected.to_homogeneous()).amax();
        assert!(off < 1e-14, "{kind}: {found} {expected}");
        if names.len() == 2 {
            assert_eq!(robot.coordinates()[1].limits, [-1.0, 2.0]);
        }
    }
    let three = two + &link("c", "");
    let universal = joint("j", "universal", "a", "b", &format!("{AXIS}{axis2}"));
    let mimic = "<mimic joint=\"j\" axis=\"axis2\"><multiplier>2</multiplier><offset>0</offset><reference>0</reference></mimic>";
    let follower = joint(
        "k",
        "revolute",
        "a",
        "c",
        &AXIS.replace("</axis>", &format!("{mimic}</axis>")),
    );
    let robot = parse(&model("1.11", &(three + &universal + &follower))).expect("a robot");
    let poses = poses_at(&robot, &[0.7, 0.3]);
    let found = poses.iter().find(|(name, _)| name == "c").expect("the body").1;
    assert!((found.rotation.angle() - 0.6).abs() < 1e-14);
}

/// A link with one collision element of a shape.
fn of_shape(shape: &str) -> String {
    format!("<link name=\"a\"><collision name=\"c\"><geometry>{shape}</geometry></collision></link>")
}

/// Returns the one body of a shape.
fn body(shape: &str) -> (Geometry, Isometry3<f64>) {
    let robot = parse(&model("1.12", &of_shape(shape))).unwrap_or_else(|e| panic!("{e}"));
    let body = &robot.links()[1].bodies[0];
    (body.geometry.clone(), body.origin)
}

/// The box around a geometry at a pose is the expected one, but for the slack of boxes in single precision.
fn has_box(geometry: &Geometry, pose: &Isometry3<f64>, expected: [&str; 2], what: &str) {
    let (min, max) = geometry.aabb_at(pose, &mut lin_canny::BoxHint::default());
    let slack = 1e-5 * (1.0 + geometry.bounding_ball().1);
    for (found, expected) in [min, max].into_iter().zip(expected) {
        let expected = Point3::from(numbers(expected));
        let off = (found - expected).amax();
        assert!(off < slack, "{what}: {found}, expected {expected}");
    }
}

#[test]
fn shapes_have_the_sizes_of_the_specification() {
    for [shape, low, high] in cases("shapes") {
        let (geometry, pose) = body(&shape);
        has_box(&geometry, &pose, [&low, &high], &shape);
    }
    let empty = parse(&model("1.9", &of_shape("<empty/>")));
    assert!(empty.expect("a robot").links()[1].bodies.is_empty());
}

#[test]
fn a_plane_of_a_cell_is_a_half_space() {
    let plane = "<collision name=\"c\"><pose>0 0 1 0 0 0</pose><geometry><plane><normal>0 0 2</normal></plane></geometry></collision>";
    let cell = cell(&model("1.9", &format!("<link name=\"a\">{plane}</link>"))).expect("a cell");
    let obstacle = &cell.obstacles[0];
    assert_eq!(obstacle.geometry.kind(), lin_canny::GeometryKind::HalfSpace);
    let ball = lin_canny::Shape::ball(0.5).expect("a ball");
    for at in [[0.0, 0.0], [1e6, -1e6]] {
        let there = Isometry3::translation(at[0], at[1], 4.0);
        let pose = lin_canny::RelativePose::new(&obstacle.pose, &there).expect("a pose");
        let found = lin_canny::PairTracker::new().closest(&obstacle.geometry, &ball, &pose);
        assert!((found.distance - 2.5).abs() < 1e-6, "{}", found.distance);
    }
}

/// A plane of a link at rest is an obstacle without end. One that moves is a box.
#[test]
fn a_plane_of_a_robot_is_a_half_space_unless_it_moves() {
    let plane = "<collision name=\"c\"><pose>0 0 1 0 0 0</pose><geometry><plane><normal>0 0 -2</normal></plane></geometry></collision>";
    let ceiling = format!("<link name=\"a\">{plane}<collision name=\"d\">{BOX}</collision></link>");
    let arm = link("b", "") + &joint("lift", "prismatic", "a", "b", "<axis><xyz>0 0 1</xyz></axis>");
    // The box of the link `a` passes through the plane, and both are at rest.
    let text = model("1.9", &format!("<pose>0 0 9 0 0 0</pose>{ceiling}{arm}"));
    let robot = parse(&text).unwrap_or_else(|e| panic!("{e}"));
    let kind = |robot: &Robot, k: usize| robot.links()[1].bodies[k].geometry.kind();
    assert_eq!(kind(&robot, 0), lin_canny::GeometryKind::HalfSpace);
    let setup = || {
        let mut setup = Cell::new();
        setup
            .add_robot("r/", &robot, Isometry3::translation(1e6, -1e6, 0.5))
            .expect("a robot");
        setup
    };
    let mut first = setup();
    let post = lin_canny::Shape::ball(0.5).expect("a ball");
    first.put("post", post, Isometry3::translation(1e6, 0.0, 0.0));
    let mut checker = Checker::of_robots(first).expect("a checker");
    let (name, _, pose) = checker.cell().obstacles().next().expect("an obstacle");
    assert_eq!((name, pose.translation.vector), ("r/a", Vector3::new(1e6, -1e6, 10.5)));
    // The ceiling is at a height of 1 above the link, whose box b has a half side of 0.5.
    let near = checker.nearest(&[0.25], f64::INFINITY).expect("pairs");
    let to_plane = near
        .iter()
        .find(|near| near.pair.b == CellBody::Obstacle(0))
        .expect("the pair");
    assert_eq!(checker.name(to_plane.pair.a), "r/b");
    assert!((to_plane.distance - 0.25).abs() < 1e-8, "{}", to_plane.distance);
    let rest = near.iter().filter(|near| near.pair.b == CellBody::Obstacle(0)).count();
    assert_eq!(rest, 1, "the box of the link a is at rest as well");

    // Saved with the world, the plane is not added a second time.
    let text = CellFile::from_cell(checker.cell()).to_json().expect("a cell");
    let mut again = setup();
    cell(&text).expect("a cell").add_to(&mut again).expect("a cell");
    let mut again = Checker::of_robots(again.clone()).expect("a checker");
    assert_eq!(again.cell().obstacles().len(), 2);
    assert_eq!(again.nearest(&[0.25], f64::INFINITY).expect("pairs"), near);

    let floating = parse(&world(&format!("<model name=\"m\">{ceiling}</model>"))).unwrap_or_else(|e| panic!("{e}"));
    assert_ne!(kind(&floating, 0), lin_canny::GeometryKind::HalfSpace);
    let (min, max) = floating.links()[1].bodies[0]
        .geometry
        .aabb_at(&Isometry3::identity(), &mut lin_canny::BoxHint::default());
    let off = (max - min - Vector3::new(2000.0, 2000.0, 1000.0)).amax();
    assert!(off < 0.1, "{min} {max}");
    let options = LoadOptions::default().plane_extent(-1.0);
    let text = world(&format!("<model name=\"m\">{ceiling}</model>"));
    says(
        Robot::parse(&text, "r.sdf", &Packages::default(), &options),
        "extent of planes",
    );
}

/// A prism covers its polygon and nothing else: whichever way around, and with the first point again.
#[test]
fn polylines_become_exact_prisms() {
    let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let star: Vec<[f64; 2]> = (0..10)
        .map(|k| {
            let radius = if k % 2 == 0 { 2.0 } else { 0.5 };
            let angle = f64::from(k) * 0.2 * std::f64::consts::PI;
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    let convex = [[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [0.0, 2.0]];
    for (polygon, area) in [
        (corner.to_vec(), 4.0),
        (star, 10.0 * 0.5 * 2.0 * 0.5 * (0.2 * std::f64::consts::PI).sin()),
        (convex.to_vec(), 4.0),
    ] {
        for turn in 0..polygon.len() {
            for is_reversed in [false, true] {
                for is_closed in [false, true] {
                    let mut points = polygon.clone();
                    points.rotate_left(turn);
                    if is_reversed {
                        points.reverse();
                    }
                    if is_closed {
                        points.push(points[0]);
                    }
                    let text: String = points
                        .iter()
                        .map(|[x, y]| format!("<point>{x:?} {y:?}</point>"))
                        .collect();
                    let (geometry, _) = body(&format!("<polyline>{text}<height>2</height></polyline>"));
                    let volume = match &geometry {
                        Geometry::Mesh(mesh) => mesh.volume(),
                        Geometry::Polyhedron(hull) => hull.volume(),
                        other => panic!("{:?}", other.kind()),
                    };
                    assert!((volume - 2.0 * area).abs() < 1e-12, "{volume} for {points:?}");
                }
            }
        }
    }
    let bow = "<polyline><point>0 0</point><point>1 1</point><point>1 0</point><point>0 1</point><height>1</height></polyline>";
    says(parse(&model("1.12", &of_shape(bow))), "polyline");
}

/// Writes the folder of a model: its configuration, and a file for each version.
fn write_model(folder: &Path, name: &str, files: &[(&str, &str)]) {
    let folder = folder.join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut config = format!("<?xml version=\"1.0\"?><model><name>{name}</name>");
    for (version, text) in files {
        config += &format!("<sdf version=\"{version}\">model-{version}.sdf</sdf>");
        std::fs::write(folder.join(format!("model-{version}.sdf")), text).expect("a file");
    }
    std::fs::write(
        folder.join("model.config"),
        config + "<author><name>a</name></author></model>",
    )
    .expect("a file");
}

#[test]
fn included_models_are_read_from_their_folders() {
    let folder = folder("include");
    let mesh = "<geometry><mesh><uri>part.stl</uri><scale>2 2 2</scale></mesh></geometry>";
    let part = format!(
        "<pose>0 0 9 0 0 0</pose><link name=\"x\"><pose>0 0 1 0 0 0</pose><collision name=\"c\">{mesh}</collision></link>\
         <link name=\"y\"><pose>1 0 0 0 0 0</pose></link><frame name=\"f\" attached_to=\"y\"><pose>0 2 0 0 0 0</pose></frame>{}",
        joint("j", "fixed", "x", "y", "")
    );
    let old = model("1.4", &link("old", ""));
    // Versions are numbers: 1.10 is later than 1.9.
    write_model(
        &folder,
        "part",
        &[("1.9", &old), ("1.10", &model("1.10", &part)), ("1.4", &old)],
    );
    std::fs::write(folder.join("part/part.stl"), TETRAHEDRON).expect("a file");
    std::fs::write(folder.join("plain.sdf"), model("1.9", &link("x", ""))).expect("a file");
    let load = |inside: &str| parse_in(&folder, &world(inside));
    let position = |robot: &Robot, name: &str| {
        let poses = poses_at(robot, robot.start());
        let found = poses.iter().find(|(link, _)| link == name);
        let (_, pose) = found.unwrap_or_else(|| panic!("no body of {name}: {:?}", robot.links()));
        let [x, y, z]: [f64; 3] = pose.translation.vector.into();
        [x, y, z].map(|x| (x * 1e9).round() / 1e9)
    };
    let absolute = format!("file://{}", folder.display());
    for [uri, inside, link, expected] in cases("includes") {
        let base = "<frame name=\"base\"><pose>0 7 0 0 0 0</pose></frame>";
        let uri = uri.replace("FOLDER", &absolute);
        let robot = load(&format!("{base}<include><uri>{uri}</uri>{inside}</include>"));
        let robot = robot.unwrap_or_else(|e| panic!("{uri} {inside}: {e}"));
        assert_eq!(position(&robot, &link), numbers(&expected), "{uri} {inside}");
        let first = robot.links().iter().find(|l| l.name == link).expect("the link");
        if link.ends_with("::x") && uri != "plain.sdf" {
            let file = first.bodies[0].mesh.as_ref().expect("a mesh");
            assert!(file.ends_with("part/part.stl"), "{}", file.display());
            assert_eq!(first.bodies[0].geometry.bounding_ball().1, body_radius());
        }
    }
    // The file says what is static, unless the include does.
    for (inside, kind) in [
        ("", MotionKind::Floating),
        ("<static>true</static>", MotionKind::Fixed),
        ("<static>false</static>", MotionKind::Floating),
    ] {
        let robot = load(&format!("<include><uri>part</uri>{inside}</include>")).expect("a robot");
        assert_eq!(robot.joints()[0].kind, kind);
    }
    // Twice, below a model, and merged into it.
    let twice = "<include><uri>part</uri><name>p</name></include><include><uri>part</uri><name>q</name></include>";
    assert_eq!(load(twice).expect("a robot").links().len(), 5);
    assert!(matches!(
        load(&twice.replace("q<", "p<")).expect_err("a name").reason,
        FileErrorKind::Repeated
    ));
    let nested = |include: &str| {
        let arm = joint("h", "fixed", "hand", "x", "")
            .replace(">x<", if include.contains("merge") { ">x<" } else { ">p::x<" });
        let hand = link("hand", "<pose>0 3 0 0 0 0</pose>");
        model("1.12", &format!("{hand}<include {include}{arm}"))
    };
    let below = "<pose relative_to=\"hand\">5 0 0 0 0 0</pose></include>";
    let robot = parse_in(&folder, &nested(&format!("><uri>part</uri><name>p</name>{below}"))).expect("a robot");
    assert_eq!(position(&robot, "p::x"), [5.0, 3.0, 1.0]);
    assert_eq!(robot.adjacent(), [[1, 2]]);
    let merged = nested(&format!("merge=\"true\"><uri>part</uri><name>p</name>{below}"));
    let robot = parse_in(&folder, &merged).expect("a robot");
    assert_eq!(position(&robot, "x"), [5.0, 3.0, 1.0]);
    assert_eq!(robot.coordinates().len(), 0);
    let text = merged.replace(
        "</pose></include>",
        "</pose><placement_frame>f</placement_frame></include>",
    );
    let answer = position(&parse_in(&folder, &text).expect("a robot"), "x");
    assert_eq!(answer, [4.0, 1.0, 1.0]);
    for (from, to) in [
        ("merge=\"true\"", "merge=\"yes\""),
        ("</pose></include>", "</pose><static>true</static></include>"),
        ("name=\"hand\"", "name=\"x\""),
    ] {
        assert!(parse_in(&folder, &merged.replace(from, to)).is_err(), "{to}");
    }
    let config = |text: &str| {
        std::fs::create_dir_all(folder.join("bad")).expect("a folder");
        std::fs::write(folder.join("bad/model.config"), text).expect("a file");
        load("\n<include><uri>bad</uri></include>").expect_err(text).to_string()
    };
    for [text, words] in cases("configurations") {
        let error = config(&text);
        assert!(error.contains(&words), "{error}");
        assert!(error.contains("bad/model.config:1"), "{error}");
    }
    for [name, text, words] in cases("faults of included files") {
        std::fs::write(folder.join(&name), text).expect("a file");
        let error = load(&format!("<include><uri>{name}</uri></include>"));
        says(error, &words);
    }
    std::fs::write(
        folder.join("light.sdf"),
        "<sdf version=\"1.9\"><light name=\"l\"/></sdf>",
    )
    .expect("a file");
    let answer = load("<include><uri>light.sdf</uri></include>")
        .expect("a robot")
        .links()
        .len();
    assert_eq!(answer, 1);
    for [include, words] in cases("faults of an include") {
        let error = says(load(&format!("\n{include}")), &words);
        assert_eq!(error.line, Some(2), "{error}");
        assert!(error.reason.to_string().len() <= 120, "{error}");
    }
}

/// The radius of the ball around the mesh of the tests at scale 2, as a hull.
fn body_radius() -> f64 {
    let points = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]].map(Point3::from);
    Geometry::from(lin_canny::ConvexPolyhedron::from_points(&points).expect("a hull"))
        .bounding_ball()
        .1
}

#[test]
fn files_that_include_themselves_and_deep_ones_are_errors() {
    let folder = folder("cycle");
    let include = |name: &str| format!("<include><uri>{name}</uri><name>n</name></include>");
    for count in [1, 2, 5] {
        for k in 0..count {
            let next = format!("c{}.sdf", (k + 1) % count);
            let text = model("1.9", &(link("a", "") + "\n" + &include(&next)));
            std::fs::write(folder.join(format!("c{k}.sdf")), text).expect("a file");
        }
        let error = says(
            Robot::load(folder.join("c0.sdf"), &Packages::default()),
            "file includes itself",
        );
        assert_eq!(error.line, Some(2), "{error}");
        says(parse_in(&folder, &world(&include("c0.sdf"))), "file includes itself");
    }
    for k in 0..100 {
        let text = model("1.9", &(link("a", "") + &include(&format!("d{}.sdf", k + 1))));
        std::fs::write(folder.join(format!("d{k}.sdf")), text).expect("a file");
    }
    std::fs::write(folder.join("d100.sdf"), model("1.9", &link("a", ""))).expect("a file");
    says(
        Robot::load(folder.join("d0.sdf"), &Packages::default()),
        "nested too deep (expected at most 64)",
    );
    assert!(Robot::load(folder.join("d50.sdf"), &Packages::default()).is_ok());
    // Files that include two others each would be read 2^20 times.
    for k in 0..20 {
        let next = format!("e{}.sdf", k + 1);
        let text = model("1.9", &(include(&next) + &include(&next).replace(">n<", ">o<")));
        std::fs::write(folder.join(format!("e{k}.sdf")), text).expect("a file");
    }
    std::fs::write(folder.join("e20.sdf"), model("1.9", &link("a", ""))).expect("a file");
    says(
        Robot::load(folder.join("e0.sdf"), &Packages::default()),
        "too many included files",
    );
    // Nested models of one file are limited by the depth of its elements.
    for (depth, is_good) in [(20, true), (50, true), (70, false), (3000, false)] {
        let inside = "<model name=\"n\">".repeat(depth) + &link("a", "") + &"</model>".repeat(depth);
        let result = parse(&model("1.9", &(link("a", "") + &inside)));
        assert_eq!(result.is_ok(), is_good, "{depth}");
    }
    // A chain of frames is as long as it wants to be.
    let chain: String = (1..50_000)
        .map(|k| {
            format!(
                "<frame name=\"f{k}\" attached_to=\"f{}\"><pose>0.001 0 0 0 0 0</pose></frame>",
                k - 1
            )
        })
        .collect();
    let inside = link("a", "") + "<frame name=\"f0\"/>" + &chain + &link("b", "<pose relative_to=\"f49999\"/>");
    let drawn = drawn(&model("1.9", &inside));
    assert!((drawn["b"].translation.x - 49.999).abs() < 1e-9);
}

#[test]
fn names_masks_and_included_bytes_are_bounded() {
    let long = "n".repeat(200);
    let inside = format!("<model name='{long}'>{}</model>", link(&"k".repeat(50), ""));
    assert!(parse(&model("1.9", &inside)).is_ok());
    let inside = format!("<model name='{long}'>{}</model>", link(&"k".repeat(55), ""));
    let error = says(parse(&model("1.9", &inside)), "with 257 bytes (expected at most 256)");
    let error = error.to_string().replace(&long, "");
    assert!(error.len() < 300, "{error}");
    let masked = |count: usize| {
        let mask = "<surface><contact><collide_bitmask>0</collide_bitmask></contact></surface>";
        let collision = format!("<collision name='c'>{BOX}{mask}</collision>");
        let links = (0..count).map(|k| format!("<link name='l{k}'>{collision}</link>"));
        parse(&model("1.9", &(link("all", "") + &links.collect::<String>())))
    };
    // A body with neither collides with no body, not even with one that has all bits.
    assert_eq!(masked(20).expect("a robot").excluded().len(), 20 * 19 / 2 + 20);
    says(masked(1_500), "(expected at most 1000000)");
    let folder = folder("large");
    let text = model("1.9", &(link("a", "") + &format!("<!--{}-->", "x".repeat(1 << 20))));
    std::fs::write(folder.join("f.sdf"), text).expect("a file");
    let includes = |count: usize| {
        let one = |k: usize| format!("<include><uri>f.sdf</uri><name>i{k}</name></include>");
        parse_in(&folder, &world(&(0..count).map(one).collect::<String>()))
    };
    assert!(includes(15).is_ok());
    says(includes(17), "too many included files: 16 with 167");
}

#[test]
fn models_stand_where_the_kind_of_the_file_says() {
    let kinds = |text: &str| -> BTreeMap<String, String> {
        let robot = parse(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(robot.links()[0].name, "world");
        let joints = robot.joints().iter();
        joints.map(|j| (j.name.clone(), format!("{:?}", j.kind))).collect()
    };
    let of_words = |words: &str| -> BTreeMap<String, String> {
        let joints = words.split(", ").filter_map(|joint| joint.split_once(' '));
        joints.map(|(name, kind)| (name.to_owned(), kind.to_owned())).collect()
    };
    let arm = link("a", "") + &link("b", "") + &joint("j", "revolute", "a", "b", AXIS);
    for [inside, expected] in cases("kinds of joints") {
        let (text, expected) = (model("1.12", &inside), of_words(&expected));
        assert_eq!(kinds(&text), expected, "{text}");
        // In a world, nothing stands by itself, and all names have the name of the model.
        let text = world(&format!("<model name=\"m\">{inside}</model>"));
        let is_held = inside.contains("static") || inside.contains("world");
        for (name, kind) in kinds(&text) {
            let before = &expected[name.strip_prefix("m::").expect("the name of the model")];
            let is_free = !is_held && before == "Fixed";
            assert!(
                kind == if is_free { "Floating" } else { before } || is_held,
                "{name}: {text}"
            );
        }
    }
    let canonical = link("c", "") + &arm;
    let canonical = model("1.9", &canonical).replace("name=\"m\"", "name=\"m\" canonical_link=\"b\"");
    assert_eq!(kinds(&canonical), of_words("a Fixed, c Floating, j Revolute"));
    // Joints of the world join models, also by their frames.
    let two =
        "<model name=\"m\"><link name=\"a\"/></model><model name=\"n\"><link name=\"b\"/><link name=\"a\"/></model>";
    let robot = parse(&world(&format!("{}{two}", joint("j", "revolute", "m", "n::a", AXIS)))).expect("a robot");
    let j = robot.joints().iter().find(|j| j.name == "j").expect("the joint");
    assert_eq!(
        [j.parent, j.child].map(|k| robot.links()[k].name.as_str()),
        ["m::a", "n::a"]
    );
    // The joint of a static model is listed, for it moves nothing.
    let robot = parse(&model("1.9", &format!("<static>true</static>{arm}"))).expect("a robot");
    assert!(
        robot.skipped()[0].to_string().contains("joint \"j\""),
        "{}",
        robot.skipped()[0]
    );
}

#[test]
fn limits_of_a_floating_link_contain_the_pose_at_which_it_is_drawn() {
    let model = |name: &str, is_static: &str, pose: &str| {
        format!(
            "<model name=\"{name}\">{is_static}{}</model>",
            link("l", &format!("<pose>{pose}</pose>"))
        )
    };
    let wall = model("wall", "<static>true</static>", "15 0 0 0 0 0");
    let text = world(&(model("crate", "", "12 0 -30.5 0 0 0") + &wall.replace("15 0 0", "15 0 -30.5")));
    let robot = parse(&text).expect("a robot");
    let limits: Vec<[f64; 2]> = robot.coordinates().iter().map(|c| c.limits).collect();
    assert_eq!(limits[..3], [[-10.0, 12.0], [-10.0, 10.0], [-30.5, 10.0]]);
    let options = LoadOptions::default()
        .floating_limits([-50.0, 50.0])
        .continuous_limits([0.0; 2]);
    let turned = text.replace("12 0 -30.5 0 0 0", "12 0 -30.5 0 0 -1.5");
    let wide = Robot::parse(&turned, "r.sdf", &Packages::default(), &options).expect("a robot");
    assert_eq!(wide.coordinates()[0].limits, [-50.0, 50.0]);
    assert!(wide.coordinates()[5].limits[0] == wide.start()[5] && wide.start()[5] < -1.4);
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    let near = Checker::of_robots(setup).expect("a checker").clearance(robot.start());
    let near = near.expect("within the limits").expect("a pair");
    assert!(near.lower <= 2.0, "{near:?}");
    assert!(near.upper >= 2.0, "{near:?}");
    assert!(near.upper - near.lower < 1e-9, "{near:?}");
}

/// The coordinates of a floating link are its pose in the world.
#[test]
fn floating_links_start_where_they_are_drawn() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for k in 0..200 {
        let mut six: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.0..3.0));
        if k % 4 == 0 {
            six[4] = if k % 8 == 0 { 1.0 } else { -1.0 } * std::f64::consts::FRAC_PI_2;
        }
        let words = six.map(|x| format!("{x:?}")).join(" ");
        let robot = parse(&world(&format!(
            "<model name=\"m\">{}</model>",
            link("a", &format!("<pose>{words}</pose>"))
        )))
        .expect("a robot");
        let names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
        let truth = ["x", "y", "z", "roll", "pitch", "yaw"].map(|part| format!("m::a/{part}"));
        assert_eq!(names, truth);
        let turn = UnitQuaternion::from_euler_angles(six[3], six[4], six[5]);
        let expected = Isometry3::from_parts(Translation3::new(six[0], six[1], six[2]), turn);
        for q in [robot.start(), &six] {
            let [(_, pose)] = &poses_at(&robot, q)[..] else {
                panic!("one body")
            };
            assert!(is_near(pose, &expected), "{words}: {q:?}");
        }
    }
}

#[test]
fn mimic_joints_follow_their_leader() {
    let follow = |leader: &str, numbers: [f64; 3]| {
        let [multiplier, offset, reference] = numbers;
        format!(
            "<axis><xyz>0 0 1</xyz><mimic joint=\"{leader}\"><multiplier>{multiplier}</multiplier>\
             <offset>{offset}</offset><reference>{reference}</reference></mimic></axis>"
        )
    };
    let links: String = ["a", "b", "c", "d"].iter().map(|name| link(name, "")).collect();
    let file = |version: &str, of_c: &str, of_d: &str| {
        let joints = joint("k", "revolute", "a", "c", of_c)
            + &joint("l", "prismatic", "a", "d", of_d)
            + &joint("j", "revolute", "a", "b", AXIS);
        model(version, &(links.clone() + &joints))
    };
    let robot = parse(&file(
        "1.11",
        &follow("j", [2.0, 0.5, 0.25]),
        &follow("k", [-3.0, 1.0, 0.0]),
    ))
    .expect("a robot");
    assert_eq!(robot.coordinates().len(), 1);
    let poses = poses_at(&robot, &[0.7]);
    let k = 2.0 * (0.7 - 0.25) + 0.5;
    let of = |name: &str| poses.iter().find(|(other, _)| other == name).expect("the body").1;
    assert!((of("c").rotation.angle() - k).abs() < 1e-14, "{poses:?}");
    assert!((of("d").translation.z - (-3.0 * k + 1.0)).abs() < 1e-14, "{poses:?}");
}

#[test]
fn masks_exclude_the_pairs_that_share_no_bit() {
    let body =
        |masks: &str| format!("<collision name=\"c\">{BOX}<surface><contact>{masks}</contact></surface></collision>");
    let collide = |mask: &str| body(&format!("<collide_bitmask>{mask}</collide_bitmask>"));
    let links = |bodies: &[String]| -> String {
        bodies
            .iter()
            .enumerate()
            .map(|(k, body)| format!("<link name=\"l{k}\">{body}</link>"))
            .collect()
    };
    for [bodies, expected] in cases("masks") {
        let robot = parse(&world(&format!("<model name=\"m\">{bodies}</model>"))).expect("a robot");
        assert_eq!(format!("{:?}", robot.excluded()), expected);
        let mut setup = Cell::new();
        setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
        let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
        let is_free = checker.is_free_at(robot.start()).expect("an answer");
        let truth = expected != "[]" && bodies.matches("collision name").count() == 2;
        assert_eq!(is_free, truth);
    }
    // Bodies follow their links, whatever the order of the file is.
    let late = links(&[collide("1"), collide("2"), collide("2")])
        + &joint("j", "fixed", "l2", "l0", "")
        + &joint("k", "fixed", "l0", "l1", "");
    let robot = parse(&model("1.9", &format!("<frame name=\"f\"/>{late}"))).expect("a robot");
    let names: Vec<[&str; 2]> = robot
        .excluded()
        .iter()
        .map(|pair| pair.map(|(link, _)| robot.links()[link].name.as_str()))
        .collect();
    assert_eq!(names, [["l2", "l0"], ["l0", "l1"]]);
    for mask in ["-1", "65536", "0x10000", "x", "1.5", "", "0x", "99999999999999999999"] {
        says(parse(&model("1.9", &links(&[collide(mask)]))), "collide_bitmask");
    }
}

#[test]
fn submeshes_are_the_named_objects() {
    let folder = folder("submesh");
    let tetrahedron = |name: &str, first: usize, x: f64| {
        let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
        format!(
            "o {name}\nv {x} 0 0\nv {} 0 0\nv {x} 1 0\nv {x} 0 1\nf {a} {c} {b}\nf {a} {b} {d}\nf {a} {d} {c}\nf {b} {c} {d}\n",
            x + 1.0
        )
    };
    std::fs::write(
        folder.join("two.obj"),
        tetrahedron("left", 1, 0.0) + &tetrahedron("right", 5, 10.0),
    )
    .expect("a file");
    std::fs::write(
        folder.join("same.obj"),
        tetrahedron("left", 1, 0.0) + &tetrahedron("left", 5, 10.0),
    )
    .expect("a file");
    let load = |mesh: &str, options: &LoadOptions| {
        let text = model("1.9", &of_shape(&format!("<mesh>{mesh}</mesh>")));
        Robot::parse(&text, folder.join("r.sdf"), &Packages::default(), options)
    };
    let uses = [lin_canny_robot::MeshUse::Hull, lin_canny_robot::MeshUse::Mesh];
    for usage in uses {
        let options = LoadOptions::default().meshes(usage);
        for [inside, low, high] in cases("submeshes") {
            let robot = load(&format!("<uri>two.obj</uri>{inside}"), &options).unwrap_or_else(|e| panic!("{e}"));
            let geometry = &robot.links()[1].bodies[0].geometry;
            has_box(geometry, &Isometry3::identity(), [&low, &high], &inside);
            if let Geometry::Mesh(mesh) = geometry {
                assert!(mesh.volume() > 0.0, "{inside}");
            }
        }
    }
    for [mesh, words] in cases("faults of a submesh") {
        says(load(&mesh, &LoadOptions::default()), &words);
    }
    let pieces = LoadOptions::default()
        .meshes(lin_canny_robot::MeshUse::Pieces)
        .pieces(&folder);
    says(
        load("<uri>two.obj</uri><submesh><name>left</name></submesh>", &pieces),
        "a submesh as convex pieces is not supported",
    );
}

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bench.sdf")
}

#[test]
fn the_example_is_a_robot_and_a_cell() {
    let robot = Robot::load(example(), &Packages::default()).expect("the example");
    assert_eq!(robot.name(), "bench");
    let names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names[..3], ["arm::shoulder", "arm::elbow", "arm::left_slide"]);
    assert_eq!(names.len(), 9);
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    // The column stands on the table.
    setup.exclude("table::top", "arm::base").expect("names");
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let mut q = robot.start().to_vec();
    assert!(checker.is_free_at(&q).expect("an answer"));
    // Both fingers close by the value of one.
    q[2] = -0.0151;
    assert!(checker.is_free_at(&q).is_err() || !checker.is_free_at(&q).expect("an answer"));
    let cell = CellFile::load(example(), &Packages::default(), &LoadOptions::default()).expect("a cell");
    let names: Vec<&str> = cell.obstacles.iter().map(|o| o.name.as_str()).collect();
    let truth = [
        "table::top",
        "arm::base",
        "arm::upper",
        "arm::hand",
        "arm::left",
        "arm::right",
        "part::block",
    ];
    assert_eq!(names, truth);
    let error =
        CellFile::parse("<robot/>", "c.sdf", &Packages::default(), &LoadOptions::default()).expect_err("a URDF");
    assert!(error.to_string().contains("(expected sdf)"), "{error}");
}

/// Poses, joints and axes are those of the C++ library `libsdformat` 12.3, whose output the text files hold.
///
/// `SDFORMAT_CASES` names another folder with such files.
#[test]
fn poses_are_those_of_another_reader() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sdformat");
    let folder = std::env::var_os("SDFORMAT_CASES").map_or(folder, PathBuf::from);
    let files = std::fs::read_dir(&folder)
        .expect("the folder")
        .flatten()
        .map(|entry| entry.path());
    let files: Vec<PathBuf> = files
        .filter(|path| path.extension().is_some_and(|e| e == "sdf"))
        .collect();
    assert!(!files.is_empty());
    for path in files {
        let robot = Robot::load(&path, &Packages::default()).unwrap_or_else(|e| panic!("{e}"));
        let cell = CellFile::load(&path, &Packages::default(), &LoadOptions::default()).expect("a cell");
        let start = poses_at(&robot, robot.start());
        let frames = frames_at(&robot);
        let text = std::fs::read_to_string(path.with_extension("txt")).expect("the output");
        let mut links = BTreeMap::new();
        let mut bodies = 0;
        for line in text.lines() {
            let mut words = line.split_whitespace();
            let (kind, name) = (words.next().expect("a kind"), words.next().expect("a name"));
            let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
            let pose = || {
                let [x, y, z, w, i, j, k] = numbers[..] else {
                    panic!("{line}")
                };
                let turn = lin_canny::nalgebra::Quaternion::new(w, i, j, k);
                Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_quaternion(turn))
            };
            let is_same =
                |a: &Isometry3<f64>, b: &Isometry3<f64>| (a.to_homogeneous() - b.to_homogeneous()).amax() < 1e-9;
            match kind {
                "link" => drop(links.insert(name, pose())),
                "collision" => {
                    let link = name.rsplit_once('/').expect("a collision").0;
                    let expected = links[link] * pose();
                    let of_cell = cell.obstacles.iter().filter(|o| o.name == link).map(|o| o.pose);
                    let of_robot = start.iter().filter(|(other, _)| other == link).map(|(_, pose)| *pose);
                    assert!(
                        of_cell.into_iter().any(|at| is_same(&at, &expected)),
                        "{}: {line}",
                        path.display()
                    );
                    assert!(
                        of_robot.into_iter().any(|at| is_same(&at, &expected)),
                        "{}: {line}",
                        path.display()
                    );
                    bodies += 1;
                }
                "joint" => {
                    let words: Vec<&str> = name.split('@').collect();
                    let joint = robot.joints().iter().find(|j| j.name == words[0]).expect("the joint");
                    let model = words[0].rsplit_once("::").expect("a model").0;
                    let [parent, child] = [joint.parent, joint.child].map(|k| robot.links()[k].name.as_str());
                    assert_eq!([parent, child], [1, 2].map(|k| format!("{model}::{}", words[k])));
                    assert!(is_same(&frames[joint.child], &pose()), "{}: {line}", path.display());
                }
                "axis" => {
                    let joint = robot.joints().iter().find(|j| j.name == name).expect("the joint");
                    let axis = Vector3::new(numbers[0], numbers[1], numbers[2]);
                    let off = (joint.axis.into_inner() - axis).amax();
                    assert!(off < 1e-9, "{}: {line}", path.display());
                }
                _ => {}
            }
        }
        assert_eq!(bodies, cell.obstacles.len());
        assert_eq!(links.len() + 1, robot.links().len());
    }
}

/// The frame of each link at the start, by the joints.
fn frames_at(robot: &Robot) -> Vec<Isometry3<f64>> {
    let mut frames = vec![Isometry3::identity()];
    for joint in robot.joints() {
        let mut frame = frames[joint.parent] * joint.origin;
        if let (MotionKind::Floating, Some(drive)) = (joint.kind, joint.drive) {
            let q = &robot.start()[drive.coordinate..];
            let turn = UnitQuaternion::from_euler_angles(q[3], q[4], q[5]);
            frame *= Isometry3::from_parts(Translation3::new(q[0], q[1], q[2]), turn);
        }
        frames.push(frame);
    }
    frames
}
