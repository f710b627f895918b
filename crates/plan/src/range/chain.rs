//! The joints between two bodies as one chain, and its axes at a configuration.

use std::vec::Vec;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::extremes::Extremes;
use crate::motion::joint::JointKind;
use crate::motion::joint::{Drive, TreeJoint};
use crate::motion::space::JointPath;
use crate::tolerance::{ARM_PLACE, ARM_TURN, ARM_VALUE, RANGE_FRAME, RANGE_TERM};
use lin_canny::normalize_rotation;

/// A full turn, rounded up.
const FULL_TURN: f64 = core::f64::consts::TAU * (1.0 + 4.0 * f64::EPSILON);

/// A body at an end of a chain.
pub(super) struct ChainEnd {
    /// The joints from the world to the body; `None` for a body at rest.
    pub(super) path: Option<JointPath>,
    /// Pose of the body in the frame of the last joint, or in the world.
    pub(super) pose: Isometry3<f64>,
    /// Deviation of the squared norm of the rotation of `pose` from 1, before it was normalised.
    pub(super) deviation: f64,
    /// Distance of the farthest point of the body from its origin.
    pub(super) reach: f64,
}

/// A joint between both bodies.
#[derive(Debug)]
struct ChainJoint {
    /// The pose of the joint in the frame after the joint before, the axis and the kind.
    joint: TreeJoint,
    drive: Drive,
    /// The index of its coordinate in the ranges of the chain.
    place: usize,
    /// Upper bounds of the distance of all points of A, and of B, from the origin of the joint.
    reach: [f64; 2],
}

/// The joints between two bodies, from A to B.
#[derive(Debug)]
pub(super) struct Chain {
    joints: Vec<ChainJoint>,
    /// Pose of B in the frame of the last joint.
    last: Isometry3<f64>,
    /// The coordinates that move the pair, in the order of the chain.
    pub(super) coordinates: Vec<usize>,
    /// The range of each of them.
    pub(super) ranges: Vec<[f64; 2]>,
    /// Whether no joint that places a body in the world moves, so that there is only one pose of each.
    pub(super) is_at_a_point: bool,
    /// Greatest distance of two points of the chain and of the bodies at its ends.
    length: f64,
    /// What a bound loses by rounding, apart from its terms.
    rounding: f64,
}

/// A joint as a bound sees it: its axis at the centre of a cell, and what moves it.
#[derive(Clone, Copy)]
pub(super) struct Screw {
    pub(super) is_turn: bool,
    pub(super) axis: Vector3<f64>,
    pub(super) origin: Vector3<f64>,
    /// Change of the joint by its coordinate.
    pub(super) factor: f64,
    pub(super) place: usize,
    /// Half the width of the range of the joint.
    pub(super) half: f64,
    /// Of a turn: the longest way of a point at distance 1 from the axis; sine and cosine of the
    /// half-width up to a quarter turn, both rounded to the safe side.
    pub(super) chord: f64,
    pub(super) sine: f64,
    pub(super) cosine: f64,
    /// Upper bounds of the distance of all points of A, and of B, from the axis.
    pub(super) reach: [f64; 2],
}

/// The chain at the centre of a cell, in the frame of A.
#[derive(Default)]
pub(super) struct PosedChain {
    pub(super) screws: Vec<Screw>,
    /// Rotation of the frame behind the first k joints.
    pub(super) rotations: Vec<UnitQuaternion<f64>>,
    pub(super) b: Isometry3<f64>,
    /// What a bound over the cell may lose by rounding.
    pub(super) rounding: f64,
}

/// Collects the joints of a chain.
struct Builder<'a> {
    low: &'a [f64],
    high: &'a [f64],
    before: Isometry3<f64>,
    joints: Vec<ChainJoint>,
    coordinates: Vec<usize>,
    /// Number of products of poses.
    products: f64,
}

impl Builder<'_> {
    fn fixed(&mut self, pose: &Isometry3<f64>) {
        self.before = normalize_rotation(&(self.before * pose));
        self.products += 2.0;
    }

    /// Appends a joint whose frame is the frame before.
    fn joint(&mut self, joint: &TreeJoint, sign: f64) {
        let moves = joint.drive.filter(|d| d.factor != 0.0);
        let Some(drive) = moves else {
            let value = sign * joint.drive.map_or(0.0, |d| d.offset);
            return self.fixed(&joint.moved(value));
        };
        let known = self.coordinates.iter().position(|c| *c == drive.coordinate);
        let place = known.unwrap_or(self.coordinates.len());
        if known.is_none() {
            self.coordinates.push(drive.coordinate);
        }
        let origin = core::mem::replace(&mut self.before, Isometry3::identity());
        self.joints.push(ChainJoint {
            joint: TreeJoint {
                origin,
                ..joint.clone()
            },
            drive: Drive {
                coordinate: drive.coordinate,
                factor: sign * drive.factor,
                offset: sign * drive.offset,
            },
            place,
            reach: [0.0; 2],
        });
        self.products += 2.0;
    }

    /// Returns the greatest absolute value of a joint.
    fn most(&self, drive: &Drive) -> f64 {
        let ends = [self.low[drive.coordinate], self.high[drive.coordinate]];
        drive.factor.abs() * ends[0].abs().larger(ends[1].abs()) + drive.offset.abs()
    }
}

impl Chain {
    /// Returns the chain between two bodies over a range of configurations.
    pub(super) fn new(a: &ChainEnd, b: &ChainEnd, low: &[f64], high: &[f64]) -> Self {
        let mut builder = Builder {
            low,
            high,
            before: Isometry3::identity(),
            joints: Vec::new(),
            coordinates: Vec::new(),
            products: 0.0,
        };
        let none = Vec::new();
        let joints = |end: &ChainEnd| end.path.as_ref().map_or(none.clone(), |path| path.joints.clone());
        let (of_a, of_b) = (joints(a), joints(b));
        let shared = of_a.iter().zip(&of_b).take_while(|(x, y)| x.0 == y.0).count();
        builder.fixed(&a.pose.inverse());
        for (_, joint) in of_a[shared..].iter().rev() {
            builder.joint(joint, -1.0);
            builder.fixed(&joint.origin.inverse());
        }
        match (&a.path, &b.path) {
            (Some(path), None) => builder.fixed(&path.base.inverse()),
            (None, Some(path)) => builder.fixed(&path.base),
            _ => {}
        }
        for (_, joint) in &of_b[shared..] {
            builder.fixed(&joint.origin);
            builder.joint(joint, 1.0);
        }
        builder.fixed(&b.pose);
        // What the poses of the bodies in the world err by.
        let mut cell = 0.0;
        for (end, joints) in [(a, &of_a), (b, &of_b)] {
            let base = end.path.as_ref().map_or(0.0, |path| size(&path.base));
            let mut length = base + size(&end.pose) + end.reach;
            let mut turns = 0.0;
            for (_, joint) in joints {
                let most = joint.drive.map_or(0.0, |d| builder.most(&d));
                length += size(&joint.origin);
                match joint.kind {
                    JointKind::Revolute => turns += most,
                    JointKind::Prismatic => length += most,
                }
            }
            // A rotation that is not normalised moves a point by twice its deviation.
            cell += 3.0 * end.deviation * length;
            cell += ((joints.len() + 2) as f64 * (ARM_TURN + ARM_PLACE) + ARM_VALUE * turns) * length;
        }
        let mut drives = of_a.iter().chain(&of_b).filter_map(|(_, joint)| joint.drive);
        let is_at_a_point = drives.all(|d| d.factor == 0.0 || low[d.coordinate] == high[d.coordinate]);
        Self {
            is_at_a_point,
            ..builder.finish([a.reach, b.reach], cell)
        }
    }

    /// Returns the number of joints.
    pub(super) fn len(&self) -> usize {
        self.joints.len()
    }

    /// Writes the chain at the centre of a cell.
    pub(super) fn pose_at(&self, centre: &[f64], half: &[f64], posed: &mut PosedChain) {
        posed.screws.clear();
        posed.rotations.clear();
        let mut frame = Isometry3::identity();
        posed.rotations.push(frame.rotation);
        let mut spread = 0.0;
        for one in &self.joints {
            let at = normalize_rotation(&(frame * one.joint.origin));
            let is_turn = one.joint.kind == JointKind::Revolute;
            let half = half[one.place] * one.drive.factor.abs() * (1.0 + 4.0 * f64::EPSILON);
            let [chord, sine, cosine] = if is_turn { arc(half) } else { [0.0, 0.0, 1.0] };
            posed.screws.push(Screw {
                is_turn,
                axis: at.rotation * one.joint.axis.into_inner(),
                origin: at.translation.vector,
                factor: one.drive.factor,
                place: one.place,
                half,
                chord,
                sine,
                cosine,
                reach: one.reach,
            });
            spread += match (is_turn, self.length > 0.0) {
                (true, _) => half,
                (false, true) => half / self.length,
                (false, false) => 0.0,
            };
            let value = one.drive.factor * centre[one.place] + one.drive.offset;
            frame = normalize_rotation(&(at * one.joint.moved(value)));
            posed.rotations.push(frame.rotation);
        }
        posed.b = normalize_rotation(&(frame * self.last));
        let terms = RANGE_TERM * (self.len() + 2) as f64 * self.length;
        let growth = (1.0 + spread) * (1.0 + spread) * (1.0 + spread);
        posed.rounding = (self.rounding + terms) * growth;
    }
}

impl Builder<'_> {
    fn finish(mut self, [reach_a, reach_b]: [f64; 2], of_world: f64) -> Chain {
        let range = |c: &usize| [self.low[*c], self.high[*c]];
        let mut ranges: Vec<[f64; 2]> = self.coordinates.iter().map(range).collect();
        let mut lengths = Vec::new();
        let mut value_error = 0.0;
        for one in &self.joints {
            let most = self.most(&one.drive);
            let slide = match one.joint.kind {
                JointKind::Revolute => {
                    value_error += ARM_VALUE * most;
                    0.0
                }
                JointKind::Prismatic => most,
            };
            lengths.push([size(&one.joint.origin), slide]);
        }
        let count = self.joints.len();
        // From the origin of a joint to A its own pose counts, to B its own slide.
        let mut to_a = reach_a;
        for k in 0..count {
            to_a += lengths[k][0];
            self.joints[k].reach[0] = to_a;
            to_a += lengths[k][1];
        }
        let mut to_b = reach_b + size(&self.before);
        for k in (0..count).rev() {
            to_b += lengths[k][1];
            self.joints[k].reach[1] = to_b;
            to_b += lengths[k][0];
        }
        let length = to_b + reach_a;
        // Poses repeat after a full turn of a coordinate whose joints all turn by as much.
        for (place, [low, high]) in ranges.iter_mut().enumerate() {
            let mut of = self.joints.iter().filter(|one| one.place == place);
            let Some(factor) = of.clone().next().map(|one| one.drive.factor.abs()) else {
                continue;
            };
            if of.all(|one| one.joint.kind == JointKind::Revolute && one.drive.factor.abs() == factor) {
                let turn = *low + FULL_TURN / factor;
                *high = high.smaller(turn.next_up());
            }
        }
        let frames = RANGE_FRAME * (count + 1) as f64 * self.products + 8.0 * (count + 1) as f64 * value_error;
        Chain {
            joints: self.joints,
            last: self.before,
            coordinates: self.coordinates,
            ranges,
            is_at_a_point: false,
            length,
            rounding: frames * length + of_world,
        }
    }
}

/// Returns upper bounds of the way of a point at distance 1 from the axis of a turn and of the radius
/// of the ball around its arc, and the distance of the ball's centre from the axis.
fn arc(half: f64) -> [f64; 3] {
    use core::f64::consts::{FRAC_PI_2, PI};
    const UP: f64 = 1.0 + 8.0 * f64::EPSILON;
    let chord = if half >= PI {
        2.0
    } else {
        2.0 * libm::sin(0.5 * half) * UP
    };
    let [sine, cosine] = if half >= FRAC_PI_2 {
        [1.0, 0.0]
    } else {
        // A cosine that is off by an error e adds e^2 to the square of the radius.
        [libm::sin(half) * UP, libm::cos(half)]
    };
    [chord, sine, cosine]
}

/// Returns an upper bound of the distance of a frame's origin.
fn size(pose: &Isometry3<f64>) -> f64 {
    pose.translation.vector.abs().sum()
}
