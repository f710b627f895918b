//! The demonstrations of the page: cost of accuracy, hard cases, queries of a scene, a robot in its
//! cell.

mod accuracy;
mod hard;
mod queries;
mod robot;

use eframe::egui;

use crate::stage::Stage;

/// Names of the demonstrations, by number.
pub const NAMES: [&str; 4] = [
    "What accuracy costs in time",
    "Hard cases that stay stable",
    "Only the enabled queries",
    "A robot in its cell",
];

/// A demonstration whose bodies are on the stage.
pub trait Demo {
    /// Advances by a frame; returns whether the next frame is due at once.
    fn frame(&mut self, stage: &mut Stage) -> bool;

    /// Draws its part of the panel.
    fn panel(&mut self, ui: &mut egui::Ui, stage: &mut Stage);

    /// Returns whether only the closest pair is drawn.
    fn shows_closest_only(&self) -> bool {
        false
    }

    /// Returns whether the mouse may drag a body.
    fn may_hold(&self, body: usize) -> bool;
}

/// Opens a demonstration on an empty stage.
///
/// # Errors
/// Returns an error if the number does not exist or the bodies cannot be built.
pub fn open(number: usize, stage: &mut Stage) -> Result<Box<dyn Demo>, String> {
    let say = |e: Box<dyn std::error::Error>| e.to_string();
    Ok(match number {
        0 => Box::new(accuracy::Accuracy::new(stage).map_err(say)?),
        1 => Box::new(hard::Hard::new(stage).map_err(say)?),
        2 => Box::new(queries::Pile::new(stage).map_err(say)?),
        3 => Box::new(robot::Robot::new(stage).map_err(say)?),
        _ => {
            return Err(format!(
                "demonstration {number} does not exist (expected 0..{})",
                NAMES.len()
            ));
        }
    })
}

/// Draws a bar on a logarithmic scale, with its text.
fn bar(ui: &mut egui::Ui, name: &str, text: &str, part: f64, colour: egui::Color32) {
    ui.label(format!("{name}: {text}"));
    let (rect, _) = ui.allocate_exact_size(egui::vec2(250.0, 10.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, egui::Color32::from_gray(225));
    let mut filled = rect;
    filled.set_width(rect.width() * part.clamp(0.0, 1.0) as f32);
    ui.painter().rect_filled(filled, 2.0, colour);
}

/// Returns the position of a value between two powers of ten, on a logarithmic scale.
fn log_part(x: f64, from: f64, to: f64) -> f64 {
    if x > 0.0 { (x.log10() - from) / (to - from) } else { 0.0 }
}
