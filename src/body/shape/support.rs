//! Support points of shapes and their derivatives by the direction, for the solvers; the interface
//! of a curved core; and the match of a core.

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, root};
use crate::body::polyhedron::Feature;
use crate::body::shape::Mass;
use nalgebra::Vector3;

/// A flat round face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    /// The centre is at `(0, 0, z)`; the outward normal is along z, with the sign of `side`.
    pub(crate) z: f64,
    pub(crate) side: f64,
    pub(crate) radius: f64,
}

impl Disc {
    /// Returns the point of the disc nearest to a given point.
    pub(crate) fn foot<T: Scalar>(&self, place: &Vec3<T>) -> Vec3<T> {
        let off = root(place[0] * place[0] + place[1] * place[1]);
        let r = T::from(self.radius);
        let s = if off > r { r / off } else { T::from(1.0) };
        [place[0] * s, place[1] * s, T::from(self.z)]
    }
}

/// A flat or straight facet of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Flat {
    Disc(Disc),
    /// A generator of a curved side, by both ends.
    Line([Vector3<f64>; 2]),
}

impl Flat {
    /// Returns the middle of the facet.
    pub(crate) fn middle(&self) -> Vec3<f64> {
        match self {
            Self::Disc(disc) => [0.0, 0.0, disc.z],
            Self::Line([p, q]) => ((p + q) * 0.5).into(),
        }
    }

    /// Returns the point of the facet nearest to a given point.
    pub(crate) fn foot(&self, place: &Vec3<f64>) -> Vec3<f64> {
        match self {
            Self::Disc(disc) => disc.foot(place),
            Self::Line([p, q]) => {
                let u = q - p;
                let t = u.dot(&(Vector3::from(*place) - p)) / u.norm_squared();
                (p + u * t.clamped(0.0, 1.0)).into()
            }
        }
    }
}

/// A convex core by its support function `h(n) = max of n . x`, over branches.
///
/// A *branch* is a domain in which the map from a direction to its support point is smooth: a
/// vertex, a rim, a whole ellipsoid. Directions are unit vectors in the frame of the core. Solvers
/// run in f64 and in double-double.
pub(crate) trait Support {
    /// Whether the core has only one branch.
    const IS_SMOOTH: bool = false;

    /// Returns the largest distance of a point of the core from the origin, rounded up.
    fn reach(&self) -> f64;

    /// Returns branch and support point along `n`, a direction of any length; the search starts at
    /// the branch `hint`.
    fn support<T: Scalar>(&self, n: &Vec3<T>, hint: u32) -> (u32, Vec3<T>);

    /// Returns the point of a branch along `n`. It is a point of the core, and it is the support
    /// point if the branch has the greatest support value along `n`.
    fn of_branch<T: Scalar>(&self, branch: u32, n: &Vec3<T>) -> Vec3<T>;

    /// Returns the displacement of the `point` of a branch along `n` if `n` rotates by the tangent
    /// `d`: the second derivative of the support function, applied to `d`.
    fn bent<T: Scalar>(&self, branch: u32, point: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T>;

    /// Returns the unit axis `u` and the level `c` of the circle of unit directions, `n . u = c`,
    /// along which two branches have equal support values; `None` if no circle is known.
    fn ridge<T: Scalar>(&self, of: [u32; 2]) -> Option<(Vec3<T>, T)>;

    /// Returns a point of the core on the branch, close to the point `place`, which must be close
    /// to the branch.
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T>;

    /// Returns centre and radius of a ball inside the core that touches the surface, or almost, at
    /// `point`, where the normal is `n`. The radius is never too large; it is zero if no ball is
    /// known.
    fn inner_ball(&self, point: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64);

    /// Returns the flat round face whose normal is closest to `n`; `None` if the core has none.
    fn disc(&self, n: &Vector3<f64>) -> Option<Disc>;

    /// Returns the outward unit normals of the edges of the polygon that generates the core by
    /// rotation around the z axis, as components perpendicular to the axis and along it. `None` if
    /// no polygon does.
    fn meridian(&self) -> Option<[[f64; 2]; 3]> {
        None
    }

    /// Calls `each` with the outward normals of the flat faces to which a branch belongs.
    fn flat_faces(&self, _branch: u32, each: &mut impl FnMut(Vec3<f64>)) {
        let sides = [1.0, -1.0].each(|z| self.disc(&Vector3::new(0.0, 0.0, z)));
        sides.iter().flatten().for_each(|disc| each([0.0, 0.0, disc.side]));
    }

    /// Returns the flat or straight facet of the surface whose normal is closest to `n`. `None` if
    /// the core is curved in both directions, or a polyhedron.
    fn flat(&self, n: &Vector3<f64>) -> Option<Flat> {
        self.disc(n).map(Flat::Disc)
    }

    /// Returns the feature that contains the points of up to three branches, `point` among them.
    fn feature(&self, branches: &[u32], point: &Vector3<f64>) -> Feature;
}

/// A core with curved sides: the calls of a shape in addition to support points.
pub(crate) trait Curved: Support + Copy {
    /// Index of the kind in the order in which a pair is solved: polyhedra, with index 0, come
    /// first.
    const ORDER: u32;

    /// Returns the fingerprint of kind and parameters.
    fn fingerprint(&self) -> Fingerprint;

    /// Returns the core with all lengths multiplied by a power of two.
    fn scaled(&self, by: f64) -> Self;

    /// Returns whether the closed core contains a point, up to rounding.
    fn contains(&self, point: &Vector3<f64>) -> bool;

    /// Returns the mass properties at unit density.
    fn mass(&self) -> Mass;
}

/// Returns the index of the kind of a curved core in the order in which a pair is solved.
pub(crate) fn order_of<C: Curved>(_: &C) -> u32 {
    C::ORDER
}

/// Matches a core: an expression for the polyhedron, and one for every kind of [`Curved`] core.
macro_rules! match_core {
    ($core:expr, $body:pat => $polyhedral:expr, $curved:pat => $round:expr) => {
        match $core {
            Core::Polyhedron($body) => $polyhedral,
            Core::Ellipsoid($curved) => $round,
            Core::Cylinder($curved) => $round,
            Core::Cone($curved) => $round,
        }
    };
}

pub(crate) use match_core;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::num::scalar::{dot, sub};
    use crate::body::shape::{Cone, Cylinder, Ellipsoid};
    use crate::rng::Rng;

    fn unit(rng: &mut Rng) -> Vec3<f64> {
        let n = Vector3::from([(); 3].map(|()| rng.range(-1.0, 1.0)));
        (n / n.norm()).into()
    }

    /// Checks what solvers assume about a core.
    fn check(core: &impl Support) {
        let mut rng = Rng::new(7);
        for _ in 0..2_000 {
            let n = unit(&mut rng);
            let (branch, point) = core.support(&n, 0);
            let height = dot(&n, &point);
            let slack = 1e-12 * core.reach();
            assert!(dot(&point, &point).sqrt() <= core.reach() + slack, "reach");
            let m = unit(&mut rng);
            let other = core.support(&m, branch).1;
            assert!(dot(&n, &other) <= height + slack, "the support point is the highest");
            let onto = core.onto(branch, &point);
            assert!(
                dot(&sub(&onto, &point), &sub(&onto, &point)).sqrt() <= 1e-7 * core.reach(),
                "onto"
            );

            // The second derivative against a difference quotient, away from poles.
            let d = sub(&m, &n.map(|x| x * dot(&n, &m)));
            let step = 1e-6;
            let turned = [0, 1, 2].map(|k| n[k] + step * d[k]);
            let back = [0, 1, 2].map(|k| n[k] - step * d[k]);
            let slope = sub(&core.of_branch(branch, &turned), &core.of_branch(branch, &back)).map(|x| x / (2.0 * step));
            let bent = core.bent(branch, &point, &n, &d);
            let off = sub(&slope, &bent);
            let length = dot(&bent, &bent).sqrt();
            let is_mild = n.iter().all(|x| x.abs() > 0.05);
            assert!(
                !is_mild || dot(&off, &off).sqrt() <= 1e-4 * (core.reach() + length),
                "{n:?}: {slope:?}, not {bent:?}"
            );

            // A ball inside the core at the point: its support value is at most that of the core
            // along every direction.
            let (centre, radius) = core.inner_ball(&point.into(), &n.into());
            let highest = dot(&m, &core.support(&m, 0).1);
            assert!(
                dot(&m, &centre.into()) + radius <= highest + 1e-9 * core.reach(),
                "inner ball"
            );
        }
    }

    #[test]
    fn curved_cores_are_what_solvers_take_them_for() {
        check(&Cylinder {
            radius: 0.7,
            half_height: 1.3,
        });
        check(&Cone {
            radius: 0.7,
            half_height: 1.3,
        });
        check(&Ellipsoid {
            semi_axes: Vector3::new(1.0, 0.6, 0.3),
        });
    }
}
