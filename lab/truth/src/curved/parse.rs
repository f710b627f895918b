//! Parser of shapes and poses in lines of text: `KIND params; KIND params; x y z qx qy qz qw`.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, RelativePose, Shape, ShapeError};

/// One pair of a file.
pub struct Pair {
    /// Shape A.
    pub a: Shape,
    /// Shape B.
    pub b: Shape,
    /// Pose of B in the frame of A.
    pub pose: RelativePose,
}

fn numbers(words: &str) -> Result<Vec<f64>, String> {
    let number = |w: &str| w.parse::<f64>().map_err(|_| format!("`{w}` is no number"));
    words.split_whitespace().map(number).collect()
}

/// Returns the hull of points, in as many dimensions as they span.
fn hull(numbers: &[f64]) -> Result<Shape, ShapeError> {
    let points: Vec<Point3<f64>> = numbers.chunks_exact(3).map(|p| Point3::new(p[0], p[1], p[2])).collect();
    let body = match points[..] {
        [p] => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        _ => ConvexPolyhedron::from_points(&points).or_else(|e| ConvexPolyhedron::polygon(&points).map_err(|_| e)),
    };
    Ok(Shape::from(body?))
}

/// Parses a shape.
///
/// Forms: `ball r`, `capsule half_length r`, `box hx hy hz`, `hull x y z x y z ...`,
/// `cylinder half_height r`, `cone half_height r`, `ellipsoid a b c`,
/// each with `+ r` for rounding.
fn shape(text: &str) -> Result<Shape, String> {
    let (core, round) = match text.split_once('+') {
        Some((core, round)) => (core, numbers(round)?),
        None => (text, vec![0.0]),
    };
    let core = core.trim();
    let (kind, rest) = core.split_once(char::is_whitespace).unwrap_or((core, ""));
    let given = numbers(rest)?;
    let shape = match (kind, &given[..]) {
        ("ball", &[r]) => Shape::ball(r),
        ("capsule", &[half, r]) => Shape::capsule(half, r),
        ("box", &[x, y, z]) => Shape::cuboid(Vector3::new(x, y, z)),
        ("hull", all) if !all.is_empty() && all.len() % 3 == 0 => hull(all),
        ("cylinder", &[half, r]) => Shape::cylinder(half, r),
        ("cone", &[half, r]) => Shape::cone(half, r),
        ("ellipsoid", &[a, b, c]) => Shape::ellipsoid(Vector3::new(a, b, c)),
        _ => return Err(format!("`{}` is no shape", text.trim())),
    };
    let [round] = round[..] else {
        return Err(format!("`{}` has no radius", text.trim()));
    };
    shape.and_then(|s| s.rounded(round)).map_err(|e| e.to_string())
}

/// Parses the pose of B in the frame of A. A quaternion is normalised if its length differs from
/// one by more than rounding.
fn pose(text: &str) -> Result<RelativePose, String> {
    let [x, y, z, qx, qy, qz, qw] = numbers(text)?[..] else {
        return Err("a pose is seven numbers".into());
    };
    let q = Quaternion::new(qw, qx, qy, qz);
    let unit = (q.norm_squared() - 1.0).abs() <= 1e-12;
    let q = if unit {
        UnitQuaternion::new_unchecked(q)
    } else {
        UnitQuaternion::new_normalize(q)
    };
    RelativePose::from_isometry(&Isometry3::from_parts(Translation3::new(x, y, z), q)).map_err(|e| e.to_string())
}

/// Parses one line.
pub fn pair(line: &str) -> Result<Pair, String> {
    let parts: Vec<&str> = line.split(';').collect();
    let [a, b, p] = parts[..] else {
        return Err("a line is two shapes and a pose, with `;` between".into());
    };
    Ok(Pair {
        a: shape(a)?,
        b: shape(b)?,
        pose: pose(p)?,
    })
}
