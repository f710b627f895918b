//! The promises on `lin_canny_rapier::single`.

use lin_canny_rapier::single as engine;

#[path = "promises.rs"]
mod promises;
