//! Signed distances of points from closed meshes, judged over the rationals: side and both bounds.
//!
//! Points are queried one by one, by a prepared query, by a tracker and in a batch. The instrument
//! `soak` uses this module.

use super::exact_place::Place;
use crate::near_points::{MESH_KINDS, POINT_KINDS, hard_mesh, hard_point, is_between, place};
use crate::rng::Rng;
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, PointOutcome, PointQuery, PointTracker};

/// Points of a mesh.
const EACH: usize = 12;

/// Promised width of the bounds, relative to the size of mesh and point.
const WIDTH: f64 = 2e-14;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Meshes.
        pub meshes: u64,
        /// Points outside, on and inside.
        pub places: [u64; 3],
    }
}

/// Plays a mesh.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let kind = rng.below(MESH_KINDS);
    let scale = *rng.pick(&[1.0, 1.0, 2e-100, 1e-30, 3e50, 1e99]);
    let soup = hard_mesh(kind, &mut rng).map(|p| p.map(|x| x * scale));
    let corners: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(&corners, &soup.triangles).map_err(|e| e.to_string())?;
    let (query, prepared) = (PointQuery::new(&mesh), PointQuery::new(&mesh).prepared());
    let mut tracker = PointTracker::new();
    let mut mix = Mix {
        meshes: 1,
        ..Mix::default()
    };
    let (mut points, mut found) = (Vec::new(), Vec::new());
    for _ in 0..EACH {
        let given = hard_point(&soup, rng.below(POINT_KINDS), &mut rng);
        let point = Point3::from(given);
        let told = |e: lin_canny::PointError| format!("mesh {kind} times {scale:e}, {given:?}: {e}");
        let one = query.closest_point(&point).map_err(told)?;
        // Coordinates below 2^-200 of the size count as zero.
        let flush = soup.radius() * 2f64.powi(-202);
        let p = given.map(|x| if x.abs() < flush { 0.0 } else { x });
        let truth = place(&soup, p, &mut rng);
        mix.places[truth as usize] += 1;
        let tracked = tracker.closest_point(&query, &point).map_err(told)?;
        for answer in [one, prepared.closest_point(&point).map_err(told)?, tracked] {
            let [low, high] = {
                let (x, y) = (answer.lower.abs(), answer.upper.abs());
                [x.min(y), x.max(y)]
            };
            let is_right = is_side(&answer, truth)
                && is_between(&soup, p, low, high)
                && high - low <= WIDTH * (soup.radius() + high);
            if !is_right {
                return Err(format!("mesh {kind} times {scale:e}, {given:?} {truth:?}: {answer:?}"));
            }
        }
        points.push(point);
        found.push(one);
    }
    let batch = prepared.closest_points(&points).map_err(|e| e.to_string())?;
    let differs = batch.iter().zip(&found).find(|(x, y)| x != y);
    differs.map_or(Ok(mix), |pair| {
        Err(format!("mesh {kind} times {scale:e}, batch and single: {pair:?}"))
    })
}

fn is_side(answer: &PointOutcome, truth: Place) -> bool {
    match truth {
        Place::Outside => answer.state == ContactState::Separated,
        Place::On => answer.state == ContactState::Touching,
        Place::Inside => answer.state == ContactState::Overlapping,
    }
}
