//! A box slides over the edge of a round plate: contact points of each frame, with ids that persist
//! from frame to frame.

use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Manifold, ManifoldOptions, RelativePose, Tracker, polyhedron::solids};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plate = solids::prism(24, 0.2, 1.0)?; // 24 sides, half height, radius
    let part = solids::cuboid(Vector3::new(0.35, 0.25, 0.2))?; // half extents
    // One tracker and one manifold for each pair of bodies.
    let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    // Points at most this far apart count, so that a solver receives them before they touch.
    let options = ManifoldOptions::default().prediction(0.01);
    for frame in 0..8 {
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
        let position = Translation3::new(0.45 + 0.08 * f64::from(frame), 0.1, 0.399);
        let plate_from_part = RelativePose::from_isometry(&Isometry3::from_parts(position, turn))?;
        pair.manifold(&plate, &part, &plate_from_part, &options, &mut manifold);
        println!("frame {frame}: {} points", manifold.points().len());
        for contact in manifold.points() {
            // A solver looks up what it stored for a contact, such as an impulse, by its id.
            let [x, y, z] = contact.point_on_a.into();
            println!(
                "  id {:<8} depth {:.4} at [{x:+.3}, {y:+.3}, {z:+.3}]",
                contact.id.to_string(),
                -contact.separation
            );
        }
    }
    Ok(())
}
