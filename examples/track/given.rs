//! Reads poses from a file and writes the answers to a file, for meshes as they are, convex or not.

use std::fmt::Write as _;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, Mesh, PairTracker, RelativePose};
use lin_canny_formats::MeshFile;

use crate::Trouble;

/// A quaternion is not normalised if its squared norm differs from one by at most this.
const UNIT: f64 = 1e-12;

/// Names of the columns; the first line may contain them.
const HEADER: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// Answers every pose of the file, in order, with one tracker.
pub(crate) fn answer(meshes: [&Path; 2], poses: &Path, csv: &Path) -> Result<(), Trouble> {
    if poses == csv {
        return Err(format!("{}: the poses are not overwritten", poses.display()).into());
    }
    let (a, b) = (load('A', meshes[0])?, load('B', meshes[1])?);
    let text = truth::command::read(poses)?;
    let mut rows = String::from("distance,lower,upper,ax,ay,az,bx,by,bz\n");
    let (mut tracker, mut frames, mut shared) = (PairTracker::new(), 0, 0);
    let began = std::time::Instant::now();
    for (line, number) in text.lines().zip(1..) {
        let is_header = number == 1 && words(line).eq(HEADER);
        if line.trim().is_empty() || is_header {
            continue;
        }
        let named = |why: String| format!("{}:{number}: {why}", poses.display());
        let pose = pose(line).ok_or_else(|| named("not seven numbers `x y z qx qy qz qw`".into()))?;
        let a_from_b = RelativePose::from_isometry(&pose).map_err(|e| named(e.to_string()))?;
        let found = tracker.closest(&a, &b, &a_from_b);
        let (p, q) = (found.point_on_a, pose * found.point_on_b);
        let numbers = [found.distance, found.lower, found.upper, p.x, p.y, p.z, q.x, q.y, q.z];
        let words: Vec<String> = numbers.iter().map(|x| format!("{x:.16e}")).collect();
        writeln!(rows, "{}", words.join(","))?;
        frames += 1;
        shared += usize::from(found.state != ContactState::Separated);
    }
    if frames == 0 {
        return Err(format!("{}: no pose", poses.display()).into());
    }
    let each = began.elapsed().as_micros() as f64 / f64::from(frames);
    truth::command::write(csv, &rows)?;
    println!("{frames} poses, {shared} of them in contact; {each:.1} us a pose with reading and writing");
    println!("written: {}", csv.display());
    Ok(())
}

/// Reads a mesh.
fn load(letter: char, path: &Path) -> Result<Mesh, Trouble> {
    let (points, triangles) = MeshFile::load(path)?.whole();
    let points: Vec<_> = points.into_iter().map(Point3::from).collect();
    let mesh = Mesh::new(&points, &triangles).map_err(|e| format!("{}: {e}", path.display()))?;
    println!("{letter}: {}: {}", path.display(), mesh.report());
    Ok(mesh)
}

/// Returns the words of a line, separated by commas or blanks.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',']).map(str::trim).filter(|w| !w.is_empty())
}

/// Returns a pose from seven numbers. A quaternion rounded to few digits is normalised.
fn pose(line: &str) -> Option<Isometry3<f64>> {
    let numbers: Result<Vec<f64>, _> = words(line).map(str::parse).collect();
    let [x, y, z, i, j, k, w] = numbers.ok()?.try_into().ok()?;
    let q = Quaternion::new(w, i, j, k);
    let rotation = if (q.norm_squared() - 1.0).abs() <= UNIT {
        UnitQuaternion::new_unchecked(q)
    } else {
        UnitQuaternion::new_normalize(q)
    };
    Some(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}
