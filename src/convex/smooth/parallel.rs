//! Depth of cylinders and cones about parallel axes, in the plane of the axes.
//!
//! A cylinder or a cone is swept by a polygon, its meridian, that turns about the axis. About
//! parallel axes the difference of two such bodies is swept by the sum of both meridians, turning
//! about an axis as well. A point inside is nearest to an edge of the meridian in its half-plane,
//! and the normal of the edge is that of an edge of either summand. So the depth is the least
//! height along six normals, without a search, even if the least directions form a circle.
//!
//! B about an axis with a tilt is off the body about the parallel axis by at most the chord of the
//! tilt times its reach: once for the depth, and once for each height.

use super::best::{BranchSet, ProvenBounds};
use super::posed::PosedCores;
use crate::base::num::scalar::root;
use crate::base::tolerance::{CERTIFICATE, DEPTH_GOAL, PARALLEL_AXES, UNIT};
use crate::body::shape::Support;

/// Takes the depth of cores that are cylinders or cones about parallel axes, or about axes with a
/// tilt that is below the goal of a depth.
pub(super) fn prove<A: Support, B: Support>(posed: &PosedCores<A, B, f64>, best: &mut ProvenBounds<f64>) {
    let (Some(of_a), Some(of_b)) = (posed.a.meridian(), posed.b.meridian()) else {
        return;
    };
    let [x, y, z] = posed.frame.vector(&[0.0, 0.0, 1.0]);
    // The chord of an angle of at most 90 degrees is at most sqrt(2) < 3/2 times the sine.
    let tilt = 1.5 * root(x * x + y * y) + PARALLEL_AXES;
    let off = 2.0 * tilt * posed.b.reach();
    if !(off <= DEPTH_GOAL * posed.size) {
        return;
    }
    let [tx, ty, _] = posed.frame.translation;
    let apart = root(tx * tx + ty * ty);
    let aside = if apart > 0.0 {
        [tx / apart, ty / apart]
    } else {
        [1.0, 0.0]
    };
    let side = if z < 0.0 { 1.0 } else { -1.0 };
    let of_b = of_b.map(|[out, up]| [out, side * up]);
    let (mut top, mut set) = (f64::NEG_INFINITY, BranchSet::default());
    for [out, up] in of_a.into_iter().chain(of_b) {
        let toward = posed.toward([out * aside[0], out * aside[1], up]);
        let piece = posed.support(&toward, [0; 2]);
        let height = best.prove(&toward, &piece);
        if height > top {
            (top, set) = (height, BranchSet::default());
            set.add(piece.of);
        }
    }
    let upper = top + off;
    // Only a point inside is nearest to an edge for certain.
    if upper < -CERTIFICATE * UNIT * posed.size && upper < best.upper {
        (best.upper, best.set) = (upper, set);
    }
}
