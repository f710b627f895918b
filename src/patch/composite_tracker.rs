//! The state of a surface and a body of convex pieces, and the queries: a tracker for each piece.

use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3};

use super::outcome::SurfaceWork;
use super::search::NetGoal;
use super::separation::BesideSurface;
use super::shape_tracker::{SurfaceShapeTracker, far_apart, lower_to};
use super::surface::Surface;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::composite::parts::Parted;
use crate::composite::parts::Placed;
use crate::composite::pieces::{Composite, Piece};
use crate::composite::separation::ball_about;
use crate::pair::spot::Answer;

/// The trackers of a surface and the pieces of a [`Composite`].
///
/// The counterpart of [`SurfaceShapeTracker`] for bodies of placed convex shapes: the surface is A
/// and the body B. A piece whose ball is farther away than the closest piece is not asked. Not
/// saved to files.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceCompositeTracker {
    pieces: Vec<SurfaceShapeTracker>,
    /// The piece that was closest.
    last: usize,
    splits: Option<usize>,
}

impl SurfaceCompositeTracker {
    /// Returns the work of all queries so far.
    pub(crate) fn work(&self) -> SurfaceWork {
        self.pieces.iter().fold(SurfaceWork::default(), |mut sum, piece| {
            sum += piece.work();
            sum
        })
    }

    /// Returns the number of entries of the fronts that are kept.
    pub(crate) fn front_len(&self) -> usize {
        self.pieces.iter().map(SurfaceShapeTracker::front_len).sum()
    }

    /// Returns the bytes kept on the heap, without those of shapes.
    #[must_use]
    pub(crate) fn heap_bytes(&self) -> usize {
        let own = self.pieces.capacity() * size_of::<SurfaceShapeTracker>();
        own + self.pieces.iter().map(SurfaceShapeTracker::heap_bytes).sum::<usize>()
    }
}

impl BesideSurface for SurfaceCompositeTracker {
    type Body = Composite;

    fn ball(body: &Composite) -> (Point3<f64>, f64) {
        ball_about(body.aabb())
    }

    fn allow(&mut self, splits: Option<usize>) {
        self.splits = splits;
    }

    /// Returns the closest points of all pieces with bounds as close as a goal asks for.
    fn answer(&mut self, a: &Surface, b: &Composite, a_from_b: &RelativePose, goal: NetGoal) -> Answer {
        let pieces = b.pieces();
        self.pieces.resize_with(pieces.len(), SurfaceShapeTracker::new);
        let placed = Placed::new(a_from_b, b.is_in_place());
        let (centre, radius) = ball_about(b.aabb());
        let offset = sqrt(a_from_b.translation().norm_squared());
        let noise = 2.0 * CERTIFICATE * UNIT * (a.reach + sqrt(centre.coords.norm_squared()) + radius + offset);
        let mut ask = |k: usize, most: f64| {
            let (pose, is_exact) = placed.between(&Isometry3::identity(), &pieces[k].pose);
            if apart(a, &pieces[k], &pose) - 2.0 * noise > most {
                return None;
            }
            // The rounding of composed poses: two products of rotations and two sums.
            let placing = if is_exact { 0.0 } else { noise };
            self.pieces[k].allow(self.splits);
            Some(self.pieces[k].answer_placed(a, &pieces[k].shape, &pose, goal, placing))
        };
        let mut last = self.last.min(pieces.len() - 1);
        let first = last;
        let mut best = ask(first, f64::INFINITY).unwrap_or_else(|| far_apart(a, &pieces[first].shape, a_from_b));
        let mut lower = best.lower;
        for k in (0..pieces.len()).filter(|&k| k != first) {
            let Some(found) = ask(k, best.upper) else { continue };
            lower = lower.smaller(found.lower);
            if found.upper < best.upper {
                (last, best) = (k, found);
            }
        }
        self.last = last;
        lower_to(&mut best, lower, goal);
        best.outcome.point_on_b = pieces[last].pose * best.point_on_b;
        best.on[1].part = last as u32;
        best
    }
}

/// Returns the gap of the balls about a surface and a piece, up to rounding.
fn apart(a: &Surface, piece: &Piece, pose: &RelativePose) -> f64 {
    let ((centre, radius), (of_piece, reach)) = (a.bounding_ball(), piece.shape.bounding_ball());
    let between = pose.rotation() * of_piece.coords + pose.translation() - centre.coords;
    sqrt(between.norm_squared()) - radius - reach
}
