//! The bodies of a robot, the obstacles, and the pairs that may touch.

use std::string::{String, ToString};
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::error::PlanError;
use lin_canny::Geometry;

/// The bodies of a robot and the obstacles about it, of every kind of shape.
///
/// Bodies of the robot count in the order of the bodies of the configuration space. Shapes of a
/// rigid robot are given in the frame of the robot, shapes of an arm in the frame of their link.
#[derive(Clone, Debug, Default)]
pub struct World {
    pub(crate) robot: Vec<(String, Geometry)>,
    pub(crate) obstacles: Vec<(String, Geometry, Isometry3<f64>)>,
    pub(crate) excluded: Vec<(WorldId, WorldId)>,
}

/// A body of the robot or an obstacle, by its number in the order in which it was added;
/// [`World::name`] returns its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WorldId {
    /// A body of the robot, the first is 0.
    Robot(usize),
    /// An obstacle, the first is 0.
    Obstacle(usize),
}

/// Two parts: a body of the robot, and an obstacle or a later body of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct WorldPair {
    /// The body of the robot.
    pub a: WorldId,
    /// The obstacle, or another body of the robot.
    pub b: WorldId,
}

impl World {
    /// Returns a world without bodies.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a body of the robot.
    pub fn robot_body(&mut self, name: impl ToString, shape: impl Into<Geometry>) -> WorldId {
        self.robot.push((name.to_string(), shape.into()));
        WorldId::Robot(self.robot.len() - 1)
    }

    /// Adds an obstacle at a pose.
    pub fn obstacle(&mut self, name: impl ToString, shape: impl Into<Geometry>, pose: Isometry3<f64>) -> WorldId {
        self.obstacles.push((name.to_string(), shape.into(), pose));
        WorldId::Obstacle(self.obstacles.len() - 1)
    }

    /// Excludes all pairs of a body called `a` and a body called `b`: such pairs are never
    /// measured and may touch, such as adjacent links of an arm.
    ///
    /// # Errors
    /// A name that no body has.
    pub fn exclude(&mut self, a: &str, b: &str) -> Result<(), PlanError> {
        let [first, second] = [a, b].map(|name| self.named(name));
        for (name, list) in [(a, &first), (b, &second)] {
            if list.is_empty() {
                return Err(PlanError::Unnamed(name.to_string()));
            }
        }
        for &x in &first {
            self.excluded.extend(second.iter().map(|&y| (x.min(y), x.max(y))));
        }
        Ok(())
    }

    /// Returns the pairs that are excluded, the smaller part first.
    pub fn excluded(&self) -> impl ExactSizeIterator<Item = [WorldId; 2]> {
        self.excluded.iter().map(|&(a, b)| [a, b])
    }

    /// Returns the name of a part; empty for a part that does not exist.
    #[must_use]
    pub fn name(&self, part: WorldId) -> &str {
        match part {
            WorldId::Robot(k) => self.robot.get(k).map_or("", |b| &b.0),
            WorldId::Obstacle(k) => self.obstacles.get(k).map_or("", |b| &b.0),
        }
    }

    /// Returns name and shape of the bodies of the robot, in the order of the configuration space.
    pub fn robot_bodies(&self) -> impl ExactSizeIterator<Item = (&str, &Geometry)> {
        self.robot.iter().map(|(name, shape)| (name.as_str(), shape))
    }

    /// Returns name, shape and pose of the obstacles.
    pub fn obstacles(&self) -> impl ExactSizeIterator<Item = (&str, &Geometry, &Isometry3<f64>)> {
        self.obstacles
            .iter()
            .map(|(name, shape, pose)| (name.as_str(), shape, pose))
    }

    /// Returns the shapes of a pair.
    pub(crate) fn shapes(&self, pair: WorldPair) -> [&Geometry; 2] {
        [self.shape(pair.a), self.shape(pair.b)]
    }

    fn shape(&self, part: WorldId) -> &Geometry {
        match part {
            WorldId::Robot(k) => &self.robot[k].1,
            WorldId::Obstacle(k) => &self.obstacles[k].1,
        }
    }

    /// Returns whether a body is not convex: distances then cost many times a predicate.
    pub(crate) fn has_parts(&self) -> bool {
        let obstacles = self.obstacles.iter().map(|o| &o.1);
        let is_convex = |shape: &Geometry| matches!(shape, Geometry::Polyhedron(_) | Geometry::Convex(_));
        !self.robot.iter().map(|b| &b.1).chain(obstacles).all(is_convex)
    }

    pub(crate) fn is_excluded(&self, pair: WorldPair) -> bool {
        self.excluded.contains(&(pair.a.min(pair.b), pair.a.max(pair.b)))
    }

    fn named(&self, name: &str) -> Vec<WorldId> {
        let robot = self.robot.iter().enumerate().filter(|(_, b)| b.0 == name);
        let obstacles = self.obstacles.iter().enumerate().filter(|(_, b)| b.0 == name);
        let robot = robot.map(|(k, _)| WorldId::Robot(k));
        robot.chain(obstacles.map(|(k, _)| WorldId::Obstacle(k))).collect()
    }
}
