//! Answers of queries of two surfaces.

use nalgebra::{Point3, Unit, Vector3};

use super::search::NetGoal;
use super::shape_tracker::class;
use super::surface::SurfacePoint;
use super::tree::Node;
use crate::pair::outcome::{Class, Distance};
use crate::polyhedron::Feature;

/// The closest points of two surfaces, with proof.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceOutcome {
    /// [`Class::Separated`] if the lower bound is positive; [`Class::Touching`] if the surfaces are
    /// proven to share a point; else [`Class::Undecided`]. Surfaces have no inside and never
    /// overlap.
    pub class: Class,
    /// The distance of the witnesses, between the bounds.
    pub distance: f64,
    /// Lower bound of the distance.
    pub lower: f64,
    /// Upper bound of the distance.
    pub upper: f64,
    /// Whether the bounds are no farther apart than was asked for. If not, the budget of splits was
    /// used up or is too small by far (see [`patch`](crate::patch)), or the width is below
    /// [`PATCH_LIMIT`](crate::tolerance::PATCH_LIMIT) times the size of the pair; the bounds hold
    /// all the same.
    pub is_reached: bool,
    /// The witness on A by its parameters.
    pub on_a: SurfacePoint,
    /// The witness on B by its parameters.
    pub on_b: SurfacePoint,
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from the witness on A to that on B, in A's frame; where the witnesses
    /// coincide, a normal of a surface.
    pub normal: Unit<Vector3<f64>>,
}

/// The closest points of a surface and a convex shape, with proof.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceShapeOutcome {
    /// [`Class::Separated`] if the lower bound is positive; [`Class::Overlapping`] if a point of
    /// the surface is proven to lie in the shape; else [`Class::Undecided`].
    pub class: Class,
    /// The distance of the witnesses, between the bounds; zero for an overlap, which has no depth.
    pub distance: f64,
    /// Lower bound of the distance.
    pub lower: f64,
    /// Upper bound of the distance: zero exactly if the class is [`Class::Overlapping`].
    pub upper: f64,
    /// Whether the bounds are no farther apart than was asked for, as
    /// [`SurfaceOutcome::is_reached`].
    pub is_reached: bool,
    /// The witness on the surface by its parameters; of an overlap, a point within the shape.
    pub on_a: SurfacePoint,
    /// The witness on the surface, in its frame.
    pub point_on_a: Point3<f64>,
    /// The point of the boundary of the shape that is closest to the witness on the surface, in
    /// the frame of the shape; where rounding hides whether that witness lies in the shape, the
    /// same point.
    pub point_on_b: Point3<f64>,
    /// Unit direction from the surface to the shape, in the frame of the surface; of an overlap,
    /// from the witness inwards.
    pub normal: Unit<Vector3<f64>>,
    /// The feature of the core of the shape that is closest to the witness on the surface.
    pub feature: Feature,
}

impl SurfaceShapeOutcome {
    /// Lowers the lower bound to that of other pieces.
    pub(super) fn lower_to(&mut self, lower: f64, goal: NetGoal) {
        self.lower = self.lower.min(lower);
        self.distance = self.distance.max(self.lower);
        self.class = class(self.lower, self.upper);
        self.is_reached = goal.is_reached(self.lower, self.upper);
    }
}

/// The closest points of a surface and a body of convex pieces, with proof.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceCompositeOutcome {
    /// The closest piece, in the order of [`Composite::pieces`](crate::Composite::pieces).
    pub piece: u32,
    /// The closest points of that piece, with bounds for the whole body. The witness on B is in the
    /// frame of the body; the feature is one of the piece.
    pub closest: SurfaceShapeOutcome,
}

impl From<&SurfaceShapeOutcome> for Distance {
    fn from(o: &SurfaceShapeOutcome) -> Self {
        Self {
            class: o.class,
            value: o.distance,
            lower: o.lower,
            upper: o.upper,
        }
    }
}

impl From<&SurfaceOutcome> for Distance {
    fn from(o: &SurfaceOutcome) -> Self {
        Self {
            class: o.class,
            value: o.distance,
            lower: o.lower,
            upper: o.upper,
        }
    }
}

/// A part of a surface: a node of its tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePart {
    /// The number of the patch; `None` for a group of whole patches.
    pub patch: Option<u32>,
    /// Least and greatest parameter u.
    pub u: [f64; 2],
    /// Least and greatest parameter v.
    pub v: [f64; 2],
}

impl SurfacePart {
    pub(super) fn of(node: &Node) -> Self {
        let [u, v] = node.domain();
        let patch = (!node.is_group()).then_some(node.patch());
        Self { patch, u, v }
    }
}

/// The answer to a question of yes or no by bounds: no exact arithmetic decides what they leave
/// open.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Decision {
    /// Proven.
    Yes,
    /// Proven not to be so.
    No,
    /// The bounds of the distance leave both possible.
    Undecided {
        /// Lower bound of the distance.
        lower: f64,
        /// Upper bound of the distance.
        upper: f64,
    },
}

impl Decision {
    /// Returns whether a distance is at most `d`, by its bounds.
    pub(super) fn by(lower: f64, upper: f64, d: f64) -> Self {
        if upper <= d {
            Self::Yes
        } else if lower > d {
            Self::No
        } else {
            Self::Undecided { lower, upper }
        }
    }

    /// Returns the answer, `None` if undecided.
    #[must_use]
    pub fn known(self) -> Option<bool> {
        match self {
            Self::Yes => Some(true),
            Self::No => Some(false),
            Self::Undecided { .. } => None,
        }
    }
}

/// The work of queries of two surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceWork {
    /// Queries answered.
    pub queries: u64,
    /// Entries of fronts tested by their directions.
    pub entries: u64,
    /// Entries that their directions did not prove.
    pub failed: u64,
    /// Gaps of two nets along a direction.
    pub gaps: u64,
    /// Pairs bounded by second derivatives.
    pub caps: u64,
    /// Pairs bounded by a curved surface between them.
    pub bowls: u64,
    /// Surroundings of closest points proven at once.
    pub regions: u64,
    /// Surroundings of closest points that were tried and not proven.
    pub refused: u64,
    /// Steps of Newton's method for two points.
    pub steps: u64,
    /// Pairs of nodes split.
    pub splits: u64,
    /// Searches from the roots.
    pub searches: u64,
}
