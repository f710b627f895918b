//! A pair of trees at one relative pose: the maps between the frames in single and double
//! precision, with their error bounds.

use alloc::borrow::Cow;
use nalgebra::{Matrix3, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{BOXES, CERTIFICATE, FAR, NEAR, SHORT_OF, UNIT, UNIT_DOUBLE_DOUBLE};
use crate::body::polyhedron::power_of_two;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::tree::{Below, Paths, Tree, up};
use crate::pair::draft::origins_apart;
use crate::pair::transform::{StoredFrame, about_origins};

/// A body as the tree searches use it.
#[derive(Clone, Copy)]
pub(crate) struct TreeSide<'a> {
    pub(crate) tree: &'a Tree,
    /// The frame of stored coordinates. Its origin is near the body, wherever the body's is.
    pub(crate) frame: StoredFrame,
    /// Largest distance of a point from the stored origin, in stored units.
    pub(crate) radius: f64,
    /// Largest error of the position of a stored point, in stored units.
    pub(crate) off: f64,
}

/// Largest size for single precision, in its unit.
///
/// Larger sizes are left to double precision, so that squares stay far inside the range of f32.
const SINGLE_MOST: f32 = (1u64 << 30) as f32;

/// Upper bound of lengths that underflow in the products of single precision.
const LEAST: f32 = 1.0 / (1u64 << 60) as f32;

/// The map `a_from_b` between the stored frames, and between the frames of the trees.
pub(crate) struct TreeFrame {
    /// The rotation times one unit of B's stored frame in A's stored units.
    pub(crate) matrix: Matrix3<f64>,
    pub(crate) translation: Vector3<f64>,
    /// The rotation without the unit.
    pub(crate) rotation: Matrix3<f64>,
    /// One unit of B's stored frame in A's stored units.
    pub(crate) scale: f64,
    /// Pair size L in A's stored units.
    pub(crate) size: f64,
    /// Largest position error of the stored points of both bodies, in A's stored units.
    pub(crate) off: f64,
    /// Error of a distance and of a height in double precision, position errors included.
    pub(crate) error: f64,
    /// A proven gap prunes a pair if it is at most this much less than the distance.
    pub(crate) tie: f64,
    pub(crate) single: Single,
}

/// The frame in single precision, in a unit in which the larger tree has a size of about one.
pub(crate) struct Single {
    /// The unit in A's stored units, a power of two; then its inverse.
    pub(crate) unit: f64,
    pub(super) per_unit: f64,
    /// From B's tree to A's tree, and back.
    pub(crate) ways: [Way; 2],
    pub(crate) scale_a: f32,
    pub(crate) scale_b: f32,
    /// Error of a gap; infinite if the sizes are too large for single precision.
    pub(crate) error: f32,
}

/// A map `x -> R x + t` in single precision.
pub(crate) struct Way {
    /// The rotation matrix, row by row.
    pub(crate) rotation: [f32; 9],
    pub(crate) translation: [f32; 3],
}

impl Way {
    fn new(rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> Self {
        Self {
            rotation: core::array::from_fn(|k| rotation[(k / 3, k % 3)] as f32),
            translation: [translation.x as f32, translation.y as f32, translation.z as f32],
        }
    }

    /// Returns the image of a point.
    #[inline(always)]
    pub(crate) fn place(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let (r, t) = (&self.rotation, &self.translation);
        [
            r[0] * x + r[1] * y + r[2] * z + t[0],
            r[3] * x + r[4] * y + r[5] * z + t[1],
            r[6] * x + r[7] * y + r[8] * z + t[2],
        ]
    }

    /// Returns the direction that the map rotates to `n`.
    #[inline(always)]
    pub(crate) fn back(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let r = &self.rotation;
        [
            r[0] * x + r[3] * y + r[6] * z,
            r[1] * x + r[4] * y + r[7] * z,
            r[2] * x + r[5] * y + r[8] * z,
        ]
    }
}

impl TreeFrame {
    /// Creates the frame of two bodies at a pose.
    ///
    /// Returns `None` if the bodies are so far apart, or so small, that squares of lengths leave
    /// the range of f64.
    pub(crate) fn new(a: TreeSide, b: TreeSide, pose: &RelativePose) -> Option<Self> {
        let scale = ratio(a, b);
        let (pose, offsets) = of_stored(a, b, pose)?;
        let rotation = pose.rotation();
        let per_unit = power_of_two(-a.frame.exponent);
        let translation = pose.translation() * per_unit;
        // The stored origins are put in double-double, with an error relative to them. L contains
        // them, so every term in UNIT L covers it.
        let extra = UNIT_DOUBLE_DOUBLE / UNIT * offsets * per_unit;
        let size = a.radius + scale * b.radius + sqrt(translation.norm_squared()) + extra;
        // Written so that NaN returns `None`.
        if !(size > NEAR && size < FAR) {
            return None;
        }
        let matrix = rotation * scale;
        let off = a.off + scale * b.off;
        let error = CERTIFICATE * UNIT * size + off;
        Some(Self {
            matrix,
            translation,
            rotation,
            scale,
            size,
            off,
            error,
            tie: SHORT_OF * size,
            single: Single::new(a, b, scale, &matrix, &translation, &rotation, error),
        })
    }

    /// Returns the position of a stored point of B in A's stored frame.
    #[inline(always)]
    pub(crate) fn point(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * p + self.translation
    }

    /// Returns the gradient of `n . x` in B's stored frame, where `n` and `x` are in A's stored
    /// frame.
    #[inline(always)]
    pub(crate) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.matrix.tr_mul(n)
    }

    /// Converts a length from A's stored units to the unit of single precision, rounded up.
    #[inline(always)]
    pub(crate) fn single_up(&self, length: f64) -> f32 {
        up(length * self.single.per_unit)
    }
}

impl Single {
    fn new(
        a: TreeSide,
        b: TreeSide,
        scale: f64,
        matrix: &Matrix3<f64>,
        translation: &Vector3<f64>,
        rotation: &Matrix3<f64>,
        error: f64,
    ) -> Self {
        let (unit, [scale_a, scale_b]) = units_of(a, b, scale);
        let shift = (matrix * b.tree.centre + translation - a.tree.centre) / unit;
        let reach = a.tree.reach * scale_a + b.tree.reach * scale_b + sqrt(shift.norm_squared()) as f32;
        // The second term covers the error of the shift if bodies are far from their origins, and
        // the position errors of points. The third covers scales that underflow.
        let error = BOXES as f32 * reach + (2.0 * error / unit) as f32 + LEAST;
        Self {
            unit,
            per_unit: 1.0 / unit,
            ways: [
                Way::new(rotation, &shift),
                Way::new(&rotation.transpose(), &-rotation.tr_mul(&shift)),
            ],
            scale_a,
            scale_b,
            error: if reach < SINGLE_MOST { error } else { f32::INFINITY },
        }
    }
}

/// Returns the unit of single precision in A's stored units, and the units of both trees in it.
fn units_of(a: TreeSide, b: TreeSide, scale: f64) -> (f64, [f32; 2]) {
    let (of_a, of_b) = (a.tree.unit(), b.tree.unit() * scale);
    let unit = of_a.larger(of_b);
    (unit, [(of_a / unit) as f32, (of_b / unit) as f32])
}

/// How far the points of two bodies have moved in their frames, by the paths of their trees.
pub(crate) struct TreeMoves<'a> {
    pub(crate) trees: [&'a Tree; 2],
    /// The units of both trees in the unit of single precision.
    pub(crate) scales: [f32; 2],
    /// The units of both trees in A's stored units.
    units: [f64; 2],
}

impl<'a> TreeMoves<'a> {
    pub(super) fn new(a: TreeSide<'a>, b: TreeSide<'a>) -> Self {
        let scale = ratio(a, b);
        Self {
            trees: [a.tree, b.tree],
            scales: units_of(a, b, scale).1,
            units: [a.tree.unit(), b.tree.unit() * scale],
        }
    }

    /// Returns the path sums of both roots: over all moves, the longest displacement of a point.
    pub(crate) fn totals(&self) -> [u64; 2] {
        self.trees.each(|tree| tree.paths.total)
    }

    /// Returns how far points of both bodies may have moved since their path sums were `before`.
    ///
    /// The length is in A's stored units, up to rounding. Returns `None` if the difference is too
    /// large for the 32-bit paths of the nodes.
    pub(crate) fn since(&self, before: [u64; 2]) -> Option<f64> {
        let [a, b] = self.totals();
        let least = |now: u64, then: u64| u32::try_from(now.checked_sub(then)?).ok();
        let (a, b) = (least(a, before[0])?, least(b, before[1])?);
        let length = |units| f64::from(Paths::length(units));
        Some(length(a) * self.units[0] + length(b) * self.units[1])
    }
}

/// Returns one unit of B's stored frame in A's stored units.
fn ratio(a: TreeSide, b: TreeSide) -> f64 {
    power_of_two((b.frame.exponent - a.frame.exponent).clamp(-1000, 1000))
}

/// Returns the relative pose of the stored origins, and the sum of their distances from the bodies'
/// origins.
///
/// `None` if their offset is out of range.
#[inline(always)]
pub(crate) fn of_stored<'p>(a: TreeSide, b: TreeSide, pose: &'p RelativePose) -> Option<(Cow<'p, RelativePose>, f64)> {
    if a.frame.is_at_origin() && b.frame.is_at_origin() {
        return Some((Cow::Borrowed(pose), 0.0));
    }
    let origins = [&a.frame.origin, &b.frame.origin];
    let offsets = origins[0].abs().sum() + origins[1].abs().sum();
    Some((Cow::Owned(about_origins(pose, origins)?), offsets))
}

/// Returns the distance of the stored origins, the error as a distance of the bodies, and the
/// direction.
///
/// The lengths are in the caller's unit.
pub(super) fn far(a: TreeSide, b: TreeSide, pose: &RelativePose) -> (f64, f64, Vector3<f64>) {
    let lengths = |v: &Vector3<f64>| v.abs().sum();
    let (pose, off) = match of_stored(a, b, pose) {
        Some((pose, offsets)) => (pose, UNIT * offsets),
        None => (Cow::Borrowed(pose), lengths(&a.frame.origin) + lengths(&b.frame.origin)),
    };
    let (distance, n) = origins_apart(&pose);
    let reach = a.radius * a.frame.unit() + b.radius * b.frame.unit() + off;
    (distance, distance * (CERTIFICATE * UNIT) + reach, n)
}

/// Returns the two halves of a pair of nodes; `None` for a pair of leaves.
///
/// The node whose box has the larger surface is split, unless it is a leaf. The longer box is not
/// preferred, because the children of a long thin box may be as long as the box.
pub(crate) fn split_pair([a, b]: [&Tree; 2], frame: &TreeFrame, [x, y]: NodePair) -> Option<[NodePair; 2]> {
    let is_a_larger = || {
        let (of_a, of_b) = (&a.boxes[x as usize], &b.boxes[y as usize]);
        let (scale_a, scale_b) = (frame.single.scale_a, frame.single.scale_b);
        of_a.area() * (scale_a * scale_a) >= of_b.area() * (scale_b * scale_b)
    };
    match (a.below(x), b.below(y)) {
        (Below::Children(c), Below::Leaf(..)) => Some([[c, y], [c + 1, y]]),
        (Below::Leaf(..), Below::Children(c)) => Some([[x, c], [x, c + 1]]),
        (Below::Children(c), Below::Children(_)) if is_a_larger() => Some([[c, y], [c + 1, y]]),
        (_, Below::Children(c)) => Some([[x, c], [x, c + 1]]),
        _ => None,
    }
}
