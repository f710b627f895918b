//! A half-space and a body of any kind: closest points, predicates, motion over time, contacts.
//!
//! ```text
//!         \  body  /
//!          \      /      n      outward normal of the half-space
//!     ^     '----p       p      the lowest point of the body, by its support function
//!   n |          |       d      signed distance: n . p - offset
//!  ___|__________|__d_________
//!     half-space
//! ```
//!
//! The signed distance is the height of the lowest point of the body, for separated and for
//! overlapping bodies: moving the body along the normal by the depth ends an overlap, and no
//! shorter translation does. So one support point answers every query, and no state is cached:
//!
//! - a convex body has a support function ([`Shape::top`], [`ConvexPolyhedron::top`]);
//! - a mesh or a compound is searched by its tree ([`crate::nonconvex::top`]);
//! - a Bézier surface is searched by its control nets, in an interval ([`BezierSurface::top`]).
//!
//! Two half-spaces overlap without end unless their normals are opposite. Normals that are opposite
//! up to rounding ([`OPPOSITE`]) count as opposite, and the distance is that of the two planes.
//!
//! The pair size L is the radius of the body about its origin, plus the distance of the origins,
//! plus the distance of the plane from the origin of the half-space.

#[cfg(feature = "meshes")]
mod contacts;
mod over_time;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::num::double_double::Expansion;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
#[cfg(feature = "surfaces")]
use crate::base::tolerance::SURFACE_POINT;
use crate::base::tolerance::{CERTIFICATE, OPPOSITE, UNIT, UNIT_LENGTH};
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, Feature};
use crate::body::shape::{Shape, Top};
use crate::convex::contact::HalfSpace;
#[cfg(feature = "meshes")]
use crate::nonconvex::parts::{Parted, PartsRef};
#[cfg(feature = "meshes")]
use crate::nonconvex::separation::ball_about;
use crate::pair::draft::unit;
use crate::pair::location::{PairOutcome, WitnessLocation, features_on};
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{ContactState, Decision, DepthMode, Outcome};
use crate::pair::point::PointOutcome;
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;

/// Default width of the interval of a surface, as a fraction of its radius.
#[cfg(feature = "surfaces")]
const WIDTH: f64 = 1.0 / (1u64 << 30) as f64;

/// Default number of splits of a surface.
#[cfg(feature = "surfaces")]
const SPLITS: usize = 20_000;

/// Largest number of splits of a surface, for any request of the caller.
#[cfg(feature = "surfaces")]
const MOST_SPLITS: usize = 1 << 22;

/// The body of a pair with a half-space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Above<'a> {
    Polyhedron(&'a ConvexPolyhedron),
    Shape(&'a Shape),
    #[cfg(feature = "meshes")]
    Parts(PartsRef<'a>),
    #[cfg(feature = "surfaces")]
    Surface(&'a BezierSurface),
    HalfSpace(&'a HalfSpace),
}

/// A half-space and a body, in either order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpacePair<'a> {
    space: &'a HalfSpace,
    body: Above<'a>,
    /// The operand that is the half-space.
    order: Operand,
    /// Radius about the foot of the half-space that contains the other body during the step being
    /// proven.
    part: f64,
}

/// The lowest point of a body over a half-space.
struct Height {
    value: f64,
    lower: f64,
    upper: f64,
    /// The lowest point, in the body's frame, and the point of the plane below it.
    on_body: Vector3<f64>,
    on_plane: Vector3<f64>,
    location: WitnessLocation,
    /// Whether the bounds are as close as requested.
    is_converged: bool,
    /// Whether bounds that straddle zero mean contact.
    is_tight: bool,
}

/// A point of a body that is about the highest along a direction, and where it lies.
struct Found {
    top: Top,
    location: WitnessLocation,
    is_converged: bool,
}

impl Found {
    fn new(top: Top, subshape: u32) -> Self {
        let location = WitnessLocation::new(subshape, top.feature);
        Self {
            top,
            location,
            is_converged: true,
        }
    }
}

/// How closely the highest point of a surface is searched. Other bodies have one answer.
#[derive(Clone, Copy)]
struct Effort {
    width: Option<f64>,
    splits: Option<usize>,
}

impl Effort {
    const DEFAULT: Self = Self {
        width: None,
        splits: None,
    };
}

impl<'a> Above<'a> {
    /// Returns the highest point of the body along a unit direction. A half-space has none.
    fn top(&self, n: &Vector3<f64>, effort: Effort) -> Found {
        // Only a surface is searched with an effort.
        let _ = effort;
        match self {
            Self::Polyhedron(body) => Found::new(body.top(n), 0),
            Self::Shape(shape) => Found::new(shape.top(n), 0),
            #[cfg(feature = "meshes")]
            Self::Parts(body) => {
                let (top, number) = crate::nonconvex::top::top(body, n);
                Found::new(top, number)
            }
            #[cfg(feature = "surfaces")]
            Self::Surface(surface) => {
                let width = effort.width.unwrap_or(WIDTH * surface.reach());
                let splits = effort.splits.unwrap_or(SPLITS).min(MOST_SPLITS);
                let found = surface.top(n, width, splits);
                let top = Top {
                    point: found.point,
                    feature: found.location.feature,
                    excess: found.excess,
                    error: found.error,
                };
                let is_converged = found.excess <= width;
                Found {
                    top,
                    location: found.location,
                    is_converged,
                }
            }
            Self::HalfSpace(space) => {
                let (point, feature) = (space.foot().coords, PLANE);
                let (excess, error) = (f64::INFINITY, 0.0);
                Found::new(
                    Top {
                        point,
                        feature,
                        excess,
                        error,
                    },
                    0,
                )
            }
        }
    }

    /// Returns the largest distance of a point from the body's origin, rounded up, and the error of
    /// its points and heights beyond that of `CERTIFICATE`.
    fn size(&self) -> (f64, f64) {
        let far = |v: &Vector3<f64>| v.abs().sum();
        match self {
            Self::Polyhedron(body) => (body.radius * body.unit() + far(&body.origin), 0.0),
            Self::Shape(shape) => {
                let core = shape.core();
                (core.radius() + far(&core.origin()) + shape.rounding_radius(), 0.0)
            }
            #[cfg(feature = "meshes")]
            Self::Parts(body) => {
                let (side, unit) = (body.side(), body.stored_unit());
                // The heights of nodes and of members err separately.
                let size = side.radius * unit + far(&side.frame.origin);
                (size, side.off * unit + CERTIFICATE * UNIT * size)
            }
            #[cfg(feature = "surfaces")]
            Self::Surface(surface) => (surface.reach(), surface.reach() * SURFACE_POINT),
            Self::HalfSpace(space) => (space.offset().abs(), 0.0),
        }
    }

    /// Returns a ball that contains the body. A half-space has the point of its plane that is
    /// closest to its origin.
    fn ball(&self) -> (Point3<f64>, f64) {
        match self {
            Self::Polyhedron(body) => body.bounding_ball(),
            Self::Shape(shape) => shape.bounding_ball(),
            #[cfg(feature = "meshes")]
            Self::Parts(body) => ball_about(body.corners_of_box()),
            #[cfg(feature = "surfaces")]
            Self::Surface(surface) => surface.bounding_ball(),
            Self::HalfSpace(space) => (space.foot(), 0.0),
        }
    }

    fn is_surface(&self) -> bool {
        match self {
            #[cfg(feature = "surfaces")]
            Self::Surface(_) => true,
            _ => false,
        }
    }
}

impl HalfSpace {
    /// Returns the signed distance of a point, by the exact sum of its products.
    pub(crate) fn outcome_of(&self, point: &Point3<f64>) -> PointOutcome {
        let n = self.normal().into_inner();
        let mut height = Expansion::<10>::new();
        (0..3).for_each(|k| height.add_product(n[k], point[k]));
        height.add(-self.offset());
        let (side, [distance]) = (height.sign(), height.leading());
        // The stored normal has a length of one within 8 UNIT.
        let [lower, upper] = [1.0 - UNIT_LENGTH, 1.0 + UNIT_LENGTH].each(|part| distance * part);
        let mut outcome = PointOutcome {
            state: ContactState::Undecided,
            distance,
            lower: lower.smaller(upper),
            upper: lower.larger(upper),
            point: point - n * distance,
            normal: self.normal(),
            location: WitnessLocation::new(0, PLANE),
        };
        outcome.set_side(side);
        outcome
    }
}

impl<'a> HalfSpacePair<'a> {
    pub(crate) fn new(space: &'a HalfSpace, body: Above<'a>, order: Operand) -> Self {
        let part = 0.0;
        Self {
            space,
            body,
            order,
            part,
        }
    }

    /// Returns the pose of the body in the frame of the half-space.
    fn space_from_body(&self, a_from_b: &RelativePose) -> RelativePose {
        if self.order == Operand::A {
            *a_from_b
        } else {
            a_from_b.swapped()
        }
    }

    /// Returns the lowest point of the body, and its height over the plane.
    fn height(&self, pose: &RelativePose, effort: Effort) -> Height {
        let n = self.space.normal().into_inner();
        let rotation = pose.rotation();
        let down = unit(&-rotation.tr_mul(&n)).into_inner();
        // A sum of sixteenths does not overflow.
        let sixteenth = pose.translation_sixteenth().abs().sum() + self.space.offset().abs() * 0.0625;
        let (reach, doubt) = self.body.size();
        // Rounded to zero only if all lengths are far below the least extent of a body.
        let term = (CERTIFICATE * UNIT * 16.0) * (sixteenth + reach * 0.0625) + doubt + f64::MIN_POSITIVE;
        let place = |on_body: &Vector3<f64>| {
            let at = rotation * on_body + pose.translation();
            (at, n.dot(&at) - self.space.offset())
        };
        let Found {
            top,
            location,
            is_converged,
        } = self.body.top(&down, effort);
        let (at, value) = place(&top.point);
        if let Above::HalfSpace(other) = self.body {
            return self.height_of_plane(other, &down, at, value, term);
        }
        Height {
            value,
            lower: value - (top.excess + term),
            upper: value + (top.error + term),
            on_body: top.point,
            on_plane: at - n * value,
            location,
            is_converged,
            is_tight: !self.body.is_surface(),
        }
    }

    /// Returns the height of another half-space: that of its plane if the normals are opposite.
    fn height_of_plane(
        &self,
        other: &HalfSpace,
        down: &Vector3<f64>,
        at: Vector3<f64>,
        value: f64,
        term: f64,
    ) -> Height {
        let is_opposite = (down - other.normal().into_inner()).amax() <= OPPOSITE;
        let on_plane = at - self.space.normal().into_inner() * value;
        let (value, lower, upper) = if is_opposite {
            (value, value - term, value + term)
        } else {
            (0.0, f64::NEG_INFINITY, -f64::MIN_POSITIVE)
        };
        Height {
            value,
            lower,
            upper,
            on_body: other.foot().coords,
            on_plane,
            location: WitnessLocation::new(0, PLANE),
            is_converged: true,
            is_tight: true,
        }
    }

    /// Returns the closest points; the depth of an overlap is exact for every kind of body.
    pub(crate) fn closest_with(&self, a_from_b: &RelativePose, question: &QueryOptions) -> PairOutcome {
        let effort = Effort {
            width: question.width,
            splits: question.splits,
        };
        let found = self.outcome(a_from_b, effort);
        if question.depth == DepthMode::None || found.outcome.lower == f64::NEG_INFINITY {
            let outcome = found.outcome.without_depth();
            return PairOutcome { outcome, ..found };
        }
        found
    }

    fn outcome(&self, a_from_b: &RelativePose, effort: Effort) -> PairOutcome {
        let height = self.height(&self.space_from_body(a_from_b), effort);
        let locations = [WitnessLocation::new(0, PLANE), height.location];
        let mut outcome = Outcome {
            state: height.state(),
            distance: height.value,
            lower: height.lower,
            upper: height.upper,
            point_on_a: height.on_plane.into(),
            point_on_b: height.on_body.into(),
            normal: self.space.normal(),
            ..Outcome::starting_at(features_on(&locations))
        };
        outcome.unsign_zeros();
        let found = PairOutcome {
            outcome,
            locations,
            is_converged: height.is_converged,
        };
        if self.order == Operand::A {
            return found;
        }
        let mut found = found.swapped(a_from_b);
        found.outcome.normal = Unit::new_unchecked(unit(&found.outcome.normal).into_inner());
        found
    }

    /// Returns whether the distance is at most `d`. Distances that the bounds cannot distinguish
    /// from `d` count as within; those of a surface are undecided.
    pub(crate) fn decide_within(&self, a_from_b: &RelativePose, d: f64, question: &QueryOptions) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let pose = self.space_from_body(a_from_b);
        let mut effort = Effort {
            width: question.width,
            splits: question.splits,
        };
        let mut height = self.height(&pose, effort);
        if !height.is_tight && Decision::by(height.lower, height.upper, d) != Decision::Yes && height.lower <= d {
            effort.width = Some(0.0);
            height = self.height(&pose, effort);
        }
        match Decision::by(height.lower, height.upper, d) {
            Decision::Undecided { .. } if height.is_tight => Decision::Yes,
            decision => decision,
        }
    }
}

/// The only feature of a half-space.
const PLANE: Feature = Feature::Face(FaceId(0));

impl Height {
    fn state(&self) -> ContactState {
        if self.lower > 0.0 {
            ContactState::Separated
        } else if self.upper < 0.0 {
            ContactState::Overlapping
        } else if self.is_tight {
            ContactState::Touching
        } else {
            ContactState::Undecided
        }
    }
}

/// Returns an upper bound of the length of a vector.
fn length_up(v: &Vector3<f64>) -> f64 {
    let largest = v.amax();
    if !(largest > 0.0) {
        return 0.0;
    }
    (largest * sqrt((v / largest).norm_squared()) * crate::base::tolerance::ROUND_UP).larger(largest)
}
