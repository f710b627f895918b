//! Tubes of joints around curves.

use std::borrow::Cow;
use std::vec::Vec;

use crate::motion::curve::JointCurve;
use lin_canny::EXTENT_MAX;

/// How much each coordinate may deviate from a curve, such as the tracking error of a controller.
///
/// The entries are in the units of the coordinates: radians, or lengths. They are numbers, which hold
/// at all times, or a [`JointCurve`], whose values are the entries at the same times. The control
/// points of this curve must not be negative. Calls take anything that converts into a tube.
///
/// ```
/// use lin_canny_plan::{JointCurve, JointTube};
///
/// let even = JointTube::from(&[0.0, 0.01]);
/// // The error grows to the middle of the motion, and then falls.
/// let swelling = JointTube::from(JointCurve::bezier(&[[0.0, 0.0], [0.0, 0.02], [0.0, 0.0]])?);
/// assert_eq!((even.at(0.5), swelling.at(0.5)), (vec![0.0, 0.01], vec![0.0, 0.01]));
/// # Ok::<(), lin_canny_plan::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JointTube(Entries);

#[derive(Clone, Debug, PartialEq)]
enum Entries {
    Constant(Vec<f64>),
    Along(JointCurve),
}

impl JointTube {
    /// Returns the number of coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        match &self.0 {
            Entries::Constant(entries) => entries.len(),
            Entries::Along(curve) => curve.coordinates(),
        }
    }

    /// Returns the entries at a time from 0 to 1.
    #[must_use]
    pub fn at(&self, time: f64) -> Vec<f64> {
        match &self.0 {
            Entries::Constant(entries) => entries.clone(),
            Entries::Along(curve) => curve.at(time),
        }
    }

    /// Returns upper bounds of the entries at all times of a span.
    pub(crate) fn over(&self, time: f64, span: f64) -> Cow<'_, [f64]> {
        match &self.0 {
            Entries::Constant(entries) => entries.into(),
            Entries::Along(curve) => (0..curve.coordinates())
                .map(|c| curve.greatest(c, time, span))
                .collect(),
        }
    }

    /// Returns whether no coordinate deviates.
    pub(crate) fn is_zero(&self) -> bool {
        match &self.0 {
            Entries::Constant(entries) => entries.iter().all(|x| *x == 0.0),
            Entries::Along(curve) => (0..curve.coordinates()).all(|c| {
                let of = curve.bounds(c);
                of.hull[1] == 0.0 && of.error == 0.0
            }),
        }
    }

    /// Returns whether the entries are a curve.
    pub(crate) fn varies(&self) -> bool {
        matches!(self.0, Entries::Along(_))
    }

    /// Returns a number that is no entry of a tube.
    pub(crate) fn wrong_entry(&self) -> Option<f64> {
        let wrong = |x: &f64| !(0.0..=EXTENT_MAX).contains(x);
        match &self.0 {
            Entries::Constant(entries) => entries.iter().copied().find(wrong),
            Entries::Along(curve) => (0..curve.coordinates()).flat_map(|c| curve.bounds(c).hull).find(wrong),
        }
    }
}

impl From<&[f64]> for JointTube {
    fn from(entries: &[f64]) -> Self {
        Self(Entries::Constant(entries.into()))
    }
}

impl<const N: usize> From<&[f64; N]> for JointTube {
    fn from(entries: &[f64; N]) -> Self {
        entries[..].into()
    }
}

impl From<&Vec<f64>> for JointTube {
    fn from(entries: &Vec<f64>) -> Self {
        entries[..].into()
    }
}

impl From<JointCurve> for JointTube {
    fn from(entries: JointCurve) -> Self {
        Self(Entries::Along(entries))
    }
}

impl From<&JointCurve> for JointTube {
    fn from(entries: &JointCurve) -> Self {
        entries.clone().into()
    }
}

impl From<&JointTube> for JointTube {
    fn from(tube: &JointTube) -> Self {
        tube.clone()
    }
}
