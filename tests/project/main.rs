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

/// Returns the text of a file of the repository.
pub(crate) fn read(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Returns the checkout.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a checkout")
}
