//! Changes of the world of a checker between queries.
//!
//! A change costs what it changes: the pairs of one body. The trackers of other pairs stay. After
//! [`Checker::forget`], answers equal those of a new checker of the same world, bit for bit.

use core::ops::{Deref, DerefMut};
use core::sync::atomic::{AtomicU64, Ordering};
use std::string::{String, ToString};
use std::vec::Vec;

use nalgebra::{Isometry3, Point3};

use crate::cell::world::{Changes, World};
use crate::check::checker::Checker;
use crate::check::pairs::Pairs;
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::names::{Select, WorldId, WorldPair};

/// The next number of a checker.
static NEXT: AtomicU64 = AtomicU64::new(1);

/// The world of a checker, to be changed: see [`Checker::world_mut`].
///
/// The checker takes the changes when this is dropped.
pub struct WorldMut<'a, C: ConfigurationSpace> {
    checker: &'a mut Checker<C>,
}

impl<C: ConfigurationSpace> Deref for WorldMut<'_, C> {
    type Target = World;

    fn deref(&self) -> &World {
        &self.checker.world
    }
}

impl<C: ConfigurationSpace> DerefMut for WorldMut<'_, C> {
    fn deref_mut(&mut self) -> &mut World {
        &mut self.checker.world
    }
}

impl<C: ConfigurationSpace> Drop for WorldMut<'_, C> {
    fn drop(&mut self) {
        self.checker.fault = self.checker.take_changes().err();
    }
}

/// Changes of the world.
impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the world to change it: obstacles, attached objects, excluded pairs, margins and
    /// paddings.
    ///
    /// The checker finds the pairs that changed; the others keep what they know. A whole world may
    /// be assigned as well: all its pairs are then measured again, without
    /// [boxes](Self::set_pair_boxes). If it does not fit the space, or if robot bodies are added,
    /// every call returns the error until another world is assigned.
    ///
    /// ```
    /// # use lin_canny::nalgebra::Isometry3;
    /// # use lin_canny::Shape;
    /// # use lin_canny_plan::{Checker, PlanError, RigidSpace, World};
    /// # let mut world = World::new();
    /// # world.robot_body("drone", Shape::ball(0.1)?);
    /// # let mut checker = Checker::new(RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?, world)?;
    /// let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let mast = checker.world_mut().add_obstacle("mast", Shape::ball(0.1)?, at(1.0))?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 0.8);
    /// checker.world_mut().move_obstacle("mast", at(2.0))?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 1.8);
    ///
    /// let mut world = checker.world_mut();
    /// world.remove_obstacle(mast)?;
    /// world.attach("drone", "load", Shape::ball(0.1)?, at(0.2), &["drone"])?;
    /// drop(world);
    /// assert!(checker.clearance(&q)?.is_none());
    /// assert_eq!(checker.world_mut().remove_obstacle(mast), Err(PlanError::Removed(mast)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn world_mut(&mut self) -> WorldMut<'_, C> {
        WorldMut { checker: self }
    }

    /// Removes an attached object, and leaves it as an obstacle where it is at a configuration.
    ///
    /// The obstacle has the name and the padding of the object, and a new id. Excluded pairs and
    /// margins of pairs end with the object.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid, if the body does not exist or is not
    /// attached, or if several attached objects have the name. Then nothing changes.
    pub fn detach_at<'a>(&mut self, body: impl Into<Select<'a>>, configuration: &[f64]) -> Result<WorldId, PlanError> {
        let found = self.world.select(body)?;
        let attached = found.iter().filter_map(|id| match *id {
            WorldId::Attached(k) => self.world.attached[k].as_ref().map(|object| (*id, object.clone())),
            _ => None,
        });
        let attached: Vec<_> = attached.collect();
        let (id, object) = match &attached[..] {
            [one] => one.clone(),
            [] => {
                let first = found.first().map_or(String::new(), |id| self.show(id).to_string());
                let kind = "an attached object";
                return Err(PlanError::Kind { body: first, kind });
            }
            [(_, first), ..] => {
                return Err(PlanError::Ambiguous {
                    name: first.name.clone(),
                    count: attached.len(),
                });
            }
        };
        let pose = self.pose(id, configuration)?;
        let mut world = self.world_mut();
        let padding = world.padding(id);
        let left = world.add_obstacle(object.name, object.geometry, pose)?;
        world.detach(id)?;
        if padding > 0.0 {
            world.pad(left, padding)?;
        }
        Ok(left)
    }

    /// Returns the pose of a body in the world at a configuration, of a moving obstacle at the time
    /// of [`set_time`](Self::set_time).
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid or the body does not exist.
    pub fn pose(&self, id: WorldId, configuration: &[f64]) -> Result<Isometry3<f64>, PlanError> {
        self.world.select(id)?;
        if self.world.obstacle_motion(id).is_some() {
            self.check_time()?;
        }
        Ok(*self.pairs.places.pose(id, &self.moving_poses(configuration)?))
    }

    /// Returns the pose of a link in the world at a configuration: the frame to which
    /// [`World::attach`] refers.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid or no link has this name.
    pub fn link_pose(&self, link: &str, configuration: &[f64]) -> Result<Isometry3<f64>, PlanError> {
        let body = self.world.body_of(self.world.frame(link)?);
        Ok(self.moving_poses(configuration)?[body])
    }

    /// Returns the poses of all bodies of the space and of all attached objects.
    fn moving_poses(&self, configuration: &[f64]) -> Result<Vec<Isometry3<f64>>, PlanError> {
        self.check_world()?;
        self.space.check(configuration)?;
        let mut poses = Vec::new();
        self.space.place(configuration, &mut poses);
        self.pairs.places.carry(&mut poses);
        Ok(poses)
    }
}

/// What a change of the world changes in the pairs.
impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the error of a world that does not fit the space.
    pub(crate) fn check_world(&self) -> Result<(), PlanError> {
        match &self.fault {
            // Motions have times of their own.
            None | Some(PlanError::PoseTime { .. }) => Ok(()),
            Some(fault) => Err(fault.clone()),
        }
    }

    /// Takes what changed in the world.
    fn take_changes(&mut self) -> Result<(), PlanError> {
        let changes = core::mem::take(&mut self.world.changes);
        let is_other = changes.owner != self.number || changes.robot || self.check_world().is_err();
        if is_other {
            // A world that was taken out before is another one when it comes back.
            self.number = Self::next_number();
        }
        self.world.changes.owner = self.number;
        if is_other {
            self.take_world()?;
        } else {
            self.take_pairs(changes)?;
        }
        self.time.map_or(Ok(()), |time| self.place_moving(time))
    }

    /// Measures the whole world.
    pub(crate) fn take_world(&mut self) -> Result<(), PlanError> {
        self.world.validate()?;
        let bodies = self.world.robot.len() + self.world.bare_frames();
        if self.space.bodies() != bodies {
            return Err(PlanError::Bodies {
                space: self.space.bodies(),
                world: bodies,
            });
        }
        let mut pairs = Pairs::new(&self.world, bodies);
        let middles = pairs.mover_balls.iter();
        let middles: Vec<_> = middles.map(|ball| ball.map_or(Point3::origin(), |b| b.0)).collect();
        for k in 0..self.world.attached.len() {
            pairs.set_attached(&self.world, k);
        }
        for k in 0..self.world.obstacles.len() {
            pairs.set_obstacle(&self.world, k)?;
        }
        pairs.step_boxes();
        pairs.take_margins(&self.world);
        pairs.made = self.pairs.made;
        self.space.set_middles(&middles);
        self.pairs = pairs;
        self.has_parts = self.world.has_parts();
        self.forget();
        self.set_all_pairs();
        Ok(())
    }

    /// Measures the bodies and pairs that changed.
    fn take_pairs(&mut self, changes: Changes) -> Result<(), PlanError> {
        for id in &changes.bodies {
            self.range_bodies.remove(id);
            match *id {
                WorldId::Obstacle(k) => self.pairs.set_obstacle(&self.world, k)?,
                WorldId::Attached(k) => self.pairs.set_attached(&self.world, k),
                WorldId::Robot(_) => {}
            }
        }
        if changes.bodies.iter().any(|id| matches!(id, WorldId::Obstacle(_))) {
            self.pairs.step_boxes();
        }
        changes.pairs_of.iter().for_each(|id| self.set_pairs(*id));
        changes.pairs.iter().for_each(|pair| self.set_pair(*pair));
        if changes.margin {
            for index in self.pairs.ordered() {
                self.pairs.all[index].kept = self.world.kept_distance(self.pairs.all[index].pair);
            }
        }
        self.has_parts = self.world.has_parts();
        self.pairs.take_margins(&self.world);
        Ok(())
    }

    /// Returns the number of a new checker.
    pub(crate) fn next_number() -> u64 {
        NEXT.fetch_add(1, Ordering::Relaxed)
    }

    /// Measures all pairs of a new checker, each set once.
    pub(crate) fn set_all_pairs(&mut self) {
        let ids = |count, id: fn(usize) -> WorldId| (0..count).map(id);
        let mut all: Vec<WorldId> = ids(self.world.robot.len(), WorldId::Robot).collect();
        all.extend(ids(self.world.attached.len(), WorldId::Attached));
        let movers = all.len();
        all.extend(ids(self.world.obstacles.len(), WorldId::Obstacle));
        self.pairs.all.reserve(movers * all.len() - movers * (movers + 1) / 2);
        for (k, &a) in all[..movers].iter().enumerate() {
            for &b in &all[k + 1..] {
                self.set_pair(WorldPair { a, b });
            }
        }
    }

    /// Measures the pairs of a body from now on, or does not if it was removed.
    fn set_pairs(&mut self, id: WorldId) {
        let robot = (0..self.world.robot.len()).map(WorldId::Robot);
        let attached = (0..self.world.attached.len()).map(WorldId::Attached);
        let mut partners: Vec<WorldId> = robot.chain(attached).collect();
        if !matches!(id, WorldId::Obstacle(_)) {
            partners.extend((0..self.world.obstacles.len()).map(WorldId::Obstacle));
        }
        for pair in partners.into_iter().filter_map(|other| WorldPair::new(id, other)) {
            self.set_pair(pair);
        }
    }

    /// Measures a pair from now on, or does not.
    fn set_pair(&mut self, pair: WorldPair) {
        let is_measured = [pair.a, pair.b].iter().all(|id| self.world.contains(*id))
            && !self.world.excluded.contains(&pair)
            && !self.is_rigid(pair);
        let kept = is_measured.then(|| self.world.kept_distance(pair));
        if let Some(index) = self.pairs.set(pair, kept) {
            self.hits.retain(|k| *k != index);
        }
    }

    /// Returns whether the bodies of a pair keep their relative pose at all configurations.
    fn is_rigid(&self, pair: WorldPair) -> bool {
        let places = &self.pairs.places;
        let [a, b] = [pair.a, pair.b].map(|id| places.mover(id).map(|mover| places.carrier(mover).0));
        match (a, b) {
            (Some(a), Some(b)) => a == b || self.space.is_rigid(a, b),
            _ => false,
        }
    }
}
