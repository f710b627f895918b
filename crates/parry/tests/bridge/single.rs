//! The promises on `lin_canny_parry::single`.

use lin_canny_parry::single as engine;

#[path = "promises.rs"]
mod promises;
