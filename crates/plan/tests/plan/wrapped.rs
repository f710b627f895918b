//! A space whose segments can end elsewhere, and that does not know the middles of its bodies.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny_plan::{ConfigurationSpace, PlanError};

#[derive(Clone)]
pub(crate) struct Wrapped<C> {
    space: C,
    end: fn(&C, &[f64], &[f64]) -> Vec<f64>,
}

impl<C> Wrapped<C> {
    pub(crate) fn new(space: C) -> Self {
        Self::with_ends(space, |_, _, to| to.to_vec())
    }

    /// A space whose segments end where a function of their ends says.
    pub(crate) fn with_ends(space: C, end: fn(&C, &[f64], &[f64]) -> Vec<f64>) -> Self {
        Self { space, end }
    }
}

impl<C: ConfigurationSpace> ConfigurationSpace for Wrapped<C> {
    type Segment = C::Segment;

    fn coordinates(&self) -> usize {
        self.space.coordinates()
    }
    fn degrees_of_freedom(&self) -> usize {
        self.space.degrees_of_freedom()
    }
    fn bodies(&self) -> usize {
        self.space.bodies()
    }
    fn bounds(&self) -> &[[f64; 2]] {
        self.space.bounds()
    }
    fn scales(&self) -> &[f64] {
        self.space.scales()
    }
    fn check(&self, q: &[f64]) -> Result<(), PlanError> {
        self.space.check(q)
    }
    fn place(&self, q: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        self.space.place(q, poses);
    }
    fn segment(&self, from: &[f64], to: &[f64]) -> Result<C::Segment, PlanError> {
        self.space.segment(from, &(self.end)(&self.space, from, to))
    }
    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        self.space.difference(from, to)
    }
    fn moved(&self, q: &[f64], step: &[f64]) -> Vec<f64> {
        self.space.moved(q, step)
    }
    fn sample(&self, uniform: &mut dyn FnMut() -> f64) -> Vec<f64> {
        self.space.sample(uniform)
    }
    fn gradient(&self, q: &[f64], body: usize, point: &Point3<f64>, direction: &Vector3<f64>, gradient: &mut [f64]) {
        self.space.gradient(q, body, point, direction, gradient);
    }
    fn is_rigid(&self, a: usize, b: usize) -> bool {
        self.space.is_rigid(a, b)
    }
}
