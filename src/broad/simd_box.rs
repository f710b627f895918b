//! A stored box in two SIMD registers: the form in which all hot loops compute.

use super::aabb::{Aabb, FARTHEST, StoredBox};
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use nalgebra::Point3;
use wide::{f32x4, f64x4, i32x4};

/// Lower and upper bounds in lanes 0 to 2; lane 3 is arbitrary, and every test ignores lane 3.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) lo: f32x4,
    pub(crate) hi: f32x4,
}

/// The three lanes of the axes, as a mask of `to_bitmask`.
const AXES: u32 = 0b111;

impl Bounds {
    /// Returns the stored form of a box, with the coordinates in the cyclic order that starts at
    /// axis `FIRST`; `None` if the box may be faulty or out of the range of `f32`, which the slow
    /// path decides.
    #[inline(always)]
    pub(crate) fn outward<const FIRST: usize>(aabb: &Aabb, origin: &Point3<f64>) -> Option<Self> {
        let axes = [FIRST, (FIRST + 1) % 3, (FIRST + 2) % 3];
        let pick = |p: &Point3<f64>| f64x4::from([p[axes[0]], p[axes[1]], p[axes[2]], 0.0]);
        let (min, max, zero) = (pick(&aabb.min), pick(&aabb.max), pick(origin));
        let ordered = min.simd_le(max).to_bitmask() & AXES == AXES;
        let lo = rounded_down(min - zero);
        let hi = -rounded_down(zero - max);
        let limit = f32x4::splat(FARTHEST);
        let in_range = ((-limit).simd_le(lo) & hi.simd_le(limit)).to_bitmask() & AXES == AXES;
        // Adding zero turns -0 into +0, so that equal bounds have equal bits and sort keys.
        let zero = f32x4::ZERO;
        (ordered & in_range).then_some(Self {
            lo: lo + zero,
            hi: hi + zero,
        })
    }

    #[inline(always)]
    pub(crate) fn from_box(stored: &StoredBox) -> Self {
        let ([a, b, c], [d, e, f]) = (stored.lo, stored.hi);
        Self {
            lo: f32x4::from([a, b, c, 0.0]),
            hi: f32x4::from([d, e, f, 0.0]),
        }
    }

    #[inline(always)]
    pub(crate) fn to_box(self) -> StoredBox {
        let ([a, b, c, _], [d, e, f, _]) = (self.lo.to_array(), self.hi.to_array());
        StoredBox {
            lo: [a, b, c],
            hi: [d, e, f],
        }
    }

    /// Returns whether the closed boxes share a point.
    #[inline(always)]
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let meets = self.lo.simd_le(other.hi) & other.lo.simd_le(self.hi);
        meets.to_bitmask() & AXES == AXES
    }

    /// Returns whether `other` lies within this box, faces included.
    #[inline(always)]
    pub(crate) fn contains(&self, other: &Self) -> bool {
        let within = self.lo.simd_le(other.lo) & other.hi.simd_le(self.hi);
        within.to_bitmask() & AXES == AXES
    }

    /// Returns the least box that covers both boxes; the empty box is neutral.
    #[inline(always)]
    pub(crate) fn united(&self, other: &Self) -> Self {
        Self {
            lo: self.lo.fast_min(other.lo),
            hi: self.hi.fast_max(other.hi),
        }
    }

    /// Returns the displacement of the faces between the two boxes: by axis, the larger of the two.
    #[inline(always)]
    pub(crate) fn displacement(&self, other: &Self) -> f32x4 {
        (self.lo - other.lo).abs().fast_max((self.hi - other.hi).abs())
    }
}

/// Returns whether any axis exceeds its bound.
#[inline(always)]
pub(crate) fn any_above(v: f32x4, bounds: f32x4) -> bool {
    v.simd_gt(bounds).to_bitmask() & AXES != 0
}

/// Returns the largest of the three axes.
#[inline(always)]
pub(crate) fn largest(v: f32x4) -> f32 {
    let [a, b, c, _] = v.to_array();
    a.at_least(b.at_least(c))
}

/// Returns the largest `f32` at or below each lane; exact if a lane is an `f32`. No branches.
#[inline(always)]
fn rounded_down(v: f64x4) -> f32x4 {
    let [a, b, c, d] = v.to_array();
    let nearest = [a as f32, b as f32, c as f32, d as f32];
    let [a, b, c, d] = nearest;
    let back = f64x4::from([f64::from(a), f64::from(b), f64::from(c), f64::from(d)]);
    let [a, b, c, d] = back.simd_gt(v).to_array().each(|mask| mask.to_bits() as i32);
    // -1 in lanes that were rounded up. The next float below has bits less by 1 for a positive
    // float, and greater by 1 for a negative float; a sign of -1 yields the latter: (x ^ -1) + 1 =
    // -x.
    let above = i32x4::from([a, b, c, d]);
    let bits: i32x4 = i32x4::from(nearest.each(|v| v.to_bits() as i32));
    let sign: i32x4 = bits >> 31;
    let down = (bits + (above ^ sign)) - sign;
    f32x4::from(down.to_array().each(|bits| f32::from_bits(bits as u32)))
}
