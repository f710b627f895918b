//! lin-canny
#![no_std]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

pub mod broad;
mod double_double;
pub mod polyhedron;
mod scalar;
pub mod tolerance;
