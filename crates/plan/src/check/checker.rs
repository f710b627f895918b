//! The checker: proves segments free over their whole length.

use core::ops::Range;
use std::collections::BTreeMap;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3};

use crate::cell::Changes;
use crate::cell::range_body::RangeBody;
use crate::cell::{Cell, Named};
use crate::check::body_boxes::{GROWN, PlacedBox};
use crate::check::pairs::{BodyPoses, PairInterval, PairKey, Pairs, cut, cut_at_knots};
use crate::check::swept_boxes::Sweep;
use crate::check::verdict::{CheckWork, LeavingPair, Verdict};
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::carried::CarriedMotion;
use crate::motion::carried::PartMotion;
use crate::motion::space::{BodyBall, BodyMotion, ConfigurationSpace, SegmentMotion};
use crate::motion::tree::JointTree;
use crate::motion::tube::JointTube;
use crate::names::{CellBody, CellPair};
use lin_canny::impact::{Cast, CastOptions, Certificate, Impact, Tolerance, cast_with_certificates, cast_within};
use lin_canny::motion::Motion;
use lin_canny::separation::{Measurement, Separation};
use lin_canny::{EXTENT_MAX, MovingPair, Operand, RelativePose};

/// Width of the bracket of a contact, in units of the sum of both radii. Free segments that come
/// closer than this need more queries.
const CONTACT: f64 = 1.0 / (1u64 << 20) as f64;

/// Number of recent collisions that are tested first at the next configuration. The first few of
/// them are tested before any box.
pub(crate) const HITS: usize = 16;
pub(crate) const HITS_FIRST: usize = 2;

/// Least number of parts of a curve with a tube of joints, a power of two.
const TUBE_PARTS: u32 = 16;

/// Checks motions of a robot among obstacles, with one tracker per pair.
pub struct Checker<C> {
    pub(crate) space: C,
    pub(crate) cell: Cell,
    /// The number of this checker, which its cell has.
    pub(crate) number: u64,
    /// The error of a cell that does not fit the space, or of moving obstacles without a pose.
    pub(crate) fault: Option<PlanError>,
    pub(crate) pairs: Pairs,
    /// What all pairs must keep in addition: inside a tube.
    pub(crate) tube: f64,
    /// How much each coordinate may deviate: inside a tube of joints.
    pub(crate) joint_tube: Option<JointTube>,
    pub(crate) start_contact_margin: Option<f64>,
    /// The time at which configurations are queried.
    pub(crate) time: Option<f64>,
    pub(crate) work: CheckWork,
    /// Scratch memory: pairs to check, and poses.
    pub(crate) candidates: Vec<usize>,
    pair_intervals: Vec<PairInterval>,
    /// The boxes of the movers along the last motion.
    sweep: Sweep,
    pub(crate) poses: Vec<Isometry3<f64>>,
    /// The balls around the movers at a configuration, and the boxes that were needed.
    pub(crate) placed_balls: Vec<(Point3<f64>, f64)>,
    pub(crate) placed_boxes: Vec<Option<PlacedBox>>,
    /// Pairs that were not free at single configurations, the latest first.
    pub(crate) hits: Vec<usize>,
    /// Scratch memory: ranks among the recent collisions and distances of balls, with their pairs.
    pub(crate) order: Vec<(usize, f64, PairKey, usize)>,
    /// Distance within which the last clearance was found; the next search starts with it.
    pub(crate) reach: f64,
    /// Whether predicates run before distances.
    pub(crate) has_parts: bool,
    /// Bodies that proofs over ranges have prepared.
    pub(crate) range_bodies: BTreeMap<CellBody, RangeBody>,
}

impl Checker<JointTree> {
    /// Returns the checker of all robots of a cell: see [`Cell::add_robot`].
    ///
    /// For many cells of the same robots, keep their [space](Cell::space) and call [`new`](Self::new):
    /// the checkers then share it.
    ///
    /// # Errors
    /// Returns an error as [`Cell::space`] and [`new`](Self::new) do.
    pub fn of_robots(cell: Cell) -> Result<Self, PlanError> {
        Self::new(cell.space()?, cell)
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the checker of a robot in a cell.
    ///
    /// # Errors
    /// Returns an error if the space and the cell have different numbers of robot bodies, if a
    /// pose is out of range, or if two kinds of geometry cannot be measured.
    pub fn new(space: C, cell: Cell) -> Result<Self, PlanError> {
        let mut checker = Self {
            reach: 0.0,
            has_parts: false,
            pairs: Pairs::new(&Cell::new(), 0),
            space,
            cell,
            number: Self::next_number(),
            fault: None,
            tube: 0.0,
            joint_tube: None,
            start_contact_margin: None,
            time: None,
            work: CheckWork::default(),
            candidates: Vec::new(),
            pair_intervals: Vec::new(),
            sweep: Sweep::default(),
            poses: Vec::new(),
            placed_balls: Vec::new(),
            placed_boxes: Vec::new(),
            hits: Vec::new(),
            order: Vec::new(),
            range_bodies: BTreeMap::new(),
        };
        checker.cell.changes = Changes::default();
        checker.cell.changes.owner = checker.number;
        checker.take_cell()?;
        Ok(checker)
    }

    /// Returns another checker of the same robot and cell, for example for another thread.
    ///
    /// It has the margins, the accepted contacts, the time and the boxes of pairs of this checker, and
    /// no cached state: each answer has the bits of an answer after [`reset`](Self::reset).
    ///
    /// ```
    /// # use lin_canny::nalgebra::Isometry3;
    /// # use lin_canny::Shape;
    /// # use lin_canny_plan::{Checker, TranslationSpace, Cell};
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("drone", Shape::ball(0.1)?);
    /// # cell.add_obstacle("mast", Shape::ball(0.1)?, Isometry3::identity())?;
    /// # let space = TranslationSpace::new([[-4.0, 4.0]; 3], Default::default(), 1)?;
    /// # let mut checker = Checker::new(space, cell)?;
    /// checker.cell_mut().set_margin(0.5)?;
    /// let mut other = checker.fork()?;
    /// assert!(!other.is_free_at(&[0.6, 0.0, 0.0])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error as [`new`](Self::new) and [`set_time`](Self::set_time) do.
    pub fn fork(&self) -> Result<Self, PlanError>
    where
        C: Clone,
    {
        let mut other = Self::new(self.space.clone(), self.cell.clone())?;
        other.start_contact_margin = self.start_contact_margin;
        if let Some(time) = self.time {
            other.set_time(time)?;
        }
        for tracked in self.pairs.own.values().map(|k| &self.pairs.all[*k]) {
            if let Some(boxes) = &tracked.apart {
                other.pairs.set_apart(tracked.pair, boxes);
            }
        }
        Ok(other)
    }

    /// Accepts contacts at the start of a segment, for example of a part that is lifted from a
    /// table.
    ///
    /// A pair that is within this distance at the start of a segment, or overlaps by no more, is
    /// accepted if it is proven not to come closer than at the start, minus `2^-30` of the pair
    /// size, until it has left the margin. From then on it must keep its distance like any other
    /// pair. Sliding along a face is accepted too. [`Verdict::start_contacts`] lists such pairs. A
    /// contact with a moving obstacle is never accepted.
    ///
    /// The option acts on motions ([`certify`](Self::certify), [`is_free`](Self::is_free)), not on
    /// configurations ([`is_free_at`](Self::is_free_at)), tubes or
    /// [`clearance_along`](Self::clearance_along). To
    /// put a part down, certify the motion from the contact, in reverse.
    /// [`PairTracker::cast_from_contact`](lin_canny::PairTracker::cast_from_contact) gives the
    /// details. The default is `None`: no contact is accepted.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{Checker, JointMotion, RigidSpace, Cell};
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("part", solids::cuboid(Vector3::new(0.1, 0.1, 0.1))?);
    /// # let table = solids::cuboid(Vector3::new(1.0, 1.0, 0.1))?;
    /// # cell.add_obstacle("table", table, Isometry3::translation(0.0, 0.0, -0.1))?;
    /// # let mut checker = Checker::new(RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?, cell)?;
    /// let at = |x: f64, z: f64| [x, 0.0, z, 0.0, 0.0, 0.0, 1.0];
    /// let (table, above) = (at(0.0, 0.1), at(0.0, 0.5));
    /// assert!(!checker.certify(&JointMotion::segment(&table, &above))?.is_free());
    /// checker.set_start_contact_margin(Some(1e-3))?;
    /// let verdict = checker.certify(&JointMotion::segment(&table, &above))?;
    /// assert!(verdict.is_free() && verdict.start_contacts().len() == 1);
    /// assert!(checker.certify(&JointMotion::segment(&table, &at(0.5, 0.1)))?.is_free());
    /// assert!(!checker.certify(&JointMotion::segment(&table, &at(0.5, 0.09)))?.is_free());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the margin is negative or not finite.
    pub fn set_start_contact_margin(&mut self, margin: Option<f64>) -> Result<(), PlanError> {
        if let Some(value) = margin
            && !(0.0..=EXTENT_MAX).contains(&value)
        {
            let what = "start contact margin";
            return Err(PlanError::Value { what, value });
        }
        self.start_contact_margin = margin;
        Ok(())
    }

    /// Returns the margin within which contacts at the start of a segment are accepted.
    #[must_use]
    pub fn start_contact_margin(&self) -> Option<f64> {
        self.start_contact_margin
    }

    /// Returns the distance that a pair must keep, inside a tube as well.
    pub(crate) fn kept(&self, index: usize) -> f64 {
        in_tube(self.pairs.all[index].kept, self.tube)
    }

    /// Returns the distance that a pair must keep during an interval, inside a tube of joints as
    /// well.
    pub(crate) fn kept_along(&self, index: usize, segment: &C::Segment, interval: &Range<f64>) -> f64 {
        let kept = self.kept(index);
        let Some(tube) = &self.joint_tube else { return kept };
        let ball = |part: CellBody| {
            let mover = self.pairs.body_poses.mover(part)?;
            let (body, carried) = self.pairs.body_poses.carrier(mover);
            Some(BodyBall::new(self.pairs.ball(part), body, carried))
        };
        let pair = self.pairs.all[index].pair;
        let span = (interval.end - interval.start).next_up();
        let tube = tube.over(interval.start, span);
        let spread = ball(pair.a).and_then(|a| segment.spread(a, ball(pair.b), interval.start, span, &tube));
        kept + spread.unwrap_or(f64::INFINITY)
    }

    /// Returns the number of parts in which pairs are cast: more in a tube of joints, whose width
    /// depends on the configuration.
    pub(crate) fn parts(&self, segment: &C::Segment) -> u32 {
        let least = if self.joint_tube.is_none() { 1 } else { TUBE_PARTS };
        segment.parts().max(least)
    }

    /// Returns the intervals in which a pair is cast: equal parts of the times 0 to 1, cut where the
    /// motion of a moving obstacle changes.
    pub(crate) fn intervals(&self, index: usize, parts: u32) -> Vec<Range<f64>> {
        let obstacle = self.pairs.all[index].pair.b;
        let mut all = Vec::new();
        for Range { start, end } in parts_of_time(parts) {
            let mut from = start;
            for at in self.pairs.body_poses.knots(obstacle, start, end) {
                all.push(from..at);
                from = at;
            }
            all.push(from..end);
        }
        all
    }

    /// Returns whether a pair is one with a moving obstacle.
    pub(crate) fn is_moving(&self, index: usize) -> bool {
        self.cell.obstacle_motion(self.pairs.all[index].pair.b).is_some()
    }

    /// Sets the time on the clock at which configurations are queried: moving obstacles are at their
    /// poses at this time. Curves have times of their own.
    ///
    /// # Errors
    /// Returns an error if the time is not finite, or if a moving obstacle has no pose at this time
    /// ([`PlanError::PoseTime`]). Then nothing changes.
    pub fn set_time(&mut self, time: f64) -> Result<(), PlanError> {
        if !(time.abs() <= EXTENT_MAX) {
            let what = "time";
            return Err(PlanError::Value { what, value: time });
        }
        self.check_cell()?;
        self.place_moving(time)?;
        (self.time, self.fault) = (Some(time), None);
        Ok(())
    }

    /// Returns the time at which configurations are queried.
    #[must_use]
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    /// Returns an error if an obstacle moves, and there is no time to query configurations.
    pub(crate) fn check_time(&self) -> Result<(), PlanError> {
        self.fault.clone().map_or(Ok(()), Err)?;
        match self.time {
            Some(_) => Ok(()),
            None => self.cell.check_at_rest(),
        }
    }

    /// Puts all moving obstacles at their poses at a time.
    pub(crate) fn place_moving(&mut self, time: f64) -> Result<(), PlanError> {
        let each = self.cell.motions.keys().map(|&id| self.pose_at(id, time));
        let placed: Vec<(CellBody, Isometry3<f64>)> = each.collect::<Result<_, _>>()?;
        for (id, pose) in placed {
            if let CellBody::Obstacle(k) = id {
                self.pairs.place_obstacle(k, &pose);
            }
        }
        Ok(())
    }

    fn pose_at(&self, id: CellBody, time: f64) -> Result<(CellBody, Isometry3<f64>), PlanError> {
        let poses = self.cell.obstacle_motion(id);
        let pose = poses.and_then(|poses| poses.at(time));
        pose.map(|pose| (id, pose)).ok_or_else(|| self.no_pose(id, time))
    }

    pub(crate) fn no_pose(&self, id: CellBody, time: f64) -> PlanError {
        let [from, until] = self.cell.obstacle_motion(id).map_or([0.0; 2], |poses| poses.ends());
        PlanError::PoseTime {
            name: self.cell.name(id).into(),
            time,
            from,
            until,
        }
    }

    /// Sets the motions of the obstacles along a curve that runs between these times on the clock.
    pub(crate) fn set_parts(&mut self, times: [f64; 2]) -> Result<(), PlanError> {
        for (&id, poses) in &self.cell.motions {
            let CellBody::Obstacle(k) = id else { continue };
            let Some(parts) = poses.parts(times) else {
                let is_covered = poses.at(times[0]).is_some();
                return Err(self.no_pose(id, times[usize::from(is_covered)]));
            };
            self.pairs.body_poses.parts[k] = parts;
        }
        Ok(())
    }

    /// Returns an error if a moving obstacle has no pose between two times.
    pub(crate) fn check_poses(&self, times: [f64; 2]) -> Result<(), PlanError> {
        for (&id, poses) in &self.cell.motions {
            if let Some(time) = times.into_iter().find(|time| poses.at(*time).is_none()) {
                return Err(self.no_pose(id, time));
            }
        }
        Ok(())
    }

    /// Returns the configuration space.
    #[must_use]
    pub fn space(&self) -> &C {
        &self.space
    }

    /// Returns the cell.
    #[must_use]
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// Returns the name of a body.
    #[must_use]
    pub fn name(&self, part: CellBody) -> &str {
        self.cell.name(part)
    }

    /// Returns what prints a body, a pair, a [`NearPair`](crate::NearPair) or a [`Verdict`] with
    /// the names of the bodies: see [`Cell::show`].
    ///
    /// ```
    /// # use lin_canny::nalgebra::Isometry3;
    /// # use lin_canny::Shape;
    /// # use lin_canny_plan::{Checker, JointMotion, RigidSpace, Cell};
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("drone", Shape::ball(0.1)?);
    /// # cell.add_obstacle("mast", Shape::ball(0.1)?, Isometry3::identity())?;
    /// # let mut checker = Checker::new(RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?, cell)?;
    /// let [p, q] = [-1.0, 1.0].map(|x| [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    /// let verdict = checker.certify(&JointMotion::segment(&p, &q))?;
    /// assert!(checker.show(&verdict).to_string().starts_with("blocked by drone and mast, which meet at 0.4"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn show<'a, T>(&'a self, value: &'a T) -> Named<'a, T> {
        self.cell.show(value)
    }

    /// Returns the counts of work since the checker was made.
    #[must_use]
    pub fn work(&self) -> CheckWork {
        CheckWork {
            pairs_made: self.pairs.made,
            ..self.work
        }
    }

    /// Drops all cached state: the next call returns, bit for bit, what a new checker would.
    ///
    /// Call it before each configuration to make results independent of order, threads and
    /// machines. The call itself is cheap, but trackers then save no time between neighbouring
    /// configurations. Without it, classes and predicates are the same; only the last bits of
    /// distances may differ.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{Checker, RigidSpace, Cell};
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("plank", solids::cuboid(Vector3::new(0.5, 0.1, 0.1))?);
    /// # cell.add_obstacle("wall", solids::cuboid(Vector3::new(0.1, 1.0, 1.0))?, Isometry3::translation(2.0, 0.0, 0.0))?;
    /// # let space = RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?;
    /// # let mut checker = Checker::new(space, cell)?;
    /// # let [p, q] = [[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], [1.0, 0.1, 0.0, 0.0, 0.0, 0.6, 0.8]];
    /// let first = checker.clearance(&p)?;
    /// checker.clearance(&q)?;
    /// checker.reset();
    /// assert_eq!(checker.clearance(&p)?, first);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reset(&mut self) {
        self.pairs.reset();
        self.hits.clear();
        self.range_bodies.clear();
        self.reach = self.pairs.robot_radius;
    }

    /// Returns the verdict on a motion; `ends` if it is the segment between two configurations.
    pub(crate) fn judged(
        &mut self,
        segment: &C::Segment,
        ends: Option<[&[f64]; 2]>,
        any: bool,
    ) -> Result<Verdict, PlanError> {
        self.work.segments += 1;
        let mut pair_intervals = core::mem::take(&mut self.pair_intervals);
        let found = self.gather(segment, &mut pair_intervals).and_then(|()| {
            if any {
                // Any contact decides, so recent collisions come first.
                let recent = &self.hits[..self.hits.len().min(HITS_FIRST)];
                pair_intervals.sort_by_key(|s| !recent.contains(&s.pair));
            }
            self.judge(segment, ends, &pair_intervals, any)
        });
        self.pair_intervals = pair_intervals;
        if let Ok(Verdict::Free { .. }) = found {
            self.work.free += 1;
        }
        found
    }

    /// Collects the pairs whose swept boxes overlap, with their times; the earliest first.
    fn gather(&mut self, segment: &C::Segment, pair_intervals: &mut Vec<PairInterval>) -> Result<(), PlanError> {
        pair_intervals.clear();
        let parts = self.parts(segment);
        let longest = 1.0 / f64::from(parts);
        let kept = self.pairs.own.values().map(|&pair| self.pairs.all[pair].kept);
        let kept = kept.fold(0.0, f64::larger) + self.start_contact_margin.unwrap_or_default();
        let tube = if self.tube > 0.0 {
            self.tube.next_up() * GROWN
        } else {
            0.0
        };
        self.sweep.run(&self.pairs, segment, parts, |ball, time, span| {
            let Some(joints) = &self.joint_tube else { return tube };
            let spread = segment.spread(ball, None, time, span, &joints.over(time, span));
            tube + spread.unwrap_or(f64::INFINITY)
        });
        for mover in 0..self.pairs.mover_balls.len() {
            self.pairs.near_along(mover, &self.sweep, pair_intervals)?;
        }
        let pairs = &self.pairs;
        pair_intervals.extend(pairs.own.iter().filter_map(|(&(a, b), &pair)| {
            let near = self.sweep.overlap(a, b, kept)?;
            // A pair that is in contact at the start is followed until the end.
            let [from, until] = if self.start_contact_margin.is_none() {
                near
            } else {
                [0.0, 1.0]
            };
            let key = pairs.all[pair].key;
            Some(PairInterval { pair, key, from, until })
        }));
        if longest < 1.0 && self.start_contact_margin.is_none() {
            cut(pair_intervals, longest);
        }
        cut_at_knots(pair_intervals, &self.pairs);
        pair_intervals.sort_unstable_by(|x, y| x.from.total_cmp(&y.from).then(x.key.cmp(&y.key)));
        self.work.pairs += pair_intervals.len() as u64;
        Ok(())
    }

    /// Casts pair after pair, each up to the first contact found so far.
    fn judge(
        &mut self,
        segment: &C::Segment,
        ends: Option<[&[f64]; 2]>,
        pair_intervals: &[PairInterval],
        any: bool,
    ) -> Result<Verdict, PlanError> {
        let clearance = self.pairs.least_kept;
        let mut start_contacts = Vec::new();
        let (mut blocked, mut until) = (None, 1.0);
        for pair_interval in pair_intervals {
            if pair_interval.from > until {
                break;
            }
            let (k, end) = (pair_interval.pair, pair_interval.until.smaller(until));
            let is_start = pair_interval.from == 0.0 && !self.is_moving(k);
            let start_contact = self.start_contact_margin.filter(|_| is_start);
            let kept = self.kept_along(k, segment, &(pair_interval.from..pair_interval.until));
            let mut interval = pair_interval.from..end;
            if start_contact.is_none() {
                if self.apart_along(k, ends, kept) {
                    continue;
                }
                if !self.is_moving(k) {
                    let pair = self.pairs.all[k].pair;
                    let Some(near) = self.sweep.boxes_meet(&self.pairs, pair, &interval, kept) else {
                        continue;
                    };
                    interval = near;
                }
                let Some(from) = self.hulls_meet(k, segment, &interval, kept)? else {
                    continue;
                };
                interval.start = from;
            }
            let Range { start: from, end } = interval;
            let found = self.cast(k, segment, from..end, kept, start_contact, None)?;
            self.work.queries += u64::from(found.queries + found.proofs);
            let (safe, hit) = match found.impact {
                Impact::Miss => {
                    let pair = self.pairs.all[k].pair;
                    start_contacts.extend(found.start_contact.map(|contact| LeavingPair { pair, contact }));
                    continue;
                }
                Impact::AtStart { seen } => (from, Some((from, seen))),
                Impact::Hit { safe, hit, seen } => (safe, Some((hit, seen))),
                Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => {
                    // The contact may be at the end of the interval, where the motion is at rest.
                    let seen = self.contact_at(k, segment, end, kept)?;
                    (safe, seen.map(|seen| (end, seen)))
                }
                // A variant that is unknown here proves nothing.
                _ => (from, None),
            };
            blocked = Some(match hit {
                Some((t, seen)) => {
                    let pair = self.pairs.all[k].pair;
                    let points = [seen.point_on_a, seen.point_on_b];
                    let mut required = self.cell.required_distance(pair);
                    required.tube = (kept - required.distance).larger(0.0);
                    Verdict::Blocked {
                        free_until: safe,
                        contact_at: t,
                        piece: 0,
                        pair,
                        required,
                        witnesses: self.in_world(segment, pair, safe, points),
                        start_contacts: Vec::new(),
                    }
                }
                None => Verdict::Undecided {
                    free_until: safe,
                    piece: 0,
                    start_contacts: Vec::new(),
                },
            });
            until = safe;
            if any {
                self.remember_hit(k);
            }
            if any || !(until > 0.0) {
                break;
            }
        }
        let free = Verdict::Free {
            clearance,
            start_contacts: Vec::new(),
        };
        Ok(blocked.unwrap_or(free).on_piece(0, start_contacts))
    }

    /// Puts a pair first among the recent collisions.
    pub(crate) fn remember_hit(&mut self, index: usize) {
        self.hits.retain(|&k| k != index);
        self.hits.insert(0, index);
        self.hits.truncate(HITS);
    }

    /// Returns whether boxes prove a pair farther apart than a distance along a segment.
    fn apart_along(&mut self, index: usize, ends: Option<[&[f64]; 2]>, kept: f64) -> bool {
        let boxes = self.pairs.all[index].apart.as_ref();
        let is_apart = boxes
            .zip(ends)
            .is_some_and(|(boxes, ends)| boxes.apart_along(ends, kept));
        self.work.lookups += u64::from(is_apart);
        is_apart
    }

    /// Casts a pair along a segment. A contact at the start of the interval is accepted within
    /// `start_contact`.
    pub(crate) fn cast(
        &mut self,
        index: usize,
        segment: &C::Segment,
        interval: Range<f64>,
        margin: f64,
        start_contact: Option<f64>,
        trail: Option<&mut Vec<Certificate>>,
    ) -> Result<Cast, PlanError> {
        let (tracked, body_poses) = self.pairs.tracked(index);
        // Certificates must be in the world frame; other results may be in any frame.
        let (motion, partner) = motions(segment, body_poses, tracked.pair, interval.start, trail.is_some());
        let [a, b] = self.cell.shapes(tracked.pair);
        let mut pair = tracked.tracker.pair(a, b);
        let tolerance = contact_tolerance(&pair);
        let found = match (start_contact, trail) {
            (Some(contact), trail) => {
                let options = CastOptions::default()
                    .tolerance(tolerance)
                    .distance(margin)
                    .start_contact_margin(contact);
                let bodies = [a.into(), b.into()];
                tracked
                    .tracker
                    .cast_from_contact(bodies, &motion, &partner, interval, &options, trail)
            }
            (None, Some(trail)) => {
                cast_with_certificates(&mut pair, &motion, &partner, interval, tolerance, margin, trail)
            }
            (None, None) => cast_within(&mut pair, &motion, &partner, interval, tolerance, margin),
        };
        found.map_err(PlanError::from)
    }

    /// Returns the closest points of a pair at a time, if it is proven to be in contact or closer
    /// than it must keep.
    fn contact_at(
        &mut self,
        index: usize,
        segment: &C::Segment,
        time: f64,
        kept: f64,
    ) -> Result<Option<Measurement>, PlanError> {
        let (tracked, body_poses) = self.pairs.tracked(index);
        let pair = tracked.pair;
        let [pose_a, pose_b] = [pair.a, pair.b].map(|part| pose_of(segment, body_poses, part, time));
        let relative = RelativePose::new(&pose_a, &pose_b)?;
        let [a, b] = self.cell.shapes(pair);
        let mut pair = tracked.tracker.pair(a, b);
        let seen = pair.measure(&relative);
        Ok(pair.meets(&relative, kept, &seen).then_some(seen))
    }

    fn in_world(&self, segment: &C::Segment, pair: CellPair, time: f64, points: [Point3<f64>; 2]) -> [Point3<f64>; 2] {
        let body_poses = &self.pairs.body_poses;
        [(pair.a, points[0]), (pair.b, points[1])].map(|(part, point)| pose_of(segment, body_poses, part, time) * point)
    }
}

/// Returns the width of the bracket of a contact.
pub(crate) fn contact_tolerance(pair: &MovingPair<'_>) -> Tolerance {
    let radii = pair.ball(Operand::A).1 + pair.ball(Operand::B).1;
    Tolerance::Distance(CONTACT * radii)
}

/// Returns the motions of both bodies of a pair from a time on: in the world, or relative to the
/// last link that carries both.
pub(crate) fn motions<'a, M: SegmentMotion>(
    segment: &'a M,
    body_poses: &'a BodyPoses,
    pair: CellPair,
    start: f64,
    in_world: bool,
) -> (CarriedMotion<'a, M>, PartMotion<'a, M>) {
    let [body, other] = [pair.a, pair.b].map(|id| body_poses.mover(id));
    let body = body.unwrap_or_default();
    let stem = match other {
        Some(other) if !in_world => segment.stem(body_poses.carrier(body).0, body_poses.carrier(other).0),
        _ => 0,
    };
    let partner = match (other, pair.b) {
        (None, CellBody::Obstacle(k)) => match body_poses.part(k, start) {
            Some(part) => PartMotion::Moving(part),
            None => PartMotion::Obstacle(&body_poses.resting[k]),
        },
        _ => PartMotion::Robot(moving(segment, body_poses, other.unwrap_or_default(), stem)),
    };
    (moving(segment, body_poses, body, stem), partner)
}

/// Returns the pose of a body at a time.
fn pose_of<M: SegmentMotion>(segment: &M, body_poses: &BodyPoses, part: CellBody, time: f64) -> Isometry3<f64> {
    match (part, body_poses.mover(part)) {
        (CellBody::Obstacle(k), _) => match body_poses.part(k, time) {
            Some(part) => part.pose(time),
            None => body_poses.obstacle_poses[k],
        },
        (_, mover) => moving(segment, body_poses, mover.unwrap_or_default(), 0).pose(time),
    }
}

/// Returns equal parts of the times 0 to 1.
fn parts_of_time(count: u32) -> impl Iterator<Item = Range<f64>> {
    let at = move |k: u32| f64::from(k) / f64::from(count);
    (0..count).map(move |k| at(k)..at(k + 1))
}

/// Returns the motion of a body that moves with the robot, relative to a stem.
fn moving<'a, M: SegmentMotion>(
    segment: &'a M,
    body_poses: &'a BodyPoses,
    mover: usize,
    stem: usize,
) -> CarriedMotion<'a, M> {
    let (body, carried) = body_poses.carrier(mover);
    CarriedMotion {
        motion: BodyMotion { segment, body, stem },
        carried,
    }
}

/// Returns the distance that a pair must keep in a tube.
pub(crate) fn in_tube(kept: f64, tube: f64) -> f64 {
    match tube > 0.0 {
        true => (kept + tube).next_up(),
        false => kept,
    }
}
