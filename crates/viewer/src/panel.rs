//! The panel: controls of the source, the outcome of the chosen pair, and the switches of the
//! picture.

use eframe::egui::{self, Color32, RichText};
use lin_canny::Feature;

use crate::app::{Source, Viewer};
use crate::demo;
use crate::player::Player;
use crate::stage::Stage;

/// Draws the panel.
pub(crate) fn panel(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.add_space(6.0);
    let mut open = None;
    match &mut viewer.source {
        Source::Recording(player) => recording(player, &mut viewer.stage, ui),
        Source::Demo(number, demo) => {
            egui::ComboBox::from_id_salt("demo")
                .selected_text(demo::NAMES[*number])
                .width(250.0)
                .show_ui(ui, |ui| {
                    for (k, name) in demo::NAMES.iter().enumerate() {
                        if ui.selectable_label(k == *number, *name).clicked() {
                            open = Some(k);
                        }
                    }
                });
            ui.add_space(4.0);
            demo.panel(ui, &mut viewer.stage);
        }
    }
    if let Some(number) = open {
        // The list has only existing numbers, and tests build their bodies.
        viewer.open_demo(number).unwrap_or_else(|text| viewer.stage.note = text);
    }
    ui.separator();
    answer(viewer, ui);
    ui.separator();
    shown(viewer, ui);
    let [stage, list, commands] = viewer.times.map(|t| t.as_secs_f64() * 1e6);
    let text = format!(
        "{} bodies, {} pairs\nstage {stage:.0} us, list {list:.0} us, draw {commands:.0} us",
        viewer.stage.bodies.len(),
        viewer.stage.pairs.len(),
    );
    ui.label(RichText::new(text).small().color(Color32::GRAY));
}

fn recording(player: &mut Player, stage: &mut Stage, ui: &mut egui::Ui) {
    ui.heading(&player.recording.title);
    let last = player.recording.frames.len().saturating_sub(1);
    let mut frame = player.frame;
    ui.horizontal(|ui| {
        if ui.button(if player.plays { "stop" } else { "play" }).clicked() {
            player.plays = !player.plays;
        }
        if ui.button("-1").clicked() {
            frame = frame.saturating_sub(1);
        }
        if ui.button("+1").clicked() {
            frame = (frame + 1).min(last);
        }
        ui.label(format!("frame {} of {}", player.frame, last + 1));
    });
    ui.spacing_mut().slider_width = 200.0;
    ui.add(egui::Slider::new(&mut frame, 0..=last).show_value(false));
    if frame != player.frame {
        player.plays = false;
        player.show(frame, stage);
    }
    if !stage.note.is_empty() {
        ui.label(&stage.note);
    }
}

fn answer(viewer: &Viewer, ui: &mut egui::Ui) {
    let Some(pair) = viewer.chosen().map(|k| &viewer.stage.pairs[k]) else {
        ui.label("no pair is watched");
        return;
    };
    let names = pair.bodies.map(|k| viewer.stage.bodies[k].name.as_str());
    ui.label(RichText::new(format!("{} - {}", names[0], names[1])).strong());
    let Some(o) = pair.outcome else {
        ui.label("no answer is recorded");
        return;
    };
    egui::Grid::new("numbers").num_columns(2).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(name);
            ui.label(RichText::new(value).monospace());
            ui.end_row();
        };
        row("contact state", o.state.to_string());
        row("distance", number(o.distance));
        row("lower", number(o.lower));
        row("upper", number(o.upper));
        row("between", format!("{:.1e}", o.upper - o.lower));
        row("features", o.features.to_string());
        row("", format!("{} - {}", kind(o.features.a), kind(o.features.b)));
        row("solver", o.solver.to_string());
        row("steps", o.work.steps.to_string());
        if !pair.contacts.is_empty() {
            row("contacts", pair.contacts.len().to_string());
        }
    });
}

/// Formats a number with fixed digits if these are sufficient, otherwise with an exponent.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e6).contains(&x.abs()) {
        format!("{x:.15}")
    } else {
        format!("{x:.12e}")
    }
}

fn kind(feature: Feature) -> &'static str {
    match feature {
        Feature::Vertex(_) => "vertex",
        Feature::Edge(_) => "edge",
        Feature::Face(_) => "face",
    }
}

fn shown(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let show = &mut viewer.show;
    egui::Grid::new("show").num_columns(2).show(ui, |ui| {
        let boxes = [
            (&mut show.witnesses, "closest points"),
            (&mut show.all, "all pairs"),
            (&mut show.regions, "Voronoi regions"),
            (&mut show.contacts, "contacts"),
            (&mut show.names, "names"),
            (&mut show.boxes, "boxes"),
            (&mut show.columns, "columns"),
            (&mut show.brackets, "brackets"),
            (&mut show.paths, "paths"),
        ];
        for (k, (flag, name)) in boxes.into_iter().enumerate() {
            ui.checkbox(flag, name);
            if k % 2 == 1 {
                ui.end_row();
            }
        }
    });
    if ui.button("look at all").clicked() {
        viewer.look_at_all();
    }
    ui.label(
        RichText::new("Drag a body, or the background to look around. Wheel: nearer; right button: shift.").small(),
    );
}
