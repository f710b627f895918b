//! A gripper passes a shelf of six parcels: a scene finds near pairs and reports events.
//!
//! The events: a body comes within 3 cm of another, leaves it, starts or stops to overlap.

use std::sync::Arc;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Group, PairQueries, Scene};

const SHELF: Group = Group::new(1).unwrap();
const ROBOT: Group = Group::new(2).unwrap();

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::new();
    // Only these queries run, and only between these groups: parcels are never compared with each
    // other.
    let queries = PairQueries::none().overlap(true).within(0.03).distance(0.2);
    scene.set_queries(ROBOT, SHELF, queries)?;
    let parcel = Arc::new(solids::cuboid(Vector3::new(0.1, 0.15, 0.12))?); // one shape, shared
    for k in 0..6 {
        let pose = Isometry3::translation(0.3 * f64::from(k), 0.02 * f64::from(k % 3), 0.0);
        scene.insert(Body::fixed(parcel.clone()).group(SHELF), pose)?;
    }
    let gripper = Body::moving(solids::prism(16, 0.1, 0.08)?).group(ROBOT);
    let gripper = scene.insert(gripper, Isometry3::translation(-0.4, 0.265, 0.0))?;

    for frame in 0..96 {
        let x = -0.4 + 0.02 * f64::from(frame);
        scene.set_pose(gripper, Isometry3::translation(x, 0.265, 0.0))?;
        scene.step();
        for event in scene.events() {
            let parcel = if event.a == gripper { event.b } else { event.a };
            println!("frame {frame:>2}: {:?}, parcel {}", event.change, parcel.index);
        }
    }
    let near = scene.pairs().filter_map(|pair| Some(pair.distance?.value));
    println!("nearest at the end: {:.4}\n", near.fold(f64::INFINITY, f64::min));
    println!("the last step:\n{}", scene.report());
    Ok(())
}
