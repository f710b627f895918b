//! Calls of the library with a progress callback: Ctrl-C and progress.

use std::ops::ControlFlow;
use std::time::Instant;

use lin_canny::Progress;
use pyo3::prelude::*;

use crate::batch::{BREATH, reporter};

/// Checks for signals and reports progress from time to time, during a call without the lock of the
/// interpreter.
pub(crate) struct Watch {
    report: Option<Py<PyAny>>,
    looked: Instant,
    /// What is done, and all; `None` before the first callback.
    last: Option<[usize; 2]>,
    raised: Option<PyErr>,
}

impl Watch {
    /// `progress` is a callable with the arguments done and total, or `True` for a bar of tqdm.
    pub(crate) fn new(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self {
            report: reporter(py, 0, progress)?.map(Bound::unbind),
            looked: Instant::now(),
            last: None,
            raised: None,
        })
    }

    /// The callback: stops the call if an exception was raised.
    pub(crate) fn look(&mut self, now: Progress) -> ControlFlow<()> {
        self.last = Some([now.done, now.total.unwrap_or(now.done)]);
        if self.raised.is_none() && self.looked.elapsed() > BREATH {
            let found = Python::attach(|py| {
                py.check_signals()?;
                self.tell(py)
            });
            (self.looked, self.raised) = (Instant::now(), found.err());
        }
        Progress::stop_if(self.raised.is_some())
    }

    fn tell(&self, py: Python<'_>) -> PyResult<()> {
        if let (Some(report), Some([done, total])) = (&self.report, self.last) {
            report.call1(py, (done, total))?;
        }
        Ok(())
    }

    /// Returns the exception that stopped the call, or else reports the last progress; all of it if
    /// the call `is_complete`.
    pub(crate) fn finish(mut self, py: Python<'_>, is_complete: bool) -> PyResult<()> {
        if let Some(error) = self.raised {
            return Err(error);
        }
        if let (true, Some([done, total])) = (is_complete, &mut self.last) {
            *done = *total;
        }
        self.tell(py)
    }
}
