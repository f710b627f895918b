//! C interface of lin-canny: geometries, pairs, rays, scenes and checkers of robots.
//!
//! The header `include/lin_canny.h` is generated from these sources; `include/lin_canny.hpp` wraps
//! it for C++17. `README.md` shows how to build and link.
//!
//! # Rules
//!
//! * A handle is a number, zero is none. A stale, foreign or invented handle is an error.
//! * Every function returns a status, except those that cannot fail. The message of the last error
//!   of a thread is [`lc_last_error`]. An error writes no answer, except where the function says
//!   so.
//! * Arrays are read during the call and never kept. Answers are structs that the caller owns. Nothing
//!   writes to an array during the call: no other thread, no callback, and no answer that overlaps it.
//! * The size of an answer is an argument: a later version may add fields at the end.
//! * A panic becomes `LC_PANIC`. The floating-point mode of the caller is set to the one that the
//!   proofs need, and set back afterwards.
//!
//! # Memory
//!
//! | module | holds |
//! |---|---|
//! | `table` | handles, claims of objects |
//! | `border` | statuses, messages, panics, the floating-point mode |
//! | `memory` | pointers of the caller, checked once |
//! | all others | the functions, which use those three and no pointer themselves |

#![allow(non_camel_case_types)] // names of C

#[cfg(panic = "abort")]
compile_error!("panics are caught at the border: build with panic = \"unwind\"");

mod border;
mod cell;
mod checker;
mod geometry;
mod memory;
mod pair;
mod pose;
mod progress;
mod robot;
mod scene;
mod table;

use std::ffi::{CString, c_char};

pub use border::lc_status;
pub use cell::*;
pub use checker::*;
pub use geometry::*;
pub use pair::*;
pub use pose::*;
pub use progress::lc_progress;
pub use robot::*;
pub use scene::*;

/// The version of the interface. It grows by one with every change that breaks compiled callers.
pub const LC_ABI: u32 = 0;

/// Returns the version of the interface of the loaded library; compare it with `LC_ABI`.
#[unsafe(no_mangle)]
pub extern "C" fn lc_abi() -> u32 {
    LC_ABI
}

/// Returns the version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn lc_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// Returns the message of the last error of this thread, or an empty text.
///
/// The text is valid until the next error of this thread. It must not be freed.
#[unsafe(no_mangle)]
pub extern "C" fn lc_last_error() -> *const c_char {
    border::last_error()
}

/// Frees a text that a function of this library returned; null is no error.
///
/// # Safety
/// `text` is null, or is from this library and not freed, and its length is unchanged. No check is
/// possible.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_text_free(text: *mut c_char) {
    if !text.is_null() {
        // SAFETY: by the caller's contract; texts are made by `CString::into_raw`.
        drop(unsafe { CString::from_raw(text) });
    }
}

/// Returns the number of live objects of all kinds, for tests that look for leaks.
#[unsafe(no_mangle)]
pub extern "C" fn lc_live() -> u64 {
    (geometry::live() + pair::live() + scene::live() + checker::live()) as u64
}
