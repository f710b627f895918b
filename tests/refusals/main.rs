//! Promise: invalid poses and calls of a scene are rejected with a named error. These tests need no
//! other crate of the checkout.

mod poses;
mod scenes;
