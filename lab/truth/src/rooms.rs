//! Rooms full of hulls, and a long hull that moves through them, for tests and races of the
//! planner.

use lin_canny::ConvexPolyhedron;
use lin_canny::polyhedron::solids;
use lin_canny_plan::{Cell, RigidSpace};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::casts::{rotation, solid};
use crate::rng::Rng;
use crate::shapes::ellipsoid;

/// Half side of a room.
pub const HALF: f64 = 4.0;

/// Hulls in a room, and a robot that is one hull.
#[derive(Clone, Debug)]
pub struct Room {
    /// The robot: a long hull of radius 0.6 and half width 0.12.
    pub robot: ConvexPolyhedron,
    /// The obstacles.
    pub hulls: Vec<(ConvexPolyhedron, Isometry3<f64>)>,
}

impl Room {
    /// Returns a room of `n` hulls of 8 to 40 vertices, always the same for a seed.
    pub fn new(n: usize, seed: u64) -> Self {
        let mut rng = Rng::new(0x900 + seed);
        let robot = solid(&ellipsoid(&mut rng, 24, [0.6, 0.12, 0.12]).points);
        let hulls = (0..n).map(|_| {
            let axes = [0; 3].map(|_| rng.range(0.15, 0.6));
            let vertices = 8 + rng.below(33);
            let at = Vector3::from([0; 3].map(|_| rng.range(-HALF, HALF)));
            let hull = solid(&ellipsoid(&mut rng, vertices, axes).points);
            (hull, Isometry3::from_parts(at.into(), rotation(&mut rng)))
        });
        let hulls = hulls.collect();
        Self { robot, hulls }
    }

    /// Returns the room as the planner's world.
    pub fn cell(&self) -> Cell {
        let mut cell = Cell::new();
        cell.robot_body("robot", self.robot.clone());
        for (k, (hull, pose)) in self.hulls.iter().enumerate() {
            cell.add_obstacle(k, hull.clone(), *pose).expect("an obstacle");
        }
        cell
    }

    /// Returns the space of the robot; configurations may lie up to 2 outside the room.
    pub fn space(&self) -> RigidSpace {
        let bounds = [[-HALF - 2.0, HALF + 2.0]; 3];
        RigidSpace::new(bounds, 0.6, 1).expect("bounds are finite")
    }

    /// Returns a segment: a random start, and an end 0.4 to 1.6 away and rotated by up to 1.6
    /// radians.
    pub fn segment(&self, rng: &mut Rng) -> [Isometry3<f64>; 2] {
        let at = Vector3::from([0; 3].map(|_| rng.range(-HALF, HALF)));
        let start = Isometry3::from_parts(at.into(), rotation(rng));
        let way = Vector3::from(rng.unit()) * rng.range(0.4, 1.6);
        let turn = Vector3::from(rng.unit()) * rng.range(0.0, 1.6);
        let spin = lin_canny::Velocity::new(way, turn);
        [start, spin.applied(&start, 1.0)]
    }
}

/// Returns a wall in the plane x = 0 with a central square hole of side `width`; it is 0.5 thick
/// and 10 wide.
pub fn wall(width: f64) -> Vec<(ConvexPolyhedron, Isometry3<f64>)> {
    let (half, rest) = (0.5 * width, 0.5 * (5.0 - 0.5 * width));
    let block = |half_sizes: [f64; 3], [x, y, z]: [f64; 3]| {
        let block = solids::cuboid(Vector3::from(half_sizes)).expect("a box");
        (block, Isometry3::translation(x, y, z))
    };
    vec![
        block([0.25, 5.0, rest], [0.0, 0.0, half + rest]),
        block([0.25, 5.0, rest], [0.0, 0.0, -half - rest]),
        block([0.25, rest, half], [0.0, half + rest, 0.0]),
        block([0.25, rest, half], [0.0, -half - rest, 0.0]),
    ]
}

/// Returns the space of a plank of 1.6 by 0.2 by 0.2 at such a wall.
///
/// Also returns its configurations on both sides, rotated so that it does not fit through the hole.
pub fn passage() -> (RigidSpace, [Vec<f64>; 2]) {
    let space = RigidSpace::new([[-2.5, 2.5], [-2.0, 2.0], [-2.0, 2.0]], 0.8, 1).expect("bounds are finite");
    let ends = [-1.0, 1.0].map(|side: f64| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.2, 0.1, 1.5));
        let at = Vector3::new(1.8 * side, 0.9 * side, 0.7);
        RigidSpace::configuration(&Isometry3::from_parts(at.into(), turn))
    });
    (space, ends)
}
