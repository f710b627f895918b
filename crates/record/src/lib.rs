//! Writes and reads recordings of moving bodies and query results.
//!
//! A recording is a file of JSON lines. A loop, a [`Scene`](lin_canny::scene::Scene), a robot or a
//! planner writes one line per frame. [`page`] plays it on a page for a browser.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//! use lin_canny::{Geometry, PairTracker, RelativePose};
//! use lin_canny_record::{Recorder, Recording};
//!
//! let cube = Geometry::from(solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?);
//! let mut file = Vec::new(); // or `Recorder::create("pair.jsonl", "two cubes")?`
//! let mut recorder = Recorder::new(&mut file, "two cubes")?;
//! let a = recorder.body("still", &cube, &Isometry3::identity())?;
//! let b = recorder.body("moved", &cube, &Isometry3::identity())?;
//! let mut pair = PairTracker::new();
//! for frame in 0..10 {
//!     let pose = Isometry3::translation(3.0 - 0.1 * f64::from(frame), 0.2, 0.1);
//!     let poses = RelativePose::new(&Isometry3::identity(), &pose)?;
//!     recorder.pose(b, &pose)?;
//!     recorder.answer(a, b, &pair.closest(&cube, &cube, &poses))?;
//!     recorder.end_frame()?;
//! }
//! recorder.finish()?;
//!
//! let recording = Recording::read(file.as_slice())?;
//! assert_eq!((recording.bodies.len(), recording.frames.len()), (2, 10));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`svg`] draws a few shapes and a view of things in space as SVG.
//!
//! # The format, version 2
//!
//! A file is UTF-8 text with one JSON value per line. The first line is the [`Header`]:
//! `{"format":"lin-canny recording","version":2,"title":"two cubes"}`. Each further line is an
//! object with one key:
//!
//! | key | value |
//! |---|---|
//! | `geometry` | a [`Geometry`](lin_canny::Geometry), serialised by the core library with its feature `serde`; geometries are numbered from 0 in the order of their lines |
//! | `body` | a [`BodyLine`]: name, number of the geometry, and pose; bodies are numbered from 0 in the order of their lines, and shown from the next frame on |
//! | `frame` | a [`Frame`]: the poses that changed since the previous frame, and everything to show |
//!
//! A pose is an array of seven numbers: the translation x, y, z and the unit quaternion x, y, z, w,
//! from the body's frame to the world. Points are arrays of three numbers. Poses, boxes, paths and
//! contacts are in the world frame. The outcome of a query is in the frames of the two bodies, as
//! in [`Outcome`](lin_canny::Outcome). Lengths and times are in the units of the caller. Numbers
//! are written with enough digits to read back the same bits. The reader returns an error for
//! another version, and ignores unknown keys.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod format;
mod markup;
mod page;
mod picture;
mod read;
mod scene;
pub mod svg;
mod write;

pub use format::{BodyLine, Bracket, ColumnLine, Contact, FORMAT, Frame, Header, PairLine, VERSION, poses};
pub use markup::escaped;
pub use page::{PageOptions, page};
pub use picture::RenderMesh;
pub use read::{Cursor, ReadError, Recording};
pub use write::{Recorder, WriteError, is_same};
