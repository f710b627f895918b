//! The state of a surface and a body of convex pieces, and the queries: a tracker for each piece.

use alloc::vec::Vec;
use nalgebra::Isometry3;

use super::outcome::{Decision, SurfaceCompositeOutcome};
use super::search::NetGoal;
use super::shape_tracker::{SurfaceShapeTracker, far_apart};
use super::surface::Surface;
use crate::composite::parts::Parted;
use crate::composite::pieces::{Composite, Piece};
use crate::composite::placed::Placed;
use crate::composite::separation::ball_about;
use crate::num::scalar::sqrt;
use crate::pair::outcome::Distance;
use crate::pose::RelativePose;
use crate::tolerance::{CERTIFICATE, UNIT};

/// The trackers of a surface and the pieces of a [`Composite`].
///
/// The counterpart of [`SurfaceShapeTracker`] for bodies of placed convex shapes: the surface is A
/// and the body B. A piece whose ball is farther away than the closest piece is not asked. Not
/// saved to files.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Point3};
/// use lin_canny::patch::{Patch, Surface, SurfaceCompositeTracker};
/// use lin_canny::{Composite, Piece, RelativePose, Shape};
///
/// // Two balls over a flat square.
/// let at = |k: usize| Point3::new((k / 2) as f64, (k % 2) as f64, 0.0);
/// let points: Vec<_> = (0..4).map(at).collect();
/// let floor = Surface::new(vec![Patch::polynomial([1, 1], &points)?])?;
/// let ball = |x: f64, z: f64| -> Result<Piece, lin_canny::ShapeError> {
///     let pose = Isometry3::translation(x, 0.0, z);
///     Ok(Piece { pose, ..Piece::new(Shape::ball(0.2)?) })
/// };
/// let body = Composite::new(vec![ball(0.0, 0.5)?, ball(0.5, 0.0)?])?;
/// let pose = Isometry3::translation(0.2, 0.5, 1.0);
/// let a_from_b = RelativePose::from_isometry(&pose)?;
/// let mut pair = SurfaceCompositeTracker::new();
/// let c = pair.closest(&floor, &body, &a_from_b, 1e-9);
/// assert_eq!(c.piece, 1);
/// assert!(c.closest.lower <= 0.8 && 0.8 <= c.closest.upper);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SurfaceCompositeTracker {
    pieces: Vec<SurfaceShapeTracker>,
    /// The piece that was closest.
    last: usize,
}

impl SurfaceCompositeTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the bytes kept on the heap, without those of shapes.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        let own = self.pieces.capacity() * size_of::<SurfaceShapeTracker>();
        own + self.pieces.iter().map(SurfaceShapeTracker::heap_bytes).sum::<usize>()
    }

    /// Returns the closest points with bounds of the distance that are at most `width` apart, as
    /// [`SurfaceShapeTracker::closest`] does.
    pub fn closest(
        &mut self,
        a: &Surface,
        b: &Composite,
        a_from_b: &RelativePose,
        width: f64,
    ) -> SurfaceCompositeOutcome {
        self.answer(a, b, a_from_b, NetGoal::Width(width))
    }

    /// Returns the distance with bounds that are at most `width` apart, as
    /// [`closest`](Self::closest).
    pub fn distance(&mut self, a: &Surface, b: &Composite, a_from_b: &RelativePose, width: f64) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b, width).closest)
    }

    /// Decides whether a point of the surface lies in a piece. Pairs that merely touch stay
    /// undecided.
    pub fn intersects(&mut self, a: &Surface, b: &Composite, a_from_b: &RelativePose) -> Decision {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Decides whether the distance is at most `d`, a length in the caller's unit. Undecided only
    /// if `d` is within rounding of the distance, or a budget is used up.
    pub fn within(&mut self, a: &Surface, b: &Composite, a_from_b: &RelativePose, d: f64) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let found = self.answer(a, b, a_from_b, NetGoal::Within(d)).closest;
        Decision::by(found.lower, found.upper, d)
    }

    /// Returns the closest points of all pieces with bounds as close as a goal asks for.
    pub(super) fn answer(
        &mut self,
        a: &Surface,
        b: &Composite,
        a_from_b: &RelativePose,
        goal: NetGoal,
    ) -> SurfaceCompositeOutcome {
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
            Some(self.pieces[k].answer_placed(a, &pieces[k].shape, &pose, goal, placing))
        };
        let mut last = self.last.min(pieces.len() - 1);
        let first = last;
        let mut best = ask(first, f64::INFINITY).unwrap_or_else(|| far_apart(a, &pieces[first].shape, a_from_b));
        let mut lower = best.lower;
        for k in (0..pieces.len()).filter(|&k| k != first) {
            let Some(found) = ask(k, best.upper) else { continue };
            lower = lower.min(found.lower);
            if found.upper < best.upper {
                (last, best) = (k, found);
            }
        }
        self.last = last;
        best.lower_to(lower, goal);
        best.point_on_b = pieces[last].pose * best.point_on_b;
        SurfaceCompositeOutcome {
            piece: last as u32,
            closest: best,
        }
    }
}

/// Returns the gap of the balls about a surface and a piece, up to rounding.
fn apart(a: &Surface, piece: &Piece, pose: &RelativePose) -> f64 {
    let ((centre, radius), (of_piece, reach)) = (a.bounding_ball(), piece.shape.bounding_ball());
    let between = pose.rotation() * of_piece.coords + pose.translation() - centre.coords;
    sqrt(between.norm_squared()) - radius - reach
}
