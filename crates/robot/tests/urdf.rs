//! The URDF reader: a fault in every place it can stand, files of every encoding, and another reader as oracle.

use std::path::Path;

use lin_canny::cover::CoverGoal;
use lin_canny::nalgebra::{UnitQuaternion, Vector3};
use lin_canny_robot::{
    FileError, FileErrorKind, LinkBody, LoadOptions, MotionKind, Packages, Robot, cover_links, urdf_of_balls,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truth::errors::says;

fn parse(text: &str) -> Result<Robot, FileError> {
    Robot::parse(text, "r.urdf", &Packages::default(), &LoadOptions::default())
}

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("urdf/rows.txt"), section)
}

/// A robot with a mark `@name@` in every place where an element can stand, each in a line of its own.
const MARKED: &str = include_str!("urdf/marked.xml");

/// The names of the marks.
fn places() -> impl Iterator<Item = &'static str> {
    MARKED
        .lines()
        .filter_map(|line| line.strip_prefix('@')?.strip_suffix('@'))
}

/// Returns the marked robot with an element in one place, and the line of the place.
fn with(place: &str, element: &str) -> (String, u32) {
    let mark = format!("@{place}@");
    let line = MARKED.lines().position(|line| line == mark).expect(place) as u32 + 1;
    let mut text = MARKED.trim_end().replace(&mark, element);
    for other in places() {
        text = text.replace(&format!("@{other}@"), "");
    }
    (text, line)
}

/// Returns what a robot is, with every number.
fn content(robot: &Robot) -> String {
    format!("{:?} {:?} {:?}", robot.links(), robot.joints(), robot.coordinates())
}

/// The error of an element in one place names its line and some words.
fn named(place: &str, element: &str, words: &[&str]) -> FileErrorKind {
    let (text, line) = with(place, element);
    let error = parse(&text).expect_err(&format!("{element} in {place}"));
    let told = error.to_string();
    assert_eq!(error.line, Some(line), "{place}: {told}");
    for word in words {
        assert!(told.contains(word), "{place}: {told} does not name {word}");
    }
    error.reason
}

#[test]
fn unknown_elements_are_errors_in_every_place() {
    for place in places() {
        for name in ["colision", "cone", "robot", "Link", "loop_joint", "sdf"] {
            let reason = named(place, &format!("<{name} name=\"n\"/>"), &[name, "unknown element"]);
            assert!(matches!(reason, FileErrorKind::UnknownPart { what: "element", .. }));
        }
    }
    named("link", "<colision/>", &["did you mean \"collision\"?"]);
    named("geometry", "<shpere radius=\"1\"/>", &["did you mean \"sphere\"?"]);
    named("joint", "<orgin/>", &["did you mean \"origin\"?"]);
    named("middle", "<lnk name=\"c\"/>", &["did you mean \"link\"?"]);
    // What is read in one place is unknown in others.
    for (place, element) in [
        ("robot", "collision"),
        ("link", "geometry"),
        ("link", "joint"),
        ("joint", "link"),
    ] {
        named(place, &format!("<{element} name=\"n\"/>"), &["unknown element"]);
    }
}

#[test]
fn what_xacro_left_is_an_error_in_every_place() {
    for place in places() {
        for name in [
            "xacro:include",
            "xacro:colision",
            "xacro:link",
            "macro",
            "property",
            "include",
        ] {
            let reason = named(place, &format!("<{name} name=\"n\"/>"), &[name, "run xacro"]);
            assert!(matches!(reason, FileErrorKind::Xacro(_)));
        }
    }
    let plain = with("robot", "").0;
    for (from, to) in [
        ("size=\"1 2 3\"", "size=\"${x} 2 3\""),
        ("link name=\"b\"", "link name=\"${x}b\""),
        ("child link=\"b\"", "child link=\"$(arg x)b\""),
        ("upper=\"1\"", "upper=\"${pi/2}\""),
    ] {
        let error = parse(&plain.replace(from, to)).expect_err(to);
        assert!(error.line.is_some(), "{error}");
        assert!(error.to_string().contains("run xacro"), "{error}");
    }
    let undeclared = with("robot", "<xacro:include/>").0.replace("xmlns:xacro", "xmlns:y");
    let error = says(parse(&undeclared), "run xacro");
    assert_eq!(error.line, Some(2), "{error}");
}

#[test]
fn what_is_passed_over_changes_nothing_whatever_is_in_it() {
    let plain = content(&parse(&with("robot", "").0).expect("a robot"));
    let passed = [
        "visual",
        "inertial",
        "dynamics",
        "calibration",
        "safety_controller",
        "transmission",
        "gazebo",
        "material",
        "sensor",
        "ros2_control",
    ];
    let faults = [
        "",
        "<geometry/><geometry><box size=\"x\"/><cone/></geometry>",
        "<origin xyz=\"NaN\"/><origin/><link name=\"a\"/><joint/>",
        "<xacro:if/>text ${x}",
    ];
    for place in ["robot", "link", "collision", "geometry", "middle", "joint", "end"] {
        for name in passed {
            for fault in faults {
                let (text, _) = with(place, &format!("<{name} radius=\"x\">{fault}</{name}><{name}/>"));
                assert_eq!(content(&parse(&text).expect(&text)), plain);
            }
        }
    }
    for place in places() {
        for name in ["x:link", "x:collision", "x:box", "x:origin"] {
            let (text, _) = with(
                place,
                &format!("<{name} name=\"a\">{}</{name}><!-- c --><?p?>", faults[1]),
            );
            assert_eq!(content(&parse(&text).expect(&text)), plain);
        }
    }
    // Attributes of a foreign namespace are none of ours.
    let text = with("robot", "").0;
    let prefixed = text
        .replace("size=", "x:size=\"9 9 9\" size=")
        .replace("lower", "x:lower=\"0\" lower");
    assert_eq!(content(&parse(&prefixed).expect("a robot")), plain);
    // A default namespace is the one of all elements.
    let default = text.replace("<robot ", "<robot xmlns=\"http://drake.mit.edu\" ");
    assert_eq!(content(&parse(&default).expect("a robot")), plain);
    for unused in [
        " effort=\"x\" velocity=\"\"",
        " effort=\"1\" velocity=\"inf\" jerk=\"1\" current=\"2\"",
    ] {
        let text = text.replace("upper=\"1\"", &format!("upper=\"1\"{unused}"));
        assert_eq!(content(&parse(&text).expect("a robot")), plain);
    }
    // A velocity is a limit, which changes nothing else.
    let text = text.replace("upper=\"1\"", "upper=\"1\" velocity=\"0.5\"");
    let limited = content(&parse(&text).expect("a robot"));
    assert!(limited.contains("velocity: Some(0.5)"), "{limited}");
    assert_eq!(limited.replace("velocity: Some(0.5)", "velocity: None"), plain);
}

#[test]
fn elements_given_twice_are_errors() {
    for [place, element] in cases("elements given twice") {
        let (text, line) = with(&place, &element);
        let error = parse(&text).expect_err(&element);
        assert!(matches!(error.reason, FileErrorKind::Twice(_)), "{error}");
        assert!(error.line > Some(line), "{error}");
    }
    for place in ["robot", "middle", "end"] {
        for (element, name) in [("<link name=\"a\"/>", "a"), ("<joint name=\"j\" type=\"fixed\"/>", "j")] {
            let error = parse(&with(place, element).0).expect_err(element);
            assert!(matches!(error.reason, FileErrorKind::Repeated), "{error}");
            assert!(error.line.is_some() && error.element.contains(name), "{error}");
        }
    }
    let one = "<mimic joint=\"j\"/>";
    let error = parse(&with("joint", &format!("{one}{one}")).0).expect_err("two mimics");
    assert!(matches!(error.reason, FileErrorKind::Twice(_)), "{error}");
}

#[test]
fn missing_parts_and_misspelt_attributes_are_named() {
    let plain = with("robot", "").0;
    for [from, to, line, words] in cases("misspelt parts") {
        assert!(plain.contains(&from), "{from}");
        let error = says(parse(&plain.replacen(&from, &to, 1)), &words);
        let line = plain.lines().position(|text| text.contains(&line)).expect(&line) as u32 + 1;
        assert_eq!(error.line, Some(line), "{error}");
    }
    // An origin of a link moves nothing, so it must be the identity.
    let plain = content(&parse(&plain).expect("a robot"));
    let identity = with("link", "<origin xyz=\"0 0 0\" rpy=\"0 -0 0\"/>").0;
    assert_eq!(content(&parse(&identity).expect("a robot")), plain);
    for origin in ["xyz=\"0 0 1\"", "rpy=\"0 0 1\"", "xyz=\"x\"", "xyy=\"0\""] {
        named("link", &format!("<origin {origin}/>"), &["origin"]);
    }
}

#[test]
fn files_of_every_encoding_and_line_end_are_read() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("encodings");
    std::fs::create_dir_all(&folder).expect("a folder");
    let body = "<robot name=\"Gelenk für Größe\">\n<link name=\"ü\"/>\n</robot>\n";
    let declared = |encoding: &str| format!("<?xml version=\"1.0\" encoding=\"{encoding}\"?>\n{body}");
    let latin = |text: &str| -> Vec<u8> { text.chars().map(|c| c as u8).collect() };
    let little = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(u16::to_le_bytes).collect() };
    let big = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(u16::to_be_bytes).collect() };
    let marked = |text: &str| format!("\u{feff}{text}");
    let files = [
        body.as_bytes().to_vec(),
        marked(body).into_bytes(),
        declared("UTF-8").into_bytes(),
        marked(&declared("utf-8")).into_bytes(),
        latin(&declared("ISO-8859-1")),
        latin(&declared("windows-1252")),
        latin(&declared("latin1").replace('"', "'")),
        little(&marked(&declared("UTF-16"))),
        big(&marked(&declared("UTF-16"))),
        little(&marked(body)),
        little(&declared("UTF-16LE")),
        big(&declared("UTF-16BE")),
    ];
    let load = |bytes: &[u8]| {
        let file = folder.join("r.urdf");
        std::fs::write(&file, bytes).expect("a file");
        Robot::load(&file, &Packages::default())
    };
    for (k, bytes) in files.iter().enumerate() {
        let robot = load(bytes).unwrap_or_else(|e| panic!("file {k}: {e}"));
        assert_eq!(robot.name(), "Gelenk für Größe", "file {k}");
        assert_eq!(robot.link("ü"), Some(0), "file {k}");
    }
    let crlf = declared("iso-8859-1").replace('\n', "\r\n");
    assert!(load(&latin(&crlf)).is_ok());
    let error = load(&latin(&crlf.replace("<link", "<lin"))).expect_err("an unknown element");
    assert_eq!(error.line, Some(3), "{error}");
    let error = says(load(&latin(body)), "byte 0xfc (expected UTF-8");
    assert_eq!(error.line, Some(1), "{error}");
    let error = load(&latin(&declared("utf-8"))).expect_err("a wrong encoding");
    assert_eq!(error.line, Some(2), "{error}");
    says(load(&latin(&declared("shift_jis"))), "\"shift_jis\"");
    let odd = little(&marked(body));
    says(load(&odd[..odd.len() - 1]), "UTF-16");
    // In text that is decoded, an encoding and a byte order mark have no meaning.
    assert!(parse(&marked(&declared("utf-16"))).is_ok());
}

/// What tinyxml takes and XML does not changes nothing, and is listed with its line.
#[test]
fn what_tinyxml_takes_is_listed() {
    let plain = content(&parse(&with("robot", "").0).expect("a robot"));
    let is_listed = |text: &str, line: u32, words: &[&str]| {
        let robot = parse(text).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert_eq!(content(&robot), plain);
        let skipped: Vec<String> = robot.skipped().iter().map(ToString::to_string).collect();
        assert_eq!(skipped.len(), words.len(), "{skipped:?}");
        for (skipped, words) in skipped.iter().zip(words) {
            assert!(skipped.starts_with(&format!("r.urdf:{line}: ")), "{skipped}");
            assert!(skipped.contains(words), "{skipped}");
        }
    };
    for place in places() {
        for (element, words) in [
            ("<!-- ---- é ' > ---->", &["\"--\" in a comment"][..]),
            ("<!-- a -\n<b c=\"--\"> --->", &["\"--\" in a comment"]),
            ("<!----><!-- --x --><!-- - -->", &["\"--\" in a comment"]),
            ("stray>", &["text between elements (\"stray>\")"]),
            ("<![CDATA[ <!-- -- ]]>", &["text between elements (\"<!-- --\")"]),
            (
                "<y:link name='a' z:b='\"'/><y:box/>",
                &["undeclared prefix: \"y\"", "undeclared prefix: \"z\""],
            ),
            ("<x:l xmlns:y='u' y:a='1'/><x:l q='y:a'>y:a</x:l>", &[]),
        ] {
            let (text, line) = with(place, element);
            is_listed(&text, line, words);
        }
        let (text, line) = with(place, "<x:l xmlns:y='u'/><!-- -- \n--><y:l/>\n<colision/>");
        let error = parse(&text).expect_err(place);
        assert_eq!(error.line, Some(line + 2), "{error}");
    }
    let (text, _) = with("robot", "");
    let header = "<?xml version=\"1.0\" encoding=\"utf-8\"?>";
    let late = ["XML declaration behind other text"];
    is_listed(&format!("\n \n{header}\n{text}"), 3, &late);
    is_listed(&format!(" {header}{text}"), 1, &late);
    is_listed(&format!("{header}\n{header}{text}"), 2, &late);
    is_listed(
        &format!("<!-- c -->\n{header}<!DOCTYPE robot [<!-- it's > -->]>{text}"),
        2,
        &late,
    );
    let around = "text outside of the root element";
    is_listed(&format!("{header}\n\n é <![CDATA[<]]>{text}"), 3, &[around, around]);
    is_listed(&format!("{text}<!-- c --> \n"), 1, &[]);
    let end = text.lines().count() as u32;
    is_listed(&format!("{text}\n\nend"), end + 2, &[around]);
}

/// Balls replace collision elements, and all else of the file stays.
#[test]
fn a_file_that_tinyxml_takes_is_written_with_balls() {
    let around = [
        "<robot name=\"r\">\n<!-- -- --><y:x/><link name=\"a\">",
        "</link>\n<y:z/></robot>",
    ];
    let collision = "<collision><geometry><sphere radius=\"1\"/></geometry></collision>";
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tinyxml.urdf");
    let text = format!("\n<?xml version=\"1.0\"?>\n{}", around.join(collision));
    std::fs::write(&file, text).expect("a file");
    let robot = Robot::load(&file, &Packages::default()).expect("a robot");
    let covers = cover_links(&robot, CoverGoal::Balls(1), 1).expect("balls");
    let written = urdf_of_balls(&file, &covers).expect("a text");
    let body = written
        .strip_prefix("<?xml version=\"1.0\"?>\n")
        .expect("a declaration");
    let body = body
        .strip_prefix(around[0])
        .and_then(|body| body.strip_suffix(around[1]));
    assert!(
        body.is_some_and(|body| body.contains("sphere") && body.starts_with("<collision>")),
        "{written}"
    );
    assert_eq!(parse(&written).expect("a robot").links().len(), 1);
}

#[test]
fn limits_that_look_like_degrees_are_listed() {
    let with = |limit: &str| parse(&with("robot", "").0.replace("lower=\"-1\" upper=\"1\"", limit)).expect(limit);
    let robot = with("lower=\"-90\" upper=\"90\"");
    assert_eq!(robot.coordinates()[0].limits, [-90.0, 90.0]);
    let [skipped] = robot.skipped() else {
        panic!("{:?}", robot.skipped())
    };
    assert!(
        skipped
            .to_string()
            .contains("joint \"j\" limit: limits -90.0 and 90.0 look like degrees"),
        "{skipped}"
    );
    for limit in ["lower=\"-50\" upper=\"50\"", "lower=\"-1e9\" upper=\"1e9\""] {
        assert!(with(limit).skipped().is_empty());
    }
}

#[test]
fn files_that_are_no_good_xml_get_a_message_that_helps() {
    let body = "<robot name=\"r\"><link name=\"a\"/></robot>";
    for (text, line, words) in [
        (body.replace("name", "name=\"a\" name"), 1, "'name'"),
        (body.replace("name", "y:n=\"a\" y:n=\"b\" name"), 1, "'n'"),
        (
            body.replace("<link", "<!-- a -- b\n---><y:x/>\n<link a=\"1\" a=\"2\""),
            3,
            "'a'",
        ),
        (body.replace("<link", "<!-- a -- b\n-- ><y:x/>\n<link"), 3, "'-->'"),
        (body.replace("<link", "\n<xacro:x/><link"), 2, "run xacro"),
        (body.replace("\"a\"", "\"a & b\""), 1, "&amp;"),
        ("<robot name=\"r\">\n\n<link name=\"a\"/>\n".into(), 3, "never closed"),
        ("<world/>".into(), 1, "\"world\" (expected robot, mujoco or sdf)"),
    ] {
        let error = says(parse(&text), words);
        assert_eq!(error.line, Some(line), "{error}");
    }
    // A document type may define entities. They are bounded, and none is read from elsewhere.
    let with_type = |inside: &str, name: &str| {
        format!(
            "<?xml version=\"1.0\"?>\n<!DOCTYPE robot [{inside}]>\n<robot name=\"{name}\"><link name=\"a\"/></robot>"
        )
    };
    let robot = parse(&with_type("<!ENTITY n \"arm\">", "&n;")).expect("a robot");
    assert_eq!(robot.name(), "arm");
    assert!(parse(&format!("<!DOCTYPE robot>{body}")).is_ok());
    let mut bomb = "<!ENTITY e0 \"xxxxxxxxxx\">".to_owned();
    for k in 0..9 {
        bomb += &format!("<!ENTITY e{} \"{}\">", k + 1, format!("&e{k};").repeat(10));
    }
    assert!(parse(&with_type(&bomb, "&e9;")).is_err());
    assert!(parse(&with_type("<!ENTITY n \"&n;\">", "&n;")).is_err());
    let long = format!("<!ENTITY n \"{}\">", "x".repeat(1_000));
    assert_eq!(parse(&with_type(&long, "&n;&n;")).expect("a robot").name().len(), 2_000);
    says(
        parse(&with_type(&long, &"&n;".repeat(2_000))),
        "longer than a megabyte is not supported",
    );
    says(
        parse(&format!("<robot {}/>", "a=\"\" ".repeat(6_000))),
        "that many prefixes or attributes",
    );
    assert!(parse(&with_type("<!ENTITY n SYSTEM \"file:///etc/passwd\">", "&n;")).is_err());
    let default = "<!ATTLIST origin xyz CDATA \"1 0 0\">";
    says(parse(&with_type(default, "r")), "document type");
}

/// A random robot: elements in any order, numbers in any form, and what is passed over in between.
fn random_robot(random: &mut ChaCha8Rng) -> String {
    let number = |random: &mut ChaCha8Rng| match random.random_range(0..4) {
        0 => format!("{}", random.random_range(-3..4)),
        1 => format!("{:e}", random.random_range(-3.0..3.0)),
        _ => format!(" {:.3}\n", random.random_range(-3.0..3.0)),
    };
    let three = |random: &mut ChaCha8Rng| (0..3).map(|_| number(random)).collect::<Vec<_>>().join(" ");
    let mut elements = Vec::new();
    let count = random.random_range(1..9);
    for k in 0..count {
        let mut inside = String::new();
        for _ in 0..random.random_range(0..3) {
            let sizes: [f64; 3] = std::array::from_fn(|_| random.random_range(0.1..2.0));
            let [x, y, z] = sizes;
            let shape = match random.random_range(0..4) {
                0 => format!("<box size=\"{x} {y} {z}\"/>"),
                1 => format!("<sphere radius=\"{x}\"/>"),
                2 => format!("<cylinder length=\"{x}\" radius=\"{y}\"/>"),
                _ => format!("<capsule radius=\"{x}\" length=\"{y}\"/>"),
            };
            let origin = match random.random_range(0..4) {
                0 => String::new(),
                1 => format!("<origin xyz=\"{}\"/>", three(random)),
                2 => format!("<origin rpy=\"{}\"/>", three(random)),
                _ => format!("<origin rpy=\"{}\" xyz=\"{}\"/>", three(random), three(random)),
            };
            let geometry = format!("<geometry>{shape}</geometry>");
            let parts = if random.random_bool(0.5) {
                origin + &geometry
            } else {
                geometry + &origin
            };
            inside += &format!("<collision name=\"n\">{parts}</collision>");
            inside += "<visual><geometry><box size=\"1 1 1\"/></geometry></visual>";
        }
        elements.push(format!("<link name=\"l{k}\">{inside}</link>"));
        if k > 0 {
            let parent = random.random_range(0..k);
            let kind =
                ["revolute", "continuous", "prismatic", "fixed", "planar", "floating"][random.random_range(0..6)];
            let mut parts = vec![
                format!("<parent link=\"l{parent}\"/>"),
                format!("<child link=\"l{k}\"/>"),
                "<limit lower=\"-1.5\" upper=\"2\" effort=\"1\" velocity=\"1\"/>".to_owned(),
                "<dynamics damping=\"1\"/>".to_owned(),
            ];
            if random.random_bool(0.8) {
                parts.push(format!(
                    "<axis xyz=\"{} 4\"/>",
                    three(random).split_whitespace().take(2).collect::<Vec<_>>().join(" ")
                ));
            }
            if random.random_bool(0.8) {
                parts.push(format!("<origin xyz=\"{}\" rpy=\"{}\"/>", three(random), three(random)));
            }
            let turn = random.random_range(0..parts.len());
            parts.rotate_left(turn);
            elements.push(format!(
                "<joint name=\"j{k}\" type=\"{kind}\">{}</joint>",
                parts.concat()
            ));
            if k > 1 && random.random_bool(0.3) {
                let mimic = format!(
                    "<mimic joint=\"j{}\" multiplier=\"{}\"/></joint>",
                    k - 1,
                    -0.5 * f64::from(k)
                );
                let last = elements.pop().expect("a joint").replace("</joint>", &mimic);
                let single = ["revolute", "continuous", "prismatic"];
                let is_single = |text: &str| single.iter().any(|kind| text.contains(&format!("\"{kind}\"")));
                let before = elements
                    .iter()
                    .any(|e| e.contains(&format!("name=\"j{}\"", k - 1)) && is_single(e));
                let plain = last.replace(&mimic, "</joint>");
                elements.push(if before && is_single(&last) { last } else { plain });
            }
        }
    }
    let turn = random.random_range(0..elements.len());
    elements.rotate_left(turn);
    format!("<robot name=\"random\">{}<gazebo/></robot>", elements.join("\n"))
}

/// Returns the corners of the box around a body, and its kind.
fn shape(body: &LinkBody) -> String {
    let (center, radius) = body.geometry.bounding_ball();
    format!("{:?} {center:?} {radius:?}", body.geometry.kind())
}

/// Returns what `shape` returns for a geometry as `urdf-rs` reads it.
fn shape_of(geometry: &urdf_rs::Geometry) -> String {
    let text = match geometry {
        urdf_rs::Geometry::Box { size } => format!("<box size=\"{} {} {}\"/>", size[0], size[1], size[2]),
        urdf_rs::Geometry::Sphere { radius } => format!("<sphere radius=\"{radius}\"/>"),
        urdf_rs::Geometry::Cylinder { radius, length } => {
            format!("<cylinder radius=\"{radius}\" length=\"{length}\"/>")
        }
        urdf_rs::Geometry::Capsule { radius, length } => format!("<capsule radius=\"{radius}\" length=\"{length}\"/>"),
        urdf_rs::Geometry::Mesh { filename, .. } => panic!("{filename}"),
    };
    let collision = format!("<collision><geometry>{text}</geometry></collision>");
    let robot = parse(&format!("<robot><link name=\"a\">{collision}</link></robot>")).expect("a robot");
    shape(&robot.links()[0].bodies[0])
}

/// The pose is the one of `urdf-rs`, with angles by nalgebra.
fn same_pose(ours: &lin_canny::nalgebra::Isometry3<f64>, theirs: &urdf_rs::Pose) {
    let [roll, pitch, yaw] = *theirs.rpy;
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    assert_eq!(ours.translation.vector, Vector3::from(*theirs.xyz));
    assert!((ours.rotation.to_rotation_matrix().matrix() - turn.to_rotation_matrix().matrix()).amax() < 1e-14);
}

#[test]
fn good_files_give_the_robot_that_another_reader_gives() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut texts = vec![std::fs::read_to_string(examples.join("arm.urdf")).expect("the example")];
    let mut random = ChaCha8Rng::seed_from_u64(5);
    texts.extend((0..300).map(|_| random_robot(&mut random)));
    for text in texts {
        let ours = parse(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let theirs = urdf_rs::read_from_string(&text).expect("a robot");
        assert_eq!(ours.name(), theirs.name.as_str());
        assert_eq!(ours.links().len(), theirs.links.len());
        for link in &theirs.links {
            let bodies = &ours.links()[ours.link(&link.name).expect("the link")].bodies;
            assert_eq!(bodies.len(), link.collision.len());
            for (body, collision) in bodies.iter().zip(&link.collision) {
                same_pose(&body.origin, &collision.origin);
                assert_eq!(shape(body), shape_of(&collision.geometry));
            }
        }
        assert_eq!(ours.joints().len(), theirs.joints.len());
        for joint in &theirs.joints {
            let own = ours.joints().iter().find(|j| j.name == joint.name).expect("the joint");
            let names = [own.parent, own.child].map(|k| ours.links()[k].name.as_str());
            assert_eq!(names, [joint.parent.link.as_str(), joint.child.link.as_str()]);
            same_pose(&own.origin, &joint.origin);
            let axis = Vector3::from(*joint.axis.xyz).normalize();
            assert!((own.axis.into_inner() - axis).amax() < 1e-15);
            use urdf_rs::JointType;
            let (kind, is_limited) = match joint.joint_type {
                JointType::Revolute => (MotionKind::Revolute, true),
                JointType::Continuous => (MotionKind::Revolute, false),
                JointType::Prismatic => (MotionKind::Prismatic, true),
                JointType::Fixed => (MotionKind::Fixed, false),
                JointType::Planar => (MotionKind::Planar, false),
                JointType::Floating => (MotionKind::Floating, false),
                JointType::Spherical => panic!("a spherical joint"),
            };
            assert_eq!(own.kind, kind);
            if is_limited {
                assert_eq!(own.limits, [joint.limit.lower, joint.limit.upper]);
            }
            let mimic = joint.mimic.as_ref();
            assert_eq!(own.mimics.as_deref(), mimic.map(|m| m.joint.as_str()));
            if let (Some(mimic), Some(drive)) = (mimic, own.drive) {
                let other = ours
                    .joints()
                    .iter()
                    .find(|j| j.name == mimic.joint)
                    .and_then(|j| j.drive);
                let other = other.expect("a drive");
                assert_eq!(drive.coordinate, other.coordinate);
                assert_eq!(drive.factor, other.factor * mimic.multiplier.unwrap_or(1.0));
            }
        }
    }
}

/// Versions below 1.2 have limits of zero where none is given, later ones have no limit.
#[test]
fn omitted_limits_are_those_of_the_version() {
    let text = with("robot", "").0.replace("lower=\"-1\"", "");
    for (version, expected) in [
        ("", 0.0),
        ("version=\"1.1\"", 0.0),
        ("version=\"1.2\"", f64::NEG_INFINITY),
    ] {
        let robot = parse(&text.replace("<robot ", &format!("<robot {version} "))).expect("a robot");
        assert_eq!(robot.joints()[0].limits, [expected, 1.0]);
        let open = LoadOptions::default().continuous_limits[0];
        let found = robot.coordinates()[0].limits;
        assert_eq!(found, [if expected == 0.0 { 0.0 } else { open }, 1.0]);
    }
}
