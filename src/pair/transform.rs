//! The relative pose in the arithmetic of a solver, and the lengths that scale rounding errors.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::scalar::Scalar;
use crate::base::pose::{PoseBits, RelativePose};
use crate::base::tolerance::FAR;
use crate::body::polyhedron::{ConvexPolyhedron, power_of_two};
use crate::pair::posed::PosedPair;

/// Lengths that scale the rounding errors of Minkowski points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorScale {
    /// Length of Minkowski points; scales the error of each single point.
    pub(crate) size: f64,
    /// Scales the additional error that all points share: an error of the translation between the
    /// bodies.
    pub(crate) shared: f64,
}

impl ErrorScale {
    /// Returns the length that scales the total error of a position.
    pub(crate) fn total(self) -> f64 {
        self.size + self.shared
    }
}

/// The transform `a_from_b` between stored frames, in the arithmetic of a solver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform<T> {
    pub(crate) matrix: [[T; 3]; 3],
    pub(crate) translation: [T; 3],
}

/// A rotation matrix by rows.
type Rotation = [[DoubleDouble; 3]; 3];

impl Transform<f64> {
    /// Returns the transform of a posed pair, as rounded to f64.
    pub(crate) fn of(posed: &PosedPair) -> Self {
        let matrix = posed.rotation.matrix();
        Self {
            matrix: core::array::from_fn(|r| core::array::from_fn(|c| matrix[(r, c)])),
            translation: posed.translation.vector().into(),
        }
    }
}

/// The frame in which a body is stored.
///
/// Its origin in the body, and the exponent of its unit, a power of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StoredFrame {
    pub(crate) origin: Vector3<f64>,
    pub(crate) exponent: i32,
}

impl StoredFrame {
    pub(crate) fn of(body: &ConvexPolyhedron) -> Self {
        Self {
            origin: body.origin,
            exponent: body.exponent,
        }
    }

    /// Returns one stored unit in the caller's unit.
    pub(crate) fn unit(&self) -> f64 {
        power_of_two(self.exponent)
    }

    /// Returns whether the frame has the origin of the body.
    pub(crate) fn is_at_origin(&self) -> bool {
        self.origin == Vector3::zeros()
    }

    /// Maps a stored point to the frame of the body.
    ///
    /// The result is exact for the vertices and points of which the body was made.
    pub(crate) fn given(&self, stored: &Vector3<f64>) -> Point3<f64> {
        let place = stored * self.unit();
        // A sum with zero would lose the sign of a zero.
        Point3::from(if self.is_at_origin() {
            place
        } else {
            place + self.origin
        })
    }

    /// Maps a point of the body's frame to the stored frame. The inverse of [`given`](Self::given).
    ///
    /// Near the body the difference is exact (Sterbenz); it errs by one rounding elsewhere.
    pub(crate) fn stored(&self, given: &Point3<f64>) -> Vector3<f64> {
        (given.coords - self.origin) / self.unit()
    }

    /// Maps the pose of a member from the frame of the body to a frame about the stored origin.
    ///
    /// Lengths stay in the caller's unit.
    pub(crate) fn about(&self, pose: &Isometry3<f64>) -> Isometry3<f64> {
        let place = pose.translation.vector - self.origin;
        Isometry3::from_parts(place.into(), pose.rotation)
    }
}

/// Maps a point by a pose, relative to another point; rounded once.
pub(crate) fn placed_from(pose: &Isometry3<f64>, point: &Vector3<f64>, from: &Vector3<f64>) -> Vector3<f64> {
    let pose = PoseBits::new(pose);
    let (q, t) = (pose.q(), pose.t());
    let there = turned(&q, &rotation(&q), &point.map(DoubleDouble::from).into());
    Vector3::from_fn(|k, _| (there[k] + DoubleDouble::sum(t[k], -from[k])).value())
}

/// Returns the relative pose of two bodies about other origins, which are given in their frames.
///
/// The offset of the new origins is the difference of the two translations, in double-double: the
/// old origins may be far away and cancel. Returns `None` if it is out of range.
pub(crate) fn about_origins(pose: &RelativePose, [a, b]: [&Vector3<f64>; 2]) -> Option<RelativePose> {
    if *a == Vector3::zeros() && *b == *a {
        return Some(*pose);
    }
    let (pose_a, pose_b) = pose.poses();
    let in_world = |q: [f64; 4], p: &Vector3<f64>| turned(&q, &rotation(&q), &p.map(DoubleDouble::from).into());
    let (of_a, of_b) = (in_world(pose.a.q(), a), in_world(pose.b.q(), b));
    let apart = apart(pose, 1.0);
    let offset: [DoubleDouble; 3] = core::array::from_fn(|k| (of_b[k] - of_a[k]) + apart[k]);
    let at = |part: [f64; 3], q| Isometry3::from_parts(Vector3::from(part).into(), q);
    let (low, high) = (offset.each(|x| -x.lo), offset.each(|x| x.hi));
    RelativePose::new(&at(low, pose_a.rotation), &at(high, pose_b.rotation)).ok()
}

/// Returns the position of B in A's frame, and whether it is exact, if both bodies are rotated
/// alike.
///
/// Then a pose maps points without a rotation. Returns `None` for other poses.
#[cfg(feature = "meshes")]
pub(crate) fn shift_alike(pose: &RelativePose) -> Option<([DoubleDouble; 3], bool)> {
    let (a, b) = (pose.a.q(), pose.b.q());
    let is_unturned = a[..3] == [0.0; 3];
    if a != b && !(is_unturned && b[..3] == [0.0; 3]) {
        return None;
    }
    let shift = apart(pose, 1.0);
    let is_exact = is_unturned || shift == [DoubleDouble::default(); 3];
    Some((turned(&a, &transposed(&rotation(&a)), &shift), is_exact))
}

impl Transform<DoubleDouble> {
    /// Returns the transform from the unrounded poses.
    ///
    /// `None` if the translation is out of range for the products below.
    pub(crate) fn new(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> Option<Self> {
        Self::between(&StoredFrame::of(a), &StoredFrame::of(b), pose)
    }

    /// Returns the transform between two stored frames. `None` as for [`new`](Self::new).
    pub(crate) fn between(a: &StoredFrame, b: &StoredFrame, pose: &RelativePose) -> Option<Self> {
        let (a_from_world, world_from_b) = (transposed(&rotation(&pose.a.q())), rotation(&pose.b.q()));
        let translation = Self::shift_by([&a_from_world, &world_from_b], a, &b.origin, pose)?;
        let scale = power_of_two(b.exponent - a.exponent);
        let columns: [[DoubleDouble; 3]; 3] = core::array::from_fn(|c| {
            apply(
                &a_from_world,
                &core::array::from_fn(|r| world_from_b[r][c].scaled(scale)),
            )
        });
        Some(Self {
            matrix: transposed(&columns),
            translation,
        })
    }

    /// Returns the position of B's origin in A's stored frame. `None` as for [`new`](Self::new).
    pub(crate) fn shift(a: &StoredFrame, b: &Vector3<f64>, pose: &RelativePose) -> Option<[DoubleDouble; 3]> {
        let rotations = [&transposed(&rotation(&pose.a.q())), &rotation(&pose.b.q())];
        Self::shift_by(rotations, a, b, pose)
    }

    /// Returns [`shift`](Self::shift) for the given rotations of the pose.
    fn shift_by(
        rotations: [&Rotation; 2],
        a: &StoredFrame,
        b: &Vector3<f64>,
        pose: &RelativePose,
    ) -> Option<[DoubleDouble; 3]> {
        // The offsets of the bodies are at most 1e116 and cannot leave the range alone.
        if pose.translation().amax() > FAR * power_of_two(a.exponent) {
            return None;
        }
        let apart = apart(pose, 1.0);
        let place = placed(rotations, pose, [&a.origin, b], &apart);
        Some(place.each(|x| x.scaled(power_of_two(-a.exponent))))
    }
}

/// The rotations of a pose in double-double, for one or two points, for which a whole [`Transform`]
/// costs too much.
///
/// Both bodies are stored in the same unit, about their own origins.
#[cfg(feature = "exact")]
pub(crate) struct Turned {
    pose: RelativePose,
    a_from_world: Rotation,
    world_from_b: Rotation,
    /// Difference of the translations, in stored units.
    apart: [DoubleDouble; 3],
}

#[cfg(feature = "exact")]
impl Turned {
    /// The stored unit of both bodies is two to the `exponent`.
    pub(crate) fn new(pose: RelativePose, exponent: i32) -> Self {
        Self {
            a_from_world: transposed(&rotation(&pose.a.q())),
            world_from_b: rotation(&pose.b.q()),
            apart: apart(&pose, power_of_two(-exponent)),
            pose,
        }
    }

    /// Returns the vector from a stored point of A to one of B, in A's frame.
    pub(crate) fn between(&self, p: &Vector3<f64>, q: &Vector3<f64>) -> [DoubleDouble; 3] {
        let rotations = [&self.a_from_world, &self.world_from_b];
        placed(rotations, &self.pose, [p, q], &self.apart)
    }

    /// Maps a vector from B's frame to A's.
    pub(crate) fn vector(&self, v: &[DoubleDouble; 3]) -> [DoubleDouble; 3] {
        apply(&self.a_from_world, &apply(&self.world_from_b, v))
    }
}

impl<T: Scalar> Transform<T> {
    /// Maps a stored point of B to A's stored frame.
    #[inline(always)]
    pub(crate) fn point(&self, p: &Vector3<f64>) -> [T; 3] {
        let p = [T::from(p.x), T::from(p.y), T::from(p.z)];
        let r = apply(&self.matrix, &p);
        core::array::from_fn(|k| r[k] + self.translation[k])
    }

    /// Maps a vector from B's stored frame to A's.
    pub(crate) fn vector(&self, v: &[T; 3]) -> [T; 3] {
        apply(&self.matrix, v)
    }

    /// Maps a normal from A's stored frame to B's: B's points rise along the result as they rise
    /// along `n`.
    #[inline(always)]
    pub(crate) fn direction(&self, n: &[T; 3]) -> [T; 3] {
        core::array::from_fn(|c| self.matrix[0][c] * n[0] + self.matrix[1][c] * n[1] + self.matrix[2][c] * n[2])
    }
}

/// Returns the difference of the translations times a power of two.
fn apart(pose: &RelativePose, by: f64) -> [DoubleDouble; 3] {
    let (a, b) = (pose.a.t(), pose.b.t());
    core::array::from_fn(|k| DoubleDouble::sum(b[k], -a[k]).scaled(by))
}

/// Returns the vector from a point of A to a point of B in A's frame, for the difference of the
/// translations.
fn placed(
    [a_from_world, world_from_b]: [&Rotation; 2],
    pose: &RelativePose,
    [p, q]: [&Vector3<f64>; 2],
    apart: &[DoubleDouble; 3],
) -> [DoubleDouble; 3] {
    let at_b = turned(&pose.b.q(), world_from_b, &q.map(DoubleDouble::from).into());
    let offset = core::array::from_fn(|k| at_b[k] + apart[k]);
    let in_a = turned(&pose.a.q(), a_from_world, &offset);
    core::array::from_fn(|k| in_a[k] - DoubleDouble::from(p[k]))
}

/// Returns a vector rotated by a quaternion, or the vector itself if the quaternion is real.
fn turned(q: &[f64; 4], rotation: &Rotation, v: &[DoubleDouble; 3]) -> [DoubleDouble; 3] {
    if q[..3] == [0.0; 3] {
        return *v;
    }
    apply(rotation, v)
}

/// Returns the rotation matrix of the quaternion `q`, divided by `|q|^2`.
fn rotation(q: &[f64; 4]) -> Rotation {
    let [x, y, z, w] = *q;
    let [xx, yy, zz, ww] = q.each(|c| DoubleDouble::product(c, c));
    let [xy, xz, yz] = [(x, y), (x, z), (y, z)].each(|(a, b)| DoubleDouble::product(a, b));
    let [wx, wy, wz] = [x, y, z].each(|c| DoubleDouble::product(w, c));
    let one = DoubleDouble::from(1.0);
    let s = DoubleDouble::from(2.0) / (xx + yy + zz + ww);
    [
        [one - (yy + zz) * s, (xy - wz) * s, (xz + wy) * s],
        [(xy + wz) * s, one - (xx + zz) * s, (yz - wx) * s],
        [(xz - wy) * s, (yz + wx) * s, one - (xx + yy) * s],
    ]
}

#[inline]
fn apply<T: Scalar>(m: &[[T; 3]; 3], v: &[T; 3]) -> [T; 3] {
    core::array::from_fn(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2])
}

fn transposed<T: Copy>(m: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    core::array::from_fn(|r| core::array::from_fn(|c| m[c][r]))
}
