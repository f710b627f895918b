//! Files changed at random: read or refused by an error, without a panic, and what is read makes a space.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Cell, ConfigurationSpace};
use lin_canny_robot::{CellFile, FileError, LoadOptions, Packages, Robot, Srdf, Trajectory};
use truth::mutants;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).expect(name)
}

/// Reads mutants of a text that stands in a file.
fn read<T>(text: &str, words: &[&str], count: usize, mut reader: impl FnMut(&str) -> Result<T, FileError>) {
    mutants::read(text.as_bytes(), words, count, |bytes| {
        let changed = String::from_utf8_lossy(bytes);
        reader(&changed)
            .map_err(|error| assert!(!error.to_string().is_empty()))
            .is_ok()
    });
}

/// Reads mutants of a robot: each gives an error, of which most have a line, or a robot whose links have finite poses.
fn robots(name: &str, text: &str, words: &[&str], count: usize) {
    let path = folder().join(name);
    let (mut poses, mut state, mut errors) = (Vec::new(), 0.0, [0; 2]);
    read(text, words, count, |changed| {
        let robot = Robot::parse(changed, &path, &Packages::default(), &LoadOptions::default());
        let robot = robot.inspect_err(|error| errors[usize::from(error.line.is_some())] += 1)?;
        assert_eq!(robot.links().len(), robot.joints().len() + 1);
        let mut setup = Cell::new();
        setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
        let Ok(space) = setup.space() else { return Ok(()) };
        let drawn = space.sample(&mut || {
            state = (state + 0.618_033_988_749_894_9) % 1.0;
            state
        });
        for q in [robot.start(), &drawn] {
            space.place(q, &mut poses);
            let is_finite = |p: &Isometry3<f64>| p.to_homogeneous().iter().all(|x| x.is_finite());
            assert!(poses.iter().all(is_finite), "{changed}");
        }
        Ok(())
    });
    assert!(
        errors[1] > errors[0],
        "{name}: {errors:?} errors without and with a line"
    );
}

#[test]
fn changed_urdfs_never_panic() {
    let filter = "<drake:collision_filter_group xmlns:drake=\"http://drake.mit.edu\" name=\"a\" ignore=\"false\">
        <drake:member link=\"base\"/><drake:member link=\"gripper\"/><drake:member_group name=\"a\"/>
        <drake:ignored_collision_filter_group name=\"a\"/></drake:collision_filter_group></robot>";
    let name = "examples/gripper.urdf";
    let words = [
        "mimic joint=\"left\"",
        "gripper",
        "base",
        "planar",
        "floating",
        "continuous",
        "sphere",
    ];
    robots(name, &text(name).replace("</robot>", filter), &words, 3000);
}

#[test]
fn changed_mjcfs_never_panic() {
    for name in ["frames", "pairs", "equality", "meshes"] {
        let name = format!("tests/mujoco/models/{name}.xml");
        let words = ["body", "geom", "frame", "class=\"long\"", "1 2 3 4 5 6 7"];
        robots(&name, &text(&name), &words, 1000);
    }
}

#[test]
fn changed_sdformats_never_panic() {
    let words = [
        "world",
        "__model__",
        "hand",
        "left",
        "arm::hand",
        "elbow_frame",
        "table",
        "fixed",
        "prismatic",
        "true",
        "1.4",
        "relative_to=\"hand\"",
        "attached_to=\"left\"",
    ];
    let marked = text("tests/sdformat/marked.xml").replace("part.stl", "../../examples/gripper_arm/finger.obj");
    let part = Path::new(env!("CARGO_TARGET_TMPDIR")).join("part.sdf");
    let model = "<sdf version=\"1.9\"><model name=\"m\"><link name=\"a\"/></model></sdf>";
    std::fs::write(&part, model).expect("a file");
    let include = format!("<include><uri>file://{}</uri><name>i</name></include>", part.display());
    let marked = marked.replacen("@model@", &include, 1);
    let marks = |line: &&str| !line.starts_with('@');
    let marked: String = marked.lines().filter(marks).collect::<Vec<_>>().join("\n");
    for (name, text) in [
        ("examples/bench.sdf", text("examples/bench.sdf")),
        ("tests/sdformat/marked.sdf", marked),
    ] {
        robots(name, &text, &words, 2500);
        let path = folder().join(name);
        read(&text, &words, 2500, |changed| {
            CellFile::parse(changed, &path, &Packages::default(), &LoadOptions::default())
        });
    }
}

#[test]
fn changed_cells_srdfs_and_trajectories_never_panic() {
    let robot = Robot::load(folder().join("examples/gripper.urdf"), &Packages::default()).expect("the example");
    let path = folder().join("examples/changed");
    let words = ["gripper", "base", "planar", "floating", "sphere"];
    read(&text("examples/cell.json"), &words, 3000, |changed| {
        CellFile::parse(changed, &path, &Packages::default(), &LoadOptions::default())
    });
    let groups = "<group name=\"hand\"><link name=\"gripper\"/><joint name=\"left\"/></group>
        <group name=\"all\"><group name=\"arm\"/><group name=\"hand\"/></group>
        <group_state name=\"home\" group=\"arm\"><joint name=\"lift\" value=\"0.5\"/><joint name=\"elbow\" value=\"1\"/></group_state>
        <virtual_joint name=\"v\" type=\"planar\" parent_frame=\"w\" child_link=\"base\"/></robot>";
    let srdf = text("examples/gripper.srdf").replace("</robot>", groups);
    read(&srdf, &words, 3000, |changed| Srdf::parse(changed, &path, &robot));
    read(&text("examples/carry.csv"), &words, 3000, |changed| {
        let trajectory = Trajectory::parse(changed, &path, robot.coordinates())?;
        assert!(trajectory.rows.iter().flatten().all(|x| x.is_finite()));
        Ok(())
    });
    let names: Vec<String> = robot.coordinates().iter().map(|c| format!("\"{}\"", c.name)).collect();
    let zeros = vec!["0.01"; names.len()].join(", ");
    let point = |t: u32| format!("{{\"positions\": [{zeros}], \"velocities\": [{zeros}], \"time_from_start\": {t}}}");
    let (first, last) = (point(0), point(1));
    let message = format!(
        "{{\"joint_names\": [{}], \"points\": [{first}, {last}]}}",
        names.join(", ")
    );
    let block = format!("joint_names:\n- {}\npoints:\n- {first}\n- {last}\n", names.join("\n- "));
    for (text, extension) in [(message, "json"), (block, "yaml")] {
        let path = path.with_extension(extension);
        read(&text, &words, 3000, |changed| {
            let trajectory = Trajectory::parse_timed(changed, &path, robot.coordinates(), &[])?;
            // An error of the numbers is no panic.
            let _ = trajectory.curves();
            Ok(())
        });
    }
}
