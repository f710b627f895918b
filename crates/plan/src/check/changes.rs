//! Changes of the world of a checker between queries.
//!
//! A change costs what it changes: the pairs of one body. The trackers of other pairs stay. After
//! [`Checker::forget`], answers equal those of a new checker of the same world, bit for bit.

use std::string::{String, ToString};
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::check::checker::Checker;
use crate::check::pairs::{resting, swept};
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::motion::timed_poses::TimedPoses;
use crate::names::{Select, WorldId, WorldPair};
use lin_canny::Geometry;

/// Changes of the world.
impl<C: ConfigurationSpace> Checker<C> {
    /// Adds an obstacle at a pose in the world, and returns its id, which is never used again.
    ///
    /// ```
    /// # use lin_canny::nalgebra::Isometry3;
    /// # use lin_canny::Shape;
    /// # use lin_canny_plan::{Checker, PlanError, RigidSpace, World};
    /// # let mut world = World::new();
    /// # world.robot_body("drone", Shape::ball(0.1)?);
    /// # let mut checker = Checker::new(RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?, world)?;
    /// let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    /// let mast = checker.add_obstacle("mast", Shape::ball(0.1)?, Isometry3::translation(1.0, 0.0, 0.0))?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 0.8);
    /// checker.move_obstacle("mast", Isometry3::translation(2.0, 0.0, 0.0))?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 1.8);
    /// checker.remove_obstacle(mast)?;
    /// assert!(checker.clearance(&q)?.is_none());
    /// assert_eq!(checker.remove_obstacle(mast), Err(PlanError::Removed(mast)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the pose is invalid or the box of the obstacle is not finite. Then
    /// nothing changes.
    pub fn add_obstacle(
        &mut self,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        pose: Isometry3<f64>,
    ) -> Result<WorldId, PlanError> {
        let geometry = geometry.into();
        resting(&geometry, &pose)?;
        let id = self.world.obstacle(name, geometry, pose);
        self.obstacles_changed(&[id])?;
        self.set_pairs(id);
        Ok(id)
    }

    /// Adds an obstacle that moves, and returns its id, which is never used again: see
    /// [`World::moving_obstacle`](crate::World::moving_obstacle).
    ///
    /// # Errors
    /// Returns an error if the box of the obstacle is not finite, or if it has no pose at the time
    /// of [`set_time`](Self::set_time). Then nothing changes.
    pub fn add_moving_obstacle(
        &mut self,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        poses: TimedPoses,
    ) -> Result<WorldId, PlanError> {
        let geometry = geometry.into();
        resting(&geometry, &poses.poses()[0])?;
        swept(&geometry, &poses)?;
        if let Some(time) = self.time
            && poses.at(time).is_none()
        {
            let [from, until] = poses.ends();
            let name = name.to_string();
            return Err(PlanError::PoseTime {
                name,
                time,
                from,
                until,
            });
        }
        let id = self.world.moving_obstacle(name, geometry, poses);
        self.obstacles_changed(&[id])?;
        self.set_pairs(id);
        Ok(id)
    }

    /// Moves obstacles to a pose in the world, and returns them. An obstacle that moved is at rest
    /// from then on.
    ///
    /// # Errors
    /// As [`World::move_obstacle`](crate::World::move_obstacle), and if the box of an obstacle is
    /// not finite. Then nothing changes.
    pub fn move_obstacle<'a>(
        &mut self,
        bodies: impl Into<Select<'a>>,
        pose: Isometry3<f64>,
    ) -> Result<Vec<WorldId>, PlanError> {
        let bodies = bodies.into();
        for id in self.world.select(bodies)? {
            if let (WorldId::Obstacle(_), Some(geometry)) = (id, self.world.geometry(id)) {
                resting(geometry, &pose)?;
            }
        }
        let found = self.world.move_obstacle(bodies, pose)?;
        self.obstacles_changed(&found)?;
        Ok(found)
    }

    /// Replaces the geometry of obstacles, and returns them. Poses, names and ids stay.
    ///
    /// # Errors
    /// As [`World::replace_obstacle`](crate::World::replace_obstacle), and if the box of an obstacle
    /// is not finite. Then nothing changes.
    pub fn replace_obstacle<'a>(
        &mut self,
        bodies: impl Into<Select<'a>>,
        geometry: impl Into<Geometry>,
    ) -> Result<Vec<WorldId>, PlanError> {
        let (bodies, geometry) = (bodies.into(), geometry.into());
        for id in self.world.select(bodies)? {
            if let Some(pose) = self.world.obstacle_pose(id) {
                resting(&geometry, pose)?;
            }
            if let Some(poses) = self.world.obstacle_motion(id) {
                swept(&geometry, poses)?;
            }
        }
        let found = self.world.replace_obstacle(bodies, geometry)?;
        self.obstacles_changed(&found)?;
        Ok(found)
    }

    /// Removes obstacles, and returns their ids, which are never used again.
    ///
    /// # Errors
    /// As [`World::remove_obstacle`](crate::World::remove_obstacle).
    pub fn remove_obstacle<'a>(&mut self, bodies: impl Into<Select<'a>>) -> Result<Vec<WorldId>, PlanError> {
        let found = self.world.remove_obstacle(bodies)?;
        for id in &found {
            self.set_pairs(*id);
        }
        self.obstacles_changed(&found)?;
        Ok(found)
    }

    /// Attaches an object to a link, and returns its id, which is never used again.
    ///
    /// The object moves with the link in every query: see [`World::attach`](crate::World::attach).
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::{Shape, polyhedron::solids};
    /// # use lin_canny_plan::{Checker, RigidSpace, World};
    /// # let mut world = World::new();
    /// # world.robot_body("hand", Shape::ball(0.1)?);
    /// # world.obstacle("wall", solids::cuboid(Vector3::new(0.1, 1.0, 1.0))?, Isometry3::translation(1.0, 0.0, 0.0));
    /// # let mut checker = Checker::new(RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?, world)?;
    /// let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 0.8);
    /// let before = Isometry3::translation(0.3, 0.0, 0.0);
    /// checker.attach("hand", "part", Shape::ball(0.1)?, before, &["hand"])?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 0.5);
    /// let id = checker.detach_at("part", &q)?;
    /// assert_eq!(checker.world().obstacle_pose(id), Some(&before));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`World::attach`](crate::World::attach). Then nothing changes.
    pub fn attach(
        &mut self,
        link: &str,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        pose: Isometry3<f64>,
        touch_links: &[&str],
    ) -> Result<WorldId, PlanError> {
        let id = self.world.attach(link, name, geometry, pose, touch_links)?;
        self.attached_changed(&[id]);
        self.set_pairs(id);
        Ok(id)
    }

    /// Removes attached objects, and returns their ids, which are never used again.
    ///
    /// # Errors
    /// As [`World::detach`](crate::World::detach).
    pub fn detach<'a>(&mut self, bodies: impl Into<Select<'a>>) -> Result<Vec<WorldId>, PlanError> {
        let found = self.world.detach(bodies)?;
        for id in &found {
            self.set_pairs(*id);
        }
        self.attached_changed(&found);
        Ok(found)
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
        resting(&object.geometry, &pose)?;
        let padding = self.world.padding(id);
        self.detach(id)?;
        let left = self.add_obstacle(object.name, object.geometry, pose)?;
        if padding > 0.0 {
            self.pad(left, padding)?;
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
    /// [`attach`](Self::attach) refers.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid or no link has this name.
    pub fn link_pose(&self, link: &str, configuration: &[f64]) -> Result<Isometry3<f64>, PlanError> {
        let body = self.world.body_of(self.world.frame(link)?);
        Ok(self.moving_poses(configuration)?[body])
    }

    /// Returns the poses of all bodies of the space and of all attached objects.
    fn moving_poses(&self, configuration: &[f64]) -> Result<Vec<Isometry3<f64>>, PlanError> {
        self.space.check(configuration)?;
        let mut poses = Vec::new();
        self.space.place(configuration, &mut poses);
        self.pairs.places.carry(&mut poses);
        Ok(poses)
    }

    /// Excludes all pairs of a body of `a` and a body of `b`, which are then never measured.
    ///
    /// # Errors
    /// As [`World::exclude`](crate::World::exclude).
    #[doc(alias = "allow")]
    #[doc(alias = "allowed collision matrix")]
    pub fn exclude<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
    ) -> Result<Vec<WorldPair>, PlanError> {
        let pairs = self.world.exclude(a, b)?;
        pairs.iter().for_each(|pair| self.set_pair(*pair));
        Ok(pairs)
    }

    /// Includes all pairs of a body of `a` and a body of `b` again.
    ///
    /// # Errors
    /// As [`World::include`](crate::World::include).
    pub fn include<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
    ) -> Result<Vec<WorldPair>, PlanError> {
        let pairs = self.world.include(a, b)?;
        pairs.iter().for_each(|pair| self.set_pair(*pair));
        Ok(pairs)
    }

    /// Sets the padding of bodies: all their pairs must keep so much more.
    ///
    /// # Errors
    /// As [`World::pad`](crate::World::pad).
    pub fn pad<'a>(&mut self, bodies: impl Into<Select<'a>>, padding: f64) -> Result<Vec<WorldId>, PlanError> {
        let found = self.world.pad(bodies, padding)?;
        found.iter().for_each(|id| self.set_pairs(*id));
        self.margins_changed();
        Ok(found)
    }

    /// Sets or removes the explicit margin of all pairs of a body of `a` and a body of `b`.
    ///
    /// # Errors
    /// As [`World::set_pair_margin`](crate::World::set_pair_margin).
    pub fn set_pair_margin<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
        margin: Option<f64>,
    ) -> Result<Vec<WorldPair>, PlanError> {
        let pairs = self.world.set_pair_margin(a, b, margin)?;
        pairs.iter().for_each(|pair| self.set_pair(*pair));
        self.margins_changed();
        Ok(pairs)
    }
}

/// What a change of the world changes in the pairs.
impl<C: ConfigurationSpace> Checker<C> {
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

    fn obstacles_changed(&mut self, ids: &[WorldId]) -> Result<(), PlanError> {
        for id in ids {
            self.range_bodies.remove(id);
            if let WorldId::Obstacle(k) = *id {
                self.pairs.set_obstacle(&self.world, k)?;
            }
        }
        self.pairs.step_boxes();
        self.bodies_changed();
        if let Some(time) = self.time {
            self.place_moving(time)?;
        }
        Ok(())
    }

    fn attached_changed(&mut self, ids: &[WorldId]) {
        for id in ids {
            if let WorldId::Attached(k) = *id {
                self.pairs.set_attached(&self.world, k);
            }
        }
        self.bodies_changed();
    }

    fn bodies_changed(&mut self) {
        self.has_parts = self.world.has_parts();
        self.margins_changed();
    }

    pub(crate) fn margins_changed(&mut self) {
        self.pairs.take_margins(&self.world);
    }
}
