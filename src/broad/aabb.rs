//! Axis-aligned boxes, as callers give them (`f64`) and as the broad phase stores them (`f32`,
//! rounded outward).

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::broad::BroadPhaseError;
use nalgebra::{Point3, Vector3};

/// An axis-aligned box with `f64` corners, as a caller gives it. It is closed: the faces belong to
/// the box.
///
/// The fields are plain numbers, so a box may be invalid. [`Aabb::validate`] returns the first
/// error, and every call of a broad phase rejects such a box with an error that names the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// The corner with the least coordinates.
    pub min: Point3<f64>,
    /// The corner with the greatest coordinates.
    pub max: Point3<f64>,
}

/// What is wrong with a box on an axis: the error of the loop over all boxes, which does not know
/// the body.
#[derive(Clone, Copy, Debug)]
pub(in crate::broad) enum BoxFault {
    NonFinite { axis: usize },
    Inverted { axis: usize },
}

/// Converts a least and a greatest corner to a box, without a check.
///
/// ```
/// use lin_canny::broad::Aabb;
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{BoxHint, polyhedron::solids};
///
/// let body = solids::cuboid(Vector3::new(1.0, 2.0, 3.0))?;
/// let mut hint = BoxHint::default();
/// let pose = Isometry3::translation(10.0, 0.0, 0.0);
/// let aabb = Aabb::from(body.aabb_at(&pose, &mut hint));
/// let tight = Aabb::from(([9.0, -2.0, -3.0].into(), [11.0, 2.0, 3.0].into()));
/// assert!(aabb.contains(&tight));
/// # Ok::<(), lin_canny::BuildError>(())
/// ```
impl From<(Point3<f64>, Point3<f64>)> for Aabb {
    fn from((min, max): (Point3<f64>, Point3<f64>)) -> Self {
        Self { min, max }
    }
}

impl Aabb {
    /// Returns the box between two corners, without a check.
    #[must_use]
    pub fn new(min: Point3<f64>, max: Point3<f64>) -> Self {
        Self { min, max }
    }

    /// Returns the box with this centre and these half extents.
    #[must_use]
    pub fn from_center(center: Point3<f64>, half: Vector3<f64>) -> Self {
        Self {
            min: center - half,
            max: center + half,
        }
    }

    /// Returns the whole space, for [`insert_unbounded`](super::SweepAndPrune::insert_unbounded)
    /// only.
    #[must_use]
    pub fn everything() -> Self {
        let far = Vector3::repeat(f64::INFINITY);
        Self {
            min: Point3::from(-far),
            max: Point3::from(far),
        }
    }

    /// Returns the box grown by `growth` on every side.
    #[must_use]
    pub fn grown(&self, growth: f64) -> Self {
        let by = Vector3::repeat(growth);
        Self {
            min: self.min - by,
            max: self.max + by,
        }
    }

    /// Returns the box that covers this box during a translation by `motion`. The translation
    /// follows a straight line; a rotation needs a separate bound.
    #[doc(alias = "sweep")]
    #[must_use]
    pub fn swept(&self, motion: &Vector3<f64>) -> Self {
        let zero = Vector3::zeros();
        Self {
            min: self.min + motion.smaller(zero),
            max: self.max + motion.larger(zero),
        }
    }

    /// Returns the smallest box that covers both boxes.
    #[must_use]
    pub fn united(&self, other: &Self) -> Self {
        Self {
            min: self.min.smaller(other.min),
            max: self.max.larger(other.max),
        }
    }

    /// Returns whether the closed boxes share a point. Touching boxes do.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Returns whether `other` lies within this box, faces included.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.min[k] && other.max[k] <= self.max[k])
    }

    /// Checks a finite box.
    ///
    /// # Errors
    /// Returns an error for the first axis with a bound that is NaN or infinite, or with a minimum
    /// above the maximum.
    pub fn validate(&self) -> Result<(), BroadPhaseError> {
        self.finite().map_err(|fault| BroadPhaseError::from_fault(fault, None))
    }

    pub(in crate::broad) fn finite(&self) -> Result<(), BoxFault> {
        if self.is_sound() {
            return Ok(());
        }
        (0..3).try_for_each(|axis| self.validate_axis(axis, f64::is_finite))
    }

    /// Checks a box that may be infinite.
    ///
    /// # Errors
    /// Returns an error for the first axis with a bound that is NaN, or with a minimum above the
    /// maximum.
    pub fn validate_unbounded(&self) -> Result<(), BroadPhaseError> {
        self.ordered().map_err(|fault| BroadPhaseError::from_fault(fault, None))
    }

    pub(in crate::broad) fn ordered(&self) -> Result<(), BoxFault> {
        (0..3).try_for_each(|axis| self.validate_axis(axis, |v| !v.is_nan()))
    }

    fn validate_axis(&self, axis: usize, usable: fn(f64) -> bool) -> Result<(), BoxFault> {
        let (min, max) = (self.min[axis], self.max[axis]);
        if !usable(min) || !usable(max) {
            Err(BoxFault::NonFinite { axis })
        } else if min > max {
            Err(BoxFault::Inverted { axis })
        } else {
            Ok(())
        }
    }

    /// Checks all axes without branches. Every comparison with NaN is false, so NaN takes the slow
    /// path.
    #[inline(always)]
    fn is_sound(&self) -> bool {
        let mut sound = true;
        for k in 0..3 {
            sound &= self.min[k] <= self.max[k];
            sound &= self.min[k] > f64::NEG_INFINITY;
            sound &= self.max[k] < f64::INFINITY;
        }
        sound
    }
}

/// Largest coordinate of a [`StoredBox`]; larger coordinates are clamped. Clamping is monotone, so
/// it may add pairs but loses none. The corners of [`StoredBox::EMPTY`] are beyond this limit.
pub(crate) const FARTHEST: f32 = 1e38;

/// A box as the broad phase stores it: `f32`, relative to the origin of the structure, every bound
/// rounded outward.
///
/// The stored boxes decide which boxes overlap. Rounding is monotone, so boxes that overlap in
/// `f64` overlap here too. Boxes that are separated in `f64` by less than about 2^-23 of their
/// distance from the origin may be a pair here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct StoredBox {
    /// Lower bounds.
    pub lo: [f32; 3],
    /// Upper bounds.
    pub hi: [f32; 3],
}

impl StoredBox {
    /// The box that overlaps nothing, not even itself. A body has this box before its insertion and
    /// after its removal. Its bounds are finite on purpose: their differences are never NaN, and
    /// every serde format can store them.
    pub(crate) const EMPTY: Self = Self {
        lo: [3e38; 3],
        hi: [-3e38; 3],
    };

    /// Returns the stored form of a valid box.
    #[must_use]
    pub fn outward(aabb: &Aabb, origin: &Point3<f64>) -> Self {
        // Adding zero converts -0 to +0, so that equal bounds have equal bits and sort keys.
        Self {
            lo: core::array::from_fn(|k| rounded_down(aabb.min[k] - origin[k]) + 0.0),
            hi: core::array::from_fn(|k| 0.0 - rounded_down(origin[k] - aabb.max[k])),
        }
    }

    /// Returns whether the closed boxes share a point.
    #[inline(always)]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        let mut all = true;
        for k in 0..3 {
            all &= self.lo[k] <= other.hi[k];
            all &= other.lo[k] <= self.hi[k];
        }
        all
    }

    /// Returns whether `other` lies within this box, faces included.
    #[inline(always)]
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        let mut all = true;
        for k in 0..3 {
            all &= self.lo[k] <= other.lo[k];
            all &= other.hi[k] <= self.hi[k];
        }
        all
    }

    /// Returns the coordinates in the cyclic order that starts `by` axes later.
    pub(crate) fn rotated(&self, by: usize) -> Self {
        let turn = |v: &[f32; 3]| [v[by % 3], v[(by + 1) % 3], v[(by + 2) % 3]];
        Self {
            lo: turn(&self.lo),
            hi: turn(&self.hi),
        }
    }

    /// Returns a box that overlaps every box at most `by` away from this box. It is a little
    /// larger, because differences of bounds are rounded.
    pub(crate) fn grown(&self, by: f64) -> Self {
        let by = by.next_up();
        Self {
            lo: self.lo.each(|v| rounded_down(f64::from(v) - by) + 0.0),
            hi: self.hi.each(|v| 0.0 - rounded_down(-f64::from(v) - by)),
        }
    }

    /// Returns the squared distance between the boxes in `f64`; zero if the boxes overlap.
    pub(crate) fn distance_squared(&self, other: &Self) -> f64 {
        let gap = |k: usize| {
            let before = f64::from(other.lo[k]) - f64::from(self.hi[k]);
            let after = f64::from(self.lo[k]) - f64::from(other.hi[k]);
            before.larger(after).at_least(0.0)
        };
        (0..3).map(|k| gap(k) * gap(k)).sum()
    }
}

/// Returns the largest `f32` at or below `v`, clamped to `FARTHEST`; exact if `v` is an `f32`.
fn rounded_down(v: f64) -> f32 {
    let limit = FARTHEST as f64;
    let v = if v < -limit { -limit } else { v };
    let v = if v > limit { limit } else { v };
    let nearest = v as f32;
    let step = i32::from(f64::from(nearest) > v);
    // Bit patterns of floats, read as sign and magnitude, increase with the value.
    let bits = nearest.to_bits() as i32;
    let rank = (bits ^ (((bits >> 31) as u32) >> 1) as i32) - step;
    f32::from_bits((rank ^ (((rank >> 31) as u32) >> 1) as i32) as u32)
}

/// Returns an integer that orders like the float. Equal floats have equal keys (a stored box has no
/// -0).
#[inline(always)]
pub(crate) fn order_key(v: f32) -> u32 {
    let bits = v.to_bits();
    bits ^ (((bits as i32) >> 31) as u32 | 0x8000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn rounding_is_outward_tight_and_exact_on_f32() {
        let mut rng = Rng::new(1);
        for _ in 0..20_000 {
            let v = rng.sign() * libm::exp2(rng.range(-141.0, 119.0));
            let down = rounded_down(v);
            assert!(f64::from(down) <= v && f64::from(down.next_up()) > v, "{v:e} {down:e}");
            let same = v as f32;
            assert_eq!(rounded_down(f64::from(same)), same);
        }
        assert_eq!(rounded_down(1e300), FARTHEST);
        assert_eq!(rounded_down(-1e300), -FARTHEST);
        assert_eq!(rounded_down(-1e-60), -f32::from_bits(1));
        assert_eq!(rounded_down(1e-60), 0.0);
    }

    #[test]
    fn keys_order_like_floats() {
        let values = [-1e38, -2.0, -1e-45, 0.0, 1e-45, 1.0, 1e38_f32];
        assert!(values.windows(2).all(|w| order_key(w[0]) < order_key(w[1])));
    }

    #[test]
    fn empty_overlaps_nothing() {
        let all = StoredBox::outward(&Aabb::everything(), &Point3::origin());
        assert!(!all.overlaps(&StoredBox::EMPTY) && !StoredBox::EMPTY.overlaps(&StoredBox::EMPTY));
        assert!(all.overlaps(&all));
    }
}
