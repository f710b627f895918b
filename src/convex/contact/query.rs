//! A query for the contacts of two bodies.

use nalgebra::{Matrix3, Vector3};

use crate::base::motion::BallAtPose;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::ConvexPolyhedron;

use super::ManifoldOptions;
use super::facet::Facet;

/// Identity and size of a body, by which motions are measured.
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
    /// The parts of the surfaces that bear the contact.
    pub(crate) facets: [Facet<'a>; 2],
    /// Radii by which the bodies are rounded. Options and outcomes are those of the cores.
    pub(super) radii: [f64; 2],
    /// Rotation of `a_from_b`.
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
    /// Bounding ball of the smaller body at its pose relative to the larger body.
    pub(super) ball: BallAtPose,
    pub(super) options: &'a ManifoldOptions,
}

impl<'a> Query<'a> {
    /// Returns the query for two polyhedra.
    #[inline(always)]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &RelativePose,
        options: &'a ManifoldOptions,
    ) -> Self {
        let facets = [Facet::Body(a), Facet::Body(b)];
        Self::of([Extent::of(a), Extent::of(b)], facets, pose, options)
    }

    /// Returns the query for two bodies; their facets are needed for new contacts only.
    #[inline(always)]
    pub(crate) fn of(
        extents: [Extent; 2],
        facets: [Facet<'a>; 2],
        pose: &RelativePose,
        options: &'a ManifoldOptions,
    ) -> Self {
        let (rotation, translation) = (pose.rotation(), pose.translation());
        let [a, b] = &extents;
        let (moving, ball) = if b.radius <= a.radius {
            (Operand::B, (&b.origin, b.radius))
        } else {
            (Operand::A, (&a.origin, a.radius))
        };
        let ball = BallAtPose::new(moving, ball, &rotation, &translation);
        Self {
            extents,
            facets,
            radii: [0.0; 2],
            rotation,
            translation,
            ball,
            options,
        }
    }

    /// Returns the query for the bodies as cores, rounded by two radii; the extents are those of
    /// the cores with the fingerprints of the rounded bodies.
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

    /// Returns how far the bodies may move before the contacts are computed again, for an outcome
    /// with this lower bound.
    pub(super) fn budget(&self, lower: f64) -> f64 {
        if !self.extents.iter().all(|extent| extent.is_unscaled) {
            // If stored coordinates are rescaled, old points would be measured more coarsely than
            // new points.
            -1.0
        } else if lower <= self.options.prediction {
            self.options.drift * self.least_radius()
        } else {
            lower - self.options.prediction
        }
    }

    /// Returns the pair's size L.
    #[inline(always)]
    pub(super) fn size(&self) -> f64 {
        let [a, b] = &self.extents;
        let apart = self.rotation * b.origin + self.translation - a.origin;
        a.radius + b.radius + sqrt(apart.norm_squared())
    }
}

/// Returns the radius about the origin of the stored coordinates, in the caller's unit.
#[inline(always)]
fn radius(body: &ConvexPolyhedron) -> f64 {
    if body.is_unscaled {
        body.radius
    } else {
        body.radius * body.unit()
    }
}
