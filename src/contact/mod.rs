//! Contact manifolds: the few points at which two bodies hold each other apart, kept from frame to
//! frame; and gradients of the signed distance.
//!
//! A manifold starts from a certified outcome: normal, features, witnesses. The features are
//! promoted to the faces (or edges) within a small angle of the normal ([`promote`]), both are
//! projected along the normal ([`shadow`]), and the vertices of their overlap ([`clip`], and
//! [`rims`] for faces of many vertices) are the contact candidates. A few candidates are kept
//! ([`mod@reduce`]): the deepest, and the points that span the most area. [`manifold`] keeps the
//! contacts over frames.
//!
//! Every pair of points (a of A, b of B) satisfies `n . b - n . a >= lower`, the bound of the
//! outcome, so the deepest contact is the outcome's own; no contact can be deeper.
//!
//! Source: the clipping of a reference and an incident face (Gregorius 2013, "The separating axis
//! test between convex polyhedra", GDC). Departures:
//! 1. Both faces are projected along the certified normal, and play equal parts: points on A and on
//!    B lie opposite each other along the normal, whichever body is named first.
//! 2. The reference only determines the body with which the normal rotates between two outcomes.
//! 3. Old contacts are matched by a bound on the motion of the bodies, not by distances of points.

mod axes;
mod clip;
mod corners;
mod gradient;
mod keep;
mod manifold;
mod options;
mod promote;
mod query;
mod reduce;
mod rims;
mod shadow;

use nalgebra::{Matrix3, Point3, Vector3};

use crate::num::scalar::sqrt;
use crate::pair::outcome::{Outcome, Solver};
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::tolerance::{ACROSS, AGREE, STEEP};
use axes::Axes;
use corners::{ContactCandidate, Corners, Location};
use keep::Shadows;
use promote::Promotion;
use reduce::reduce;
use rims::Rays;
use shadow::{LazyProjection, ProjectedFeature};

pub use gradient::Gradient;
pub use manifold::{ContactPoint, Manifold};
pub use options::ManifoldOptions;
pub(crate) use query::Query;

/// Most points of a manifold.
pub(crate) const MOST_POINTS: usize = 8;

/// The contacts of an outcome.
struct Contacts {
    points: [ContactPoint; MOST_POINTS],
    count: usize,
    /// Features that bear the contacts.
    features: FeaturePair,
    /// Location of each contact on both features.
    on: [[Location; 2]; MOST_POINTS],
    /// Lower bound of each vertex's distance to the boundary of the opposite face.
    margins: [f64; MOST_POINTS],
    /// Whether the contacts are the previous manifold's, in the previous order.
    same: bool,
    rays: Rays,
}

/// Two bodies, the rotation of `a_from_b`, and the certified outcome.
#[derive(Clone, Copy)]
struct Answer<'a> {
    a: &'a ConvexPolyhedron,
    b: &'a ConvexPolyhedron,
    rotation: &'a Matrix3<f64>,
    /// The pair's size L, in the caller's units.
    size: f64,
    outcome: &'a Outcome,
}

impl Answer<'_> {
    /// Returns the contacts of an outcome whose lower bound is within the prediction. `lasts` is
    /// the motion of the bodies since the candidates were chosen, if the choice may be kept.
    fn contacts(self, options: &ManifoldOptions, before: &Manifold, lasts: Option<f64>) -> Contacts {
        let outcome = self.outcome;
        let mut contacts = Contacts {
            points: [ContactPoint::witness(outcome); MOST_POINTS],
            count: 1,
            features: outcome.features,
            on: [ContactCandidate::WITNESS; MOST_POINTS],
            margins: [0.0; MOST_POINTS],
            same: false,
            rays: before.rays,
        };
        // If the bodies are very far apart or very different in size, the witnesses are the only
        // contact.
        if self.a.exponent != self.b.exponent || outcome.solver == Solver::Far {
            return contacts;
        }
        let axes = self.axes();
        let features = self.promoted(&axes, options, before.features());
        contacts.features = features;
        if features.a.dimension() > 0 && features.b.dimension() > 0 && self.bears(&axes, features) {
            self.share(&axes, options, before, lasts, &mut contacts);
        }
        contacts
    }

    /// Computes the contacts of two features, each an edge or a face.
    // Not inlined: most contacts of round bodies involve a vertex and need none of the stack space.
    #[inline(never)]
    fn share(
        self,
        axes: &[Axes; 2],
        options: &ManifoldOptions,
        before: &Manifold,
        lasts: Option<f64>,
        contacts: &mut Contacts,
    ) {
        let features = contacts.features;
        let mut shadows = Shadows {
            a: LazyProjection::new(self.a, features.a, &axes[0], false),
            b: LazyProjection::new(self.b, features.b, &axes[1], true),
        };
        let lasts = lasts.filter(|_| before.features() == Some(features));
        if lasts.is_some_and(|moved| shadows.keep(&self, options, before, moved, contacts)) {
            return;
        }
        let seen = Seen {
            answer: self,
            a: shadows.a.seen(),
            b: shadows.b.seen(),
            unit: self.a.unit(),
        };
        seen.choose(options, before, contacts);
    }

    /// Returns the contact axes in each body's stored frame, about the body's witness.
    #[inline(always)]
    fn axes(&self) -> [Axes; 2] {
        let normal = self.outcome.normal.into_inner();
        let across = across(&normal);
        [
            Axes {
                across,
                normal,
                witness: self.a.stored(&self.outcome.point_on_a),
            },
            Axes {
                across: across.map(|v| self.rotation.tr_mul(&v)),
                normal: self.rotation.tr_mul(&normal),
                witness: self.b.stored(&self.outcome.point_on_b),
            },
        ]
    }

    /// Returns the rounding of a plane coordinate, in stored units.
    fn noise(&self) -> f64 {
        ACROSS * self.size / self.a.unit()
    }

    /// Returns the features that bear the contact.
    #[inline(always)]
    fn promoted(&self, axes: &[Axes; 2], options: &ManifoldOptions, before: Option<FeaturePair>) -> FeaturePair {
        let promote = |body, outward, feature, kept| {
            let promotion = Promotion {
                body,
                outward,
                sine: options.sine,
                kept,
            };
            promotion.of(feature)
        };
        let closest = self.outcome.features;
        FeaturePair {
            a: promote(self.a, axes[0].normal, closest.a, before.map(|f| f.a)),
            b: promote(self.b, -axes[1].normal, closest.b, before.map(|f| f.b)),
        }
    }

    /// Returns whether no promoted face is upright, as a closest face may be if a facet of A - B is
    /// smaller than rounding.
    #[inline(always)]
    fn bears(&self, axes: &[Axes; 2], features: FeaturePair) -> bool {
        let is_across = |body: &ConvexPolyhedron, feature: Feature, outward: Vector3<f64>| match feature {
            Feature::Face(f) => body.planes[f.index()].normal.dot(&outward) > STEEP,
            _ => true,
        };
        is_across(self.a, features.a, axes[0].normal) && is_across(self.b, features.b, -axes[1].normal)
    }
}

/// Two features projected along the normal.
struct Seen<'a> {
    answer: Answer<'a>,
    a: &'a ProjectedFeature<'a>,
    b: &'a ProjectedFeature<'a>,
    /// Length of a stored unit in the caller's unit.
    unit: f64,
}

impl Seen<'_> {
    /// Adds the candidates within the prediction, and the witnesses if no candidate is as deep.
    #[inline(always)]
    fn corners(
        &self,
        options: &ManifoldOptions,
        noise: f64,
        before: &Manifold,
        rays: &mut Rays,
        corners: &mut Corners,
    ) {
        let (a, b) = (self.a, self.b);
        if a.is_edge() && b.is_edge() {
            clip::beside(a, b, options.sine, corners);
        } else if a.is_large() || b.is_large() {
            let middle = |p: &Point3<f64>| a.place_of(&self.answer.a.stored(p));
            let hint = before.middle().as_ref().map(middle);
            rims::clip([a, b], noise, hint, options.most(), rays, corners);
        } else {
            clip::clip(a, b, noise, corners);
        }
        if !self.has_deepest(corners) {
            corners.push([0.0; 2], [0.0; 2], ContactCandidate::WITNESS);
        }
    }

    /// Returns whether a candidate is as deep as the outcome.
    #[inline(always)]
    fn has_deepest(&self, corners: &Corners) -> bool {
        let deep = (self.answer.outcome.upper + AGREE * self.answer.size) / self.unit;
        corners.all().iter().any(|c| c.separation <= deep)
    }

    #[inline(always)]
    fn none(&self, options: &ManifoldOptions) -> Corners {
        Corners::new(self.answer.outcome.distance / self.unit, options.prediction / self.unit)
    }

    #[inline(always)]
    fn choose(&self, options: &ManifoldOptions, before: &Manifold, contacts: &mut Contacts) {
        let Answer { a, b, outcome, .. } = self.answer;
        let (mut corners, noise) = (self.none(options), self.answer.noise());
        self.corners(options, noise, before, &mut contacts.rays, &mut corners);
        let merge = noise.max(options.drift * a.radius.min(b.radius));
        let kept = self.kept(corners.all(), options, before);
        let chosen = reduce(corners.all(), kept, options.most(), merge, noise);
        contacts.count = 0;
        for &k in chosen.all() {
            let corner = &corners.all()[k];
            let point = if corner.on == ContactCandidate::WITNESS {
                ContactPoint::witness(outcome)
            } else {
                self.contact(corner, self.name(corner))
            };
            // If rounding has split a feature, the witnesses may have the features of a nearby
            // candidate.
            let before = &contacts.points[..contacts.count];
            if before.iter().all(|p| p.features != point.features) {
                contacts.points[contacts.count] = point;
                contacts.on[contacts.count] = corner.on;
                contacts.margins[contacts.count] = self.margin(corner, options);
                contacts.count += 1;
            }
        }
    }

    /// Lower bound of a candidate vertex's distance to the boundary of the opposite face.
    fn margin(&self, corner: &ContactCandidate, options: &ManifoldOptions) -> f64 {
        let inside = match corner.on.map(Location::as_corner) {
            [Some(_), _] => self.b.inside_by(corner.at),
            [_, Some(_)] => self.a.inside_by(corner.at),
            _ => 0.0,
        };
        keep::margin(inside * self.unit, corner.separation * self.unit, options)
    }

    /// Returns a bit mask of the candidates that the previous manifold contained; zero if all
    /// candidates fit or the features changed.
    fn kept(&self, corners: &[ContactCandidate], options: &ManifoldOptions, before: &Manifold) -> u64 {
        if corners.len() <= options.most() || before.features() != Some(self.features()) {
            return 0;
        }
        let bit = |(k, c): (usize, &ContactCandidate)| u64::from(before.on().contains(&c.on)) << k;
        corners.iter().enumerate().map(bit).fold(0, |bits, bit| bits | bit)
    }

    fn features(&self) -> FeaturePair {
        FeaturePair {
            a: self.a.feature,
            b: self.b.feature,
        }
    }

    fn name(&self, corner: &ContactCandidate) -> FeaturePair {
        if corner.on == ContactCandidate::WITNESS {
            return self.answer.outcome.features;
        }
        let [a, b] = corner.on;
        FeaturePair {
            a: self.a.name(a),
            b: self.b.name(b),
        }
    }

    fn contact(&self, corner: &ContactCandidate, features: FeaturePair) -> ContactPoint {
        let [on_a, on_b] = corner.on;
        ContactPoint {
            point_on_a: self.answer.a.to_user(&self.a.point(on_a, corner.at)),
            point_on_b: self.answer.b.to_user(&self.b.point(on_b, corner.at)),
            separation: corner.separation * self.unit,
            features,
            id: features,
        }
    }
}

impl ConvexPolyhedron {
    /// Converts a point from the caller's coordinates to stored coordinates.
    fn stored(&self, given: &Point3<f64>) -> Vector3<f64> {
        if self.is_unscaled {
            given.coords
        } else {
            (given.coords - self.origin) / self.unit()
        }
    }
}

/// Returns two unit directions perpendicular to a unit direction and to each other, right-handed
/// with `n`.
fn across(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if n.x.abs() < 0.6 {
        Vector3::new(0.0, -n.z, n.y)
    } else {
        Vector3::new(n.z, 0.0, -n.x)
    };
    let first = other / sqrt(other.norm_squared());
    [first, n.cross(&first)]
}
