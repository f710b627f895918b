//! Results of a scene.

use lin_canny::impact::Impact;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::scene::{ClosestPair, PairResults, Scene as Loaded};
use lin_canny::{Distance, Outcome};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::{Scene, body, group, number};
use crate::array::{columns, triple};
use crate::errors::scene_error;

/// Two bodies of a scene and their closest points, in the world.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct ScenePair {
    ids: [u64; 2],
    outcome: Outcome,
    points: [Point3<f64>; 2],
    normal: Vector3<f64>,
}

impl ScenePair {
    fn new(found: &ClosestPair, scene: &Loaded) -> Self {
        let still = Isometry3::identity();
        let [a, b] = [found.a, found.b].map(|id| scene.pose(id).copied().unwrap_or(still));
        Self {
            ids: [number(found.a), number(found.b)],
            outcome: found.outcome,
            points: [a * found.outcome.point_on_a, b * found.outcome.point_on_b],
            normal: a.rotation * *found.outcome.normal,
        }
    }
}

#[pymethods]
impl ScenePair {
    /// The id of the first body.
    #[getter]
    fn a(&self) -> u64 {
        self.ids[0]
    }

    /// The id of the second body.
    #[getter]
    fn b(&self) -> u64 {
        self.ids[1]
    }

    /// The signed distance.
    #[getter]
    fn distance(&self) -> f64 {
        self.outcome.distance
    }

    /// Lower bound of the signed distance.
    #[getter]
    fn lower(&self) -> f64 {
        self.outcome.lower
    }

    /// Upper bound of the signed distance.
    #[getter]
    fn upper(&self) -> f64 {
        self.outcome.upper
    }

    /// "separated", "touching", "overlapping" or "undecided".
    #[getter]
    fn state(&self) -> &'static str {
        self.outcome.state.name()
    }

    /// The witness on the first body in the world, shape (3,).
    #[getter]
    fn point_a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.points[0].coords.into())
    }

    /// The witness on the second body in the world, shape (3,).
    #[getter]
    fn point_b<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.points[1].coords.into())
    }

    /// The unit vector from the first to the second body in the world, shape (3,).
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.normal.into())
    }

    fn __repr__(&self) -> String {
        let Outcome {
            distance, lower, upper, ..
        } = self.outcome;
        let [a, b] = self.ids;
        format!("<ScenePair {a} - {b}: {distance:.6} in [{lower:.15}, {upper:.15}]>")
    }
}

/// Returns 1 for yes, 0 for no, -1 if not enabled.
fn flag(answer: Option<bool>) -> i8 {
    answer.map_or(-1, i8::from)
}

/// Returns a number of a distance, NaN if there is none.
fn number_of(pair: &PairResults, get: fn(&Distance) -> f64) -> f64 {
    pair.distance.as_ref().map_or(f64::NAN, get)
}

#[pymethods]
impl Scene {
    /// Returns all pairs whose boxes overlap.
    ///
    /// The result is a structured array with the fields `a`, `b` (ids), `overlaps`, `within` (1
    /// yes, 0 no, -1 not enabled), `distance`, `lower` and `upper` (NaN if not enabled, or beyond
    /// the enabled range).
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pairs: Vec<PairResults> = self.0.pairs().collect();
        let ids = |id: fn(&PairResults) -> u64| PyArray1::from_iter(py, pairs.iter().map(id)).into_any();
        let flags = |get: fn(&PairResults) -> Option<bool>| {
            PyArray1::from_iter(py, pairs.iter().map(|pair| flag(get(pair)))).into_any()
        };
        let numbers = |get: fn(&Distance) -> f64| {
            PyArray1::from_iter(py, pairs.iter().map(|pair| number_of(pair, get))).into_any()
        };
        let fields = [
            ("a", "u8", ids(|pair| number(pair.a))),
            ("b", "u8", ids(|pair| number(pair.b))),
            ("overlaps", "i1", flags(|pair| pair.overlaps)),
            ("within", "i1", flags(|pair| pair.within)),
            ("distance", "f8", numbers(|d| d.value)),
            ("lower", "f8", numbers(|d| d.lower)),
            ("upper", "f8", numbers(|d| d.upper)),
        ];
        columns(py, pairs.len(), &fields)
    }

    /// Returns the events of the last step: tuples of the change and the ids of the two bodies.
    ///
    /// A change is a text such as "overlap began", "came within" or "boxes parted".
    fn events(&self) -> Vec<(String, u64, u64)> {
        let reported = self.0.events().iter();
        reported
            .map(|e| (e.change.to_string(), number(e.a), number(e.b)))
            .collect()
    }

    /// Returns the first contacts, and first times within a distance, of the last `advance`.
    ///
    /// Each is a tuple of the ids of two bodies, the time up to which they are proven apart, and
    /// the time at which they are proven to be in contact; None if rounding or a limit prevents a
    /// proof. The last item is the distance of `impact_within`: then the bodies are proven farther
    /// apart, and within the distance. It is 0 for a contact.
    fn impacts(&self) -> Vec<(u64, u64, f64, Option<f64>, f64)> {
        let hit = |impact: &Impact| match *impact {
            Impact::Hit { hit, .. } => Some(hit),
            _ => None,
        };
        let all = self.0.impacts().iter();
        all.map(|i| (number(i.a), number(i.b), i.safe(), hit(&i.impact), i.distance))
            .collect()
    }

    /// Returns the pair of least signed distance of two groups at the last step, at any distance.
    ///
    /// Returns None if there is no pair. At least one query must be enabled between the groups.
    fn closest_pair(&self, py: Python<'_>, group_a: u8, group_b: u8) -> PyResult<Option<ScenePair>> {
        let groups = (group(group_a)?, group(group_b)?);
        let found = py.detach(|| self.0.closest_pair(groups.0, groups.1));
        let found = found.map_err(scene_error)?;
        Ok(found.map(|pair| ScenePair::new(&pair, &self.0)))
    }

    /// Returns all pairs of two groups that are at most `d` apart at the last step, decided
    /// exactly.
    fn pairs_within(&self, py: Python<'_>, group_a: u8, group_b: u8, d: f64) -> PyResult<Vec<ScenePair>> {
        let groups = (group(group_a)?, group(group_b)?);
        let found = py.detach(|| self.0.pairs_within(groups.0, groups.1, d));
        Ok(self.named(&found.map_err(scene_error)?))
    }

    /// Returns the `count` bodies closest to a body at the last step, the closest first.
    ///
    /// farthest: the largest distance of a returned body.
    #[pyo3(signature = (id, count, farthest=f64::INFINITY))]
    fn nearest(&self, id: u64, count: usize, farthest: f64) -> PyResult<Vec<ScenePair>> {
        let found = self.0.nearest(body(id), count, farthest).map_err(scene_error)?;
        Ok(self.named(&found))
    }
}

impl Scene {
    fn named(&self, pairs: &[ClosestPair]) -> Vec<ScenePair> {
        pairs.iter().map(|pair| ScenePair::new(pair, &self.0)).collect()
    }
}
