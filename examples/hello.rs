//! The example of the README: a small body passes a larger one, and a tracker follows their closest
//! features.

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, polyhedron::solids};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let part = solids::icosahedron(0.5)?;
    let corners = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 2.]].map(Point3::from);
    let wedge = ConvexPolyhedron::from_points(&corners)?; // an error names the point and what is wrong with it
    let mut pair = Tracker::new(); // remembers the features of the last answer
    for frame in 0..7 {
        let pose = Isometry3::translation(2.5 - 0.3 * f64::from(frame), 1.5, 0.5);
        let wedge_from_part = RelativePose::new(&Isometry3::identity(), &pose)?;
        let c = pair.closest(&wedge, &part, &wedge_from_part);
        let (distance, lower, upper) = (c.distance, c.lower, c.upper);
        println!("{:>7}  {distance:.6} in [{lower:.15}, {upper:.15}]", c.features);
    }
    Ok(())
}
