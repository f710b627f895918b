//! Effects between the groups of a scene.

use lin_canny::impact::Tolerance;
use lin_canny::scene::PairQueries;
use pyo3::prelude::*;

use super::{Scene, group};
use crate::errors::scene_error;

#[pymethods]
impl Scene {
    /// Enables queries between the pairs of two groups, or within one group if both are equal.
    ///
    /// A call replaces the previous call for these groups. Without any query nothing is computed.
    ///
    /// boxes: events of the boxes. overlap: whether bodies share a point. within: whether bodies
    /// are at most this far apart. distance: the signed distance up to this range. depth: the depth
    /// of overlaps of convex bodies. impact: the first contact between two steps of bodies that
    /// `advance` moves, in a bracket in which bodies are at most this far apart. impact_within: the
    /// first time between two steps at which bodies come within this distance, in a bracket of the
    /// width impact, or as narrow as rounding allows; contacts are found as well if impact is given.
    /// fixed: whether pairs of two fixed bodies are queried.
    #[pyo3(signature = (
        group_a, group_b, *, boxes=false, overlap=false, within=None, distance=None, depth=false, impact=None,
        impact_within=None, fixed=false
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn set_queries(
        &mut self,
        group_a: u8,
        group_b: u8,
        boxes: bool,
        overlap: bool,
        within: Option<f64>,
        distance: Option<f64>,
        depth: bool,
        impact: Option<f64>,
        impact_within: Option<f64>,
        fixed: bool,
    ) -> PyResult<()> {
        let mut queries = PairQueries::none()
            .boxes(boxes)
            .overlap(overlap)
            .depth(depth)
            .fixed(fixed);
        queries.within = within;
        queries.distance = distance;
        queries.impact = impact.map(Tolerance::Distance);
        queries.impact_within = impact_within.map(|d| (d, Tolerance::Distance(impact.unwrap_or(0.0))));
        let called = self.0.set_queries(group(group_a)?, group(group_b)?, queries);
        called.map_err(scene_error)
    }
}
