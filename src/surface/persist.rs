//! The serialised form of patches and surfaces (feature `serde`). Nets keep every bit and are
//! checked on deserialisation.

use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

use super::bezier_surface::BezierSurface;
use super::error::SurfaceError;
use super::net::{BezierPatch, check_degrees};
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::{KNOTS, PATCH_MAX, RAISED, WEIGHT_RATIO};

/// The serialised form of a patch.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Patch")]
pub(super) struct StoredPatch {
    degrees: [usize; 2],
    /// Weight times point, and weight.
    net: Vec<[f64; 4]>,
    is_triangular: bool,
    source: Source,
    /// The largest distance from the origin of the points from which the net was computed.
    reach: f64,
}

/// The source of the control points, which bounds their errors.
#[derive(Serialize, Deserialize)]
enum Source {
    Points,
    Triangle,
    Knots,
}

/// The serialised form of a surface.
#[derive(Serialize, Deserialize)]
#[serde(rename = "BezierSurface")]
pub(super) struct StoredSurface {
    patches: Vec<BezierPatch>,
    /// The knots around each patch, in u and v.
    domains: Vec<[[f64; 2]; 2]>,
}

impl From<BezierPatch> for StoredPatch {
    fn from(patch: BezierPatch) -> Self {
        let source = if patch.noise == KNOTS {
            Source::Knots
        } else if patch.noise == RAISED {
            Source::Triangle
        } else {
            Source::Points
        };
        Self {
            degrees: patch.degrees,
            net: patch.net,
            is_triangular: patch.is_triangular,
            source,
            reach: patch.reach,
        }
    }
}

/// Checks the weights and coordinates of a net, with limits that are a factor of two wider than for
/// given points. Nets that were halved repeatedly exceed the limits by rounding.
fn check_net(net: &[[f64; 4]], expected: usize) -> Result<(), SurfaceError> {
    let given = net.len();
    if given != expected {
        return Err(SurfaceError::Count { given, expected });
    }
    let largest = net.iter().map(|h| h[3]).fold(0.0, f64::larger);
    for (index, h) in net.iter().enumerate() {
        let value = h[3];
        // NaN fails the comparisons.
        let is_weight = value >= 0.5 * WEIGHT_RATIO * largest && (WEIGHT_RATIO * WEIGHT_RATIO..=2.0).contains(&value);
        if !is_weight {
            return Err(SurfaceError::Weight { index, value });
        }
        if let Some(axis) = (0..3).find(|&k| !((h[k] / value).abs() <= 2.0 * PATCH_MAX)) {
            let value = h[axis] / value;
            return Err(SurfaceError::Coordinate { index, axis, value });
        }
    }
    Ok(())
}

impl TryFrom<StoredPatch> for BezierPatch {
    type Error = SurfaceError;

    fn try_from(stored: StoredPatch) -> Result<Self, SurfaceError> {
        let [p, q] = stored.degrees;
        check_degrees(stored.degrees)?;
        check_net(&stored.net, (p + 1) * (q + 1))?;
        if stored.is_triangular && p != q {
            return Err(SurfaceError::Degree {
                direction: 1,
                degree: q,
            });
        }
        let mut patch = Self::assembled(stored.degrees, stored.net);
        // The radius of the net is the smallest valid value. NaN fails the comparison.
        if !(stored.reach >= patch.reach && stored.reach <= 4.0 * PATCH_MAX) {
            return Err(SurfaceError::Reach { value: stored.reach });
        }
        patch.reach = stored.reach;
        patch.is_triangular = stored.is_triangular;
        patch.noise = match stored.source {
            Source::Points => 0.0,
            Source::Triangle => RAISED,
            Source::Knots => KNOTS,
        };
        Ok(patch)
    }
}

impl From<BezierSurface> for StoredSurface {
    fn from(surface: BezierSurface) -> Self {
        Self {
            patches: surface.patches,
            domains: surface.domains,
        }
    }
}

impl TryFrom<StoredSurface> for BezierSurface {
    type Error = SurfaceError;

    fn try_from(stored: StoredSurface) -> Result<Self, SurfaceError> {
        let (given, expected) = (stored.domains.len(), stored.patches.len());
        if given != expected {
            return Err(SurfaceError::Count { given, expected });
        }
        for (index, domain) in stored.domains.iter().enumerate() {
            for (direction, [low, high]) in domain.iter().enumerate() {
                if !(low < high && low.abs() <= PATCH_MAX && high.abs() <= PATCH_MAX) {
                    return Err(SurfaceError::Knot {
                        direction,
                        index,
                        value: *high,
                    });
                }
            }
        }
        Self::assembled(stored.patches, stored.domains)
    }
}
