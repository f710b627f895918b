//! Serialized form of a shape (feature `serde`): the parameters, checked on deserialization.

use alloc::sync::Arc;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{Core, Shape, ShapeError};
use crate::body::polyhedron::ConvexPolyhedron;

/// Serialized form of a shape.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Shape")]
pub(super) struct StoredShape {
    core: StoredCore,
    round: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "Core")]
enum StoredCore {
    Polyhedron(alloc::boxed::Box<ConvexPolyhedron>),
    Ellipsoid { semi_axes: [f64; 3] },
    Cylinder { half_height: f64, radius: f64 },
    Cone { half_height: f64, radius: f64 },
}

impl From<Shape> for StoredShape {
    fn from(shape: Shape) -> Self {
        let core = match shape.core {
            Core::Polyhedron(body) => StoredCore::Polyhedron(alloc::boxed::Box::new(Arc::unwrap_or_clone(body))),
            Core::Ellipsoid(core) => StoredCore::Ellipsoid {
                semi_axes: core.semi_axes().into(),
            },
            Core::Cylinder(core) => StoredCore::Cylinder {
                half_height: core.half_height(),
                radius: core.radius(),
            },
            Core::Cone(core) => StoredCore::Cone {
                half_height: core.half_height(),
                radius: core.radius(),
            },
        };
        Self {
            core,
            round: shape.rounding,
        }
    }
}

impl TryFrom<StoredShape> for Shape {
    type Error = ShapeError;

    fn try_from(stored: StoredShape) -> Result<Self, ShapeError> {
        let shape = match stored.core {
            StoredCore::Polyhedron(body) => Self::from(*body),
            StoredCore::Ellipsoid { semi_axes } => Self::ellipsoid(Vector3::from(semi_axes))?,
            StoredCore::Cylinder { half_height, radius } => Self::cylinder(half_height, radius)?,
            StoredCore::Cone { half_height, radius } => Self::cone(half_height, radius)?,
        };
        shape.rounded(stored.round)
    }
}
