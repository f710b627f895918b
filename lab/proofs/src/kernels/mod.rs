//! The kernels, in the crate's own order of operations.

pub mod boxes;
pub mod certificate;
pub mod closed_form;
pub mod curved;
pub mod double;
pub mod patches;
pub mod paths;
pub mod places;
pub mod planes;
pub mod poses;
pub mod signs;
