//! Two cores at a relative pose, in the arithmetic of a solver.
//!
//! The Minkowski difference `B - A` is evaluated one branch pair at a time.

use crate::base::num::scalar::{Scalar, Vec3, dot, neg, root, scaled, sub};
use crate::body::shape::Support;
use crate::convex::smooth::cores::{Any, CoreKind};
use crate::pair::transform::Transform;

/// Two cores at a relative pose.
pub(super) struct PosedCores<'a, A, B, T> {
    pub(super) a: &'a A,
    pub(super) b: &'a B,
    pub(super) frame: Transform<T>,
    /// Pair size L: both radii plus the distance of the origins.
    pub(super) size: f64,
}

/// A pair of branches, one per core, with a point on each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DifferencePoint<T> {
    /// The branches of A and of B.
    pub(super) of: [u32; 2],
    /// In the frame of A.
    pub(super) on_a: Vec3<T>,
    /// In the frame of B.
    pub(super) on_b: Vec3<T>,
    /// From the point of A to that of B, in the frame of A.
    pub(super) w: Vec3<T>,
}

/// A unit direction from A to B with two perpendicular unit tangents.
#[derive(Clone, Copy)]
pub(super) struct Toward<T> {
    pub(super) n: Vec3<T>,
    /// Direction of the support point of B, in the frame of B.
    pub(super) m: Vec3<T>,
    pub(super) tangents: [Vec3<T>; 2],
}

/// A step in the tangent plane of a direction.
pub(super) type PlaneStep<T> = [T; 2];

impl<T: Scalar, A: Support, B: Support> PosedCores<'_, A, B, T> {
    /// Returns a unit direction in both frames, with two tangents.
    #[inline(always)]
    pub(super) fn toward(&self, n: Vec3<T>) -> Toward<T> {
        let m = neg(&self.frame.direction(&n));
        let tangents = tangents(&n);
        Toward { n, m, tangents }
    }

    #[inline(always)]
    pub(super) fn piece(&self, of: [u32; 2], on_a: Vec3<T>, on_b: Vec3<T>) -> DifferencePoint<T> {
        let w = sub(&self.at(&on_b), &on_a);
        DifferencePoint { of, on_a, on_b, w }
    }

    /// Returns a point of B in the frame of A.
    #[inline(always)]
    pub(super) fn at(&self, on_b: &Vec3<T>) -> Vec3<T> {
        let (turned, t) = (self.frame.vector(on_b), self.frame.translation);
        [turned[0] + t[0], turned[1] + t[1], turned[2] + t[2]]
    }

    /// Returns the support points of both cores: they minimise `n . w` over the difference.
    #[inline(always)]
    pub(super) fn support(&self, toward: &Toward<T>, hint: [u32; 2]) -> DifferencePoint<T> {
        let (a, on_a) = self.a.support(&toward.n, hint[0]);
        let (b, on_b) = self.b.support(&toward.m, hint[1]);
        self.piece([a, b], on_a, on_b)
    }

    /// Returns the points of two branches. The point of a branch that a `known` pair contains is
    /// copied from it.
    #[inline(always)]
    pub(super) fn of_branches(
        &self,
        of: [u32; 2],
        toward: &Toward<T>,
        known: &[DifferencePoint<T>],
    ) -> DifferencePoint<T> {
        let on_a = match known.iter().find(|p| p.of[0] == of[0]) {
            Some(p) => p.on_a,
            None => self.a.of_branch(of[0], &toward.n),
        };
        let on_b = match known.iter().find(|p| p.of[1] == of[1]) {
            Some(p) => p.on_b,
            None => self.b.of_branch(of[1], &toward.m),
        };
        self.piece(of, on_a, on_b)
    }

    /// Returns the second derivative of the height of a branch pair in the tangent plane (entries
    /// 00, 01, 11).
    #[inline(always)]
    pub(super) fn bend(&self, piece: &DifferencePoint<T>, toward: &Toward<T>) -> [T; 3] {
        let (a, b) = (self.bend_of_a(piece, toward), self.bend_of_b(piece, toward));
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }

    #[inline(always)]
    fn bend_of_a(&self, piece: &DifferencePoint<T>, toward: &Toward<T>) -> [T; 3] {
        let [d, e] = &toward.tangents;
        let bent = |d: &Vec3<T>| self.a.bent(piece.of[0], &piece.on_a, &toward.n, d);
        form(d, e, &bent(d), &bent(e))
    }

    #[inline(always)]
    fn bend_of_b(&self, piece: &DifferencePoint<T>, toward: &Toward<T>) -> [T; 3] {
        let [d, e] = [
            self.frame.direction(&toward.tangents[0]),
            self.frame.direction(&toward.tangents[1]),
        ];
        let bent = |d: &Vec3<T>| self.b.bent(piece.of[1], &piece.on_b, &toward.m, d);
        form(&d, &e, &bent(&d), &bent(&e))
    }

    /// Returns the points of a branch pair after a step of the direction in the tangent plane. Each
    /// point moves along the surface of its core.
    pub(super) fn slid(
        &self,
        piece: &DifferencePoint<T>,
        toward: &Toward<T>,
        step: &PlaneStep<T>,
    ) -> DifferencePoint<T> {
        let d = tangent(toward, step);
        let by = self.a.bent(piece.of[0], &piece.on_a, &toward.n, &d);
        let on_a = self.a.onto(piece.of[0], &add(&piece.on_a, &by));
        let d_in_b = neg(&self.frame.direction(&d));
        let by = self.b.bent(piece.of[1], &piece.on_b, &toward.m, &d_in_b);
        let on_b = self.b.onto(piece.of[1], &add(&piece.on_b, &by));
        self.piece(piece.of, on_a, on_b)
    }
}

impl<A: CoreKind, B: CoreKind> PosedCores<'_, A, B, f64> {
    /// Runs a slow path with both cores as [`Any`], so that it is compiled once for all pairs.
    #[inline(always)]
    pub(super) fn with_any<R>(&self, slow: impl FnOnce(&PosedCores<Any, Any, f64>) -> R) -> R {
        let (a, b) = (&self.a.any(), &self.b.any());
        let Self { frame, size, .. } = *self;
        slow(&PosedCores { a, b, frame, size })
    }
}

/// Returns two unit tangents of a unit direction (Duff et al. 2017, "Building an orthonormal basis,
/// revisited").
#[inline(always)]
pub(super) fn tangents<T: Scalar>(n: &Vec3<T>) -> [Vec3<T>; 2] {
    let one = T::from(1.0);
    let sign = if n[2] < T::from(0.0) { -one } else { one };
    let a = -one / (sign + n[2]);
    let b = n[0] * n[1] * a;
    [
        [one + sign * n[0] * n[0] * a, sign * b, -sign * n[0]],
        [b, sign + n[1] * n[1] * a, -n[1]],
    ]
}

/// Returns a unit direction near `n` that lies in no plane of symmetry that contains `n`.
pub(super) fn askew<T: Scalar>(n: &Vec3<T>) -> Vec3<T> {
    let [d, e] = tangents(n);
    let off = add(&scaled(&d, T::from(0.37)), &scaled(&e, T::from(0.61)));
    unit(&add(n, &off)).unwrap_or(*n)
}

/// Returns entries 00, 01, 11 of a symmetric form on two tangents, from the images of the tangents.
#[inline(always)]
fn form<T: Scalar>(d: &Vec3<T>, e: &Vec3<T>, of_d: &Vec3<T>, of_e: &Vec3<T>) -> [T; 3] {
    [dot(d, of_d), dot(d, of_e), dot(e, of_e)]
}

/// Returns a vector rounded to f64.
#[inline(always)]
pub(super) fn values<T: Scalar>(v: &Vec3<T>) -> Vec3<f64> {
    [v[0].value(), v[1].value(), v[2].value()]
}

#[inline(always)]
pub(super) fn add<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Returns a step of the tangent plane as a vector.
#[inline(always)]
pub(super) fn tangent<T: Scalar>(toward: &Toward<T>, step: &PlaneStep<T>) -> Vec3<T> {
    let [d, e] = &toward.tangents;
    add(&scaled(d, step[0]), &scaled(e, step[1]))
}

/// Returns the unit vector along `v`, if `v` has a direction.
#[inline(always)]
pub(super) fn unit<T: Scalar>(v: &Vec3<T>) -> Option<Vec3<T>> {
    let length = root(dot(v, v));
    (length.value() > 0.0 && length.value().is_finite()).then(|| scaled(v, T::from(1.0) / length))
}
