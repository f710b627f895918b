//! The least clearance of an arm and a fixture over all motions and all tolerances.
//!
//! Three tolerances are joints with a small range: the error of a joint (calibration), the position of the fixture, and the
//! position of the part in the gripper. `RangeProver` proves the clearance over the box of all of them, and bisection finds the greatest
//! tolerance at which arm and fixture never meet.
//!
//! Run with `cargo run --release -p lin-canny-plan --example tolerances`.

use std::error::Error;

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{
    Cell, CellBody, Checker, ClearanceWidth, Drive, JointKind, JointTree, RangeOptions, RangeProver, TreeJoint,
};

/// The ranges of the two turns of the arm.
const TURNS: [[f64; 2]; 2] = [[-0.8, 0.8], [0.2, 1.2]];

fn main() -> Result<(), Box<dyn Error>> {
    truth::command::no_options("The least clearance of an arm and a fixture over all motions and all tolerances");
    let mut checker = cell()?;
    println!("tolerance, mm and mrad   verdict   least clearance, mm   cells");
    for tolerance in [0.0, 0.001, 0.002, 0.005, 0.01, 0.02] {
        let (verdict, lower, cells) = proved(&mut checker, tolerance)?;
        let (shown, lower) = (tolerance * 1e3, lower * 1e3);
        println!("{shown:22.0}   {verdict:<7} {lower:21.2} {cells:7}");
    }
    let (mut free, mut touching) = (0.0, 0.05);
    while touching - free > 1e-6 {
        let middle = 0.5 * (free + touching);
        match proved(&mut checker, middle)?.0 {
            "never" => free = middle,
            _ => touching = middle,
        }
    }
    println!("proven apart up to {:.3} mm and mrad", free * 1e3);
    Ok(())
}

/// Returns the verdict, the proven clearance, and the number of cells.
fn proved(checker: &mut Checker<JointTree>, tolerance: f64) -> Result<(&'static str, f64, u64), Box<dyn Error>> {
    let (t, [first, second]) = (tolerance, TURNS);
    let (low, high) = ([first[0], second[0], -t, -t, -t], [first[1], second[1], t, t, t]);
    let options = RangeOptions::default().width(ClearanceWidth::Length(1e-5));
    let (part, fixture) = (CellBody::Robot(0), CellBody::Robot(1));
    let answer = RangeProver::new(&options).pair(checker, part, fixture, &low, &high)?;
    Ok((answer.verdict.name(), answer.lower, answer.cells))
}

/// Returns an arm of two turns that holds a part, before a fixture.
fn cell() -> Result<Checker<JointTree>, Box<dyn Error>> {
    let joint = |parent, kind, axis: Unit<Vector3<f64>>, x: f64, coordinate| TreeJoint {
        parent,
        kind,
        origin: Isometry3::translation(x, 0.0, 0.0),
        axis,
        drive: Some(Drive::by(coordinate)),
    };
    let (turn, slide) = (JointKind::Revolute, JointKind::Prismatic);
    let joints = vec![
        joint(0, turn, Vector3::z_axis(), 0.0, 0),
        joint(1, turn, Vector3::z_axis(), 0.5, 1),
        // The error of the second turn is a turn about its axis.
        joint(2, turn, Vector3::z_axis(), 0.0, 2),
        // The part may be in the gripper further out.
        joint(3, slide, Vector3::x_axis(), 0.0, 3),
        // The fixture is no obstacle but a link that slides.
        joint(0, slide, Vector3::x_axis(), 1.12, 4),
    ];
    let error = [-0.1, 0.1];
    let limits = vec![TURNS[0], TURNS[1], error, error, error];
    let tree = JointTree::new(Isometry3::identity(), joints, limits, vec![4, 5], vec![0.5; 6])?;
    let mut cell = Cell::new();
    let part = solids::cuboid(Vector3::new(0.25, 0.03, 0.03))?;
    cell.robot_body("part", part.transformed(&Isometry3::translation(0.25, 0.0, 0.0))?);
    cell.robot_body("fixture", solids::cuboid(Vector3::new(0.1, 0.5, 0.5))?);
    Ok(Checker::new(tree, cell)?)
}
