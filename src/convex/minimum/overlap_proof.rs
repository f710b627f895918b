//! Cached proof of overlap: four points of the Minkowski difference around the origin.
//!
//! A point of the difference is a vertex pair, and stays a point of the difference at any pose.
//! After most small motions the tetrahedron of the four points at the new pose still contains the
//! origin, which four signed volumes prove; if not, the solver starts from the points closest to
//! the origin. Only for answers without a depth: an answer with a depth keeps a whole surface.

use crate::base::num::each::Each;
use crate::body::polyhedron::{FeaturePair, VertexId};
use crate::convex::minimum::gjk::{Minimum, solve};
use crate::convex::minimum::simplex::Simplex;
use crate::convex::minimum::start::vertex_of;
use crate::convex::minimum::witnesses::witnesses;
use crate::pair::answer::{is_proven, set_overlapping};
use crate::pair::difference::difference_point;
use crate::pair::draft::Draft;
use crate::pair::outcome::Solver;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Four vertex pairs (a tetrahedron of A - B). The default, four equal pairs, is never a valid
/// proof; it marks that the previous query overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct OverlapProof([[VertexId; 2]; 4]);

impl Default for OverlapProof {
    fn default() -> Self {
        Self([[VertexId(0); 2]; 4])
    }
}

impl OverlapProof {
    fn from_simplex(simplex: &Simplex<f64>) -> Option<Self> {
        let kept: &[_; 4] = simplex.points().try_into().ok()?;
        Some(Self(kept.each(|c| [c.a, c.b])))
    }

    /// Returns a guess: four pairs of vertices, of A and of B, whose differences may contain the
    /// origin.
    pub(crate) fn guess(points: [[VertexId; 2]; 4]) -> Self {
        Self(points)
    }

    /// Proves the overlap at this pose and writes it, by the four points or, if they do not contain
    /// the origin, by the solver, which starts from those closest to the origin. Returns the new
    /// proof; `None` if the bodies are not proven to overlap. `from`, the features of the last
    /// answer, are the start if the four points are of no use.
    #[inline]
    pub(crate) fn renewed(&self, posed: &PosedPair, from: FeaturePair, draft: &mut Draft) -> Option<Self> {
        let frame = Transform::of(posed);
        let (a, b) = (posed.a.points.len(), posed.b.points.len());
        // State from a file, or of different bodies, may name vertices that do not exist.
        let is_valid = *self != Self::default() && self.0.iter().all(|[x, y]| x.index() < a && y.index() < b);
        let mut start = None;
        if is_valid {
            let points = self.0.each(|[x, y]| difference_point(posed, &frame, x, y));
            let simplex = Simplex::tetrahedron(points, posed.error_scale::<f64>());
            if simplex.len() < 4 {
                start = Some(simplex);
            } else if write_overlap(posed, &simplex, draft) {
                draft.solver = Solver::Surface;
                return Some(*self);
            }
        }
        // Four points around the origin whose witnesses differ are no start: no point is closer.
        let start = start.unwrap_or_else(|| vertex_of(posed, &frame, from));
        solve_overlap(posed, &frame, start, draft)
    }
}

/// Solves for an overlap from a simplex; returns the proof if the bodies overlap.
#[cold]
fn solve_overlap(
    posed: &PosedPair,
    frame: &Transform<f64>,
    start: Simplex<f64>,
    draft: &mut Draft,
) -> Option<OverlapProof> {
    draft.work.fallbacks += 1;
    let Minimum::Inside { simplex } = solve(posed, frame, start) else {
        return None;
    };
    draft.solver = Solver::Fallback;
    write_overlap(posed, &simplex, draft).then(|| OverlapProof::from_simplex(&simplex))?
}

/// Writes the overlap and the witnesses of a tetrahedron around the origin; features stay as in the
/// last answer. Returns whether the overlap is settled.
fn write_overlap(posed: &PosedPair, simplex: &Simplex<f64>, draft: &mut Draft) -> bool {
    (draft.point_on_a, draft.point_on_b) = witnesses(posed, simplex);
    set_overlapping(draft);
    is_proven(posed, draft)
}
