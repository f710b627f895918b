//! The pairs of a checker, each with a tracker, and the boxes of the obstacles.

use std::collections::BTreeSet;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3};

use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::tolerance::PLACED;
use crate::world::{World, WorldId, WorldPair};
use lin_canny::broad::{Aabb, BodyId, BodyOptions, SweepAndPrune};
use lin_canny::motion::{MotionModel, Steady, Velocity};
use lin_canny::polyhedron::BoxHint;
use lin_canny::{Geometry, PairTracker};

/// Least length of a swept box, as a fraction of the segment, so that there are at most 128 boxes.
/// Not measured.
const SWEPT: f64 = 1.0 / 64.0;

/// A pair and its tracker.
pub(crate) struct TrackedPair {
    pub(crate) pair: WorldPair,
    pub(crate) tracker: PairTracker,
    /// Number of the configuration at which the pair was last measured.
    pub(crate) measured: u64,
    /// Index of the last stretch of the pair; belongs to another pair if there is none.
    stretch: usize,
    /// Value of `Pairs::forgotten` when the tracker was last reset.
    begun: u64,
}

/// A pair, and an interval of a segment in which the swept boxes of both overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub(crate) pair: usize,
    pub(crate) from: f64,
    pub(crate) until: f64,
}

/// All pairs that are measured.
pub(crate) struct Pairs {
    /// Index of the pair of a robot body and an obstacle; [`NONE`] for an excluded pair.
    table: Vec<u32>,
    pub(crate) all: Vec<TrackedPair>,
    /// Index of the first pair of two robot bodies.
    pub(crate) own: usize,
    obstacles: usize,
    boxes: SweepAndPrune,
    /// Obstacles found by a query.
    found: Vec<BodyId>,
    /// The motions of the obstacles, which are at rest.
    pub(crate) resting: Vec<Steady>,
    /// A ball around each robot body and each obstacle, in the frame of the shape.
    pub(crate) robot_balls: Vec<(Point3<f64>, f64)>,
    pub(crate) obstacle_balls: Vec<(Point3<f64>, f64)>,
    /// The greatest radius of a ball of the robot.
    pub(crate) robot_radius: f64,
    /// Number of calls of `forget`.
    forgotten: u64,
}

const NONE: u32 = u32::MAX;

impl Pairs {
    pub(crate) fn new(world: &World, is_rigid: impl Fn(usize, usize) -> bool) -> Result<Self, PlanError> {
        let mut pairs = Self {
            table: Vec::new(),
            all: Vec::new(),
            own: 0,
            obstacles: world.obstacles.len(),
            boxes: SweepAndPrune::new(),
            found: Vec::new(),
            resting: Vec::new(),
            robot_balls: world.robot.iter().map(|b| b.1.bounding_ball()).collect(),
            obstacle_balls: Vec::new(),
            robot_radius: 0.0,
            forgotten: 0,
        };
        pairs.robot_radius = pairs.robot_balls.iter().map(|b| b.1).fold(0.0, f64::larger);
        for (_, shape, pose) in &world.obstacles {
            pairs.obstacle(shape, pose)?;
        }
        pairs.boxes.step();
        for i in 0..world.robot.len() {
            for k in 0..world.obstacles.len() {
                let entry = pairs.add(&world.excluded, WorldPair::new(i, WorldId::Obstacle(k)));
                pairs.table.push(entry);
            }
        }
        pairs.own = pairs.all.len();
        for i in 0..world.robot.len() {
            for k in i + 1..world.robot.len() {
                if !is_rigid(i, k) {
                    pairs.add(&world.excluded, WorldPair::new(i, WorldId::Robot(k)));
                }
            }
        }
        Ok(pairs)
    }

    fn obstacle(&mut self, shape: &Geometry, pose: &Isometry3<f64>) -> Result<(), PlanError> {
        self.resting.push(Steady::new(pose, Velocity::default())?);
        let aabb = Aabb::from(shape.aabb_at(pose, &mut BoxHint::default()));
        // The box of a half-space is infinite.
        if aabb.validate().is_ok() {
            self.boxes.insert(&aabb, BodyOptions::fixed())?;
        } else {
            self.boxes.insert_unbounded(&aabb, BodyOptions::fixed())?;
        }
        self.obstacle_balls.push(shape.bounding_ball());
        Ok(())
    }

    fn add(&mut self, excluded: &BTreeSet<(WorldId, WorldId)>, pair: WorldPair) -> u32 {
        if excluded.contains(&(pair.a, pair.b)) {
            return NONE;
        }
        self.all.push(TrackedPair {
            pair,
            tracker: PairTracker::new(),
            measured: 0,
            stretch: 0,
            begun: 0,
        });
        self.all.len() as u32 - 1
    }

    /// Drops the cached state of all trackers; each is reset at its next query.
    pub(crate) fn forget(&mut self) {
        self.forgotten += 1;
    }

    /// Returns a pair with its tracker, reset if needed, and the obstacles.
    pub(crate) fn tracked(&mut self, index: usize) -> (&mut TrackedPair, &[Steady]) {
        let tracked = &mut self.all[index];
        if core::mem::replace(&mut tracked.begun, self.forgotten) != self.forgotten {
            tracked.tracker.reset();
        }
        (tracked, &self.resting)
    }

    /// Returns the index of the pair of a robot body and an obstacle, unless excluded.
    pub(crate) fn of(&self, body: usize, obstacle: usize) -> Option<usize> {
        let entry = self.table[body * self.obstacles + obstacle];
        (entry != NONE).then_some(entry as usize)
    }

    /// Appends the pairs of a robot body and the obstacles whose boxes overlap a box.
    pub(crate) fn near(&mut self, body: usize, swept: &Aabb, pairs: &mut Vec<usize>) -> Result<(), PlanError> {
        self.found.clear();
        self.boxes.overlapping(swept, &mut self.found)?;
        let found = self.found.iter().map(|id| id.index as usize);
        pairs.extend(found.filter_map(|k| self.of(body, k)));
        Ok(())
    }
}

impl Pairs {
    /// Appends the pairs of a robot body and the obstacles whose boxes overlap a swept box. Extends
    /// a stretch that ends at the start of the box.
    pub(crate) fn near_within(
        &mut self,
        body: usize,
        swept: &Aabb,
        (from, until): (f64, f64),
        stretches: &mut Vec<Stretch>,
    ) -> Result<(), PlanError> {
        self.found.clear();
        self.boxes.overlapping(swept, &mut self.found)?;
        for k in 0..self.found.len() {
            let Some(pair) = self.of(body, self.found[k].index as usize) else {
                continue;
            };
            let last = &mut self.all[pair].stretch;
            match stretches.get_mut(*last) {
                Some(stretch) if stretch.pair == pair && stretch.until == from => stretch.until = until,
                _ => {
                    *last = stretches.len();
                    stretches.push(Stretch { pair, from, until });
                }
            }
        }
        Ok(())
    }
}

impl WorldPair {
    /// Returns a pair with the smaller id first: `b` is an obstacle or a later robot body.
    pub(crate) fn new(body: usize, b: WorldId) -> Self {
        Self {
            a: WorldId::Robot(body),
            b,
        }
    }
}

/// Returns a span of at most `most` in which the pivot of a body deviates from the parabola of its
/// course by at most half the radius of the body.
pub(crate) fn even_span((centre, radius): (Point3<f64>, f64), model: &MotionModel, most: f64) -> f64 {
    let near = 0.5 * (radius + (centre - model.pivot).norm());
    let mut span = most;
    while model.shift.at(span) > near && span > SWEPT {
        span *= 0.5;
    }
    span
}

/// Returns a box that contains a body, grown by `margin`, during a motion that starts at `pose`.
///
/// The pivot stays within the hull of the control points of its parabola, up to the drift. No point
/// is farther from the pivot than the ball.
pub(crate) fn swept_box(
    (centre, radius): (Point3<f64>, f64),
    pose: &Isometry3<f64>,
    model: &MotionModel,
    span: f64,
    margin: f64,
) -> Aabb {
    let start = pose * model.pivot;
    let (way, bend) = (model.linear * span, model.acceleration * (0.5 * span * span));
    let ends = [start, start + way * 0.5, start + way + bend];
    let path = ends[1..]
        .iter()
        .fold(Aabb::new(start, start), |all, p| all.united(&Aabb::new(*p, *p)));
    let reach = radius + (centre - model.pivot).norm();
    let size = reach + start.coords.abs().sum() + way.abs().sum() + bend.abs().sum();
    path.grown(margin + reach + model.shift.at(span) + PLACED * size)
}
