//! Cores of this module's solvers, in addition to those of [`shape`](crate::shape).
//!
//! [`PolyhedralCore`] is a polyhedron as a core of a curved pair. [`Any`] is a core of any kind,
//! for slow paths where a match costs nothing in comparison (finer arithmetic, extreme sizes, the
//! global search of a depth).

use nalgebra::Vector3;

use crate::base::num::scalar::{Scalar, Vec3, dot, root, scaled, sub};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::body::shape::{Disc, Flat, Support, with_curved_kinds};
use crate::pair::difference::support_vertex;

/// A polyhedron in stored coordinates, times a power of two.
#[derive(Clone, Copy)]
pub(super) struct PolyhedralCore<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    pub(super) unit: f64,
}

/// The branches of a polyhedron are its vertices.
impl Support for PolyhedralCore<'_> {
    fn reach(&self) -> f64 {
        self.body.radius * self.unit
    }

    #[inline(always)]
    fn support<T: Scalar>(&self, n: &Vec3<T>, hint: u32) -> (u32, Vec3<T>) {
        let hint = if (hint as usize) < self.body.points.len() {
            hint
        } else {
            0
        };
        let VertexId(branch) = support_vertex(self.body, n, VertexId(hint));
        (branch, self.of_branch(branch, n))
    }

    #[inline(always)]
    fn of_branch<T: Scalar>(&self, branch: u32, _: &Vec3<T>) -> Vec3<T> {
        let points = &self.body.points;
        let p = points.get(branch as usize).unwrap_or(&points[0]) * self.unit;
        [T::from(p.x), T::from(p.y), T::from(p.z)]
    }

    #[inline(always)]
    fn bent<T: Scalar>(&self, _: u32, _: &Vec3<T>, _: &Vec3<T>, _: &Vec3<T>) -> Vec3<T> {
        [T::from(0.0); 3]
    }

    #[inline(always)]
    fn ridge<T: Scalar>(&self, [one, other]: [u32; 2]) -> Option<(Vec3<T>, T)> {
        let zero = T::from(0.0);
        let n = [zero; 3];
        let along = sub(&self.of_branch(one, &n), &self.of_branch(other, &n));
        let squared = dot(&along, &along);
        (squared > zero).then(|| (scaled(&along, T::from(1.0) / root(squared)), zero))
    }

    #[inline(always)]
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T> {
        self.of_branch(branch, place)
    }

    fn inner_ball(&self, point: &Vector3<f64>, _: &Vector3<f64>) -> (Vector3<f64>, f64) {
        (*point, 0.0)
    }

    fn disc(&self, _: &Vector3<f64>) -> Option<Disc> {
        None
    }

    fn flat_faces(&self, branch: u32, each: &mut impl FnMut(Vec3<f64>)) {
        let faces = self.body.vertex_faces(VertexId(branch));
        let normals = faces.filter_map(|face| self.body.face_plane(face));
        normals.for_each(|(normal, _)| each((*normal).into()));
    }

    fn feature(&self, branches: &[u32], _: &Vector3<f64>) -> Feature {
        let first = VertexId(branches.first().copied().unwrap_or(0));
        let mut vertices = [first; 3];
        for (vertex, &branch) in vertices.iter_mut().zip(branches) {
            *vertex = VertexId(branch);
        }
        if vertices.iter().any(|v| v.index() >= self.body.points.len()) {
            return Feature::Vertex(VertexId(0));
        }
        if vertices == [first; 3] {
            return Feature::Vertex(first);
        }
        self.body.feature_of(&vertices)
    }
}

/// A core that can be converted to [`Any`].
pub(super) trait CoreKind: Support {
    fn any(&self) -> Any<'_>;
}

macro_rules! any {
    ($($kind:ident),*) => {
        /// A core of any kind.
        #[derive(Clone, Copy)]
        pub(super) enum Any<'a> {
            Hull(PolyhedralCore<'a>),
            $($kind(crate::body::shape::$kind),)*
            /// The origin alone.
            Point,
        }

        $(impl From<crate::body::shape::$kind> for Any<'_> {
            fn from(core: crate::body::shape::$kind) -> Self {
                Self::$kind(core)
            }
        }

        impl CoreKind for crate::body::shape::$kind {
            fn any(&self) -> Any<'_> {
                Any::$kind(*self)
            }
        })*

        macro_rules! each {
            ($any:expr, $core:ident => $result:expr, $point:expr) => {
                match $any {
                    Any::Hull($core) => $result,
                    $(Any::$kind($core) => $result,)*
                    Any::Point => $point,
                }
            };
        }
    };
}

with_curved_kinds!(any);

impl CoreKind for PolyhedralCore<'_> {
    fn any(&self) -> Any<'_> {
        Any::Hull(*self)
    }
}

impl CoreKind for Any<'_> {
    fn any(&self) -> Any<'_> {
        *self
    }
}

impl Support for Any<'_> {
    fn reach(&self) -> f64 {
        each!(self, core => core.reach(), 0.0)
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
