//! A proof of overlap that is kept from frame to frame: four points of the Minkowski difference around the origin.
//!
//! Points of the difference are vertex pairs and stay points of it at any pose. Placed anew, their tetrahedron still holds the
//! origin after most small motions, which four signed volumes prove; where it does not, the solver starts from the last
//! features. Only for answers without a depth: one with a depth keeps a whole surface.

use super::fallback::{Minimum, corner, solve};
use super::outcome::{Layer, Outcome};
use super::placed::{Frame, Placed};
use super::refine::take_overlap;
use super::simplex::Simplex;
use crate::polyhedron::FeaturePair;

/// A vertex of each body, four times. Four times the same proves nothing: that is what is kept of a first overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Hold([[u32; 2]; 4]);

impl Hold {
    fn of(simplex: &Simplex<f64>) -> Option<Self> {
        let kept: &[_; 4] = simplex.kept().try_into().ok()?;
        Some(Self(kept.map(|c| [c.a, c.b])))
    }

    /// Four pairs of vertices, of A and of B, that may hold the origin between their differences.
    pub(crate) fn guess(corners: [[u32; 2]; 4]) -> Self {
        Self(corners)
    }

    /// Whether the bodies are overlapping for the same reason; then the answer, which is as good as the solver's.
    #[inline]
    pub(crate) fn proves(&self, placed: &Placed, outcome: &mut Outcome) -> bool {
        let (a, b) = (placed.a.points.len(), placed.b.points.len());
        // What comes from a file, or from other bodies, may name what is not there.
        if !self.0.iter().all(|[x, y]| (*x as usize) < a && (*y as usize) < b) {
            return false;
        }
        let frame = Frame::of(placed);
        let corners = self.0.map(|[x, y]| corner(placed, &frame, x, y));
        let Some(simplex) = Simplex::around_origin(corners, placed.reach::<f64>()) else {
            return false;
        };
        outcome.layer = Layer::Surface;
        take_overlap(placed, &simplex, outcome)
    }
}

/// Solves for an overlap at once, where the last answer was one: its proof, if it still is.
#[cold]
pub(crate) fn regain(placed: &Placed, from: FeaturePair, outcome: &mut Outcome) -> Option<Hold> {
    outcome.work.fallbacks += 1;
    let Minimum::Inside { simplex } = solve(placed, &Frame::of(placed), from) else {
        return None;
    };
    outcome.layer = Layer::Fallback;
    take_overlap(placed, &simplex, outcome).then(|| Hold::of(&simplex))?
}
