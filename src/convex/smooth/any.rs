//! A core of any kind, for slow paths where one match is free: finer arithmetic, extreme sizes.

use nalgebra::Vector3;

use super::polyhedral::PolyhedralCore;
use crate::base::num::scalar::{Scalar, Vec3};
use crate::body::polyhedron::{Feature, VertexId};
use crate::body::shape::{Cone, Cylinder, Disc, Ellipsoid, Flat, Superquadric, Support};

/// A core of any kind.
#[derive(Clone, Copy)]
pub(super) enum Any<'a> {
    Hull(PolyhedralCore<'a>),
    Ellipsoid(Ellipsoid),
    Cylinder(Cylinder),
    Cone(Cone),
    Superquadric(Superquadric),
    /// The origin alone.
    Point,
}

/// A core that can be put behind the match.
pub(super) trait CoreKind: Support {
    fn any(&self) -> Any<'_>;
}

macro_rules! kind {
    ($($name:ident: $of:ty),*) => {
        $(impl<'a> From<$of> for Any<'a> {
            fn from(core: $of) -> Self {
                Any::$name(core)
            }
        }

        impl<'a> CoreKind for $of {
            fn any(&self) -> Any<'_> {
                Any::$name(*self)
            }
        })*
    };
}

kind!(Hull: PolyhedralCore<'a>, Ellipsoid: Ellipsoid, Cylinder: Cylinder, Cone: Cone, Superquadric: Superquadric);

impl CoreKind for Any<'_> {
    fn any(&self) -> Any<'_> {
        *self
    }
}

macro_rules! each {
    ($any:expr, $core:ident => $result:expr, $point:expr) => {
        match $any {
            Any::Hull($core) => $result,
            Any::Ellipsoid($core) => $result,
            Any::Cylinder($core) => $result,
            Any::Cone($core) => $result,
            Any::Superquadric($core) => $result,
            Any::Point => $point,
        }
    };
}

impl Support for Any<'_> {
    fn reach(&self) -> f64 {
        each!(self, core => core.reach(), 0.0)
    }

    fn noise(&self) -> f64 {
        each!(self, core => core.noise(), 0.0)
    }

    fn support<T: Scalar>(&self, n: &Vec3<T>, hint: u32) -> (u32, Vec3<T>) {
        each!(self, core => core.support(n, hint), (0, [T::from(0.0); 3]))
    }

    fn of_branch<T: Scalar>(&self, branch: u32, n: &Vec3<T>) -> Vec3<T> {
        each!(self, core => core.of_branch(branch, n), [T::from(0.0); 3])
    }

    fn bent<T: Scalar>(&self, branch: u32, point: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
        each!(self, core => core.bent(branch, point, n, d), [T::from(0.0); 3])
    }

    fn ridge<T: Scalar>(&self, of: [u32; 2]) -> Option<(Vec3<T>, T)> {
        each!(self, core => core.ridge(of), None)
    }

    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T> {
        each!(self, core => core.onto(branch, place), [T::from(0.0); 3])
    }

    fn inner_ball(&self, point: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64) {
        each!(self, core => core.inner_ball(point, n), (*point, 0.0))
    }

    fn disc(&self, n: &Vector3<f64>) -> Option<Disc> {
        each!(self, core => core.disc(n), None)
    }

    fn flat(&self, n: &Vector3<f64>) -> Option<Flat> {
        each!(self, core => core.flat(n), None)
    }

    fn meridian(&self) -> Option<[[f64; 2]; 3]> {
        each!(self, core => core.meridian(), None)
    }

    fn flat_faces(&self, branch: u32, each: &mut impl FnMut(Vec3<f64>)) {
        each!(self, core => core.flat_faces(branch, each), ())
    }

    fn feature(&self, branches: &[u32], point: &Vector3<f64>) -> Feature {
        each!(self, core => core.feature(branches, point), Feature::Vertex(VertexId(0)))
    }
}
