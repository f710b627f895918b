//! The serialised forms of a manifold (feature `serde`).
//!
//! The text contains the complete state. No bound of a text is believed: a manifold that is read
//! keeps points and ids, and computes its contacts again at the next query. A scene reads the
//! complete state ([`Complete`]) and proves it again.

use nalgebra::{Unit, Vector3};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use super::{ContactPoint, Made, Manifold};
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{REPEATED, REPEATED_NORMAL};
use crate::convex::contact::MOST_POINTS;
use crate::convex::contact::clip::Location;
use crate::convex::contact::clip_large::Rays;

/// The complete state of a manifold.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Manifold", rename = "Manifold")]
struct StoredManifold {
    points: [ContactPoint; MOST_POINTS],
    #[serde(deserialize_with = "at_most_all")]
    count: usize,
    normal: Unit<Vector3<f64>>,
    #[serde(with = "crate::base::num::scalar::infinite")]
    lower: f64,
    #[serde(with = "crate::base::num::scalar::infinite")]
    upper: f64,
    made: Option<Made>,
    fresh: bool,
    on: [[Location; 2]; MOST_POINTS],
    margins: [f64; MOST_POINTS],
    rays: Rays,
}

/// Deserializes the number of points; returns an error for more points than the manifold can hold.
fn at_most_all<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    let count = usize::deserialize(deserializer)?;
    if count <= MOST_POINTS {
        Ok(count)
    } else {
        Err(D::Error::custom("a manifold holds at most 8 points"))
    }
}

impl Serialize for Manifold {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        StoredManifold::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Manifold {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut read = StoredManifold::deserialize(deserializer)?;
        read.forget_bounds();
        let blank = Self::default();
        (read.on, read.margins, read.rays) = (blank.on, blank.margins, blank.rays);
        if let Some(made) = &mut read.made {
            made.since = f64::INFINITY;
        }
        Ok(read)
    }
}

/// The complete state of a manifold, for a reader that proves it again.
#[derive(Deserialize)]
pub(crate) struct Complete(#[serde(with = "StoredManifold")] pub(crate) Manifold);

impl Manifold {
    /// Drops the bounds, so that the next query computes contacts again. Points and ids stay.
    pub(crate) fn forget_bounds(&mut self) {
        let blank = Self::default();
        (self.lower, self.upper, self.fresh) = (blank.lower, blank.upper, false);
        if let Some(made) = &mut self.made {
            (made.lower, made.upper) = (blank.lower, blank.upper);
            made.budget = f64::NEG_INFINITY;
        }
    }

    /// Returns the pose at which the bounds were computed.
    pub(crate) fn made_at(&self) -> Option<RelativePose> {
        self.made.as_ref().map(|made| made.pose)
    }

    /// Returns whether this state is that of the bodies of `again`, which was computed at the same
    /// pose. Bounds may differ by rounding alone: both contain the distance, or none is taken.
    pub(crate) fn is_repeated(&self, again: &Self) -> bool {
        let (Some(made), Some(proven)) = (&self.made, &again.made) else {
            return false;
        };
        let length = REPEATED * proven.ball.size();
        let is_opposite = |p: &ContactPoint| {
            let between = made.pose.rotation() * p.point_on_b.coords + made.pose.translation();
            (self.normal.dot(&(between - p.point_on_a.coords)) - p.separation).abs() <= length
        };
        // Written so that NaN is no repetition.
        made.bodies == proven.bodies
            && made.options == proven.options
            && made.ball == proven.ball
            && made.lower <= proven.upper
            && proven.lower <= made.upper
            && made.lower <= made.upper
            && made.budget <= proven.budget + length
            && made.since >= 0.0
            && (made.normal_in_a() - proven.normal_in_a()).norm_squared() <= REPEATED_NORMAL
            && (self.normal.norm_squared() - 1.0).abs() <= REPEATED_NORMAL
            // The bounds of a kept manifold are wider by the motion.
            && self.lower <= made.lower
            && self.upper >= made.upper
            && (!self.fresh || self.points[..self.count].iter().all(is_opposite))
    }
}

impl Made {
    /// Returns the normal in A's frame. The reference may be that of an earlier manifold.
    fn normal_in_a(&self) -> Vector3<f64> {
        match self.reference {
            Operand::A => self.normal,
            Operand::B => self.pose.rotation() * self.normal,
        }
    }
}
