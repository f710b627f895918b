//! The motion of the links of a tree of joints along a curve of the coordinates.
//!
//! # Bounds
//!
//! All sums run along the path from the base to a link, without other branches. `q_i` is the value
//! of joint i, and `A_i`, `B_i`, `C_i` are sums over the revolute joints up to i: of the greatest
//! absolute first, second and third derivative of `q` over a span (see [`JointCurve`]). Along a
//! straight segment `B` and `C` are zero.
//!
//! The derivatives of a product of rotations are bounded by those of the exponential of the sum of
//! the angles (Leibniz's rule): `A`, `B + A^2` and `C + 3 A B + A^3` for a vector of length 1.
//! The pivot, the middle of the body, is the sum of vectors `R_1 .. R_i u_i`, each rotated by the
//! joints before it: the last one leads from the origin of the link to the pivot. So the third
//! derivative of a vector of constant length is at most `(C + 3 A B + A^3) |u_i|`. A vector along a
//! prismatic joint of value d adds `3 (B + A^2) |d'| + 3 A |d''|` and the third derivative of d.
//! Velocity and acceleration come from the forward recursion of Newton and Euler (Luh, Walker and
//! Paul 1980). The sum of the third derivatives bounds the deviation from them.
//!
//! The angular velocity of link k is `w = sum q'_i z_i` over its revolute joints, where `z_i` is
//! the axis of joint i in the world, and `z_i' = w_{i-1} x z_i`. So `|w'|` is at most the sum of
//! `|q''_i| + |q'_i| A_{i-1}`, and `|w''|` at most the sum of the third derivative,
//! `2 |q''_i| A_{i-1}` and `|q'_i| (B + A^2)_{i-1}`. The body rotates away from its model at the
//! rate `|w(s) - w|` at most. This gives two bounds of the angle: `sup |w'| s^2 / 2`, and
//! `|w'| s^2 / 2 + sup |w''| s^3 / 6` with the angular acceleration `w'` at the start. The model
//! takes the bound that is smaller after a quarter of the span.
//!
//! Bounds over a part of a span are smaller than those over the whole span. Let `T(h)` be the bound
//! of a third derivative over the first `h` of a span `S`. The deviation after `s` is at most the
//! triple integral of `T`. It is at most `d s^3 / 6` for every `s` up to `S`, with
//! `d = 3 int_0^1 T(S y) (1 - y)^2 dy`, because this mean of `T` grows with `S`. With `T` over
//! nested parts the integral is a sum ([`CUBIC`]); likewise for a second derivative ([`SQUARE`]).
//!
//! Rounding errors grow with the number of joints on the path: see `ARM_TURN`, `ARM_PLACE` and
//! `ARM_VALUE`. They are bounded once for the whole curve. The bounds in the world are used for all
//! frames, where they are larger.

use std::sync::{Arc, OnceLock};
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use crate::extremes::Extremes;
use crate::motion::curve::{JointCurve, PARTS};
use crate::motion::joint::JointKind;
use crate::motion::joint::{Drive, TreeJoint};
use crate::motion::space::{BodyBall, SegmentMotion};
use crate::tolerance::{ARM_PLACE, ARM_TURN, ARM_VALUE, CURVE_DIFFERENCE, LENGTH};
use lin_canny::motion::{MotionModel, Remainder};
use lin_canny::normalize_rotation;

/// Rotation of the joints that two links share, in radians, beyond which the pair is measured
/// relative to the last link that carries both.
const TURNED: f64 = 1.0;

/// Rotation of all joints, in radians at the greatest rate, beyond which a curve is cut for casts.
/// On 14 joints from rest to rest, a proof takes 857 queries without cuts, and 43 with them.
const CUT: f64 = 8.0;

/// Product of span and degree up to which bounds are those of the whole span, not of nested parts.
const EVEN: f64 = 1.0;

/// Largest number of parts of a curve for casts.
const CUTS: u32 = 32;

/// Parts of the integral `3 int (1 - y)^2 dy` over the second half, the second quarter and the
/// first quarter.
const CUBIC: [f64; PARTS] = [0.125, 0.296875, 0.578125];

/// Parts of the integral `2 int (1 - y) dy`.
const SQUARE: [f64; PARTS] = [0.25, 0.3125, 0.4375];

/// Base, joints and paths; a space and its segments share them.
#[derive(Clone, Debug)]
pub(crate) struct LinkTree(Arc<Paths>);

#[derive(Debug)]
struct Paths {
    base: Isometry3<f64>,
    joints: Vec<TreeJoint>,
    /// Upper bound of the distance of each joint's origin from that of its parent link.
    lengths: Vec<f64>,
    /// The joints between the base and each link, outward.
    paths: Vec<Vec<usize>>,
}

impl LinkTree {
    /// Normalises rotations and axes, because the bounds require unit length up to rounding. The
    /// parent of each joint must come before the joint.
    pub(crate) fn new(base: &Isometry3<f64>, mut joints: Vec<TreeJoint>) -> Self {
        let mut paths: Vec<Vec<usize>> = std::vec![Vec::new()];
        for (index, joint) in joints.iter_mut().enumerate() {
            joint.origin = normalize_rotation(&joint.origin);
            joint.axis = Unit::new_normalize(joint.axis.into_inner());
            let mut path = paths[joint.parent].clone();
            path.push(index);
            paths.push(path);
        }
        let base = normalize_rotation(base);
        let lengths = joints.iter().map(|joint| length(&joint.origin.translation.vector));
        Self(Arc::new(Paths {
            base,
            lengths: lengths.collect(),
            joints,
            paths,
        }))
    }

    pub(crate) fn base(&self) -> &Isometry3<f64> {
        &self.0.base
    }

    pub(crate) fn joints(&self) -> &[TreeJoint] {
        &self.0.joints
    }

    /// Returns the joints between the base and a link, outward.
    pub(crate) fn path(&self, link: usize) -> impl ExactSizeIterator<Item = (usize, &TreeJoint)> {
        self.0.paths[link].iter().map(|&k| (k, &self.0.joints[k]))
    }

    /// Returns the last link on the paths of both links: up to this one they move alike.
    fn stem(&self, a: usize, b: usize) -> usize {
        let [of_a, of_b] = [a, b].map(|link| self.0.paths[link].iter());
        let shared = of_a.zip(of_b).take_while(|(x, y)| x == y);
        shared.last().map_or(0, |(&joint, _)| joint + 1)
    }

    /// Writes the poses of the base and of all links, and returns their number.
    pub(crate) fn poses(&self, configuration: &[f64], poses: &mut Vec<Isometry3<f64>>) -> usize {
        poses.clear();
        poses.push(self.0.base);
        for joint in &self.0.joints {
            poses.push(joint.after(&poses[joint.parent], joint.value(configuration)));
        }
        poses.len()
    }
}

/// Returns an upper bound of the length of a vector.
fn length(v: &Vector3<f64>) -> f64 {
    (v.norm() * (1.0 + LENGTH)).smaller(v.abs().sum())
}

/// The bodies of a robot: link and middle of each, about which its motion is stated, in the frame
/// of the link.
#[derive(Clone, Debug)]
pub(crate) struct TreeBodies {
    pub(crate) links: Vec<usize>,
    pub(crate) middles: Vec<Point3<f64>>,
}

/// Pose and motion model of each body at a time.
type PlacedBodies = Vec<(Isometry3<f64>, MotionModel)>;

/// The motion of the bodies of a [`JointTree`](crate::JointTree) along a curve or a segment.
#[derive(Clone, Debug)]
pub struct TreeSegment {
    tree: LinkTree,
    bodies: Arc<TreeBodies>,
    curve: JointCurve,
    /// Bounds of each link over the whole curve.
    whole: Vec<WholeBounds>,
    /// Bounds of the model of each body along a straight segment, which hold at all times, once they
    /// are needed.
    straight: OnceLock<Vec<ModelBounds>>,
    /// For each part of the curve, once it is needed, pose and motion model of each body at the
    /// start of the part, where the first queries of most pairs are.
    starts: Vec<OnceLock<PlacedBodies>>,
}

impl TreeSegment {
    pub(crate) fn new(tree: &LinkTree, bodies: &Arc<TreeBodies>, curve: JointCurve) -> Self {
        let mut whole = Vec::with_capacity(tree.joints().len() + 1);
        whole.push(WholeBounds::new(tree.base()));
        for (index, joint) in tree.joints().iter().enumerate() {
            let mut link: WholeBounds = whole[joint.parent];
            link.pass(joint, tree.0.lengths[index], &curve);
            whole.push(link);
        }
        let turned = whole.iter().map(|link| link.turned).fold(0.0, f64::larger);
        Self {
            starts: std::vec![OnceLock::new(); parts(&curve, turned)],
            whole,
            straight: OnceLock::new(),
            tree: tree.clone(),
            bodies: bodies.clone(),
            curve,
        }
    }

    /// Returns the bounds of the model of each body along a straight segment.
    fn straight_bounds(&self) -> Vec<ModelBounds> {
        let mut links = Vec::with_capacity(self.tree.joints().len() + 1);
        links.push(SpanBounds::new(1));
        for (index, joint) in self.tree.joints().iter().enumerate() {
            let mut link: SpanBounds = links[joint.parent];
            let rates = joint.drive.map(|d| self.curve.state(d.coordinate, 0.0, 1.0, 1).bounds);
            link.pass(joint, self.tree.0.lengths[index], &self.curve, rates);
            links.push(link);
        }
        let bodies = self.bodies.links.iter().enumerate();
        bodies.map(|(body, &link)| links[link].model(self, body)).collect()
    }

    /// Returns pose and motion model of each body if they are shared by all queries of this span: at
    /// the start of a part. Bounds of a straight segment hold for all spans; others are too large for
    /// a much shorter span.
    fn start(&self, time: f64, span: f64) -> Option<&[(Isometry3<f64>, MotionModel)]> {
        let parts = self.starts.len() as f64;
        let first = (1.0 / parts).next_up();
        let is_whole = span <= first && span > 0.5 * first;
        if !(is_whole || (time == 0.0 && self.curve.degree() == 1)) {
            return None;
        }
        let part = (time * parts) as usize;
        if part as f64 != time * parts {
            return None;
        }
        Some(self.starts.get(part)?.get_or_init(|| self.outward(time, first)))
    }

    /// Returns pose and model of each body in the world, by one recursion over all links.
    fn outward(&self, time: f64, span: f64) -> PlacedBodies {
        let joints = self.tree.joints();
        let mut links = Vec::with_capacity(joints.len() + 1);
        links.push(LinkMotion::new(*self.tree.base()));
        // Empty along a straight segment.
        let mut bounds: Vec<SpanBounds> = self.span_bounds(span).into_iter().collect();
        for (index, joint) in joints.iter().enumerate() {
            let mut link: LinkMotion = links[joint.parent];
            let mut of_link = bounds.get(joint.parent).copied();
            self.pass((index, joint), &mut link, of_link.as_mut(), time, span);
            links.push(link);
            bounds.extend(of_link);
        }
        let bodies = self.bodies.links.iter().enumerate();
        let one = |(body, &link): (usize, &usize)| {
            let model = self.model_of(body, links[link], bounds.get(link), span);
            (links[link].pose, model)
        };
        bodies.map(one).collect()
    }

    /// Returns the value of a joint at a time.
    fn value(&self, joint: &TreeJoint, time: f64) -> f64 {
        let at = |d: Drive| d.factor * self.curve.value(d.coordinate, 0, time) + d.offset;
        joint.drive.map_or(0.0, at)
    }

    /// Returns the bounds of the base over a span; `None` along a straight segment, whose bounds are
    /// known.
    fn span_bounds(&self, span: f64) -> Option<SpanBounds> {
        (self.curve.degree() > 1).then(|| SpanBounds::new(used_parts(&self.curve, span)))
    }

    /// Passes a joint at a time, to the link that it moves.
    fn pass(
        &self,
        (index, joint): (usize, &TreeJoint),
        link: &mut LinkMotion,
        bounds: Option<&mut SpanBounds>,
        time: f64,
        span: f64,
    ) {
        let Some(bounds) = bounds else {
            let values = joint.drive.map(|d| {
                let of = |order| self.curve.value(d.coordinate, order, time);
                [of(0), of(1), 0.0]
            });
            link.pass(joint, values);
            return;
        };
        let state = joint
            .drive
            .map(|d| self.curve.state(d.coordinate, time, span, bounds.used));
        link.pass(joint, state.map(|state| state.values));
        let rates = state.map(|state| state.bounds);
        bounds.pass(joint, self.tree.0.lengths[index], &self.curve, rates);
    }

    /// Returns the motion model of a body about its middle.
    fn model_of(&self, body: usize, link: LinkMotion, bounds: Option<&SpanBounds>, span: f64) -> MotionModel {
        let middle = self.bodies.middles[body];
        match bounds {
            None => {
                let straight = self.straight.get_or_init(|| self.straight_bounds());
                link.model(middle, &straight[body], span)
            }
            Some(bounds) => link.model(middle, &bounds.model(self, body), span),
        }
    }
}

/// Returns the number of parts into which casts along a curve are cut, if no body is rotated by more
/// than `turned` at the greatest rates.
fn parts(curve: &JointCurve, turned: f64) -> usize {
    let mut parts = 1;
    while curve.degree() > 1 && parts < CUTS && turned > CUT * f64::from(parts) {
        parts *= 2;
    }
    parts as usize
}

/// Returns the rotation by a joint at its greatest rate.
fn turned(joint: &TreeJoint, curve: &JointCurve) -> f64 {
    match (joint.kind, joint.drive) {
        (JointKind::Revolute, Some(d)) => d.factor.abs() * curve.bounds(d.coordinate).most[1],
        _ => 0.0,
    }
}

/// Returns the greatest absolute value of a joint; 0 for a revolute joint.
fn farthest(joint: &TreeJoint, curve: &JointCurve) -> f64 {
    match (joint.kind, joint.drive) {
        (JointKind::Prismatic, Some(d)) => {
            let ends = curve.bounds(d.coordinate).hull.map(|q| (d.factor * q + d.offset).abs());
            ends[0].larger(ends[1])
        }
        _ => 0.0,
    }
}

/// Returns the number of nested parts whose bounds are worth their cost: one along a straight segment
/// or over a short span, on which derivatives change little.
fn used_parts(curve: &JointCurve, span: f64) -> usize {
    let degree = curve.degree();
    if degree == 1 || span * degree as f64 <= EVEN {
        1
    } else {
        PARTS
    }
}

impl SegmentMotion for TreeSegment {
    fn pose(&self, body: usize, time: f64) -> Isometry3<f64> {
        if time == 0.0
            && let Some(start) = self.start(0.0, 1.0 / self.starts.len() as f64)
        {
            return start[body].0;
        }
        let path = self.tree.path(self.bodies.links[body]);
        path.fold(*self.tree.base(), |pose, (_, joint)| {
            joint.after(&pose, self.value(joint, time))
        })
    }

    fn model(&self, body: usize, time: f64, span: f64) -> MotionModel {
        self.placed(0, body, time, span).1
    }

    fn stem(&self, a: usize, b: usize) -> usize {
        let stem = self.tree.stem(self.bodies.links[a], self.bodies.links[b]);
        // If the stem hardly rotates, use the world frame, whose start is cached.
        if self.whole[stem].turned > TURNED { stem } else { 0 }
    }

    fn placed(&self, stem: usize, body: usize, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        if stem == 0
            && let Some(start) = self.start(time, span)
        {
            return start[body];
        }
        let (start, shared) = match stem {
            0 => (*self.tree.base(), 0),
            _ => (Isometry3::identity(), self.tree.path(stem).len()),
        };
        let mut motion = LinkMotion::new(start);
        // Relative to a stem, bounds are smaller than in the world.
        let mut bounds = match stem {
            0 => self.span_bounds(span),
            _ => Some(SpanBounds::new(used_parts(&self.curve, span))),
        };
        for passed in self.tree.path(self.bodies.links[body]).skip(shared) {
            self.pass(passed, &mut motion, bounds.as_mut(), time, span);
        }
        (motion.pose, self.model_of(body, motion, bounds.as_ref(), span))
    }

    fn poses(&self, _: usize, times: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        let joints = self.tree.joints();
        let mut links = Vec::with_capacity(joints.len() + 1);
        for &time in times {
            links.clear();
            links.push(*self.tree.base());
            for joint in joints {
                let pose = joint.after(&links[joint.parent], self.value(joint, time));
                links.push(pose);
            }
            poses.extend(self.bodies.links.iter().map(|&link| links[link]));
        }
    }

    /// The second derivative of the position of a point is bounded over the whole curve. On a path
    /// with the second derivative b, the chord of a span s is at most `b s^2 / 8` away.
    fn chord_deviation(&self, body: usize, reach: f64, parts: u32) -> f64 {
        let span = 1.0 / f64::from(parts);
        let mut whole = self.whole[self.bodies.links[body]];
        let bend = whole.path.place[1] + whole.path.turned()[1] * reach;
        whole.reach_on(reach);
        (bend * span * span / 8.0 + 4.0 * whole.place) * GROWTH
    }

    fn parts(&self) -> u32 {
        self.starts.len() as u32
    }

    fn spread(&self, a: BodyBall, b: Option<BodyBall>, time: f64, span: f64, tube: &[f64]) -> Option<f64> {
        let links = &self.bodies.links;
        // Joints that move both bodies do not change their distance.
        let shared = b.map_or(0, |b| {
            self.tree.path(self.tree.stem(links[a.body], links[b.body])).len()
        });
        let bodies = core::iter::once(a).chain(b);
        Some(bodies.map(|ball| self.deviation(ball, shared, time, span, tube)).sum())
    }
}

/// A joint of a body's path at a time: a point of its axis, and the axis.
struct PassedJoint<'a> {
    index: usize,
    joint: &'a TreeJoint,
    at: Point3<f64>,
    axis: Vector3<f64>,
}

impl TreeSegment {
    /// Returns an upper bound of the distance of each point of a ball from its position, if
    /// coordinates deviate by at most `tube`, at all times of a span. The first `shared` joints of
    /// the path do not count.
    ///
    /// A joint that deviates by e moves a point at the distance x from its axis by at most e x, and
    /// does not change how far outer joints move the point. The distance from the axis grows at
    /// most at the speed of the point relative to the joint: rates of outer joints times the
    /// lengths beyond them.
    fn deviation(&self, ball: BodyBall, shared: usize, time: f64, span: f64, tube: &[f64]) -> f64 {
        let link = self.bodies.links[ball.body];
        let mut pose = *self.tree.base();
        let mut passed = Vec::new();
        for (index, joint) in self.tree.path(link) {
            pose = joint.after(&pose, self.value(joint, time));
            passed.push(PassedJoint {
                index,
                joint,
                at: pose.translation.vector.into(),
                axis: pose.rotation * joint.axis.into_inner(),
            });
        }
        let centre = pose * ball.centre;
        let mut whole = self.whole[link];
        whole.reach_on(ball.centre.coords.abs().sum());
        let error = 4.0 * whole.place;
        let (mut beyond, mut speed, mut sum) = (length(&ball.centre.coords), 0.0, 0.0);
        for PassedJoint { index, joint, at, axis } in passed.into_iter().skip(shared).rev() {
            if let Some(drive) = joint.drive {
                let factor = drive.factor.abs();
                let off = factor * tube[drive.coordinate];
                let rate = factor * self.curve.state(drive.coordinate, time, span, 1).bounds[0][0];
                match joint.kind {
                    JointKind::Revolute => {
                        let lever = axis.cross(&(centre - at)).norm() + error + speed * span;
                        sum += off * (lever.smaller(beyond) + ball.radius);
                        speed += rate * beyond;
                    }
                    JointKind::Prismatic => {
                        sum += off;
                        speed += rate;
                        beyond += farthest(joint, &self.curve);
                    }
                }
            }
            beyond += self.tree.0.lengths[index];
        }
        sum * (1.0 + ARM_PLACE)
    }
}

/// Upper bounds of derivatives of a link's motion over a span.
#[derive(Clone, Copy, Debug, Default)]
struct PathBounds {
    /// Sums of the first three derivatives of revolute joints.
    rates: [f64; 3],
    /// First three derivatives of the position of the origin.
    place: [f64; 3],
    /// First two derivatives of the angular velocity.
    bend: [f64; 2],
}

impl PathBounds {
    /// Returns bounds of the first three derivatives of a rotated vector of length 1.
    fn turned(&self) -> [f64; 3] {
        let [a, b, c] = self.rates;
        [a, b + a * a, c + 3.0 * a * b + a * a * a]
    }

    /// Moves the origin by a vector of at most this length.
    fn carry(&mut self, length: f64) {
        let turned = self.turned();
        for (sum, turned) in self.place.iter_mut().zip(turned) {
            *sum += turned * length;
        }
    }

    /// Passes a joint whose value has these derivatives, and which slides to at most `most`.
    fn pass(&mut self, kind: JointKind, [d, dd, ddd]: [f64; 3], most: f64) {
        let [a, b, _] = self.turned();
        match kind {
            JointKind::Revolute => {
                self.bend[0] += dd + d * a;
                self.bend[1] += ddd + 2.0 * dd * a + d * b;
                for (sum, rate) in self.rates.iter_mut().zip([d, dd, ddd]) {
                    *sum += rate;
                }
            }
            JointKind::Prismatic => {
                self.carry(most);
                self.place[0] += d;
                self.place[1] += 2.0 * a * d + dd;
                self.place[2] += 3.0 * b * d + 3.0 * a * dd + ddd;
            }
        }
    }
}

/// Upper bounds of a link's motion over the whole curve, and of its rounding errors.
#[derive(Clone, Copy, Debug)]
struct WholeBounds {
    /// Bounds of the derivatives.
    path: PathBounds,
    /// What rounding errors are relative to: bounds that grow with the rounding of derivatives.
    rounded: PathBounds,
    /// Sum of the rotations by the joints at their greatest rates.
    turned: f64,
    /// Sum of the lengths from the world's origin.
    length: f64,
    /// Rounding errors of the angle and of the position.
    turn: f64,
    place: f64,
}

impl WholeBounds {
    fn new(base: &Isometry3<f64>) -> Self {
        let length = base.translation.vector.abs().sum();
        Self {
            path: PathBounds::default(),
            rounded: PathBounds::default(),
            turned: 0.0,
            length,
            turn: ARM_TURN,
            place: ARM_PLACE * length,
        }
    }

    /// Adds the rounding of a position after a further vector of this length.
    fn reach_on(&mut self, length: f64) {
        self.length += length;
        self.place += (self.turn + ARM_PLACE) * length + ARM_PLACE * self.length;
    }

    /// Passes a joint, whose origin is at most `far` from that of its parent link.
    fn pass(&mut self, joint: &TreeJoint, far: f64, curve: &JointCurve) {
        self.reach_on(joint.origin.translation.vector.abs().sum());
        self.path.carry(far);
        self.rounded.carry(far);
        self.turn += ARM_TURN;
        self.turned += turned(joint, curve);
        let Some(drive) = joint.drive else { return };
        let of = curve.bounds(drive.coordinate);
        let factor = drive.factor.abs();
        let error = curve.value_error() * (factor * of.most[0] + drive.offset.abs()) + factor * of.error;
        let most = farthest(joint, curve);
        match joint.kind {
            JointKind::Revolute => self.turn += error,
            JointKind::Prismatic => {
                // The rounding of the value exceeds the part in `ARM_PLACE` by this much.
                self.place += (error - ARM_VALUE * most).at_least(0.0);
                self.reach_on(joint.axis.abs().sum() * most);
            }
        }
        let n = curve.degree() as f64;
        let second = |part: f64| [of.most[1], of.most[2] + part * of.most[1], of.most[3]].map(|x| factor * x);
        self.path.pass(joint.kind, second(CURVE_DIFFERENCE * n), most);
        // The second derivative rounds relative to the first.
        self.rounded.pass(joint.kind, second(n - 1.0), most);
    }
}

/// Bounds of the motion of a link over nested parts of a span, of which so many are used.
#[derive(Clone, Copy, Debug)]
struct SpanBounds {
    parts: [PathBounds; PARTS],
    used: usize,
}

impl SpanBounds {
    fn new(used: usize) -> Self {
        Self {
            parts: [PathBounds::default(); PARTS],
            used,
        }
    }

    /// Passes a joint with bounds of the derivatives of its coordinate. Its origin is at most `far`
    /// from that of the parent link.
    fn pass(&mut self, joint: &TreeJoint, far: f64, curve: &JointCurve, rates: Option<[[f64; 3]; PARTS]>) {
        let parts = &mut self.parts[..self.used];
        parts.iter_mut().for_each(|bounds| bounds.carry(far));
        let (Some(drive), Some(rates)) = (joint.drive, rates) else {
            return;
        };
        let (factor, most) = (drive.factor.abs(), farthest(joint, curve));
        for (bounds, rates) in parts.iter_mut().zip(rates) {
            bounds.pass(joint.kind, rates.map(|x| factor * x), most);
        }
    }

    /// Returns the bounds of the model of a body about its middle.
    ///
    /// Errors count twice, because a bound holds between two rounded poses.
    fn model(mut self, segment: &TreeSegment, body: usize) -> ModelBounds {
        let middle = segment.bodies.middles[body];
        let mut whole = segment.whole[segment.bodies.links[body]];
        let used = self.used;
        if middle != Point3::origin() {
            let far = length(&middle.coords);
            for bounds in &mut self.parts[..used] {
                bounds.carry(far);
            }
            whole.rounded.carry(far);
            whole.reach_on(middle.coords.abs().sum());
        }
        let error = 2.0 * whole.turn + ARM_PLACE + segment.curve.value_error();
        let graded = |parts: &[f64; PARTS], of: &dyn Fn(&PathBounds) -> f64| match used {
            1 => of(&self.parts[0]) * GROWTH,
            _ => self.parts.iter().zip(parts).map(|(b, part)| of(b) * part).sum::<f64>() * GROWTH,
        };
        let [still, even] = [2.0 * whole.turn, error * whole.rounded.rates[0]];
        ModelBounds {
            shift: Remainder([
                2.0 * whole.place,
                2.0 * error * whole.rounded.place[0],
                4.0 * error * whole.rounded.place[1],
                graded(&CUBIC, &|b| b.place[2]),
            ]),
            turn: Remainder([still, even, graded(&SQUARE, &|b| b.bend[0]), 0.0]),
            bend: 4.0 * error * whole.rounded.bend[0],
            jerk: graded(&CUBIC, &|b| b.bend[1]),
        }
    }
}

/// Growth of a bound by the rounding of its terms.
const GROWTH: f64 = 1.0 + ARM_PLACE;

/// Bounds of the model of a body.
#[derive(Clone, Copy, Debug)]
struct ModelBounds {
    shift: Remainder,
    /// Bound of the rotation without the angular acceleration.
    turn: Remainder,
    /// Rounding of the angular acceleration.
    bend: f64,
    /// Bound of the second derivative of the angular velocity.
    jerk: f64,
}

/// State of the recursion from the base outward: one link.
#[derive(Clone, Copy)]
struct LinkMotion {
    pose: Isometry3<f64>,
    linear: Vector3<f64>,
    acceleration: Vector3<f64>,
    angular: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
}

impl LinkMotion {
    fn new(pose: Isometry3<f64>) -> Self {
        Self {
            pose,
            linear: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            angular: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
        }
    }

    /// Passes a joint, to the link that it moves, with the value of its coordinate and its first two
    /// derivatives.
    fn pass(&mut self, joint: &TreeJoint, values: Option<[f64; 3]>) {
        let apart = self.pose.rotation * joint.origin.translation.vector;
        self.carry(&apart);
        let (Some(drive), Some(values)) = (joint.drive, values) else {
            self.pose = joint.after_origin(&self.pose, &apart, 0.0);
            return;
        };
        let [value, rate, bend] = values.map(|x| drive.factor * x);
        let value = value + drive.offset;
        self.pose = joint.after_origin(&self.pose, &apart, value);
        let axis = self.pose.rotation * joint.axis.into_inner();
        match joint.kind {
            JointKind::Revolute => {
                self.angular_acceleration += self.angular.cross(&axis) * rate + axis * bend;
                self.angular += axis * rate;
            }
            JointKind::Prismatic => {
                self.carry(&(axis * value));
                self.linear += axis * rate;
                self.acceleration += self.angular.cross(&axis) * (2.0 * rate) + axis * bend;
            }
        }
    }

    /// Moves the origin along a vector that rotates with the link.
    fn carry(&mut self, along: &Vector3<f64>) {
        let w = self.angular;
        self.linear += w.cross(along);
        self.acceleration += self.angular_acceleration.cross(along) + w.cross(&w.cross(along));
    }

    /// Returns the motion about the middle of a body.
    fn model(mut self, middle: Point3<f64>, bounds: &ModelBounds, span: f64) -> MotionModel {
        if middle != Point3::origin() {
            self.carry(&(self.pose.rotation * middle.coords));
        }
        let Remainder([still, even, ..]) = bounds.turn;
        let now = self.angular_acceleration.norm() * GROWTH + bounds.bend;
        let by_instant = Remainder([still, even, now, bounds.jerk]);
        let near = 0.25 * span;
        let is_instant = by_instant.at(near) < bounds.turn.at(near);
        MotionModel {
            pivot: middle,
            linear: self.linear,
            angular: self.angular,
            acceleration: self.acceleration,
            shift: bounds.shift,
            turn: if is_instant { by_instant } else { bounds.turn },
        }
    }
}
