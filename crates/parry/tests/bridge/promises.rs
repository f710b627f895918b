//! The promises, in one precision.

use super::engine;

mod casts;
mod closed_forms;
mod decomposition;
mod dispatch;
mod hulls;
mod manifolds;
mod meshes;
mod numbers;
