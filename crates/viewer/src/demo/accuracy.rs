//! Two hulls to drag: time and error of the walk alone, certified and exact queries.

use std::error::Error;

use eframe::egui::{self, Color32};
use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker};
use web_time::Instant;

use super::{Demo, bar, log_part};
use crate::stage::{Pair, Stage};

const LEVELS: [&str; 3] = ["walk alone", "certified", "exact"];
const COLOURS: [Color32; 3] = [
    Color32::from_rgb(86, 140, 200),
    Color32::from_rgb(222, 150, 60),
    Color32::from_rgb(130, 175, 110),
];
/// Queries of each level per frame.
const QUERIES: [u32; 3] = [60, 60, 20];
/// Rotation of the body between two queries, in degrees.
const TURN: f64 = 0.5;
/// Fraction of the old mean that a frame keeps.
const KEEP: f64 = 0.95;

pub(super) struct Accuracy {
    level: usize,
    bodies: [ConvexPolyhedron; 2],
    trackers: [Tracker; 3],
    /// Decaying sums of seconds and of queries. Their quotient is shown, because the clock of a
    /// page is coarse.
    sums: [[f64; 2]; 3],
    errors: [f64; 3],
    turned: u64,
}

impl Accuracy {
    pub(super) fn new(stage: &mut Stage) -> Result<Self, Box<dyn Error>> {
        let bodies = [
            solids::random_hull(28, Vector3::new(1.0, 0.8, 0.7), 7)?,
            solids::random_hull(20, Vector3::new(0.6, 0.7, 0.5), 11)?,
        ];
        let pose = Isometry3::from_parts(
            Translation3::new(1.7, 0.35, 0.3),
            UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5),
        );
        for (body, (name, pose)) in bodies.iter().zip([("still", Isometry3::identity()), ("to drag", pose)]) {
            let geometry = stage.geometry(body.clone());
            stage.body(name, geometry, pose);
        }
        stage.pairs.push(Pair::of(0, 1));
        stage.measure_all();
        Ok(Self {
            level: 1,
            bodies,
            trackers: Default::default(),
            sums: [[0.0; 2]; 3],
            errors: [0.0; 3],
            turned: 0,
        })
    }

    /// Times queries of one level while the pair rotates to and fro in small steps.
    fn time(&mut self, level: usize, stage: &Stage) {
        let [a, b] = &self.bodies;
        let tracker = &mut self.trackers[level];
        let mut poses = Vec::new();
        for k in 0..QUERIES[level] {
            let angle = (f64::from(k % 20) - 10.0).abs() * TURN.to_radians();
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            let pose = Isometry3::from_parts(stage.bodies[1].pose.translation, stage.bodies[1].pose.rotation * turn);
            poses.extend(RelativePose::new_normalized(&stage.bodies[0].pose, &pose).ok());
        }
        let start = Instant::now();
        for pose in &poses {
            match level {
                0 => std::hint::black_box(tracker.propose(a, b, pose).distance.is_some()),
                1 => std::hint::black_box(tracker.closest(a, b, pose).lower > 0.0),
                _ => std::hint::black_box(tracker.closest_exact(a, b, pose).lower > 0.0),
            };
        }
        let [seconds, queries] = &mut self.sums[level];
        *seconds = KEEP * *seconds + start.elapsed().as_secs_f64();
        *queries = KEEP * *queries + poses.len() as f64;
    }

    /// Computes errors against the exact outcome, and shows the outcome of the selected level.
    fn answer(&mut self, stage: &mut Stage) {
        let [a, b] = &self.bodies;
        let Ok(poses) = RelativePose::new_normalized(&stage.bodies[0].pose, &stage.bodies[1].pose) else {
            return;
        };
        let exact = self.trackers[2].closest_exact(a, b, &poses);
        let certified = self.trackers[1].closest(a, b, &poses);
        let walk = self.trackers[0].propose(a, b, &poses);
        let walked = walk.distance.unwrap_or(0.0);
        let told = if exact.distance > 0.0 { walked } else { exact.distance };
        self.errors = [
            (told - exact.distance).abs(),
            certified.upper - certified.lower,
            exact.upper - exact.lower,
        ];
        stage.pairs[0].outcome = Some(if self.level == 2 { exact } else { certified });
    }
}

impl Demo for Accuracy {
    fn frame(&mut self, stage: &mut Stage) -> bool {
        self.answer(stage);
        self.time((self.turned % 3) as usize, stage);
        self.turned += 1;
        true
    }

    fn panel(&mut self, ui: &mut egui::Ui, _: &mut Stage) {
        ui.label("Drag the orange body. Each level is asked about the pair as it turns by half a degree.");
        ui.horizontal(|ui| {
            for (k, name) in LEVELS.iter().enumerate() {
                ui.radio_value(&mut self.level, k, *name);
            }
        });
        ui.add_space(4.0);
        ui.strong("time of a query");
        for k in 0..3 {
            let [seconds, queries] = self.sums[k];
            let ns = if queries > 0.0 { 1e9 * seconds / queries } else { 0.0 };
            bar(
                ui,
                LEVELS[k],
                &format!("{ns:.0} ns"),
                log_part(ns, 1.0, 5.0),
                COLOURS[k],
            );
        }
        ui.add_space(4.0);
        ui.strong("error of the distance");
        for k in 0..3 {
            let what = if k == 0 { "unproven" } else { "proven" };
            let text = format!("{:.1e}, {what}", self.errors[k]);
            bar(ui, LEVELS[k], &text, log_part(self.errors[k], -17.0, -9.0), COLOURS[k]);
        }
    }

    fn may_hold(&self, body: usize) -> bool {
        body == 1
    }
}
