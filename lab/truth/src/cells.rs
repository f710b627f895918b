//! A robot cell made of meshes: an arm of six axes with turned links, a table, two trays, posts and
//! a wall.

use crate::forms::mesh;
use lin_canny_plan::{Cell, Joint, JointTree};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::rng::Rng;
use crate::soups::{self, Soup};
use crate::turned;

/// For each joint: height above the previous link, whether the axis is z (otherwise y), and the
/// limit on both sides.
const JOINTS: [(f64, bool, f64); 6] = [
    (0.12, true, 2.9),
    (0.20, false, 1.8),
    (0.45, false, 2.6),
    (0.40, true, 2.9),
    (0.15, false, 2.2),
    (0.11, true, 2.9),
];

/// Radius, lower and upper end of each link, along z of its frame.
const LINKS: [[f64; 3]; 7] = [
    [0.10, 0.0, 0.115],
    [0.085, 0.005, 0.26],
    [0.07, -0.05, 0.50],
    [0.055, -0.05, 0.39],
    [0.045, 0.005, 0.19],
    [0.04, -0.04, 0.10],
    [0.05, 0.01, 0.13],
];

/// A robot and its surroundings.
pub struct ArmCell {
    /// The links, one body each.
    pub links: Vec<Soup>,
    /// The obstacles.
    pub obstacles: Vec<(Soup, Isometry3<f64>)>,
}

/// Returns a link with collars and a waist: `12 n` triangles.
fn link(n: usize, [r, low, high]: [f64; 3]) -> Soup {
    let step = 0.1 * (high - low);
    let profile = [
        [0.9 * r, low],
        [r, low + 0.1 * r],
        [r, low + 2.0 * step],
        [0.8 * r, low + 3.0 * step],
        [0.8 * r, high - step],
        [0.9 * r, high],
    ];
    turned::turned(n, &profile)
}

impl ArmCell {
    /// Returns a cell whose links have `12 n` triangles each: n = 84 gives a robot of about 7,000.
    pub fn new(n: usize) -> Self {
        let at = Isometry3::translation;
        let shrunk = |soup: Soup, s: [f64; 3]| soup.map(|p| [p[0] * s[0], p[1] * s[1], p[2] * s[2]]);
        let tray = || turned::tray((n / 8).max(2));
        let post = || shrunk(turned::shaft(n.max(6)), [0.03, 0.03, 0.1]);
        let lying = Isometry3::from_parts(
            Translation3::new(0.0, -0.55, 0.75),
            UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2),
        );
        Self {
            links: LINKS.iter().map(|&l| link(n, l)).collect(),
            obstacles: vec![
                (soups::plate((n / 12).max(1), [0.9, 0.9, 0.02]), at(0.0, 0.0, -0.04)),
                (shrunk(tray(), [0.6, 0.6, 1.0]), at(0.55, 0.3, 0.0)),
                (shrunk(tray(), [0.6, 0.6, 1.0]), at(-0.5, 0.4, 0.0)),
                (post(), at(0.45, -0.35, 0.5)),
                (post(), at(-0.45, -0.35, 0.5)),
                (post(), lying),
                (soups::plate((n / 12).max(1), [0.5, 0.01, 0.5]), at(0.0, 0.8, 0.5)),
            ],
        }
    }

    /// Returns whether a pair of links may touch: adjacent links do.
    pub fn is_excluded(a: usize, b: usize) -> bool {
        a.abs_diff(b) < 2
    }

    /// Returns the configuration space of the arm.
    pub fn arm(&self) -> JointTree {
        let joint = |&(height, is_z, limit): &(f64, bool, f64)| {
            let axis = if is_z { Vector3::z_axis() } else { Vector3::y_axis() };
            Joint::revolute(Isometry3::translation(0.0, 0.0, height), axis, [-limit, limit])
        };
        let joints = JOINTS.iter().map(joint).collect();
        JointTree::serial(Isometry3::identity(), joints, (0..7).collect(), 0.15).expect("a sound arm")
    }

    /// Returns the cell as the planner's world.
    pub fn cell(&self) -> Cell {
        let mut cell = Cell::new();
        for (k, link) in self.links.iter().enumerate() {
            cell.robot_body(format!("link {k}"), mesh(link));
        }
        for (k, (soup, pose)) in self.obstacles.iter().enumerate() {
            cell.add_obstacle(k, mesh(soup), *pose).expect("an obstacle");
        }
        for k in 0..6 {
            let names = [k, k + 1].map(|k| format!("link {k}"));
            cell.exclude(&names[0], &names[1]).expect("names of links");
        }
        // The base rests on the table.
        cell.exclude("link 0", "0").expect("names");
        cell
    }

    /// Returns a random configuration within the limits.
    pub fn sample(rng: &mut Rng) -> Vec<f64> {
        JOINTS.iter().map(|j| rng.range(-j.2, j.2)).collect()
    }
}
