//! Surfaces over time, against each other and against convex shapes.
//!
//! No plane separates surfaces that reach into each other's hollows, so a look ahead bounds the
//! displacement of all points, as for composites (Mirtich 1996, conservative advancement): bodies
//! that are proven `d` apart stay apart until their points, seen from each other, may have moved by
//! `d`. A measure is as narrow as a part of the distance, so looks near contact are as sharp as
//! those far away, and the number of looks grows with the logarithm of the tolerance.

use alloc::borrow::Cow;

use nalgebra::Point3;

use super::outcome::{Decision, SurfaceCompositeOutcome, SurfaceOutcome, SurfaceShapeOutcome};
use super::search::NetGoal;
use super::shape_tracker::SurfaceShapeTracker;
use super::surface::{Surface, SurfacePoint};
use super::tracker::SurfaceTracker;
use crate::pair::answer::unit;
use crate::polyhedron::{FaceId, Feature, FeaturePair};
use crate::pose::{Operand, RelativePose};
use crate::separation::{Flight, Free, Measure, Proof, Separation, Tangent};
use crate::shape::Shape;
use crate::tuning::patch::{HOPE, MEASURED, NARROWER};

/// Two surfaces that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfacePair<'a> {
    pub(crate) a: &'a Surface,
    pub(crate) b: &'a Surface,
    pub(crate) tracker: &'a mut SurfaceTracker,
}

/// A surface and a convex shape that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfaceShapePair<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) shape: Cow<'a, Shape>,
    /// Which of the two is the surface.
    pub(crate) order: Operand,
    pub(crate) tracker: &'a mut SurfaceShapeTracker,
}

/// Returns the pose of the other body in the frame of a surface that is A or B.
pub(super) fn from_surface(order: Operand, a_from_b: &RelativePose) -> RelativePose {
    if order == Operand::A {
        *a_from_b
    } else {
        a_from_b.swapped()
    }
}

/// Returns a measure with the surface as A as that of the pair, for the pose of the measure.
pub(super) fn in_order(order: Operand, seen: Measure, pose: &RelativePose) -> Measure {
    if order == Operand::A {
        seen
    } else {
        exchanged(&seen, pose)
    }
}

impl From<&SurfaceOutcome> for Measure {
    /// Pieces are the patches of the witnesses, as are the features, the faces of these numbers.
    fn from(o: &SurfaceOutcome) -> Self {
        let face = |at: &SurfacePoint| Feature::Face(FaceId(at.patch));
        Self {
            class: o.class,
            distance: o.distance,
            lower: o.lower,
            upper: o.upper,
            features: Some(FeaturePair {
                a: face(&o.on_a),
                b: face(&o.on_b),
            }),
            pieces: (o.on_a.patch, o.on_b.patch),
            point_on_a: o.point_on_a,
            point_on_b: o.point_on_b,
            normal: o.normal,
            tangent: Tangent::Free,
            by_plane: false,
        }
    }
}

impl From<&SurfaceShapeOutcome> for Measure {
    /// The piece of A is the patch of the witness, as is the feature.
    fn from(o: &SurfaceShapeOutcome) -> Self {
        Self {
            class: o.class,
            distance: o.distance,
            lower: o.lower,
            upper: o.upper,
            features: Some(FeaturePair {
                a: Feature::Face(FaceId(o.on_a.patch)),
                b: o.feature,
            }),
            pieces: (o.on_a.patch, 0),
            point_on_a: o.point_on_a,
            point_on_b: o.point_on_b,
            normal: o.normal,
            tangent: Tangent::Free,
            by_plane: false,
        }
    }
}

impl From<&SurfaceCompositeOutcome> for Measure {
    fn from(o: &SurfaceCompositeOutcome) -> Self {
        let seen = Self::from(&o.closest);
        let pieces = (seen.pieces.0, o.piece);
        Self { pieces, ..seen }
    }
}

/// Returns the measure with A and B exchanged, for the pose of the measure.
pub(crate) fn exchanged(seen: &Measure, pose: &RelativePose) -> Measure {
    Measure {
        features: seen.features.map(FeaturePair::swapped),
        pieces: (seen.pieces.1, seen.pieces.0),
        point_on_a: seen.point_on_b,
        point_on_b: seen.point_on_a,
        normal: unit(&-pose.rotation().tr_mul(&seen.normal)),
        ..*seen
    }
}

/// Returns how long a lower bound lasts, where `lower` takes a width and returns a new bound: asked
/// if the bound seen is far below the distance that is left. The answer is zero if no search comes
/// near that distance.
pub(super) fn held<S: Separation>(
    pair: &mut S,
    seen: &Measure,
    flight: &Flight,
    lower: impl FnOnce(&mut S, &RelativePose, f64) -> f64,
) -> Free {
    let left = seen.upper - flight.keep;
    let mut bound = seen.lower;
    if left > 0.0
        && bound - flight.keep < (1.0 - NARROWER) * left
        && let Ok(pose) = RelativePose::new(&flight.pose_a, &flight.pose_b)
    {
        bound = bound.max(lower(pair, &pose, MEASURED * left));
    }
    let proof = Proof::Own;
    if bound - flight.keep < HOPE * left {
        return Free { span: 0.0, proof };
    }
    let way = bound - flight.keep - flight.apart(pair).noise;
    let span = flight.held(pair, way);
    Free { span, proof }
}

impl Separation for SurfacePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == Operand::A { self.a } else { self.b }.bounding_ball()
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Measure::from(&self.tracker.answer(self.a, self.b, a_from_b, NetGoal::Part(MEASURED)))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        self.tracker.within(self.a, self.b, a_from_b, distance) == Decision::Yes
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, pose, width| {
            pair.tracker.closest(pair.a, pair.b, pose, width).lower
        })
    }
}

impl Separation for SurfaceShapePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == self.order {
            self.surface.bounding_ball()
        } else {
            self.shape.bounding_ball()
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        let pose = from_surface(self.order, a_from_b);
        let goal = NetGoal::Part(MEASURED);
        let found = self.tracker.answer(self.surface, &self.shape, &pose, goal);
        in_order(self.order, Measure::from(&found), &pose)
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        let pose = from_surface(self.order, a_from_b);
        self.tracker.within(self.surface, &self.shape, &pose, distance) == Decision::Yes
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, a_from_b, width| {
            let pose = from_surface(pair.order, a_from_b);
            pair.tracker.closest(pair.surface, &pair.shape, &pose, width).lower
        })
    }
}
