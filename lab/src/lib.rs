//! What the tests, benches and examples of `lin-canny` share.

pub mod boxes;
