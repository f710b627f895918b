//! Answers poses of a file, for meshes as they are, convex or not: a table and a picture.

use std::fmt::Write as _;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, Mesh, Outcome, PairTracker, RelativePose};
use lin_canny_formats::MeshFile;
use truth::say;

use crate::options::Options;
use crate::picture::{self, Curve, Drawn, Shown};
use crate::{CURVE, Trouble};

/// A quaternion is not normalised if its squared norm differs from one by at most this.
const UNIT: f64 = 1e-12;

/// Names of the columns; the first line may contain them.
const HEADER: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// Answers every pose of the file, in order, with one tracker, and draws the closest.
pub(crate) fn answer(options: &Options, meshes: [&Path; 2], poses: &Path) -> Result<(), Trouble> {
    if let Some(csv) = &options.csv {
        if poses == csv {
            return Err(format!("{}: the poses are not overwritten", poses.display()).into());
        }
        truth::command::writable(csv)?;
    }
    let (a, b) = (load('A', meshes[0])?, load('B', meshes[1])?);
    let text = truth::command::read(poses)?;
    let mut rows = String::from("distance,lower,upper,ax,ay,az,bx,by,bz\n");
    let (mut tracker, mut found) = (PairTracker::new(), vec![]);
    let began = std::time::Instant::now();
    for (line, number) in text.lines().zip(1..) {
        let is_header = number == 1 && words(line).eq(HEADER);
        if line.trim().is_empty() || is_header {
            continue;
        }
        let named = |why: String| format!("{}:{number}: {why}", poses.display());
        let pose = pose(line).ok_or_else(|| named("not seven numbers `x y z qx qy qz qw`".into()))?;
        let a_from_b = RelativePose::from_isometry(&pose).map_err(|e| named(e.to_string()))?;
        let outcome = tracker.closest(&a, &b, &a_from_b).outcome;
        let (p, q) = (outcome.point_on_a, pose * outcome.point_on_b);
        let numbers = [
            outcome.distance,
            outcome.lower,
            outcome.upper,
            p.x,
            p.y,
            p.z,
            q.x,
            q.y,
            q.z,
        ];
        let words: Vec<String> = numbers.iter().map(|x| format!("{x:.16e}")).collect();
        writeln!(rows, "{}", words.join(","))?;
        found.push(Found { number, pose, outcome });
    }
    let least = found
        .iter()
        .min_by(|x, y| x.outcome.distance.total_cmp(&y.outcome.distance));
    let least = least.ok_or_else(|| format!("{}: no pose", poses.display()))?;
    let each = began.elapsed().as_micros() as f64 / found.len() as f64;
    let shared = found
        .iter()
        .filter(|f| f.outcome.state != ContactState::Separated)
        .count();
    say!(
        "{} poses, {shared} of them in contact; {each:.1} us a pose with reading",
        found.len()
    );
    let [lower, upper] = [least.outcome.lower, least.outcome.upper];
    say!(
        "closest: {} in [{lower}, {upper}] at line {}",
        least.outcome.distance,
        least.number
    );
    if let Some(csv) = &options.csv {
        truth::command::write(csv, &rows)?;
        say!("written: {}", csv.display());
    }
    let shown = Shown {
        bodies: [Drawn::mesh(&a, &Isometry3::identity()), Drawn::mesh(&b, &least.pose)],
        normal: least.outcome.normal.into_inner(),
        points: [least.outcome.point_on_a, least.pose * least.outcome.point_on_b],
        title: match least.outcome.state {
            ContactState::Separated => format!(
                "line {}: {:.6} apart, between {lower:.12} and {upper:.12}",
                least.number, least.outcome.distance
            ),
            state => format!("line {}: {}", least.number, format!("{state:?}").to_lowercase()),
        },
    };
    let group = found.len().div_ceil(CURVE);
    let distance = |group: &[Found]| group.iter().map(|f| f.outcome.distance).fold(f64::INFINITY, f64::min);
    let points = found
        .chunks(group)
        .enumerate()
        .map(|(k, g)| (k * group, distance(g)))
        .collect();
    picture::draw(
        &shown,
        &[Curve {
            name: "distance",
            points,
        }],
        &options.out,
    )?;
    say!(
        "picture of the pose at line {}: {}",
        least.number,
        options.out.display()
    );
    Ok(())
}

/// The answer at the pose of a line.
struct Found {
    number: usize,
    pose: Isometry3<f64>,
    outcome: Outcome,
}

/// Reads a mesh.
fn load(letter: char, path: &Path) -> Result<Mesh, Trouble> {
    let (points, triangles) = MeshFile::load(path)?.whole();
    let points: Vec<_> = points.into_iter().map(Point3::from).collect();
    let mesh = Mesh::new(&points, &triangles).map_err(|e| format!("{}: {e}", path.display()))?;
    say!("{letter}: {}: {}", path.display(), mesh.report());
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
