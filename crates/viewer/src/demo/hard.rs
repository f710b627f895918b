//! Named hard cases: nudge a body by units in the last place, watch state and bounds, and compare
//! with parry's recorded answer.

use std::error::Error;

use eframe::egui::{self, Color32, RichText};
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny_record::poses;
use serde::Deserialize;

use super::Demo;
use crate::panel::number;
use crate::stage::{Body, PALETTE, Pair, Stage};

/// Written by `cargo run --release -p race --bin hard_cases -- --out crates/viewer/cases.json`.
const CASES: &str = include_str!("../../cases.json");

#[derive(Deserialize)]
struct Case {
    name: String,
    family: String,
    a: Vec<[f64; 3]>,
    b: Vec<[f64; 3]>,
    pose_a: [f64; 7],
    pose_b: [f64; 7],
    #[serde(rename = "class")]
    state: String,
    distance: f64,
    parry: Option<f64>,
}

pub(super) struct Hard {
    cases: Vec<Case>,
    chosen: usize,
    /// Units in the last place by which the second body is moved along each axis.
    ulps: [i32; 3],
    moved: bool,
}

impl Hard {
    pub(super) fn new(stage: &mut Stage) -> Result<Self, Box<dyn Error>> {
        let cases: Vec<Case> = serde_json::from_str(CASES)?;
        for (k, case) in cases.iter().enumerate() {
            for (points, numbers) in [(&case.a, case.pose_a), (&case.b, case.pose_b)] {
                let points: Vec<Point3<f64>> = points.iter().copied().map(Point3::from).collect();
                let geometry = stage.geometry(ConvexPolyhedron::from_points(&points)?);
                let pose = poses::pose(numbers).ok_or_else(|| format!("{}: invalid pose: {numbers:?}", case.name))?;
                stage.bodies.push(Body {
                    name: if geometry.is_multiple_of(2) { "A" } else { "B" }.into(),
                    geometry,
                    pose,
                    shown: k == 0,
                    colour: PALETTE[geometry % 2],
                });
            }
        }
        let mut hard = Self {
            cases,
            chosen: 0,
            ulps: [0; 3],
            moved: false,
        };
        hard.show(0, stage);
        Ok(hard)
    }

    fn show(&mut self, chosen: usize, stage: &mut Stage) {
        self.chosen = chosen;
        self.ulps = [0; 3];
        self.moved = false;
        for (k, body) in stage.bodies.iter_mut().enumerate() {
            body.shown = k / 2 == chosen;
        }
        stage.pairs = vec![Pair::of(2 * chosen, 2 * chosen + 1)];
        self.put(stage);
    }

    /// Puts the second body at its pose, nudged.
    fn put(&self, stage: &mut Stage) {
        let case = &self.cases[self.chosen];
        if let Some(mut pose) = poses::pose(case.pose_b) {
            for (x, ulps) in pose.translation.vector.iter_mut().zip(self.ulps) {
                *x = nudged(*x, ulps);
            }
            stage.bodies[2 * self.chosen + 1].pose = pose;
        }
        stage.measure(0);
    }

    fn truth(&self, ui: &mut egui::Ui, stage: &Stage) {
        let case = &self.cases[self.chosen];
        egui::Grid::new("truth").num_columns(2).show(ui, |ui| {
            let mut row = |name: &str, text: String, colour: Color32| {
                ui.label(name);
                ui.label(RichText::new(text).monospace().color(colour));
                ui.end_row();
            };
            row("true contact state", case.state.clone(), Color32::DARK_GREEN);
            row("true distance", number(case.distance), Color32::DARK_GREEN);
            let right = |d: f64| (d - case.distance).abs() <= 1e-9 * case.distance.abs() + 1e-12;
            let colour = if case.parry.is_some_and(right) {
                Color32::DARK_GREEN
            } else {
                Color32::RED
            };
            let text = case.parry.map_or("no answer".into(), number);
            row("parry f64", text, colour);
            if let Some(o) = stage.pairs[0].outcome.filter(|_| !self.moved && self.ulps == [0; 3]) {
                let holds = o.lower <= case.distance && case.distance <= o.upper;
                let colour = if holds { Color32::DARK_GREEN } else { Color32::RED };
                row("bounds hold", if holds { "yes" } else { "no" }.into(), colour);
            }
        });
    }
}

impl Demo for Hard {
    fn frame(&mut self, stage: &mut Stage) -> bool {
        let at = |body: &Body, numbers: [f64; 7]| {
            poses::pose(numbers).is_none_or(|p: Isometry3<f64>| {
                (p.translation.vector - body.pose.translation.vector).norm() <= 1e-6 * p.translation.vector.norm()
            })
        };
        let case = &self.cases[self.chosen];
        let [a, b] = [0, 1].map(|k| &stage.bodies[2 * self.chosen + k]);
        self.moved = !(at(a, case.pose_a) && at(b, case.pose_b));
        false
    }

    fn panel(&mut self, ui: &mut egui::Ui, stage: &mut Stage) {
        let mut chosen = self.chosen;
        let name = |case: &Case| format!("{}: {}", case.family, case.name);
        egui::ComboBox::from_id_salt("case")
            .selected_text(name(&self.cases[chosen]))
            .width(250.0)
            .show_ui(ui, |ui| {
                for (k, case) in self.cases.iter().enumerate() {
                    ui.selectable_value(&mut chosen, k, name(case));
                }
            });
        if chosen != self.chosen {
            self.show(chosen, stage);
        }
        self.truth(ui, stage);
        ui.label("Nudge body B by units in the last place:");
        let mut ulps = self.ulps;
        ui.horizontal(|ui| {
            for (axis, count) in ["x", "y", "z"].into_iter().zip(&mut ulps) {
                *count -= i32::from(ui.small_button("-").clicked());
                ui.monospace(format!("{axis}{count:+}"));
                *count += i32::from(ui.small_button("+").clicked());
            }
        });
        if ulps != self.ulps {
            self.ulps = ulps;
            self.put(stage);
        }
    }

    fn may_hold(&self, body: usize) -> bool {
        body == 2 * self.chosen + 1
    }
}

/// Returns a number moved by units in its last place.
fn nudged(x: f64, ulps: i32) -> f64 {
    let step = if ulps > 0 { f64::next_up } else { f64::next_down };
    (0..ulps.unsigned_abs()).fold(x, |x, _| step(x))
}
