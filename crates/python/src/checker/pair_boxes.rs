//! Boxes of joint values in which pairs of links are proven apart.

use pyo3::prelude::*;

use super::Checker;
use crate::errors::plan_error;
use lin_canny_robot::plan::PairBoxes;

#[pymethods]
impl Checker {
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
    /// list of (str, str, float)
    ///     The pairs, each with the share of the joint limits in which it is proven apart.
    #[pyo3(signature = (*, boxes=500, progress=None))]
    fn prepare_pairs(
        &mut self,
        py: Python<'_>,
        boxes: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<(String, String, f64)>> {
        let found = self.proved(py, progress, |checker, watch| {
            PairBoxes::search(checker, boxes, &mut |now| watch.look(now))
        })?;
        self.checker.set_pair_boxes(&found).map_err(plan_error)?;
        let name = |id| self.checker.name(id).to_string();
        let pairs = found.pairs();
        Ok(pairs.map(|(pair, share)| (name(pair.a), name(pair.b), share)).collect())
    }
}
