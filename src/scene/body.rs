//! The bodies of a scene: geometries, poses, groups, and all other values of a body that the stages
//! of a step read, table by table. The bounding balls of two bodies give a lower bound of their
//! distance.

use crate::base::motion::{Velocity, displacement};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{PoseError, RelativePose, is_unit};
use crate::base::tolerance::{CENTRE, LEAST_SQUARE, RADIUS_UP, ROUND_DOWN, ROUND_UP, SCENE_REACH};
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::broad;
use crate::broad::Aabb;
use crate::broad::slots::Slots;
#[cfg(feature = "meshes")]
use crate::nonconvex::contact::ConvexPatches;
use crate::pair_tracker::geometry::Geometry;
use crate::scene::budget::Travel;
use crate::scene::motion::{Moving, Sweep, Ticks};
use crate::scene::queries::Group;
use crate::scene::queries::Member;
use crate::scene::{BodyId, SceneError};
use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, Vector3};

/// A body to insert into a scene. Many bodies may share one geometry.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Body {
    /// The geometry, in the frame of the body.
    pub geometry: Geometry,
    /// The group of the body; group 0 by default.
    pub group: Group,
    /// Whether the body is fixed. Two fixed bodies are paired only if the queries of their groups
    /// include [`PairQueries::fixed`](field@super::PairQueries::fixed); a step counts the pairs
    /// left out. A fixed body has no velocity, but its pose may be set.
    pub fixed: bool,
    /// A number for the caller, for instance an index into a table of names; 0 by default. The
    /// scene stores the number and never uses it.
    pub user_data: u64,
}

impl Body {
    /// Returns a body that moves.
    ///
    /// The geometry is a [`ConvexPolyhedron`](crate::ConvexPolyhedron), a [`Shape`](crate::Shape),
    /// a [`Compound`](crate::Compound), a [`Mesh`](crate::Mesh), or an `Arc` of one of these.
    pub fn moving(geometry: impl Into<Geometry>) -> Self {
        Self {
            geometry: geometry.into(),
            group: Group::default(),
            fixed: false,
            user_data: 0,
        }
    }

    /// Returns a fixed body.
    ///
    /// Two fixed bodies are not paired by default. For parts of an assembly enable
    /// [`PairQueries::fixed`](field@super::PairQueries::fixed), or insert
    /// [`moving`](Self::moving) bodies.
    pub fn fixed(geometry: impl Into<Geometry>) -> Self {
        Self {
            fixed: true,
            ..Self::moving(geometry)
        }
    }

    /// Returns the body with another group.
    #[must_use]
    pub fn group(self, group: Group) -> Self {
        Self { group, ..self }
    }

    /// Returns the body with a number for the caller: see [`user_data`](field@Self::user_data).
    #[must_use]
    pub fn user_data(self, user_data: u64) -> Self {
        Self { user_data, ..self }
    }
}

/// The geometry of a body in a scene, with derived values.
#[derive(Clone, Debug)]
pub(super) struct BodySolid {
    pub(super) shape: Geometry,
    pub(super) ball: Ball,
    pub(super) group: Group,
    pub(super) fixed: bool,
    /// Whether the broad phase has a finite box of the body; false if the range of a query is
    /// infinite.
    pub(super) boxed: bool,
    pub(super) user_data: u64,
    /// The convex patches of a mesh or compound, if contacts are enabled.
    #[cfg(feature = "meshes")]
    pub(super) patches: Option<ConvexPatches>,
}

impl BodySolid {
    /// Returns the solid of a body, or an error if the geometry is too large for a scene.
    pub(super) fn new(body: Body) -> Result<Self, SceneError> {
        let reach = match &body.geometry {
            Geometry::Polyhedron(shape) => shape.vertex_points().fold(0.0, |m: f64, p| m.larger(p.coords.amax())),
            Geometry::HalfSpace(space) => space.offset().abs(),
            other => {
                let (centre, radius) = other.bounding_ball();
                centre.coords.amax() + radius
            }
        };
        if !(reach <= SCENE_REACH) {
            return Err(SceneError::TooLarge { reach });
        }
        Ok(Self {
            ball: Ball::about(&body.geometry),
            shape: body.geometry,
            group: body.group,
            fixed: body.fixed,
            boxed: true,
            user_data: body.user_data,
            #[cfg(feature = "meshes")]
            patches: None,
        })
    }

    /// Returns an upper bound of the distance of any point of the body from its origin.
    pub(super) fn reach(&self) -> f64 {
        (self.ball.centre.norm() + self.ball.radius) * RADIUS_UP
    }

    /// Returns an upper bound of the displacement of any point between two poses; `from` and `to`
    /// are the balls at these poses.
    #[inline]
    fn displacement(&self, [old, new]: [&Isometry3<f64>; 2], [from, to]: [&Ball; 2]) -> f64 {
        let shift = to.centre - from.centre;
        displacement(&shift, self.ball.radius, &old.rotation, &new.rotation)
            + self.ball.error(&old.translation.vector)
            + self.ball.error(&new.translation.vector)
    }

    /// Returns the key under which the body is counted.
    pub(super) fn member(&self) -> Member {
        (self.group, self.shape.kind(), self.fixed)
    }
}

/// All bodies of one scene. Tables are indexed by `BodyId::index`. An index is reused in the step
/// after the removal of its body at the earliest.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyTable {
    pub(super) slots: Slots,
    pub(super) solids: Vec<Option<BodySolid>>,
    pub(super) poses: Vec<Isometry3<f64>>,
    /// Bounding balls at the current poses.
    pub(super) balls: Vec<Ball>,
    pub(super) travels: Vec<Travel>,
    pub(super) hints: Vec<BoxHint>,
    /// The id of the body in the broad phase. The next table is the inverse: from the index of a
    /// proxy to the body.
    pub(super) proxies: Vec<broad::BodyId>,
    pub(super) body_of_proxy: Vec<u32>,
    /// Motions of the bodies; empty before the first velocity is set or the first tick starts.
    pub(super) moving: Vec<Moving>,
    /// Sweeps of the step being prepared, up to the last body that ever had one.
    pub(super) sweeps: Vec<Option<Sweep>>,
    /// Bodies that have a sweep.
    pub(super) swept: Vec<u32>,
    /// Bodies whose boxes contain the swept motion of the last step.
    pub(super) wide: Vec<u32>,
    pub(super) ticks: Ticks,
    /// Bodies whose boxes must be computed again, each listed once.
    pub(super) due: Vec<u32>,
    /// Bodies without any query that moved, but whose boxes were not updated; in ascending order.
    pub(super) stale: Vec<u32>,
    /// Number of the step being prepared.
    pub(super) step: u32,
}

impl BodyTable {
    pub(super) fn len(&self) -> usize {
        self.slots.len()
    }

    pub(super) fn index_of(&self, id: BodyId) -> Result<usize, SceneError> {
        self.slots.index_of(id).ok_or(SceneError::StaleBody { body: id })
    }

    #[inline]
    pub(super) fn lives(&self, i: usize) -> bool {
        self.slots.lives(i as u32)
    }

    /// Returns the group of the body at an index. Until the next step, a removed body keeps its
    /// group.
    pub(super) fn group(&self, index: u32) -> Option<Group> {
        self.solids[index as usize].as_ref().map(|s| s.group)
    }

    /// Returns the id of the body at an index. Until the next step, a removed body keeps its id.
    #[inline]
    pub(super) fn id(&self, index: u32) -> BodyId {
        self.slots.id(index)
    }

    pub(super) fn ids(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.slots.ids()
    }

    /// Appends a body that already has a proxy in the broad phase.
    pub(super) fn insert(
        &mut self,
        solid: BodySolid,
        pose: Isometry3<f64>,
        proxy: broad::BodyId,
        hint: BoxHint,
    ) -> BodyId {
        // The broad phase has rejected a body beyond the last index.
        let index = self.slots.vacant(usize::MAX).unwrap_or(u32::MAX);
        let i = index as usize;
        if i == self.poses.len() {
            self.make_room();
            self.solids.push(None);
            self.poses.push(pose);
            self.balls.push(solid.ball);
            self.travels.push(Travel::default());
            self.hints.push(hint);
            self.proxies.push(proxy);
            if !self.moving.is_empty() {
                self.moving.push(Moving::default());
            }
        }
        let id = self.slots.begin(index);
        self.poses[i] = pose;
        self.balls[i] = solid.ball.at(&pose);
        self.travels[i] = Travel::moved_in(self.step);
        self.hints[i] = hint;
        self.stop(i);
        self.solids[i] = Some(solid);
        self.set_proxy(index, proxy);
        id
    }

    /// Appends a row that was read from a file.
    #[cfg(feature = "serde")]
    pub(super) fn restore(
        &mut self,
        solid: Option<BodySolid>,
        pose: Isometry3<f64>,
        travel: Travel,
        hint: BoxHint,
        proxy: broad::BodyId,
    ) {
        self.balls.push(solid.as_ref().map_or(Ball::NONE, |s| s.ball.at(&pose)));
        self.solids.push(solid);
        self.poses.push(pose);
        self.travels.push(travel);
        self.hints.push(hint);
        self.proxies.push(proxy);
    }

    /// Reserves memory for an eighth more bodies, instead of doubling: these tables are most of the
    /// memory of a scene.
    fn make_room(&mut self) {
        let more = self.poses.len() / 8 + 16;
        if self.poses.len() == self.poses.capacity() {
            self.solids.reserve_exact(more);
            self.poses.reserve_exact(more);
            self.balls.reserve_exact(more);
            self.travels.reserve_exact(more);
            self.hints.reserve_exact(more);
            self.proxies.reserve_exact(more);
        }
    }

    /// Links a body and its proxy in the broad phase.
    pub(super) fn set_proxy(&mut self, index: u32, proxy: broad::BodyId) {
        let place = proxy.index as usize;
        if place >= self.body_of_proxy.len() {
            self.body_of_proxy.resize(place + 1, u32::MAX);
        }
        self.body_of_proxy[place] = index;
        self.proxies[index as usize] = proxy;
    }

    /// Makes the id stale at once. The index stays in use until the step ends.
    pub(super) fn remove(&mut self, index: usize) {
        self.slots.remove(index as u32);
        self.stop(index);
    }

    /// Returns the velocity of a body: zero unless set.
    pub(super) fn velocity(&self, i: usize) -> Velocity {
        self.moving.get(i).map_or_else(Velocity::default, |m| m.velocity)
    }

    /// Starts a tick. From now on every disturbance of a body is recorded, because pairs may sleep.
    pub(super) fn begin_tick(&mut self, length: f64, is_swept: bool) {
        self.moving.resize(self.poses.len(), Moving::default());
        self.ticks.begin(length, is_swept);
    }

    /// Sets the velocity of a body.
    pub(super) fn set_velocity(&mut self, i: usize, velocity: Velocity) {
        self.moving.resize(self.poses.len(), Moving::default());
        if self.moving[i].velocity != velocity {
            self.moving[i].velocity = velocity;
            self.disturb(i);
        }
    }

    /// Sets the velocity of a body that is inserted or removed to zero.
    fn stop(&mut self, i: usize) {
        if let Some(moving) = self.moving.get_mut(i) {
            *moving = Moving::default();
        }
        self.disturb(i);
        if let Some(sweep) = self.sweeps.get_mut(i) {
            *sweep = None;
        }
    }

    /// Returns whether the motion of a body changes in the step being prepared; true if unknown.
    #[inline]
    pub(super) fn is_disturbed(&self, index: u32) -> bool {
        let moving = self.moving.get(index as usize);
        moving.is_none_or(|m| m.is_disturbed(self.step))
    }

    /// Records that the motion of a body changes in the step being prepared.
    pub(super) fn disturb(&mut self, i: usize) {
        if let Some(moving) = self.moving.get_mut(i) {
            moving.disturb(self.step, self.ticks.is_pending);
        }
    }

    /// Sets the pose of a body, adds the displacement to its odometer, and marks its box as due.
    #[inline]
    pub(super) fn place(&mut self, i: usize, pose: &Isometry3<f64>) {
        let Some(solid) = &self.solids[i] else { return };
        if self.poses[i] == *pose {
            return;
        }
        let ball = solid.ball.at(pose);
        let way = solid.displacement([&self.poses[i], pose], [&self.balls[i], &ball]);
        self.disturb(i);
        self.keep_start(i);
        self.shift(i, pose, ball, way);
    }

    /// Moves a body by a tick.
    pub(super) fn advance(&mut self, i: usize, pose: &Isometry3<f64>, sweep: Option<Sweep>) {
        let Some(solid) = &self.solids[i] else { return };
        let ball = solid.ball.at(pose);
        let way = solid.displacement([&self.poses[i], pose], [&self.balls[i], &ball]);
        // A point may move away and come back within one tick.
        let farthest = sweep.map_or(way, |s| {
            way.larger(s.displacement(solid.reach(), self.ticks.length.abs()))
        });
        if let Some(sweep) = sweep {
            self.keep_sweep(i, sweep);
        }
        self.shift(i, pose, ball, farthest);
    }

    /// Stores the start pose of a body that a call moves after the tick, and not the tick.
    pub(super) fn keep_start(&mut self, i: usize) {
        if self.ticks.is_swept && self.sweeps.get(i).is_none_or(Option::is_none) {
            self.keep_sweep(i, self.sweep(i));
        }
    }

    fn keep_sweep(&mut self, i: usize, sweep: Sweep) {
        if i >= self.sweeps.len() {
            self.sweeps.resize(i + 1, None);
        }
        self.sweeps[i] = Some(sweep);
        self.swept.push(i as u32);
    }

    /// Sets the pose and the ball of a body; `way` is an upper bound of the displacement.
    #[inline]
    pub(super) fn shift(&mut self, i: usize, pose: &Isometry3<f64>, ball: Ball, way: f64) {
        self.travels[i].add(way, self.step);
        self.balls[i] = ball;
        self.poses[i] = *pose;
        self.mark_due(i);
    }

    /// Marks the box of a body, so that the next step computes it again.
    #[inline]
    pub(super) fn mark_due(&mut self, i: usize) {
        if self.travels[i].mark_due(self.step) {
            self.due.push(i as u32);
        }
    }

    /// Ends the step: indices of removed bodies become free.
    pub(super) fn end_step(&mut self) {
        let solids = &mut self.solids;
        self.slots.end_step(|index| solids[index] = None);
        self.due.clear();
        self.step = self.step.wrapping_add(1);
        self.ticks.end_step();
        self.wide.clear();
        for index in self.swept.drain(..) {
            // A body that was removed has lost its sweep.
            if self.sweeps[index as usize].take().is_some() {
                self.wide.push(index);
            }
        }
    }

    /// Marks the boxes that contain a swept motion of the last step as due.
    pub(super) fn narrow(&mut self) {
        for k in 0..self.wide.len() {
            let i = self.wide[k] as usize;
            if self.lives(i) {
                self.mark_due(i);
            }
        }
    }

    /// Returns the motion of a body over the tick of the step being prepared.
    pub(super) fn sweep(&self, i: usize) -> Sweep {
        let sweep = self.sweeps.get(i).copied().flatten();
        sweep.unwrap_or_else(|| Sweep {
            from: self.poses[i],
            velocity: Velocity::default(),
        })
    }

    /// Returns the reserved memory in bytes, without the geometries, which may be shared.
    pub(super) fn bytes(&self) -> usize {
        let words = [&self.body_of_proxy, &self.due, &self.stale, &self.swept, &self.wide];
        words.iter().map(|list| list.capacity() * 4).sum::<usize>()
            + self.slots.bytes()
            + self.solids.capacity() * size_of::<Option<BodySolid>>()
            + self.poses.capacity() * size_of::<Isometry3<f64>>()
            + self.balls.capacity() * size_of::<Ball>()
            + self.travels.capacity() * size_of::<Travel>()
            + self.hints.capacity() * size_of::<BoxHint>()
            + self.proxies.capacity() * size_of::<broad::BodyId>()
            + self.moving.capacity() * size_of::<Moving>()
            + self.sweeps.capacity() * size_of::<Option<Sweep>>()
    }
}

/// Returns an error if a pose is not a rigid motion, or moves a body out of the range of a scene.
#[inline]
pub(super) fn checked(pose: &Isometry3<f64>, body: Option<BodyId>) -> Result<(), SceneError> {
    // A comparison with NaN is false.
    let is_near = pose.translation.vector.iter().all(|t| t.abs() <= SCENE_REACH);
    if is_near && is_unit(pose) {
        return Ok(());
    }
    Err(refusal(pose, body))
}

/// Returns the reason why a pose is invalid.
#[cold]
fn refusal(pose: &Isometry3<f64>, body: Option<BodyId>) -> SceneError {
    if let Err(error) = RelativePose::from_isometry(pose) {
        return SceneError::Pose {
            body,
            error: as_only(error),
        };
    }
    // A finite translation that is too far out along the axis of its largest coordinate.
    let t = &pose.translation.vector;
    let axis = t.iamax();
    SceneError::TooFar {
        body,
        axis,
        value: t[axis],
    }
}

/// Returns the error with operand A. The pose was checked as that of B relative to the identity,
/// but here there is only one body.
fn as_only(error: PoseError) -> PoseError {
    use crate::base::pose::Operand;
    match error {
        PoseError::Translation { axis, value, .. } => PoseError::Translation {
            body: Operand::A,
            axis,
            value,
        },
        PoseError::Rotation { norm_squared, .. } => PoseError::Rotation {
            body: Operand::A,
            norm_squared,
        },
    }
}

/// Returns the box of a posed body, grown on every side.
#[inline]
pub(super) fn box_of(shape: &Geometry, pose: &Isometry3<f64>, growth: f64, hint: &mut BoxHint) -> Aabb {
    let (min, max) = shape.aabb_at(pose, hint);
    // Rounded up, so that the growths of both boxes of a pair add up to at least the largest
    // threshold.
    Aabb::new(min, max).grown(growth * ROUND_UP)
}

/// The radius of the ball of a half-space. It contains all points of the half-space that a body of
/// a scene can meet, because all bodies are within [`SCENE_REACH`] of their origins and of the
/// origin of the world.
const HALF_SPACE_REACH: f64 = 8.0 * SCENE_REACH;

/// A ball that contains a body, in one frame: centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub(super) centre: Vector3<f64>,
    pub(super) radius: f64,
}

impl Ball {
    /// Placeholder for an index without a body.
    #[cfg(feature = "serde")]
    pub(super) const NONE: Self = Self {
        centre: Vector3::new(0.0, 0.0, 0.0),
        radius: 0.0,
    };

    /// Returns a ball that contains a geometry, in its frame. The ball is centred at the origin of
    /// the frame, if this ball is at most 1.25 times as large as the ball around the centre of the
    /// box.
    pub(super) fn about(shape: &Geometry) -> Self {
        let (centre, radius) = match shape {
            Geometry::HalfSpace(space) => (space.foot(), HALF_SPACE_REACH),
            _ => shape.bounding_ball(),
        };
        let own = match shape {
            Geometry::Polyhedron(body) => about_origin(body),
            _ => (sqrt(centre.coords.norm_squared()) + radius) * RADIUS_UP,
        };
        if own <= 1.25 * radius || own == 0.0 {
            return Self {
                centre: Vector3::zeros(),
                radius: own,
            };
        }
        Self {
            centre: centre.coords,
            radius,
        }
    }

    /// Returns the ball at a pose of the body.
    #[inline]
    pub(super) fn at(&self, pose: &Isometry3<f64>) -> Self {
        let t = pose.translation.vector;
        if self.centre == Vector3::zeros() {
            return Self { centre: t, ..*self };
        }
        // If the norm of the quaternion is not exactly 1, the error of the centre is less than
        // CENTRE times the displacement.
        let centre = pose.rotation.coords.normalize();
        let turned = nalgebra::UnitQuaternion::new_unchecked(centre.into()) * self.centre;
        Self {
            centre: turned + t,
            radius: self.radius + self.error(&t),
        }
    }

    /// Returns an upper bound of the error of the posed centre.
    #[inline]
    pub(super) fn error(&self, t: &Vector3<f64>) -> f64 {
        let sum = |v: &Vector3<f64>| v.x.abs() + v.y.abs() + v.z.abs();
        if self.centre == Vector3::zeros() {
            0.0
        } else {
            CENTRE * (sum(&self.centre) + sum(t))
        }
    }
}

/// Returns the radius of the ball around the origin that contains a body.
fn about_origin(body: &ConvexPolyhedron) -> f64 {
    // Scaled, so that squares stay in range.
    let size = body.vertex_points().fold(0.0, |m: f64, p| m.larger(p.coords.amax()));
    if size == 0.0 {
        return 0.0;
    }
    let square = |p: Point3<f64>| (p.coords / size).norm_squared();
    size * sqrt(body.vertex_points().map(square).fold(0.0, f64::larger)) * RADIUS_UP
}

/// Returns a lower bound of the distance of the bodies in two balls; it may be negative.
#[inline]
pub(super) fn least_distance(a: &Ball, b: &Ball) -> f64 {
    let between = b.centre - a.centre;
    // Squares lose less than LEAST_SQUARE below the normal numbers.
    let squared = (between.norm_squared() - LEAST_SQUARE).at_least(0.0);
    sqrt(squared) * ROUND_DOWN - (a.radius + b.radius) * ROUND_UP
}
