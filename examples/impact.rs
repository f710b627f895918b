//! A spinning rod flies at a wall 1 mm thick: `cast` returns the time of impact as a proven
//! bracket, but checks at every frame see no overlap.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{RelativePose, Tracker, Velocity, polyhedron::solids};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wall = solids::cuboid(Vector3::new(0.0005, 1.0, 1.0))?; // half extents in metres
    let rod = solids::cuboid(Vector3::new(0.05, 0.005, 0.005))?;
    let rest = Steady::new(&Isometry3::identity(), Velocity::default())?;
    // 50 m/s along x, 40 rad/s about z.
    let velocity = Velocity::new(Vector3::new(50.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 40.0));

    for lane in 0..5 {
        let y = 0.3 * f64::from(lane);
        let flight = Steady::new(&Isometry3::translation(-0.5, y, 0.0), velocity)?;
        let mut pair = Tracker::new();
        // Overlaps that a loop at 60 frames per second sees.
        let mut frames = 0;
        for frame in 0..=2 {
            let t = f64::from(frame) / 60.0;
            frames += u32::from(pair.intersects(&wall, &rod, &RelativePose::new(&rest.pose(t), &flight.pose(t))?));
        }
        let found = cast(
            &mut pair.pair(&wall, &rod),
            &rest,
            &flight,
            0.0..2.0 / 60.0,
            Tolerance::Distance(1e-9),
        )?;
        print!("y = {y:.1}: {frames} of 3 frames see an overlap; ");
        match found.impact {
            Impact::Hit { safe, hit, .. } => println!("free until {safe:.12} s, in contact at {hit:.12} s"),
            Impact::Miss => println!("proven free over the whole time"),
            other => println!("{other:?}"),
        }
        println!("         {} queries", found.queries);
    }
    Ok(())
}
