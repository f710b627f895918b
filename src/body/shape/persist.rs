//! Serialized form of a shape (feature `serde`): the parameters, checked on deserialization.

use alloc::boxed::Box;
use alloc::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Core, Shape, ShapeError, with_curved_kinds};
use crate::body::polyhedron::ConvexPolyhedron;

/// Serialized form of a shape.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Shape")]
pub(super) struct StoredShape {
    core: StoredCore,
    round: f64,
}

macro_rules! stored {
    ($($kind:ident),*) => {
        #[derive(Serialize, Deserialize)]
        #[serde(rename = "Core")]
        enum StoredCore {
            Polyhedron(Box<ConvexPolyhedron>),
            $($kind(super::$kind),)*
        }

        impl From<Core> for StoredCore {
            fn from(core: Core) -> Self {
                match core {
                    Core::Polyhedron(body) => Self::Polyhedron(Box::new(Arc::unwrap_or_clone(body))),
                    $(Core::$kind(core) => Self::$kind(core),)*
                }
            }
        }

        impl From<StoredCore> for Core {
            fn from(stored: StoredCore) -> Self {
                match stored {
                    StoredCore::Polyhedron(body) => Self::Polyhedron(Arc::new(*body)),
                    $(StoredCore::$kind(core) => Self::$kind(core),)*
                }
            }
        }
    };
}

with_curved_kinds!(stored);

impl From<Shape> for StoredShape {
    fn from(shape: Shape) -> Self {
        Self {
            round: shape.rounding,
            core: shape.core.into(),
        }
    }
}

impl TryFrom<StoredShape> for Shape {
    type Error = ShapeError;

    fn try_from(stored: StoredShape) -> Result<Self, ShapeError> {
        Self::sharp(stored.core.into()).rounded(stored.round)
    }
}
