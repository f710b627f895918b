//! A convex shape as the second body: one node that is never split. Its support function gives the
//! exact support value along every direction. A tracker finds its closest point to a point of the
//! surface.

use super::closest::NEWTON;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::bowl::BowlSide;
use super::closest::{CLOSE, Meeting, Meets, Parameters, facing, solve};
use super::gap::NetFrame;
use super::height::NetSide;
use super::net::{BezierPatch, SurfaceJet};
use super::tree::Cut;
use super::tree::Node;
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::pose::{RelativePose, normalize_rotation};
use crate::base::tolerance::UNIT;
use crate::body::shape::Shape;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::Outcome;

/// Displacement, in parameters, over which the rotation of a shape's normal approximates its
/// curvature.
const PROBE: f64 = 1.0 / 65_536.0;

/// How far back a point is moved to find the direction to a close shape without the rounding of a
/// short line, as a fraction of the pair size.
const BACK: f64 = 1.0 / 256.0;

/// Number of dampings of a step towards a shape; each is eight times the one before.
const DAMPINGS: usize = 10;

/// A convex shape as one node.
pub(super) struct ShapeNode<'a> {
    shape: &'a Shape,
    node: Node,
    /// The last direction and the support value along it. Searches query many nodes along one
    /// direction.
    last: (Vector3<f64>, f64),
    /// The index of the last support point of a curved core.
    next: u32,
}

impl<'a> ShapeNode<'a> {
    pub(super) fn new(shape: &'a Shape) -> Self {
        let (centre, radius) = shape.bounding_ball();
        Self {
            shape,
            node: Node::whole(centre.coords, radius, 0.0),
            last: (Vector3::zeros(), 0.0),
            next: 0,
        }
    }
}

impl NetSide for ShapeNode<'_> {
    const IS_CONVEX: bool = true;

    fn node(&self, _: u32) -> &Node {
        &self.node
    }

    fn highest(&mut self, _: u32, n: &Vector3<f64>) -> f64 {
        if self.last.0 != *n {
            self.last = (*n, self.shape.support_height(n));
        }
        self.last.1
    }

    /// The point belongs to the core, because the rounding radius changes no direction between
    /// closest points. The minimum-norm solver ends after few steps on a polyhedral core. Points of
    /// curved cores are all different, so each has a new index.
    fn support(&mut self, id: u32, n: &Vector3<f64>) -> (u32, Vector3<f64>, f64) {
        self.next += 1;
        let (vertex, point) = self.shape.core_point(n);
        (vertex.unwrap_or(self.next), point, self.highest(id, n))
    }

    fn least(&self, _: u32, _: &Vector3<f64>, highest: f64) -> f64 {
        highest
    }

    fn cap(&self, _: u32, _: &Vector3<f64>, highest: f64, _: f64) -> f64 {
        highest
    }

    fn least_above(&self, _: u32, _: &BowlSide) -> Option<f64> {
        None
    }

    fn above(&self, _: u32, _: &BowlSide) -> Option<f64> {
        None
    }

    /// Never used: the node cannot be split.
    fn split(&mut self, id: u32) -> u32 {
        id
    }
}

/// Finds the closest points of a convex shape to points of a surface.
pub(super) struct Feet<'a> {
    patches: &'a [BezierPatch],
    /// A point at the origin.
    point: &'a Shape,
    shape: &'a Shape,
    tracker: &'a mut ShapeTracker,
    frame: &'a NetFrame,
    /// The rotation of `a_from_b`.
    turn: UnitQuaternion<f64>,
}

/// A point of the surface and the closest point of the shape.
struct ShapeFoot {
    at: [f64; 2],
    jet: SurfaceJet,
    found: Outcome,
}

impl<'a> Feet<'a> {
    pub(super) fn new(
        patches: &'a [BezierPatch],
        [point, shape]: [&'a Shape; 2],
        tracker: &'a mut ShapeTracker,
        frame: &'a NetFrame,
        pose: &RelativePose,
    ) -> Self {
        let (a, b) = pose.poses();
        let turn = normalize_rotation(&Isometry3::from_parts(
            Vector3::zeros().into(),
            a.rotation.inverse() * b.rotation,
        ));
        Self {
            patches,
            point,
            shape,
            tracker,
            frame,
            turn: turn.rotation,
        }
    }

    /// Returns the closest point of the shape to a point in A's frame, with the signed distance.
    fn look(&mut self, p: &Vector3<f64>) -> Option<Outcome> {
        let offset = self.frame.translation - p;
        let pose = Isometry3::from_parts(offset.into(), self.turn);
        let pose = RelativePose::from_isometry(&pose).ok()?;
        Some(self.tracker.closest(self.point, self.shape, &pose))
    }

    fn foot(&mut self, patch: &BezierPatch, at: [f64; 2]) -> Option<ShapeFoot> {
        let jet = patch.jet(at);
        let found = self.look(&jet.point)?;
        Some(ShapeFoot { at, jet, found })
    }

    /// Returns the error of a signed distance that the point and the pose cause.
    fn error(&self) -> f64 {
        self.frame.error + self.frame.points
    }

    /// Returns a point closer to the shape, or deeper inside; `None` if no step leads to one. Tries
    /// the support point of a close shape, then Newton's method if the second derivative is
    /// positive definite, then damped steps with the curvature of the shape alone (Levenberg 1944).
    fn step(&mut self, patch: &BezierPatch, now: &ShapeFoot) -> Option<ShapeFoot> {
        let (n, j) = (*now.found.normal, [now.jet.u, now.jet.v]);
        let gradient = j.each(|c| -n.dot(&c));
        let is_held = |k: usize| now.at[k] <= 0.0 && gradient[k] >= 0.0 || now.at[k] >= 1.0 && gradient[k] <= 0.0;
        let held = [is_held(0), is_held(1), true, true];
        if held == [true; 4] {
            return None;
        }
        let right = [gradient[0], gradient[1], 0.0, 0.0];
        if let Some(next) = self.toward_top(patch, now, &held) {
            return Some(next);
        }
        let round = self.roundness(now)?;
        let [uu, uv, vv] = [now.jet.uu, now.jet.uv, now.jet.vv].each(|x| -n.dot(&x));
        let bent = matrix([round[0] + uu, round[1] + uv, round[2] + vv]);
        if let Some(next) = solve(&bent, &right, &held).and_then(|s| self.tried(patch, now, &s)) {
            return Some(next);
        }
        let square = [j[0].norm_squared(), j[1].norm_squared()];
        let mut damping = 1.0 / self.frame.size;
        for _ in 0..DAMPINGS {
            let damped = [round[0] + damping * square[0], round[1], round[2] + damping * square[1]];
            let step = solve(&matrix(damped), &right, &held);
            if let Some(next) = step.and_then(|s| self.tried(patch, now, &s)) {
                return Some(next);
            }
            damping *= 8.0;
        }
        None
    }

    /// Returns a point closer to a close shape, by a step towards the point of the shape that is
    /// lowest over the surface. Near an edge of the shape the curvature of the distance grows as
    /// 1/distance, so normals do not predict the closest point.
    fn toward_top(&mut self, patch: &BezierPatch, now: &ShapeFoot, held: &[bool; 4]) -> Option<ShapeFoot> {
        if now.found.distance.abs() > CLOSE * self.frame.size {
            return None;
        }
        let (p, j) = (now.jet.point, [now.jet.u, now.jet.v]);
        let n = self.frame.direction_in_b(&self.along(now));
        let top = self.shape.core_point(&-n).1 - n * self.shape.rounding_radius();
        let way = self.frame.place(&top) - p;
        let right = [-j[0].dot(&way), -j[1].dot(&way), 0.0, 0.0];
        let square = [j[0].norm_squared(), j[0].dot(&j[1]), j[1].norm_squared()];
        let step = solve(&matrix(square), &right, held)?;
        self.tried(patch, now, &step)
    }

    /// Returns the second derivative of the distance of a point from the shape, in the parameters
    /// of the patch. The entries are 00, 01 and 11 of a non-negative form. They come from the
    /// rotation of the normal over a small displacement, and only steer the search.
    fn roundness(&mut self, now: &ShapeFoot) -> Option<[f64; 3]> {
        let (n, j) = (*now.found.normal, [now.jet.u, now.jet.v]);
        let mut form = [[0.0; 2]; 2];
        for k in 0..2 {
            let turned = *self.look(&(now.jet.point + j[k] * PROBE))?.normal;
            let by = (n - turned) / PROBE;
            form[k] = [by.dot(&j[0]), by.dot(&j[1])];
        }
        let (uu, vv) = (form[0][0].at_least(0.0), form[1][1].at_least(0.0));
        let most = crate::base::num::scalar::sqrt(uu * vv);
        Some([uu, (0.5 * (form[0][1] + form[1][0])).clamped(-most, most), vv])
    }

    fn tried(&mut self, patch: &BezierPatch, now: &ShapeFoot, step: &Parameters) -> Option<ShapeFoot> {
        let mut part = 1.0;
        for _ in 0..2 {
            let at = [0, 1].each(|k| (now.at[k] - part * step[k]).clamped(0.0, 1.0));
            let next = self.foot(patch, at)?;
            if next.found.distance < now.found.distance {
                return Some(next);
            }
            part *= 0.25;
        }
        None
    }

    /// Returns the direction from a point to the shape. If the point is so close that rounding
    /// rotates the line to the shape, this is the normal of the surface if it is nearly parallel to
    /// the line. Otherwise it is the direction from a point farther back, which has the same
    /// closest point.
    fn along(&mut self, foot: &ShapeFoot) -> Vector3<f64> {
        let (n, size) = (*foot.found.normal, self.frame.size);
        let distance = foot.found.distance.abs();
        if distance > CLOSE * size {
            return n;
        }
        let of_surface = facing(&foot.jet.u.cross(&foot.jet.v), &n, size / distance);
        of_surface.unwrap_or_else(|| {
            let back = foot.jet.point - n * (BACK * size);
            self.look(&back).map_or(n, |found| *found.normal)
        })
    }

    /// Returns the close points of a foot. If rounding hides whether the point lies in the shape,
    /// it is the witness of both bodies: its depth is within rounding, and the witness of the shape
    /// may be farther away.
    fn meeting(&mut self, number: u32, foot: &ShapeFoot) -> Meeting {
        let (p, found) = (foot.jet.point, &foot.found);
        let upper = (found.upper + self.error()).at_least(0.0);
        let on_b = if found.distance <= 0.0 && upper > 0.0 {
            self.frame.rotation.tr_mul(&(p - self.frame.translation))
        } else {
            found.point_on_b.coords
        };
        let zero = Vector3::zeros();
        Meeting {
            patches: [number, 0],
            at: [foot.at[0], foot.at[1], 0.0, 0.0],
            on_a: p,
            on_b,
            w: self.frame.place(&on_b) - p,
            tangents: [foot.jet.u, foot.jet.v, zero, zero],
            distance: found.distance.at_least(0.0),
            upper,
            normal: Some(*found.normal),
            along: Some(self.along(foot)),
            feature: found.features.b,
            bowl: None,
        }
    }
}

/// Returns a form in two parameters as a form in four.
fn matrix([uu, uv, vv]: [f64; 3]) -> [Parameters; 4] {
    let mut m = [[0.0; 4]; 4];
    (m[0][0], m[0][1], m[1][0], m[1][1]) = (uu, uv, uv, vv);
    m
}

impl Meets for Feet<'_> {
    /// Stops if the point is proven to lie in the shape, because the upper bound is then zero.
    fn descend(&mut self, [number, _]: [u32; 2], start: [f64; 4]) -> Option<(Meeting, u64)> {
        let patches = self.patches;
        let patch = &patches[number as usize];
        let mut now = self.foot(patch, [start[0], start[1]])?;
        let mut steps = 0;
        while steps < NEWTON && now.found.upper + self.error() > 0.0 {
            steps += 1;
            let Some(next) = self.step(patch, &now) else { break };
            let gained = now.found.distance - next.found.distance;
            now = next;
            if !(gained > 4.0 * UNIT * self.frame.size) {
                break;
            }
        }
        Some((self.meeting(number, &now), steps as u64))
    }

    fn is_closer(&mut self, [number, _]: [u32; 2], [u, v, ..]: [f64; 4], most: f64) -> bool {
        let p = self.patches[number as usize].point(u, v);
        self.look(&p.coords).is_some_and(|found| found.distance < most)
    }

    fn direction(&mut self, patch: u32, [u, v]: [f64; 2]) -> Option<Vector3<f64>> {
        let p = self.patches[patch as usize].point(u, v);
        self.look(&p.coords).map(|found| *found.normal)
    }

    fn cut(&self, side: usize, patch: u32, sides: [[f64; 2]; 2]) -> Option<Cut> {
        (side == 0).then(|| Cut::new(&self.patches[patch as usize], sides))
    }
}
