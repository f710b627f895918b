//! What a caller may ask of a manifold.

use super::MOST_POINTS;

/// What is asked of a manifold. Numbers that are none (NaN) ask for nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ManifoldOptions {
    /// Contacts up to this separation are wanted, in the caller's unit. Zero: those that touch or overlap.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub prediction: f64,
    /// How many points at most, 1 to 8. Default 4. Of faces of more than 24 corners not all corners of what they share are looked at: in
    /// random poses of one upon another eight points span 60 % of it in all but some in a thousand, and where it is long and narrow now
    /// and then much less.
    pub max_points: usize,
    /// The sine of the largest angle between the normal and a face that bears the contact. Default 1/64, a little less than one degree.
    /// A face within one degree of upright bears none, whatever is asked.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub sine: f64,
    /// How far the bodies may move before a manifold is made anew, in radii of the smaller one; till then its points stay
    /// where they are on the bodies, with new separations. Contacts nearer to each other than this are one. Default 1/1024; zero: every
    /// motion asks anew.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub drift: f64,
    /// How far the bodies may move, in radii of the smaller one, before the choice among the corners of what two faces share is made
    /// anew; till then the same corners are kept, as long as they are corners and the deepest is among them. Default 1/16.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub choice: f64,
}

impl Default for ManifoldOptions {
    fn default() -> Self {
        Self::within(0.0)
    }
}

impl ManifoldOptions {
    /// The default with a prediction distance.
    #[must_use]
    pub const fn within(prediction: f64) -> Self {
        Self {
            prediction,
            max_points: 4,
            sine: 1.0 / 64.0,
            drift: 1.0 / 1024.0,
            choice: 1.0 / 16.0,
        }
    }

    pub(super) fn most(&self) -> usize {
        self.max_points.clamp(1, MOST_POINTS)
    }
}
