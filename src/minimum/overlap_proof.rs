//! A proof of overlap that is kept from frame to frame: four points of the Minkowski difference around the origin.
//!
//! Points of the difference are vertex pairs and stay points of it at any pose. PosedPair anew, their tetrahedron still holds the
//! origin after most small motions, which four signed volumes prove; where it does not, the solver starts from the last
//! features. Only for answers without a depth: one with a depth keeps a whole surface.

use crate::minimum::gjk::{Minimum, solve};
use crate::minimum::simplex::Simplex;
use crate::minimum::witnesses::witnesses;
use crate::pair::answer::{is_proven, overlapping};
use crate::pair::difference::difference_point;
use crate::pair::outcome::{Outcome, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::FeaturePair;

/// A vertex of each body, four times. Four times the same proves nothing: that is what is kept of a first overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct OverlapProof([[u32; 2]; 4]);

impl OverlapProof {
    fn of(simplex: &Simplex<f64>) -> Option<Self> {
        let kept: &[_; 4] = simplex.kept().try_into().ok()?;
        Some(Self(kept.map(|c| [c.a, c.b])))
    }

    /// Whether the bodies are overlapping for the same reason; then the answer, which is as good as the solver's.
    #[inline]
    pub(crate) fn proves(&self, posed: &PosedPair, outcome: &mut Outcome) -> bool {
        let (a, b) = (posed.a.points.len(), posed.b.points.len());
        // What comes from a file, or from other bodies, may name what is not there.
        if !self.0.iter().all(|[x, y]| (*x as usize) < a && (*y as usize) < b) {
            return false;
        }
        let frame = Transform::of(posed);
        let corners = self.0.map(|[x, y]| difference_point(posed, &frame, x, y));
        let Some(simplex) = Simplex::around_origin(corners, posed.reach::<f64>()) else {
            return false;
        };
        outcome.solver = Solver::Surface;
        take_overlap(posed, &simplex, outcome)
    }
}

/// Solves for an overlap at once, where the last answer was one: its proof, if it still is.
#[cold]
pub(crate) fn solve_overlap(posed: &PosedPair, from: FeaturePair, outcome: &mut Outcome) -> Option<OverlapProof> {
    outcome.work.fallbacks += 1;
    let Minimum::Inside { simplex } = solve(posed, &Transform::of(posed), from) else {
        return None;
    };
    outcome.solver = Solver::Fallback;
    take_overlap(posed, &simplex, outcome).then(|| OverlapProof::of(&simplex))?
}

/// The witnesses of a tetrahedron around the origin; features stay those of the answer before. Whether that settles the overlap.
fn take_overlap(posed: &PosedPair, simplex: &Simplex<f64>, outcome: &mut Outcome) -> bool {
    (outcome.point_on_a, outcome.point_on_b) = witnesses(posed, simplex);
    overlapping(outcome);
    is_proven(posed, outcome)
}
