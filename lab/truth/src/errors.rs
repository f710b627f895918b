//! Errors that must say what is wrong.
//!
//! The tests of `lin-canny-formats` and the package `truth` use this file, so it depends on neither.

use std::fmt::Display;

/// Returns the error of a result, which must say some words.
///
/// # Panics
/// Panics if there is no error, or if it does not say the words.
#[track_caller]
pub fn says<T, E: Display>(result: Result<T, E>, words: &str) -> E {
    match result {
        Err(error) if error.to_string().contains(words) => error,
        Err(error) => panic!("{error} does not say {words}"),
        Ok(_) => panic!("no error (expected {words})"),
    }
}
