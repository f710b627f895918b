//! The program behind the example of studies: an arm of six axes with links of hulls, among 40 bodies. `LIN_CANNY_WRITE=1` writes its
//! files again.

use lin_canny_robot::plan::Checker;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use lin_canny_robot::lin_canny::ConvexPolyhedron;
use lin_canny_robot::lin_canny::nalgebra::Point3;
use lin_canny_robot::{LoadedCell, RobotFiles};

type Trouble = Box<dyn std::error::Error>;

/// A link: its name, its radius, and how far it reaches along z.
const LINKS: [(&str, f64, [f64; 2]); 7] = [
    ("base", 0.11, [0.0, 0.12]),
    ("shoulder", 0.09, [0.0, 0.26]),
    ("upper_arm", 0.07, [-0.05, 0.50]),
    ("forearm", 0.055, [-0.04, 0.40]),
    ("wrist_1", 0.045, [0.0, 0.16]),
    ("wrist_2", 0.042, [-0.04, 0.12]),
    ("gripper", 0.05, [0.0, 0.12]),
];

/// A joint: its name, how far above the joint before it stands, its axis, and its limit on both sides.
const JOINTS: [(&str, f64, &str, f64); 6] = [
    ("turn", 0.12, "0 0 1", 2.9),
    ("lift", 0.20, "0 1 0", 1.8),
    ("elbow", 0.45, "0 1 0", 2.6),
    ("roll", 0.40, "0 0 1", 2.9),
    ("bend", 0.15, "0 1 0", 2.2),
    ("twist", 0.11, "0 0 1", 2.9),
];

/// Corners of a link all around.
const SIDES: u32 = 24;

/// The files by their names in `examples`.
fn files() -> Result<Vec<(String, String)>, Trouble> {
    let mut files = vec![
        ("six_axis.urdf".to_owned(), urdf()?),
        ("six_axis_cell.json".to_owned(), cell()),
    ];
    for &(name, radius, reach) in &LINKS {
        files.push((format!("six_axis/{name}.obj"), link(radius, reach)?.to_obj()));
    }
    Ok(files)
}

#[test]
fn examples_are_what_this_program_makes() -> Result<(), Trouble> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for (name, text) in files()? {
        let file = folder.join(&name);
        if std::env::var_os("LIN_CANNY_WRITE").is_some() {
            fs::write(&file, &text)?;
        }
        assert!(
            fs::read_to_string(&file)? == text,
            "{name} is not what LIN_CANNY_WRITE=1 writes"
        );
    }
    Ok(())
}

#[test]
fn forty_bodies_stand_about_six_axes() -> Result<(), Trouble> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files = RobotFiles::new(folder.join("six_axis.urdf"));
    files.cell = Some(folder.join("six_axis_cell.json"));
    files.srdf = Some(folder.join("six_axis.srdf"));
    let LoadedCell { robot, cell: setup, .. } = files.load()?;
    assert_eq!((robot.coordinates().len(), robot.links().len()), (6, 7));
    let mut checker = Checker::of_robots(setup.clone())?;
    assert_eq!(checker.cell().obstacles().len(), 40);
    let near = checker.clearance(&[0.0; 6])?.ok_or("no pair")?;
    assert!(near.lower > 0.0, "upright, the arm is free: {near:?}");
    Ok(())
}

/// A rod with bevelled ends.
fn link(radius: f64, [low, high]: [f64; 2]) -> Result<ConvexPolyhedron, Trouble> {
    // A tenth of a millimetre is what the files show.
    let rounded = |x: f64| (x * 1e4).round() / 1e4;
    let bevel = 0.3 * radius;
    let rings = [
        (radius - bevel, low),
        (radius, low + bevel),
        (radius, high - bevel),
        (radius - bevel, high),
    ];
    let corner = |(r, z): (f64, f64), k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SIDES);
        Point3::new(rounded(r * angle.cos()), rounded(r * angle.sin()), rounded(z))
    };
    let ring = |ring| (0..SIDES).map(move |k| corner(ring, k));
    let points: Vec<_> = rings.into_iter().flat_map(ring).collect();
    Ok(ConvexPolyhedron::from_points(&points)?)
}

fn urdf() -> Result<String, Trouble> {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<robot name=\"six_axis\">\n");
    for (name, ..) in LINKS {
        writeln!(
            text,
            "  <link name=\"{name}\"><collision><geometry><mesh filename=\"six_axis/{name}.obj\"/></geometry></collision></link>"
        )?;
    }
    for (k, (name, height, axis, limit)) in JOINTS.into_iter().enumerate() {
        let (parent, child) = (LINKS[k].0, LINKS[k + 1].0);
        writeln!(
            text,
            "  <joint name=\"{name}\" type=\"revolute\">\n    <parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"0 0 {height}\"/><axis xyz=\"{axis}\"/>\n    \
             <limit lower=\"-{limit}\" upper=\"{limit}\" effort=\"100\" velocity=\"2\"/>\n  </joint>"
        )?;
    }
    Ok(text + "</robot>\n")
}

/// Boxes: the name, the size, the centre and the turn about z.
type Block = (String, [f64; 3], [f64; 3], f64);

/// Five boards without a lid.
fn bin(name: &str, [x, y, z]: [f64; 3], turn: f64) -> Vec<Block> {
    let (sin, cos) = f64::sin_cos(turn);
    let board = |part: &str, size, [u, v, w]: [f64; 3]| {
        let centre = [x + cos * u - sin * v, y + sin * u + cos * v, z + w];
        (format!("{name} {part}"), size, centre, turn)
    };
    vec![
        board("floor", [0.40, 0.30, 0.01], [0.0, 0.0, 0.005]),
        board("left", [0.40, 0.01, 0.20], [0.0, 0.155, 0.10]),
        board("right", [0.40, 0.01, 0.20], [0.0, -0.155, 0.10]),
        board("front", [0.01, 0.32, 0.20], [0.205, 0.0, 0.10]),
        board("back", [0.01, 0.32, 0.20], [-0.205, 0.0, 0.10]),
    ]
}

fn blocks() -> Vec<Block> {
    let block = |name: &str, size, centre| (name.to_owned(), size, centre, 0.0);
    let mut all = vec![
        block("floor", [3.0, 3.0, 0.05], [0.0, 0.0, -0.025]),
        block("table", [0.5, 1.2, 0.04], [0.65, 0.0, 0.28]),
        block("conveyor", [0.4, 2.4, 0.30], [-0.75, 0.0, 0.15]),
        block("rail left", [0.03, 2.4, 0.05], [-0.56, 0.0, 0.325]),
        block("rail right", [0.03, 2.4, 0.05], [-0.94, 0.0, 0.325]),
        block("cabinet", [0.5, 0.4, 1.1], [1.1, 1.1, 0.55]),
        block("camera boom", [0.05, 1.1, 0.05], [0.65, 0.55, 1.35]),
        block("camera", [0.10, 0.12, 0.10], [0.65, 0.0, 1.30]),
        block("lamp", [0.06, 1.6, 0.06], [-0.2, 0.0, 1.65]),
    ];
    for (k, (x, y)) in [(1.4, 1.4), (-1.4, 1.4), (-1.4, -1.4), (1.4, -1.4)]
        .into_iter()
        .enumerate()
    {
        all.push(block(&format!("post {k}"), [0.06, 0.06, 1.8], [x, y, 0.9]));
    }
    for (k, (size, centre)) in [
        ([2.8, 0.02, 1.6], [0.0, 1.4, 0.9]),
        ([2.8, 0.02, 1.6], [0.0, -1.4, 0.9]),
        ([0.02, 2.8, 1.6], [1.4, 0.0, 0.9]),
        ([0.02, 2.8, 1.6], [-1.4, 0.0, 0.9]),
    ]
    .into_iter()
    .enumerate()
    {
        all.push(block(&format!("fence {k}"), size, centre));
    }
    all.extend(bin("bin a", [0.65, 0.35, 0.30], 0.2));
    all.extend(bin("bin b", [0.65, -0.30, 0.30], -0.1));
    for (k, height) in [0.4, 0.75, 1.1].into_iter().enumerate() {
        all.push(block(&format!("board {k}"), [0.9, 0.3, 0.02], [0.0, -0.85, height]));
    }
    all.push(block("shelf left", [0.02, 0.3, 1.2], [-0.46, -0.85, 0.6]));
    all.push(block("shelf right", [0.02, 0.3, 1.2], [0.46, -0.85, 0.6]));
    for k in 0..8u32 {
        let at = |m: u32, low: f64, step: f64| low + step * f64::from(m);
        // On the conveyor, on the shelf.
        let centre = match k {
            0..4 => [-0.75, at(k, -0.6, 0.4), 0.35],
            _ => [at(k - 4, -0.3, 0.2), -0.85, 0.81],
        };
        all.push((format!("part {k}"), [0.08, 0.12, 0.10], centre, at(k, 0.0, 0.35)));
    }
    all
}

fn cell() -> String {
    let mut lines = Vec::new();
    for (name, [a, b, c], [x, y, z], turn) in blocks() {
        lines.push(format!(
            "    {{\"name\": \"{name}\", \"box\": {{\"size\": [{a}, {b}, {c}]}}, \"xyz\": [{x:.4}, {y:.4}, {z:.4}], \
             \"rpy\": [0, 0, {turn:.4}]}}"
        ));
    }
    let exclude = "  \"exclude\": [[\"base\", \"floor\"], [\"shoulder\", \"floor\"]]";
    format!("{{\n  \"bodies\": [\n{}\n  ],\n{exclude}\n}}\n", lines.join(",\n"))
}
