//! Elements that Drake adds to URDF.

use lin_canny_robot::plan::{Cell, Checker};
use std::path::Path;

use lin_canny::Geometry;
use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::{FileError, FileErrorKind, LoadOptions, MeshUse, Packages, Robot};
use truth::errors::says;

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("drake/rows.txt"), section)
}

/// Links `a` to `e`, each but `e` with two balls, on joints to `a`, with elements below `robot`
/// each in a line of its own from line 2 on.
fn read(elements: &[&str]) -> Result<Robot, FileError> {
    let ball = "<collision><geometry><sphere radius='1'/></geometry></collision>";
    let links = ["a", "b", "c", "d"].map(|name| format!("<link name='{name}'>{ball}{ball}</link>"));
    let joints = ["b", "c", "d", "e"].map(|name| {
        format!("<joint name='j{name}' type='continuous'><parent link='a'/><child link='{name}'/></joint>")
    });
    parse(&format!(
        "<robot name='r' xmlns:drake='http://drake.mit.edu'>\n{}\n{}<link name='e'/>{}</robot>",
        elements.join("\n"),
        // Joints and links need no order: the robot has an order of its own.
        joints.concat(),
        links.into_iter().rev().collect::<String>()
    ))
}

fn parse(text: &str) -> Result<Robot, FileError> {
    Robot::parse(text, "r.urdf", &Packages::default(), &LoadOptions::default())
}

/// Returns the excluded pairs as words such as `b c`, each with the number of pairs of bodies.
fn pairs(robot: &Robot) -> Vec<(String, usize)> {
    let mut found = std::collections::BTreeMap::new();
    for pair in robot.excluded() {
        let mut names = pair.map(|(link, _)| robot.links()[link].name.clone());
        names.sort();
        *found.entry(names.join(" ")).or_default() += 1;
    }
    found.into_iter().collect()
}

const BC: &str = "<drake:collision_filter_group name='bc'><drake:member link='b'/><drake:member link='c'/>
</drake:collision_filter_group>";
const D: &str = "<drake:collision_filter_group name='d'><drake:member link='d'/></drake:collision_filter_group>";

fn group(name: &str, inside: &str) -> String {
    format!("<drake:collision_filter_group name='{name}'>{inside}</drake:collision_filter_group>")
}

#[test]
fn groups_exclude_pairs_of_links() {
    let ignores = |name: &str| format!("<drake:ignored_collision_filter_group name='{name}'/>");
    let link = |name: &str| format!("<drake:member link='{name}'/>");
    let member_group = |name: &str| format!("<drake:member_group name='{name}'/>");
    for (inside, expected) in [
        (String::new(), &[][..]),
        (link("a"), &[]),
        // A group may ignore itself.
        (
            link("a") + &link("b") + &link("d") + &ignores("g"),
            &["a b", "a d", "b d"],
        ),
        (link("a") + &ignores("bc"), &["a b", "a c"]),
        (link("a") + &ignores("bc") + &ignores("d"), &["a b", "a c", "a d"]),
        // A link is not excluded against itself, and a link without bodies has no pairs.
        (link("b") + &link("e") + &ignores("bc"), &["b c"]),
        (member_group("d") + &ignores("bc"), &["b d", "c d"]),
        (link("a") + &member_group("bc") + &ignores("d"), &["a d", "b d", "c d"]),
        (member_group("bc") + &ignores("g"), &["b c"]),
        // Members of groups in a cycle are the same.
        (member_group("g") + &member_group("d") + &ignores("bc"), &["b d", "c d"]),
    ] {
        let group = group("g", &inside);
        for place in 0..3 {
            let mut elements = vec![BC, D];
            elements.insert(place, &group);
            let robot = read(&elements).expect(&inside);
            let expected: Vec<_> = expected.iter().map(|pair| (pair.to_string(), 4)).collect();
            assert_eq!(pairs(&robot), expected, "{inside}");
            assert!(robot.excluded().is_sorted(), "{:?}", robot.excluded());
        }
        for (ignore, count) in [("true", 0), ("false", expected.len())] {
            let ignored = group.replacen("name='g'", &format!("name='g' ignore='{ignore}'"), 1);
            let robot = read(&[BC, &ignored, D]).expect(&ignored);
            assert_eq!(pairs(&robot).len(), count, "{ignored}");
        }
    }
    // If all pairs are excluded, no pair is checked.
    let all = group("all", &(["a", "b", "c", "d"].map(link).concat() + &ignores("all")));
    for (elements, is_checked) in [(vec![], true), (vec![all.as_str()], false)] {
        let mut setup = Cell::new();
        setup
            .add_robot("", &read(&elements).expect("a robot"), Isometry3::identity())
            .expect("a robot");
        let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
        let near = checker.clearance(&[0.0; 4]).expect("a configuration");
        assert_eq!(near.is_some(), is_checked);
    }
}

#[test]
fn faults_of_groups_are_errors_with_their_line() {
    for [element, words] in cases("faults of groups") {
        for place in 0..3 {
            let mut elements = vec![
                BC.lines().next().unwrap_or_default(),
                "</drake:collision_filter_group>",
                D,
            ];
            elements.insert([0, 2, 3][place], &element);
            let error = read(&elements).expect_err(&element);
            assert_eq!(error.line, Some([2, 4, 5][place]), "{error}");
            assert!(error.to_string().contains(&words), "{error} does not say {words}");
        }
    }
    let error = read(&[D, BC, D]).expect_err("two groups d");
    assert!(matches!(error.reason, FileErrorKind::Repeated), "{error}");
    assert!(error.line == Some(5), "{error}");
    // An ignored group is not read.
    let ignored = "<drake:collision_filter_group name='d' ignore='true'><drake:x/></drake:collision_filter_group>";
    assert!(read(&[D, ignored]).is_ok());
}

/// Reads a robot of one link with these collision elements, or with elements in another place.
fn with(collisions: &str, other: &str, options: &LoadOptions) -> Result<Robot, FileError> {
    let text = format!(
        "<robot name='r' xmlns:drake='http://drake.mit.edu'>{}<link name='a'>{}{collisions}</link><link name='b'/>
<joint name='j' type='fixed'>{}<parent link='a'/><child link='b'/></joint></robot>",
        if other.contains("linear") { other } else { "" },
        if other.contains("visual") { other } else { "" },
        if other.contains("mimic") || other.contains("acceleration") {
            other
        } else {
            ""
        },
    );
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    Robot::parse(&text, examples.join("r.urdf"), &Packages::default(), options)
}

fn collision(shape: &str) -> String {
    format!("<collision><geometry>{shape}</geometry></collision>")
}

#[test]
fn shapes_of_drake_are_bodies() {
    let plain = LoadOptions::default();
    let capsule = "<drake:capsule radius='0.5' length='2'/>";
    let ellipsoid = "<drake:ellipsoid a='1' b='2' c='3'/>";
    let sphere = collision("<sphere radius='1'/>");
    for (shape, extents) in [
        (capsule, [0.5, 0.5, 1.5]),
        (&capsule.replace("drake:", ""), [0.5, 0.5, 1.5]),
        (ellipsoid, [1.0, 2.0, 3.0]),
    ] {
        for (k, text) in [
            collision(shape) + &sphere + &sphere,
            sphere.clone() + &collision(shape) + &sphere,
            sphere.clone() + &sphere + &collision(shape),
        ]
        .into_iter()
        .enumerate()
        {
            let robot = with(&text, "", &plain).expect(shape);
            let found = format!("{:?}", robot.links()[0].bodies[k].geometry);
            let expected = match shape.contains("ellipsoid") {
                true => lin_canny::Shape::ellipsoid(extents.into()),
                false => lin_canny::Shape::capsule(extents[2] - extents[0], extents[0]),
            };
            assert_eq!(found, format!("{:?}", Geometry::from(expected.expect("a body"))));
        }
    }
    for [shape, words] in cases("faults of shapes") {
        for text in [
            collision(&shape) + &sphere + &sphere,
            sphere.clone() + &collision(&shape) + &sphere,
            sphere.clone() + &sphere + &collision(&shape),
        ] {
            let error = with(&text, "", &plain).expect_err(&shape).to_string();
            assert!(error.contains(&words), "{error} does not say {words}");
        }
    }
}

#[test]
fn a_mesh_that_is_declared_convex_is_its_hull() {
    let options = LoadOptions::default().meshes(MeshUse::Mesh);
    let mesh = |inside: &str| {
        collision(&format!(
            "<mesh filename='package://gripper_arm/finger.obj'>{inside}</mesh>"
        ))
    };
    let (plain, convex) = (mesh(""), mesh("<drake:declare_convex/>"));
    for place in 0..3 {
        let mut collisions = vec![plain.as_str(); 2];
        collisions.insert(place, &convex);
        let robot = with(&collisions.concat(), "", &options).expect("a robot");
        for (k, body) in robot.links()[0].bodies.iter().enumerate() {
            assert_eq!(matches!(body.geometry, Geometry::Mesh(_)), k != place);
            assert!(body.mesh.is_some());
        }
        for options in [
            LoadOptions::default().link_meshes([("a".into(), MeshUse::Mesh)]),
            LoadOptions::default().meshes(MeshUse::Pieces),
        ] {
            assert!(with(&convex, "", &options).is_ok());
        }
    }
    for (inside, words) in [
        ("<drake:declare_convx/>", "did you mean \"drake:declare_convex\"?"),
        ("<declare_convex/>", "unknown element: \"declare_convex\""),
    ] {
        says(with(&mesh(inside), "", &options), words);
    }
}

#[test]
fn other_elements_of_drake_are_passed_over_or_errors_by_what_they_mean() {
    let plain = LoadOptions::default();
    let passed = "<drake:proximity_properties><drake:mu_dynamic value='x'/></drake:proximity_properties>";
    let shape = collision(&format!("{passed}<sphere radius='1'/>"));
    let inside = format!("<collision>{passed}<geometry><sphere radius='1'/></geometry></collision>");
    for other in [
        "",
        "<drake:linear_bushing_rpy><drake:x/></drake:linear_bushing_rpy>",
        "<drake:linear_spring_damper/>",
        "<drake:visual/>",
        "<drake:acceleration/>",
    ] {
        let robot = with(&(shape.clone() + &inside), other, &plain).expect(other);
        assert_eq!(robot.links()[0].bodies.len(), 2);
    }
    says(
        with("", "<drake:mimic joint='j'/>", &plain),
        "joint \"j\" mimic: drake:mimic is not supported",
    );
    says(
        with(&collision("<sphere radius='1'/>"), "<drake:visuals/>", &plain),
        "unknown element: \"drake:visuals\"",
    );
    // The prefix and the namespace are Drake's, each on its own.
    for (declared, prefix) in [
        ("xmlns:drake='urn:other'", "drake"),
        ("xmlns:d='http://drake.mit.edu'", "d"),
        (
            "xmlns='http://drake.mit.edu' xmlns:drake='http://drake.mit.edu'",
            "drake",
        ),
    ] {
        let joint = format!("<{prefix}:joint name='x' type='planar'/>");
        let text = |inside: &str| format!("<robot name='r' {declared}>{inside}<link name='a'/></robot>");
        says(parse(&text(&joint)), "drake:joint is not supported");
        assert!(parse(&text(&format!("<{prefix}:gear_ratio value='2'/>"))).is_ok());
    }
    // Drake takes its prefix without a declaration.
    let error = says(
        parse("<robot name='r'>\n<drake:joint/><link name='a'/></robot>"),
        "drake:joint is not supported",
    );
    assert_eq!(error.line, Some(2), "{error}");
    let robot = parse("<robot name='r'>\n<drake:gear_ratio/><link name='a'/></robot>").expect("a robot");
    let [skipped] = robot.skipped() else {
        panic!("{:?}", robot.skipped())
    };
    assert!(
        skipped.line == Some(2) && skipped.to_string().contains("expected an attribute xmlns:drake"),
        "{skipped}"
    );
}
