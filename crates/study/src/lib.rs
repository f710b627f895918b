//! Computes clearances of millions of robot configurations with SQL functions of Apache DataFusion.
//!
//! The functions run in one process or on the executors of Apache Ballista. The command line tool
//! of the same name needs no program.
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
//! let study = Study::new(files.load()?.cell, StudyOptions::default())?;
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
//! | task | type or module |
//! |---|---|
//! | load robot, cell and options, and register the functions | [`Study`], [`StudyOptions`] |
//! | make contexts with the functions, local or on a cluster | [`engine`] |
//! | read and write files of rows | [`Input`], [`Format`] |
//! | run a query part by part, and resume it after an interruption | [`Run`] |
//! | make configurations | [`sampled`] |
//! | make cells of ranges, to prove which links can ever meet | [`audited`] |
//! | make the graph of a roadmap | [`roadmap`] |
//! | start scheduler and executors | [`cluster`] |
//!
//! The result of a row depends on the row alone, bit for bit, because the checker drops all cached
//! state before each row.
#![forbid(unsafe_code)]

pub mod audited;
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

pub use error::StudyError;
pub use format::{Format, flat};
pub use input::{ID, Input, TABLE, configuration_of, quoted};
pub use lin_canny_robot as robot;
pub use run::{Run, RunOptions, RunProgress, RunSummary, cluster_error, look_over};
pub use study::{Study, StudyOptions};
