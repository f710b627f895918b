//! The class `Atlas`: boxes of configurations proven free or in contact.

use std::path::PathBuf;
use std::sync::Arc;

use lin_canny_robot::plan::{Atlas as Loaded, AtlasOptions, AtlasVerdict};
use lin_canny_robot::{load_atlas, save_atlas};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::{CONFIGURATION, CONFIGURATIONS, Checker};
use crate::array::{numbers, of_table, table};
use crate::errors::{file_error, plan_error};

/// Disjoint boxes of configurations that are proven free or in contact.
///
/// `Checker.free_boxes` makes one, and `Checker.set_atlas` answers by it.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Atlas(Arc<Loaded>);

#[pymethods]
impl Atlas {
    /// Reads an atlas from a file that `save` or the tool wrote.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        load_atlas(path).map(|atlas| Self(Arc::new(atlas))).map_err(file_error)
    }

    /// Writes the atlas to a file, with exact numbers.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        save_atlas(&self.0, path).map_err(file_error)
    }

    /// Shares of the volume that are proven free, proven to be in contact, and left. Their sum is 1.
    #[getter]
    fn shares(&self) -> (f64, f64, f64) {
        let shares = self.0.shares();
        (shares.free, shares.contact, shares.left)
    }

    /// The number of boxes that were searched.
    #[getter]
    fn searched(&self) -> u64 {
        self.0.searched()
    }

    /// Whether every box is decided or cannot be halved.
    #[getter]
    fn is_complete(&self) -> bool {
        self.0.is_complete()
    }

    /// Least and greatest value of each coordinate, shape (dof, 2).
    #[getter]
    fn range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [low, high] = self.0.range();
        let rows: Vec<Vec<f64>> = low.iter().zip(high).map(|(low, high)| vec![*low, *high]).collect();
        of_table(py, &rows, 2)
    }

    /// Returns "free" or "contact" if a box proves it at a configuration, else None.
    ///
    /// "contact" means that a pair is in contact or closer than it must keep.
    fn verdict_at(&self, q: &Bound<'_, PyAny>) -> PyResult<Option<&'static str>> {
        let q = numbers(q, CONFIGURATION)?;
        self.check(q.len())?;
        Ok(self.0.verdict_at(&q).map(|verdict| match verdict {
            AtlasVerdict::Free => "free",
            AtlasVerdict::Contact => "contact",
        }))
    }

    /// Returns the verdicts at many configurations, shape (N, dof): 1 where a box proves it free, -1 where
    /// one proves a contact, 0 where nothing is proven.
    ///
    /// The result is an int8 array of shape (N,).
    fn verdicts<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let rows = table(q, CONFIGURATIONS)?;
        if let Some(row) = rows.first() {
            self.check(row.len())?;
        }
        let of = |row: &Vec<f64>| match self.0.verdict_at(row) {
            Some(AtlasVerdict::Free) => 1,
            Some(AtlasVerdict::Contact) => -1,
            None => 0,
        };
        Ok(PyArray1::from_vec(py, rows.iter().map(of).collect()))
    }

    fn __repr__(&self) -> String {
        let shares = self.0.shares();
        format!(
            "<Atlas: {:.2} % free, {:.2} % in contact>",
            100.0 * shares.free,
            100.0 * shares.contact
        )
    }
}

impl Atlas {
    fn check(&self, found: usize) -> PyResult<()> {
        let expected = self.0.range()[0].len();
        match found == expected {
            true => Ok(()),
            false => Err(plan_error(format!(
                "configuration has {found} numbers (expected {expected})"
            ))),
        }
    }
}

#[pymethods]
impl Checker {
    /// Searches for boxes of configurations within the limits that are proven free, or in contact.
    ///
    /// The boxes are disjoint, and the largest come first. Margins, paddings and excluded pairs count
    /// as in `is_free`. Moving obstacles are at their poses of `time`. Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// boxes : int
    ///     The largest number of boxes to search.
    /// proofs : int, optional
    ///     The largest number of proofs of a pair over a box.
    /// resume : Atlas, optional
    ///     An atlas of the same world, from whose open boxes the search goes on. Two calls give the
    ///     atlas of one call with the sum of both numbers of boxes.
    /// progress : callable or bool, optional
    ///     Receives the number of searched boxes and of all; True shows a tqdm bar.
    #[pyo3(signature = (*, boxes=20_000, proofs=None, resume=None, progress=None))]
    fn free_boxes(
        &mut self,
        py: Python<'_>,
        boxes: u64,
        proofs: Option<u64>,
        resume: Option<&Bound<'_, Atlas>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Atlas> {
        let options = AtlasOptions::default().boxes(boxes).proofs(proofs.unwrap_or(u64::MAX));
        let earlier = resume.map(|atlas| atlas.get().0.clone());
        let found = self.proved(py, progress, |checker, watch| match &earlier {
            Some(atlas) => checker.resume_boxes(atlas, &options, &mut |now| watch.look(now)),
            None => checker.free_boxes_with_progress(&options, &mut |now| watch.look(now)),
        })?;
        Ok(Atlas(Arc::new(found)))
    }

    /// Answers by the boxes of an atlas from now on, where they decide; None drops them.
    ///
    /// Verdicts stay. `is_free`, `certify`, `are_free` and `certify_batch` take less time where a box
    /// decides; plans of six joints do not. Any change of the world drops the atlas: see
    /// `has_atlas`. An atlas of another robot or world is a PlanError that names what differs. Calls
    /// that return distances do not use it, and a pickled checker has none.
    fn set_atlas(&mut self, atlas: Option<&Bound<'_, Atlas>>) -> PyResult<()> {
        match atlas {
            Some(atlas) => self.checker.set_atlas(atlas.get().0.clone()).map_err(plan_error),
            None => {
                self.checker.clear_atlas();
                Ok(())
            }
        }
    }

    /// Proves boxes of joint values in which pairs of links are apart, and answers by them from now on.
    ///
    /// A pair has boxes if it is measured and one or two joints move it, such as the links of a wrist.
    /// Verdicts stay; `is_free`, `certify`, `plan` and their batches take less time. Changes of the
    /// world keep the boxes, but a pair that must keep more afterwards is queried as before. A
    /// pickled checker has none. Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// boxes : int
    ///     The largest number of boxes of a pair.
    /// progress : callable or bool, optional
    ///     Receives the number of searched boxes of a pair and of all; True shows a tqdm bar.
    ///
    /// Returns
    /// -------
    /// list of (str, str, Atlas)
    ///     The pairs with their boxes.
    #[pyo3(signature = (*, boxes=500, progress=None))]
    fn prepare_pairs(
        &mut self,
        py: Python<'_>,
        boxes: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<(String, String, Atlas)>> {
        let options = AtlasOptions::default().boxes(boxes);
        let found = self.proved(py, progress, |checker, watch| {
            checker.pair_boxes_with_progress(&options, &mut |now| watch.look(now))
        })?;
        self.checker.set_pair_boxes(&found).map_err(plan_error)?;
        let name = |id| self.checker.name(id).to_string();
        let pairs = found.pairs();
        Ok(pairs
            .map(|(pair, atlas)| (name(pair.a), name(pair.b), Atlas(Arc::new(atlas.clone()))))
            .collect())
    }

    /// Whether the checker answers by an atlas.
    #[getter]
    fn has_atlas(&self) -> bool {
        self.checker.atlas().is_some()
    }
}
