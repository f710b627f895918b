//! Crowds of moving hulls: the scenes of tests, examples and benchmarks of `Scene`, with fixed
//! seeds.
//!
//! Hulls are random points on an ellipsoid with half axes of 0.4 to 0.6 (0.5 to 0.6 in a pile), so
//! a body is about one unit wide.

use crate::pose::{add, quat, quat_mul, scale, unit_quat};
use crate::rng::Rng;
use crate::shapes::{Shape, ellipsoid};
use crate::{Point, Pose};
use lin_canny::ConvexPolyhedron;
use nalgebra::Point3;
use std::sync::Arc;

/// Arrangement of a crowd.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// 16 cubic units per body, random directions, at most 0.01 and 0.02 radians per step, with
    /// walls around.
    Sparse,
    /// Four layers of unit cells on a square. Each body jostles in its cell within 0.1, by 0.01 and
    /// 0.02 radians per step: about three pairs of boxes per body.
    Pile,
    /// Bodies at a given density and step rate, with at most one unit and one radian per second.
    Gas {
        /// Volume of the bodies divided by that of the room.
        fill: f64,
        /// Steps per second.
        rate: f64,
    },
}

/// One body's motion.
#[derive(Clone, Debug)]
struct Mover {
    velocity: Point,
    /// Rotation per step.
    spin: [f64; 4],
    home: Point,
    /// Half side of its room.
    room: Point,
}

/// Bodies in motion. Each body moves in its room and bounces off the walls.
#[derive(Clone, Debug)]
pub struct Crowd {
    /// The distinct shapes.
    pub shapes: Vec<Shape>,
    /// Index of the shape of each body.
    pub shape_of: Vec<usize>,
    /// Poses of the bodies in this frame.
    pub poses: Vec<Pose>,
    movers: Vec<Mover>,
}

/// Distinct shapes of a crowd.
const SHAPES: usize = 16;

impl Crowd {
    /// Returns the distinct shapes as bodies of the crate.
    pub fn hulls(&self) -> Vec<Arc<ConvexPolyhedron>> {
        let hull = |s: &Shape| {
            let points: Vec<Point3<f64>> = s.points.iter().copied().map(Point3::from).collect();
            Arc::new(ConvexPolyhedron::from_points(&points).expect("points of an ellipsoid are a body"))
        };
        self.shapes.iter().map(hull).collect()
    }

    /// Returns `n` bodies, hulls of `vertices` points, always the same.
    pub fn new(kind: Kind, n: usize, vertices: usize) -> Self {
        let mut rng = Rng::new(0x5EED + n as u64 + 7 * vertices as u64);
        let least = if kind == Kind::Pile { 0.5 } else { 0.4 };
        let axes = |rng: &mut Rng| [0; 3].map(|_| rng.range(least, 0.6));
        let shapes = (0..SHAPES).map(|_| {
            let axes = axes(&mut rng);
            ellipsoid(&mut rng, vertices, axes)
        });
        let shapes: Vec<Shape> = shapes.collect();
        let mut crowd = Self {
            shapes,
            shape_of: (0..n).map(|_| rng.below(SHAPES)).collect(),
            poses: Vec::new(),
            movers: Vec::new(),
        };
        match kind {
            Kind::Pile => crowd.pile(n, &mut rng),
            Kind::Sparse => crowd.fill(n, 16.0, (0.01, 0.02), &mut rng),
            // The volume of a ball of radius 1/2, divided by the density.
            Kind::Gas { fill, rate } => {
                let speed = rng.range(0.999, 1.0) / rate;
                crowd.fill(n, std::f64::consts::PI / 6.0 / fill, (speed, speed), &mut rng);
            }
        }
        crowd
    }

    fn add(&mut self, at: Point, home: Point, room: Point, (speed, spin): (f64, f64), rng: &mut Rng) {
        self.poses.push(Pose::new(rng.quat(), at));
        self.movers.push(Mover {
            velocity: scale(rng.unit(), speed),
            spin: quat(rng.unit(), spin),
            home,
            room,
        });
    }

    fn fill(&mut self, n: usize, volume: f64, pace: (f64, f64), rng: &mut Rng) {
        let half = 0.5 * (volume * n as f64).cbrt();
        for _ in 0..n {
            let at = [0; 3].map(|_| rng.range(-half, half));
            // The fastest body moves at full speed, others slower.
            let part = rng.range(0.5, 1.0);
            self.add(at, [0.0; 3], [half; 3], (pace.0 * part, pace.1 * part), rng);
        }
    }

    fn pile(&mut self, n: usize, rng: &mut Rng) {
        let side = ((n as f64 / 4.0).sqrt().ceil() as usize).max(1);
        let mut cells: Vec<usize> = (0..side * side * 4).collect();
        // Neighbours in space are far apart in memory: the worst case.
        rng.shuffle(&mut cells);
        for cell in cells.into_iter().take(n) {
            let home = [cell / 4 % side, cell / 4 / side, cell % 4].map(|v| v as f64);
            let at = add(home, [0; 3].map(|_| rng.range(-0.1, 0.1)));
            self.add(at, home, [0.1; 3], (0.01, 0.02), rng);
        }
    }

    /// Advances the crowd by one frame.
    pub fn step(&mut self) {
        for (pose, mover) in self.poses.iter_mut().zip(&mut self.movers) {
            for k in 0..3 {
                let next = pose.t[k] + mover.velocity[k] - mover.home[k];
                if next.abs() > mover.room[k] && next * mover.velocity[k] > 0.0 {
                    mover.velocity[k] = -mover.velocity[k];
                }
                pose.t[k] += mover.velocity[k];
            }
            pose.q = unit_quat(quat_mul(mover.spin, pose.q));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowds_stay_in_their_rooms_and_repeat() {
        for kind in [Kind::Sparse, Kind::Pile, Kind::Gas { fill: 0.02, rate: 60.0 }] {
            let run = || {
                let mut crowd = Crowd::new(kind, 100, 12);
                (0..200).for_each(|_| crowd.step());
                crowd
            };
            let crowd = run();
            assert_eq!(crowd.poses, run().poses);
            for (pose, mover) in crowd.poses.iter().zip(&crowd.movers) {
                for k in 0..3 {
                    assert!((pose.t[k] - mover.home[k]).abs() <= mover.room[k] + 0.02);
                }
            }
        }
    }
}
