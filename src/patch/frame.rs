//! Two bodies at a relative pose.

use nalgebra::{Matrix3, Vector3};

use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{CERTIFICATE, FAR, NEAR, PATCH_LIMIT, UNIT};

/// `a_from_b` with the errors of points placed by it.
pub(super) struct NetFrame {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
    /// The size L of the pair: both reaches and the distance of the origins.
    pub(super) size: f64,
    /// Error of a height or of a distance by the pose and by dot products.
    pub(super) error: f64,
    /// How far the pose may put points of B aside, as part of `error`: of poses that were composed.
    pub(super) placing: f64,
    /// Error of a distance by the points.
    pub(super) points: f64,
    /// Intervals are not asked to be narrower.
    pub(super) limit: f64,
}

impl NetFrame {
    /// Returns the frame of bodies with points so far from their origins, whose points err by
    /// `points`. `None` if the bodies are so far apart, or so small, that squares of lengths leave
    /// the range of f64.
    pub(super) fn new(reach: [f64; 2], points: f64, pose: &RelativePose) -> Option<Self> {
        let translation = pose.translation();
        let size = reach[0] + reach[1] + sqrt(translation.norm_squared());
        // Written so that NaN goes the safe way.
        (size > NEAR && size < FAR).then(|| Self {
            rotation: pose.rotation(),
            translation,
            size,
            error: CERTIFICATE * UNIT * size,
            placing: 0.0,
            points,
            limit: PATCH_LIMIT * size,
        })
    }

    /// Returns the frame of a pose that puts points of B up to `placing` aside.
    pub(super) fn placed(self, placing: f64) -> Self {
        Self {
            error: self.error + placing,
            placing,
            ..self
        }
    }

    /// Returns the place of a point of B in A's frame.
    #[inline(always)]
    pub(super) fn place(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * p + self.translation
    }

    /// Returns the direction of B's frame along which points rise as along `n` in A's.
    #[inline(always)]
    pub(super) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(n)
    }
}
