//! Witnesses and features of a simplex of the Minkowski difference.

use crate::base::num::each::Each;
use nalgebra::Point3;

use crate::base::num::scalar::Scalar;
use crate::body::polyhedron::{FeaturePair, VertexId};
use crate::convex::minimum::simplex::Simplex;
use crate::pair::answer::walk_state;
use crate::pair::posed::PosedPair;

/// Returns the witnesses: the convex combinations of the vertices of each body, in stored frames.
pub(crate) fn witnesses<T: Scalar>(posed: &PosedPair, simplex: &Simplex<T>) -> (Point3<f64>, Point3<f64>) {
    let (mut on_a, mut on_b) = ([T::from(0.0); 3], [T::from(0.0); 3]);
    for (c, &w) in simplex.points().iter().zip(simplex.weights()) {
        let (p, q) = (posed.a.points[c.a.index()], posed.b.points[c.b.index()]);
        for k in 0..3 {
            on_a[k] = on_a[k] + w * T::from(p[k]);
            on_b[k] = on_b[k] + w * T::from(q[k]);
        }
    }
    (
        Point3::from(on_a.each(|c| c.value())),
        Point3::from(on_b.each(|c| c.value())),
    )
}

/// Returns the smallest features that contain the vertices of the simplex.
pub(crate) fn features<T: Scalar>(posed: &PosedPair, simplex: &Simplex<T>) -> FeaturePair {
    let (mut a, mut b) = ([VertexId(0); 4], [VertexId(0); 4]);
    for (k, c) in simplex.points().iter().enumerate() {
        (a[k], b[k]) = (c.a, c.b);
    }
    walk_state(posed, &a[..simplex.len()], &b[..simplex.len()])
}
