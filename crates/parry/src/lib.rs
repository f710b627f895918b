//! Certified contacts of [`lin_canny`] inside parry: a hull shape and a query dispatcher.
//!
//! Module [`single`] is for `parry3d` (feature `f32`, on by default), module
//! [`double`] for `parry3d-f64` (feature `f64`). Both have the same items, and both
//! features may be on. rapier and bevy_rapier take the dispatcher as it is; `lin-canny-rapier` has
//! whole simulations.
//!
//! ```
//! use lin_canny_parry::single::{CertifiedDispatcher, Hull, parry};
//! use parry::math::{Pose, Vector};
//! use parry::query::{ContactManifold, PersistentQueryDispatcher, QueryDispatcher};
//! use parry::shape::Cuboid;
//!
//! // A pin of a millimetre, in metres: parry's own hull code takes it for a point.
//! let points: Vec<Vector> = (0..24)
//!     .map(|k| (std::f32::consts::TAU / 12.0 * k as f32, if k < 12 { 5e-4 } else { -5e-4 }))
//!     .map(|(angle, y)| Vector::new(5e-5 * angle.cos(), y, 5e-5 * angle.sin()))
//!     .collect();
//! let pin = Hull::from_points(&points)?;
//! let table = Cuboid::new(Vector::new(0.1, 0.01, 0.1));
//!
//! let dispatcher = CertifiedDispatcher::default();
//! let pose = Pose::translation(0.0, 0.0105, 0.0);
//! let distance = dispatcher.distance(&pose, &table, &pin).unwrap().distance;
//! assert!(distance.abs() < 1e-9);
//!
//! let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
//! dispatcher.contact_manifolds(&pose, &table, &pin, 1e-5, &mut manifolds, &mut None).unwrap();
//! assert!(manifolds[0].points.len() >= 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What it gives
//!
//! * **The shape** [`Hull`](crate::single::Hull) carries a [`ConvexPolyhedron`], rounded by a border
//!   radius or not, into parry: support
//!   points, boxes and mass properties that do not scan the vertices, support faces spread over four
//!   vertices that include the deepest one, exact point containment. It works under parry's own
//!   dispatcher too: a coin laid flat on a half-space stays flat.
//! * **The dispatcher** [`CertifiedDispatcher`](crate::single::CertifiedDispatcher) answers pairs of convex shapes of
//!   every kind, rounded, in compounds, or as the triangles of a mesh or height field, by
//!   [`lin_canny`], in `f64`, without an absolute tolerance, and hands all other pairs to parry.
//! * **The shape** [`MeshShape`](crate::single::MeshShape) is a mesh as the caller brought it, a
//!   terrain of a million triangles or a tool: closed ones are solids, contacts are those of convex
//!   patches, so that no edge inside a flat floor bears one.
//! * **V-HACD, checked.** [`decompose`](crate::single::decompose) cuts a mesh into convex pieces by
//!   parry's V-HACD and measures the gaps: distances are intervals that hold for the mesh.
//! * **No state.** A manifold is a function of the relative pose and of the contacts that the
//!   engine itself kept: the closest features of the last query stand in the feature ids of the
//!   contacts. Shapes whose bounding balls are farther apart than the prediction asks for have no
//!   contact; others beyond the prediction keep one. Snapshots go on bit for bit, any number of
//!   threads gives the same bits, and a
//!   dropped pair leaves nothing behind. Only bodies made of cuboids, balls, capsules, triangles and
//!   plain polyhedra are remembered, by their points: those in use, and some thousands that are not.
//!
//! # Bodies and poses without the dispatcher
//!
//! To call [`lin_canny`] itself on what stands in a world of parry or rapier: both use `glam`, rapier
//! mostly in `f32`, so numbers cross as arrays, and a rotation from `f32` has to be normalised in `f64`.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Point3, Translation3};
//! use lin_canny::nalgebra::{Quaternion, UnitQuaternion};
//! use lin_canny::{BuildError, ConvexPolyhedron, RelativePose, Tracker};
//! // `rapier3d::parry` and `rapier3d::math` are the same.
//! use lin_canny_parry::single::parry::{math::{Pose, Vector}, shape};
//!
//! /// The hull of vertices: of `Cuboid::to_trimesh`, `TriMesh::vertices`.
//! fn body(points: &[Vector]) -> Result<ConvexPolyhedron, BuildError> {
//!     let wide = |p: &Vector| Point3::from(p.to_array().map(f64::from));
//!     ConvexPolyhedron::from_points(&points.iter().map(wide).collect::<Vec<_>>())
//! }
//!
//! fn pose(pose: &Pose) -> Isometry3<f64> {
//!     let [i, j, k, w] = pose.rotation.to_array().map(f64::from);
//!     let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
//!     let translation = pose.translation.to_array().map(f64::from);
//!     Isometry3::from_parts(Translation3::from(translation), rotation)
//! }
//!
//! let a = body(&shape::Cuboid::new(Vector::new(1.0, 2.0, 3.0)).to_trimesh().0)?;
//! let ball = shape::Ball::new(0.5).to_trimesh(8, 8).0;
//! let ball = shape::ConvexPolyhedron::from_convex_hull(&ball).unwrap();
//! let b = body(ball.points())?;
//! let (pose_a, pose_b) = (Pose::identity(), Pose::translation(4.0, 0.1, 0.0));
//! let a_from_b = RelativePose::new(&pose(&pose_a), &pose(&pose_b))?;
//! let c = Tracker::new().closest(&a, &b, &a_from_b);
//! assert!((c.distance - 2.5).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which pairs are answered by whom
//!
//! | pair | distance, contact, test, closest points | manifold |
//! |---|---|---|
//! | a hull, cuboid, capsule, segment, triangle, convex polyhedron or rounded one of these, and one of these | here | here |
//! | a ball, and any of the shapes above but a cuboid | here | here |
//! | ball and cuboid | here, but the test: parry (closed form) | parry (closed form) |
//! | two balls | parry (closed form) | parry (closed form) |
//! | cylinder or cone, rounded ones too, and any of the shapes above | here | here |
//! | half-space, and a hull, capsule, segment, triangle, convex polyhedron or rounded one | parry (closed form) | here |
//! | half-space, and a ball, cuboid, cylinder or cone, or a rounded one of the last two | parry (closed form) | parry (closed form) |
//! | a `MeshShape`, and a `MeshShape` or any of the shapes above but a half-space | here | here |
//! | compounds | part by part | part by part, at once with a `MeshShape` |
//! | mesh or height field of parry, and any convex shape above but a half-space | parry | triangle by triangle, here |
//! | two meshes or height fields, voxels, custom shapes | parry | parry |
//!
//! A rounded `Hull` counts as a rounded polyhedron. The closed forms of parry that are kept compare no
//! length with an absolute number: tests hold them to four parts in a million of the size, from a
//! tenth of a millimetre to ten kilometres. Its other
//! tolerances in `f32` are absolute: distances and casts of small parts to a mesh of parry are not
//! cured, and a `MeshShape` (`MeshShape::try_from(&trimesh)`) is. rapier's character controller asks
//! parry's own dispatcher, whichever is set.
//!
//! # Triangles of surfaces
//!
//! An overlap with a triangle of a mesh or height field of parry is measured along the triangle's
//! own normal where the contact lies in the triangle, as its least translation may lead out over an
//! edge beyond which the surface goes on. Normals that the surface refuses
//! (`TriMeshFlags::FIX_INTERNAL_EDGES`, `HeightFieldFlags`) bear no contact. **Without such flags
//! edges inside a flat floor bear contacts**, as with parry: a body that slides may catch there. A
//! `MeshShape` needs no flag.
//!
//! # Casts
//!
//! `cast_shapes` and `cast_shapes_nonlinear` of all convex shapes of the table, and of compounds
//! part by part, are those of [`impact`](lin_canny::impact); two balls without a turn have parry's
//! closed form. The shapes are proven apart (or farther than the target distance) until the time of
//! impact, and are within some units in the last place of the engine's numbers there. No contact is
//! passed over, whatever the turn. Departures from parry:
//!
//! * A cast that ends without a decision, because rounding hides whether the shapes meet, is a hit
//!   at the last instant proven free. The status is `OutOfIterations` if a limit of work was
//!   reached, and `Failed` never occurs.
//! * A cast with turns that does not stop at a penetration, of shapes that meet at the start, is
//!   parry's, unless the shapes pass more than ten thousand of their thicknesses: then the start is
//!   the hit. If one of them is a `MeshShape`, such a cast is that of the other's core, a ball of half
//!   its thickness about its centre of mass, or a smaller one if this touches, too. A part that
//!   lies on a thin floor and is pushed may sink into the floor by half, and still come out below: of
//!   36 that spin and are pushed at 3 m/s at a tray of 2 mm, 9 fall through in `f32`, and 27 without
//!   sweeps.
//! * rapier sweeps hulls, cuboids, balls and capsules by code of its own, which no dispatcher
//!   replaces; cylinders and cones in continuous motion are cast by its dispatcher, and so here.
//!
//! # Limits
//!
//! * A query of numbers that the code in charge cannot work with is `Unsupported`: no query panics, nor
//!   does a search of parry's go on without end. Such numbers are negative or infinite sizes, poses
//!   that are none, and where parry answers, coordinates, velocities and ways above 1e9 in `f32` (1e76
//!   in `f64`); such queries are manifolds of voxels with half-spaces and of polyhedra of which parry
//!   kept no face, and casts over more than 65,536 cells of a field. A prediction below zero asks for
//!   overlaps at least as deep. Vertices of meshes are not looked at: they must be finite.
//! * Serialized, a `Hull` is a parry `ConvexPolyhedron` with the vertices of the hull; read back,
//!   the dispatcher makes a body of these vertices again, which costs a comparison of all vertices
//!   in each query ([`Hull::try_from`](crate::single::Hull) saves that). After reading a snapshot the
//!   dispatcher must be set again: engines do not serialize it.
//! * Cylinders and cones cost more than parry's: a step of 180 that are thrown into a bin takes 1.3
//!   and 1.2 times as long at a metre (two cores of an AMD EPYC with other work on them,
//!   2026-11-25). At 2 cm parry's overlap by .6 of their size and ours by .008. Of two that are near
//!   and do not touch, the kept contact is that of a plane between them, which need not be the
//!   nearest points. An overlap of at most 1 % of the smaller radius may be measured along the
//!   normal that is best in its neighbourhood, so that it is told too deep by at most that.
//! * A body on a `MeshShape` costs 10 to 25 microseconds a step, some ten times parry's mesh,
//!   whatever the number of triangles (`terrain` of the examples of `lin-canny-rapier`). The engine
//!   keeps a tracker for the pair, which saves time and nothing else.
//! * A `MeshShape` is no part of a snapshot, has no mass unless it is closed, and bears contacts from
//!   outside alone: give a thin sheet both sides, or a body that is pushed through it comes free.
//! * Flat and needle-like bodies for which parry has no convex polyhedron are no part of a snapshot.
//!
//! # Defects of parry 0.31.1 and glamx 0.3.1 that are worked round
//!
//! * glamx `symmetric_eigen`: any symmetric matrix with entries below about 1e-5 gets the unit axes.
//!   `MassProperties::with_inertia_matrix` is wrong by 11 % for a hull of 24 vertices of 10 cm at
//!   density 1, and by 100 % for a needle. `Hull` brings mass properties of its own.
//! * `ConvexPolyhedron::local_support_feature` returns the first four vertices of the best-aligned
//!   face, which need not hold the deepest vertex: prisms of 6 and more sides tip on a half-space.
//! * The distance, contact and manifold code tests lengths against 1e-3 and areas against 1e-3
//!   (`f32`) in absolute units: bodies of a centimetre are reported as intersecting from a gap of
//!   a tenth of their size.
//! * The distance of two cuboids and of two capsules is too large by as much as a hundredth of the
//!   distance, in `f64` too: witnesses nearer than this exist.
//!
//! * `contact` of a shape and a half-space in this order takes the pose for its inverse.
//!
//! All of these were reproduced with these versions.

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "f64")]
pub mod double;
#[cfg(feature = "f32")]
pub mod single;

pub use lin_canny;
#[cfg(doc)]
use lin_canny::ConvexPolyhedron;
