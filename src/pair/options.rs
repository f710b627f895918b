//! Options of a query of two geometries of any kind.

use super::outcome::DepthMode;

/// Options of a query of two geometries:
/// [`PairTracker::closest_with`](crate::PairTracker::closest_with) and
/// [`penetration_with`](crate::PairTracker::penetration_with).
///
/// ```
/// use lin_canny::{QueryOptions, DepthMode};
///
/// let narrow = QueryOptions::default().width(1e-9).splits(100_000);
/// let quick = QueryOptions::default().depth(DepthMode::None);
/// assert_ne!(narrow, quick);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct QueryOptions {
    /// Which depth a query of two overlapping convex geometries returns.
    ///
    /// For other geometries the query computes no depth.
    pub depth: DepthMode,
    /// Largest distance between the bounds of a pair with a Bézier surface, or of a penetration
    /// depth.
    ///
    /// A length in the caller's unit. For depths, `None` asks for no width.
    ///
    /// `None` means `2^-30` of the sum of the radii of both bounding balls, but at least `2^-38` of
    /// the largest coordinate of the translation. Rounding keeps the bounds about `2^-42 L` apart:
    /// for a smaller width, or one that is NaN,
    /// [`PairOutcome::is_converged`](crate::PairOutcome::is_converged) is false. The pair size L is
    /// the sum of both radii about the origins plus the distance of the origins.
    pub width: Option<f64>,
    /// Budget of a query with a Bézier surface: how many pairs of nodes it may split, at most
    /// `2^22`.
    ///
    /// A depth is narrowed by as many splits of cells of translations, at most `2^20`; `None` means
    /// 1,000 there.
    ///
    /// `None` means 20,000. For a compound the budget applies to each piece. A query that uses up
    /// its budget returns wider bounds. A query of two surfaces also returns wider bounds if it
    /// would need several times its budget at the speed at which its bounds approach each other.
    pub splits: Option<usize>,
}

impl QueryOptions {
    /// Returns the options with another depth mode for overlaps of convex geometries.
    #[must_use]
    pub const fn depth(mut self, depth: DepthMode) -> Self {
        self.depth = depth;
        self
    }

    /// Returns the options with another width of the bounds of pairs with a Bézier surface.
    #[must_use]
    pub const fn width(mut self, width: f64) -> Self {
        self.width = Some(width);
        self
    }

    /// Returns the options with another budget of queries with a Bézier surface.
    #[must_use]
    pub const fn splits(mut self, splits: usize) -> Self {
        self.splits = Some(splits);
        self
    }
}
