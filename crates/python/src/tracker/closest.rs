//! The result of a closest-points query.

use lin_canny::{PairOutcome, RelativePose};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::array::triple;
use crate::errors::refused;
use crate::pickle::{Pickled, pickled};

/// Returns the gradients of the distance by motions of A and of B: six numbers each, linear and
/// angular, along the axes of the world, about the origins of the bodies; zero if the depth of an
/// overlap is unknown.
pub(crate) fn gradients(answer: &PairOutcome, pose: &RelativePose) -> [[f64; 6]; 2] {
    if answer.lower == f64::NEG_INFINITY {
        return [[0.0; 6]; 2];
    }
    let (pose_a, pose_b) = pose.poses();
    let by_body = [
        (answer.gradient_a(), pose_a.rotation),
        (answer.gradient_b(pose), pose_b.rotation),
    ];
    by_body.map(|(gradient, rotation)| {
        let [linear, angular] = [gradient.linear, gradient.angular].map(|v| rotation * v);
        [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
    })
}

/// The closest points of two geometries, with proven bounds of the signed distance.
///
/// Points and normal are in the frame of the poses, the world. For convex geometries, separated or
/// overlapping, `point_b - point_a` equals `distance * normal` (the length up to rounding, the
/// direction to about 1e-6).
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Closest {
    answer: PairOutcome,
    pose: RelativePose,
}

impl Closest {
    #[inline]
    pub(crate) fn new(answer: PairOutcome, pose: RelativePose) -> Self {
        Self { answer, pose }
    }

    /// Returns the outcome, in the frames of the bodies.
    pub(crate) fn answer(&self) -> &PairOutcome {
        &self.answer
    }
}

#[pymethods]
impl Closest {
    /// The signed distance: the negative penetration depth if two convex geometries overlap, zero
    /// if others overlap.
    #[getter]
    fn distance(&self) -> f64 {
        self.answer.distance
    }

    /// Lower bound of the signed distance; minus infinity if the depth of an overlap is unknown.
    #[getter]
    fn lower(&self) -> f64 {
        self.answer.lower
    }

    /// Upper bound of the signed distance.
    #[getter]
    fn upper(&self) -> f64 {
        self.answer.upper
    }

    /// "separated", "touching", "overlapping" or "undecided".
    #[getter]
    fn state(&self) -> &'static str {
        self.answer.state.name()
    }

    /// The closest features, such as "v3-f1": vertex 3 of A and face 1 of B.
    #[getter]
    fn features(&self) -> String {
        self.answer.features.to_string()
    }

    /// The piece, triangle or patch of each witness, by the caller's index; 0 if convex.
    #[getter]
    fn parts(&self) -> (u32, u32) {
        (self.answer.locations[0].subshape, self.answer.locations[1].subshape)
    }

    /// The witness on A in the world, shape (3,).
    #[getter]
    fn point_a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, (self.pose.poses().0 * self.answer.point_on_a).coords.into())
    }

    /// The witness on B in the world, shape (3,).
    #[getter]
    fn point_b<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, (self.pose.poses().1 * self.answer.point_on_b).coords.into())
    }

    /// The unit vector from A to B in the world, shape (3,).
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, (self.pose.poses().0.rotation * *self.answer.normal).into())
    }

    /// The derivative of the distance by a motion of A, shape (6,): by the velocity of its origin,
    /// then by its angular velocity, both in the world.
    ///
    /// If A moves with the velocity v and the angular velocity w, the distance changes at the rate
    /// `gradient_a @ [*v, *w]`. If several pairs of points are equally close, or an overlap is
    /// equally deep along several normals, the distance has a kink: the gradient is that of the
    /// witnesses returned. Then the true rate is at most that of the gradient (points), or at
    /// least (normals). It is zero if the depth of an overlap is unknown.
    #[getter]
    fn gradient_a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &gradients(&self.answer, &self.pose)[0])
    }

    /// The derivative of the distance by a motion of B, shape (6,); see `gradient_a`.
    #[getter]
    fn gradient_b<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &gradients(&self.answer, &self.pose)[1])
    }

    fn __repr__(&self) -> String {
        let PairOutcome { outcome: o, .. } = &self.answer;
        format!(
            "<Closest {}: {:.6} in [{:.15}, {:.15}], {}>",
            o.state.name(),
            o.distance,
            o.lower,
            o.upper,
            o.features
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        pickled::<Self>(py, postcard::to_stdvec(&(&self.answer, &self.pose)))
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let (answer, pose) = postcard::from_bytes(bytes).map_err(refused)?;
        Ok(Self { answer, pose })
    }
}
