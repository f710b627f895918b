//! What a call reports to its caller besides the result: progress, and events of `tracing`.
//!
//! Without the feature `tracing` the functions of events are empty.

use core::fmt::Display;
use core::ops::ControlFlow;

/// The progress of a long call. The callback that receives it can stop the call by
/// [`ControlFlow::Break`]: see [`WithProgress`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// The stage of the call: `"hull"`, `"tree"`.
    pub stage: &'static str,
    /// The work done so far in this stage.
    pub done: usize,
    /// The work of the whole stage, in the same unit; `None` if it is unknown before the end.
    pub total: Option<usize>,
}

impl Progress {
    /// Returns the progress of a stage.
    #[must_use]
    pub const fn new(stage: &'static str, done: usize, total: Option<usize>) -> Self {
        Self { stage, done, total }
    }

    /// Returns the value by which a callback stops the call if `is_over`.
    pub const fn stop_if(is_over: bool) -> ControlFlow<()> {
        if is_over {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Long calls that report their progress to a callback, about a hundred times per stage.
///
/// Use them for clouds of a million points, meshes of a million triangles and grids of a million
/// nodes. Each method names the function whose result it returns.
///
/// ```
/// use core::ops::ControlFlow;
/// use lin_canny::{Progress, WithProgress, polyhedron::BuildError};
/// # use lin_canny::nalgebra::Point3;
/// # let wave = |k: i32| f64::from(k).sin();
/// # let place = |k| Point3::new(wave(k), wave(k + 1), wave(7 * k));
/// # let points: Vec<_> = (0..2000).map(place).collect();
///
/// let mut shown = 0;
/// let mut show = |progress: Progress| {
///     shown = progress.done; // here a bar is drawn
///     ControlFlow::Continue(())
/// };
/// let body = WithProgress::new(&mut show).convex_hull(&points)?;
///
/// let mut stop = |_| ControlFlow::Break(());
/// let stopped = WithProgress::new(&mut stop).convex_hull(&points);
/// assert!(matches!(stopped, Err(BuildError::Stopped)));
/// # Ok::<(), BuildError>(())
/// ```
pub struct WithProgress<'a> {
    pub(crate) watch: Watch<'a>,
}

impl<'a> WithProgress<'a> {
    /// Returns long calls that report to this callback.
    #[must_use]
    pub fn new(callback: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        let watch = Watch {
            callback: Some(callback),
            ..Watch::none()
        };
        Self { watch }
    }
}

/// The caller has stopped the call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopped;

/// Reports the progress of a call to its caller, about a hundred times per stage.
///
/// After the caller has stopped the call, loops end at their next progress report, and their
/// results are dropped at the next stage.
pub(crate) struct Watch<'a> {
    callback: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
    stage: &'static str,
    total: Option<usize>,
    /// The work at which the next report is due, and the work between two reports.
    next: usize,
    every: usize,
    is_stopped: bool,
}

impl<'a> Watch<'a> {
    /// Number of reports per stage of known work.
    const PARTS: usize = 128;

    /// Work between two reports of a stage whose work is unknown.
    const EVERY: usize = 1 << 14;

    /// Work between two reports of a stage whose units are slow.
    #[cfg(feature = "meshes")]
    const EVERY_SLOW: usize = 1 << 8;

    /// Returns a watch for a caller without a callback.
    pub(crate) const fn none() -> Self {
        Self {
            callback: None,
            stage: "",
            total: None,
            next: usize::MAX,
            every: usize::MAX,
            is_stopped: false,
        }
    }

    /// Starts a stage.
    pub(crate) fn stage(&mut self, stage: &'static str, total: Option<usize>) -> Result<(), Stopped> {
        self.check()?;
        (self.stage, self.total) = (stage, total);
        self.every = total.map_or(Self::EVERY, |total| (total / Self::PARTS).max(1));
        self.tell(0);
        self.check()
    }

    /// Starts a stage of unknown work whose units take tens of microseconds each.
    #[cfg(feature = "meshes")]
    pub(crate) fn slow_stage(&mut self, stage: &'static str) -> Result<(), Stopped> {
        self.stage(stage, None)?;
        self.every = Self::EVERY_SLOW;
        self.next = self.every;
        Ok(())
    }

    /// Reports how much of the stage is done, and returns whether the call continues.
    pub(crate) fn done(&mut self, done: usize) -> bool {
        if done >= self.next {
            self.tell(done);
        }
        !self.is_stopped
    }

    /// Returns an error if the caller has stopped the call.
    pub(crate) fn check(&self) -> Result<(), Stopped> {
        if self.is_stopped { Err(Stopped) } else { Ok(()) }
    }

    fn tell(&mut self, done: usize) {
        self.next = done.saturating_add(self.every);
        if let Some(callback) = &mut self.callback {
            self.is_stopped |= callback(Progress::new(self.stage, done, self.total)).is_break();
        }
    }
}

/// Reports that the walk did not solve a query and `solver` did.
#[inline(always)]
pub(crate) fn fell_back(solver: &dyn Display, steps: u32) {
    #[cfg(feature = "tracing")]
    tracing::debug!(%solver, steps, "the walk did not answer a query");
    let _ = (solver, steps);
}

/// Reports that input was rejected.
#[inline(always)]
pub(crate) fn refused(what: &'static str, why: &dyn Display) {
    #[cfg(feature = "tracing")]
    tracing::warn!(what, %why, "refused");
    let _ = (what, why);
}

/// Reports that a search ends without a result because its budget is spent.
#[inline(always)]
pub(crate) fn spent(what: &'static str, looks: u32) {
    #[cfg(feature = "tracing")]
    tracing::warn!(what, looks, "the budget is spent");
    let _ = (what, looks);
}
