//! The promises on `lin_canny_parry::single`.

use lin_canny_parry::single as engine;

#[path = "casts.rs"]
mod casts;
#[path = "closed_forms.rs"]
mod closed_forms;
#[path = "decomposition.rs"]
mod decomposition;
#[path = "dispatch.rs"]
mod dispatch;
#[path = "hulls.rs"]
mod hulls;
#[path = "manifolds.rs"]
mod manifolds;
#[path = "meshes.rs"]
mod meshes;
#[path = "numbers.rs"]
mod numbers;
