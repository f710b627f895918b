//! The shapes, queries and dispatcher, written once for both precisions of parry.
//!
//! The crate compiles this folder twice: in `single` with `parry3d`, in `double` with `parry3d-f64`.
//! All files name parry by `super::parry`, and its numbers by `Real`.

use super::parry;

mod cast;
mod contact;
mod convex;
mod curved;
mod decomposition;
mod dispatcher;
mod far;
mod guard;
mod half_space;
mod hull;
mod hull_shape;
mod known;
mod manifold;
mod mass;
mod mesh;
mod mesh_shape;
mod number;
mod part;
mod ray_point;
mod surface;

pub use contact::ContactOptions;
pub use decomposition::{DecompositionError, decompose};
pub use dispatcher::CertifiedDispatcher;
pub use hull::{Conversion, Hull, HullError};
pub use mesh::geometry;
pub use mesh_shape::MeshShape;
pub use number::{isometry, pose};
