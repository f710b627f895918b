//! The serialised forms of worlds and curves (feature `serde`): lists, checked when they are read.
//! No field is left out: formats without field names need all of them.

use std::collections::BTreeMap;
use std::string::String;
use std::sync::Arc;
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::curve::JointCurve;
use crate::error::PlanError;
use crate::timed_poses::TimedPoses;
use crate::world::{AttachedObject, Frame, World, WorldId, WorldPair};
use lin_canny::Geometry;

/// A world as it is stored. Removed bodies keep their places, so that ids stay.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "World")]
pub(crate) struct StoredWorld {
    robot: Vec<(String, Geometry)>,
    frames: Vec<(String, Frame)>,
    attached: Vec<Option<AttachedObject>>,
    obstacles: Vec<Option<(String, Geometry, Isometry3<f64>)>>,
    #[serde(default)]
    motions: Vec<(WorldId, TimedPoses)>,
    excluded: Vec<WorldPair>,
    margin: f64,
    paddings: Vec<(WorldId, f64)>,
    margins: Vec<(WorldPair, f64)>,
}

impl From<World> for StoredWorld {
    fn from(world: World) -> Self {
        Self {
            robot: Arc::unwrap_or_clone(world.robot),
            frames: Arc::unwrap_or_clone(world.frames),
            attached: world.attached,
            obstacles: world.obstacles,
            motions: world.motions.into_iter().collect(),
            excluded: world.excluded.into_iter().collect(),
            margin: world.margin,
            paddings: world.paddings.into_iter().collect(),
            margins: world.margins.into_iter().collect(),
        }
    }
}

impl TryFrom<StoredWorld> for World {
    type Error = PlanError;

    fn try_from(stored: StoredWorld) -> Result<Self, PlanError> {
        let mut world = Self {
            robot: stored.robot.into(),
            frames: stored.frames.into(),
            attached: stored.attached,
            obstacles: stored.obstacles,
            motions: stored.motions.into_iter().collect(),
            hulls: BTreeMap::new(),
            excluded: stored.excluded.into_iter().collect(),
            margin: stored.margin,
            paddings: stored.paddings.into_iter().collect(),
            margins: stored.margins.into_iter().collect(),
        };
        world.validate()?;
        let bodies: Vec<WorldId> = world.bodies().map(|body| body.0).collect();
        bodies.into_iter().for_each(|id| world.note_hull(id));
        Ok(world)
    }
}

/// A curve as it is stored: its control points, the error of each coordinate, and its times on a
/// clock.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "JointCurve")]
pub(crate) struct StoredCurve {
    points: Vec<Vec<f64>>,
    errors: Vec<f64>,
    #[serde(default)]
    times: Option<[f64; 2]>,
}

impl From<JointCurve> for StoredCurve {
    fn from(curve: JointCurve) -> Self {
        Self {
            points: curve.control_points(),
            errors: (0..curve.coordinates()).map(|c| curve.bounds(c).error).collect(),
            times: curve.times(),
        }
    }
}

impl TryFrom<StoredCurve> for JointCurve {
    type Error = PlanError;

    fn try_from(stored: StoredCurve) -> Result<Self, PlanError> {
        let curve = Self::with_errors(&stored.points, &stored.errors)?;
        match stored.times {
            Some(times) => curve.with_times(times),
            None => Ok(curve),
        }
    }
}
