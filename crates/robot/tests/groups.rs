//! Groups, states and virtual joints of an SRDF, with a fault in every place it can stand.

use lin_canny_robot::{FileError, FileErrorKind, LoadOptions, MotionKind, Packages, Robot, Srdf};

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("groups/rows.txt"), section)
}

/// A tree: base - torso - left arm - left hand, and torso - right arm - right hand - right thumb,
/// where the thumb mimics the hand. A cart floats, a puck slides, a flag is fixed.
fn robot() -> Robot {
    let joint = |name: &str, kind: &str, parent: &str, more: &str| {
        let child = name.trim_start_matches("j ");
        format!(
            "<link name='{child}'/><joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{more}</joint>"
        )
    };
    let joints = [
        joint("j torso", "prismatic", "base", "<limit lower='-1' upper='1'/>"),
        joint("j left arm", "continuous", "torso", ""),
        joint("j left hand", "continuous", "left arm", ""),
        joint("j right arm", "continuous", "torso", ""),
        joint("j right hand", "continuous", "right arm", ""),
        joint("j thumb", "continuous", "right hand", "<mimic joint='j right hand'/>"),
        joint("j cart", "floating", "base", ""),
        joint("j puck", "planar", "base", ""),
        joint("j flag", "fixed", "base", ""),
    ];
    let text = format!("<robot name='r'><link name='base'/>{}</robot>", joints.concat());
    Robot::parse(&text, "r.urdf", &Packages::default(), &LoadOptions::default()).expect("a robot")
}

/// Reads elements, each in a line of its own from line 2 on.
fn read(elements: &[&str]) -> Result<Srdf, FileError> {
    let text = format!("<robot name='r'>\n{}\n</robot>", elements.join("\n"));
    Srdf::parse(&text, "r.srdf", &robot())
}

const GOOD: [&str; 3] = [
    "<group name='left'><chain base_link='torso' tip_link='left hand'/></group>",
    "<group_state name='home' group='left'><joint name='j left arm' value='0.5'/></group_state>",
    "<virtual_joint name='ground' type='fixed' parent_frame='world' child_link='base'/>",
];

/// Returns what is read from an element in the first, a middle and the last place, with its line.
fn in_places(element: &str) -> impl Iterator<Item = (Result<Srdf, FileError>, u32)> {
    [0, 1, 3].into_iter().map(move |place| {
        let mut elements = GOOD.to_vec();
        elements.insert(place, element);
        (read(&elements), place as u32 + 2)
    })
}

/// An element is an error whose text has these words, wherever it is.
fn wrong(element: &str, words: &str) {
    for (found, line) in in_places(element) {
        let error = found.expect_err(element);
        assert_eq!(error.line, Some(line), "{error}");
        assert!(error.to_string().contains(words), "{error} does not say {words}");
    }
}

/// An element is read, and one part of it is skipped for this reason.
fn skipped(element: &str, words: &str) -> Srdf {
    let mut last = None;
    for (found, line) in in_places(element) {
        let srdf = found.expect(element);
        let [one] = &srdf.skipped[..] else {
            panic!("{element}: {:?}", srdf.skipped)
        };
        assert_eq!(one.line, Some(line), "{one}");
        assert!(one.to_string().contains(words), "{one} does not say {words}");
        last = Some(srdf);
    }
    last.expect("a file")
}

fn group(srdf: &Srdf, name: &str) -> (String, String) {
    let group = srdf.groups.iter().find(|group| group.name == name).expect(name);
    (group.links.join(", "), group.joints.join(", "))
}

#[test]
fn groups_have_the_links_and_joints_of_their_elements() {
    for [inside, links, joints] in cases("groups") {
        for (found, _) in in_places(&format!("<group name='g'>{inside}</group>")) {
            let srdf = found.expect(&inside);
            assert!(srdf.skipped.is_empty(), "{:?}", srdf.skipped);
            // Links and joints are in the order of the robot: breadth first.
            assert_eq!(group(&srdf, "g"), (links.clone(), joints.clone()), "{inside}");
            assert_eq!(group(&srdf, "left").0, "torso, left arm, left hand");
        }
    }
}

#[test]
fn groups_inside_groups_are_flattened_in_any_order() {
    let groups = [
        "<group name='all'><group name='arms'/><group name='extra'/></group>",
        "<group name='arms'><group name='left'/><group name='right'/><group name='left'/></group>",
        "<group name='right'><chain base_link='torso' tip_link='right arm'/></group>",
        "<group name='extra'><link name='flag'/><group name='right'/></group>",
        GOOD[0],
    ];
    for turn in 0..groups.len() {
        let mut turned = groups.to_vec();
        turned.rotate_left(turn);
        let srdf = read(&turned).expect("an SRDF");
        assert!(srdf.skipped.is_empty(), "{:?}", srdf.skipped);
        let names: Vec<&str> = srdf.groups.iter().map(|group| group.name.as_str()).collect();
        assert_eq!(names[(groups.len() - turn) % groups.len()], "all");
        let (links, joints) = group(&srdf, "all");
        assert_eq!(links, "torso, flag, left arm, right arm, left hand");
        assert_eq!(joints, "j flag, j left arm, j right arm, j left hand");
        assert_eq!(group(&srdf, "extra").1, "j flag, j right arm");
        assert_eq!(group(&srdf, "right").0, "torso, right arm");
    }
    // A deep chain of groups neither overflows the stack nor loses its end.
    let mut deep: Vec<String> = (0..3000)
        .map(|k| format!("<group name='g{k}'><group name='g{}'/></group>", k + 1))
        .collect();
    deep.push("<group name='g3000'><link name='thumb'/></group>".into());
    let srdf = read(&deep.iter().map(String::as_str).collect::<Vec<_>>()).expect("an SRDF");
    assert_eq!(group(&srdf, "g0").0, "thumb");
}

#[test]
fn cycles_of_groups_are_errors_that_name_the_cycle() {
    wrong(
        "<group name='g'><group name='g'/></group>",
        "group \"g\": contains itself: g (",
    );
    let cycle = [
        "<group name='before'><group name='a'/></group>",
        "<group name='a'><link name='base'/><group name='left'/><group name='b'/></group>",
        GOOD[0],
        "<group name='b'><group name='c'/></group>",
        "<group name='c'><group name='left'/><group name='a'/></group>",
    ];
    let error = read(&cycle).expect_err("a cycle");
    assert_eq!(
        error.to_string(),
        "r.srdf:3: group \"a\": contains itself: a, b, c (expected groups without cycles)"
    );
    assert!(matches!(error.reason, FileErrorKind::GroupLoop(_)));
    assert!(read(&cycle[..4]).is_ok_and(|srdf| srdf.skipped.len() == 1));
}

#[test]
fn names_that_do_not_exist_are_skipped_with_their_line() {
    for [element, words] in cases("names that do not exist") {
        let known = ["<link name='thumb'/>", "<joint name='j cart'/>"];
        for at in 0..3 {
            let mut inside = known.to_vec();
            inside.insert(at, &element);
            let srdf = skipped(&format!("<group name='g'>{}</group>", inside.concat()), &words);
            assert_eq!(group(&srdf, "g"), ("cart, thumb".into(), "j cart, j thumb".into()));
        }
    }
    let value = "<joint name='j left arm' value='1'/>";
    for state in [
        format!("<joint name='gone' value='0 0 0 0 0 0 1'/>{value}"),
        format!("{value}<joint name='gone' value='1'/>"),
    ] {
        let state = format!("<group_state name='s' group='left'>{state}</group_state>");
        let srdf = skipped(
            &state,
            "group_state \"s\" joint \"gone\": joint \"gone\" does not exist",
        );
        assert_eq!(srdf.state("s").expect("a state").values, [("j left arm".into(), 1.0)]);
    }
    // The values of a state do not depend on its group.
    let state = format!("<group_state name='s' group='lef'>{value}</group_state>");
    let srdf = skipped(&state, "group \"lef\" does not exist; did you mean \"left\"?");
    assert_eq!(srdf.state("lef/s").expect("a state").values.len(), 1);
    let joint = "<virtual_joint name='v' type='planar' parent_frame='world' child_link='bass'/>";
    let srdf = skipped(joint, "link \"bass\" does not exist; did you mean \"base\"?");
    assert_eq!(srdf.virtual_joints.len(), 1);
    // A virtual joint has no value, because it does not move the robot.
    skipped(
        "<group_state name='s' group='left'><joint name='ground' value='1'/></group_state>",
        "joint \"ground\" does not exist",
    );
    // In the order of the file.
    let srdf = read(&[
        "<group_state name='s' group='none'/>",
        "<disable_collisions link1='base' link2='none'/>",
        "<group name='g'><link name='none'/></group>",
        "<virtual_joint name='v' type='planar' parent_frame='world' child_link='none'/>",
    ]);
    let lines: Vec<_> = srdf.expect("an SRDF").skipped.iter().map(|one| one.line).collect();
    assert_eq!(lines, [2, 3, 4, 5].map(Some));
}

#[test]
fn states_have_the_values_of_coordinates() {
    let state = "<group_state name='s' group='left'>
        <joint name='j torso' value='7'/><joint name=' j left arm ' value=' -1.5 '/><joint name='j thumb' value='9'/>
        <joint name='j flag' value='0 0 0 0 0 0 1'/><joint name='j puck' value='1 2 3'/>
        <joint name='j cart' value='4 5 6 0 0 2 2'/></group_state>";
    let srdf = read(&[GOOD[0], state]).expect("an SRDF");
    let half = std::f64::consts::FRAC_PI_2;
    let state = &srdf.states[0];
    assert_eq!((state.name.as_str(), state.group.as_str()), ("s", "left"));
    let expected = [
        ("j torso", 7.0),
        ("j left arm", -1.5),
        ("j puck/x", 1.0),
        ("j puck/y", 2.0),
        ("j puck/theta", 3.0),
        ("j cart/x", 4.0),
        ("j cart/y", 5.0),
        ("j cart/z", 6.0),
        ("j cart/roll", 0.0),
        ("j cart/pitch", 0.0),
        ("j cart/yaw", half),
    ];
    assert_eq!(state.values.len(), expected.len());
    let robot = robot();
    for ((name, value), (known, number)) in state.values.iter().zip(expected) {
        assert!(name == known && (value - number).abs() < 1e-15, "{name} {value}");
        assert!(robot.coordinates().iter().any(|c| c.name == *name), "{name}");
    }
}

#[test]
fn states_are_found_by_their_names() {
    let state = |name: &str, group: &str| format!("<group_state name='{name}' group='{group}'/>");
    let mut elements: Vec<String> = ["left", "right"].map(|name| format!("<group name='{name}'/>")).into();
    elements.extend([state("home", "left"), state("home", "right"), state("up", "right")]);
    elements.push("<group_state name='alone'/>".into());
    let srdf = read(&elements.iter().map(String::as_str).collect::<Vec<_>>()).expect("an SRDF");
    for (name, group) in [
        ("left/home", "left"),
        ("right/home", "right"),
        ("up", "right"),
        ("right/up", "right"),
        ("alone", ""),
    ] {
        assert_eq!(srdf.state(name).expect(name).group, group);
    }
    for [name, words] in cases("faults of names of states") {
        assert!(
            srdf.state(&name).expect_err(&name).to_string().starts_with(&words),
            "{name}"
        );
    }
}

#[test]
fn virtual_joints_are_read() {
    for (name, kind) in [
        ("fixed", MotionKind::Fixed),
        ("planar", MotionKind::Planar),
        ("floating", MotionKind::Floating),
    ] {
        let element = format!("<virtual_joint name='v' type='{name}' parent_frame='odom' child_link=' base '/>");
        for (found, line) in in_places(&element) {
            let srdf = found.expect(name);
            let joint = &srdf.virtual_joints[usize::from(line == 5)];
            assert_eq!((joint.name.as_str(), joint.kind), ("v", kind));
            assert_eq!(joint.parent_frame.as_str(), "odom");
            assert_eq!(joint.child_link.as_str(), "base");
        }
    }
}

#[test]
fn what_tinyxml_takes_is_listed() {
    let text = "group \"g\": text between elements (\"text\")";
    let prefix = "undeclared prefix: \"moveit\"";
    assert_eq!(skipped("<group name='g'>text</group>", text).groups.len(), 2);
    assert_eq!(skipped("<!-- ---- -->", "\"--\" in a comment").groups.len(), 1);
    assert_eq!(skipped("<moveit:x/><moveit:y/>", prefix).groups.len(), 1);
}

#[test]
fn faults_are_errors_with_their_line() {
    for [element, words] in cases("faults") {
        wrong(&element, &words);
    }
    for [joint, values, words] in cases("faults of values") {
        let good = "<joint name='j left arm' value='1'/><joint name='j left hand' value='2'/>";
        let bad = format!("<joint name='{joint}' value='{values}'/>");
        for inside in [format!("{bad}{good}"), format!("{good}{bad}")] {
            wrong(
                &format!("<group_state name='s' group='left'>{inside}</group_state>"),
                &words,
            );
        }
    }
    let twice = "<joint name='j torso' value='0'/>";
    wrong(
        &format!("<group_state name='s' group='left'>{twice}{twice}</group_state>"),
        "joint \"j torso\": name is already in use",
    );
    // The second of two elements with one name is in the last place.
    for element in GOOD {
        let again = read(&[&GOOD[..], &[element]].concat()).expect_err(element);
        assert!(matches!(again.reason, FileErrorKind::Repeated), "{again}");
        assert!(again.line == Some(5), "{again}");
    }
}
