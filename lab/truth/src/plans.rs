//! The planner as its tests use it: cells of sound bodies with free names, motions and ranges within
//! the limits. What a test takes to be sound, and is not, ends the test.

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, Geometry};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, ConfigurationSpace, Drive, JointCurve, JointKind, JointMotion, JointTube,
    RangeAnswer, RangeOptions, RangeProver, RangeVerdict, TimedPoses, TreeJoint, Verdict,
};

/// Returns a box at the origin, by the halves of its sides.
///
/// # Panics
/// Panics if a side is not a positive length.
pub fn cuboid(half: [f64; 3]) -> ConvexPolyhedron {
    solids::cuboid(Vector3::from(half)).expect("a box")
}

/// Returns the Bézier curve of control points.
///
/// # Panics
/// Panics if the points are no curve.
pub fn bezier(points: &[impl AsRef<[f64]>]) -> JointCurve {
    JointCurve::bezier(points).expect("a curve")
}

/// Returns the motion along a curve with a tube.
///
/// # Panics
/// Panics if the tube has other coordinates or is negative.
pub fn tubed(curve: &JointCurve, tube: impl Into<JointTube>) -> JointMotion {
    JointMotion::curve(curve).with_tube(tube).expect("a motion")
}

/// Returns a joint that turns the next link about an axis by a coordinate.
pub fn turn(parent: usize, origin: Isometry3<f64>, axis: Unit<Vector3<f64>>, coordinate: usize) -> TreeJoint {
    TreeJoint {
        parent,
        kind: JointKind::Revolute,
        origin,
        axis,
        drive: Some(Drive::by(coordinate)),
    }
}

/// Returns a joint that moves the next link along an axis by a coordinate.
pub fn slide(parent: usize, origin: Isometry3<f64>, axis: Unit<Vector3<f64>>, coordinate: usize) -> TreeJoint {
    TreeJoint {
        kind: JointKind::Prismatic,
        ..turn(parent, origin, axis, coordinate)
    }
}

/// Returns until when a blocked motion is free and when it is in contact, and the pair; `None` for
/// any other verdict.
pub fn blocked(verdict: &Verdict) -> Option<([f64; 2], CellPair)> {
    match *verdict {
        Verdict::Blocked {
            free_until,
            contact_at,
            pair,
            ..
        } => Some(([free_until, contact_at], pair)),
        _ => None,
    }
}

/// Returns the place of a verdict of a range in a tally: never, always, both, open.
pub fn place_of(verdict: &RangeVerdict) -> usize {
    match verdict {
        RangeVerdict::Never => 0,
        RangeVerdict::Always => 1,
        RangeVerdict::Both { .. } => 2,
        _ => 3,
    }
}

/// Returns what a checker answers to one of eight questions; `Debug` writes every digit, and the
/// sign of zero.
pub fn told<C: ConfigurationSpace>(checker: &mut Checker<C>, question: usize, q: &[f64], p: &[f64]) -> String {
    let motion = JointMotion::segment(q, p);
    match question {
        0 => format!("{:?}", checker.nearest(q, 0.2)),
        1 => format!("{:?}", checker.is_free_at(q)),
        2 => format!("{:?}", checker.certify(&motion)),
        3 => format!("{:?}", checker.clearance(q)),
        4 => format!("{:?}", checker.in_contact(q)),
        5 => format!("{:?}", checker.nearest(q, f64::INFINITY)),
        6 => format!("{:?}", checker.clearance_along(&motion, 0.1)),
        _ => format!("{:?}", checker.certify(&motion.with_radius(0.01).expect("a motion"))),
    }
}

/// Puts bodies into a cell.
///
/// Each function panics if the name is in use or the body or pose is not sound.
pub trait Furnish {
    /// Adds an obstacle.
    fn put(&mut self, name: impl ToString, geometry: impl Into<Geometry>, pose: Isometry3<f64>) -> CellBody;

    /// Adds an obstacle that moves.
    fn put_moving(&mut self, name: impl ToString, geometry: impl Into<Geometry>, poses: TimedPoses) -> CellBody;

    /// Attaches an object to a link.
    fn carry(
        &mut self,
        link: &str,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        pose: Isometry3<f64>,
        touch_links: &[&str],
    ) -> CellBody;
}

impl Furnish for Cell {
    fn put(&mut self, name: impl ToString, geometry: impl Into<Geometry>, pose: Isometry3<f64>) -> CellBody {
        self.add_obstacle(name, geometry, pose).expect("an obstacle")
    }

    fn put_moving(&mut self, name: impl ToString, geometry: impl Into<Geometry>, poses: TimedPoses) -> CellBody {
        self.add_moving_obstacle(name, geometry, poses).expect("an obstacle")
    }

    fn carry(
        &mut self,
        link: &str,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        pose: Isometry3<f64>,
        touch_links: &[&str],
    ) -> CellBody {
        self.attach(link, name, geometry, pose, touch_links).expect("an object")
    }
}

/// Asks a checker about motions and ranges within the limits.
///
/// Each function panics if the motion or range is not within the limits.
pub trait Ask {
    /// Returns the verdict of a motion.
    fn verdict_of(&mut self, motion: &JointMotion) -> Verdict;

    /// Returns whether a motion is proven free.
    fn is_free_along(&mut self, motion: &JointMotion) -> bool {
        self.verdict_of(motion).is_free()
    }

    /// Returns the answer of a pair of bodies over a range.
    fn answer_over(&mut self, options: &RangeOptions, pair: [CellBody; 2], low: &[f64], high: &[f64]) -> RangeAnswer;

    /// Returns the answers of all pairs over a range.
    fn answers_over(&mut self, options: &RangeOptions, low: &[f64], high: &[f64]) -> Vec<RangeAnswer>;
}

impl<C: ConfigurationSpace> Ask for Checker<C> {
    fn verdict_of(&mut self, motion: &JointMotion) -> Verdict {
        self.certify(motion).expect("within limits")
    }

    fn answer_over(&mut self, options: &RangeOptions, [a, b]: [CellBody; 2], low: &[f64], high: &[f64]) -> RangeAnswer {
        RangeProver::new(options).pair(self, a, b, low, high).expect("a range")
    }

    fn answers_over(&mut self, options: &RangeOptions, low: &[f64], high: &[f64]) -> Vec<RangeAnswer> {
        RangeProver::new(options).all_pairs(self, low, high).expect("a range")
    }
}
