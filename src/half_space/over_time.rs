//! A half-space and a body over time: a plane that rotates with the half-space.
//!
//! A half-space is in no ball. A step needs only the part of it that the body can reach during the
//! step: the points within a radius of its *foot*, the point of its plane closest to its origin.
//! Let D be the distance from the foot to the farthest point of the body at the start. Until some
//! point of the body, seen from the half-space, has moved by `AHEAD D`, the body stays within
//! `(1 + AHEAD) D` of the foot; so a step ends there at the latest, and its proof takes this part
//! for the half-space.

use nalgebra::{Point3, Vector3};

use super::{Above, Effort, HalfSpacePair, length_up};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{CERTIFICATE, HEIGHT, PLANE, ROUND_UP, UNIT};
use crate::time::separation::{FreeSpan, Measurement, PairMotion, Proof, Separation, SupportPoint, Tangent, plane};

/// How far the points of a body may move during a step, in units of the distance from the foot to
/// the farthest point of the body. At least one, so that a step can lead to contact.
const AHEAD: f64 = 2.0;

impl HalfSpacePair<'_> {
    /// Returns an upper bound of the distance from the foot to any point of the body, at the start
    /// of a motion.
    fn farthest(&self, flight: &PairMotion) -> f64 {
        let poses = [&flight.pose_a, &flight.pose_b];
        let of_space = usize::from(self.order == Operand::B);
        let (space, body) = (poses[of_space], poses[1 - of_space]);
        let (centre, radius) = self.body.ball();
        let (foot, offset) = (self.space.foot(), body.translation.vector - space.translation.vector);
        let way = offset + (body.rotation * centre.coords - space.rotation * foot.coords);
        let rounding = PLANE * (offset.abs().sum() + centre.coords.abs().sum() + foot.coords.abs().sum());
        (length_up(&way) + radius + rounding) * ROUND_UP
    }
}

impl Separation for HalfSpacePair<'_> {
    /// The half-space gets the size of the body.
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let (centre, radius) = self.body.ball();
        if of == self.order {
            (self.space.foot(), radius)
        } else {
            (centre, radius)
        }
    }

    fn ball_during(&self, of: Operand, flight: &PairMotion) -> (Point3<f64>, f64) {
        if of == self.order {
            (self.space.foot(), (1.0 + AHEAD) * self.farthest(flight) * ROUND_UP)
        } else {
            self.body.ball()
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        let found = self.outcome(a_from_b, Effort::DEFAULT);
        let tangent = if self.order == Operand::A {
            Tangent::WithA
        } else {
            Tangent::WithB
        };
        Measurement {
            tangent,
            ..Measurement::from(&found)
        }
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        self.outcome(a_from_b, Effort::DEFAULT).upper <= distance
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let length = length_up(direction);
        if !(length > 0.0) {
            return SupportPoint {
                height: 0.0,
                point: Vector3::zeros(),
            };
        }
        if of == self.order {
            // d = s n + e: no point of the part is higher along n than the foot.
            let n = self.space.normal().into_inner();
            let along = n.dot(direction);
            let aside = if along > 0.0 {
                length_up(&(direction - n * along))
            } else {
                length
            };
            let height = (aside + HEIGHT * length) * self.part + HEIGHT * length * self.space.offset().abs();
            return SupportPoint {
                height,
                point: Vector3::zeros(),
            };
        }
        let (centre, _) = self.body.ball();
        let found = self.body.top(&(direction / length), Effort::DEFAULT);
        let (reach, doubt) = self.body.size();
        let (size, point) = (reach + centre.coords.abs().sum(), found.top.point - centre.coords);
        SupportPoint {
            height: direction.dot(&point) + length * (found.top.excess + doubt + CERTIFICATE * UNIT * size),
            point,
        }
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        let farthest = self.farthest(flight);
        let near = flight.held(self, AHEAD * farthest);
        let proof = Proof::Own;
        if let Above::HalfSpace(_) = self.body {
            // Half-spaces that rotate meet at once, far away.
            let rests = flight.model_a.angular == flight.model_b.angular && flight.model_a.angular == Vector3::zeros();
            let way = seen.lower - flight.required - flight.apart(self).noise;
            let span = if rests { flight.held(self, way) } else { 0.0 };
            return FreeSpan { span, proof };
        }
        self.part = (1.0 + AHEAD) * farthest * ROUND_UP;
        let by_plane = plane::free_for(self, seen, flight).span;
        // A span that equals that of the flight proves it whole.
        FreeSpan {
            span: by_plane.smaller(near).at_least(0.0),
            proof,
        }
    }
}
