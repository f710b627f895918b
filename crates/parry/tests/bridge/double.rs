//! The promises on `lin_canny_parry::double`.

use lin_canny_parry::double as engine;

#[path = "promises.rs"]
mod promises;
