//! The promises on `lin_canny_parry::double`.

use lin_canny_parry::double as engine;

#[path = "decomposition.rs"]
mod decomposition;
#[path = "dispatch.rs"]
mod dispatch;
#[path = "hulls.rs"]
mod hulls;
