//! Readers of files: arbitrary bytes are read, or are an error, without a panic, without a hang and
//! in memory that grows with their number.
//!
//! The first byte of an input names the format; the rest is the file. The memory is counted if
//! [`PeakAlloc`] is the global allocator of the program, and no other thread allocates.

use std::sync::LazyLock;
use std::time::{Duration, Instant};

use lin_canny::scene::Scene;
use lin_canny::{Geometry, Mesh, MeshKind, PairTracker, PointQuery, QueryOptions, RelativePose, RepairOptions, Replay};
use lin_canny_formats::{Grid, Invalid, MeshFile, PointFile};
use lin_canny_plan::{Cell, Checker, ConfigurationSpace, JointCurve, RangeAnswer};
use lin_canny_robot::record::{Cursor, Recording};
use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot, Srdf, Trajectory, csv_text};
use nalgebra::{Isometry3, Point3, Vector3};
pub use peak_alloc::PeakAlloc;

/// Most bytes that a reader may hold at a time: so many, and so many for each byte of the file.
const MEMORY: (usize, usize) = (4 << 20, 400);

/// Most bytes of what a short file may ask for: repeated instances, copies, and excluded pairs.
const REPEATED: usize = 128 << 20;

/// Words of the files that may ask for them: COLLADA, glTF as JSON and GLB, MJCF, SDFormat.
const REPEATING: [&str; 5] = ["COLLADA", "asset", "glTF", "mujoco", "sdf"];

/// Most triangles of a mesh that is repaired.
const REPAIRED: usize = 10_000;

/// Longest time of a reader, in debug builds and on a busy machine.
const TIME: Duration = Duration::from_secs(10);

/// Most letters of an error of a mesh or point file.
const MESSAGE: usize = 1_000;

/// The first byte and the extension of mesh files.
const MESHES: [(u8, &str); 7] = [
    (b'b', "glb"),
    (b'd', "dae"),
    (b'g', "gltf"),
    (b'm', "msh"),
    (b'o', "obj"),
    (b'p', "ply"),
    (b's', "stl"),
];

/// The first byte and the extension of point files.
const POINTS: [(u8, &str); 4] = [(b'c', "pcd"), (b'n', "npy"), (b'p', "ply"), (b'x', "xyz")];

/// A file in a folder that does not exist, so that no other file is found next to it.
const FILE: &str = "/no folder/file";

/// What is in the root folder, each with a slash before it. Files outside the folder of [`FILE`]
/// have one of these in their path, whether it is absolute or names a package.
static ROOT: LazyLock<Vec<String>> = LazyLock::new(|| {
    let entries = std::fs::read_dir("/").into_iter().flatten().flatten();
    entries
        .map(|entry| format!("/{}", entry.file_name().to_string_lossy()))
        .collect()
});

/// The robot of SRDF files and trajectories.
static ROBOT: LazyLock<Robot> = LazyLock::new(|| {
    let link =
        |k: usize| format!("<link name='l{k}'><collision><geometry><sphere radius='1'/></geometry></collision></link>");
    let joint = |k: usize, kind: &str| {
        let ends = format!("<parent link='l{}'/><child link='l{k}'/>", k - 1);
        format!("<joint name='j{k}' type='{kind}'>{ends}<limit lower='-2' upper='2'/></joint>")
    };
    let links: String = (0..4).map(link).collect();
    let joints = joint(1, "revolute") + &joint(2, "prismatic") + &joint(3, "floating");
    let text = format!("<robot name='r'>{links}{joints}</robot>");
    Robot::parse(&text, FILE, &Packages::default(), &LoadOptions::default()).expect("a robot")
});

/// Reads a mesh file.
///
/// # Panics
/// Panics if a mesh has an index out of range, a point that is not finite or not used, or no
/// triangle, if the repaired mesh is open, or if time or memory are out of bounds.
pub fn meshes(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let Some((_, extension)) = MESHES.iter().find(|(letter, _)| letter == first) else {
        return;
    };
    let file = match bounded(bytes, || MeshFile::parse(bytes, format!("{FILE}.{extension}"))) {
        Ok(file) => file,
        Err(error) => {
            let letters = error.to_string().chars().count();
            return assert!((1..=MESSAGE).contains(&letters), "{letters} letters: {error}");
        }
    };
    assert!(!file.objects.is_empty());
    for object in &file.objects {
        let mut is_used = vec![false; object.points.len()];
        object
            .triangles
            .iter()
            .flatten()
            .for_each(|&k| is_used[k as usize] = true);
        assert!(!object.triangles.is_empty() && is_used.iter().all(|is| *is));
        assert!(object.points.iter().flatten().all(|x| x.is_finite()));
    }
    assert!(file.skipped.iter().all(|skipped| !skipped.what.is_empty()));
    repair(&file, f64::from(*first % 3) * 0.01);
}

/// Repairs a mesh that is not too large.
fn repair(file: &MeshFile, weld: f64) {
    let (points, triangles) = file.whole();
    if triangles.len() > REPAIRED {
        return;
    }
    let points: Vec<_> = points.into_iter().map(Point3::from).collect();
    let options = RepairOptions::default().weld(weld);
    if let Ok(mesh) = Mesh::repaired(&points, &triangles, &options) {
        assert_eq!(mesh.kind(), MeshKind::Solid);
        let repair = mesh.report().repair.as_deref().expect("a repaired mesh");
        assert!((0.0..=1.0).contains(&repair.cap_share), "{repair}");
        let middle = mesh
            .vertices()
            .iter()
            .fold(Vector3::zeros(), |sum, p| sum + p.coords / mesh.vertex_count() as f64);
        let winding = PointQuery::new(&mesh).winding_number(&Point3::from(middle));
        assert!(
            winding.is_ok_and(|w| w.is_none_or(|w| w == 0 || !repair.is_empty)),
            "{repair}"
        );
    }
}

/// Reads a grid.
///
/// # Panics
/// Panics if a number is not finite or the shape is not that of the numbers, or if time or memory
/// are out of bounds.
fn grid(bytes: &[u8], path: &str) {
    match bounded(bytes, || Grid::parse(bytes, path)) {
        Ok(grid) => {
            assert!(!grid.values.is_empty() && grid.values.len() == grid.rows * grid.columns);
            assert!(grid.values.iter().all(|x| x.is_finite()));
        }
        Err(error) => {
            let letters = error.to_string().chars().count();
            assert!((1..=MESSAGE).contains(&letters), "{letters} letters: {error}");
        }
    }
}

/// Reads a point file, and the same bytes as a grid.
///
/// # Panics
/// Panics if a point or a radius is not finite, if there is no point, if files whose points all have
/// a return are refused or others are not, or if time or memory are out of bounds.
pub fn points(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let Some((_, extension)) = POINTS.iter().find(|(letter, _)| letter == first) else {
        return;
    };
    let path = format!("{FILE}.{extension}");
    if matches!(*extension, "npy" | "xyz") {
        grid(bytes, &path);
    }
    let file = bounded(bytes, || PointFile::parse(bytes, &path));
    let strict = bounded(bytes, || PointFile::parse_with(bytes, &path, Invalid::Refuse));
    for error in [&file, &strict].into_iter().filter_map(|file| file.as_ref().err()) {
        let letters = error.to_string().chars().count();
        assert!((1..=MESSAGE).contains(&letters), "{letters} letters: {error}");
    }
    let Ok(file) = file else {
        return assert!(strict.is_err());
    };
    assert_eq!(strict.is_ok(), file.dropped == 0);
    let points = file.points.to_f64();
    assert!(!points.is_empty() && points.as_flattened().iter().all(|x| x.is_finite()));
    let radii = file.radii.as_deref().unwrap_or_default();
    assert!(radii.is_empty() || radii.len() == points.len());
    assert!(radii.iter().all(|radius| *radius >= 0.0 && radius.is_finite()));
    assert!(file.skipped.iter().all(|skipped| !skipped.what.is_empty()));
}

/// Reads a file of a robot: URDF, MJCF, SDFormat as robot or cell, SRDF, the JSON of a cell, the CSV
/// of a trajectory, or the CSV, JSON or YAML of a timed one. A text that names something in the root
/// folder is not read.
///
/// # Panics
/// Panics if what was read forms no finite configuration space, if what is written is not read
/// again as it was, or if time or memory are out of bounds.
pub fn robots(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    LazyLock::force(&ROBOT);
    let text = &String::from_utf8_lossy(bytes);
    // The end of an element is not a path.
    let paths = text.replace("</", "<");
    if ROOT.iter().any(|name| paths.contains(name)) {
        return;
    }
    match first {
        b'u' | b'm' | b'w' => robot(text),
        b's' => srdf(text),
        b'c' | b'f' => cell(text),
        b't' => trajectory(text),
        b'i' => timed(text, "csv"),
        b'j' => timed(text, "json"),
        b'y' => timed(text, "yaml"),
        _ => {}
    }
}

/// Reads what was saved: `l` a recording, `r` a replay; as JSON `g` a geometry, `s` a scene, `q` a
/// curve, `w` a world of the planner, `a` an answer over a range; `v` a receipt, which is checked.
///
/// # Panics
/// Panics if what was read is inconsistent, if what is written is not read again as it was, or if
/// time or memory are out of bounds.
pub fn stored(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let text = &String::from_utf8_lossy(bytes);
    match first {
        b'l' => recording(bytes),
        b'r' => replay(text),
        b'g' => {
            if let Some(geometry) = again::<Geometry>(text) {
                measured(&geometry);
            }
        }
        b's' => {
            if let Some(mut scene) = again::<Scene>(text) {
                assert_eq!(scene.check(), Ok(()));
                scene.step();
                assert_eq!(scene.check(), Ok(()));
            }
        }
        b'q' => {
            if let Some(curve) = again::<JointCurve>(text) {
                let at = [curve.at(0.3), curve.velocity(0.3), curve.acceleration(0.3)];
                assert!(at.iter().all(|row| row.len() == curve.coordinates()));
                assert!(at[0].iter().all(|x| x.is_finite()));
            }
        }
        b'w' => {
            again::<Cell>(text);
        }
        b'a' => {
            again::<RangeAnswer>(text);
        }
        b'v' => {
            parsed(text, || lin_canny_verify::verify(bytes));
        }
        _ => {}
    }
}

/// Returns what JSON holds, if it is valid; what is written is read again as it was.
fn again<T: serde::Serialize + serde::de::DeserializeOwned>(text: &str) -> Option<T> {
    let value: T = parsed(text, || serde_json::from_str(text))?;
    let written = serde_json::to_string(&value).expect("what was read is written");
    let read: T = serde_json::from_str(&written).expect("what was written is read");
    assert_eq!(serde_json::to_string(&read).expect("what was read is written"), written);
    Some(value)
}

/// Measures a geometry and itself.
fn measured(geometry: &Geometry) {
    let (_, radius) = geometry.bounding_ball();
    let pose = RelativePose::from_isometry(&Isometry3::translation(radius.min(1e99), 0.0, 0.0));
    let Ok(pose) = pose else { return };
    // Surfaces that coincide use up any budget.
    let few = QueryOptions::default().splits(50);
    let found = PairTracker::new().closest_with(geometry, geometry, &pose, &few);
    assert!(found.lower <= found.upper && !found.distance.is_nan(), "{found:?}");
}

fn recording(bytes: &[u8]) {
    let Ok(recording) = bounded(bytes, || Recording::read(bytes)) else {
        return;
    };
    let mut cursor = Cursor::default();
    for frame in 0..recording.frames.len() {
        cursor.seek(&recording, frame);
    }
}

fn replay(text: &str) {
    let Some(replay) = parsed(text, || text.parse::<Replay>()) else {
        return;
    };
    let written = replay.to_string();
    let again: Replay = written.parse().expect("what was written is read");
    assert_eq!(again.to_string(), written);
    let [a, b] = replay.shapes();
    let found = replay.pair_tracker().closest(&a, &b, &replay.pose);
    assert!(found.lower <= found.upper && !found.distance.is_nan(), "{found:?}");
}

/// The root element decides the format: URDF, MJCF or SDFormat.
fn robot(text: &str) {
    let options = LoadOptions::default().skip_missing_meshes(true);
    let Some(robot) = parsed(text, || Robot::parse(text, FILE, &Packages::default(), &options)) else {
        return;
    };
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    let Ok(space) = setup.space() else { return };
    let (mut poses, mut state) = (Vec::new(), 0.0);
    let q = space.sample(&mut || {
        state = (state + 0.618_033_988_749_894_9) % 1.0;
        state
    });
    assert_eq!(q.len(), robot.coordinates().len());
    assert_eq!(q.len(), robot.start().len());
    assert!(robot.start().iter().all(|x| x.is_finite()));
    let bodies: Vec<usize> = robot.links().iter().map(|link| link.bodies.len()).collect();
    let is_body = |(link, body): &(usize, usize)| *body < bodies[*link];
    assert!(robot.excluded().as_flattened().iter().all(is_body));
    let is_pair = |[a, b]: &[usize; 2]| a < b && *b < bodies.len();
    assert!(robot.adjacent().iter().all(is_pair));
    space.place(&q, &mut poses);
    let is_finite = |pose: &Isometry3<f64>| pose.to_homogeneous().iter().all(|x| x.is_finite());
    assert!(poses.iter().all(is_finite));
}

fn srdf(text: &str) {
    let Some(srdf) = parsed(text, || Srdf::parse(text, FILE, &ROBOT)) else {
        return;
    };
    let again = Srdf::parse(&srdf.text("r"), FILE, &ROBOT).expect("what was written is read");
    assert_eq!((again.excluded, again.skipped.len()), (srdf.excluded, 0));
}

fn cell(text: &str) {
    let options = LoadOptions::default();
    let Some(cell) = parsed(text, || CellFile::parse(text, FILE, &Packages::default(), &options)) else {
        return;
    };
    let mut setup = Cell::new();
    setup.add_robot("", &*ROBOT, Isometry3::identity()).expect("a robot");
    // Poses and names may be out of range, which is an error.
    if cell.add_to(&mut setup).is_err() {
        return;
    }
    let Ok(checker) = Checker::of_robots(setup.clone()) else {
        return;
    };
    let saved = CellFile::from_cell(checker.cell())
        .to_json()
        .expect("a world is written");
    let again = CellFile::parse(&saved, FILE, &Packages::default(), &options).expect("what was written is read");
    assert_eq!(again.to_json().expect("a cell is written"), saved);
}

fn trajectory(text: &str) {
    let coordinates = ROBOT.coordinates();
    let Some(trajectory) = parsed(text, || Trajectory::parse(text, FILE, coordinates)) else {
        return;
    };
    assert!(trajectory.rows.iter().all(|row| row.len() == coordinates.len()));
    assert!(trajectory.lines.is_sorted() && trajectory.lines.len() == trajectory.rows.len());
    let again = csv_text(coordinates, &trajectory.rows);
    let again = Trajectory::parse(&again, FILE, coordinates).expect("what was written is read");
    assert_eq!(again.rows, trajectory.rows);
}

/// A coordinate that the file does not name rests at 0.
fn timed(text: &str, extension: &str) {
    let coordinates = ROBOT.coordinates();
    let (path, rest) = (format!("{FILE}.{extension}"), vec![Some(0.0); coordinates.len()]);
    let Some(trajectory) = parsed(text, || Trajectory::parse_timed(text, &path, coordinates, &rest)) else {
        return;
    };
    let rows = &trajectory.rows;
    let times = trajectory.times.as_ref().expect("times");
    assert!(!rows.is_empty() && times.len() == rows.len() && trajectory.lines.len() == rows.len());
    assert!(times.iter().all(|t| t.is_finite()) && times.windows(2).all(|t| t[0] < t[1]));
    let is_within = |row: &Vec<f64>| {
        let mut each = row.iter().zip(coordinates);
        row.len() == coordinates.len() && each.all(|(x, c)| (c.limits[0]..=c.limits[1]).contains(x))
    };
    assert!(rows.iter().all(is_within));
    let is_row = |row: &Vec<f64>| row.is_empty() || row.len() == coordinates.len() && row.iter().all(|x| x.is_finite());
    for derivatives in [&trajectory.velocities, &trajectory.accelerations] {
        assert!(derivatives.len() == rows.len() && derivatives.iter().all(is_row));
    }
    // Numbers may be out of range, which is an error.
    let Ok(curves) = trajectory.curves() else { return };
    assert_eq!(curves.len() + 1, rows.len());
    for (curve, ends) in curves.iter().zip(rows.windows(2)) {
        assert_eq!([0, curve.degree()].map(|j| curve.control_point(j)), ends);
        let at = [curve.at(0.5), curve.velocity(0.5), curve.acceleration(0.5)];
        assert!(at.iter().flatten().all(|x| x.is_finite()));
    }
}

/// Returns what a reader of a text returns; `None` for an error, which says why.
fn parsed<T, E: std::fmt::Display>(text: &str, read: impl FnOnce() -> Result<T, E>) -> Option<T> {
    let read = bounded(text.as_bytes(), read);
    read.map_err(|error| assert!(!error.to_string().is_empty())).ok()
}

/// Returns what the reader of a file returns, whose time and memory are within bounds.
fn bounded<R>(bytes: &[u8], read: impl FnOnce() -> R) -> R {
    let length = bytes.len();
    // Without the zeros of UTF-16.
    let words: Vec<u8> = bytes.iter().copied().filter(|byte| *byte > 0).collect();
    let words = String::from_utf8_lossy(&words);
    let is_repeating = REPEATING.iter().any(|word| words.contains(word));
    let more = if is_repeating { REPEATED } else { 0 };
    let (started, before) = (Instant::now(), PeakAlloc.current_usage());
    PeakAlloc.reset_peak_usage();
    let result = read();
    let peak = PeakAlloc.peak_usage().saturating_sub(before);
    let most = MEMORY.0 + MEMORY.1 * length + more;
    assert!(
        peak <= most,
        "{peak} bytes for a file of {length} (expected at most {most})"
    );
    let took = started.elapsed();
    assert!(
        took < TIME,
        "{took:?} for a file of {length} bytes (expected at most {TIME:?})"
    );
    result
}
