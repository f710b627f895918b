//! Shape and dispatcher for `parry3d_f64`, in `f64`.

pub use parry3d_f64 as parry;

#[path = "bridge/cast.rs"]
mod cast;
#[path = "bridge/curved.rs"]
mod curved;
#[path = "bridge/decomposition.rs"]
mod decomposition;
#[path = "bridge/dispatcher.rs"]
mod dispatcher;
#[path = "bridge/far.rs"]
mod far;
#[path = "bridge/guard.rs"]
mod guard;
#[path = "bridge/half_space.rs"]
mod half_space;
#[path = "bridge/hull.rs"]
mod hull;
#[path = "bridge/hull_shape.rs"]
mod hull_shape;
#[path = "bridge/known.rs"]
mod known;
#[path = "bridge/manifold.rs"]
mod manifold;
#[path = "bridge/mass.rs"]
mod mass;
#[path = "bridge/mesh.rs"]
mod mesh;
#[path = "bridge/mesh_shape.rs"]
mod mesh_shape;
#[path = "bridge/number.rs"]
mod number;
#[path = "bridge/part.rs"]
mod part;
#[path = "bridge/ray_point.rs"]
mod ray_point;
#[path = "bridge/surface.rs"]
mod surface;

pub use decomposition::{DecompositionError, decompose};
pub use dispatcher::{Certified, ContactOptions};
pub use hull::{Conversion, Hull, HullError};
pub use mesh::{MeshShape, geometry};
pub use number::{isometry, pose};
