//! The pairs of a checker: a tracker each, and the boxes of the obstacles.

use alloc::vec::Vec;

use nalgebra::{Isometry3, Point3};

use super::error::PlanError;
use super::world::{World, WorldId, WorldPair};
use crate::broad::{Aabb, BodyId, BodyOptions, BroadPhase, PencilSweep};
use crate::geometry::Geometry;
use crate::motion::{Course, Steady, Velocity};
use crate::pair_tracker::{AnyTracker, BodyShapes};
use crate::polyhedron::BoxHint;
use crate::tolerance::PLANE;

/// A pair and its tracker, made when the pair is first measured.
pub(super) struct TrackedPair {
    pub(super) pair: WorldPair,
    pub(super) tracker: Option<AnyTracker>,
    /// The number of the configuration at which the pair was measured last.
    pub(super) measured: u64,
}

impl TrackedPair {
    /// Returns the tracker of the pair of these shapes.
    pub(super) fn tracked(&mut self, shapes: BodyShapes<'_>) -> &mut AnyTracker {
        self.tracker.get_or_insert_with(|| AnyTracker::new(shapes))
    }
}

/// All pairs that are measured.
pub(super) struct Pairs {
    /// By body of the robot and obstacle: the index of the pair, [`NONE`] for an excluded pair.
    table: Vec<u32>,
    pub(super) all: Vec<TrackedPair>,
    /// The index of the first pair of two bodies of the robot.
    pub(super) own: usize,
    obstacles: usize,
    boxes: PencilSweep,
    /// Obstacles found by a query.
    found: Vec<BodyId>,
    /// The obstacles as bodies that rest.
    pub(super) resting: Vec<Steady>,
    /// A ball about each body of the robot and about each obstacle, in the frame of the shape.
    pub(super) robot_balls: Vec<(Point3<f64>, f64)>,
    pub(super) obstacle_balls: Vec<(Point3<f64>, f64)>,
    /// The greatest radius of a ball of the robot.
    pub(super) robot_radius: f64,
}

const NONE: u32 = u32::MAX;

impl Pairs {
    pub(super) fn new(world: &World, is_rigid: impl Fn(usize, usize) -> bool) -> Result<Self, PlanError> {
        let mut pairs = Self {
            table: Vec::new(),
            all: Vec::new(),
            own: 0,
            obstacles: world.obstacles.len(),
            boxes: PencilSweep::new(),
            found: Vec::new(),
            resting: Vec::new(),
            robot_balls: world.robot.iter().map(|b| b.1.bounding_ball()).collect(),
            obstacle_balls: Vec::new(),
            robot_radius: 0.0,
        };
        pairs.robot_radius = pairs.robot_balls.iter().map(|b| b.1).fold(0.0, f64::max);
        for (_, shape, pose) in &world.obstacles {
            pairs.obstacle(shape, pose)?;
        }
        pairs.boxes.step();
        for i in 0..world.robot.len() {
            for k in 0..world.obstacles.len() {
                let entry = pairs.add(world, WorldPair::new(i, WorldId::Obstacle(k)))?;
                pairs.table.push(entry);
            }
        }
        pairs.own = pairs.all.len();
        for i in 0..world.robot.len() {
            for k in i + 1..world.robot.len() {
                if !is_rigid(i, k) {
                    pairs.add(world, WorldPair::new(i, WorldId::Robot(k)))?;
                }
            }
        }
        Ok(pairs)
    }

    fn obstacle(&mut self, shape: &Geometry, pose: &Isometry3<f64>) -> Result<(), PlanError> {
        self.resting.push(Steady::new(pose, Velocity::default())?);
        let aabb = Aabb::from(shape.aabb_at(pose, &mut BoxHint::default()));
        self.boxes.insert(&aabb, BodyOptions::fixed())?;
        self.obstacle_balls.push(shape.bounding_ball());
        Ok(())
    }

    fn add(&mut self, world: &World, pair: WorldPair) -> Result<u32, PlanError> {
        if world.is_excluded(pair) {
            return Ok(NONE);
        }
        self.all.push(TrackedPair {
            pair,
            tracker: None,
            measured: 0,
        });
        Ok(self.all.len() as u32 - 1)
    }

    /// Returns the pair of a body of the robot and an obstacle, unless excluded.
    pub(super) fn of(&self, body: usize, obstacle: usize) -> Option<usize> {
        let entry = self.table[body * self.obstacles + obstacle];
        (entry != NONE).then_some(entry as usize)
    }

    /// Appends the pairs of a body of the robot with the obstacles whose boxes a box overlaps.
    pub(super) fn near(&mut self, body: usize, swept: &Aabb, pairs: &mut Vec<usize>) -> Result<(), PlanError> {
        self.found.clear();
        self.boxes.overlapping(swept, &mut self.found)?;
        let found = self.found.iter().map(|id| id.index as usize);
        pairs.extend(found.filter_map(|k| self.of(body, k)));
        Ok(())
    }
}

impl WorldPair {
    fn new(body: usize, b: WorldId) -> Self {
        Self {
            a: WorldId::Robot(body),
            b,
        }
    }
}

/// Returns a box that contains a body, grown by `margin`, at every instant of a motion of one unit
/// of time that begins at `pose`: the pivot stays within the hull of the control points of its
/// parabola but for the drift, and no point is farther from the pivot than the ball reaches.
pub(super) fn swept_box(
    (centre, radius): (Point3<f64>, f64),
    pose: &Isometry3<f64>,
    course: &Course,
    margin: f64,
) -> Aabb {
    let start = pose * course.pivot;
    let (half, bend) = (course.linear * 0.5, course.acceleration * 0.5);
    let ends = [start, start + half, start + course.linear + bend];
    let path = ends[1..]
        .iter()
        .fold(Aabb::new(start, start), |all, p| all.united(&Aabb::new(*p, *p)));
    let reach = radius + (centre - course.pivot).norm();
    let size = reach + start.coords.abs().sum() + course.linear.abs().sum() + bend.abs().sum();
    path.grown(margin + reach + course.drift(reach).at(1.0) + PLANE * size)
}
