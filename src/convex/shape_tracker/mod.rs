//! The state that a caller keeps per pair of shapes, and the conversion of an outcome of two cores.
//!
//! The outcome of the cores becomes the outcome of the rounded shapes ([`grow`]), or the outcome
//! along the normal of a face, independent of the closest features ([`along_face`]). This file also
//! tests points in a shape. `manifold` computes contacts from the outcomes.

mod manifold;

use crate::base::num::extremes::Bounded;
use crate::base::num::packed::PackedVec3;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, Feature, FeaturePair};
use crate::body::shape::{Core, Curved, Shape, Support, match_core};
use crate::convex::replay::Replay;
use crate::convex::smooth;
use crate::convex::tracker::{Tracker, TrackerWork};
use crate::pair::outcome::{Accuracy, ContactState, DepthMode, Outcome};
use crate::pair::rounding;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// Closest features of the last outcome of one pair of shapes, from which the next query starts.
///
/// The counterpart of [`Tracker`] for every kind of [`Shape`]. It owns no shape. A tracker of
/// another pair, or one that is out of date, costs time and never makes a result wrong.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ShapeTracker {
    polyhedral: Tracker,
    curved: smooth::WarmStart,
    totals: TrackerWork,
}

impl ShapeTracker {
    /// Returns a tracker that starts cold.
    #[must_use]
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Returns a tracker whose first query of two shapes, one of them curved, starts along a
    /// direction from A to B.
    ///
    /// The direction is in the frame of A.
    pub(crate) fn along(n: &Vector3<f64>) -> Self {
        Self {
            curved: smooth::WarmStart::along(n),
            ..Self::default()
        }
    }

    /// Returns the closest points of two shapes, their signed distance and its bounds.
    ///
    /// `PairTracker::closest` describes them. Features belong to the cores. Depths are searched to
    /// an interval of `2^-19 L` by a limited number of support points, unless balls inside the
    /// cores prove them, or cylinders and cones have parallel axes. If the shapes have a common
    /// centre and many directions are nearly as deep, the interval may stay wider.
    pub(crate) fn closest(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose) -> Outcome {
        self.measure(a, b, a_from_b, DepthMode::Full)
    }

    /// Returns the closest points; for an overlap, with the depth or a local depth.
    pub(crate) fn measure(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose, until: DepthMode) -> Outcome {
        match (a.core(), b.core()) {
            (Core::Polyhedron(x), Core::Polyhedron(y)) => {
                let mut outcome = self.polyhedral.checked(x, y, a_from_b, until);
                let radii = [a.rounding_radius(), b.rounding_radius()];
                if radii != [0.0; 2] {
                    self::grow([x, y], a_from_b, radii, &mut outcome);
                }
                outcome
            }
            (x, y) => {
                let mut outcome = smooth::closest(x, y, a_from_b, DepthMode::Full, &mut self.curved);
                self.count(&outcome);
                let radii = [a.rounding_radius(), b.rounding_radius()];
                if radii != [0.0; 2] {
                    self::shift(a_from_b, radii, &mut outcome);
                }
                outcome
            }
        }
    }

    /// Returns the closest points; for polyhedra whose cores overlap, the contact state without the
    /// depth.
    ///
    /// Then the upper bound is minus the sum of the radii, and the witnesses are those of the
    /// cores.
    pub(crate) fn closest_or_class(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose) -> Outcome {
        let (Core::Polyhedron(x), Core::Polyhedron(y)) = (a.core(), b.core()) else {
            return self.closest(a, b, a_from_b);
        };
        let radii = [a.rounding_radius(), b.rounding_radius()];
        let mut outcome = self.polyhedral.closest_or_class(x, y, a_from_b);
        if outcome.state == ContactState::Overlapping {
            outcome.distance = rounding::less(outcome.distance, radii);
            [_, outcome.upper] = rounding::bounds([outcome.lower, outcome.upper], radii);
        } else if radii != [0.0; 2] {
            self::grow([x, y], a_from_b, radii, &mut outcome);
        }
        outcome
    }

    /// Returns whether the closed shapes are at most `d` apart, in the caller's unit.
    ///
    /// False if `d` is negative or NaN.
    ///
    /// For polyhedra, rounded or not, the result equals exact arithmetic on the poses, the radii
    /// and the `d` given (with the feature `exact`). For other shapes, a distance that the bounds
    /// cannot distinguish from `d` counts as within. For such a `d` the result may depend on the
    /// last query, which moves the bounds by less than their width.
    pub(crate) fn within(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose, d: f64) -> bool {
        match (a.core(), b.core()) {
            (Core::Polyhedron(x), Core::Polyhedron(y)) => {
                self.polyhedral
                    .within_reach(x, y, a_from_b, [d, a.rounding_radius(), b.rounding_radius()])
            }
            _ => d >= 0.0 && self.closest(a, b, a_from_b).lower <= d,
        }
    }

    /// Returns the query as a text that rebuilds the query bit for bit, like [`Tracker::replay`].
    ///
    /// `None` unless both cores are polyhedra.
    #[must_use]
    pub(crate) fn replay(&self, a: &Shape, b: &Shape, a_from_b: &RelativePose) -> Option<Replay> {
        let (Core::Polyhedron(x), Core::Polyhedron(y)) = (a.core(), b.core()) else {
            return None;
        };
        Some(Replay {
            rounding_radii: [a.rounding_radius(), b.rounding_radius()],
            ..self.polyhedral.replay(x, y, a_from_b, Accuracy::Certified)
        })
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub(crate) fn work(&self) -> TrackerWork {
        let mut totals = self.totals;
        totals += self.polyhedral.work();
        totals
    }

    fn count(&mut self, outcome: &Outcome) {
        self.totals.note(false, outcome.solver, &outcome.work);
    }
}

impl Replay {
    /// Returns a tracker of [`shapes`](Self::shapes) with the recorded start.
    #[must_use]
    pub(crate) fn shape_tracker(&self) -> ShapeTracker {
        ShapeTracker {
            polyhedral: self.tracker(),
            ..ShapeTracker::default()
        }
    }
}

impl Shape {
    /// Returns whether the closed shape contains a point; `false` for a point that is not finite.
    ///
    /// The result is right up to rounding of `1e-14` times the size of the shape, and exact for
    /// polyhedra that are not rounded.
    #[must_use]
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        if let Core::Polyhedron(body) = self.core() {
            let near = || {
                body.closest_point(point)
                    .is_some_and(|p| (p - point).norm() <= self.rounding_radius())
            };
            return body.contains(point) || self.rounding_radius() > 0.0 && near();
        }
        if self.rounding_radius() > 0.0 {
            return self.is_near(point).unwrap_or(false);
        }
        match_core!(self.core(), _ => false, core => core.contains(&point.coords))
    }

    /// Returns whether a rounded shape contains a point, from the distance of the point.
    fn is_near(&self, point: &Point3<f64>) -> Option<bool> {
        let point = Self::from(ConvexPolyhedron::point(*point).ok()?);
        let pose = RelativePose::from_isometry(&Isometry3::identity()).ok()?;
        Some(ShapeTracker::new().within(self, &point, &pose, 0.0))
    }
}

/// Returns the gap between the plane of a face of A and a core B, along the outward normal of the
/// face, as an outcome.
///
/// The gap is a lower bound of the signed distance, correct up to rounding. `upper` is also set to
/// the gap, but is not a bound. Returns `None` if A does not have the face.
pub(crate) fn along_face(a: &ConvexPolyhedron, face: FaceId, b: &Core, a_from_b: &RelativePose) -> Option<Outcome> {
    let (normal, offset) = a.face_plane(face)?;
    let rotation = a_from_b.rotation();
    let (feature, lowest) = support(b, &-rotation.tr_mul(&normal))?;
    let place = rotation * lowest + a_from_b.translation();
    let gap = normal.dot(&place) - offset;
    let features = FeaturePair {
        a: Feature::Face(face),
        b: feature,
    };
    Some(Outcome {
        state: if gap > 0.0 {
            ContactState::Separated
        } else {
            ContactState::Overlapping
        },
        distance: gap,
        lower: gap,
        upper: gap,
        point_on_a: Point3::from(place - normal.into_inner() * gap),
        point_on_b: Point3::from(lowest),
        normal,
        ..Outcome::starting_at(features)
    })
}

/// Returns the outcome with the bodies in the other order.
pub(crate) fn swapped(outcome: &Outcome, b_from_a: &RelativePose) -> Outcome {
    let normal = -b_from_a.rotation().tr_mul(&outcome.normal);
    Outcome {
        features: outcome.features.swapped(),
        point_on_a: outcome.point_on_b,
        point_on_b: outcome.point_on_a,
        normal: Unit::new_unchecked(normal),
        ..*outcome
    }
}

/// Returns the support point of a core along a unit direction, and its feature.
fn support(core: &Core, n: &Vector3<f64>) -> Option<(Feature, Vector3<f64>)> {
    fn of<S: Support>(core: &S, n: &Vector3<f64>) -> (Feature, Vector3<f64>) {
        let (branch, point) = core.support::<f64>(&[n.x, n.y, n.z], 0);
        let point = Vector3::from(point);
        (core.feature(&[branch], &point), point)
    }
    Some(match_core!(core, body => {
        let v = body.extreme_vertex(n);
        (Feature::Vertex(v), body.vertex(v)?.coords)
    }, core => of(core, n)))
}

/// Moves distance, bounds and witnesses of the cores outward by both radii.
///
/// Returns whether the bounds leave the contact state undecided.
#[inline]
pub(super) fn shift(pose: &RelativePose, radii: [f64; 2], outcome: &mut Outcome) -> bool {
    outcome.distance = rounding::less(outcome.distance, radii);
    [outcome.lower, outcome.upper] = rounding::bounds([outcome.lower, outcome.upper], radii);
    let n = *outcome.normal;
    outcome.point_on_a += n * radii[0];
    if radii[1] > 0.0 {
        outcome.point_on_b -= pose.vector_in_b(PackedVec3::new(&n)).vector() * radii[1];
    }
    outcome.state = match outcome.state {
        _ if outcome.lower > 0.0 => ContactState::Separated,
        _ if outcome.upper < 0.0 => ContactState::Overlapping,
        ContactState::Undecided => ContactState::Undecided,
        _ => ContactState::Touching,
    };
    outcome.lower <= 0.0 && 0.0 <= outcome.upper
}

/// Moves the outcome of two polyhedra outward by both radii.
///
/// If the bounds leave the contact state undecided, exact arithmetic decides it.
#[inline]
pub(super) fn grow(cores: [&ConvexPolyhedron; 2], pose: &RelativePose, radii: [f64; 2], outcome: &mut Outcome) {
    if shift(pose, radii, outcome) {
        settle(cores, pose, radii, outcome);
    }
}

#[cfg(feature = "exact")]
#[cold]
fn settle([a, b]: [&ConvexPolyhedron; 2], pose: &RelativePose, radii: [f64; 2], outcome: &mut Outcome) {
    use crate::pair::outcome::Solver;
    use core::cmp::Ordering;
    let hint = outcome.features.vertices_of(a, b).into();
    outcome.work.exacts += 1;
    outcome.solver = Solver::Exact;
    match crate::convex::exact::compare(a, b, pose, hint, &radii) {
        Ordering::Greater => {
            outcome.state = ContactState::Separated;
            outcome.lower = outcome.lower.at_least(0.0);
        }
        Ordering::Equal => {
            outcome.state = ContactState::Touching;
            (outcome.lower, outcome.upper) = (0.0, 0.0);
        }
        Ordering::Less => {
            outcome.state = ContactState::Overlapping;
            outcome.upper = outcome.upper.at_most(0.0);
        }
    }
    outcome.distance = outcome.distance.clamped(outcome.lower, outcome.upper);
}

#[cfg(not(feature = "exact"))]
fn settle(_: [&ConvexPolyhedron; 2], _: &RelativePose, _: [f64; 2], _: &mut Outcome) {}
