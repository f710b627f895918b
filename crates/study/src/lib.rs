//! Clearances of millions of configurations of a robot as SQL functions of Apache DataFusion, in one process or on the executors of
//! Apache Ballista. The tool of the same name needs no program.
//!
//! ```
//! # let runtime = tokio::runtime::Runtime::new()?;
//! use datafusion::prelude::SessionContext;
//! use lin_canny_study::robot::RobotFiles;
//! use lin_canny_study::{Study, StudyOptions};
//!
//! let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../robot/examples");
//! let mut files = RobotFiles::new(format!("{folder}/six_axis.urdf"));
//! files.cell = Some(format!("{folder}/six_axis_cell.json").into());
//! let study = Study::load(&files, StudyOptions::default())?;
//!
//! # runtime.block_on(async {
//! let context = SessionContext::new();
//! study.register(&context);
//! let query = "SELECT clearance([0.0, 0.5, 1.0, 0.0, 0.0, 0.0])['distance'] > 0.05 AS is_far";
//! let answer = context.sql(query).await?.collect().await?;
//! # assert_eq!(answer[0].num_rows(), 1);
//! # Ok::<(), datafusion::error::DataFusionError>(())
//! # })?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | what | with |
//! |---|---|
//! | robot, cell, options; the functions | [`Study`], [`StudyOptions`] |
//! | contexts that know the functions, here and on a cluster | [`engine`] |
//! | files of rows | [`Input`], [`Format`] |
//! | a query part by part, that goes on after a stop | [`Run`] |
//! | configurations to begin with | [`sampled`] |
//! | the graph of a roadmap | [`roadmap`] |
//! | scheduler and executors | [`cluster`] |
//!
//! A row's answer is a function of the row alone, bit for bit: each is asked of a checker that has forgotten the others.
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

pub use error::{RowError, StudyError};
pub use format::{Format, flat};
pub use input::{ID, Input, TABLE, configuration_of, quoted};
pub use lin_canny_robot as robot;
pub use run::{Run, RunOptions, RunProgress, RunSummary, cluster_error, look_over};
pub use study::{Study, StudyOptions};
