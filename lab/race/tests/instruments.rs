//! Every instrument starts and prints its usage; the race `mbm` solves its sample.

use std::process::Command;

#[test]
fn every_instrument_says_how_it_is_used() {
    for (name, program) in [
        ("accuracy_cost", env!("CARGO_BIN_EXE_accuracy_cost")),
        ("corpus", env!("CARGO_BIN_EXE_corpus")),
        ("falling_pile", env!("CARGO_BIN_EXE_falling_pile")),
        ("figures", env!("CARGO_BIN_EXE_figures")),
        ("grade", env!("CARGO_BIN_EXE_grade")),
        ("race", env!("CARGO_BIN_EXE_race")),
        ("soak", env!("CARGO_BIN_EXE_soak")),
    ] {
        let told = Command::new(program).arg("-h").output().expect("a program");
        let text = String::from_utf8_lossy(&told.stdout);
        assert!(
            told.status.success() && text.contains(&format!("Usage: {name}")),
            "{name}: {} {text}",
            told.status
        );
    }
}

/// Runs the race `mbm` with further arguments.
fn mbm(arguments: &[&str]) -> (bool, String) {
    let mut race = Command::new(env!("CARGO_BIN_EXE_race"));
    let out = race.arg("mbm").args(arguments).output().expect("a program");
    let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    (out.status.success(), text)
}

#[test]
fn the_sample_of_mbm_is_solved_and_certified() {
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/mbm");
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [csv, paths] = ["mbm.csv", "paths.jsonl"].map(|name| folder.join(name).to_string_lossy().into_owned());
    // A straight segment through the cage, and the start alone.
    let start = "[0, -0.785, 0, -2.356, 0, 1.571, 0.785]";
    let through = "[1.5, 0.785, 0, -2.356, 0, 1.571, 0.785]";
    let row = |set: &str, path: String| {
        format!("{{\"robot\": \"panda\", \"set\": \"{set}\", \"index\": 1, \"path\": [{path}]}}\n")
    };
    let text = row("box", start.into()) + &row("cage", format!("{start}, {through}"));
    std::fs::write(&paths, text).expect("a file");
    let (ok, text) = mbm(&["--data", sample, "--paths", &paths, "--csv", &csv]);
    assert!(ok, "{text}");
    let table = std::fs::read_to_string(&csv).expect("a table");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(
        table.starts_with("robot,set,index,engine,valid,solved,certified,us,length\n"),
        "{table}"
    );
    let planned: Vec<_> = rows.iter().filter(|row| row[3].starts_with("rrt-connect")).collect();
    assert!(planned.len() >= 14, "{table}");
    assert!(planned.iter().all(|row| row[4..7] == ["1", "1", "1"]), "{table}");
    let of_file: Vec<_> = rows.iter().filter(|row| row[3] == "file hulls").collect();
    let certified: Vec<_> = of_file.iter().map(|row| (row[1], row[6])).collect();
    assert_eq!(certified, [("box", "1"), ("cage", "0")], "{table}");
    assert!(text.contains("panda") && text.contains("median us"), "{text}");
}

#[test]
fn mbm_names_what_is_wrong() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("mbm");
    let set = folder.join("panda/problems/box_panda");
    std::fs::create_dir_all(&set).expect("a folder");
    let data = folder.to_string_lossy().into_owned();
    for (scene, request, part) in [
        (
            "world: {collision_objects: [{id: a, primitives: [{type: cone, dimensions: [1, 1]}], primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]}]}",
            "",
            "object \"a\": primitive Some(\"cone\")",
        ),
        ("world: {}", "", "collision_objects is missing"),
        (
            "world: {collision_objects: []}",
            "start_state: {}",
            "position is missing",
        ),
        ("world: [", "", "scene0001.yaml: line 1"),
    ] {
        let request = if request.is_empty() {
            "start_state: {joint_state: {name: [j], position: [0]}}\ngoal_constraints: [{joint_constraints: [{joint_name: j, position: 1}]}]"
        } else {
            request
        };
        std::fs::write(set.join("scene0001.yaml"), scene).expect("a file");
        std::fs::write(set.join("request0001.yaml"), request).expect("a file");
        let (ok, text) = mbm(&["--data", &data]);
        assert!(!ok && text.contains(part), "{part}: {text}");
    }
    let (ok, text) = mbm(&[]);
    assert!(!ok && text.contains("--data FOLDER is missing"), "{text}");
}
