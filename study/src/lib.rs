//! Clearances of millions of configurations as SQL functions.
#![forbid(unsafe_code)]

pub mod cluster;
pub mod engine;
mod error;
mod format;
mod functions;
mod input;
mod manifest;
pub mod roadmap;
mod rows;
mod run;
pub mod sampled;
mod study;

pub use error::{RowFault, StudyError};
pub use format::{Format, flat};
pub use input::{ID, Input, TABLE, configuration_of, quoted};
pub use lin_canny_robot as robot;
pub use run::{Run, RunOptions, RunProgress, RunSummary, cluster_error, look_over};
pub use study::{Study, StudyOptions};
