//! First contacts of two elements, for judges: what the search of meshes does with each pair.
//!
//! A vertex is given by its positions at time zero and at time one.

use nalgebra::Point3;

use super::paths::{Parts, VertexPath, VertexPlaces};
use super::search::{self, FirstContact, SearchWork};
use super::{cast_of, measure, width};
use crate::pair::outcome::ContactState;
use crate::time::impact::{Cast, ImpactError, Tolerance};

/// The positions of some vertices.
pub type Positions<const N: usize> = [[Point3<f64>; 2]; N];

/// Returns the first contact of a vertex and a face.
pub fn cast_vertex_face(vertex: &Positions<1>, face: &Positions<3>, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    cast(vertex, face, tolerance, search::vertex_face)
}

/// Returns the first contact of two edges.
pub fn cast_edge_edge(a: &Positions<2>, b: &Positions<2>, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    cast(a, b, tolerance, search::edge_edge)
}

/// Returns the first contact of any points of two triangles.
pub fn cast_triangles(a: &Positions<3>, b: &Positions<3>, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    cast(a, b, tolerance, search::triangles)
}

/// Finds the contact, and measures the two sides at the safe time.
fn cast<const A: usize, const B: usize>(
    a: &Positions<A>,
    b: &Positions<B>,
    tolerance: Tolerance,
    contact: fn(&[VertexPath; A], &[VertexPath; B], f64, &mut SearchWork) -> FirstContact,
) -> Result<Cast, ImpactError>
where
    VertexPlaces<A, B>: Parts,
{
    let a = a.map(|[start, end]| VertexPath::new(start, end));
    let b = b.map(|[start, end]| VertexPath::new(start, end));
    let mut work = SearchWork::default();
    let width = width(a.iter().chain(&b), tolerance)?;
    let found = contact(&a, &b, width, &mut work);
    let seen = |time: f64, state: ContactState| measure(&a, &b, time, state);
    Ok(cast_of(found, &work, !cfg!(feature = "exact"), seen))
}
