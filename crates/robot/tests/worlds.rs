//! Promise: a world that is saved as a cell file and loaded again answers as before, bit for bit; a recording shows it as it
//! is in each frame.

use std::path::Path;

use lin_canny_robot::lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny_robot::lin_canny::{
    Cloud, CloudElement, Compound, ConvexPolyhedron, Geometry, HalfSpace, Mesh, Piece, Shape,
};
use lin_canny_robot::plan::{Cell, CellBody, Checker, ConfigurationSpace, JointTree};
use lin_canny_robot::record::{Cursor, Recording};
use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot, RobotRecorder};
use truth::plans::{self, Furnish, cuboid};
use truth::rng::Rng;

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("worlds/rows.txt"), section)
}

/// An arm of three links, of which one has two bodies, and a tool without bodies.
const ARM: &str = include_str!("worlds/arm.urdf");

/// The setup of the arm with adjacent links excluded.
fn setup() -> Cell {
    let robot = Robot::parse(ARM, "arm.urdf", &Packages::default(), &LoadOptions::default()).expect("an arm");
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    setup
}

fn parse(text: &str) -> Result<CellFile, String> {
    let found = CellFile::parse(text, "cell.json", &Packages::default(), &LoadOptions::default());
    found.map_err(|error| error.to_string())
}

/// The checker of a world that was saved and loaded.
fn reloaded(cell: &Cell) -> Checker<JointTree> {
    let text = CellFile::from_cell(cell).to_json().expect("a world");
    let mut setup = setup();
    parse(&text)
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .add_to(&mut setup)
        .expect("a cell");
    Checker::of_robots(setup.clone()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn pose(rng: &mut Rng, far: f64) -> Isometry3<f64> {
    let mut draw = |most: f64| Vector3::from_fn(|_, _| rng.range(-most, most));
    let turn = UnitQuaternion::from_scaled_axis(draw(3.0));
    let mut pose = Isometry3::from_parts(Translation3::from(draw(far)), turn);
    // A checker takes rotations that are nearly unit.
    if rng.below(2) == 0 {
        let off = turn.coords * (1.0 + 1e-13);
        pose.rotation = UnitQuaternion::new_unchecked(off.into());
    }
    pose
}

/// A geometry of any kind; bounded, if it moves with the robot.
fn geometry(rng: &mut Rng, is_bounded: bool) -> Geometry {
    let mut size = || rng.range(0.05, 0.2);
    let [x, y, z] = [size(), size(), size()];
    let block = cuboid([x, y, z]);
    let kind = rng.below(if is_bounded { 11 } else { 12 });
    let mut points = || -> Vec<Point3<f64>> {
        let draw = |_| Point3::from(Vector3::from_fn(|_, _| rng.range(-0.3, 0.3)));
        (0..12).map(draw).collect()
    };
    match kind {
        0 => Shape::ball(x).expect("a ball").into(),
        1 => Shape::capsule(x, y).expect("a capsule").into(),
        2 => Shape::cylinder(x, y).expect("a cylinder").into(),
        3 => Shape::cone(x, y).expect("a cone").into(),
        4 => Shape::ellipsoid(Vector3::new(x, y, z)).expect("an ellipsoid").into(),
        5 => Mesh::from_convex(&block).expect("a mesh").into(),
        6 => Cloud::new(&points(), CloudElement::Ball(0.3 * x))
            .expect("a cloud")
            .into(),
        7 => {
            let points: Vec<[f32; 3]> = points().iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect();
            let radii = points.iter().map(|p| 0.1 * f64::from(p[0].abs())).collect();
            Cloud::from_f32(&points, CloudElement::Balls(radii))
                .expect("a cloud")
                .into()
        }
        8 => ConvexPolyhedron::from_points(&points()).expect("a hull").into(),
        9 => {
            let mut moved = Piece::new(Shape::from(block.clone()));
            moved.pose = Isometry3::translation(0.3, 0.1, 0.0);
            Compound::new(vec![Piece::new(block), moved])
                .expect("a compound")
                .into()
        }
        10 => block.into(),
        _ => HalfSpace::new(Vector3::new(x - 0.1, y - 0.1, 1.0), -2.0)
            .expect("a half-space")
            .into(),
    }
}

fn sample(rng: &mut Rng) -> Vec<f64> {
    vec![rng.range(-2.5, 2.5), rng.range(-2.5, 2.5), rng.range(0.0, 0.3)]
}

/// Makes random changes, which may be refused: one, or several at once.
fn change(checker: &mut Checker<JointTree>, rng: &mut Rng) {
    if rng.below(14) == 0 {
        let (name, q) = (*rng.pick(&["a", "b", "c", "upper"]), sample(rng));
        let _ = checker.detach_at(name, &q);
        return;
    }
    let mut cell = checker.cell_mut();
    for _ in 0..*rng.pick(&[1, 1, 1, 3]) {
        change_world(&mut cell, rng);
    }
}

fn change_world(cell: &mut Cell, rng: &mut Rng) {
    let names = ["a", "b", "c", "upper", "fore", "hand", "tool", "nobody"];
    let name = *rng.pick(&names[..4]);
    let [one, two] = [*rng.pick(&names), *rng.pick(&names)];
    let all: Vec<CellBody> = cell.bodies().map(|b| b.0).collect();
    let [id, other] = [*rng.pick(&all), *rng.pick(&all)];
    let link = *rng.pick(&names[3..]);
    let _ = match rng.below(14) {
        0 | 1 => cell
            .add_obstacle(name, geometry(rng, false), pose(rng, 1.6))
            .map(|_| ()),
        2 => cell.move_obstacle(name, pose(rng, 1.6)).map(|_| ()),
        3 => cell.move_obstacle(id, pose(rng, 1.6)).map(|_| ()),
        4 => cell.replace_obstacle(id, geometry(rng, false)).map(|_| ()),
        5 => cell
            .remove_obstacle(if rng.below(4) == 0 { name } else { "c" })
            .map(|_| ()),
        6 => cell
            .attach(link, name, geometry(rng, true), pose(rng, 0.2), &[one])
            .map(|_| ()),
        7 => cell.detach(name).map(|_| ()),
        8 => cell.set_margin(*rng.pick(&[0.0, 0.02])),
        9 => cell.pad(one, *rng.pick(&[0.0, 0.01, 0.2])).map(|_| ()),
        10 => cell.pad(id, 0.03).map(|_| ()),
        11 => cell
            .set_pair_margin(one, id, *rng.pick(&[None, Some(0.0), Some(0.05)]))
            .map(|_| ()),
        12 => cell.exclude(one, two).and(cell.exclude(id, other)).map(|_| ()),
        _ => cell.include(one, id).map(|_| ()),
    };
}

/// Returns a text with the ids of one world replaced by those of the same bodies of another.
fn renamed(text: &str, from: &Cell, to: &Cell) -> String {
    let ids = |cell: &Cell| -> Vec<String> { cell.bodies().map(|b| format!("{:?}", b.0)).collect() };
    let pairs: Vec<_> = ids(from).into_iter().zip(ids(to)).collect();
    let (mut found, mut rest) = (String::new(), text);
    while !rest.is_empty() {
        let (step, with) = match pairs.iter().find(|pair| rest.starts_with(&pair.0)) {
            Some((id, with)) => (id.len(), with.as_str()),
            None => {
                let step = rest.chars().next().map_or(1, char::len_utf8);
                (step, &rest[..step])
            }
        };
        found += with;
        rest = &rest[step..];
    }
    found
}

fn judge(sequences: usize, changes: usize, seed: u64) {
    let (mut free, mut removed) = (0, 0);
    for k in 0..sequences {
        let mut rng = Rng::new(seed + k as u64);
        let mut checker = Checker::of_robots(setup()).expect("a checker");
        checker.cell_mut().set_margin(0.02).expect("a margin");
        for step in 0..changes {
            change(&mut checker, &mut rng);
            let mut loaded = reloaded(checker.cell());
            let q = sample(&mut rng);
            let by = [0; 3].map(|_| rng.range(-0.3, 0.3));
            let p = checker.space().moved(&q, &by);
            for question in 0..if step % 8 == 0 { 6 } else { 3 } {
                checker.reset();
                loaded.reset();
                let expected = plans::told(&mut checker, question, &q, &p);
                let told = renamed(
                    &plans::told(&mut loaded, question, &q, &p),
                    loaded.cell(),
                    checker.cell(),
                );
                assert_eq!(told, expected, "{k} {step} {question}");
                free += usize::from(told == "Ok(true)");
            }
            // A world without removed bodies is the same in full.
            let again = reloaded(loaded.cell());
            assert_eq!(format!("{:?}", again.cell()), format!("{:?}", loaded.cell()));
            removed += usize::from(format!("{:?}", checker.cell()) != format!("{:?}", loaded.cell()));
            if rng.below(4) == 0 {
                checker = loaded;
            }
        }
    }
    assert!(free > sequences, "{free} free, {removed} with removed bodies");
    assert!(removed > sequences, "{free} free, {removed} with removed bodies");
}

#[test]
fn a_world_that_was_saved_and_loaded_answers_as_before() {
    judge(10, 100, 100);
}

#[test]
#[ignore = "1,000 sequences of 100 changes: cargo test --release -p lin-canny-robot --test worlds -- --ignored"]
fn a_world_that_was_saved_and_loaded_answers_as_before_1000_times() {
    judge(1000, 100, 10_000);
}

#[test]
fn solids_have_their_names_in_the_file() {
    let mut checker = Checker::of_robots(setup()).expect("a checker");
    let at = Isometry3::translation(0.0, 0.0, 2.0);
    let block = cuboid([0.1, 0.2, 0.3]);
    for (name, geometry) in [
        ("a", Geometry::from(block.clone())),
        ("b", Shape::ball(0.1).expect("a ball").into()),
        ("c", Shape::capsule(0.1, 0.2).expect("a capsule").into()),
        ("d", Shape::cone(0.1, 0.2).expect("a cone").into()),
        ("e", HalfSpace::new(Vector3::z(), -2.5).expect("a half-space").into()),
        ("f", Mesh::from_convex(&block).expect("a mesh").into()),
    ] {
        checker.cell_mut().put(name, geometry, at);
    }
    checker.cell_mut().pad("f", 0.01).expect("a padding");
    checker.cell_mut().pad("a", 0.02).expect("a padding");
    checker.cell_mut().include("upper", "fore").expect("links");
    checker.cell_mut().exclude("hand", "e").expect("bodies");
    checker
        .cell_mut()
        .exclude(CellBody::Robot(1), CellBody::Obstacle(0))
        .expect("bodies");
    let text = CellFile::from_cell(checker.cell()).to_json().expect("a world");
    for part in [
        r#"{"name":"a","box":{"size":[0.2,0.4,0.6]},"xyz":[0.0,0.0,2.0],"xyzw":[0.0,0.0,0.0,1.0]}"#,
        r#""sphere":{"radius":0.1}"#,
        r#""capsule":{"radius":0.2,"length":0.2}"#,
        r#""cone":{"radius":0.2,"length":0.2}"#,
        r#""half_space":{"normal":[0.0,0.0,1.0],"offset":-2.5}"#,
        r#""geometry":{"Mesh":"#,
        r#"["e","hand"]"#,
        r#"[["fore",0],"a"]"#,
        r#"["f",0.01]"#,
        r#"["a",0.02]"#,
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(!text.contains(r#"["fore","upper"]"#), "{text}");
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("saved.json");
    CellFile::from_cell(checker.cell()).save(&file).expect("a file");
    let cell = CellFile::load(&file, &Packages::default(), &LoadOptions::default()).expect("a cell");
    assert_eq!(cell.to_json().expect("a cell"), text);
}

#[test]
fn wrong_worlds_are_named() {
    let body = r#"{"name": "x", "sphere": {"radius": 1}, "xyz": [0, 9, 0]}"#;
    let checker = |more: &str| {
        let mut setup = setup();
        let file = parse(&format!("{{\"bodies\": [{body}, {body}], {more}}}"))?;
        file.add_to(&mut setup).map_err(|error| error.to_string())?;
        Checker::of_robots(setup.clone()).map_err(|error| error.to_string())
    };
    for [more, expected] in cases("wrong worlds") {
        let error = checker(&more).err().unwrap_or_default();
        assert!(error.contains(&expected), "{more}: {error}");
    }
    for [shape, expected] in cases("wrong shapes") {
        let error = parse(&format!("{{\"bodies\": [{{\"name\": \"x\", {shape}}}]}}"))
            .err()
            .unwrap_or_default();
        assert!(error.starts_with("cell.json:1: "), "{error}");
        assert!(error.contains(&expected), "{error}");
    }
    let mut checker = checker(r#""margin": 0.1"#).expect("a checker");
    assert_eq!(checker.cell().margin(), 0.1);
    checker.cell_mut().put(
        "x#3",
        Shape::ball(1.0).expect("a ball"),
        Isometry3::translation(0.0, 9.0, 0.0),
    );
    let mut cell = CellFile::from_cell(checker.cell());
    cell.obstacles[2].pose.translation.x = f64::NAN;
    let error = cell.to_json().err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.starts_with("cell.json: \"x#3\": "), "{error}");
}

#[test]
fn a_recording_shows_the_world_as_it_is_in_each_frame() {
    let mut checker = Checker::of_robots(setup()).expect("a checker");
    let q = [0.0, 0.0, 0.1];
    let at = |x: f64| Isometry3::translation(x, 0.0, 2.0);
    let ball = Geometry::from(Shape::ball(0.1).expect("a ball"));
    checker.cell_mut().put("part", ball.clone(), at(0.0));
    checker.cell_mut().put("post", ball.clone(), at(1.0));
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("changes.jsonl");
    let mut recorder = RobotRecorder::create(&file, &checker, &q).expect("a file");
    let mut frame = |checker: &mut Checker<JointTree>| {
        let near = checker.clearance(&q).expect("a configuration").expect("a pair");
        recorder.frame(checker, &q, "here", &near).expect("a frame");
    };
    frame(&mut checker);
    // The part stays the same body when a link takes it and puts it down.
    checker.cell_mut().remove_obstacle("part").expect("a part");
    checker.cell_mut().carry("tool", "part", ball.clone(), at(0.0), &[]);
    frame(&mut checker);
    checker.detach_at("part", &q).expect("a part");
    checker.cell_mut().move_obstacle("post", at(2.0)).expect("a post");
    frame(&mut checker);
    checker
        .cell_mut()
        .replace_obstacle("post", Shape::ball(0.2).expect("a ball"))
        .expect("a post");
    frame(&mut checker);
    checker.cell_mut().remove_obstacle("part").expect("a part");
    frame(&mut checker);
    recorder.finish().expect("a file");
    let recording = Recording::open(&file).expect("a recording");
    let names: Vec<&str> = recording.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["upper", "fore", "fore", "hand", "part", "post", "post"]);
    let mut cursor = Cursor::default();
    let mut shown = |frame: usize, body: usize| {
        cursor.seek(&recording, frame);
        cursor.poses.get(body).copied().flatten()
    };
    let tool = checker.link_pose("tool", &q).expect("a link");
    let carried = (tool * at(0.0)).translation.vector;
    assert_eq!(shown(0, 4), Some(at(0.0)));
    for frame in [1, 2, 3] {
        let pose = shown(frame, 4).expect("a part");
        assert!((pose.translation.vector - carried).norm() < 1e-12, "{frame}: {pose}");
    }
    assert_eq!(shown(1, 5), Some(at(1.0)));
    assert_eq!(shown(2, 5), Some(at(2.0)));
    assert_eq!(shown(3, 5), None);
    assert_eq!((shown(3, 6), shown(4, 4)), (Some(at(2.0)), None));
}
