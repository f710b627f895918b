//! The seam between shapes and solvers: support points, and how they move with the direction.

use nalgebra::Vector3;

use crate::num::scalar::{Scalar, Vec3, root};
use crate::polyhedron::Feature;

/// A flat round face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    /// Its centre is at `(0, 0, z)`, its outward normal along z with the sign of `side`.
    pub(crate) z: f64,
    pub(crate) side: f64,
    pub(crate) radius: f64,
}

impl Disc {
    /// The point of the disc nearest to a place.
    pub(crate) fn foot<T: Scalar>(&self, place: &Vec3<T>) -> Vec3<T> {
        let off = root(place[0] * place[0] + place[1] * place[1]);
        let r = T::from(self.radius);
        let s = if off > r { r / off } else { T::from(1.0) };
        [place[0] * s, place[1] * s, T::from(self.z)]
    }
}

/// A convex core as its support function sees it: `h(n) = max of n . x`, over branches.
///
/// A *branch* is a smooth piece of the map from a direction to its support point: a vertex, a rim,
/// a whole ellipsoid. Directions are unit vectors in the frame of the core; solvers run in f64 and
/// in double-double.
pub(crate) trait Support {
    /// Largest distance of a point of the core from its origin, rounded up.
    fn reach(&self) -> f64;

    /// By how many UNIT times the radius a height errs more than
    /// [`CERTIFICATE`](crate::tolerance::CERTIFICATE) counts.
    fn noise(&self) -> f64 {
        0.0
    }

    /// Branch and support point along `n`, `hint` a branch to begin with.
    fn support<T: Scalar>(&self, n: &Vec3<T>, hint: u32) -> (u32, Vec3<T>);

    /// The point of a branch along `n`: a point of the core, and its support point if the branch is
    /// the highest there.
    fn of_branch<T: Scalar>(&self, branch: u32, n: &Vec3<T>) -> Vec3<T>;

    /// How the `point` of a branch along `n` moves when `n` turns by the tangent `d`: the second
    /// derivative of the support function, applied to `d`.
    fn bent<T: Scalar>(&self, branch: u32, point: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T>;

    /// A point of the branch close to `place`, a place close to the branch: a point of the core.
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T>;

    /// A ball inside the core, centre and radius, which reaches to the surface at `point`, a place
    /// of normal `n`, or almost: the radius is never too large, and zero if no ball is known.
    fn inner_ball(&self, point: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64);

    /// The flat round face that faces along `n`, of cores that have one there.
    fn disc(&self, n: &Vector3<f64>) -> Option<Disc>;

    /// The feature that holds the points of up to three branches, `point` among them.
    fn feature(&self, branches: &[u32], point: &Vector3<f64>) -> Feature;
}
