//! A query for the contacts of two bodies, and the options of a contact manifold.

use nalgebra::{Matrix3, Vector3};

use crate::base::motion::BallAtPose;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::convex::contact::MOST_POINTS;
use crate::convex::contact::bearing::Facet;
use crate::pair::outcome::DepthMode;

/// Options of a contact manifold. An option that is NaN requests nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ManifoldOptions {
    /// Largest separation of a contact, in the caller's unit. With zero only touching or
    /// overlapping bodies have contacts. Between meshes, each pair of convex patches whose boxes
    /// are within this distance costs about 12 µs. A value beyond the size of the bodies queries
    /// every pair: 0.2 s for two meshes of 128 patches each.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub prediction: f64,
    /// Largest number of points, 1 to 8; 4 by default. If a face has more than 24 vertices, not all
    /// vertices of the overlap are examined. For a large face in random poses on another, eight
    /// points span at least 60 % of the overlap, except in a few of a thousand poses. In long and
    /// narrow overlaps they sometimes span much less.
    pub max_points: usize,
    /// Sine of the largest angle between the normal and the normal of a face that carries the
    /// contact; 1/2 (30 degrees) by default. The vertices of such a face within the prediction are
    /// contacts, so a round body rests on its face instead of rolling over one vertex. At 1/64
    /// piles of round hulls penetrate 1.3 times as deep as at 1/2; above 1/2 nothing changes. A
    /// face within one degree of parallel to the normal never carries the contact, at any setting.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub max_face_sine: f64,
    /// Largest motion of the bodies before a manifold is computed again, in radii of the smaller
    /// body; 1/1024 by default. Until then the points stay fixed on the bodies, and only
    /// separations change. Contacts nearer to each other than this are merged. With zero every
    /// motion computes the manifold again.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub rebuild_motion: f64,
    /// Largest motion of the bodies before points are chosen again from the vertices of the overlap
    /// of two faces, in radii of the smaller body; 1/16 by default. Until then the chosen vertices
    /// are kept, as long as they stay in the overlap and include the deepest.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub reselect_motion: f64,
    /// Whether a local depth is enough; false by default. Normal and separations of an overlap then
    /// come from the nearest facet around the last one, in a fraction of the time, even if a
    /// shorter translation separates the bodies: see [`Tracker::closest_with_local_depth`]. This
    /// applies to polyhedra, sharp or rounded, and to curved shapes, whose normal is then that of a
    /// local minimum of the support value. Compounds and meshes keep the depth.
    ///
    /// [`Tracker::closest_with_local_depth`]: crate::Tracker::closest_with_local_depth
    #[cfg_attr(feature = "serde", serde(default))]
    pub local_depth: bool,
}

impl Default for ManifoldOptions {
    fn default() -> Self {
        Self {
            prediction: 0.0,
            max_points: 4,
            max_face_sine: 0.5,
            rebuild_motion: 1.0 / 1024.0,
            reselect_motion: 1.0 / 16.0,
            local_depth: false,
        }
    }
}

impl ManifoldOptions {
    /// Returns the options with another prediction distance, in the caller's unit.
    #[must_use]
    pub const fn prediction(mut self, prediction: f64) -> Self {
        self.prediction = prediction;
        self
    }

    /// Returns the options with another number of points.
    #[must_use]
    pub const fn max_points(mut self, max_points: usize) -> Self {
        self.max_points = max_points;
        self
    }

    /// Returns the options with another [`max_face_sine`](field@Self::max_face_sine).
    #[must_use]
    pub const fn max_face_sine(mut self, sine: f64) -> Self {
        self.max_face_sine = sine;
        self
    }

    /// Returns the options with another [`rebuild_motion`](field@Self::rebuild_motion).
    #[must_use]
    pub const fn rebuild_motion(mut self, motion: f64) -> Self {
        self.rebuild_motion = motion;
        self
    }

    /// Returns the options with another [`reselect_motion`](field@Self::reselect_motion).
    #[must_use]
    pub const fn reselect_motion(mut self, motion: f64) -> Self {
        self.reselect_motion = motion;
        self
    }

    /// Returns the options with or without a local depth.
    #[must_use]
    pub const fn local_depth(mut self, local_depth: bool) -> Self {
        self.local_depth = local_depth;
        self
    }

    /// Returns the depth that the contacts need of an overlap.
    pub(crate) fn until(&self) -> DepthMode {
        DepthMode::of_depth(true, self.local_depth)
    }

    pub(crate) fn most(&self) -> usize {
        self.max_points.clamp(1, MOST_POINTS)
    }
}

/// Identity and size of a body, from which motions are measured.
#[derive(Clone, Copy)]
pub(crate) struct Extent {
    /// Equal for equal bodies only.
    pub(crate) fingerprint: Fingerprint,
    /// Centre and radius of a ball that contains the body.
    pub(crate) origin: Vector3<f64>,
    pub(crate) radius: f64,
    /// Whether stored coordinates are the caller's.
    pub(crate) is_unscaled: bool,
}

impl Extent {
    #[inline(always)]
    pub(crate) fn of(body: &ConvexPolyhedron) -> Self {
        Self {
            fingerprint: body.fingerprint,
            origin: body.origin,
            radius: radius(body),
            is_unscaled: body.is_unscaled,
        }
    }
}

/// Two bodies, their relative pose, and the options of their contacts.
pub(crate) struct Query<'a> {
    extents: [Extent; 2],
    /// The facets of the surfaces that carry the contact.
    pub(crate) facets: [Facet<'a>; 2],
    /// Radii by which the bodies are rounded. Options and outcomes are those of the cores.
    pub(super) radii: [f64; 2],
    /// Rotation of `a_from_b`.
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
    /// Bounding ball of the smaller body at its pose relative to the larger body.
    pub(super) ball: BallAtPose,
    #[cfg(feature = "serde")]
    pub(super) pose: &'a RelativePose,
    pub(super) options: &'a ManifoldOptions,
}

impl<'a> Query<'a> {
    /// Returns the query for two polyhedra.
    #[inline(always)]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &'a RelativePose,
        options: &'a ManifoldOptions,
    ) -> Self {
        let facets = [Facet::Body(a), Facet::Body(b)];
        Self::of([Extent::of(a), Extent::of(b)], facets, pose, options)
    }

    /// Returns the query for two bodies. Their facets are needed for new contacts only.
    #[inline(always)]
    pub(crate) fn of(
        extents: [Extent; 2],
        facets: [Facet<'a>; 2],
        pose: &'a RelativePose,
        options: &'a ManifoldOptions,
    ) -> Self {
        let (rotation, translation) = (pose.rotation(), pose.translation());
        let [a, b] = &extents;
        let (moving, centre, radius) = if b.radius <= a.radius {
            (Operand::B, &b.origin, b.radius)
        } else {
            (Operand::A, &a.origin, a.radius)
        };
        let ball = BallAtPose::new(moving, centre, radius, &rotation, &translation);
        Self {
            extents,
            facets,
            radii: [0.0; 2],
            rotation,
            translation,
            ball,
            #[cfg(feature = "serde")]
            pose,
            options,
        }
    }

    /// Returns the query for bodies that are given by their cores and two rounding radii. The
    /// extents are those of the cores, with the fingerprints of the rounded bodies.
    #[inline]
    pub(crate) fn rounded(mut self, radii: [f64; 2]) -> Self {
        self.radii = radii;
        self
    }

    pub(super) fn bodies(&self) -> [Fingerprint; 2] {
        [self.extents[0].fingerprint, self.extents[1].fingerprint]
    }

    /// Returns the radius of the smaller body.
    pub(super) fn least_radius(&self) -> f64 {
        let [a, b] = &self.extents;
        (a.radius + self.radii[0]).smaller(b.radius + self.radii[1])
    }

    /// Returns how far the bodies may move before the contacts are computed again, for this lower
    /// bound of the outcome.
    pub(super) fn budget(&self, lower: f64) -> f64 {
        if !self.extents.iter().all(|extent| extent.is_unscaled) {
            // If stored coordinates are rescaled, old points would be measured less precisely than
            // new points.
            -1.0
        } else if lower <= self.options.prediction {
            self.options.rebuild_motion * self.least_radius()
        } else {
            lower - self.options.prediction
        }
    }

    /// Returns the pair size L.
    #[inline(always)]
    pub(super) fn size(&self) -> f64 {
        let [a, b] = &self.extents;
        let apart = self.rotation * b.origin + self.translation - a.origin;
        a.radius + b.radius + sqrt(apart.norm_squared())
    }
}

/// Returns the radius around the origin of the stored coordinates, in the caller's unit.
#[inline(always)]
fn radius(body: &ConvexPolyhedron) -> f64 {
    if body.is_unscaled {
        body.radius
    } else {
        body.radius * body.unit()
    }
}
