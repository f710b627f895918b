//! Callbacks of long calls.

use std::ffi::{c_char, c_void};
use std::ops::ControlFlow;

use lin_canny::Progress;

use crate::border::{error, lc_status, outside};

/// Reports how far a long call is; `total` is zero if it is unknown.
///
/// The library calls it on the thread of the call, with the floating-point mode of the library,
/// which is set again afterwards. `stage` ends with a zero and is valid until the callback returns.
/// A value other than zero stops the call with `LC_STOPPED`. The callback must return: an
/// exception, a `longjmp` or the end of its thread is undefined. It may call the library, with
/// other objects than those of the running call, but must not write to arrays of that call.
pub type lc_progress =
    Option<unsafe extern "C" fn(context: *mut c_void, stage: *const c_char, done: u64, total: u64) -> i32>;

/// A callback and its context.
pub(crate) struct Reporter {
    callback: lc_progress,
    context: *mut c_void,
    is_stopped: bool,
}

impl Reporter {
    /// # Safety
    /// The callback is null, or may be called with the context.
    pub(crate) unsafe fn new(callback: lc_progress, context: *mut c_void) -> Self {
        Self {
            callback,
            context,
            is_stopped: false,
        }
    }

    pub(crate) fn report(&mut self, progress: Progress) -> ControlFlow<()> {
        if let (Some(callback), false) = (self.callback, self.is_stopped) {
            let mut stage = [0_u8; 32];
            let length = progress.stage.len().min(31);
            stage[..length].copy_from_slice(&progress.stage.as_bytes()[..length]);
            let (done, total) = (progress.done as u64, progress.total.unwrap_or(0) as u64);
            let stop = outside(|| {
                // SAFETY: by the contract of `new`.
                unsafe { callback(self.context, stage.as_ptr().cast(), done, total) }
            });
            self.is_stopped = stop != 0;
        }
        Progress::stop_if(self.is_stopped)
    }

    /// Returns an error if the callback has stopped the call.
    pub(crate) fn finish(&self) -> Result<(), lc_status> {
        if self.is_stopped {
            return Err(error(lc_status::LC_STOPPED, &"the callback stopped the call"));
        }
        Ok(())
    }
}
