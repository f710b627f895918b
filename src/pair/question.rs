//! What is asked of two geometries of any kinds.

use super::outcome::Until;

/// Options of a query of two geometries:
/// [`PairTracker::ask`](crate::PairTracker::ask).
///
/// ```
/// use lin_canny::{Question, Until};
///
/// let narrow = Question::new().width(1e-9).splits(100_000);
/// let quick = Question::new().until(Until::ContactState);
/// assert_ne!(narrow, quick);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Question {
    /// Where a query of two convex geometries that overlap may stop. The depths of other geometries
    /// are never searched here.
    pub until: Until,
    /// How far the bounds of a pair with a surface of patches may be apart, a length in the
    /// caller's unit; `None` for `2^-30` of the size of the pair. A width that is no number, or
    /// that is below `2^-42` times the size L (the farthest
    /// control points or points of both geometries from their origins, and the distance of the
    /// origins), is taken as that limit.
    pub width: Option<f64>,
    /// The number of pairs of nodes that a query of a surface of patches may split, at most `2^22`;
    /// `None` for 20,000. A query that uses up its budget returns wider bounds; so does one of two
    /// surfaces that would need several times its budget by the speed at which its bounds approach
    /// each other.
    pub splits: Option<usize>,
}

impl Question {
    /// Returns the question for the depth of convex geometries and the usual width.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            until: Until::Depth,
            width: None,
            splits: None,
        }
    }

    /// Returns the question with another end of a query of convex geometries.
    #[must_use]
    pub const fn until(mut self, until: Until) -> Self {
        self.until = until;
        self
    }

    /// Returns the question with another width of the bounds of surfaces.
    #[must_use]
    pub const fn width(mut self, width: f64) -> Self {
        self.width = Some(width);
        self
    }

    /// Returns the question with another budget of a query of surfaces.
    #[must_use]
    pub const fn splits(mut self, splits: usize) -> Self {
        self.splits = Some(splits);
        self
    }
}
