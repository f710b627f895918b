//! Cells in which the hulls of bodies meet that are not convex: pairs of nodes of their trees.

use std::collections::BTreeMap;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Vector3};

use super::search::Search;
use super::verdict::RangeCell;
use crate::cell::range_body::{Part, RangeBody};
use crate::extremes::Extremes;
use lin_canny::{ConvexPolyhedron, Outcome, RelativePose, Tracker};

/// Most pairs of parts that are tested in a cell.
const MOST: u32 = 4096;

/// Greatest displacement for which parts are tried, in units of the distance at the centre.
const NEAR: f64 = 16.0;

/// Convex bodies of leaves, made when they are needed.
type Leaves = [BTreeMap<usize, Option<ConvexPolyhedron>>; 2];

impl Search<'_> {
    /// Proves a cell by planes between parts of the bodies.
    ///
    /// If the surfaces stay apart over the cell, the bodies meet nowhere in it or everywhere. The
    /// distance at the centre says which.
    pub(super) fn by_parts(&mut self, cell: &mut RangeCell, found: &Outcome) -> bool {
        let has_parts = self.bodies.iter().any(|body| body.parts[0].has_children());
        if !has_parts || self.bodies[1].plane.is_some() || found.lower * NEAR < self.moved() {
            return false;
        }
        match self.parts_apart(&found.normal) {
            Some(bound) => self.is_free(cell, bound),
            None => false,
        }
    }

    /// Returns a lower bound of the distance of all parts over the cell, if it is beyond the target.
    fn parts_apart(&mut self, normal: &Vector3<f64>) -> Option<f64> {
        let bodies = self.bodies;
        let target = self.target();
        let mut leaves = Leaves::default();
        let mut stack = std::vec![[0, 0]];
        let (mut least, mut count) = (f64::INFINITY, 0);
        while let Some(pair) = stack.pop() {
            count += 1;
            if count > MOST {
                return None;
            }
            let parts = [0, 1].map(|k| &bodies[k].parts[pair[k]]);
            let bound = self.pair_apart(pair, normal, target, &mut leaves);
            if bound > target {
                least = least.smaller(bound);
                continue;
            }
            let larger = match parts.map(Part::has_children) {
                [false, false] => return None,
                [true, true] => usize::from(parts[1].ball.1 > parts[0].ball.1),
                [is_first, _] => usize::from(!is_first),
            };
            for child in parts[larger].children {
                let mut next = pair;
                next[larger] = child;
                stack.push(next);
            }
        }
        Some(least)
    }

    /// Returns a lower bound of the distance of two parts over the cell.
    fn pair_apart(&mut self, pair: [usize; 2], normal: &Vector3<f64>, target: f64, leaves: &mut Leaves) -> f64 {
        let bodies: [&RangeBody; 2] = self.bodies;
        let parts = [0, 1].map(|k| &bodies[k].parts[pair[k]]);
        let poses = [Isometry3::identity(), self.room.posed.b];
        let centres = [0, 1].map(|k| (poses[k] * parts[k].ball.0).coords);
        let radii = parts[0].ball.1 + parts[1].ball.1 + parts[0].radius + parts[1].radius;
        let between = centres[1] - centres[0];
        let apart = between.norm();
        let frames = self.frames();
        let room = &mut self.room;
        let balls = centres.map(|centre| (centre, 0.0));
        let mut best = room.bounds.balls_apart(&room.posed, balls).0 - radii - room.posed.rounding;
        if best > target {
            return best;
        }
        let mut normals: Vec<Vector3<f64>> = std::vec![*normal];
        if apart > 0.0 {
            normals.push(between / apart);
        }
        if !parts.iter().any(|part| part.has_children()) {
            normals.extend(leaf_normal(leaves, pair, parts, &room.posed.b));
        }
        room.bounds.prepare(&room.posed, parts);
        for n in normals.iter().rev() {
            for frame in frames.clone() {
                let found = room.bounds.gap(parts, false, frame, n, &room.half, true);
                best = best.larger(found.gap - room.posed.rounding);
                if best > target {
                    return best;
                }
            }
        }
        best
    }
}

/// Returns the normal of the closest points of two leaves.
fn leaf_normal(leaves: &mut Leaves, pair: [usize; 2], parts: [&Part; 2], b: &Isometry3<f64>) -> Option<Vector3<f64>> {
    let [of_a, of_b] = leaves;
    let a = of_a.entry(pair[0]).or_insert_with(|| convex(parts[0])).as_ref()?;
    let second = of_b.entry(pair[1]).or_insert_with(|| convex(parts[1])).as_ref()?;
    let pose = RelativePose::from_isometry(b).ok()?;
    let found = Tracker::new().closest(a, second, &pose);
    (found.lower > 0.0).then(|| found.normal.into_inner())
}

/// Returns the hull of the points of a part.
fn convex(part: &Part) -> Option<ConvexPolyhedron> {
    let points: Vec<Point3<f64>> = part.points.each().collect();
    let hull = match points[..] {
        [point] => ConvexPolyhedron::point(point),
        [start, end] => ConvexPolyhedron::segment(start, end),
        [_, _, _] => ConvexPolyhedron::polygon(&points),
        _ => ConvexPolyhedron::from_points(&points),
    };
    hull.or_else(|_| ConvexPolyhedron::polygon(&points)).ok()
}
