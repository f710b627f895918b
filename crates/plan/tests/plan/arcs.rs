//! A rod that meets a post in the middle of an arc alone: at both ends of the segment, and along its chord, they are apart.

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{Cell, Checker, ConfigurationSpace, JointMotion, JointTree, RigidSpace, TreeJoint};
use truth::plans::{Ask, Furnish, bezier, turn};

/// The ends of the arc, in radians.
const ENDS: [f64; 2] = [0.3, -0.3];

/// Half the width of a rod whose end is 1 from the axis: its corners are at most 1.0002 from it.
const HALF: f64 = 0.02;

fn rod(half_length: f64, unit: f64) -> ConvexPolyhedron {
    solids::cuboid(Vector3::new(half_length, HALF, HALF) * unit).expect("a rod")
}

/// A narrow post, and its pose: its near side is so far from the axis.
fn post(far: f64, unit: f64) -> (ConvexPolyhedron, Isometry3<f64>) {
    let post = solids::cuboid(Vector3::new(0.05, 0.01, 1.0) * unit).expect("a post");
    (post, Isometry3::translation((far + 0.05) * unit, 0.0, 0.0))
}

/// A rod on a joint about z; the post is an obstacle, or a body of the base.
fn lever(far: f64, is_own: bool, unit: f64) -> Checker<JointTree> {
    let (post, at) = post(far, unit);
    let joints = vec![
        turn(0, Isometry3::identity(), Vector3::z_axis(), 0),
        TreeJoint::fixed(1, Isometry3::translation(0.5 * unit, 0.0, 0.0)),
        TreeJoint::fixed(0, at),
    ];
    let mut cell = Cell::new();
    cell.robot_body("rod", rod(0.5, unit));
    let mut links = vec![2];
    if is_own {
        cell.robot_body("post", post);
        links.push(3);
    } else {
        cell.put("post", post, at);
    }
    let radii = vec![0.0, 0.0, unit, 2.0 * unit];
    let lever = JointTree::new(Isometry3::identity(), joints, vec![[-3.0, 3.0]], links, radii).expect("a lever");
    Checker::new(lever, cell).expect("a world")
}

/// A rod that turns about its middle.
fn propeller(far: f64, unit: f64) -> Checker<RigidSpace> {
    let mut cell = Cell::new();
    cell.robot_body("rod", rod(1.0, unit));
    let (post, at) = post(far, unit);
    cell.put("post", post, at);
    let space = RigidSpace::new([[-4.0 * unit, 4.0 * unit]; 3], unit, 1).expect("a space");
    Checker::new(space, cell).expect("a world")
}

fn agrees<C: ConfigurationSpace>(checker: &mut Checker<C>, ends: [&[f64]; 2], is_free: bool, what: &str) {
    for [from, to] in [ends, [ends[1], ends[0]]] {
        let answer = checker.is_free_along(&JointMotion::segment(from, to));
        assert_eq!(answer, is_free, "{what}");
        let found = checker.is_free(&JointMotion::segment(from, to)).expect("a segment");
        assert_eq!(found, is_free, "{what}");
    }
}

fn judge(far: f64, unit: f64) {
    let is_free = far > 1.0002;
    for is_own in [false, true] {
        let (mut checker, what) = (lever(far, is_own, unit), format!("{far}, own {is_own}, unit {unit}"));
        agrees(&mut checker, [&ENDS[..1], &ENDS[1..]], is_free, &what);
        let [a, b] = ENDS;
        for points in [&[[a], [b]][..], &[[a], [0.3 * a], [0.3 * b], [b]]] {
            let curve = bezier(points);
            let verdict = checker.verdict_of(&JointMotion::curve(&curve));
            assert_eq!(verdict.is_free(), is_free, "{what}, {} points", points.len());
        }
    }
    let ends = ENDS.map(|angle| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        RigidSpace::configuration(&Isometry3::from_parts(Vector3::zeros().into(), turn))
    });
    let what = format!("{far}, propeller, unit {unit}");
    agrees(&mut propeller(far, unit), [&ends[0], &ends[1]], is_free, &what);
}

#[test]
fn a_rod_meets_a_post_in_the_middle_of_an_arc() {
    for unit in [1.0, 1e-95, 1e95] {
        for far in [0.965, 0.97, 0.98, 0.99, 0.999, 0.9999, 1.0003, 1.001, 1.01, 1.1] {
            judge(far, unit);
        }
    }
}
