//! A block moves into the corner of an L, a nonconvex mesh made from the points and triangles that
//! a file reader returns.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Geometry, ManifoldOptions, Mesh, PairTracker, RelativePose, polyhedron::solids};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The outline of the L, and a copy one unit above it.
    let outline = [[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 3.], [0., 3.]];
    let points: Vec<_> = [0.0, 1.0]
        .iter()
        .flat_map(|z| outline.map(|[x, y]| Point3::new(x, y, *z)))
        .collect();
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
    }
    for k in 0..6 {
        let next = (k + 1) % 6;
        triangles.extend([[k, next, next + 6], [k, next + 6, k + 6]]);
    }
    let bracket = Geometry::from(Mesh::new(&points, &triangles)?); // an error names the triangle
    let block = Geometry::from(solids::cuboid(Vector3::new(0.5, 0.5, 0.4))?);

    let mut pair = PairTracker::new(); // for any two geometries
    for frame in 0..7 {
        let position = 2.4 - 0.16 * f64::from(frame);
        let pose = RelativePose::from_isometry(&Isometry3::translation(position, position, 0.5))?;
        let found = pair.closest(&bracket, &block, &pose);
        print!(
            "at {position:.2}: {:?}, distance {:.4} in [{:.4}, {:.4}]",
            found.state, found.distance, found.lower, found.upper
        );
        println!(", on triangle {}", found.locations[0].subshape);
        for group in pair.contacts(&bracket, &block, &pose, &ManifoldOptions::default().prediction(1e-3))? {
            let n = group.normal;
            let deepest = group
                .contacts
                .iter()
                .map(|c| -c.point.separation)
                .fold(f64::NEG_INFINITY, f64::max);
            println!(
                "    {} contacts along [{:+.1}, {:+.1}, {:+.1}], {deepest:.4} deep",
                group.contacts.len(),
                n.x,
                n.y,
                n.z
            );
        }
    }
    Ok(())
}
