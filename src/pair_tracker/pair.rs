//! A pair of two geometries of known kinds and their tracker: the questions that every pair
//! answers.

use alloc::string::String;

use nalgebra::{Point3, Unit};

use super::engine::BodyShapes;
use crate::base::num::extremes::Bounded;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::FeaturePair;
#[cfg(feature = "meshes")]
use crate::body::shape::Shape;
#[cfg(feature = "meshes")]
use crate::composite::penetration::PenetrationBounds;
#[cfg(feature = "meshes")]
use crate::composite::pieces::{Composite, CompositeTracker};
use crate::pair::answer::far;
use crate::pair::outcome::{Class, Decision, Outcome};
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::time::separation::{Flight, Free, Measure, PolyhedronPair, Proof, Separation, ShapePair};

/// Two geometries and a borrowed tracker.
pub(super) trait Asked: Separation {
    /// Returns the closest points with bounds of the signed distance.
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer;

    /// Returns whether the geometries are at most `d` apart.
    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision;

    /// Returns a lower bound of the distance, the cheapest to be had.
    fn lower_bound(&mut self, pose: &RelativePose) -> f64 {
        self.answer(pose, &Question::new()).lower.at_least(0.0)
    }

    /// Returns bounds of the penetration depth of two solids.
    #[cfg(feature = "meshes")]
    fn penetration(&mut self, _: &RelativePose) -> Option<PenetrationBounds> {
        None
    }

    /// Returns the first broken invariant of what is kept.
    fn check(&mut self, _: &RelativePose) -> Result<(), String> {
        Ok(())
    }
}

impl Asked for PolyhedronPair<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.ask(pose, question)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.ask_within(pose, d, question)
    }

    #[cfg(feature = "meshes")]
    fn penetration(&mut self, pose: &RelativePose) -> Option<PenetrationBounds> {
        let (a, b, _) = self.sides();
        let [a, b] = [a, b].map(|body| Composite::from(Shape::from(body.clone())));
        CompositeTracker::new().penetration(&a, &b, pose)
    }

    fn check(&mut self, _: &RelativePose) -> Result<(), String> {
        self.sides().2.check()
    }
}

/// Two geometries that no tracker measures: a surface and a mesh with coordinates beyond those of
/// surfaces. Only balls about the origins are known.
#[derive(Debug)]
pub(crate) struct BallPair {
    balls: [(Point3<f64>, f64); 2],
}

impl BallPair {
    pub(super) fn new((a, b): BodyShapes<'_>) -> Self {
        Self {
            balls: [a.bounding_ball(), b.bounding_ball()],
        }
    }

    fn answered(&self, pose: &RelativePose) -> Answer {
        let reach = self.balls.map(|(centre, radius)| centre.coords.norm() + radius);
        let (lower, upper, normal) = far(reach, pose);
        Answer {
            is_reached: false,
            ..Answer::of_convex(Outcome {
                class: if lower > 0.0 {
                    Class::Separated
                } else {
                    Class::Undecided
                },
                distance: 0.5 * lower + 0.5 * upper,
                lower,
                upper,
                point_on_a: self.balls[0].0,
                point_on_b: self.balls[1].0,
                normal: Unit::new_unchecked(normal),
                ..Outcome::starting_at(FeaturePair::FIRST)
            })
        }
    }
}

impl Separation for BallPair {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        self.balls[usize::from(of == Operand::B)]
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Measure::from(&self.answered(a_from_b))
    }

    fn meets(&mut self, _: &RelativePose, _: f64, seen: &Measure) -> bool {
        seen.lower <= 0.0
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        let way = seen.lower - flight.keep - flight.apart(self).noise;
        Free {
            span: flight.held(self, way),
            proof: Proof::Own,
        }
    }
}

impl Asked for BallPair {
    fn answer(&mut self, pose: &RelativePose, _: &Question) -> Answer {
        self.answered(pose)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, _: &Question) -> Decision {
        let found = self.answered(pose);
        if d >= 0.0 {
            Decision::by(found.lower, found.upper, d)
        } else {
            Decision::No
        }
    }
}

impl Asked for ShapePair<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.ask(pose, question)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.ask_within(pose, d, question)
    }

    #[cfg(feature = "meshes")]
    fn penetration(&mut self, pose: &RelativePose) -> Option<PenetrationBounds> {
        let (a, b, _) = self.sides();
        let [a, b] = [a, b].map(|shape| Composite::from(shape.clone()));
        CompositeTracker::new().penetration(&a, &b, pose)
    }
}
