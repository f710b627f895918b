//! The pairs of a checker, each with a tracker, and the boxes of the obstacles.

use std::boxed::Box;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3};

use crate::cell::{Cell, resting, swept};
use crate::check::apart::ApartBoxes;
use crate::check::body_boxes::{OwnBox, PlacedBox, placed_ball};
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::carried::Carried;
use crate::motion::timed_poses::PosePart;
use crate::names::{CellBody, CellPair};
use lin_canny::PairTracker;
use lin_canny::broad::{Aabb, BodyId, BodyOptions, SweepAndPrune};
use lin_canny::motion::{Motion, Steady, Velocity};

/// A pair and its tracker.
pub(crate) struct TrackedPair {
    pub(crate) pair: CellPair,
    /// The distance that the pair must keep.
    pub(crate) kept: f64,
    /// Orders the pairs: pairs with obstacles come first.
    pub(crate) key: PairKey,
    pub(crate) tracker: PairTracker,
    /// The tracker of the hulls of both bodies, once one of them is a mesh and was queried.
    pub(crate) hull_tracker: Option<Box<PairTracker>>,
    /// Boxes of joint values in which the pair is apart.
    pub(crate) apart: Option<Arc<ApartBoxes>>,
    /// Number of the configuration at which the pair was last measured.
    pub(crate) measured: u64,
    /// Value of `Pairs::forgotten` when the tracker was last reset.
    begun: u64,
}

/// Whether no body is an obstacle, and the pair. Unlike the index of a pair, it does not depend on
/// earlier changes of the cell.
pub(crate) type PairKey = (bool, CellPair);

/// A pair, and an interval of a segment in which the swept boxes of both overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairInterval {
    pub(crate) pair: usize,
    pub(crate) key: PairKey,
    pub(crate) from: f64,
    pub(crate) until: f64,
}

/// Cuts intervals at the multiples of a span.
pub(crate) fn cut(pair_intervals: &mut Vec<PairInterval>, span: f64) {
    for k in 0..pair_intervals.len() {
        let PairInterval { from, until, .. } = pair_intervals[k];
        let mut at = from + span - from % span;
        pair_intervals[k].until = until.smaller(at);
        while at < until {
            let next = at + span;
            pair_intervals.push(PairInterval {
                from: at,
                until: until.smaller(next),
                ..pair_intervals[k]
            });
            at = next;
        }
    }
}

/// Cuts intervals of moving obstacles where their motion changes.
pub(crate) fn cut_at_knots(pair_intervals: &mut Vec<PairInterval>, pairs: &Pairs) {
    for k in 0..pair_intervals.len() {
        let PairInterval { pair, from, until, .. } = pair_intervals[k];
        let obstacle = pairs.all[pair].pair.b;
        let mut last = k;
        for at in pairs.body_poses.knots(obstacle, from, until) {
            pair_intervals[last].until = at;
            last = pair_intervals.len();
            pair_intervals.push(PairInterval {
                from: at,
                until,
                ..pair_intervals[k]
            });
        }
    }
}

/// All pairs that are measured, and the bodies.
///
/// Bodies that move with the robot, the *movers*, are numbered: first the bodies of the space, then
/// the attached objects.
pub(crate) struct Pairs {
    /// For each obstacle, the index of its pair with each mover; [`NONE`] if it is not measured.
    rows: Vec<Vec<u32>>,
    /// The pairs; vacant ones keep their last content.
    pub(crate) all: Vec<TrackedPair>,
    vacant: Vec<usize>,
    /// Indices of the pairs of two movers, in the order of both.
    pub(crate) own: BTreeMap<(usize, usize), usize>,
    boxes: SweepAndPrune,
    /// The box of each obstacle in the broad phase, and the obstacle of each box.
    box_ids: Vec<Option<BodyId>>,
    of_box: Vec<usize>,
    pub(crate) obstacle_boxes: Vec<Aabb>,
    /// Obstacles found by a query.
    found: Vec<BodyId>,
    /// Pairs found by a query.
    pub(crate) near: Vec<usize>,
    /// The obstacles at their present poses.
    placed: Vec<PlacedObstacle>,
    pub(crate) body_poses: BodyPoses,
    /// A ball around each mover and each obstacle, in the frame of the shape; `None` for a mover
    /// without geometry.
    pub(crate) mover_balls: Vec<Option<(Point3<f64>, f64)>>,
    pub(crate) obstacle_balls: Vec<(Point3<f64>, f64)>,
    /// A box around each mover and each obstacle, along the axes of the frame of the shape.
    mover_own_boxes: Vec<OwnBox>,
    obstacle_own_boxes: Vec<OwnBox>,
    /// The greatest radius of a ball of a mover.
    pub(crate) robot_radius: f64,
    /// Whether all pairs must keep the margin of the cell and nothing else.
    pub(crate) is_uniform: bool,
    /// Upper bound of what a pair of each mover and an obstacle must keep.
    pub(crate) most_kept: Vec<f64>,
    /// Lower bound of what a pair must keep.
    pub(crate) least_kept: f64,
    /// Number of calls of `reset`.
    forgotten: u64,
    /// Number of pairs that were made, and of trackers with them.
    pub(crate) made: u64,
}

/// A ball and a box around an obstacle, in the world.
pub(crate) struct PlacedObstacle {
    pub(crate) ball: (Point3<f64>, f64),
    pub(crate) own_box: PlacedBox,
}

/// Where the bodies are.
pub(crate) struct BodyPoses {
    /// Number of bodies of the space.
    pub(crate) bodies: usize,
    /// The objects that are carried; those that were detached are at the first body.
    pub(crate) carried: Vec<Carried>,
    /// The motions of the obstacles, which are at rest, and their poses.
    pub(crate) resting: Vec<Steady>,
    pub(crate) obstacle_poses: Vec<Isometry3<f64>>,
    /// The motion of each obstacle along the present curve, in order of time; empty for those at
    /// rest.
    pub(crate) parts: Vec<Vec<PosePart>>,
}

impl BodyPoses {
    /// Returns the number of a body that moves with the robot.
    pub(crate) fn mover(&self, id: CellBody) -> Option<usize> {
        match id {
            CellBody::Robot(k) => Some(k),
            CellBody::Attached(k) => Some(self.bodies + k),
            CellBody::Obstacle(_) => None,
        }
    }

    /// Returns the motion of an obstacle along the present curve, from a time on; `None` if the
    /// obstacle is at rest.
    pub(crate) fn part(&self, obstacle: usize, time: f64) -> Option<&PosePart> {
        let parts = &self.parts[obstacle];
        let after = parts.partition_point(|part| part.from <= time);
        parts.get(after.saturating_sub(1))
    }

    /// Returns the times within an interval at which the motion of an obstacle changes.
    pub(crate) fn knots(&self, id: CellBody, from: f64, until: f64) -> impl Iterator<Item = f64> {
        let parts = match id {
            CellBody::Obstacle(k) => &self.parts[k][..],
            _ => &[],
        };
        let within = move |at: &f64| *at > from && *at < until;
        parts.iter().map(|part| part.from).filter(within)
    }

    /// Returns the body of the space that a mover is, or that carries it, and how.
    pub(crate) fn carrier(&self, mover: usize) -> (usize, Option<&Carried>) {
        match mover.checked_sub(self.bodies) {
            Some(k) => (self.carried[k].body, Some(&self.carried[k])),
            None => (mover, None),
        }
    }

    /// Appends the poses of the attached objects to those of the bodies of the space.
    pub(crate) fn carry(&self, poses: &mut Vec<Isometry3<f64>>) {
        poses.truncate(self.bodies);
        for carried in &self.carried {
            let pose = poses.get(carried.body).map(|body| carried.placed(body));
            poses.push(pose.unwrap_or_default());
        }
    }

    /// Returns the pose of a body, given those of all movers.
    pub(crate) fn pose<'a>(&'a self, id: CellBody, movers: &'a [Isometry3<f64>]) -> &'a Isometry3<f64> {
        match id {
            CellBody::Robot(k) => &movers[k],
            CellBody::Attached(k) => &movers[self.bodies + k],
            CellBody::Obstacle(k) => &self.obstacle_poses[k],
        }
    }
}

const NONE: u32 = u32::MAX;

/// Number of obstacles up to which the boxes of all of them are tested, without the broad phase.
const FEW: usize = 64;

/// Bodies.
impl Pairs {
    /// Returns the pairs of a cell without any pair; the caller adds attached objects, obstacles
    /// and pairs.
    pub(crate) fn new(cell: &Cell, bodies: usize) -> Self {
        let robot = cell.robot.iter().map(|b| Some(b.1.bounding_ball()));
        let mut mover_balls: Vec<_> = robot.collect();
        mover_balls.resize(bodies, None);
        let mut mover_own_boxes: Vec<_> = cell.robot.iter().map(|b| OwnBox::of(&b.1)).collect();
        mover_own_boxes.resize(bodies, OwnBox::NONE);
        let mut pairs = Self {
            rows: Vec::new(),
            all: Vec::new(),
            vacant: Vec::new(),
            own: BTreeMap::new(),
            boxes: SweepAndPrune::new(),
            box_ids: Vec::new(),
            of_box: Vec::new(),
            obstacle_boxes: Vec::new(),
            found: Vec::new(),
            near: Vec::new(),
            placed: Vec::new(),
            body_poses: BodyPoses {
                bodies,
                carried: Vec::new(),
                resting: Vec::new(),
                obstacle_poses: Vec::new(),
                parts: Vec::new(),
            },
            mover_balls,
            obstacle_balls: Vec::new(),
            mover_own_boxes,
            obstacle_own_boxes: Vec::new(),
            robot_radius: 0.0,
            is_uniform: true,
            most_kept: Vec::new(),
            least_kept: 0.0,
            forgotten: 0,
            made: 0,
        };
        pairs.measure_radius();
        pairs.take_margins(cell);
        pairs
    }

    fn measure_radius(&mut self) {
        let radii = self.mover_balls.iter().flatten().map(|ball| ball.1);
        self.robot_radius = radii.fold(0.0, f64::larger);
    }

    /// Sets, adds or removes an attached object; its pairs are not measured until they are set.
    pub(crate) fn set_attached(&mut self, cell: &Cell, index: usize) {
        while self.body_poses.carried.len() <= index {
            self.body_poses.carried.push(Carried {
                body: 0,
                pose: Isometry3::identity(),
                middle: Point3::origin(),
            });
            self.mover_balls.push(None);
            self.mover_own_boxes.push(OwnBox::NONE);
            for row in &mut self.rows {
                row.push(NONE);
            }
        }
        let mover = self.body_poses.bodies + index;
        self.mover_balls[mover] = None;
        if let Some(object) = &cell.attached[index] {
            let ball = object.geometry.bounding_ball();
            self.mover_balls[mover] = Some(ball);
            self.mover_own_boxes[mover] = OwnBox::of(&object.geometry);
            self.body_poses.carried[index] = Carried {
                body: cell.body_of(object.frame),
                pose: object.pose,
                middle: ball.0,
            };
        }
        self.measure_radius();
    }

    /// Sets, adds or removes an obstacle; its new pairs are not measured until they are set. The
    /// broad phase must make a step afterwards.
    pub(crate) fn set_obstacle(&mut self, cell: &Cell, index: usize) -> Result<(), PlanError> {
        while self.box_ids.len() <= index {
            self.box_ids.push(None);
            self.body_poses
                .resting
                .push(Steady::new(&Isometry3::identity(), Velocity::default())?);
            self.body_poses.obstacle_poses.push(Isometry3::identity());
            self.body_poses.parts.push(Vec::new());
            self.obstacle_boxes.push(Aabb::new(Point3::origin(), Point3::origin()));
            self.obstacle_balls.push((Point3::origin(), 0.0));
            self.obstacle_own_boxes.push(OwnBox::NONE);
            self.placed.push(PlacedObstacle {
                ball: (Point3::origin(), 0.0),
                own_box: PlacedBox::new(&OwnBox::NONE, &Isometry3::identity()),
            });
            self.rows.push(std::vec![NONE; self.mover_balls.len()]);
        }
        self.body_poses.parts[index].clear();
        let Some((_, shape, pose)) = &cell.obstacles[index] else {
            if let Some(id) = self.box_ids[index].take() {
                self.boxes.remove(id)?;
            }
            return Ok(());
        };
        let (steady, mut aabb) = resting(shape, pose)?;
        if let Some(poses) = cell.motions.get(&CellBody::Obstacle(index)) {
            aabb = swept(shape, poses)?;
        }
        let is_bounded = [&aabb, &self.obstacle_boxes[index]].map(|b| b.validate().is_ok());
        match self.box_ids[index] {
            Some(id) if is_bounded == [true; 2] => self.boxes.set_box(id, &aabb)?,
            known => {
                if let Some(id) = known {
                    self.boxes.remove(id)?;
                }
                let id = if is_bounded[0] {
                    self.boxes.insert(&aabb, BodyOptions::default().fixed(true))?
                } else {
                    self.boxes.insert_unbounded(&aabb, BodyOptions::default().fixed(true))?
                };
                let at = id.index as usize;
                self.of_box.resize(self.of_box.len().max(at + 1), 0);
                self.of_box[at] = index;
                self.box_ids[index] = Some(id);
            }
        }
        self.body_poses.resting[index] = steady;
        self.obstacle_boxes[index] = aabb;
        self.obstacle_balls[index] = shape.bounding_ball();
        self.obstacle_own_boxes[index] = OwnBox::of(shape);
        self.place_obstacle(index, pose);
        Ok(())
    }

    /// Puts an obstacle at a pose.
    pub(crate) fn place_obstacle(&mut self, index: usize, pose: &Isometry3<f64>) {
        self.body_poses.obstacle_poses[index] = *pose;
        self.placed[index] = PlacedObstacle {
            ball: placed_ball(self.obstacle_balls[index], pose),
            own_box: PlacedBox::new(&self.obstacle_own_boxes[index], pose),
        };
    }

    /// Puts obstacles that move at their poses at a time of the present curve.
    pub(crate) fn place_along(&mut self, time: f64) {
        for k in 0..self.placed.len() {
            if let Some(pose) = self.body_poses.part(k, time).map(|part| part.pose(time)) {
                self.place_obstacle(k, &pose);
            }
        }
    }

    /// Returns an obstacle at its present pose.
    pub(crate) fn placed(&self, obstacle: usize) -> &PlacedObstacle {
        &self.placed[obstacle]
    }

    /// Applies the changes of boxes.
    pub(crate) fn step_boxes(&mut self) {
        self.boxes.step();
    }

    /// Takes over what all pairs of the cell must keep; the pairs take theirs when they are set.
    pub(crate) fn take_margins(&mut self, cell: &Cell) {
        self.is_uniform = cell.paddings.is_empty() && cell.margins.is_empty();
        let (most, least) = cell.kept_bounds();
        let movers = (0..self.mover_balls.len()).map(|k| match k.checked_sub(self.body_poses.bodies) {
            Some(k) => CellBody::Attached(k),
            None => CellBody::Robot(k),
        });
        let is_uniform = self.is_uniform;
        let most = movers.map(|id| match is_uniform {
            true => most,
            false => (most + cell.padding(id)) * (1.0 + 8.0 * f64::EPSILON) + f64::MIN_POSITIVE,
        });
        self.most_kept = most.collect();
        self.least_kept = least;
    }
}

/// Pairs.
impl Pairs {
    fn entry(&self, pair: CellPair) -> Option<usize> {
        let a = self.body_poses.mover(pair.a)?;
        match pair.b {
            CellBody::Obstacle(k) => self.of(a, k),
            _ => self.own.get(&(a, self.body_poses.mover(pair.b)?)).copied(),
        }
    }

    /// Measures a pair from now on, or does not; updates what it must keep. Returns the index of a
    /// pair that is no longer measured.
    pub(crate) fn set(&mut self, pair: CellPair, kept: Option<f64>) -> Option<usize> {
        let known = self.entry(pair);
        let is_own = !matches!(pair.b, CellBody::Obstacle(_));
        let index = match (known, kept) {
            (None, None) => return None,
            (Some(index), Some(kept)) => {
                self.all[index].kept = kept;
                return None;
            }
            (Some(index), None) => {
                self.all[index].tracker = PairTracker::new();
                self.all[index].hull_tracker = None;
                self.vacant.push(index);
                Err(index)
            }
            (None, Some(kept)) => {
                self.made += 1;
                let tracked = TrackedPair {
                    pair,
                    kept,
                    key: (is_own, pair),
                    tracker: PairTracker::new(),
                    hull_tracker: None,
                    apart: None,
                    measured: 0,
                    begun: self.forgotten,
                };
                Ok(match self.vacant.pop() {
                    Some(index) => {
                        self.all[index] = tracked;
                        index
                    }
                    None => {
                        self.all.push(tracked);
                        self.all.len() - 1
                    }
                })
            }
        };
        let a = self.body_poses.mover(pair.a)?;
        match (pair.b, index) {
            (CellBody::Obstacle(k), index) => self.rows[k][a] = index.map_or(NONE, |index| index as u32),
            (b, Ok(index)) => {
                self.own.insert((a, self.body_poses.mover(b)?), index);
            }
            (b, Err(_)) => {
                self.own.remove(&(a, self.body_poses.mover(b)?));
            }
        }
        index.err()
    }

    /// Sets the boxes of joint values in which a pair is apart, if the pair is measured.
    pub(crate) fn set_apart(&mut self, pair: CellPair, boxes: &Arc<ApartBoxes>) {
        if let Some(index) = self.entry(pair) {
            self.all[index].apart = Some(boxes.clone());
        }
    }

    /// Returns the difference of the most and the least that pairs must keep.
    pub(crate) fn spread(&self) -> f64 {
        let kept = || self.own.values().map(|k| self.all[*k].kept);
        let most = self.most_kept.iter().copied().chain(kept()).fold(0.0, f64::larger);
        most - self.least_kept
    }

    /// Returns the ball around a body, in the frame of its shape.
    pub(crate) fn ball(&self, id: CellBody) -> (Point3<f64>, f64) {
        let ball = match (id, self.body_poses.mover(id)) {
            (CellBody::Obstacle(k), _) => Some(self.obstacle_balls[k]),
            (_, mover) => mover.and_then(|k| self.mover_balls[k]),
        };
        ball.unwrap_or((Point3::origin(), 0.0))
    }

    /// Returns the box around a mover, along the axes of the frame of its shape.
    pub(crate) fn mover_own_box(&self, mover: usize) -> &OwnBox {
        &self.mover_own_boxes[mover]
    }

    /// Returns the number of pairs.
    pub(crate) fn len(&self) -> usize {
        self.all.len() - self.vacant.len()
    }

    /// Appends the indices of all pairs with obstacles, in the order of their keys.
    pub(crate) fn with_obstacles(&self, pairs: &mut Vec<usize>) {
        for mover in 0..self.mover_balls.len() {
            pairs.extend((0..self.rows.len()).filter_map(|k| self.of(mover, k)));
        }
    }

    /// Returns the indices of all pairs, in the order of their keys.
    pub(crate) fn ordered(&self) -> Vec<usize> {
        let mut all = Vec::with_capacity(self.len());
        self.with_obstacles(&mut all);
        all.extend(self.own.values());
        all
    }

    /// Drops the cached state of all trackers; each is reset at its next query.
    pub(crate) fn reset(&mut self) {
        self.forgotten += 1;
    }

    /// Returns a pair with its tracker, reset if needed, and where the bodies are.
    pub(crate) fn tracked(&mut self, index: usize) -> (&mut TrackedPair, &BodyPoses) {
        let tracked = &mut self.all[index];
        if core::mem::replace(&mut tracked.begun, self.forgotten) != self.forgotten {
            tracked.tracker.reset();
            tracked.hull_tracker = None;
        }
        (tracked, &self.body_poses)
    }

    /// Returns the index of the pair of a mover and an obstacle, if it is measured.
    pub(crate) fn of(&self, mover: usize, obstacle: usize) -> Option<usize> {
        let entry = self.rows[obstacle][mover];
        (entry != NONE).then_some(entry as usize)
    }

    /// Appends the pairs of a mover and the obstacles whose boxes overlap a box.
    pub(crate) fn near(&mut self, mover: usize, swept: &Aabb, pairs: &mut Vec<usize>) -> Result<(), PlanError> {
        if self.rows.len() <= FEW {
            let near = (0..self.rows.len()).filter(|k| self.obstacle_boxes[*k].overlaps(swept));
            pairs.extend(near.filter_map(|k| self.of(mover, k)));
            return Ok(());
        }
        self.found.clear();
        self.boxes.overlapping(swept, &mut self.found)?;
        let found = self.found.iter().map(|id| self.of_box[id.index as usize]);
        pairs.extend(found.filter_map(|k| self.of(mover, k)));
        Ok(())
    }
}
