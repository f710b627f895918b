//! Shows pairs, scenes and robots with their closest features: one source for a window, for
//! pictures without a display, and for a web page.
//!
//! `stage`, `lit`, `player` and `bits` know nothing of graphics; `camera` and `draw` are
//! plain arithmetic; `gpu` draws a stage into a texture; `app` is panel, mouse and the picture in
//! egui; `demo` holds what the page shows.

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
