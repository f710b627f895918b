//! A six-axis arm in a cell that fits it, with sliders for its joints.

use std::error::Error;

use eframe::egui;
use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, Shape};
use lin_canny_plan::{Joint, JointTree};

use super::Demo;
use crate::stage::{Pair, Stage};

const Y: Unit<Vector3<f64>> = Unit::new_unchecked(Vector3::new(0.0, 1.0, 0.0));
const Z: Unit<Vector3<f64>> = Unit::new_unchecked(Vector3::new(0.0, 0.0, 1.0));

/// Name, height above the previous joint in metres, axis, and limit on both sides in radians.
const JOINTS: [(&str, f64, Unit<Vector3<f64>>, f64); 6] = [
    ("base", 0.12, Z, 2.9),
    ("shoulder", 0.20, Y, 1.8),
    ("elbow", 0.45, Y, 2.6),
    ("wrist 1", 0.40, Z, 2.9),
    ("wrist 2", 0.15, Y, 2.2),
    ("wrist 3", 0.11, Z, 2.9),
];

pub(super) struct Robot {
    arm: JointTree,
    links: Vec<usize>,
    joints: [f64; 6],
}

impl Robot {
    pub(super) fn new(stage: &mut Stage) -> Result<Self, Box<dyn Error>> {
        let mut links = Vec::new();
        for (name, link, shape) in links_of_arm()? {
            let geometry = stage.geometry(shape);
            let body = stage.body(name, geometry, Isometry3::identity());
            stage.bodies[body].colour = if link % 2 == 0 {
                [222, 150, 60, 255]
            } else {
                [205, 175, 120, 255]
            };
            links.push(link);
        }
        for (name, half, at) in CELL {
            let geometry = stage.geometry(solids::cuboid(Vector3::from(half))?);
            let [x, y, z] = at;
            let body = stage.body(name, geometry, Isometry3::translation(x, y, z));
            stage.bodies[body].colour = [125, 150, 180, 255];
        }
        for b in 0..stage.bodies.len() {
            // Links that one or two joints connect touch by design; base and shoulder are next to
            // the table.
            let is_table = b == links.len();
            let far = |a: usize| match links.get(b) {
                Some(link) => *link > links[a] + 2,
                None => !is_table || links[a] > 1,
            };
            let pairs = (0..links.len().min(b)).filter(|a| far(*a)).map(|a| Pair::of(a, b));
            stage.pairs.extend(pairs);
        }
        let joint = |(_, height, axis, limit): (&str, f64, Unit<Vector3<f64>>, f64)| {
            Joint::revolute(Isometry3::translation(0.0, 0.0, height), axis, [-limit, limit])
        };
        let arm = JointTree::serial(Isometry3::identity(), JOINTS.map(joint).into(), links.clone(), 0.15)?;
        let joints = [0.25, 0.75, 1.25, 0.3, 0.85, 0.0];
        let mut robot = Self { arm, links, joints };
        robot.put(stage)?;
        Ok(robot)
    }

    fn put(&mut self, stage: &mut Stage) -> Result<(), Box<dyn Error>> {
        for (body, link) in self.links.iter().enumerate() {
            stage.bodies[body].pose = self.arm.link_pose(&self.joints, *link)?;
        }
        stage.measure_all();
        Ok(())
    }
}

/// Name, half sizes and position of each obstacle of the cell, in metres.
const CELL: [(&str, [f64; 3], [f64; 3]); 8] = [
    ("table", [0.65, 0.75, 0.02], [0.40, 0.0, -0.02]),
    ("fence", [0.22, 0.01, 0.10], [0.62, 0.0, 0.10]),
    ("post", [0.035, 0.035, 0.45], [0.20, 0.68, 0.45]),
    ("lamp", [0.03, 0.55, 0.03], [0.10, 0.0, 1.25]),
    ("bin", [0.01, 0.17, 0.07], [0.41, -0.38, 0.07]),
    ("bin", [0.01, 0.17, 0.07], [0.69, -0.38, 0.07]),
    ("bin", [0.13, 0.01, 0.07], [0.55, -0.54, 0.07]),
    ("bin", [0.13, 0.01, 0.07], [0.55, -0.22, 0.07]),
];

type Link = (&'static str, usize, Geometry);

/// Returns name, link and shape of each body of the arm.
fn links_of_arm() -> Result<Vec<Link>, Box<dyn Error>> {
    let tube = |name, link: usize, radius: f64, length: f64, height: f64| {
        let solid = solids::prism(32, 0.5 * length, radius)?;
        Ok::<Link, Box<dyn Error>>((
            name,
            link,
            solid.transformed(&Isometry3::translation(0.0, 0.0, height))?.into(),
        ))
    };
    let block = |name, link: usize, [x, y, z]: [f64; 3], height: f64, round: f64| {
        let half = Vector3::new(0.5 * x - round, 0.5 * y - round, 0.5 * z - round);
        let solid = solids::cuboid(half)?.transformed(&Isometry3::translation(0.0, 0.0, height))?;
        Ok::<Link, Box<dyn Error>>((name, link, Shape::from(solid).rounded(round)?.into()))
    };
    Ok(vec![
        tube("base", 0, 0.10, 0.12, 0.06)?,
        tube("shoulder", 1, 0.085, 0.20, 0.10)?,
        block("upper arm", 2, [0.11, 0.13, 0.56], 0.225, 0.03)?,
        block("forearm", 3, [0.09, 0.10, 0.42], 0.19, 0.025)?,
        tube("wrist 1", 4, 0.045, 0.14, 0.07)?,
        tube("wrist 2", 5, 0.040, 0.13, 0.05)?,
        block("gripper", 6, [0.05, 0.14, 0.07], 0.04, 0.01)?,
    ])
}

impl Demo for Robot {
    fn frame(&mut self, _: &mut Stage) -> bool {
        false
    }

    fn panel(&mut self, ui: &mut egui::Ui, stage: &mut Stage) {
        let before = self.joints;
        for ((name, .., limit), value) in JOINTS.iter().zip(&mut self.joints) {
            ui.add(egui::Slider::new(value, -limit..=*limit).text(*name));
        }
        if before != self.joints
            && let Err(trouble) = self.put(stage)
        {
            stage.note = trouble.to_string();
        }
        ui.label("The closest pair of the arm with the cell and with itself is named below. Angles in radians.");
    }

    fn shows_closest_only(&self) -> bool {
        true
    }

    fn may_hold(&self, body: usize) -> bool {
        body >= self.links.len()
    }
}
