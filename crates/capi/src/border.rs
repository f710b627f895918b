//! The border between C and Rust: statuses, messages, panics and the floating-point unit.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::c_char;
use std::fmt::Display;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use crate::table::{Cause, Fault};

/// What a call returns.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum lc_status {
    /// The call has written its answer.
    LC_OK = 0,
    /// A pointer is null or misaligned, or a size, a count or a text is invalid.
    LC_ARGUMENT = 1,
    /// A handle is zero, of another kind, of another copy of the library, or of a freed object.
    LC_HANDLE = 2,
    /// Another call is using the object: a call of another thread, or the call that runs this
    /// callback.
    LC_BUSY = 3,
    /// The library refuses the input; the message says why.
    LC_REFUSED = 4,
    /// The library has a defect; the message is that of the panic. A pair goes on without its
    /// cached state; a scene and a checker refuse all later calls.
    LC_PANIC = 5,
    /// There is no room for more handles of this kind.
    LC_FULL = 6,
    /// A callback stopped the call.
    LC_STOPPED = 7,
}
use lc_status::*;

/// The result of a call before it crosses the border. An error has left its message.
pub(crate) type Status = Result<(), lc_status>;

thread_local! {
    /// The message of the last error, with its zero at the end; empty before the first error.
    static LAST: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Returns the message of the last error of this thread.
pub(crate) fn last_error() -> *const c_char {
    // A thread that is ending has no message any more.
    let message = LAST.try_with(|last| match last.borrow().as_slice() {
        [] => c"".as_ptr(),
        text => text.as_ptr().cast(),
    });
    message.unwrap_or(c"".as_ptr())
}

fn store(message: &dyn Display) {
    let _ = LAST.try_with(|last| {
        let Ok(mut last) = last.try_borrow_mut() else {
            return;
        };
        last.clear(); // keeps its memory
        let _ = write!(last, "{message}");
        last.retain(|&c| c != 0);
        last.push(0);
    });
}

/// Stores the message of an error, and returns its status.
#[cold]
#[inline(never)]
pub(crate) fn error(status: lc_status, message: &dyn Display) -> lc_status {
    store(message);
    status
}

/// Returns the error of an input that the library refuses.
pub(crate) fn refused(message: impl Display) -> lc_status {
    error(LC_REFUSED, &message)
}

/// Returns the error of an argument by its name in C.
#[cold]
#[inline(never)]
pub(crate) fn bad_argument(name: &str) -> lc_status {
    error(
        LC_ARGUMENT,
        &format_args!("argument `{name}` is null, misaligned, too long or has an invalid size"),
    )
}

impl From<Fault> for lc_status {
    #[cold]
    #[inline(never)]
    fn from(Fault { cause, name }: Fault) -> Self {
        match cause {
            Cause::Stale => error(
                LC_HANDLE,
                &format_args!("the handle of the {name} is zero, of another kind, or of a freed object"),
            ),
            Cause::Busy => error(LC_BUSY, &format_args!("another call is using the {name}")),
            Cause::Full => error(LC_FULL, &format_args!("there are too many handles of the kind {name}")),
        }
    }
}

/// Returns the message of a panic.
fn message(payload: &(dyn Any + Send)) -> Option<&str> {
    let text = payload.downcast_ref::<&'static str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str))
}

#[cold]
#[inline(never)]
fn panicked(payload: Box<dyn Any + Send>) -> lc_status {
    let Some(text) = message(&*payload) else {
        // Dropping a payload of another type may panic.
        std::mem::forget(payload);
        return LC_PANIC;
    };
    // The hook ran on the thread that panicked, which may be another one.
    let is_stored = LAST.try_with(|last| last.borrow().starts_with(text.as_bytes()));
    if is_stored == Ok(false) {
        store(&text);
    }
    LC_PANIC
}

/// Sends messages of panics to `lc_last_error` instead of the standard error of the host.
///
/// A `cdylib` and a `staticlib` have a standard library of their own, so the hook sees the panics
/// of this library alone. Tests link this package as an `rlib` and share the hook; the feature
/// `testing` prints as before.
pub(crate) fn set_hook() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            let text = message(info.payload()).unwrap_or("panic without a message");
            match info.location() {
                Some(location) => store(&format_args!("{text} at {location}")),
                None => store(&text),
            }
            if cfg!(feature = "testing") {
                before(info);
            }
        }));
    });
}

#[inline(always)]
fn caught(call: impl FnOnce() -> Status) -> lc_status {
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => LC_OK,
        Ok(Err(status)) => status,
        Err(payload) => panicked(payload),
    }
}

/// Runs a call, catches its panic, and runs it in the floating-point mode that Rust requires.
///
/// Rust requires rounding to nearest, no flush to zero and masked exceptions. A host may have
/// another mode, by interval arithmetic or by `-ffast-math` at its link; no bound would hold then.
#[inline(always)]
pub(crate) fn guarded(call: impl FnOnce() -> Status) -> lc_status {
    let mode = unit::get();
    if unit::is_plain(mode) {
        caught(call)
    } else {
        in_plain_mode(mode, call)
    }
}

#[cold]
#[inline(never)]
fn in_plain_mode(mode: unit::Mode, call: impl FnOnce() -> Status) -> lc_status {
    unit::set(unit::PLAIN);
    let status = caught(call);
    unit::set(mode);
    status
}

/// Runs code of the host inside a call, and sets the mode of [`guarded`] again: the code may change
/// it, for example by loading a library that was linked with `-ffast-math`.
pub(crate) fn outside<R>(call: impl FnOnce() -> R) -> R {
    let result = call();
    if !unit::is_plain(unit::get()) {
        unit::set(unit::PLAIN);
    }
    result
}

#[cfg(target_arch = "x86_64")]
mod unit {
    use std::arch::asm;

    pub(super) type Mode = u32;
    pub(super) const PLAIN: Mode = 0x1f80;

    #[inline(always)]
    pub(super) fn get() -> Mode {
        let mut mode = std::mem::MaybeUninit::<Mode>::uninit();
        // SAFETY: the instruction writes the four bytes of `mode` and nothing else.
        unsafe { asm!("stmxcsr [{}]", in(reg) mode.as_mut_ptr(), options(nostack, preserves_flags)) };
        // SAFETY: written by the instruction.
        unsafe { mode.assume_init() }
    }

    #[inline(always)]
    pub(super) fn is_plain(mode: Mode) -> bool {
        mode & !0x3f == PLAIN // the six sticky flags of past exceptions do not matter
    }

    pub(super) fn set(mode: Mode) {
        // SAFETY: the instruction reads the four bytes of `mode`. Rust code runs in the mode
        // `PLAIN` only: the mode of the host is set again just before the call returns to C.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &mode, options(nostack, preserves_flags)) };
    }
}

#[cfg(target_arch = "aarch64")]
mod unit {
    use std::arch::asm;

    pub(super) type Mode = u64;
    pub(super) const PLAIN: Mode = 0;

    /// The bits of FPCR that change results: rounding mode, flush to zero, default NaN, alternative
    /// half precision, and enabled traps.
    const CHANGING: Mode = 0x07c0_9f07;

    #[inline(always)]
    pub(super) fn get() -> Mode {
        let mode: u64;
        // SAFETY: the instruction reads a register.
        unsafe { asm!("mrs {}, fpcr", out(reg) mode, options(nomem, nostack, preserves_flags)) };
        mode
    }

    #[inline(always)]
    pub(super) fn is_plain(mode: Mode) -> bool {
        mode & CHANGING == PLAIN
    }

    pub(super) fn set(mode: Mode) {
        // SAFETY: Rust code runs in the mode `PLAIN` only: the mode of the host is set again just
        // before the call returns to C.
        unsafe { asm!("msr fpcr, {}", in(reg) mode, options(nomem, nostack, preserves_flags)) };
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod unit {
    pub(super) type Mode = ();
    pub(super) const PLAIN: Mode = ();
    pub(super) fn get() -> Mode {}
    pub(super) fn is_plain((): Mode) -> bool {
        true
    }
    pub(super) fn set((): Mode) {}
}
