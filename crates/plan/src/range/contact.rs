//! Cells in which two bodies always meet: a point that stays inside both.

use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Vector3};

use super::search::Search;
use crate::extremes::Extremes;
use lin_canny::{Outcome, PointOutcome, PointQuery};

/// Steps of the search for a deep point, their first length in units of the smaller radius, and its
/// factor after a step that does not lead deeper.
const SINKING: usize = 40;
const FIRST_STEP: f64 = 0.25;
const SHORTER: f64 = 0.8;

impl Search<'_> {
    /// Returns whether the bodies are proven closer than they must be all over the cell.
    pub(super) fn is_blocked(&mut self, found: &Outcome) -> bool {
        let moved = self.moved();
        let rounding = self.room.posed.rounding;
        if found.upper + moved + rounding <= self.kept {
            return true;
        }
        if found.lower > 0.0 {
            return false;
        }
        let shapes = self.shapes;
        let queries = shapes.map(PointQuery::new);
        let b = self.room.posed.b;
        let middle = 0.5 * (found.point_on_a.coords + (b * found.point_on_b).coords);
        let deep = self.deepest(&queries, &b, middle);
        let mut points = std::vec![deep, middle];
        let screws = &self.room.posed.screws;
        points.extend(screws.iter().filter(|s| s.is_turn && s.half > 0.0).map(|screw| {
            // A point of the axis does not move.
            screw.origin + screw.axis * screw.axis.dot(&(deep - screw.origin))
        }));
        if points.iter().any(|x| self.stays_inside(&queries, &b, x)) {
            return true;
        }
        if self.kept == 0.0 && !depths_of(&queries, &b, &deep).iter().all(|depth| *depth > rounding) {
            self.answer.flat += 1;
        }
        false
    }

    /// Returns whether a point fixed to one of the links stays inside both bodies.
    fn stays_inside(&mut self, queries: &[PointQuery<'_>; 2], b: &Isometry3<f64>, x: &Vector3<f64>) -> bool {
        let depths = depths_of(queries, b, x);
        let rounding = self.room.posed.rounding;
        let room = &mut self.room;
        (0..room.posed.rotations.len()).any(|frame| {
            let ways = room.bounds.point_moved(&room.posed, frame, x);
            (0..2).all(|k| depths[k] - ways[k] > rounding)
        })
    }

    /// Returns a point deep inside both bodies, by steps away from the nearer surface.
    fn deepest(&self, queries: &[PointQuery<'_>; 2], b: &Isometry3<f64>, start: Vector3<f64>) -> Vector3<f64> {
        let radii: Vec<f64> = self.bodies.iter().map(|body| body.parts[0].ball.1).collect();
        let is_plane = self.bodies[1].plane.is_some();
        let least = if is_plane { radii[0] } else { radii[0].smaller(radii[1]) };
        let (mut x, mut step) = (start, FIRST_STEP * least);
        let mut best = (f64::INFINITY, start);
        for _ in 0..SINKING {
            let [Some(in_a), Some(in_b)] = depths(queries, b, &x) else {
                break;
            };
            let (height, outward) = if in_a.distance > in_b.distance {
                (in_a.distance, in_a.normal.into_inner())
            } else {
                (in_b.distance, b.rotation * in_b.normal.into_inner())
            };
            if height < best.0 {
                best = (height, x);
            } else {
                step *= SHORTER;
            }
            x -= outward * step;
        }
        best.1
    }
}

/// Returns lower bounds of how deep a point of A's frame is inside both bodies.
fn depths_of(queries: &[PointQuery<'_>; 2], b: &Isometry3<f64>, x: &Vector3<f64>) -> [f64; 2] {
    depths(queries, b, x).map(|found| found.map_or(0.0, |found| -found.upper))
}

/// Returns the signed distances of a point of A's frame from both bodies.
fn depths(queries: &[PointQuery<'_>; 2], b: &Isometry3<f64>, x: &Vector3<f64>) -> [Option<PointOutcome>; 2] {
    let point = Point3::from(*x);
    [
        queries[0].closest_point(&point).ok(),
        queries[1].closest_point(&b.inverse_transform_point(&point)).ok(),
    ]
}
