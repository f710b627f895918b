//! The world: robot bodies, obstacles, and the pairs that may touch.

use std::collections::BTreeSet;
use std::string::{String, ToString};
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::error::PlanError;
use lin_canny::Geometry;

/// The bodies of a robot and its obstacles, of any kind of geometry.
///
/// Robot bodies must be added in the order of the bodies of the configuration space. The geometry
/// of a rigid robot is in the frame of the robot, the geometry of an arm in the frame of its link.
#[derive(Clone, Debug, Default)]
pub struct World {
    pub(crate) robot: Vec<(String, Geometry)>,
    pub(crate) obstacles: Vec<(String, Geometry, Isometry3<f64>)>,
    pub(crate) excluded: BTreeSet<(WorldId, WorldId)>,
}

/// A robot body or an obstacle, by its index in the order of insertion.
///
/// [`World::name`] returns its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WorldId {
    /// A robot body; the first is 0.
    Robot(usize),
    /// An obstacle; the first is 0.
    Obstacle(usize),
}

/// A pair: a robot body, and an obstacle or a later robot body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct WorldPair {
    /// The robot body.
    pub a: WorldId,
    /// The obstacle, or another robot body.
    pub b: WorldId,
}

impl World {
    /// Returns a world without bodies.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a robot body.
    pub fn robot_body(&mut self, name: impl ToString, shape: impl Into<Geometry>) -> WorldId {
        self.robot.push((name.to_string(), shape.into()));
        WorldId::Robot(self.robot.len() - 1)
    }

    /// Adds an obstacle at a pose in the world.
    pub fn obstacle(&mut self, name: impl ToString, shape: impl Into<Geometry>, pose: Isometry3<f64>) -> WorldId {
        self.obstacles.push((name.to_string(), shape.into(), pose));
        WorldId::Obstacle(self.obstacles.len() - 1)
    }

    /// Excludes all pairs of a body with the name `a` and a body with the name `b`.
    ///
    /// Excluded pairs are never measured and may touch, for example adjacent links of an arm.
    ///
    /// # Errors
    /// Returns an error if no body has one of the names.
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

    /// Excludes all pairs for which `is_excluded` returns true.
    ///
    /// ```
    /// # use lin_canny_plan::{World, WorldId};
    /// # use lin_canny::{Shape, nalgebra::Isometry3};
    /// let mut world = World::new();
    /// let [arm, hand] = ["arm", "hand"].map(|name| world.robot_body(name, Shape::ball(0.1).unwrap()));
    /// world.obstacle("post", Shape::ball(0.2)?, Isometry3::translation(1.0, 0.0, 0.0));
    /// // The robot is checked against the post only.
    /// world.exclude_if(|pair| matches!(pair.b, WorldId::Robot(_)));
    /// assert!(world.excluded().eq([[arm, hand]]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn exclude_if(&mut self, is_excluded: impl Fn(WorldPair) -> bool) {
        for k in 0..self.robot.len() {
            let robot = (k + 1..self.robot.len()).map(WorldId::Robot);
            let others = robot.chain((0..self.obstacles.len()).map(WorldId::Obstacle));
            let pairs = others.map(|b| WorldPair::new(k, b)).filter(|pair| is_excluded(*pair));
            self.excluded.extend(pairs.map(|pair| (pair.a, pair.b)));
        }
    }

    /// Returns the excluded pairs in ascending order, each with the smaller id first.
    pub fn excluded(&self) -> impl ExactSizeIterator<Item = [WorldId; 2]> {
        self.excluded.iter().map(|&(a, b)| [a, b])
    }

    /// Returns the name of a body; empty if the body does not exist.
    #[must_use]
    pub fn name(&self, part: WorldId) -> &str {
        match part {
            WorldId::Robot(k) => self.robot.get(k).map_or("", |b| &b.0),
            WorldId::Obstacle(k) => self.obstacles.get(k).map_or("", |b| &b.0),
        }
    }

    /// Returns name and geometry of the robot bodies, in the order of the configuration space.
    pub fn robot_bodies(&self) -> impl ExactSizeIterator<Item = (&str, &Geometry)> {
        self.robot.iter().map(|(name, shape)| (name.as_str(), shape))
    }

    /// Returns name, geometry and pose of the obstacles.
    pub fn obstacles(&self) -> impl ExactSizeIterator<Item = (&str, &Geometry, &Isometry3<f64>)> {
        self.obstacles
            .iter()
            .map(|(name, shape, pose)| (name.as_str(), shape, pose))
    }

    /// Returns the geometries of a pair.
    pub(crate) fn shapes(&self, pair: WorldPair) -> [&Geometry; 2] {
        [self.shape(pair.a), self.shape(pair.b)]
    }

    fn shape(&self, part: WorldId) -> &Geometry {
        match part {
            WorldId::Robot(k) => &self.robot[k].1,
            WorldId::Obstacle(k) => &self.obstacles[k].1,
        }
    }

    /// Returns whether a body is not convex, so that a distance costs many times a predicate.
    pub(crate) fn has_parts(&self) -> bool {
        let obstacles = self.obstacles.iter().map(|o| &o.1);
        let is_convex = |shape: &Geometry| matches!(shape, Geometry::Polyhedron(_) | Geometry::Convex(_));
        !self.robot.iter().map(|b| &b.1).chain(obstacles).all(is_convex)
    }

    fn named(&self, name: &str) -> Vec<WorldId> {
        let robot = self.robot.iter().enumerate().filter(|(_, b)| b.0 == name);
        let obstacles = self.obstacles.iter().enumerate().filter(|(_, b)| b.0 == name);
        let robot = robot.map(|(k, _)| WorldId::Robot(k));
        robot.chain(obstacles.map(|(k, _)| WorldId::Obstacle(k))).collect()
    }
}
