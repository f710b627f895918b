//! Receipts of a step of a scene.

use std::collections::BTreeMap;

use super::distance::distance;
use super::error::ReceiptError;
use super::pair::{meeting, missing};
use super::scene::{Body, Scene, Way};
use super::{Claim, Receipt};
use crate::tolerance::RECEIPT;
use lin_canny::scene::{BodyId, PairResults};
use lin_canny::{ContactState, PairTracker, RelativePose};

impl Receipt {
    /// Returns the receipt of the last step of a scene: a distance or a common point of each pair
    /// that has a result, and the errors of those that have no receipt.
    ///
    /// `name` returns the name of a body. Bodies are stated at their poses in the world, so no pose
    /// may be set after the step. Both bounds of a distance are wider than those of the scene by 1e-12
    /// of the greatest coordinate, because the poses of a pair round; of meshes and compounds, by 2e-12.
    /// Pairs whose boxes are apart have no result and no line.
    ///
    /// A pair has no receipt if a body has none ([module](crate::receipt)), or if it touches or overlaps
    /// by less than rounding.
    ///
    /// # Errors
    /// Returns an error if no pair has a receipt ([`ReceiptError::Nothing`]).
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::scene::{Body, PairQueries, Scene};
    /// use lin_canny_plan::receipt::Receipt;
    ///
    /// let mut scene = Scene::with_queries(PairQueries::none().distance(1.0))?;
    /// for x in [0.0, 1.25, 2.0] {
    ///     let die = solids::cuboid(Vector3::repeat(0.5))?;
    ///     let pose = Isometry3::translation(x, 0.1 * x, 0.2 * x);
    ///     scene.insert(Body::moving(die), pose)?;
    /// }
    /// scene.step();
    /// let name = |id| format!("die {id}");
    /// let (receipt, without) = Receipt::step(&scene, name)?;
    /// assert!(without.is_empty(), "{without:?}");
    /// let text = receipt.to_string();
    /// assert!(text.contains("{\"distance\":[0,1],") && text.contains("{\"meet\":[1,2],"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn step(
        scene: &lin_canny::scene::Scene,
        name: impl Fn(BodyId) -> String,
    ) -> Result<(Self, Vec<ReceiptError>), ReceiptError> {
        let (mut stated, mut errors) = (Scene::default(), Vec::new());
        // The number of each body; `None` if it has no form in a receipt.
        let mut numbers: BTreeMap<BodyId, Option<usize>> = BTreeMap::new();
        let has_result = |pair: &PairResults<'_>| {
            let decided = pair.overlaps.or(pair.within).is_some();
            decided || pair.distance.is_some() || pair.outcome.is_some()
        };
        let mut pairs: Vec<PairResults<'_>> = scene.pairs().filter(has_result).collect();
        pairs.sort_unstable_by_key(|pair| (pair.a, pair.b));
        for id in pairs.iter().flat_map(|pair| [pair.a, pair.b]) {
            let (Some(geometry), Some(pose)) = (scene.geometry(id), scene.pose(id)) else {
                continue;
            };
            numbers.entry(id).or_insert_with(|| {
                let body = Body::new(&name(id), geometry, Way::Rests(*pose));
                let body = body.map_err(|error| errors.push(error)).ok()?;
                stated.bodies.push(body);
                Some(stated.bodies.len() - 1)
            });
        }
        let mut lines = Vec::new();
        for pair in &pairs {
            let ids = [pair.a, pair.b];
            let [Some(Some(a)), Some(Some(b))] = ids.map(|id| numbers.get(&id)) else {
                continue;
            };
            match line(scene, &stated, pair, [*a, *b]) {
                Ok(line) => lines.push(line),
                Err(error) => errors.push(error),
            }
        }
        match lines.is_empty() {
            true => Err(ReceiptError::Nothing),
            false => Ok((Self::of_scene(Claim::Lines, stated, lines), errors)),
        }
    }
}

/// Returns the line of a pair, with the bodies in the order of their numbers.
fn line(
    scene: &lin_canny::scene::Scene,
    stated: &Scene,
    pair: &PairResults<'_>,
    numbers: [usize; 2],
) -> Result<String, ReceiptError> {
    let ids = [pair.a, pair.b];
    let order = if numbers[0] < numbers[1] { [0, 1] } else { [1, 0] };
    let (pair_of, ids) = (order.map(|k| numbers[k]), order.map(|k| ids[k]));
    let refused = |why: &'static str| missing(stated, pair_of, 0.0, why);
    let [Some(x), Some(y)] = ids.map(|id| scene.pose(id)) else {
        return Err(refused("a body was removed"));
    };
    let relative = RelativePose::new(x, y).map_err(|_| refused("a pose is out of range"))?;
    let outcome = pair.outcome.map(|found| (found.state, [found.lower, found.upper]));
    let distance_of = pair.distance.map(|found| (found.state, [found.lower, found.upper]));
    let found = outcome.or(distance_of).or_else(|| {
        let [a, b] = ids.map(|id| scene.geometry(id));
        let seen = PairTracker::new().closest(a?, b?, &relative).outcome;
        Some((seen.state, [seen.lower, seen.upper]))
    });
    match found {
        Some((ContactState::Separated, [lower, upper])) => {
            let room = RECEIPT * stated.size();
            distance(stated, pair_of, [x, y], &relative, [lower - room, upper + room])
        }
        _ => meeting(stated, None, pair_of, None, 0.0),
    }
}
