//! Runs rapier with the certified contacts of [`lin_canny`], with only the effects you enable.
//!
//! Without [`response`](Effects::response) no physics engine is created. Module [`single`] is for
//! `rapier3d` (feature `f32`, on by default), module [`double`] for `rapier3d-f64` (feature `f64`).
//!
//! ```
//! use lin_canny_rapier::single::{Hull, Simulation};
//! use lin_canny_rapier::{Body, Effects, Settings};
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//!
//! let effects = Effects { gravity: Some(Vector3::y() * -9.81), friction: Some(0.5), ..Effects::response() };
//! // A coin of 2 cm, laid on a table.
//! let settings = Settings::default().length_unit(0.02).time_step(1.0 / 240.0);
//! let mut simulation = Simulation::new(effects, settings)?;
//! let table = Hull::new(solids::cuboid(Vector3::new(1.0, 0.1, 1.0))?);
//! simulation.insert(&table, Body::fixed(Isometry3::translation(0.0, -0.1, 0.0)))?;
//! let coin = Hull::new(solids::prism(32, 0.001, 0.01)?);
//! let lying = Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
//! let pose = Isometry3::translation(0.0, 0.001, 0.0) * lying;
//! let id = simulation.insert(&coin, Body::moving(pose, 8000.0))?;
//! for _ in 0..240 {
//!     simulation.step()?;
//! }
//! assert!(simulation.pose(id).unwrap().rotation.angle_to(&lying.rotation) < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Two engines
//!
//! | | without [`response`](Effects::response) | with response |
//! |---|---|---|
//! | bodies | pass through each other | push each other |
//! | engine | this crate integrates velocities | a rapier world with the dispatcher of [`lin_canny_parry`] |
//! | pair queries | a [`Scene`](lin_canny::scene::Scene) runs those in [`Settings::queries`] | rapier's narrow phase has the contacts |
//!
//! A simulation keeps its engine for its lifetime.
//!
//! # Bodies
//!
//! A body has any parry shape, a [`Hull`](lin_canny_parry::single::Hull) or a
//! [`MeshShape`](lin_canny_parry::single::MeshShape). It is fixed, kinematic (it moves at its
//! velocity and nothing pushes it) or dynamic. A body may have its own friction and restitution;
//! the default is that of the effects. Poses and velocities can be set between steps.
//!
//! With response, `Simulation::step_with` takes rapier's hooks and event handler.
//! `Simulation::world_mut` gives access to joints, forces and sensors; its page has a pendulum.
//! `Simulation::deepest_overlap` measures the deepest overlap, for both engines.
//!
//! # Each effect in rapier, and its cost
//!
//! The numbers are milliseconds per step of a pile of 500 hulls of 64 vertices, in `f32`, over 300
//! steps. They were measured with a prototype before the release (rapier 0.36.1).
//! `cargo run --release -p lin-canny-rapier --example effects` measures another scene.
//!
//! | effect | switch of rapier | with | without |
//! |---|---|---|---|
//! | response | another engine | 1.41 | 0.19 (overlaps reported), 0.42 (distances), 1.00 (contact points) |
//! | gravity | `gravity` | 1.41 | 0.02: nothing moves, everything sleeps |
//! | rotation | `lock_rotations` | 1.41 | 0.63 |
//! | sleeping | `can_sleep` | 1.41 | 1.57: more expensive without |
//! | continuous motion against fixed bodies | `max_ccd_substeps` | 1.41 | 1.24 |
//! | continuous motion of all bodies | `ccd_enabled` | 1.55 | 1.41 |
//! | friction | friction 0 | 1.41 | 3.96: the solver builds its rows anyway, and the pile never rests |
//! | Coulomb friction instead of the simplified model | `friction_model` | 1.81 | 1.41 |
//! | restitution | restitution 0 | 1.46 | 1.41: the difference is noise |
//! | 1, 4, 8 iterations | `num_solver_iterations` | 1.32, 1.41, 2.11 | |
//!
//! **In rapier, a simulation without friction or restitution is not faster.**
//!
//! # What follows from the size of the bodies
//!
//! [`length_unit`](Settings::length_unit) is rapier's `length_unit`: rapier multiplies lengths and speeds by it.
//! If you set `length_unit` yourself, you **must also remove the speed limit**. Otherwise small
//! parts fall too slowly: a part of 2 mm falls by 0.77 m in the first second instead of 4.9 m.
//!
//! ```
//! use lin_canny_rapier::single::rapier::pipeline::PhysicsWorld;
//!
//! let mut world = PhysicsWorld::new();
//! world.integration_parameters.length_unit = 0.002;
//! world.integration_parameters.normalized_max_linear_velocity = f32::MAX; // none
//! ```
//!
//! | quantity of rapier 0.36.1 | in terms of the size | in this crate |
//! |---|---|---|
//! | `normalized_max_linear_velocity`: speed limit | 400 sizes per second | none, or [`max_speed`](Settings::max_speed) |
//! | `normalized_prediction_distance`: distance below which there are contacts | 0.02 sizes | as in rapier |
//! | `normalized_allowed_linear_error`: where swept motion stops | 0.005 sizes | as in rapier |
//! | `normalized_max_corrective_velocity`: speed at which overlaps and joints are corrected | 3 sizes per second | as in rapier |
//! | `normalized_contact_recycle_distance`: distance up to which contacts are kept | 0.05 sizes | as in rapier |
//! | margin of the boxes of the broad phase | 0.04 to 0.25 sizes | constants of rapier |
//! | `normalized_linear_threshold` of a body: half a second below it puts the body to sleep | 0.1 sizes per second, as measured | as in rapier |
//! | `recovery_pace` and the contact load of soft bodies | 0.5 sizes per second; gravity counts as 10 sizes per second squared | as in rapier: this crate makes no soft bodies |
//!
//! Sleep may be wrong at large sizes. If `length_unit` is 24 m or more, a body that is thrown up on Earth
//! is slower than 0.1 sizes per second for half a second, so it falls asleep at its highest point.
//! Disable [`sleeping`](Effects::sleeping) for such sizes, and if gravity is weak.
//!
//! These quantities do not depend on the size:
//!
//! * The angular velocity is limited to an eighth of a turn per step: 47 rad/s with steps of 1/60
//!   s, 188 rad/s with steps of 1/240 s. A part of 2 mm that rolls at 0.2 m/s reaches this limit.
//!   rapier's `RigidBody::set_allow_fast_rotation` removes the limit for a body.
//! * In rapier the softness of contacts is a frequency of 30 Hz (60 Hz on fixed bodies) for any
//!   step, so bodies sink by g / (2 pi 30)^2 = 0.28 mm. This crate multiplies both frequencies by
//!   `1 / (60 time_step)`, so shorter steps are stiffer.
//! * Inverse masses below 1e-20 count as zero: see [`SimulationError::Number`].
//! * Swept motion starts at a speed that depends on the extents of the shape and the step.
//!
//! # bevy_rapier and avian
//!
//! This section is from reading the source of bevy_rapier 0.37.0 and avian 0.8.0, without building
//! them.
//!
//! bevy_rapier has `RapierContextSimulation::with_query_dispatcher` and `set_query_dispatcher`. Set
//! the dispatcher in a `Startup` system, because this empties the narrow phase, and make colliders
//! from hulls:
//!
//! ```ignore
//! fn certify(mut context: WriteRapierContext) -> Result {
//!     context.single_mut()?.simulation.set_query_dispatcher(CertifiedDispatcher::default());
//!     Ok(())
//! }
//! let collider = Collider::from(SharedShape::from(Hull::from_points(&points)?));
//! ```
//!
//! avian calls
//! `AnyCollider::contact_manifolds_with_context(&self, other, .., prediction, manifolds, context)`
//! with the manifolds of the last frame and their feature ids. So
//! [`CertifiedDispatcher`](lin_canny_parry::single::CertifiedDispatcher) works without changes, because its contacts
//! depend only on the pose and the kept contacts. avian starts parry's queries cold in every frame,
//! so it gains more than rapier. Its swept motion and spatial queries need parry's colliders. Its
//! broad phase, contact graph, constraint graph and islands are public.
//!
//! rapier's solver has no public interface for contacts: `NarrowPhase::register_pairs`,
//! `compute_contacts` and the island solver are private in rapier 0.36.1. So this crate uses the
//! dispatcher. rapier's character controller always uses parry's dispatcher. It has the defects of
//! parry's contacts in `f32` if the character or the floor measures a few centimetres or less.
//!
//! # Workarounds for defects of rapier 0.36.1
//!
//! * Continuous motion calls `mass_properties(1.0)` of every fast shape in every step. A
//!   [`Hull`](lin_canny_parry::single::Hull) computes them once.
//! * `utils::inv` is 0 below 1e-20, so the inertia of bodies below 0.1 mm at density 1 would be
//!   infinite. Hulls invert in `f64`.
//! * Inertia tensors of bodies of 10 cm or less at density 1 are wrong by 11 % to 100 %: see
//!   [`lin_canny_parry`].
//! * Snapshots do not contain the dispatcher. Set it again after you read one.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod effects;
mod error;
mod free;
mod overlap;

#[cfg(feature = "f64")]
pub mod double;
#[cfg(feature = "f32")]
pub mod single;

pub use effects::{Body, BodyId, Continuous, Effects, FrictionModel, Report, Settings};
pub use error::SimulationError;
pub use lin_canny_parry;
pub use overlap::Overlap;
