//! Contact manifolds: a few points at which two bodies touch, kept from frame to frame; and
//! gradients of the signed distance.
//!
//! A manifold starts from a certified outcome: normal, features and witness points. The features
//! are replaced by the faces (or edges) within a small angle of the normal ([`bearing`]). Both are
//! projected along the normal ([`projection`]). The vertices of their overlap ([`clip`], and
//! [`clip_large`] for faces with many vertices) are the contact candidates. A few candidates are
//! kept ([`mod@reduce`]): the deepest, and the points that span the most area. [`manifold`] keeps
//! the contacts from frame to frame.
//!
//! Every pair of points (a of A, b of B) satisfies `n . b - n . a >= lower`, where `lower` is the
//! bound of the outcome. So the deepest contact is that of the outcome, and no contact can be
//! deeper.
//!
//! Source: the clipping of a reference and an incident face (Gregorius 2013, "The separating axis
//! test between convex polyhedra", GDC). Departures:
//! 1. Both faces are projected along the certified normal and treated alike: points on A and on B
//!    lie opposite each other along the normal, in either order of the bodies.
//! 2. The reference only determines the body with which the normal rotates between two outcomes.
//! 3. The contacts of curved shapes lie on flat round faces and straight generators ([`Facet`]),
//!    clipped as circles and segments ([`clip_curved`]). The contacts of rounded shapes are those
//!    of their cores, and their points move outward.
//! 4. A bound on the motion of the bodies matches old contacts, not distances of points.

mod bearing;
mod clip;
mod clip_curved;
mod clip_large;
mod gradient;
mod half_space;
mod manifold;
mod projection;
mod query;
mod reduce;
mod refresh;

use nalgebra::{Matrix3, Point3, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{ACROSS, AGREE, STEEP};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::pair::outcome::{Outcome, Solver};
use crate::pair::rounding;
use bearing::Promotion;
pub(crate) use clip::ContactCandidate;
use clip::{Candidates, Location};
use clip_large::Rays;
use projection::{Axes, LazyProjection, ProjectedFeature};
pub(crate) use reduce::reduce;
use refresh::Projections;

pub(crate) use bearing::{Facet, RoundFace};
pub use gradient::Gradient;
pub use half_space::{HalfSpace, HalfSpaceContact, HalfSpaceContacts, HalfSpaceError};
#[cfg(feature = "serde")]
pub(crate) use manifold::persist::Complete;
pub use manifold::{ContactPoint, Manifold};
pub use query::ManifoldOptions;
pub(crate) use query::{Extent, Query};

/// Largest number of points of a manifold.
pub(crate) const MOST_POINTS: usize = 8;

/// The contacts of an outcome.
struct Contacts {
    points: [ContactPoint; MOST_POINTS],
    count: usize,
    /// Features that carry the contacts.
    features: FeaturePair,
    /// Location of each contact on both features.
    on: [[Location; 2]; MOST_POINTS],
    /// Lower bound of the distance from each vertex to the boundary of the opposite face.
    margins: [f64; MOST_POINTS],
    /// Whether the contacts are those of the previous manifold, in the same order.
    same: bool,
    rays: Rays,
}

/// Rules by which candidates become contacts.
struct Choice<'a> {
    before: &'a Manifold,
    /// Whether candidates of the previous manifold are preferred among equals.
    is_steady: bool,
    most: usize,
    /// Least distance of two contacts, seen along the normal.
    merge: f64,
    /// Depths within this count as equal.
    tie: f64,
}

impl Contacts {
    /// Returns the witness points of an outcome as the only contact.
    #[inline(always)]
    fn of_witnesses(outcome: &Outcome, before: &Manifold) -> Self {
        Self {
            points: [ContactPoint::witness(outcome); MOST_POINTS],
            count: 1,
            features: outcome.features,
            on: [ContactCandidate::WITNESS; MOST_POINTS],
            margins: [0.0; MOST_POINTS],
            same: false,
            rays: before.rays,
        }
    }

    /// Replaces the contacts by a few of the candidates; `place` returns the contact of a candidate
    /// and its margin.
    #[inline(always)]
    fn choose(
        &mut self,
        all: &[ContactCandidate],
        choice: &Choice,
        place: impl Fn(&ContactCandidate) -> (ContactPoint, f64),
    ) {
        let mut kept = 0;
        if choice.is_steady && choice.before.features() == Some(self.features) {
            for (k, c) in all.iter().enumerate() {
                kept |= u64::from(choice.before.on().contains(&c.on)) << k;
            }
        }
        self.count = 0;
        for &k in reduce(all, kept, choice.most, choice.merge, choice.tie).all() {
            let (point, margin) = place(&all[k]);
            // If rounding has split a feature, the witnesses may have the features of a nearby
            // candidate.
            if self.points[..self.count].iter().all(|p| p.features != point.features) {
                self.points[self.count] = point;
                self.on[self.count] = all[k].on;
                self.margins[self.count] = margin;
                self.count += 1;
            }
        }
    }

    /// Moves the contacts of two cores outward by the radii of the rounded bodies.
    #[cold]
    fn grow(&mut self, query: &Query, normal: &Vector3<f64>) {
        let [on_a, on_b] = query.radii;
        for point in &mut self.points[..self.count] {
            point.point_on_a += normal * on_a;
            point.point_on_b -= query.rotation.tr_mul(normal) * on_b;
            point.separation = rounding::less(point.separation, query.radii);
        }
    }
}

/// Two bodies, the rotation of `a_from_b`, and the certified outcome.
#[derive(Clone, Copy)]
struct PosedOutcome<'a> {
    a: &'a ConvexPolyhedron,
    b: &'a ConvexPolyhedron,
    rotation: &'a Matrix3<f64>,
    /// The pair size L, in the caller's unit.
    size: f64,
    outcome: &'a Outcome,
}

impl PosedOutcome<'_> {
    /// Returns the contacts of an outcome whose lower bound is within the prediction.
    /// `since_choice` is the motion of the bodies since the candidates were chosen, if the choice
    /// may be kept.
    fn contacts(self, options: &ManifoldOptions, before: &Manifold, since_choice: Option<f64>) -> Contacts {
        let outcome = self.outcome;
        let mut contacts = Contacts::of_witnesses(outcome, before);
        // If the bodies are very far apart or very different in size, the witness points are the
        // only contact.
        if self.a.exponent != self.b.exponent || outcome.solver == Solver::Far {
            return contacts;
        }
        let axes = self.axes();
        let features = self.promoted(&axes, options, before.features());
        contacts.features = features;
        if features.a.dimension() > 0 && features.b.dimension() > 0 && self.has_no_upright_face(&axes, features) {
            self.clip_features(&axes, options, before, since_choice, &mut contacts);
        }
        contacts
    }

    /// Computes the contacts of two features, each an edge or a face.
    // Not inlined: most contacts of round bodies involve a vertex and need none of the stack space.
    #[inline(never)]
    fn clip_features(
        self,
        axes: &[Axes; 2],
        options: &ManifoldOptions,
        before: &Manifold,
        since_choice: Option<f64>,
        contacts: &mut Contacts,
    ) {
        let features = contacts.features;
        let mut projections = Projections {
            a: LazyProjection::new(self.a, features.a, &axes[0], false),
            b: LazyProjection::new(self.b, features.b, &axes[1], true),
        };
        let since_choice = since_choice.filter(|_| before.features() == Some(features));
        if since_choice.is_some_and(|moved| projections.keep(&self, options, before, moved, contacts)) {
            return;
        }
        let pair = ProjectedPair {
            posed: self,
            a: projections.a.get(),
            b: projections.b.get(),
            unit: self.a.unit(),
        };
        pair.choose(options, before, contacts);
    }

    /// Returns the contact axes in the stored frame of each body, relative to its witness point.
    #[inline(always)]
    fn axes(&self) -> [Axes; 2] {
        let normal = self.outcome.normal.into_inner();
        let tangents = tangents_of(&normal);
        let noise = ACROSS * self.size / self.a.unit();
        [
            Axes {
                tangents,
                normal,
                witness: self.a.to_stored(&self.outcome.point_on_a),
                noise,
            },
            Axes {
                tangents: tangents.each(|v| self.rotation.tr_mul(&v)),
                normal: self.rotation.tr_mul(&normal),
                witness: self.b.to_stored(&self.outcome.point_on_b),
                noise,
            },
        ]
    }

    /// Returns the features that carry the contact.
    #[inline(always)]
    fn promoted(&self, axes: &[Axes; 2], options: &ManifoldOptions, before: Option<FeaturePair>) -> FeaturePair {
        let promote = |body, outward, feature, previous| {
            let promotion = Promotion {
                body,
                outward,
                sine: options.max_face_sine,
                previous,
            };
            promotion.promote(feature)
        };
        let closest = self.outcome.features;
        FeaturePair {
            a: promote(self.a, axes[0].normal, closest.a, before.map(|f| f.a)),
            b: promote(self.b, -axes[1].normal, closest.b, before.map(|f| f.b)),
        }
    }

    /// Returns whether no chosen face is parallel to the normal. A closest face may be parallel to
    /// it if a facet of A - B is smaller than rounding.
    #[inline(always)]
    fn has_no_upright_face(&self, axes: &[Axes; 2], features: FeaturePair) -> bool {
        let is_not_upright = |body: &ConvexPolyhedron, feature: Feature, outward: Vector3<f64>| match feature {
            Feature::Face(f) => body.planes[f.index()].normal.dot(&outward) > STEEP,
            _ => true,
        };
        is_not_upright(self.a, features.a, axes[0].normal) && is_not_upright(self.b, features.b, -axes[1].normal)
    }
}

/// Two features projected along the normal.
struct ProjectedPair<'a> {
    posed: PosedOutcome<'a>,
    a: &'a ProjectedFeature<'a>,
    b: &'a ProjectedFeature<'a>,
    /// Length of a stored unit in the caller's unit.
    unit: f64,
}

impl ProjectedPair<'_> {
    /// Adds the candidates within the prediction, and the witness points if no candidate is as
    /// deep.
    #[inline(always)]
    fn add_candidates(
        &self,
        options: &ManifoldOptions,
        before: &Manifold,
        rays: &mut Rays,
        candidates: &mut Candidates,
    ) {
        let (a, b) = (self.a, self.b);
        if a.is_edge() && b.is_edge() {
            clip::overlap_edges(a, b, options.max_face_sine, candidates);
        } else if a.is_large() || b.is_large() {
            let middle = |p: &Point3<f64>| a.position_of(&self.posed.a.to_stored(p));
            let hint = before.middle().as_ref().map(middle);
            clip_large::clip([a, b], hint, options.most(), rays, candidates);
        } else {
            clip::clip(a, b, a.axes.noise, candidates);
        }
        if !self.has_deepest(candidates) {
            candidates.push([0.0; 2], [0.0; 2], ContactCandidate::WITNESS);
        }
    }

    /// Returns whether a candidate is as deep as the outcome.
    #[inline(always)]
    fn has_deepest(&self, candidates: &Candidates) -> bool {
        let deep = (self.posed.outcome.upper + AGREE * self.posed.size) / self.unit;
        candidates.all().iter().any(|c| c.separation <= deep)
    }

    #[inline(always)]
    fn no_candidates(&self, options: &ManifoldOptions) -> Candidates {
        Candidates::new(self.posed.outcome.distance / self.unit, options.prediction / self.unit)
    }

    #[inline(always)]
    fn choose(&self, options: &ManifoldOptions, before: &Manifold, contacts: &mut Contacts) {
        let PosedOutcome { a, b, outcome, .. } = self.posed;
        let (mut candidates, noise) = (self.no_candidates(options), self.a.axes.noise);
        self.add_candidates(options, before, &mut contacts.rays, &mut candidates);
        let all = candidates.all();
        let choice = Choice {
            before,
            is_steady: all.len() > options.most(),
            most: options.most(),
            merge: noise.larger(options.rebuild_motion * a.radius.smaller(b.radius)),
            tie: noise,
        };
        contacts.choose(all, &choice, |candidate| {
            let point = if candidate.on == ContactCandidate::WITNESS {
                ContactPoint::witness(outcome)
            } else {
                self.contact(candidate, self.features_of(candidate))
            };
            (point, self.margin(candidate, options))
        });
    }

    /// Lower bound of the distance from a candidate vertex to the boundary of the opposite face.
    fn margin(&self, candidate: &ContactCandidate, options: &ManifoldOptions) -> f64 {
        let inside = match candidate.on.each(Location::as_vertex) {
            [Some(_), _] => self.b.inside_by(candidate.at),
            [_, Some(_)] => self.a.inside_by(candidate.at),
            _ => 0.0,
        };
        refresh::margin(inside * self.unit, candidate.separation * self.unit, options)
    }

    fn features_of(&self, candidate: &ContactCandidate) -> FeaturePair {
        if candidate.on == ContactCandidate::WITNESS {
            return self.posed.outcome.features;
        }
        let [a, b] = candidate.on;
        FeaturePair {
            a: self.a.feature_at(a),
            b: self.b.feature_at(b),
        }
    }

    fn contact(&self, candidate: &ContactCandidate, features: FeaturePair) -> ContactPoint {
        let [on_a, on_b] = candidate.on;
        ContactPoint {
            point_on_a: self.posed.a.to_user(&self.a.point(on_a, candidate.at)),
            point_on_b: self.posed.b.to_user(&self.b.point(on_b, candidate.at)),
            separation: candidate.separation * self.unit,
            features,
            id: features,
        }
    }
}

impl ConvexPolyhedron {
    /// Converts a point from the caller's coordinates to stored coordinates.
    fn to_stored(&self, p: &Point3<f64>) -> Vector3<f64> {
        if self.is_unscaled {
            p.coords
        } else {
            (p.coords - self.origin) / self.unit()
        }
    }
}

/// Returns two unit directions perpendicular to a unit direction and to each other, right-handed
/// with `n`.
pub(crate) fn tangents_of(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if n.x.abs() < 0.6 {
        Vector3::new(0.0, -n.z, n.y)
    } else {
        Vector3::new(n.z, 0.0, -n.x)
    };
    let first = other / sqrt(other.norm_squared());
    [first, n.cross(&first)]
}
