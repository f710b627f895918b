//! Gives parry the certified contacts of [`lin_canny`]: a hull shape and a query dispatcher.
//!
//! Module [`single`] is for `parry3d` (feature `f32`, on by default), module [`double`] for
//! `parry3d-f64` (feature `f64`). Both have the same items, and both features may be enabled.
//! rapier and bevy_rapier accept the dispatcher without changes. For whole simulations, use
//! `lin-canny-rapier`.
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
//! # Contents
//!
//! * **The shape [`Hull`](crate::single::Hull)** is a [`ConvexPolyhedron`] for parry, with or
//!   without a border radius. Its support points, boxes and mass properties do not scan the
//!   vertices. A support face has four vertices around the face, including the deepest one. Point
//!   containment is exact. The shape also works with parry's dispatcher: a coin laid flat on a
//!   half-space stays flat.
//! * **The dispatcher [`CertifiedDispatcher`](crate::single::CertifiedDispatcher)** handles pairs of convex shapes with
//!   [`lin_canny`], in `f64` and without an absolute tolerance. The shapes may be rounded, parts of
//!   a compound, or triangles of a mesh or height field. It passes all other pairs to parry.
//! * **The shape [`MeshShape`](crate::single::MeshShape)** is a mesh, for example a tool or a
//!   terrain of a million triangles. A closed mesh is solid. Contacts are those of convex patches,
//!   so an edge inside a flat floor has no contact.
//! * **The function [`decompose`](crate::single::decompose)** divides a mesh into convex pieces
//!   with parry's V-HACD and measures the gaps. Distances are intervals that hold for the mesh.
//!
//! # No hidden state
//!
//! A manifold is a function of the relative pose and of the contacts that the engine kept. The
//! feature ids of the contacts store the closest features of the last query. So a restored snapshot
//! continues bit for bit, any number of threads gives the same bits, and a removed pair leaves
//! nothing behind. The dispatcher caches only bodies that it makes from cuboids, balls, capsules,
//! triangles and plain polyhedra, by their points. It keeps those in use and a few thousand others.
//!
//! If the bounding balls of two shapes are farther apart than the prediction, they have no contact.
//! Other shapes beyond the prediction keep one contact.
//!
//! # Use lin-canny without the dispatcher
//!
//! You can also call [`lin_canny`] directly for shapes in a parry or rapier world. Both use `glam`,
//! rapier mostly in `f32`. So pass numbers as arrays, and normalise a rotation from `f32` in `f64`:
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
//! # Which pairs lin-canny handles
//!
//! *Here* means that the dispatcher computes the result with [`lin_canny`].
//!
//! | pair | distance, contact, intersection test, closest points | manifold |
//! |---|---|---|
//! | two of: hull, cuboid, capsule, segment, triangle, convex polyhedron, rounded or not | here | here |
//! | ball, and any of the shapes above except a cuboid | here | here |
//! | ball and cuboid | here; intersection test: parry (closed form) | parry (closed form) |
//! | two balls | parry (closed form) | parry (closed form) |
//! | cylinder or cone, rounded or not, and any of the shapes above | here | here |
//! | half-space, and a hull, capsule, segment, triangle or convex polyhedron, rounded or not | parry (closed form) | here |
//! | half-space, and a ball, a cuboid, or a cylinder or cone, rounded or not | parry (closed form) | parry (closed form) |
//! | `MeshShape`, and a `MeshShape` or any of the shapes above except a half-space | here | here |
//! | compounds | piece by piece | piece by piece; with a `MeshShape` all pieces at once |
//! | mesh or height field of parry, and any convex shape above except a half-space | parry | triangle by triangle, here |
//! | two meshes or height fields, voxels, custom shapes | parry | parry |
//!
//! A rounded `Hull` counts as a rounded polyhedron. The closed forms of parry in the table compare
//! no length with an absolute number. Tests check them to 4e-6 of the size, from 0.1 mm to 10 km.
//! parry's other tolerances in `f32` are absolute. So distances and casts of small parts to a mesh
//! of parry remain inaccurate. Use a `MeshShape` instead (`MeshShape::try_from(&trimesh)`).
//! rapier's character controller always uses parry's dispatcher.
//!
//! # Triangles of parry's meshes and height fields
//!
//! If a contact is inside a triangle, its overlap is measured along the normal of the triangle. The
//! least translation may cross an edge, where the mesh continues. A normal that the mesh rejects
//! (`TriMeshFlags::FIX_INTERNAL_EDGES`, `HeightFieldFlags`) has no contact. **Without such flags,
//! edges inside a flat floor have contacts**, as with parry, and a sliding body may catch on them.
//! A `MeshShape` needs no flag.
//!
//! # Casts
//!
//! [`impact`](lin_canny::impact) computes `cast_shapes` and `cast_shapes_nonlinear` of all convex
//! shapes of the table, and of compounds piece by piece. Two balls without rotation use parry's
//! closed form. The shapes are proven apart (or farther than the target distance) until the time of
//! impact. At that time they are within a few units in the last place of the engine's numbers. No
//! contact is missed, for any rotation. Departures from parry:
//!
//! * If a cast ends undecided, because a shape is within rounding error of contact, the result is a
//!   hit at the last time proven free. The status is `OutOfIterations` if a work limit was reached.
//!   `Failed` never occurs.
//! * parry runs a cast with rotation that does not stop at penetration, if the shapes are in
//!   contact at the start. If the shapes move by more than 10,000 of their thicknesses, the start
//!   is the hit.
//! * If one shape of such a cast is a `MeshShape`, only a core of the other shape is cast: a ball
//!   of half its thickness around its centre of mass, or a smaller ball if that one touches
//!   already. So a part that lies on a thin floor and is pushed may sink into the floor by half,
//!   and may fall through. Of 36 spinning parts that were pushed at 3 m/s on a tray of 2 mm, 9 fell
//!   through in `f32`, and 27 without sweeps.
//! * rapier sweeps hulls, cuboids, balls and capsules with its own code, which no dispatcher
//!   replaces. It casts cylinders and cones in continuous motion with its dispatcher, so with this
//!   crate.
//!
//! # Limits
//!
//! * A query with invalid numbers returns `Unsupported`. No query panics or runs without end:
//!
//!   | invalid | details |
//!   |---|---|
//!   | sizes | negative or infinite |
//!   | poses | not a rigid motion |
//!   | coordinates, velocities and distances of queries that parry runs | above 1e9 (`f32`) or 1e76 (`f64`) |
//!   | manifolds | voxels with half-spaces; polyhedra of which parry kept no face |
//!   | casts | over more than 65,536 cells of a field |
//!
//! * A negative prediction returns only overlaps that are at least as deep. Vertices of meshes are
//!   not checked: they must be finite.
//! * A serialised `Hull` is a parry `ConvexPolyhedron` with the same vertices. After
//!   deserialisation the dispatcher builds a body from these vertices again and compares all
//!   vertices in each query ([`Hull::try_from`](crate::single::Hull) saves this). Engines do not
//!   serialise the dispatcher, so set it again after you read a snapshot.
//! * Cylinders and cones cost more than in parry: a step of 180 of them that are thrown into a bin
//!   takes 1.3 and 1.2 times as long at 1 m (two cores of an AMD EPYC with other programs running,
//!   2026-11-25). At 2 cm, overlaps are 0.6 of the size with parry and 0.008 with this crate.
//! * If a cylinder or cone is close to a shape without touching it, the kept contact is that of a
//!   plane between them, which may differ from the closest points. An overlap of at most 1 % of the
//!   smaller radius may be a local minimum, so the reported depth is too large by at most that.
//! * A body on a `MeshShape` costs 10-25 µs per step, about ten times the cost with parry's mesh,
//!   for any number of triangles (example `terrain` of `lin-canny-rapier`). The engine keeps a
//!   tracker for the pair, which only saves time.
//! * A `MeshShape` is not part of a snapshot. It has a mass only if it is closed. It has contacts
//!   from outside only: a thin sheet needs both sides, otherwise a body that is pushed through it
//!   has no contact any more.
//! * Flat and needle-like bodies for which parry has no convex polyhedron are not part of a
//!   snapshot.
//!
//! # Workarounds for defects of parry 0.31.1 and glamx 0.3.1
//!
//! * glamx `symmetric_eigen` returns the unit axes for any symmetric matrix with entries below
//!   about 1e-5. So `MassProperties::with_inertia_matrix` is wrong by 11 % for a 10 cm hull of 24
//!   vertices at density 1, and by 100 % for a needle. `Hull` computes its mass properties itself.
//! * `ConvexPolyhedron::local_support_feature` returns the first four vertices of the best-aligned
//!   face, which may not include the deepest vertex. So prisms with 6 or more sides tip on a
//!   half-space.
//! * The distance, contact and manifold code compares lengths and areas with 1e-3 (`f32`) in
//!   absolute units. So bodies of 1 cm are reported as intersecting at a gap of a tenth of their
//!   size.
//! * The distance of two cuboids and of two capsules is too large by up to 1 %, in `f64` too:
//!   closer witness points exist.
//! * `contact` of a shape and a half-space, in this order, uses the pose instead of its inverse.
//!
//! All of these defects were reproduced with these versions.

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "f64")]
pub mod double;
#[cfg(feature = "f32")]
pub mod single;

pub use lin_canny;
#[cfg(doc)]
use lin_canny::ConvexPolyhedron;
