//! Shows pairs, scenes and robots with their closest features in a window, in pictures without a
//! display, and on a web page.
//!
//! - `stage`, `lit`, `player` and `bits` are independent of graphics.
//! - `camera` and `draw` are plain arithmetic.
//! - `gpu` draws a stage into a texture.
//! - `app` has the panel, the mouse and the picture in egui.
//! - `demo` has the demonstrations of the page.

pub mod app;
pub mod bits;
pub mod camera;
pub mod demo;
pub mod draw;
pub mod gpu;
#[cfg(not(target_arch = "wasm32"))]
pub mod headless;
pub mod lit;
mod panel;
mod pipelines;
pub mod player;
pub mod stage;
#[cfg(target_arch = "wasm32")]
mod web;
