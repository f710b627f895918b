//! parry's GJK, started from the simplex of the last frame, over a hill-climbing support map.

use super::{ParryPose, Witnesses, pose, vectors};
use crate::body::edge_ids;
use crate::{Face, Point, Pose};
use parry3d_f64::math::Vector;
use parry3d_f64::query::gjk::{self, CsoPoint, GJKResult, VoronoiSimplex};
use parry3d_f64::shape::SupportMap;
use std::cell::Cell;

/// A body for [`GjkCached`]: points and, for each, its neighbours along edges, in one list.
#[derive(Clone, Debug)]
pub struct Climber {
    points: Vec<Vector>,
    /// Neighbours of point `i` are `neighbours[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Climber {
    /// Returns a body from its points and faces (merged or triangles). Climbing never visits points
    /// that no face uses.
    pub fn new(points: &[Point], faces: &[Face]) -> Self {
        let mut near = vec![Vec::new(); points.len()];
        for [i, j] in edge_ids(points.len(), faces) {
            near[i as usize].push(j);
            near[j as usize].push(i);
        }
        let mut first = vec![0];
        first.extend(near.iter().scan(0, |end, l| {
            *end += l.len() as u32;
            Some(*end)
        }));
        Self {
            points: vectors(points),
            first,
            neighbours: near.concat(),
        }
    }

    /// Returns a point from which climbing can start: one that has neighbours.
    fn start(&self) -> u32 {
        self.first.windows(2).position(|w| w[0] < w[1]).unwrap_or(0) as u32
    }

    /// Returns the farthest point along `dir`, climbing from `from`. On a convex body, a point
    /// without a better neighbour is the farthest.
    fn climb(&self, from: u32, dir: Vector) -> u32 {
        let mut at = from as usize;
        let mut height = self.points[at].dot(dir);
        loop {
            let here = at;
            for &k in &self.neighbours[self.first[here] as usize..self.first[here + 1] as usize] {
                let h = self.points[k as usize].dot(dir);
                if h > height {
                    (at, height) = (k as usize, h);
                }
            }
            if at == here {
                return at as u32;
            }
        }
    }
}

/// A climber with its current point.
struct Climbing<'a> {
    body: &'a Climber,
    at: Cell<u32>,
}

impl SupportMap for Climbing<'_> {
    fn local_support_point(&self, dir: Vector) -> Vector {
        self.at.set(self.body.climb(self.at.get(), dir));
        self.body.points[self.at.get() as usize]
    }
}

/// State of a pair between frames.
///
/// It contains the support vertices, and up to three pairs of points that span the last simplex,
/// each in its body's frame. Create a new one if a body changes.
#[derive(Clone)]
pub struct GjkCached {
    stand: Option<(u32, u32)>,
    kept: [(Vector, Vector); 3],
    count: usize,
    simplex: VoronoiSimplex,
}

impl Default for GjkCached {
    fn default() -> Self {
        Self {
            stand: None,
            kept: [(Vector::ZERO, Vector::ZERO); 3],
            count: 0,
            simplex: VoronoiSimplex::new(),
        }
    }
}

impl GjkCached {
    /// Returns distance and witness points from two world poses; `None` if the bodies overlap.
    pub fn closest(&mut self, a: &Climber, pose_a: &Pose, b: &Climber, pose_b: &Pose) -> Option<Witnesses> {
        let (world_a, world_b) = (pose(pose_a), pose(pose_b));
        let a_from_b = world_a.inv_mul(&world_b);
        let (at_a, at_b) = self.stand.unwrap_or_else(|| (a.start(), b.start()));
        let a = Climbing {
            body: a,
            at: Cell::new(at_a),
        };
        let b = Climbing {
            body: b,
            at: Cell::new(at_b),
        };
        self.warm(&a_from_b, &a, &b);
        let found = gjk::closest_points(&a_from_b, &a, &b, f64::MAX, true, &mut self.simplex);
        self.stand = Some((a.at.get(), b.at.get()));
        // A simplex that contains the origin cannot start the next frame.
        self.count = 0;
        let GJKResult::ClosestPoints(p, q, _) = found else {
            return None;
        };
        self.keep(&a_from_b);
        Some(Witnesses {
            distance: (q - p).length(),
            on_a: (world_a * p).into(),
            on_b: (world_a * q).into(),
        })
    }

    /// Puts the simplex of the last frame, at the pose of this frame, into the solver; without one,
    /// a first support point.
    fn warm(&mut self, a_from_b: &ParryPose, a: &Climbing, b: &Climbing) {
        let Some((first, more)) = self.kept[..self.count].split_first() else {
            self.simplex
                .reset(CsoPoint::from_shapes(a_from_b, a, b, a_from_b.translation));
            return;
        };
        let place = |&(p, q): &(Vector, Vector)| CsoPoint::new(p, *a_from_b * q);
        self.simplex.reset(place(first));
        for pair in more {
            // Rejected if the pose has made the simplex degenerate: then it is smaller, not wrong.
            let _ = self.simplex.add_point(place(pair));
        }
    }

    /// Stores at most a triangle of the solver's simplex.
    fn keep(&mut self, a_from_b: &ParryPose) {
        self.count = (self.simplex.dimension() + 1).min(3);
        for i in 0..self.count {
            let c = self.simplex.point(i);
            self.kept[i] = (c.orig1, a_from_b.inverse_transform_point(c.orig2));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parry::{Cloud, vector};
    use crate::rng::Rng;
    use crate::shapes;

    #[test]
    fn climbing_finds_what_scanning_finds() {
        let mut r = Rng::new(23);
        for s in [
            shapes::cone(64, 1.0, 0.3),
            shapes::icosphere(2),
            shapes::cuboid([1.0, 0.5, 0.1]),
        ] {
            let climber = Climber::new(&s.points, &s.faces);
            let mut at = climber.start();
            for _ in 0..500 {
                let d = vector(r.unit());
                at = climber.climb(at, d);
                let best = Cloud::new(&s.points).local_support_point(d).dot(d);
                assert!((climber.points[at as usize].dot(d) - best).abs() < 1e-14);
            }
        }
    }
}
