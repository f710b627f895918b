//! The extension module `lin_canny._native`. The Python package re-exports all names without an
//! underscore.

mod array;
mod batch;
mod checker;
mod cover;
mod curve;
mod errors;
mod geometry;
mod mesh_file;
mod point_file;
mod points;
mod pose;
mod ray;
mod robot;
mod scene;
mod tracker;
mod trajectory;
mod watch;

use pyo3::prelude::*;

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<geometry::Geometry>()?;
    module.add_class::<geometry::Cloud>()?;
    module.add_class::<tracker::PairTracker>()?;
    module.add_class::<tracker::Closest>()?;
    module.add_class::<tracker::Penetration>()?;
    module.add_class::<tracker::Cast>()?;
    module.add_class::<tracker::StartContact>()?;
    module.add_class::<ray::RayCaster>()?;
    module.add_class::<ray::RayCast>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<scene::ScenePair>()?;
    module.add_class::<robot::Robot>()?;
    module.add_class::<checker::Checker>()?;
    module.add_class::<checker::BodyId>()?;
    module.add_class::<checker::NearPair>()?;
    module.add_class::<checker::Verdict>()?;
    module.add_class::<checker::RangeAnswer>()?;
    module.add_class::<curve::JointCurve>()?;
    module.add_class::<trajectory::Trajectory>()?;
    module.add_class::<mesh_file::MeshFile>()?;
    module.add_class::<point_file::PointFile>()?;
    module.add_function(wrap_pyfunction!(mesh_file::load_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(point_file::read_points, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::distances, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::closest_batch, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::contacts_batch, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::penetration_batch, module)?)?;
    module.add_function(wrap_pyfunction!(points::signed_distance, module)?)?;
    module.add_function(wrap_pyfunction!(points::contains, module)?)?;
    module.add_function(wrap_pyfunction!(points::closest_points, module)?)?;
    module.add_class::<points::PointTracker>()?;
    module.add_class::<points::ClosestPoint>()?;
    module.add_function(wrap_pyfunction!(points::nearest_features, module)?)?;
    module.add_function(wrap_pyfunction!(points::within, module)?)?;
    module.add_function(wrap_pyfunction!(points::signed_distance_grid, module)?)?;
    module.add_function(wrap_pyfunction!(cover::cover_outside, module)?)?;
    module.add_function(wrap_pyfunction!(cover::cover_inside, module)?)?;
    #[cfg(feature = "bench")]
    module.add_function(wrap_pyfunction!(tracker::rust_loop, module)?)?;
    errors::add(module)
}
