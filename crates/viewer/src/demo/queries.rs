//! A pile of swinging bodies: enable the queries of a scene one by one and see their cost.

use std::error::Error;

use eframe::egui::{self, Color32};
use lin_canny::ManifoldOptions;
use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene, StepWork};
use lin_canny_record::Contact;
use web_time::Instant;

use super::{Demo, bar, log_part};
use crate::stage::{Pair, Stage};

/// Bodies along a side of the pile, and layers.
const SIDE: usize = 5;
const LAYERS: usize = 4;
const NAMES: [&str; 6] = [
    "who overlaps",
    "who is within 0.1",
    "distance up to 0.3",
    "closest points and features",
    "depth of overlaps",
    "contact points",
];
/// Fraction of the old mean that a step keeps.
const KEEP: f64 = 0.95;

pub(super) struct Pile {
    scene: Scene,
    ids: Vec<BodyId>,
    on: [bool; 6],
    runs: bool,
    time: f64,
    /// Mean microseconds of the whole step, then of boxes, pairs, narrow phase and events. A scene
    /// on a page has no clock, so the last four stay zero there.
    stages: [f64; 5],
    counts: StepWork,
}

impl Pile {
    pub(super) fn new(stage: &mut Stage) -> Result<Self, Box<dyn Error>> {
        let mut scene = Scene::new();
        let mut ids = Vec::new();
        let shapes = (0..6u64)
            .map(|k| solids::random_hull(24, Vector3::new(0.5, 0.45, 0.4), k + 1))
            .collect::<Result<Vec<_>, _>>()?;
        let geometries: Vec<usize> = shapes.into_iter().map(|shape| stage.geometry(shape)).collect();
        for k in 0..SIDE * SIDE * LAYERS {
            let geometry = geometries[k % geometries.len()];
            let pose = pose(k, 0.0);
            let body = Body::moving(stage.geometries[geometry].clone());
            ids.push(scene.insert(body.user_data(k as u64), pose)?);
            stage.body(format!("body {k}"), geometry, pose);
        }
        let mut pile = Self {
            scene,
            ids,
            on: [false; 6],
            runs: true,
            time: 0.0,
            stages: [0.0; 5],
            counts: StepWork::default(),
        };
        pile.call()?;
        Ok(pile)
    }

    fn call(&mut self) -> Result<(), Box<dyn Error>> {
        let [overlap, within, distance, features, depth, contacts] = self.on;
        let mut queries = PairQueries::none().boxes(true).overlap(overlap);
        if within {
            queries = queries.within(0.1);
        }
        if distance || features || depth {
            queries = queries.distance(0.3).features(features).depth(depth);
        }
        if contacts {
            queries = queries.manifold(ManifoldOptions::with_prediction(0.05));
        }
        Ok(self.scene.set_queries(Group::default(), Group::default(), queries)?)
    }

    fn step(&mut self, stage: &mut Stage) -> Result<(), Box<dyn Error>> {
        for (k, id) in self.ids.iter().enumerate() {
            stage.bodies[k].pose = pose(k, self.time);
            self.scene.set_pose(*id, stage.bodies[k].pose)?;
        }
        let start = Instant::now();
        let report = self.scene.step();
        let times = [
            start.elapsed(),
            report.times.boxes,
            report.times.pairs,
            report.times.look,
            report.times.events,
        ];
        for (mean, time) in self.stages.iter_mut().zip(times) {
            *mean = KEEP * *mean + (1.0 - KEEP) * 1e6 * time.as_secs_f64();
        }
        self.counts = report.counts;
        self.watch(stage);
        Ok(())
    }

    fn watch(&self, stage: &mut Stage) {
        stage.pairs.clear();
        let number = |id| self.scene.user_data(id).unwrap_or_default() as usize;
        for pair in self.scene.pairs() {
            let mut watched = Pair::of(number(pair.a), number(pair.b));
            watched.outcome = pair.outcome.copied();
            let [a, b] = watched.bodies.map(|k| stage.bodies[k].pose);
            if let Some(manifold) = pair.manifold {
                let normal = a * manifold.normal().into_inner();
                watched.contacts.extend(manifold.points().iter().map(|p| Contact {
                    name: String::new(),
                    on_a: a * p.point_on_a,
                    on_b: b * p.point_on_b,
                    normal,
                    separation: p.separation,
                }));
            }
            if watched.outcome.is_some() || !watched.contacts.is_empty() {
                stage.pairs.push(watched);
            }
        }
    }
}

impl Demo for Pile {
    fn frame(&mut self, stage: &mut Stage) -> bool {
        if self.runs {
            self.time += 1.0 / 60.0;
            if let Err(trouble) = self.step(stage) {
                stage.note = trouble.to_string();
                self.runs = false;
            }
        }
        self.runs
    }

    fn panel(&mut self, ui: &mut egui::Ui, stage: &mut Stage) {
        ui.label(format!("{} bodies swing. Called for:", self.ids.len()));
        let before = self.on;
        for (flag, name) in self.on.iter_mut().zip(NAMES) {
            ui.checkbox(flag, name);
        }
        if before != self.on
            && let Err(trouble) = self.call()
        {
            stage.note = trouble.to_string();
        }
        ui.checkbox(&mut self.runs, "run");
        ui.strong("a step, microseconds");
        let names = ["whole step", "boxes", "pairs", "narrow phase", "events"];
        for (name, mean) in names.into_iter().zip(self.stages).filter(|(_, mean)| *mean > 0.0) {
            let colour = Color32::from_rgb(86, 140, 200);
            bar(ui, name, &format!("{mean:.1}"), log_part(mean, -1.0, 4.0), colour);
        }
        let c = &self.counts;
        ui.label(format!(
            "{} pairs of boxes, {} active, {} skipped by the budget; {} queries, {} depths, {} manifolds",
            c.pairs, c.active, c.skipped, c.queries, c.depths, c.manifolds
        ));
        if !stage.note.is_empty() {
            ui.colored_label(Color32::RED, &stage.note);
        }
    }

    fn may_hold(&self, _: usize) -> bool {
        false
    }
}

/// Returns the pose of a body of the pile at a time.
fn pose(k: usize, time: f64) -> Isometry3<f64> {
    let cell = [k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE].map(|i| i as f64);
    let phase = k as f64 * 2.4;
    let swing = |rate: f64| 0.06 * (rate * time + phase).sin();
    let middle = 0.5 * (SIDE as f64 - 1.0);
    let place = Translation3::new(
        0.86 * (cell[0] - middle) + swing(1.1),
        0.80 * (cell[1] - middle) + swing(0.9),
        0.74 * cell[2] + swing(1.3),
    );
    let turn = UnitQuaternion::from_euler_angles(phase + 0.2 * time, 0.7 * phase, 0.3 * time);
    Isometry3::from_parts(place, turn)
}
