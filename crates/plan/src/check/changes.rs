//! Changes of the cell of a checker between queries.
//!
//! A change costs what it changes: the pairs of one body. The trackers of other pairs stay. After
//! [`Checker::reset`], answers equal those of a new checker of the same cell, bit for bit.

use core::ops::{Deref, DerefMut};
use core::sync::atomic::{AtomicU64, Ordering};
use std::string::{String, ToString};
use std::vec::Vec;

use nalgebra::{Isometry3, Point3};

use crate::cell::{Cell, Changes, resting};
use crate::check::checker::Checker;
use crate::check::pairs::Pairs;
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::names::{CellBody, CellPair, Select};

/// The next number of a checker.
static NEXT: AtomicU64 = AtomicU64::new(1);

/// The cell of a checker, to be changed: see [`Checker::cell_mut`].
///
/// The checker takes the changes when this is dropped.
pub struct CellMut<'a, C: ConfigurationSpace> {
    checker: &'a mut Checker<C>,
}

impl<C: ConfigurationSpace> Deref for CellMut<'_, C> {
    type Target = Cell;

    fn deref(&self) -> &Cell {
        &self.checker.cell
    }
}

impl<C: ConfigurationSpace> DerefMut for CellMut<'_, C> {
    fn deref_mut(&mut self) -> &mut Cell {
        &mut self.checker.cell
    }
}

impl<C: ConfigurationSpace> Drop for CellMut<'_, C> {
    fn drop(&mut self) {
        self.checker.fault = self.checker.take_changes().err();
    }
}

/// Changes of the cell.
impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the cell to change it: obstacles, attached objects, excluded pairs, margins and
    /// paddings.
    ///
    /// The checker finds the pairs that changed; the others keep what they know. A whole cell may
    /// be assigned as well: all its pairs are then measured again, without
    /// [boxes](Self::set_pair_boxes). If it does not fit the space, or if robot bodies are added,
    /// every call returns the error until another cell is assigned.
    ///
    /// ```
    /// # use lin_canny::nalgebra::Isometry3;
    /// # use lin_canny::Shape;
    /// # use lin_canny_plan::{Checker, PlanError, RigidSpace, Cell};
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("drone", Shape::ball(0.1)?);
    /// # let mut checker = Checker::new(RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1)?, cell)?;
    /// let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let mast = checker.cell_mut().add_obstacle("mast", Shape::ball(0.1)?, at(1.0))?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 0.8);
    /// checker.cell_mut().move_obstacle("mast", at(2.0))?;
    /// assert_eq!(checker.clearance(&q)?.unwrap().distance, 1.8);
    ///
    /// let mut cell = checker.cell_mut();
    /// cell.remove_obstacle(mast)?;
    /// cell.attach("drone", "load", Shape::ball(0.1)?, at(0.2), &["drone"])?;
    /// drop(cell);
    /// assert!(checker.clearance(&q)?.is_none());
    /// assert_eq!(checker.cell_mut().remove_obstacle(mast), Err(PlanError::Removed(mast)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cell_mut(&mut self) -> CellMut<'_, C> {
        CellMut { checker: self }
    }

    /// Removes an attached object, and leaves it as an obstacle where it is at a configuration.
    ///
    /// The obstacle has the name and the own padding of the object, and a new id. Excluded pairs and
    /// margins of pairs end with the object.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid, if the body does not exist or is not
    /// attached, or if several attached objects have the name. Then nothing changes.
    pub fn detach_at<'a>(&mut self, body: impl Into<Select<'a>>, configuration: &[f64]) -> Result<CellBody, PlanError> {
        let found = self.cell.select(body)?;
        let attached = found.iter().filter_map(|id| match *id {
            CellBody::Attached(k) => self.cell.attached[k].as_ref().map(|object| (*id, object.clone())),
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
        let mut cell = self.cell_mut();
        let padding = cell.own_padding(id);
        cell.detach(id)?;
        let left = cell.add_obstacle(object.name, object.geometry, pose)?;
        cell.pad(left, padding)?;
        Ok(left)
    }

    /// Returns the pose of a body in the world at a configuration, of a moving obstacle at the time
    /// of [`set_time`](Self::set_time).
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid or the body does not exist.
    pub fn pose(&self, id: CellBody, configuration: &[f64]) -> Result<Isometry3<f64>, PlanError> {
        self.cell.select(id)?;
        if self.cell.obstacle_motion(id).is_some() {
            self.check_time()?;
        }
        Ok(*self.pairs.body_poses.pose(id, &self.moving_poses(configuration)?))
    }

    /// Returns the pose of a link in the world at a configuration: the frame to which
    /// [`Cell::attach`] refers.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid or no link has this name.
    pub fn link_pose(&self, link: &str, configuration: &[f64]) -> Result<Isometry3<f64>, PlanError> {
        let body = self.cell.body_of(self.cell.frame(link)?);
        Ok(self.moving_poses(configuration)?[body])
    }

    /// Returns the poses of all bodies of the space and of all attached objects.
    fn moving_poses(&self, configuration: &[f64]) -> Result<Vec<Isometry3<f64>>, PlanError> {
        self.check_cell()?;
        self.space.check(configuration)?;
        let mut poses = Vec::new();
        self.space.place(configuration, &mut poses);
        self.pairs.body_poses.carry(&mut poses);
        Ok(poses)
    }
}

/// What a change of the cell changes in the pairs.
impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the error of a cell that does not fit the space.
    pub(crate) fn check_cell(&self) -> Result<(), PlanError> {
        match &self.fault {
            // Motions have times of their own.
            None | Some(PlanError::PoseTime { .. }) => Ok(()),
            Some(fault) => Err(fault.clone()),
        }
    }

    /// Takes what changed in the world.
    fn take_changes(&mut self) -> Result<(), PlanError> {
        let changes = core::mem::take(&mut self.cell.changes);
        let is_other = changes.owner != self.number || changes.robot || self.check_cell().is_err();
        if is_other {
            // A cell that was taken out before is another one when it comes back.
            self.number = Self::next_number();
        }
        self.cell.changes.owner = self.number;
        if is_other {
            self.take_cell()?;
        } else {
            self.take_pairs(changes)?;
        }
        self.time.map_or(Ok(()), |time| self.place_moving(time))
    }

    /// Measures the whole cell.
    pub(crate) fn take_cell(&mut self) -> Result<(), PlanError> {
        self.cell.validate()?;
        let bodies = self.cell.robot.len() + self.cell.bare_frames();
        if self.space.bodies() != bodies {
            return Err(PlanError::Bodies {
                space: self.space.bodies(),
                cell: bodies,
            });
        }
        let mut pairs = Pairs::new(&self.cell, bodies);
        let middles = pairs.mover_balls.iter();
        let middles: Vec<_> = middles.map(|ball| ball.map_or(Point3::origin(), |b| b.0)).collect();
        for k in 0..self.cell.attached.len() {
            pairs.set_attached(&self.cell, k);
        }
        for k in 0..self.cell.obstacles.len() {
            pairs.set_obstacle(&self.cell, k)?;
        }
        pairs.step_boxes();
        pairs.take_margins(&self.cell);
        pairs.made = self.pairs.made;
        self.space.set_middles(&middles);
        self.pairs = pairs;
        self.has_parts = self.cell.has_parts();
        self.reset();
        self.set_all_pairs();
        Ok(())
    }

    /// Measures the bodies and pairs that changed.
    fn take_pairs(&mut self, changes: Changes) -> Result<(), PlanError> {
        for id in &changes.bodies {
            self.range_bodies.remove(id);
            match *id {
                CellBody::Obstacle(k) => self.pairs.set_obstacle(&self.cell, k)?,
                CellBody::Attached(k) => self.pairs.set_attached(&self.cell, k),
                CellBody::Robot(_) => {}
            }
        }
        if changes.bodies.iter().any(|id| matches!(id, CellBody::Obstacle(_))) {
            self.pairs.step_boxes();
        }
        changes.pairs_of.iter().for_each(|id| self.set_pairs(*id));
        changes.pairs.iter().for_each(|pair| self.set_pair(*pair));
        if changes.margin {
            for index in self.pairs.ordered() {
                self.pairs.all[index].kept = self.cell.required_distance(self.pairs.all[index].pair).distance;
            }
        }
        self.has_parts = self.cell.has_parts();
        self.pairs.take_margins(&self.cell);
        Ok(())
    }

    /// Returns the number of a new checker.
    pub(crate) fn next_number() -> u64 {
        NEXT.fetch_add(1, Ordering::Relaxed)
    }

    /// Measures all pairs of a new checker, each set once.
    pub(crate) fn set_all_pairs(&mut self) {
        let ids = |count, id: fn(usize) -> CellBody| (0..count).map(id);
        let mut all: Vec<CellBody> = ids(self.cell.robot.len(), CellBody::Robot).collect();
        all.extend(ids(self.cell.attached.len(), CellBody::Attached));
        let movers = all.len();
        all.extend(ids(self.cell.obstacles.len(), CellBody::Obstacle));
        self.pairs.all.reserve(movers * all.len() - movers * (movers + 1) / 2);
        for (k, &a) in all[..movers].iter().enumerate() {
            for &b in &all[k + 1..] {
                self.set_pair(CellPair { a, b });
            }
        }
    }

    /// Measures the pairs of a body from now on, or does not if it was removed.
    fn set_pairs(&mut self, id: CellBody) {
        let robot = (0..self.cell.robot.len()).map(CellBody::Robot);
        let attached = (0..self.cell.attached.len()).map(CellBody::Attached);
        let mut partners: Vec<CellBody> = robot.chain(attached).collect();
        if !matches!(id, CellBody::Obstacle(_)) {
            partners.extend((0..self.cell.obstacles.len()).map(CellBody::Obstacle));
        }
        for pair in partners.into_iter().filter_map(|other| CellPair::new(id, other)) {
            self.set_pair(pair);
        }
    }

    /// Measures a pair from now on, or does not.
    fn set_pair(&mut self, pair: CellPair) {
        let is_measured = [pair.a, pair.b].iter().all(|id| self.cell.contains(*id))
            && !self.cell.excluded.contains_key(&pair)
            && !self.is_rigid(pair);
        let kept = is_measured.then(|| self.cell.required_distance(pair).distance);
        if let Some(index) = self.pairs.set(pair, kept) {
            self.hits.retain(|k| *k != index);
        }
    }

    /// Returns whether the bodies of a pair keep their relative pose at all configurations.
    fn is_rigid(&self, pair: CellPair) -> bool {
        let body_poses = &self.pairs.body_poses;
        let [a, b] = [pair.a, pair.b].map(|id| body_poses.mover(id).map(|mover| body_poses.carrier(mover).0));
        match (a, b) {
            (Some(a), Some(b)) => a == b || self.space.is_rigid(a, b),
            _ => false,
        }
    }
}
