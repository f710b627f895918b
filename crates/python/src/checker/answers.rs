//! Answers of a checker, with names.

use lin_canny_robot::plan::{CellPair, Checker, JointTree, NearPair as Near, Verdict as Judged};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::cell::BodyId;
use crate::array::triple;
use crate::errors::no_condition;
use crate::tracker::StartContact;

/// The names of two bodies.
pub(super) type Pair = (String, String);

/// Returns the names of a pair.
pub(super) fn names(checker: &Checker<JointTree>, pair: CellPair) -> Pair {
    (checker.name(pair.a).to_owned(), checker.name(pair.b).to_owned())
}

/// Two bodies near each other at a configuration, with bounds of their signed distance.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct NearPair {
    near: Near,
    pair: Pair,
}

impl NearPair {
    pub(super) fn new(near: Near, checker: &Checker<JointTree>) -> Self {
        let pair = names(checker, near.pair);
        Self { near, pair }
    }
}

#[pymethods]
impl NearPair {
    /// The signed distance: negative for an overlap, zero for an overlap of unknown depth.
    #[getter]
    fn distance(&self) -> f64 {
        self.near.distance
    }

    /// Lower bound of the signed distance.
    #[getter]
    fn lower(&self) -> f64 {
        self.near.lower
    }

    /// Upper bound of the signed distance.
    #[getter]
    fn upper(&self) -> f64 {
        self.near.upper
    }

    /// The signed distance less what the pair must keep: its margin and the paddings.
    #[getter]
    fn excess(&self) -> f64 {
        self.near.excess
    }

    /// The name of the first body.
    #[getter]
    fn a(&self) -> &str {
        &self.pair.0
    }

    /// The name of the second body.
    #[getter]
    fn b(&self) -> &str {
        &self.pair.1
    }

    /// The ids of both bodies.
    #[getter]
    fn ids(&self) -> (BodyId, BodyId) {
        (BodyId(self.near.pair.a), BodyId(self.near.pair.b))
    }

    /// The witness on the first body in the world, shape (3,).
    #[getter]
    fn point_a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.near.witnesses[0].coords.into())
    }

    /// The witness on the second body in the world, shape (3,).
    #[getter]
    fn point_b<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.near.witnesses[1].coords.into())
    }

    /// The unit vector from the first body to the second in the world, shape (3,); zero for an
    /// overlap of unknown depth.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.near.normal.into())
    }

    /// The derivative of the signed distance by each coordinate, shape (dof,); zero for an overlap
    /// of unknown depth.
    ///
    /// Where two places are equally close, as at parallel faces, the distance has a kink: the
    /// gradient is that of the witnesses alone. Divide by `Checker.scales` for derivatives by a
    /// length.
    #[getter]
    fn gradient<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.near.gradient)
    }

    fn __repr__(&self) -> String {
        let Near {
            distance, lower, upper, ..
        } = self.near;
        let (a, b) = &self.pair;
        format!("<NearPair {a:?} - {b:?}: {distance:.6} in [{lower:.15}, {upper:.15}]>")
    }
}

/// Whether a motion is free: a statement about every instant of it.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Verdict {
    segment: usize,
    verdict: Judged,
    pair: Option<Pair>,
    start_contacts: Vec<StartContact>,
    /// What the pair that blocks does, in words.
    meet: String,
    /// Of a trajectory, the times of `free_until` and `contact_at`.
    times: Option<[f64; 2]>,
    text: String,
}

impl Verdict {
    pub(super) fn new(verdict: Judged, checker: &Checker<JointTree>) -> Self {
        let segment = verdict.piece().unwrap_or(0);
        let pair = match verdict {
            Judged::Blocked { pair, .. } => Some(names(checker, pair)),
            _ => None,
        };
        let contacts = verdict.start_contacts().iter();
        let contacts = contacts.map(|leaving| StartContact::new(leaving.contact, Some(names(checker, leaving.pair))));
        let start_contacts = contacts.collect();
        let meet = match &verdict {
            Judged::Blocked { required, .. } => checker.show(required).meet(""),
            _ => String::new(),
        };
        let text = checker.show(&verdict).to_string();
        Self {
            segment,
            verdict,
            pair,
            start_contacts,
            meet,
            times: None,
            text,
        }
    }

    /// Returns the verdict on a trajectory, with the time of a fraction of its segment.
    pub(super) fn with_times(mut self, time_at: impl Fn(f64) -> f64) -> Self {
        let safe = time_at(self.verdict.free_until());
        let blocked = self.contact_at().map_or(f64::NAN, &time_at);
        self.times = Some([safe, blocked]);
        if !self.is_free() {
            let at = if blocked.is_nan() { safe } else { blocked };
            self.text = format!("segment {}, time {at:?}: {}", self.segment, self.text);
        }
        self
    }
}

#[pymethods]
impl Verdict {
    /// Raises TypeError: the answer has more than two values.
    fn __bool__(&self) -> PyResult<bool> {
        Err(no_condition("Verdict", "is_free"))
    }

    /// "free" (every pair keeps its required distance at every instant), "blocked" (a pair is proven not
    /// to) or "undecided" (rounding hides it).
    ///
    /// With a tube, "blocked" only means that the tube is not proven free: a free motion may exist
    /// in it.
    #[getter]
    fn state(&self) -> &'static str {
        self.verdict.name()
    }

    /// The contacts at the start that were accepted: see `Checker.start_contact_margin`.
    ///
    /// Of a path, those of all segments up to the one that is not free. If `free_until` is 0, the proof ends
    /// before it finds all of that segment.
    #[getter]
    fn start_contacts(&self) -> Vec<StartContact> {
        self.start_contacts.clone()
    }

    /// Whether the motion is proven free.
    #[getter]
    fn is_free(&self) -> bool {
        self.verdict.is_free()
    }

    /// The number of the segment of the path, spline or trajectory; 0 if all of it is free, and for a
    /// single segment or curve.
    #[getter]
    fn segment(&self) -> usize {
        self.segment
    }

    /// The time on the segment, 0 to 1, up to which all pairs are proven to keep their required
    /// distances, `start_contacts` after they have left the contact.
    #[getter]
    fn free_until(&self) -> f64 {
        self.verdict.free_until()
    }

    /// The time at which a pair is proven not to keep the margin, or with a tube the margin and what
    /// the tube moves; None unless blocked.
    #[getter]
    fn contact_at(&self) -> Option<f64> {
        match self.verdict {
            Judged::Blocked { contact_at, .. } => Some(contact_at),
            _ => None,
        }
    }

    /// The time of the trajectory up to which all pairs are proven to keep the margin; None unless
    /// the verdict is on a trajectory.
    ///
    /// It is `free_until` as a time, rounded; of a free trajectory its last time.
    #[getter]
    fn free_until_time(&self) -> Option<f64> {
        self.times.map(|[safe, _]| safe)
    }

    /// The time of the trajectory at which a pair is proven not to keep the margin; None unless
    /// blocked and on a trajectory.
    ///
    /// It is `contact_at` as a time, rounded.
    #[getter]
    fn contact_time(&self) -> Option<f64> {
        self.times.map(|[_, blocked]| blocked).filter(|time| !time.is_nan())
    }

    /// The names of the pair that blocks; None unless blocked.
    #[getter]
    fn pair(&self) -> Option<Pair> {
        self.pair.clone()
    }

    /// The distance that the pair that blocks must keep, its margin plus both paddings; None unless
    /// blocked. `str` says where it comes from.
    #[getter]
    fn required_distance(&self) -> Option<f64> {
        match self.verdict {
            Judged::Blocked { required, .. } => Some(required.distance),
            _ => None,
        }
    }

    /// The closest points of the pair that blocks, at the time `free_until`, in the world, each of shape
    /// (3,); None unless blocked.
    #[getter]
    #[allow(clippy::type_complexity)] // a pair of arrays
    fn points<'py>(&self, py: Python<'py>) -> Option<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        match self.verdict {
            Judged::Blocked { witnesses: [a, b], .. } => {
                Some((triple(py, a.coords.into()), triple(py, b.coords.into())))
            }
            _ => None,
        }
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        match (&self.verdict, &self.pair) {
            (
                Judged::Blocked {
                    free_until: safe,
                    contact_at: t,
                    ..
                },
                Some((a, b)),
            ) => {
                let time = self.contact_time();
                let time = time.map_or(String::new(), |time| {
                    format!(" of segment {}, time {time:.9}", self.segment)
                });
                let meet = &self.meet;
                format!("<Verdict blocked: {a:?} and {b:?} {meet} between {safe:.9} and {t:.9}{time}>")
            }
            _ => format!("<Verdict {}>", self.state()),
        }
    }
}
