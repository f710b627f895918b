//! Casts every pair of a hull, a cylinder, a mesh and a Bézier surface with one type of tracker.
//!
//! Prints the distance, the time of impact and the number of contacts at impact, for both orders of
//! each pair.
//!
//! ```text
//! cargo run --release -p race --example any_pair
//! ```

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::revolution;
use lin_canny::{Geometry, ManifoldOptions, Mesh, PairTracker, RelativePose, Shape, Velocity};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    truth::command::no_options(
        "Every pair of a hull, a cylinder, a mesh and a surface in both orders: distance, time of impact and contacts",
    );
    let half = 0.5_f64.sqrt();
    let south: &[[f64; 3]] = &[[0.0, -1.0, 1.0], [1.0, -1.0, half], [1.0, 0.0, 1.0]];
    let north: &[[f64; 3]] = &[[1.0, 0.0, 1.0], [1.0, 1.0, half], [0.0, 1.0, 1.0]];
    let bodies: [(&str, Geometry); 4] = [
        ("hull", solids::cuboid(Vector3::new(1.0, 0.5, 0.5))?.into()),
        ("cylinder", Shape::cylinder(1.0, 0.5)?.into()),
        ("mesh", Mesh::from_convex(&solids::icosahedron(1.0)?)?.into()),
        ("surface", revolution(&[south, north])?.into()),
    ];
    let (start, still) = (Isometry3::translation(4.0, 0.3, 0.2), Isometry3::identity());
    let rest = Steady::new(&still, Velocity::default())?;
    let flight = Steady::new(&start, Velocity::new(-Vector3::x(), Vector3::z()))?;
    let pose = RelativePose::new(&still, &start)?;
    for (first, a) in &bodies {
        for (second, b) in &bodies {
            let mut tracker = PairTracker::new();
            let distance = tracker.distance(a, b, &pose);
            let tolerance = Tolerance::Distance(1e-6);
            let found = cast(&mut tracker.pair(a, b), &rest, &flight, 0.0..5.0, tolerance)?;
            print!("{first:>8} and {second:<8} {:.6} apart; ", distance.value);
            let Impact::Hit { safe, hit, .. } = found.impact else {
                println!("{:?}", found.impact);
                continue;
            };
            let touching = RelativePose::new(&rest.pose(hit), &flight.pose(hit))?;
            let contacts = match tracker.contacts(a, b, &touching, &ManifoldOptions::with_prediction(1e-3)) {
                Ok(groups) => format!("{} contacts", groups.iter().map(|g| g.contacts.len()).sum::<usize>()),
                Err(refused) => refused.to_string(),
            };
            println!("they meet between {safe:.6} and {hit:.6}: {contacts}");
        }
    }
    Ok(())
}
