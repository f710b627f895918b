//! The deepest overlap of bodies at their current poses, for both engines.

use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{self, ClosestPair, Group, Scene};
use lin_canny::{Geometry, PairTracker, RelativePose};

use crate::{BodyId, SimulationError};

const STILL: Group = Group::new(0).unwrap();
const PUSHED: Group = Group::new(1).unwrap();

/// Two overlapping solids, with bounds of their penetration depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// The two bodies.
    pub bodies: [BodyId; 2],
    /// Lower bound: no shorter translation separates the bodies; zero if nothing is known.
    pub lower: f64,
    /// Upper bound: a translation of this length separates the bodies, so that they share no inner
    /// point.
    pub upper: f64,
}

/// A body at its current pose.
pub(crate) struct Member {
    pub(crate) body: BodyId,
    pub(crate) geometry: Geometry,
    /// Pose of the geometry in the world.
    pub(crate) pose: Isometry3<f64>,
    /// Whether the body is dynamic. Two bodies that are not dynamic are not tested.
    pub(crate) is_pushed: bool,
}

/// Returns the overlap with the greatest upper bound; `None` if no two solids share a point.
pub(crate) fn deepest(members: impl Iterator<Item = Member>) -> Result<Option<Overlap>, SimulationError> {
    let mut scene = Scene::new();
    let boxes = scene::PairQueries::none().boxes(true);
    scene.set_queries(PUSHED, PUSHED, boxes)?;
    scene.set_queries(PUSHED, STILL, boxes)?;
    for Member {
        body,
        geometry,
        pose,
        is_pushed,
    } in members
    {
        let member = match is_pushed {
            true => scene::Body::moving(geometry).group(PUSHED),
            false => scene::Body::fixed(geometry).group(STILL),
        };
        scene.insert(member.user_data(body.index() as u64), pose)?;
    }
    scene.step();
    let pairs = [PUSHED, STILL].map(|those| scene.pairs_within(PUSHED, those, 0.0));
    let mut deepest: Option<Overlap> = None;
    for list in pairs {
        for overlap in list?.iter().filter_map(|pair| measured(&scene, pair)) {
            if deepest.is_none_or(|found| overlap.upper > found.upper) {
                deepest = Some(overlap);
            }
        }
    }
    Ok(deepest)
}

/// Returns the depth of a pair; `None` if one of the two is a mesh that is not closed.
fn measured(scene: &Scene, pair: &ClosestPair) -> Option<Overlap> {
    let pose = RelativePose::new(scene.pose(pair.a)?, scene.pose(pair.b)?).ok()?;
    let found = PairTracker::new().penetration(scene.geometry(pair.a)?, scene.geometry(pair.b)?, &pose)?;
    let body = |id| Some(BodyId(scene.user_data(id)? as u32));
    Some(Overlap {
        bodies: [body(pair.a)?, body(pair.b)?],
        lower: found.lower,
        upper: found.upper,
    })
}
