//! Ray casts: the first point of a ray that lies in a body, between two proven bounds.

mod half_space;
#[cfg(feature = "meshes")]
mod hull;
#[cfg(feature = "meshes")]
mod mesh;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use crate::base::motion::{MotionError, Steady, Velocity};
use crate::base::num::extremes::{Bounded, Extremes};
#[cfg(feature = "meshes")]
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{RelativePose, rigid};
use crate::base::tolerance::{PLACED_BALL, RAY};
use crate::body::polyhedron::{ConvexPolyhedron, Feature};
#[cfg(feature = "meshes")]
use crate::nonconvex::{
    parts::{Centred, Parted},
    query::ray::Met,
};
use crate::pair::options::QueryOptions;
#[cfg(feature = "meshes")]
use crate::pair::transform::about_origins;
use crate::pair_tracker::PairTracker;
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};
use crate::time::impact::{Impact, ImpactError, Tolerance, cast};
use crate::time::separation::{Measurement, Separation};

/// Width of the bracket of a ray cast, as a multiple of the pair size.
///
/// It exceeds the rounding of a position, so that a short segment of the ray proves a crossing.
const RAY_WIDTH: f64 = 1.0 / (1u64 << 40) as f64;

/// Segments of a ray that are tried for a crossing, each twice as long as the one before.
const RAY_CROSSINGS: u32 = 8;

/// A ray: the points `origin + s direction` for `s` from zero on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ray {
    /// The start of the ray, in the world.
    pub origin: Point3<f64>,
    /// The direction, in the world.
    pub direction: Unit<Vector3<f64>>,
}

/// Error of a ray or a ray cast.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// The direction has no length, or is not finite.
    #[error("ray direction is zero or not finite")]
    Direction,
    /// The length of the ray is negative or NaN.
    #[error("ray length {length} is negative or NaN")]
    Length {
        /// The length.
        length: f64,
    },
    /// The pose of the body or the origin of the ray is invalid.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The cast of the point that moves along the ray failed.
    #[error(transparent)]
    Impact(#[from] ImpactError),
}

impl Ray {
    /// Returns the ray from a point along a direction of any length.
    ///
    /// # Errors
    /// Returns an error if the direction has no length or is not finite.
    pub fn new(origin: Point3<f64>, direction: Vector3<f64>) -> Result<Self, RayError> {
        let largest = direction.amax();
        if !(largest > 0.0 && largest < f64::INFINITY) {
            return Err(RayError::Direction);
        }
        let scaled = direction / largest;
        Ok(Self {
            origin,
            direction: Unit::new_unchecked(scaled / sqrt(scaled.norm_squared())),
        })
    }

    /// Returns the point at this distance from the origin.
    #[must_use]
    pub fn at(&self, distance: f64) -> Point3<f64> {
        self.origin + self.direction.into_inner() * distance
    }

    /// Returns the motion of a point along the ray, one unit of length per unit of time.
    pub(crate) fn flight(&self, length: f64) -> Result<Steady, RayError> {
        if !(length >= 0.0) {
            return Err(RayError::Length { length });
        }
        let start = Isometry3::translation(self.origin.x, self.origin.y, self.origin.z);
        let velocity = Velocity::new(self.direction.into_inner(), Vector3::zeros());
        Ok(Steady::new(&start, velocity)?)
    }

    /// Returns the segment of the ray, up to a length, that may lie in a ball; `None` if no segment
    /// does.
    ///
    /// The segment is rounded outward.
    pub(crate) fn within_ball(&self, centre: &Point3<f64>, radius: f64, length: f64) -> Option<[f64; 2]> {
        let way = centre - self.origin;
        let along = way.dot(&self.direction);
        let size = radius + centre.coords.abs().sum() + self.origin.coords.abs().sum();
        let reach = radius + RAY * size;
        let aside = way - self.direction.into_inner() * along;
        // NaN goes on to the cast.
        if sqrt(aside.norm_squared()) > reach {
            return None;
        }
        let (from, until) = ((along - reach).at_least(0.0), (along + reach).smaller(length));
        (from <= until).then_some([from, until])
    }
}

/// The first point of a ray in a body. Distances are measured from the origin of the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RayCast {
    /// No point of the ray, up to its length, lies in the body.
    Miss,
    /// The origin lies in the body, or on its surface.
    Inside,
    /// The ray enters the body after `safe` and at the latest at `hit`.
    Hit(RayHit),
    /// The ray comes so near the body that rounding hides whether they meet.
    ///
    /// Nothing is known beyond `safe`.
    Undecided {
        /// All points up to here lie outside the body.
        safe: f64,
    },
}

impl RayCast {
    /// Returns the distance up to which all points lie outside the body.
    ///
    /// Zero if the origin is inside; `None` for a miss.
    #[must_use]
    pub fn safe(&self) -> Option<f64> {
        match *self {
            Self::Miss => None,
            Self::Inside => Some(0.0),
            Self::Hit(RayHit { safe, .. }) | Self::Undecided { safe } => Some(safe),
        }
    }
}

/// The point at which a ray enters a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RayHit {
    /// All points of the ray up to this distance lie outside the body.
    pub safe: f64,
    /// A point of the ray up to this distance lies in the body.
    pub hit: f64,
    /// The body's point closest to the end of the safe segment, in the world.
    pub point: Point3<f64>,
    /// The outward normal of the body at this point, in the world.
    pub normal: Unit<Vector3<f64>>,
    /// The feature that the ray hits, for bodies with named features.
    pub feature: Option<Feature>,
    /// The triangle or piece of the feature; zero for bodies of one piece.
    pub subshape: u32,
}

/// Casts rays at geometries and caches the state of the last body.
///
/// The bracket is proven at any scale, for grazing rays and for sheets without thickness. A cast
/// takes microseconds. To draw images with rays, use a library that does nothing else.
///
/// * Mesh, closed or open: the result is exact for the ray as given (feature `exact`), so it is
///   never [`RayCast::Undecided`]. The bracket is at most `2e-12 L` wide.
/// * Polyhedron: the result is exact too (features `exact` and `meshes`) if its faces are flat to
///   the last bit, like the faces of hulls. The bracket is about `1e-12 L` wide. An origin outside
///   a polyhedron, at any distance, is never [`RayCast::Inside`] (feature `exact`).
/// * Curved shape, compound, cloud: the result is proven for a point that moves along the ray, up
///   to the rounding of its position. The bracket of a head-on hit is about `1e-12 L` wide. A ray
///   that grazes a compound or a cloud within rounding, or starts so near, is
///   [`RayCast::Undecided`].
/// * Half-space: a closed form. The bracket is about `1e-13 L` wide, divided by the sine of the
///   angle between ray and plane. A ray within rounding of parallel may be [`RayCast::Undecided`].
///   An origin above the plane is never [`RayCast::Inside`] (feature `exact`).
/// * Bézier surface: the result is [`RayCast::Undecided`] if the ray meets the surface, because a
///   point proves no crossing.
///
/// L is the radius of the body plus the distance of its middle from the origin of the ray. A ray
/// that touches a closed mesh or a polyhedron at an edge, or runs in a face, hits it. If a ray
/// grazes a curved shape or a compound, the bracket may be as wide as the segment of the ray that
/// is within rounding, `1e-15 L`, of the surface: `3e-8 L` along a ball, a whole face along a face.
///
/// Without the feature `exact`, a ray that passes an edge or a vertex of a mesh within rounding,
/// `1e-14 L`, gets the result of the moving point. Such a hit may be a miss.
///
/// The point that moves along a ray is a body like any other, and
/// [`impact::cast`](crate::impact::cast) finds its first contact.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
/// use lin_canny::{Geometry, Ray, RayCast, RayCaster, Shape};
///
/// let can = Geometry::from(Shape::cylinder(2.0, 0.5)?);
/// let ray = Ray::new(Point3::new(-4.0, 0.1, 0.0), Vector3::x())?;
/// let at = Isometry3::identity();
/// let found = RayCaster::new().cast(&can, &at, &ray, f64::INFINITY)?;
/// let RayCast::Hit(hit) = found else { panic!("{found:?}") };
/// let expected = 4.0 - (0.25_f64 - 0.01).sqrt();
/// assert!(hit.safe < expected && expected < hit.hit);
/// assert!(hit.hit - hit.safe < 1e-10 && hit.normal.x < -0.97);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "raycast")]
#[doc(alias = "ray cast")]
#[doc(alias = "line of sight")]
#[derive(Clone, Debug)]
pub struct RayCaster {
    /// A point at the origin.
    point: ConvexPolyhedron,
    tracker: PairTracker,
    /// The last compound or cloud that is far from the origin of its frame, about its middle.
    #[cfg(feature = "meshes")]
    centred: Option<(Fingerprint, Centred)>,
}

impl Default for RayCaster {
    fn default() -> Self {
        Self {
            point: ConvexPolyhedron::origin(),
            tracker: PairTracker::new(),
            #[cfg(feature = "meshes")]
            centred: None,
        }
    }
}

impl RayCaster {
    /// Returns a caster that starts cold.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns where a ray enters a body at a pose; the length of the ray may be infinite.
    ///
    /// # Errors
    /// Returns an error if the length is negative or NaN, or if the pose or the ray is not finite
    /// or out of range.
    pub fn cast<'g>(
        &mut self,
        body: impl Into<GeometryRef<'g>>,
        pose: &Isometry3<f64>,
        ray: &Ray,
        length: f64,
    ) -> Result<RayCast, RayError> {
        let body = body.into();
        #[cfg(feature = "meshes")]
        if let Some(found) = self.cast_far(body, pose, ray, length) {
            return found;
        }
        let flight = ray.flight(length)?;
        let still = Steady::new(pose, Velocity::default())?;
        if let Some(space) = body.half_space() {
            return Ok(half_space::entered(space, pose, ray, length));
        }
        let (centre, radius) = body.bounding_ball();
        let (place, reach) = placed_ball(&centre, radius, pose);
        let Some([from, until]) = ray.within_ball(&place, reach, length) else {
            return Ok(RayCast::Miss);
        };
        let width = RAY_WIDTH * (radius + sqrt((place - ray.origin).norm_squared()));
        #[cfg(feature = "meshes")]
        if let Some(mesh) = body.mesh()
            && let Some(found) = mesh::pierce(mesh, pose, ray, [from, until], length, width)
        {
            return Ok(found);
        }
        #[cfg(feature = "meshes")]
        if let Some(hull) = body.polyhedron()
            && let Some(found) = hull::entered(hull, pose, ray, [from, until], length, width)
        {
            return Ok(found);
        }
        let mut pair = self.tracker.pair(body, &self.point);
        let found = cast(&mut pair, &still, &flight, from..until, Tolerance::Distance(width))?;
        let found = match found.impact {
            Impact::Miss => RayCast::Miss,
            Impact::AtStart { seen } if from == 0.0 && is_union(body) && seen.upper > 0.0 => {
                RayCast::Undecided { safe: 0.0 }
            }
            Impact::AtStart { .. } if from == 0.0 => RayCast::Inside,
            Impact::AtStart { seen } => entered(pose, from, from, &seen),
            Impact::Hit { safe, hit, seen } => entered(pose, safe, hit, &seen),
            Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => {
                let crossing = crossing(body, pose, ray, [safe, until], width);
                let seen = crossing.and_then(|_| self.seen(body, pose, &ray.at(safe)));
                match (crossing, seen) {
                    (Some(hit), Some(seen)) => entered(pose, safe, hit, &seen),
                    _ => RayCast::Undecided { safe },
                }
            }
        };
        let found = self.with_origin(found, body, pose, ray);
        #[cfg(feature = "meshes")]
        if let Some(hull) = body.polyhedron()
            && let Some(met) = mesh::proven(hull, pose, ray, [from, until], length, width, &found)
        {
            return Ok(match met {
                Met::Nothing => RayCast::Miss,
                Met::Between(safe, hit) => match self.seen(body, pose, &ray.at(safe)) {
                    Some(seen) => entered(pose, safe, hit, &seen),
                    None => RayCast::Undecided { safe },
                },
            });
        }
        #[cfg(feature = "meshes")]
        if let (RayCast::Hit(hit), Some(mesh)) = (found, body.mesh()) {
            return Ok(mesh::entered(mesh, pose, ray, [hit.safe, hit.hit], None));
        }
        Ok(found)
    }

    /// Returns where a ray enters a compound or a cloud that is far from the origin of its frame;
    /// `None` for other bodies.
    ///
    /// The body is taken about its middle, and the ray from there, so that no rounding is relative
    /// to the distance from the origin.
    #[cfg(feature = "meshes")]
    fn cast_far(
        &mut self,
        body: GeometryRef,
        pose: &Isometry3<f64>,
        ray: &Ray,
        length: f64,
    ) -> Option<Result<RayCast, RayError>> {
        let union = body.union().filter(|union| !union.is_near())?;
        let origins = [&union.side().frame.origin, &Vector3::zeros()];
        let (pose, start) = about_origins(&placed(pose, &ray.origin)?, origins)?.poses();
        let known = self.centred.take().filter(|(of, _)| *of == union.fingerprint());
        let (of, centred) = known.unwrap_or_else(|| (union.fingerprint(), Centred::new(union)));
        let from_start = Ray {
            origin: start.translation.vector.into(),
            ..*ray
        };
        let mut found = self.cast(centred.parts(), &pose, &from_start, length);
        self.centred = Some((of, centred));
        if let Ok(RayCast::Hit(hit)) = &mut found {
            hit.point += ray.origin - from_start.origin;
        }
        Some(found)
    }

    /// Returns the result of a cast after the exact predicate has decided whether the origin is in
    /// the body, if the body is a polyhedron.
    ///
    /// A cast cannot decide this, because it normalises the rotation of the body, and its bounds of
    /// a point next to the body may contain zero.
    fn with_origin(&mut self, found: RayCast, body: GeometryRef, pose: &Isometry3<f64>, ray: &Ray) -> RayCast {
        let is_near = found.safe().is_some_and(|safe| safe <= 0.0) && body.polyhedron().is_some();
        let (Some(at), true) = (placed(pose, &ray.origin), is_near) else {
            return found;
        };
        match (self.tracker.intersects(body, &self.point, &at), found) {
            (true, _) => RayCast::Inside,
            (false, RayCast::Inside) => RayCast::Undecided { safe: 0.0 },
            _ => found,
        }
    }

    /// Returns the body's point closest to a point in the world.
    fn seen(&mut self, body: GeometryRef, pose: &Isometry3<f64>, at: &Point3<f64>) -> Option<Measurement> {
        Some(self.tracker.pair(body, &self.point).measure(&placed(pose, at)?))
    }
}

/// Returns the ball around a body at a pose, enlarged by the rounding of its centre at this pose.
pub(crate) fn placed_ball(centre: &Point3<f64>, radius: f64, pose: &Isometry3<f64>) -> (Point3<f64>, f64) {
    (pose * centre, radius + PLACED_BALL * centre.coords.abs().sum())
}

/// Returns the pose of a point in the frame of a body.
pub(super) fn placed(pose: &Isometry3<f64>, at: &Point3<f64>) -> Option<RelativePose> {
    RelativePose::new(pose, &Isometry3::translation(at.x, at.y, at.z)).ok()
}

/// Returns the hit of a body at a pose, from the measurement at the end of the safe segment.
fn entered(pose: &Isometry3<f64>, safe: f64, hit: f64, seen: &Measurement) -> RayCast {
    let pose = rigid(pose);
    RayCast::Hit(RayHit {
        safe,
        hit,
        point: pose * seen.point_on_a,
        normal: Unit::new_unchecked(pose.rotation * seen.normal.into_inner()),
        feature: seen.features.map(|f| f.a),
        subshape: seen.subshapes[0],
    })
}

/// Returns whether a body is a compound or a cloud, which counts as met unless it is proven apart.
fn is_union(body: GeometryRef) -> bool {
    matches!(body.kind(), GeometryKind::Compound | GeometryKind::Cloud)
}

/// Returns the end of a short segment of the ray that meets the body.
///
/// This proves a hit of a sheet without thickness, which no single f64 point may meet. The ends of
/// the segment are rounded by about a hundredth of `width`.
fn crossing(body: GeometryRef, pose: &Isometry3<f64>, ray: &Ray, [safe, until]: [f64; 2], width: f64) -> Option<f64> {
    let pose = rigid(pose);
    let place = |at: f64| pose.inverse_transform_point(&ray.at(at));
    let rest = RelativePose::from_isometry(&Isometry3::identity()).ok()?;
    let mut tracker = PairTracker::new();
    (0..RAY_CROSSINGS).find_map(|k| {
        let end = (safe + width * f64::from(1u32 << k)).smaller(until);
        let piece = ConvexPolyhedron::segment(place(safe), place(end)).ok()?;
        let meets = tracker.decide_within(body, &piece, &rest, 0.0, &QueryOptions::default());
        let is_proven = meets.is_yes() && (!is_union(body) || tracker.closest(body, &piece, &rest).upper <= 0.0);
        is_proven.then_some(end)
    })
}
