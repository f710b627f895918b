//! Surfaces over time, against each other and against convex shapes.
//!
//! No plane separates surfaces that reach into each other's hollows, so a look ahead bounds the
//! displacement of all points, as for composites (Mirtich 1996, conservative advancement): bodies
//! that are proven `d` apart stay apart until their points, seen from each other, may have moved by
//! `d`. A measure is as narrow as a part of the distance, so looks near contact are as sharp as
//! those far away, and the number of looks grows with the logarithm of the tolerance.

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
///
/// A measure has bounds that are at most a quarter of the distance apart. A hit is proven by a
/// crossing of the surfaces ([`SurfaceTracker::intersects`]), so a tolerance must leave room for
/// one: from some `1e-8` of the size on.
///
/// ```
/// use lin_canny::impact::{Impact, Tolerance, cast};
/// use lin_canny::motion::Steady;
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::patch::{SurfacePair, revolution};
/// use lin_canny::Velocity;
///
/// // Two spheres of radius 1, three apart, at speed 1.
/// let half = 0.5_f64.sqrt();
/// let south: &[[f64; 3]] =
///     &[[0.0, -1.0, 1.0], [1.0, -1.0, half], [1.0, 0.0, 1.0]];
/// let north: &[[f64; 3]] =
///     &[[1.0, 0.0, 1.0], [1.0, 1.0, half], [0.0, 1.0, 1.0]];
/// let sphere = revolution(&[south, north])?;
/// let still = Steady::new(&Isometry3::identity(), Velocity::default())?;
/// let start = Isometry3::translation(-3.0, 0.0, 0.0);
/// let velocity = Velocity::new(Vector3::x(), Vector3::zeros());
/// let flight = Steady::new(&start, velocity)?;
/// let mut pair = SurfacePair::new(&sphere, &sphere);
/// let tolerance = Tolerance::Distance(1e-6);
/// let found = cast(&mut pair, &still, &flight, (0.0, 2.0), tolerance)?;
/// let Impact::Hit { safe, hit, .. } = found.impact else {
///     panic!("{:?}", found.impact)
/// };
/// assert!(safe < 1.0 && 1.0 < hit && hit - safe < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SurfacePair<'a> {
    a: &'a Surface,
    b: &'a Surface,
    tracker: SurfaceTracker,
}

impl<'a> SurfacePair<'a> {
    /// Returns the pair with a new tracker.
    #[must_use]
    pub fn new(a: &'a Surface, b: &'a Surface) -> Self {
        Self::with_tracker(a, b, SurfaceTracker::new())
    }

    /// Returns the pair with a tracker that has followed the pair before.
    #[must_use]
    pub fn with_tracker(a: &'a Surface, b: &'a Surface, tracker: SurfaceTracker) -> Self {
        Self { a, b, tracker }
    }

    /// Returns the tracker, to be kept.
    #[must_use]
    pub fn into_tracker(self) -> SurfaceTracker {
        self.tracker
    }
}

/// A surface and a convex shape that can be measured over time.
///
/// A measure has bounds that are at most a quarter of the distance apart. A hit is proven by a
/// point of the surface within the shape.
#[derive(Clone, Debug)]
pub struct SurfaceShapePair<'a> {
    surface: &'a Surface,
    shape: &'a Shape,
    /// Which of the two is the surface.
    order: Operand,
    tracker: SurfaceShapeTracker,
}

impl<'a> SurfaceShapePair<'a> {
    /// Returns the pair of a surface A and a shape B with a new tracker.
    #[must_use]
    pub fn new(a: &'a Surface, b: &'a Shape) -> Self {
        Self::with_tracker(a, b, SurfaceShapeTracker::new())
    }

    /// Returns the pair of a surface A and a shape B with a tracker that has followed the pair
    /// before.
    #[must_use]
    pub fn with_tracker(a: &'a Surface, b: &'a Shape, tracker: SurfaceShapeTracker) -> Self {
        Self {
            surface: a,
            shape: b,
            order: Operand::A,
            tracker,
        }
    }

    /// Returns the pair with the shape as A and the surface as B.
    #[must_use]
    pub fn swapped(mut self) -> Self {
        self.order = if self.order == Operand::A {
            Operand::B
        } else {
            Operand::A
        };
        self
    }

    /// Returns the tracker, to be kept.
    #[must_use]
    pub fn into_tracker(self) -> SurfaceShapeTracker {
        self.tracker
    }
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
        let found = self.tracker.answer(self.surface, self.shape, &pose, goal);
        in_order(self.order, Measure::from(&found), &pose)
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        let pose = from_surface(self.order, a_from_b);
        self.tracker.within(self.surface, self.shape, &pose, distance) == Decision::Yes
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, a_from_b, width| {
            let pose = from_surface(pair.order, a_from_b);
            pair.tracker.closest(pair.surface, pair.shape, &pose, width).lower
        })
    }
}
