//! The promises on `lin_canny_rapier::double`.

use lin_canny_rapier::double as engine;

#[path = "promises.rs"]
mod promises;
