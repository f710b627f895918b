//! Prints the contacts of a box that slides over the edge of a round plate, with their `id`s.

use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Manifold, ManifoldOptions, RelativePose, Tracker, polyhedron::solids};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    truth::command::no_options(
        "A box slides over the rim of a round plate: its contacts frame by frame, with the names they keep",
    );
    let plate = solids::prism(24, 0.2, 1.0)?;
    let part = solids::cuboid(Vector3::new(0.35, 0.25, 0.2))?;
    // One tracker and one manifold per pair of bodies.
    let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    let options = ManifoldOptions::with_prediction(0.01);
    println!("name (the features it was first seen on), features now, depth, place on the plate");
    for frame in 0..8 {
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
        let place = Translation3::new(0.45 + 0.08 * f64::from(frame), 0.1, 0.399);
        let plate_from_part = RelativePose::from_isometry(&Isometry3::from_parts(place, turn))?;
        pair.manifold(&plate, &part, &plate_from_part, &options, &mut manifold);
        println!("frame {frame}, {} points", manifold.points().len());
        for contact in manifold.points() {
            // Look up what a solver keeps for a contact by `id`; `features` are the current
            // features.
            println!(
                "  {:>8}  now {:>8}  {:.4} deep at [{:+.3}, {:+.3}]",
                contact.id, contact.features, -contact.separation, contact.point_on_a.x, contact.point_on_a.y
            );
        }
    }
    Ok(())
}
