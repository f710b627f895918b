//! The extension module `lin_canny._native`. The Python package re-exports all names without an
//! underscore.

mod array;
mod batch;
mod checker;
mod clash;
mod cover;
mod curve;
mod errors;
mod geometry;
mod mesh_file;
mod pickle;
mod point_file;
mod points;
mod pose;
mod ray;
mod receipt;
mod recorder;
mod robot;
mod scene;
mod tracker;
mod trajectory;
mod view;
mod watch;

use pyo3::PyClass;
use pyo3::prelude::*;

/// Adds a class. CPython aligns objects to 16 bytes, and pyo3 writes the contents there: what needs
/// more is boxed.
fn class<T: PyClass>(module: &Bound<'_, PyModule>) -> PyResult<()> {
    const { assert!(align_of::<T>() <= 16, "the contents of this class need a box") };
    module.add_class::<T>()
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    class::<geometry::Geometry>(module)?;
    class::<geometry::Cloud>(module)?;
    class::<geometry::MeshRepair>(module)?;
    class::<tracker::PairTracker>(module)?;
    class::<tracker::Closest>(module)?;
    class::<tracker::OverlapVolume>(module)?;
    class::<tracker::Penetration>(module)?;
    class::<tracker::Cast>(module)?;
    class::<tracker::StartContact>(module)?;
    class::<clash::Clash>(module)?;
    class::<clash::Clashes>(module)?;
    module.add_function(wrap_pyfunction!(clash::clash, module)?)?;
    class::<ray::RayCaster>(module)?;
    class::<ray::RayCast>(module)?;
    class::<recorder::Recorder>(module)?;
    class::<scene::Scene>(module)?;
    class::<scene::ScenePair>(module)?;
    class::<robot::Robot>(module)?;
    class::<checker::Checker>(module)?;
    class::<checker::BodyId>(module)?;
    class::<checker::NearPair>(module)?;
    class::<checker::Verdict>(module)?;
    class::<checker::RangeAnswer>(module)?;
    class::<checker::LinkAudit>(module)?;
    class::<curve::JointCurve>(module)?;
    class::<trajectory::Trajectory>(module)?;
    class::<mesh_file::MeshFile>(module)?;
    class::<point_file::PointFile>(module)?;
    module.add_function(wrap_pyfunction!(mesh_file::load_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(point_file::read_points, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::distances, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::closest_batch, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::contacts_batch, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::overlap_batch, module)?)?;
    module.add_function(wrap_pyfunction!(tracker::penetration_batch, module)?)?;
    module.add_function(wrap_pyfunction!(points::signed_distance, module)?)?;
    module.add_function(wrap_pyfunction!(points::contains, module)?)?;
    module.add_function(wrap_pyfunction!(points::winding_number, module)?)?;
    module.add_function(wrap_pyfunction!(points::closest_points, module)?)?;
    // Private, so not among the names of `__all__`.
    module.setattr("_page", wrap_pyfunction!(view::page, module)?)?;
    class::<points::PointTracker>(module)?;
    class::<points::ClosestPoint>(module)?;
    module.add_function(wrap_pyfunction!(points::nearest_features, module)?)?;
    module.add_function(wrap_pyfunction!(points::within, module)?)?;
    module.add_function(wrap_pyfunction!(points::signed_distance_grid, module)?)?;
    module.add_function(wrap_pyfunction!(cover::cover_outside, module)?)?;
    module.add_function(wrap_pyfunction!(cover::cover_inside, module)?)?;
    module.add_function(wrap_pyfunction!(cover::hull_outside, module)?)?;
    #[cfg(feature = "bench")]
    module.add_function(wrap_pyfunction!(tracker::rust_loop, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    errors::add(module)
}
