//! A pair of bodies at one relative pose: the maps between their stored frames.

use nalgebra::{Matrix3, Vector3};

use super::simplex::Reach;
use crate::double_double::DoubleDouble;
use crate::lanes::{Lanes, Rotation};
use crate::polyhedron::{ConvexPolyhedron, power_of_two};
use crate::pose::{RelativePose, Which};
use crate::scalar::{Scalar, sqrt};
use crate::tolerance::{FAR, NEAR, UNIT, UNIT_DOUBLE_DOUBLE};

/// Two bodies placed against each other, in stored units.
pub(crate) struct Placed<'a> {
    pub(crate) a: &'a ConvexPolyhedron,
    pub(crate) b: &'a ConvexPolyhedron,
    /// `a_from_b` between stored frames: a rotation times `unit`, and a shift.
    pub(crate) rotation: Rotation,
    pub(crate) translation: Lanes,
    /// One unit of B's stored frame in A's.
    unit: f64,
    /// The pair's size L in A's stored units.
    size: f64,
    /// How far the stored origins are from the bodies' own, in A's stored units: zero for ordinary bodies.
    offsets: f64,
    pub(crate) pose: &'a RelativePose,
}

/// Why a pair cannot be placed in f64: it is so far apart, or its bodies such points, that only the separation counts.
pub(crate) struct BeyondRange;

impl<'a> Placed<'a> {
    /// Places B beside A. The caller has seen to it that A's units are not the smaller ones.
    #[inline(always)]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &'a RelativePose,
    ) -> Result<Self, BeyondRange> {
        let (rotation, translation, unit, offsets) = if a.as_given && b.as_given {
            (pose.turn(), pose.shift(), 1.0, 0.0)
        } else {
            shifted_and_scaled(a, b, pose)?
        };
        // The shift by the origins is made in double-double, and its error is relative to the origins: as a part of L
        // it is covered by every term in UNIT L.
        let extra = UNIT_DOUBLE_DOUBLE / UNIT * offsets;
        let size = a.radius + unit * b.radius + sqrt(translation.norm_squared()) + extra;
        // Written so that NaN goes the safe way.
        if !(size > NEAR && size < FAR) {
            return Err(BeyondRange);
        }
        Ok(Self {
            a,
            b,
            rotation,
            translation,
            unit,
            size,
            offsets,
            pose,
        })
    }

    /// L in A's stored units.
    #[inline(always)]
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Whether both bodies are stored in the same unit, so that directions and vectors turn alike: what the walk needs.
    /// Pairs that are not have a body 2^105 units or more, or less than 2^-105, in radius.
    #[inline(always)]
    pub(crate) fn has_one_unit(&self) -> bool {
        self.unit == 1.0
    }

    /// What the rounding of a solver is relative to: L, and the origins of the bodies in full where the placement rounds
    /// as coarsely as the solver (in double-double; for f64 they are a part of L).
    pub(crate) fn reach<T: Scalar>(&self) -> Reach {
        Reach {
            size: self.size,
            shared: if T::UNIT == UNIT { 0.0 } else { self.offsets },
        }
    }

    /// Where a point of B is in A's frame.
    #[inline(always)]
    pub(crate) fn point_in_a(&self, p: &Vector3<f64>) -> Vector3<f64> {
        (self.rotation.times(Lanes::new(p)) + self.translation).vector()
    }

    /// A vector of B's frame in A's.
    #[inline(always)]
    pub(crate) fn vector_in_a(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.times(Lanes::new(v)).vector()
    }

    /// Where a point of A is in B's frame. Needs one unit.
    #[inline(always)]
    pub(crate) fn point_in_b(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation
            .transposed_times(Lanes::new(p) - self.translation)
            .vector()
    }

    /// A vector of A's frame in B's. Needs one unit.
    #[inline(always)]
    pub(crate) fn vector_in_b(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transposed_times(Lanes::new(v)).vector()
    }

    /// The direction of B's frame along which points rise as they do along `n` of A's.
    #[inline(always)]
    pub(crate) fn direction_in_b(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.transposed_times(Lanes::new(n)).vector()
    }

    /// The matrix of B's ellipsoid in A's frame.
    pub(crate) fn spread_of_b(&self) -> Matrix3<f64> {
        let matrix = self.rotation.matrix();
        matrix * self.b.spread * matrix.transpose()
    }

    /// How high B's stored origin is along `n` of A's frame.
    #[inline(always)]
    pub(crate) fn lift(&self, n: &Vector3<f64>) -> f64 {
        Lanes::new(n).dot(self.translation)
    }
}

/// The bodies in the order a test needs them: `x` owns the vertex or edge that moves, `y` the feature beside it, and
/// the test is done in `y`'s frame.
pub(crate) trait Sides {
    /// Which body is `x`.
    const OF: Which;
    fn x(&self) -> &ConvexPolyhedron;
    fn y(&self) -> &ConvexPolyhedron;
    /// L.
    fn size(&self) -> f64;
    fn point_in_y(&self, p: &Vector3<f64>) -> Vector3<f64>;
    /// The direction of `x`'s frame along which points rise as they do along `n` of `y`'s.
    fn direction_in_x(&self, n: &Vector3<f64>) -> Vector3<f64>;
    /// From A to B in A's frame, for the unit direction `n` from `y` to `x` in `y`'s.
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64>;
    /// The witnesses on A and on B.
    fn witnesses(on_x: Vector3<f64>, on_y: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>);
}

/// A as `x`, B as `y`.
pub(crate) struct OfA<'a, 'b>(pub(crate) &'a Placed<'b>);

/// B as `x`, A as `y`.
pub(crate) struct OfB<'a, 'b>(pub(crate) &'a Placed<'b>);

impl Sides for OfA<'_, '_> {
    const OF: Which = Which::A;
    #[inline(always)]
    fn x(&self) -> &ConvexPolyhedron {
        self.0.a
    }
    #[inline(always)]
    fn y(&self) -> &ConvexPolyhedron {
        self.0.b
    }
    #[inline(always)]
    fn size(&self) -> f64 {
        self.0.size
    }
    #[inline(always)]
    fn point_in_y(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.point_in_b(p)
    }
    #[inline(always)]
    fn direction_in_x(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.0.vector_in_a(n)
    }
    #[inline(always)]
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64> {
        -self.0.vector_in_a(n)
    }
    #[inline(always)]
    fn witnesses(on_x: Vector3<f64>, on_y: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (on_x, on_y)
    }
}

impl Sides for OfB<'_, '_> {
    const OF: Which = Which::B;
    #[inline(always)]
    fn x(&self) -> &ConvexPolyhedron {
        self.0.b
    }
    #[inline(always)]
    fn y(&self) -> &ConvexPolyhedron {
        self.0.a
    }
    #[inline(always)]
    fn size(&self) -> f64 {
        self.0.size
    }
    #[inline(always)]
    fn point_in_y(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.0.point_in_a(p)
    }
    #[inline(always)]
    fn direction_in_x(&self, n: &Vector3<f64>) -> Vector3<f64> {
        self.0.direction_in_b(n)
    }
    #[inline(always)]
    fn normal(&self, n: &Vector3<f64>) -> Vector3<f64> {
        *n
    }
    #[inline(always)]
    fn witnesses(on_x: Vector3<f64>, on_y: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (on_y, on_x)
    }
}

/// Matrix, translation, scale and offsets of `a_from_b` between stored frames that are not the given ones. Scaling alone
/// is exact, so that powers of two change no bit of an answer but the exponent. Shifts are made in double-double, because
/// the offsets of the bodies may be far larger than the bodies and cancel.
#[cold]
fn shifted_and_scaled(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
) -> Result<(Rotation, Lanes, f64, f64), BeyondRange> {
    let scale = power_of_two(b.exponent - a.exponent);
    if a.origin == Vector3::zeros() && b.origin == Vector3::zeros() {
        let translation = pose.shift() * power_of_two(-a.exponent);
        return Ok((Rotation::new(&(pose.rotation() * scale)), translation, scale, 0.0));
    }
    let frame = Frame::<DoubleDouble>::new(a, b, pose).ok_or(BeyondRange)?;
    let matrix = Matrix3::from_fn(|r, c| frame.matrix[r][c].value());
    let translation = Vector3::from_fn(|r, _| frame.translation[r].value());
    let length = |v: &Vector3<f64>| v.abs().sum();
    let offsets = (length(&a.origin) + length(&b.origin)) / a.unit();
    Ok((Rotation::new(&matrix), Lanes::new(&translation), scale, offsets))
}

/// `a_from_b` between stored frames in the arithmetic of a solver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<T> {
    pub(crate) matrix: [[T; 3]; 3],
    pub(crate) translation: [T; 3],
}

impl Frame<f64> {
    pub(crate) fn of(placed: &Placed) -> Self {
        let matrix = placed.rotation.matrix();
        Self {
            matrix: core::array::from_fn(|r| core::array::from_fn(|c| matrix[(r, c)])),
            translation: placed.translation.vector().into(),
        }
    }
}

impl Frame<DoubleDouble> {
    /// From the poses as given. `None` where the translation is beyond the range of the products that follow.
    pub(crate) fn new(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> Option<Self> {
        Self::between((&a.origin, a.exponent), (&b.origin, b.exponent), pose)
    }

    /// From the poses of two frames, each stored about an origin and in units of a power of two.
    pub(crate) fn between(a: (&Vector3<f64>, i32), b: (&Vector3<f64>, i32), pose: &RelativePose) -> Option<Self> {
        // The bodies' own offsets are at most 1e116 and cannot leave the range alone.
        if pose.translation().amax() > FAR * power_of_two(a.1) {
            return None;
        }
        let (ra, rb) = (rotation(&pose.a.q()), rotation(&pose.b.q()));
        let at_b = apply(&rb, &b.0.map(DoubleDouble::from).into());
        let offset = core::array::from_fn(|k| at_b[k] + DoubleDouble::sum(pose.b.t()[k], -pose.a.t()[k]));
        let ra = transposed(&ra);
        let unit = DoubleDouble::from(power_of_two(-a.1));
        let in_a = apply(&ra, &offset);
        let translation = core::array::from_fn(|k| (in_a[k] - DoubleDouble::from(a.0[k])) * unit);
        let scale = DoubleDouble::from(power_of_two(b.1 - a.1));
        let columns: [[DoubleDouble; 3]; 3] =
            core::array::from_fn(|c| apply(&ra, &core::array::from_fn(|r| rb[r][c] * scale)));
        Some(Self {
            matrix: transposed(&columns),
            translation,
        })
    }
}

impl<T: Scalar> Frame<T> {
    /// A stored point of B in A's stored frame.
    #[inline(always)]
    pub(crate) fn point(&self, p: &Vector3<f64>) -> [T; 3] {
        let p = [T::from(p.x), T::from(p.y), T::from(p.z)];
        let r = apply(&self.matrix, &p);
        core::array::from_fn(|k| r[k] + self.translation[k])
    }

    /// A vector of B's stored frame in A's.
    pub(crate) fn vector(&self, v: &[T; 3]) -> [T; 3] {
        apply(&self.matrix, v)
    }

    /// The direction of B's stored frame along which points rise as they do along `n` in A's.
    #[inline(always)]
    pub(crate) fn direction(&self, n: &[T; 3]) -> [T; 3] {
        core::array::from_fn(|c| self.matrix[0][c] * n[0] + self.matrix[1][c] * n[1] + self.matrix[2][c] * n[2])
    }
}

/// The matrix of `q`, divided by `|q|^2`.
fn rotation(q: &[f64; 4]) -> [[DoubleDouble; 3]; 3] {
    let [x, y, z, w] = q.map(DoubleDouble::from);
    let two = DoubleDouble::from(2.0);
    let one = DoubleDouble::from(1.0);
    let s = two / (x * x + y * y + z * z + w * w);
    [
        [one - (y * y + z * z) * s, (x * y - w * z) * s, (x * z + w * y) * s],
        [(x * y + w * z) * s, one - (x * x + z * z) * s, (y * z - w * x) * s],
        [(x * z - w * y) * s, (y * z + w * x) * s, one - (x * x + y * y) * s],
    ]
}

#[inline]
fn apply<T: Scalar>(m: &[[T; 3]; 3], v: &[T; 3]) -> [T; 3] {
    core::array::from_fn(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2])
}

fn transposed<T: Copy>(m: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    core::array::from_fn(|r| core::array::from_fn(|c| m[c][r]))
}
