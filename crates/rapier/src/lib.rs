//! Dynamics by the effects a scene calls for: rapier under the certified contacts of
//! [`lin_canny`], and no engine at all if nothing calls for one.
//!
//! Module [`single`] is for `rapier3d` (feature `f32`, on by default), module
//! [`double`] for `rapier3d-f64` (feature `f64`).
//!
//! ```
//! use lin_canny_rapier::single::{Hull, Simulation};
//! use lin_canny_rapier::{Body, Effects, Settings};
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//!
//! let effects = Effects { gravity: Some(Vector3::y() * -9.81), friction: Some(0.5), ..Effects::response() };
//! // A coin of 2 cm, laid on a table.
//! let settings = Settings { size: 0.02, time_step: Some(1.0 / 240.0), ..Settings::default() };
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
//! Without [`response`](Effects::response), bodies pass through each other. Then no physics engine
//! is built: velocities are integrated here, and a [`Scene`](lin_canny::scene::Scene) of
//! [`lin_canny`] answers what is called for about the pairs ([`Settings::queries`]). With response,
//! a rapier world runs under the dispatcher of [`lin_canny_parry`]. A simulation has one of the two
//! engines for its lifetime.
//!
//! # Bodies
//!
//! A body has any shape of parry, a [`Hull`](lin_canny_parry::single::Hull) or a
//! [`MeshShape`](lin_canny_parry::single::MeshShape), and is fixed, kinematic (it moves at its velocity
//! and nothing pushes it) or dynamic. Friction and restitution are those of the effects unless the
//! body has its own. Poses and velocities can be set between steps. With response,
//! `Simulation::step_with` takes rapier's hooks and event handler, and `Simulation::world_mut` is the
//! way to joints, forces and sensors; its page has a pendulum. `Simulation::deepest_overlap` judges
//! the contacts of either engine.
//!
//! # What each effect is in rapier, and what it costs
//!
//! Milliseconds a step of a pile of 500 hulls of 64 vertices, `f32`, 300 steps, measured before
//! the release with a prototype (rapier 0.36.1); `cargo run --release -p lin-canny-rapier --example
//! effects` measures a scene of its own.
//!
//! | effect | switch of rapier | with | without |
//! |---|---|---|---|
//! | response | another engine | 1.41 | 0.19 (overlaps told), 0.42 (distances), 1.00 (contact points) |
//! | gravity | `gravity` | 1.41 | 0.02: nothing moves, everything sleeps |
//! | rotation | `lock_rotations` | 1.41 | 0.63 |
//! | sleeping | `can_sleep` | 1.41 | 1.57: leaving it out costs |
//! | continuous motion against fixed bodies | `max_ccd_substeps` | 1.41 | 1.24 |
//! | continuous motion of all bodies | `ccd_enabled` | 1.55 | 1.41 |
//! | friction | friction 0 | 1.41 | 3.96: rows are built anyway, and the pile never rests |
//! | Coulomb friction instead of the simplified model | `friction_model` | 1.81 | 1.41 |
//! | restitution | restitution 0 | 1.46 | 1.41: within the noise |
//! | 1, 4, 8 iterations | `num_solver_iterations` | 1.32, 1.41, 2.11 | |
//!
//! **Leaving out friction or restitution saves nothing in rapier.**
//!
//! # What follows from the size of the bodies
//!
//! [`length_unit`](Settings::length_unit) is rapier's `length_unit`: rapier multiplies lengths and speeds by it.
//! Whoever sets `length_unit` by hand **must lift the limit of the speed as well**, or small parts
//! fall too slowly: one of 2 mm by 0.77 m in the first second, not by 4.9 m.
//!
//! ```
//! use lin_canny_rapier::single::rapier::pipeline::PhysicsWorld;
//!
//! let mut world = PhysicsWorld::new();
//! world.integration_parameters.length_unit = 0.002;
//! world.integration_parameters.normalized_max_linear_velocity = f32::MAX; // none
//! ```
//!
//! | quantity of rapier 0.36.1 | of size | here |
//! |---|---|---|
//! | `normalized_max_linear_velocity`, the limit of the speed | 400 sizes a second | none, or [`max_speed`](Settings::max_speed) |
//! | `normalized_prediction_distance`, from which on there are contacts | 0.02 sizes | as rapier has it |
//! | `normalized_allowed_linear_error`, where swept motion stops | 0.005 sizes | as rapier has it |
//! | `normalized_max_corrective_velocity`, at which overlaps and joints are mended | 3 sizes a second | as rapier has it |
//! | `normalized_contact_recycle_distance`, up to which contacts are kept | 0.05 sizes | as rapier has it |
//! | growth of the boxes of the broad phase | 0.04 to 0.25 sizes | constants of rapier |
//! | `normalized_linear_threshold` of a body: half a second below it is sleep | 0.1 sizes a second, as measured | as rapier has it |
//! | `recovery_pace` and the contact load of soft bodies | 0.5 sizes a second; gravity taken as 10 sizes a second squared | as rapier has it: the bridge makes no soft bodies |
//!
//! Sleep is the one that may surprise at large sizes: a body thrown up on the earth is slower than
//! 0.1 sizes a second for half a second if `length_unit` is 24 m or more, and stays there asleep. Leave out
//! [`sleeping`](Effects::sleeping) for those, and where gravity is weak.
//!
//! These do not depend on the size:
//!
//! * The angular velocity is limited to an eighth of a turn a step: 47 radians a second in steps of
//!   1/60 s, 188 in steps of 1/240 s. A part of 2 mm that rolls at 0.2 m/s turns that fast. rapier's
//!   `RigidBody::set_allow_fast_rotation` lifts the limit for a body.
//! * The softness of contacts is a frequency of 30 Hz (60 Hz on fixed bodies) whatever the step is,
//!   so that bodies sag by g / (2 pi 30)^2 = 0.28 mm. Here both frequencies are multiplied by
//!   `1 / (60 time_step)`, which makes shorter steps stiffer.
//! * Inverse masses below 1e-20 are zero: see [`SimulationError::Number`].
//! * Swept motion begins at a speed that follows from the extents of the shape and the step.
//!
//! # bevy_rapier and avian
//!
//! bevy_rapier (0.37.0, read, not built here) has
//! `RapierContextSimulation::with_query_dispatcher` and `set_query_dispatcher`; set the dispatcher
//! in a `Startup` system, as setting it empties the narrow phase, and make colliders of hulls:
//!
//! ```ignore
//! fn certify(mut context: WriteRapierContext) -> Result {
//!     context.single_mut()?.simulation.set_query_dispatcher(CertifiedDispatcher::default());
//!     Ok(())
//! }
//! let collider = Collider::from(SharedShape::from(Hull::from_points(&points)?));
//! ```
//!
//! avian (0.8.0, read, not built here) calls `AnyCollider::contact_manifolds_with_context(&self,
//! other, .., prediction, manifolds, context)` with the manifolds of the last frame and their
//! feature ids: [`CertifiedDispatcher`](lin_canny_parry::single::CertifiedDispatcher) fits as it is, since its contacts
//! depend on pose and kept contacts alone. avian asks parry without any start in every frame, so
//! its gain is larger than rapier's. Its swept motion and spatial queries need parry's colliders.
//! Its broad phase, contact graph, constraint graph and islands are public.
//!
//! rapier's solver cannot be fed from outside: `NarrowPhase::register_pairs`, `compute_contacts`
//! and the island solver are private to rapier 0.36.1. The dispatcher is the way in. rapier's
//! character controller has parry's dispatcher built in: it walks by parry's contacts, and a character
//! or floor of a few centimetres or less has the defects of these in `f32`.
//!
//! # Defects of rapier 0.36.1 that are worked round
//!
//! * Continuous motion asks every fast shape for `mass_properties(1.0)` in every step: a
//!   [`Hull`](lin_canny_parry::single::Hull) computes them once.
//! * `utils::inv` is 0 below 1e-20: the inertia of bodies below 0.1 mm at density 1 would be
//!   infinite. Hulls invert in `f64`.
//! * Inertia tensors of bodies of 10 cm and less at density 1 are wrong by 11 % to 100 %: see
//!   [`lin_canny_parry`].
//! * Snapshots do not hold the dispatcher: set it again after reading one.

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
