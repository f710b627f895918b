//! lin-canny
#![no_std]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod double_double;
pub mod polyhedron;
mod scalar;
pub mod tolerance;
