//! Promise: the source, the README and the lock files are consistent.

mod errors;
mod figures;
mod layering;
mod links;
mod locks;
mod manifests;
mod options;
mod pages;
mod readme;
mod terms;
mod unsafe_code;

use std::path::Path;

/// Returns the checkout.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a checkout")
}
